//! Tests of what two methods made: cell by cell, layer by layer, and what they could have detected.

use super::energy::Energy;
use super::maps::{ByMaps, FACTOR};
use super::measure::{CELLS, Cell, Mean, Measured, Seen, is_heavy};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use turbid::Spectrum;
use turbid::integrators::Layer;
use turbid::stats::{POWER_QUANTILE, student_critical, student_p};

/// Level at which a number is measured again: what is no matter of chance must be detected then too, so that it may be larger than
/// that of tests which decide.
const ALPHA: f64 = 1e-4;

/// The smallest deviation that is hardly ever missed at this level, where differences below `explained` are no alarm.
fn smallest_deviation(std_error: f64, freedom: u64, explained: f64) -> f64 {
    (student_critical(ALPHA, freedom) * std_error).max(explained) + POWER_QUANTILE * std_error
}

/// One number against another.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Test {
    /// Layer and channel, and the quarter if it is not the whole picture, in words.
    pub cell: String,
    /// What is to be tested.
    pub value: f64,
    /// What it should be.
    pub expected: f64,
    /// Standard error of the difference.
    pub std_error: f64,
    /// Part of the difference that is explained.
    pub allowed: f64,
    /// p-value of the rest.
    pub p: f64,
    /// The smallest detectable deviation, over what is expected; none where the tail is heavy.
    pub smallest: Option<f64>,
    /// Light of the cell, as a weight.
    pub weight: f64,
}

impl Test {
    /// Whether it calls for a confirmation.
    pub fn is_suspicious(&self) -> bool {
        self.p < ALPHA
    }

    /// In a line.
    pub fn line(&self) -> String {
        let allowed =
            if self.allowed > 0.0 { format!(", explained {:.2e}", self.allowed) } else { String::new() };
        let tail = if self.smallest.is_none() { ", heavy tail: no verdict" } else { "" };
        format!(
            "{}: {:.5e} for {:.5e}, difference {:+.2e} ({:+.1} %), error {:.2e}{allowed}, p {:.1e}{tail}",
            self.cell,
            self.value,
            self.expected,
            self.value - self.expected,
            100.0 * (self.value / self.expected - 1.0),
            self.std_error,
            self.p
        )
    }
}

/// What one comparison found.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Check {
    /// Which two.
    pub name: String,
    /// Its tests.
    pub tests: Vec<Test>,
    /// Half of the light is in cells where a deviation of this much, relative, is detectable; none if half of it is in
    /// cells of heavy tails.
    pub smallest: Option<f64>,
}

/// The detectable deviation in half of all light; none if half of it is in cells of heavy tails.
fn median(mut all: Vec<(f64, f64)>) -> Option<f64> {
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    let half = 0.5 * all.iter().map(|(_, weight)| weight).sum::<f64>();
    let mut sum = 0.0;
    let found = all.iter().find(|(_, weight)| {
        sum += weight;
        sum >= half
    });
    found.map(|(smallest, _)| *smallest).filter(|s| s.is_finite())
}

/// Whether photon maps make a layer: the others are unbiased in every method.
fn has_map(layer: &str) -> bool {
    [Layer::Caustic, Layer::Indirect, Layer::Multiple].iter().any(|l| l.name() == layer)
}

/// What a scene would have shown: the detectable deviation in half of its light, layer by layer and channel by
/// channel. In a layer it is that of the sharpest comparison of unbiased pictures or, where that of photon maps is less
/// sharp and the layer is made by them, of that one. 0 where all is black.
pub fn sharpness(checks: &[&Check]) -> Option<f64> {
    let mut weights: BTreeMap<&str, f64> = BTreeMap::new();
    for (layer, _, weight) in checks.iter().flat_map(|check| check.layers()) {
        let most = weights.entry(layer).or_default();
        *most = most.max(weight);
    }
    let mut layers: BTreeMap<&str, [Option<f64>; 2]> = BTreeMap::new();
    for check in checks {
        for (layer, smallest, weight) in check.layers() {
            let name = layer.split('.').next().unwrap_or_default();
            let by_maps = usize::from(check.name.starts_with("maps") && has_map(name));
            let best = &mut layers.entry(layer).or_default()[by_maps];
            // What is seen straight may be a small part.
            let smallest = if weight >= 0.5 * weights[layer] { smallest } else { f64::INFINITY };
            *best = Some(best.map_or(smallest, |best| best.min(smallest)));
        }
    }
    if layers.is_empty() {
        return (!checks.is_empty()).then_some(0.0);
    }
    let larger = |[unbiased, by_maps]: [Option<f64>; 2]| unbiased.unwrap_or(0.0).max(by_maps.unwrap_or(0.0));
    median(layers.into_iter().map(|(layer, smallest)| (larger(smallest), weights[layer])).collect())
}

impl Check {
    fn new(name: &str, tests: Vec<Test>) -> Self {
        let mut check = Check { name: name.to_string(), tests, smallest: None };
        check.smallest = median(check.shares());
        check
    }

    /// Of each test the smallest deviation that it or that of the whole picture would have shown, and its part of the light
    /// that was compared.
    fn shares(&self) -> Vec<(f64, f64)> {
        let all: f64 = self.tests.iter().map(|t| t.weight).sum();
        let smallest = |t: &Test| t.smallest.unwrap_or(f64::INFINITY);
        let whole = |cell: &str| {
            let name = cell.split(' ').next();
            self.tests.iter().find(|t| Some(t.cell.as_str()) == name).map_or(f64::INFINITY, smallest)
        };
        self.tests.iter().map(|t| (smallest(t).min(whole(&t.cell)), t.weight / all)).collect()
    }

    /// Each layer and channel: what would have been detected in the whole picture, or in half of the light of its quarters, and
    /// how much light there is.
    fn layers(&self) -> impl Iterator<Item = (&str, f64, f64)> {
        let wholes = self.tests.iter().filter(|t| !t.cell.contains(' '));
        wholes.map(|whole| {
            let quarters = self.tests.iter().filter(|t| t.cell.starts_with(&format!("{} ", whole.cell)));
            let smallest = |t: &Test| t.smallest.unwrap_or(f64::INFINITY);
            let of_quarters = median(quarters.map(|t| (smallest(t), t.weight)).collect());
            let weight = whole.weight.max(whole.value.abs());
            (whole.cell.as_str(), smallest(whole).min(of_quarters.unwrap_or(f64::INFINITY)), weight)
        })
    }

    /// The test with the smallest p-value.
    pub fn worst(&self) -> Option<&Test> {
        self.tests.iter().min_by(|a, b| a.p.total_cmp(&b.p))
    }
}

/// Degrees of freedom of a difference of two means (Welch 1947), rounded down; the second may be a constant.
fn freedom(va: f64, na: u64, vb: f64, nb: u64) -> u64 {
    let sum = va + vb;
    let spread = va * va / (na - 1) as f64 + vb * vb / (nb - 1) as f64;
    if spread > 0.0 { ((sum * sum / spread) as u64).max(1) } else { na.min(nb) - 1 }
}

/// So many contributions, as large as the largest of their layer and channel in any quarter of the picture, and a difference is
/// out of the reach of chance: none of as many that are expected is drawn once in 5e8 times. What fewer of them would make up
/// may be light that the lower side finds so rarely that it has not, such as a lamp met behind glass after a collision; the
/// standard error of what it has found says nothing of that.
const RARE: f64 = 20.0;

/// A difference of means beyond what is allowed, itself known to an error.
fn test(cell: String, a: &Mean, b: &Mean, (allowed, allowed_error): (f64, f64)) -> Option<Test> {
    let is_heavy = a.is_heavy || b.is_heavy;
    let missing = RARE * if a.moments.mean() < b.moments.mean() { a.largest } else { b.largest };
    let rare = RARE * a.largest.max(b.largest);
    let (a, b) = (&a.moments, &b.moments);
    let (value, expected) = (a.mean(), b.mean());
    if value == 0.0 && expected == 0.0 {
        return None;
    }
    let (va, vb) = (a.std_error() * a.std_error(), b.std_error() * b.std_error());
    let std_error = (va + vb + allowed_error * allowed_error).sqrt();
    let freedom = freedom(va, a.n(), vb, b.n());
    let beyond = ((value - expected).abs() - allowed).max(0.0);
    let p = match std_error {
        // Constants: rounding is no difference.
        0.0 if beyond <= 1e-9 * expected.abs() => 1.0,
        0.0 => 0.0,
        _ if is_heavy || beyond == 0.0 || beyond < missing => 1.0,
        _ => student_p(beyond / std_error, freedom),
    };
    let smallest = (allowed + smallest_deviation(std_error, freedom, rare)) / expected.abs();
    Some(Test {
        cell,
        value,
        expected,
        std_error,
        allowed,
        p,
        smallest: (!is_heavy).then_some(smallest),
        weight: expected.abs(),
    })
}

/// The part of all light in a comparison below which nothing at all on one side is no alarm: a method may find so little so
/// rarely that none of its samples did, and an error of 0 says nothing.
const NEGLIGIBLE: f64 = 0.01;

/// The part of all light in a comparison below which it is what rounding leaves: between two bodies whose faces coincide but for
/// the last digit a ray may find an emitting medium 1e-16 of its size thick, in one place of the scene and not in another.
const ROUNDING: f64 = 1e-12;

/// The tests, without those that nothing can be said of, for these reasons: with a quarter the whole picture is not known where
/// nothing was found.
fn known(mut tests: Vec<Test>) -> Vec<Test> {
    let light = |t: &Test| t.value.abs().max(t.expected.abs());
    let all: f64 = tests.iter().map(light).sum();
    let is_unknown = |t: &Test| (t.value == 0.0 || t.expected == 0.0) && light(t) < NEGLIGIBLE * all;
    let unknown: Vec<String> = tests.iter().filter(|t| is_unknown(t)).map(|t| t.cell.clone()).collect();
    for test in tests.iter_mut().filter(|t| unknown.iter().any(|cell| cell.starts_with(&t.cell))) {
        (test.p, test.smallest) = (1.0, None);
    }
    for test in tests.iter_mut().filter(|t| light(t) < ROUNDING * all) {
        (test.p, test.smallest) = (1.0, None);
    }
    tests
}

/// Two unbiased methods, in the layers that both know.
pub fn unbiased(name: &str, a: &Measured, b: &Measured, knows: impl Fn(Layer) -> bool) -> Check {
    let cells = (0..CELLS).filter(|index| knows(Cell::of(*index).layer));
    Check::new(name, known(cells.flat_map(|index| unbiased_at(index, a, b)).collect()))
}

/// The test of a cell, and with the first quarter that of the whole picture.
fn unbiased_at(index: usize, a: &Measured, b: &Measured) -> impl Iterator<Item = Test> {
    let cell = Cell::of(index);
    let whole = (cell.quarter == 0)
        .then(|| test(cell.whole_name(), &a.whole(index), &b.whole(index), (0.0, 0.0)))
        .flatten();
    whole.into_iter().chain(test(cell.name(), &a.mean(index), &b.mean(index), (0.0, 0.0)))
}

/// Emitted is what the lights have, and ends as absorbed or escaped.
pub fn conserved(energy: &Energy) -> Check {
    let mut tests = Vec::new();
    let parts = [
        ("emitted", &energy.emitted, energy.power_error),
        ("absorbed and escaped", &energy.balance, Spectrum::ZERO),
    ];
    for (name, all, of_power) in parts {
        for (c, (moments, channel)) in all.iter().zip(["r", "g", "b"]).enumerate() {
            let std_error = libm::hypot(moments.std_error(), of_power[c]);
            let z = if moments.mean() == 0.0 { 0.0 } else { moments.mean() / std_error };
            let heavy = is_heavy(moments);
            let is_rounding = moments.mean().abs() < 1e-9;
            let p = if heavy || is_rounding { 1.0 } else { student_p(z, moments.n() - 1) };
            tests.push(Test {
                cell: format!("{name}.{channel}"),
                // About 1, so that what can be detected is relative to the power.
                value: 1.0 + moments.mean(),
                expected: 1.0,
                std_error,
                allowed: 0.0,
                p,
                smallest: (!heavy).then(|| smallest_deviation(std_error, moments.n() - 1, 0.0)),
                weight: 1.0,
            });
        }
    }
    Check::new("energy", tests)
}

/// The part of the light of the brightest quarter that blur may carry into another one. It does not fall with the radius as
/// errors within a quarter do: a bright spot at a distance below the radius counts as the inverse of the disc.
const CARRIED: f64 = 0.01;

/// What photon maps made, against an unbiased method: `of` takes the same part of the picture as `reference` has.
///
/// Layers without a map (emission, direct, single) are unbiased. The others have an error D(r) that goes to 0 with the radius:
/// where a field is smooth as r^2, and as r where the radius meets an edge, since the part of a quarter that lies within r
/// of edges is in proportion to r. So D(r) = a r + b r^2 + ..., and with radii in the ratio q = r2/r1 (8^(-1/3) in media,
/// 8^(-1/2) on surfaces) |D(r2)| <= q |D(r1)| where all parts have one sign. Parts of either sign may cancel in one place at
/// the large radius; that they do in all quarters at once is a coincidence that the confirmation's other seed does not
/// remove, and that has not been met: |D(r2)| <= q max |D(r1)| over quarters. An error that does not shrink is larger by
/// 1/q, at least 2.
pub fn shrinking(
    name: &str,
    maps: &ByMaps,
    part: impl Fn(&Seen) -> &Measured,
    reference: &Measured,
    knows: impl Fn(Layer) -> bool,
    has_media: bool,
) -> Check {
    let (small, large) = (part(&maps.small), part(&maps.large));
    let (on_surfaces, in_media) = (1.0 / libm::sqrt(FACTOR as f64), 1.0 / libm::cbrt(FACTOR as f64));
    let mut tests = Vec::new();
    for index in (0..CELLS).filter(|index| knows(Cell::of(*index).layer)) {
        let cell = Cell::of(index);
        let is_scarce = maps.scarce.contains(&cell.layer);
        let unknown = |test: Test| Test { p: 1.0, smallest: None, ..test };
        let of_map = |found: Option<Test>| if is_scarce { found.map(unknown) } else { found };
        let ratio = match cell.layer {
            Layer::Emission | Layer::Direct | Layer::Single => {
                tests.extend(unbiased_at(index, part(&maps.rays), reference));
                continue;
            }
            Layer::Multiple => in_media,
            Layer::Caustic => on_surfaces,
            // Gathering rays bring the light of media too.
            Layer::Indirect => {
                if has_media {
                    in_media
                } else {
                    on_surfaces
                }
            }
        };
        let reference_of = |index: usize| reference.mean(index);
        // The errors of the small maps in each quarter, with their own errors.
        let coarse: [(f64, f64); 4] = std::array::from_fn(|quarter| {
            let at = index / 4 * 4 + quarter;
            let (a, b) = (small.mean(at).moments, reference_of(at).moments);
            let error = libm::hypot(a.std_error(), b.std_error());
            (ratio * (a.mean() - b.mean()).abs(), ratio * error)
        });
        if cell.quarter == 0 {
            // Errors of either sign do not cancel in what is allowed.
            let error = coarse.iter().map(|(_, error)| error * error).sum::<f64>().sqrt() / 4.0;
            let allowed = (coarse.iter().map(|(error, _)| error).sum::<f64>() / 4.0, error);
            tests.extend(of_map(test(
                cell.whole_name(),
                &large.whole(index),
                &reference.whole(index),
                allowed,
            )));
        }
        let (largest, error) = coarse.into_iter().max_by(|a, b| a.0.total_cmp(&b.0)).unwrap_or_default();
        // A dim quarter has what is carried over its border from a bright one.
        let first = index / 4 * 4;
        let brightest = (first..first + 4).map(|at| reference.mean(at).moments.mean()).fold(0.0, f64::max);
        let allowed = (largest + CARRIED * brightest, error);
        tests.extend(of_map(test(cell.name(), &large.mean(index), &reference_of(index), allowed)));
    }
    Check::new(name, known(tests))
}

#[cfg(test)]
mod tests {
    use super::super::maps::LARGE_MAPS;
    use super::super::measure::{BATCHES, Batch};
    use super::*;
    use turbid::math::{exp, ln, sin_cos};
    use turbid::rng::{Purpose, Stream};

    /// A layer counts as seen where unbiased pictures and photon maps both would have shown a deviation; in layers without a
    /// map any comparison does; heavy tails are none; black pictures agree.
    #[test]
    fn a_scene_is_as_sharp_as_its_layers() {
        let check = |name: &str, cells: &[(&str, f64, Option<f64>)]| {
            let test = |(cell, weight, smallest): &(&str, f64, Option<f64>)| Test {
                cell: cell.to_string(),
                value: *weight,
                expected: *weight,
                std_error: 0.0,
                allowed: 0.0,
                p: 1.0,
                smallest: *smallest,
                weight: *weight,
            };
            Check::new(name, cells.iter().map(test).collect())
        };
        let light = check("light - paths", &[("direct.r", 1.0, Some(0.5)), ("multiple.r", 9.0, None)]);
        let maps = check("maps - paths", &[("direct.r", 1.0, Some(0.1)), ("multiple.r", 9.0, Some(0.2))]);
        let pair = check("turned - paths", &[("direct.r", 1.0, Some(0.3)), ("multiple.r", 9.0, Some(0.1))]);
        assert_eq!(sharpness(&[&light, &maps, &pair]), Some(0.2));
        assert_eq!(sharpness(&[&light, &pair]), Some(0.1));
        assert_eq!(sharpness(&[&light, &maps]), None);
        assert_eq!(sharpness(&[&check("light - paths", &[])]), Some(0.0));
        assert_eq!(sharpness(&[]), None);
        // Less than half of a layer's light says nothing of it.
        for (weight, expected) in [(4.0, None), (5.0, Some(0.1))] {
            let part = check("light - paths", &[("multiple.r", weight, Some(0.1))]);
            let all = check("turned - paths", &[("multiple.r", 9.0, None)]);
            assert_eq!(sharpness(&[&part, &all]), expected);
        }
        // Half of the light is in one quarter, which shows more than the whole picture.
        let cells = [
            ("direct.r", 1.0, None),
            ("direct.r top left", 3.0, Some(0.1)),
            ("direct.r top right", 1.0, None),
        ];
        assert_eq!(sharpness(&[&check("light - paths", &cells)]), Some(0.1));
    }

    /// Batches of noise of 2 per cent about 1, shifted by layer; red, green and blue by 1, 2 and 3.
    fn made(set: u64, count: usize, shift: impl Fn(Cell) -> f64) -> Measured {
        let mut stream = Stream::new(5, Purpose::Synthetic, set, 0);
        let mut normal =
            || (-2.0 * ln(stream.open_unit())).sqrt() * sin_cos(std::f64::consts::TAU * stream.unit()).1;
        let mut batch = |_| -> Batch {
            std::array::from_fn(|index| {
                let cell = Cell::of(index);
                (cell.channel + 1) as f64 * (1.0 + shift(cell)) * (1.0 + 0.02 * normal())
            })
        };
        Measured { batches: (0..count).map(&mut batch).collect(), ..Measured::default() }
    }

    fn seen(all: Measured) -> Seen {
        Seen { all, ..Seen::default() }
    }

    #[test]
    fn cells_have_their_places() {
        let names: std::collections::BTreeSet<String> = (0..CELLS).map(|i| Cell::of(i).name()).collect();
        assert_eq!(names.len(), CELLS);
        assert_eq!(Cell::of(0).name(), "emission.r top left");
        assert_eq!(Cell::of(CELLS - 1).name(), "multiple.b bottom right");
        let measured = made(0, 64, |cell| cell.quarter as f64);
        for index in 0..CELLS {
            let (a, b) = (measured.flipped().mean(index).moments, measured.mean(index ^ 1).moments);
            assert_eq!((a.mean(), Cell::of(index).quarter / 2), (b.mean(), Cell::of(index ^ 1).quarter / 2));
        }
    }

    /// Right pairs, 100 of 90 numbers: at 10^-4 one is measured again in the mean, six or more are in one of a thousand such
    /// sets. One number of one deviates by what the comparison says it detects.
    #[test]
    fn two_means_differ_where_they_do() {
        let alarms = |check: &Check| check.tests.iter().filter(|t| t.is_suspicious()).count();
        let mut again = 0;
        for set in 0..100 {
            let (a, b) = (made(2 * set, BATCHES, |_| 0.0), made(2 * set + 1, BATCHES, |_| 0.0));
            let check = unbiased("a", &a, &b, |_| true);
            assert_eq!(check.tests.len(), CELLS / 4 * 5);
            again += alarms(&check);
            // 0.02 sqrt(2/64) times 6.4 (126 degrees of freedom), half of it for the whole picture.
            assert!((check.smallest.unwrap() - 0.0113).abs() < 0.001, "{:?}", check.smallest);
        }
        assert!(again < 6, "{again}");
        let dark = Cell::of(40);
        let wrong = made(1000, BATCHES, |cell| if cell == dark { -0.035 } else { 0.0 });
        let check = unbiased("a", &wrong, &made(1001, BATCHES, |_| 0.0), |_| true);
        assert_eq!((alarms(&check), check.worst().unwrap().cell.clone()), (1, dark.name()));
    }

    /// An error that falls with the radius is none; one that stays, or a layer that is missing, is one; layers without a map
    /// may have none at all.
    #[test]
    fn errors_must_shrink() {
        let reference = made(1, BATCHES, |_| 0.0);
        let of = |small: f64, large: f64, plain: f64| {
            let has_map =
                |cell: Cell| matches!(cell.layer, Layer::Caustic | Layer::Indirect | Layer::Multiple);
            let with = |x: f64| move |cell: Cell| if has_map(cell) { x } else { 0.0 };
            let maps = ByMaps {
                rays: seen(made(2, BATCHES, |cell| if has_map(cell) { 0.0 } else { plain })),
                small: seen(made(3, BATCHES, with(small))),
                large: seen(made(4, LARGE_MAPS, with(large))),
                scarce: Vec::new(),
            };
            let check = shrinking("a", &maps, |s| &s.all, &reference, |_| true, true);
            let mut layers: Vec<String> =
                check.tests.iter().filter(|t| t.is_suspicious()).map(|t| t.cell.clone()).collect();
            layers.iter_mut().for_each(|cell| cell.truncate(cell.find('.').unwrap_or(0)));
            layers.dedup();
            layers.join(" ")
        };
        assert_eq!(of(0.0, 0.0, 0.0), "");
        // In proportion to r: on surfaces 0.35 of it stays, in media half.
        assert_eq!(of(-0.4, -0.14, 0.0), "");
        assert_eq!(of(-0.4, -0.19, 0.0), "caustic");
        assert_eq!(of(-0.2, -0.2, 0.0), "caustic indirect multiple");
        assert_eq!(of(-1.0, -1.0, 0.0), "caustic indirect multiple");
        assert_eq!(of(0.0, 0.0, 0.05), "emission direct single");
    }

    /// A difference that few contributions of the size of those in another quarter would make up is none, and is not counted as
    /// seen; where it takes many, it is one.
    #[test]
    fn what_is_rare_may_be_missing() {
        const SAMPLES: f64 = 1e4;
        let dim = Cell::of(40);
        let with_tails = |measured: Measured, largest: f64| {
            let tails = (0..CELLS).map(|index| {
                let mut tail = turbid::stats::Tail::default();
                tail.push(if index == 41 { largest } else { 3.0 });
                tail
            });
            Measured { tails: tails.collect(), samples: [SAMPLES; 4], ..measured }
        };
        let shift = |cell: Cell| if cell == dim { -0.05 } else { 0.0 };
        let find = |largest: f64| {
            let (low, high) = (made(1, BATCHES, shift), made(2, BATCHES, |_| 0.0));
            let check = unbiased("a", &with_tails(low, largest), &with_tails(high, 3.0), |_| true);
            check.tests.into_iter().find(|t| t.cell == dim.name()).unwrap()
        };
        // The difference is 0.05 x 2 of green: twenty contributions of 30 are 0.06 of a mean over 10,000, of 60 are 0.12.
        let (seen, unknown) = (find(30.0), find(60.0));
        assert!(dim.channel == 1 && seen.p < 1e-12 && unknown.p == 1.0, "{seen:?} {unknown:?}");
        let smallest = (0.12 + POWER_QUANTILE * unknown.std_error) / unknown.expected;
        assert!((unknown.smallest.unwrap() / smallest - 1.0).abs() < 1e-9, "{unknown:?}");
        // On the brighter side large contributions are no excuse.
        let (low, high) = (made(1, BATCHES, shift), made(2, BATCHES, |_| 0.0));
        let check = unbiased("a", &with_tails(low, 3.0), &with_tails(high, 60.0), |_| true);
        assert_eq!(check.worst().unwrap().cell, dim.name());
        assert!(check.worst().unwrap().is_suspicious());
    }

    /// A method that found nothing is wrong where there is much, and knows nothing where there is little.
    #[test]
    fn nothing_is_no_number() {
        let much = made(1, BATCHES, |_| 0.0);
        let without = |light: f64| {
            let change = |batch: &Batch, to: f64| {
                let mut batch = *batch;
                batch[3] *= to;
                batch
            };
            let with = |to: f64| {
                let batches = much.batches.iter().map(|b| change(b, to)).collect();
                Measured { batches, ..Measured::default() }
            };
            unbiased("a", &with(0.0), &with(light), |_| true)
        };
        assert!(without(10.0).tests.iter().any(|t| t.p < 1e-12));
        assert!(without(0.1).tests.iter().all(|t| t.p == 1.0));
    }

    /// A layer of 1e-13 of the light may differ by any factor, one of 1e-10 may not.
    #[test]
    fn what_rounding_leaves_is_no_difference() {
        let much = made(1, BATCHES, |_| 0.0);
        let alarms = |share: f64| {
            let with = |to: f64| {
                let scaled = |batch: &Batch| {
                    let mut batch = *batch;
                    batch[..12].iter_mut().for_each(|x| *x *= to);
                    batch
                };
                Measured { batches: much.batches.iter().map(scaled).collect(), ..Measured::default() }
            };
            unbiased("a", &with(share), &with(2.0 * share), |_| true).tests.iter().any(Test::is_suspicious)
        };
        assert!(!alarms(1e-13) && alarms(1e-10));
    }

    /// Tails without a variance, against numbers without a tail and against their like: false alarms are rare, and a change by
    /// the smallest deviation that is said to be detectable, darker or brighter, is detected. Shapes of 0.5 to 0.7, 200 sets of 64
    /// batches of 300 for each: at most one false alarm (0.02 are expected where tails are light), one miss in twenty.
    #[test]
    fn deviations_are_seen_under_heavy_tails() {
        const EACH: u64 = 300;
        for (shape, both) in [(0.5, false), (0.5, true), (0.65, false), (0.65, true), (0.7, false)] {
            let (mut alarms, mut missed, mut known) = (0, 0, 0);
            for set in 0..200 {
                let mut stream = Stream::new(11, Purpose::Synthetic, set, 0);
                let mut made = |is_heavy: bool| {
                    let mut made = Measured::with_tails();
                    for _ in 0..BATCHES {
                        let mut sums = [0.0; CELLS];
                        for _ in 0..EACH {
                            let u = stream.open_unit();
                            // The mean of either is 1/(1 - shape).
                            let x = if is_heavy { exp(-shape * ln(u)) } else { (0.5 + u) / (1.0 - shape) };
                            sums[0] += x;
                            made.keep(std::iter::once((0, x)));
                        }
                        made.push(sums, [EACH as f64; 4]);
                    }
                    made
                };
                let (a, b) = (made(true), made(both).mean(0));
                let times = |factor: f64| {
                    let moments = a.batches.iter().map(|batch| factor * batch[0]).collect();
                    let mean = a.mean(0);
                    let mean = Mean { moments, largest: factor * mean.largest, ..mean };
                    test("a".into(), &mean, &b, (0.0, 0.0)).unwrap()
                };
                let right = times(1.0);
                alarms += usize::from(right.is_suspicious());
                if let Some(smallest) = right.smallest {
                    known += 2;
                    let wrong = [times(1.0 - smallest), times(1.0 + smallest)];
                    missed += wrong.iter().filter(|test| !test.is_suspicious()).count();
                }
            }
            let what = format!("{shape}, {both}: {alarms} alarms, {missed} missed of {known}");
            assert!(alarms < 2 && known > 150 && 20 * missed < known, "{what}");
        }
    }
}
