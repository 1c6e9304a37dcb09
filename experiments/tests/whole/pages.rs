//! The pages that a reader meets first say nothing that is not measured and kept.

use std::fs;
use std::path::{Path, PathBuf};
use turbid_experiments::harness::with_rough_error;

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap().to_path_buf()
}

fn read(path: &str) -> String {
    fs::read_to_string(root().join(path)).unwrap_or_else(|error| panic!("{path}: {error}"))
}

/// Words of a page or of its text, one space apart, without what marks it up.
fn plain(text: &str) -> String {
    let mut plain = String::new();
    let mut is_tag = false;
    for c in text.chars() {
        match c {
            '<' => is_tag = true,
            '>' => is_tag = false,
            c if !is_tag => plain.push(c),
            _ => {}
        }
    }
    plain.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// The numbers of a text: digits with a point or a thin space among them.
fn numbers(text: &str) -> Vec<&str> {
    let is_inside = |c: char| c.is_ascii_digit() || c == '.';
    let parts = text.split(|c| !is_inside(c)).map(|part| part.trim_matches('.'));
    parts.filter(|part| part.starts_with(|c: char| c.is_ascii_digit())).collect()
}

/// README.md without commands, addresses and the table of experiments' names.
fn prose(readme: &str) -> String {
    let mut is_code = false;
    let lines = readme.lines().filter(|line| {
        is_code ^= line.starts_with("```");
        !is_code && !line.starts_with("```") && !line.contains("](")
    });
    lines.map(|line| line.split('`').step_by(2).collect::<String>()).collect::<Vec<_>>().join("\n")
}

#[test]
fn every_number_of_the_readme_is_kept() {
    let report = plain(&read("results/reference/study/report.html"));
    let readme = read("README.md");
    assert!(readme.split_whitespace().count() <= 700);
    // The three results are the report's own sentences.
    let results = readme.split("## Three results").nth(1).unwrap().split("\n\n").nth(1).unwrap();
    let results: Vec<String> = results
        .split("\n1. ")
        .flat_map(|part| part.split("\n2. "))
        .flat_map(|part| part.split("\n3. "))
        .map(|sentence| plain(sentence.trim_start_matches("1. ")))
        .collect();
    assert_eq!(results.len(), 3);
    for sentence in &results {
        assert!(report.contains(sentence.as_str()), "not in the kept report: {sentence}");
    }
    // What is no measurement: the year of the method, the compiler, targets that the table of experiments names, the licence.
    let others = ["1998", "1.95", "10", "3", "1", "2", "2.0"];
    let said: Vec<&str> = results.iter().flat_map(|sentence| numbers(sentence)).collect();
    for number in numbers(&prose(&readme)) {
        assert!(
            others.contains(&number) || said.contains(&number),
            "{number} is neither measured nor allowed"
        );
    }
}

/// The strip's pictures are those of the kept record, at the width of print, and its rival had the map's time.
#[test]
fn the_strip_is_what_was_printed() {
    let record: serde_json::Value = serde_json::from_str(&read("results/print/cornell-fog.json")).unwrap();
    assert_eq!(record["size"], serde_json::json!([960, 960]));
    let rival = record["rival"].as_str().unwrap();
    assert!(read("README.md").contains(&format!("| photon maps | {rival}, equal time | reference |")));
    let seconds = |of: &str| record[of]["seconds"].as_f64().unwrap();
    assert!((seconds("equal") / seconds("ours") - 1.0).abs() < 0.01);
    assert!(record["reference"][0].as_u64() > record["equal"]["samples"].as_u64());
}

/// What the kept report says of claims and of photon maps beside paths is in the kept tables.
#[test]
fn the_kept_report_says_what_its_tables_say() {
    let report = plain(&read("results/reference/study/report.html"));
    let mut claims = csv::Reader::from_path(root().join("results/reference/study/claims.csv")).unwrap();
    let mut count = 0;
    for record in claims.records() {
        let record = record.unwrap();
        let text = plain(
            &record[record.len() - 1].replace('&', "&amp;").replace('"', "&quot;").replace('<', "&lt;"),
        );
        assert!(report.contains(&text), "{text}");
        count += 1;
    }
    assert!(count > 100 && report.contains(&format!("All {count} claims in one table")), "{count}");
    let mut answers = csv::Reader::from_path(root().join("results/reference/study/answers.csv")).unwrap();
    for record in answers.records() {
        let record = record.unwrap();
        for (value, factor, unit) in [(2, 1.0, " ×"), (4, 1.0, " ×"), (6, 1.0, " queries"), (8, 100.0, " %")]
        {
            if let (Ok(value), Ok(error)) = (record[value].parse::<f64>(), record[value + 1].parse::<f64>()) {
                // Of a squared bias that came out below 0 an upper end is told.
                if value == 0.0 {
                    continue;
                }
                let said = with_rough_error(factor * value, factor * error) + unit;
                assert!(report.contains(&said), "{said} of {}", &record[0]);
            }
        }
    }
}

/// Every file that the pages show or link to is there.
#[test]
fn every_link_of_the_pages_leads_somewhere() {
    for page in
        ["README.md", "RENDERING.md", "BENCHMARKS.md", "ARCHITECTURE.md", "CONTRIBUTING.md", "TESTING.md"]
    {
        let text = read(page);
        for target in
            text.split("](").skip(1).filter_map(|rest| rest.split_once(')')).map(|(target, _)| target)
        {
            if !target.starts_with("http") {
                let file = target.split('#').next().unwrap();
                assert!(root().join(file).exists(), "{page} links to {target}");
            }
        }
    }
}

/// What BENCHMARKS.md says was printed is what a bench has printed.
#[test]
fn the_benchmarks_are_kept_outputs() {
    let kept: String = [
        "tree", "fogbox", "others", "guided", "pass", "maps", "lines", "plan", "memory", "growth", "limits",
        "referee",
    ]
    .map(|name| read(&format!("results/speed/{name}.txt")))
    .concat();
    let page = read("BENCHMARKS.md");
    let blocks: Vec<&str> =
        page.split("```text\n").skip(1).map(|rest| rest.split("\n```").next().unwrap()).collect();
    assert_eq!(blocks.len(), 15);
    for line in blocks.iter().flat_map(|block| block.lines()) {
        assert!(kept.lines().any(|kept| kept == line), "not printed by a bench: {line}");
    }
}
