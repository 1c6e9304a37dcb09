//! The few lines that end a study on the terminal.

use crate::harness::{Outcome, Verdict};

/// Verdict counts, the headline of each experiment, and where the report is.
pub fn summary(outcome: &Outcome) -> String {
    let mut text = format!("\n{}\n\n", counts(outcome));
    for part in &outcome.sections {
        // A study of one question answers in all of its sentences.
        let shown = if part.judged.is_empty() && outcome.sections.len() == 1 { usize::MAX } else { 1 };
        if !part.section.summary.is_empty() {
            text.push_str(&format!("{}\n", part.experiment.title));
        }
        for sentence in part.section.summary.iter().take(shown) {
            text.push_str(&format!("  {sentence}\n"));
        }
        for judged in part.judged.iter().filter(|j| j.verdict != Verdict::Upheld) {
            let claim = &judged.claim;
            let why = if judged.advice.is_empty() { String::new() } else { format!("; {}", judged.advice) };
            let verdict = judged.verdict.word();
            text.push_str(&format!(
                "  {verdict}: {}: measured {}; claimed {}{why}.\n",
                claim.text,
                judged.measured(),
                claim.margin()
            ));
        }
    }
    text.push_str(&format!("\nReport: {}\n", outcome.report.display()));
    text
}

/// "12 claims: 9 upheld, 1 rejected, 2 undecided.", or the cost alone where nothing is claimed.
fn counts(outcome: &Outcome) -> String {
    let [upheld, rejected, undecided] =
        [Verdict::Upheld, Verdict::Rejected, Verdict::Undecided].map(|verdict| outcome.count(verdict));
    let total = upheld + rejected + undecided;
    let noun = if total == 1 { "claim" } else { "claims" };
    let cost = crate::harness::cost_line(&outcome.sections);
    if total == 0 && outcome.sections.len() == 1 {
        return format!("{cost}.");
    }
    let without = match outcome.sections.iter().filter(|s| s.failure.is_some()).count() {
        0 => String::new(),
        1 => ", 1 section without a conclusion".to_string(),
        n => format!(", {n} sections without a conclusion"),
    };
    format!("{total} {noun}: {upheld} upheld, {rejected} rejected, {undecided} undecided{without} ({cost}).")
}
