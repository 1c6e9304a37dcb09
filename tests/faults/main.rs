//! Planted faults: each must be caught by a check of the suite, and a document must say by how much: TESTING.md of those
//! that shipped elsewhere, BY_HAND.md of changes by hand that no test had noticed.
//!
//! What needs a switch inside the library is planted through `turbid::faults`; what a user could do wrong outside is done
//! here, to the same check. Every check passes without its fault. One fault at a time, in one test: switches are global.
#![allow(clippy::unwrap_used, reason = "tests")]

#[path = "../checks/mod.rs"]
mod checks;
mod rows;
#[path = "../support/mod.rs"]
mod support;
mod table;

use rows::{BY_HAND, ROWS, Row};
use std::collections::BTreeMap;
use support::verdict::{Trial, trial};
use turbid::faults::{Fault, planted, with};

fn describe(trial: &Trial) -> String {
    let worst = trial.worst().map_or(String::new(), |f| format!("{}: z {:.2}, p {:.1e}", f.what, f.z, f.p));
    format!("{worst} {}", trial.broken.as_deref().unwrap_or_default())
}

/// Runs the check of every row without its fault and with it: what it found with it.
fn caught(rows: &[Row]) -> Vec<Trial> {
    let mut right: BTreeMap<&str, Trial> = BTreeMap::new();
    let mut wrong = Vec::new();
    for Row { fault, check_name, check, .. } in rows {
        let without = right.entry(check_name).or_insert_with(|| with(None, || trial(|| check(false))));
        assert!(!without.is_rejected(), "{check_name} fails without a fault: {}", describe(without));
        let caught = with(fault.switch(), || trial(|| check(true)));
        assert!(caught.is_rejected(), "nobody catches {fault:?}: {}", describe(&caught));
        support::verdict::println_line(&format!("{fault:?} {}", describe(&caught)));
        wrong.push(caught);
    }
    assert!(Fault::ALL.iter().all(|fault| !planted(*fault)));
    wrong
}

/// Every fault is caught, every check passes without it, and the tables of TESTING.md and of changes by hand say what was
/// found here. No other test of this binary plants anything.
#[test]
fn every_fault_is_caught() {
    let shipped = caught(ROWS);
    let by_hand = caught(BY_HAND);
    table::agrees_with_the_document("TESTING.md", ROWS, &shipped);
    table::agrees_with_the_document("tests/faults/BY_HAND.md", BY_HAND, &by_hand);
}

/// Every switch of the library has a row; rows that switch nothing do their fault themselves.
#[test]
fn every_switch_has_a_row() {
    for fault in Fault::ALL {
        let own = ROWS.iter().chain(BY_HAND).filter(|row| row.fault.switch() == Some(fault)).count();
        assert_eq!(own, 1, "{fault:?}");
    }
}

/// Nobody but the tests of this package turns the switches on: the feature is named in one manifest, under features
/// and under dev-dependencies, and is no default.
#[test]
fn no_other_package_can_plant_faults() {
    let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR"));
    let read = |path: &str| -> toml::Table {
        toml::from_str(&std::fs::read_to_string(root.join(path)).unwrap()).unwrap()
    };
    for path in ["analytic/Cargo.toml", "experiments/Cargo.toml", "experiments/figure/Cargo.toml"] {
        assert!(!read(path).to_string().contains("faults"), "{path}");
    }
    let own = read("Cargo.toml");
    assert_eq!(own["features"].as_table().unwrap().len(), 1);
    assert!(own["features"]["faults"].as_array().unwrap().is_empty());
    assert!(!own["dependencies"].to_string().contains("faults"));
    assert!(!own["workspace"].to_string().contains("faults"));
    assert!(own["dev-dependencies"]["turbid"].to_string().contains("faults"));
}
