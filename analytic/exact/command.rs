//! The command line.

use crate::format::Format;
use crate::question::Question;
use crate::{
    beams, boundary, cavity, critical, cuboid, emitting_cube, half_space, infinite, kernel, layers, nearest,
    nested, path, progressive, slab, sphere, thick, two_stream, xy,
};
use clap::{Parser, Subcommand};
use std::path::PathBuf;

/// Exact values of light transport in fog, water and smoke, each with an absolute error bound.
///
/// Lengths are mean free paths. A slab 0 <= t <= tau has its lit face at t = 0, which receives unit irradiance:
/// fractions and fluences are dimensionless, radiances are per steradian. A cosine mu > 0 points up, towards the lit
/// face. Every value comes with a unit (`mfp` a mean free path, 1 a pure number), a bound on its error, and how it is known; a
/// question outside the range in which the answer is known is refused. Bounds hold for decimals as typed, whose rounding to
/// double precision they count: where w is near 1, that is most of them. Each command's --help states its equation, units,
/// ranges and sources.
#[derive(Parser)]
#[command(name = "exact", version, arg_required_else_help = true, verbatim_doc_comment)]
pub struct Cli {
    /// Answer a table of cases: CSV with the columns
    /// id,geometry,tau,a,w,g,n,mu0,t,r,mu,dphi,extra,quantity; others are ignored. Gives id, value, error, method, note
    /// and the parameters; a row that is not answered here has an empty value and a note saying why. A file of up to
    /// 16 MiB, no pipe; control characters in its cells are spelt out
    #[arg(verbatim_doc_comment, long, value_name = "FILE.csv")]
    pub cases: Option<PathBuf>,
    /// Form of the output: a table for eyes, which shows digits as far as they are certain (four at least), or every bit
    /// as CSV or JSON. Without it a table, and CSV for --cases
    #[arg(verbatim_doc_comment, long, global = true, value_enum, help_heading = "Output")]
    pub format: Option<Format>,
    /// Write to this file, which appears whole or not at all, in place of standard output. Before all is answered nothing
    /// is written: a run that is ended leaves the old file
    #[arg(verbatim_doc_comment, long, global = true, help_heading = "Output", value_name = "FILE")]
    pub out: Option<PathBuf>,
    /// Draw the field to this file as well.
    #[arg(long, global = true, help_heading = "Output", value_name = "FILE.svg|FILE.png")]
    pub plot: Option<PathBuf>,
    #[command(subcommand)]
    pub command: Option<Command>,
}

/// The commands in the order of the help, each with the arguments that are its question.
#[derive(Subcommand)]
pub enum Command {
    Slab(slab::Args),
    Layers(layers::Args),
    HalfSpace(half_space::Args),
    Thick(thick::Args),
    TwoStream(two_stream::Args),
    Xy(xy::Args),
    Sphere(sphere::Args),
    Cuboid(cuboid::Args),
    EmittingCube(emitting_cube::Args),
    Nested(nested::Args),
    Cavity(cavity::Args),
    Critical(critical::Args),
    Path(path::Args),
    Infinite(infinite::Args),
    Kernel(kernel::Args),
    Beams(beams::Args),
    Nearest(nearest::Args),
    Progressive(progressive::Args),
    Boundary(boundary::Args),
}

impl Command {
    /// What is asked.
    pub fn question(&self) -> &dyn Question {
        match self {
            Command::Slab(question) => question,
            Command::Layers(question) => question,
            Command::HalfSpace(question) => question,
            Command::Thick(question) => question,
            Command::TwoStream(question) => question,
            Command::Xy(question) => question,
            Command::Sphere(question) => question,
            Command::Cuboid(question) => question,
            Command::EmittingCube(question) => question,
            Command::Nested(question) => question,
            Command::Cavity(question) => question,
            Command::Critical(question) => question,
            Command::Path(question) => question,
            Command::Infinite(question) => question,
            Command::Kernel(question) => question,
            Command::Beams(question) => question,
            Command::Nearest(question) => question,
            Command::Progressive(question) => question,
            Command::Boundary(question) => question,
        }
    }
}
