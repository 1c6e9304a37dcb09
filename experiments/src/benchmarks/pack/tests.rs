//! The kept pack is what the generator writes, its scenes are scenes, and the simulator answers some of them.

use super::*;
use crate::benchmarks::comparison::Verdict;
use std::path::PathBuf;
use turbid::estimators::{Estimator, Gather, Kernel};
use turbid::scene::{Orders, Scene, SceneFile};
use turbid::sensor::{Measurement, PathSettings, PhotonSettings, by_paths, by_photons};
use turbid::transport::NoProgress;

fn kept() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../results/pack")
}

fn scene(toml: &str) -> Scene {
    SceneFile::from_toml(toml).unwrap().scene(Path::new(".")).unwrap()
}

/// What the simulator found as a file of answers.
fn answers(found: &[Measurement], shift: f64) -> String {
    let lines = found
        .iter()
        .filter_map(|m| Some(format!("{},{:?},{:?}\n", m.sensor, m.mean * (1.0 + shift), m.std_error?)));
    format!("id,value,std_error\n{}", lines.collect::<String>())
}

#[test]
fn the_kept_pack_is_what_is_written() {
    let problems = problems::problems().unwrap();
    let mut ids = std::collections::BTreeSet::new();
    for problem in &problems {
        let scene = scene(&problem.toml());
        let names: Vec<String> = scene.sensors().iter().map(|sensor| sensor.name.clone()).collect();
        let questions: Vec<String> = problem.questions().map(|q| q.id).collect();
        assert_eq!(names, questions);
        for q in problem.questions() {
            assert!(q.bound > 0.0 && q.bound < 1e-6 * q.value.abs(), "{q:?}");
            assert!(ids.insert(q.id), "{} is asked twice", problem.name);
        }
    }
    assert!((60..=100).contains(&ids.len()), "{}", ids.len());
    for (name, bytes) in files(&problems, &kept()).unwrap() {
        let path = kept().join(&name);
        let there = std::fs::read(&path).unwrap_or_default();
        assert!(there == bytes, "{name} is not what `benchmarks --pack` writes");
    }
    // Nothing else lies there but what other programs answered.
    for entry in std::fs::read_dir(kept().join("scenes")).unwrap() {
        let name = entry.unwrap().file_name().into_string().unwrap();
        assert!(
            problems.iter().any(|p| p.file() == format!("scenes/{name}")),
            "{name} is no scene of the pack"
        );
    }
}

/// A peaked slab, refracting ones, layers and a ball by photons; other slabs, a ball and a furnace by paths. By the checker's rule
/// answers agree, and disagree once all are 10 per cent off; the comparison says that it detects 5.
#[test]
fn the_simulator_answers() {
    let mut problems = problems::problems().unwrap();
    let questions: Vec<Question> = problems.iter().flat_map(Problem::questions).collect();
    let photons = PhotonSettings {
        photons: 40_000,
        maps: 1,
        seed: 1,
        orders: Orders::ALL,
        // Only tallies are read.
        estimator: Estimator::new(Kernel::Uniform, Gather::radius(1.0).unwrap()),
    };
    let paths = PathSettings { samples: 10_000, seed: 1, replicate: 0, orders: Orders::ALL };
    for (name, is_by_paths) in [
        ("slab-hg0.75-t1-w0.9-mu1", false),
        ("glass-hg0.9-n1.33-t10-w0.99-mu1", false),
        ("sphere-centre-a1-w0.9", false),
        ("slab-rayleigh-t1-w1-mu0.5", true),
        ("glass-iso-n1.5-t1-w0.9-diffuse", false),
        ("layers-haze", false),
        ("thermal-hg0.5-t2-w0.5", true),
        ("sphere-incident-a1-w0.9", true),
        ("furnace-hg0.75-t2-w0.5", true),
    ] {
        let problem = problems.iter_mut().find(|p| p.name == name).unwrap();
        // Photons tally; a map has neighbours, and a bias.
        problem.asked.retain(|asked| is_by_paths || !["fluence", "radiance"].contains(&asked.quantity));
        let scene = scene(&problem.toml());
        let found = if is_by_paths {
            by_paths(&scene, &paths, &NoProgress).unwrap()
        } else {
            by_photons(&scene, &photons, &NoProgress).unwrap().measurements
        };
        let answer = |shift| compare("turbid", "answers.csv", &answers(&found, shift), &questions).unwrap();
        let fair = answer(0.0);
        let worst = fair.worst();
        assert_eq!(fair.verdict(), Verdict::Agrees, "{name}: p {:?}, worst {worst:?}", fair.p());
        let detects = fair.detects().unwrap();
        assert!(detects < 0.05, "{name} detects {detects}");
        assert_eq!(answer(0.1).verdict(), Verdict::Differs, "{name}, 10 per cent off");
    }
}

#[test]
fn hostile_answers() {
    let question = problems::problems().unwrap()[0].questions().next().unwrap();
    let id = question.id.clone();
    for (text, words) in [
        ("id,value\nx,1\n".to_string(), "there is no column std_error"),
        (format!("id,value,std_error\n{id},NaN,1\n"), "line 2: value is NaN"),
        (format!("id,value,std_error\n{id},1,-1\n"), "is -1; allowed: at least 0"),
        ("id,value,std_error\nno-such,1,1\n".to_string(), "there is no question no-such"),
        (format!("id,value,std_error\n{id},1,1\n{id},1,1\n"), "is answered twice"),
        (format!("id,value,std_error\n{}", format!("{id},1,1\n").repeat(1_000_000)), "more than 100000 rows"),
    ] {
        let error = compare("x", "answers.csv", &text, std::slice::from_ref(&question)).unwrap_err();
        let error = format!("{error:#}");
        assert!(
            error.starts_with("answers.csv") && error.contains(words) && !error.contains('\n'),
            "{error}"
        );
    }
}
