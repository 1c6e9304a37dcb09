//! `exact`: the referee's answers on the command line, each with its bound and how it is known.

use std::process::ExitCode;

fn main() -> ExitCode {
    turbid_exact::program::main()
}
