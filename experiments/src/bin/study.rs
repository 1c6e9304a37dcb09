//! Runs all experiments and writes one report.

use std::process::ExitCode;

fn main() -> ExitCode {
    use turbid_experiments::{ALL, CLOSINGS, harness};
    harness::main_with("study", ALL, CLOSINGS)
}
