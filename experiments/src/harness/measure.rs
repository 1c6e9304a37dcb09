//! Measures the cells that are missing, in parallel.

use super::cell::{self, CellOutput, FORMAT, Header};
use super::manifest::Manifest;
use super::progress::Progress;
use super::{CellId, Experiment, Settings};
use anyhow::{Context, anyhow};
use cpu_time::ThreadTime;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

/// One cell to be measured.
pub(super) struct Task<'a> {
    pub experiment: &'a Experiment,
    pub cell: CellId,
    pub path: PathBuf,
}

/// The file of a cell.
pub(super) fn cell_path(cells: &Path, experiment: &Experiment, cell: &CellId) -> PathBuf {
    cells.join(experiment.name).join(format!("{}.csv", cell.id()))
}

/// Measures all tasks on `settings.threads` threads, the largest first. After an error no further cell is begun;
/// cells in work are finished and kept.
pub(super) fn measure(mut tasks: Vec<Task>, manifest: &Manifest, settings: &Settings) -> anyhow::Result<()> {
    if tasks.is_empty() {
        return Ok(());
    }
    tasks.sort_by(|a, b| b.cell.cost.total_cmp(&a.cell.cost));
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(settings.threads)
        .build()
        .context("cannot start threads")?;
    let progress = Progress::new(tasks.len(), tasks.iter().map(|t| t.cell.cost).sum());
    let next = AtomicUsize::new(0);
    let failure: Mutex<Option<anyhow::Error>> = Mutex::new(None);
    pool.broadcast(|_| {
        while let Some(task) = tasks.get(next.fetch_add(1, Ordering::Relaxed)) {
            match measure_one(task, manifest, settings) {
                Ok(()) => progress.advance(task.cell.cost),
                Err(error) => {
                    next.store(tasks.len(), Ordering::Relaxed);
                    if let Ok(mut failure) = failure.lock() {
                        failure.get_or_insert(error);
                    }
                    return;
                }
            }
        }
    });
    progress.finish();
    match failure.into_inner() {
        Ok(Some(error)) => Err(error),
        _ => Ok(()),
    }
}

fn measure_one(task: &Task, manifest: &Manifest, settings: &Settings) -> anyhow::Result<()> {
    let name = || format!("cell {} of {}", task.cell.id(), task.experiment.name);
    let start = ThreadTime::now();
    let output = catch_unwind(AssertUnwindSafe(|| (task.experiment.measure)(settings, &task.cell)))
        .unwrap_or_else(|_| Err(anyhow!("it panicked")))
        .with_context(name)?;
    let CellOutput { rows, counters, seconds, non_finite } = output;
    // A value that is not finite is counted, however the rows were made.
    let non_finite = non_finite.max(rows.iter().filter(|row| !row.value.is_finite()).count() as u64);
    let header = Header {
        format: FORMAT,
        experiment: task.experiment.name.to_string(),
        id: task.cell.id(),
        settings: manifest.settings.clone(),
        program: manifest.program.clone(),
        cpu_seconds: start.elapsed().as_secs_f64(),
        phases: seconds,
        non_finite,
        counters,
    };
    cell::write(&task.path, &header, &rows).with_context(name)
}
