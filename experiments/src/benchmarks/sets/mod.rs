//! The sets: one file each.

mod disort;
mod duct;
mod emitting_cube;
mod garcia_siewert;
mod i3rc;
mod kobayashi;
mod markov;
mod mcml;
mod prahl;
mod reed;
mod van_de_hulst;

use super::set::Set;

/// All sets, in the order of the page.
pub const ALL: &[&Set] = &[
    &van_de_hulst::SET,
    &garcia_siewert::MIE,
    &garcia_siewert::HAZE,
    &garcia_siewert::LAYERS,
    &disort::SET,
    &reed::SET,
    &prahl::SET,
    &i3rc::SET,
    &mcml::SET,
    &duct::SET,
    &emitting_cube::SET,
    &markov::SET,
    &kobayashi::ONE,
    &kobayashi::TWO,
    &kobayashi::THREE,
];
