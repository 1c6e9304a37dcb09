//! Studies that a user's file asks, as the program `study` makes them.

use crate::error::refuse;
use crate::scene::{is_text, table};
use crate::work::{self, Watch};
use anyhow::Context;
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyString};
use std::path::{Path, PathBuf};
use turbid::output::write_atomically;
use turbid::transport::Progress;
use turbid_experiments::harness::{self, Digest, Findings, Question, Settings, Share};
use turbid_experiments::own_study;

/// The file of a study that was given as a text or a dict: it is in the folder of what was found, and until then nowhere.
const FILE: &str = "study.toml";

/// Steps of the progress: parts of the cost of all cells.
const STEPS: f64 = 1e6;

/// What Python asks for; its side has the defaults.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
struct Options {
    out: PathBuf,
    seed: u64,
    photons: f64,
    threads: Option<u16>,
    part: Option<String>,
    merge: Vec<PathBuf>,
    dry_run: bool,
    /// The file of this module.
    program: PathBuf,
}

/// A study as it was given.
enum Given {
    File(PathBuf),
    Text(String),
}

impl Given {
    fn read(study: &Bound<'_, PyAny>) -> PyResult<Self> {
        if let Ok(dict) = study.cast::<PyDict>() {
            let text = toml::to_string(&table(dict, 0)?).map_err(|error| refuse(error.to_string()))?;
            return Ok(Given::Text(text));
        }
        if let Ok(word) = study.cast::<PyString>().map(|word| word.to_string())
            && is_text(&word)
        {
            return Ok(Given::Text(word));
        }
        let path = study.extract();
        path.map(Given::File)
            .map_err(|_| PyTypeError::new_err("a study is a dict, TOML text, or the path of a study file"))
    }

    /// Files that a text names are looked for in the current folder.
    fn question(&self) -> anyhow::Result<Question> {
        match self {
            Given::File(path) => Question::read(path),
            Given::Text(text) => Question::of(Path::new(FILE), text.clone()),
        }
    }
}

impl harness::Watch for Watch {
    fn say(&self, _: &str) {}

    fn begin(&self, _: usize) {
        self.stage("cells", STEPS as u64);
    }

    fn advance(&self, part: f64) {
        Progress::advance(self, (part * STEPS).round() as u64);
    }

    fn finish(&self) {}

    fn is_cancelled(&self) -> bool {
        Progress::is_cancelled(self)
    }
}

/// Makes a study, or says what it will take: the report's file unless it is a part, lines of words, and how many cells were measured.
#[pyfunction]
pub fn study(
    py: Python<'_>,
    study: &Bound<'_, PyAny>,
    options: &Bound<'_, PyAny>,
    progress: Option<Py<PyAny>>,
) -> PyResult<(Option<PathBuf>, Vec<String>, usize)> {
    let given = Given::read(study)?;
    let Options { out, seed, photons, threads, part, merge, dry_run, program } = options.extract()?;
    let share =
        |words: String| words.parse().map_err(|allowed| refuse(format!("part is '{words}'; {allowed}")));
    let part: Option<Share> = part.map(share).transpose()?;
    let mut settings = Settings { seed, photon_scale: photons, part, merge, dry_run, ..Settings::new(out) };
    settings.threads = threads.map_or(settings.threads, usize::from);
    work::run(py, threads, progress.as_ref(), move |watch| {
        watch.stage("scenes", 1);
        let program = Digest::of_file(&program).context("cannot read the module turbid")?.to_string();
        let question = given.question()?;
        let outcome = match own_study::ASKED.study("study", question, &settings, program, watch)? {
            Findings::Forecast(text) => return Ok((None, text.lines().map(String::from).collect(), 0)),
            Findings::Outcome(outcome) => outcome,
        };
        if let Given::Text(text) = &given {
            write_atomically(settings.out.join(FILE), |out| out.write_all(text.as_bytes()))?;
        }
        let measured = outcome.measured;
        if let Some(part) = part {
            return Ok((None, vec![format!("part {}: {measured} cells measured", part.words())], measured));
        }
        let summary = outcome.sections.into_iter().flat_map(|section| section.section.summary).collect();
        Ok((Some(outcome.report), summary, measured))
    })
}
