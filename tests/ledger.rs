//! The ledger of the photon mapper: each class of light is the path tracer's, and they add up to the whole.
#![allow(clippy::unwrap_used, reason = "tests")]

#[path = "checks/mod.rs"]
mod checks;
mod support;

use checks::ledger::{
    Room, a_clear_room_keeps_its_ledger, a_foggy_room_keeps_its_ledger,
    a_foggy_room_keeps_its_ledger_when_gathered, layers_are_those_of_paths, mirror,
};
use turbid::Spectrum;
use turbid::photons::maps::Indirect;

#[test]
fn seen() {
    a_foggy_room_keeps_its_ledger();
}

#[test]
fn gathered() {
    a_foggy_room_keeps_its_ledger_when_gathered();
}

#[test]
fn in_clear_air() {
    a_clear_room_keeps_its_ledger();
}

#[test]
fn in_color_and_forward() {
    let room = Room {
        floor: mirror(),
        sigma_t: Spectrum::rgb(0.3, 0.6, 0.9),
        albedo: Spectrum::rgb(0.9, 0.7, 0.5),
        g: 0.6,
        is_colored: true,
    };
    layers_are_those_of_paths(&room, Indirect::Seen, 1, 4000, 3);
    layers_are_those_of_paths(&room, Indirect::Gathered, 4, 4000, 4);
}
