//! A sphere about all that a scene holds.

use super::SceneParts;
use crate::geometry::{Shape, Sphere};
use glam::DVec3;

/// A sphere about every medium, surface and body of a light; none where one of them has no end, or there is none.
pub(super) fn of(parts: &SceneParts) -> Option<Sphere> {
    about(&shapes(parts).map(Shape::bounds).collect::<Option<Vec<_>>>()?)
}

/// The same about those that have an end.
pub(super) fn of_bounded(parts: &SceneParts) -> Option<Sphere> {
    about(&shapes(parts).filter_map(Shape::bounds).collect::<Vec<_>>())
}

fn shapes(parts: &SceneParts) -> impl Iterator<Item = &Shape> {
    let regions = parts.regions.iter().map(|r| &r.shape);
    let objects = parts.objects.iter().map(|o| &o.shape);
    regions.chain(objects).chain(parts.lights.iter().filter_map(|l| l.body()))
}

/// A sphere about balls, its centre that of the box about all of them.
fn about(balls: &[(DVec3, f64)]) -> Option<Sphere> {
    let low = balls.iter().map(|(c, r)| c - DVec3::splat(*r)).reduce(DVec3::min)?;
    let high = balls.iter().map(|(c, r)| c + DVec3::splat(*r)).reduce(DVec3::max)?;
    let center = 0.5 * (low + high);
    let radius = balls.iter().map(|(c, r)| c.distance(center) + r).fold(0.0, f64::max);
    Sphere::new(center, radius).ok()
}
