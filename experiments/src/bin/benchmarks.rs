//! Runs the published benchmarks and writes their page.

use std::process::ExitCode;

fn main() -> ExitCode {
    turbid_experiments::benchmarks::main()
}
