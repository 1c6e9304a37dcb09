//! `turbid render --compare` and `turbid advise` for pictures: what they write, refuse and promise.

use crate::{BELOW_A_PANE, Folder, refuses_naming, succeeds, text};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// A diffuse floor in a box of scattering medium under a lamp with an extent.
const ROOM: &str = r#"
[camera]
position = [0.0, 1.0, 4.0]
look_at = [0.0, 0.7, 0.0]
fov = 40.0
width = 24
height = 16

[[regions]]
shape = { cuboid = { min = [-1.0, 0.0, -1.0], max = [1.0, 2.0, 1.0] } }
sigma_t = 0.5
albedo = 0.8
g = 0.0

[[objects]]
shape = { rectangle = { corner = [-1.0, 0.0, -1.0], u = [0.0, 0.0, 2.0], v = [2.0, 0.0, 0.0] } }
surface = { lambertian = { reflectance = 0.5 } }

[[lights]]
area = { shape = { rectangle = { corner = [-0.25, 1.9, -0.25], u = [0.5, 0.0, 0.0], v = [0.0, 0.0, 0.5] } }, radiance = 10.0 }
"#;

/// Rows of NAME-error.csv by their layer, each number by the name of its column.
fn rows(picture: &Path) -> BTreeMap<String, BTreeMap<String, String>> {
    let name = picture.file_stem().unwrap().to_str().unwrap();
    let csv = std::fs::read_to_string(picture.with_file_name(format!("{name}-error.csv"))).unwrap();
    let mut lines = csv.lines().map(|line| line.split(',').map(String::from).collect::<Vec<_>>());
    let header = lines.next().unwrap();
    lines.map(|line| (line[0].clone(), header.iter().cloned().zip(line).collect())).collect()
}

fn number(row: &BTreeMap<String, String>, name: &str) -> f64 {
    row[name].parse().unwrap()
}

fn room() -> (Folder, PathBuf, PathBuf) {
    let folder = Folder::new();
    let (scene, picture) = (folder.file("room.toml", ROOM), folder.0.path().join("a.exr"));
    (folder, scene, picture)
}

/// Paths against other paths: both are unbiased, so that no block differs, the bias is none, and the error of the picture is the noise
/// of its samples: with a quarter of the samples twice as large, within a half.
#[test]
fn paths_differ_from_paths_by_their_noise() {
    let (_folder, scene, picture) = room();
    let mut errors = Vec::new();
    for samples in ["64", "256"] {
        let arguments =
            ["render", text(&scene), "-o", text(&picture), "--with", "paths", "--samples", samples];
        let said = succeeds(&[&arguments[..], &["--compare", "paths", "--compare-samples", "256"]].concat());
        assert!(said.contains("with paths of 256 samples a pixel") && said.contains("a-error.csv"), "{said}");
        let rows = rows(&picture);
        let total = &rows["total"];
        assert_eq!(total["blocks_that_differ"], "0");
        // At 10^-6.
        assert!(
            number(total, "relative_bias").abs() < 5.0 * number(total, "relative_bias_error"),
            "{total:?}"
        );
        errors.push(number(total, "rmse"));
    }
    let ratio = errors[0] / errors[1];
    assert!((1.5..3.0).contains(&ratio), "{ratio}");
    let png = std::fs::read(picture.with_file_name("a-error.png")).unwrap();
    assert!(png.starts_with(b"\x89PNG"));
}

/// One map has an error that nobody knows, and says so; several are tested block by block.
#[test]
fn one_map_has_no_test() {
    let (_folder, scene, picture) = room();
    let quick = ["--global", "emit:2000", "--volume", "emit:2000", "--gather-rays", "2", "--samples", "2"];
    for (maps, has_test) in [("1", false), ("3", true)] {
        let arguments = ["render", text(&scene), "-o", text(&picture), "--maps", maps, "--compare", "paths"];
        let said = succeeds(&[&arguments[..], &quick].concat());
        assert_eq!(said.contains("no test"), !has_test, "{said}");
        let total = &rows(&picture)["total"];
        assert_eq!(total["blocks"].is_empty(), !has_test);
        assert_eq!(total["error_holds"] == "picture and reference", has_test);
    }
}

#[test]
fn comparisons_that_cannot_be_are_refused() {
    let (folder, scene, picture) = room();
    let render = ["render", text(&scene), "-o", text(&picture)];
    let cases: [(&[&str], &[&str]); 6] = [
        (&["--compare", "light"], &["--compare", "paths"]),
        (&["--compare-samples", "8"], &["--compare"]),
        (&["--compare", "paths", "--compare-samples", "1"], &["allowed: whole numbers from 2"]),
        (
            &["--with", "light", "--compare", "paths"],
            &["--compare says nothing to --with light; allowed: with --with photons or --with paths"],
        ),
        (
            &[
                "--set",
                "lights=[{point={position=[0,1.5,0],power=1}}]",
                "--set",
                "objects.0.surface={mirror={reflectance=1}}",
                "--compare",
                "paths",
            ],
            &["--compare paths: the path tracer cannot sample", "allowed"],
        ),
        (&["--compare", "paths", "--memory", "1k"], &["--memory"]),
    ];
    for (options, words) in cases {
        refuses_naming(&[&render[..], options].concat(), words);
    }
    // What cannot be written is known before the work.
    std::fs::create_dir(folder.0.path().join("a-error.csv")).unwrap();
    refuses_naming(&[&render[..], &["--compare", "paths"]].concat(), &["a-error.csv"]);
    assert!(!picture.exists());
}

/// What is advised is within what is promised: the command line that is printed, run and compared.
#[test]
fn advice_for_a_picture_keeps_its_promise() {
    let (_folder, scene, picture) = room();
    let target = 0.1;
    let said = succeeds(&["advise", text(&scene), "--target", "10%", "--gather-rays", "0"]);
    let command = said.lines().find(|line| line.starts_with("turbid render ")).unwrap();
    let row = said.lines().find(|line| line.starts_with("predicted RMSE")).unwrap();
    let numbers: Vec<f64> =
        row.split_whitespace().rev().take(3).map(|x| x.parse::<f64>().unwrap() / 100.0).collect();
    let (high, low, value) = (numbers[0], numbers[1], numbers[2]);
    assert!(low < value && value < high && value <= target && value > 0.5 * target, "{row}");
    let exr = text(&picture);
    let arguments: Vec<&str> = command
        .split_whitespace()
        .skip(1)
        .map(|word| if word == "picture.exr" { exr } else { word })
        .collect();
    succeeds(&[&arguments[..], &["--seed", "7", "--compare", "paths", "--compare-samples", "256"]].concat());
    let total = &rows(&picture)["total"];
    let (rmse, error) = (number(total, "relative_rmse"), number(total, "relative_rmse_error"));
    assert!(low - 2.0 * error < rmse && rmse < high + 2.0 * error, "{rmse} ± {error} of {low} to {high}");
}

#[test]
fn advice_that_cannot_be_is_refused() {
    let (_folder, scene, _) = room();
    let advise = ["advise", text(&scene), "--target", "10%"];
    let cases: [(&[&str], &[&str]); 5] = [
        (&["--for", "nothing"], &["--for", "picture, probes"]),
        (&["--for", "probes"], &["no fluence probe"]),
        (&["--pilot", "1000"], &["--pilot says nothing to --for picture; allowed: with --for probes"]),
        (&["--for", "probes", "--gather-rays", "0"], &["--gather-rays says nothing to --for probes"]),
        (
            &[
                "--set",
                "lights=[{point={position=[0,1.5,0],power=1}}]",
                "--set",
                "objects.0.surface={mirror={reflectance=1}}",
            ],
            &["paths cannot be the reference"],
        ),
    ];
    for (options, words) in cases {
        refuses_naming(&[&advise[..], options].concat(), words);
    }
    refuses_naming(&["advise", "slab", "--target", "10%", "--for", "picture"], &["no [camera]"]);
}

/// A reference of guided paths is told as one, and is another than that of paths where photons know better directions.
#[test]
fn a_guided_reference_is_told() {
    let folder = Folder::new();
    let (scene, picture) = (folder.file("pane.toml", BELOW_A_PANE), folder.0.path().join("a.exr"));
    let render = |more: &[&str]| {
        let start = ["render", text(&scene), "-o", text(&picture), "--samples", "2", "--global", "emit:2000"];
        let compared = ["--compare", "paths", "--compare-samples", "16"];
        let said = succeeds(&[&start[..], &compared, more].concat());
        let of = rows(&picture)["total"].clone();
        (said, of["reference_guide"].clone(), number(&of, "mean"), number(&of, "reference"))
    };
    let (said, guide, mean, paths) = render(&[]);
    assert!(said.contains("with paths of 16 samples") && guide.is_empty(), "{said}");
    let (said, guide, same, guided) = render(&["--guide", "20000"]);
    assert!(said.contains("with guided paths of 16 samples") && guide == "20000", "{said}");
    assert!(same == mean && guided != paths && guided > 0.0, "{guided} {paths}");
}
