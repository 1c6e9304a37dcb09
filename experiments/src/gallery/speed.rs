//! The section "Speed" of the page: ratios measured side by side in one run, read from the benches' kept outputs.

use maud::{Markup, html};

/// One ratio.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    /// What is compared with what.
    pub label: String,
    /// How many times as efficient: 1/(mean square error x CPU seconds) of ours over the other's.
    pub ratio: f64,
    /// Lower end of its interval of 95 per cent.
    pub low: f64,
    /// Upper end.
    pub high: f64,
    /// The command that measures it.
    pub command: &'static str,
}

/// What `cargo bench -p turbid-benches --bench fogbox -- iso hg het` printed last, and the same with `-- maps 8`.
const KEPT: [&str; 2] =
    [include_str!("../../../results/speed/fogbox.txt"), include_str!("../../../results/speed/maps.txt")];

/// The numbers of a line, signs of an interval apart.
fn numbers(line: &str) -> Vec<f64> {
    line.split([' ', '(', ')']).filter_map(|word| word.parse().ok()).collect()
}

/// The rows, as measured last: those that the outputs have.
pub fn rows() -> Vec<Row> {
    let [fogs, maps] = KEPT;
    let paths = |name: &str, label: &str| {
        let found =
            numbers(fogs.lines().find(|line| line.starts_with(name) && line.contains("turbid paths"))?);
        let [_, _, ratio, low, high] = found.get(..5)?.try_into().ok()?;
        let command = "cargo bench -p turbid-benches --bench fogbox -- iso hg het";
        Some(Row {
            label: format!("{label}, over Mitsuba's volpath (scalar_rgb)"),
            ratio,
            low,
            high,
            command,
        })
    };
    let map = |first: usize, label: &str| {
        let mut lines = maps.lines().skip_while(|line| !line.starts_with("Time of Mitsuba scalar_rgb"));
        let found = numbers(lines.find(|line| line.trim_start().starts_with("20 %"))?);
        let [ratio, low, high] = found.get(first..first + 3)?.try_into().ok()?;
        let label =
            format!("{label}, seen directly, over Mitsuba's volpath (scalar_rgb) at an error of 20 %");
        let command = "cargo bench -p turbid-benches --bench fogbox -- maps 8";
        Some(Row { label, ratio, low, high, command })
    };
    [
        paths("iso", "Paths in a box of homogeneous fog"),
        paths("hg", "The same in fog that scatters forwards"),
        paths("het", "The same in heterogeneous fog"),
        map(4, "Photon maps of 1998, 135,000 photons on surfaces and 65,000 in the fog"),
        map(7, "The same with 200,000 photons on surfaces"),
    ]
    .into_iter()
    .flatten()
    .collect()
}

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

    /// Every line is found, and read from its own place.
    #[test]
    fn the_kept_outputs_are_read() {
        let rows = rows();
        assert_eq!(rows.len(), 5);
        for row in &rows {
            assert!(0.0 < row.low && row.low <= row.ratio && row.ratio <= row.high, "{row:?}");
            let said = format!("{:.2} ({:5.2} to {:5.2})", row.ratio, row.low, row.high);
            assert!(KEPT.iter().any(|kept| kept.contains(&said)), "{said}");
        }
        // The maps of 1998 are the second and the third of their line.
        let title = "Time of Mitsuba scalar_rgb over that of the cheapest map, of the map of 1998, and of that with 200,000 on surfaces";
        let line = KEPT[1].split_once(title).unwrap().1.lines().find(|line| line.contains("20 %")).unwrap();
        let starts: Vec<usize> = line.match_indices(" (").map(|(at, _)| at).collect();
        let at = |row: &Row| line.find(&format!("{:.2} ({:5.2} to", row.ratio, row.low)).unwrap();
        assert!(starts[0] < at(&rows[3]) && at(&rows[3]) < starts[1] && starts[1] < at(&rows[4]));
    }

    #[test]
    fn every_row_is_shown() {
        let rows = rows();
        let text = section(&rows).into_string();
        assert!(rows.iter().all(|row| text.contains(&row.label) && text.contains(row.command)));
        assert_eq!(section(&[]).into_string(), "");
    }
}
