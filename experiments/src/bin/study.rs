//! Runs all experiments, or a study of the user's own, and writes one report.

use std::process::ExitCode;

fn main() -> ExitCode {
    use turbid_experiments::{ALL, CLOSINGS, harness, own_study};
    harness::main_with("study", ALL, CLOSINGS, Some(own_study::ASKED))
}
