//! Questions to the referee.

use crate::work;
use anyhow::bail;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};
use turbid::transport::Progress;
use turbid_exact::{Answer, Argument, Asker, Field, Takes};

/// Every problem: name, help, and its arguments as name, help, what it takes, whether it is required, defaults, allowed words.
#[pyfunction]
pub fn problems(py: Python<'_>) -> PyResult<Bound<'_, PyList>> {
    let argument = |argument: &Argument| {
        let takes = match argument.takes {
            Takes::Nothing => "nothing",
            Takes::One => "one",
            Takes::Vector => "vector",
            Takes::List => "list",
            Takes::Descriptions => "descriptions",
        };
        let dict = PyDict::new(py);
        dict.set_item("name", &argument.name)?;
        dict.set_item("help", &argument.help)?;
        dict.set_item("takes", takes)?;
        dict.set_item("required", argument.is_required)?;
        dict.set_item("default", &argument.default)?;
        dict.set_item("allowed", &argument.allowed)?;
        Ok(dict)
    };
    let list = PyList::empty(py);
    for problem in turbid_exact::problems() {
        let dict = PyDict::new(py);
        dict.set_item("name", &problem.name)?;
        dict.set_item("about", &problem.about)?;
        dict.set_item("arguments", problem.arguments.iter().map(argument).collect::<PyResult<Vec<_>>>()?)?;
        list.append(dict)?;
    }
    Ok(list)
}

/// Arguments of one question by name.
pub type Question = Vec<(String, Option<String>)>;

/// A place: a number or a word.
#[derive(IntoPyObject)]
pub enum Place {
    Number(f64),
    Word(String),
}

/// Quantity, place, value, bound, unit, how it is known.
pub type Row = (&'static str, Vec<(&'static str, Place)>, f64, f64, String, &'static str);

fn rows(answer: Answer) -> Vec<Row> {
    let place = |(name, field): (&'static str, Field)| {
        let place = match field {
            Field::Number(number) => Place::Number(number),
            Field::Whole(number) => Place::Number(number as f64),
            Field::Text(text) => Place::Word(text),
        };
        (name, place)
    };
    let row = |row: turbid_exact::Row| {
        let at = row.at.into_iter().map(place).collect();
        (row.quantity, at, row.value.value, row.value.error, row.unit.to_string(), row.value.method)
    };
    answer.rows.into_iter().map(row).collect()
}

/// Answers questions of one problem, one after the other: what is solved serves the next.
#[pyfunction]
#[pyo3(signature = (problem, questions, progress=None))]
pub fn ask(
    py: Python<'_>,
    problem: String,
    questions: Vec<Question>,
    progress: Option<Py<PyAny>>,
) -> PyResult<Vec<Vec<Row>>> {
    work::run(py, Some(1), progress.as_ref(), move |watch| {
        let mut asker = Asker::default();
        watch.stage("questions", questions.len() as u64);
        let one = |question: &Question| {
            if watch.is_cancelled() {
                bail!("cancelled");
            }
            let answer = asker.ask(&problem, question)?;
            watch.advance(1);
            Ok(rows(answer))
        };
        questions.iter().map(one).collect()
    })
}
