//! What an experiment is made of.

use super::{CellOutput, Cells, Digest, Section, Settings, Unit};

/// One experiment: a claim or a few, what they predict, how it is measured and what follows.
///
/// The four functions are pure: everything they return is a function of their arguments.
#[derive(Debug, Clone, Copy)]
pub struct Experiment {
    /// File-safe name, that of the module.
    pub name: &'static str,
    /// Heading of its section.
    pub title: &'static str,
    /// What is asked, one or two sentences.
    pub question: &'static str,
    /// The maps to be measured.
    pub cells: fn(&Settings) -> Vec<CellId>,
    /// What theory says, computed before anything is measured.
    pub predict: fn(&Settings) -> anyhow::Result<Vec<Prediction>>,
    /// Measures one map.
    pub measure: fn(&Settings, &CellId) -> anyhow::Result<CellOutput>,
    /// What all maps together say.
    pub conclude: fn(&Settings, &[Prediction], &Cells) -> anyhow::Result<Section>,
}

/// One cell: a map, or a batch of paths, that is a pure function of settings, group and replicate.
#[derive(Debug, Clone, PartialEq)]
pub struct CellId {
    /// What is simulated: maps of one group differ in their random numbers only.
    pub group: String,
    /// Number of the independent repetition, from 0; it goes into the random streams.
    pub replicate: u64,
    /// Work, in any unit that all cells of the study share, such as photons: for order and remaining time.
    pub cost: f64,
    /// Photons that it holds at one time, at least; 0 where their number does not follow the settings.
    pub held: u64,
}

impl CellId {
    /// A cell of `group` (lower case letters, digits, `.`, `_` and `-`).
    pub fn new(group: impl Into<String>, replicate: u64, cost: f64) -> Self {
        CellId { group: group.into(), replicate, cost, held: 0 }
    }

    /// The same, of a map of at least so many photons.
    #[must_use]
    pub fn holding(self, photons: u64) -> Self {
        CellId { held: photons, ..self }
    }

    /// All `maps` cells of a group.
    pub fn replicates(group: &str, maps: u64, cost: f64) -> impl Iterator<Item = CellId> + use<> {
        let group = group.to_string();
        (0..maps).map(move |replicate| CellId::new(group.as_str(), replicate, cost))
    }

    /// The unique file-safe name; names sort as replicates do.
    pub fn id(&self) -> String {
        format!("{}-{:06}", self.group, self.replicate)
    }

    /// The number that random streams take as their replicate: different for every experiment and group, so that
    /// cells of different groups share no histories.
    pub fn stream(&self, experiment: &str) -> u64 {
        let name = Digest::of(format!("{experiment}/{}", self.group).as_bytes());
        name.word() << 24 | self.replicate
    }

    /// Whether the group can be part of a file's name.
    pub(super) fn is_file_safe(&self) -> bool {
        let allowed = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || "._-".contains(c);
        !self.group.is_empty()
            && self.group.len() <= 100
            && !self.group.starts_with('.')
            && self.group.chars().all(allowed)
    }
}

/// A value computed before the measurement.
#[derive(Debug, Clone, PartialEq)]
pub struct Prediction {
    /// Which case, as in the cells' rows.
    pub case: String,
    /// Which quantity, as in the cells' rows.
    pub quantity: String,
    /// Its unit.
    pub unit: Unit,
    /// The predicted value.
    pub value: f64,
    /// Bound on its numerical error.
    pub error: f64,
    /// Where it comes from: the equation or the literature, in a few words.
    pub source: String,
}
