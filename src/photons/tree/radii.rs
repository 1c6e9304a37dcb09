//! A radius for each photon, and every photon whose own radius reaches a stretch of a ray.

use super::PhotonTree;
use super::block::{BLOCK, ROW};
use super::cylinder::Cylinder;
use super::nearest::{Counted, Nearest};
use super::scratch::with_scratch;
use super::units::Units;
use super::within::{Neighbors, bits};
use crate::faults::{Fault, planted};
use crate::math::{Interval, Ray};
use glam::DVec3;
use rayon::prelude::*;
use wide::f32x8;

/// A radius for each photon of a tree: the distance to its k-th nearest other one.
#[derive(Debug)]
pub struct Radii {
    units: Units,
    /// In the tree's order \[units\].
    each: Vec<f32>,
    /// The largest one below each box \[units\], as the boxes of the levels are, finest first.
    levels: Vec<Vec<[f32x8; 2]>>,
    largest: f32,
}

impl Radii {
    /// That of the photon at a place in the tree's order \[L\].
    pub fn of(&self, place: usize) -> f64 {
        self.units.stretch(f64::from(self.each[place]))
    }

    /// The largest \[L\]; 0 of none.
    pub fn largest(&self) -> f64 {
        self.units.stretch(f64::from(self.largest))
    }
}

impl PhotonTree {
    /// The distance of each photon to its k-th nearest other one \[L\], but at least and at most what is allowed; `place` says where a
    /// position is asked. By the threads of the current pool. Of k and more photons in one place those elsewhere count.
    pub fn radii(&self, k: usize, (least, most): (f64, f64), place: impl Fn(DVec3) -> DVec3 + Sync) -> Radii {
        let kth = |at: DVec3, k: usize| {
            // The nearest of all is the photon itself.
            match self.nearest(at, k + 1, most, Counted::BelowKth, &mut |_: Neighbors<'_>| ()) {
                Nearest::Found(shell) => shell.radius,
                Nearest::Underfull => most,
            }
        };
        let one = |index: usize| {
            let at = place(self.position(index));
            let radius = if planted(Fault::RadiiExtrapolated) {
                let few = (k as f64).sqrt().floor();
                kth(at, few as usize) * libm::cbrt(k as f64 / few)
            } else {
                kth(at, k)
            };
            let (radius, most) = (self.units.shrink(radius.max(least)), self.units.shrink(most));
            let single = (radius.min(most) as f32).min(f32::MAX);
            // None is above the most by rounding.
            if f64::from(single) > most { single.next_down() } else { single }
        };
        let each: Vec<f32> = (0..self.stored).into_par_iter().with_min_len(BLOCK).map(one).collect();
        let mut largest: Vec<f32> = each.chunks(BLOCK).map(maximum).collect();
        let mut levels = Vec::with_capacity(self.levels.len());
        for _ in &self.levels {
            levels.push(largest.chunks(16).map(row_pair).collect());
            largest = largest.chunks(16).map(maximum).collect();
        }
        Radii { units: self.units, each, levels, largest: maximum(&largest) }
    }

    /// Visits every photon whose own radius reaches a ray and whose foot on it lies in `span`, its start included and its end not: the
    /// photon's place in the tree's order, where its foot is along the ray \[L\], and its squared distance [L^2]. In the tree's order.
    pub fn along_by_radii(
        &self,
        ray: &Ray,
        span: Interval,
        radii: &Radii,
        mut visit: impl FnMut(usize, f64, f64),
    ) {
        let mut ask = |place: usize| {
            let way = self.position(place) - ray.origin;
            let foot = way.dot(ray.dir);
            let squared = (way - ray.dir * foot).length_squared();
            let radius = radii.of(place);
            if span.start <= foot && foot < span.end && squared <= radius * radius {
                visit(place, foot, squared);
            }
        };
        let Some(cylinder) = Cylinder::new(&self.units, ray, span, radii.largest()) else {
            (0..self.stored).for_each(ask);
            return;
        };
        with_scratch(|scratch| {
            let (touched, parents) = (&mut scratch.touched, &mut scratch.parents);
            touched.clear();
            touched.extend((!self.levels.is_empty()).then_some(0));
            for (boxes, radii) in self.levels.iter().zip(&radii.levels).rev() {
                std::mem::swap(touched, parents);
                touched.clear();
                for &node in parents.iter() {
                    let mask = cylinder.touched_within(&boxes[node as usize], &radii[node as usize]);
                    touched.extend(bits(mask).map(|lane| node * 16 + lane as u32));
                }
            }
            for &block in touched.iter() {
                let radii = &radii.levels[0][block as usize / 16];
                let radius = radii[block as usize % 16 / 8].as_array()[block as usize % 8];
                let within = cylinder.squared_reach(radius);
                for (half, positions) in self.positions[block as usize].iter().enumerate() {
                    let near = cylinder.squared_distances(positions).simd_le(within).to_bitmask();
                    let first = (2 * block as usize + half) * ROW;
                    bits(near).for_each(|lane| ask(first + lane));
                }
            }
        });
    }
}

fn maximum(radii: &[f32]) -> f32 {
    radii.iter().copied().fold(0.0, f32::max)
}

/// Up to sixteen numbers, 0 where there are none.
fn row_pair(sixteen: &[f32]) -> [f32x8; 2] {
    let at = |lane: usize| sixteen.get(lane).copied().unwrap_or(0.0);
    [0, 8].map(|first| f32x8::new(std::array::from_fn(|lane| at(first + lane))))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::warp;
    use crate::photons::{Flags, Photon};
    use crate::rng::{Purpose, Stream};
    use glam::Vec3;

    fn photon(position: DVec3) -> Photon {
        let (dir, normal, power) = (Vec3::Z, Vec3::ZERO, Vec3::ONE);
        Photon { position, dir, normal, power, order: 0, flags: Flags::NONE }
    }

    /// Random maps, even and crowded about a place, small, large and far off, some photons in one place: radii are what sorted
    /// distances say, and found along rays is what all photons, asked one by one with the radius of each, say.
    #[test]
    fn photons_that_reach_a_ray_are_those_found_one_by_one() {
        let mut stream = Stream::new(15, Purpose::Synthetic, 0, 0);
        let (mut found, mut capped) = (0, 0);
        for trial in 0..84 {
            let size = libm::exp10(8.0 * stream.unit() - 4.0);
            let far = DVec3::from(stream.triple()) * [0.0, 3.0 * size, 1e3 * size][trial % 3];
            let count = [0, 1, 5, 16, 17, 300, 2000][trial % 7];
            let crowded = trial % 2 == 1;
            let position = |stream: &mut Stream| {
                let way = (DVec3::from(stream.triple()) - 0.5) * DVec3::new(size, 0.3 * size, 0.1 * size);
                let near = if crowded { stream.unit() * stream.unit() * stream.unit() } else { 1.0 };
                far + way * near
            };
            let mut photons: Vec<Photon> = (0..count).map(|_| photon(position(&mut stream))).collect();
            if trial % 5 == 0 {
                photons.iter_mut().take(4).for_each(|photon| photon.position = far);
            }
            let tree = PhotonTree::new(photons).unwrap();
            let k = [1, 2, 9, 30][trial % 4];
            let (least, most) = (1e-6 * size, [0.05, 0.3, 40.0][trial % 3] * size);
            let radii = tree.radii(k, (least, most), |place| place);
            for place in 0..tree.len() {
                let mut distances: Vec<f64> = (0..tree.len())
                    .filter(|other| *other != place)
                    .map(|other| tree.position(place).distance(tree.position(other)))
                    .collect();
                distances.sort_by(f64::total_cmp);
                let elsewhere = distances.iter().copied().find(|distance| *distance > 0.0).unwrap_or(most);
                let kth = distances.get(k - 1).copied().unwrap_or(most);
                let expected = kth.max(elsewhere.min(most)).max(least).min(most);
                // Of single precision, in units of up to the size.
                let error = 1e-6 * expected + 2e-7 * size * f64::from(u8::from(expected < 1e-3 * size));
                assert!(
                    (radii.of(place) - expected).abs() <= error,
                    "{trial}: {} {expected}",
                    radii.of(place)
                );
                capped += u32::from(radii.of(place) >= 0.999_999 * most);
            }
            for which in 0..8 {
                let dir = match which {
                    0 => DVec3::X,
                    1 => DVec3::new(1.0, -0.0, 1e-14).normalize(),
                    _ => warp::square_to_sphere(stream.pair()),
                };
                let away = [0.2, 2.0, 100.0][which % 3] * size;
                let ray = Ray::new(position(&mut stream) - dir * away, dir);
                let end = if which == 5 { f64::INFINITY } else { 2.0 * away * stream.unit() };
                let span = Interval { start: end.min(away) * 0.3 * stream.unit(), end };
                let mut seen = Vec::new();
                tree.along_by_radii(&ray, span, &radii, |place, foot, squared| {
                    seen.push((place, foot, squared))
                });
                let all = (0..tree.len()).filter_map(|place| {
                    let way = tree.position(place) - ray.origin;
                    let foot = way.dot(dir);
                    let squared = (way - dir * foot).length_squared();
                    let is_in =
                        foot >= span.start && foot < span.end && squared <= radii.of(place) * radii.of(place);
                    is_in.then_some((place, foot, squared))
                });
                assert!(seen.iter().copied().eq(all), "{trial} {which}: {}", seen.len());
                found += seen.len();
            }
        }
        assert!(found > 3000 && capped > 400, "{found} {capped}");
    }

    /// The same radii on one thread and on many.
    #[test]
    fn radii_do_not_depend_on_the_threads() {
        let mut stream = Stream::new(16, Purpose::Synthetic, 0, 0);
        let photons: Vec<_> = (0..20_000).map(|_| photon(DVec3::from(stream.triple()))).collect();
        let tree = PhotonTree::new(photons).unwrap();
        let on = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| tree.radii(20, (0.0, 1.0), |place| place).each)
        };
        let alone = on(1);
        assert!(alone.iter().all(|radius| *radius > 0.0 && *radius < 1.0));
        assert_eq!(alone, on(7));
    }
}
