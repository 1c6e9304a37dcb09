//! Maps of independent points of a known density: estimators tested apart from transport.

use super::{Flags, Photon, PhotonMap, Photons};
use crate::error::{Error, Result};
use crate::math::{exp, exp_m1, ln_1p, sin_cos, warp};
use crate::rng::{Purpose, Stream};
use glam::{DVec3, Vec3};
use std::f64::consts::PI;

/// How the density varies along x, `s` running from 0 to 1 across the box; uniform along y and z.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Profile {
    /// The same everywhere.
    Constant,
    /// Proportional to 1 + slope (2 s - 1), slope in [-1, 1].
    Linear {
        /// Relative difference between the faces and the middle.
        slope: f64,
    },
    /// Proportional to exp(-rate x).
    Exponential {
        /// Decay [1/L], of either sign.
        rate: f64,
    },
    /// Zero for x below `edge`, the same everywhere else.
    Step {
        /// Where the density begins \[L\], inside the box.
        edge: f64,
    },
    /// Proportional to 1 + amplitude cos(2 pi periods s).
    Sinusoid {
        /// Relative amplitude, in [-1, 1].
        amplitude: f64,
        /// Waves across the box.
        periods: u32,
    },
}

/// How many photons a map gets.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Number {
    /// Exactly this many.
    Exact(u64),
    /// A Poisson number of this mean: counts in disjoint regions are then independent.
    Expected(u64),
}

/// Independent photons of unit total power in a box, with isotropic directions.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Synthetic {
    profile: Profile,
    lower: DVec3,
    upper: DVec3,
    kept: f64,
}

impl Synthetic {
    /// Photons in the box from `lower` to `upper` \[L\].
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a box without volume and for parameters outside the ranges of [`Profile`].
    pub fn new(profile: Profile, lower: DVec3, upper: DVec3) -> Result<Self> {
        let size = upper - lower;
        if !(size.min_element() > 0.0 && size.is_finite()) {
            return Err(Error::out_of_range(
                "the box's shortest edge",
                size.min_element(),
                "finite and above 0",
            ));
        }
        let (name, value, allowed, is_allowed) = match profile {
            Profile::Constant => ("the density", 1.0, "1", true),
            Profile::Linear { slope } => ("the slope", slope, "-1 to 1", slope.abs() <= 1.0),
            Profile::Exponential { rate } => {
                let across = rate * size.x;
                ("the decay across the box", across, "-700 to 700", across.abs() <= 700.0)
            }
            Profile::Step { edge } => ("the edge", edge, "inside the box", lower.x <= edge && edge < upper.x),
            Profile::Sinusoid { amplitude, .. } => {
                ("the amplitude", amplitude, "-1 to 1", amplitude.abs() <= 1.0)
            }
        };
        if !is_allowed {
            return Err(Error::out_of_range(name, value, allowed));
        }
        Ok(Synthetic { profile, lower, upper, kept: 1.0 })
    }

    /// The same photons, of which each is stored with probability `kept` only: stored and emitted then
    /// differ.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] unless `kept` is in (0, 1].
    pub fn thinned(self, kept: f64) -> Result<Self> {
        if !(kept > 0.0 && kept <= 1.0) {
            return Err(Error::out_of_range("the kept fraction", kept, "above 0, to 1"));
        }
        Ok(Synthetic { kept, ..self })
    }

    /// The density at a point [W/L^3]: what an estimate of the collision density estimates, blur apart. It
    /// integrates to the kept fraction over the box.
    pub fn density(&self, point: DVec3) -> f64 {
        let size = self.upper - self.lower;
        let inside = point.cmpge(self.lower).all() && point.cmple(self.upper).all();
        if !inside {
            return 0.0;
        }
        let s = (point.x - self.lower.x) / size.x;
        let relative = match self.profile {
            Profile::Constant => 1.0,
            Profile::Linear { slope } => 1.0 + slope * (2.0 * s - 1.0),
            Profile::Exponential { rate } => {
                let across = rate * size.x;
                if across == 0.0 { 1.0 } else { -across * exp(-across * s) / exp_m1(-across) }
            }
            Profile::Step { edge } if point.x < edge => 0.0,
            Profile::Step { edge } => size.x / (self.upper.x - edge),
            Profile::Sinusoid { amplitude, periods } => {
                1.0 + amplitude * sin_cos(2.0 * PI * f64::from(periods) * s).1
            }
        };
        self.kept * relative / size.x / size.y / size.z
    }

    /// A map of these photons, a function of its arguments alone.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] if `number` is zero, or a map cannot hold as many.
    pub fn map(&self, number: Number, seed: u64, replicate: u64) -> Result<PhotonMap> {
        let (emitted, histories) = match number {
            Number::Exact(n) => (n, n),
            Number::Expected(mean) => (mean, poisson(mean, seed, replicate)),
        };
        let photons: Photons = (0..histories)
            .filter_map(|history| self.photon(Stream::new(seed, Purpose::Synthetic, replicate, history)))
            .collect();
        PhotonMap::new(photons, emitted)
    }

    fn photon(&self, mut stream: Stream) -> Option<Photon> {
        let [v, w] = stream.pair();
        let along = DVec3::new(self.inverse(stream.open_unit()), v, w);
        let dir = warp::square_to_sphere(stream.pair()).as_vec3();
        (stream.unit() < self.kept).then(|| Photon {
            position: self.lower + (self.upper - self.lower) * along,
            dir,
            normal: Vec3::ZERO,
            power: Vec3::ONE,
            order: 0,
            flags: Flags::NONE,
        })
    }

    /// The `s` below which a fraction `u` of the photons is.
    fn inverse(&self, u: f64) -> f64 {
        match self.profile {
            Profile::Constant => u,
            // slope s^2 + (1 - slope) s = u, the root in a form without cancellation.
            Profile::Linear { slope } => {
                let b = 1.0 - slope;
                2.0 * u / (b + (b * b + 4.0 * slope * u).sqrt())
            }
            Profile::Exponential { rate } => {
                let across = rate * (self.upper.x - self.lower.x);
                if across == 0.0 { u } else { -ln_1p(u * exp_m1(-across)) / across }
            }
            Profile::Step { edge } => {
                let begin = (edge - self.lower.x) / (self.upper.x - self.lower.x);
                begin + (1.0 - begin) * u
            }
            Profile::Sinusoid { amplitude, periods } => invert_sinusoid(amplitude, f64::from(periods), u),
        }
    }
}

/// Solves s + amplitude sin(2 pi periods s)/(2 pi periods) = u: Newton's steps, halving the bracket where
/// they leave it, until the bracket or the step is below the spacing of numbers.
fn invert_sinusoid(amplitude: f64, periods: f64, u: f64) -> f64 {
    if periods == 0.0 {
        return u;
    }
    let wave = 2.0 * PI * periods;
    let (mut below, mut above) = (0.0f64, 1.0f64);
    let mut s = u;
    for _ in 0..100 {
        let (sin, cos) = sin_cos(wave * s);
        let excess = s + amplitude * sin / wave - u;
        if excess > 0.0 {
            above = s;
        } else {
            below = s;
        }
        let newton = s - excess / (1.0 + amplitude * cos);
        let next = if newton > below && newton < above { newton } else { 0.5 * (below + above) };
        if (next - s).abs() <= f64::EPSILON * s {
            return next;
        }
        s = next;
    }
    s
}

/// A Poisson number: the arrivals of a process of rate one before time `mean`, by their gaps.
fn poisson(mean: u64, seed: u64, replicate: u64) -> u64 {
    let mut stream = Stream::new(seed, Purpose::Synthetic, replicate, u64::MAX);
    let mut left = mean as f64;
    let mut count = 0;
    loop {
        left += ln_1p(-stream.unit());
        if left < 0.0 {
            return count;
        }
        count += 1;
    }
}
