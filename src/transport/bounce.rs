//! What becomes of a walker at a body.

use super::visitor::{Arrival, Step, Visitor, Walker};
use super::{Flags, Lobe, Roulette};
use crate::faults::{Fault, planted};
use crate::geometry::Normals;
use crate::math::{Ray, warp};
use crate::rng::Stream;
use crate::scene::{Scene, SceneHit, Target};
use crate::surface::{Dielectric, Filter, Lambertian, Surface, fresnel, refract};
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

/// What a weight is multiplied by where a direction was drawn from a lobe and its own surface or phase function together, and the
/// density of that [1/sr]; no change without a lobe, and 0 where the surface or phase function sends nothing.
#[inline(always)]
pub(super) fn learned(lobe: Option<&Lobe>, dir: DVec3, own: impl FnOnce() -> f64) -> (f64, Option<f64>) {
    let Some(lobe) = lobe else { return (1.0, None) };
    let own = own();
    let mixed = lobe.mixed(dir, own);
    (if own > 0.0 { own / mixed } else { 0.0 }, Some(mixed))
}

/// The walker after a body, or none if it ends there. What changes its weight and is no loss changes the game too: the scale of
/// radiance behind a boundary, which is given back on the way out, and the density of a direction that was learned.
pub(super) fn bounce<V: Visitor>(
    scene: &Scene,
    walker: &Walker,
    found: &SceneHit,
    roulette: &mut Roulette,
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
        return pass(walker, found, filter, *roulette, stream, visitor);
    }
    if let Surface::Dielectric(dielectric) = surface
        && dielectric.is_matched()
    {
        let (_, interior) = dielectric.sides(walker.ray.dir, found.hit.normal);
        return Some(Walker { interior, ..straight_on(walker, found, position) });
    }
    let dir = walker.ray.dir;
    let normals = found.hit.normals(dir);
    let is_diffuse = matches!(surface, Surface::Lambertian(_));
    let factor = if is_diffuse && !V::CARRIES_RADIANCE { normals.arriving(dir) } else { 1.0 };
    if factor == 1.0 {
        visitor.visit(walker, Step::Surface(arrival, found), stream);
    } else {
        // Irradiance about the shading normal is what the photon counts for whoever keeps it.
        let counted = Walker { weight: walker.weight * factor, ..*walker };
        let arrival = Arrival { walker: &counted, position };
        visitor.visit(&counted, Step::Surface(arrival, found), stream);
    }
    if let Surface::Dielectric(dielectric) = surface {
        let next = cross(scene, (walker, position), found, dielectric, stream, visitor)?;
        if next.interior != walker.interior {
            *roulette = roulette.scaled(next.weight.max() / walker.weight.max());
        }
        return Some(next);
    }
    let about = if is_diffuse && !V::CARRIES_RADIANCE { normals.geometric } else { normals.shading };
    let reflectance = surface.reflectance(position, found.hit.uv) * factor;
    let survivor = roulette.survive(walker.weight, reflectance, stream);
    let lobe = if is_diffuse { visitor.lobe_on_surface(position, normals.geometric) } else { None };
    if is_diffuse {
        *roulette = roulette.led(1.0);
    }
    let scattered = match lobe {
        None => survivor.zip(surface.scatter(dir, about, stream.pair())),
        Some(lobe) => survivor.and_then(|weight| {
            let after = lobe.sample(stream, |stream| Lambertian::scatter(about, stream.pair()).0);
            let own = || warp::pdf_cosine_hemisphere(after.dot(about));
            let (factor, mixed) = learned(Some(lobe), after, own);
            *roulette = roulette.led(factor);
            let weight = weight * factor;
            (weight.max() >= f64::MIN_POSITIVE).then_some((weight, (after, mixed)))
        }),
    };
    let leaving = scattered.and_then(|(weight, (after, pdf))| match pdf {
        Some(_) => normals.leaves(after).then_some((weight, after, pdf)),
        None => Some((weight * specular::<V>(&normals, (dir, after), true)?, after, pdf)),
    });
    let next = leaving.map(|(weight, dir, pdf)| Walker {
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

/// What a weight is multiplied by where light is turned from one direction to another by a specular surface; none where that
/// is not on the side of the geometric normal that it is on by the other.
fn specular<V: Visitor>(
    normals: &Normals,
    (before, after): (DVec3, DVec3),
    is_reflected: bool,
) -> Option<f64> {
    if !normals.differ() {
        return Some(1.0);
    }
    let agrees = normals.is_on_side(-before, true) && normals.is_on_side(after, is_reflected);
    agrees.then(|| if V::CARRIES_RADIANCE { 1.0 } else { normals.turned(before, after) })
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
    let normals = found.hit.normals(dir);
    let normal = normals.shading;
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
        let after = (dir + normal * (2.0 * cosine)).normalize();
        let Some(factor) = specular::<V>(&normals, (dir, after), true) else {
            visitor.visit(walker, Step::Absorbed(walker.weight, None), stream);
            return None;
        };
        let weight = walker.weight * factor;
        return Some(Walker { ray: Ray::new(position, after), weight, interior: near, ..next });
    }
    let ratio = n_near / n_far;
    let is_scaled =
        (V::CARRIES_RADIANCE && !planted(Fault::RadianceUnscaled)) || planted(Fault::PhotonPowerScaled);
    let weight = if is_scaled { walker.weight * (ratio * ratio) } else { walker.weight };
    let after = refract(dir, normal, ratio, (cosine, refraction.cos_far));
    let Some(factor) = specular::<V>(&normals, (dir, after), false) else {
        visitor.visit(walker, Step::Absorbed(walker.weight, None), stream);
        return None;
    };
    Some(Walker { ray: Ray::new(position, after), weight: weight * factor, interior: far, ..next })
}
