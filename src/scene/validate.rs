//! Checks on the parts of a scene together. Each part has checked its own numbers when it was made.

use super::{Object, Parts, Quantity, Scene, interiors};
use crate::Spectrum;
use crate::error::{Error, Result};
use crate::geometry::{Face, Shape, Slab};
use crate::light::{Light, Section, Stage};
use crate::medium::Medium;
use crate::surface::Surface;

/// Positions keep a part in 2^53 of the scene's extent: a mean free path must stay well above that step for a
/// flight to be resolved to 1e-6 of itself.
const MAX_EXTENT_OVER_MFP: f64 = 1e9;

fn refuse<T>(text: impl Into<String>) -> Result<T> {
    Err(Error::Scene(text.into()))
}

/// The slab and its cell, if the scene has a cell; an error where parts do not fit together.
pub(super) fn check(parts: &Parts) -> Result<Option<Stage>> {
    if parts.regions.iter().any(|r| !r.shape.is_solid()) {
        return refuse("a medium needs a convex shape with an inside: a sphere, a cuboid or a slab");
    }
    let filled = || parts.interiors.iter().filter_map(|i| i.medium.as_ref());
    if parts.lights.is_empty()
        && !parts.regions.iter().map(|r| &r.medium).chain(filled()).any(Medium::is_emitting)
    {
        return refuse("a scene needs at least one light, or a medium that emits");
    }
    interiors::check(parts)?;
    let stage = stage(parts)?;
    for light in &parts.lights {
        if light.needs_stage() && stage.is_none() {
            return refuse(
                "an unbounded light needs a slab of medium and `cell`, the side of the cell that stands for it",
            );
        }
        if let Light::Beam(beam) = light
            && beam.section() == Section::Unbounded
            && beam.dir().z == 0.0
        {
            return refuse("an unbounded beam must not run along the faces of its slab");
        }
    }
    check_fold(parts, stage.as_ref())?;
    check_apart(parts)?;
    check_end(parts)?;
    for region in &parts.regions {
        let far = extent(&region.shape) * region.medium.highest_sigma_t().max();
        if far > MAX_EXTENT_OVER_MFP {
            return Err(Error::out_of_range(
                "distance from the origin over the mean free path",
                far,
                "at most 1e9",
            ));
        }
    }
    for sensor in &parts.sensors {
        let is_finite = match sensor.quantity {
            Quantity::Fluence(p) => {
                if parts.lights.iter().any(|l| l.apex() == Some(p)) {
                    return refuse(format!(
                        "sensor {} is at a point or spot light, where the fluence is infinite",
                        sensor.name
                    ));
                }
                p.is_finite()
            }
            Quantity::Radiance(ray) => ray.origin.is_finite() && ray.dir.is_finite(),
            Quantity::Outflow { ref shape, .. } => {
                if matches!(shape, Shape::Slab(_)) && stage.is_none() {
                    return refuse(format!("sensor {} is on a slab, so the scene needs `cell`", sensor.name));
                }
                true
            }
            Quantity::Absorbed(region) => {
                let filled = parts.interiors.iter().filter(|i| i.medium.is_some()).count();
                let media = parts.regions.len() + filled;
                if region >= media {
                    return refuse(format!(
                        "sensor {} names region {region}; allowed: 0 to {}",
                        sensor.name,
                        media as i64 - 1
                    ));
                }
                true
            }
        };
        if !is_finite {
            return refuse(format!("sensor {} has a position or direction that is not finite", sensor.name));
        }
    }
    Ok(stage)
}

fn stage(parts: &Parts) -> Result<Option<Stage>> {
    let Some(side) = parts.cell else { return Ok(None) };
    if !(side > 0.0 && side.is_finite()) {
        return Err(Error::out_of_range("cell", side, "finite and above 0"));
    }
    let as_slab = |shape: &Shape| if let Shape::Slab(slab) = shape { Some(*slab) } else { None };
    let slabs: Vec<Slab> = parts.regions.iter().filter_map(|r| as_slab(&r.shape)).collect();
    let refracting = parts.objects.iter().filter(|o| matches!(o.surface, Surface::Dielectric(_)));
    let refracting: Vec<Slab> = refracting.filter_map(|o| as_slab(&o.shape)).collect();
    match slabs[..] {
        _ if !refracting.is_empty() => Ok(Some(Stage { slab: around(&slabs, &refracting)?, side })),
        [slab] => Ok(Some(Stage { slab, side })),
        _ => refuse(format!("`cell` stands for one slab of medium; this scene has {}", slabs.len())),
    }
}

/// The slab that unbounded light starts from where it meets dielectric slabs: about all of them and half as thick again
/// on both sides, so that light is outside when it starts.
fn around(slabs: &[Slab], refracting: &[Slab]) -> Result<Slab> {
    let all = || slabs.iter().chain(refracting);
    let top = all().map(Slab::top).fold(f64::INFINITY, f64::min);
    let bottom = all().map(|s| s.face(Face::Bottom)).fold(f64::NEG_INFINITY, f64::max);
    let thickness = bottom - top;
    Slab::new(top - 0.5 * thickness, 2.0 * thickness)
}

/// The objects that refract.
fn dielectrics(parts: &Parts) -> impl Iterator<Item = &Object> {
    parts.objects.iter().filter(|o| matches!(o.surface, Surface::Dielectric(_)))
}

/// Light that starts or is measured on the very surface that refracts it could be on either side.
fn check_apart(parts: &Parts) -> Result<()> {
    for light in &parts.lights {
        if let Light::Isotropic(isotropic) = light
            && let Some(same) = dielectrics(parts).find(|o| !is_around(isotropic.shape(), &o.shape))
        {
            return refuse(format!(
                "isotropic light starts on its shape, which must lie outside every dielectric surface: not so for {:?}",
                same.shape
            ));
        }
    }
    for sensor in &parts.sensors {
        if let Quantity::Outflow { shape, .. } = &sensor.quantity
            && dielectrics(parts).any(|o| o.shape == *shape)
        {
            return refuse(format!(
                "sensor {} is on a dielectric surface, where what leaves could still be reflected; allowed: a larger shape",
                sensor.name
            ));
        }
    }
    Ok(())
}

/// Whether a solid shape holds another one, as far as their bounds tell; both faces of a slab strictly.
fn is_around(outer: &Shape, inner: &Shape) -> bool {
    match (outer, inner, inner.bounds()) {
        (Shape::Slab(o), Shape::Slab(i), _) => {
            o.top() < i.top() && i.face(Face::Bottom) < o.face(Face::Bottom)
        }
        _ => outer != inner,
    }
}

/// Light inside a closed shape that reflects everything, where nothing absorbs, would never come to an end. Closed
/// rooms made of several shapes are not recognised.
fn check_end(parts: &Parts) -> Result<()> {
    let keeps_all = |kept: Spectrum| kept.min() >= 1.0;
    for object in parts.objects.iter().filter(|o| keeps_all(o.surface.largest_reflectance())) {
        // Light leaves dielectrics and filters on both sides.
        let lets_pass = matches!(object.surface, Surface::Dielectric(_) | Surface::Filter(_));
        if lets_pass || !object.shape.is_solid() {
            continue;
        }
        // Shapes are convex: those that share a part of their inside hold the other's middle, or nearly so.
        let middle = |shape: &Shape| shape.sample_inside(0.0, [0.5; 3]).0;
        let is_inside =
            |shape: &Shape| object.shape.contains(middle(shape)) || shape.contains(middle(&object.shape));
        let absorbs = parts.regions.iter().any(|r| r.medium.is_absorbing() && is_inside(&r.shape))
            || parts.interiors.iter().any(|i| i.medium.as_ref().is_some_and(Medium::is_absorbing))
            || parts
                .objects
                .iter()
                .any(|o| !keeps_all(o.surface.largest_reflectance()) && is_inside(&o.shape))
            || parts.lights.iter().any(|l| l.body().is_some_and(is_inside));
        if !absorbs {
            return refuse(
                "light could be caught for ever: a closed shape reflects everything and nothing in it absorbs",
            );
        }
    }
    Ok(())
}

/// Photons keep their power in single precision, which ends near 1e38 on both sides of 1.
pub(super) fn check_power(scene: &Scene) -> Result<()> {
    if scene.lights().is_empty() {
        return Ok(());
    }
    let power = scene.power();
    let is_out = |p: &f64| !(1e-30..=1e30).contains(p) && (*p != 0.0 || power.is_black());
    match (0..3).map(|c| power[c]).find(is_out) {
        Some(bad) => {
            Err(Error::out_of_range("power of all lights in a channel", bad, "1e-30 to 1e30 W, or 0 in some"))
        }
        None => Ok(()),
    }
}

/// Folding positions into a cell is exact only where every part looks the same after a step along x or y.
fn check_fold(parts: &Parts, stage: Option<&Stage>) -> Result<()> {
    let Some(stage) = stage else { return Ok(()) };
    let is_unbounded = |shape: &Shape| matches!(shape, Shape::Slab(_));
    let all_unbounded = parts.regions.iter().all(|r| is_unbounded(&r.shape))
        && parts.objects.iter().all(|o| is_unbounded(&o.shape))
        && parts.lights.iter().all(Light::needs_stage);
    if !all_unbounded {
        return refuse("with `cell`, every medium, surface and light must be laterally unbounded");
    }
    if !parts.regions.iter().all(|r| r.medium.is_layered()) {
        return refuse(
            "with `cell`, a density must depend on z alone: a grid of one sample along x and y, or height fog along z",
        );
    }
    for light in &parts.lights {
        let shape = match light {
            Light::Isotropic(l) => Some(l.shape()),
            Light::VolumeSource(l) => Some(l.shape()),
            _ => None,
        };
        if let Some(shape) = shape
            && dielectrics(parts).next().is_none()
            && *shape != Shape::Slab(stage.slab)
        {
            return refuse("an unbounded light's slab must be the slab of the medium");
        }
    }
    Ok(())
}

/// Largest distance of a shape's points from the origin, along any axis that is bounded \[L\].
fn extent(shape: &Shape) -> f64 {
    match shape {
        Shape::Sphere(s) => s.center().abs().max_element() + s.radius(),
        Shape::Cuboid(c) => c.min().abs().max_element().max(c.max().abs().max_element()),
        Shape::Slab(s) => s.top().abs() + s.thickness(),
        Shape::Rectangle(_) | Shape::Mesh(_) | Shape::Lathe(_) => 0.0,
    }
}
