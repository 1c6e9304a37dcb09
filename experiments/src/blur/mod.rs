//! Claim: the edge of a shaft of light is as wide in a photon map as theory predicts before the run, and wider by more
//! than half with the k nearest photons than in the fixed radius that holds as many of them.
//! Referee: the exact edge of every kernel in a decaying shaft, at a fixed radius and over the law of the k-th photon;
//! the exact transfer of a sinusoid. Shown beside it: kernels at equal radius and at equal standard deviation, the wrong
//! law of one rule taken for the other, and the width of one map's noisy profile.
//!
//! Photons are uncollided, one a history at most, and so independent. Profiles are estimates over the exact fluence
//! inside the shaft at that depth.

mod cases;
mod claims;
mod conclude;
mod figures;
mod measure;
mod predict;
mod profile;
mod results;
mod shaft;
mod tables;
mod waves;

use crate::harness::Experiment;

/// The experiment.
pub const EXPERIMENT: Experiment = Experiment {
    name: "blur",
    title: "How wide does the edge of a shaft of light become?",
    question: "The edge of a shaft of light is sharp; its image in a photon map is not, since every estimate gathers \
               over a ball. How wide is the image at each radius, kernel, k and number of photons, what is left of a \
               fine pattern, and how many photons does a given sharpness cost?",
    groups: measure::groups,
    predict: predict::predict,
    conclude: conclude::conclude,
};
