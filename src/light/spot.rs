//! A spot light: a point whose intensity falls off away from an axis.

use super::bundle::cone;
use super::emission::emissive;
use super::{Bundle, EmissionCell, LightSample, PrimarySample};
use crate::Spectrum;
use crate::error::{Error, Result};
use crate::math::{Frame, Interval, Ray, cosine_pair, sin, warp};
use glam::DVec3;
use std::f64::consts::PI;

/// A point that emits into a cone about an axis.
///
/// Intensity is full up to `full_angle` from the axis, 0 from `edge_angle` on, and between them I (3 x^2 - 2 x^3), where
/// x = (cos theta - cos edge) / (cos full - cos edge). With a = 1 - cos full and b = 1 - cos edge the power is exactly
/// pi I (a + b).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spot {
    position: DVec3,
    frame: Frame,
    power: Spectrum,
    /// Angles up to which intensity is full, and from which on it is dark \[degrees\].
    angles: [f64; 2],
    /// 1 - cos of the angle up to which intensity is full.
    full: f64,
    /// 1 - cos of the angle from which on it is dark.
    edge: f64,
}

/// 1 - cos of an angle in degrees, with every digit of small ones.
pub(super) fn one_minus_cos_degrees(degrees: f64) -> f64 {
    let half = sin(degrees * (PI / 360.0));
    2.0 * half * half
}

impl Spot {
    /// A light at `position` \[L\] that shines along `dir` (of any length but 0), of the given total power \[W\]; both
    /// angles are measured from the axis, in degrees.
    ///
    /// # Errors
    /// `Error::Scene` or `Error::OutOfRange`, naming what is wrong.
    pub fn new(
        position: DVec3,
        dir: DVec3,
        (full_angle, edge_angle): (f64, f64),
        power: Spectrum,
    ) -> Result<Self> {
        if !position.is_finite() {
            return Err(Error::Scene("a spot light needs a finite position".into()));
        }
        let Some(dir) = dir.try_normalize() else {
            return Err(Error::Scene("a spot light needs a finite direction other than 0 0 0".into()));
        };
        if !(1e-6..=180.0).contains(&edge_angle) {
            return Err(Error::out_of_range("edge_angle", edge_angle, "1e-6 to 180 degrees"));
        }
        if !(full_angle >= 0.0 && full_angle <= edge_angle) {
            return Err(Error::out_of_range("full_angle", full_angle, "0 to edge_angle, in degrees"));
        }
        Ok(Spot {
            position,
            frame: Frame::new(dir),
            power: emissive("power", power)?,
            angles: [full_angle, edge_angle],
            full: one_minus_cos_degrees(full_angle),
            edge: one_minus_cos_degrees(edge_angle),
        })
    }

    /// Where it is \[L\].
    pub fn position(&self) -> DVec3 {
        self.position
    }

    /// Unit direction of its axis.
    pub fn dir(&self) -> DVec3 {
        self.frame.z
    }

    /// Angles from the axis up to which intensity is full, and from which on it is dark \[degrees\].
    pub fn angles(&self) -> [f64; 2] {
        self.angles
    }

    /// Share of the full intensity at 1 - cos of an angle to the axis.
    fn falloff(&self, one_minus_mu: f64) -> f64 {
        if one_minus_mu <= self.full {
            1.0
        } else if one_minus_mu >= self.edge {
            0.0
        } else {
            let x = (self.edge - one_minus_mu) / (self.edge - self.full);
            x * x * (3.0 - 2.0 * x)
        }
    }

    /// Intensity along a unit direction [W/sr].
    pub fn intensity(&self, dir: DVec3) -> Spectrum {
        self.power * (self.falloff(cosine_pair(self.frame.z, dir).0) / (PI * (self.full + self.edge)))
    }

    /// The part of a line that it shines on \[L\], whose ends may be infinite: its cone's, all of it for cones wider than a half space,
    /// which may leave out a part in the middle; none where the line passes the cone by.
    pub fn lit(&self, ray: &Ray) -> Option<Interval> {
        let all = Interval { start: f64::NEG_INFINITY, end: f64::INFINITY };
        if self.edge >= 1.0 {
            return Some(all);
        }
        // From the point of the line nearest to the apex, whose distance from it keeps its digits.
        let nearest = (self.position - ray.origin).dot(ray.dir);
        let (p, d) = (self.frame.to_local(ray.at(nearest) - self.position), self.frame.to_local(ray.dir));
        // In the double cone sin^2 z^2 is at least cos^2 (x^2 + y^2): a t^2 + 2 b t + c at least 0.
        let (sin2, cos2) = (self.edge * (2.0 - self.edge), (1.0 - self.edge) * (1.0 - self.edge));
        let form = |u: DVec3, v: DVec3| sin2 * u.z * v.z - cos2 * (u.x * v.x + u.y * v.y);
        let (a, b, c) = (form(d, d), form(p, d), form(p, p));
        let square = b * b - a * c;
        if a <= 0.0 && square <= 0.0 {
            return None;
        }
        // The root that does not cancel, and the other by their product.
        let sum = -(b + square.max(0.0).sqrt().copysign(b));
        let (first, second) = (sum / a, if sum == 0.0 { 0.0 } else { c / sum });
        let (start, end) = (nearest + first.min(second), nearest + first.max(second));
        if a > 0.0 {
            // The line goes from one half of the double cone to the other.
            let is_ahead = d.z > 0.0;
            return Some(if is_ahead {
                Interval { start: end, ..all }
            } else {
                Interval { end: start, ..all }
            });
        }
        let is_before = |t: f64| p.z + t * d.z > 0.0;
        (is_before(first) || is_before(second)).then_some(Interval { start, end })
    }

    pub(super) fn power(&self) -> Spectrum {
        self.power
    }

    /// 1 - cos of the angle to the axis below which a share `u` of the power goes.
    fn one_minus_mu(&self, u: f64) -> f64 {
        let flux = u * 0.5 * (self.full + self.edge);
        if flux < self.full {
            return flux;
        }
        // What lies beyond x of the cubic, in parts of the whole: 1 - (2 x^3 - x^4).
        let width = self.edge - self.full;
        let beyond = if width > 0.0 { (flux - self.full) / (0.5 * width) } else { 0.0 };
        self.edge - width * inverse_flux(1.0 - beyond)
    }

    pub(super) fn ray(&self, numbers: &PrimarySample) -> Ray {
        let one_minus_mu = self.one_minus_mu(numbers.direction[0]);
        let local = warp::direction((one_minus_mu, 2.0 - one_minus_mu), numbers.direction[1]);
        Ray::new(self.position, self.frame.to_world(local).normalize())
    }

    pub(super) fn bundle(&self, cell: &EmissionCell) -> Bundle {
        let (axis, angle) = cone(cell, &self.frame, |u| self.one_minus_mu(u));
        Bundle { center: self.position, radius: 0.0, axis, angle }
    }

    pub(super) fn sample(&self, p: DVec3) -> Option<LightSample> {
        let to_light = self.position - p;
        let d2 = to_light.length_squared();
        if d2 == 0.0 {
            return None;
        }
        let distance = d2.sqrt();
        let dir = to_light / distance;
        let intensity = self.intensity(-dir);
        if intensity.is_black() {
            return None;
        }
        Some(LightSample { dir, distance, value: intensity / d2, pdf_solid_angle: None })
    }
}

/// The x in [0, 1] with 2 x^3 - x^4 = `share`: Newton's steps, halving where they would leave what brackets the root.
fn inverse_flux(share: f64) -> f64 {
    // At 0 the slope is 0 too, and a step of Newton's is 0/0.
    if share == 0.0 {
        return 0.0;
    }
    let (mut low, mut high) = (0.0, 1.0);
    let mut x = libm::cbrt(0.5 * share);
    // Halving alone would need 60 steps to the last digit.
    for _ in 0..60 {
        let excess = x * x * x * (2.0 - x) - share;
        if excess > 0.0 {
            high = x
        } else {
            low = x
        }
        let step = excess / (x * x * (6.0 - 4.0 * x));
        let next = x - step;
        let next = if next > low && next < high { next } else { 0.5 * (low + high) };
        if (next - x).abs() <= f64::EPSILON * x {
            return next;
        }
        x = next;
    }
    x
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::exp;
    use crate::rng::{Purpose, Stream};
    use std::f64::consts::LN_10;

    /// Places are on the lit part where the intensity towards them is above 0, and nowhere else: lines in all directions, past the
    /// apex at all distances, through it and along the axis, cones from 1e-6 degrees to beyond a half space.
    #[test]
    fn lit_parts_are_where_the_light_is() {
        let mut stream = Stream::new(11, Purpose::Synthetic, 0, 0);
        let (mut lit, mut dark) = (0, 0);
        for case in 0..40_000 {
            let edge_angle = [1e-6, 1e-3, 0.1, 5.0, 30.0, 70.0, 89.9, 90.0, 120.0][case % 9];
            let sphere = |stream: &mut Stream| warp::square_to_sphere(stream.pair()).normalize();
            let axis = sphere(&mut stream);
            let apex = 3.0 * sphere(&mut stream);
            let spot = Spot::new(apex, axis, (0.5 * edge_angle, edge_angle), Spectrum::ONE).unwrap();
            // Towards a place in the cone or near it, from anywhere, or along its axis.
            let depth = exp(LN_10 * (4.0 * stream.unit() - 3.0));
            let beside =
                sphere(&mut stream) * (3.0 * stream.unit() * depth * edge_angle.to_radians().min(1.0));
            let target = if case % 5 == 0 { apex } else { apex + axis * depth + beside };
            let dir =
                if case % 7 == 0 { axis * (1 - 2 * (case % 2) as i32) as f64 } else { sphere(&mut stream) };
            let ray = Ray::new(target - dir * (5.0 * stream.unit()), dir);
            let part = spot.lit(&ray);
            for _ in 0..20 {
                let away = exp(LN_10 * (6.0 * stream.unit() - 5.0));
                let t = (target - ray.origin).dot(dir) + if stream.unit() < 0.5 { away } else { -away };
                let to = (ray.at(t) - apex).normalize();
                let one_minus_mu = cosine_pair(axis, to).0;
                // As many digits as there are in a place about an apex at 3: of the angle, and so of its square.
                let blur = 1e-14 / ray.at(t).distance(apex) / one_minus_mu.sqrt() + 1e-12;
                if (one_minus_mu / spot.edge - 1.0).abs() < 8.0 * blur {
                    continue;
                }
                let is_lit = !spot.intensity(to).is_black();
                let is_inside = part.is_some_and(|part| (part.start..=part.end).contains(&t));
                let may_be_dark = is_inside && edge_angle >= 90.0;
                assert!(
                    is_lit == is_inside || may_be_dark,
                    "{edge_angle} {case}: {t} of {part:?}, lit {is_lit}"
                );
                if is_lit { lit += 1 } else { dark += 1 }
            }
        }
        assert!(lit > 100_000 && dark > 100_000, "{lit} {dark}");
    }

    #[test]
    fn the_flux_is_inverted() {
        for i in 0..=1000 {
            let share = f64::from(i) / 1000.0;
            let x = inverse_flux(share);
            assert!((x * x * x * (2.0 - x) - share).abs() < 4.0 * f64::EPSILON, "{share}: {x}");
        }
        assert_eq!((inverse_flux(0.0), inverse_flux(1.0)), (0.0, 1.0));
    }
}
