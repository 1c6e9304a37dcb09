//! What the user chooses.

use super::measure::Effort;
use crate::harness::{seed, threads};
use clap::Parser;
use std::ops::Range;
use std::path::PathBuf;

/// Scenes by chance: draws valid scenes and asks whether every method gives them the same light.
///
/// Exit code: 0 all agree, 1 an alarm, 3 too many undecided, 2 an error.
#[derive(Debug, Clone, Parser)]
#[command(name = "sweep", version)]
pub struct Settings {
    /// Seeds of the scenes: 0..2000 are two thousand
    #[arg(long, value_name = "FROM..TO", value_parser = seeds, default_value = "0..200", conflicts_with_all = ["seed", "scene"])]
    pub seeds: Range<u64>,
    /// One scene, with all that was compared; with --scene the seed of the random numbers
    #[arg(long, value_parser = seed)]
    pub seed: Option<u64>,
    /// A scene of your own with a camera, a scene file or one of Mitsuba (.xml), in place of a drawn one
    #[arg(long, value_name = "FILE")]
    pub scene: Option<PathBuf>,
    /// Work of each method where a scene needs all of it, over that of some seven seconds
    #[arg(long, default_value_t = 1.0)]
    pub effort: f64,
    /// Scenes at a time [default: all cores]
    #[arg(long, value_parser = threads)]
    pub threads: Option<u16>,
    /// Folder of the results, a small file a seed
    #[arg(long, default_value = "results/local/sweep")]
    pub out: PathBuf,
    /// Take what another build of the program found
    #[arg(long)]
    pub reuse: bool,
    /// Do not look for the smallest scene that still shows an alarm
    #[arg(long)]
    pub no_shrink: bool,
    /// Print the scene of --seed, and nothing else
    #[arg(long, requires = "seed", conflicts_with = "scene")]
    pub print: bool,
    /// Negative control: paths are too bright by this factor, which every scene that they see must show
    #[arg(long, value_name = "FACTOR", default_value_t = 1.0, hide_default_value = true)]
    pub control: f64,
    /// Examine in this process and write what was found here
    #[arg(long, hide = true)]
    pub child: Option<PathBuf>,
}

/// Rays and look-ups of an effort of 1. Few scenes need all of it: in the mean a method takes 1.4 s.
const STEPS: f64 = 1.75e7;
/// CPU seconds of a method at an effort of 1, after which it is stopped: what rays take differs by scene, and what it takes to
/// fill photon maps is counted by the histories of one.
const SECONDS: f64 = 40.0;

fn seeds(text: &str) -> Result<Range<u64>, String> {
    let parse = |text: &str| text.trim().parse::<u64>().ok();
    let ends = text.split_once("..").and_then(|(from, to)| Some((parse(from)?, parse(to)?)));
    match ends {
        Some((from, to)) if from < to && to <= 1 << 32 => Ok(from..to),
        _ => Err("allowed: FROM..TO, whole numbers, such as 0..2000".into()),
    }
}

impl Settings {
    /// The options that what a scene shows depends on, where they are not the usual ones: as words of a command.
    pub fn own(&self) -> String {
        let own = [("--effort", self.effort), ("--control", self.control)].into_iter();
        own.filter(|(_, value)| *value != 1.0).map(|(option, value)| format!(" {option} {value}")).collect()
    }

    /// How much each method may do.
    ///
    /// # Errors
    /// for an effort or a factor that is not a number above 0
    pub fn effort(&self) -> anyhow::Result<Effort> {
        anyhow::ensure!(
            self.effort > 0.0 && self.effort <= 1e4,
            "--effort is {}; allowed: above 0, to 10000",
            self.effort
        );
        anyhow::ensure!(
            self.control > 0.0 && self.control <= 1e4,
            "--control is {}; allowed: above 0, to 10000",
            self.control
        );
        let seconds = Some(SECONDS * self.effort.max(1.0));
        Ok(Effort { steps: STEPS * self.effort, seconds, control: self.control })
    }
}
