//! Scenes by chance: draws valid scenes and asks whether every method gives them the same light.

use std::process::ExitCode;

fn main() -> ExitCode {
    turbid_experiments::sweep::main()
}
