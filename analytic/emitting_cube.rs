//! The cube of Burns and Christon: it absorbs and emits at one temperature, most in its middle, between cold black walls.
//!
//! kappa = peak (1 - 2|x-1/2|)(1 - 2|y-1/2|)(1 - 2|z-1/2|) + base in the unit cube, sigma T^4 = 1, no scattering. Along a ray the
//! emitted radiance is constant, 1/pi, so that I = (1 - e^(-tau))/pi with tau the depth to the wall, and
//!
//!   G = 4 - (1/pi) int e^(-tau) dOmega,   div q = kappa (4 - G),   q_wall = 1 - (1/pi) int e^(-tau) cos dOmega

use crate::error::{Result, within};
use crate::quadrature::GaussLegendre;
use crate::value::Value;
use libm::{atan2, cos, exp, sin};
use std::f64::consts::PI;

const HOW: &str = "directions through every face, two sets of nodes";

/// The emitting cube.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EmittingCube {
    peak: f64,
    base: f64,
}

/// Nodes of a panel in one round after another, until two agree: more near edges and corners.
const ORDERS: [usize; 4] = [8, 12, 18, 27];

impl EmittingCube {
    /// The problem as published: peak 0.9, base 0.1.
    pub const BURNS_CHRISTON: Self = EmittingCube { peak: 0.9, base: 0.1 };

    /// A cube whose absorption per side is `base` at the walls and `base` + `peak` in the middle.
    ///
    /// # Errors
    /// `Error::OutOfRange` unless both are 0 to 10
    /// # Limits
    /// base 0, peak 0: transparent, G = 0; large: G = 4
    /// # Source
    /// Burns and Christon 1997
    pub fn new(peak: f64, base: f64) -> Result<Self> {
        within("peak", peak, 0.0, 10.0, "0 to 10")?;
        within("base", base, 0.0, 10.0, "0 to 10")?;
        Ok(EmittingCube { peak, base })
    }

    /// Absorption coefficient at a place.
    pub fn absorption(&self, place: [f64; 3]) -> f64 {
        let tent = |x: f64| 1.0 - 2.0 * (x - 0.5).abs();
        self.peak * tent(place[0]) * tent(place[1]) * tent(place[2]) + self.base
    }

    fn check(place: [f64; 3]) -> Result<()> {
        for (name, at) in ["x", "y", "z"].into_iter().zip(place) {
            within(name, at, 0.0, 1.0, "0 to 1")?;
        }
        Ok(())
    }

    /// Fluence (irradiation), in units of sigma T^4.
    pub fn fluence(&self, place: [f64; 3]) -> Result<Value> {
        Self::check(place)?;
        let dark = self.transmitted(place, |_| 1.0);
        Ok(Value::new(4.0 - dark.value / PI, dark.error / PI + 8.0 * f64::EPSILON, HOW))
    }

    /// Divergence of the flux, kappa (4 - G): what is lost per volume, in units of sigma T^4 per side.
    pub fn divergence(&self, place: [f64; 3]) -> Result<Value> {
        Self::check(place)?;
        let dark = self.transmitted(place, |_| 1.0);
        Ok(dark.scaled(self.absorption(place) / PI))
    }

    /// Flux into the wall at `place`, which has to lie on it: of more than one, the first in the order of the axes.
    pub fn wall_flux(&self, place: [f64; 3]) -> Result<Value> {
        Self::check(place)?;
        let wall = (0..3).find(|&axis| place[axis] == 0.0 || place[axis] == 1.0);
        let Some(axis) = wall else {
            let near = place.iter().map(|x| x.min(1.0 - x)).fold(1.0, f64::min);
            within("distance of the place to the wall", near, 0.0, 0.0, "0")?;
            unreachable!("a place that is not on a wall is refused")
        };
        let inwards = if place[axis] == 0.0 { 1.0 } else { -1.0 };
        let dark = self.transmitted(place, |direction| (inwards * direction[axis]).max(0.0));
        Ok(Value::new(1.0 - dark.value / PI, dark.error / PI + 8.0 * f64::EPSILON, HOW))
    }

    /// int e^(-tau) g dOmega over all directions, by the face that each leaves through.
    fn transmitted(&self, place: [f64; 3], g: impl Fn([f64; 3]) -> f64) -> Value {
        let by = |order: usize| {
            let rule = GaussLegendre::rule(order);
            let faces = (0..3).flat_map(|axis| [(axis, false), (axis, true)]);
            faces.map(|(axis, far)| self.through(axis, far, place, &g, &rule)).sum::<f64>()
        };
        let (mut value, mut error) = (by(ORDERS[0]), f64::INFINITY);
        for &order in &ORDERS[1..] {
            let fine = by(order);
            (error, value) = ((fine - value).abs(), fine);
            if error <= 1e-8 * fine {
                break;
            }
        }
        Value::new(value, error + 64.0 * f64::EPSILON * value, HOW)
    }

    /// By azimuth and tilt about the normal of a face, on panels between what bends the depth: sides of the face, middle planes,
    /// and lines in which two of them meet, as seen from the place.
    fn through(
        &self,
        axis: usize,
        far: bool,
        place: [f64; 3],
        g: &impl Fn([f64; 3]) -> f64,
        rule: &GaussLegendre,
    ) -> f64 {
        let [q, r] = [[1, 2], [0, 2], [0, 1]][axis];
        let height = if far { 1.0 - place[axis] } else { place[axis] };
        // Seen against the face, a line parallel to it and across q lies at a distance from the foot that is that of its middle plane
        // stretched by the height.
        let towards = if far { 0.5 - place[axis] } else { place[axis] - 0.5 };
        let lines = |side: usize| {
            let mut at = vec![-place[side], 1.0 - place[side], 0.5 - place[side]];
            if towards > 0.0 {
                at.push((0.5 - place[side]) * height / towards);
            }
            at
        };
        let (in_q, in_r) = (lines(q), lines(r));
        let full = 2.0 * PI;
        let mut angles = vec![0.0, full];
        for &u in &in_q {
            for &v in &in_r {
                let angle = atan2(v, u);
                angles.push(if angle < 0.0 { angle + full } else { angle });
            }
        }
        // Directions along the axes, from which every quadrant begins.
        angles.extend([0.5 * PI, PI, 1.5 * PI]);
        sort(&mut angles);
        let mut sum = 0.0;
        for pair in angles.windows(2).filter(|pair| pair[1] - pair[0] > 1e-14) {
            sum += rule.integrate(pair[0], pair[1], |angle| {
                let (c, s) = (cos(angle), sin(angle));
                let reach = |low: f64, slope: f64| match slope {
                    slope if slope > 0.0 => (low + 1.0) / slope,
                    slope if slope < 0.0 => low / slope,
                    _ => f64::INFINITY,
                };
                let rim = reach(-place[q], c).min(reach(-place[r], s)).max(0.0);
                // By the angle to the normal: depths are smooth in its sine.
                let mut breaks = vec![0.0, atan2(rim, height)];
                let bends = in_q.iter().map(|u| u / c).chain(in_r.iter().map(|v| v / s));
                breaks.extend(
                    bends.filter(|&along| along > 0.0 && along < rim).map(|along| atan2(along, height)),
                );
                sort(&mut breaks);
                let mut inner = 0.0;
                for pair in breaks.windows(2).filter(|pair| pair[1] > pair[0]) {
                    inner += rule.integrate(pair[0], pair[1], |tilt| {
                        let (across, mu) = (sin(tilt), cos(tilt));
                        let mut direction = [0.0; 3];
                        direction[axis] = if far { mu } else { -mu };
                        (direction[q], direction[r]) = (across * c, across * s);
                        across * g(direction) * exp(-self.depth(place, direction, height / mu))
                    });
                }
                inner
            });
        }
        sum
    }

    /// Optical depth along a ray: cubic between middle planes, which two nodes integrate exactly.
    fn depth(&self, place: [f64; 3], direction: [f64; 3], length: f64) -> f64 {
        let mut stops = [0.0, 0.0, 0.0, 0.0, length];
        for axis in 0..3 {
            let at = (0.5 - place[axis]) / direction[axis];
            stops[axis + 1] = if at > 0.0 && at < length { at } else { 0.0 };
        }
        stops.sort_by(f64::total_cmp);
        let node = 0.5 / 3.0_f64.sqrt();
        let along = |s: f64| self.absorption([0, 1, 2].map(|axis| place[axis] + s * direction[axis]));
        let part = |pair: &[f64]| {
            let (middle, length) = (0.5 * (pair[0] + pair[1]), pair[1] - pair[0]);
            0.5 * length * (along(middle - node * length) + along(middle + node * length))
        };
        stops.windows(2).map(part).sum()
    }
}

fn sort(numbers: &mut [f64]) {
    numbers.sort_by(f64::total_cmp);
}

#[cfg(test)]
mod tests {
    use super::*;

    /// int f over a box from a corner by three pyramids, of f times d^2: u the place, slant the length of a step along the axis.
    fn from_corner(reach: [f64; 3], order: usize, f: impl Fn([f64; 3], f64) -> f64) -> f64 {
        let rule = GaussLegendre::rule(order);
        if reach.contains(&0.0) {
            return 0.0;
        }
        let mut sum = 0.0;
        for p in 0..3 {
            let [q, r] = [[1, 2], [0, 2], [0, 1]][p];
            sum += rule.integrate(0.0, reach[p], |s| {
                rule.integrate(0.0, reach[q] / reach[p], |tq| {
                    rule.integrate(0.0, reach[r] / reach[p], |tr| {
                        let mut u = [s; 3];
                        (u[q], u[r]) = (s * tq, s * tr);
                        f(u, (1.0 + tq * tq + tr * tr).sqrt())
                    })
                })
            });
        }
        sum
    }

    /// The other order: G = (1/pi) int kappa e^(-tau)/d^2 dV over pyramids about the place, the singularity gone with the Jacobian,
    /// on octants and on what the middle planes cut from them.
    fn over_the_volume(cube: &EmittingCube, place: [f64; 3], order: usize) -> f64 {
        let mut sum = 0.0;
        for octant in 0..8_usize {
            let signs = [0, 1, 2].map(|axis| if octant >> axis & 1 == 1 { -1.0 } else { 1.0 });
            let reach = [0, 1, 2].map(|axis| if signs[axis] < 0.0 { place[axis] } else { 1.0 - place[axis] });
            sum += from_corner(reach, order, |u, slant| {
                let there = [0, 1, 2].map(|axis| place[axis] + signs[axis] * u[axis]);
                let length = (u[0] * u[0] + u[1] * u[1] + u[2] * u[2]).sqrt();
                let direction = [0, 1, 2].map(|axis| signs[axis] * u[axis] / length);
                cube.absorption(there) * exp(-cube.depth(place, direction, length)) / (slant * slant)
            });
        }
        sum / PI
    }

    /// The second rule errs as the inverse square of its order: kinks lie in its panels.
    #[test]
    fn two_orders_of_integration_agree() {
        let cube = EmittingCube::BURNS_CHRISTON;
        for place in [[0.5, 0.5, 0.5], [0.2, 0.45, 0.7], [0.0, 0.5, 0.25], [0.9, 0.9, 0.9]] {
            let value = cube.fluence(place).unwrap();
            let [rough, fine] = [12, 24].map(|order| over_the_volume(&cube, place, order));
            let allowed = (fine - rough).abs() + value.error;
            assert!((value.value - fine).abs() <= allowed, "{place:?}: {value:?} {fine}");
            assert!(value.error < 1e-7 && allowed < 1e-3, "{place:?}: {value:?} {allowed:e}");
            // The coefficient a hundredth off would be seen.
            let wrong = EmittingCube::new(0.909, 0.101).unwrap().fluence(place).unwrap();
            assert!((wrong.value - fine).abs() > allowed, "{place:?}: {wrong:?}");
        }
    }

    /// All that the volume loses arrives at the walls: int div q dV = 6 int q_wall dA.
    #[test]
    fn losses_arrive_at_the_walls() {
        let cube = EmittingCube::new(3.0, 0.5).unwrap();
        let rule = GaussLegendre::rule(6);
        // An octant, and a quarter of a wall.
        let volume = rule.integrate(0.0, 0.5, |x| {
            rule.integrate(0.0, 0.5, |y| {
                rule.integrate(0.0, 0.5, |z| cube.divergence([x, y, z]).unwrap().value)
            })
        });
        let wall = rule.integrate(0.0, 0.5, |y| {
            rule.integrate(0.0, 0.5, |z| cube.wall_flux([0.0, y, z]).unwrap().value)
        });
        // Four nodes a side leave 8e-4, eight 6e-5: the fourth power.
        assert!((8.0 * volume / (24.0 * wall) - 1.0).abs() < 3e-4, "{volume} {wall}");
    }

    /// Of one coefficient: the direct light of the cuboid's own even source, 4 kappa times the volume; and the limits.
    #[test]
    fn even_absorption_and_limits() {
        let cube = EmittingCube::new(0.0, 2.0).unwrap();
        let even = crate::Cuboid::new([2.0; 3], 0.0, crate::CuboidSource::Uniform).unwrap();
        for place in [[0.5, 0.5, 0.5], [0.0, 0.3, 0.6], [0.01, 0.02, 0.03]] {
            let (value, other) =
                (cube.fluence(place).unwrap(), even.fluence(place.map(|x| 2.0 * x)).unwrap());
            let other = other.scaled(4.0 * 8.0);
            assert!((value.value - other.value).abs() <= value.error + other.error, "{value:?} {other:?}");
            assert!(value.error < 1e-5, "{value:?}");
        }
        let empty = EmittingCube::new(0.0, 0.0).unwrap().fluence([0.1, 0.5, 1.0]).unwrap();
        assert!(empty.covers(0.0) && empty.error < 1e-6, "{empty:?}");
        let flux = EmittingCube::new(0.0, 10.0).unwrap().wall_flux([0.5, 0.5, 0.0]).unwrap();
        assert!((flux.value - 1.0).abs() < 1e-2 && flux.value < 1.0, "{flux:?}");
        assert!(EmittingCube::new(f64::NAN, 0.0).is_err() && EmittingCube::new(0.0, 11.0).is_err());
        assert!(cube.fluence([0.5, 1.5, 0.5]).is_err() && cube.wall_flux([0.5, 0.4, 0.5]).is_err());
    }
}
