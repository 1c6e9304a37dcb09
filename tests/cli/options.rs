//! Options that mean one thing: what a method would ignore is refused, and who measures has one name.

use crate::{Folder, refuses_naming, succeeds, text, turbid};

/// By name, with the method, in one line; `src/bin/turbid/options.rs` asks for every option of every method.
#[test]
fn what_a_method_ignores_is_refused() {
    let folder = Folder::new();
    let exr = folder.0.path().join("a.exr");
    for (with, option) in [
        ("paths", &["--k", "50"][..]),
        ("paths", &["--kernel", "uniform"]),
        ("path", &["--photons", "1000"]),
        ("photons", &["--samples", "100000"]),
        ("photons", &["--weight-windows"]),
        ("light", &["--maps", "16"]),
        ("light", &["--reject", "off"]),
    ] {
        let with_method = format!("--with {}", if with == "path" { "paths" } else { with });
        let told = format!("{} says nothing to {with_method}; allowed: with --with ", option[0]);
        refuses_naming(&[&["measure", "slab", "--with", with][..], option].concat(), &[&told]);
    }
    for (with, option) in
        [("light", ["--passes", "1"]), ("paths", ["--k", "2"]), ("paths", ["--global", "200000"])]
    {
        let told = format!("{} says nothing to --with {with}; allowed: with --with photons", option[0]);
        let render = ["render", "fogbox", "--with", with, "-o", text(&exr)];
        refuses_naming(&[&render[..], &option].concat(), &[&told]);
    }
    let told = ["--photons says nothing to --which volume; allowed: with --which medium"];
    refuses_naming(&["map", "slab", "--npy", text(&exr), "--photons", "10", "--which", "volume"], &told);
    let told = ["--tone says nothing to --which all; allowed: with --output"];
    refuses_naming(&["map", "slab", "--npy", text(&exr), "--tone", "clip"], &told);
    assert!(!exr.exists());
}

/// `path`, as older scripts have it, is the same.
#[test]
fn paths_have_two_names() {
    let by =
        |name: &str| succeeds(&["measure", "slab", "--with", name, "--samples", "2000", "--format", "csv"]);
    assert_eq!(by("path"), by("paths"));
    let folder = Folder::new();
    let picture = |name: &str| {
        let exr = folder.0.path().join(format!("{name}.exr"));
        succeeds(&["render", "fogbox", "-o", text(&exr), "--with", name, "--width", "4", "--samples", "1"]);
        std::fs::read(exr).unwrap()
    };
    assert!(picture("path") == picture("paths"));
}

/// A fog in two halves with a wall between them, lit on one side: photons behind the wall are not seen from the other one, so that
/// what does not reject them finds light there.
#[test]
fn rejections_are_those_of_pictures() {
    let folder = Folder::new();
    let scene = folder.file(
        "wall.toml",
        "[[regions]]\nshape = { cuboid = { min = [-1, -1, -1], max = [1, 1, 1] } }\nsigma_t = 2\nalbedo = 0\ng = 0\n\
         [[objects]]\nshape = { rectangle = { corner = [0, -2, -2], u = [0, 4, 0], v = [0, 0, 4] } }\nsurface = \"black\"\n\
         [[lights]]\npoint = { position = [0.5, 0, 0], power = 1 }\n\
         [[sensors]]\nname = \"dark\"\nmeasure = { fluence = { at = [-0.1, 0, 0] } }\n",
    );
    let dark = |more: &[&str]| -> f64 {
        let measure = ["measure", text(&scene), "--with", "photons", "--photons", "2e4", "--maps", "2"];
        let read = ["--radius", "0.3", "--boundary", "none", "--format", "csv"];
        let output = turbid(&[&measure[..], &read, more].concat()).output().unwrap();
        let table = String::from_utf8(output.stdout).unwrap();
        table.lines().nth(1).unwrap().split(',').nth(3).unwrap().parse().unwrap()
    };
    assert!(dark(&[]) > 0.01 && dark(&["--reject", "off"]) == dark(&[]));
    for rule in ["behind-plane", "visible"] {
        assert_eq!(dark(&["--reject", rule]), 0.0, "{rule}");
    }
}

/// The table in a file is that of standard output, which stays empty.
#[test]
fn tables_go_to_files() {
    let folder = Folder::new();
    let file = folder.0.path().join("table.csv");
    let slab = ["measure", "slab", "--with", "paths", "--samples", "2000"];
    for format in ["table", "csv", "json"] {
        let formatted = [&slab[..], &["--format", format]].concat();
        let table = succeeds(&formatted);
        assert_eq!(succeeds(&[&formatted[..], &["--out", text(&file)]].concat()), "");
        assert_eq!(std::fs::read_to_string(&file).unwrap(), table);
    }
    let scene = folder.file("slab.toml", &succeeds(&["scenes", "slab", "--resolved"]));
    let before = std::fs::read_to_string(&scene).unwrap();
    let onto = ["measure", text(&scene), "--with", "paths", "--samples", "1000000000", "--out"];
    refuses_naming(&[&onto[..], &[text(&scene)]].concat(), &["--out names a file of the scene"]);
    assert_eq!(std::fs::read_to_string(&scene).unwrap(), before);
    let nowhere = folder.0.path().join("none").join("table.csv");
    refuses_naming(&[&onto[..], &[text(&nowhere)]].concat(), &["cannot write ", "No such file"]);
    let photons =
        ["measure", text(&scene), "--with", "photons", "--photons-from", text(&file), "--out", text(&file)];
    refuses_naming(&photons, &["--out and --photons-from name one file"]);
}
