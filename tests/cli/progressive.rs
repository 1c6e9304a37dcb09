//! `turbid render --progressive`: stopped and resumed, and what it refuses.

use crate::{Folder, RAYS, refuses_naming, succeeds, text};
use std::path::Path;

/// A small picture of the built-in fogbox.
const SMALL: [&str; 12] = [
    "--progressive",
    "--width",
    "8",
    "--global",
    "emit:2000",
    "--volume",
    "emit:2000",
    "--gather-rays",
    "0",
    "--seed",
    "3",
    "--quiet",
];

fn arguments<'a>(out: &'a Path, more: &[&'a str]) -> Vec<&'a str> {
    [&["render", "fogbox", "-o", text(out)], &SMALL[..], more].concat()
}

/// Stopped twice and resumed, on other numbers of threads: the picture of a run that was not.
#[test]
fn a_resumed_picture_is_that_of_one_run() {
    let folder = Folder::new();
    let path = |name: &str| folder.0.path().join(name);
    let (parted, whole, state) = (path("parted.exr"), path("whole.exr"), path("fog.state"));
    for (maps, threads) in [("3", "1"), ("5", "2"), ("5", "2"), ("8", "1")] {
        let more = ["--maps", maps, "--state", text(&state), "--threads", threads];
        let said = succeeds(&arguments(&parted, &more));
        assert!(said.contains(&format!("1 a pixel, {maps} repetitions")), "{said}");
    }
    succeeds(&arguments(&whole, &["--maps", "8"]));
    assert!(std::fs::read(&parted).unwrap() == std::fs::read(&whole).unwrap());
    let header = String::from_utf8_lossy(&std::fs::read(&whole).unwrap()).to_string();
    assert!(header.contains("\"progressive\":true") && header.contains("\"repetitions\":8"));
    // Not the mean of maps that are all read alike.
    let fixed = path("fixed.exr");
    succeeds(
        &arguments(&fixed, &["--maps", "8"])
            .into_iter()
            .map(|word| if word == "--progressive" { "--no-jitter" } else { word })
            .collect::<Vec<_>>(),
    );
    assert!(std::fs::read(&fixed).unwrap() != std::fs::read(&whole).unwrap());
}

/// Where k is chosen by how full the maps are, another k is told by the radii that follow.
#[test]
fn another_k_has_other_first_radii() {
    let folder = Folder::new();
    let (out, state) = (folder.0.path().join("a.exr"), folder.0.path().join("a.state"));
    let full = ["--progressive", "--width", "4", "--global", "emit:80000", "--volume", "emit:2000"];
    let mut all =
        vec!["render", "fogbox", "-o", text(&out), "--state", text(&state), "--gather-rays", "0", "--quiet"];
    all.extend(full);
    succeeds(&[&all[..], &["--maps", "2"]].concat());
    refuses_naming(
        &[&all[..], &["--maps", "3", "--k", "100"]].concat(),
        &["a.state", "differs in first radii"],
    );
    succeeds(&[&all[..], &["--maps", "3"]].concat());
}

/// A run beside another one on the same state is refused before it makes a map.
#[test]
fn a_state_has_one_run_at_a_time() {
    let folder = Folder::new();
    let (out, state) = (folder.0.path().join("a.exr"), folder.0.path().join("a.state"));
    succeeds(&arguments(&out, &["--maps", "2", "--state", text(&state)]));
    let held = std::fs::File::open(&state).unwrap();
    held.lock().unwrap();
    let (kept, picture) = (std::fs::read(&state).unwrap(), std::fs::read(&out).unwrap());
    let more = ["--maps", "3", "--state", text(&state)];
    refuses_naming(&arguments(&out, &more), &["a.state", "another run"]);
    assert!(std::fs::read(&state).unwrap() == kept && std::fs::read(&out).unwrap() == picture);
    drop(held);
    succeeds(&arguments(&out, &more));
}

/// What the files hold that a scene names counts too.
#[test]
fn another_grid_is_another_scene() {
    let folder = Folder::new();
    let at = |name: &str| folder.0.path().join(name);
    let grid = |density: f32| folder.grid("fog.vol", density);
    grid(1.0);
    let scene = folder.file(
        "scene.toml",
        r#"
        [camera]
        position = [0.5, 0.5, 4.0]
        look_at = [0.5, 0.5, 0.0]
        fov = 20.0
        width = 4
        height = 4
        [[regions]]
        shape = { cuboid = { min = [0.0, 0.0, 0.0], max = [1.0, 1.0, 1.0] } }
        sigma_t = 1.0
        albedo = 0.8
        g = 0.0
        density = { grid = { file = "fog.vol" } }
        [[lights]]
        point = { position = [0.5, 0.5, 2.0], power = 10.0 }
        "#,
    );
    let (out, state) = (at("a.exr"), at("a.state"));
    let arguments = |maps: &'static str| {
        let mut all = vec!["render", text(&scene), "-o", text(&out), "--maps", maps, "--state", text(&state)];
        all.extend(["--progressive", "--volume", "emit:500", "--radius", "0.2", "--quiet"]);
        all
    };
    succeeds(&arguments("2"));
    succeeds(&arguments("3"));
    grid(0.5);
    refuses_naming(&arguments("4"), &["a.state", "digest of the scene's files"]);
}

/// A limited time makes at least two maps, and resumes.
#[test]
fn a_time_is_kept() {
    let folder = Folder::new();
    let (out, state) = (folder.0.path().join("a.exr"), folder.0.path().join("a.state"));
    let more = ["--seconds", "0.001", "--state", text(&state), "--samples", "2"];
    assert!(succeeds(&arguments(&out, &more)).contains("2 a pixel, 2 repetitions"));
    assert!(succeeds(&arguments(&out, &more)).contains("2 a pixel, 3 repetitions"));
}

#[test]
fn what_cannot_be_resumed_is_refused_and_left_as_it_is() {
    let folder = Folder::new();
    let (out, state) = (folder.0.path().join("a.exr"), folder.0.path().join("a.state"));
    succeeds(&arguments(&out, &["--maps", "2", "--state", text(&state)]));
    let kept = std::fs::read(&state).unwrap();
    let (picture, named) = (std::fs::read(&out).unwrap(), text(&state));
    for (more, word) in [
        (&["--kernel", "cone"][..], "mapper settings"),
        (&["--k", "50"], "mapper settings"),
        (&["--samples", "3"], "samples"),
        (&["--height", "9"], "size"),
        (&["--radius", "0.2"], "mapper settings"),
        (&["--volume", "emit:3000"], "map settings"),
        (&["--set", "albedo=0.5"], "scene"),
    ] {
        let mut all = arguments(&out, &["--maps", "4", "--state", named]);
        if let Some(at) = all.iter().position(|known| *known == more[0]) {
            all.drain(at..at + 2);
        }
        refuses_naming(&[&all[..], more].concat(), &["a.state", &format!("differs in {word}")]);
    }
    let body = kept.iter().enumerate().filter(|(_, byte)| **byte == b'\n').nth(2).unwrap().0 + 1;
    // A number that is as good as any other, but is not what was written.
    let mut flipped = kept.clone();
    flipped[body + 40] ^= 1;
    std::fs::write(&state, &flipped).unwrap();
    refuses_naming(&arguments(&out, &["--maps", "4", "--state", named]), &["a.state", "damaged"]);
    for damaged in [kept[..kept.len() - 8].to_vec(), kept[..30].to_vec(), Vec::new(), b"no\n{}\n".to_vec()] {
        std::fs::write(&state, &damaged).unwrap();
        refuses_naming(&arguments(&out, &["--maps", "4", "--state", named]), &["a.state"]);
        assert!(std::fs::read(&state).unwrap() == damaged);
    }
    assert!(std::fs::read(&out).unwrap() == picture, "a refused run wrote a picture");
}

#[test]
fn what_has_no_end_or_no_error_is_refused() {
    let folder = Folder::new();
    let out = folder.0.path().join("a.exr");
    let other = folder.0.path().join("a.png");
    for (more, words) in [
        (&["--maps", "1"][..], &["--maps is 1", "2 to 4294967295"][..]),
        (&[], &["--seconds", "--maps"]),
        (&["--maps", "3", "--seconds", "3"], &["one of them"]),
        (&["--maps", "3", "--passes", "2", "--radius", "0.2", "--adapt", "0"], &["--passes is 2"]),
        (&["--maps", "3", "--state", text(&other)], &["lead to one file"]),
        (&["--maps", "3", "--state", text(&folder.0.path().join("no/a"))], &["no/a"]),
        (&["--maps", "3", "--state", "/dev/zero"], &["/dev/zero", "not a state"]),
        (&["--maps", "3", "--with", "paths"], &["--progressive", "--with photons"]),
    ] {
        refuses_naming(&arguments(&out, more), words);
    }
    refuses_naming(
        &["render", "fogbox", "-o", text(&out), "--samples", "2", "--seconds", "2"],
        &["one of them"],
    );
    refuses_naming(&["measure", "slab", "--with", "photons", "--progressive"], &["--radius"]);
    refuses_naming(&["measure", "slab", "--with", "paths", "--progressive"], &["--progressive"]);
    let measure = ["measure", "slab", "--with", "photons", "--photons", "100", "--progressive"];
    refuses_naming(&[&measure[..], &["--radius", "0.3", "--maps", "1"]].concat(), &["--maps is 1"]);
    let scene = folder.file("rays.toml", RAYS);
    let measure = ["measure", text(&scene), "--with", "photons", "--photons", "100", "--progressive"];
    refuses_naming(&[&measure[..], &["--ray-radius", "0.3", "--maps", "4"]].concat(), &["with --radius"]);
}
