//! `exact`: the referee's answers on the command line, each with its bound and how it is known.

#[path = "exact/cases.rs"]
mod cases;
#[path = "exact/kernel.rs"]
mod kernel;
#[path = "exact/slab.rs"]
mod slab;
#[path = "exact/table.rs"]
mod table;

use clap::{Parser, Subcommand};
use std::io::{self, Write};
use std::path::PathBuf;
use std::process::ExitCode;

/// Exact values of light transport in fog, water and smoke.
///
/// Lengths are mean free paths. A slab 0 <= t <= tau has its lit face at t = 0, which receives unit irradiance:
/// fractions and fluences are dimensionless, radiances are per steradian. A cosine mu > 0 points up, towards the lit
/// face. Every value has an absolute error bound.
#[derive(Parser)]
#[command(name = "exact", version, arg_required_else_help = true)]
struct Cli {
    /// Answer a table of cases: CSV with the columns
    /// id,geometry,tau,a,w,g,n,mu0,t,r,mu,dphi,extra,quantity; others are ignored. Prints id,value,error,note; a row
    /// that is not answered here has an empty value and a note saying why.
    #[arg(long, value_name = "FILE.csv")]
    cases: Option<PathBuf>,
    #[command(subcommand)]
    command: Option<Command>,
}

#[derive(Subcommand)]
enum Command {
    /// A homogeneous slab: fluxes, fluence and, with isotropic scattering, radiance of scattered light.
    Slab(slab::Args),
    /// A smoothing kernel: moments, variance, exponential fields, faces and edges.
    Kernel(kernel::Args),
}

fn run() -> anyhow::Result<()> {
    let cli = match Cli::try_parse() {
        Ok(cli) => cli,
        // clap's own text and its exit code, 0 for --help and 2 for a mistake.
        Err(error) => error.exit(),
    };
    let mut output = Vec::new();
    if let Some(path) = &cli.cases {
        anyhow::ensure!(cli.command.is_none(), "--cases stands alone: give it or a command, not both");
        cases::answer(path, &mut output)?;
    }
    match &cli.command {
        Some(Command::Slab(args)) => slab::answer(args)?.print(&mut output)?,
        Some(Command::Kernel(args)) => kernel::answer(args)?.print(&mut output)?,
        None => {}
    }
    let mut out = io::stdout().lock();
    out.write_all(&output)?;
    out.flush()?;
    Ok(())
}

fn main() -> ExitCode {
    let Err(error) = run() else { return ExitCode::SUCCESS };
    let closed = |e: &io::Error| e.kind() == io::ErrorKind::BrokenPipe;
    if error.downcast_ref::<io::Error>().is_some_and(closed) {
        return ExitCode::SUCCESS;
    }
    // If stderr is closed too, the exit code is all that is left to say.
    let _ = writeln!(io::stderr().lock(), "error: {error:#}");
    ExitCode::from(2)
}
