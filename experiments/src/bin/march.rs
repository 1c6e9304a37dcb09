//! Runs the experiment `march` alone.

use std::process::ExitCode;

fn main() -> ExitCode {
    turbid_experiments::harness::main("march", &[turbid_experiments::march::EXPERIMENT])
}
