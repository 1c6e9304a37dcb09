//! What the parts found, together.

use super::part::Part;
use super::{clouds, edge, equal_error, importance, pixels, walls};
use crate::harness::{Cells, Section, Settings, Table};
use crate::prediction::{Prediction, Predictions};

/// Concludes.
pub fn conclude(settings: &Settings, predictions: &[Prediction], cells: &Cells) -> anyhow::Result<Section> {
    let known = Predictions::new(predictions);
    let parts = [
        pixels::conclude::conclude(settings, &known, cells)?,
        equal_error::conclude::conclude(settings, cells)?,
        edge::conclude::conclude(settings, &known, cells)?,
        walls::conclude(cells)?,
        clouds::conclude(settings, cells)?,
        importance::conclude::conclude(settings, cells)?,
    ];
    let (mut section, mut said) = (Section::default(), Vec::new());
    for Part { section: mut own, said: mut sentences } in parts {
        section.summary.append(&mut own.summary);
        section.claims.append(&mut own.claims);
        section.figures.append(&mut own.figures);
        section.tables.append(&mut own.tables);
        section.notes.append(&mut own.notes);
        section.rows.append(&mut own.rows);
        section.answers.append(&mut own.answers);
        section.headlines.append(&mut own.headlines);
        said.append(&mut sentences);
    }
    section.summary.extend(said.iter().map(|[sentence, found]| format!("\"{sentence}\": {found}.")));
    section.tables.push(Table {
        caption: "The talk's sentences and what was found. Times are CPU seconds of this machine, side by side in one \
                  run; no claim rests on them. Verdicts are on the numbers that the claims state, not on the sentences."
            .to_string(),
        columns: ["the talk", "found"].map(String::from).to_vec(),
        rows: said.into_iter().map(Vec::from).collect(),
    });
    Ok(section)
}
