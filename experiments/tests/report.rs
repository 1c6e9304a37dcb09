//! The report of a study of many experiments: one page that can be found through.
#![allow(clippy::unwrap_used, reason = "tests")]

mod fake;

use std::collections::BTreeSet;
use std::fs;
use turbid_experiments::harness::{Experiment, Section, Settings, Study, run};

/// The known experiment with many claims and rows, as larger ones have.
fn many(name: &'static str, title: &'static str) -> Experiment {
    let conclude = |settings: &_, predictions: &_, cells: &_| -> anyhow::Result<Section> {
        let mut section = (fake::FAKE.conclude)(settings, predictions, cells)?;
        let first = section.claims.clone();
        for i in 0..5 {
            for mut claim in first.clone() {
                claim.id = format!("{}, again {i}", claim.id);
                section.claims.push(claim);
            }
            let rows = section.tables[0].rows.clone();
            section.tables[0].rows.extend(rows);
        }
        let mut figure = section.figures[0].clone();
        figure.name = "again".to_string();
        section.figures.push(figure);
        Ok(section)
    };
    Experiment { name, title, conclude, ..fake::FAKE }
}

/// Everything between `before` and the next quotation mark.
fn quoted<'a>(page: &'a str, before: &str) -> Vec<&'a str> {
    page.split(before).skip(1).filter_map(|rest| rest.split_once('"')).map(|(value, _)| value).collect()
}

#[test]
fn every_experiment_claim_and_figure_can_be_reached() {
    let folder = tempfile::tempdir().unwrap();
    let experiments = [
        many("blur", "How far does a gather blur an edge?"),
        many("boundary", "What is lost where the medium ends?"),
        many("rates", "How fast does the error fall with the photons?"),
    ];
    let study = Study { name: "study", experiments: &experiments, ..fake::study() };
    run(&study, &Settings { threads: 2, ..Settings::new(folder.path()) }).unwrap();
    let page = fs::read_to_string(folder.path().join("report.html")).unwrap();

    let ids = quoted(&page, " id=\"");
    let unique: BTreeSet<&str> = ids.iter().copied().collect();
    assert_eq!(ids.len(), unique.len(), "an anchor is there twice");
    let links = quoted(&page, " href=\"#");
    for link in &links {
        assert!(unique.contains(link), "{link} leads nowhere");
    }
    let reached: BTreeSet<&str> = links.into_iter().collect();
    for experiment in &experiments {
        assert!(reached.contains(experiment.name));
        for figure in ["bias", "again"] {
            assert!(reached.contains(format!("figure-{}-{figure}", experiment.name).as_str()));
        }
        // Its first claim by a link, all by their anchors.
        assert!(reached.iter().any(|link| link.starts_with(&format!("claim-{}-", experiment.name))));
        assert!(unique.contains(format!("claim-{}-control--again-4", experiment.name).as_str()));
    }
    // Long tables are folded; what is not upheld stands open before the table of all claims.
    assert!(page.contains("Show all 160 rows") && page.contains("All 72 claims in one table"));
    let open = page.split("<details class=\"all\"").next().unwrap();
    assert!(open.contains("badge rejected") && open.contains("Claims that are rejected or undecided."));
    let numbers: Vec<&str> =
        page.split("<b>Figure ").skip(1).map(|rest| rest.split('.').next().unwrap()).collect();
    assert_eq!(numbers, ["1", "2", "3", "4", "5", "6"], "figures are numbered in the order of the page");
}
