//! The k nearest photons, without a heap: a bound, every squared distance below it, the k-th of them.

use super::PhotonTree;
use super::block::BLOCK;
use super::boxes::Probe;
use super::scratch::{Last, Scratch, with_scratch};
use super::units::LIMIT;
use super::within::Visit;
use glam::DVec3;
use wide::f32x8;

/// What a search for the k nearest photons found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Nearest {
    /// The k-th photon is within the cap.
    Found(Shell),
    /// Fewer than k photons are within the cap, or all that are coincide with the query point; none was
    /// visited.
    Underfull,
}

/// The sphere through the k-th photon.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shell {
    /// Distance of the k-th photon \[L\], above zero.
    pub radius: f64,
    /// Photons strictly nearer.
    pub closer: usize,
    /// Photons at that distance, the k-th among them.
    pub tied: usize,
    /// Photons at distance zero if there were k or more of them, so that the shell is the next one out; else
    /// 0.
    pub coincident: usize,
}

/// Which photons of the shell count.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Counted {
    /// The k-1 nearer ones.
    BelowKth,
    /// The k-th too.
    UpToKth,
}

/// The sphere in the tree's units.
pub(super) struct Sphere {
    pub(super) squared: f32,
    pub(super) closer: usize,
    pub(super) tied: usize,
    pub(super) coincident: usize,
}

impl PhotonTree {
    /// Visits the photons nearer to `centre` than the `k`-th, in the tree's order, and says how far the k-th
    /// is.
    ///
    /// The k-1 nearer photons count in full. Photons that tie with the k-th, as stored, share what is missing
    /// from k-1 (from k for [`Counted::UpToKth`]) in equal parts, so that exactly k-1 (k) count, whatever
    /// their order.
    ///
    /// If k or more photons coincide with `centre`, no ball of positive volume has the k-th on its surface:
    /// the search goes out to the next distance at which there is a photon, all those at the centre count,
    /// and [`Shell::coincident`] tells how many they were.
    ///
    /// Nothing is near a point that is not finite. `k` is at least 1; photons beyond `max_radius` \[L\] are not looked at.
    #[inline(always)]
    pub fn nearest(
        &self,
        centre: DVec3,
        k: usize,
        max_radius: f64,
        counted: Counted,
        visitor: &mut impl Visit,
    ) -> Nearest {
        if self.stored < k || !centre.is_finite() {
            return Nearest::Underfull;
        }
        let point = self.units.relative(centre);
        let cap = self.units.shrink(max_radius);
        if point.abs().max_element() > LIMIT {
            return self.nearest_point(centre, k, max_radius, counted, visitor);
        }
        let cap2 = (cap.min(4.0 * LIMIT) * cap.min(4.0 * LIMIT)) as f32;
        with_scratch(|scratch| match scratch.find(self, point.as_vec3().to_array(), k, cap2) {
            None => Nearest::Underfull,
            Some(sphere) => {
                let share = share(&sphere, k, counted);
                let (radius, inverse_r2) = (f32x8::splat(sphere.squared), 1.0 / sphere.squared);
                for (&row, &squared) in scratch.rows[..scratch.end].iter().zip(&scratch.squared) {
                    let (row, inside) = (row as usize, squared.simd_lt(radius));
                    if inside.any() {
                        visitor.visit(self.neighbors(row, (squared, inverse_r2), inside, 1.0));
                    }
                }
                if share > 0.0 {
                    self.visit_tied(scratch, sphere.squared, share, visitor);
                }
                Nearest::Found(Shell {
                    radius: self.units.stretch(f64::from(sphere.squared).sqrt()),
                    closer: sphere.closer,
                    tied: sphere.tied,
                    coincident: sphere.coincident,
                })
            }
        })
    }

    /// Photons exactly as far as the k-th, where some of them count.
    #[cold]
    fn visit_tied(&self, scratch: &Scratch, r2: f32, share: f32, visitor: &mut dyn Visit) {
        for (&row, &squared) in scratch.rows[..scratch.end].iter().zip(&scratch.squared) {
            let (row, inside) = (row as usize, squared.simd_eq(f32x8::splat(r2)));
            if inside.any() {
                visitor.visit(self.neighbors(row, (squared, 1.0 / r2), inside, share));
            }
        }
    }

    /// From more than 2^60 times its size away the map is one point: every photon ties.
    #[cold]
    fn nearest_point(
        &self,
        centre: DVec3,
        k: usize,
        max_radius: f64,
        counted: Counted,
        visitor: &mut dyn Visit,
    ) -> Nearest {
        let away = centre - self.units.absolute([0.0; 3]);
        let longest = away.abs().max_element();
        let radius = (away / longest).length() * longest;
        if radius > max_radius {
            return Nearest::Underfull;
        }
        let sphere = Sphere { squared: 1.0, closer: 0, tied: self.stored, coincident: 0 };
        let share = share(&sphere, k, counted);
        for (row, squared) in self.all_at(1.0) {
            let inside = squared.simd_le(f32x8::ONE);
            visitor.visit(self.neighbors(row, (squared, 1.0), inside, share));
        }
        Nearest::Found(Shell { radius, closer: 0, tied: self.stored, coincident: 0 })
    }

    /// The squared distance within which k photons are certain to be: the k-th of the nearest node that has
    /// as many, a node of the finest level at least.
    pub(super) fn bound(&self, probe: &Probe, k: usize, near: &mut Vec<u32>) -> f32 {
        let (mut first, mut blocks) = (0, self.positions.len());
        let mut node = 0;
        for level in (1..self.levels.len()).rev() {
            let to_boxes = probe.squared_distances_to_boxes(&self.levels[level][node]);
            let nearest =
                (0..16).fold(0, |best, lane| if to_boxes[lane] < to_boxes[best] { lane } else { best });
            let child = node * 16 + nearest;
            let width = 1usize << (4 * level);
            let child_blocks = width.min(self.positions.len() - child * width);
            let photons = (child_blocks * BLOCK).min(self.stored - child * width * BLOCK);
            if photons < k {
                break;
            }
            (node, first, blocks) = (child, child * width, child_blocks);
        }
        near.clear();
        for positions in self.positions[first..first + blocks].iter().flatten() {
            near.extend(probe.squared_distances(positions).as_array().iter().map(|d| d.to_bits()));
        }
        f32::from_bits(*near.select_nth_unstable(k - 1).1)
    }
}

/// The part of each tied photon that counts.
pub(super) fn share(sphere: &Sphere, k: usize, counted: Counted) -> f32 {
    let nearer = if sphere.coincident > 0 { sphere.closer } else { k - 1 };
    let counts = nearer + usize::from(counted == Counted::UpToKth);
    ((counts - sphere.closer) as f64 / sphere.tied as f64) as f32
}

impl Scratch {
    /// The sphere through the k-th photon; `rows` and `squared` then hold every row that it meets.
    fn find(&mut self, tree: &PhotonTree, point: [f32; 3], k: usize, cap2: f32) -> Option<Sphere> {
        let probe = Probe::new(point);
        let guess = self.guess(tree, point, k).unwrap_or(0.0);
        if guess > 0.0 && guess < cap2 {
            self.collect(tree, &probe, guess);
        }
        if guess == 0.0 || guess >= cap2 || self.near.len() < k {
            let bound = tree.bound(&probe, k, &mut self.near).min(cap2);
            self.collect_enough(tree, &probe, k, guess, bound);
            if self.near.len() < k {
                return None;
            }
        }
        let (nearer, &mut kth, farther) = self.near.select_nth_unstable(k - 1);
        let kth = f32::from_bits(kth);
        if kth < (1.0 / (LIMIT * LIMIT)) as f32 {
            return self.beyond_coincident(tree, &probe, cap2);
        }
        let closer = nearer.iter().filter(|&&d| f32::from_bits(d) < kth).count();
        let tied = k - closer + farther.iter().filter(|&&d| f32::from_bits(d) == kth).count();
        self.remember(Last { identity: tree.identity, k, point, squared: kth });
        Some(Sphere { squared: kth, closer, tied, coincident: 0 })
    }

    /// Half as many photons again as the last search found, if that was nearby: a guess that may fail.
    pub(super) fn guess(&self, tree: &PhotonTree, point: [f32; 3], k: usize) -> Option<f32> {
        let last = self.last_in(tree.identity).filter(|last| last.k == k)?;
        let step = [0, 1, 2].map(|axis| point[axis] - last.point[axis]);
        let moved = step[0] * step[0] + step[1] * step[1] + step[2] * step[2];
        (moved < last.squared).then_some(last.squared * 1.3)
    }

    /// Collects at least k photons if `bound` holds as many, and not many more: beside a dense region a ball
    /// that is certain to hold k may hold thousands of times as many. `below` is known to hold fewer than k.
    fn collect_enough(&mut self, tree: &PhotonTree, probe: &Probe, k: usize, below: f32, bound: f32) {
        let many = k / 4 + 64;
        let mut trial = bound;
        tree.touch(probe, trial, self);
        while self.touched.len() > many && 0.5 * trial > below {
            trial *= 0.5;
            tree.touch(probe, trial, self);
        }
        self.collect(tree, probe, trial);
        while self.near.len() < k && trial < bound {
            trial = (trial * 1.25).min(bound);
            self.collect(tree, probe, trial);
        }
    }

    /// Every squared distance of at most `bound`, and the blocks they are in.
    fn collect(&mut self, tree: &PhotonTree, probe: &Probe, bound: f32) {
        tree.touch(probe, bound, self);
        self.measure(tree, |positions| probe.squared_distances(positions), bound);
        self.keep_near(bound);
    }

    /// The sphere through the nearest photon that is not at the centre, where k or more are.
    fn beyond_coincident(&mut self, tree: &PhotonTree, probe: &Probe, cap2: f32) -> Option<Sphere> {
        self.collect(tree, probe, cap2);
        let resolved = (1.0 / (LIMIT * LIMIT)) as f32;
        let distances = || self.near.iter().map(|&d| f32::from_bits(d));
        let squared = distances().filter(|&d| d >= resolved).reduce(f32::min)?;
        let closer = distances().filter(|&d| d < squared).count();
        let tied = distances().filter(|&d| d == squared).count();
        Some(Sphere { squared, closer, tied, coincident: closer })
    }
}
