//! The cases: which ray, which steps, which gather.

use crate::harness::{Parameters, Settings};
use crate::setups::{CELL, Setup, Size};
use glam::DVec3;
use turbid::estimators::{Estimator, Kernel};
use turbid::integrators::StepRule;
use turbid::math::Ray;

/// Optical thickness of the slab.
pub const TAU: f64 = 2.0;
/// Its single-scattering albedo; it scatters isotropically.
pub const ALBEDO: f64 = 0.9;
/// The slab under a normal beam.
pub const SETUP: Setup = Setup::slab(TAU, ALBEDO, 0.0);
/// Farthest that a photon is taken from [mfp].
pub const REACH: f64 = 0.3;
/// Directions of the rays: cosine with the normal.
pub const COSINES: [f64; 3] = [1.0, 0.5, 0.2];
/// Steps [mfp]; each divides all paths through the slab.
pub const STEPS: [f64; 5] = [0.05, 0.1, 0.2, 0.5, 1.0];
/// Radius of most gathers [mfp].
pub const RADIUS: f64 = 0.2;

/// One question to a map: the radiance that leaves the lit face.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Case {
    /// Cosine of the ray with the normal.
    pub mu: f64,
    /// Step [mfp].
    pub step: f64,
    /// Rule of the steps.
    pub rule: StepRule,
    /// Gather.
    pub size: Size,
}

impl Case {
    /// Every case: all rays and steps at one radius; other gathers along the normal, in three steps and in one.
    pub fn all() -> Vec<Case> {
        let mut cases = Vec::new();
        for rule in StepRule::ALL {
            for mu in COSINES {
                cases.extend(STEPS.map(|step| Case { mu, step, rule, size: Size::Radius(RADIUS) }));
            }
            for radius in [0.1, REACH] {
                let size = Size::Radius(radius);
                cases.extend([0.05, 0.2, 1.0].map(|step| Case { mu: 1.0, step, rule, size }));
            }
            if rule != StepRule::Middle {
                cases.extend([4, 10, 50].map(|k| Case { mu: 1.0, step: 0.2, rule, size: Size::Nearest(k) }));
            }
        }
        cases
    }

    /// What it asks, as columns of the results.
    pub fn parameters(&self) -> Parameters {
        Parameters { kernel: Some(Kernel::Uniform), ..self.size.parameters() }
    }

    /// The name in tables.
    pub fn name(&self) -> String {
        let gather = self.size.name();
        format!("mu={} dx={} {gather} {}", self.mu, self.step, rule_name(self.rule))
    }

    /// What is asked at each step.
    pub fn estimator(&self) -> turbid::Result<Estimator> {
        Ok(Estimator::new(Kernel::Uniform, self.size.gather(REACH)?))
    }

    /// Length of a ray [mfp].
    pub fn length(&self) -> f64 {
        TAU / self.mu
    }

    /// The rays, from the lit face into the slab. Small gathers are noisy, and cheap: they get more of them.
    pub fn rays(&self) -> impl Iterator<Item = Ray> {
        let side = if self.size.is_nearest() { 16 } else { 3 };
        let dir = DVec3::new((1.0 - self.mu * self.mu).sqrt(), 0.0, self.mu);
        let place = move |i: usize| (i as f64 + 0.5) * CELL / side as f64;
        (0..side * side).map(move |i| Ray::new(DVec3::new(place(i % side), place(i / side), 0.0), dir))
    }
}

/// The rule in words.
pub fn rule_name(rule: StepRule) -> &'static str {
    match rule {
        StepRule::NearEnd => "1998",
        StepRule::Middle => "middle",
        StepRule::Integrated => "integrated",
    }
}

/// Photons emitted into a map.
pub fn photons(settings: &Settings) -> u64 {
    settings.photons(50_000, 200_000)
}

/// Maps.
pub fn maps(settings: &Settings) -> u64 {
    settings.pick(160, 320)
}
