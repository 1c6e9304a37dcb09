//! `exact`: the referee's answers on the command line, each with its bound and how it is known.

#[path = "exact/cases.rs"]
mod cases;
#[path = "exact/kernel.rs"]
mod kernel;
#[path = "exact/slab.rs"]
mod slab;
#[path = "exact/table.rs"]
mod table;

use clap::error::ErrorKind;
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
        Err(error) => return explain(&error),
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
    print(&output)
}

fn print(output: &[u8]) -> anyhow::Result<()> {
    let mut out = io::stdout().lock();
    out.write_all(output)?;
    out.flush()?;
    Ok(())
}

/// Help and version go to stdout; a command line that cannot be understood becomes an error of one line.
fn explain(error: &clap::Error) -> anyhow::Result<()> {
    let text = error.render().to_string();
    match error.kind() {
        ErrorKind::DisplayHelp | ErrorKind::DisplayVersion => print(text.as_bytes()),
        ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand => {
            anyhow::bail!("nothing asked; allowed: --cases FILE.csv, slab, kernel; more with --help")
        }
        _ => anyhow::bail!("{}", one_line(&text)),
    }
}

/// The parts of a message of several lines, without usage and hints where to look.
fn one_line(text: &str) -> String {
    let mut line = String::new();
    for part in text.lines().map(str::trim).filter(|part| !part.is_empty()) {
        if part.starts_with("Usage:") || part.starts_with("For more information") {
            break;
        }
        let part = part.strip_prefix("error: ").unwrap_or(part);
        let part = part
            .strip_prefix("[possible values: ")
            .map_or(part.to_string(), |values| format!("allowed: {}", values.trim_end_matches(']')));
        if !line.is_empty() {
            line.push_str(if line.ends_with(':') { " " } else { "; " });
        }
        line.push_str(&part);
    }
    line
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
