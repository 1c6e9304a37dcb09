//! Directions towards media that emit.
//!
//! All of them are aimed at as one: a medium is chosen by what it may bring, then a place in it, as for its photons, and
//! along the direction to that place the light of all media is collected. No square of a distance divides what is found.

use crate::light::{Light, MediumEmission};
use crate::math::Ray;
use crate::rng::Stream;
use crate::scene::Scene;
use glam::DVec3;

fn emitters(scene: &Scene) -> impl Iterator<Item = &MediumEmission> {
    // Those that were named are other lights.
    scene.lights()[scene.named_lights().len()..].iter().filter_map(|light| match light {
        Light::MediumEmission(emission) => Some(emission),
        _ => None,
    })
}

/// Whether there are directions from `p` towards a medium that emits.
pub fn has_direction(scene: &Scene) -> bool {
    scene.plan().has_emission && emitters(scene).any(MediumEmission::has_direction)
}

/// Density with which [`sample`] chooses the direction of a ray [1/sr]; 0 where nothing can be chosen.
pub fn pdf_solid_angle(scene: &Scene, ray: &Ray) -> f64 {
    let (mut sum, mut all) = (0.0, 0.0);
    for emission in emitters(scene) {
        let brightness = emission.brightness_at(ray.origin);
        if brightness > 0.0 {
            sum += brightness * emission.pdf_solid_angle(ray);
            all += brightness;
        }
    }
    if all > 0.0 { sum / all } else { 0.0 }
}

/// A direction from `p` towards a medium that emits, and its density [1/sr]; none where none can be chosen.
pub fn sample(scene: &Scene, p: DVec3, stream: &mut Stream) -> Option<(DVec3, f64)> {
    let all: f64 = emitters(scene).map(|emission| emission.brightness_at(p)).sum();
    if all <= 0.0 {
        return None;
    }
    let mut target = stream.unit() * all;
    let chosen = emitters(scene).filter(|emission| emission.brightness_at(p) > 0.0).find(|emission| {
        target -= emission.brightness_at(p);
        target < 0.0
    });
    let dir = chosen?.sample(p, stream.triple())?;
    let pdf = pdf_solid_angle(scene, &Ray::new(p, dir));
    (pdf > 0.0).then_some((dir, pdf))
}
