//! The questions: which field, asked by whom, with the exact law of one photon.

use crate::debiasing::predict::Ball;
use crate::setups::uncollided::{DEPTH, MU0, Query, SPAN, scene as slab};
use crate::setups::{Body, CELL, asked, region};
use glam::DVec3;
use std::f64::consts::PI;
use turbid::Spectrum;
use turbid::light::{Light, Point};
use turbid::math::Ray;
use turbid::photons::synthetic::{Profile, Synthetic};
use turbid::scene::{Orders, Quantity, Scene, SceneParts, Sensor};
use turbid_analytic::kernel::Kernel;
use turbid_analytic::quadrature::GaussLegendre;
use turbid_analytic::slab_kernel::edge_loss;

/// Optical thickness of the slab of `dimension`.
const TAU: f64 = 4.0;
/// Depth of the places next to the lit face [mfp].
const FACE: f64 = 0.1;
/// Distance of the places about the point light [mfp].
const DISTANCE: f64 = 0.5;
/// Radius of the medium about it.
const MEDIUM: f64 = 2.0;
/// Amplitude of the wave, at whose troughs it is asked: a fifth of the mean is left there.
const AMPLITUDE: f64 = 0.8;
/// Waves along the cell: 2/3 mean free paths each, which the largest ball averages away.
const WAVES: u32 = 6;
/// Length of the wave [mfp].
const WAVE: f64 = CELL / WAVES as f64;

/// What is asked.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Field {
    /// Points at a place in an exponential.
    Places,
    /// Points along a ray across it.
    Rays,
    /// Beams along a ray across it.
    Beams,
    /// Points at a trough of a short wave.
    Dip,
    /// Points at a place next to the lit face, beyond which is no medium.
    Face,
    /// Points at a place near a point light.
    Light,
}

/// Maps that questions share.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Source {
    /// The slab of `dimension`.
    Slab,
    /// A ball about a point light.
    Light,
    /// Independent points of a wave.
    Wave,
}

impl Source {
    /// All.
    pub const ALL: [Source; 3] = [Source::Slab, Source::Light, Source::Wave];

    /// Its name in groups.
    pub fn name(self) -> &'static str {
        match self {
            Source::Slab => "slab",
            Source::Light => "light",
            Source::Wave => "wave",
        }
    }
}

impl Field {
    /// All, in the order of figures: first those that are smooth.
    pub const ALL: [Field; 6] =
        [Field::Places, Field::Rays, Field::Beams, Field::Dip, Field::Face, Field::Light];

    /// Its name in cases.
    pub fn name(self) -> &'static str {
        match self {
            Field::Places => "places",
            Field::Rays => "rays",
            Field::Beams => "beams",
            Field::Dip => "dip",
            Field::Face => "face",
            Field::Light => "light",
        }
    }

    /// Its title for readers.
    pub fn title(self) -> &'static str {
        match self {
            Field::Places => "exponential, points at a place",
            Field::Rays => "exponential, points on a ray",
            Field::Beams => "exponential, beams on a ray",
            Field::Dip => "dip of a wave of 2/3 mfp",
            Field::Face => "0.1 mfp below the lit face",
            Field::Light => "0.5 mfp from a point light",
        }
    }

    /// Whether theory's assumption, a bend of second order, holds up to the largest radius.
    pub fn is_smooth(self) -> bool {
        matches!(self, Field::Places | Field::Rays | Field::Beams)
    }

    /// The maps that it is put to.
    pub fn source(self) -> Source {
        match self {
            Field::Dip => Source::Wave,
            Field::Light => Source::Light,
            _ => Source::Slab,
        }
    }

    /// The question of `dimension`, where it is one.
    pub fn query(self) -> Query {
        match self {
            Field::Rays => Query::Rays,
            Field::Beams => Query::Beams,
            _ => Query::Places,
        }
    }

    /// Exponent c of the radius in the variance.
    pub fn codimension(self) -> f64 {
        self.query().codimension()
    }

    /// Mean and weight at a radius, over the exact value.
    pub fn ball(self, radius: f64) -> anyhow::Result<Ball> {
        let volume = 4.0 / 3.0 * PI * radius * radius * radius;
        Ok(match self {
            Field::Places | Field::Rays | Field::Beams => Ball::new(self.query(), radius)?,
            Field::Face => {
                let split = edge_loss(Kernel::Uniform, radius, FACE, TAU, |t| libm::exp(-t / MU0))?;
                Ball::of(split.mean.value / self.exact(), MU0 * CELL * CELL / (self.exact() * volume))
            }
            Field::Light => {
                // The fluence times the sphere's area.
                let mean = mean_about(DISTANCE, radius, |s| libm::exp(-s))?;
                Ball::of(mean / self.exact(), 1.0 / (self.exact() * volume))
            }
            Field::Dip => {
                let x = 2.0 * PI * radius / WAVE;
                let (sin, cos) = turbid::math::sin_cos(x);
                let damped = if x < 1e-3 { 1.0 - x * x / 10.0 } else { 3.0 * (sin - x * cos) / (x * x * x) };
                Ball::of((1.0 - AMPLITUDE * damped) / (1.0 - AMPLITUDE), 1.0 / (self.exact() * volume))
            }
        })
    }

    /// Whether a place asks.
    pub fn is_place(self) -> bool {
        !matches!(self, Field::Rays | Field::Beams)
    }

    /// The exact fluence at the places of those that ask places.
    pub fn exact(self) -> f64 {
        match self {
            Field::Dip => (1.0 - AMPLITUDE) / (CELL * CELL * CELL),
            Field::Face => libm::exp(-FACE / MU0),
            Field::Light => libm::exp(-DISTANCE) / (4.0 * PI * DISTANCE * DISTANCE),
            Field::Places | Field::Rays | Field::Beams => libm::exp(-DEPTH / MU0),
        }
    }

    /// The places of those that ask places.
    pub fn places(self) -> Vec<DVec3> {
        match self {
            Field::Face => Body::Slab { thickness: TAU }.places(5, FACE),
            Field::Light => Body::Sphere { radius: MEDIUM }.places(4, MEDIUM - DISTANCE),
            Field::Dip => {
                let across = [0.8, 2.0, 3.2];
                let at = |i: usize| DVec3::new((2 + i % 3) as f64 * WAVE, across[i / 3 % 3], across[i / 9]);
                (0..27).map(at).collect()
            }
            Field::Places | Field::Rays | Field::Beams => Body::Slab { thickness: TAU }.places(5, DEPTH),
        }
    }

    /// The rays of those that ask rays: few where each takes long.
    pub fn rays(self) -> Vec<Ray> {
        let count = if self == Field::Beams { 4 } else { 8 };
        let x = |i: usize| (i as f64 + 0.5) * SPAN.end / count as f64;
        (0..count).map(|i| Ray::new(DVec3::new(x(i), 0.0, DEPTH), DVec3::Y)).collect()
    }
}

/// Mean over a ball of a field about a point at a distance from its centre; `spread` is the field at a distance s from that point, times
/// 4 pi s^2.
fn mean_about(distance: f64, radius: f64, spread: impl Fn(f64) -> f64) -> anyhow::Result<f64> {
    let rule = GaussLegendre::new(48)?;
    let whole = rule.integrate(0.0, (radius - distance).max(0.0), &spread);
    // The part of the sphere of radius s that lies in the ball.
    let part = |s: f64| 0.5 * (1.0 - (distance * distance + s * s - radius * radius) / (2.0 * distance * s));
    let cut = rule.integrate((distance - radius).abs(), distance + radius, |s| part(s) * spread(s));
    Ok((whole + cut) / (4.0 / 3.0 * PI * radius * radius * radius))
}

/// The scene of a source that has one, with a fluence sensor where a question is asked.
pub fn scene(source: Source) -> anyhow::Result<Scene> {
    match source {
        Source::Slab | Source::Wave => slab(),
        Source::Light => {
            let shape = Body::Sphere { radius: MEDIUM }.shape()?;
            Ok(asked(Scene::new(SceneParts {
                regions: vec![region(shape, 1.0, 0.0, 0.0)?],
                lights: vec![Light::Point(Point::new(DVec3::ZERO, Spectrum::ONE)?)],
                ..SceneParts::default()
            })?))
        }
    }
}

/// The scene of a question with a sensor at one of its places, of uncollided light.
pub fn with_sensor(field: Field) -> anyhow::Result<Scene> {
    let plain = scene(field.source())?;
    let sensor = Sensor {
        name: field.name().to_string(),
        label: "fluence".to_string(),
        quantity: Quantity::Fluence(field.places()[0]),
        orders: Orders { min: 0, max: Some(0) },
    };
    Ok(asked(Scene::new(SceneParts {
        regions: plain.regions().to_vec(),
        lights: plain.lights().to_vec(),
        cell: plain.periodic_cell().map(|cell| cell.side),
        sensors: vec![sensor],
        ..SceneParts::default()
    })?))
}

/// The points of the wave.
pub fn wave() -> anyhow::Result<Synthetic> {
    let profile = Profile::Sinusoid { amplitude: -AMPLITUDE, periods: WAVES };
    Ok(Synthetic::new(profile, DVec3::ZERO, DVec3::splat(CELL))?)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::selection::cases::LARGEST;

    #[test]
    fn whole_balls_lie_where_photons_are() {
        for place in Field::Dip.places() {
            let room = place.min_element().min((DVec3::splat(CELL) - place).min_element());
            assert!(room >= LARGEST - 1e-12);
            assert!((wave().unwrap().density(place) * CELL * CELL * CELL - 0.2).abs() < 1e-12);
        }
        assert!(Field::Light.places().iter().all(|p| (p.length() - DISTANCE).abs() < 1e-12));
        assert!(Field::Light.places().iter().all(|p| p.length() + LARGEST < MEDIUM));
    }

    /// A field of 1 has the mean 1, and s^2 that of the distance and the ball's own: b^2 + 3/5 r^2; the light within and without.
    #[test]
    fn means_about_a_point_in_closed_form() {
        for radius in [0.2, 0.5, 0.8] {
            let even = mean_about(0.5, radius, |s| 4.0 * PI * s * s).unwrap();
            let square = mean_about(0.5, radius, |s| 4.0 * PI * s * s * s * s).unwrap();
            assert!((even - 1.0).abs() < 1e-12, "{radius}: {even}");
            assert!((square - 0.25 - 0.6 * radius * radius).abs() < 1e-12, "{radius}: {square}");
        }
    }

    /// Small balls tend to the exact value, with the bend of each field: Lap f/(10 f).
    #[test]
    fn small_balls_bend_as_the_fields_do() {
        let (b, r) = (DISTANCE, 0.01);
        // Of e^-s/s^2: f'' + 2 f'/s over f is 1 + 2/s + 2/s^2.
        let about_light = 1.0 + 2.0 / b + 2.0 / (b * b);
        let dip = 4.0 * PI * PI / (WAVE * WAVE) * AMPLITUDE / (1.0 - AMPLITUDE);
        for (field, bend) in [
            (Field::Places, 1.0 / (MU0 * MU0)),
            (Field::Face, 1.0 / (MU0 * MU0)),
            (Field::Light, about_light),
            (Field::Dip, dip),
        ] {
            let blur = field.ball(r).unwrap().mean - 1.0;
            assert!((blur / (bend * r * r / 10.0) - 1.0).abs() < 0.01, "{field:?}: {blur}");
        }
    }
}
