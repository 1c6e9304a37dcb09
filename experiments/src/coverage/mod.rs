//! Claim: the laboratory's 95 per cent intervals cover what they should, 95 ± 1.5 times in a hundred, and its p-values
//! are below 1 per cent once in a hundred.
//! Referee: the exact expectations of estimates from independent photons, which theory knows to many more digits than a
//! small study can detect. Shown beside it: how coverage falls with fewer maps, the normal quantile in the place of
//! Student's, and how often tests on right data raise an alarm.
//!
//! A small study is repeated 2,000 times. Each repeat is a few maps of uncollided photons and makes every interval that
//! the laboratory makes of its own maps, in the same way.

mod conclude;
mod field;
mod figures;
mod intervals;
mod measure;
mod nulls;
mod results;

use crate::harness::Experiment;

/// The experiment.
pub const EXPERIMENT: Experiment = Experiment {
    name: "coverage",
    title: "Can the intervals be trusted?",
    question: "Every verdict rests on intervals over independent maps. When a whole small study is repeated thousands of \
               times, how often do its 95 % intervals contain the exact value, and how often do its tests raise an alarm \
               although nothing is wrong?",
    groups: measure::groups,
    predict: conclude::predict,
    conclude: conclude::conclude,
};
