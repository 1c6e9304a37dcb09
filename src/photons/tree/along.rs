//! Every photon within a distance of a stretch of a ray: boxes that come so near, then their photons one by one.

use super::PhotonTree;
use super::block::ROW;
use super::cylinder::Cylinder;
use super::scratch::with_scratch;
use super::within::bits;
use crate::math::{Interval, Ray};

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
        let Some(cylinder) = Cylinder::new(&self.units, ray, span, radius) else {
            (0..self.stored).for_each(ask);
            return;
        };
        let within = cylinder.squared_radius();
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
            let photons: Vec<_> = (0..count).map(|_| photon(position(&mut stream))).collect();
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
