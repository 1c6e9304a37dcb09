//! Runs the experiment `extremes` alone.

use std::process::ExitCode;

fn main() -> ExitCode {
    turbid_experiments::harness::main("extremes", &[turbid_experiments::extremes::EXPERIMENT])
}
