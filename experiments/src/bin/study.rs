//! Runs all experiments and writes one report.

use std::process::ExitCode;

fn main() -> ExitCode {
    turbid_experiments::harness::main("study", turbid_experiments::ALL)
}
