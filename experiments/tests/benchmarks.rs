//! Benchmarks of other communities: quick sets say what they must, and the kept page is of the kept answers.
#![allow(clippy::unwrap_used, reason = "tests")]

use assert_cmd::Command;
use std::path::{Path, PathBuf};
use turbid_experiments::benchmarks::{Answered, Comparison, Verdict, sets};

/// The folder of the workspace.
fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap().to_path_buf()
}

fn benchmarks(args: &[&str], out: &Path) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_benchmarks"));
    command.args(args).arg("--out").arg(out);
    command
}

fn answered(folder: &Path, set: &str) -> Answered {
    let text = std::fs::read_to_string(folder.join(format!("{set}.json"))).unwrap();
    serde_json::from_str(&text).unwrap()
}

fn by<'a>(answered: &'a Answered, who: &str) -> &'a Comparison {
    answered.comparisons.iter().find(|c| c.by == who).unwrap()
}

/// Sets that take a second or two. Those whose numbers are not what they are said to be differ, and the page says why.
#[test]
fn quick_sets() {
    let folder = tempfile::tempdir().unwrap();
    const MAP: (&str, Verdict) = ("photon map", Verdict::Agrees);
    let quick = [
        ("van-de-hulst", vec![("exact", Verdict::Agrees), ("light tracing", Verdict::Agrees), MAP]),
        ("mie", vec![("exact", Verdict::Agrees), ("paths", Verdict::Agrees), MAP]),
        ("haze-l", vec![("exact", Verdict::Agrees), ("paths", Verdict::Agrees), MAP]),
        ("reed", vec![("exact", Verdict::Agrees), ("light tracing", Verdict::Agrees), MAP]),
        ("prahl", vec![("exact", Verdict::Differs), ("light tracing", Verdict::Agrees)]),
        ("emitting-cube", vec![("exact", Verdict::Open), ("paths against exact", Verdict::Agrees)]),
        ("kobayashi-1", vec![("exact, case i", Verdict::Agrees), ("paths, case i", Verdict::Agrees)]),
    ];
    let names: Vec<&str> = quick.iter().map(|(name, _)| *name).collect();
    benchmarks(&["--quick", "--only", &names.join(",")], folder.path()).assert().success();
    let page = std::fs::read_to_string(folder.path().join("index.html")).unwrap();
    for (name, verdicts) in quick {
        let answered = answered(folder.path(), name);
        for (who, verdict) in verdicts {
            let comparison = by(&answered, who);
            assert_eq!(comparison.verdict(), verdict, "{name} by {who}: p {:?}", comparison.p());
            // What agrees would not if ours were off by what it says it detects, with a margin: the test can fail.
            if verdict == Verdict::Agrees {
                let mut off = comparison.clone();
                let bias = 1.0 + 1.5 * comparison.detects().unwrap();
                off.rows.iter_mut().for_each(|row| row.ours *= bias);
                assert_eq!(off.verdict(), Verdict::Differs, "{name} by {who}");
            }
        }
        assert!(
            page.contains(&format!("id=\"{name}\"")) && folder.path().join(format!("{name}.png")).exists()
        );
    }
    assert!(!page.contains("It is not explained"));
    // Answered already, it takes what is there.
    let again = benchmarks(&["--quick", "--only", "prahl"], folder.path()).assert().success();
    assert!(String::from_utf8_lossy(&again.get_output().stderr).contains("prahl: answered already"));
}

/// Numbers of another code: right ones agree, wrong ones differ, and hostile tables get one line.
#[test]
fn numbers_of_another_code() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("theirs.csv");
    let out = folder.path().join("out");
    let of = |set: &str, text: &str| {
        std::fs::write(&file, text).unwrap();
        let theirs = format!("{set}={}", file.display());
        benchmarks(&["--quick", "--only", set, "--theirs", &theirs], &out).assert()
    };
    let run = |text: &str| of("emitting-cube", text);
    let refused = |run: assert_cmd::assert::Assert, words: &str| {
        let said = String::from_utf8(run.code(2).get_output().stderr.clone()).unwrap();
        let errors: Vec<&str> = said.lines().filter(|line| line.contains("error:")).collect();
        assert!(errors.len() == 1 && errors[0].contains(words), "{said}");
    };
    let head = "x,divergence,std_error\n";
    let exact =
        |x: f64| turbid_analytic::EmittingCube::BURNS_CHRISTON.divergence([x, 0.5, 0.5]).unwrap().value;
    for (factor, verdict) in [(1.0, Verdict::Agrees), (1.01, Verdict::Differs)] {
        let row = |x: f64| format!("{x},{:.8},0.001\n", factor * exact(x));
        run(&format!("{head}{}{}", row(0.5), row(0.25))).success();
        assert_eq!(by(&answered(&out, "emitting-cube"), "exact").verdict(), verdict);
    }
    for (text, words) in [
        (String::new(), "no column x"),
        ("x,divergence\n0.5,2\n".into(), "no column std_error"),
        (format!("{head}0.5,NaN,0\n"), "line 2: divergence is NaN"),
        (format!("{head}0.5,2,0\n0.5,2\n"), "line 3: 2 fields; needed: 3"),
        (format!("{head}{}", "0.5,2,0\n".repeat(200_000)), "more than 100000 rows"),
        (format!("{head}7,2,0\n"), "x is 7"),
        (format!("{head}0.5,2,-0.1\n"), "line 2: std_error is -0.1; allowed: at least 0"),
    ] {
        refused(run(&text), words);
    }
    let flux = "case,set,x_cm,y_cm,z_cm,flux,rel_std_error\niii,2A,5,5,5,1,0\n";
    refused(of("kobayashi-2", flux), "line 2: case is iii; allowed: i or ii");
    // What was compared with numbers of the user's is not taken for an answer without them.
    let row = |x: f64| format!("{x},{:.8},0.001\n", exact(x));
    run(&format!("{head}{}", row(0.5))).success();
    let again = benchmarks(&["--quick", "--only", "emitting-cube"], &out).assert().success();
    assert!(!String::from_utf8_lossy(&again.get_output().stderr).contains("answered already"));
    assert_eq!(by(&answered(&out, "emitting-cube"), "exact").verdict(), Verdict::Open);
}

/// The kept page is what the program writes from the kept answers; every difference on it has its reason.
#[test]
fn the_kept_page_shows_the_kept_answers() {
    let kept = root().join("results/benchmarks");
    let folder = tempfile::tempdir().unwrap();
    for set in sets::ALL {
        let file = format!("{}.json", set.name);
        std::fs::copy(kept.join(&file), folder.path().join(&file)).unwrap();

        for comparison in answered(&kept, set.name).comparisons {
            let is_explained = set.explained.iter().any(|(by, _)| *by == comparison.by);
            assert!(
                comparison.verdict() != Verdict::Differs || is_explained,
                "{} by {}",
                set.name,
                comparison.by
            );
        }
    }
    benchmarks(&["--page"], folder.path()).assert().success();
    let of_sets = sets::ALL.iter().flat_map(|set| ["png", "csv"].map(|end| format!("{}.{end}", set.name)));
    for file in of_sets.chain(["index.html".to_string()]) {
        let (made, kept) = (folder.path().join(&file), kept.join(&file));
        assert!(
            std::fs::read(made).unwrap() == std::fs::read(kept).unwrap(),
            "benchmarks --page writes another {file}"
        );
    }
}
