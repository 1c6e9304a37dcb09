//! The cases: which selector, which question, how many photons.

use super::fields::Field;
use crate::harness::Settings;

/// The largest radius of all selectors [mfp], at which those that need a first one start.
pub const LARGEST: f64 = 0.8;
/// Cells a group.
pub const CELLS: u64 = 64;
/// The radius of the rule of thumb [mfp].
pub const THUMB: f64 = 0.1;

/// How a radius is chosen.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Selector {
    /// The radius of the least mean squared error in theory.
    Oracle,
    /// From the bend between two radii.
    PlugIn,
    /// The same, from twice what it said last, five times more.
    Iterated,
    /// The largest radius that contradicts no smaller one, halved.
    Interval,
    /// The same, not halved.
    Whole,
    /// The gather of so many nearest photons.
    Nearest(usize),
    /// [`THUMB`].
    Fixed,
}

impl Selector {
    /// All, the oracle first.
    pub const ALL: [Selector; 8] = [
        Selector::Oracle,
        Selector::PlugIn,
        Selector::Iterated,
        Selector::Interval,
        Selector::Whole,
        Selector::Nearest(50),
        Selector::Nearest(100),
        Selector::Fixed,
    ];

    /// Its name in cases.
    pub fn name(self) -> String {
        match self {
            Selector::Oracle => "oracle".into(),
            Selector::PlugIn => "plug-in".into(),
            Selector::Iterated => "iterated".into(),
            Selector::Interval => "interval".into(),
            Selector::Whole => "interval-whole".into(),
            Selector::Nearest(k) => format!("k={k}"),
            Selector::Fixed => format!("r={THUMB}"),
        }
    }

    /// Its title for readers.
    pub fn title(self) -> String {
        match self {
            Selector::Oracle => "best radius".into(),
            Selector::PlugIn => "plug-in".into(),
            Selector::Iterated => "plug-in, iterated".into(),
            Selector::Interval => "interval test".into(),
            Selector::Whole => "interval test, not halved".into(),
            Selector::Nearest(k) => format!("{k} nearest photons"),
            Selector::Fixed => format!("radius {THUMB} mfp"),
        }
    }

    /// Whether its radius does not depend on the photons.
    pub fn is_fixed(self) -> bool {
        matches!(self, Selector::Oracle | Selector::Fixed)
    }
}

/// Numbers of photons of a map, and maps of a cell.
pub fn sizes(settings: &Settings) -> Vec<(u64, u64)> {
    let all: &[(u64, u64)] = settings.pick(
        &[(1_000, 10), (10_000, 4), (100_000, 1)][..],
        &[(1_000, 20), (10_000, 8), (100_000, 2), (1_000_000, 1)],
    );
    // Sizes stay different.
    let scaled = |n: u64, least: u64| ((n as f64 * settings.photon_scale) as u64).max(least);
    all.iter().zip(1..).map(|(&(photons, batch), place)| (scaled(photons, 100 * place), batch)).collect()
}

/// Whether a question is put to maps of so many photons: beams take too long about rays that many pass.
pub fn is_asked(settings: &Settings, field: Field, photons: u64) -> bool {
    field != Field::Beams || photons <= settings.pick(20_000, 200_000)
}

/// The cases: questions and numbers of photons.
pub fn all(settings: &Settings) -> Vec<(Field, u64)> {
    let sizes = sizes(settings);
    let of = |field: Field| sizes.iter().map(move |&(photons, _)| (field, photons));
    let asked = |case: &(Field, u64)| is_asked(settings, case.0, case.1);
    Field::ALL.into_iter().flat_map(of).filter(asked).collect()
}

/// Whether a selector is put to a question: there is no gather of the nearest photons along rays.
pub fn is_put(selector: Selector, field: Field) -> bool {
    field.is_place() || !matches!(selector, Selector::Nearest(_))
}

/// The name of a case in tables.
pub fn name(field: Field, photons: u64, selector: Selector) -> String {
    format!("{} n={photons} {}", field.name(), selector.name())
}

/// Errors that the simulator's own advice is asked for.
pub const TARGETS: [f64; 3] = [0.2, 0.1, 0.05];
/// Photons of a pilot map of the advice.
pub const PILOT: u64 = 1000;
/// Its pilot maps: the fewest that it takes.
pub const MAPS: u64 = 32;

/// The name of the case of an advice.
pub fn advised(field: Field, target: f64) -> String {
    format!("{} advised for {}", field.name(), target)
}
