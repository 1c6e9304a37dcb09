//! Claim: a telescoping sum over ever smaller radii takes the blur of a kernel estimate away, and pays more for it than it is worth.
//! Points at a place, points along a ray and beams along a ray, whose variance grows as the radius to the power -c, c = 3, 2, 1:
//! stopped at a level, the sum has (1 + s)/(1 - s) times the variance of the plain estimate at its last radius, s = 2^(-c/2); drawn at
//! random without end, no schedule has finite variance in finite work.
//! Referee: exact kernel means and the exact law of the counts of independent photons in an exponential field.
//!
//! Only where differences fall faster than their work grows, as of marches through a varying density, does such a sum pay: the experiment
//! `transmittance` measures that.

mod cases;
mod conclude;
mod figures;
mod measure;
pub(crate) mod predict;
mod results;

use crate::harness::Experiment;

/// The experiment.
pub const EXPERIMENT: Experiment = Experiment {
    name: "debiasing",
    title: "Does a telescoping sum make a kernel estimate unbiased at a price worth paying?",
    question: "The blur of a photon estimate can be taken away in the mean: by the differences between the estimates of one radius \
               and the next smaller one, drawn at random and divided by their chance. At equal numbers of photons, is what it says \
               nearer to the truth than the plain estimate at its best radius?",
    groups: measure::groups,
    predict: predict::predict,
    conclude: conclude::conclude,
};
