//! Lights that subpaths start from, those that come from a surface, a point or a direction; and their techniques' shares.
//!
//! What fills a volume, or comes from all sides, is met by the eye's subpath, which collects it along whole rays: chance alone finds
//! it with little variance, or a direction that is chosen for it.

use super::vertex::Vertex;
use super::weights::Ways;
use crate::Spectrum;
use crate::faults::{Fault, planted};
use crate::light::{Light, LightSample};
use crate::math::Ray;
use crate::photons::from_light;
use crate::rng::Stream;
use crate::scene::Scene;
use crate::transport::Walker;
use glam::DVec3;

/// What arrives from a light along a direction, but for what is lost on the way.
#[derive(Debug, Clone, Copy)]
pub(super) struct Arriving {
    /// Radiance, or irradiance of a delta light, summed over channels.
    pub light: f64,
    /// Density of next-event estimation [1/sr]; 1 of a delta light.
    pub pdf: f64,
    /// How far the light is \[L\].
    pub distance: f64,
    /// Whether rays meet it.
    pub is_met: bool,
}

impl Arriving {
    /// From a light that rays meet, of this radiance.
    pub fn met(radiance: Spectrum, pdf: f64, distance: f64) -> Self {
        Arriving { light: radiance.sum(), pdf, distance, is_met: true }
    }

    /// From a sample of next-event estimation.
    pub fn aimed(sample: &LightSample) -> Self {
        let (pdf, is_met) = (sample.pdf_solid_angle.unwrap_or(1.0), sample.pdf_solid_angle.is_some());
        Arriving { light: sample.value.sum() * pdf, pdf, distance: sample.distance, is_met }
    }
}

/// The lights of a scene that subpaths start from.
pub(super) struct Sources<'a> {
    scene: &'a Scene,
    /// Their numbers, and sums over channels of their power up to each of them \[W\].
    lights: Vec<(usize, f64)>,
}

impl<'a> Sources<'a> {
    pub fn new(scene: &'a Scene) -> Self {
        let (mut lights, mut power) = (Vec::new(), 0.0);
        for (index, light) in scene.lights().iter().enumerate().filter(|(_, light)| !light.fills_space()) {
            power += light.power(scene.periodic_cell()).sum();
            lights.push((index, power));
        }
        Sources { scene, lights }
    }

    /// Power of all of them, summed over channels \[W\].
    pub fn power(&self) -> f64 {
        self.lights.last().map_or(0.0, |(_, power)| *power)
    }

    /// The numbers of the lights.
    pub fn numbers(&self) -> impl Iterator<Item = usize> + '_ {
        self.lights.iter().map(|(index, _)| *index)
    }

    /// A photon of all of them, chosen in proportion to power, and the number of its light.
    pub fn start(&self, stream: &mut Stream) -> Option<(usize, Walker)> {
        let target = if self.lights.len() > 1 { stream.unit() * self.power() } else { 0.0 };
        let chosen =
            self.lights.partition_point(|(_, sum)| *sum <= target).min(self.lights.len().checked_sub(1)?);
        let (index, sum) = self.lights[chosen];
        let own = sum - chosen.checked_sub(1).map_or(0.0, |before| self.lights[before].1);
        let walker = from_light(self.scene, index, stream)?;
        Some((index, Walker { weight: walker.weight * (self.power() / own), ..walker }))
    }

    /// What arrives at a place from a direction of one of them; none where it sends nothing.
    pub fn arriving(&self, index: usize, place: DVec3, dir: DVec3) -> Option<Arriving> {
        let light = &self.scene.lights()[index];
        let ray = Ray::new(place, dir);
        if light.is_delta() {
            return light.sample(place, [0.5; 2]).map(|sample| Arriving::aimed(&sample));
        }
        let (radiance, pdf, distance) = match light.background(&ray) {
            Some((radiance, pdf)) => (radiance, pdf, f64::INFINITY),
            None => {
                let hit = light.hit(&ray, None)?;
                let (radiance, pdf) = light.emitted(&ray, &hit);
                (radiance, pdf, hit.t)
            }
        };
        (pdf > 0.0).then(|| Arriving::met(radiance, pdf, distance))
    }

    /// Density of the photons that bring this light to a vertex along `dir`.
    fn pdf(&self, vertex: &Vertex, dir: DVec3, light: f64) -> f64 {
        vertex.met(dir) * light / self.power()
    }

    /// The ways of the first vertex of a subpath that left a light along `start`, and arrived straight or by specular surfaces.
    pub fn ways(&self, index: usize, start: &Walker, vertex: &Vertex, is_direct: bool) -> Ways {
        let nobody = Ways { pdf: 1.0, connected: 0.0, beyond: 0.0 };
        if is_direct {
            let Some(arriving) = self.arriving(index, vertex.position, -vertex.from) else { return nobody };
            let passes = vertex.passes(self.scene, -vertex.from, arriving.distance);
            let beyond = if arriving.is_met { passes } else { 0.0 };
            let pdf = self.pdf(vertex, vertex.from, arriving.light) * passes;
            let connected = if planted(Fault::NextEventForgotten) { 0.0 } else { arriving.pdf };
            return Ways { pdf, connected, beyond };
        }
        let light = &self.scene.lights()[index];
        let radiance = match light {
            Light::Area(area) => area.radiance().sum(),
            _ => match light.background(&Ray::new(start.ray.origin, -start.ray.dir)) {
                Some((radiance, _)) => radiance.sum(),
                None => return nobody,
            },
        };
        let is_scaled = !planted(Fault::LightIndexForgotten);
        let scale = if is_scaled { self.scale(vertex.interior, start.interior) } else { 1.0 };
        Ways { pdf: self.pdf(vertex, vertex.from, radiance * scale), connected: 0.0, beyond: 1.0 }
    }

    /// Shares of the balance heuristic that the two techniques without a subpath of light have in what arrives at the last vertex of the
    /// eye's: by meeting the light, and by next-event estimation.
    ///
    /// # Arguments
    /// `dir` in which the eye's subpath leaves; `scale` none where nothing specular lies between, else [`Sources::scale`]
    pub fn shares(&self, vertex: &Vertex, dir: DVec3, arriving: &Arriving, scale: Option<f64>) -> [f64; 2] {
        let (passes, aimed, scale) = match scale {
            None => (vertex.passes(self.scene, dir, arriving.distance), arriving.pdf, 1.0),
            Some(scale) => (1.0, 0.0, scale),
        };
        let met = if arriving.is_met { vertex.pdf(dir) * passes } else { 0.0 };
        let joined = self.pdf(vertex, dir, arriving.light * passes * scale);
        let all = met + aimed + vertex.ways.others(joined, vertex.turned(dir));
        [met / all, aimed / all]
    }

    /// What radiance is multiplied by on its way from an interior to another: the squared ratio of their indices.
    pub fn scale(&self, to: usize, from: usize) -> f64 {
        let [to, from] = [to, from].map(|interior| self.scene.interiors()[interior].index);
        to * to / (from * from)
    }
}
