//! Claim: the error of a photon map's fluence estimate, in slabs and in spheres, is what theory predicts before the run.
//! Referee: exact fields, the exact mean of a kernel over a truncated ball, and the exact expectation of the k
//! nearest rule for independent points. Shown beside it: the path tracer, the wrong estimators, the clustering of
//! photons of one history.
//!
//! Two kinds of field. *Uncollided* photons under a normal beam are independent, and their field e^-t is known in
//! closed form: the place where the orders in radius, photons and k are tested. *All orders* of scattering, at several
//! albedos and asymmetries, are tested against the exact slab, and in spheres that emit or are lit from all sides, whose
//! surface is curved and whose light bends in all directions, against the exact sphere.

mod cases;
mod claims;
mod conclude;
mod fields;
mod figures;
mod measure;
mod predict;
mod results;
mod tables;

use crate::harness::Experiment;

/// The experiment.
pub const EXPERIMENT: Experiment = Experiment {
    name: "bias",
    title: "How wrong is a photon map in fog?",
    question: "A photon map smooths the light over the ball that its photons come from. By how much does that make \
               its fluence wrong, at each number of photons, gather size and depth, and is the error the one that \
               theory predicts before the run?",
    groups: measure::groups,
    predict: predict::predict,
    conclude: conclude::conclude,
};
