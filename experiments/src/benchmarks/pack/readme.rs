//! The page of explanation.

use super::question::Question;
use super::{Comparison, VERSION};
use std::collections::BTreeSet;
use std::fmt::Write;

const HOW: &str = include_str!("how.md");

/// Why answers are outside of their errors, as found: program, text.
const FOUND: [(&str, &str); 2] =
    [("mitsuba", include_str!("mitsuba.md")), ("pythonicdisort", include_str!("pythonicdisort.md"))];

/// The page.
pub(super) fn text(questions: &[Question], outcomes: &[(&str, Comparison)]) -> String {
    let scenes: BTreeSet<&str> = questions.iter().map(|q| q.scene.as_str()).collect();
    let relative = |q: &Question| q.bound / libm::fabs(q.value);
    let widest = questions.iter().map(relative).fold(0.0, f64::max);
    let mut page = HOW
        .replace("{version}", &VERSION.to_string())
        .replace("{questions}", &questions.len().to_string())
        .replace("{scenes}", &scenes.len().to_string())
        .replace("{widest}", &format!("{widest:.0e}"));
    page += "\n## Outcome\n\nAnswers as found, by the scripts in `outcome`; `check.py` printed the `.txt` beside them.\n\n";
    page += "| program | questions | χ² | p | largest z | verdict |\n| --- | --- | --- | --- | --- | --- |\n";
    for (_, c) in outcomes {
        let (sum, n) = c.chi_squared();
        let worst = c.worst().map_or(String::new(), |row| {
            // Theirs less the exact value, as the checker counts it.
            format!("{:.1}, `{}`", -row.z().unwrap_or(0.0), row.case)
        });
        let p = c.p().unwrap_or(1.0);
        let p = if p < 1e-12 { "< 1e-12".into() } else { format!("{p:.2}") };
        let _ = writeln!(page, "| {} | {n} | {sum:.4} | {p} | {worst} | {} |", c.by, c.verdict().word());
    }
    for (name, c) in outcomes {
        let found = FOUND.iter().find(|(program, _)| program == name).map_or("", |(_, text)| *text);
        let _ = write!(page, "\n### {}\n\n{found}", c.by);
    }
    page
}
