//! What becomes of a walker at a body.

use super::visitor::{Arrival, Step, Visitor, Walker};
use super::{Flags, Roulette};
use crate::faults::{Fault, planted};
use crate::math::Ray;
use crate::rng::Stream;
use crate::scene::{Scene, SceneHit, Target};
use crate::surface::{Dielectric, Filter, Surface, fresnel, refract};
use glam::DVec3;

/// Total reflections without a chance to leave after which light counts as caught: a cube of glass keeps some of the light
/// that starts inside for ever. Only a body that nothing fills can keep it so long, and it keeps it without loss, mirrors
/// on it or in it too: what is truncated would have come out of a round body never, and out of any other long before.
const CAUGHT: u32 = 10_000;

/// Whether a ray whose order may not grow is followed beyond a body.
pub(super) fn is_looked_through(scene: &Scene, found: &SceneHit) -> bool {
    matches!(found.target, Target::Object(index)
        if matches!(scene.objects()[index].surface, Surface::Mirror(_) | Surface::Dielectric(_) | Surface::Filter(_)))
}

/// The walker after a body, or none if it ends there.
pub(super) fn bounce<V: Visitor>(
    scene: &Scene,
    walker: &Walker,
    found: &SceneHit,
    roulette: Roulette,
    stream: &mut Stream,
    visitor: &mut V,
) -> Option<Walker> {
    let position = walker.ray.at(found.hit.t);
    let arrival = Arrival { walker, position };
    let Target::Object(index) = found.target else {
        visitor.visit(walker, Step::Surface(arrival, found), stream);
        visitor.visit(walker, Step::Absorbed(walker.weight, None), stream);
        return None;
    };
    let surface = &scene.objects()[index].surface;
    if let Surface::Filter(filter) = surface {
        return pass(walker, found, filter, roulette, stream, visitor);
    }
    if let Surface::Dielectric(dielectric) = surface
        && dielectric.is_matched()
    {
        let (_, interior) = dielectric.sides(walker.ray.dir, found.hit.normal);
        return Some(Walker { interior, ..straight_on(walker, found, position) });
    }
    visitor.visit(walker, Step::Surface(arrival, found), stream);
    if let Surface::Dielectric(dielectric) = surface {
        return cross(scene, (walker, position), found, dielectric, stream, visitor);
    }
    let dir = walker.ray.dir;
    let normal = facing(dir, found.hit.normal);
    let reflectance = surface.reflectance(position, found.hit.uv);
    let survivor = roulette.survive(walker.weight, reflectance, stream);
    let next = survivor.zip(surface.scatter(dir, normal, stream.pair())).map(|(weight, (dir, pdf))| Walker {
        ray: Ray::new(position, dir),
        weight,
        order: walker.order + u32::from(pdf.is_some()),
        flags: walker.flags.with(if pdf.is_some() { Flags::DIFFUSE } else { Flags::SPECULAR }),
        origin_surface: Some(found.start()),
        interior: walker.interior,
        sampled_at: position,
        events: walker.events,
        // A mirror is no way out.
        total_reflections: if pdf.is_some() { 0 } else { walker.total_reflections },
        pdf_solid_angle: pdf,
    });
    if next.is_none() {
        let lost = Roulette::lost(walker.weight, reflectance);
        visitor.visit(walker, Step::Absorbed(lost, None), stream);
    }
    next
}

/// The normal on the side that a ray comes from.
fn facing(dir: DVec3, outward: DVec3) -> DVec3 {
    if dir.dot(outward) < 0.0 { outward } else { -outward }
}

/// Straight on behind a filter: no event, so that order, flags and density stay.
fn pass<V: Visitor>(
    walker: &Walker,
    found: &SceneHit,
    filter: &Filter,
    roulette: Roulette,
    stream: &mut Stream,
    visitor: &mut V,
) -> Option<Walker> {
    let position = walker.ray.at(found.hit.t);
    let transmittance = filter.transmittance(position, found.hit.uv);
    let Some(weight) = roulette.survive(walker.weight, transmittance, stream) else {
        let lost = Roulette::lost(walker.weight, transmittance);
        visitor.visit(walker, Step::Absorbed(lost, None), stream);
        return None;
    };
    Some(Walker { weight, ..straight_on(walker, found, position) })
}

/// The walker behind a body that is no event, on the same way.
fn straight_on(walker: &Walker, found: &SceneHit, position: DVec3) -> Walker {
    Walker { ray: Ray::new(position, walker.ray.dir), origin_surface: Some(found.start()), ..*walker }
}

/// Reflected or refracted, in proportion: the weight stays, but for the scale of radiance behind a refraction.
///
/// The ratio of radiance to the squared index is the same on both sides, so that what a path finds behind the boundary
/// counts (n_near/n_far)^2; a photon carries its power as it is. Which side the ray comes from, the boundary says.
fn cross<V: Visitor>(
    scene: &Scene,
    (walker, position): (&Walker, DVec3),
    found: &SceneHit,
    dielectric: &Dielectric,
    stream: &mut Stream,
    visitor: &mut V,
) -> Option<Walker> {
    let dir = walker.ray.dir;
    let normal = facing(dir, found.hit.normal);
    let (near, far) = dielectric.sides(dir, found.hit.normal);
    let (n_near, n_far) = (scene.interiors()[near].index, scene.interiors()[far].index);
    let cosine = (-dir.dot(normal)).clamp(0.0, 1.0);
    let mut refraction = fresnel(n_near, n_far, cosine);
    if planted(Fault::FresnelForgotten) && refraction.reflectance < 1.0 {
        refraction.reflectance = 0.0;
    }
    let is_total = refraction.reflectance >= 1.0;
    if is_total && walker.total_reflections >= CAUGHT {
        visitor.visit(walker, Step::Truncated(walker.weight), stream);
        return None;
    }
    let next = Walker {
        flags: walker.flags.with(Flags::SPECULAR),
        origin_surface: Some(found.start()),
        sampled_at: position,
        total_reflections: if is_total { walker.total_reflections + 1 } else { 0 },
        pdf_solid_angle: None,
        ..*walker
    };
    if is_total || stream.unit() < refraction.reflectance {
        let dir = (dir + normal * (2.0 * cosine)).normalize();
        return Some(Walker { ray: Ray::new(position, dir), interior: near, ..next });
    }
    let ratio = n_near / n_far;
    let is_scaled =
        (V::CARRIES_RADIANCE && !planted(Fault::RadianceUnscaled)) || planted(Fault::PhotonPowerScaled);
    let weight = if is_scaled { walker.weight * (ratio * ratio) } else { walker.weight };
    let dir = refract(dir, normal, ratio, (cosine, refraction.cos_far));
    Some(Walker { ray: Ray::new(position, dir), weight, interior: far, ..next })
}
