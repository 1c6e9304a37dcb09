//! What the user chooses: the flags shared by all experiments.

use super::program::{seed, threads};
use super::question::stem;
use super::{Question, Share};
use clap::error::ErrorKind;
use clap::{CommandFactory, FromArgMatches, Parser};
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use turbid_figure::Width;

/// The seed of a study that names none: fixed before any run with it. Those below were looked at while the laboratory was
/// built, and some claims were chosen then.
pub const SEED: u64 = 100;

/// How much is measured.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Preset {
    /// A few minutes.
    Quick,
    /// The reference run: more maps and more photons.
    Full,
}

/// The settings of a study. Results depend on preset, seed, photon scale and choice of experiments, and on nothing
/// else here.
#[derive(Debug, Clone, PartialEq)]
pub struct Settings {
    /// How much is measured.
    pub preset: Preset,
    /// Seed of all random streams.
    pub seed: u64,
    /// Factor on every number of photons; 1 unless asked for.
    pub photon_scale: f64,
    /// Threads of the pool, at least 1.
    pub threads: usize,
    /// Folder of report, results and cells.
    pub out: PathBuf,
    /// Forget the cells of earlier runs.
    pub fresh: bool,
    /// Take cells of another build of the program.
    pub reuse_cells: bool,
    /// Let the exit code tell the verdicts.
    pub strict: bool,
    /// Names of the experiments to run; all if empty.
    pub only: Vec<String>,
    /// Redraw figures from their tables instead of running anything.
    pub replot: Option<Replot>,
    /// A study of the user's own in the place of the experiments: its file, which is read after the command line.
    pub question_file: Option<PathBuf>,
    /// The same, read.
    pub question: Option<Arc<Question>>,
    /// Say what a study of the user's own will take, and measure nothing.
    pub dry_run: bool,
    /// Measure a part of the cells, and conclude nothing.
    pub part: Option<Share>,
    /// Measure nothing, and conclude from the cells of these folders.
    pub merge: Vec<PathBuf>,
}

/// What is redrawn.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Replot {
    /// In this width alone; in both if `None`.
    pub width: Option<Width>,
    /// Tables of single figures; those of the study's folder if empty.
    pub files: Vec<PathBuf>,
}

const FONT: &str = concat!(
    env!("CARGO_PKG_VERSION"),
    "\nFigures embed DejaVu Sans (Bitstream Vera licence: free to use, embed and share)."
);

/// Plays the simulator against exact values and writes a report.
#[derive(Parser)]
#[command(version, long_version = FONT)]
struct Flags {
    /// A few minutes of work (default)
    #[arg(long, conflicts_with = "full")]
    quick: bool,
    /// The reference run: more maps and more photons
    #[arg(long)]
    full: bool,
    /// Seed of all random numbers
    #[arg(long, default_value_t = SEED, value_parser = seed)]
    seed: u64,
    /// Factor on every number of photons
    #[arg(long, value_name = "SCALE", default_value_t = 1.0, value_parser = scale)]
    photons: f64,
    /// Folder of the report [default: results/local/NAME, with -full, -seedN and -photonsX after those flags]
    #[arg(long)]
    out: Option<PathBuf>,
    /// Number of threads [default: all cores]
    #[arg(long, value_parser = threads)]
    threads: Option<u16>,
    /// Forget the cells of earlier runs
    #[arg(long)]
    fresh: bool,
    /// Take cells that another build of the program made (recorded in the report)
    #[arg(long, conflicts_with = "fresh")]
    reuse_cells: bool,
    /// Exit with 1 after a rejected claim, 3 after an undecided one
    #[arg(long)]
    strict: bool,
    /// Run only these experiments
    #[arg(long, value_name = "NAME", value_delimiter = ',')]
    only: Vec<String>,
    /// Redraw the figures of a finished study, and those in its report, from figures/*.csv; nothing is measured
    #[arg(long, conflicts_with_all = ["seed", "photons", "threads", "fresh", "reuse_cells", "strict"])]
    replot: bool,
    /// Redraw in this width of print alone: single (85 mm) or double (175 mm)
    #[arg(long, requires = "replot", value_parser = width)]
    width: Option<Width>,
    /// Say how many cells a study of your own has, and about how much time and memory they take, and measure nothing
    #[arg(long, conflicts_with_all = ["replot", "fresh", "reuse_cells", "strict"])]
    dry_run: bool,
    /// Measure one part of the cells, such as 3/16, and conclude nothing: parts may run at once, in one folder or in several
    #[arg(long, value_name = "I/N", conflicts_with_all = ["replot", "merge", "fresh", "strict", "dry_run"])]
    part: Option<Share>,
    /// Conclude from the cells of these folders of parts, and measure nothing
    #[arg(long, value_name = "DIR", num_args = 1.., conflicts_with_all = ["replot", "fresh", "dry_run"])]
    merge: Vec<PathBuf>,
    /// A study of your own, STUDY.toml (experiments/studies/README.md says what it holds); with --replot tables of figures, FILE.csv, each of which is
    /// drawn alone
    #[arg(value_name = "FILE", conflicts_with_all = ["only", "full", "quick", "strict"])]
    files: Vec<PathBuf>,
}

/// What is wrong with the files of a command line, if anything is.
fn wrong_files(flags: &Flags) -> Option<String> {
    let is = |file: &Path, end: &str| file.extension().is_some_and(|e| e.eq_ignore_ascii_case(end));
    match flags.files.as_slice() {
        [] if flags.dry_run => Some("--dry-run needs a study of your own: STUDY.toml".into()),
        [_, ..] if flags.replot && flags.out.is_some() => {
            Some("--replot FILE.csv writes beside its table: --out cannot be used".into())
        }
        _ if flags.replot => None,
        [] => None,
        [study] if is(study, "toml") => None,
        [first, ..] => Some(format!(
            "{}: allowed: one study, whose name ends in .toml, or FILE.csv with --replot",
            first.display()
        )),
    }
}

fn width(text: &str) -> Result<Width, String> {
    [Width::Single, Width::Double]
        .into_iter()
        .find(|width| width.name() == text)
        .ok_or_else(|| "allowed: single, double".to_string())
}

/// A factor on photon counts, 1e-6 to 1e6.
fn scale(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(x) if (1e-6..=1e6).contains(&x) => Ok(x),
        _ => Err("allowed: a factor from 1e-6 to 1e6".to_string()),
    }
}

impl Settings {
    /// Quick settings with the default seed on all cores, written to `out`.
    pub fn new(out: impl Into<PathBuf>) -> Self {
        Settings {
            preset: Preset::Quick,
            seed: SEED,
            photon_scale: 1.0,
            threads: cores(),
            out: out.into(),
            fresh: false,
            reuse_cells: false,
            strict: false,
            only: Vec::new(),
            replot: None,
            question_file: None,
            question: None,
            dry_run: false,
            part: None,
            merge: Vec::new(),
        }
    }

    /// The settings that command-line arguments (the program's name first) ask for.
    ///
    /// # Errors
    /// clap's error, whose kind tells help and version from mistakes.
    pub fn parse(study: &'static str, args: impl IntoIterator<Item = OsString>) -> Result<Self, clap::Error> {
        let mut command = Flags::command().name(study);
        let matches = command.try_get_matches_from_mut(args)?;
        let flags = Flags::from_arg_matches(&matches)?;
        if let Some(wrong) = wrong_files(&flags) {
            return Err(command.error(ErrorKind::ArgumentConflict, wrong));
        }
        let question_file = if flags.replot { None } else { flags.files.first().cloned() };
        let preset = if flags.full { Preset::Full } else { Preset::Quick };
        // A quick look must not write over a night's work, nor one seed over another.
        let mut folder = study.to_string();
        if let Some(file) = &question_file {
            folder.push_str(&format!("-{}", stem(file)));
        }
        if flags.full {
            folder.push_str("-full");
        }
        if flags.seed != SEED {
            folder.push_str(&format!("-seed{}", flags.seed));
        }
        if flags.photons != 1.0 {
            folder.push_str(&format!("-photons{}", flags.photons));
        }
        Ok(Settings {
            preset,
            seed: flags.seed,
            photon_scale: flags.photons,
            threads: flags.threads.map_or_else(cores, usize::from),
            out: flags.out.unwrap_or_else(|| match flags.merge.as_slice() {
                [one] => one.clone(),
                _ => PathBuf::from("results/local").join(folder),
            }),
            fresh: flags.fresh,
            reuse_cells: flags.reuse_cells,
            strict: flags.strict,
            only: flags.only,
            replot: flags.replot.then_some(Replot { width: flags.width, files: flags.files }),
            question_file,
            question: None,
            dry_run: flags.dry_run,
            part: flags.part,
            merge: flags.merge,
        })
    }

    /// One of two values, by preset.
    pub fn pick<T>(&self, quick: T, full: T) -> T {
        match self.preset {
            Preset::Quick => quick,
            Preset::Full => full,
        }
    }

    /// A number of photons by preset, times the scale, at least 1.
    pub fn photons(&self, quick: u64, full: u64) -> u64 {
        ((self.pick(quick, full) as f64 * self.photon_scale).round() as u64).max(1)
    }

    /// Photons a map and numbers of maps, the photons times the scale, at least 1.
    pub fn sizes(&self, sizes: &[(u64, u64)]) -> Vec<(u64, u64)> {
        let scaled = |n: u64| ((n as f64 * self.photon_scale) as u64).max(1);
        sizes.iter().map(|&(photons, maps)| (scaled(photons), maps)).collect()
    }

    /// What a cell depends on, in words: two cells of equal words and equal program are equal.
    pub fn words(&self) -> String {
        let preset = match &self.question {
            Some(question) => format!("{} of digest {}", question.stem(), question.digest),
            None => self.pick("quick", "full").to_string(),
        };
        let scale = if self.photon_scale == 1.0 {
            String::new()
        } else {
            format!(", photons × {}", self.photon_scale)
        };
        format!("{preset}, seed {}{scale}", self.seed)
    }

    /// The command that repeats the study's results; the folder is left out where it is absolute.
    pub fn command(&self, study: &str) -> String {
        let what = match &self.question_file {
            Some(file) if file.is_absolute() => {
                file.file_name().unwrap_or_default().to_string_lossy().to_string()
            }
            Some(file) => file.display().to_string(),
            None => format!("--{}", self.pick("quick", "full")),
        };
        let mut text = format!("cargo run --release -p turbid-experiments --bin {study} -- {what}");
        text.push_str(&format!(" --seed {}", self.seed));
        if self.photon_scale != 1.0 {
            text.push_str(&format!(" --photons {}", self.photon_scale));
        }
        if !self.only.is_empty() {
            text.push_str(&format!(" --only {}", self.only.join(",")));
        }
        text
    }
}

fn cores() -> usize {
    std::thread::available_parallelism().map_or(1, usize::from)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(args: &[&str]) -> Result<Settings, clap::Error> {
        Settings::parse("bias", std::iter::once("bias").chain(args.iter().copied()).map(OsString::from))
    }

    #[test]
    fn defaults_are_a_quick_study() {
        let settings = parse(&[]).unwrap();
        assert_eq!(settings, Settings::new("results/local/bias"));
        let folder = |args: &[&str]| parse(args).unwrap().out;
        assert_eq!(folder(&["--full"]), PathBuf::from("results/local/bias-full"));
        let other = folder(&["--seed", "2", "--photons", "0.003"]);
        assert_eq!(other, PathBuf::from("results/local/bias-seed2-photons0.003"));
    }

    #[test]
    fn photons_follow_preset_and_scale() {
        assert_eq!(parse(&["--photons", "0.5"]).unwrap().photons(1000, 8000), 500);
        assert_eq!(parse(&["--full"]).unwrap().photons(1000, 8000), 8000);
        assert_eq!(parse(&["--photons", "1e-6"]).unwrap().photons(10, 10), 1);
    }

    #[test]
    fn bad_values_are_refused() {
        for bad in [
            &["--photons", "0"][..],
            &["--photons", "nan"],
            &["--photons", "-1"],
            &["--seed", "-1"],
            &["--seed", "x"],
            &["--threads", "0"],
            &["--quick", "--full"],
            &["--fresh", "--reuse-cells"],
            &["--colour"],
            &["--width", "single"],
            &["--replot", "--width", "wide"],
            &["--replot", "--seed", "2"],
            &["a.csv"],
            &["--replot", "--out", "x", "a.csv"],
        ] {
            assert!(parse(bad).is_err(), "{bad:?}");
        }
    }

    #[test]
    fn the_command_repeats_the_results() {
        let settings =
            parse(&["--full", "--seed", "7", "--photons", "2", "--only", "a,b", "--threads", "3"]).unwrap();
        let command = settings.command("bias");
        let flags: Vec<&str> = command.split(" -- ").nth(1).unwrap().split(' ').collect();
        let again = parse(&flags).unwrap();
        assert_eq!((again.words(), again.only), (settings.words(), settings.only));
    }
}
