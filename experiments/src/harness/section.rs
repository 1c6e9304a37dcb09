//! What an experiment says in the report.

use super::format::{number, percent, with_error};
use super::{Answer, Claim, Headline, Row, Unit};
use crate::prediction::Entry;
use turbid::stats::{Moments, mean_interval};
use turbid_figure::Figure;

/// A figure in all of its forms: drawn in its own width and in the other width of a journal, and as a table.
#[derive(Debug, Clone, PartialEq)]
pub struct FigureFiles {
    /// File-safe name, unique within the experiment.
    pub name: String,
    /// What to see in it, in whole sentences.
    pub caption: String,
    /// The figure as SVG.
    pub svg: String,
    /// The figure as PNG.
    pub png: Vec<u8>,
    /// The figure as a table, from which it can be redrawn.
    pub csv: String,
    /// The figure in the other width.
    pub other: OtherWidth,
    /// What is drawn.
    pub figure: Figure,
}

/// A figure laid out for one column of print where it is drawn for two, or for two where it is drawn for one.
#[derive(Debug, Clone, PartialEq)]
pub struct OtherWidth {
    /// `single` or `double`, the end of the files' names.
    pub name: &'static str,
    /// The figure as SVG.
    pub svg: String,
    /// The figure as PNG.
    pub png: Vec<u8>,
}

impl FigureFiles {
    /// Draws a figure.
    ///
    /// # Errors
    /// If it cannot be drawn as it is, in either width.
    pub fn draw(name: &str, caption: &str, figure: &Figure) -> anyhow::Result<Self> {
        let csv = figure.csv(caption)?;
        let other = figure.in_width(figure.width.other());
        let (png, other_png) = rayon::join(|| figure.png(), || other.png());
        Ok(FigureFiles {
            name: name.to_string(),
            caption: caption.to_string(),
            svg: figure.svg()?,
            png: png?,
            csv,
            other: OtherWidth { name: other.width.name(), svg: other.svg()?, png: other_png? },
            figure: figure.clone(),
        })
    }

    /// The figure as LaTeX with its file's name, beside the table of the same stem.
    pub(super) fn latex(&self, stem: &str) -> anyhow::Result<(String, String)> {
        Ok((format!("{stem}.tex"), self.figure.tex(&format!("{stem}.csv"))?))
    }

    /// The drawings with their files' names, for an experiment's figures or for any name: those of the figure's own
    /// width first.
    pub(super) fn drawings(&self, stem: &str) -> [(String, &[u8]); 4] {
        let other = self.other.name;
        [
            (format!("{stem}.svg"), self.svg.as_bytes()),
            (format!("{stem}.png"), &self.png),
            (format!("{stem}-{other}.svg"), self.other.svg.as_bytes()),
            (format!("{stem}-{other}.png"), &self.other.png),
        ]
    }
}

/// The 95 per cent interval of a mean over maps, as figures show it.
pub fn bar(moments: &Moments) -> (f64, f64) {
    let interval = mean_interval(moments, 0.95);
    (interval.low, interval.high)
}

/// The same on a logarithmic axis: squares are positive, but an interval of few cells may reach below.
pub fn positive_bar(moments: &Moments) -> (f64, f64) {
    let (low, high) = bar(moments);
    (low.max(0.01 * moments.mean()), high)
}

/// The interval of a mean of fractions, in per cent.
pub fn percent_bar(moments: &Moments) -> (f64, f64) {
    let (low, high) = bar(moments);
    (percent(low), percent(high))
}

/// A table of words and numbers for readers; the numbers behind it are in results.csv.
#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    /// What to see in it, in whole sentences.
    pub caption: String,
    /// Headings, with units.
    pub columns: Vec<String>,
    /// The cells.
    pub rows: Vec<Vec<String>>,
}

impl Table {
    /// A table of result rows: measured with standard error, predicted, exact, and their distance. Columns that no
    /// row fills are left out.
    pub fn of_rows(caption: &str, rows: &[Row]) -> Self {
        let optional = |value: Option<String>| value.unwrap_or_default();
        let cells = |row: &Row| {
            let (case, quantity) = row.key();
            let shown =
                |(value, error): (f64, f64)| with_error(row.unit().shown(value), row.unit().shown(error));
            vec![
                case.to_string(),
                row_label(quantity, row.unit()),
                shown(row.value()),
                optional(row.prediction().map(|value| number(row.unit().shown(value)))),
                optional(row.exact_value().map(shown)),
                optional(
                    row.z_and_p().map(|(z, _)| format!("{z:.1}").replace("-0.0", "0.0").replace('-', "−")),
                ),
                row.verdict().to_string(),
            ]
        };
        let columns = ["case", "quantity", "measured", "predicted", "exact", "z", "against exact"]
            .map(String::from)
            .to_vec();
        Table { caption: caption.to_string(), columns, rows: rows.iter().map(cells).collect() }
            .without_empty_columns()
    }

    fn without_empty_columns(self) -> Self {
        let is_filled =
            |i: &usize| self.rows.iter().any(|row| row.get(*i).is_some_and(|cell| !cell.is_empty()));
        let kept: Vec<usize> = (0..self.columns.len()).filter(is_filled).collect();
        let keep = |row: &Vec<String>| kept.iter().filter_map(|&i| row.get(i).cloned()).collect();
        Table {
            caption: self.caption.clone(),
            columns: keep(&self.columns),
            rows: self.rows.iter().map(keep).collect(),
        }
    }
}

/// A quantity with its unit in brackets.
pub(crate) fn row_label(quantity: &str, unit: Unit) -> String {
    match unit.title() {
        none if none.is_empty() => quantity.to_string(),
        unit => format!("{quantity} [{unit}]"),
    }
}

/// What one experiment found. Title and question come from the experiment itself.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Section {
    /// Paragraphs; the first is the headline, one sentence that stands alone.
    pub summary: Vec<String>,
    /// The numbers that a paper would quote.
    pub headlines: Vec<Headline>,
    /// Claims, judged together with those of the whole study.
    pub claims: Vec<Claim>,
    /// Figures, in order.
    pub figures: Vec<FigureFiles>,
    /// Tables, in order.
    pub tables: Vec<Table>,
    /// What a careful reader should know: limits, surprises, what was left out.
    pub notes: Vec<String>,
    /// All results, for results.csv.
    pub rows: Vec<Row>,
    /// The cases whose mean error is predicted term by term, for the budget of the whole study.
    pub budget: Vec<Entry>,
    /// What photon maps cost beside paths, scene by scene, for the answer that opens the report.
    pub answers: Vec<Answer>,
    /// Tables beside the page, by the names of their files; one called results.csv stands in the place of `rows`.
    pub files: Vec<(String, String)>,
    /// How many predicted cases a rule of the experiment's own keeps out of `budget`.
    pub left_out: usize,
}

impl Section {
    /// What stands in the place of a section that could not be made.
    pub(super) fn without_conclusion(why: &str) -> Self {
        let why = why.trim_end_matches('.');
        let advice =
            if why.contains("internal error") { "Please report it" } else { "More photons or maps may help" };
        Section { summary: vec![format!("No conclusion: {why}. {advice}.")], ..Section::default() }
    }
}
