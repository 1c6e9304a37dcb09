//! Claim: a photon map's root mean square error over a slab or a sphere is the predicted one, split into bias and noise,
//! and from a countable number of queries on it costs less than a path tracer of the same error.
//! Referee: exact fluence, kernel means, the k nearest law, Poisson's law with clusters. Shown beside it: paths,
//! guided by photons and not, the price of 10, 3 and 1 per cent, what a fixed choice of k costs.
//!
//! One query is the fluence at a point. Costs are counted in operations: a ray followed by a photon or a path, a
//! shadow ray, a photon put into the tree, a photon gathered, each as one; seconds stand beside them.

mod answers;
mod cases;
mod choose;
mod claims;
mod conclude;
mod data;
mod figures;
mod measure;
mod predict;
mod split;
mod tables;
mod theory;
mod words;

use crate::harness::Experiment;

/// The experiment.
pub const EXPERIMENT: Experiment = Experiment {
    name: "tradeoff",
    title: "What does the speed of a photon map cost in accuracy?",
    question: "A photon map is paid for once and then asked often; a path tracer is paid for at every query. How many \
               photons, and which gather, reach 10, 3 and 1 per cent, at what cost, and from how many queries on is \
               the map the cheaper of the two?",
    groups: measure::groups,
    predict: predict::predict,
    conclude: conclude::conclude,
};
