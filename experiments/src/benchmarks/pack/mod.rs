//! The benchmark pack: questions with exact values, by which another transport code can test itself.
//!
//! `benchmarks --pack` writes the questions as CSV and JSON, a scene file a problem, a checker and a page of explanation.
//! The answers of other programs that lie in its folder `outcome` are compared on that page.

mod problems;
mod question;
mod readme;
#[cfg(test)]
mod tests;

use super::comparison::{Comparison, Row};
use super::published::Published;
use crate::harness::{read_if_there, say};
use anyhow::{Context, ensure};
use question::{Problem, Question};
use readme::{Outcome, VERSION};
use serde::Serialize;
use std::collections::BTreeMap;
use std::path::Path;
use turbid::output::{write_atomically, write_csv, write_json};

/// Programs whose answers are kept: name of the file, name of the program, script that answers.
const PROGRAMS: [(&str, &str, &str); 2] = [
    ("mitsuba", "Mitsuba 3.9", include_str!("ask_mitsuba.py")),
    ("pythonicdisort", "PythonicDISORT 1.8", include_str!("ask_pythonicdisort.py")),
];

#[derive(Serialize)]
struct Pack<'a> {
    name: &'static str,
    version: u32,
    license: &'static str,
    questions: &'a [Question],
}

/// Writes the pack.
///
/// # Errors
/// Those of the referee and of the disk, and answers in `outcome` that are not read
pub fn write(folder: &Path) -> anyhow::Result<()> {
    let files = files(&problems::problems()?, folder)?;
    for (name, bytes) in &files {
        let path = folder.join(name);
        let parent = path.parent().unwrap_or(folder);
        std::fs::create_dir_all(parent).with_context(|| format!("cannot create {}", parent.display()))?;
        write_atomically(&path, |out| out.write_all(bytes))?;
    }
    say(&format!("the pack is {}: {} files", folder.display(), files.len()));
    Ok(())
}

/// The files of the pack, by name; answers of other programs are read from the folder.
fn files(problems: &[Problem], folder: &Path) -> anyhow::Result<BTreeMap<String, Vec<u8>>> {
    let questions: Vec<Question> = problems.iter().flat_map(Problem::questions).collect();
    let mut files = BTreeMap::new();
    for problem in problems {
        files.insert(problem.file(), problem.toml().into_bytes());
    }
    let (mut csv, mut json) = (Vec::new(), Vec::new());
    write_csv(&mut csv, &questions)?;
    let pack = Pack {
        name: "turbid benchmark pack",
        version: VERSION,
        license: "MIT OR Apache-2.0",
        questions: &questions,
    };
    write_json(&mut json, &pack)?;
    let mut outcomes = Vec::new();
    for (name, program, script) in PROGRAMS {
        files.insert(format!("outcome/ask_{name}.py"), script.into());
        if let Some(answers) = text_if_there(&folder.join(format!("outcome/{name}.csv")))? {
            let file = format!("outcome/{name}.csv");
            let comparison = compare(program, &file, &answers, &questions)?;
            let found = text_if_there(&folder.join(format!("outcome/{name}.md")))?.unwrap_or_default();
            outcomes.push(Outcome { comparison, found });
        }
    }
    files.insert("README.md".into(), readme::text(&questions, &outcomes).into_bytes());
    files.insert("questions.csv".into(), csv);
    files.insert("questions.json".into(), json);
    files.insert("check.py".into(), include_str!("check.py").into());
    Ok(files)
}

fn text_if_there(path: &Path) -> anyhow::Result<Option<String>> {
    let text = read_if_there(path, 1 << 20)?;
    text.map(|text| String::from_utf8(text).with_context(|| path.display().to_string())).transpose()
}

/// Answers beside the exact values: the rule of the checker.
///
/// # Errors
/// One line for a file that is no table of answers
fn compare(by: &str, name: &str, text: &str, questions: &[Question]) -> anyhow::Result<Comparison> {
    let table = Published::read(name, text, &["id", "value", "std_error"])?;
    let mut rows: Vec<Row> = Vec::new();
    for e in table.entries() {
        let id = e.text("id")?;
        let question = questions.iter().find(|q| q.id == id);
        let question = question
            .with_context(|| format!("{name}: there is no question {}", turbid::output::one_line(id)))?;
        ensure!(rows.iter().all(|row| row.case != id), "{name}: {id} is answered twice; allowed: once");
        let (theirs, error) = (e.number("value")?, e.not_negative("std_error")?);
        rows.push(Row::new(
            id,
            question.quantity,
            0.0,
            (theirs, error),
            (question.value, Some(question.bound)),
        ));
    }
    Ok(Comparison { by: by.into(), rows, seconds: 0.0 })
}
