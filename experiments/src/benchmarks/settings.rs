//! What the user chooses.

use super::sets;
use crate::harness::{seed, threads};
use clap::Parser;
use std::path::{Path, PathBuf};

/// Runs the benchmarks of other communities and writes their page: ours, theirs, difference over combined error.
#[derive(Debug, Clone, Parser)]
#[command(name = "benchmarks", version)]
pub struct Settings {
    /// A hundredth of the histories: minutes instead of half an hour
    #[arg(long)]
    pub quick: bool,
    /// Only these sets; those answered before stay on the page
    #[arg(long, value_name = "NAME", value_delimiter = ',', value_parser = set_name)]
    pub only: Vec<String>,
    /// Seed of all random numbers
    #[arg(long, default_value_t = 1, value_parser = seed)]
    pub seed: u64,
    /// Folder of the page [default: results/benchmarks, with --quick results/local/benchmarks, with --pack results/pack]
    #[arg(long)]
    pub out: Option<PathBuf>,
    /// Numbers of another code, where a set has none of its own: NAME=FILE, such as kobayashi-2=flux.csv
    #[arg(long, value_name = "NAME=FILE", value_parser = theirs)]
    pub theirs: Vec<(String, PathBuf)>,
    /// Number of threads [default: all cores]
    #[arg(long, value_parser = threads)]
    pub threads: Option<u16>,
    /// Forget what earlier runs answered
    #[arg(long)]
    pub fresh: bool,
    /// Only write the page, its pictures and tables anew, from the answers that are in its folder
    #[arg(long)]
    pub page: bool,
    /// Only write the pack of questions with exact values, for other codes to answer
    #[arg(long, conflicts_with_all = ["quick", "only", "seed", "theirs", "fresh", "page"])]
    pub pack: bool,
}

fn set_name(text: &str) -> Result<String, String> {
    if sets::ALL.iter().any(|set| set.name == text) {
        return Ok(text.to_string());
    }
    let names: Vec<&str> = sets::ALL.iter().map(|set| set.name).collect();
    Err(format!("allowed: {}", names.join(", ")))
}

fn theirs(text: &str) -> Result<(String, PathBuf), String> {
    let (name, file) = text.split_once('=').ok_or("allowed: NAME=FILE")?;
    let open: Vec<&str> = sets::ALL.iter().filter(|set| set.open).map(|set| set.name).collect();
    if open.contains(&name) && !file.is_empty() {
        return Ok((name.to_string(), PathBuf::from(file)));
    }
    Err(format!("allowed: NAME=FILE, where NAME is {}", open.join(" or ")))
}

impl Settings {
    /// Folder of the page.
    pub fn folder(&self) -> PathBuf {
        let default = match (self.pack, self.quick) {
            (true, _) => "results/pack",
            (_, true) => "results/local/benchmarks",
            _ => "results/benchmarks",
        };
        self.out.clone().unwrap_or_else(|| PathBuf::from(default))
    }

    /// Whether a set is wanted.
    pub fn has(&self, name: &str) -> bool {
        self.only.is_empty() || self.only.iter().any(|only| only == name)
    }

    /// The file with numbers of another code for a set.
    pub fn theirs(&self, name: &str) -> Option<&Path> {
        self.theirs.iter().find(|(set, _)| set == name).map(|(_, file)| file.as_path())
    }

    /// What the answer of a set depends on.
    pub fn words(&self, set: &str) -> String {
        let theirs =
            self.theirs(set).map_or(String::new(), |file| format!(", numbers of {}", file.display()));
        format!("{}, seed {}{theirs}", if self.quick { "quick" } else { "full" }, self.seed)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn flags() {
        let parse = |args: &[&str]| Settings::try_parse_from([&["benchmarks"], args].concat());
        assert!(parse(&["--only", "reed,disort"]).is_ok_and(|s| s.has("reed") && !s.has("van-de-hulst")));
        assert_eq!(parse(&["--quick"]).unwrap().folder(), PathBuf::from("results/local/benchmarks"));
        assert_eq!(parse(&["--pack"]).unwrap().folder(), PathBuf::from("results/pack"));
        for bad in [
            &["--only", "reeds"][..],
            &["--theirs", "reed"],
            &["--theirs", "reed=x.csv"],
            &["--threads", "0"],
            &["--pack", "--only", "reed"],
        ] {
            assert!(parse(bad).is_err(), "{bad:?}");
        }
    }
}
