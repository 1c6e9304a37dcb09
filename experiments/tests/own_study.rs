//! Studies of users' own: files in, tables out, the same bits by any number of threads, parts and folders.
#![allow(clippy::unwrap_used, reason = "tests")]

use assert_cmd::Command;
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use turbid::exchange::from_mitsuba;
use turbid::stats::{ALPHA, student_critical};

const SLAB: &str = "\
title = 'Two slabs'
scene = 'slab'
photons = [500, 2e3]
maps = 64
target = 0.2
[axes]
albedo = [0.5, 0.9]
[measure]
probes = [[2.0, 2.0, 0.1], [2.0, 2.0, 1.0]]
[[estimators]]
radius = [0.2, 0.4]
treatment = ['none', 'clipped']
[[estimators]]
k = 20
";

/// The same of a ball, which is solved in no time: for what many runs, each of which solves it, must agree in.
fn of_a_ball() -> String {
    let probes = "[[2.0, 2.0, 0.1], [2.0, 2.0, 1.0]]";
    assert!(SLAB.contains("'slab'") && SLAB.contains(probes));
    SLAB.replace("'slab'", "'sphere'").replace(probes, "[[0.0, 0.0, 0.3], [0.0, 0.5, 0.1]]")
}

fn study(folder: &Path, args: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_study"));
    command.current_dir(folder).args(args);
    command
}

fn written(text: &str) -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("mine.toml");
    std::fs::write(&file, text).unwrap();
    (folder, file)
}

fn refused(folder: &Path, args: &[&str]) -> String {
    let run = study(folder, args).assert().code(2).stdout("");
    let text = String::from_utf8(run.get_output().stderr.clone()).unwrap();
    let lines: Vec<&str> = text.lines().filter(|line| line.contains("error: ")).collect();
    assert!(lines.len() == 1, "{args:?}: {text}");
    lines[0].to_string()
}

fn rows(path: &Path) -> Vec<HashMap<String, String>> {
    csv::Reader::from_path(path).unwrap().deserialize().map(Result::unwrap).collect()
}

fn results(folder: &Path, out: &str) -> Vec<u8> {
    std::fs::read(folder.join(out).join("results.csv")).unwrap()
}

/// One thread or two, in one run or in parts, in one folder or in several, some of them twice: the same bits.
#[test]
fn threads_and_parts_change_nothing() {
    let (folder, _file) = written(&of_a_ball());
    let at = folder.path();
    let run = study(at, &["mine.toml", "--out", "one", "--threads", "1"]).assert().success();
    let said = String::from_utf8(run.get_output().stdout.clone()).unwrap();
    assert!(said.contains("albedo=0.5") && said.contains("albedo=0.9") && said.contains("20 %"), "{said}");
    study(at, &["mine.toml", "--out", "two", "--threads", "2"]).assert().success();
    let one = results(at, "one");
    assert!(one == results(at, "two"));
    // Two scenes, two sizes, five estimators, two places and all of them; every file there.
    assert_eq!(rows(&at.join("one/results.csv")).len(), 2 * 2 * 5 * 3);
    for file in ["report.html", "costs.csv", "predictions.csv", "figures/own-costs-scene001.png"] {
        assert!(at.join("one").join(file).is_file(), "{file}");
    }
    for (part, out) in [("1/3", "a"), ("2/3", "b"), ("3/3", "a"), ("2/3", "a")] {
        study(at, &["mine.toml", "--out", out, "--part", part]).assert().success();
    }
    assert!(!at.join("a/results.csv").exists());
    study(at, &["mine.toml", "--out", "merged", "--merge", "a", "b"]).assert().success();
    assert!(results(at, "merged") == one);
    study(at, &["mine.toml", "--merge", "a"]).assert().success();
    assert!(results(at, "a") == one);
    // A part that is lost is named; one of another seed, or that differs, is refused.
    let lost = refused(at, &["mine.toml", "--out", "lost", "--merge", "b"]);
    assert!(lost.contains("are in none of the merged folders, such as own/scene"), "{lost}");
    assert!(!at.join("lost").exists());
    study(at, &["mine.toml", "--out", "c", "--part", "1/3", "--seed", "7"]).assert().success();
    let other = refused(at, &["mine.toml", "--out", "mixed", "--merge", "b", "c"]);
    assert!(other.contains("of other settings") && other.contains("seed 7"), "{other}");
    // A part of other settings takes no place of those that are there.
    let other = refused(at, &["mine.toml", "--out", "c", "--part", "2/3", "--seed", "8"]);
    assert!(other.contains("holds cells of other settings") && other.contains("seed 7"), "{other}");
    let other = refused(at, &["mine.toml", "--out", "none", "--merge", "nowhere"]);
    assert!(!at.join("none").exists());
    assert!(other.contains("has no cells"), "{other}");
}

/// The predicted blur of fixed radii is what maps measure, with and without a treatment of the face; and the prediction of the one is
/// not that of the other.
#[test]
fn predictions_are_what_maps_measure() {
    let (folder, _file) = written(SLAB);
    let at = folder.path();
    study(at, &["mine.toml", "--out", "out"]).assert().success();
    let rows = rows(&at.join("out/results.csv"));
    let number = |row: &HashMap<String, String>, key: &str| row[key].parse::<f64>().unwrap();
    let z = |row: &HashMap<String, String>, of: f64| (number(row, "mean") - of) / number(row, "std_error");
    let limit = student_critical(ALPHA, 63);
    let predicted: Vec<_> = rows.iter().filter(|row| !row["predicted"].is_empty()).collect();
    assert_eq!(predicted.len(), 2 * 2 * 4 * 2);
    for row in &predicted {
        assert!(z(row, number(row, "predicted")).abs() < limit, "{row:?}");
    }
    let mut told_apart = 0;
    for row in predicted.iter().filter(|row| row["treatment"] == "none" && row["place"] == "probe 0") {
        let same = |other: &&&HashMap<String, String>| {
            other["treatment"] == "clipped"
                && ["albedo", "photons", "radius", "place"].iter().all(|key| other[*key] == row[*key])
        };
        let clipped = predicted.iter().find(same).unwrap();
        told_apart += usize::from(z(row, number(clipped, "predicted")).abs() > limit);
    }
    assert!(told_apart >= 4, "{told_apart} of 8");
    assert!(rows.iter().all(|row| row["place"] == "all" || row["reference_by"] == "exact"));
}

/// Nothing is written of what is refused, and one line says what is wrong.
#[test]
fn what_cannot_be_studied_is_refused_in_one_line() {
    let (folder, file) = written(SLAB);
    let at = folder.path();
    let changed = |from: &str, to: &str| {
        assert!(SLAB.contains(from));
        std::fs::write(&file, SLAB.replace(from, to)).unwrap();
        let text = refused(at, &["mine.toml", "--out", "out"]);
        assert!(!at.join("out").exists(), "{text}");
        text
    };
    let list = |n: usize| format!("[{}]", (0..n).map(|i| format!("0.{i:04}")).collect::<Vec<_>>().join(", "));
    for (from, to, words) in [
        ("photons = [500, 2e3]", "photon = [500]", "unknown key `photon`; nearest: `photons`"),
        ("photons = [500, 2e3]", "photons = [0]", "allowed: whole numbers from 1"),
        ("photons = [500, 2e3]", "photons = [500, 500]", "photons names one number twice"),
        ("maps = 64", "maps = 2", "maps is 2; allowed: at least 4"),
        ("scene = 'slab'", "scene = 'none.toml'", "cannot read"),
        ("scene = 'slab'", "scene = 'mine.toml'", "names itself"),
        ("albedo = [0.5, 0.9]", "albedo = [1.5]", "albedo"),
        ("albedo = [0.5, 0.9]", "albedoo = [0.5]", "unknown key `albedoo`"),
        ("albedo = [0.5, 0.9]", "tau = [1, 2.0, 1.0]", "axes.tau has 1.0 twice"),
        ("scene = 'slab'", "scene = 'none.xml'", "none.xml: cannot be read"),
        ("[2.0, 2.0, 0.1]", "[2.0, 2.0, -0.1]", "probe 0"),
        ("[2.0, 2.0, 0.1]", "[2.0, 2.0]", "mine.toml:9"),
        ("probes = [[2.0, 2.0, 0.1], [2.0, 2.0, 1.0]]", "sensors = ['nothing']", "no sensor \"nothing\""),
        ("probes = [[2.0, 2.0, 0.1], [2.0, 2.0, 1.0]]", "picture = {}", "no [camera]"),
        ("radius = [0.2, 0.4]", "radius = [9.0]", "beyond the periodic cell"),
        ("treatment = ['none', 'clipped']", "treatment = 'clip'", "treatment is \"clip\"; allowed: none"),
        ("target = 0.2", "target = -1", "target is -1"),
        ("title = 'Two slabs'", "title = 'Two slabs", "mine.toml:1"),
    ] {
        let text = changed(from, to);
        assert!(text.contains(words), "{to}: {text}");
    }
    let many = format!("albedo = {}\ng = {}\ntau = {}", list(300), list(300), list(300));
    let text = changed("albedo = [0.5, 0.9]", &many);
    assert!(text.contains("runs; allowed: up to 100000"), "{text}");
    std::fs::write(&file, SLAB).unwrap();
    assert!(refused(at, &["mine.toml", "--full"]).contains("--full"));
    assert!(refused(at, &["mine.toml", "--part", "4/3"]).contains("3/16"));
    assert!(refused(at, &["none.toml"]).contains("cannot read none.toml"));
    assert!(refused(at, &["mine.csv"]).contains("ends in .toml"));
    let run = Command::new(env!("CARGO_BIN_EXE_bias")).current_dir(at).arg("mine.toml").assert().code(2);
    let text = String::from_utf8(run.get_output().stderr.clone()).unwrap();
    assert!(text.contains("bias is one experiment; allowed: study mine.toml"), "{text}");
}

/// Too few paths scatter three times for an error: the places are told, and nothing is said relative to them; with enough of them it is.
#[test]
fn references_without_an_error_are_told() {
    let asked = |error: &str, most: &str| {
        let reference = format!("[reference]\nwith = 'paths'\nerror = {error}\nmost = {most}\n");
        of_a_ball()
            .replace("[[estimators]]\nk", &format!("{reference}[[estimators]]\nk"))
            .replace("[measure]", "[measure]\nmin_order = 3")
    };
    let (folder, file) = written(&asked("0.3", "1100"));
    let at = folder.path();
    let run = || {
        study(at, &["mine.toml", "--out", "out"]).assert().success();
        let report = std::fs::read_to_string(at.join("out/report.html")).unwrap();
        (report, rows(&at.join("out/results.csv")))
    };
    let (report, few) = run();
    assert!(report.contains("the samples of 2 of 2 places have no standard error"), "{report}");
    assert!(report.contains("or fewer than 1000 paths"));
    assert!(
        !few.is_empty() && few.iter().all(|row| row["reference_error"].is_empty() && row["rmse"].is_empty())
    );
    std::fs::write(&file, asked("0.3", "1e6")).unwrap();
    let (report, enough) = run();
    assert!(!report.contains("have no standard error"));
    assert!(enough.iter().all(|row| row["place"] == "all" || !row["reference_error"].is_empty()));
    assert!(enough.iter().any(|row| row["place"] == "all"));
}

/// What is refused leaves the results that are there.
#[test]
fn results_stay_where_a_later_study_is_refused() {
    let (folder, file) = written(&of_a_ball());
    let at = folder.path();
    study(at, &["mine.toml", "--out", "out"]).assert().success();
    let report = || std::fs::read(at.join("out/report.html")).unwrap();
    let before = (results(at, "out"), report());
    let narrow = of_a_ball().replace("radius = ", "radius = 1e-9 # ");
    assert_ne!(narrow, of_a_ball());
    std::fs::write(&file, narrow).unwrap();
    for arguments in [&["mine.toml", "--out", "out"][..], &["mine.toml", "--dry-run"]] {
        let said = refused(at, arguments);
        assert!(
            said.contains("mine.toml: the estimator \"") && said.contains("a gather radius of 1e-9 L"),
            "{said}"
        );
    }
    assert!(before == (results(at, "out"), report()));
    // Pictures are refused while they are measured.
    let picture = |radius: &str| {
        let read = format!(
            "[measure]\npicture = {{ width = 12, height = 12, samples = 1, blocks = [2, 2] }}\n[[estimators]]\nradius = {radius}\n"
        );
        std::fs::write(&file, format!("scene = 'fogbox'\nphotons = [1e3]\nmaps = 4\n{read}")).unwrap();
    };
    picture("0.3");
    study(at, &["mine.toml", "--out", "picture"]).assert().success();
    let predicted = || std::fs::read(at.join("picture/predictions.csv")).unwrap();
    let before = (results(at, "picture"), predicted());
    picture("1e-9");
    let said = refused(at, &["mine.toml", "--out", "picture"]);
    assert!(
        said.contains("mine.toml: cell scene000") && said.contains("a gather radius of 1e-9 L"),
        "{said}"
    );
    assert!(before == (results(at, "picture"), predicted()));
}

/// A scene of Mitsuba, with a mesh beside it, is studied as the scene file that is made of it.
#[test]
fn a_scene_of_mitsuba_is_that_which_is_made_of_it() {
    let room = "<scene version='3.0.0'><integrator type='volpath'/>
        <shape type='cube'><bsdf type='null'/><medium type='homogeneous' name='interior'><rgb name='sigma_t' value='1 2 3'/>
            <rgb name='albedo' value='0.8 0.7 0.6'/></medium></shape>
        <shape type='obj'><string name='filename' value='floor.obj'/><bsdf type='diffuse'/></shape>
        <emitter type='constant'/></scene>";
    let asks = "scene = 'SCENE'\nphotons = [500, 2000]\nmaps = 8\n[axes]\n'regions.0.g' = [0.0, 0.5]\n[measure]\n\
        probes = [[0.1, 0.2, 0.3]]\n[[estimators]]\nradius = [0.4]\n";
    let run = |name: &str| {
        let (folder, _) = written(&asks.replace("SCENE", name));
        let at = |name: &str| folder.path().join(name);
        std::fs::write(at("floor.obj"), "v -2 -1.5 2\nv 2 -1.5 2\nv 0 -1.5 -3\nf 1 2 3\n").unwrap();
        std::fs::write(at("room.xml"), room).unwrap();
        let imported = from_mitsuba(&at("room.xml"), "room", &[], false).unwrap();
        assert!(!imported.files.is_empty());
        imported.files.iter().for_each(|file| std::fs::write(at(&file.name), &file.bytes).unwrap());
        std::fs::write(at("room.toml"), imported.scene.to_toml().unwrap()).unwrap();
        study(folder.path(), &["mine.toml", "--out", "out"]).assert().success();
        results(folder.path(), "out")
    };
    let xml = run("room.xml");
    assert!(String::from_utf8_lossy(&xml).contains("0.4") && xml == run("room.toml"));
}

#[test]
fn a_dry_run_tells_and_writes_nothing() {
    let (folder, _file) = written(SLAB);
    let run = study(folder.path(), &["mine.toml", "--out", "out", "--dry-run"]).assert().success();
    let text = String::from_utf8(run.get_output().stdout.clone()).unwrap();
    assert!(text.contains("scene001-n2000") && text.contains("in all 288 cells"), "{text}");
    assert!(!folder.path().join("out").exists());
}

/// A scene in the study's own file is the scene of a file beside it; an axis that is called as a column is told apart from it.
#[test]
fn a_scene_within_the_file() {
    let scene = "cell = 2.0\n[[regions]]\nshape = { slab = { top = 0.0, thickness = 1.0 } }\nsigma_t = 1.0\nalbedo = 0.0\ng = 0.0\n\
                 [[lights]]\nbeam = { dir = [0, 0, 1], irradiance = 1.0, section = 'unbounded' }\n";
    let study_of = |scene: &str| {
        format!(
            "scene = {scene}\nphotons = [500]\nmaps = 4\naxes = {{ 'regions.0.sigma_t' = [0.5, 1.0] }}\n\
             measure = {{ probes = [[1, 1, 0.5]] }}\n"
        )
    };
    let within = "{ cell = 2.0, regions = [{ shape = { slab = { top = 0.0, thickness = 1.0 } }, sigma_t = 1.0, albedo = 0.0, g = 0.0 }], \
                  lights = [{ beam = { dir = [0, 0, 1], irradiance = 1.0, section = 'unbounded' } }] }";
    let (folder, file) = written(&study_of("'scene.toml'"));
    let at = folder.path();
    std::fs::write(at.join("scene.toml"), scene).unwrap();
    study(at, &["mine.toml", "--out", "beside"]).assert().success();
    std::fs::write(&file, study_of(within)).unwrap();
    study(at, &["mine.toml", "--out", "within"]).assert().success();
    assert!(results(at, "within") == results(at, "beside"));
    // Nothing is claimed and nothing answered: the tables have their headers all the same.
    for (table, columns) in [("claims", 15), ("headlines", 6), ("answers", 11)] {
        let text = std::fs::read_to_string(at.join("within").join(format!("{table}.csv"))).unwrap();
        assert_eq!(
            (text.lines().count(), text.trim_end().split(',').count()),
            (1, columns),
            "{table}: {text}"
        );
    }
    std::fs::write(&file, study_of(&within.replace("albedo = 0.0", "albedo = 1.5"))).unwrap();
    assert!(refused(at, &["mine.toml"]).ends_with("mine.toml: scene: albedo is 1.5; allowed: 0 to 1"));
    std::fs::write(&file, "scene = 'sphere'\nphotons = [500]\nmaps = 4\naxes = { radius = [1.0] }\n")
        .unwrap();
    study(at, &["mine.toml", "--out", "ball"]).assert().success();
    let rows = rows(&at.join("ball/results.csv"));
    assert!(rows.iter().all(|row| row["scene.radius"] == "1.0" && row["radius"].is_empty()));
}

/// A picture is compared block by block and layer by layer; light that maps and paths both find agrees.
#[test]
fn a_picture_by_layer() {
    let text = "scene = 'fogbox'\nphotons = [2e4]\nmaps = 8\n[measure]\npicture = { width = 12, height = 9, blocks = [2, 2] }\n\
                [[estimators]]\nk = 50\n[[estimators]]\nbeam_radius = 0.05\nbeam_length = 'whole'\n\
                [[estimators]]\nbeam_radius = 0.05\nplanes = true\n[reference]\nerror = 0.05\n";
    let (folder, file) = written(text);
    let at = folder.path();
    study(at, &["mine.toml", "--out", "out"]).assert().success();
    let rows = rows(&at.join("out/results.csv"));
    let of = |group: &str| rows.iter().filter(|row| row["place"].starts_with(group)).count();
    assert_eq!(
        (of("total"), of("single"), of("multiple"), of("direct"), of("all single")),
        (12, 12, 12, 12, 3)
    );
    // A strip of 0.05 blurs by less than balls of 50 photons of so few.
    let is_sharp = |place: &str, radius: &str| {
        place.starts_with("direct") || (place.starts_with("multiple") && !radius.is_empty())
    };
    let sharp: Vec<_> = rows.iter().filter(|row| is_sharp(&row["place"], &row["beam_radius"])).collect();
    assert_eq!(sharp.len(), 20);
    for row in sharp {
        let number = |key: &str| row[key].parse::<f64>().unwrap();
        let error = (number("std_error").powi(2) + number("reference_error").powi(2)).sqrt();
        let z = (number("mean") - number("reference")) / error;
        assert!(z.abs() < student_critical(ALPHA, 7), "{row:?}");
    }
    let own = text.replace("planes = true", "ray_ends = 'own'");
    std::fs::write(&file, own).unwrap();
    assert!(
        refused(at, &["mine.toml", "--out", "out"]).contains("one homogeneous region with nothing in it")
    );
    let pool = format!("scene = '{}/scenes/pool.toml'", env!("CARGO_MANIFEST_DIR"));
    std::fs::write(&file, text.replace("scene = 'fogbox'", &pool)).unwrap();
    assert!(refused(at, &["mine.toml", "--out", "out"]).contains("planes: planes can be stored neither"));
}

/// Rays and places of an exact slab by points along rays, and by beams of every blur, length and end, and by planes: all right, each with its
/// own words in the table.
#[test]
fn every_way_of_reading_rays_is_an_estimator() {
    let (folder, _file) = written(
        "\
scene = 'slab'
photons = [5e3]
maps = 64
[measure]
probes = [[2.0, 2.0, 0.5]]
rays = [{ origin = [1.0, 1.0, -0.5], dir = [0.6, 0, 0.8] }]
[[estimators]]
ray_radius = 0.1
ray_ends = ['cut', 'own']
[[estimators]]
beam_radius = 0.1
beam_blur = ['1d', '2d']
beam_length = 'whole'
ray_ends = ['cut', 'own']
[[estimators]]
beam_radius = 0.12
beam_length = 'whole'
beam_fluence = true
[[estimators]]
beam_radius = 0.1
beam_length = 'whole'
planes = true
",
    );
    study(folder.path(), &["mine.toml", "--out", "out"]).assert().success();
    let all = rows(&folder.path().join("out/results.csv"));
    let mut words = std::collections::BTreeSet::new();
    for row in all.iter().filter(|row| row["place"] != "all") {
        let number = |key: &str| row[key].parse::<f64>().unwrap();
        let (bias, error) = (number("bias"), number("bias_error"));
        // A ball of 0.1 or a strip of 0.1 mean free paths blurs by less than a per cent.
        assert!(error < 0.1 && bias.abs() < 5.0 * error + 0.01, "{row:?}");
        let keys =
            ["ray_radius", "beam_radius", "beam_blur", "beam_length", "beam_fluence", "planes", "ray_ends"];
        words.insert(keys.map(|key| row[key].clone()).join(","));
    }
    let expected = [
        ",0.1,1d,whole,false,false,cut",
        ",0.1,1d,whole,false,false,own",
        ",0.1,1d,whole,false,true,cut",
        ",0.1,2d,whole,false,false,cut",
        ",0.1,2d,whole,false,false,own",
        ",0.12,1d,whole,true,false,cut",
        "0.1,,,,,,cut",
        "0.1,,,,,,own",
    ];
    assert_eq!(words.into_iter().collect::<Vec<_>>(), expected);
    for (change, told) in [
        (
            ("beam_radius = 0.12\nbeam_length = 'whole'", "beam_radius = 0.12"),
            "some beams are sampled and some whole",
        ),
        (("beam_blur = ['1d', '2d']", "beam_blur = '4d'"), "beam_blur is \"4d\"; allowed: 1d, 2d, 3d"),
        (("beam_blur = ['1d', '2d']", "beam_blur = '3d'"), "rays have none; allowed: 1d, 2d"),
        (("beam_radius = 0.12\n", "radius = 0.12\n"), "say how beams are read; allowed: with beam_radius"),
    ] {
        let text = std::fs::read_to_string(folder.path().join("mine.toml")).unwrap();
        std::fs::write(folder.path().join("bad.toml"), text.replace(change.0, change.1)).unwrap();
        let said = refused(folder.path(), &["bad.toml", "--out", "bad"]);
        assert!(said.contains(told), "{said}");
    }
}

/// Halves of two maps, whose spread the reference's own error hides, tell no error: that is said, nothing else is missing.
#[test]
fn too_few_maps_for_an_error_are_said_to_be_too_few() {
    let (folder, _file) = written(
        "\
photons = [1e3, 2e3]
maps = 4
estimators = [{ k = 30 }]
measure = { probes = [[0, 0.6, 0]] }
[[scene.lights]]
area = { shape = { sphere = { center = [-1.5, 2.5, 0], radius = 0.3 } }, radiance = 10 }
[[scene.regions]]
shape = { cuboid = { min = [-1, -1, -1], max = [1, 1, 1] } }
sigma_t = 2.0
albedo = 0.95
g = 0.8
",
    );
    let run = study(folder.path(), &["mine.toml", "--out", "out"]).assert().success();
    let said = String::from_utf8(run.get_output().stdout.clone()).unwrap();
    assert!(said.contains("too few maps to tell its error") && !said.contains("unknown"), "{said}");
    let all = rows(&folder.path().join("out/results.csv"));
    assert!(all.iter().any(|row| row["place"] == "all") && folder.path().join("out/costs.csv").exists());
}

/// The script that deals parts out to GNU parallel, or to xargs where there is none.
#[cfg(unix)]
#[test]
fn parts_by_gnu_parallel() {
    let text = of_a_ball().replace("maps = 64", "maps = 4").replace("[500, 2e3]", "[500]");
    let (folder, _file) = written(&text);
    let at = folder.path();
    study(at, &["mine.toml", "--out", "one"]).assert().success();
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("studies/cluster/in-parts.sh");
    let mut command = Command::new(script);
    command.current_dir(at).env("TURBID_STUDY", env!("CARGO_BIN_EXE_study"));
    command.args(["mine.toml", "parts", "3"]).assert().success();
    assert!(results(at, "one") == results(at, "parts"));
}
