//! Radiance that leaves a matt surface towards the eye.

use super::{Eye, Gathers, Mapper};
use crate::Spectrum;
use crate::estimators::{Gather, Kernel, irradiance};
use crate::math::Ray;
use crate::photons::PhotonMap;
use crate::photons::maps::Indirect;
use crate::photons::tree::Tangent;
use crate::rng::Stream;
use crate::scene::{SceneHit, Target};
use crate::surface::{Lambertian, Surface};
use crate::transport::{Walker, transmittance};
use glam::DVec3;
use std::f64::consts::PI;

/// Photons of a flat surface lie on it, so that few of another one that meets it need be let in.
const FLAT: f64 = 0.1;

/// A point of a matt surface that light leaves towards a walker.
#[derive(Clone, Copy)]
pub(super) struct Matt<'w> {
    /// Who looks, or gathers: on the interior's side.
    pub walker: &'w Walker,
    /// What it met.
    pub found: &'w SceneHit,
    /// Where \[L\].
    pub position: DVec3,
    /// Unit normal on the side of the walker.
    pub normal: DVec3,
    /// Fraction of the irradiance that is reflected, on all directions together.
    pub reflectance: Spectrum,
}

impl<'w> Matt<'w> {
    /// The point that a ray met, if its surface is matt.
    pub fn met(mapper: &Mapper, walker: &'w Walker, found: &'w SceneHit) -> Option<Self> {
        let Target::Object(index) = found.target else { return None };
        let Surface::Lambertian(surface) = &mapper.scene.objects()[index].surface else { return None };
        let (position, outward) = (walker.ray.at(found.hit.t), found.hit.normal);
        let normal = if walker.ray.dir.dot(outward) < 0.0 { outward } else { -outward };
        Some(Matt {
            walker,
            found,
            position,
            normal,
            reflectance: surface.reflectance(position, found.hit.uv),
        })
    }

    /// A ray that starts here, in the interior of the one that came.
    pub fn leaving(&self, dir: DVec3) -> Walker {
        let start = Walker::new(Ray::new(self.position, dir), Spectrum::ONE);
        Walker { from: Some(self.found.start()), within: self.walker.within, ..start }
    }

    /// Irradiance from a map [W/L^2].
    pub fn irradiance(
        &self,
        mapper: &Mapper,
        map: &PhotonMap,
        (kernel, gather): (Kernel, Gather),
        count: &mut Gathers,
    ) -> Spectrum {
        let (normal, slope) = (self.normal, mapper.settings.slope);
        let flats = mapper.flats.as_ref().filter(|flats| flats.is_flat(self.found));
        let slope = if flats.is_some() { FLAT * slope } else { slope };
        let estimate = irradiance(map, self.position, &Tangent { normal, slope }, kernel, gather);
        count.add(&estimate);
        match flats {
            Some(flats) => {
                estimate.value / flats.share(self.found, normal, self.position, kernel, estimate.radius)
            }
            None => estimate.value,
        }
    }

    /// Irradiance straight from lights [W/L^2].
    pub fn direct(&self, mapper: &Mapper, report: &mut super::Report, stream: &mut Stream) -> Spectrum {
        let here = self.leaving(self.normal);
        let cosine = |towards: DVec3| towards.dot(self.normal).max(0.0);
        // Density cos/pi: the irradiance along a sampled direction is pi times the radiance.
        let mapped = |towards: DVec3| cosine(towards) / PI;
        mapper.direct(&here, here.from, report, stream, mapped, |stream| {
            Lambertian::scatter(self.normal, stream.pair()).0
        }) * PI
    }
}

impl Eye<'_, '_> {
    /// What a body reflects towards the eye, if it is matt.
    pub(super) fn surface(&mut self, walker: &Walker, found: &SceneHit, stream: &mut Stream) {
        let mapper = self.mapper;
        let (maps, settings) = (mapper.maps, mapper.settings);
        let Some(matt) = Matt::met(mapper, walker, found) else { return };
        if matt.reflectance.is_black() {
            return;
        }
        let passed = transmittance(mapper.scene, &walker.ray, found.hit.t, walker.within, stream);
        let seen = walker.weight * passed * matt.reflectance / PI;
        self.layers.direct += seen * matt.direct(mapper, &mut self.report, stream);
        if let Some(map) = &maps.caustic {
            self.layers.caustic +=
                seen * matt.irradiance(mapper, map, settings.caustic, &mut self.report.caustic);
        }
        let Some(global) = &maps.global else { return };
        let rest = match maps.indirect {
            Indirect::Seen => matt.irradiance(mapper, global, settings.global, &mut self.report.global),
            Indirect::Gathered => mapper.gathered(&matt, settings.gather_rays, &mut self.report, stream),
        };
        self.layers.indirect += seen * rest;
    }
}
