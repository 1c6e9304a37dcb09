//! Scenes by chance: a small sweep, the command line, and what a wrong scene looks like.
#![allow(clippy::unwrap_used, reason = "tests")]

use assert_cmd::Command;
use rayon::prelude::*;
use std::fmt::Write;
use turbid::stats::holm;
use turbid_experiments::sweep::draw::draw;
use turbid_experiments::sweep::examine::{Alarm, Examined, examine};
use turbid_experiments::sweep::measure::Effort;
use turbid_experiments::sweep::text::SceneText;

fn sweep() -> Command {
    Command::new(env!("CARGO_BIN_EXE_sweep"))
}

/// An eightieth of what the program does: about a second a scene.
const SMALL: Effort = Effort { steps: 2.2e5, seconds: None, control: 1.0 };

/// The first valid scene of a seed.
fn scene(seed: u64) -> (SceneText, String) {
    let drawn = (0..20).map(|attempt| draw(seed, attempt)).find(|drawn| drawn.text.scene().is_ok()).unwrap();
    (drawn.text, drawn.what)
}

fn lines(examined: &Examined) -> String {
    let mut text = String::new();
    for check in &examined.checks {
        let smallest = check.smallest.map_or("heavy tails".into(), |s| format!("{:.0} %", 100.0 * s));
        let worst = check.worst.as_ref().map_or(String::new(), |w| w.line());
        writeln!(text, "    {}: {} numbers, {smallest}, farthest {worst}", check.check, check.tests).unwrap();
    }
    for line in examined.alarms.iter().flat_map(Alarm::lines) {
        writeln!(text, "    ALARM {line}").unwrap();
    }
    text
}

/// 32 scenes by every method: nothing fails, and no confirmed number differs after Holm.
#[test]
#[allow(clippy::print_stdout, reason = "a test's protocol")]
fn fixed_scenes_agree() {
    let examined: Vec<(u64, String, Examined)> = SEEDS
        .into_par_iter()
        .map(|seed| {
            let (text, what) = scene(seed);
            (seed, what, examine(&text, seed, &SMALL, &|_| {}).unwrap())
        })
        .collect();
    assert_eq!(examined.len(), 32);
    for (seed, what, examined) in &examined {
        println!("seed {seed} ({what})\n{}", lines(examined));
        // What refuses a valid scene is an alarm below; maps were read wherever photons have a place to start.
        let has_maps = examined.checks.iter().any(|check| check.check.starts_with("maps - "));
        let is_endless = scene(*seed).0.scene().unwrap().check_emission().is_err();
        let is_shut_in = examined.refused.iter().any(|line| line.starts_with("camera: "));
        let has_cell = scene(*seed).0.table.contains_key("cell");
        assert_eq!(has_maps, !is_endless && !is_shut_in && !has_cell, "seed {seed}: {:?}", examined.refused);
        assert_eq!(
            examined.refused.is_empty(),
            !is_endless && !is_shut_in,
            "seed {seed}: {:?}",
            examined.refused
        );
    }
    let alarms: Vec<(u64, &Alarm)> =
        examined.iter().flat_map(|(seed, _, e)| e.alarms.iter().map(move |a| (*seed, a))).collect();
    let adjusted = holm(&alarms.iter().map(|(_, alarm)| alarm.p()).collect::<Vec<_>>());
    let wrong: Vec<String> = alarms
        .iter()
        .zip(&adjusted)
        .filter(|(_, p)| **p <= 1e-3)
        .map(|((seed, alarm), _)| format!("seed {seed}: {}", alarm.lines().join("; ")))
        .collect();
    assert!(wrong.is_empty(), "{wrong:#?}\nrepeat: cargo run --release --bin sweep -- --seed SEED");
    // In half of the scenes the loss of the light, or its double, would have been detected.
    let mut sharp: Vec<f64> = examined.iter().map(|(_, _, e)| e.smallest.unwrap_or(f64::INFINITY)).collect();
    sharp.sort_by(f64::total_cmp);
    println!("smallest detectable deviations: {sharp:.2?}");
    assert!(sharp[16] < 0.8, "{sharp:?}");
}

/// Seeds of the scenes above: in order, none left out.
const SEEDS: std::ops::Range<u64> = 1000..1032;

/// The negative control: a lamp that is a tenth brighter in what should be the same scene is detected, and confirmed.
#[test]
fn a_wrong_pair_is_seen() {
    use turbid_experiments::sweep::compare::unbiased;
    use turbid_experiments::sweep::measure::paths;
    let text: SceneText = {
        let table = toml::from_str(
            r#"
            camera = { position = [0, 0, 3], look_at = [0, 0, 0], fov = 50, width = 16, height = 12 }
            objects = [{ shape = { rectangle = { corner = [-1, -1, 0], u = [2, 0, 0], v = [0, 2, 0] } }, surface = { lambertian = { reflectance = 0.5 } } }]
            lights = [{ area = { shape = { sphere = { center = [0, 2, 2], radius = 0.3 } }, radiance = 5 } }]
            "#,
        );
        SceneText { table: table.unwrap(), ..SceneText::default() }
    };
    let bright = |factor: f64| {
        let mut text = text.clone();
        text.parts_mut("lights")[0]["area"]["radiance"] = toml::Value::Float(5.0 * factor);
        let scene = text.scene().unwrap();
        paths(&scene, scene.camera().unwrap(), (10.0 * factor) as u64, &SMALL).unwrap().all
    };
    let alarms = |factor: f64| {
        let check = unbiased("lamp", &bright(factor), &bright(1.0), |_| true);
        check.tests.iter().filter(|t| t.is_suspicious()).count()
    };
    assert_eq!((alarms(1.1) > 0, alarms(0.999)), (true, 0));
}

/// A small scene: a white square under a lamp, and a black ball that changes nothing much.
const SQUARE: &str = r#"
camera = { position = [0, 0, 3], look_at = [0, 0, 0], fov = 50, width = 16, height = 12 }
objects = [
    { shape = { rectangle = { corner = [-1, -1, 0], u = [2, 0, 0], v = [0, 2, 0] } }, surface = { lambertian = { reflectance = 0.5 } } },
    { shape = { sphere = { center = [0.5, 0.5, 0.3], radius = 0.1 } }, surface = "black" },
]
lights = [{ area = { shape = { sphere = { center = [0, 2, 2], radius = 0.3 } }, radiance = 5 } }]
"#;

/// The exit code, standard output and standard error of a run.
fn ran(arguments: &[&str]) -> (Option<i32>, String, String) {
    let output = sweep().args(arguments).output().unwrap();
    let text = |bytes: &[u8]| String::from_utf8(bytes.to_vec()).unwrap();
    (output.status.code(), text(&output.stdout), text(&output.stderr))
}

/// The negative control of the whole program: paths that are twice too bright are an alarm, which is confirmed, traced to a
/// scene with less in it, and told by the exit code; too little work is undecided, and told by another one.
#[test]
fn a_wrong_method_is_an_alarm_to_the_end() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("square.toml");
    std::fs::write(&file, SQUARE).unwrap();
    let (file, out) = (file.to_str().unwrap(), folder.path().join("out"));
    let out = out.to_str().unwrap();
    let own = ["--scene", file, "--out", out, "--effort", "0.01"];
    let (code, said, errors) = ran(&own);
    assert_eq!((code, errors.as_str()), (Some(0), ""), "{said}");
    assert!(said.contains("\nagree; "), "{said}");
    let (code, said, errors) = ran(&[&own[..], &["--control", "2"]].concat());
    assert_eq!((code, errors.as_str()), (Some(1), ""), "{said}");
    assert!(said.contains("ALARM light - paths: again, four times the samples: "), "{said}");
    assert!(said.contains("ALARM maps - paths: again, four times the samples: "), "{said}");
    let smallest = std::fs::read_to_string(folder.path().join("out/failures/square/scene.toml")).unwrap();
    assert!(said.contains("the smallest scene that shows it, ") && said.contains(&smallest), "{said}");
    assert!(smallest.contains("rectangle") && !smallest.contains("black"), "{smallest}");
    // The file shows it again.
    let again = format!("{out}/failures/square/scene.toml");
    let (code, said, _) = ran(&["--scene", &again, "--effort", "0.01", "--control", "2", "--no-shrink"]);
    assert_eq!(code, Some(1), "{said}");
    // A run over seeds, with an alarm and with too little work.
    let seeds = ["--seeds", "1000..1002", "--out", out, "--no-shrink", "--effort"];
    let (code, said, errors) = ran(&[&seeds[..], &["0.01", "--control", "8"]].concat());
    assert_eq!(code, Some(1), "{said}");
    assert!(
        said.contains("ALARM: seed 100") && errors.contains("again, four times the samples"),
        "{said}{errors}"
    );
    let (code, said, errors) = ran(&[&seeds[..], &["1e-4"]].concat());
    assert_eq!((code, errors.as_str()), (Some(3), ""), "{said}");
    assert!(said.contains("0 alarms") && said.contains("undecided: seed 1000: "), "{said}");
    let (code, said, _) = ran(&["--seed", "1000", "--effort", "1e-4", "--out", out]);
    assert_eq!(code, Some(3), "{said}");
}

#[test]
fn bad_values_give_one_line_and_exit_2() {
    for bad in [
        &["--seeds", "5"][..],
        &["--seeds", "5..5"],
        &["--effort", "0"],
        &["--control", "0"],
        &["--scene", "/dev/zero"],
        &["--seeds", "0..1", "--out", "Cargo.toml/out"],
        &["--seed", "1", "--out", "Cargo.toml/out"],
        &["--seeds", "0..2", "--seed", "1"],
        &["--scene", "no.toml"],
    ] {
        let run = sweep().args(bad).assert().code(2).stdout("");
        let text = String::from_utf8(run.get_output().stderr.clone()).unwrap();
        assert!(text.trim_end().lines().count() == 1, "{bad:?}: {text}");
    }
}

/// A scene of one's own that is refused is named with its line, and one without a camera by its file.
#[test]
fn scenes_that_are_none_are_refused_by_file_and_line() {
    let folder = tempfile::tempdir().unwrap();
    let refused = |name: &str, text: &str| {
        let path = folder.path().join(name);
        std::fs::write(&path, text).unwrap();
        let run = sweep().arg("--scene").arg(&path).assert().code(2).stdout("");
        String::from_utf8(run.get_output().stderr.clone()).unwrap()
    };
    let region = "[[regions]]\nshape = { sphere = { center = [0, 0, 0], radius = 1 } }\nsigma_t = 1\nalbedo = 0.5\ng = 0\n";
    let light = "[[lights]]\npoint = { position = [0, 0, 2], power = 1 }\n";
    let said = refused("white.toml", &format!("{}{light}", region.replace("0.5", "1.7")));
    assert!(said.contains("white.toml:4:10: albedo is 1.7; allowed: 0 to 1"), "{said}");
    let said = refused("dark.toml", &format!("{region}{light}"));
    assert!(said.contains("dark.toml: the scene has no camera; allowed: "), "{said}");
}

/// A run goes on where it was interrupted, prints the same again, and says how to repeat a scene.
#[test]
fn a_run_is_kept_in_files() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().to_str().unwrap();
    let run = |seeds: &str| {
        let args = ["--seeds", seeds, "--effort", "0.01", "--out", out, "--no-shrink"];
        String::from_utf8(sweep().args(args).assert().get_output().stdout.clone()).unwrap()
    };
    run("2000..2001");
    let kept = std::fs::read(folder.path().join("2000.json")).unwrap();
    let first = run("2000..2002");
    assert_eq!(std::fs::read(folder.path().join("2000.json")).unwrap(), kept);
    assert_eq!(run("2000..2002"), first);
    assert!(first.contains("2 scenes: "), "{first}");
    sweep().args(["--seed", "2000", "--print", "--scene", "mine.toml"]).assert().code(2);
    let text = sweep().args(["--seed", "2000", "--print"]).assert().success();
    assert_eq!(String::from_utf8(text.get_output().stdout.clone()).unwrap(), scene(2000).0.toml());
}
