//! Runs the experiment `selection` alone.

use std::process::ExitCode;

fn main() -> ExitCode {
    turbid_experiments::harness::main("selection", &[turbid_experiments::selection::EXPERIMENT])
}
