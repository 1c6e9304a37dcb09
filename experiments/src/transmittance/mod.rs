//! Claim: estimators of what passes through a varying medium have the mean, variance and look-ups that theory predicts before
//! the run, and unbiased ray marching has less variance at equal look-ups than ratio tracking.
//! Referee: the optical depth by quadrature on the pieces of the density, and the second moments of each estimator.
//! Shown beside it: marches, which are bright, and what takes their bias away.
//!
//! Delta tracking, ratio tracking with controls, among them the renderer's own, power series, marches, their jackknife and
//! their telescoping sum, on rays through ramps, steps, peaks, waves, fog, noise and clouds.

mod cases;
mod claims;
mod conclude;
mod estimators;
mod expected;
mod figures;
mod line;
mod measure;
mod predict;
mod rays;
mod results;
mod series;
#[cfg(test)]
mod tests;

use crate::harness::Experiment;

/// The experiment.
pub const EXPERIMENT: Experiment = Experiment {
    name: "transmittance",
    title: "What passes through a varying medium, at what price?",
    question: "The light that passes through a medium whose density varies has no closed form, and is estimated from densities looked \
               up along a ray: by tracking, by series, by marches. What do these estimators say in the mean, how much do they \
               vary, and what does it take them?",
    groups: measure::groups,
    predict: predict::predict,
    conclude: conclude::conclude,
};
