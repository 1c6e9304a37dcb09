//! The part of a disc across a ray that is seen from its middle among flat bodies: where they cut the disc's plane they are segments.

use crate::estimators::Kernel;
use crate::estimators::disc_share::{share_among, share_before};
use crate::geometry::{Front, Rectangle, Shape};
use crate::math::{Frame, Ray};
use glam::{DVec2, DVec3};

/// A segment lies behind a line if it reaches no farther before it than this part of the disc's radius.
const ON_LINE: f64 = 1e-9;

/// Sines of angles below this are those of a plane along a disc.
pub(super) const ALONG: f64 = 1e-9;

/// The rectangles that a flat shape consists of.
pub(super) fn rectangles_of(shape: &Shape) -> Option<Vec<Rectangle>> {
    match shape {
        Shape::Rectangle(rectangle) => Some(vec![*rectangle]),
        Shape::Cuboid(cuboid) => Some(cuboid.faces()),
        _ => None,
    }
}

/// The lines in which a face cuts the discs across a ray, as the ray's origin has it.
#[derive(Clone, Copy)]
pub(super) struct FaceLine {
    /// Unit vector across the ray.
    towards: DVec2,
    /// Sine of the angle between discs and face.
    sine: f64,
    /// Height of the ray's origin above the face, and how much that of places along the ray rises.
    height: f64,
    rise: f64,
}

impl FaceLine {
    /// As the beginning of a ray along `axes.z` has it; none of a face along the discs, behind which rounding may put their centre.
    pub fn new(face: &Front, axes: &Frame) -> Option<Self> {
        let across = -DVec2::new(face.normal.dot(axes.x), face.normal.dot(axes.y));
        let sine = across.length();
        let (height, rise) = (face.distance, face.normal.dot(axes.z));
        (sine > ALONG).then(|| FaceLine { towards: across / sine, sine, height, rise })
    }

    /// The line on the disc of a radius at a distance along the ray: a unit vector towards it and its distance over the radius. None if it is
    /// beyond the disc.
    pub fn on_disc(&self, along: f64, radius: f64) -> Option<(DVec2, f64)> {
        let away = (self.height + self.rise * along).max(0.0) / (radius * self.sine);
        (away < 1.0).then_some((self.towards, away))
    }
}

/// A rectangle as a ray has it: how far along the ray its corner is and how far across it, and its edges the same.
struct Sheet {
    corner: (f64, DVec2),
    u: (f64, DVec2),
    v: (f64, DVec2),
}

impl Sheet {
    /// The segment in which it cuts the plane at a distance along the ray.
    fn segment(&self, along: f64) -> Option<[DVec2; 2]> {
        // One coordinate of the rectangle runs, the other follows.
        let ((run, run_across), (follow, across)) =
            if self.u.0.abs() <= self.v.0.abs() { (self.u, self.v) } else { (self.v, self.u) };
        let (corner, corner_across) = self.corner;
        let away = along - corner;
        // The other one, at the beginning and the end of the first: between 0 and 1 in the rectangle.
        let [start, end] = [away / follow, (away - run) / follow];
        if !(start.max(end) >= 0.0 && start.min(end) <= 1.0) {
            return None;
        }
        let at = |(place, part): (f64, f64)| {
            let inside = place.clamp(0.0, 1.0);
            let part =
                if inside == place { part } else { ((inside - start) / (end - start)).clamp(0.0, 1.0) };
            corner_across + run_across * part + across * inside
        };
        Some([(start, 0.0), (end, 1.0)].map(at))
    }
}

/// The flat bodies about a ray, and the faces of its medium, which are planes.
pub(super) struct Sheets {
    sheets: Vec<Sheet>,
    faces: Vec<FaceLine>,
}

impl Sheets {
    /// About a ray along `axes.z`.
    pub fn new(
        (ray, axes): (&Ray, &Frame),
        rectangles: impl Iterator<Item = Rectangle>,
        faces: Vec<FaceLine>,
    ) -> Self {
        let told = |way: DVec3| (way.dot(axes.z), DVec2::new(way.dot(axes.x), way.dot(axes.y)));
        let sheet = |rectangle: Rectangle| Sheet {
            corner: told(rectangle.corner() - ray.origin),
            u: told(rectangle.u()),
            v: told(rectangle.v()),
        };
        Sheets { sheets: rectangles.map(sheet).collect(), faces }
    }

    /// The part of the disc of a radius at a distance along the ray \[L\] that is in the medium and seen from its middle.
    pub fn share(&self, kernel: Kernel, along: f64, radius: f64) -> f64 {
        let mut lines: Vec<_> = self.faces.iter().filter_map(|face| face.on_disc(along, radius)).collect();
        let mut segments: Vec<[DVec2; 2]> = Vec::new();
        for [a, b] in self.sheets.iter().filter_map(|sheet| sheet.segment(along)) {
            let (a, b) = (a / radius, b / radius);
            let way = b - a;
            let nearest = a - way * (a.dot(way) / way.length_squared()).clamp(-1.0, 0.0);
            if nearest.length_squared() >= 1.0 || nearest.is_nan() {
                continue;
            }
            // Both ends beyond the disc: a line on it.
            let across = a.perp_dot(way) / way.length();
            let (towards, away) = (-way.perp().normalize() * across.signum(), across.abs());
            if a.length_squared().min(b.length_squared()) >= 1.0 && away > 0.0 {
                lines.push((towards, away));
            } else {
                segments.push([a, b]);
            }
        }
        segments.retain(|ends| {
            let is_behind = |(towards, away): &(DVec2, f64)| {
                ends.iter().all(|end| end.dot(*towards) >= (away - ON_LINE).max(0.0))
            };
            !lines.iter().any(is_behind)
        });
        if segments.is_empty() {
            return share_before(kernel, &lines);
        }
        share_among(kernel, &lines, &segments)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Cuboid, Shape};
    use crate::math::{sin_cos, warp};
    use crate::rng::{Purpose, Stream};
    use std::f64::consts::{PI, TAU};

    /// A rectangle of any size and place about the middle of a box.
    fn rectangle(stream: &mut Stream, size: f64) -> Rectangle {
        let axes = Frame::new(warp::square_to_sphere(stream.pair()));
        let corner = DVec3::from(stream.triple()) - 0.5;
        let [a, b] = stream.pair().map(|u| size * (0.05 + u));
        Rectangle::new(corner, axes.x * a, axes.y * b).unwrap()
    }

    /// In a box, alone and among rectangles that part the disc, end in it, lie along it and across it: what rays to all sides say, which
    /// ask each rectangle for itself.
    #[test]
    fn shares_are_those_of_rays_to_all_sides() {
        const RAYS: u32 = 4096;
        let mut stream = Stream::new(6, Purpose::Synthetic, 0, 0);
        let (mut whole, mut parted) = (0, 0);
        let cuboid = Shape::Cuboid(Cuboid::new(DVec3::splat(-0.5), DVec3::splat(0.5)).unwrap());
        for trial in 0..600 {
            let kernel = Kernel::ALL[trial % 5];
            let size = [0.3, 1.0, 10.0, 1e7][trial / 3 % 4];
            let rectangles: Vec<_> = (0..trial % 4).map(|_| rectangle(&mut stream, size)).collect();
            let place = (DVec3::from(stream.triple()) - 0.5) * 0.999;
            let dir = if trial % 7 == 0 { DVec3::X } else { warp::square_to_sphere(stream.pair()) };
            let (along, radius) = (3.0 * stream.unit(), 0.05 + 0.6 * stream.unit());
            let ray = Ray::new(place - dir * along, dir);
            let axes = Frame::new(dir);
            let faces = cuboid.faces_about(ray.origin).unwrap();
            let faces = faces.iter().filter_map(|face| FaceLine::new(face, &axes)).collect();
            let sheets = Sheets::new((&ray, &axes), rectangles.iter().copied(), faces);
            let found = sheets.share(kernel, along, radius);
            let reach = |angle: f64| {
                let (sin, cos) = sin_cos(angle);
                let way = Ray::new(place, axes.x * cos + axes.y * sin);
                let end = cuboid.interval(&way).unwrap().end.min(radius);
                let until = |end: f64, one: &Rectangle| Shape::Rectangle(*one).until(&way, end);
                kernel.within_disc(rectangles.iter().fold(end, until) / radius)
            };
            let all = (0..RAYS).map(|n| reach(TAU * f64::from(n) / f64::from(RAYS))).sum::<f64>();
            let expected = all / f64::from(RAYS);
            // Of a cone's tip beside a line the closed form is known to 10^-4.
            assert!(
                (found - expected).abs() < 4e-4,
                "{trial}: {found} {expected} {rectangles:?} {ray:?} {along}"
            );
            whole += usize::from(expected == 1.0);
            parted += usize::from(!rectangles.is_empty() && expected < 1.0);
        }
        assert!(whole > 20 && parted > 200, "{whole} {parted}");
    }

    /// Between plates far larger than the disc, alone and with a wall from one to the other: a strip, or one that ends at the wall, however
    /// narrow.
    #[test]
    fn narrow_gaps_are_as_wide_as_they_are() {
        let mut stream = Stream::new(8, Purpose::Synthetic, 0, 0);
        for trial in 0..200 {
            let axes = Frame::new(warp::square_to_sphere(stream.pair()));
            let (x, y, z) = (axes.x, axes.y, axes.z);
            let half = [3.0, 15.0, 1e3][trial % 3];
            let gap = [1e-2, 1e-4, 1e-6][trial / 3 % 3];
            let below = gap * (0.1 + 0.8 * stream.unit());
            let plate = |at: f64| {
                Rectangle::new(y * at - (x + z) * half, x * (2.0 * half), z * (2.0 * half)).unwrap()
            };
            let wall = Rectangle::new(x * 0.3 - y - z, y * 2.0, z * 2.0).unwrap();
            let plates = [plate(-below), plate(gap - below)];
            let ray = Ray::new(-z, z);
            let share = |rectangles: &[Rectangle]| {
                Sheets::new((&ray, &Frame::new(z)), rectangles.iter().copied(), Vec::new()).share(
                    Kernel::Uniform,
                    1.0,
                    1.0,
                )
            };
            // What the disc's curve takes away is of the third power.
            for (found, expected) in
                [(share(&plates), 2.0 * gap / PI), (share(&[&plates[..], &[wall]].concat()), 1.3 * gap / PI)]
            {
                let error = gap * gap + 1e-14 * half / gap;
                assert!((found / expected - 1.0).abs() < error, "{half} {gap} {below}: {found} {expected}");
            }
        }
    }
}
