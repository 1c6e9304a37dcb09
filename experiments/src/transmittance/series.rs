//! The exponential as a power series whose order is drawn.

use turbid::math::exp;
use turbid::rng::Stream;

/// How the order of the series is drawn: which chance it has to reach an order.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Orders {
    /// From each order to the next with the same chance.
    Geometric(f64),
    /// Seldom beyond 0; then 2 at least, and from k to k + 1 with the chance 2/(k + 1).
    Seldom,
}

/// Chance of [`Orders::Seldom`] to go beyond 0.
const SELDOM: f64 = 0.1;

impl Orders {
    /// Draws an order.
    pub fn draw(self, stream: &mut Stream) -> usize {
        let mut order = match self {
            Orders::Geometric(_) => 0,
            Orders::Seldom if stream.unit() < SELDOM => 2,
            Orders::Seldom => return 0,
        };
        while stream.unit() < self.goes_on(order) {
            order += 1;
        }
        order
    }

    /// Chance to go on from an order that was reached, beyond those that are never the last.
    fn goes_on(self, order: usize) -> f64 {
        match self {
            Orders::Geometric(q) => q,
            Orders::Seldom => 2.0 / (order + 1) as f64,
        }
    }

    /// The chance to reach an order.
    pub fn reaches(self, order: usize) -> f64 {
        match self {
            Orders::Geometric(q) => libm::pow(q, order as f64),
            Orders::Seldom => match order {
                0 => 1.0,
                _ => SELDOM * (2..order).map(|k| self.goes_on(k)).product::<f64>(),
            },
        }
    }

    /// The mean order: the sum of the chances to reach each from 1 on.
    pub fn mean(self) -> f64 {
        match self {
            Orders::Geometric(q) => q / (1.0 - q),
            // Behind order 40 less than 1e-30 is left.
            Orders::Seldom => (1..40).map(|k| self.reaches(k)).sum(),
        }
    }
}

/// exp(-tau) from independent estimates of tau, one more than the order: each in turn is the pivot about which the others are
/// expanded, in all orders of taking k of them.
///
/// With y_i = pivot - tau_i the term of order k is the mean of all products of k of the y, over k! and the chance that the order
/// is reached. The mean over pivots and products uses each estimate as often as any other.
///
/// # Source
/// Kettunen, d'Eon, Pantaleoni and Novak 2021
pub fn about_each(depths: &[f64], orders: Orders) -> f64 {
    let count = depths.len();
    let mut sum = 0.0;
    for pivot in 0..count {
        // Elementary symmetric sums of all but the pivot.
        let mut sums = vec![1.0];
        for (_, depth) in depths.iter().enumerate().filter(|(i, _)| *i != pivot) {
            let y = depths[pivot] - depth;
            sums.push(0.0);
            for k in (1..sums.len()).rev() {
                sums[k] += y * sums[k - 1];
            }
        }
        // (n - k)!/n! is 1 over k! and the number of products.
        let (mut series, mut weight) = (0.0, 1.0);
        for (k, sum) in sums.iter().enumerate() {
            series += weight * sum / orders.reaches(k);
            weight /= (sums.len() - 1).saturating_sub(k).max(1) as f64;
        }
        sum += exp(-depths[pivot]) * series;
    }
    sum / count as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use turbid::rng::Purpose;

    /// Estimates that agree leave the exponential alone; by hand, of two estimates and order 1.
    #[test]
    fn series_by_hand() {
        assert!((about_each(&[0.7, 0.7, 0.7], Orders::Seldom) / libm::exp(-0.7) - 1.0).abs() < 1e-15);
        let by_hand = 0.5 * (libm::exp(-1.0) * (1.0 - 1.0 / 0.25) + libm::exp(-2.0) * (1.0 + 1.0 / 0.25));
        assert!((about_each(&[1.0, 2.0], Orders::Geometric(0.25)) - by_hand).abs() < 1e-15);
        // Three estimates, pivot 0: mean of y is -1.5, mean of products 2.
        let about =
            |p: f64, mean: f64, product: f64| libm::exp(-p) * (1.0 + mean / 0.5 + product / 2.0 / 0.25);
        let by_hand = (about(0.0, -1.5, 2.0) + about(1.0, 0.0, -1.0) + about(2.0, 1.5, 2.0)) / 3.0;
        assert!((about_each(&[0.0, 1.0, 2.0], Orders::Geometric(0.5)) - by_hand).abs() < 1e-15);
    }

    /// Orders are drawn as often as they say, and their mean is 0.1 (2 + 2/3 + 1/3 + 2/15 + ...) = 0.31945.
    #[test]
    fn orders_are_reached_as_often_as_they_say() {
        assert!((Orders::Seldom.mean() - 0.319_453).abs() < 1e-6, "{}", Orders::Seldom.mean());
        const N: u64 = 1 << 18;
        for orders in [Orders::Geometric(0.7), Orders::Seldom] {
            let mut reached = [0u64; 6];
            for history in 0..N {
                let order = orders.draw(&mut Stream::new(1, Purpose::Synthetic, 0, history));
                reached.iter_mut().take(order + 1).for_each(|count| *count += 1);
            }
            for (k, count) in reached.iter().enumerate() {
                let chance = orders.reaches(k);
                // Five standard errors of a count.
                let most = 5.0 * (N as f64 * chance * (1.0 - chance)).sqrt() + 1e-9;
                assert!((*count as f64 - N as f64 * chance).abs() <= most, "{orders:?} {k}: {count}");
            }
        }
    }
}
