//! Runs the experiment `debiasing` alone.

use std::process::ExitCode;

fn main() -> ExitCode {
    turbid_experiments::harness::main("debiasing", &[turbid_experiments::debiasing::EXPERIMENT])
}
