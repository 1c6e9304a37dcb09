//! Runs the experiment `tradeoff` alone.

use std::process::ExitCode;

fn main() -> ExitCode {
    turbid_experiments::harness::main("tradeoff", &[turbid_experiments::tradeoff::EXPERIMENT])
}
