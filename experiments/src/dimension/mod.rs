//! Claim: the mean squared error at the best radius falls with the photons as N^(-4/(c + 4)), c = 3 - dim(stored) - dim(query):
//! photons stored as points or as beams (0, 1), asked by a place or by a ray (0, 1).
//! Referee: exact kernel means and exact variances of independent photons in an exponential field. Shown beside it: a ray that is marched
//! in balls, which is asked by places and yet has the c of a ray.
//!
//! The kernel's own dimension sets the blur alone: what is stored and what asks set how the variance falls with the radius.
//!
//! Against time: `media`, which asks for light scattered twice and more in four media, of planes and debiased sums too.

mod cases;
mod conclude;
mod figures;
mod measure;
mod media;
mod predict;
mod results;

use crate::harness::{Experiment, Group, Settings};
use crate::prediction::Prediction;

/// The experiment.
pub const EXPERIMENT: Experiment = Experiment {
    name: "dimension",
    title: "What do rays and beams gain over points?",
    question: "Photons can be stored as points or as beams, and asked by a place or along a whole ray. By how much does the error then \
               fall with the number of photons, at the best radius for each, and which is ahead at equal photons and at equal \
               time: in a field that is known by heart, and in thin, thick, peaked and bounded media, beside planes and debiased sums?",
    groups,
    predict,
    conclude: conclude::conclude,
};

fn groups(settings: &Settings) -> Vec<Group> {
    let mut groups = measure::groups(settings);
    groups.extend(media::groups(settings));
    groups
}

fn predict(settings: &Settings) -> anyhow::Result<Vec<Prediction>> {
    let mut predictions = predict::predict(settings)?;
    predictions.extend(media::predict(settings));
    Ok(predictions)
}
