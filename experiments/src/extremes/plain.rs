//! A search in double precision over plain positions: what the tree is held against. No tree, no unit, no list.

use glam::DVec3;
use std::f64::consts::PI;
use turbid::photons::Photon;

/// Photons with their positions as they were shot.
pub struct Plain {
    photons: Vec<(DVec3, f64)>,
    emitted: f64,
}

impl Plain {
    /// The photons of a map, powers of the first channel.
    pub fn new(photons: &[Photon], emitted: u64) -> Self {
        let photons = photons.iter().map(|p| (p.position, f64::from(p.power.x))).collect();
        Plain { photons, emitted: emitted as f64 }
    }

    /// Squared distances to a point, with powers.
    fn squared(&self, point: DVec3) -> impl Iterator<Item = (f64, f64)> + '_ {
        self.photons.iter().map(move |(position, power)| (position.distance_squared(point), *power))
    }

    fn density(&self, power: f64, radius: f64) -> f64 {
        power / (self.emitted * 4.0 / 3.0 * PI * radius * radius * radius)
    }

    /// Collision density by a fixed radius, uniform kernel, and the number of photons in the ball.
    pub fn within(&self, point: DVec3, radius: f64) -> (f64, usize) {
        let inside = self.squared(point).filter(|(d2, _)| *d2 <= radius * radius);
        let (power, found) = inside.fold((0.0, 0), |(sum, n), (_, power)| (sum + power, n + 1));
        (self.density(power, radius), found)
    }

    /// Collision density by the k nearest, uniform kernel: the k-1 nearer ones over the ball of the k-th, and the
    /// radius of that ball. With fewer than k within the cap, all in the ball of the cap.
    pub fn nearest(&self, point: DVec3, k: usize, cap: f64) -> (f64, f64) {
        let mut all: Vec<(f64, f64)> = self.squared(point).filter(|(d2, _)| *d2 <= cap * cap).collect();
        if all.len() < k {
            return (self.within(point, cap).0, cap);
        }
        let (nearer, kth, _) = all.select_nth_unstable_by(k - 1, |a, b| a.0.total_cmp(&b.0));
        let (power, radius) = (nearer.iter().map(|(_, power)| power).sum(), kth.0.sqrt());
        (self.density(power, radius), radius)
    }
}
