//! Runs the experiment `progressive` alone.

use std::process::ExitCode;

fn main() -> ExitCode {
    turbid_experiments::harness::main("progressive", &[turbid_experiments::progressive::EXPERIMENT])
}
