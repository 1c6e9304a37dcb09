//! The closing section: do the predicted terms, over every case of the study, add up to the measured errors?
//!
//! Cases that share maps are not independent, so four tests are made. *One case a map set*: each group of maps is cut
//! into sets of up to 32 consecutive maps, which are independent of each other; one case is drawn for each, and the
//! distances of their means from their predictions must follow Student's t (Kolmogorov and Smirnov). *The sum of all*, and *the groups*:
//! the cases of a group are summed map by map; in all groups alike, and in groups that are off to either side (chi squared),
//! nothing may be left over. *The largest
//! distance of all*: with all maps of a case, against what it would be if nothing were left over, by resampling whole
//! maps, so that cases that share maps keep doing so. The first or the last must fail when a term is taken out of the
//! predictions; for this the first draws among the cases that carry the term.

mod common;
mod conclude;
mod figures;
mod largest;
mod sets;

use crate::harness::Closing;

/// The closing section.
pub const CLOSING: Closing = Closing {
    name: "budget",
    title: "Do the predicted errors add up?",
    question: "Every error of this study was predicted as a sum of terms: the rule that sets the radius, clusters of \
               photons, blur, edges, steps of a march, storage. Over all cases of all experiments, is anything left \
               between the sum and the measurement, and is each term needed?",
    conclude: conclude::conclude,
};
