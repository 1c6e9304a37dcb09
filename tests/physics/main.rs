//! Every test of the simulator's physics, in one program: it compiles what they share once, and keeps all cores busy.
#![allow(clippy::unwrap_used, reason = "tests")]

#[path = "../checks/mod.rs"]
mod checks;
#[path = "../common/mod.rs"]
mod common;
#[path = "../support/mod.rs"]
mod support;

#[path = "../against_exact/mod.rs"]
mod against_exact;
#[path = "../geometry/mod.rs"]
mod geometry;
#[path = "../laws/mod.rs"]
mod laws;
#[path = "../photons/mod.rs"]
mod photons;
#[path = "../transport/mod.rs"]
mod transport;
