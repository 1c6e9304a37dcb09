//! The files that a study leaves beside its report.

use super::cells::CellSeconds;
use super::headline;
use super::results::Record;
use super::{
    Answer, Estimate, Experiment, Headline, Judged, Provenance, Reached, SectionReport, TARGETS, Unit,
};
use crate::prediction::Prediction;
use anyhow::{Context, anyhow, ensure};
use serde::Serialize;
use std::io::{self, ErrorKind};
use std::path::Path;
use turbid::output::{check_writable, write_atomically, write_csv, write_json};

/// The phase of timing.csv that is the whole cell.
const WHOLE: &str = "all";

/// A row of timing.csv.
#[derive(Serialize)]
pub(super) struct Seconds<'a> {
    experiment: &'static str,
    cell: &'a str,
    phase: &'a str,
    cpu_seconds: f64,
}

impl<'a> Seconds<'a> {
    /// The rows of one cell: the whole of it, then the phases that it timed.
    pub(super) fn of_cell(experiment: &'static str, cell: &'a CellSeconds) -> Vec<Self> {
        let row = |phase: &'a str, cpu_seconds| Seconds { experiment, cell: &cell.cell, phase, cpu_seconds };
        let phases = cell.phases.iter().map(|(phase, &seconds)| row(phase, seconds));
        std::iter::once(row(WHOLE, cell.total)).chain(phases).collect()
    }
}

/// A row of answers.csv: the cheapest map that reaches an error in a scene, if there is one. CPU time is of this machine.
#[derive(Default, Serialize)]
pub(super) struct AnswerRecord<'a> {
    scene: &'a str,
    target_error: f64,
    speed_in_time: Option<f64>,
    error_in_time: Option<f64>,
    speed_in_work: Option<f64>,
    error_in_work: Option<f64>,
    pays_from_queries: Option<f64>,
    error_of_queries: Option<f64>,
    bias: Option<f64>,
    error_of_bias: Option<f64>,
    limit: &'a str,
}

impl<'a> AnswerRecord<'a> {
    /// The rows of one scene.
    pub(super) fn of_answer(answer: &'a Answer) -> Vec<Self> {
        let row = |(target, reached): (f64, &'a Option<Reached>)| {
            let reached = reached.as_ref();
            let value = |of: fn(&Reached) -> &Estimate| reached.map(|r| of(r).value());
            let error = |of: fn(&Reached) -> &Estimate| reached.map(|r| of(r).std_error());
            let queries = reached.and_then(|r| r.pays_from.as_ref());
            AnswerRecord {
                scene: &answer.scene,
                target_error: target,
                speed_in_time: value(|r| &r.time),
                error_in_time: error(|r| &r.time),
                speed_in_work: value(|r| &r.work),
                error_in_work: error(|r| &r.work),
                pays_from_queries: queries.map(Estimate::value),
                error_of_queries: queries.map(Estimate::std_error),
                bias: value(|r| &r.bias),
                error_of_bias: error(|r| &r.bias),
                limit: reached.map_or("", |r| r.limit),
            }
        };
        TARGETS.into_iter().zip(&answer.reached).map(row).collect()
    }
}

/// A row of predictions.csv.
#[derive(Serialize)]
struct PredictionRecord<'a> {
    experiment: &'a str,
    case: &'a str,
    quantity: &'a str,
    unit: Unit,
    predicted: f64,
    error: f64,
    source: &'a str,
}

/// The table of predictions.
pub(super) fn prediction_table(
    experiments: &[Experiment],
    predictions: &[Vec<Prediction>],
) -> anyhow::Result<Vec<u8>> {
    let mut records = Vec::new();
    for (experiment, list) in experiments.iter().zip(predictions) {
        for Prediction { case, quantity, unit, value, error, source } in list {
            let experiment = experiment.name;
            records.push(PredictionRecord {
                experiment,
                case,
                quantity,
                unit: *unit,
                predicted: *value,
                error: *error,
                source,
            });
        }
    }
    let mut bytes = Vec::new();
    write_csv(&mut bytes, &records)?;
    Ok(bytes)
}

/// The bytes of a file of at most `most` bytes; nothing if there is none.
///
/// # Errors
/// A file that cannot be read, is too large, or is none: what is a pipe or a device is not waited for
pub(crate) fn read_if_there(path: &Path, most: u64) -> anyhow::Result<Option<Vec<u8>>> {
    match turbid::input::read(path, most) {
        Ok(bytes) => Ok(Some(bytes)),
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(None),
        Err(error) => Err(error).with_context(|| format!("cannot read {}", path.display())),
    }
}

/// Refuses to write to what is there and no file: to open a pipe that nobody reads from would wait for ever.
pub(super) fn check_plain(path: &Path) -> anyhow::Result<()> {
    let is_plain = std::fs::metadata(path).map_or(true, |about| about.is_file());
    ensure!(is_plain, "cannot write {}: a folder, a device or a pipe; allowed: a file", path.display());
    Ok(())
}

/// Makes a folder, and tries before the work whether these files of it could be written.
///
/// # Errors
/// The folder that cannot be made, or the first file that cannot be written
pub(crate) fn check_folder(folder: &Path, files: &[&str]) -> anyhow::Result<()> {
    std::fs::create_dir_all(folder).with_context(|| format!("cannot create {}", folder.display()))?;
    for path in files.iter().map(|name| folder.join(name)) {
        check_plain(&path)?;
        check_writable(path)?;
    }
    Ok(())
}

/// Tries before the work whether files could be written to a folder, which need not be there yet; makes nothing.
///
/// # Errors
/// The file that cannot be written, or the folder in which the next one cannot be made
pub(crate) fn check_later(folder: &Path) -> anyhow::Result<()> {
    let there = folder.ancestors().find(|above| above.as_os_str().is_empty() || above.exists());
    let there = there.filter(|above| !above.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let file = there.join("file");
    check_writable(file).map_err(|error| anyhow!("cannot write to {}: {}", folder.display(), error.cause))
}

/// Files of notes that a study leaves for the next run are no larger.
pub(super) const MOST_NOTES: u64 = 1 << 20;

/// Writes a file unless it already holds these bytes, so that its date says when they were made. Tells whether it
/// was written.
pub(super) fn write_if_changed(path: &Path, bytes: &[u8]) -> anyhow::Result<bool> {
    check_plain(path)?;
    if let Ok(about) = std::fs::metadata(path) {
        let is_same = about.len() == bytes.len() as u64
            && turbid::input::read(path, about.len()).is_ok_and(|old| old == bytes);
        if is_same {
            return Ok(false);
        }
    }
    write_atomically(path, |out| out.write_all(bytes))?;
    Ok(true)
}

/// A run that measured nothing keeps the record of the run that did; late predictions stay on record until every
/// cell is measured anew.
pub(super) fn keep_or_write(path: &Path, mut new: Provenance) -> anyhow::Result<Provenance> {
    let old =
        read_if_there(path, MOST_NOTES)?.and_then(|bytes| serde_json::from_slice::<Provenance>(&bytes).ok());
    if let Some(old) = old {
        let is_same = old.format == new.format
            && old.command == new.command
            && old.program == new.program
            && old.cells == new.cells;
        if is_same && new.measured == 0 && !new.late_predictions {
            return Ok(old);
        }
        new.late_predictions |= old.late_predictions && new.measured < new.cells;
    }
    write_atomically(path, |out| write_json(out, &new))?;
    Ok(new)
}

/// Rows as CSV; the header alone where there are none.
pub(super) fn write_rows<T: Serialize + Default>(out: &mut dyn io::Write, rows: &[T]) -> io::Result<()> {
    if !rows.is_empty() {
        return write_csv(out, rows);
    }
    let mut blank = Vec::new();
    write_csv(&mut blank, [T::default()])?;
    out.write_all(blank.split_inclusive(|byte| *byte == b'\n').next().unwrap_or_default())
}

/// results.csv, claims.csv, the headline numbers and the figures: functions of settings and seed alone.
pub(super) fn write_results(out: &Path, sections: &[SectionReport]) -> anyhow::Result<()> {
    let rows: Vec<Record> = sections
        .iter()
        .flat_map(|s| s.section.rows.iter().map(|row| Record::new(s.experiment.name, row)))
        .collect();
    write_atomically(out.join("results.csv"), |file| write_rows(file, &rows))?;
    for (name, text) in sections.iter().flat_map(|s| &s.section.files) {
        write_atomically(out.join(name), |file| file.write_all(text.as_bytes()))?;
    }
    let claims: Vec<ClaimRecord> = sections
        .iter()
        .flat_map(|s| s.judged.iter().map(|judged| ClaimRecord::new(s.experiment.name, judged)))
        .collect();
    write_atomically(out.join("claims.csv"), |file| write_rows(file, &claims))?;
    let headlines: Vec<_> = sections.iter().flat_map(headlines).collect();
    write_atomically(out.join("headlines.csv"), |file| write_rows(file, &headline::records(&headlines)))?;
    let commands = headline::commands(&headlines);
    write_atomically(out.join("numbers.tex"), |file| file.write_all(commands.as_bytes()))?;
    let folder = out.join("figures");
    std::fs::create_dir_all(&folder).with_context(|| format!("cannot create {}", folder.display()))?;
    for part in sections {
        for figure in &part.section.figures {
            let stem = format!("{}-{}", part.experiment.name, figure.name);
            for (name, bytes) in figure.drawings(&stem) {
                write_if_changed(&folder.join(name), bytes)?;
            }
            write_if_changed(&folder.join(format!("{stem}.csv")), figure.csv.as_bytes())?;
            let (name, text) = figure.latex(&stem)?;
            write_if_changed(&folder.join(name), text.as_bytes())?;
        }
    }
    Ok(())
}

/// The headline numbers of a section, each with its experiment and its name in the study.
fn headlines(part: &SectionReport) -> impl Iterator<Item = (&'static str, String, &Headline)> {
    let experiment = part.experiment.name;
    part.section.headlines.iter().map(move |h| (experiment, headline::whole_name(experiment, h), h))
}

/// A row of claims.csv.
#[derive(Default, Serialize)]
struct ClaimRecord<'a> {
    experiment: &'a str,
    claim: &'a str,
    unit: Unit,
    maps: Option<u64>,
    statistic: f64,
    std_error: f64,
    interval_low: f64,
    interval_high: f64,
    margin: String,
    half_margin_in_errors: Option<f64>,
    chosen_after: String,
    p: f64,
    p_holm: f64,
    verdict: &'static str,
    text: &'a str,
}

impl<'a> ClaimRecord<'a> {
    fn new(experiment: &'a str, judged: &'a Judged) -> Self {
        ClaimRecord {
            experiment,
            claim: &judged.claim.id,
            unit: judged.claim.unit,
            maps: judged.claim.statistic.maps(),
            statistic: judged.claim.statistic.value(),
            std_error: judged.claim.statistic.std_error(),
            interval_low: judged.interval.low,
            interval_high: judged.interval.high,
            margin: judged.claim.margin(),
            half_margin_in_errors: judged.claim.sharpness(),
            chosen_after: judged.claim.basis.words(),
            p: judged.p,
            p_holm: judged.adjusted,
            verdict: judged.verdict.word(),
            text: &judged.claim.text,
        }
    }
}
