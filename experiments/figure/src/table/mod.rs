//! A figure as a CSV file that people and data frames can read and edit, and back again without a bit lost.
//!
//! The file starts with lines of the form `# key: value`, each value one line of JSON: the version of the format, a
//! description in words, the layout of the figure, the heading and axes of each panel, the look of each layer. Then
//! come tidy rows, one a point (bin, cell, rule, note), with the columns `panel`, `layer`, `kind`, those that the figure
//! fills of `x`, `y`, `x_low`, `x_high`, `y_low`, `y_high`, `value`, and `label`. A reader that skips lines with `#`, such
//! as `pandas.read_csv(file, comment="#")`, sees a plain table. The label stands last since a label may have a comma:
//! pgfplots knows no quotes, and takes what follows the comma for one more column, which it leaves out.

mod header;
mod layers;
mod read;
mod rows;
mod write;

pub(crate) use read::read;
pub(crate) use write::write;

/// The version of the format.
const VERSION: u32 = 1;

/// The columns of numbers, in the order of the file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Column {
    X,
    Y,
    XLow,
    XHigh,
    YLow,
    YHigh,
    Value,
}

impl Column {
    const ALL: [Column; 7] =
        [Column::X, Column::Y, Column::XLow, Column::XHigh, Column::YLow, Column::YHigh, Column::Value];

    fn name(self) -> &'static str {
        match self {
            Self::X => "x",
            Self::Y => "y",
            Self::XLow => "x_low",
            Self::XHigh => "x_high",
            Self::YLow => "y_low",
            Self::YHigh => "y_high",
            Self::Value => "value",
        }
    }
}

/// The columns of words and whole numbers: the last stands behind the numbers, the others before them.
const KEYS: [&str; 4] = ["panel", "layer", "kind", "label"];

/// The numbers of a row, by column.
type Numbers = [Option<f64>; 7];

/// A row with these numbers.
fn numbers(filled: &[(Column, f64)]) -> Numbers {
    let mut out = [None; 7];
    for &(column, value) in filled {
        out[column as usize] = Some(value);
    }
    out
}
