//! Runs the experiment `blur` alone.

use std::process::ExitCode;

fn main() -> ExitCode {
    turbid_experiments::harness::main("blur", &[turbid_experiments::blur::EXPERIMENT])
}
