//! What pilot maps tell of a probe: the bend of its field, and its noise by radius.

use crate::faults::{Fault, planted};

/// Balls about each probe.
pub(super) const BALLS: usize = 8;
/// Radius of each over that of the next smaller one: eight of them span a factor of 11.
const RATIO: f64 = std::f64::consts::SQRT_2;
/// Rounds in which the noise law is fitted with the weights of the last one: they settle in two or three.
const ROUNDS: usize = 4;

/// What the next order, s^4, adds to the fitted bend at a reach of one mean free path, relative to it, if the field
/// bends like e^-t: slope of s^4/120 against s^2 over a ball, (1/120) cov(s^2, s^4)/var(s^2) = (1/120)(10/9), over 1/6.
const NEXT_ORDER: f64 = 1.0 / 18.0;

/// A channel at a fluence probe.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Probe {
    pub name: String,
    pub channel: usize,
    /// Radius of the largest ball \[L\].
    pub reach: f64,
    /// The same in mean free paths.
    pub reach_mfp: f64,
    /// Estimate of each ball, largest first, a list a map.
    pub values: Vec<[f64; BALLS]>,
    /// Bend over the largest ball, one a map.
    pub bends: Vec<f64>,
    /// Photons in the largest ball, mean over maps.
    pub found: f64,
}

/// What maps tell of a probe.
pub(super) struct Law {
    /// The bend: a times the squared largest radius, over the fluence \[1\].
    pub mean: f64,
    /// What remains uncertain of it.
    pub deviation: f64,
    /// The part of that which other maps would not show: what the prior holds back, and the next order.
    pub unseen: f64,
    /// Relative variance of a ball in one map times its cubed radius, over the largest radius: alpha + beta r.
    pub noise: [f64; 2],
}

impl Probe {
    /// Relative bias of a ball of radius `r` in a field of this bend.
    pub fn bias_of(&self, bend: f64, r: f64) -> f64 {
        let u = r / self.reach;
        0.6 * bend * u * u
    }

    /// Photons of one pilot map in a ball of radius `r`.
    pub fn found(&self, r: f64) -> f64 {
        let u = r / self.reach;
        self.found * u * u * u
    }

    /// The laws of the maps, each counted as often as `counts` says.
    pub fn law(&self, counts: &[f64]) -> Law {
        let (mut sums, mut squares) = ([0.0; BALLS + 1], [0.0; BALLS + 1]);
        for (count, (balls, bend)) in counts.iter().zip(self.values.iter().zip(&self.bends)) {
            let values = balls.iter().chain(std::iter::once(bend));
            for ((x, sum), square) in values.zip(&mut sums).zip(&mut squares) {
                *sum += count * x;
                *square += count * x * x;
            }
        }
        let n = self.values.len() as f64;
        let mean = |i: usize| sums[i] / n;
        let variance = |i: usize| ((squares[i] - n * mean(i) * mean(i)) / (n - 1.0)).max(0.0);
        let (ball, seen, noise) = (mean(0), mean(BALLS), (variance(BALLS) / n).sqrt());
        let prior = ball * self.reach_mfp * self.reach_mfp / 6.0;
        let share = prior * prior / (prior * prior + noise * noise);
        // The largest ball reads 3/5 of the bend too much.
        let here = ball - 0.6 * share * seen;
        let bend = share * seen / here;
        let next = NEXT_ORDER * self.reach_mfp * self.reach_mfp * bend;
        // The squared deviation share noise^2 is share^2 noise^2, which other maps show, and the rest.
        let unseen = (share * (1.0 - share)).sqrt() * noise / here;
        let x: [f64; BALLS] = std::array::from_fn(|i| radius(1.0, i));
        let y = std::array::from_fn(|i| variance(i) * x[i] * x[i] * x[i] / (here * here));
        let found = x.map(|x| self.found(x * self.reach));
        Law {
            mean: bend,
            deviation: libm::hypot(share.sqrt() * noise / here, next),
            unseen: libm::hypot(unseen, next),
            noise: noise_law(&x, &y, &found),
        }
    }

    /// Relative variance of a ball of radius `r` in one map.
    pub fn variance(&self, law: &Law, r: f64) -> f64 {
        let u = r / self.reach;
        let clusters = if planted(Fault::ClustersForgotten) { 0.0 } else { law.noise[1] };
        (law.noise[0] + clusters * u) / (u * u * u)
    }
}

/// y = alpha + beta x by least squares, neither below 0: counts vary, and the photons of one history gather.
///
/// The variance of the variance of Poisson counts of mean n is 2 + 1/n times its square; the squares are those of the
/// fitted law, since the balls that happen to vary least would win if they were those of the balls.
fn noise_law(x: &[f64; BALLS], y: &[f64; BALLS], found: &[f64; BALLS]) -> [f64; 2] {
    let mut law = [y.iter().sum::<f64>() / BALLS as f64, 0.0];
    if law[0] <= 0.0 {
        return [0.0; 2];
    }
    for _ in 0..ROUNDS {
        let (mut w, mut wx, mut wxx, mut wy, mut wxy) = (0.0, 0.0, 0.0, 0.0, 0.0);
        for ((x, y), found) in x.iter().zip(y).zip(found) {
            let fitted = law[0] + law[1] * x;
            let weight = 1.0 / (fitted * fitted * (2.0 + 1.0 / found));
            w += weight;
            wx += weight * x;
            wxx += weight * x * x;
            wy += weight * y;
            wxy += weight * x * y;
        }
        let below = w * wxx - wx * wx;
        let (alpha, beta) = ((wxx * wy - wx * wxy) / below, (w * wxy - wx * wy) / below);
        law = if beta < 0.0 {
            [wy / w, 0.0]
        } else if alpha < 0.0 {
            [0.0, wxy / wxx]
        } else {
            [alpha, beta]
        };
    }
    law
}

/// The weights that turn the balls of a probe into the bend of the field over the largest one: the slope against s^2 of
/// the shells between balls, which share no photons, by least squares weighted by their volumes.
pub(super) fn bend_weights() -> [f64; BALLS] {
    // Shell i lies between ball i and ball i + 1; the last one is the smallest ball itself. In a shell the mean of s^2
    // is 3/5 (R^5 - r^5) / (R^3 - r^3), and its mean field is (R^3 x_i - r^3 x_(i+1)) / (R^3 - r^3).
    let power = |x: f64, n: u32| (0..n).fold(1.0, |product, _| product * x);
    let inner = |i: usize| if i + 1 < BALLS { radius(1.0, i + 1) } else { 0.0 };
    let volume = |i: usize| power(radius(1.0, i), 3) - power(inner(i), 3);
    let square = |i: usize| 0.6 * (power(radius(1.0, i), 5) - power(inner(i), 5)) / volume(i);
    // Volumes add up to 1.
    let mean: f64 = (0..BALLS).map(|i| volume(i) * square(i)).sum();
    let spread: f64 = (0..BALLS).map(|i| volume(i) * (square(i) - mean) * (square(i) - mean)).sum();
    let mut weights = [0.0; BALLS];
    for i in 0..BALLS {
        let of_shell = (square(i) - mean) / spread;
        weights[i] += of_shell * power(radius(1.0, i), 3);
        if i + 1 < BALLS {
            weights[i + 1] -= of_shell * power(inner(i), 3);
        }
    }
    weights
}

/// Radius of a ball: each is smaller than the one before.
pub(super) fn radius(reach: f64, ball: usize) -> f64 {
    (0..ball).fold(reach, |r, _| r / RATIO)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Means over balls of 1 + a s^2 give back a.
    #[test]
    fn the_bend_is_exact_for_its_own_law() {
        let balls: [f64; BALLS] = std::array::from_fn(|i| 1.0 + 0.6 * 0.37 * radius(1.0, i) * radius(1.0, i));
        let found: f64 = bend_weights().iter().zip(&balls).map(|(w, x)| w * x).sum();
        assert!((found - 0.37).abs() < 1e-12, "{found}");
    }

    /// The law gives itself back; a falling one and one below 0 at the centre lose the term that would be negative, so
    /// that no variance is below 0 anywhere.
    #[test]
    fn no_variance_is_negative() {
        let x: [f64; BALLS] = std::array::from_fn(|i| radius(1.0, i));
        let found = x.map(|x| 1000.0 * x * x * x);
        let [alpha, beta] = noise_law(&x, &x.map(|x| 0.3 + 0.2 * x), &found);
        assert!((alpha - 0.3).abs() < 1e-12 && (beta - 0.2).abs() < 1e-12, "{alpha} {beta}");
        let [alpha, beta] = noise_law(&x, &x.map(|x| 0.3 * (x - 0.05)), &found);
        assert!(alpha == 0.0 && beta > 0.0 && beta < 0.3, "{alpha} {beta}");
        let [alpha, beta] = noise_law(&x, &x.map(|x| 0.3 - 0.2 * x), &found);
        assert!(beta == 0.0 && alpha > 0.1 && alpha < 0.3, "{alpha} {beta}");
        assert_eq!(noise_law(&x, &[0.0; BALLS], &found), [0.0; 2]);
    }
}
