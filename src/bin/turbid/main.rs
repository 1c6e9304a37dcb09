//! The command `turbid`: parses, calls the file of the command, reports errors in one line.

mod advise;
mod beside;
mod check;
mod command;
mod export;
mod import;
mod load;
mod made;
mod map;
mod measure;
mod memory;
mod notes;
mod picture;
mod progress;
mod render;
mod scenes;
mod shared;
mod statistics;
mod usage;

use clap::Parser;
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
#[command(name = "turbid", version, arg_required_else_help = true, after_help = EXAMPLES)]
struct Arguments {
    #[command(subcommand)]
    command: command::Command,
}

fn main() -> ExitCode {
    end_on_signal(|| "turbid: stopped by a signal; files appear whole or not at all".to_string());
    without_panic("turbid", || {
        let outcome = match Arguments::try_parse() {
            Ok(arguments) => arguments.command.run(),
            Err(error) => usage::explain(&error),
        };
        command::exit_code("turbid", outcome)
    })
}
