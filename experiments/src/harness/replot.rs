//! Figures redrawn from their tables, without measuring anything.

use super::lock;
use super::outputs::write_if_changed;
use super::{FigureFiles, Replot, Settings, Terminal};
use crate::report;
use anyhow::{Context, bail};
use rayon::prelude::*;
use std::path::{Path, PathBuf};
use turbid_figure::{Error, Figure};

/// A table with what is drawn from it.
struct Redrawn {
    table: PathBuf,
    /// The table's name without its ending.
    stem: String,
    files: FigureFiles,
    /// Name and text of the figure as LaTeX, in the figure's own width.
    latex: (String, String),
}

/// Redraws the figures of a finished study and puts them into its report, or redraws single figures beside their
/// tables. Says in a line what was done.
///
/// All tables are read and all figures drawn before anything is written; each file then appears whole.
///
/// # Errors
/// If a study is at work in the folder, there is no table, one cannot be read, with file and line, or a file cannot be written.
pub fn replot(settings: &Settings, what: &Replot) -> anyhow::Result<String> {
    let folder = settings.out.join("figures");
    // A table alone is drawn beside itself, wherever that is; a study's figures and report are that study's while it runs.
    let _held = if what.files.is_empty() && folder.is_dir() {
        Some(lock::hold(&settings.out, None, &Terminal::default())?)
    } else {
        None
    };
    let tables = if what.files.is_empty() { tables(&folder, &settings.only)? } else { what.files.clone() };
    let redrawn: Vec<Redrawn> = tables.into_par_iter().map(redraw).collect::<anyhow::Result<_>>()?;
    let own_report = settings.out.join("report.html");
    // The page is made before the first file is written too.
    let page = if what.files.is_empty() && own_report.exists() {
        let mut page = turbid::input::read_text(&own_report, MOST_OF_A_REPORT)
            .with_context(|| format!("cannot read {}", own_report.display()))?;
        for Redrawn { stem, files, .. } in &redrawn {
            page = report::with_figure(&page, stem, &files.svg, &files.caption).unwrap_or(page);
        }
        Some(page)
    } else {
        None
    };

    let (mut written, mut changed) = (0, 0);
    for Redrawn { table, stem, files, latex } in &redrawn {
        let [svg, png, other_svg, other_png] = files.drawings(stem);
        let tex = (latex.0.clone(), latex.1.as_bytes());
        let is_other = |width: &str| files.other.name == width;
        let chosen = match what.width.map(|width| is_other(width.name())) {
            None => vec![svg, png, other_svg, other_png, tex],
            Some(false) => vec![svg, png, tex],
            Some(true) => vec![other_svg, other_png],
        };
        for (name, bytes) in chosen {
            written += 1;
            changed += usize::from(write_if_changed(&table.with_file_name(name), bytes)?);
        }
    }
    let mut said = format!("{} figures redrawn: {written} files, {changed} of them changed", redrawn.len());
    if let Some(page) = page {
        let is_new = write_if_changed(&own_report, page.as_bytes())?;
        let state = if is_new { "shows the new drawings" } else { "shows them already" };
        said.push_str(&format!("; {} {state}", own_report.display()));
    }
    Ok(format!("{said}."))
}

/// The tables of a study's figures, in order; of these experiments alone, unless `only` is empty.
fn tables(folder: &Path, only: &[String]) -> anyhow::Result<Vec<PathBuf>> {
    let entries = std::fs::read_dir(folder)
        .with_context(|| format!("no finished study: cannot read {}", folder.display()))?;
    let mut tables = Vec::new();
    for entry in entries {
        let path = entry.with_context(|| format!("cannot read {}", folder.display()))?.path();
        let is_chosen = |stem: &str| {
            only.is_empty()
                || only.iter().any(|name| stem.strip_prefix(name).is_some_and(|s| s.starts_with('-')))
        };
        let stem = path.file_stem().and_then(|s| s.to_str()).unwrap_or_default();
        // Names that begin with a point are files of other programs, not yet finished ones among them.
        if path.extension().is_some_and(|e| e == "csv") && !stem.starts_with('.') && is_chosen(stem) {
            tables.push(path);
        }
    }
    if tables.is_empty() {
        let of = if only.is_empty() { String::new() } else { format!(" of {}", only.join(", ")) };
        bail!("there is no figure{of} in {}; figures are kept there as NAME.csv", folder.display());
    }
    tables.sort();
    Ok(tables)
}

/// Larger reports are refused.
const MOST_OF_A_REPORT: u64 = 1 << 30;

/// Larger tables of a figure are refused.
const MOST_BYTES: u64 = 1 << 26;

/// Redraws a figure from its table and says how many bytes the drawings have; writes nothing.
pub(crate) fn try_redraw(table: &Path) -> anyhow::Result<usize> {
    let redrawn = redraw(table.to_path_buf())?;
    let drawings: usize = redrawn.files.drawings(&redrawn.stem).iter().map(|(_, bytes)| bytes.len()).sum();
    Ok(drawings + redrawn.latex.1.len())
}

fn redraw(table: PathBuf) -> anyhow::Result<Redrawn> {
    let place = table.display();
    let text =
        turbid::input::read_text(&table, MOST_BYTES).with_context(|| format!("cannot read {place}"))?;
    let stem = table.file_stem().and_then(|s| s.to_str()).unwrap_or("figure").to_string();
    let (figure, caption) = Figure::from_csv(&text).map_err(|e| match e {
        Error::Csv { .. } => anyhow::anyhow!("{place}:{e}"),
        other => anyhow::anyhow!("{place}: {other}"),
    })?;
    let files = FigureFiles::draw(&stem, &caption, &figure).with_context(|| place.to_string())?;
    let latex = files.latex(&stem).with_context(|| place.to_string())?;
    Ok(Redrawn { stem, files, latex, table: table.clone() })
}
