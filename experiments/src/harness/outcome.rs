//! What a study leaves: sections with their verdicts.

use super::progress::duration;
use super::{Experiment, Judged, Section, Verdict};
use crate::prediction::Prediction;
use std::path::PathBuf;

/// One experiment with all that it found.
#[derive(Debug, Clone)]
pub struct SectionReport {
    /// The experiment.
    pub experiment: Experiment,
    /// What was predicted.
    pub predictions: Vec<Prediction>,
    /// What it says; its claims have moved to `judged`.
    pub section: Section,
    /// Its claims, judged with all others.
    pub judged: Vec<Judged>,
    /// Counters summed over its cells.
    pub counters: Vec<(String, u64)>,
    /// Number of cells and their CPU seconds.
    pub cells: (usize, f64),
    /// Why it has no conclusion, if so.
    pub failure: Option<String>,
}

/// What a finished study leaves.
#[derive(Debug)]
pub struct Outcome {
    /// The report's file.
    pub report: PathBuf,
    /// All sections.
    pub sections: Vec<SectionReport>,
    /// How many cells were measured in this run.
    pub measured: usize,
}

impl Outcome {
    /// Number of claims with a verdict.
    pub fn count(&self, verdict: Verdict) -> usize {
        self.sections.iter().flat_map(|s| &s.judged).filter(|j| j.verdict == verdict).count()
    }

    /// Exit code of `--strict`: 1 after a rejected claim, else 3 after an undecided one or an experiment without a conclusion,
    /// else 0.
    pub fn strict_code(&self) -> u8 {
        let without = self.sections.iter().filter(|s| s.failure.is_some()).count();
        match (self.count(Verdict::Rejected), self.count(Verdict::Undecided) + without) {
            (0, 0) => 0,
            (0, _) => 3,
            _ => 1,
        }
    }
}

/// Seconds for the summary's last line.
pub(crate) fn cost_line(sections: &[SectionReport]) -> String {
    let cells: usize = sections.iter().map(|s| s.cells.0).sum();
    let seconds: f64 = sections.iter().map(|s| s.cells.1).sum();
    format!("{cells} cells, {} of CPU time", duration(seconds))
}
