//! What a scene requires of the simulator: computed from the scene, printed by `turbid check`, and obeyed.

use super::{Object, SceneParts};
use crate::faults::{Fault, planted};
use crate::light::Light;
use crate::medium::Medium;
use crate::surface::Surface;

/// What a scene requires; what it does not require costs nothing.
#[derive(Debug, Clone, PartialEq)]
pub struct Plan {
    /// Whether light can collide at all.
    pub has_media: bool,
    /// Whether every medium has the same extinction in all channels, so that one flight serves all.
    pub has_grey_extinction: bool,
    /// Whether the density of some medium varies, so that flights and transmittances are tracked.
    pub has_heterogeneous: bool,
    /// Whether some medium emits by itself.
    pub has_emission: bool,
    /// What each varying density is, in words.
    pub densities: Vec<String>,
    /// Whether every number is the same in all channels, so that one channel is reported.
    pub is_grey: bool,
    /// Whether light can meet a surface.
    pub has_surfaces: bool,
    /// Whether light can meet a specular surface.
    pub has_specular: bool,
    /// Whether there are boundaries of interiors.
    pub has_dielectrics: bool,
    /// Whether light can meet a boundary between interiors of different indices.
    pub has_refraction: bool,
    /// Whether light can meet a boundary between interiors of the same index, which it passes as though there were none.
    pub has_matched: bool,
    /// Whether light can meet a filter.
    pub has_filters: bool,
    /// Whether some light has a direction to aim at.
    pub has_next_event: bool,
    /// Indices of lights for which a distance is sampled on every ray: in one point (point and spot), and bounded beams.
    pub distance_lights: Vec<usize>,
    /// Whether the first collision is forced: the media are so thin that free flights would rarely meet them.
    pub forces_first_collision: bool,
    /// Path classes that the path tracer cannot sample, in words; photons reach them all.
    pub unreachable: Vec<String>,
    /// Whether nothing is left out, required or not: see [`Scene::with_full_plan`](super::Scene::with_full_plan).
    pub is_full: bool,
}

/// Below this optical thickness fewer than one free flight in ten collides, and forcing pays.
const THIN: f64 = 0.1;

impl Plan {
    pub(super) fn of(parts: &SceneParts) -> Self {
        let filled = parts.interiors.iter().filter_map(|i| i.medium.as_ref());
        let media: Vec<&Medium> = parts.regions.iter().map(|r| &r.medium).chain(filled).collect();
        let has_media = media.iter().any(|m| m.is_colliding());
        let has_heterogeneous = media.iter().any(|m| !m.is_homogeneous());
        let regions = || parts.regions.iter().filter(|r| r.medium.is_colliding());
        let thickness = regions().map(|r| r.shape.shortest_extent() * r.medium.highest_sigma_t().max());
        let thickest = thickness.fold(0.0, f64::max);
        let has_specular = parts.objects.iter().any(|o| o.surface.is_specular());
        let has_delta = parts.lights.iter().any(Light::is_delta);
        let has_event =
            has_media || parts.objects.iter().any(|o| o.surface.is_event() && !o.surface.is_specular());
        let mut unreachable = Vec::new();
        let has_boundary = |matched: bool| {
            let is_one =
                |o: &Object| matches!(&o.surface, Surface::Dielectric(d) if d.is_matched() == matched);
            parts.objects.iter().any(is_one)
        };
        if has_specular && has_delta {
            if has_event {
                unreachable.push(
                    "L S+ (D|M) ... : from a beam, a sun without disc, a point or spot light by mirrors or glass to the first scattering".into(),
                );
            }
            unreachable.push(
                "L S+ E : from a beam, a sun without disc, a point or spot light by mirrors or glass to the sensor"
                    .into(),
            );
        }
        Plan {
            has_media,
            has_grey_extinction: media
                .iter()
                .take(if planted(Fault::FillingColorIgnored) { parts.regions.len() } else { usize::MAX })
                .all(|m| m.has_grey_extinction()),
            has_heterogeneous,
            has_emission: media.iter().any(|m| m.is_emitting()),
            densities: media.iter().filter_map(|m| m.density()).map(|d| d.describe()).collect(),
            is_grey: media.iter().all(|m| m.is_grey())
                && parts.objects.iter().all(|o| o.surface.is_grey())
                && (planted(Fault::LightColorIgnored) || parts.lights.iter().all(Light::is_grey)),
            has_surfaces: !parts.objects.is_empty(),
            has_specular,
            has_dielectrics: has_boundary(false) || has_boundary(true),
            has_refraction: has_boundary(false),
            has_matched: has_boundary(true),
            has_filters: parts.objects.iter().any(|o| matches!(o.surface, Surface::Filter(_))),
            has_next_event: parts.lights.iter().any(Light::has_direction),
            distance_lights: (0..parts.lights.len())
                .filter(|&i| parts.lights[i].apex().is_some() || parts.lights[i].is_shaft())
                .collect(),
            forces_first_collision: regions().next().is_some() && thickest < THIN && !has_heterogeneous,
            unreachable,
            is_full: false,
        }
    }

    /// The same with nothing left out; all media are heterogeneous. What is true of the scene and saves nothing stays.
    pub(super) fn full(&self) -> Self {
        Plan {
            has_media: true,
            has_grey_extinction: false,
            has_heterogeneous: true,
            has_emission: true,
            has_specular: true,
            has_dielectrics: true,
            has_refraction: true,
            has_matched: true,
            has_filters: true,
            has_next_event: true,
            forces_first_collision: false,
            is_full: true,
            ..self.clone()
        }
    }

    /// The plan in words, one line each.
    pub fn lines(&self) -> Vec<String> {
        let mut lines = vec![
            match (self.has_media, self.forces_first_collision) {
                (true, _) if self.has_heterogeneous => {
                    "heterogeneous media: delta tracking, ratio tracking, majorants by cell".to_string()
                }
                (false, _) => "no medium: no flights, no volume map".to_string(),
                (true, false) => "homogeneous media: flights and transmittance in closed form".to_string(),
                (true, true) => "thin homogeneous media: closed form, first collision forced".to_string(),
            },
            if self.is_grey { "grey: one channel reported" } else { "in colour: three channels reported" }
                .to_string(),
        ];
        if !self.has_grey_extinction {
            lines.push("extinction differs by channel: flights by channel, balance weights".to_string());
        }
        lines.extend(self.densities.iter().map(|density| format!("density: {density}")));
        if self.has_emission {
            lines.push("emitting media: seen along rays; photons start in them as from lights".to_string());
        }
        lines.push(match (self.has_surfaces, self.has_specular) {
            (false, _) => "no surface: nothing to intersect but media and lights".to_string(),
            (true, false) => "diffuse or black surfaces: no caustic, no mirror paths".to_string(),
            (true, true) => "mirrors or glass: specular paths".to_string(),
        });
        if self.has_refraction {
            lines.push("dielectric boundaries: Fresnel reflection, refraction, interiors".to_string());
        }
        if self.has_matched {
            lines.push(
                "index-matched boundaries: interiors, but no events, and shadow rays pass them".to_string(),
            );
        }
        if self.has_filters {
            lines.push("filters: shadow rays pass them, body after body".to_string());
        }
        if !self.has_next_event && !self.has_emission {
            lines.push("no light to aim at: no next-event estimation".to_string());
        }
        if !self.distance_lights.is_empty() {
            lines.push(
                "point lights and beams: equiangular sampling, or even sampling within the beam, in multiple importance with \
                 free flight"
                    .to_string(),
            );
        }
        lines
    }
}
