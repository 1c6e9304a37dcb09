//! The stratified slab: homogeneous layers on top of each other over a ground, each with its own thickness, albedo,
//! phase function and source.
//!
//! In layer i the radiance I, mu > 0 upwards, obeys
//!
//! mu dI/dt = I - (w_i/2) int sum_l (2l+1) chi_il P_l(mu) P_l(mu') I(t, mu') dmu' - beam - q_i/(4 pi)
//!
//! with q_i the power that starts per area and mean free path. Between layers of one index I is the same on both sides of an
//! interface. Between others it is a smooth face that reflects and refracts by Fresnel's laws for unpolarised light:
//! I/n^2 passes with a share 1 - r, and beyond the critical angle nothing does; faces are far from each other in
//! wavelengths, so that powers add. The ground returns nothing, rho/pi of the power that arrives in all directions, or a share as
//! a mirror, and may shine; it lies in a medium of its own index. Above the slab the index is 1. One layer in air is
//! [`crate::FresnelSlab`].
//!
//! Two methods know it: adding, whose layers are those of [`crate::AddingDoubling`], and the modes of discrete ordinates
//! of every layer, matched at all interfaces by one linear system. Either is computed on two sets of nodes; the error is
//! a small part of the difference, which is the bound, together with the differences of its neighbours (the other
//! fluxes; other depths of the layer), what nodes leave open of light from behind an interface close by, and roundings.
//! Light that has not been scattered has closed forms or quadratures, and is added.
//!
//! All powers are per area, over the irradiance on the lit face; in the dark, in whatever unit the sources have.
//!
//! Limits: one layer over a black ground is [`crate::Slab`]; two layers alike are one; all albedos 1: nothing is
//! absorbed; a closed enclosure of one temperature has the fluence 4 pi n^2 B everywhere.
//!
//! Source: van de Hulst 1963; Hansen and Travis 1974, section 3; Stamnes, Tsay, Wiscombe and Jayaweera 1988; de Haan,
//! Bosma and Hovenier 1987; plates and faces: Stokes 1862; Prahl, van Gemert and Welch 1993; Jin and Stamnes 1994.

mod adding;
mod azimuth;
mod grid;
mod ordinates;
mod pile;
mod problem;
mod stratified;
#[cfg(test)]
mod tests;
mod varying;

pub use problem::{Ground, Layer};
pub use stratified::StratifiedSlab;
pub use varying::VaryingAlbedo;
