//! What an experiment is made of.

use super::{Cells, Group, Section, Settings};
use crate::prediction::Prediction;

/// One experiment: a claim or a few, what they predict, how it is measured and what follows.
///
/// The three functions are pure: everything they return is a function of their arguments.
#[derive(Debug, Clone, Copy)]
pub struct Experiment {
    /// File-safe name, that of the module.
    pub name: &'static str,
    /// Heading of its section.
    pub title: &'static str,
    /// What is asked, one or two sentences.
    pub question: &'static str,
    /// The maps to be measured, and how.
    pub groups: fn(&Settings) -> Vec<Group>,
    /// What theory says, computed before anything is measured.
    pub predict: fn(&Settings) -> anyhow::Result<Vec<Prediction>>,
    /// What all maps together say.
    pub conclude: fn(&Settings, &[Prediction], &Cells) -> anyhow::Result<Section>,
}
