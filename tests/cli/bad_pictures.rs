//! Pictures that cannot be made, and those whose maps stay empty: what the one line says, and what is left behind.

use crate::{Folder, refuses_naming, succeeds, text, turbid};

/// Fast settings of a picture of the built-in box of fog.
const TINY: [&str; 10] =
    ["--width", "4", "--samples", "1", "--gather-rays", "2", "--global", "emit:200", "--volume", "emit:200"];

#[test]
fn the_built_in_box_needs_no_file() {
    let folder = Folder::new();
    let out = folder.0.path().join("fog.exr");
    for (with, settings) in [("photons", &TINY[..]), ("paths", &TINY[..4])] {
        let said =
            succeeds(&[&["render", "fogbox", "-o", text(&out), "--with", with][..], settings].concat());
        assert!(said.contains("fog.exr") && said.contains("fog.png"), "{said}");
    }
    let png = folder.0.path().join("map.png");
    succeeds(&[&["map", "fogbox", "-o", text(&png)][..], &TINY[..2], &TINY[6..]].concat());
    refuses_naming(&["render", "slab", "-o", text(&out)], &["no [camera]", "fogbox"]);
}

/// Its walls, fog and lamp are those of the scene of the laboratory, number by number.
#[test]
fn the_built_in_box_is_that_of_the_laboratory() {
    let text = std::fs::read_to_string("experiments/scenes/fogbox-iso.toml").unwrap();
    let laboratory: toml::Table = toml::from_str(&text).unwrap();
    let built_in: toml::Table = toml::from_str(&succeeds(&["scenes", "fogbox", "--resolved"])).unwrap();
    for key in ["regions", "objects", "lights"] {
        let numbers = |table: &toml::Table| format!("{:?}", table[key]).replace(".0", "");
        let (a, b) = (laboratory[key].as_array().unwrap(), built_in[key].as_array().unwrap());
        assert_eq!(a.len(), b.len(), "{key}");
        if key != "regions" {
            assert_eq!(numbers(&laboratory), numbers(&built_in), "{key}");
        }
    }
}

#[test]
fn sizes_and_numbers_out_of_range() {
    let folder = Folder::new();
    let out = folder.0.path().join("a.exr");
    let refuse = |options: &[&str], words: &[&str]| {
        refuses_naming(&[&["render", "fogbox", "-o", text(&out)], options].concat(), words);
    };
    refuse(
        &["--width", "16384"],
        &["--width, --height", "268435456; allowed: at most 8388608 pixels", "memory"],
    );
    refuse(&["--width", "20000", "--height", "1"], &["--width", "allowed: whole numbers from 1 to 16384"]);
    refuse(&["--height", "0"], &["--height", "allowed: whole numbers from 1 to 16384"]);
    refuse(&["--width", "-3"], &["--width", "-3"]);
    refuse(&["--set", "width=0"], &["camera.width is 0; allowed: 1 to 16384 pixels"]);
    refuse(&["--set", "fov=30"], &["unknown key `fov`", "width"]);
    refuse(&["--set", "sigma_t=-1"], &["sigma_t is -1; allowed: finite and at least 0"]);
    refuse(&["--samples", "0"], &["--samples", "allowed: whole numbers from 1"]);
    refuse(&["--samples", "1e12"], &["--samples is 1000000000000; allowed: 1 to 4294967295"]);
    refuse(&["--maps", "0"], &["--maps", "allowed"]);
    refuse(&["--seconds", "inf"], &["--seconds is inf; allowed: finite and above 0"]);
    refuse(&["--global", "1e10"], &["--global", "allowed: a number of photons to store, 1 to 1e9"]);
    refuse(&["--caustic", "emit:0"], &["--caustic", "allowed"]);
    refuse(&["--k", "many"], &["--k", "allowed: whole numbers from 2 to 1e9"]);
    refuse(&["--k", "1e12"], &["--k", "allowed: whole numbers from 2 to 1e9"]);
    refuse(&["--volume-k", "1"], &["k is 1; allowed: at least 2"]);
    refuse(&["--max-radius", "-1"], &["--max-radius", "is -1; allowed: finite and above 0"]);
    refuse(&["--radius", "nan"], &["--radius", "NaN"]);
    for rays in ["--gather-rays=-1", "--gather-rays=1e9", "--gather-rays=nan"] {
        refuse(&[rays], &["--gather-rays", "allowed: whole numbers from 0 to 1000000"]);
    }
    refuse(&["--seed=-1"], &["--seed", "allowed: whole numbers from 0 to"]);
    refuse(&["--near", "-1"], &["--near is -1; allowed: finite and at least 0"]);
    refuse(&["--step", "0"], &["--step is 0; allowed: finite and above 0"]);
    refuse(&["--step", "1e-12"], &["--step is", "allowed: at least a millionth of the scene"]);
    refuse(&["--exposure", "1e9"], &["--exposure is", "allowed: -1000 to 1000 stops"]);
    refuse(&["--tone", "film"], &["--tone", "allowed: soft, clip"]);
    refuse(&["--boundary", "open"], &["--boundary", "allowed: none, clipped"]);
    refuse(&["--reject", "all"], &["--reject", "allowed: off, facing"]);
    refuse(&["--step-rule", "far"], &["--step-rule", "allowed: near-end"]);
    refuse(&["--spacing", "-1"], &["--spacing is -1; allowed: finite and at least 0"]);
    refuse(
        &["--spacing", "2", "--no-jitter"],
        &["--spacing is about random steps; allowed: without --no-jitter"],
    );
    refuse(
        &["--spacing", "2", "--ray-radius", "0.1"],
        &["--spacing is about steps; allowed: without --ray-radius"],
    );
    refuse(&["--planes", "--ray-radius", "0.1"], &["--planes", "--ray-radius"]);
    refuse(&["--planes", "--volume-k", "20"], &["--planes", "--volume-k"]);
    refuse(&["--planes"], &["allowed: beams beside them (a beam radius)"]);
    refuse(
        &["--planes", "--beam-radius", "1", "--plan", "full"],
        &["--plan full takes", "allowed with them: auto"],
    );
    refuse(&["--ray-ends", "own"], &["--ray-ends is own", "allowed: with --ray-radius or --beam-radius"]);
    refuse(
        &["--ray-ends", "own", "--ray-radius", "1"],
        &["--ray-ends: rays end for each photon or beam in one homogeneous region"],
    );
    refuse(&["--plan", "none"], &["--plan", "allowed: auto, full"]);
    refuse(&["--glboal", "3"], &["--glboal"]);
    refuse(&["--threads", "0"], &["--threads"]);
    let png = folder.0.path().join("a.png");
    let map = |options: &[&str], words: &[&str]| {
        refuses_naming(&[&["map", "fogbox", "-o", text(&png)], options].concat(), words);
    };
    map(&["--which", "direct"], &["--which", "allowed: global, caustic, volume, all, medium"]);
    map(&["--ply", "cloud.obj"], &["--ply is cloud.obj; allowed: a file name that ends in .ply"]);
    map(&["--which", "caustic"], &["the map is empty"]);
    map(&["--width", "0"], &["--width"]);
    map(&["--samples", "3"], &["--samples"]);
    assert_eq!(std::fs::read_dir(folder.0.path()).unwrap().count(), 0, "something was left behind");
}

/// Fog that scatters nothing, and a lamp whose light meets nothing: black layers, a note, no failure.
#[test]
fn empty_maps_make_black_layers_and_say_so() {
    let folder = Folder::new();
    let camera =
        "[camera]\nposition = [0.5, 0.5, 4]\nlook_at = [0.5, 0.5, 0]\nfov = 30\nwidth = 4\nheight = 4\n";
    let fog = "[[regions]]\nshape = { cuboid = { min = [0, 0, 0], max = [1, 1, 1] } }\nsigma_t = 1\nalbedo = 0\ng = 0\n";
    let floor = "[[objects]]\nshape = { rectangle = { corner = [0, 0, 0], u = [1, 0, 0], v = [0, 1, 0] } }\nsurface = { lambertian = { reflectance = 0.5 } }\n";
    let point = |x: f64| format!("[[lights]]\npoint = {{ position = [{x}, 0.5, 0.5], power = 1 }}\n");
    let away = "[[lights]]\nspot = { position = [0.5, 0.5, 9], dir = [0, 0, 1], full_angle = 5, edge_angle = 10, power = 1 }\n";
    for (name, scene, words) in [
        ("black.toml", format!("{camera}{fog}{}", point(0.5)), "the volume map is empty"),
        ("away.toml", format!("{camera}{floor}{away}"), "the global map is empty"),
    ] {
        let file = folder.file(name, &scene);
        let out = folder.0.path().join("out.exr");
        let asked = ["--samples", "1", "--global", "1000", "--volume", "1000", "--gather-rays", "0"];
        let arguments = [&["render", text(&file), "-o", text(&out)][..], &asked].concat();
        let output = turbid(&arguments).output().unwrap();
        let stderr = String::from_utf8(output.stderr).unwrap();
        assert!(output.status.success(), "{name}: {stderr}");
        assert_eq!(stderr.lines().count(), 1, "{name}: {stderr}");
        assert!(stderr.starts_with("turbid: note: ") && stderr.contains(words), "{name}: {stderr}");
        assert!(stderr.contains("none of 1000 photons"), "{name}: {stderr}");
        let said = String::from_utf8(output.stdout).unwrap();
        assert!(
            said.contains("0 photons stored of 1000 emitted") && said.contains("non-finite     0"),
            "{said}"
        );
        assert!(out.exists() && out.with_extension("png").exists());
    }
}

/// What is written before the disk is full stays whole, and the line says so; nothing else is left.
#[cfg(target_os = "linux")]
#[test]
fn full_disks() {
    let folder = Folder::new();
    let path = |name: &str| folder.0.path().join(name);
    let full = |name: &str| std::os::unix::fs::symlink("/dev/full", path(name)).unwrap();
    full("full.exr");
    full("half.png");
    full("cloud.ply");
    let render = |file: &str, words: &[&str]| {
        refuses_naming(&[&["render", "fogbox", "-o", text(&path(file))][..], &TINY].concat(), words);
    };
    render("full.exr", &["cannot write", "full.exr", "No space left"]);
    assert!(!path("full.png").exists());
    render("half.exr", &["half.exr is written", "cannot write", "half.png", "No space left"]);
    let (png, ply) = (path("map.png"), path("cloud.ply"));
    let map = ["map", "fogbox", "-o", text(&png), "--ply", text(&ply)];
    refuses_naming(
        &[&map[..], &TINY[..2], &TINY[6..]].concat(),
        &["map.png is written", "cannot write", "cloud.ply", "No space left"],
    );
    // A disk that is full in the middle of a file, as far as a process can tell.
    let limited = std::process::Command::new("sh")
        .args(["-c", "trap '' 25; ulimit -f 4; exec \"$0\" \"$@\""])
        .arg(assert_cmd::cargo::cargo_bin("turbid"))
        .args(["render", "fogbox", "--with", "paths", "--samples", "1", "--width", "200", "-o"])
        .arg(path("large.exr"))
        .output()
        .unwrap();
    let told = String::from_utf8(limited.stderr).unwrap();
    let expected = format!(
        "turbid: error: cannot write {}: File too large (os error 27)\n",
        path("large.exr").display()
    );
    assert_eq!((limited.status.code(), told.lines().last()), (Some(2), expected.lines().last()));
    std::fs::create_dir(path("folder.exr")).unwrap();
    refuses_naming(&["render", "fogbox", "-o", text(&path("folder.exr"))], &["folder.exr: it is a folder"]);
    let mut left: Vec<_> = std::fs::read_dir(folder.0.path())
        .unwrap()
        .map(|e| e.unwrap().file_name().into_string().unwrap())
        .collect();
    left.sort();
    assert_eq!(left, ["cloud.ply", "folder.exr", "full.exr", "half.exr", "half.png", "map.png"]);
}
