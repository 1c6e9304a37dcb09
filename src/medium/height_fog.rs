//! Fog that thins out with height.

use super::Bound;
use crate::error::{Error, Result};
use crate::faults::{Fault, planted};
use crate::math::{Interval, Positive, Ray, exp, exp_m1};
use glam::DVec3;

/// Density \[1\] = exp(-h/H) at a height h above the base, 1 below it; H is the scale height.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HeightFog {
    up: DVec3,
    base: f64,
    scale_height: f64,
}

/// The density changes by a factor of e^(1/2) within a stretch of bounds, unless the ray is so long that there would
/// be more than [`MOST_BOUNDS`].
const LOG_STEP: f64 = 0.5;
const MOST_BOUNDS: f64 = 64.0;

impl HeightFog {
    /// Fog over the plane `p . up = base`.
    ///
    /// # Arguments
    /// `up` of any length but 0; `base` the height of the plane along it, `scale_height` \[L\]
    /// # Errors
    /// `Error::Scene` for a direction or a base that is not finite, or a direction 0 0 0
    pub fn new(up: DVec3, base: f64, scale_height: Positive) -> Result<Self> {
        match up.try_normalize() {
            Some(up) if base.is_finite() => Ok(HeightFog { up, base, scale_height: scale_height.get() }),
            _ => Err(Error::Scene(
                "height fog needs a finite base, and a finite direction upwards other than 0 0 0".into(),
            )),
        }
    }

    /// Height above the base over the scale height, along a ray: at the origin, and its slope [1/L].
    fn line(&self, ray: &Ray) -> (f64, f64) {
        ((self.up.dot(ray.origin) - self.base) / self.scale_height, self.up.dot(ray.dir) / self.scale_height)
    }

    /// Whether it depends on z alone.
    pub fn is_layered(&self) -> bool {
        self.up.x == 0.0 && self.up.y == 0.0
    }

    /// Density at a point \[1\], 0 to 1.
    pub fn at(&self, p: DVec3) -> f64 {
        exp(-((self.up.dot(p) - self.base) / self.scale_height).max(0.0))
    }

    /// No point of a box has more than this: it is densest in its lowest corner.
    pub fn high_in(&self, min: DVec3, max: DVec3) -> f64 {
        self.at(DVec3::select(self.up.cmpge(DVec3::ZERO), min, max))
    }

    /// The part of a stretch that lies above the base, and the length of the rest \[L\].
    fn split(&self, ray: &Ray, part: Interval) -> (Option<Interval>, f64) {
        let (height, slope) = self.line(ray);
        let above = if slope == 0.0 {
            if height >= 0.0 { Some(part) } else { None }
        } else {
            let crossing = -height / slope;
            let side = if slope > 0.0 {
                Interval { start: crossing, end: f64::INFINITY }
            } else {
                Interval { start: f64::NEG_INFINITY, end: crossing }
            };
            side.intersection(part)
        };
        let below = match above {
            Some(above) => {
                (above.start - part.start) + if above.end < part.end { part.end - above.end } else { 0.0 }
            }
            None => part.length(),
        };
        (above, below)
    }

    /// The integral of the density over a part of a ray \[L\], in closed form: a stretch of length s that starts at
    /// density d and climbs at a slope of k scale heights a length has d (1 - e^(-ks))/k.
    pub fn integral(&self, ray: &Ray, part: Interval) -> f64 {
        let (above, below) = self.split(ray, part);
        let Some(above) = above else { return below };
        let (height, slope) = self.line(ray);
        // From the lower end, so that the exponent is not positive.
        let lower = if slope >= 0.0 { above.start } else { above.end };
        let density = exp(-(height + slope * lower).max(0.0));
        let (slope, length) = (slope.abs(), above.length());
        let is_level = slope == 0.0 || (planted(Fault::GentleFogLevel) && slope < 1e-3);
        let reach = if is_level { length } else { -exp_m1(-slope * length) / slope };
        below + if density == 0.0 { 0.0 } else { density * reach }
    }

    /// Bounds of the density along a part of a ray: it is monotone, so that those of a stretch are its ends'.
    pub fn along(&self, ray: &Ray, part: Interval) -> Layers {
        let (height, slope) = self.line(ray);
        Layers { height, slope, at: part.start, part }
    }
}

/// Stretches of a ray through height fog.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Layers {
    /// Height of the ray's origin in scale heights, and its slope [1/L].
    height: f64,
    slope: f64,
    at: f64,
    part: Interval,
}

impl Iterator for Layers {
    type Item = Bound;

    fn next(&mut self) -> Option<Bound> {
        let Interval { start, end } = self.part;
        if self.at >= end {
            return None;
        }
        let interval = if self.slope == 0.0 {
            Interval { start: self.at, end }
        } else {
            let step = LOG_STEP / self.slope.abs();
            // An endless ray has no parts of its length: its steps double.
            let least = if end.is_finite() { (end - start) / MOST_BOUNDS } else { self.at - start };
            let next = self.at + step.max(least);
            Interval { start: self.at, end: if next > self.at { next.min(end) } else { end } }
        };
        self.at = interval.end;
        let density = |t: f64| exp(-(self.height + self.slope * t).max(0.0));
        let a = density(interval.start);
        let b = if self.slope == 0.0 { a } else { density(interval.end) };
        // What rounding does to a height is less than a part in 1e9 of the density, within the extents that scenes
        // are allowed.
        Some(Bound { interval, low: a.min(b) * (1.0 - 1e-9), high: (a.max(b) * (1.0 + 1e-9)).min(1.0) })
    }
}
