//! What theory says: the exact mean of the field over the treated ball of each fixed radius, in one slab or ball.

use super::asked::{OwnStudy, asked};
use super::place::Place;
use super::points::Point;
use super::reference::Reference;
use super::solved::Solved;
use super::words;
use crate::harness::Settings;
use crate::prediction::Prediction;
use crate::setups::Body;
use crate::theory::{Table, referee_kernel};
use glam::DVec3;
use turbid::estimators::boundary::{Rejection, Treatment};
use turbid::estimators::{Estimator, Gather};
use turbid::scene::{Quantity, Scene};
use turbid_analytic::boundary::{self as referee, treated_mean_symmetric};

/// Most means that are computed; what is beyond is not predicted.
const MOST: usize = 4000;

/// Predicts what can be.
pub fn predict(settings: &Settings) -> anyhow::Result<Vec<Prediction>> {
    let study = asked(settings)?;
    let mut all = Vec::new();
    let mut left = MOST;
    for (point, reference) in study.points.iter().zip(&study.references) {
        all.extend(of_point(&study, point, reference, &mut left)?);
    }
    Ok(all)
}

fn of_point(
    study: &OwnStudy,
    point: &Point,
    reference: &Reference,
    left: &mut usize,
) -> anyhow::Result<Vec<Prediction>> {
    let Some(solved) = &reference.solved else { return Ok(Vec::new()) };
    let mut all = Vec::new();
    let channels = if point.scene.plan().is_grey { 1 } else { 3 };
    for channel in 0..channels {
        let Some(field) = InBody::new(solved, point, channel)? else { continue };
        for estimator in point.estimators.iter().filter(|e| words::is_fixed(e)) {
            for place in point.places.iter().filter(|place| place.channel == channel) {
                if *left == 0 {
                    return Ok(all);
                }
                let Some(mean) = field.mean(&point.scene, place, estimator) else { continue };
                *left -= 1;
                for &photons in &study.photons {
                    let case = words::case(point, photons, estimator);
                    let source = "mean of the exact field over the treated ball";
                    all.push(Prediction::new(case, place.name.as_str(), place.unit, mean, source));
                }
            }
        }
    }
    Ok(all)
}

/// A body whose light depends on one coordinate, and its field in a table.
struct InBody {
    body: Body,
    origin: DVec3,
    sigma_t: f64,
    /// Against the depth below the face or surface \[mfp\].
    fluence: Table,
}

impl InBody {
    fn new(solved: &Solved, point: &Point, channel: usize) -> anyhow::Result<Option<Self>> {
        let Some((body, origin, sigma_t)) = solved.body(point, channel) else { return Ok(None) };
        let Some(field) = solved.quick_fluence(point, channel) else { return Ok(None) };
        // The light of a point at the centre has no table.
        if !field(body.deepest()).is_finite() {
            return Ok(None);
        }
        let fluence = Table::of_fluence(body.deepest(), |depth| Ok(field(depth)))?;
        Ok(Some(InBody { body, origin, sigma_t, fluence }))
    }

    /// What the ball of an estimator at a place is expected to give, and its bound.
    fn mean(&self, scene: &Scene, place: &Place, estimator: &Estimator) -> Option<(f64, f64)> {
        let sensor = &scene.sensors()[place.sensor];
        let (Quantity::Fluence(p), Gather::Radius(radius)) = (&sensor.quantity, estimator.gather) else {
            return None;
        };
        // Beams about a place are not in its ball.
        if estimator.rejection != Rejection::Off
            || estimator.has_beam_fluence
            || sensor.orders != turbid::scene::Orders::ALL
        {
            return None;
        }
        let treatment = match estimator.treatment {
            Treatment::None => referee::Treatment::None,
            Treatment::Clipped => referee::Treatment::Clipped,
            Treatment::Reflection => referee::Treatment::Reflection,
            Treatment::LocalLinear => referee::Treatment::LocalLinear,
        };
        let r = self.sigma_t * radius.get();
        let deepest = self.body.deepest();
        let (at, field): ([f64; 3], Box<dyn Fn(f64) -> f64 + '_>) = match self.body {
            Body::Sphere { radius } => {
                let away = self.sigma_t * p.distance(self.origin);
                ([0.0, 0.0, away], Box::new(move |x| self.fluence.at((radius - x).clamp(0.0, radius))))
            }
            Body::Slab { .. } | Body::Cuboid { .. } => {
                let depth = self.sigma_t * (p.z - self.origin.z);
                ([0.0, 0.0, depth], Box::new(move |x| self.fluence.at(x.clamp(0.0, deepest))))
            }
        };
        let kernel = referee_kernel(estimator.kernel);
        let mean = treated_mean_symmetric(treatment, kernel, self.body.referee(), at, r, field).ok()?;
        mean.value.is_finite().then_some((mean.value, mean.error))
    }
}
