//! Who asks by words: they become a question as those of the command line do, and what it solves serves the next.

use crate::answer::Answer;
use crate::command::Command;
use crate::question::{Solved, ask};
use crate::usage;
use anyhow::{Result, anyhow};
use clap::error::ErrorKind;
use clap::{FromArgMatches, Subcommand};

/// Asks one question after the other; what was solved of a medium or a body is not solved again.
pub struct Asker {
    parser: clap::Command,
    solved: Solved,
}

impl Default for Asker {
    fn default() -> Self {
        let parser = Command::augment_subcommands(clap::Command::new("exact"));
        Asker { parser, solved: Solved::default() }
    }
}

impl Asker {
    /// Answers one question of a problem, with bounds that hold for the decimals that stand in the arguments.
    ///
    /// # Arguments
    /// `problem` one of the names of [`problems`](crate::problems), and `arguments` some of its arguments by name, as often
    /// as there are values of them; none for the value of a switch
    ///
    /// # Errors
    /// Those of the command line, in one line, under the name of the argument
    pub fn ask(&mut self, problem: &str, arguments: &[(String, Option<String>)]) -> Result<Answer> {
        let mut words = vec!["exact".to_string(), option(problem)];
        words.extend(arguments.iter().map(|(name, value)| match value {
            Some(value) => format!("--{}={value}", option(name)),
            None => format!("--{}", option(name)),
        }));
        let named = |error: &clap::Error| {
            let is_value = matches!(error.kind(), ErrorKind::ValueValidation | ErrorKind::InvalidValue);
            usage::of_cell(error, |option| is_value.then(|| option.replace('-', "_")), |_| "a whole number")
        };
        let command = self.command(words, named)?;
        self.answer(&command, None)
    }

    /// The question in the words of a command line, whose errors `said` tells.
    pub(crate) fn command(
        &mut self,
        words: Vec<String>,
        said: impl FnOnce(&clap::Error) -> String,
    ) -> Result<Command> {
        let matches = self.parser.try_get_matches_from_mut(words);
        let command = matches.and_then(|matches| Command::from_arg_matches(&matches));
        command.map_err(|error| anyhow!("{}", said(&error)))
    }

    /// Answers all that is asked, or `wanted` alone.
    pub(crate) fn answer(&self, command: &Command, wanted: Option<&'static str>) -> Result<Answer> {
        ask(command.question(), wanted, &self.solved)
    }
}

/// A name as the command line has it.
fn option(name: &str) -> String {
    name.replace('_', "-")
}
