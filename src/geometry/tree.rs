//! A tree over boxes in single precision, wide enough that nothing is missed: of the triangles of a mesh, of the regions
//! of a scene.

use crate::error::{Error, Result};
use crate::math::Ray;
use glam::{DVec3, Vec3A};
use obvhs::BvhBuildParams;
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::node::Bvh2Node;
use obvhs::cwbvh::CwBvh;
use obvhs::cwbvh::builder::build_cwbvh;
use obvhs::cwbvh::bvh2_to_cwbvh::bvh2_to_cwbvh;
use obvhs::ray::{Ray as Ray32, RayHit};
use std::time::Duration;

/// Half the extent of all boxes in the tree's own coordinates. The tree's nodes ignore what ends before a distance of
/// 1e-4; boxes are wider than that on every side, so that nothing is lost.
const HALF: f64 = 4096.0;

/// What every box is widened by, in the tree's coordinates: 128 units in the last place of the largest coordinate.
/// The box test of the tree rounds a coordinate 13 times by up to a unit, a direction of at least [`LEAST`] drifts
/// from the true one by up to 28, and the eight bits that a box is stored in add up to 6.
const PAD: f64 = HALF * 128.0 / 16_777_216.0;

/// Least component of a direction in the tree: below it the tree would replace it, and confuse the signs of zeros.
const LEAST: f32 = 1.0 / 4_194_304.0;

/// Depth that the tree's own stack can follow.
const MAX_DEPTH: usize = 30;

/// Boxes that are one to a millionth of their size: their unions have the same area in single precision, so that more of them are
/// nested too deeply, and would take the square of their number to sort. Some 300 that stretch across the scene are too many
/// already; small ones that lie side by side differ by much of their size.
const MOST_ALIKE: usize = 1000;

/// Boxes that lie over each other but for a part of their size, of which no more are merged one after the other: where the
/// unions of many cost nearly alike, that takes the square of their number.
const MOST_OVER_EACH_OTHER: usize = 64;

/// Whether more boxes than that are one, to one part in 2^`bits` of their size.
fn are_alike(boxes: &[Aabb], bits: u32, most: usize) -> bool {
    if boxes.len() <= most {
        return false;
    }
    let place = |b: &Aabb| {
        // The power of two below that part of the size, which alike boxes share.
        let size = (b.max - b.min).max_element();
        let grain = f64::from(f32::from_bits(size.to_bits() & 0x7f80_0000)) / f64::from(1u32 << bits);
        [b.min, b.max].map(|v| v.to_array().map(|x| (f64::from(x) / grain) as i64))
    };
    let mut places: Vec<[[i64; 3]; 2]> = boxes.iter().map(place).collect();
    places.sort_unstable();
    places.chunk_by(|a, b| a == b).any(|alike| alike.len() > most)
}

/// A tree of boxes cut in halves of as many, across the longest extent of their middles: no better than it need be, in n log n
/// whatever the boxes.
fn halved(boxes: &[Aabb]) -> CwBvh {
    let mut order: Vec<u32> = (0..boxes.len() as u32).collect();
    let mut nodes = vec![Bvh2Node::default()];
    let mut open = vec![(0usize, 0usize, order.len())];
    while let Some((node, start, end)) = open.pop() {
        let part = &mut order[start..end];
        let around = |f: &dyn Fn(&Aabb) -> Aabb| {
            part.iter().map(|&i| f(&boxes[i as usize])).reduce(|a, b| a.union(&b)).unwrap_or_default()
        };
        let aabb = around(&|b| *b);
        if part.len() == 1 {
            nodes[node] = Bvh2Node::new(aabb, 1, start as u32);
            continue;
        }
        let middles = around(&|b| Aabb::new(b.center(), b.center()));
        let extent = middles.max - middles.min;
        let axis = (0..3).fold(0, |best, axis| if extent[axis] > extent[best] { axis } else { best });
        let middle = |i: u32| boxes[i as usize].center()[axis];
        let half = part.len() / 2;
        part.select_nth_unstable_by(half, |&a, &b| middle(a).total_cmp(&middle(b)).then(a.cmp(&b)));
        let first = nodes.len();
        nodes[node] = Bvh2Node::new(aabb, 0, first as u32);
        nodes.extend([Bvh2Node::default(); 2]);
        open.extend([(first, start, start + half), (first + 1, start + half, end)]);
    }
    let tree = Bvh2 { nodes, primitive_indices: order, ..Bvh2::default() };
    bvh2_to_cwbvh(&tree, 3, true, false)
}

/// A tree over boxes, in coordinates of its own: the middle of all boxes is the origin, the longest half-extent is
/// [`HALF`].
#[derive(Debug, Clone)]
pub(crate) struct Tree {
    tree: CwBvh,
    center: DVec3,
    /// Half the extent, widened, by axis \[L\].
    half: DVec3,
    /// Tree's units per L.
    scale: f64,
}

impl Tree {
    /// A tree over boxes (lower and upper corner), each widened by `margin` \[L\], and the order in which it keeps
    /// them: entry i of the tree is box `order[i]`.
    ///
    /// # Arguments  `what` the boxes are about, in the plural: "triangles"
    /// # Errors     `Error::Scene` for boxes too many, too large, too small, or too deeply nested to be searched
    pub fn new(what: &str, boxes: &[(DVec3, DVec3)], margin: f64) -> Result<(Self, Vec<u32>)> {
        if boxes.is_empty() || boxes.len() > 100_000_000 {
            return Err(Error::Scene(format!("{} {what}; allowed: 1 to 1e8", boxes.len())));
        }
        let (min, max) = boxes.iter().fold((boxes[0].0, boxes[0].1), |(a, b), x| (a.min(x.0), b.max(x.1)));
        let center = 0.5 * (min + max);
        let reach = 0.5 * (max - min).max_element();
        if !(1e-100..=1e100).contains(&reach) {
            return Err(Error::out_of_range(
                format!("half the extent of all {what}"),
                reach,
                "1e-100 to 1e100",
            ));
        }
        // Boxes in one far place have no room between them in single precision, or their middle is none that f64 has.
        let farthest = min.abs().max(max.abs()).max_element();
        if farthest > 1e100 {
            return Err(Error::out_of_range(
                format!("a coordinate of the {what}"),
                farthest,
                "up to 1e100 in size",
            ));
        }
        let scale = HALF / reach;
        let pad = PAD.max(2.0 * margin * scale);
        let narrow = |p: DVec3| ((p - center) * scale).as_vec3a();
        let pad32 = Vec3A::splat(pad as f32);
        let boxes32: Vec<Aabb> =
            boxes.iter().map(|(a, b)| Aabb::new(narrow(*a) - pad32, narrow(*b) + pad32)).collect();
        let too_deep = || Error::Scene(format!("{what} nested too deeply in each other to be searched"));
        if are_alike(&boxes32, 20, MOST_ALIKE) {
            return Err(too_deep());
        }
        let tree = if are_alike(&boxes32, 4, MOST_OVER_EACH_OTHER) {
            halved(&boxes32)
        } else {
            build_cwbvh(&boxes32, BvhBuildParams::medium_build(), &mut Duration::default())
        };
        if depth(&tree) > MAX_DEPTH {
            return Err(too_deep());
        }
        let order = tree.primitive_indices.clone();
        Ok((Tree { tree, center, half: 0.5 * (max - min) + pad / scale, scale }, order))
    }

    /// Where the ray enters and leaves the box of all boxes; none if it misses or ends before.
    fn span(&self, ray: &Ray, end: f64) -> Option<f64> {
        let (mut start, mut end) = (0.0f64, end);
        for i in 0..3 {
            let (o, d) = (ray.origin[i] - self.center[i], ray.dir[i]);
            if d == 0.0 {
                if o.abs() > self.half[i] {
                    return None;
                }
                continue;
            }
            let (a, b) = ((-self.half[i] - o) / d, (self.half[i] - o) / d);
            start = start.max(a.min(b));
            end = end.min(a.max(b));
        }
        (start <= end).then_some(start)
    }

    /// Offers `test` the entries whose boxes the ray may meet before distance `end` \[L\], nearer boxes first, with
    /// the distance beyond which nothing is looked for any more; `test` returns what that distance is from now on.
    #[inline]
    pub fn search(&self, ray: &Ray, end: f64, mut test: impl FnMut(usize, f64) -> f64) {
        // From where the ray enters the box of all boxes: then single precision suffices, however far the origin.
        let Some(start) = self.span(ray, end) else { return };
        let origin = ((ray.at(start) - self.center) * self.scale).as_vec3a();
        let dir = ray.dir.as_vec3a();
        let least = Vec3A::select(dir.cmplt(Vec3A::ZERO), Vec3A::splat(-LEAST), Vec3A::splat(LEAST));
        let dir = Vec3A::select(dir.abs().cmplt(Vec3A::splat(LEAST)), least, dir);
        // Rounded up, and no nearer than the boxes are wide of their triangles.
        let narrow = |t: f64| ((t - start) * self.scale * (1.0 + 2.4e-7) + PAD) as f32;
        let mut end = end;
        self.tree.ray_traverse(Ray32::new(origin, dir, 0.0, narrow(end)), &mut RayHit::none(), |_, entry| {
            end = test(entry, end);
            narrow(end)
        });
    }

    /// Offers `test` the entries whose boxes may be nearer to a point than `reach` \[L\], nearer boxes first; `test` returns
    /// what that distance is from now on.
    pub fn near(&self, point: DVec3, reach: f64, mut test: impl FnMut(usize, f64) -> f64) {
        let point = (point - self.center) * self.scale;
        let mut reach = reach;
        let mut open = vec![(0.0, 0usize)];
        while let Some((distance, index)) = open.pop() {
            let Some(node) = self.tree.nodes.get(index).filter(|_| distance <= reach * self.scale) else {
                continue;
            };
            let first = open.len();
            for child in (0..8).filter(|&child| !node.is_child_empty(child)) {
                // Boxes are wider than what they hold by more than single precision rounds.
                let around = node.child_aabb(child);
                let distance = point.distance(point.clamp(around.min.as_dvec3(), around.max.as_dvec3()));
                if distance > reach * self.scale {
                    continue;
                }
                if node.is_leaf(child) {
                    let (first, count) = node.child_primitives(child);
                    for entry in first..first + count {
                        reach = test(entry as usize, reach);
                    }
                } else {
                    open.push((distance, node.child_node_index(child) as usize));
                }
            }
            open[first..].sort_by(|a, b| b.0.total_cmp(&a.0));
        }
    }
}

/// Number of levels of nodes.
fn depth(tree: &CwBvh) -> usize {
    let mut deepest = 0;
    let mut open = vec![(0usize, 1usize)];
    while let Some((index, level)) = open.pop() {
        let Some(node) = tree.nodes.get(index) else { continue };
        deepest = deepest.max(level);
        let inner = (0..8).filter(|&child| !node.is_leaf(child));
        open.extend(inner.map(|child| (node.child_node_index(child) as usize, level + 1)));
    }
    deepest
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Boxes over each other but for a part of their size, and nested ones, as many as merging one by one took minutes for:
    /// every box that a ray meets is offered.
    #[test]
    fn boxes_over_each_other_are_found() {
        let many = 30_000;
        for apart in [1e-12, 1e-6, 1e-4] {
            let step = |i: u32| f64::from(i) * apart;
            let beside = |i| (DVec3::new(0.0, 0.0, step(i)), DVec3::new(1.0, 1.0, step(i) + 1e-3));
            let nested = |i| (DVec3::splat(-step(i)), DVec3::splat(1.0 + step(i)));
            for (name, boxes) in [
                ("beside", (0..many).map(beside).collect::<Vec<_>>()),
                ("nested", (0..many).map(nested).collect()),
            ] {
                let built = Tree::new("boxes", &boxes, 0.0);
                if apart < 1e-9 {
                    assert!(built.is_err(), "{name}, {apart} apart");
                    continue;
                }
                let (tree, order) = built.unwrap();
                let mut found = vec![0u32; boxes.len()];
                let ray = Ray::new(DVec3::new(0.3, 0.4, -100.0), DVec3::Z);
                tree.search(&ray, f64::INFINITY, |entry, end| {
                    found[order[entry] as usize] += 1;
                    end
                });
                assert!(found.iter().all(|&n| n == 1), "{name}, {apart} apart");
            }
        }
    }
}
