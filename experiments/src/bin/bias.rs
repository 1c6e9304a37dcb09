//! Runs the experiment `bias` alone.

use std::process::ExitCode;

fn main() -> ExitCode {
    turbid_experiments::harness::main("bias", &[turbid_experiments::bias::EXPERIMENT])
}
