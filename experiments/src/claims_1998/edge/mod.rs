//! "The estimate is too low near the edge of a medium" and "looking at the incoming direction avoids false photons".
//!
//! A foggy room one mean free path deep is lit from its open side; a thin black wall closes it, and behind the wall the same
//! fog goes on in the dark. The light in the room is that of a slab with nothing behind. Where the edge is open, half of
//! the ball is empty; on the dark side of the wall, gathers find the photons of the room.

pub mod conclude;
mod figure;
mod results;

use super::part::STREAM;
use crate::harness::{CellId, CellOutput, Group, Settings, Unit};
use crate::prediction::Prediction;
use crate::setups::{CELL, Setup, Size};
use glam::DVec3;
use std::f64::consts::PI;
use turbid::Spectrum;
use turbid::estimators::boundary::{Boundary, Rejection};
use turbid::estimators::{Estimator, Gather, Kernel};
use turbid::geometry::{Rectangle, Shape, Slab};
use turbid::photons::{Histories, is_in, shoot};
use turbid::scene::Orders;
use turbid::stats::Moments;
use turbid::transport::NoProgress;
use turbid_analytic::nearest::nearest_expectation;
use turbid_analytic::quadrature::GaussLegendre;
use turbid_analytic::{Incidence, IsotropicSlab};

/// The group of all cells.
pub const GROUP: &str = "edge";
/// Depth of the lit room [mfp]: the wall is there.
pub const ROOM: f64 = 1.0;
/// The room: a slab under a normal beam.
const SETUP: Setup = Setup::slab(ROOM, 0.9, 0.0);
/// Farthest that a photon is taken from [mfp].
const REACH: f64 = 0.5;
/// Probes along a side of the cell.
const SIDE: usize = 4;
/// Depths below the open edge [mfp].
pub const DEPTHS: [f64; 6] = [0.0, 0.03, 0.06, 0.1, 0.15, 0.3];
/// Distances behind the wall [mfp].
pub const BEHIND: [f64; 5] = [0.01, 0.03, 0.06, 0.1, 0.15];

/// The gathers: a fixed radius, and the 50 nearest, the talk's own number.
pub const SIZES: [Size; 2] = [FIXED, NEAREST];
/// Photons within a radius.
pub const FIXED: Size = Size::Radius(0.2);
/// The nearest photons.
pub const NEAREST: Size = Size::Nearest(50);

/// The case of a depth below the open edge.
pub fn edge_case(size: Size, depth: f64) -> String {
    format!("edge h={depth} {}", size.title())
}

/// The case of a distance behind the wall.
pub fn wall_case(size: Size, rejection: Rejection, distance: f64) -> String {
    format!("wall h={distance} {} {}", size.title(), rejection.name())
}

/// Photons emitted into a map.
pub fn photons(settings: &Settings) -> u64 {
    settings.photons(20_000, 40_000)
}

/// All cells.
pub fn group(settings: &Settings) -> Group {
    Group::new(GROUP, settings.pick(96, 256), 4.0 * photons(settings) as f64, measure)
}

/// Measures one cell: everything over the exact fluence, that of the wall's lit side for what is behind it.
fn measure(settings: &Settings, cell: &CellId) -> anyhow::Result<CellOutput> {
    let mut output = CellOutput::new();
    let histories = Histories {
        count: photons(settings),
        seed: settings.seed,
        replicate: cell.stream(STREAM),
        max_order: None,
    };
    let pass = shoot(&SETUP.scene()?, histories, &[], is_in(Orders::ALL), &NoProgress)?;
    output.count("photons emitted", pass.emitted());
    let map = pass.into_map(REACH)?;
    let truth = IsotropicSlab::new(ROOM, SETUP.albedo, Incidence::Beam { mu0: 1.0 })?;
    // The fog of both rooms, and the wall, wider than the cell and all gathers.
    let fog = Shape::Slab(Slab::new(0.0, 3.0 * ROOM)?);
    let wide = 10.0 * CELL;
    let corner = DVec3::new(-wide, -wide, ROOM);
    let wall = [Shape::Rectangle(Rectangle::new(corner, 2.0 * wide * DVec3::X, 2.0 * wide * DVec3::Y)?)];
    let boundary = Boundary::of(&fog)?.with_walls(&wall);
    let place = |i: usize| (i as f64 + 0.5) * CELL / SIDE as f64;
    let mean = |z: f64, gather: Gather, rejection: Rejection| {
        let estimator = Estimator::new(Kernel::Uniform, gather).rejecting(rejection);
        let at = |i: usize| {
            let point = DVec3::new(place(i % SIDE), place(i / SIDE), z);
            estimator.fluence(&map, point, Spectrum::ONE, &boundary).value[0]
        };
        (0..SIDE * SIDE).map(at).collect::<Moments>().mean()
    };
    let at_wall = truth.fluence(ROOM)?.value;
    for size in SIZES {
        let gather = size.gather(REACH)?;
        for depth in DEPTHS {
            let exact = truth.fluence(depth)?.value;
            let low = mean(depth, gather, Rejection::Off) / exact - 1.0;
            output.push(edge_case(size, depth), "error", low);
        }
        for distance in BEHIND {
            for rejection in Rejection::ALL {
                let leak = mean(ROOM + distance, gather, rejection) / at_wall;
                output.push(wall_case(size, rejection, distance), "leak", leak);
            }
        }
    }
    Ok(output)
}

/// A field of photons against depth, 0 outside the room.
struct Profile {
    values: Vec<f64>,
}

/// Points of a profile, and of a gather's radii.
const POINTS: usize = 400;

impl Profile {
    fn new(value: impl Fn(f64) -> anyhow::Result<f64>) -> anyhow::Result<Self> {
        let values =
            (0..=POINTS).map(|i| value(i as f64 * ROOM / POINTS as f64)).collect::<anyhow::Result<_>>()?;
        Ok(Profile { values })
    }

    fn at(&self, depth: f64) -> f64 {
        let x = (depth / ROOM * POINTS as f64).clamp(0.0, POINTS as f64);
        let i = (x as usize).min(POINTS - 1);
        let part = x - i as f64;
        self.values[i] * (1.0 - part) + self.values[i + 1] * part
    }

    /// Mean over a ball about a depth, whatever of it lies outside the room being empty: a ball's slice at height s has the
    /// share 3 (r² - s²)/(4 r³).
    fn ball_mean(&self, depth: f64, r: f64) -> f64 {
        let (low, high) = ((depth - r).max(0.0), (depth + r).min(ROOM));
        if high <= low {
            return 0.0;
        }
        let steps = 200;
        let dx = (high - low) / f64::from(steps);
        let slice = |i: i32| {
            let t = low + (f64::from(i) + 0.5) * dx;
            let s = t - depth;
            self.at(t) * 0.75 * (r * r - s * s) / (r * r * r)
        };
        (0..steps).map(slice).sum::<f64>() * dx
    }

    /// Expectation of a gather about a depth; `density` photons a volume where the field is 1.
    fn expected(&self, depth: f64, size: Size, density: f64) -> anyhow::Result<f64> {
        match size {
            Size::Radius(r) => Ok(self.ball_mean(depth, r)),
            Size::Nearest(k) => {
                let radius = |i: usize| REACH * i as f64 / POINTS as f64;
                let means: Vec<f64> =
                    (0..=POINTS).map(|i| self.ball_mean(depth, radius(i).max(1e-6 * REACH))).collect();
                let mean = |r: f64| {
                    let x = (r / REACH * POINTS as f64).clamp(0.0, POINTS as f64);
                    let i = (x as usize).min(POINTS - 1);
                    let part = x - i as f64;
                    means[i] * (1.0 - part) + means[i + 1] * part
                };
                let ball = |r: f64| density * 4.0 / 3.0 * PI * r * r * r;
                Ok(nearest_expectation(u32::try_from(k)?, REACH, |r| ball(r) * mean(r), mean)?.value)
            }
        }
    }
}

/// What theory says of every case.
///
/// At the edge the ball's part outside is empty. Behind the wall a gather sees the room's photons alone; with a look at the
/// incoming direction, those that travel away from the wall, whose fluence is 2 pi int_0^1 I(t, mu) dmu.
pub fn predict(settings: &Settings) -> anyhow::Result<Vec<Prediction>> {
    let slab = IsotropicSlab::new(ROOM, SETUP.albedo, Incidence::Beam { mu0: 1.0 })?;
    let all = Profile::new(|t| Ok(slab.fluence_interpolated(t)?.value))?;
    let away = {
        let rule = GaussLegendre::new(16)?;
        // Nodes crowd where the radiance bends: mu = x².
        let fluence = |t: f64| -> anyhow::Result<f64> {
            let up = |x: f64| slab.radiance(t, x * x).map_or(f64::NAN, |v| 2.0 * x * v.value);
            let sum = rule.integrate(0.0, 1.0, up);
            Ok(2.0 * PI * sum)
        };
        Profile::new(fluence)?
    };
    let density = SETUP.density(photons(settings));
    let at_wall = slab.fluence(ROOM)?.value;
    let mut predictions = Vec::new();
    let mut add = |case: String, quantity: &str, value: f64, source: &str| {
        // Linear pieces of a 400th of the room.
        predictions.push(Prediction::new(case, quantity, Unit::FRACTION, (value, 2e-4), source));
    };
    for size in SIZES {
        for depth in DEPTHS {
            let exact = slab.fluence(depth)?.value;
            let low = all.expected(depth, size, density)? / exact - 1.0;
            add(edge_case(size, depth), "error", low, "exact fluence over the part of the ball inside");
        }
        for distance in BEHIND {
            for rejection in Rejection::ALL {
                let field = match rejection {
                    Rejection::Off => Some(&all),
                    Rejection::Facing | Rejection::FacingBehind => Some(&away),
                    Rejection::BehindPlane | Rejection::Visible => None,
                };
                let leak = match field {
                    Some(field) => field.expected(ROOM + distance, size, density)? / at_wall,
                    None => 0.0,
                };
                add(
                    wall_case(size, rejection, distance),
                    "leak",
                    leak,
                    "exact fluence of what is not rejected",
                );
            }
        }
    }
    Ok(predictions)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An even field: half a ball at the open edge, and behind the wall the cap (2 r + h)(r - h)²/(4 r³).
    #[test]
    fn even_light_by_volumes() {
        let even = Profile::new(|_| Ok(1.0)).unwrap();
        assert!((even.ball_mean(0.0, 0.2) - 0.5).abs() < 1e-4);
        assert!((even.ball_mean(0.5, 0.2) - 1.0).abs() < 1e-4);
        let (r, h): (f64, f64) = (0.2, 0.06);
        let cap = (2.0 * r + h) * (r - h) * (r - h) / (4.0 * r * r * r);
        assert!((even.ball_mean(ROOM + h, r) - cap).abs() < 1e-4);
        assert_eq!(even.ball_mean(ROOM + r, r), 0.0);
    }
}
