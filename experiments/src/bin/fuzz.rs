//! Tries inputs by chance.

use std::process::ExitCode;

fn main() -> ExitCode {
    turbid_experiments::fuzz::main()
}
