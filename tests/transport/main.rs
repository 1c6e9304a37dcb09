//! Walks of light: bits that stay, invariants, extremes, and classes of paths by every method.
#![allow(clippy::unwrap_used, reason = "tests")]

#[path = "../checks/mod.rs"]
mod checks;
#[path = "../support/mod.rs"]
mod support;

mod ends;
mod extremes;
mod golden;
mod invariants;
mod ledger;
mod light_tracing;
mod path_classes;
mod plan;
