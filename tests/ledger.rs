//! The ledger of the photon mapper: each class of light is the path tracer's, and they add up to the whole.
#![allow(clippy::unwrap_used, reason = "tests")]

#[path = "checks/mod.rs"]
mod checks;
mod support;

use checks::ledger::{
    Room, a_clear_room_keeps_its_ledger, a_foggy_room_keeps_its_ledger,
    a_foggy_room_keeps_its_ledger_when_gathered, layers_are_those_of_paths, mirror, settings,
    what_is_absent_is_not_asked,
};
use support::scenes::lambertian;
use turbid::Spectrum;
use turbid::integrators::mapper::Settings;
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
        has_glass: false,
    };
    layers_are_those_of_paths(&room, Indirect::Seen, &settings(1), 4000, 3);
    layers_are_those_of_paths(&room, Indirect::Gathered, &settings(4), 4000, 4);
}

/// Light through a ball of glass, which focuses it on the floor; seen through the ball too.
#[test]
fn with_glass() {
    let room = Room {
        floor: lambertian(Spectrum::grey(0.6)),
        sigma_t: Spectrum::grey(0.3),
        albedo: Spectrum::grey(0.8),
        g: 0.0,
        is_colored: false,
        has_glass: true,
    };
    layers_are_those_of_paths(&room, Indirect::Seen, &settings(1), 8000, 6);
    layers_are_those_of_paths(&room, Indirect::Gathered, &settings(4), 8000, 7);
}

#[test]
fn absent_maps() {
    what_is_absent_is_not_asked();
}

/// Short rays of the gathering traced on: the same light by other means, most of it here.
#[test]
fn gathered_twice() {
    let room = Room {
        floor: mirror(),
        sigma_t: Spectrum::grey(0.3),
        albedo: Spectrum::grey(0.8),
        g: 0.0,
        is_colored: true,
        has_glass: false,
    };
    let near = Settings { near: 1.2, ..settings(4) };
    layers_are_those_of_paths(&room, Indirect::Gathered, &near, 4000, 8);
}
