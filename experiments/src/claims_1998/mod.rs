//! Claim: what the talk of 1998 says of volume photon maps in whole sentences holds in numbers.
//! Referee: the path tracer for pixels of a box of fog, for errors and for what paths cost; the exact slab for the edge of
//! a medium and for light that leaks through a thin wall. Shown beside it: what a gather takes amid 36 and a million
//! triangles, what multiple scattering in a cloud takes, and what importance brings.
//!
//! Jensen and Christensen (1998), "Efficient simulation of light transport in scenes with participating media using photon
//! maps", as told in the talk's slides.

mod clouds;
mod conclude;
mod edge;
mod equal_error;
mod fogbox;
mod importance;
mod maps;
mod part;
mod pixels;
mod times;
mod walls;

use crate::harness::{Experiment, Group, Settings};
use crate::prediction::Prediction;

/// The experiment.
pub const EXPERIMENT: Experiment = Experiment {
    name: "claims-1998",
    title: "Do the sentences of 1998 hold?",
    question: "The talk that introduced photon maps for fog says that 50 to 100 photons an estimate work well, that photon \
               maps are faster than Monte Carlo, that the estimate is too low at the edge of a medium, that looking at \
               the incoming direction avoids false photons, that maps are decoupled from geometry, that multiple \
               scattering in clouds costs 100 to 61 of single scattering, and names importance as an improvement. By how \
               much?",
    groups,
    predict,
    conclude: conclude::conclude,
};

fn groups(settings: &Settings) -> Vec<Group> {
    vec![
        pixels::group(settings),
        edge::group(settings),
        walls::group(settings),
        equal_error::group(settings),
        clouds::group(settings),
        importance::group(settings),
    ]
}

fn predict(settings: &Settings) -> anyhow::Result<Vec<Prediction>> {
    let mut predictions = pixels::predict(settings)?;
    predictions.extend(edge::predict(settings)?);
    Ok(predictions)
}
