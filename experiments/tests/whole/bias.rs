//! The experiment `bias`, whole, on few photons.

use super::run;
use std::collections::BTreeMap;
use std::path::Path;

const PROGRAM: &str = env!("CARGO_BIN_EXE_bias");

/// A hundredth of the photons: every map of the real one is shot, every case predicted, gathered, judged and drawn; and
/// a quarter of the cells again, on other threads.
#[test]
fn the_same_results_on_one_thread_and_two_and_after_a_loss() {
    let folder = tempfile::tempdir().unwrap();
    let one = run::same_on_threads_and_after_a_loss(PROGRAM, "0.01", folder.path());
    assert!(run::figures(&one) >= 4);
    parameters_are_columns(&one.join("results.csv"));
}

/// The columns say what the name of the case says.
fn parameters_are_columns(results: &Path) {
    let mut table = csv::Reader::from_path(results).unwrap();
    let rows = table.deserialize().collect::<Result<Vec<BTreeMap<String, String>>, _>>().unwrap();
    let named = rows.iter().filter(|row| row["quantity"] == "error left over");
    let cases = named.map(|row| {
        let gather = match (row["radius"].as_str(), row["k"].as_str()) {
            (radius, "") => format!("r={radius}"),
            ("", k) => format!("k={k}"),
            both => panic!("{both:?}"),
        };
        let number = |column: &str| row[column].parse::<f64>().unwrap();
        let (photons, depth) = (number("photons"), number("depth"));
        let name = format!("{} n={photons} t={depth} {gather} {}", row["field"], row["kernel"]);
        assert_eq!(name.replace(".0 ", " "), row["case"].replace("(biased)", ""), "{row:?}");
    });
    assert!(cases.count() > 100);
}
