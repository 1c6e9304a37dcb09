//! The page of explanation.

use super::super::comparison::Comparison;
use super::question::Question;
use std::collections::BTreeSet;
use std::fmt::Write;

const HOW: &str = include_str!("how.md");

/// A changed value, id or unit is another version.
pub(super) const VERSION: u32 = 1;

/// What a program answered, and what was found of it in words.
pub(super) struct Outcome {
    pub(super) comparison: Comparison,
    pub(super) found: String,
}

/// The page.
pub(super) fn text(questions: &[Question], outcomes: &[Outcome]) -> String {
    let scenes: BTreeSet<&str> = questions.iter().map(|q| q.scene.as_str()).collect();
    let relative = |q: &Question| q.bound / libm::fabs(q.value);
    let widest = questions.iter().map(relative).fold(0.0, f64::max);
    let mut page = HOW
        .replace("{version}", &VERSION.to_string())
        .replace("{questions}", &questions.len().to_string())
        .replace("{scenes}", &scenes.len().to_string())
        .replace("{widest}", &format!("1e{}", libm::ceil(libm::log10(widest))));
    page += "\n## Outcome\n\nAnswers as found, by the scripts in `outcome`; `check.py` printed the `.txt` beside them.\n\n";
    page += "| program | questions | χ² | p | largest z | verdict |\n| --- | --- | --- | --- | --- | --- |\n";
    for Outcome { comparison: c, .. } in outcomes {
        let (sum, n) = c.chi_squared();
        let worst = c.worst().map_or(String::new(), |row| {
            // Theirs less the exact value, as the checker counts it.
            format!("{:.1}, `{}`", -row.z().unwrap_or(0.0), row.case)
        });
        let p = c.p().unwrap_or(1.0);
        let p = if p < 1e-12 { "< 1e-12".into() } else { format!("{p:.2}") };
        let _ = writeln!(page, "| {} | {n} | {sum:.1} | {p} | {worst} | {} |", c.by, c.verdict().word());
    }
    for outcome in outcomes {
        let _ = write!(page, "\n### {}\n\n{}", outcome.comparison.by, outcome.found);
    }
    page
}
