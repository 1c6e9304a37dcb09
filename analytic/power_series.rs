//! The exponential of minus a mean by estimates of it, as a power series about each of them whose order is drawn: the exact second moment.

use libm::exp;

/// Highest order that counts: estimates of transmittance come here with a chance of 1e-6, and terms fall by factorials.
pub const ORDERS: usize = 12;

/// Coefficients by powers of s and t.
type Table = [[f64; ORDERS + 1]; ORDERS + 1];

/// What orders up to [`ORDERS`] bring to the second moment of an estimate F of mean 1: of n + 1 independent estimates Y of a mean that is 0 here,
///
/// F = mean over i of e^(-Y_i) sum over k <= n of e_k / (C(n, k) k! Q_k)
///
/// with e_k the sum of products of k of the n differences Y_i - Y_j, and Q_k the chance that n, which is drawn, reaches k.
///
/// Sums of products of k differences from one pivot and l from another have the generating function of independent factors: with
/// y = p - Y and y' = q - Y, E prod (1 + s y)(1 + t y') = (1 + s E y + t E y' + s t E y y')^n; where a pivot is among the other's
/// estimates its factor is known.
///
/// # Arguments
/// `nodes` values of an estimate of mean 0 with weights that sum to 1; `reaches` the chance of each order to be reached, above 0, and 1 of order 0
///
/// # Limits
/// higher orders are left out: if they had no error they would bring the chance to reach them
///
/// # Source
/// Kettunen, d'Eon, Pantaleoni and Novak 2021, "An unbiased ray-marching transmittance estimator", for the estimator
pub fn second_moment(nodes: &[(f64, f64)], reaches: impl Fn(usize) -> f64) -> f64 {
    let square: f64 = nodes.iter().map(|(y, w)| w * y * y).sum();
    // Weight of products of k of n: 1 over their number, k! and the chance.
    let weight = |n: usize, k: usize| (0..k).map(|i| 1.0 / (n - i) as f64).product::<f64>() / reaches(k);
    let weights: Vec<Vec<f64>> = (0..=ORDERS).map(|n| (0..=n).map(|k| weight(n, k)).collect()).collect();
    let combined = |n: usize, table: &Table| {
        let mut sum = 0.0;
        for (a, row) in weights[n].iter().zip(table) {
            for (b, value) in weights[n].iter().zip(row) {
                sum += a * b * value;
            }
        }
        sum
    };
    let mut one: Table = [[0.0; ORDERS + 1]; ORDERS + 1];
    one[0][0] = 1.0;
    let chances: Vec<f64> = (0..=ORDERS).map(|n| reaches(n) - reaches(n + 1)).collect();
    let mut total = 0.0;
    for (i, &(p, w)) in nodes.iter().enumerate() {
        // The same pivot twice.
        let mut table = one;
        for (n, chance) in chances.iter().enumerate() {
            total += chance * combined(n, &table) * exp(-2.0 * p) * w / (n + 1) as f64;
            if n < ORDERS {
                multiply(&mut table, n + 1, [p, p, square + p * p]);
            }
        }
        // Two pivots, each among the other's estimates.
        for (j, &(q, v)) in nodes[..=i].iter().enumerate() {
            let both = if i == j { w * v } else { 2.0 * w * v };
            let mut table = one;
            multiply(&mut table, 1, [p - q, q - p, -(p - q) * (p - q)]);
            for (n, chance) in chances.iter().enumerate().skip(1) {
                total += chance * combined(n, &table) * exp(-p - q) * both * n as f64 / (n + 1) as f64;
                if n < ORDERS {
                    multiply(&mut table, n + 1, [p, q, square + p * q]);
                }
            }
        }
    }
    total
}

/// The coefficients times a further factor 1 + a s + b t + c s t, up to the power `most` of each.
fn multiply(table: &mut Table, most: usize, [a, b, c]: [f64; 3]) {
    for k in (0..=most).rev() {
        for l in (0..=most).rev() {
            let before = |i: usize, j: usize| if k >= i && l >= j { table[k - i][l - j] } else { 0.0 };
            table[k][l] = before(0, 0) + a * before(1, 0) + b * before(0, 1) + c * before(1, 1);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// F of given estimates, by its definition: products over all subsets of the differences.
    fn estimate(values: &[f64], reaches: &dyn Fn(usize) -> f64) -> f64 {
        let n = values.len() - 1;
        let about = |i: usize| {
            let differences: Vec<f64> = (0..=n).filter(|j| *j != i).map(|j| values[i] - values[j]).collect();
            let mut sum = 0.0;
            for subset in 0..1usize << n {
                let k = subset.count_ones() as usize;
                let product: f64 = (0..n).filter(|j| subset >> j & 1 == 1).map(|j| differences[j]).product();
                // C(n, k) k! = n!/(n - k)!
                let ways: f64 = (0..k).map(|m| (n - m) as f64).product();
                sum += product / (ways * reaches(k));
            }
            exp(-values[i]) * sum
        };
        (0..=n).map(about).sum::<f64>() / (n + 1) as f64
    }

    /// Every combination of estimates one by one, where three orders at most are drawn.
    #[test]
    fn as_by_counting() {
        let nodes = [(-0.4, 0.3), (0.1, 0.5), (0.35, 0.2)];
        let mean: f64 = nodes.iter().map(|(y, w)| y * w).sum();
        assert!(mean.abs() < 1e-15, "{mean}");
        let reaches = |k: usize| [1.0, 0.7, 0.4, 0.15].get(k).copied().unwrap_or(0.0);
        let mut counted = [0.0, 0.0];
        for n in 0..4 {
            let chance = reaches(n) - reaches(n + 1);
            for choice in 0..3usize.pow(n as u32 + 1) {
                let picked: Vec<(f64, f64)> =
                    (0..=n).map(|i| nodes[choice / 3usize.pow(i as u32) % 3]).collect();
                let values: Vec<f64> = picked.iter().map(|(y, _)| *y).collect();
                let weight = chance * picked.iter().map(|(_, w)| w).product::<f64>();
                let value = estimate(&values, &reaches);
                counted[0] += weight * value;
                counted[1] += weight * value * value;
            }
        }
        let found = second_moment(&nodes, |k| if k < 4 { reaches(k) } else { 1e-30 });
        assert!((found / counted[1] - 1.0).abs() < 1e-13, "{found} {}", counted[1]);
        // What the series has beyond four orders is missing.
        assert!((counted[0] - 1.0).abs() < 1e-3, "{}", counted[0]);
        assert!(counted[1] > 1.01);
    }
}
