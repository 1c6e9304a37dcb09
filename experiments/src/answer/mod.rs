//! The closing section that opens the report: what does the speed of photon mapping cost, over all scenes?
//!
//! It measures nothing. Experiments that race photon maps against paths give an [`Answer`](crate::harness::Answer) a scene; here they become one
//! figure, one table and three sentences.

mod conclude;

use crate::harness::{ANSWER, Closing};

/// The closing section.
pub const CLOSING: Closing = Closing {
    name: ANSWER,
    title: "What the speed costs",
    question: "To the same error, how much faster than a path tracer is a photon map, what is its bias, and what limits it?",
    conclude: conclude::conclude,
};
