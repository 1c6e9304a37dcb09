//! Runs the experiment `transmittance` alone.

use std::process::ExitCode;

fn main() -> ExitCode {
    turbid_experiments::harness::main("transmittance", &[turbid_experiments::transmittance::EXPERIMENT])
}
