//! What is left of whole groups, and of all of them: a bias that every case shares is small beside the error of one case
//! and large beside that of all.
//!
//! Cases of a group share their maps, so that they are summed map by map, each weighted by what it knows: a group gives
//! one number a map. Groups share nothing, and their means are summed in the same way.

use super::largest::deviations;
use super::sets::{Group, distance, predicted};
use turbid::stats::{Moments, chi_squared_p, normal_p, student_p};

/// What is left over between measurement and prediction, as a fraction of the exact values.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Left {
    /// Weighted mean.
    pub mean: f64,
    /// Its standard error, with the bounds on the predictions' numerical errors.
    pub error: f64,
}

impl Left {
    /// In standard errors.
    pub fn distance(&self) -> f64 {
        distance(self.mean, self.error, 0.0, 0.0)
    }
}

/// What is left of one group, and its p-value by Student's t.
fn left_of_group(group: &Group) -> (Left, f64) {
    let mut sums = vec![0.0; group.maps];
    let (mut weights, mut bound) = (0.0, 0.0);
    for entry in &group.entries {
        let m: Moments = entry.maps.iter().collect();
        let weight = 1.0 / (m.std_error() * m.std_error() + entry.error * entry.error).max(f64::MIN_POSITIVE);
        let expected = predicted(entry, None);
        sums.iter_mut().zip(&entry.maps).for_each(|(sum, map)| *sum += weight * (map - expected));
        weights += weight;
        // One sign for all: predictions of a group share their tables.
        bound += weight * entry.error;
    }
    let m: Moments = sums.iter().map(|sum| sum / weights).collect::<Vec<f64>>().iter().collect();
    let left = Left { mean: m.mean(), error: libm::hypot(m.std_error(), bound / weights) };
    (left, student_p(left.distance(), m.n() - 1))
}

/// What is left over in all groups together.
#[derive(Debug, Clone, PartialEq)]
pub struct Common<'a> {
    /// In all cases alike.
    pub all: Left,
    /// Of as much in all cases alike, two-sided.
    pub p_all: f64,
    /// Of groups that are as far off together, of either sign: by the sum of their squared distances.
    pub p_groups: f64,
    /// What is left of each group, and its p-value, the farthest off first.
    pub groups: Vec<(&'a str, Left, f64)>,
}

impl<'a> Common<'a> {
    /// Sums up at least one group.
    pub fn new(groups: &[Group<'a>]) -> Self {
        let (mut sum, mut weights, mut squares) = (0.0, 0.0, 0.0);
        let mut each = Vec::new();
        for group in groups {
            let (left, p) = left_of_group(group);
            // The variance of Student's t: small groups know their own error less well.
            let freedom = (group.maps - 1) as f64;
            let weight = (freedom - 2.0) / freedom / (left.error * left.error).max(f64::MIN_POSITIVE);
            sum += weight * left.mean;
            weights += weight;
            let z = deviations(p);
            squares += z * z;
            each.push((group.name, left, p));
        }
        each.sort_by(|a, b| a.2.total_cmp(&b.2));
        let all = Left { mean: sum / weights, error: 1.0 / weights.sqrt() };
        Common {
            all,
            p_all: normal_p(all.distance()),
            p_groups: chi_squared_p(squares, groups.len() as u64),
            groups: each,
        }
    }

    /// The standard error of a group: the median.
    pub fn middle_error(&self) -> f64 {
        let mut errors: Vec<f64> = self.groups.iter().map(|(_, left, _)| left.error).collect();
        errors.sort_by(f64::total_cmp);
        errors[errors.len() / 2]
    }
}

#[cfg(test)]
mod tests {
    use super::super::sets::groups;
    use super::super::sets::tests::made_up;
    use super::*;
    use crate::prediction::{Entry, Term};
    use turbid::stats::{ALPHA, wilson_interval};

    fn common(entries: &[Entry]) -> Common<'_> {
        Common::new(&groups(entries.iter()).unwrap().0)
    }

    /// Two cases of four maps: variances 5/3 and 20/3 of a map, so weights 4 and 1, and differences 1 and 2 too large.
    #[test]
    fn a_group_by_hand() {
        let one = Entry::new("g", "a", &[(Term::Blur, 1.0)], 0.0, vec![0.5, 1.5, 2.5, 3.5]);
        let two = Entry::new("g", "b", &[(Term::Blur, 3.0)], 0.0, vec![2.0, 4.0, 6.0, 8.0]);
        let (left, p) = left_of_group(&Group { name: "g", maps: 4, entries: vec![&one, &two] });
        // (4 x 1 + 1 x 2)/5; a map rises by (4 x 1 + 1 x 2)/5 = 1.2 too: variance 1.44 x 5/3, over 4 maps.
        assert!((left.mean - 1.2).abs() < 1e-14 && (left.error - 0.6f64.sqrt()).abs() < 1e-14, "{left:?}");
        assert!((p - student_p(1.2 / 0.6f64.sqrt(), 3)).abs() < 1e-14);
    }

    /// Right predictions: either p is uniform where it is asked, whatever the cases share and how few the maps are.
    #[test]
    fn right_predictions_pass_at_the_nominal_rate() {
        let mut alarms = [0; 2];
        for seed in 0..1000 {
            let shape: Vec<(usize, usize)> = [(16, 30), (24, 3), (192, 5), (512, 8), (64, 3)].repeat(6);
            let entries = made_up(seed, &shape, 0.0);
            let found = common(&entries);
            alarms[0] += u64::from(found.p_all < 0.05);
            alarms[1] += u64::from(found.p_groups < 0.05);
        }
        let level = |alarms| wilson_interval(alarms, 1000, 1.0 - ALPHA);
        assert!(level(alarms[0]).contains(0.05) && level(alarms[1]).contains(0.05), "{alarms:?}");
    }

    /// Half a per cent in all cases is little beside the 5 % of one map; 100 groups of 64 maps know it to 0.05 %.
    #[test]
    fn a_bias_of_all_and_one_of_a_group() {
        for seed in 0..10 {
            let mut entries = made_up(seed, &[(64, 6); 100], 0.005);
            let all = common(&entries);
            assert!(all.p_all < 1e-6 && (all.all.mean - 0.005).abs() < 5.0 * all.all.error, "{all:?}");
            entries = made_up(seed, &[(64, 6); 100], 0.0);
            assert!(common(&entries).p_all > 1e-5);
            for entry in entries.iter_mut().filter(|e| e.group == "g7") {
                entry.maps.iter_mut().for_each(|x| *x += 0.1);
            }
            let found = common(&entries);
            let (name, left, p) = found.groups[0];
            assert!(name == "g7" && left.mean > 0.02 && p < 1e-6 && found.p_groups < 1e-3, "{found:?}");
            // Half of the groups 1 % too high and half too low: three standard errors each, and none in the mean.
            entries = made_up(seed, &[(64, 6); 100], 0.0);
            for entry in &mut entries {
                let number: u32 = entry.group[1..].parse().unwrap();
                let sign = if number.is_multiple_of(2) { 1.0 } else { -1.0 };
                entry.maps.iter_mut().for_each(|x| *x += 0.01 * sign);
            }
            let found = common(&entries);
            assert!(found.p_all > 1e-5 && found.p_groups < 1e-9, "{found:?}");
        }
    }
}
