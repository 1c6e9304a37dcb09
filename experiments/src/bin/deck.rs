//! Runs the experiment `deck` alone.

use std::process::ExitCode;

fn main() -> ExitCode {
    turbid_experiments::harness::main("deck", &[turbid_experiments::deck::EXPERIMENT])
}
