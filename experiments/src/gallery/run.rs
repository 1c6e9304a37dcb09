//! The whole run: replicates, comparison, plates, page.

use super::beside::beside;
use super::cache::Cache;
use super::pictures::{ALL, Picture};
use super::plates::plates;
use super::print::{Printed, print};
use super::recipe::command;
use super::settings::{FROM_PAGE, PAGE, PRINT, Settings};
use super::shown::PageEntry;
use super::studio::Studio;
use super::{assets, page};
use crate::harness::{
    check_folder, check_later, duration, on_threads, program, program_digest, read_if_there, say,
};
use anyhow::Context;
use clap::Parser;
use serde::de::DeserializeOwned;
use std::path::Path;
use std::process::ExitCode;
use turbid::output::write_atomically;

/// CPU seconds of a picture: mean of those that are kept.
const EXPECTED: f64 = 1250.0;

/// Runs the gallery as a program.
pub fn main() -> ExitCode {
    let kept = |settings: &Settings| {
        let cache = settings.cache();
        format!("finished renders are kept in {}, and the same command goes on from there", cache.display())
    };
    program("gallery", Settings::try_parse, kept, |settings| {
        on_threads(settings.threads, || run(settings)).map(|()| 0)
    })
}

fn run(settings: &Settings) -> anyhow::Result<()> {
    if settings.assets {
        check_later(&settings.scenes.join("fogbox"))?;
        check_later(&settings.scenes.join("pool"))?;
        write(&settings.scenes.join("fogbox/het.vol"), &assets::fogbox_het()?)?;
        for (file, print) in assets::pool() {
            print.write(&settings.scenes.join(file))?;
        }
        return Ok(assets::window().write(&settings.scenes.join("window.png"))?);
    }
    let folder = settings.folder();
    if settings.page {
        return write_page(&folder, settings);
    }
    let program = program_digest()?.to_string();
    let chosen = |p: &&Picture| settings.has(p);
    if settings.print {
        return print_all(&folder, settings, &program);
    }
    check_folder(&folder, &["index.html"])?;
    for picture in ALL.iter().filter(chosen) {
        check_folder(&folder, &[&format!("{}.json", picture.name)])?;
        check_folder(&settings.cache().join(picture.name), &["photons.picture"])?;
    }
    let expected = ALL.iter().filter(chosen).count() as f64 * EXPECTED;
    let share = if settings.draft { 0.25 } else { 1.0 };
    say(&format!(
        "about {} of CPU time; what is made already is taken",
        duration(expected * share * settings.scale() * settings.scale())
    ));
    for picture in ALL.iter().filter(chosen) {
        let shown = one(picture, settings, &folder, &program).with_context(|| picture.name.to_string())?;
        write(&folder.join(format!("{}.json", picture.name)), &serde_json::to_vec_pretty(&shown)?)?;
        write_page(&folder, settings)?;
    }
    say(&format!("the page is {}", folder.join("index.html").display()));
    Ok(())
}

/// The pictures at the size of print, of those that the kept page has compared.
fn print_all(folder: &Path, settings: &Settings, program: &str) -> anyhow::Result<()> {
    let shown = of_all::<PageEntry>(Path::new(PAGE))?;
    let chosen: Vec<&Picture> = ALL.iter().filter(|p| settings.has(p)).collect();
    for picture in &chosen {
        check_folder(folder, &[&format!("{}.json", picture.name)])?;
        check_folder(&settings.cache().join(picture.name), &["photons.picture"])?;
    }
    for picture in chosen {
        let page = shown.iter().find(|(name, _)| *name == picture.name);
        let (_, page) =
            page.with_context(|| format!("{} is not in {PAGE}: make its page first", picture.name))?;
        let printed = print(picture, page, settings, folder, program).context(picture.name)?;
        write(&folder.join(format!("{}.json", picture.name)), &serde_json::to_vec_pretty(&printed)?)?;
    }
    say(&format!("the pictures are in {}", folder.display()));
    if folder == Path::new(PRINT) {
        write_page(Path::new(PAGE), settings)?;
    }
    Ok(())
}

fn write_page(folder: &Path, settings: &Settings) -> anyhow::Result<()> {
    let shown: Vec<PageEntry> = of_all(folder)?.into_iter().map(|(_, shown)| shown).collect();
    let printed = of_all::<Printed>(&folder.join(FROM_PAGE))?;
    let page = page::page(&shown, &printed, settings).into_string();
    write(&folder.join("index.html"), page.as_bytes())
}

/// Larger files about a picture are none.
const MOST_BYTES: u64 = 1 << 26;

/// What a folder has of all pictures, by name, those of earlier runs too.
fn of_all<T: DeserializeOwned>(folder: &Path) -> anyhow::Result<Vec<(&'static str, T)>> {
    let mut found = Vec::new();
    for picture in ALL {
        let path = folder.join(format!("{}.json", picture.name));
        if let Some(text) = read_if_there(&path, MOST_BYTES)? {
            let read = serde_json::from_slice(&text).with_context(|| path.display().to_string())?;
            found.push((picture.name, read));
        }
    }
    Ok(found)
}

fn write(path: &Path, bytes: &[u8]) -> anyhow::Result<()> {
    Ok(write_atomically(path, |out| out.write_all(bytes))?)
}

/// Everything of one picture.
fn one(picture: &Picture, settings: &Settings, folder: &Path, program: &str) -> anyhow::Result<PageEntry> {
    let studio = Studio::open(picture, &settings.scenes, settings.scale(), settings.seed, program)?;
    let half = studio.halved()?;
    let kept = settings.cache().join(picture.name);
    let large = Cache { settings, folder: kept.clone(), studio: &studio };
    let small = Cache { settings, folder: kept, studio: &half };
    let ours = large.photons_by_class("photons", picture.samples, 0, 1)?;
    let others = if settings.draft { None } else { Some(beside(&large, &small, &ours)?) };
    let plates = plates(&studio, folder, &ours, others.as_ref())?;
    let seconds = ours.facts.seconds + others.as_ref().map_or(0.0, |o| o.seconds);
    say(&format!("{}: {} of CPU time", picture.name, duration(seconds)));
    Ok(PageEntry {
        name: picture.name.to_string(),
        command: command(picture, settings.seed)?,
        size: (studio.grid().width, studio.grid().height),
        seconds,
        ours: ours.facts,
        equal: others.as_ref().map(|o| o.equal.1.facts.clone()),
        reference: others.as_ref().map(|o| o.cost),
        compared: others.map(|o| o.compared),
        plates,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The gallery in the repository is read whole: every picture of it has its reference, its comparison and its files.
    #[test]
    fn what_is_kept_is_read_whole() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../results/gallery");
        let kept: Vec<PageEntry> = of_all(&folder).unwrap().into_iter().map(|(_, shown)| shown).collect();
        let files = std::fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().path());
        assert_eq!(kept.len(), files.filter(|path| path.extension().is_some_and(|e| e == "json")).count());
        let mean = kept.iter().map(|shown| shown.seconds).sum::<f64>() / kept.len() as f64;
        assert!((EXPECTED / mean - 1.0).abs() < 0.1, "a picture takes {mean} s");
        for shown in kept {
            assert!(shown.reference.is_some() && shown.compared.is_some(), "{}", shown.name);
            assert!(shown.plates.iter().any(|plate| plate.kind == "reference"), "{}", shown.name);
            assert!(shown.plates.iter().all(|plate| folder.join(&plate.file).exists()), "{}", shown.name);
        }
    }
}
