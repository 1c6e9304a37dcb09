//! The experiment `progressive`, whole, on few photons.

use crate::run;

/// A quarter of the photons is the least that it takes: with fewer, radii would leave the slab.
#[test]
fn few_photons_contradict_nothing() {
    run::finds_no_contradiction(env!("CARGO_BIN_EXE_progressive"), "0.25");
}
