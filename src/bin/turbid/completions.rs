//! `turbid completions`: what shells complete.

use anyhow::Context;
use clap_complete::Shell;
use turbid::output::print;

/// Print what a shell needs to complete commands, options and their values.
///
/// For bash: `turbid completions bash > ~/.local/share/bash-completion/completions/turbid`.
#[derive(clap::Args)]
pub struct Completions {
    /// The shell.
    #[arg(value_enum)]
    shell: Shell,
}

impl Completions {
    /// Prints the script.
    pub fn run(self, mut program: clap::Command) -> anyhow::Result<()> {
        let mut script = Vec::new();
        clap_complete::generate(self.shell, &mut program, "turbid", &mut script);
        print(|out| out.write_all(&script)).context("standard output")
    }
}
