//! Where each pixel looks: the first surface that is not specular, and the medium before it.

use glam::DVec3;
use turbid::Spectrum;
use turbid::geometry::Shape;
use turbid::rng::{Purpose, Stream};
use turbid::scene::{Camera, Region, Scene, Target};
use turbid::transport::{Roulette, Step, Visitor, Walker, in_parallel, walk};

/// What a pixel's middle sees.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct View {
    /// The diffuse surface, if there is one: place and normal.
    pub surface: Option<(DVec3, DVec3)>,
    /// Cosine between the line of sight and the normal.
    pub cosine: f64,
    /// Length of the way to it, or to the end of the last medium \[L\].
    pub distance: f64,
    /// Length of the way in media, and the distance of its middle \[L\].
    pub medium: (f64, f64),
    /// Whether the fog ends where the surface is, at its region's edge or at a solid body: behind it there is none, and
    /// estimates are divided by the part of their balls that lies inside.
    pub is_at_face: bool,
}

/// Follows one ray through specular surfaces to the first other one.
struct Eye<'a> {
    scene: &'a Scene,
    view: View,
}

impl Visitor for Eye<'_> {
    fn visit(&mut self, walker: &Walker, step: Step, _stream: &mut Stream) {
        let Step::Ahead(hit) = step else { return };
        let end = hit.map_or(f64::INFINITY, |found| found.hit.t);
        let mut last = 0.0_f64;
        for segment in self.scene.segments(&walker.ray, end, walker.interior).iter() {
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
pub fn look(scene: &Scene, camera: &Camera) -> Vec<View> {
    let one = |number: usize| {
        let number = number as u64;
        let (x, y) =
            ((number % u64::from(camera.width())) as u32, (number / u64::from(camera.width())) as u32);
        let ray = camera.ray(glam::DVec2::new(f64::from(x) + 0.5, f64::from(y) + 0.5));
        let view = View { surface: None, cosine: 1.0, distance: 0.0, medium: (0.0, 0.0), is_at_face: false };
        let mut eye = Eye { scene, view };
        let mut stream = Stream::new(0, Purpose::Synthetic, 0, number);
        let walker = Walker { interior: scene.interior_at(ray.origin), ..Walker::new(ray, Spectrum::ONE) };
        walk(scene, walker, Roulette::below(1e-6), Some(0), &mut stream, &mut eye);
        eye.view
    };
    in_parallel(camera.width() as usize * camera.height() as usize, one)
}
