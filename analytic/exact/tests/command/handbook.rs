//! The handbook shows what the command answers: examples and figures are made again and compared with those kept.
//!
//! After a change that is meant: `TURBID_BLESS=1 cargo test --release -p turbid-exact --test command handbook` writes them anew.
//! Look at what it changed. Last digits may differ between processors, since products of matrices use their instructions:
//! numbers are compared to 1e-8, bounds within a factor of 30, places in figures within two units of the canvas.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

fn folder() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../handbook")
}

fn exact(args: &[&str], at: &Path) -> std::process::Output {
    Command::new(env!("CARGO_BIN_EXE_exact")).args(args).current_dir(at).output().unwrap()
}

fn files(ending: &str) -> Vec<String> {
    let names = fs::read_dir(folder()).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap());
    let mut names: Vec<String> = names.filter(|name| name.ends_with(ending)).collect();
    names.sort();
    names
}

/// A page whose examples are made again in `scratch`: its text with their outputs in place of those kept.
fn renewed(page: &str, scratch: &Path) -> String {
    let text = fs::read_to_string(folder().join(page)).unwrap();
    let (mut out, mut in_console, mut in_output) = (String::new(), false, false);
    for line in text.lines() {
        if line == "```console" {
            in_console = true;
        } else if line == "```" {
            (in_console, in_output) = (false, false);
        }
        if let (true, Some(command)) = (in_console, line.strip_prefix("$ exact ")) {
            let output = exact(&command.split_whitespace().collect::<Vec<_>>(), scratch);
            let error = String::from_utf8_lossy(&output.stderr);
            assert!(output.status.success(), "{page}: {command}: {error}");
            out += &format!("{line}\n{}", String::from_utf8(output.stdout).unwrap());
            in_output = true;
        } else if !in_output {
            out += &format!("{line}\n");
        }
    }
    out
}

/// Cuts a text where numbers begin and end.
fn numbers(text: &str) -> (String, Vec<f64>) {
    let (mut words, mut numbers) = (String::new(), Vec::new());
    let mut rest = text;
    while let Some(at) = rest.find(|c: char| c.is_ascii_digit() || c == '-') {
        words += &rest[..at];
        let mut length =
            rest[at..].find(|c: char| !c.is_ascii_digit() && !"-.".contains(c)).unwrap_or(rest.len() - at);
        // One minus sign, and only in front.
        length = rest[at + 1..at + length].find('-').map_or(length, |next| next + 1);
        match rest[at..at + length].parse() {
            Ok(number) => {
                numbers.push(number);
                words.push('#');
            }
            Err(_) => words += &rest[at..at + length],
        }
        rest = &rest[at + length..];
    }
    (words + rest, numbers)
}

fn same_figure(kept: &str, made: &str) -> bool {
    let ((kept_words, kept), (made_words, made)) = (numbers(kept), numbers(made));
    kept_words == made_words && kept.iter().zip(&made).all(|(a, b)| (a - b).abs() <= 2.0)
}

fn same_word(kept: &str, made: &str) -> bool {
    let bound = |word: &str| word.len() >= 3 && word.as_bytes()[1] == b'e';
    match (kept.parse::<f64>(), made.parse::<f64>()) {
        _ if kept == made => true,
        (Ok(a), Ok(b)) if bound(kept) && bound(made) => a <= 30.0 * b && b <= 30.0 * a,
        (Ok(a), Ok(b)) => (a - b).abs() <= 1e-8 * a.abs().max(b.abs()),
        _ => false,
    }
}

fn same_line(kept: &str, made: &str) -> bool {
    let (kept, made): (Vec<_>, Vec<_>) =
        (kept.split_whitespace().collect(), made.split_whitespace().collect());
    kept.len() == made.len() && kept.iter().zip(&made).all(|(a, b)| same_word(a, b))
}

#[test]
fn examples_and_figures_are_what_the_command_makes() {
    let scratch = tempfile::tempdir().unwrap();
    // What examples read.
    for name in files(".txt").iter().chain(&files(".csv")) {
        fs::copy(folder().join(name), scratch.path().join(name)).unwrap();
    }
    let bless = std::env::var_os("TURBID_BLESS").is_some();
    let mut figures = Vec::new();
    for page in files(".md") {
        let (kept, made) =
            (fs::read_to_string(folder().join(&page)).unwrap(), renewed(&page, scratch.path()));
        if bless {
            if kept != made {
                fs::write(folder().join(&page), &made).unwrap();
            }
        } else {
            let (kept, made): (Vec<_>, Vec<_>) = (kept.lines().collect(), made.lines().collect());
            for (i, (a, b)) in kept.iter().zip(&made).enumerate() {
                assert!(same_line(a, b), "{page}:{}: kept\n{a}\nmade\n{b}", i + 1);
            }
            assert_eq!(kept.len(), made.len(), "{page} has lines too few or too many");
        }
        let commands = made.lines().filter(|line| line.starts_with("$ exact "));
        let drawn = commands.filter_map(|line| line.split_once("--plot ")?.1.split_whitespace().next());
        figures.extend(drawn.map(String::from));
        for name in
            made.split("](").skip(1).filter_map(|rest| rest.split(')').next()).filter(|n| n.ends_with(".svg"))
        {
            assert!(made.contains(&format!("--plot {name}")), "{page}: no example draws {name}");
        }
    }
    for name in &figures {
        let made = fs::read_to_string(scratch.path().join(name)).unwrap();
        if bless {
            fs::write(folder().join(name), made).unwrap();
        } else {
            let kept = fs::read_to_string(folder().join(name)).unwrap();
            assert!(same_figure(&kept, &made), "{name} is not what the command draws");
        }
    }
    figures.sort();
    assert_eq!(figures, files(".svg"), "a figure that no page makes, or one made twice");
}

/// Every problem that can be asked has a page, and the index leads to every page.
#[test]
fn every_problem_has_a_page() {
    let help = exact(&["--help"], &folder()).stdout;
    let help = String::from_utf8(help).unwrap();
    let commands = help.split_once("Commands:\n").unwrap().1.split_once("\n\n").unwrap().0;
    let index = fs::read_to_string(folder().join("README.md")).unwrap();
    let pages = files(".md");
    for command in commands.lines().filter_map(|line| line.split_whitespace().next()).filter(|c| *c != "help")
    {
        let shown = pages
            .iter()
            .any(|p| fs::read_to_string(folder().join(p)).unwrap().contains(&format!("$ exact {command} ")));
        assert!(shown, "no page has an example of exact {command}");
    }
    for page in pages.iter().filter(|p| *p != "README.md") {
        assert!(index.contains(&format!("]({page})")), "the index lacks {page}");
    }
}

/// The comparison sees what it should.
#[test]
fn a_wrong_digit_is_seen() {
    assert!(same_line("fluence  0.5  0.12345678901  3e-12", "fluence 0.5 0.12345678902  1e-12"));
    assert!(!same_line("fluence  0.5  0.12345678901  3e-12", "fluence 0.5 0.12345687901  3e-12"));
    assert!(!same_line("fluence  0.5  0.1234  3e-12", "fluence 0.5 0.1234  3e-9"));
    assert!(!same_line("fluence  0.5", "flux  0.5"));
    assert!(same_figure("M10,20h5v-3 L7-8", "M11,20h5v-3 L7-9") && !same_figure("M10,20", "M10,30"));
    assert!(!same_figure("M10,20", "L10,20") && !same_figure("M10,20", "M10,20 30"));
}
