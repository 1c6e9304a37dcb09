//! The small study: a field, the places where each map is asked, and the exact expectation of all that it states.

use crate::setups::Setup;
use crate::theory::Table;
use glam::DVec3;
use std::f64::consts::PI;
use turbid::photons::Photon;
use turbid_analytic::kernel::Kernel;
use turbid_analytic::nearest::{fixed_radius_variance, nearest_expectation};
use turbid_analytic::slab_kernel::slab_kernel_mean;

/// Photons emitted a map.
pub const PHOTONS: u64 = 2000;
/// Thickness of the slab [mfp].
const TAU: f64 = 1.0;
/// The slab under a normal beam, which only absorbs: fluence e^-t.
pub const SETUP: Setup = Setup::slab(TAU, 0.0, 0.0);
/// Depth of all places [mfp]: the balls touch no face.
const DEPTH: f64 = 0.5;
/// Radii of fixed gathers [mfp]. The last is that of every quantity but the amplitude.
pub const RADII: [f64; 3] = [0.2, 0.3, 0.4];
/// Half the distance between places, the largest radius and the cap of nearest gathers [mfp]: balls do not overlap, so
/// that they share photons as little as a fixed number of photons lets them.
pub const REACH: f64 = 0.4;
/// k of the nearest gather; a ball of the largest radius holds twice as many photons.
pub const NEIGHBORS: usize = 10;
/// Rows of places: each row is a study of its own, of the same maps.
pub const ROWS: usize = 5;
/// Places in a row: what one map says is their mean.
pub const PLACES: usize = 5;
/// Relative root mean square error whose price is asked.
const TARGET: f64 = 0.05;

/// One place of the lattice.
pub fn place(row: usize, index: usize) -> DVec3 {
    let at = |i: usize| REACH * (2 * i + 1) as f64;
    DVec3::new(at(index), at(row), DEPTH)
}

/// Whether a ball at the places' depth can reach a photon: nobody asks for the others.
pub fn is_near(photon: &Photon) -> bool {
    (photon.position.z - DEPTH).abs() <= REACH
}

/// Photons in a ball whose mean fluence is 1.
fn ball(r: f64) -> f64 {
    SETUP.density(PHOTONS) * 4.0 / 3.0 * PI * r * r * r
}

/// What is exact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Exact {
    /// Fluence at the places.
    pub fluence: f64,
    /// Expected relative error of the estimates of fixed radius, by radius.
    pub errors: [f64; RADII.len()],
    /// Expected relative error of the nearest estimate.
    pub nearest: f64,
    /// Relative variance of the estimate of the largest radius.
    pub variance: f64,
}

impl Exact {
    /// Computed by the referee. Photons are independent, their number is fixed.
    pub fn new() -> anyhow::Result<Self> {
        let field = |t: f64| libm::exp(-t);
        let here = field(DEPTH);
        let mean = |r: f64| slab_kernel_mean(Kernel::Uniform, r, DEPTH, TAU, field).map(|v| v.value);
        let mut errors = [0.0; RADII.len()];
        for (error, r) in errors.iter_mut().zip(RADII) {
            *error = mean(r)? / here - 1.0;
        }
        let exact = SETUP.exact()?;
        let means = Table::of_kernel_means(Kernel::Uniform, DEPTH, TAU, REACH, &exact)?;
        let number = |r: f64| ball(r) * means.at(r);
        let nearest = nearest_expectation(u32::try_from(NEIGHBORS)?, REACH, number, |r| means.at(r))?;
        let largest = mean(REACH)?;
        let variance = fixed_radius_variance(largest, largest / ball(REACH), Some(PHOTONS))?.value;
        Ok(Exact {
            fluence: here,
            errors,
            nearest: nearest.value / here - 1.0,
            variance: variance / (here * here),
        })
    }

    /// Root mean square error of the estimate of the largest radius, relative to the fluence.
    pub fn root_mean_square(&self) -> f64 {
        let bias = self.errors[RADII.len() - 1];
        (bias * bias + self.variance).sqrt()
    }

    /// Photons that reach the target at the largest radius, where one map has this relative variance: the bias is that
    /// of theory, and the variance falls as one over the photons.
    pub fn price(&self, variance: f64) -> f64 {
        let bias = self.errors[RADII.len() - 1];
        PHOTONS as f64 * variance / (TARGET * TARGET - bias * bias)
    }
}
