//! A surface of triangles.

mod file;
mod obj;
mod ply;
mod polygon;
mod shading;
mod triangle;

use super::{ASLANT, Hit, Tree, remainder};
use crate::error::{Error, Result};
use crate::math::Ray;
use glam::{DVec2, DVec3};
use std::collections::HashMap;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::sync::OnceLock;
use triangle::{Shear, closest};

/// Triangles, searched through a tree of single-precision boxes and met in double precision.
///
/// Corners run counter-clockwise seen from outside. Triangles that share an edge leave no gap: a ray into a closed
/// mesh always comes out.
#[derive(Debug, Clone)]
pub struct Mesh {
    /// Corners in the tree's order: the number of a triangle is its place here.
    corners: Vec<[DVec3; 3]>,
    /// Surface parameters at the corners, where the mesh has any.
    uvs: Option<Vec<[DVec2; 3]>>,
    /// Unit normals at the corners of a smooth mesh, on the outer side of their triangle; all 0 of a triangle that is flat.
    normals: Option<Vec<[DVec3; 3]>>,
    tree: Tree,
    bounds: (DVec3, DVec3),
    /// Sum of the areas up to and with each triangle [L^2].
    areas: Vec<f64>,
    dropped: usize,
    /// How far a point computed on the mesh may be off its triangle's plane \[L\].
    rounding: f64,
    /// Whether it has an inside, once that has been asked.
    is_closed: OnceLock<bool>,
    /// What it encloses [L^3], likewise.
    volume: OnceLock<f64>,
}

impl PartialEq for Mesh {
    fn eq(&self, other: &Mesh) -> bool {
        self.corners == other.corners && self.uvs == other.uvs && self.normals == other.normals
    }
}

/// Positions on the mesh are `origin + dir t` with t up to 1000 times the largest coordinate: that rounds to 2^-43
/// of it, and the sum once more.
const ROUNDING: f64 = 1.0 / (1u64 << 42) as f64;

/// Part of the mesh's extent within which a meeting may be that with the edge from which the ray starts.
const NEAR: f64 = 1.0 / (1u64 << 20) as f64;

/// Whether each triangle has the three corners of an earlier one, in whatever order.
fn repeated(triangles: &[[DVec3; 3]]) -> Vec<bool> {
    let bits = |triangle: &[DVec3; 3]| {
        // Adding 0 makes -0 the same as 0.
        let mut bits = triangle.map(|p| (p + DVec3::ZERO).to_array().map(f64::to_bits));
        bits.sort_unstable();
        bits
    };
    let mut by_hash: Vec<(u64, u32)> = (0u32..)
        .zip(triangles)
        .map(|(i, triangle)| {
            let mut hasher = DefaultHasher::new();
            bits(triangle).hash(&mut hasher);
            (hasher.finish(), i)
        })
        .collect();
    by_hash.sort_unstable();
    let mut again = vec![false; triangles.len()];
    // Others of the same hash are compared with the first: a third one that only shares the hash may stay.
    for alike in by_hash.chunk_by(|a, b| a.0 == b.0).filter(|alike| alike.len() > 1) {
        let first = bits(&triangles[alike[0].1 as usize]);
        for (_, i) in &alike[1..] {
            again[*i as usize] = bits(&triangles[*i as usize]) == first;
        }
    }
    again
}

/// Memory that a triangle takes while its mesh is made \[bytes\], its tree included.
pub(super) const TRIANGLE_BYTES: f64 = 500.0;
/// What normals add to it \[bytes\]: those given and those kept.
const NORMALS_BYTES: f64 = 150.0;

impl Mesh {
    /// A mesh from corner positions \[L\], three places among them for each triangle, and surface parameters by
    /// triangle where there are any.
    ///
    /// Triangles without area are dropped, since they have no normal, and of those with the same three corners all but the
    /// first, which is the one that rays meet ([`Mesh::dropped`] counts them).
    ///
    /// # Errors     `Error::Scene` for positions that are not finite, places outside the list, nothing left,
    /// or more than the memory that is free
    pub fn new(positions: &[DVec3], triangles: &[[u32; 3]], uvs: Option<&[[DVec2; 3]]>) -> Result<Self> {
        Mesh::build(positions, triangles, uvs, None)
    }

    /// A mesh that scatters light about normals interpolated between those at its corners, given by triangle, of any length.
    ///
    /// Where one of them is 0 or not finite the triangle stays flat. Three that lie behind it are turned, since its corners
    /// say which side is the outer one; where some do and some do not, or lie in its plane, the triangle stays flat too.
    ///
    /// # Errors     those of [`Mesh::new`]
    pub fn smooth(
        positions: &[DVec3],
        triangles: &[[u32; 3]],
        uvs: Option<&[[DVec2; 3]]>,
        normals: &[[DVec3; 3]],
    ) -> Result<Self> {
        Mesh::build(positions, triangles, uvs, Some(normals))
    }

    fn build(
        positions: &[DVec3],
        triangles: &[[u32; 3]],
        uvs: Option<&[[DVec2; 3]]>,
        normals: Option<&[[DVec3; 3]]>,
    ) -> Result<Self> {
        if let Some(bad) = positions.iter().position(|p| !p.is_finite()) {
            return Err(Error::Scene(format!("corner {} of a mesh is not finite", bad + 1)));
        }
        if uvs.is_some_and(|uvs| uvs.len() != triangles.len() || uvs.iter().flatten().any(|c| !c.is_finite()))
        {
            return Err(Error::Scene("a mesh needs finite surface parameters for every triangle".into()));
        }
        if normals.is_some_and(|normals| normals.len() != triangles.len()) {
            return Err(Error::Scene("a smooth mesh needs three normals for every triangle".into()));
        }
        let what = || format!("a mesh of {} triangles", triangles.len());
        let bytes = TRIANGLE_BYTES + if normals.is_some() { NORMALS_BYTES } else { 0.0 };
        crate::memory::check(what, bytes * triangles.len() as f64)?;
        let corner = |place: u32| {
            positions.get(place as usize).copied().ok_or_else(|| {
                Error::Scene(format!(
                    "a triangle names corner {place}; allowed: 0 to {}",
                    positions.len() as i64 - 1
                ))
            })
        };
        let (mut corners, mut kept) =
            (Vec::with_capacity(triangles.len()), Vec::with_capacity(triangles.len()));
        for (i, [a, b, c]) in triangles.iter().enumerate() {
            let triangle = [corner(*a)?, corner(*b)?, corner(*c)?];
            if unit_normal(&triangle).is_some() {
                corners.push(triangle);
                kept.push(i);
            }
        }
        if corners.is_empty() {
            return Err(Error::Scene(format!(
                "a mesh needs a triangle with an area; here none of {}",
                triangles.len()
            )));
        }
        let again = repeated(&corners);
        let first = corners.into_iter().zip(kept).zip(again).filter(|(_, again)| !again);
        let (corners, kept): (Vec<_>, Vec<_>) = first.map(|(triangle, _)| triangle).unzip();
        let dropped = triangles.len() - corners.len();
        let boxes: Vec<(DVec3, DVec3)> =
            corners.iter().map(|[a, b, c]| (a.min(*b).min(*c), a.max(*b).max(*c))).collect();
        let bounds = boxes.iter().fold(boxes[0], |(a, b), x| (a.min(x.0), b.max(x.1)));
        let rounding = ROUNDING * bounds.0.abs().max(bounds.1.abs()).max_element();
        let (tree, order) = Tree::new("triangles", &boxes, rounding)?;
        let corners: Vec<[DVec3; 3]> = order.iter().map(|&i| corners[i as usize]).collect();
        let uvs = uvs.map(|uvs| order.iter().map(|&i| uvs[kept[i as usize]]).collect());
        let normals = normals.map(|normals| {
            let given = order.iter().map(|&i| normals[kept[i as usize]]);
            let at_corners = |(corners, given)| {
                unit_normal(corners).map_or(shading::FLAT, |own| shading::at_corners(own, given))
            };
            corners.iter().zip(given).map(at_corners).collect()
        });
        let mut sum = 0.0;
        let areas = corners
            .iter()
            .map(|[a, b, c]| {
                sum += 0.5 * (b - a).cross(c - a).length();
                sum
            })
            .collect();
        Ok(Mesh {
            corners,
            uvs,
            normals,
            tree,
            bounds,
            areas,
            dropped,
            rounding,
            is_closed: OnceLock::new(),
            volume: OnceLock::new(),
        })
    }

    /// Number of triangles.
    pub fn len(&self) -> usize {
        self.corners.len()
    }

    /// Whether there is no triangle: never.
    pub fn is_empty(&self) -> bool {
        self.corners.is_empty()
    }

    /// Corners of a triangle \[L\], by its number in [`Hit::primitive`].
    pub fn triangle(&self, primitive: u32) -> [DVec3; 3] {
        self.corners[primitive as usize]
    }

    /// Whether light scatters about normals that are interpolated between corners.
    pub fn is_smooth(&self) -> bool {
        self.normals.is_some()
    }

    /// Unit normals at the corners of a triangle: those that are interpolated, or its own.
    pub fn normals(&self, primitive: u32) -> [DVec3; 3] {
        let index = primitive as usize;
        let own = || [unit_normal(&self.corners[index]).unwrap_or(DVec3::Z); 3];
        let given = self.normals.as_ref().map(|normals| normals[index]);
        given.filter(|normals| *normals != shading::FLAT).unwrap_or_else(own)
    }

    /// Number of triangles without area, or with the corners of an earlier one, that were left out.
    pub fn dropped(&self) -> usize {
        self.dropped
    }

    /// Lower and upper corner of the box around it \[L\].
    pub fn bounds(&self) -> (DVec3, DVec3) {
        self.bounds
    }

    /// The first triangle ahead; `from` is the triangle that the ray starts on.
    pub fn hit(&self, ray: &Ray, from: Option<u32>) -> Option<Hit> {
        let shear = Shear::new(ray);
        let mut best: Option<(usize, f64, [f64; 3])> = None;
        self.tree.search(ray, f64::INFINITY, |index, end| {
            if from == Some(index as u32) {
                return end;
            }
            let corners = &self.corners[index];
            let Some(meeting) = shear.meet(corners) else { return end };
            let Some(t) = self.next_distance(ray, meeting.t, corners, from) else { return end };
            // At an edge that several share, the one of the lowest number: whatever order the tree looks in.
            if best.is_none_or(|(other, nearest, _)| t < nearest || (t == nearest && index < other)) {
                best = Some((index, t, meeting.weights));
            }
            best.map_or(end, |(_, nearest, _)| nearest)
        });
        let (index, t, weights) = best?;
        let normal = unit_normal(&self.corners[index])?;
        let uv = match &self.uvs {
            Some(uvs) => (0..3).fold(DVec2::ZERO, |sum, i| sum + uvs[index][i] * weights[i]),
            None => DVec2::new(weights[1], weights[2]),
        };
        let shading = match &self.normals {
            Some(normals) => shading::interpolated(&normals[index], weights, normal),
            None => normal,
        };
        Some(Hit { t, normal, shading, uv, primitive: index as u32 })
    }

    /// Whether a triangle stands before distance `end` \[L\]; `from` is the triangle that the ray starts on.
    pub fn blocks(&self, ray: &Ray, from: Option<u32>, end: f64) -> bool {
        let shear = Shear::new(ray);
        let mut is_blocked = false;
        self.tree.search(ray, end, |index, end| {
            if is_blocked || from == Some(index as u32) {
                return end;
            }
            let corners = &self.corners[index];
            is_blocked = shear
                .meet(corners)
                .and_then(|meeting| self.next_distance(ray, meeting.t, corners, from))
                .is_some_and(|t| t < end);
            // One is enough: nothing is nearer than this.
            if is_blocked { f64::NEG_INFINITY } else { end }
        });
        is_blocked
    }

    /// The distance of a meeting that lies ahead, or none.
    ///
    /// Near the edge from which a ray starts rounding decides whether the neighbour is met just ahead or just behind.
    /// There the shape decides: the neighbour is ahead if the start's triangle rises on the side of it from which the
    /// ray comes, as in a hollow, and is not on a ridge or in a plane; and a ray that is outside can only enter.
    #[inline]
    fn next_distance(&self, ray: &Ray, t: f64, corners: &[DVec3; 3], from: Option<u32>) -> Option<f64> {
        let extent = (self.bounds.1 - self.bounds.0).max_element();
        let Some(from) = from.filter(|_| t.abs() <= NEAR * extent) else { return (t > 0.0).then_some(t) };
        let normal = unit_normal(corners)?;
        let cosine = ray.dir.dot(normal);
        if (t * cosine).abs() > self.rounding {
            return (t > 0.0).then_some(t);
        }
        let start = &self.corners[from as usize];
        let rise = |p: &DVec3| (*p - corners[0]).dot(normal) * -cosine.signum();
        let is_hollow = start.iter().any(|p| rise(p) > self.rounding);
        let enters_or_leaves = unit_normal(start)?.dot(ray.dir) * cosine < 0.0;
        (is_hollow && enters_or_leaves).then_some(t.max(0.0))
    }

    /// Whether a point lies inside a closed mesh: the first crossing of a ray from it tells.
    pub fn contains(&self, p: DVec3) -> bool {
        let ray = Ray::new(p, ASLANT);
        let shear = Shear::new(&ray);
        // The nearest crossing leaves the body if the point is inside.
        let mut nearest = (f64::INFINITY, 0.0);
        self.tree.search(&ray, f64::INFINITY, |index, end| {
            let corners = &self.corners[index];
            if let Some(meeting) = shear.meet(corners)
                && meeting.t > 0.0
                && meeting.t < nearest.0
                && let Some(normal) = unit_normal(corners)
            {
                nearest = (meeting.t, normal.dot(ray.dir));
            }
            end.min(nearest.0)
        });
        nearest.1 > 0.0
    }

    /// Distance from a point to the surface, or `limit` where that is farther \[L\].
    pub fn distance(&self, p: DVec3, limit: f64) -> f64 {
        let mut nearest = limit;
        self.tree.near(p, limit, |index, reach| {
            nearest = nearest.min(p.distance(closest(&self.corners[index], p)));
            nearest.min(reach)
        });
        nearest
    }

    /// Whether every edge joins two triangles that turn the same way: then the mesh has an inside.
    pub fn is_closed(&self) -> bool {
        *self.is_closed.get_or_init(|| self.has_inside())
    }

    fn has_inside(&self) -> bool {
        let bits = |p: DVec3| (p + 0.0).to_array().map(f64::to_bits);
        let mut edges: HashMap<[[u64; 3]; 2], i32> = HashMap::with_capacity(self.corners.len() * 3 / 2);
        for triangle in &self.corners {
            for i in 0..3 {
                let (a, b) = (bits(triangle[i]), bits(triangle[(i + 1) % 3]));
                let (key, turn) = if a < b { ([a, b], 1) } else { ([b, a], -1) };
                *edges.entry(key).or_default() += turn;
            }
        }
        edges.values().all(|&turns| turns == 0)
    }

    /// Area [L^2] of the outer sides.
    pub fn area(&self) -> f64 {
        self.areas.last().copied().unwrap_or(0.0)
    }

    /// Volume that a closed mesh encloses [L^3]: the sum of the pyramids over its triangles.
    pub fn volume(&self) -> f64 {
        let middle = 0.5 * (self.bounds.0 + self.bounds.1);
        let pyramid = |[a, b, c]: &[DVec3; 3]| (a - middle).dot((b - middle).cross(c - middle)) / 6.0;
        *self.volume.get_or_init(|| self.corners.iter().map(pyramid).sum())
    }

    /// A uniform point of the surface, the outward normal there and the number of its triangle, from two numbers
    /// in [0, 1).
    pub fn sample_surface(&self, [u, w]: [f64; 2]) -> (DVec3, DVec3, u32) {
        let target = u * self.area();
        let index = self.areas.partition_point(|&sum| sum <= target).min(self.corners.len() - 1);
        let [a, b, c] = self.corners[index];
        let v = remainder(&self.areas, index, target);
        // The square folded into a triangle: the root of v is the distance from the first corner.
        let root = v.sqrt();
        let p = a * (1.0 - root) + b * (root * (1.0 - w)) + c * (root * w);
        (p, unit_normal(&self.corners[index]).unwrap_or(DVec3::Z), index as u32)
    }

    /// Shortest edge of the box around it \[L\].
    pub fn shortest_extent(&self) -> f64 {
        (self.bounds.1 - self.bounds.0).min_element()
    }
}

/// The outward unit normal of a triangle, none without an area. Edges are scaled first, so that no size underflows.
fn unit_normal([a, b, c]: &[DVec3; 3]) -> Option<DVec3> {
    let (u, v) = (b - a, c - a);
    let size = u.abs().max(v.abs()).max_element();
    if size == 0.0 {
        return None;
    }
    (u / size).cross(v / size).try_normalize()
}
