//! Many tests at once.

/// Adjusted p-values of Holm's step-down: rejecting those at most `alpha` keeps the probability of any false
/// rejection at most `alpha`, whatever the dependence between the tests.
///
/// A p-value that is not a number counts as 0: what could not be tested did not pass.
///
/// # Source
/// Holm 1979.
pub fn holm(p_values: &[f64]) -> Vec<f64> {
    let p = |i: usize| if p_values[i].is_nan() { 0.0 } else { p_values[i] };
    let mut order: Vec<usize> = (0..p_values.len()).collect();
    order.sort_by(|&a, &b| p(a).total_cmp(&p(b)));
    let mut adjusted = vec![0.0; p_values.len()];
    let mut largest: f64 = 0.0;
    for (rank, &i) in order.iter().enumerate() {
        largest = largest.max(((p_values.len() - rank) as f64 * p(i)).min(1.0));
        adjusted[i] = largest;
    }
    adjusted
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::{Purpose, Stream};
    use crate::stats::wilson_interval;

    /// The example of Holm's procedure with four tests: 0.01, 0.04, 0.03, 0.005.
    #[test]
    fn by_hand() {
        let adjusted = holm(&[0.01, 0.04, 0.03, 0.005]);
        for (a, b) in adjusted.iter().zip([0.03, 0.06, 0.06, 0.02]) {
            assert!((a - b).abs() < 1e-15);
        }
        assert_eq!(holm(&[0.9, 0.8]), [1.0, 1.0]);
        assert_eq!(holm(&[f64::NAN, 0.5]), [0.0, 0.5]);
        assert!(holm(&[]).is_empty());
    }

    /// 20 true nulls, 10,000 families: a false rejection at 5 % happens in 4.9 % of them; without the adjustment
    /// (the negative control) in 64 %.
    #[test]
    fn family_wise_rate() {
        let (mut adjusted, mut plain) = (0, 0);
        for family in 0..10_000 {
            let mut stream = Stream::new(5, Purpose::Synthetic, family, 0);
            let p: Vec<f64> = (0..20).map(|_| stream.open_unit()).collect();
            adjusted += u64::from(holm(&p).iter().any(|&q| q <= 0.05));
            plain += u64::from(p.iter().any(|&q| q <= 0.05));
        }
        // The exact rate of the smallest of 20: 1 - (1 - 0.05/20)^20 = 0.04883.
        assert!(wilson_interval(adjusted, 10_000, 1.0 - 1e-6).contains(0.048_83));
        assert!(wilson_interval(plain, 10_000, 1.0 - 1e-6).low > 0.05);
    }
}
