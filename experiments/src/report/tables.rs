//! Tables in the page: their frame, and long ones folded after their first rows.

use crate::harness::Table;
use maud::{Markup, html};

/// Rows that a folded table shows.
const FIRST: usize = 12;
/// Tables no longer than this are shown whole: folding two rows away helps nobody.
const WHOLE: usize = 16;

/// Running numbers of figures and tables.
#[derive(Default)]
pub(super) struct Numbers {
    pub(super) figure: u32,
    pub(super) table: u32,
}

/// A row of the page: its cells, and whether it is shown in a folded table too.
pub(super) struct Row {
    pub(super) cells: Markup,
    pub(super) is_kept: bool,
}

/// A numbered table, folded if it is long. Without style sheets, in print, or in a browser that cannot fold, all rows
/// are there.
pub(super) fn table(numbers: &mut Numbers, caption: &str, head: Markup, rows: Vec<Row>) -> Markup {
    let count = rows.len();
    let is_long = count > WHOLE;
    let is_more = |i: usize, row: &Row| is_long && i >= FIRST && !row.is_kept;
    let content = html! {
        thead { (head) }
        tbody {
            @for (i, row) in rows.iter().enumerate() {
                tr class=[is_more(i, row).then_some("more")] { (row.cells) }
            }
        }
    };
    html! {
        div class=[is_long.then_some("fold")] {
            (frame(numbers, caption, content))
            @if is_long {
                details { summary { span.closed { "Show all " (count) " rows" } span.opened { "Show fewer rows" } } }
            }
        }
    }
}

/// The frame of a table of any content.
pub(super) fn frame(numbers: &mut Numbers, caption: &str, content: Markup) -> Markup {
    numbers.table += 1;
    html! {
        div.scroll { table { caption { b { "Table " (numbers.table) "." } " " (caption) } (content) } }
    }
}

/// An experiment's own table.
pub(super) fn plain(table: &Table, numbers: &mut Numbers) -> Markup {
    let class = |column: usize| is_numeric(table, column).then_some("n");
    let head = html! {
        tr { @for (i, column) in table.columns.iter().enumerate() { th class=[class(i)] { (column) } } }
    };
    let classes: Vec<Option<&str>> = (0..table.columns.len()).map(class).collect();
    let row = |row: &Vec<String>| Row {
        cells: html! {
            @for (i, cell) in row.iter().enumerate() { td class=[classes.get(i).copied().flatten()] { (lines(cell)) } }
        },
        is_kept: false,
    };
    self::table(numbers, &table.caption, head, table.rows.iter().map(row).collect())
}

/// The lines of a cell, the first of several in bold.
fn lines(cell: &str) -> Markup {
    html! {
        @if cell.contains('\n') {
            @for (i, line) in cell.lines().enumerate() { div.lead[i == 0] { (line) } }
        } @else { (cell) }
    }
}

/// Columns whose filled cells all look like numbers are set flush right.
fn is_numeric(table: &Table, column: usize) -> bool {
    let mut cells =
        table.rows.iter().filter_map(|row| row.get(column)).filter(|cell| !cell.is_empty()).peekable();
    cells.peek().is_some()
        && cells.all(|cell| {
            !cell.contains('\n') && cell.starts_with(|c: char| c.is_ascii_digit() || "−-(∞<>".contains(c))
        })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_tables_fold_and_keep_what_matters() {
        let rows = |n: usize, kept: usize| {
            (0..n).map(|i| Row { cells: html! { td { (i) } }, is_kept: i == kept }).collect()
        };
        let text = |n| table(&mut Numbers::default(), "c", html! {}, rows(n, 39)).into_string();
        assert!(!text(WHOLE).contains("details") && !text(WHOLE).contains("more"));
        assert_eq!(text(40).matches("class=\"more\"").count(), 40 - FIRST - 1);
        assert!(text(40).contains("Show all 40 rows"));
    }
}
