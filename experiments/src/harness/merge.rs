//! Cells of other folders, brought together.

use super::Settings;
use super::cell::{self, CellRow};
use super::manifest::Manifest;
use super::measure::cell_path;
use super::{CellId, Experiment};
use anyhow::{Context, bail, ensure};
use std::path::{Path, PathBuf};
use turbid::output::write_atomically;

/// The cells of an experiment, and where its predictions are.
pub(super) struct Expected<'a> {
    pub experiment: &'a Experiment,
    pub cells: Vec<&'a CellId>,
}

/// That a folder can be merged.
///
/// # Errors
/// A folder without cells
pub(super) fn check_mergeable(folder: &Path) -> anyhow::Result<()> {
    ensure!(
        folder.join("cells").is_dir(),
        "--merge {}: it has no cells; allowed: the --out folder of a part",
        folder.display()
    );
    Ok(())
}

/// Copies the cells of some folders of parts to another, where they are one study's.
///
/// # Errors
/// A cell of other settings or of another build (unless `--reuse-cells`), or that is broken; one that two
/// folders have differently
pub(super) fn collect(
    folders: &[PathBuf],
    into: &Path,
    expected: &[Expected],
    manifest: &Manifest,
    settings: &Settings,
) -> anyhow::Result<()> {
    for folder in folders {
        let from = folder.join("cells");
        if is_same(&from, into) {
            continue;
        }
        for Expected { experiment, cells } in expected {
            let own = into.join(experiment.name);
            std::fs::create_dir_all(&own).with_context(|| format!("cannot create {}", own.display()))?;
            let predictions = from.join(experiment.name).join("predictions.csv");
            if predictions.is_file() && !own.join("predictions.csv").exists() {
                copy(&predictions, &own.join("predictions.csv"))?;
            }
            for cell in cells {
                let source = cell_path(&from, experiment, cell);
                if source.is_file() {
                    take(&source, &cell_path(into, experiment, cell), experiment, cell, manifest, settings)?;
                }
            }
        }
    }
    Ok(())
}

fn is_same(a: &Path, b: &Path) -> bool {
    matches!((a.canonicalize(), b.canonicalize()), (Ok(a), Ok(b)) if a == b)
}

fn copy(from: &Path, to: &Path) -> anyhow::Result<()> {
    let bytes = std::fs::read(from).with_context(|| format!("cannot read {}", from.display()))?;
    Ok(write_atomically(to, |out| out.write_all(&bytes))?)
}

/// Takes one cell over, or finds it there already.
fn take(
    source: &Path,
    to: &Path,
    experiment: &Experiment,
    id: &CellId,
    manifest: &Manifest,
    settings: &Settings,
) -> anyhow::Result<()> {
    let (header, rows) = cell::read(source)?;
    manifest
        .check(&header, experiment.name, &id.id(), settings)
        .with_context(|| source.display().to_string())?;
    match cell::read(to) {
        Ok((_, there)) if is_equal(&there, &rows) => Ok(()),
        Ok(_) => bail!(
            "{} and {} are one cell and differ; allowed: parts of one program and one study",
            source.display(),
            to.display()
        ),
        Err(_) => copy(source, to),
    }
}

/// Bit by bit.
fn is_equal(a: &[CellRow], b: &[CellRow]) -> bool {
    let same = |(a, b): (&CellRow, &CellRow)| {
        a.case == b.case && a.quantity == b.quantity && a.value.to_bits() == b.value.to_bits()
    };
    a.len() == b.len() && a.iter().zip(b).all(same)
}
