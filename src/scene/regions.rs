//! Where the regions of a scene are: the stretches of medium that a ray passes, the region that a point is in.

use super::Region;
use super::segment::Segment;
use crate::error::Result;
use crate::geometry::Tree;
use crate::math::{Interval, Ray};
use glam::DVec3;
use std::collections::BTreeSet;

/// Regions up to which each of them is asked: a tree takes longer to search than so many shapes to try.
pub(super) const FEW: usize = 8;

/// The tree over more regions than a few.
#[derive(Debug, Clone)]
pub(super) struct RegionTree {
    /// Over the boxes of those that have an end; none where none has.
    tree: Option<Tree>,
    /// Which region each entry of the tree is.
    order: Vec<usize>,
    /// Regions without end, which no box holds.
    unbounded: Vec<usize>,
}

/// Of the same regions a tree is the same.
impl PartialEq for RegionTree {
    fn eq(&self, other: &Self) -> bool {
        self.order == other.order && self.unbounded == other.unbounded
    }
}

impl RegionTree {
    /// A tree over the regions; none over a few.
    ///
    /// # Errors   those of [`Tree::new`], for extents beyond 1e100
    pub fn new(regions: &[Region]) -> Result<Option<Self>> {
        if regions.len() <= FEW {
            return Ok(None);
        }
        let corners: Vec<_> = regions.iter().map(|region| region.shape.corners()).collect();
        let (bounded, unbounded): (Vec<_>, Vec<_>) = (0..regions.len()).partition(|i| corners[*i].is_some());
        let boxes: Vec<_> = corners.into_iter().flatten().collect();
        let found = (!boxes.is_empty()).then(|| Tree::new("regions", &boxes, 0.0)).transpose()?;
        let (tree, order) = found.map_or((None, Vec::new()), |(tree, order)| (Some(tree), order));
        let order = order.iter().map(|entry| bounded[*entry as usize]).collect();
        Ok(Some(RegionTree { tree, order, unbounded }))
    }

    /// Offers `test` every region whose box the ray meets before distance `end` \[L\], in no order.
    fn search(&self, ray: &Ray, end: f64, mut test: impl FnMut(usize)) {
        self.unbounded.iter().for_each(|index| test(*index));
        let Some(tree) = &self.tree else { return };
        tree.search(ray, end, |entry, end| {
            test(self.order[entry]);
            end
        });
    }

    /// The stretches of `regions` on `ray` within `whole`; where shapes overlap, the later one counts.
    pub fn segments(&self, regions: &[Region], ray: &Ray, whole: Interval) -> Vec<Segment> {
        let mut ends: Vec<(f64, bool, usize)> = Vec::new();
        self.search(ray, whole.end, |index| {
            let inside = regions[index].shape.interval(ray).and_then(|i| i.intersection(whole));
            if let Some(interval) = inside {
                ends.extend([(interval.start, true, index), (interval.end, false, index)]);
            }
        });
        ends.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
        let (mut entered, mut items, mut cursor) = (BTreeSet::new(), Vec::new(), whole.start);
        for (t, is_start, index) in ends {
            if t > cursor
                && let Some(medium) = entered.last().copied()
            {
                items.push(Segment { interval: Interval { start: cursor, end: t }, medium });
            }
            cursor = t;
            if is_start {
                entered.insert(index);
            } else {
                entered.remove(&index);
            }
        }
        items
    }

    /// The last region that holds a point.
    pub fn last_at(&self, regions: &[Region], p: DVec3) -> Option<usize> {
        let mut last = None;
        // Any direction: a ray that ends where it starts meets the boxes that hold the point.
        self.search(&Ray::new(p, DVec3::Z), 0.0, |index| {
            if last.is_none_or(|l| index > l) && regions[index].shape.contains(p) {
                last = Some(index);
            }
        });
        last
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Spectrum;
    use crate::geometry::{Cuboid, Shape, Slab, Sphere};
    use crate::light::{Light, Point};
    use crate::math::{Asymmetry, warp};
    use crate::medium::Homogeneous;
    use crate::phase::Phase;
    use crate::rng::{Purpose, Stream};
    use crate::scene::{SURROUNDINGS, Scene, SceneParts};

    fn region(shape: Shape, sigma_t: f64) -> Region {
        let phase = Phase::with_asymmetry(Asymmetry::new("g", 0.0).unwrap());
        let medium = Homogeneous::new(Spectrum::grey(sigma_t), Spectrum::ONE, phase).unwrap();
        Region { shape, medium: medium.into() }
    }

    fn scene(regions: Vec<Region>) -> Scene {
        let light = Point::new(DVec3::splat(50.0), Spectrum::ONE).unwrap();
        Scene::new(SceneParts { regions, lights: vec![Light::Point(light)], ..SceneParts::default() })
            .unwrap()
    }

    fn place(stream: &mut Stream, side: f64) -> DVec3 {
        (DVec3::from(stream.triple()) - 0.5) * side
    }

    /// Regions that overlap at random, one shape in ten a slab: along random rays each stretch has the medium of the last region
    /// that holds its middle, stretches are disjoint and in order, and between them no region is.
    #[test]
    fn many_regions_are_those_that_hold_each_point() {
        let mut stream = Stream::new(1, Purpose::Synthetic, 0, 0);
        for count in [9, 30, 300] {
            let regions: Vec<Region> = (0..count)
                .map(|i| {
                    let (p, size) = (place(&mut stream, 8.0), 0.1 + 2.0 * stream.unit());
                    let shape = match i % 10 {
                        0 => Shape::Slab(Slab::new(p.z, 0.1 * size).unwrap()),
                        1..5 => Shape::Sphere(Sphere::new(p, 0.5 * size).unwrap()),
                        _ => Shape::Cuboid(Cuboid::new(p, p + size * DVec3::from(stream.triple())).unwrap()),
                    };
                    region(shape, 1.0)
                })
                .collect();
            let scene = scene(regions);
            let at = |p: DVec3| scene.regions().iter().rposition(|r| r.shape.contains(p));
            for _ in 0..300 {
                let dir = warp::square_to_sphere(stream.pair()).normalize();
                let ray = Ray::new(place(&mut stream, 12.0), dir);
                let end = 20.0 * stream.unit();
                let segments = scene.segments(&ray, end, SURROUNDINGS);
                let (mut cursor, mut gaps) = (0.0, Vec::new());
                for segment in segments.iter() {
                    let Interval { start, end } = segment.interval;
                    assert!(start >= cursor && end > start);
                    assert_eq!(at(ray.at(0.5 * (start + end))), Some(segment.medium));
                    gaps.push((cursor, start));
                    cursor = end;
                }
                gaps.push((cursor, end));
                assert!(cursor <= end);
                for (start, end) in gaps.into_iter().filter(|(start, end)| end - start > 1e-9) {
                    assert_eq!(at(ray.at(0.5 * (start + end))), None);
                }
                let p = place(&mut stream, 10.0);
                assert_eq!(scene.medium_number_at(p), at(p));
            }
        }
        // Unbounded ones alone have no tree, and are many all the same.
        let layers = (0..20).map(|i| region(Shape::Slab(Slab::new(f64::from(i), 0.5).unwrap()), 1.0));
        let scene = scene(layers.collect());
        let ray = Ray::new(DVec3::new(0.3, 0.2, -1.0), DVec3::Z);
        assert_eq!(scene.segments(&ray, f64::INFINITY, SURROUNDINGS).iter().count(), 20);
    }

    /// A cube of fog cut into 512 is the cube of fog, along any ray and for any number of cuts.
    #[test]
    fn a_cube_in_pieces_is_the_cube() {
        let pieces = |n: usize| -> Scene {
            let step = 1.0 / n as f64;
            let corner = |i: usize, j: usize, k: usize| DVec3::new(i as f64, j as f64, k as f64) * step;
            let cube = |i, j, k| Cuboid::new(corner(i, j, k), corner(i + 1, j + 1, k + 1)).unwrap();
            let all = (0..n * n * n).map(|c| cube(c % n, c / n % n, c / (n * n)));
            scene(all.map(|cube| region(Shape::Cuboid(cube), 3.0)).collect())
        };
        let (whole, cut) = (pieces(1), pieces(8));
        let mut stream = Stream::new(2, Purpose::Synthetic, 0, 0);
        for _ in 0..500 {
            let ray = Ray::new(
                DVec3::splat(0.5) + place(&mut stream, 3.0),
                warp::square_to_sphere(stream.pair()).normalize(),
            );
            let depth = |scene: &Scene| scene.optical_depth(&ray, f64::INFINITY, 0)[0];
            assert!((depth(&whole) - depth(&cut)).abs() < 1e-13, "{} {}", depth(&whole), depth(&cut));
        }
    }
}
