//! `turbid man`: the help as manual pages.

use super::shared::print;
use anyhow::Context;
use clap_mangen::Man as Page;
use std::path::PathBuf;
use turbid::output::{one_line, write_atomically};

/// Write the manual pages, one of the program and one of each command.
///
/// Read one by `man -l DIR/turbid-measure.1`.
#[derive(clap::Args)]
pub struct Man {
    /// The folder to write them to; it is made if it is not there.
    #[arg(value_name = "DIR")]
    folder: PathBuf,
}

impl Man {
    /// Writes the pages.
    pub fn run(self, mut program: clap::Command) -> anyhow::Result<()> {
        let shown = one_line(&self.folder.display().to_string());
        std::fs::create_dir_all(&self.folder).with_context(|| format!("cannot make the folder {shown}"))?;
        // Options of the program become those of every command.
        program.build();
        let commands = program.get_subcommands().filter(|command| command.get_name() != "help");
        let pages: Vec<&clap::Command> = std::iter::once(&program).chain(commands).collect();
        for command in &pages {
            let mut text = Vec::new();
            Page::new((*command).clone()).render(&mut text)?;
            // Of a command `turbid-measure`.
            let name = command.get_display_name().unwrap_or(command.get_name());
            write_atomically(self.folder.join(format!("{name}.1")), |out| out.write_all(&text))?;
        }
        print(&format!("written        {} pages in {shown}\n", pages.len()))
    }
}
