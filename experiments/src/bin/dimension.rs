//! Runs the experiment `dimension` alone.

use std::process::ExitCode;

fn main() -> ExitCode {
    turbid_experiments::harness::main("dimension", &[turbid_experiments::dimension::EXPERIMENT])
}
