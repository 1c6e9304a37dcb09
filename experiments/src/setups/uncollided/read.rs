//! What is read of one pass of uncollided light: relative errors at one place or along one ray, by the simulator's estimators with the
//! uniform kernel.

use super::field::{ALBEDO, DEPTH, MU0, SPAN};
use glam::DVec3;
use turbid::Spectrum;
use turbid::estimators::boundary::Boundary;
use turbid::estimators::{BeamEstimator, Estimator, Gather, Kernel, RayEstimator};
use turbid::math::{FOUR_PI, Positive, Ray};
use turbid::photons::beams::BeamMap;
use turbid::photons::{Photon, PhotonMap, Storage};
use turbid::scene::Scene;
use turbid::transport::Walker;

/// Photons on their way to the first event: where they collide, and how they get there.
pub struct Uncollided {
    /// Whether collisions are stored.
    pub points: bool,
    /// Whether flights are.
    pub beams: bool,
}

impl Storage for Uncollided {
    fn in_medium(&self, _: u64, photon: &Photon) -> bool {
        self.points && photon.order == 0
    }

    fn has_beams(&self) -> bool {
        self.beams
    }

    fn on_flight(&self, _: u64, walker: &Walker) -> bool {
        walker.order == 0
    }
}

/// The exact fluence at the depth.
fn exact() -> f64 {
    libm::exp(-DEPTH / MU0)
}

/// What a ray at the depth collects. All of it passes, so that a ray is the same all along.
fn whole() -> f64 {
    exact() * ALBEDO * SPAN.length() / FOUR_PI
}

/// Relative error of the fluence at a place.
pub fn at_place(points: &PhotonMap, place: DVec3, radius: f64) -> anyhow::Result<f64> {
    let ball = Estimator::new(Kernel::Uniform, Gather::radius(radius)?);
    Ok(ball.fluence(points, place, Spectrum::ONE, &Boundary::UNKNOWN).value[0] / exact() - 1.0)
}

/// Relative error of the fluence at a place, from beams.
pub fn beams_at_place(beams: &BeamMap, scene: &Scene, place: DVec3, radius: f64) -> anyhow::Result<f64> {
    let radius = Positive::new("the radius", radius)?;
    let discs = BeamEstimator { kernel: Kernel::Uniform, radius, is_clipped: false };
    let medium = (0, &scene.regions()[0].medium);
    Ok(discs.fluence(beams, place, medium, &Boundary::UNKNOWN).value[0] / exact() - 1.0)
}

/// Relative error of what a ray collects, from points.
pub fn along_points(points: &PhotonMap, scene: &Scene, ray: &Ray, radius: f64) -> anyhow::Result<f64> {
    let radius = Positive::new("the radius", radius)?;
    let estimator = RayEstimator { kernel: Kernel::Uniform, radius, is_clipped: false };
    let medium = &scene.regions()[0].medium;
    let estimate = estimator.radiance(points, (ray, SPAN), medium, &Boundary::UNKNOWN, &|_| Spectrum::ONE);
    Ok(estimate.value[0] / whole() - 1.0)
}

/// Relative error of what a ray collects, from beams.
pub fn along_beams(beams: &BeamMap, scene: &Scene, ray: &Ray, radius: f64) -> anyhow::Result<f64> {
    let radius = Positive::new("the radius", radius)?;
    let estimator = BeamEstimator { kernel: Kernel::Uniform, radius, is_clipped: false };
    let medium = &scene.regions()[0].medium;
    let estimate =
        estimator.radiance(beams, (ray, SPAN), (0, medium), &Boundary::UNKNOWN, &|_| Spectrum::ONE);
    Ok(estimate.value[0] / whole() - 1.0)
}
