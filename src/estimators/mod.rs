//! Estimators: what a photon map says of the light at a point.
//!
//! With N photons **emitted**, a kernel K_r of unit integral over the ball of radius r and stored photons of
//! power p (each as though its history were the only one), photons being stored at every collision with the
//! power they arrive with:
//! - collision density, sigma_t x fluence = sum p K_r / N [W/L^3];
//! - fluence = sum p K_r / (N sigma_t) [W/L^2];
//! - in-scattered radiance = sum p phase(dir -> wo) K_r / (N sigma_t) [W/(L^2 sr)];
//! - on a surface, with K_r of unit integral over the disc: irradiance = sum p K_r / N [W/L^2].
//!
//! Along whole rays [`RayEstimator`] reads the photons about a ray and [`BeamEstimator`] the flights that pass it, which are stored
//! with the power they leave with. [`PlaneEstimator`] reads planes, a flight and a scattering on it together, without any kernel.
//!
//! An [`Estimator`] is a [`Kernel`], which weights the photons of the ball, a [`Gather`], which chooses the ball, and what it
//! does near the surface of a medium, or a wall ([`boundary`]); it states the bias and variance that it expects.

mod beam;
mod blur;
pub mod boundary;
mod chord;
mod directional;
mod disc_share;
mod ends;
mod estimator;
mod gather;
mod kernel;
mod plane;
mod point;
mod ray;
mod schedule;
mod surface;
mod transmitted;

pub use beam::BeamEstimator;
pub use blur::BeamBlur;
pub use directional::{CosinePairs, Directional};
pub use disc_share::{cap_share, disc_share};
pub use ends::{OwnEnds, RayEnds};
pub use estimator::{Estimator, Stretched};
pub use gather::{Gather, NeighborCount};
pub use kernel::Kernel;
pub use plane::PlaneEstimator;
pub use point::{Ball, BallSum, Estimate, ball_sum, count_within, for_each_photon};
pub use ray::{RayEstimate, RayEstimator};
pub use schedule::Codimension;
pub use surface::{irradiance, irradiance_seen};
pub use transmitted::Transmitted;
