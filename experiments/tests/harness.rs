//! Laws of the harness, on an experiment whose answer is known.
#![allow(clippy::unwrap_used, reason = "tests")]

mod fake;

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::atomic::{AtomicUsize, Ordering};
use turbid_experiments::harness::{
    CellId, CellOutput, Claim, Closing, Estimate, Experiment, Group, Outcome, Preset, Replot, Section,
    SectionReport, Settings, Study, Unit, Verdict, Watch, replot, run, run_watched,
};

fn settings(out: &Path) -> Settings {
    Settings { threads: 2, ..Settings::new(out) }
}

fn read(folder: &Path, name: &str) -> Vec<u8> {
    fs::read(folder.join(name)).unwrap()
}

/// All results that must be functions of settings and seed: name and content.
fn results(out: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut files: BTreeMap<String, Vec<u8>> =
        ["results.csv", "claims.csv", "predictions.csv", "headlines.csv", "numbers.tex"]
            .iter()
            .map(|name| (name.to_string(), read(out, name)))
            .collect();
    for entry in fs::read_dir(out.join("figures")).unwrap() {
        let path = entry.unwrap().path();
        files.insert(path.file_name().unwrap().to_str().unwrap().to_string(), fs::read(path).unwrap());
    }
    files
}

fn cell_files(out: &Path) -> Vec<PathBuf> {
    let mut paths: Vec<PathBuf> =
        fs::read_dir(out.join("cells/fake")).unwrap().map(|e| e.unwrap().path()).collect();
    paths.retain(|p| p.file_name().unwrap() != "predictions.csv");
    paths.sort();
    paths
}

fn verdicts(outcome: &Outcome) -> Vec<(String, Verdict)> {
    outcome.sections.iter().flat_map(|s| &s.judged).map(|j| (j.claim.id.clone(), j.verdict)).collect()
}

/// The bits of an undisturbed run on one thread.
fn undisturbed() -> BTreeMap<String, Vec<u8>> {
    let folder = tempfile::tempdir().unwrap();
    run(&fake::study(), &Settings { threads: 1, ..settings(folder.path()) }).unwrap();
    results(folder.path())
}

/// Ends a study after so many cells.
struct After(usize, AtomicUsize);

impl Watch for After {
    fn say(&self, _: &str) {}
    fn begin(&self, cells: usize) {
        assert_eq!(cells, 64);
    }
    fn advance(&self, part: f64) {
        assert!((part - 1.0 / 64.0).abs() < 1e-15);
        self.1.fetch_add(1, Ordering::SeqCst);
    }
    fn finish(&self) {}
    fn is_cancelled(&self) -> bool {
        self.1.load(Ordering::SeqCst) >= self.0
    }
}

/// A study that is ended between cells keeps them, concludes nothing, and goes on from there.
#[test]
fn whoever_watches_may_end_it() {
    let folder = tempfile::tempdir().unwrap();
    let watch = After(10, AtomicUsize::new(0));
    let error = run_watched(&fake::study(), &settings(folder.path()), &watch).unwrap_err();
    assert_eq!(error.downcast_ref(), Some(&turbid::Error::Cancelled));
    let kept = cell_files(folder.path()).len();
    // Each of two threads may have had one in work.
    assert!((10..=11).contains(&kept), "{kept}");
    assert!(!folder.path().join("report.html").exists() && !folder.path().join("results.csv").exists());
    assert_eq!(run(&fake::study(), &settings(folder.path())).unwrap().measured, 64 - kept);
    assert_eq!(results(folder.path()), undisturbed());
}

#[test]
fn right_is_upheld_wrong_is_rejected_and_the_negative_control_is_detected() {
    let folder = tempfile::tempdir().unwrap();
    let outcome = run(&fake::study(), &settings(folder.path())).unwrap();
    let expected = [
        ("amplitude", Verdict::Upheld),
        ("residual", Verdict::Undecided),
        ("wrong", Verdict::Rejected),
        ("control", Verdict::Upheld),
    ];
    assert_eq!(verdicts(&outcome), expected.map(|(id, verdict)| (id.to_string(), verdict)));
    assert_eq!((outcome.measured, outcome.strict_code()), (64, 1));
    let undecided = &outcome.sections[0].judged[1];
    assert!(undecided.advice.contains("maps of this size would decide"), "{}", undecided.advice);
    for name in [
        "report.html",
        "results.csv",
        "claims.csv",
        "predictions.csv",
        "timing.csv",
        "provenance.json",
        "figures/fake-bias.svg",
    ] {
        assert!(folder.path().join(name).exists(), "{name}");
    }
    let table = String::from_utf8(read(folder.path(), "results.csv")).unwrap();
    let header = "experiment,case,quantity,field,photons,depth,radius,k,kernel,unit,n,mean,std_error,vov,predicted,reference,reference_error,z,p,verdict,cost,cost_unit";
    assert_eq!(table.lines().next().unwrap(), header);
    assert_eq!(table.lines().count(), 6);
    assert!(table.contains(",640000,photons"));
}

#[test]
fn results_are_the_same_bits_on_any_number_of_threads() {
    let expected = undisturbed();
    for threads in [2, 4] {
        let folder = tempfile::tempdir().unwrap();
        run(&fake::study(), &Settings { threads, ..settings(folder.path()) }).unwrap();
        assert_eq!(results(folder.path()), expected, "{threads} threads");
    }
}

#[test]
fn another_seed_gives_other_results() {
    let folder = tempfile::tempdir().unwrap();
    run(&fake::study(), &Settings { seed: 2, ..settings(folder.path()) }).unwrap();
    assert_ne!(results(folder.path())["results.csv"], undisturbed()["results.csv"]);
}

#[test]
fn a_failed_cell_keeps_the_others_and_the_next_run_goes_on() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("fail"), b"").unwrap();
    let other =
        Experiment { name: "other", groups: |settings| fake::group(settings, unfailing), ..fake::FAKE };
    let both = Study { experiments: &[fake::FAKE, other], ..fake::study() };
    let outcome = run(&both, &settings(folder.path())).unwrap();
    assert_eq!(failure(&outcome), Some("cell slab-000040 of fake: asked to fail"));
    assert_eq!((outcome.sections[1].judged.len(), outcome.strict_code()), (4, 1));
    let page = String::from_utf8(read(folder.path(), "report.html")).unwrap();
    assert!(page.contains("No conclusion: cell slab-000040 of fake: asked to fail."));
    let kept = cell_files(folder.path()).len();
    assert!((40..64).contains(&kept), "{kept}");
    assert_eq!(outcome.measured, 64 + kept);
    fs::remove_file(folder.path().join("fail")).unwrap();
    fs::remove_dir_all(folder.path().join("figures")).unwrap();
    let outcome = run(&fake::study(), &settings(folder.path())).unwrap();
    assert_eq!(outcome.measured, 64 - kept);
    assert_eq!(results(folder.path()), undisturbed());
}

/// Why the first section has no conclusion.
fn failure(outcome: &Outcome) -> Option<&str> {
    outcome.sections[0].failure.as_deref()
}

/// Measures in spite of what the folder asks for.
fn unfailing(settings: &Settings, cell: &CellId) -> anyhow::Result<CellOutput> {
    let folder = tempfile::tempdir()?;
    fs::write(folder.path().join("predictions.csv"), b"")?;
    fake::measure(&Settings { out: folder.path().to_path_buf(), ..settings.clone() }, cell)
}

const ABORT_IN: &str = "TURBID_TEST_ABORT_IN";

/// Not a test by itself: the process that the next one starts, to die in the middle of a study.
#[test]
fn child_that_aborts() {
    if let Some(folder) = std::env::var_os(ABORT_IN) {
        let _never = run(&fake::study(), &settings(Path::new(&folder)));
    }
}

#[test]
fn a_killed_process_is_resumed_to_the_same_bits() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path();
    fs::write(out.join("abort"), b"").unwrap();
    let child = Command::new(std::env::current_exe().unwrap())
        .args(["--exact", "child_that_aborts", "--test-threads=1"])
        .env(ABORT_IN, out)
        .output()
        .unwrap();
    assert!(!child.status.success());
    fs::remove_file(out.join("abort")).unwrap();
    let kept = cell_files(out);
    assert!((30..64).contains(&kept.len()), "{}", kept.len());
    // Whatever else a crash can do to files: one cut short, one empty, one lost.
    let bytes = fs::read(&kept[0]).unwrap();
    fs::write(&kept[0], &bytes[..bytes.len() / 2]).unwrap();
    fs::write(&kept[1], b"").unwrap();
    fs::remove_file(&kept[2]).unwrap();
    let outcome = run(&fake::study(), &settings(out)).unwrap();
    assert_eq!(outcome.measured, 64 - (kept.len() - 3));
    assert_eq!(results(out), undisturbed());
    // The record says that predictions came first.
    assert!(!String::from_utf8(read(out, "provenance.json")).unwrap().contains("\"late_predictions\": true"));
}

#[test]
fn a_finished_study_only_redraws() {
    let folder = tempfile::tempdir().unwrap();
    run(&fake::study(), &settings(folder.path())).unwrap();
    let stamps = |out: &Path| -> Vec<_> {
        let written = |p: &Path| fs::metadata(p).unwrap().modified().unwrap();
        cell_files(out).iter().map(|p| written(p)).chain([written(&out.join("predictions.csv"))]).collect()
    };
    let names = ["report.html", "results.csv", "timing.csv", "provenance.json"];
    let before = (stamps(folder.path()), names.map(|n| read(folder.path(), n)));
    fs::remove_file(folder.path().join("report.html")).unwrap();
    let outcome = run(&fake::study(), &settings(folder.path())).unwrap();
    assert_eq!(outcome.measured, 0);
    assert_eq!((stamps(folder.path()), names.map(|n| read(folder.path(), n))), before);
}

#[test]
fn cells_of_another_build_or_other_settings_are_not_reused() {
    let folder = tempfile::tempdir().unwrap();
    let measured = |program: &str, settings: &Settings| {
        let study = Study { program: program.to_string(), ..fake::study() };
        let outcome = run(&study, settings).unwrap();
        let record: serde_json::Value =
            serde_json::from_slice(&read(folder.path(), "provenance.json")).unwrap();
        (outcome.measured, record["foreign"].as_u64().unwrap())
    };
    let plain = settings(folder.path());
    assert_eq!(measured("program-1", &plain), (64, 0));
    assert_eq!(measured("program-1", &plain), (0, 0));
    assert_eq!(measured("program-2", &plain), (64, 0));
    // The build may be overridden, and that is recorded; settings may not.
    let reuse = Settings { reuse_cells: true, ..plain.clone() };
    assert_eq!(measured("program-3", &reuse), (0, 64));
    assert_eq!(measured("program-3", &Settings { seed: 5, ..reuse }), (64, 0));
    assert_eq!(measured("program-3", &Settings { seed: 5, fresh: true, ..plain }), (64, 0));
}

#[test]
fn a_folder_without_a_manifest_is_not_emptied() {
    let folder = tempfile::tempdir().unwrap();
    let precious = folder.path().join("cells/precious.txt");
    fs::create_dir_all(precious.parent().unwrap()).unwrap();
    fs::write(&precious, b"mine").unwrap();
    run(&fake::study(), &Settings { fresh: true, ..settings(folder.path()) }).unwrap();
    assert!(precious.exists());
}

#[test]
fn non_finite_values_fail_their_experiment() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("broken"), b"").unwrap();
    let outcome = run(&fake::study(), &settings(folder.path())).unwrap();
    let expected = "1 non-finite contributions in cell slab-000000 of fake; allowed: 0";
    assert_eq!((failure(&outcome), verdicts(&outcome).len()), (Some(expected), 0));
    assert_eq!(outcome.strict_code(), 3);
}

#[test]
fn a_panic_in_a_cell_is_told_with_its_name() {
    let panicking = Experiment {
        groups: |settings| fake::group(settings, |_, cell| panic!("replicate {}", cell.replicate)),
        ..fake::FAKE
    };
    let folder = tempfile::tempdir().unwrap();
    let study = Study { experiments: &[panicking], ..fake::study() };
    let outcome = run(&study, &settings(folder.path())).unwrap();
    let said = failure(&outcome).unwrap();
    assert!(said.starts_with("cell slab-0000") && said.contains(" of fake: internal error"), "{said}");
    assert!(
        said.contains(": replicate ") && outcome.sections[0].section.summary[0].contains("Please report it")
    );
}

/// Maps that share their random numbers are not independent, however many there are: measured twice, or all the same.
#[test]
fn a_map_measured_twice_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let in_pairs = Experiment {
        groups: |settings| {
            fake::group(settings, |settings, cell| {
                fake::measure(settings, &CellId { replicate: cell.replicate / 2, ..cell.clone() })
            })
        },
        ..fake::FAKE
    };
    let all_alike = Experiment {
        groups: |settings| {
            fake::group(settings, |settings, cell| {
                fake::measure(settings, &CellId { replicate: 7, ..cell.clone() })
            })
        },
        ..fake::FAKE
    };
    for experiment in [in_pairs, all_alike] {
        let study = Study { experiments: &[experiment], ..fake::study() };
        let fresh = Settings { fresh: true, ..settings(folder.path()) };
        let outcome = run(&study, &fresh).unwrap();
        let expected =
            "cells slab-000000 and slab-000001 of fake measured the same numbers: they are one map, not two";
        assert_eq!((failure(&outcome), verdicts(&outcome).len()), (Some(expected), 0));
    }
}

/// No two cells of the whole study draw from one stream, short or full.
#[test]
fn every_cell_has_a_stream_of_its_own() {
    for preset in [Preset::Quick, Preset::Full] {
        let settings = Settings { preset, ..Settings::new("unused") };
        let mut streams = std::collections::HashMap::new();
        for experiment in turbid_experiments::ALL {
            for cell in (experiment.groups)(&settings).iter().flat_map(Group::cells) {
                let name = format!("{} of {}", cell.id(), experiment.name);
                if let Some(other) = streams.insert(cell.stream(experiment.name), name.clone()) {
                    panic!("{name} draws the numbers of {other}");
                }
            }
        }
        assert!(streams.len() > 1000, "{}", streams.len());
    }
}

#[test]
fn cell_names_are_checked() {
    let folder = tempfile::tempdir().unwrap();
    fn one(name: &str) -> Group {
        Group::new(name, 1, 1.0, fake::measure)
    }
    let twice = Experiment { groups: |_| vec![one("a"), one("a")], ..fake::FAKE };
    let unsafe_name = Experiment { groups: |_| vec![one("../a")], ..fake::FAKE };
    let same_numbers = Experiment { groups: |_| vec![one("a"), one("b").with_stream("a")], ..fake::FAKE };
    let cases = [
        (twice, "two cells are called a-000000"),
        (same_numbers, "b-000000 draws the random numbers of another group, a"),
        (unsafe_name, "no name for a file"),
    ];
    for (experiment, text) in cases {
        let study = Study { experiments: &[experiment], ..fake::study() };
        let outcome = run(&study, &settings(folder.path())).unwrap();
        assert!(failure(&outcome).is_some_and(|said| said.contains(text)), "{:?}", failure(&outcome));
    }
}

#[test]
fn only_chooses_experiments_and_knows_their_names() {
    let other = Experiment { name: "other", ..fake::FAKE };
    let folder = tempfile::tempdir().unwrap();
    let study = Study { experiments: &[fake::FAKE, other], ..fake::study() };
    let only = |name: &str| Settings { only: vec![name.to_string()], ..settings(folder.path()) };
    let error = run(&study, &only("bais")).unwrap_err().to_string();
    assert_eq!(error, "there is no experiment bais; there are: fake, other");
    assert_eq!(run(&study, &only("other")).unwrap().measured, 64);
    // The whole study takes what is there, and the predictions of neither came late.
    assert_eq!(run(&study, &settings(folder.path())).unwrap().measured, 64);
    assert!(
        String::from_utf8(read(folder.path(), "provenance.json"))
            .unwrap()
            .contains("\"late_predictions\": false")
    );
}

/// A folder is one study's at a time, whatever becomes of that one.
#[test]
fn a_folder_holds_one_study_at_a_time() {
    let folder = tempfile::tempdir().unwrap();
    let held = fs::File::create(folder.path().join(".lock")).unwrap();
    held.lock().unwrap();
    let error = run(&fake::study(), &settings(folder.path())).unwrap_err().to_string();
    assert!(error.starts_with("another study is at work in ") && error.contains("allowed: "), "{error}");
    assert!(!folder.path().join("cells").exists());
    // Nor are figures redrawn meanwhile.
    fs::create_dir(folder.path().join("figures")).unwrap();
    let error = replot(&settings(folder.path()), &Replot::default()).unwrap_err().to_string();
    assert!(error.starts_with("another study is at work in "), "{error}");
    drop(held);
    assert_eq!(run(&fake::study(), &settings(folder.path())).unwrap().measured, 64);
}

/// A map that cannot fit is refused in a line, with the scale that would, before anything is predicted.
#[cfg(target_os = "linux")]
#[test]
fn what_does_not_fit_is_refused_before_the_work() {
    let large = Experiment {
        groups: |settings| {
            vec![Group::new("a", 1, 1.0, fake::measure).holding(settings.photons(1_000_000, 1))]
        },
        predict: |_| panic!("predicted"),
        ..fake::FAKE
    };
    let folder = tempfile::tempdir().unwrap();
    let study = Study { experiments: &[large], ..fake::study() };
    let scaled = |photon_scale: f64| run(&study, &Settings { photon_scale, ..settings(folder.path()) });
    let error = scaled(1e6).unwrap_err().to_string();
    assert!(error.starts_with("a map of 1000000000000 photons takes "), "{error}");
    let allowed: f64 = error.rsplit(' ').next().unwrap().replace(',', "").parse().unwrap();
    assert!(allowed > 1.0 && allowed < 1e6, "{error}");
    assert!(failure(&scaled(1.0).unwrap()).unwrap().ends_with("predicted"));
}

/// What cannot be written, or is not a file, ends in one line before anything is measured.
#[cfg(unix)]
#[test]
fn outputs_are_tried_before_the_work() {
    for (name, said) in [
        ("report.html", "cannot write {}: a folder, a device or a pipe; allowed: a file"),
        ("numbers.tex", "cannot write {}: a folder, a device or a pipe; allowed: a file"),
        ("results.csv", "cannot write {}: a folder, a device or a pipe; allowed: a file"),
        ("figures", "cannot create {}: File exists (os error 17)"),
        ("cells/manifest.json", "cannot read {}: a folder, a device or a pipe; allowed: a file"),
        (".lock", "cannot write {}: a folder, a device or a pipe; allowed: a file"),
    ] {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(name);
        if name == "figures" {
            fs::write(&path, b"").unwrap();
        } else {
            fs::create_dir_all(&path).unwrap();
        }
        let error = format!("{:#}", run(&fake::study(), &settings(folder.path())).unwrap_err());
        assert_eq!(error, said.replace("{}", &path.display().to_string()));
        assert!(!folder.path().join("cells/fake").exists(), "{name}");
    }
}

/// Pipes that nobody writes to are not waited for: the record of an earlier run, and the report that is redrawn.
#[cfg(unix)]
#[test]
fn pipes_are_no_notes() {
    let pipe = |path: &Path| {
        fs::remove_file(path).unwrap();
        assert!(Command::new("mkfifo").arg(path).status().unwrap().success());
    };
    let folder = tempfile::tempdir().unwrap();
    let own = settings(folder.path());
    run(&fake::study(), &own).unwrap();
    pipe(&folder.path().join("report.html"));
    let error = format!("{:#}", replot(&own, &Replot::default()).unwrap_err());
    assert!(error.ends_with("report.html: a folder, a device or a pipe; allowed: a file"), "{error}");
    pipe(&folder.path().join("provenance.json"));
    pipe(&folder.path().join("figures/fake-bias.svg"));
    fs::remove_file(folder.path().join("report.html")).unwrap();
    let error = format!("{:#}", run(&fake::study(), &own).unwrap_err());
    assert!(error.contains("a folder, a device or a pipe"), "{error}");
}

/// A cell of other settings that comes into the folder after its cells were looked through.
#[test]
fn cells_of_two_seeds_do_not_mix() {
    let intruded = Experiment {
        groups: |settings| {
            fake::group(settings, |settings, cell| {
                if cell.replicate == 40 {
                    fs::copy(
                        settings.out.join("other.csv"),
                        settings.out.join("cells/fake/slab-000000.csv"),
                    )?;
                }
                fake::measure(settings, cell)
            })
        },
        ..fake::FAKE
    };
    let (other, folder) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    run(&fake::study(), &Settings { seed: 2, ..settings(other.path()) }).unwrap();
    fs::copy(other.path().join("cells/fake/slab-000000.csv"), folder.path().join("other.csv")).unwrap();
    let study = Study { experiments: &[intruded], ..fake::study() };
    let one = Settings { threads: 1, ..settings(folder.path()) };
    let outcome = run(&study, &one).unwrap();
    let said = failure(&outcome).unwrap();
    assert!(said.contains("by other settings (quick, seed 2, not quick, seed 100)"), "{said}");
}

/// A whole cell of another experiment, under the name of one of this.
#[test]
fn cells_of_two_experiments_do_not_mix() {
    let intruded = Experiment {
        groups: |settings| {
            fake::group(settings, |settings, cell| {
                if cell.replicate == 40 {
                    let from = settings.out.join("cells/other/slab-000000.csv");
                    fs::copy(from, settings.out.join("cells/fake/slab-000000.csv"))?;
                }
                fake::measure(settings, cell)
            })
        },
        ..fake::FAKE
    };
    let other = Experiment { name: "other", ..fake::FAKE };
    let folder = tempfile::tempdir().unwrap();
    let one = Settings { threads: 1, ..settings(folder.path()) };
    run(&Study { experiments: &[other], ..fake::study() }, &one).unwrap();
    let outcome = run(&Study { experiments: &[intruded], ..fake::study() }, &one).unwrap();
    assert_eq!(failure(&outcome), Some("cell slab-000000 of fake is that of other"));
}

/// An experiment that cannot predict or conclude, or panics there, says so; the others and the report stand.
#[test]
fn an_experiment_without_a_conclusion_stops_no_other() {
    let mute =
        Experiment { name: "mute", conclude: |_, _, _| anyhow::bail!("panel 2 is empty"), ..fake::FAKE };
    let rash = Experiment { name: "rash", conclude: |_, _, _| panic!("3 of 2"), ..fake::FAKE };
    let blind = Experiment { name: "blind", predict: |_| anyhow::bail!("no field"), ..fake::FAKE };
    let folder = tempfile::tempdir().unwrap();
    let lost = Experiment { name: "lost", groups: |_| panic!("no cell"), ..fake::FAKE };
    let twice = Experiment {
        name: "twice",
        conclude: |settings, predictions, cells| {
            let mut section = (fake::FAKE.conclude)(settings, predictions, cells)?;
            section.claims[1].id = section.claims[0].id.clone();
            Ok(section)
        },
        ..fake::FAKE
    };
    let study = Study { experiments: &[mute, rash, blind, lost, twice, fake::FAKE], ..fake::study() };
    let outcome = run(&study, &settings(folder.path())).unwrap();
    let failures: Vec<Option<&str>> = outcome.sections.iter().map(|s| s.failure.as_deref()).collect();
    let expected = [
        "panel 2 is empty",
        "internal error: 3 of 2",
        "predictions of blind: no field",
        "internal error: no cell",
        "two claims have the same name, amplitude",
    ];
    assert_eq!((&failures[..5], failures[5]), (&expected.map(Some)[..], None));
    assert_eq!((outcome.measured, outcome.sections[5].judged.len()), (4 * 64, 4));
    let page = String::from_utf8(read(folder.path(), "report.html")).unwrap();
    assert!(page.contains("No conclusion: panel 2 is empty."));
    // Where photons are so few that two sizes are one, too.
    let double = Experiment {
        name: "double",
        groups: |settings| [(fake::FAKE.groups)(settings), (fake::FAKE.groups)(settings)].concat(),
        ..fake::FAKE
    };
    let few = tempfile::tempdir().unwrap();
    let study = Study { experiments: &[double, fake::FAKE], ..fake::study() };
    let outcome = run(&study, &Settings { photon_scale: 0.1, ..settings(few.path()) }).unwrap();
    let said = outcome.sections[0].failure.as_deref();
    assert_eq!(
        said,
        Some("double: two cells are called slab-000000: at this --photons two numbers of photons are one")
    );
    assert_eq!((outcome.sections[0].cells.0, outcome.measured), (0, 64));
    let alone = Study { experiments: &[mute], ..fake::study() };
    let only = Settings { only: vec!["mute".to_string()], ..settings(folder.path()) };
    assert_eq!(run(&alone, &only).unwrap().strict_code(), 3);
}

/// `--fresh --only` forgets the cells of the experiments that it names.
#[test]
fn fresh_leaves_the_cells_of_others() {
    let other = Experiment { name: "other", ..fake::FAKE };
    let folder = tempfile::tempdir().unwrap();
    let study = Study { experiments: &[fake::FAKE, other], ..fake::study() };
    let plain = settings(folder.path());
    assert_eq!(run(&study, &plain).unwrap().measured, 128);
    let fresh = Settings { fresh: true, only: vec!["other".to_string()], ..plain.clone() };
    assert_eq!(run(&study, &fresh).unwrap().measured, 64);
    assert_eq!(run(&study, &plain).unwrap().measured, 0);
}

/// Says how many rows the sections before it have, and claims it if there are any settings to run all of them.
fn count_rows(settings: &Settings, sections: &[SectionReport]) -> anyhow::Result<Section> {
    let rows: usize = sections.iter().map(|s| s.section.rows.len()).sum();
    let statistic = Estimate::exact(rows as f64, 0.0);
    let claim = Claim::within("rows", "rows of all sections", Unit::ONE, statistic, 5.0, 5.0);
    let claims = if settings.only.is_empty() { vec![claim] } else { Vec::new() };
    Ok(Section { summary: vec![format!("There are {rows} rows.")], claims, ..Section::default() })
}

#[test]
fn a_closing_section_sees_all_others_and_is_judged_with_them() {
    let closing = Closing { name: "closing", title: "In all", question: "How many?", conclude: count_rows };
    let closings = [closing];
    let study = Study { closings: &closings, ..fake::study() };
    let folder = tempfile::tempdir().unwrap();
    let outcome = run(&study, &settings(folder.path())).unwrap();
    // First in the report, and one more claim for the family.
    let names =
        |outcome: &Outcome| -> Vec<&str> { outcome.sections.iter().map(|s| s.experiment.name).collect() };
    assert_eq!(names(&outcome), ["closing", "fake"]);
    assert_eq!(outcome.sections[0].judged[0].verdict, Verdict::Upheld);
    assert_eq!(verdicts(&outcome).len(), 5);
    let claims = String::from_utf8(read(folder.path(), "claims.csv")).unwrap();
    assert!(claims.lines().nth(1).unwrap().starts_with("closing,rows"));
    // Without a claim it is a line at the end.
    let only = Settings { only: vec!["fake".to_string()], ..settings(folder.path()) };
    let outcome = run(&study, &only).unwrap();
    assert_eq!(names(&outcome), ["fake", "closing"]);
    assert!(String::from_utf8(read(folder.path(), "report.html")).unwrap().contains("There are 5 rows."));
}

#[test]
fn predictions_that_come_late_are_on_record() {
    let folder = tempfile::tempdir().unwrap();
    run(&fake::study(), &settings(folder.path())).unwrap();
    let wiser = Experiment {
        predict: |settings| {
            let mut predictions = (fake::FAKE.predict)(settings)?;
            predictions[0].value *= 1.5;
            Ok(predictions)
        },
        ..fake::FAKE
    };
    for _ in 0..2 {
        run(&Study { experiments: &[wiser], ..fake::study() }, &settings(folder.path())).unwrap();
        let page = String::from_utf8(read(folder.path(), "report.html")).unwrap();
        assert!(page.contains("Predictions changed after some cells had been measured."));
    }
}

/// The page needs nothing from elsewhere, and says what it must.
#[test]
fn the_report_stands_alone() {
    let folder = tempfile::tempdir().unwrap();
    run(&fake::study(), &settings(folder.path())).unwrap();
    let page = String::from_utf8(read(folder.path(), "report.html")).unwrap();
    for absent in ["<script src", "src=", "url(", "<?xml", "<link", folder.path().to_str().unwrap()] {
        assert!(!page.contains(absent), "{absent}");
    }
    for present in
        ["<svg", "Figure 1.", "upheld", "rejected", "undecided", "cargo run --release", "The planted fault"]
    {
        assert!(page.contains(present), "{present}");
    }
}

/// Twelve studies, each with a margin nine errors wide, one a single error wide, and a fault of 100 errors: nothing is
/// decided wrongly.
#[test]
fn verdicts_of_many_studies() {
    let folder = tempfile::tempdir().unwrap();
    let mut counts = BTreeMap::new();
    for seed in 0..12 {
        let out = folder.path().join(seed.to_string());
        let outcome = run(&fake::study(), &Settings { seed, ..settings(&out) }).unwrap();
        for (id, verdict) in verdicts(&outcome) {
            *counts.entry((id, verdict.word())).or_insert(0) += 1;
        }
    }
    let count = |id: &str, word: &'static str| counts.get(&(id.to_string(), word)).copied().unwrap_or(0);
    assert_eq!(count("wrong", "rejected"), 12);
    assert_eq!(count("control", "upheld"), 12);
    assert_eq!(count("amplitude", "rejected") + count("residual", "rejected"), 0);
    assert_eq!(count("amplitude", "upheld"), 12);
}

#[test]
fn headline_numbers_are_commands_and_a_table() {
    let folder = tempfile::tempdir().unwrap();
    let outcome = run(&fake::study(), &settings(folder.path())).unwrap();
    let text = |name: &str| String::from_utf8(read(folder.path(), name)).unwrap();
    let known = &outcome.sections[0].section.headlines[0];
    let (value, error) = (known.estimate.value(), known.estimate.std_error());
    let table = text("headlines.csv");
    let rows: Vec<&str> = table.lines().collect();
    assert_eq!(rows[0], "experiment,name,value,error,unit,text");
    let start = format!("fake,FakeFactor,{value},{error},1,");
    assert!(rows.len() == 2 && rows[1].starts_with(&start), "{start} in {table}");
    let numbers = text("numbers.tex");
    assert!(
        numbers.contains("\\newcommand{\\turbidFakeFactor}{") && numbers.contains("\\ensuremath{\\pm}"),
        "{numbers}"
    );
}
