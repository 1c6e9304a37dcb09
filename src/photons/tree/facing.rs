//! Searches on a surface: photons that lie along its tangent plane, on surfaces that face the same way. What is rejected
//! sets no radius.

use super::PhotonTree;
use super::block::Row;
use super::boxes::Probe;
use super::nearest::{Counted, Nearest, Shell, Sphere, share};
use super::scratch::{Last, Scratch, with_scratch};
use super::units::LIMIT;
use super::within::Visit;
use glam::DVec3;
use wide::f32x8;

/// The tangent plane at a point of a surface: which photons, and which points of surfaces, count there.
///
/// What lies at distance d of the point is accepted if it is at most `slope` d from the plane, and if its own normal n, on
/// the side where light arrives, is at most `turn` from the tangent's: |n - normal|. The bounds do not depend on the
/// radius of a search, so that neither does whether a photon is accepted; and they ask for nothing but the place on a
/// surface, so that the accepted part of the surface is known ([`Tangent::accepts`]). On a sphere of radius R the chord d
/// lies d^2/(2R) off the plane and turns the normal by d/R: the bounds end at 2 R slope and R turn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tangent {
    /// Unit normal, on the side where light arrives.
    pub normal: DVec3,
    /// Largest sine between the plane and the way to a photon.
    pub slope: f64,
    /// Largest distance of the normals, unit vectors: 2 sin of half the angle between them.
    pub turn: f64,
}

impl Tangent {
    /// Whether a point of a surface is accepted: the way to it from the tangent's own point \[L\], and its unit normal.
    pub fn accepts(&self, way: DVec3, normal: DVec3) -> bool {
        let height = way.dot(self.normal);
        height * height <= self.slope * self.slope * way.length_squared()
            && (normal - self.normal).length_squared() <= self.turn * self.turn
    }
}

/// The plane as searches use it.
struct FacingFilter {
    normal: [f32x8; 3],
    slope2: f32x8,
    /// What rounding of stored coordinates can put a photon beside its plane, squared, in the tree's units.
    rounding2: f32x8,
    /// Largest squared distance of normals.
    turn2: f32x8,
}

impl FacingFilter {
    fn new(tangent: &Tangent) -> Self {
        let splat = |x: f64| f32x8::splat(x as f32);
        let normal = tangent.normal.to_array().map(splat);
        // Three coordinates of two points, each wrong by 2^-25 and by as much again in the products.
        let rounding = 12.0 / f64::from(1u32 << 25);
        // Three coordinates of two unit normals, each wrong by 2^-25, and their differences.
        let turn = tangent.turn + rounding;
        FacingFilter {
            normal,
            slope2: splat(tangent.slope * tangent.slope),
            rounding2: splat(rounding * rounding),
            turn2: splat(turn * turn),
        }
    }

    /// Squared distances of the photons of a row, infinite where they are rejected.
    #[inline(always)]
    fn squared(&self, probe: &Probe, positions: &Row, normals: &Row, squared: f32x8) -> f32x8 {
        let [x, y, z] = probe.offsets(positions);
        let height = x * self.normal[0] + y * self.normal[1] + z * self.normal[2];
        let is_along = (height * height).simd_le(self.slope2 * squared + self.rounding2);
        let [x, y, z] = [0, 1, 2].map(|axis| normals[axis] - self.normal[axis]);
        let is_facing = (x * x + y * y + z * z).simd_le(self.turn2);
        (is_along & is_facing).select(squared, f32x8::splat(f32::INFINITY))
    }
}

impl PhotonTree {
    /// [`PhotonTree::nearest`] among the photons that `tangent` accepts.
    pub fn nearest_facing(
        &self,
        centre: DVec3,
        tangent: &Tangent,
        k: usize,
        max_radius: f64,
        counted: Counted,
        visitor: &mut impl Visit,
    ) -> Nearest {
        let point = self.units.relative(centre);
        if self.stored < k
            || self.normals.is_empty()
            || !centre.is_finite()
            || point.abs().max_element() > LIMIT
        {
            return Nearest::Underfull;
        }
        let cap = self.units.shrink(max_radius).min(4.0 * LIMIT);
        let cap2 = (cap * cap) as f32;
        let filter = FacingFilter::new(tangent);
        with_scratch(|scratch| {
            match scratch.find_facing(self, point.as_vec3().to_array(), &filter, k, cap2) {
                None => Nearest::Underfull,
                Some(sphere) => {
                    let (radius, inverse_r2) = (f32x8::splat(sphere.squared), 1.0 / sphere.squared);
                    let share = share(&sphere, k, counted);
                    for (&row, &squared) in scratch.rows[..scratch.end].iter().zip(&scratch.squared) {
                        let row = row as usize;
                        let inside = squared.simd_lt(radius);
                        if inside.any() {
                            visitor.visit(self.neighbors(row, (squared, inverse_r2), inside, 1.0));
                        }
                        let tied = squared.simd_eq(radius);
                        if share > 0.0 && tied.any() {
                            visitor.visit(self.neighbors(row, (squared, inverse_r2), tied, share));
                        }
                    }
                    Nearest::Found(Shell {
                        radius: self.units.stretch(f64::from(sphere.squared).sqrt()),
                        closer: sphere.closer,
                        tied: sphere.tied,
                        coincident: sphere.coincident,
                    })
                }
            }
        })
    }

    /// [`PhotonTree::within`] among the photons that `tangent` accepts; nothing is near a point that is farther than
    /// 2^60 times the map's size.
    pub fn within_facing(&self, centre: DVec3, tangent: &Tangent, radius: f64, visitor: &mut impl Visit) {
        let point = self.units.relative(centre);
        if self.normals.is_empty() || !centre.is_finite() || point.abs().max_element() > LIMIT {
            return;
        }
        let r = self.units.shrink(radius).min(4.0 * LIMIT);
        let r2 = ((r * r) as f32).max((1.0 / (LIMIT * LIMIT)) as f32);
        let (probe, filter) = (Probe::new(point.as_vec3().to_array()), FacingFilter::new(tangent));
        with_scratch(|scratch| {
            scratch.measure_facing(self, &probe, &filter, r2);
            let inverse_r2 = 1.0 / r2;
            for (&row, &squared) in scratch.rows[..scratch.end].iter().zip(&scratch.squared) {
                let (row, inside) = (row as usize, squared.simd_le(f32x8::splat(r2)));
                visitor.visit(self.neighbors(row, (squared, inverse_r2), inside, 1.0));
            }
        });
    }
}

impl Scratch {
    /// Rows with accepted photons in the ball of squared radius `r2`, and their squared distances.
    #[inline(always)]
    fn measure_facing(&mut self, tree: &PhotonTree, probe: &Probe, filter: &FacingFilter, r2: f32) {
        tree.touch(probe, r2, self);
        let most = self.touched.len() * 2 + 1;
        if self.rows.len() < most {
            self.rows.resize(most, 0);
            self.squared.resize(most, f32x8::ZERO);
        }
        let bound = f32x8::splat(r2);
        let mut end = 0;
        for &block in &self.touched {
            for (half, positions) in tree.positions[block as usize].iter().enumerate() {
                let row = 2 * block + half as u32;
                let squared = probe.squared_distances(positions);
                if squared.simd_le(bound).any() {
                    let squared = filter.squared(probe, positions, &tree.normals[row as usize], squared);
                    self.rows[end] = row;
                    self.squared[end] = squared;
                    end += usize::from(squared.simd_le(bound).any());
                }
            }
        }
        self.end = end;
    }

    /// Every squared distance of an accepted photon of at most `r2`.
    fn collect_facing(&mut self, tree: &PhotonTree, probe: &Probe, filter: &FacingFilter, r2: f32) {
        self.measure_facing(tree, probe, filter, r2);
        self.keep_near(r2);
    }

    /// The sphere through the k-th accepted photon.
    ///
    /// From a first guess the ball grows, by what is missing, until k are in it: how many a node of the tree holds says
    /// nothing of how many are accepted.
    fn find_facing(
        &mut self,
        tree: &PhotonTree,
        point: [f32; 3],
        filter: &FacingFilter,
        k: usize,
        cap2: f32,
    ) -> Option<Sphere> {
        let probe = Probe::new(point);
        let guess = self.guess(tree, point, k).filter(|g| *g > 0.0);
        let mut trial = guess.unwrap_or_else(|| tree.bound(&probe, k, &mut self.near)).min(cap2);
        let resolved = (1.0 / (LIMIT * LIMIT)) as f32;
        let squared = loop {
            self.collect_facing(tree, &probe, filter, trial);
            if self.near.len() >= k {
                let kth = f32::from_bits(*self.near.select_nth_unstable(k - 1).1);
                // Where k coincide, the next distance out is the radius.
                let next = || self.near.iter().map(|d| f32::from_bits(*d)).filter(|d| *d >= resolved);
                if let Some(squared) = if kth >= resolved { Some(kth) } else { next().reduce(f32::min) } {
                    break squared;
                }
            }
            if trial >= cap2 {
                return None;
            }
            let missing = 1.3 * k as f32 / (self.near.len() + 1) as f32;
            trial = (trial.max(resolved) * missing.clamp(1.3, 8.0)).min(cap2);
        };
        let distances = || self.near.iter().map(|d| f32::from_bits(*d));
        let closer = distances().filter(|d| *d < squared).count();
        let tied = distances().filter(|d| *d == squared).count();
        self.remember(Last { identity: tree.identity, k, point, squared });
        Some(Sphere { squared, closer, tied, coincident: if closer >= k { closer } else { 0 } })
    }
}
