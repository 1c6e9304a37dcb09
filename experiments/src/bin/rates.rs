//! Runs the experiment `rates` alone.

use std::process::ExitCode;

fn main() -> ExitCode {
    turbid_experiments::harness::main("rates", &[turbid_experiments::rates::EXPERIMENT])
}
