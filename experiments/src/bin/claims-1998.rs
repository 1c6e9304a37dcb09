//! Runs the experiment `claims-1998` alone.

use std::process::ExitCode;

fn main() -> ExitCode {
    turbid_experiments::harness::main("claims-1998", &[turbid_experiments::claims_1998::EXPERIMENT])
}
