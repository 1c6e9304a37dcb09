//! Runs the experiment `coverage` alone.

use std::process::ExitCode;

fn main() -> ExitCode {
    turbid_experiments::harness::main("coverage", &[turbid_experiments::coverage::EXPERIMENT])
}
