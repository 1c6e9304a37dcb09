//! A whole study: predictions, then measurements, then conclusions, then the report.

use super::group::Measure;
use super::lock;
use super::manifest::Manifest;
use super::measure::{Task, cell_path, measure};
use super::merge::{Expected, check_mergeable, collect};
use super::outputs::{
    AnswerRecord, Seconds, check_folder, keep_or_write, prediction_table, write_if_changed, write_results,
    write_rows,
};
use super::panics::caught;
use super::program::{on_threads, program};
use super::{
    CellId, Cells, Claim, Experiment, Outcome, Provenance, Question, Section, SectionReport, Settings,
    Terminal, Watch, judge, number, program_digest, replot,
};
use crate::prediction::Prediction;
use crate::report;
use anyhow::{Context, bail, ensure};
use std::collections::BTreeSet;
use std::process::ExitCode;
use std::sync::Arc;
use std::time::Instant;
use turbid::memory::{free, in_words};
use turbid::output::{print, write_atomically, write_csv};
use turbid::photons::Photon;

/// What is studied, by which program.
#[derive(Debug, Clone)]
pub struct Study<'a> {
    /// Name of the study and of its binary.
    pub name: &'a str,
    /// Its experiments, in the order of the report.
    pub experiments: &'a [Experiment],
    /// What is said of all of them together, in the order of the report.
    pub closings: &'a [Closing],
    /// Digest of the program: cells of another are not reused.
    pub program: String,
}

/// A section made of all others after the last of them has concluded: it measures nothing of its own.
#[derive(Debug, Clone, Copy)]
pub struct Closing {
    /// File-safe name, that of the module.
    pub name: &'static str,
    /// Heading of its section.
    pub title: &'static str,
    /// What is asked, one or two sentences.
    pub question: &'static str,
    /// What the sections together say, a function of its arguments alone. Its claims are judged with all others. It stands
    /// before the experiments in the report, or last if it has neither claims nor figures.
    pub conclude: fn(&Settings, &[SectionReport]) -> anyhow::Result<Section>,
}

impl Closing {
    /// The section with the heading of an experiment that has no cells.
    fn report(&self, settings: &Settings, sections: &[SectionReport]) -> SectionReport {
        let heading = Experiment {
            name: self.name,
            title: self.title,
            question: self.question,
            groups: |_| Vec::new(),
            predict: |_| Ok(Vec::new()),
            conclude: |_, _, _| Ok(Section::default()),
        };
        let concluded = whole(|| (self.conclude)(settings, sections)).and_then(with_claims_apart);
        let (section, failure) = match concluded {
            Ok(section) => (section, None),
            Err(error) => {
                let failure = format!("{error:#}");
                (Section::without_conclusion(&failure), Some(failure))
            }
        };
        SectionReport {
            experiment: heading,
            predictions: Vec::new(),
            section,
            judged: Vec::new(),
            counters: Vec::new(),
            cells: (0, 0.0),
            failure,
        }
    }
}

/// The experiment that a file of the user's is put to.
#[derive(Clone, Copy)]
pub struct Asked {
    /// The experiment.
    pub experiment: Experiment,
    /// Refuses a file that cannot be studied, in one line.
    pub check: fn(&Settings) -> anyhow::Result<()>,
    /// What the study will take, in words.
    pub dry_run: fn(&Settings) -> anyhow::Result<String>,
}

/// What a file of the user's comes to.
pub enum Findings {
    /// What the study will take, in words: a dry run.
    Forecast(String),
    /// What was measured, and what follows unless it was a part.
    Outcome(Outcome),
}

impl Asked {
    /// Puts the experiment to a file of the user's.
    ///
    /// # Arguments
    /// `name` of the study; `program` digest of the program: cells of another are not reused
    ///
    /// # Errors
    /// A file that cannot be studied, before anything is written; those of [`run`]; an experiment without a conclusion
    pub fn study(
        &self,
        name: &str,
        question: Question,
        settings: &Settings,
        program: String,
        watch: &dyn Watch,
    ) -> anyhow::Result<Findings> {
        let path = question.path.clone();
        let settings = &Settings {
            question_file: Some(path.clone()),
            question: Some(Arc::new(question)),
            ..settings.clone()
        };
        on_threads(None, || (self.check)(settings))?;
        if settings.dry_run {
            return on_threads(None, || (self.dry_run)(settings)).map(Findings::Forecast);
        }
        let study = Study { name, experiments: &[self.experiment], closings: &[], program };
        run_watched(&study, settings, watch)
            .map(Findings::Outcome)
            .with_context(|| path.display().to_string())
    }
}

/// The main function of an experiment's binary: arguments, study, summary, exit code.
pub fn main(name: &'static str, experiments: &[Experiment]) -> ExitCode {
    main_with(name, experiments, &[], None)
}

/// The same with closing sections, and with an experiment that files of the user's are put to.
pub fn main_with(
    name: &'static str,
    experiments: &[Experiment],
    closings: &[Closing],
    asked: Option<Asked>,
) -> ExitCode {
    let kept = |settings: &Settings| {
        let cells = settings.out.join("cells");
        format!("finished cells are kept in {}, and the same command goes on from there", cells.display())
    };
    program(
        name,
        || Settings::parse(name, std::env::args_os()),
        kept,
        |settings| {
            if let Some(what) = &settings.replot {
                let said = replot(settings, what)?;
                print(|out| writeln!(out, "{said}"))?;
                return Ok(0);
            }
            let program = program_digest()?.to_string();
            let outcome = match &settings.question_file {
                None => run(&Study { name, experiments, closings, program }, settings)?,
                Some(file) => {
                    let asked = asked.with_context(|| {
                        format!(
                            "{}: {name} is one experiment; allowed: study {}",
                            file.display(),
                            file.display()
                        )
                    })?;
                    let question = Question::read(file)?;
                    match asked.study(name, question, settings, program, &Terminal::default())? {
                        Findings::Forecast(text) => {
                            print(|out| out.write_all(text.as_bytes()))?;
                            return Ok(0);
                        }
                        Findings::Outcome(outcome) => outcome,
                    }
                }
            };
            if let Some(part) = settings.part {
                let (measured, folder) = (outcome.measured, settings.out.display());
                print(|out| {
                    writeln!(
                        out,
                        "part {}: {measured} cells measured in {folder}; --merge with the folders of all parts concludes",
                        part.words()
                    )
                })?;
                return Ok(0);
            }
            print(|out| out.write_all(report::summary(&outcome).as_bytes()))?;
            Ok(if settings.strict { outcome.strict_code() } else { 0 })
        },
    )
}

/// Runs a study, or what is left of it, and writes its report. An experiment that fails anywhere says so in its section;
/// the others and the report stand.
///
/// # Errors
/// A folder that is another study's or cannot be written, an experiment that is not there; finished cells stay, and the next
/// run goes on from there.
pub fn run(study: &Study, settings: &Settings) -> anyhow::Result<Outcome> {
    run_watched(study, settings, &Terminal::default())
}

/// The same under the eyes of someone who may end it.
///
/// # Errors
/// Those of [`run`]; `turbid::Error::Cancelled` if it was ended
pub fn run_watched(study: &Study, settings: &Settings, watch: &dyn Watch) -> anyhow::Result<Outcome> {
    let experiments = selected(study.experiments, &settings.only)?;
    // Before a folder of its own is made.
    settings.merge.iter().try_for_each(|folder| check_mergeable(folder))?;
    let is_new = !settings.out.exists();
    let _held = lock::hold(&settings.out, settings.part, watch)?;
    let outcome = run_held(study, &experiments, settings, watch);
    if outcome.is_err() && is_new && !settings.merge.is_empty() {
        // It holds copies alone. What was wrong is said already.
        let _ = std::fs::remove_dir_all(&settings.out);
    }
    outcome
}

fn run_held(
    study: &Study,
    experiments: &[Experiment],
    settings: &Settings,
    watch: &dyn Watch,
) -> anyhow::Result<Outcome> {
    let planned: Vec<anyhow::Result<Vec<(CellId, Measure)>>> =
        experiments.iter().map(|experiment| whole(|| plan(experiment, settings))).collect();
    check_memory(planned.iter().flatten().flatten().map(|(cell, _)| cell.held).max().unwrap_or(0), settings)?;
    check_folder(
        &settings.out,
        &[
            "report.html",
            "results.csv",
            "claims.csv",
            "answers.csv",
            "headlines.csv",
            "numbers.tex",
            "timing.csv",
            "provenance.json",
        ],
    )?;
    check_folder(&settings.out.join("figures"), &["figure.svg"])?;
    let cells_folder = settings.out.join("cells");
    let manifest = Manifest::new(settings, &study.program);
    manifest.prepare(&cells_folder, settings, watch)?;

    if !settings.merge.is_empty() {
        let planned = experiments.iter().zip(&planned);
        let expected: Vec<Expected> = planned
            .filter_map(|(experiment, cells)| {
                let cells = cells.as_ref().ok()?.iter().map(|(cell, _)| cell).collect();
                Some(Expected { experiment, cells })
            })
            .collect();
        collect(&settings.merge, &cells_folder, &expected, &manifest, settings)?;
    }
    let mut sets: Vec<Vec<CellId>> = Vec::new();
    let mut tasks = Vec::new();
    // Cells are dealt out to parts by their place among all.
    let mut place = 0;
    let mut predictions = Vec::new();
    let mut failures = Vec::new();
    let mut late_predictions = false;
    for (experiment, cells) in experiments.iter().zip(planned) {
        let folder = cells_folder.join(experiment.name);
        std::fs::create_dir_all(&folder).with_context(|| format!("cannot create {}", folder.display()))?;
        let predicted = cells.and_then(|cells| Ok((cells, whole(|| predict(experiment, settings))?)));
        let (cells, own, failure) = match predicted {
            Ok((cells, own)) => (cells, own, None),
            // What has no predictions is not measured.
            Err(error) => (Vec::new(), Vec::new(), Some(format!("{error:#}"))),
        };
        let before = tasks.len();
        for (cell, measure) in &cells {
            let path = cell_path(&cells_folder, experiment, cell);
            let is_own = settings.part.is_none_or(|part| part.has(place));
            place += 1;
            if is_own && !manifest.accepts(&path, experiment.name, &cell.id(), settings) {
                tasks.push(Task { experiment, cell: cell.clone(), measure: measure.clone(), path });
            }
        }
        let table = prediction_table(&[*experiment], std::slice::from_ref(&own))?;
        let changed = write_if_changed(&folder.join("predictions.csv"), &table)?;
        late_predictions |= changed && tasks.len() - before < cells.len();
        sets.push(cells.into_iter().map(|(cell, _)| cell).collect());
        failures.push(failure);
        predictions.push(own);
    }
    let (total, missing) = (sets.iter().map(Vec::len).sum(), tasks.len());
    if !settings.merge.is_empty() && missing > 0 {
        let names: Vec<String> =
            tasks.iter().take(3).map(|t| format!("{}/{}", t.experiment.name, t.cell.id())).collect();
        bail!(
            "{missing} of {total} cells are in none of the merged folders, such as {}; allowed: the folders of all parts",
            names.join(", ")
        );
    }
    let predicted = prediction_table(experiments, &predictions)?;
    let write_predicted = || write_if_changed(&settings.out.join("predictions.csv"), &predicted);
    // Those of a question stand beside its cells until it is answered: what was concluded before stays whole if it is not.
    if settings.question.is_none() {
        write_predicted()?;
    }
    watch.say(&opening(study.name, settings, total, missing, predictions.iter().map(Vec::len).sum()));
    let start = Instant::now();
    let done = measure(tasks, &manifest, settings, watch)?;
    let wall_seconds = start.elapsed().as_secs_f64();
    if settings.part.is_some() {
        if let Some((experiment, failure)) = done.failures.iter().next() {
            bail!("{experiment}: {failure}");
        }
        return Ok(Outcome { report: settings.out.clone(), sections: Vec::new(), measured: done.measured });
    }

    let mut sections = Vec::new();
    let mut seconds = Vec::new();
    let mut foreign = 0;
    for (((experiment, cells), predictions), failure) in
        experiments.iter().zip(&sets).zip(predictions).zip(failures)
    {
        let folder = cells_folder.join(experiment.name);
        let failure = failure.or_else(|| done.failures.get(experiment.name).cloned());
        let read = match failure {
            Some(failure) => Err(failure),
            None => Cells::read(&folder, experiment.name, cells, settings).map_err(|e| format!("{e:#}")),
        };
        let (concluded, cells) = match read {
            Ok(cells) => {
                let section = whole(|| (experiment.conclude)(settings, &predictions, &cells));
                (section.and_then(with_claims_apart).map_err(|error| format!("{error:#}")), cells)
            }
            Err(failure) => (Err(failure), Cells::default()),
        };
        let (mut section, failure) = match concluded {
            Ok(section) => (section, None),
            // A question is one experiment: what was concluded before stays, rather than a report that says nothing.
            Err(failure) if settings.question.is_some() => bail!("{failure}"),
            Err(failure) => (Section::without_conclusion(&failure), Some(failure)),
        };
        section.rows = section.rows.into_iter().map(|row| row.predicted_from(&predictions)).collect();
        foreign += cells.programs.iter().filter(|p| **p != study.program).count();
        let own_seconds: f64 = cells.seconds.iter().map(|s| s.total).sum();
        let counters = cells.counters().iter().map(|(name, count)| (name.clone(), *count)).collect();
        seconds.extend(cells.seconds.iter().map(|cell| (experiment.name, cell.clone())));
        let cells = (cells.ids().len(), own_seconds);
        sections.push(SectionReport {
            experiment: *experiment,
            predictions,
            section,
            judged: Vec::new(),
            counters,
            cells,
            failure,
        });
    }
    let closed = study.closings.iter().map(|closing| closing.report(settings, &sections));
    let (first, last): (Vec<_>, Vec<_>) =
        closed.partition(|own| !own.section.claims.is_empty() || !own.section.figures.is_empty());
    let mut sections: Vec<SectionReport> = first.into_iter().chain(sections).chain(last).collect();
    judge_all(&mut sections, settings.seed);

    let mut provenance = Provenance::now(study.name, settings, &study.program);
    provenance.cells = total;
    provenance.measured = done.measured;
    provenance.foreign = foreign;
    provenance.cpu_seconds = seconds.iter().map(|(_, cell)| cell.total).sum();
    provenance.wall_seconds = wall_seconds;
    provenance.late_predictions = late_predictions;
    let provenance = keep_or_write(&settings.out.join("provenance.json"), provenance)?;

    write_predicted()?;
    write_results(&settings.out, &sections)?;
    let timing: Vec<Seconds> =
        seconds.iter().flat_map(|(experiment, cell)| Seconds::of_cell(experiment, cell)).collect();
    write_atomically(settings.out.join("timing.csv"), |out| write_csv(out, &timing))?;
    let answers: Vec<AnswerRecord> =
        sections.iter().flat_map(|s| &s.section.answers).flat_map(AnswerRecord::of_answer).collect();
    write_atomically(settings.out.join("answers.csv"), |out| write_rows(out, &answers))?;
    let page = report::page(study.name, settings, &sections, &provenance);
    let path = settings.out.join("report.html");
    write_atomically(&path, |out| out.write_all(page.as_bytes()))?;
    Ok(Outcome { report: path, sections, measured: done.measured })
}

/// What a part of an experiment makes; a panic in it is an error.
fn whole<T>(part: impl FnOnce() -> anyhow::Result<T>) -> anyhow::Result<T> {
    caught(part).unwrap_or_else(|panic| bail!(panic))
}

fn selected(all: &[Experiment], only: &[String]) -> anyhow::Result<Vec<Experiment>> {
    for name in only {
        if !all.iter().any(|e| e.name == name) {
            let names: Vec<&str> = all.iter().map(|e| e.name).collect();
            bail!("there is no experiment {name}; there are: {}", names.join(", "));
        }
    }
    Ok(all.iter().filter(|e| only.is_empty() || only.iter().any(|name| name == e.name)).copied().collect())
}

/// The cells of an experiment, with names of their own.
fn plan(experiment: &Experiment, settings: &Settings) -> anyhow::Result<Vec<(CellId, Measure)>> {
    let mut cells = Vec::new();
    let (mut seen, mut streams) = (BTreeSet::new(), BTreeSet::new());
    for group in (experiment.groups)(settings) {
        for cell in group.cells() {
            let name = experiment.name;
            ensure!(cell.is_file_safe(), "{name}: the group {:?} is no name for a file", cell.group);
            ensure!(
                seen.insert(cell.id()),
                "{name}: two cells are called {}: at this --photons two numbers of photons are one",
                cell.id()
            );
            ensure!(
                streams.insert((cell.stream.clone(), cell.replicate)),
                "{name}: {} draws the random numbers of another group, {}",
                cell.id(),
                cell.stream
            );
            cells.push((cell, group.measure.clone()));
        }
    }
    Ok(cells)
}

/// Refuses a map of so many photons if not even the photons fit into the memory that is free: a tree takes more.
fn check_memory(photons: u64, settings: &Settings) -> anyhow::Result<()> {
    let Some(free) = free() else { return Ok(()) };
    let takes = photons as f64 * size_of::<Photon>() as f64;
    ensure!(
        takes <= free,
        "a map of {photons} photons takes {} of memory at least, {} are free; allowed: --photons below {}",
        in_words(takes),
        in_words(free),
        number(settings.photon_scale * free / takes)
    );
    Ok(())
}

fn predict(experiment: &Experiment, settings: &Settings) -> anyhow::Result<Vec<Prediction>> {
    let predictions =
        (experiment.predict)(settings).with_context(|| format!("predictions of {}", experiment.name))?;
    for p in &predictions {
        let is_number = p.value.is_finite() && p.error.is_finite();
        ensure!(
            is_number,
            "{}: the prediction of {} of {} is not finite",
            experiment.name,
            p.quantity,
            p.case
        );
    }
    Ok(predictions)
}

fn opening(study: &str, settings: &Settings, total: usize, missing: usize, predictions: usize) -> String {
    let start = format!("{study} ({}): {predictions} predictions written", settings.words());
    match missing {
        0 => format!("{start}, all {total} cells are there."),
        _ if missing == total => format!("{start}, measuring {total} cells on {} threads.", settings.threads),
        _ => format!("{start}, measuring {missing} of {total} cells on {} threads.", settings.threads),
    }
}

/// A section whose claims and headline numbers have names of their own.
fn with_claims_apart(section: Section) -> anyhow::Result<Section> {
    let mut seen = BTreeSet::new();
    for claim in &section.claims {
        ensure!(seen.insert(claim.id.as_str()), "two claims have the same name, {}", claim.id);
    }
    let mut seen = BTreeSet::new();
    for headline in &section.headlines {
        let name = &headline.name;
        ensure!(headline.has_a_name(), "the headline number {name:?} is not called by letters alone");
        ensure!(seen.insert(name), "two headline numbers have the same name, {name}");
    }
    Ok(section)
}

/// Judges the claims of all sections together and gives each section its own back.
fn judge_all(sections: &mut [SectionReport], seed: u64) {
    let mut all: Vec<Claim> = Vec::new();
    let mut counts = Vec::new();
    for part in sections.iter_mut() {
        let claims = std::mem::take(&mut part.section.claims);
        counts.push(claims.len());
        all.extend(claims);
    }
    let mut judged = judge(all, seed).into_iter();
    for (part, count) in sections.iter_mut().zip(counts) {
        part.judged = judged.by_ref().take(count).collect();
    }
}
