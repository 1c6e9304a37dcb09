//! A study of any scene, asked by a file: what a map costs in accuracy there, and which settings reach a target the cheapest.
//!
//! Referee: an exact solution where the scene is a solved problem (`solved`), else paths or light tracing to a stated error, whose
//! batches are the rival in time as well. The maps of a replicate are filled once and read by all estimators. What is exact and
//! of one slab or ball predicts the bias of fixed radii.

mod asked;
mod conclude;
mod data;
mod dry_run;
mod figures;
mod file;
mod measure;
mod picture;
mod place;
mod points;
mod predict;
mod reference;
mod solved;
mod tables;
mod words;

use crate::harness::{Asked, Experiment, Settings};
use anyhow::Context;

/// The experiment.
pub const EXPERIMENT: Experiment = Experiment {
    name: words::NAME,
    title: "What does a photon map cost here?",
    question: "What error do photon maps make in this scene, by how many photons and by which estimator, and which settings reach \
               the target at the least cost?",
    groups: measure::groups,
    predict: predict::predict,
    conclude: conclude::conclude,
};

/// What files of the user's are put to.
pub const ASKED: Asked = Asked { experiment: EXPERIMENT, check, dry_run: dry_run::dry_run };

/// Refuses a file that cannot be studied, before anything is measured.
///
/// # Errors
/// File, key and what is allowed
fn check(settings: &Settings) -> anyhow::Result<()> {
    let study = asked::asked(settings)?;
    let file = || settings.question_file.as_ref().map(|file| file.display().to_string()).unwrap_or_default();
    measure::try_estimators(&study, settings).with_context(file)
}
