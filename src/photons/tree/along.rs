//! Every photon within a distance of a stretch of a ray: boxes that come so near, then their photons one by one, or eight at a time.

use super::PhotonTree;
use super::block::ROW;
use super::cylinder::Cylinder;
use super::scratch::with_scratch;
use super::within::{Neighbors, bits};
use crate::math::{Interval, Ray};
use wide::f32x8;

/// Radii below this are asked in double precision \[units\]: single precision places a photon about the ray within some 10^-7.
const FINE: f64 = 1.0 / 1024.0;

impl PhotonTree {
    /// Visits every photon at most `radius` \[L\] from a ray whose foot on it lies in `span`, its start included and its end not:
    /// the photon's place in the tree's order, where its foot is along the ray \[L\], and its squared distance [L^2], both of the
    /// stored position in double precision. In the tree's order.
    pub fn along(&self, ray: &Ray, span: Interval, radius: f64, visit: impl FnMut(usize, f64, f64)) {
        let mut ask = self.asked((ray, span, radius), visit);
        match Cylinder::new(&self.units, ray, span, radius) {
            Some(cylinder) => self.about(&cylinder, |first, _, _, near| {
                bits(near.to_bitmask()).for_each(|lane| ask(first + lane));
            }),
            None => (0..self.stored).for_each(ask),
        }
    }

    /// The same where parts of the span, in order and apart, are told of by rows in single precision, and the rest one by one: with each
    /// row how far along the ray its feet are from [`PhotonTree::middle_of`] the ray, over [`PhotonTree::unit`]; lanes that were not found
    /// mean nothing. False, and nothing visited, where single precision is too coarse.
    pub fn along_by_rows(
        &self,
        (ray, span, radius): (&Ray, Interval, f64),
        parts: &[Interval],
        visit: impl FnMut(usize, f64, f64),
        mut visit_row: impl FnMut(Neighbors<'_>, f32x8),
    ) -> bool {
        if parts.is_empty() || self.units.shrink(radius) < FINE {
            return false;
        }
        let Some(cylinder) = Cylinder::new(&self.units, ray, span, radius) else { return false };
        let mut ask = self.asked((ray, span, radius), visit);
        let parts: Vec<[f32x8; 2]> = parts.iter().map(|part| cylinder.stretch(&self.units, part)).collect();
        let squared_radius = self.units.shrink(radius) * self.units.shrink(radius);
        let (r2, inverse_r2) = (f32x8::splat(squared_radius as f32), (1.0 / squared_radius) as f32);
        self.about(&cylinder, |first, squared, feet, near| {
            let is_in = |[start, end]: &[f32x8; 2]| feet.simd_ge(*start) & feet.simd_lt(*end);
            let in_parts = parts.iter().map(is_in).fold(f32x8::ZERO, |all, part| all | part);
            let inside = in_parts & squared.simd_le(r2);
            if inside.any() {
                visit_row(self.neighbors(first / ROW, (squared, inverse_r2), inside, 1.0), feet);
            }
            bits((near & !in_parts).to_bitmask()).for_each(|lane| ask(first + lane));
        });
        true
    }

    /// Where a ray is nearest the middle of the map \[L\].
    pub fn middle_of(&self, ray: &Ray) -> f64 {
        -(ray.origin - self.units.absolute([0.0; 3])).dot(ray.dir)
    }

    /// The tree's unit of length, a power of two, at least half the map's longest edge \[L\].
    pub fn unit(&self) -> f64 {
        self.units.stretch(1.0)
    }

    /// Asks a photon whether it is told of, in double precision.
    fn asked(
        &self,
        (ray, span, radius): (&Ray, Interval, f64),
        mut visit: impl FnMut(usize, f64, f64),
    ) -> impl FnMut(usize) {
        move |place: usize| {
            let way = self.position(place) - ray.origin;
            let foot = way.dot(ray.dir);
            let squared = (way - ray.dir * foot).length_squared();
            if span.start <= foot && foot < span.end && squared <= radius * radius {
                visit(place, foot, squared);
            }
        }
    }

    /// Visits the rows of photons whose boxes a cylinder touches: the place of the first, squared distances \[units^2\], feet, and which of
    /// them may be within the radius with their feet in the span, rounding allowed for.
    #[inline(always)]
    fn about(&self, cylinder: &Cylinder, mut visit: impl FnMut(usize, f32x8, f32x8, f32x8)) {
        let r2 = cylinder.squared_radius();
        with_scratch(|scratch| {
            self.descend(|boxes| cylinder.touched(boxes), scratch);
            scratch.measure(self, |positions| cylinder.squared_distances(positions), r2);
            for (&row, &squared) in scratch.rows[..scratch.end].iter().zip(&scratch.squared) {
                let feet = cylinder.feet(&self.positions[row as usize / 2][row as usize % 2]);
                let near = squared.simd_le(f32x8::splat(r2)) & cylinder.holds(feet);
                visit(row as usize * ROW, squared, feet, near);
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
        let (mut found, mut by_rows) = (0, 0);
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
                by_rows += rows_are_those(&tree, (&ray, span, radius), &seen, &mut stream);
            }
        }
        assert!(found > 10_000, "{found}");
        assert!(by_rows > 2000, "{by_rows}");
    }

    /// With one or two parts of the span told of by rows: what is found, each once, with feet and distances as in double precision; a
    /// photon is in another place by single precision only beside an edge.
    fn rows_are_those(
        tree: &PhotonTree,
        (ray, span, radius): (&Ray, Interval, f64),
        seen: &[(usize, f64, f64)],
        stream: &mut Stream,
    ) -> usize {
        let end = seen.iter().fold(span.start, |end, one| end.max(one.1));
        let mut cuts = [0; 4].map(|_| span.start + (end - span.start) * stream.unit());
        cuts.sort_unstable_by(f64::total_cmp);
        let mut parts =
            vec![Interval { start: cuts[0], end: cuts[1] }, Interval { start: cuts[2], end: span.end }];
        if stream.unit() < 0.5 {
            parts = vec![span];
        }
        let (unit, middle) = (tree.unit(), tree.middle_of(ray));
        let is_in_parts = |foot: f64| parts.iter().any(|part| part.start <= foot && foot < part.end);
        let (mut one_by_one, mut rows) = (Vec::new(), Vec::new());
        let is_told = tree.along_by_rows(
            (ray, span, radius),
            &parts,
            |place, foot, squared| one_by_one.push((place, foot, squared)),
            |row, feet| {
                for (lane, place) in row.places() {
                    assert_eq!(row.power()[1].as_array()[lane], tree.photon(place).power.y);
                    assert_eq!(row.dir()[2].as_array()[lane], tree.photon(place).dir.z);
                    let foot = middle + unit * f64::from(feet.as_array()[lane]);
                    let squared = f64::from(row.u2().as_array()[lane]) * radius * radius;
                    rows.push((place, foot, squared));
                }
            },
        );
        if !is_told {
            assert!(one_by_one.is_empty() && rows.is_empty());
            return 0;
        }
        // Positions are kept to single precision, so that rays far off are no more exact.
        let rounding = 2e-6 * unit + 1e-14 * ray.origin.length();
        let is_at_edge = |&(_, foot, squared): &(usize, f64, f64)| {
            let edges = parts.iter().flat_map(|part| [part.start, part.end]);
            let mut away = edges.map(|edge| (foot - edge).abs()).chain([(squared.sqrt() - radius).abs()]);
            away.any(|away| away <= rounding)
        };
        assert!(one_by_one.iter().all(|one| seen.contains(one)));
        for one in seen.iter().filter(|one| !is_at_edge(one)) {
            let told = rows.iter().filter(|row| row.0 == one.0).collect::<Vec<_>>();
            assert_eq!(told.len(), usize::from(is_in_parts(one.1)), "{one:?}");
            assert_eq!(one_by_one.contains(one), told.is_empty(), "{one:?}");
            for row in told {
                assert!((row.1 - one.1).abs() <= rounding, "{row:?} {one:?}");
                assert!((row.2.sqrt() - one.2.sqrt()).abs() <= rounding, "{row:?} {one:?}");
            }
        }
        for row in rows.iter().filter(|row| !is_at_edge(row)) {
            assert!(seen.iter().any(|one| one.0 == row.0), "{row:?}");
        }
        rows.len()
    }
}
