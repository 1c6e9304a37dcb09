//! Where each pixel looks: the first surface that is not specular, and the medium before it.

use glam::DVec3;
use turbid::Spectrum;
use turbid::geometry::Shape;
use turbid::math::{Frame, Ray, sin_cos};
use turbid::rng::{Purpose, Stream};
use turbid::scene::{Camera, Region, Scene, Target};
use turbid::transport::{Roulette, Step, Visitor, Walker, walk};

/// What a pixel's middle sees.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct View {
    /// The matt surface, if there is one: place and normal.
    pub surface: Option<(DVec3, DVec3)>,
    /// Cosine between the line of sight and the normal.
    pub cosine: f64,
    /// Length of the way to it, or to the end of the last medium \[L\].
    pub distance: f64,
    /// Length of the way in media, and the distance of its middle \[L\].
    pub medium: (f64, f64),
    /// Share of a disc of the probed radius about the place that lies off the surface; 0 of a flat surface, where
    /// estimates are divided by the share that lies on it.
    pub missing: f64,
    /// Whether the fog ends where the surface is, at its region's edge or at a solid body: behind it there is none, and
    /// estimates are divided by the part of their balls that lies inside.
    pub is_at_face: bool,
}

/// Follows one ray through specular surfaces to the first other one.
struct Eye<'a> {
    scene: &'a Scene,
    view: View,
    is_flat: bool,
}

impl Visitor for Eye<'_> {
    fn visit(&mut self, walker: &Walker, step: Step, _stream: &mut Stream) {
        let Step::Ahead(hit) = step else { return };
        let end = hit.map_or(f64::INFINITY, |found| found.hit.t);
        let mut last = 0.0_f64;
        for segment in self.scene.segments(&walker.ray, end, walker.within).iter() {
            let (start, stop) = (segment.interval.start, segment.interval.end);
            let (length, middle) = self.view.medium;
            let (more, at) = (stop - start, self.view.distance + 0.5 * (start + stop));
            self.view.medium = (length + more, (length * middle + more * at) / (length + more));
            last = stop;
        }
        self.view.distance += if end.is_finite() { end } else { last };
        let Some(found) = hit else { return };
        let Target::Object(index) = found.target else { return };
        let shape = &self.scene.objects()[index].shape;
        self.is_flat = matches!(shape, Shape::Rectangle(_) | Shape::Cuboid(_));
        // As the mapper does it: where there is one medium alone.
        let is_solid = shape.is_solid() && self.scene.regions().len() == 1;
        let normal = found.hit.normal;
        let normal = if normal.dot(walker.ray.dir) > 0.0 { -normal } else { normal };
        self.view.surface = Some((walker.ray.at(end), normal));
        self.view.cosine = normal.dot(walker.ray.dir).abs();
        let behind = walker.ray.at(end) - 1e-6 * end * normal;
        let mut regions = self.scene.regions().iter();
        self.view.is_at_face = is_solid
            || regions.all(|Region { shape, .. }| {
                matches!(shape, Shape::Sphere(_) | Shape::Cuboid(_) | Shape::Slab(_))
                    && !shape.contains(behind)
            });
    }
}

/// What every pixel's middle sees, row by row from the top. At dielectrics one of both ways is followed, at random.
///
/// # Arguments   `radius` by pixel of the disc that is probed for the surface's edges \[L\]; 0 for none
pub fn look(scene: &Scene, camera: &Camera, radius: impl Fn(usize) -> f64 + Sync) -> Vec<View> {
    let one = |number: u64| {
        let (x, y) =
            ((number % u64::from(camera.width())) as u32, (number / u64::from(camera.width())) as u32);
        let ray = camera.ray(glam::DVec2::new(f64::from(x) + 0.5, f64::from(y) + 0.5));
        let view = View {
            surface: None,
            cosine: 1.0,
            distance: 0.0,
            medium: (0.0, 0.0),
            missing: 0.0,
            is_at_face: false,
        };
        let mut eye = Eye { scene, view, is_flat: false };
        let mut stream = Stream::new(0, Purpose::Synthetic, 0, number);
        let walker = Walker { within: scene.interior_at(ray.origin), ..Walker::new(ray, Spectrum::ONE) };
        walk(scene, walker, Roulette::Below(1e-6), Some(0), &mut stream, &mut eye);
        let radius = radius(number as usize);
        if let (Some((place, normal)), true) = (eye.view.surface, radius > 0.0 && !eye.is_flat) {
            eye.view.missing = missing(scene, place, normal, radius);
        }
        eye.view
    };
    use rayon::prelude::*;
    let count = u64::from(camera.width()) * u64::from(camera.height());
    (0..count).into_par_iter().map(one).collect()
}

/// Share of sixteen points of a disc that lie off the surface: in two rings of equal area, a ray down to the tangent
/// plane from a tenth of the radius above must end at the plane, within that tenth.
fn missing(scene: &Scene, place: DVec3, normal: DVec3, radius: f64) -> f64 {
    const POINTS: u32 = 16;
    let frame = Frame::new(normal);
    let is_off = |n: u32| {
        let ring = if n.is_multiple_of(2) { 0.5 } else { 0.866 };
        let (sin, cos) = sin_cos(2.0 * std::f64::consts::PI * f64::from(n) / f64::from(POINTS));
        let height = 0.1 * radius;
        let from = place + frame.to_world(DVec3::new(cos, sin, 0.0)) * (ring * radius) + normal * height;
        let hit = scene.hit(&Ray::new(from, -normal), None);
        !hit.is_some_and(|found| found.hit.t <= 2.0 * height && found.hit.normal.dot(normal).abs() > 0.9)
    };
    f64::from((0..POINTS).filter(|&n| is_off(n)).count() as u32) / f64::from(POINTS)
}
