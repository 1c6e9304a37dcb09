//! What the user chooses.

use super::pictures::{self, Picture};
use crate::harness::{seed, threads};
use clap::Parser;
use std::path::PathBuf;

/// Renders the gallery: each picture by photons, by its best rival in the same time, and beside a converged reference.
#[derive(Debug, Clone, Parser)]
#[command(name = "gallery", version)]
pub struct Settings {
    /// Half the width and height: a quarter of the time
    #[arg(long)]
    pub quick: bool,
    /// Only these pictures; those made before stay on the page
    #[arg(long, value_name = "NAME", value_delimiter = ',', value_parser = name)]
    pub only: Vec<String>,
    /// The photon mapper's pictures alone, to look at: no paths, no reference, no comparison
    #[arg(long)]
    pub draft: bool,
    /// Seed of all random numbers
    #[arg(long, default_value_t = 1, value_parser = seed)]
    pub seed: u64,
    /// Folder of the page [default: results/gallery, with --quick or --draft results/local/gallery]; with --print of its pictures
    /// [default: results/print]
    #[arg(long)]
    pub out: Option<PathBuf>,
    /// Folder of the scenes
    #[arg(long, default_value = "experiments/scenes")]
    pub scenes: PathBuf,
    /// Number of threads [default: all cores]
    #[arg(long, value_parser = threads)]
    pub threads: Option<u16>,
    /// Forget what earlier runs made
    #[arg(long)]
    pub fresh: bool,
    /// Take what another build of the program made
    #[arg(long, conflicts_with = "fresh")]
    pub reuse: bool,
    /// 960 pixels wide, of what the page has compared: the photon map, what is read along rays, the rival and the reference; the kept page
    /// then leads to them. Each pixel has a quarter of the samples that the page's pixels have
    #[arg(long, conflicts_with_all = ["quick", "draft", "page"])]
    pub print: bool,
    /// Only write the page anew, from the numbers and pictures that are in its folder
    #[arg(long)]
    pub page: bool,
    /// Only write the scenes' data files anew, into the folder of the scenes
    #[arg(long)]
    pub assets: bool,
}

fn name(text: &str) -> Result<String, String> {
    if pictures::ALL.iter().any(|p| p.name == text) {
        return Ok(text.to_string());
    }
    let names: Vec<&str> = pictures::ALL.iter().map(|p| p.name).collect();
    Err(format!("allowed: {}", names.join(", ")))
}

/// Folder of the kept page.
pub const PAGE: &str = "results/gallery";
/// Folder of the kept pictures at the size of print.
pub const PRINT: &str = "results/print";
/// Where a page looks for them.
pub const FROM_PAGE: &str = "../print";

impl Settings {
    /// Folder of the page.
    pub fn folder(&self) -> PathBuf {
        let default = match (self.quick || self.draft, self.print) {
            (true, _) => "results/local/gallery",
            (_, true) => PRINT,
            _ => PAGE,
        };
        self.out.clone().unwrap_or_else(|| PathBuf::from(default))
    }

    /// Folder of the cached renders, which are large: beside the page only where that is a local one.
    pub fn cache(&self) -> PathBuf {
        match &self.out {
            Some(out) => out.join("cache"),
            None if self.quick || self.draft => self.folder().join("cache"),
            None if self.print => PathBuf::from("results/local/print/cache"),
            None => PathBuf::from("results/local/gallery-full/cache"),
        }
    }

    /// Whether a picture is wanted.
    pub fn has(&self, picture: &Picture) -> bool {
        self.only.is_empty() || self.only.iter().any(|name| name == picture.name)
    }

    /// Size of the pictures over that of the scenes' own cameras.
    pub fn scale(&self) -> f64 {
        if self.quick { 0.5 } else { 1.0 }
    }

    /// The command that makes the whole page: `--only` has made a part of it.
    pub fn command(&self) -> String {
        let mut text = "cargo run --release --bin gallery".to_string();
        let flags = [(self.quick, " --quick"), (self.draft, " --draft")];
        if flags.iter().any(|f| f.0) || self.seed != 1 {
            text.push_str(" --");
        }
        flags.iter().filter(|f| f.0).for_each(|f| text.push_str(f.1));
        if self.seed != 1 {
            text.push_str(&format!(" --seed {}", self.seed));
        }
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn flags() {
        let parse = |args: &[&str]| Settings::try_parse_from([&["gallery"], args].concat());
        assert!(parse(&["--only", "pool,cloud"]).is_ok_and(|s| s.only == ["pool", "cloud"]));
        let quick = parse(&["--quick", "--seed", "3"]).unwrap();
        assert_eq!(quick.command(), "cargo run --release --bin gallery -- --quick --seed 3");
        assert_eq!(quick.folder(), PathBuf::from("results/local/gallery"));
        assert_eq!(parse(&["--print"]).unwrap().folder(), PathBuf::from("results/print"));
        assert_eq!(parse(&[]).unwrap().command(), "cargo run --release --bin gallery");
        for bad in
            [&["--only", "ponds"][..], &["--print", "--quick"], &["--fresh", "--reuse"], &["--threads", "0"]]
        {
            assert!(parse(bad).is_err(), "{bad:?}");
        }
    }
}
