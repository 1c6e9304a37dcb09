//! Tables of faults in documents against what was measured, so that the documents cannot rot.

use crate::rows::Row;
use crate::support::verdict::{BEYOND_P, Trial};

/// How the document states what a check found: whole standard errors, cut down; or that no chance is involved. Beyond a
/// thousand the number says how little the wrong answer varies, no more.
fn stated(trial: &Trial) -> String {
    match trial.worst() {
        Some(finding) if finding.p < turbid::stats::ALPHA => match finding.z.abs() {
            z if z >= 1000.0 => "over 1000".to_string(),
            z if z == BEYOND_P && finding.p == 0.0 => format!("over {BEYOND_P}"),
            z => format!("{}", z as u64),
        },
        _ => "exact".to_string(),
    }
}

/// The rows of a document's table of faults, cell by cell.
fn document(file: &str) -> Vec<Vec<String>> {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join(file);
    let text = std::fs::read_to_string(path).unwrap();
    let section = text.split("\n## Planted faults").nth(1).unwrap().split("\n## ").next().unwrap();
    let cells = |line: &str| -> Vec<String> {
        line.trim()
            .trim_matches('|')
            .split('|')
            .map(|cell| cell.trim().trim_matches('`').to_string())
            .collect()
    };
    section.lines().filter(|line| line.starts_with("| ")).skip(1).map(cells).collect()
}

/// Every fault has its row, in order, with the check that catches it and by how many standard errors.
pub fn agrees_with_the_document(file: &str, rows: &[Row], trials: &[Trial]) {
    let measured: Vec<Vec<String>> = rows
        .iter()
        .zip(trials)
        .map(|(Row { title, check_name, .. }, trial)| {
            vec![title.to_string(), check_name.to_string(), stated(trial)]
        })
        .collect();
    // The document's second column tells where the fault was seen, or what it did.
    let documented: Vec<Vec<String>> =
        document(file).iter().map(|row| vec![row[0].clone(), row[2].clone(), row[3].clone()]).collect();
    let lines: Vec<String> =
        measured.iter().map(|row| format!("| {} | `{}` | {} |", row[0], row[1], row[2])).collect();
    assert!(documented == measured, "{file} should say:\n{}", lines.join("\n"));
}
