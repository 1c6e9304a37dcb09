//! Measures the cells that are missing, in parallel.

use super::cell::{self, CellOutput, FORMAT, Header};
use super::group::Measure;
use super::manifest::Manifest;
use super::panics::caught;
use super::{CellId, Experiment, Settings, Watch};
use anyhow::{Context, anyhow};
use cpu_time::ThreadTime;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

/// One cell to be measured.
pub(super) struct Task<'a> {
    pub experiment: &'a Experiment,
    pub cell: CellId,
    pub measure: Measure,
    pub path: PathBuf,
}

/// The file of a cell.
pub(super) fn cell_path(cells: &Path, experiment: &Experiment, cell: &CellId) -> PathBuf {
    cells.join(experiment.name).join(format!("{}.csv", cell.id()))
}

/// What became of the tasks.
#[derive(Debug, Default)]
pub(super) struct Done {
    /// How many cells were measured and kept.
    pub measured: usize,
    /// Why an experiment is without some of its cells: the first of its failures, by its name.
    pub failures: BTreeMap<&'static str, String>,
}

/// Why a cell is not there.
enum Failure {
    /// The experiment failed.
    Measured(anyhow::Error),
    /// Its file could not be written, nor could others.
    Written(anyhow::Error),
}

/// Measures all tasks on `settings.threads` threads, the largest first. After a failure no further cell of that experiment
/// is begun; cells in work are finished and kept.
///
/// # Errors
/// If a cell cannot be written; `turbid::Error::Cancelled` if the watch says so
pub(super) fn measure(
    mut tasks: Vec<Task>,
    manifest: &Manifest,
    settings: &Settings,
    watch: &dyn Watch,
) -> anyhow::Result<Done> {
    if tasks.is_empty() {
        return Ok(Done::default());
    }
    tasks.sort_by(|a, b| b.cell.cost.total_cmp(&a.cell.cost));
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(settings.threads)
        .build()
        .context("cannot start threads")?;
    let total: f64 = tasks.iter().map(|t| t.cell.cost).sum();
    let advance = |task: &Task| watch.advance(if total > 0.0 { task.cell.cost / total } else { 0.0 });
    watch.begin(tasks.len());
    let next = AtomicUsize::new(0);
    let done = Mutex::new((Done::default(), None));
    let lost = || anyhow!("a thread that measures failed");
    pool.broadcast(|_| {
        while let Some(task) = tasks.get(next.fetch_add(1, Ordering::Relaxed)) {
            if watch.is_cancelled() {
                let Ok(mut done) = done.lock() else { return };
                done.1.get_or_insert_with(|| turbid::Error::Cancelled.into());
                return;
            }
            let name = task.experiment.name;
            if done.lock().is_ok_and(|done| done.0.failures.contains_key(name)) {
                advance(task);
                continue;
            }
            let outcome = measure_one(task, manifest, settings);
            advance(task);
            let Ok(mut done) = done.lock() else { return };
            match outcome {
                Ok(()) => done.0.measured += 1,
                Err(Failure::Measured(error)) => {
                    done.0.failures.entry(name).or_insert_with(|| format!("{error:#}"));
                }
                Err(Failure::Written(error)) => {
                    next.store(tasks.len(), Ordering::Relaxed);
                    done.1.get_or_insert(error);
                }
            }
        }
    });
    watch.finish();
    match done.into_inner().map_err(|_| lost())? {
        (_, Some(error)) => Err(error),
        (done, None) => Ok(done),
    }
}

fn measure_one(task: &Task, manifest: &Manifest, settings: &Settings) -> Result<(), Failure> {
    let name = || format!("cell {} of {}", task.cell.id(), task.experiment.name);
    let start = ThreadTime::now();
    let output = caught(|| (task.measure)(settings, &task.cell))
        .unwrap_or_else(|panic| Err(anyhow!(panic)))
        .with_context(name)
        .map_err(Failure::Measured)?;
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
    cell::write(&task.path, &header, &rows).with_context(name).map_err(Failure::Written)
}
