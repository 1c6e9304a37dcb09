//! Estimates near a boundary: what they do where the medium ends inside the ball, and about photons behind a wall.
//!
//! With K_r the kernel of the ball about x, O the medium, z = (y - x) . n / r the depth along the inward normal n of the
//! nearest boundary point, S_j = sum p K_r z^j over the gathered photons and M_j = int_O K_r z^j:
//!
//! | treatment | estimate | in a uniform field f |
//! |---|---|---|
//! | none | S_0 | f M_0 |
//! | clipped | S_0 / M_0 | f |
//! | reflection | sum p (K_r + K_r of the photon's images) | f between flat faces |
//! | local linear | (M_2 S_0 - M_1 S_1)/(M_0 M_2 - M_1^2) | f |
//!
//! All four are the plain estimate where the ball is whole. The radius of a k-nearest gather is set by real, accepted photons
//! alone: an image, or a rejected photon, sets none.
//!
//! Where bodies stand in the medium, and other media beside it, all treatments but none reject photons that bodies hide from x
//! and those of the other media, and divide S_0 by the part of the kernel that x sees: f again in any geometry. Closed forms
//! stay where only the medium's own faces are in the ball.

mod accepted;
mod beside;
mod images;
mod moments;
mod rejection;
mod rows;
mod sheets;
mod solid;
mod surfaces;
mod treatment;
mod visible;

pub use moments::body_moments;
pub use rejection::Rejection;
pub use surfaces::Boundary;
pub use treatment::Treatment;

pub(super) use accepted::accepted;
pub(super) use beside::Beside;
pub(super) use moments::body_part;
pub(super) use rejection::PhotonFilter;
pub(super) use rows::BesideRows;
pub(super) use treatment::Gathered;
pub(super) use visible::Surroundings;
