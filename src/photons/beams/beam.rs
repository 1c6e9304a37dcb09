//! What is stored of a flight: exact data, no estimate.

use crate::Spectrum;
use crate::medium::Medium;
use crate::scene::decay;
use crate::transport::Flags;
use glam::{DVec3, Vec3};

/// What a beam's length is, and with it what its power does along it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BeamKind {
    /// The way that a sampled flight flew: what passes is in the length. The power is the same all along it, but in a homogeneous medium
    /// whose extinction differs by channel: there the sum over the channels is. In one that varies it may be a part of a flight.
    Sampled,
    /// All the way to the end of a homogeneous medium: the power falls with what passes.
    Expected,
}

/// A photon's flight through one stretch of a medium.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Beam {
    /// Where it begins \[L\].
    pub start: DVec3,
    /// Unit direction of travel.
    pub dir: DVec3,
    /// \[L\]
    pub length: f64,
    /// Power where it begins \[W\], as though its history were the only one emitted: what leaves an event, after the albedo.
    pub power: Vec3,
    /// Number of the medium.
    pub medium: u32,
    /// Number of scatterings before it, by media and non-specular surfaces: that of a photon at its end.
    pub order: u16,
    /// What the path met before it: those of a photon at its end.
    pub flags: Flags,
    /// What its length is.
    pub kind: BeamKind,
}

impl Beam {
    /// The point at distance `t` from its start \[L\].
    pub fn at(&self, t: f64) -> DVec3 {
        self.start + self.dir * t
    }

    /// Its power at a distance from its start \[W\]; `medium` is that of its number.
    pub fn power_at(&self, t: f64, medium: &Medium) -> Spectrum {
        let power = Spectrum(self.power.as_dvec3());
        match (self.kind, medium) {
            (BeamKind::Sampled, Medium::Homogeneous(even)) => sampled(power, even.sigma_t(), t),
            (BeamKind::Sampled, Medium::Heterogeneous(_)) => power,
            (BeamKind::Expected, _) => power * decay(medium.matter().depth(t)),
        }
    }
}

/// What a sampled flight carries behind a stretch that it passed: the balance heuristic over the channels that could have chosen
/// the flight, which keeps the sum.
pub(super) fn sampled(power: Spectrum, sigma_t: Spectrum, length: f64) -> Spectrum {
    if sigma_t.is_grey() {
        return power;
    }
    let passed = power * decay(sigma_t * length);
    passed * (power.sum() / passed.sum())
}
