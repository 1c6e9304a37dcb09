//! Checks on the parts of a scene together. Each part has checked its own numbers when it was made.

use super::coincident::REMEDY;
use super::place::dielectrics;
use super::{Binned, Camera, Quantity, Scene, SceneParts, Sensor, Space, coincident, interiors};
use crate::Spectrum;
use crate::error::{Error, Result};
use crate::geometry::{Face, MAX_BINS, Shape, Slab};
use crate::light::{Light, PeriodicCell, Section};
use crate::math::{Ray, cosine_pair};
use crate::medium::{Density, Medium};
use crate::phase::PhaseFunction;
use crate::surface::Surface;
use glam::{DVec2, DVec3};

/// Positions keep a part in 2^53 of the scene's extent: a mean free path must stay well above that step for a
/// flight to be resolved to 1e-6 of itself.
const MAX_EXTENT_OVER_MFP: f64 = 1e9;

/// Tentative collisions on a ray: some milliseconds.
const MAX_TRACKED_DEPTH: f64 = 1e5;

/// Lengths, positions and coefficients of a scene are 0 or between 1 over this and this, in scene units: what is made of
/// them, their sixth powers at most, stays within the numbers that f64 has.
const LARGEST: f64 = 1e30;

fn refuse<T>(text: impl Into<String>) -> Result<T> {
    Err(Error::Scene(text.into()))
}

/// The slab and its cell, if the scene has a cell; an error where parts do not fit together.
pub(super) fn check(parts: &SceneParts) -> Result<Option<PeriodicCell>> {
    if let Some(i) = parts.regions.iter().position(|r| !r.shape.is_solid()) {
        return refuse(format!(
            "regions[{i}] needs a convex shape with an inside: a sphere, a cuboid or a slab"
        ));
    }
    let filled = || parts.interiors.iter().filter_map(|i| i.medium.as_ref());
    if parts.lights.is_empty()
        && !parts.regions.iter().map(|r| &r.medium).chain(filled()).any(Medium::is_emitting)
    {
        return refuse("a scene needs at least one light, or a medium that emits");
    }
    check_sizes(parts)?;
    interiors::check(parts)?;
    let periodic_cell = periodic_cell(parts)?;
    for (i, light) in parts.lights.iter().enumerate() {
        if light.needs_cell() && periodic_cell.is_none() {
            return refuse(format!(
                "lights[{i}] is unbounded, which needs a slab of medium and `cell`, the side of the cell that stands for it"
            ));
        }
        if let Light::Beam(beam) = light
            && beam.section() == Section::Unbounded
            && beam.dir().z == 0.0
        {
            return refuse(format!(
                "lights[{i}] is an unbounded beam that runs along the faces of its slab; allowed: a `dir` with a part along z"
            ));
        }
    }
    check_fold(parts, periodic_cell.as_ref())?;
    check_apart(parts)?;
    coincident::check(parts)?;
    coincident::check_marks(parts)?;
    check_extents(parts)?;
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
                if matches!(shape, Shape::Slab(_)) && periodic_cell.is_none() {
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
            Quantity::Binned(ref binned) => {
                check_bins(&sensor.name, binned, periodic_cell.as_ref())?;
                true
            }
        };
        if !is_finite {
            return refuse(format!("sensor {} has a position or direction that is not finite", sensor.name));
        }
    }
    let bins: usize = parts.sensors.iter().filter_map(Sensor::binned).map(Binned::bins).sum();
    if bins > MAX_BINS {
        return Err(Error::out_of_range("the number of bins of all sensors", bins as f64, "at most 4194304"));
    }
    Ok(periodic_cell)
}

/// Bins in a scene with a cell lie in the cell: those of a face across z.
fn check_bins(name: &str, binned: &Binned, periodic_cell: Option<&PeriodicCell>) -> Result<()> {
    let is_slab = |space: &Space| matches!(space, Space::Shape(Shape::Slab(_)));
    let (is_level, corners) = match binned {
        Binned::Flux { bins, .. } | Binned::Radiance { bins, .. } => {
            let normal = bins.rectangle().normal();
            (normal.x == 0.0 && normal.y == 0.0, bins.rectangle().corners().to_vec())
        }
        Binned::Fluence { space, .. } | Binned::Absorption { space, .. } => match space {
            Space::Voxels(voxels) => (true, vec![voxels.cuboid().min(), voxels.cuboid().max()]),
            Space::Shape(_) if is_slab(space) && periodic_cell.is_none() => {
                return refuse(format!("sensor {name} is on a slab, so the scene needs `cell`"));
            }
            Space::Shape(_) => (true, Vec::new()),
        },
    };
    let Some(periodic_cell) = periodic_cell else { return Ok(()) };
    if !is_level {
        return refuse(format!("sensor {name}: with `cell`, its rectangle lies across z"));
    }
    // A cell and a corner plus an edge may round apart.
    let side = periodic_cell.side * (1.0 + 1e-12);
    let is_in = |p: &DVec3| {
        [(p.x, side.x), (p.y, side.y)].iter().all(|&(x, side)| (-1e-12 * side..=side).contains(&x))
    };
    match corners.iter().find(|p| !is_in(p)) {
        Some(p) => refuse(format!(
            "sensor {name} reaches ({}, {}) along x and y; allowed: within the cell, 0 to {} and {}",
            p.x, p.y, periodic_cell.side.x, periodic_cell.side.y
        )),
        None => Ok(()),
    }
}

/// Whether flights are resolved wherever media are: in the regions, and in interiors as far as their boundaries reach.
fn check_extents(parts: &SceneParts) -> Result<()> {
    let check = |name: &str, far: f64, medium: &Medium| {
        let sigma_t = medium.highest_sigma_t().max();
        if sigma_t > 0.0 && (far * sigma_t).total_cmp(&MAX_EXTENT_OVER_MFP).is_gt() {
            let what = format!("{name}: distance from the origin over the mean free path");
            return Err(Error::out_of_range(what, far * sigma_t, "at most 1e9"));
        }
        Ok(())
    };
    for (i, region) in parts.regions.iter().enumerate() {
        let name = format!("regions[{i}]");
        check(&name, extent(&region.shape), &region.medium)?;
        check_tracking(&name, region.shape.bounds(), &region.medium)?;
    }
    for (number, interior) in parts.interiors.iter().enumerate() {
        let Some(medium) = &interior.medium else { continue };
        for object in dielectrics(&parts.objects) {
            let Surface::Dielectric(dielectric) = &object.surface else { continue };
            if dielectric.inside() == number || dielectric.outside() == number {
                let far = match object.shape.bounds() {
                    Some((center, radius)) => center.abs().max_element() + radius,
                    None => extent(&object.shape),
                };
                let name = format!("interior {}", interior.name);
                check(&name, far, medium)?;
                check_tracking(&name, object.shape.bounds(), medium)?;
            }
        }
    }
    Ok(())
}

/// Whether tracking through a medium that varies, inside of a ball, has bounded work: its tentative collisions are as many
/// as the depth of its upper bound, where it is thin itself or lets one channel pass.
fn check_tracking(name: &str, ball: Option<(DVec3, f64)>, medium: &Medium) -> Result<()> {
    let Some(density) = medium.density() else { return Ok(()) };
    let reach = match density {
        // Nothing is outside of it.
        Density::Cloud(cloud) => {
            Some(cloud.shape().radii.max_element() * (1.0 + cloud.shape().roughness).sqrt())
        }
        Density::Grid(_) | Density::HeightFog(_) | Density::Blocks(_) | Density::Repeated(_) => None,
    };
    let radius = [ball.map(|(_, radius)| radius), reach].into_iter().flatten().reduce(f64::min);
    let depth = 2.0 * radius.unwrap_or(0.0) * medium.highest_sigma_t().max();
    if depth > MAX_TRACKED_DEPTH {
        let what = format!("{name}: diameter over the shortest mean free path, of a density that varies");
        return Err(Error::out_of_range(what, depth, "at most 1e5"));
    }
    Ok(())
}

/// Whether every part is of a size that can be computed with.
fn check_sizes(parts: &SceneParts) -> Result<()> {
    let is_out = |x: f64| !(x.abs() <= LARGEST && (x == 0.0 || x.abs() >= 1.0 / LARGEST));
    let number = |name: &str, what: &str, x: f64| {
        if is_out(x) {
            return Err(Error::out_of_range(format!("{name}: {what}"), x, "0, or 1e-30 to 1e30 in size"));
        }
        Ok(())
    };
    let place = |name: &str, p: DVec3| {
        if p.abs().max_element() <= LARGEST {
            return Ok(());
        }
        Err(Error::out_of_range(format!("{name}: a coordinate"), p.abs().max_element(), "up to 1e30 in size"))
    };
    let shape = |name: &str, shape: &Shape| match (shape, shape.bounds()) {
        (Shape::Slab(slab), _) => {
            place(name, DVec3::Z * slab.top())?;
            number(name, "thickness", slab.thickness())
        }
        (_, Some((center, radius))) => {
            place(name, center)?;
            number(name, "half its extent", radius)
        }
        (_, None) => Ok(()),
    };
    let medium = |name: &str, medium: &Medium| {
        let sigma_t = medium.highest_sigma_t();
        let emission = match medium {
            Medium::Homogeneous(m) => m.emission(),
            Medium::Heterogeneous(m) => m.emission_of(1.0),
        };
        (0..3).try_for_each(|channel| {
            number(name, "largest sigma_t", sigma_t[channel])?;
            number(name, "emission", emission[channel])
        })
    };
    for (i, region) in parts.regions.iter().enumerate() {
        shape(&format!("regions[{i}]"), &region.shape)?;
        medium(&format!("regions[{i}]"), &region.medium)?;
    }
    for interior in &parts.interiors {
        interior.medium.iter().try_for_each(|m| medium(&format!("interior {}", interior.name), m))?;
    }
    for (i, object) in parts.objects.iter().enumerate() {
        shape(&format!("objects[{i}]"), &object.shape)?;
    }
    for (i, light) in parts.lights.iter().enumerate() {
        let name = format!("lights[{i}]");
        light.apex().map_or(Ok(()), |p| place(&name, p))?;
        match light {
            Light::Area(l) => shape(&name, l.shape())?,
            Light::Isotropic(l) => shape(&name, l.shape())?,
            Light::VolumeSource(l) => shape(&name, l.shape())?,
            Light::Beam(l) => match l.section() {
                Section::Disc { center, radius } => {
                    place(&name, center)?;
                    number(&name, "radius", radius)?;
                }
                Section::Rectangle(rectangle) => shape(&name, &Shape::Rectangle(rectangle))?,
                Section::Unbounded => {}
            },
            _ => {}
        }
    }
    for sensor in &parts.sensors {
        let name = format!("sensor {}", sensor.name);
        match &sensor.quantity {
            Quantity::Fluence(p) => place(&name, *p)?,
            Quantity::Radiance(ray) => place(&name, ray.origin)?,
            Quantity::Outflow { shape: around, .. } => shape(&name, around)?,
            Quantity::Absorbed(_) => {}
            Quantity::Binned(Binned::Flux { bins, .. } | Binned::Radiance { bins, .. }) => {
                shape(&name, &Shape::Rectangle(*bins.rectangle()))?;
            }
            Quantity::Binned(Binned::Fluence { space, .. } | Binned::Absorption { space, .. }) => match space
            {
                Space::Voxels(voxels) => shape(&name, &Shape::Cuboid(*voxels.cuboid()))?,
                Space::Shape(around) => shape(&name, around)?,
            },
        }
    }
    parts.camera.iter().try_for_each(|camera| place("camera", camera.position()))
}

fn periodic_cell(parts: &SceneParts) -> Result<Option<PeriodicCell>> {
    let Some(side) = parts.cell else { return Ok(None) };
    if let Some(bad) = side.to_array().into_iter().find(|side| !(*side > 0.0 && side.is_finite())) {
        return Err(Error::out_of_range("cell", bad, "finite and above 0"));
    }
    let as_slab = |shape: &Shape| if let Shape::Slab(slab) = shape { Some(*slab) } else { None };
    let slabs: Vec<Slab> = parts.regions.iter().filter_map(|r| as_slab(&r.shape)).collect();
    let refracting: Vec<Slab> = dielectrics(&parts.objects).filter_map(|o| as_slab(&o.shape)).collect();
    match slabs[..] {
        _ if !refracting.is_empty() => Ok(Some(PeriodicCell { slab: around(&slabs, &refracting)?, side })),
        [slab] => Ok(Some(PeriodicCell { slab, side })),
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

/// Light that starts or is measured on the very surface that it meets, or that refracts it, could be on either side.
fn check_apart(parts: &SceneParts) -> Result<()> {
    for (i, light) in parts.lights.iter().enumerate() {
        if let Light::Isotropic(isotropic) = light
            && let Some(same) = dielectrics(&parts.objects).find(|o| !is_around(isotropic.shape(), &o.shape))
        {
            return refuse(format!(
                "lights[{i}]: isotropic light starts on its shape, which must lie outside every dielectric surface: not so for {:?}",
                same.shape
            ));
        }
    }
    for sensor in &parts.sensors {
        if let Quantity::Outflow { shape, .. } = &sensor.quantity
            && dielectrics(&parts.objects).any(|o| o.shape == *shape)
        {
            return refuse(format!(
                "sensor {} is on a dielectric surface, where what leaves could still be reflected; allowed: a larger shape",
                sensor.name
            ));
        }
    }
    let sensors = parts.sensors.iter().filter_map(|sensor| match sensor.quantity {
        Quantity::Fluence(p) => Some((format!("sensor {}", sensor.name), p)),
        Quantity::Radiance(ray) => Some((format!("sensor {}", sensor.name), ray.origin)),
        Quantity::Outflow { .. } | Quantity::Absorbed(_) | Quantity::Binned(_) => None,
    });
    let lights = parts.lights.iter().enumerate();
    let apexes = lights.filter_map(|(i, light)| Some((format!("lights[{i}]"), light.apex()?)));
    let camera = parts.camera.iter().map(|camera| ("the camera".to_string(), camera.position()));
    for (name, p) in sensors.chain(apexes).chain(camera) {
        let is_on = |shape: &Shape| {
            let size = p.abs().max_element().max(shape.bounds().map_or(0.0, |(_, radius)| radius));
            shape.distance(p, f64::INFINITY) <= ON_RAY * size
        };
        let objects =
            parts.objects.iter().enumerate().map(|(i, object)| (format!("objects[{i}]"), &object.shape));
        let lamps = parts
            .lights
            .iter()
            .enumerate()
            .filter_map(|(i, light)| Some((format!("lights[{i}]"), light.body()?)));
        if let Some((body, _)) = objects.chain(lamps).find(|(_, shape)| is_on(shape)) {
            return refuse(format!(
                "{name} is on the surface of {body}, where rounding decides on which side it is; {REMEDY}"
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

/// Radiance along a ray through a point or spot light in a medium is infinite: light that the medium scatters once at a
/// distance d from it goes as 1/d^2. A sensor that asks for it, and a camera at such a light, are refused.
pub(super) fn check_apexes(scene: &Scene) -> Result<()> {
    for sensor in scene.sensors() {
        if let Quantity::Radiance(ray) = sensor.quantity
            && sensor.orders.contains(1)
            && let Some(light) = scene.lights().iter().position(|light| is_infinite_along(scene, &ray, light))
        {
            return refuse(format!(
                "sensor {} looks through lights[{light}], which is in one point and in a medium: the radiance is infinite; move the ray past the light, or give the light an extent",
                sensor.name
            ));
        }
    }
    let Some(camera) = scene.camera() else { return Ok(()) };
    let at_camera = |light: &usize| {
        let light = &scene.lights()[*light];
        light.apex().is_some_and(|p| p.distance(camera.position()) <= ON_RAY * p.abs().max_element())
            && seen_from(camera, light)
                .any(|dir| is_infinite_along(scene, &Ray::new(camera.position(), dir), light))
    };
    match (0..scene.lights().len()).find(at_camera) {
        Some(light) => refuse(format!(
            "the camera is at lights[{light}], which is in one point and in a medium: the radiance around it is infinite; move one of them, or give the light an extent"
        )),
        None => Ok(()),
    }
}

/// A ray that passes a point more closely than this part of their distances from the origin is one through it: what
/// rounding leaves of directions, and more.
const ON_RAY: f64 = 1e-12;

/// Directions in a picture: of its corners, edges and middle, and of a spot light's axis.
fn seen_from(camera: &Camera, light: &Light) -> impl Iterator<Item = DVec3> {
    let (width, height) = (f64::from(camera.width()), f64::from(camera.height()));
    let grid =
        (0..9).map(move |i| DVec2::new(0.5 * width * f64::from(i % 3), 0.5 * height * f64::from(i / 3)));
    let axis = if let Light::Spot(spot) = light { Some(spot.dir()) } else { None };
    let axis = axis.filter(|dir| {
        let at = camera.project(camera.position() + *dir);
        at.is_some_and(|at| at.cmpge(DVec2::ZERO).all() && at.x <= width && at.y <= height)
    });
    grid.map(|at| camera.ray(at).dir).chain(axis)
}

/// Whether light of a light that is scattered once makes the radiance along a ray infinite.
fn is_infinite_along(scene: &Scene, ray: &Ray, light: &Light) -> bool {
    let Some(apex) = light.apex() else { return false };
    let (to_apex, size) = (apex - ray.origin, apex.length().max(ray.origin.length()));
    let t = to_apex.dot(ray.dir);
    if apex.distance(ray.at(t)) > ON_RAY * size || t < -ON_RAY * size {
        return false;
    }
    if t > 0.0 && scene.sees(ray, None, t).is_none() {
        return false;
    }
    // Near the light, before and behind it.
    let step = 1e-6 * if size > 0.0 { size } else { 1.0 };
    [t - step, t + step].into_iter().filter(|t| *t > 0.0).any(|t| {
        let p = ray.at(t);
        let Some(medium) = scene.medium_at(p) else { return false };
        let Some(sample) = light.sample(p, [0.5; 2]) else { return false };
        let (one_minus_mu, one_plus_mu) = cosine_pair(ray.dir, sample.dir);
        let scattered = medium.sigma_t(p) * medium.albedo(p) * sample.value;
        !scattered.is_black() && medium.phase().eval(one_minus_mu, one_plus_mu) > 0.0
    })
}

/// Photons keep their power in single precision, which ends near 1e38 on both sides of 1.
pub(super) fn check_power(scene: &Scene) -> Result<()> {
    if scene.lights().is_empty() {
        return Ok(());
    }
    let power =
        scene.lights().iter().fold(Spectrum::ZERO, |sum, light| sum + light.power(scene.periodic_cell()));
    let is_out = |p: &f64| !(1e-30..=1e30).contains(p) && (*p != 0.0 || power.is_black());
    match (0..3).map(|c| power[c]).find(is_out) {
        Some(bad) => {
            Err(Error::out_of_range("power of all lights in a channel", bad, "1e-30 to 1e30 W, or 0 in some"))
        }
        None => Ok(()),
    }
}

/// Periods that a diagonal ray crosses in a slab: some milliseconds.
const MOST_PERIODS: f64 = 1e5;

/// Wrapping positions into a periodic cell is exact only where every part looks the same after a step along x or y by a side
/// of the cell: media, which are repeated, shapes without lateral end, and light that enters everywhere alike.
fn check_fold(parts: &SceneParts, periodic_cell: Option<&PeriodicCell>) -> Result<()> {
    let Some(periodic_cell) = periodic_cell else { return Ok(()) };
    let is_unbounded = |shape: &Shape| matches!(shape, Shape::Slab(_));
    let all_unbounded = parts.regions.iter().all(|r| is_unbounded(&r.shape))
        && parts.objects.iter().all(|o| is_unbounded(&o.shape))
        && parts.lights.iter().all(Light::needs_cell);
    if !all_unbounded {
        return refuse("with `cell`, every medium, surface and light must be laterally unbounded");
    }
    let filled = parts.interiors.iter().filter_map(|interior| interior.medium.as_ref());
    let varying = filled.chain(parts.regions.iter().map(|r| &r.medium)).any(|medium| !medium.is_layered());
    let crossed = periodic_cell.slab.thickness() / periodic_cell.side.min_element();
    if varying && crossed > MOST_PERIODS {
        let what = "thickness of the slab over the side of the cell, of a density that varies along x or y";
        return Err(Error::out_of_range(what, crossed, "at most 1e5"));
    }
    for (i, light) in parts.lights.iter().enumerate() {
        let shape = match light {
            Light::Isotropic(l) => Some(l.shape()),
            Light::VolumeSource(l) => Some(l.shape()),
            _ => None,
        };
        if let Some(shape) = shape
            && dielectrics(&parts.objects).next().is_none()
            && *shape != Shape::Slab(periodic_cell.slab)
        {
            return refuse(format!(
                "lights[{i}] is unbounded and starts on a slab that is not the slab of the medium"
            ));
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
        Shape::Rectangle(_) | Shape::Mesh(_) | Shape::Revolution(_) => 0.0,
    }
}
