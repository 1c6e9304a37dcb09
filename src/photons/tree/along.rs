//! Every photon within a distance of a stretch of a ray: boxes that come so near, then their photons one by one.

use super::PhotonTree;
use super::block::{ROW, Row};
use super::boxes::Boxes;
use super::scratch::with_scratch;
use super::within::bits;
use crate::math::{Interval, Ray};
use wide::f32x8;

/// Boxes and blocks are looked through in single precision, and let in if they come nearer than the radius and this many units:
/// some roundings of numbers up to [`FAR`].
const MARGIN: f64 = 1e-5;

/// How far from the middle of the map a ray, or how large a radius, may be for that \[units\].
const FAR: f64 = 16.0;

/// Directions of rays have no smaller part: a box is then left at a finite distance.
const LEAST: f64 = 1e-12;

/// A stretch of a ray with a radius about it, in the tree's units.
struct Cylinder {
    /// The ray's point nearest the middle of the map, from which distances along it count.
    origin: [f32; 3],
    dir: [f32; 3],
    inverse: [f32; 3],
    span: [f32; 2],
    radius: f32,
}

impl Cylinder {
    /// The boxes that the ray meets if they are widened by the radius on all sides, a bit each.
    fn touched(&self, boxes: &Boxes) -> u32 {
        let row = |[lower, upper]: &[Row; 2]| {
            let mut start = f32x8::splat(self.span[0]);
            let mut end = f32x8::splat(self.span[1]);
            for axis in 0..3 {
                let at = f32x8::splat(self.origin[axis]);
                let radius = f32x8::splat(self.radius);
                let inverse = f32x8::splat(self.inverse[axis]);
                let low = (lower[axis] - radius - at) * inverse;
                let high = (upper[axis] + radius - at) * inverse;
                start = start.fast_max(low.fast_min(high));
                end = end.fast_min(low.fast_max(high));
            }
            start.simd_le(end).to_bitmask()
        };
        row(&boxes.rows[0]) | row(&boxes.rows[1]) << 8
    }

    /// Squared distances of eight positions from the ray.
    fn squared_distances(&self, positions: &Row) -> f32x8 {
        let way = [0, 1, 2].map(|axis| positions[axis] - f32x8::splat(self.origin[axis]));
        let dir = self.dir.map(f32x8::splat);
        let [x, y, z] = [(1, 2), (2, 0), (0, 1)].map(|(a, b)| way[a] * dir[b] - way[b] * dir[a]);
        x * x + y * y + z * z
    }
}

impl PhotonTree {
    /// Visits every photon at most `radius` \[L\] from a ray whose foot on it lies in `span`, its start included and its end not:
    /// the photon's place in the tree's order, where its foot is along the ray \[L\], and its squared distance [L^2], both of the
    /// stored position in double precision. In the tree's order.
    pub fn along(&self, ray: &Ray, span: Interval, radius: f64, mut visit: impl FnMut(usize, f64, f64)) {
        let mut ask = |place: usize| {
            let way = self.position(place) - ray.origin;
            let foot = way.dot(ray.dir);
            let squared = (way - ray.dir * foot).length_squared();
            if span.start <= foot && foot < span.end && squared <= radius * radius {
                visit(place, foot, squared);
            }
        };
        let Some(cylinder) = self.cylinder(ray, span, radius) else {
            (0..self.stored).for_each(ask);
            return;
        };
        let within = f32x8::splat(cylinder.radius * cylinder.radius);
        with_scratch(|scratch| {
            self.descend(|boxes| cylinder.touched(boxes), scratch);
            for &block in &scratch.touched {
                for (half, positions) in self.positions[block as usize].iter().enumerate() {
                    let near = cylinder.squared_distances(positions).simd_le(within).to_bitmask();
                    let first = (2 * block as usize + half) * ROW;
                    bits(near).for_each(|lane| ask(first + lane));
                }
            }
        });
    }

    /// The stretch as boxes are asked about it; none where single precision does not tell.
    fn cylinder(&self, ray: &Ray, span: Interval, radius: f64) -> Option<Cylinder> {
        let origin = self.units.relative(ray.origin);
        let middle = -origin.dot(ray.dir);
        let nearest = origin + ray.dir * middle;
        let radius = self.units.shrink(radius);
        if !(nearest.length() <= FAR && radius <= FAR) {
            return None;
        }
        // Feet lie no farther from the nearest point than the corners of the map do from its middle.
        let along = |t: f64| (self.units.shrink(t) - middle).clamp(-2.0, 2.0);
        let dir = ray.dir.to_array().map(|d| if d.abs() < LEAST { LEAST.copysign(d) } else { d });
        Some(Cylinder {
            origin: nearest.as_vec3().to_array(),
            dir: ray.dir.as_vec3().to_array(),
            inverse: dir.map(|d| (1.0 / d) as f32),
            span: [(along(span.start) - MARGIN) as f32, (along(span.end) + MARGIN) as f32],
            radius: (radius + MARGIN) as f32,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::warp;
    use crate::photons::{Flags, Photon};
    use crate::rng::{Purpose, Stream};
    use glam::{DVec3, Vec3};

    fn photon(position: DVec3) -> Photon {
        let (dir, normal, power) = (Vec3::Z, Vec3::ZERO, Vec3::ONE);
        Photon { position, dir, normal, power, order: 0, flags: Flags::NONE }
    }

    /// Random maps, large, small and far off, and rays through them, past them and along an axis: found is what all photons, asked
    /// one by one, say.
    #[test]
    fn photons_along_a_ray_are_those_found_one_by_one() {
        let mut stream = Stream::new(5, Purpose::Synthetic, 0, 0);
        let mut found = 0;
        for trial in 0..200 {
            let size = libm::exp10(8.0 * stream.unit() - 4.0);
            let far = DVec3::from(stream.triple()) * [0.0, 3.0 * size, 1e3 * size][trial % 3];
            let count = [0, 1, 5, 16, 17, 300, 5000][trial % 7];
            let position = |stream: &mut Stream| {
                far + (DVec3::from(stream.triple()) - 0.5) * DVec3::new(size, 0.3 * size, 0.01 * size)
            };
            let photons = (0..count).map(|_| photon(position(&mut stream))).collect();
            let tree = PhotonTree::new(photons).unwrap();
            for which in 0..10 {
                let dir = match which {
                    0 => DVec3::X,
                    1 => DVec3::NEG_Z,
                    2 => DVec3::new(1.0, -0.0, 1e-14).normalize(),
                    _ => warp::square_to_sphere(stream.pair()),
                };
                let through = position(&mut stream);
                let away = [0.2, 2.0, 100.0][which % 3] * size;
                let ray = Ray::new(through - dir * away, dir);
                let end = if which == 5 { f64::INFINITY } else { 2.0 * away * stream.unit() };
                let span = Interval { start: end.min(away) * 0.3 * stream.unit(), end };
                let radius = size * [1e-6, 0.001, 0.05, 30.0][which % 4];
                let mut seen = Vec::new();
                tree.along(&ray, span, radius, |place, foot, squared| seen.push((place, foot, squared)));
                let all = (0..tree.len()).filter_map(|place| {
                    let way = tree.position(place) - ray.origin;
                    let foot = way.dot(dir);
                    let squared = (way - dir * foot).length_squared();
                    let is_in = foot >= span.start && foot < span.end && squared <= radius * radius;
                    is_in.then_some((place, foot, squared))
                });
                assert!(seen.iter().copied().eq(all), "{trial} {which}: {}", seen.len());
                found += seen.len();
            }
        }
        assert!(found > 10_000, "{found}");
    }
}
