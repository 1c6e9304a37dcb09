//! The largest distance between measurement and prediction over all cases, and how large it may be.
//!
//! Cases share maps, and their distances are correlated in ways that nobody has predicted; so the distribution of
//! the largest comes from the maps themselves. Each value is taken from the mean of its case, whereby nothing is left
//! over, and the maps of each group are drawn with replacement, for all of its cases at once, thousands of times. Each
//! time every case gets its distance anew, with its standard error from the maps drawn: it is that error, small by
//! chance, that makes the tails of Student's t, and skewed maps make one tail longer. (Turning the signs of maps would
//! hide skewness; normal multipliers would hide both.) Groups have different numbers of maps, so that the largest
//! distance is the one with the smallest p of Student's t.

use super::sets::{Group, distance, predicted};
use crate::harness::Digest;
use crate::prediction::Term;
use turbid::rng::{Purpose, Stream};
use turbid::stats::{Moments, Residuals, normal_critical, student_p};
use turbid::transport::in_parallel;

/// The case farthest from its prediction.
#[derive(Debug, Clone, PartialEq)]
pub struct Largest {
    /// Its name.
    pub case: String,
    /// The p-value of its distance by itself.
    pub p_alone: f64,
    /// The p-value of so large a distance anywhere.
    pub p: f64,
}

impl Largest {
    /// The distance in deviations of a normal number of the same p; infinite where that p vanishes.
    pub fn z(&self) -> f64 {
        deviations(self.p_alone)
    }
}

/// What the largest distance is when nothing is left over.
pub struct Null {
    /// The smallest p-value of each resample, sorted.
    smallest: Vec<f64>,
    entries: usize,
}

impl Null {
    /// Resamples the maps.
    pub fn new(groups: &[Group], seed: u64, resamples: usize) -> Self {
        let tables: Vec<Residuals> = groups.iter().map(residuals).collect();
        let name = Digest::of(b"budget/largest").word();
        let one = |resample: usize| {
            let mut stream = Stream::new(seed, Purpose::Resampling, name, resample as u64);
            tables.iter().map(|table| table.smallest_p(&mut stream)).fold(1.0, f64::min)
        };
        let mut smallest = in_parallel(resamples, one);
        smallest.sort_by(f64::total_cmp);
        Null { smallest, entries: groups.iter().map(|g| g.entries.len()).sum() }
    }

    /// The distance that the largest exceeds with this probability, in deviations of a normal number.
    pub fn bound(&self, probability: f64) -> f64 {
        let place = (probability * self.smallest.len() as f64) as usize;
        deviations(self.smallest.get(place).copied().unwrap_or(0.0))
    }

    /// The p-value of a smallest p-value. Beyond all resamples it is at most one over their number; Bonferroni's bound
    /// takes over where it is sharper.
    fn p(&self, p_alone: f64) -> f64 {
        let as_small = self.smallest.partition_point(|&p| p <= p_alone);
        let resampled = (as_small + 1) as f64 / (self.smallest.len() + 1) as f64;
        if as_small == 0 { resampled.min(self.entries as f64 * p_alone) } else { resampled }
    }

    /// The case farthest from its prediction, with one term taken away if one is named.
    pub fn largest(&self, groups: &[Group], without: Option<Term>) -> Largest {
        let mut worst = Largest { case: String::new(), p_alone: 1.0, p: 1.0 };
        for group in groups {
            for entry in &group.entries {
                let m: Moments = entry.maps.iter().collect();
                let t = distance(m.mean(), m.std_error(), predicted(entry, without), entry.error);
                let p_alone = student_p(t, m.n() - 1);
                if p_alone < worst.p_alone {
                    worst = Largest { case: entry.case.clone(), p_alone, p: self.p(p_alone) };
                }
            }
        }
        worst
    }
}

/// The group's values, for resampling.
fn residuals(group: &Group) -> Residuals {
    Residuals::new(&group.entries.iter().map(|entry| (&entry.maps[..], entry.error)).collect::<Vec<_>>())
}

/// A two-sided p-value in deviations of a normal number.
pub fn deviations(p: f64) -> f64 {
    if p >= 1.0 {
        0.0
    } else if p < f64::MIN_POSITIVE {
        f64::INFINITY
    } else {
        normal_critical(p)
    }
}

#[cfg(test)]
mod tests {
    use super::super::sets::groups;
    use super::super::sets::tests::made_up;
    use super::*;
    use crate::prediction::Entry;
    use turbid::stats::{ALPHA, wilson_interval};

    /// Two cases by hand: 1 to 5 against 2, with and without a numerical error, at 4 degrees: p = 1 - s (3 - s^2)/2 with
    /// s = t/sqrt(t^2 + 4), t = sqrt 2 and 1.
    #[test]
    fn the_largest_by_hand() {
        let p = |t: f64| {
            let s = t / (t * t + 4.0).sqrt();
            1.0 - 0.5 * s * (3.0 - s * s)
        };
        let maps = || vec![1.0, 2.0, 3.0, 4.0, 5.0];
        let near = Entry::new("g", "near", &[(Term::Blur, 2.0)], 0.5f64.sqrt(), maps());
        let far = Entry::new("g", "far", &[(Term::Blur, 2.0)], 0.0, maps());
        let null = Null { smallest: vec![0.01, 0.2, 0.3], entries: 2 };
        for (entries, case, t) in [(vec![&near, &far], "far", 2f64.sqrt()), (vec![&near], "near", 1.0)] {
            let found = null.largest(&[Group { name: "g", maps: 5, entries }], None);
            assert!(found.case == case && (found.p_alone - p(t)).abs() < 1e-12, "{found:?}");
        }
    }

    /// A resample is that of the values themselves, each drawn as often as the stream says, by Welford's recurrence.
    #[test]
    fn resamples_by_a_second_way() {
        let entries = made_up(6, &[(40, 5)], 0.0);
        let groups = groups(entries.iter()).unwrap().0;
        let table = residuals(&groups[0]);
        for history in 0..50 {
            let mut stream = Stream::new(9, Purpose::Resampling, 0, history);
            let drawn: Vec<usize> = {
                let mut stream = stream.clone();
                (0..40).map(|_| stream.index(40)).collect()
            };
            let one = |entry: &&Entry| {
                let whole: Moments = entry.maps.iter().collect();
                let m: Moments = drawn.iter().map(|&i| entry.maps[i]).collect();
                student_p(distance(m.mean(), m.std_error(), whole.mean(), entry.error), 39)
            };
            let expected = groups[0].entries.iter().map(one).fold(1.0, f64::min);
            let found = table.smallest_p(&mut stream);
            // Single precision: 1e-6 of a deviation of at most 6, in the logarithm of p.
            assert!((found / expected - 1.0).abs() < 1e-3, "{found} for {expected}");
        }
    }

    /// Cases that share half their variance, in groups of different sizes, some of few maps: right predictions are
    /// refused at the nominal rate, which Bonferroni's bound would miss.
    #[test]
    fn right_predictions_pass_at_the_nominal_rate() {
        let mut alarms = [0; 2];
        for seed in 0..400 {
            let entries = made_up(seed, &[(192, 40), (128, 60), (64, 30)], 0.0);
            let groups = groups(entries.iter()).unwrap().0;
            let p = Null::new(&groups, seed, 400).largest(&groups, None).p;
            alarms[0] += u64::from(p < 0.05);
            alarms[1] += u64::from(p < 0.2);
        }
        for (alarms, level) in alarms.into_iter().zip([0.05, 0.2]) {
            let interval = wilson_interval(alarms, 400, 1.0 - ALPHA);
            assert!(interval.contains(level), "{alarms} of 400 at {level}");
        }
    }

    /// One per cent in one case of 70 is 8 standard errors of 1,600 maps; the bound is at 4.5 or so.
    #[test]
    fn one_per_cent_too_much_is_seen() {
        for seed in 0..10 {
            let mut entries = made_up(seed, &[(1600, 40), (64, 30)], 0.0);
            entries[7].maps.iter_mut().for_each(|x| *x += 0.01);
            let groups = groups(entries.iter()).unwrap().0;
            let null = Null::new(&groups, seed, 2000);
            let found = null.largest(&groups, None);
            assert!(found.p <= 1e-3 && found.case == "c7" && found.z() > null.bound(1e-3), "{found:?}");
        }
    }

    #[test]
    fn a_missing_term_is_seen_far_beyond_the_resamples() {
        let entries = made_up(5, &[(256, 10)], 0.0);
        let groups = groups(entries.iter()).unwrap().0;
        let null = Null::new(&groups, 1, 1000);
        assert!(null.largest(&groups, None).p > 1e-3);
        assert!(null.largest(&groups, Some(Term::Edge)).p < 1e-12);
        assert_eq!(null.largest(&groups, Some(Term::Step)), null.largest(&groups, None));
    }

    /// A single case: the bound is that of Student's t, within what resampling can tell.
    #[test]
    fn the_bound_of_one_case_is_students() {
        let entries = made_up(2, &[(512, 1)], 0.0);
        let groups = groups(entries.iter()).unwrap().0;
        let bound = Null::new(&groups, 1, 20_000).bound(0.05);
        // The 5 % quantile of 20,000: 0.03 relative in probability, 0.015 in deviations; five of these, and the
        // skewness and excess of one sample of 512 values, 1/sqrt(512) of a deviation or so.
        assert!((bound - 1.96).abs() < 0.075 + 0.05, "{bound}");
    }
}
