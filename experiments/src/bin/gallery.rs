//! Renders the gallery and writes its page.

use std::process::ExitCode;

fn main() -> ExitCode {
    turbid_experiments::gallery::main()
}
