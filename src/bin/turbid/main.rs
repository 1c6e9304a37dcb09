//! The command `turbid`: parses, calls the file of the command, reports errors in one line.

mod advice_row;
mod advise;
mod advise_picture;
mod beside;
mod check;
mod command;
mod compare;
mod completions;
mod digest;
mod export;
mod given;
mod import;
mod learn;
mod load;
mod made;
mod man;
mod map;
mod measure;
mod memory;
mod notes;
mod options;
mod picture;
mod progress;
mod progressive;
mod provenance;
mod quiet;
mod reading_notes;
mod render;
mod revision;
mod scenes;
mod shared;
mod state;
mod statistics;
mod usage;

use clap::{ArgMatches, CommandFactory, FromArgMatches, Parser};
use std::process::ExitCode;
use turbid::output::{end_on_signal, without_panic};

/// Where to begin.
const EXAMPLES: &str = "\
To begin with, no file is needed:
  turbid render fogbox -o fog.exr --gather-rays 0       a picture by photons, and fog.png to look at
  turbid render fogbox -o paths.exr --with paths        the same by the unbiased path tracer
  turbid map fogbox -o photons.png --ply photons.ply    the photons themselves
  turbid measure slab --with photons                    numbers with standard errors
  turbid scenes                                         what else is built in";

/// How wrong is a photon map in fog? Photons and paths in scattering media, each number with its standard error.
///
/// Lengths are in scene units (L), powers in watts. Figures use the DejaVu fonts (Bitstream Vera licence).
#[derive(Parser)]
#[command(name = "turbid", version = revision::version(), arg_required_else_help = true, after_help = EXAMPLES)]
struct Arguments {
    /// Tell neither notes nor progress on standard error; errors still.
    #[arg(long, global = true)]
    quiet: bool,
    #[command(subcommand)]
    command: command::Command,
}

/// The command line, and what of it was given and is no default.
fn parse() -> Result<(Arguments, ArgMatches), clap::Error> {
    let mut command = Arguments::command();
    let given = command.try_get_matches_from_mut(std::env::args_os())?;
    let arguments = Arguments::from_arg_matches(&given).map_err(|error| error.format(&mut command))?;
    Ok((arguments, given))
}

fn main() -> ExitCode {
    end_on_signal(|| "turbid: stopped by a signal; files appear whole or not at all".to_string());
    without_panic("turbid", || {
        let outcome = match parse() {
            Ok((arguments, given)) => {
                if arguments.quiet {
                    quiet::be_quiet();
                }
                arguments.command.run(&given, Arguments::command())
            }
            Err(error) => usage::explain(&error),
        };
        command::exit_code("turbid", outcome)
    })
}
