//! The command `turbid`: parses, calls one file of `command/`, reports errors in one line.

mod command;

use clap::Parser;
use std::process::ExitCode;

/// How wrong is a photon map in fog? Photons and paths in scattering media, each number with its standard error.
///
/// Lengths are in scene units (L), powers in watts. Figures use the DejaVu fonts (Bitstream Vera licence).
#[derive(Parser)]
#[command(name = "turbid", version, arg_required_else_help = true)]
struct Arguments {
    #[command(subcommand)]
    command: command::Command,
}

fn main() -> ExitCode {
    let outcome = match Arguments::try_parse() {
        Ok(arguments) => arguments.command.run(),
        Err(error) => command::explain(&error),
    };
    command::exit_code("turbid", outcome)
}
