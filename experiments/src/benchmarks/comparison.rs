//! One comparison: rows of theirs and ours, the sum of squares over combined errors, and what it says.

use serde::{Deserialize, Serialize};
use turbid::stats::{chi_squared_p, normal_p, smallest_detectable_noncentrality};

/// Below this p a comparison differs, by the sum of squares or by the largest difference: of 50 comparisons on the page a false alarm happens on
/// one page in 100.
pub const LEVEL: f64 = 1e-4;

/// What stands between a method and the one of ours that it is held against, in [`Comparison::by`].
pub const AGAINST: &str = " against ";

/// A published number beside ours.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Row {
    /// The case of the set.
    pub case: String,
    /// The quantity.
    pub quantity: String,
    /// Where: the abscissa of the set's plot.
    pub at: f64,
    /// Their value, if there is one.
    pub theirs: Option<f64>,
    /// Their standard error, that of rounding included.
    pub their_error: Option<f64>,
    /// Our value.
    pub ours: f64,
    /// Our standard error, or bound of an exact value; none where none can be trusted.
    pub our_error: Option<f64>,
}

impl Row {
    /// A row with both.
    pub fn new(case: &str, quantity: &str, at: f64, theirs: (f64, f64), ours: (f64, Option<f64>)) -> Self {
        Row {
            case: case.to_string(),
            quantity: quantity.to_string(),
            at,
            theirs: Some(theirs.0),
            their_error: Some(theirs.1),
            ours: ours.0,
            our_error: ours.1,
        }
    }

    /// A row without a number of theirs.
    pub fn alone(case: &str, quantity: &str, at: f64, ours: (f64, Option<f64>)) -> Self {
        Row { theirs: None, their_error: None, ..Row::new(case, quantity, at, (0.0, 0.0), ours) }
    }

    /// The combined error, where both errors are known.
    pub fn combined(&self) -> Option<f64> {
        Some(libm::hypot(self.their_error?, self.our_error?)).filter(|&error| error > 0.0)
    }

    /// The difference over the combined error.
    pub fn z(&self) -> Option<f64> {
        Some((self.ours - self.theirs?) / self.combined()?)
    }

    /// The difference over their value.
    pub fn relative(&self) -> Option<f64> {
        self.theirs.filter(|&theirs| theirs != 0.0).map(|theirs| self.ours / theirs - 1.0)
    }
}

/// Who answered, and the rows.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Comparison {
    /// Who answered: the words of a column.
    pub by: String,
    /// Its rows.
    pub rows: Vec<Row>,
    /// Wall-clock seconds that ours took.
    pub seconds: f64,
}

/// What a comparison says.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Verdict {
    /// All differences together are as large as the errors let expect.
    Agrees,
    /// They are larger.
    Differs,
    /// Nothing is compared: there are no numbers of theirs, or no errors.
    Open,
}

impl Verdict {
    /// The word of the page.
    pub fn word(self) -> &'static str {
        match self {
            Verdict::Agrees => "agrees",
            Verdict::Differs => "differs",
            Verdict::Open => "open",
        }
    }
}

impl Comparison {
    /// Whether it holds a method of ours against another one of ours: nobody published a number.
    pub fn is_among_ours(&self) -> bool {
        self.by.contains(AGAINST)
    }

    /// The sum of squares and how many there are.
    pub fn chi_squared(&self) -> (f64, u64) {
        let squares = self.rows.iter().filter_map(Row::z).map(|z| z * z);
        squares.fold((0.0, 0), |(sum, n), square| (sum + square, n + 1))
    }

    /// Probability of a sum as large by chance.
    pub fn p(&self) -> Option<f64> {
        let (sum, n) = self.chi_squared();
        (n > 0).then(|| chi_squared_p(sum, n))
    }

    /// Probability that the largest of as many differences is as large by chance, at most: one row that is wrong may hide in
    /// the sum over many that are known better than they need be.
    pub fn p_of_worst(&self) -> f64 {
        let z = self.worst().and_then(Row::z).unwrap_or(0.0);
        (normal_p(z) * self.chi_squared().1 as f64).min(1.0)
    }

    /// What it says.
    pub fn verdict(&self) -> Verdict {
        match self.p() {
            None => Verdict::Open,
            Some(p) if p < LEVEL || self.p_of_worst() < LEVEL => Verdict::Differs,
            Some(_) => Verdict::Agrees,
        }
    }

    /// The bias, common to all rows and relative, that the sum of squares would find in 99 of 100 cases.
    pub fn detects(&self) -> Option<f64> {
        let precision = self
            .rows
            .iter()
            .filter_map(|row| Some(row.theirs?.abs() / row.combined()?))
            .fold(0.0, |sum, ratio| sum + ratio * ratio);
        let (_, n) = self.chi_squared();
        (precision > 0.0).then(|| libm::sqrt(smallest_detectable_noncentrality(n, LEVEL) / precision))
    }

    /// The row of the largest difference over its error.
    pub fn worst(&self) -> Option<&Row> {
        let size = |row: &&Row| row.z().map_or(0.0, f64::abs);
        self.rows.iter().filter(|row| row.z().is_some()).max_by(|a, b| size(a).total_cmp(&size(b)))
    }
}

/// What a set was answered with.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Answered {
    /// Name of the set.
    pub set: String,
    /// What the answer depends on.
    pub settings: String,
    /// Digest of the program that answered.
    pub program: String,
    /// Its comparisons.
    pub comparisons: Vec<Comparison>,
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;
    use turbid::rng::{Purpose, Stream};

    fn comparison(shift: f64) -> Comparison {
        // Half the rows one error above, half one below: a sum of squares that is expected.
        let rows = (0..40).map(|i| {
            let sign = if i % 2 == 0 { 1.0 } else { -1.0 };
            Row::new("c", "q", f64::from(i), (1.0, 0.003), (1.0 + sign * 0.005 + shift, Some(0.004)))
        });
        Comparison { by: "us".into(), rows: rows.collect(), seconds: 0.0 }
    }

    #[test]
    fn agreement_and_difference() {
        let fair = comparison(0.0);
        assert_eq!(fair.verdict(), Verdict::Agrees);
        let (sum, n) = fair.chi_squared();
        assert!((sum - 40.0).abs() < 1e-9 && n == 40);
        // The bias that it says it detects it does detect.
        let bias = fair.detects().unwrap();
        assert_eq!(comparison(1.2 * bias).verdict(), Verdict::Differs);
        assert_eq!(comparison(0.2 * bias).verdict(), Verdict::Agrees);
    }

    /// Normal differences: without a bias 2 comparisons in 10,000 differ, so that 5 or more of 1,000 have a chance of 3e-6; with the bias
    /// that is said to be detected at least 99 in 100, less 4.9 standard deviations of 1,000.
    #[test]
    fn the_bias_that_it_detects() {
        for n in [1, 11, 256] {
            let differ = |shift: f64| {
                (0..1000)
                    .filter(|set| {
                        let mut stream = Stream::new(7, Purpose::Synthetic, n, *set);
                        let row = |i: u64| {
                            // Box and Muller.
                            let [u, v] = stream.pair();
                            let normal = libm::sqrt(-2.0 * libm::log1p(-u)) * libm::cos(2.0 * PI * v);
                            Row::new(
                                "c",
                                "q",
                                i as f64,
                                (1.0, 0.03),
                                (1.0 + shift + 0.05 * normal, Some(0.04)),
                            )
                        };
                        let rows = (0..n).map(row).collect();
                        Comparison { by: "us".into(), rows, seconds: 0.0 }.verdict() == Verdict::Differs
                    })
                    .count()
            };
            let rows = (0..n).map(|i| Row::new("c", "q", i as f64, (1.0, 0.03), (1.0, Some(0.04)))).collect();
            let bias = Comparison { by: "us".into(), rows, seconds: 0.0 }.detects().unwrap();
            let (alarms, found, half) = (differ(0.0), differ(bias), differ(0.5 * bias));
            assert!(alarms < 5 && found >= 975 && half < 900, "n {n}: {alarms}, {found}, {half}");
        }
    }

    #[test]
    fn one_wrong_row_is_found() {
        let mut c = comparison(0.0);
        // Errors that are far too wide hide 7 of them in the sum.
        c.rows.iter_mut().for_each(|row| row.ours = 1.0);
        c.rows[5].ours = 1.035;
        assert!(c.p().unwrap() > 0.1 && c.verdict() == Verdict::Differs);
    }

    #[test]
    fn what_has_no_error_is_not_counted() {
        let mut rows = comparison(0.0).rows;
        rows[0].ours = 100.0;
        rows[0].our_error = None;
        rows.push(Row::alone("c", "q", 0.0, (5.0, Some(0.1))));
        let c = Comparison { by: "us".into(), rows, seconds: 0.0 };
        assert_eq!((c.chi_squared().1, c.verdict()), (39, Verdict::Agrees));
        let none = Comparison { rows: vec![Row::alone("c", "q", 0.0, (5.0, Some(0.1)))], ..c };
        assert_eq!(none.verdict(), Verdict::Open);
    }
}
