//! The laws: what every phase function, warp, light, shape, flight and roulette obeys, over its whole domain.
#![allow(clippy::unwrap_used, reason = "tests")]

#[path = "../checks/mod.rs"]
mod checks;
#[path = "../common/mod.rs"]
mod common;
#[path = "../support/mod.rs"]
mod support;

mod color;
mod flight;
mod fresnel;
mod lights;
mod media;
mod phase;
mod pictures;
mod projection;
mod roulette;
mod shapes;
mod warps;
