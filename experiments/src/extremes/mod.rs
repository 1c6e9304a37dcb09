//! Claim: at the ends of every range the numbers stay finite and right, and single precision in the photon tree costs
//! nothing that could be seen at the extents of the other experiments.
//! Referee: exact slabs, half-spaces and furnaces, sums in double precision, the same problem posed in another unit;
//! for storage, a search in double precision over exactly the photons of the tree, and the mean of a kernel over the
//! lattice of stored positions. Shown beside it: where single precision does begin to matter, and by how much.
//!
//! Four kinds of question. *Sampled* rows compare a mean over independent batches with an exact value. *Checked* rows
//! are computed once and compared with an exact value within a derived bound, bit for bit where the unit of length is
//! multiplied by a power of two. *Storage* asks one set of photons twice, in single and in double precision. *Lattice*
//! stretches a map until its stored positions are as far apart as its gathers are wide.

mod cases;
mod checks;
mod claims;
mod conclude;
mod figures;
mod half_space;
mod lattice;
mod measure;
mod nearest_checks;
mod plain;
mod predict;
mod results;
mod sampled;
mod scenes;
mod storage;
mod stretched;
mod tables;

use crate::harness::Experiment;

/// The experiment.
pub const EXPERIMENT: Experiment = Experiment {
    name: "extremes",
    title: "Does it stay right at the extremes?",
    question: "Do the path tracer and the photon map stay finite and right where media are thinnest, thickest, \
               blackest, whitest and most peaked, where lengths are tiny, huge or far from the origin, where photons \
               are few, many or all in one place? And does single precision in the photon tree matter?",
    groups: measure::groups,
    predict: predict::predict,
    conclude: conclude::conclude,
};
