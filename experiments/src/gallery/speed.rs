//! The section "Speed" of the page: ratios measured side by side in one run, written down here from the benches' output.

use maud::{Markup, html};

/// One ratio.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Row {
    /// What is compared with what.
    pub label: &'static str,
    /// How many times as efficient: 1/(mean square error x CPU seconds) of ours over the other's.
    pub ratio: f64,
    /// Lower end of its interval of 95 per cent.
    pub low: f64,
    /// Upper end.
    pub high: f64,
    /// The command that measures it.
    pub command: &'static str,
}

/// The rows, as measured last.
pub const ROWS: &[Row] = &[
    Row {
        label: "Paths in a box of even fog, over Mitsuba 3.9's volpath (scalar_rgb)",
        ratio: 3.31,
        low: 3.23,
        high: 3.38,
        command: "cargo bench -p turbid-benches --bench fogbox -- iso",
    },
    Row {
        label: "The same in fog that scatters forwards",
        ratio: 2.29,
        low: 2.20,
        high: 2.40,
        command: "cargo bench -p turbid-benches --bench fogbox -- hg",
    },
    Row {
        label: "The same in uneven fog",
        ratio: 2.51,
        low: 2.42,
        high: 2.60,
        command: "cargo bench -p turbid-benches --bench fogbox -- het",
    },
    Row {
        label: "Photon maps of 1998's size, seen directly, in a box of even fog, over Mitsuba's volpath at an error of 20 %",
        ratio: 10.61,
        low: 10.12,
        high: 11.05,
        command: "cargo bench -p turbid-benches --bench fogbox -- maps 8",
    },
];

/// The section; nothing without rows.
pub fn section(rows: &[Row]) -> Markup {
    html! {
        @if !rows.is_empty() {
            h2 id="speed" { "Speed" }
            p {
                "Efficiency is 1/(mean square error × CPU seconds), measured in turn on one machine; a ratio above 1 says that "
                "turbid reaches the same error in less time. Intervals are of 95 per cent. The experiment " code { "claims-1998" }
                " measures the error at which paths overtake a photon map."
            }
            table {
                thead { tr { th { "what" } th { "ratio" } th { "interval" } th { "measured by" } } }
                tbody {
                    @for row in rows {
                        tr {
                            td { (row.label) }
                            td { (format!("{:.2}", row.ratio)) }
                            td { (format!("{:.2} to {:.2}", row.low, row.high)) }
                            td { code { (row.command) } }
                        }
                    }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ratios_lie_in_their_intervals() {
        for row in ROWS {
            assert!(0.0 < row.low && row.low <= row.ratio && row.ratio <= row.high, "{row:?}");
            assert!(row.command.starts_with("cargo "), "{row:?}");
        }
    }

    #[test]
    fn every_row_is_shown() {
        let text = section(ROWS).into_string();
        assert!(ROWS.iter().all(|row| text.contains(row.label) && text.contains(row.command)));
        assert_eq!(section(&[]).into_string(), "");
    }
}
