//! Runs the experiment `boundary` alone.

use std::process::ExitCode;

fn main() -> ExitCode {
    turbid_experiments::harness::main("boundary", &[turbid_experiments::boundary::EXPERIMENT])
}
