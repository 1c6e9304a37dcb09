//! Every row of every table of reference values, through the command `exact --cases`.
//!
//! The tables were made by other programs in higher precision; their column `method` says how. `digits` is the number of
//! correct significant digits, so a value may be off by 10^-(digits-1) of itself, and the bound that comes with an answer
//! must cover the deviation but for the table's own last digits.
#![allow(clippy::unwrap_used, reason = "tests")]

use assert_cmd::Command;
use std::collections::HashMap;

type Row = HashMap<String, String>;

fn reference(name: &str) -> String {
    format!("{}/tests/reference/{name}", env!("CARGO_MANIFEST_DIR"))
}

fn rows(text: &[u8]) -> Vec<Row> {
    csv::Reader::from_reader(text).deserialize().map(|r| r.unwrap()).collect()
}

fn number(text: &str) -> f64 {
    text.parse().unwrap_or_else(|_| panic!("'{text}' is no number"))
}

/// Answers of the command to a table.
fn answers(path: &str) -> Vec<Row> {
    let output = Command::new(env!("CARGO_BIN_EXE_exact")).args(["--cases", path]).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    assert!(output.stderr.is_empty());
    rows(&output.stdout)
}

/// Every row of a table within 10^-(digits-1), its bound covering the deviation but for the table's last digits, and no
/// larger than `promised` of the value, or of 1 where that is more.
fn whole_table(name: &str, count: usize, promised: f64) {
    let path = reference(name);
    let (table, answers) = (rows(&std::fs::read(&path).unwrap()), answers(&path));
    assert_eq!((table.len(), answers.len()), (count, count));
    for (row, answer) in table.iter().zip(&answers) {
        assert_eq!(row["id"], answer["id"]);
        assert!(!answer["value"].is_empty(), "{answer:?}");
        let (want, digits) = (number(&row["value"]), number(&row["digits"]));
        let (got, error) = (number(&answer["value"]), number(&answer["error"]));
        let off = (got - want).abs();
        assert!(off <= libm::pow(10.0, 1.0 - digits) * want.abs(), "{answer:?}\ntable {want:e} off by {off:e}");
        // The table's own last digits; 14 printed digits of a kernel's value may be half a unit off.
        let last = 2.0 * libm::pow(10.0, -digits) * want.abs();
        assert!(off <= error + last, "{answer:?}\ntable {want:e} off by {off:e}");
        assert!(error < promised * want.abs().max(1.0), "{answer:?}");
    }
}

#[test]
fn isotropic_slabs() {
    whole_table("slab_iso.csv", 223, 1e-12);
}

#[test]
fn fluxes_of_anisotropic_slabs() {
    whole_table("slab_hg_flux.csv", 208, 1e-9);
}

#[test]
fn kernels() {
    whole_table("kernel.csv", 51, 1e-12);
}
