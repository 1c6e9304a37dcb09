//! The whole run: sets one after another, each kept as it is answered; then the page.

use super::comparison::{Answered, Comparison};
use super::scene::Bench;
use super::set::Set;
use super::sets::ALL;
use super::settings::Settings;
use super::{pack, page, plot};
use crate::harness::{check_folder, duration, on_threads, program, program_digest, read_if_there, say};
use anyhow::Context;
use clap::Parser;
use serde::Serialize;
use std::path::Path;
use std::process::ExitCode;
use std::time::Instant;
use turbid::output::{write_atomically, write_csv};

/// Larger answers are none.
const MOST_BYTES: u64 = 1 << 26;

/// A row of a set's table.
#[derive(Serialize)]
struct Record<'a> {
    set: &'a str,
    answered_by: &'a str,
    case: &'a str,
    quantity: &'a str,
    at: f64,
    theirs: Option<f64>,
    their_error: Option<f64>,
    ours: f64,
    our_error: Option<f64>,
    z: Option<f64>,
}

/// Runs the benchmarks as a program.
pub fn main() -> ExitCode {
    let kept = |settings: &Settings| {
        let folder = settings.folder();
        format!("answered sets are kept in {}, and the same command goes on from there", folder.display())
    };
    program("benchmarks", Settings::try_parse, kept, |settings| {
        on_threads(settings.threads, || run(settings)).map(|()| 0)
    })
}

fn run(settings: &Settings) -> anyhow::Result<()> {
    let folder = settings.folder();
    if settings.pack {
        return pack::write(&folder);
    }
    if !settings.page {
        answer(settings, &folder)?;
    }
    let answered = all_answered(&folder)?;
    if settings.page {
        for set in ALL {
            if let Some(answered) = answered.iter().find(|a| a.set == set.name) {
                draw(&folder, set, answered)?;
            }
        }
    }
    let page = page::page(&answered, settings).into_string();
    write(&folder.join("index.html"), page.as_bytes())?;
    say(&format!("the page is {}", folder.join("index.html").display()));
    Ok(())
}

fn answer(settings: &Settings, folder: &Path) -> anyhow::Result<()> {
    let program = program_digest()?.to_string();
    let chosen: Vec<&Set> = ALL.iter().copied().filter(|set| settings.has(set.name)).collect();
    check_folder(folder, &["index.html"])?;
    for set in &chosen {
        check_folder(folder, &[&format!("{}.json", set.name), &format!("{}.csv", set.name)])?;
    }
    let seconds = |set: &Set| set.seconds[usize::from(!settings.quick)];
    let mut left: f64 = chosen.iter().map(|set| seconds(set)).sum();
    for (index, set) in chosen.iter().enumerate() {
        // A file of the user's is read anew each time.
        let is_known = !settings.fresh
            && settings.theirs(set.name).is_none()
            && kept(folder, set)?
                .is_some_and(|a| a.settings == settings.words(set.name) && a.program == program);
        let about = format!("set {} of {}, {}", index + 1, chosen.len(), set.name);
        if is_known {
            say(&format!("{about}: answered already"));
        } else {
            say(&format!("{about}: about {} left of all", duration(left)));
            let start = Instant::now();
            let theirs = settings.theirs(set.name).map(Path::to_path_buf);
            let bench = Bench::new(folder.join("scenes"), settings.quick, settings.seed, theirs);
            let comparisons = (set.run)(&bench).with_context(|| set.name.to_string())?;
            say(&format!("  {} took {}", set.name, duration(start.elapsed().as_secs_f64())));
            keep(folder, set, settings.words(set.name), program.clone(), comparisons)?;
        }
        left -= seconds(set);
    }
    Ok(())
}

fn keep(
    folder: &Path,
    set: &Set,
    settings: String,
    program: String,
    comparisons: Vec<Comparison>,
) -> anyhow::Result<()> {
    let answered = Answered { set: set.name.to_string(), settings, program, comparisons };
    draw(folder, set, &answered)?;
    // Last: what has it is complete.
    write(&folder.join(format!("{}.json", set.name)), &serde_json::to_vec(&answered)?)
}

/// The picture and the table of a set.
fn draw(folder: &Path, set: &Set, answered: &Answered) -> anyhow::Result<()> {
    let figure = plot::figure(set, &answered.comparisons);
    let png = figure.png().with_context(|| format!("the picture of {}", set.name))?;
    let mut table = Vec::new();
    let records: Vec<Record> = answered.comparisons.iter().flat_map(|c| records(set, c)).collect();
    write_csv(&mut table, &records)?;
    write(&folder.join(format!("{}.png", set.name)), &png)?;
    write(&folder.join(format!("{}.csv", set.name)), &table)
}

fn records<'a>(set: &'a Set, c: &'a Comparison) -> impl Iterator<Item = Record<'a>> {
    c.rows.iter().map(|row| Record {
        set: set.name,
        answered_by: &c.by,
        case: &row.case,
        quantity: &row.quantity,
        at: row.at,
        theirs: row.theirs,
        their_error: row.their_error,
        ours: row.ours,
        our_error: row.our_error,
        z: row.z(),
    })
}

fn kept(folder: &Path, set: &Set) -> anyhow::Result<Option<Answered>> {
    let path = folder.join(format!("{}.json", set.name));
    let Some(text) = read_if_there(&path, MOST_BYTES)? else { return Ok(None) };
    Ok(Some(serde_json::from_slice(&text).with_context(|| path.display().to_string())?))
}

/// The answers that are there, those of earlier runs too.
fn all_answered(folder: &Path) -> anyhow::Result<Vec<Answered>> {
    let found = ALL.iter().map(|set| kept(folder, set));
    Ok(found.collect::<anyhow::Result<Vec<_>>>()?.into_iter().flatten().collect())
}

fn write(path: &Path, bytes: &[u8]) -> anyhow::Result<()> {
    Ok(write_atomically(path, |out| out.write_all(bytes))?)
}
