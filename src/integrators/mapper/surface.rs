//! Radiance that leaves a diffuse surface towards the eye.

use super::{Eye, Gathers, Mapper};
use crate::Spectrum;
use crate::estimators::{Estimate, Gather, Kernel, irradiance, irradiance_seen};
use crate::geometry::Normals;
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

/// How many radii are tried, each a quarter of the one before, where too little of the disc lies on a surface: thin rods.
const SMALLER: u32 = 4;

/// Where a curved body's accepted surface ends before k photons are found, all n that are found take the place of k: the farthest
/// tells how far the surface reaches. Of n in an area the estimate stays unbiased, and 1/(n (n-2)) is added to its relative
/// variance: less than what lines over a larger disc would add, 1/32, from here on.
const TELLING: usize = 7;

/// A point of a diffuse surface that light leaves towards a walker.
#[derive(Clone, Copy)]
pub(super) struct Diffuse<'w> {
    /// Who looks, or gathers: on the interior's side.
    pub walker: &'w Walker,
    /// What it met.
    pub found: &'w SceneHit,
    /// Where \[L\].
    pub position: DVec3,
    /// Unit normals on the side of the walker: the photons' disc lies across the geometric one.
    pub normals: Normals,
    /// Fraction of the irradiance that is reflected, on all directions together.
    pub reflectance: Spectrum,
}

impl<'w> Diffuse<'w> {
    /// The point that a ray met, if its surface is diffuse.
    pub fn met(mapper: &Mapper, walker: &'w Walker, found: &'w SceneHit) -> Option<Self> {
        let Target::Object(index) = found.target else { return None };
        let Surface::Lambertian(surface) = &mapper.scene.objects()[index].surface else { return None };
        let position = walker.ray.at(found.hit.t);
        Some(Diffuse {
            walker,
            found,
            position,
            normals: found.hit.normals(walker.ray.dir),
            reflectance: surface.reflectance(position, found.hit.uv),
        })
    }

    /// A ray that starts here, in the interior of the one that came.
    pub fn leaving(&self, dir: DVec3) -> Walker {
        let start = Walker::new(Ray::new(self.position, dir), Spectrum::ONE);
        Walker { origin_surface: Some(self.found.start()), interior: self.walker.interior, ..start }
    }

    /// Irradiance from a map [W/L^2].
    pub fn irradiance(
        &self,
        mapper: &Mapper,
        map: &PhotonMap,
        (kernel, gather): (Kernel, Gather),
        count: &mut Gathers,
        stream: &Stream,
    ) -> Spectrum {
        let slope = mapper.settings.slope;
        let place = mapper.bodies.as_ref();
        let Some(place) =
            place.and_then(|b| b.place(self.found, self.position, self.normals.geometric, slope))
        else {
            let tangent = Tangent { normal: self.normals.geometric, slope, turn: 2.0 * slope };
            let estimate = irradiance(map, self.position, &tangent, kernel, gather);
            count.add(&estimate, 2);
            return estimate.value;
        };
        // The lines that look for covered surface use up no numbers of the path.
        let mut lines = stream.clone();
        let mut gather = gather.within(place.reach());
        let mut attempt = 1;
        let (estimate, part) = loop {
            let mut estimate = irradiance(map, self.position, &place.tangent, kernel, gather);
            if estimate.underfull && estimate.found >= TELLING && !place.has_reach() {
                gather = gather.with_k(estimate.found).within(estimate.radius);
                let nearer = irradiance(map, self.position, &place.tangent, kernel, gather);
                estimate = Estimate { underfull: true, ..nearer };
            }
            if estimate.found == 0 {
                count.add(&estimate, 2);
                return estimate.value;
            }
            let part = place.part(kernel, estimate.radius, &mut lines);
            if part.is_known || attempt == SMALLER {
                break (estimate, part);
            }
            attempt += 1;
            gather = gather.within(0.25 * estimate.radius);
        };
        count.add(&estimate, 2);
        if part.share == 0.0 {
            count.unknown += 1;
            return Spectrum::ZERO;
        }
        match part.hiding {
            None => estimate.value / part.share,
            Some(hiding) => {
                let is_seen = |photon| place.sees(photon, &hiding);
                irradiance_seen(map, self.position, &place.tangent, kernel, gather, is_seen).value
                    / part.share
            }
        }
    }

    /// Irradiance straight from lights [W/L^2].
    pub fn direct(&self, mapper: &Mapper, report: &mut super::Report, stream: &mut Stream) -> Spectrum {
        let here = self.leaving(self.normals.geometric);
        // Density cos/pi: the irradiance along a sampled direction is pi times the radiance.
        let mapped = |towards: DVec3| self.normals.cosine(towards) / PI;
        mapper.direct(&here, here.origin_surface, report, stream, mapped, |stream| {
            let dir = Lambertian::scatter(self.normals.shading, stream.pair()).0;
            self.normals.leaves(dir).then_some(dir)
        }) * PI
    }
}

impl Eye<'_, '_> {
    /// What a body reflects towards the eye, if it is diffuse.
    pub(super) fn surface(&mut self, walker: &Walker, found: &SceneHit, stream: &mut Stream) {
        let mapper = self.mapper;
        let (maps, settings) = (mapper.maps, mapper.settings);
        let Some(diffuse) = Diffuse::met(mapper, walker, found) else { return };
        if diffuse.reflectance.is_black() {
            return;
        }
        let transmitted = transmittance(mapper.scene, &walker.ray, found.hit.t, walker.interior, stream);
        let seen = walker.weight * transmitted * diffuse.reflectance / PI;
        self.layers.direct += seen * diffuse.direct(mapper, &mut self.report, stream);
        if let Some(map) = &maps.caustic {
            self.layers.caustic +=
                seen * diffuse.irradiance(mapper, map, settings.caustic, &mut self.report.caustic, stream);
        }
        let Some(global) = &maps.global else { return };
        let rest = match maps.indirect {
            Indirect::Seen => {
                diffuse.irradiance(mapper, global, settings.global, &mut self.report.global, stream)
            }
            Indirect::Gathered => mapper.gathered(&diffuse, settings.gather_rays, &mut self.report, stream),
        };
        self.layers.indirect += seen * rest;
    }
}
