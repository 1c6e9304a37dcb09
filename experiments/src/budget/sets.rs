//! Independent sets of maps, and one case drawn for each.

use crate::harness::Digest;
use crate::prediction::{Entry, Term};
use anyhow::ensure;
use std::ops::Range;
use turbid::rng::{Purpose, Stream};
use turbid::stats::{KolmogorovSmirnov, Moments, kolmogorov_smirnov_test, student_p};

/// Most maps of a set: few enough that a quick study has 200 sets and more, many enough that means are nearly normal.
pub const MOST: usize = 32;
/// Fewest maps of a group that is asked at all.
const FEWEST: usize = 16;

/// Entries that share their maps.
pub struct Group<'a> {
    /// Its name, unique in the study.
    pub name: &'a str,
    /// Number of maps.
    pub maps: usize,
    /// Its entries.
    pub entries: Vec<&'a Entry>,
}

/// The groups in the order in which they appear, and how many entries were left out: those whose variance a few maps
/// carry, and those of fewer than 16 maps.
///
/// # Errors
/// Entries of one group with different numbers of maps, or values that are not finite.
pub fn groups<'a>(entries: impl Iterator<Item = &'a Entry>) -> anyhow::Result<(Vec<Group<'a>>, usize)> {
    let mut groups: Vec<Group> = Vec::new();
    let mut left_out = 0;
    for entry in entries {
        let maps = entry.maps.len();
        let values = entry.maps.iter().chain(&entry.terms).chain([&entry.error]);
        ensure!(values.clone().all(|v| v.is_finite()), "{} in {} is not finite", entry.case, entry.group);
        if maps < FEWEST || entry.maps.iter().collect::<Moments>().is_heavy_tailed() {
            left_out += 1;
            continue;
        }
        match groups.iter_mut().find(|g| g.name == entry.group) {
            Some(group) => {
                ensure!(
                    group.maps == maps,
                    "{} has {maps} maps, but its group {} has {}",
                    entry.case,
                    entry.group,
                    group.maps
                );
                group.entries.push(entry);
            }
            None => groups.push(Group { name: &entry.group, maps, entries: vec![entry] }),
        }
    }
    Ok((groups, left_out))
}

/// The predicted error of an entry, with one term taken away if one is named.
pub fn predicted(entry: &Entry, without: Option<Term>) -> f64 {
    Term::ALL.iter().zip(entry.terms).filter(|(term, _)| Some(**term) != without).map(|(_, x)| x).sum()
}

/// Whether a term is part of an entry's prediction; every entry carries none.
pub fn carries(entry: &Entry, term: Option<Term>) -> bool {
    term.is_none_or(|term| entry.terms[term as usize] != 0.0)
}

/// What is left of a mean over maps, in its standard errors. The bound on the prediction's numerical error is taken as
/// an independent error of that size: where it is small, as it should be, that changes nothing; where it is not, the
/// distance is too small, never too large.
pub fn distance(mean: f64, std_error: f64, predicted: f64, error: f64) -> f64 {
    let (left, scale) = (mean - predicted, libm::hypot(std_error, error));
    // A case without any spread that is met exactly.
    if left == 0.0 && scale == 0.0 { 0.0 } else { left / scale }
}

/// One entry, asked of one set of maps.
pub struct Drawn<'a> {
    entry: &'a Entry,
    moments: Moments,
}

impl<'a> Drawn<'a> {
    /// Draws one entry for every map set, among those that carry a term if one is named; groups without such an entry
    /// give none. The draw depends on seed, group and term alone.
    pub fn all(groups: &[Group<'a>], seed: u64, carrying: Option<Term>) -> Vec<Drawn<'a>> {
        let mut drawn = Vec::new();
        for group in groups {
            let entries: Vec<&'a Entry> =
                group.entries.iter().copied().filter(|e| carries(e, carrying)).collect();
            if !entries.is_empty() {
                let kind = carrying.map_or(String::new(), |term| format!("/{}", term.name()));
                let name = Digest::of(format!("budget{kind}/{}", group.name).as_bytes()).word();
                for (set, maps) in map_sets(group.maps).into_iter().enumerate() {
                    let mut stream = Stream::new(seed, Purpose::Resampling, name, set as u64);
                    let entry = entries[stream.index(entries.len())];
                    drawn.push(Drawn { entry, moments: entry.maps[maps].iter().collect() });
                }
            }
        }
        drawn
    }

    /// The value of Student's distribution function at what is left over: uniform if nothing is.
    pub fn uniform(&self, without: Option<Term>) -> f64 {
        let Drawn { entry, moments } = self;
        let t = distance(moments.mean(), moments.std_error(), predicted(entry, without), entry.error);
        let tail = 0.5 * student_p(t, moments.n() - 1);
        if t < 0.0 { tail } else { 1.0 - tail }
    }
}

/// The test of Kolmogorov and Smirnov over all sets.
pub fn fit(drawn: &[Drawn], without: Option<Term>) -> KolmogorovSmirnov {
    let values: Vec<f64> = drawn.iter().map(|d| d.uniform(without)).collect();
    kolmogorov_smirnov_test(&values, |u| u)
}

/// Consecutive maps in as few sets of at most 32 as possible, of nearly equal sizes.
fn map_sets(maps: usize) -> Vec<Range<usize>> {
    let sets = maps.div_ceil(MOST);
    (0..sets).map(|i| i * maps / sets..(i + 1) * maps / sets).collect()
}

#[cfg(test)]
pub mod tests {
    use super::*;
    use turbid::math::{ln, sin_cos};

    /// Groups of maps with a shared and an own normal part in each case: what `bias` adds to the predicted error is
    /// left over. Case i has the terms blur 0.05 and, if i is even, edge -0.5.
    pub fn made_up(seed: u64, shape: &[(usize, usize)], bias: f64) -> Vec<Entry> {
        let mut entries = Vec::new();
        for (g, &(maps, cases)) in shape.iter().enumerate() {
            let mut stream = Stream::new(seed, Purpose::Synthetic, g as u64, 0);
            let mut normal =
                || (-2.0 * ln(stream.open_unit())).sqrt() * sin_cos(std::f64::consts::TAU * stream.unit()).1;
            let shared: Vec<f64> = (0..maps).map(|_| normal()).collect();
            for i in 0..cases {
                let terms = [(Term::Blur, 0.05), (Term::Edge, if i % 2 == 0 { -0.5 } else { 0.0 })];
                let truth = terms[0].1 + terms[1].1 + bias;
                let values = shared.iter().map(|s| truth + 0.05 * (0.7 * s + 0.7 * normal())).collect();
                entries.push(Entry::new(format!("g{g}"), format!("c{i}"), &terms, 1e-9, values));
            }
        }
        entries
    }

    #[test]
    fn sets_are_consecutive_whole_and_small() {
        for maps in [16, 32, 33, 64, 100, 192, 511] {
            let sets = map_sets(maps);
            assert!(sets.iter().all(|s| (16..=32).contains(&s.len())), "{maps}");
            let joined: Vec<usize> = sets.into_iter().flatten().collect();
            assert_eq!(joined, (0..maps).collect::<Vec<_>>());
        }
    }

    /// Five values, 1 to 5: mean 3, standard error sqrt(1/2). Against 2 that is t = sqrt 2 at 4 degrees, whose two-sided
    /// p is 1 - s (3 - s^2)/2 with s = t/sqrt(t^2 + 4); a numerical error of sqrt(1/2) beside it makes t = 1.
    #[test]
    fn what_is_left_over_by_hand() {
        let root = 0.5f64.sqrt();
        for (error, t, predicted) in [(0.0, 2f64.sqrt(), 2.0), (root, 1.0, 2.0), (0.0, -2f64.sqrt(), 4.0)] {
            let terms = [(Term::Blur, predicted - 0.5), (Term::Edge, 0.5)];
            let entry = Entry::new("g", "c", &terms, error, vec![1.0, 2.0, 3.0, 4.0, 5.0]);
            let drawn = Drawn { entry: &entry, moments: entry.maps.iter().collect() };
            let s: f64 = t / (t * t + 4.0f64).sqrt();
            let below = 0.5 + 0.25 * s * (3.0 - s * s);
            assert!((drawn.uniform(None) - below).abs() < 1e-12, "{t}: {} for {below}", drawn.uniform(None));
            assert!((distance(3.0, root, predicted, error) - t).abs() < 1e-14);
        }
    }

    #[test]
    fn groups_are_checked() {
        let mut entries = made_up(1, &[(64, 3), (32, 2)], 0.0);
        let (found, left_out) = groups(entries.iter()).unwrap();
        assert_eq!((found.len(), found[0].entries.len(), found[1].maps, left_out), (2, 3, 32, 0));
        entries[2].maps.pop();
        assert!(groups(entries.iter()).is_err());
        entries[2].maps.truncate(8);
        assert_eq!(groups(entries.iter()).unwrap().1, 1);
        entries[0].maps[5] = 1e3;
        assert_eq!(groups(entries.iter()).unwrap().1, 2);
        entries[0].maps[5] = f64::NAN;
        assert!(groups(entries.iter()).is_err());
    }

    /// Right predictions: p is uniform, whatever the cases share. 400 made-up studies; a share of alarms at 5 %.
    #[test]
    fn right_predictions_pass_at_the_nominal_rate() {
        let alarms = (0..400).filter(|&seed| {
            let entries = made_up(seed, &[(192, 5), (512, 8), (64, 3)], 0.0);
            fit(&Drawn::all(&groups(entries.iter()).unwrap().0, seed, None), None).p < 0.05
        });
        let interval = turbid::stats::wilson_interval(alarms.count() as u64, 400, 1.0 - turbid::stats::ALPHA);
        assert!(interval.contains(0.05), "{interval:?}");
    }

    /// One per cent is 1.1 standard errors of a set of 32 maps with a deviation of 5 %: 240 sets refuse it.
    #[test]
    fn one_per_cent_too_much_is_seen() {
        for seed in 0..20 {
            let entries = made_up(seed, &[(2560, 8), (5120, 3)], 0.01);
            let drawn = Drawn::all(&groups(entries.iter()).unwrap().0, seed, None);
            assert!(drawn.len() == 240 && fit(&drawn, None).p < 1e-6);
        }
    }

    #[test]
    fn a_missing_term_is_seen_and_the_draw_repeats() {
        let entries = made_up(3, &[(640, 4)], 0.0);
        let groups = groups(entries.iter()).unwrap().0;
        let drawn = Drawn::all(&groups, 1, None);
        assert!(fit(&drawn, None).p > 1e-3);
        assert!(fit(&drawn, Some(Term::Blur)).p < 1e-6 && fit(&drawn, Some(Term::Edge)).p < 1e-3);
        assert_eq!(fit(&drawn, Some(Term::Step)), fit(&Drawn::all(&groups, 1, None), None));
        assert_ne!(fit(&drawn, None), fit(&Drawn::all(&groups, 2, None), None));
    }

    /// A term's own draw has nothing but entries with it, and so detects it at once.
    #[test]
    fn a_term_is_asked_of_its_own_entries() {
        let entries = made_up(3, &[(640, 4), (320, 1)], 0.0);
        let groups = groups(entries.iter()).unwrap().0;
        let edge = Drawn::all(&groups, 1, Some(Term::Edge));
        assert!(edge.len() == 30 && edge.iter().all(|d| d.entry.terms[Term::Edge as usize] != 0.0));
        assert!(fit(&edge, None).p > 1e-3 && fit(&edge, Some(Term::Edge)).p < 1e-12);
        assert!(Drawn::all(&groups, 1, Some(Term::Step)).is_empty());
    }
}
