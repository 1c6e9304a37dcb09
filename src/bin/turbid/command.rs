//! The commands, one file each, and their exit code.

use crate::{advise, check, completions, export, import, man, map, measure, render, scenes};
use clap::{ArgMatches, Subcommand};
use std::io::{ErrorKind, Write};
use std::process::ExitCode;
use turbid::output::{WriteError, one_line};

/// What can be asked. The help of each is what its own file says: a word here would replace all of it.
#[derive(Subcommand)]
#[allow(missing_docs, reason = "a comment on a variant would hide the long help of its command")]
pub enum Command {
    Measure(Box<measure::Measure>),
    Advise(Box<advise::Advise>),
    Render(Box<render::Render>),
    Map(Box<map::Map>),
    Check(check::Check),
    Scenes(scenes::Scenes),
    Completions(completions::Completions),
    Man(man::Man),
    Export(export::Export),
    Import(import::Import),
}

impl Command {
    /// Answers; what it prints goes to stdout.
    ///
    /// # Arguments
    /// `given` what was parsed, which knows the defaults; `program` all that may be asked
    pub fn run(self, given: &ArgMatches, program: clap::Command) -> anyhow::Result<()> {
        let given = given.subcommand().map_or(given, |(_, given)| given);
        match self {
            Command::Measure(command) => command.run(given),
            Command::Advise(command) => command.run(given),
            Command::Render(command) => command.run(given),
            Command::Map(command) => command.run(given),
            Command::Check(command) => command.run(),
            Command::Scenes(command) => command.run(),
            Command::Completions(command) => command.run(program),
            Command::Man(command) => command.run(program),
            Command::Export(command) => command.run(),
            Command::Import(command) => command.run(),
        }
    }
}

/// Exit code of an outcome: 2 for an error, told in one line on stderr; a reader that closed the pipe is no error.
pub fn exit_code(program: &str, outcome: anyhow::Result<()>) -> ExitCode {
    let Err(error) = outcome else { return ExitCode::SUCCESS };
    let is_closed_pipe = error.chain().any(|cause| {
        let file = cause.downcast_ref::<WriteError>().map(|error| &error.cause);
        file.or(cause.downcast_ref()).is_some_and(|error| error.kind() == ErrorKind::BrokenPipe)
    });
    if is_closed_pipe {
        return ExitCode::SUCCESS;
    }
    // If even stderr is closed there is nobody left to tell.
    let _ = writeln!(std::io::stderr().lock(), "{program}: error: {}", one_line(&format!("{error:#}")));
    ExitCode::from(2)
}
