//! Sensors with bins: tables, arrays, grids, and what is refused.

use crate::{BELOW_A_PANE, Folder, refuses_naming, succeeds, text, turbid};
use turbid::medium::Grid;

const SLAB: &str = "cell = 2.0\n[[regions]]\nshape = { slab = { top = 0.0, thickness = 1.0 } }\nsigma_t = [1, 2, 3]\nalbedo = 0.5\ng = 0\n\
    [[lights]]\nbeam = { dir = [0, 0, 1], irradiance = 1, section = \"unbounded\" }\n";

const ROOM: &str = "[[regions]]\nshape = { sphere = { center = [0, 0, 0], radius = 1 } }\nsigma_t = 1\nalbedo = 0.5\ng = 0\n\
    [[lights]]\narea = { shape = { sphere = { center = [0, 0, 3], radius = 0.5 } }, radiance = 1 }\n";

fn sensor(measure: &str) -> String {
    format!("[[sensors]]\nname = \"s\"\nmeasure = {{ {measure} }}\n")
}

/// Rows of a run that succeeds.
fn rows(arguments: &[&str]) -> Vec<csv::StringRecord> {
    let output = turbid(arguments).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let mut reader = csv::Reader::from_reader(output.stdout.as_slice());
    assert_eq!(reader.headers().unwrap().len(), 13 + 25);
    reader.records().collect::<Result<_, _>>().unwrap()
}

/// Voxels by each method: the array holds every bit of the table, the grid its means.
#[test]
fn a_table_an_array_and_a_grid_hold_the_same() {
    let folder = Folder::new();
    let voxels = "mean-fluence = { min = [0, 0, 0], max = [2, 2, 1], cells = [2, 1, 3] }";
    let scene = folder.file("slab.toml", &format!("{SLAB}{}", sensor(voxels)));
    let (array, grid) = (folder.0.path().join("a.npy"), folder.0.path().join("a.vol"));
    for with in ["light", "path", "photons"] {
        let count: &[&str] = match with {
            "path" => &["--samples", "2e3"],
            "light" => &["--photons", "2e4"],
            _ => &["--photons", "2e4", "--maps", "4"],
        };
        let files = ["--format", "csv", "--npy", text(&array), "--vol", text(&grid)];
        let rows = rows(&[&["measure", text(&scene), "--with", with][..], count, &files].concat());
        assert_eq!(rows.len(), 18);
        assert_eq!((&rows[0][1], &rows[17][1]), ("fluence.r", "fluence.b"));
        assert_eq!((&rows[3][3], &rows[3][4], &rows[3][5]), ("1", "0", "0"));
        assert_eq!((&rows[3][6], &rows[3][7]), ("1.5", "1.0"));
        let bytes = std::fs::read(&array).unwrap();
        assert_eq!(bytes.len(), 128 + 8 * 36);
        assert!(String::from_utf8_lossy(&bytes[..128]).contains("'shape': (2, 1, 3, 3, 2), }"));
        let grid = Grid::read(&grid).unwrap();
        assert_eq!((grid.count(), grid.channels()), ([2, 1, 3], 3));
        for (number, row) in rows.iter().enumerate() {
            let [i, k] = [3, 5].map(|column| row[column].parse::<usize>().unwrap());
            let place = 128 + 16 * (3 * (3 * i + k) + number % 3);
            let double = |at: usize| f64::from_le_bytes(bytes[at..at + 8].try_into().unwrap());
            let mean: f64 = row[9].parse().unwrap();
            assert_eq!(double(place).to_bits(), mean.to_bits(), "{with}, {row:?}");
            let error = double(place + 8);
            assert!(row[10].parse().map_or(error.is_nan(), |e: f64| e.to_bits() == error.to_bits()));
            assert_eq!(grid.values()[number].to_bits(), (mean as f32).to_bits());
        }
    }
}

/// What no photon comes to has no error, and says why; beside bins, sensors without have empty columns.
#[test]
fn bins_that_nothing_reaches_say_so() {
    let folder = Folder::new();
    let dark =
        "flux = { corner = [-1, -1, -2], u = [2, 0, 0], v = [0, 2, 0], bins = [1, 1], crossing = \"along\" }";
    let file = folder.file(
        "dark.toml",
        &format!("{ROOM}{}max_order = 0\n{}", sensor(dark), sensor("absorbed = { region = 0 }")),
    );
    let output = turbid(&["measure", text(&file), "--with", "light", "--photons", "1e4"]).output().unwrap();
    let table = String::from_utf8(output.stdout).unwrap();
    assert!(table.contains("nothing-found"), "{table}");
    assert_eq!(table.lines().count(), 3);
    let told = String::from_utf8(output.stderr).unwrap();
    assert!(told.contains("nothing-found: ") && told.contains("s flux (1 bins)"), "{told}");
}

#[test]
fn bins_that_cannot_be_are_refused() {
    let folder = Folder::new();
    let refused = |scene: &str, more: &str, with: &[&str], words: &[&str]| {
        let file = folder.file("scene.toml", &format!("{scene}{more}"));
        let arguments: Vec<&str> = ["measure", text(&file), "--with"].iter().chain(with).copied().collect();
        refuses_naming(&arguments, words);
    };
    let flux = |corner: &str, u: &str, v: &str, bins: &str| {
        sensor(&format!("flux = {{ corner = {corner}, u = {u}, v = {v}, bins = {bins} }}"))
    };
    let [x, y] = ["[2, 0, 0]", "[0, 2, 0]"];
    // Places.
    refused(
        SLAB,
        &flux("[1, 0, 0]", x, y, "[1, 1]"),
        &["light"],
        &["sensor s", "(3, 0)", "within the cell, 0 to 2"],
    );
    refused(SLAB, &flux("[0, 0, 0]", x, "[0, 0, 1]", "[1, 1]"), &["light"], &["sensor s", "across z"]);
    refused(ROOM, &flux("[0, 0, 0]", x, "[1, 1, 0]", "[1, 1]"), &["path"], &["sensor s", "perpendicular"]);
    refused(ROOM, &flux("[0, 0, 0]", x, y, "[0, 1]"), &["path"], &["sensor s", "bins", "1 or more"]);
    refused(
        ROOM,
        &flux("[0, 0, 0]", x, y, "[4000, 4000]"),
        &["path"],
        &["sensor s", "16000000", "at most 4194304"],
    );
    let table = "[[objects]]\nshape = { rectangle = { corner = [0, 0, -2], u = [2, 0, 0], v = [0, 2, 0] } }\nsurface = \"black\"\n";
    refused(
        ROOM,
        &format!("{table}{}", flux("[0, 0, -2]", x, y, "[1, 1]")),
        &["path"],
        &["sensor s lies on the surface of objects[0]"],
    );
    let half = "mean-fluence = { min = [0, 0, 0], cells = [1, 1, 1] }";
    refused(ROOM, &sensor(half), &["path"], &["sensor s", "`min`, `max` and `cells`", "`region`"]);
    refused(ROOM, &sensor("mean-fluence = { region = 1 }"), &["path"], &["sensor s", "allowed: 0 to 0"]);
    let wrong =
        "flux = { corner = [0, 0, 0], u = [1, 0, 0], v = [0, 1, 0], bins = [1, 1], crossing = \"up\" }";
    refused(ROOM, &sensor(wrong), &["path"], &["`up`", "along"]);
    let ends = "mean-fluence = { region = 0, scoring = \"analog\" }";
    refused(ROOM, &sensor(ends), &["path"], &["sensor s", "analog", "track-length, collision"]);
    // Methods.
    refused(
        ROOM,
        &sensor("fluence = { at = [0, 0, 0.5] }"),
        &["light"],
        &["sensor s", "means over bins", "use paths"],
    );
    let seen = "mean-radiance = { corner = [0, 0, -2], u = [1, 0, 0], v = [0, 1, 0], bins = [1, 1], dir = [0, 0, 1] }";
    refused(ROOM, &sensor(seen), &["light"], &["sensor s", "lights themselves", "min_order = 1"]);
    let mirror = "[[objects]]\nshape = { sphere = { center = [5, 0, 0], radius = 1 } }\nsurface = { mirror = { reflectance = 1 } }\n";
    refused(
        ROOM,
        &format!("{mirror}{}min_order = 1\n", sensor(seen)),
        &["light"],
        &["sensor s", "mirrors or glass"],
    );
    refused(ROOM, &format!("{mirror}{}", sensor(seen)), &["photons"], &["sensor s", "surfaces", "use paths"]);
    let beside =
        "mean-fluence = { min = [-1, -1, -1], max = [1, 1, 1], cells = [2, 2, 2], scoring = \"collision\" }";
    refused(ROOM, &sensor(beside), &["light"], &["sensor s", "no light collides", "track-length"]);
    refused(
        ROOM,
        &sensor(beside),
        &["photons"],
        &["sensor s", "only where light of every channel collides", "use paths"],
    );
    // Whatever the seed: the points that a map is asked at would miss a layer that is as thin as a hundredth.
    let layered = "[[regions]]\nshape = { cuboid = { min = [0, 0, 0], max = [1, 1, 1] } }\nsigma_t = 1\nalbedo = 0.9\ng = 0\n\
        density = { layers = { axis = \"x\", edges = [0, 0.01, 1], density = [0, 1] } }\n\
        [[lights]]\npoint = { position = [2, 0.5, 0.5], power = 10 }\n";
    for seed in ["1", "2", "3", "4"] {
        let by_maps = ["photons", "--photons", "16000", "--radius", "0.1", "--seed", seed];
        refused(
            layered,
            &sensor("mean-fluence = { region = 0 }"),
            &by_maps,
            &["sensor s", "collides", "use paths"],
        );
    }
    // Files and memory.
    let array = folder.0.path().join("none").join("a.npy");
    let one = sensor("mean-fluence = { region = 0 }");
    refused(ROOM, &one, &["light", "--npy", text(&array)], &["cannot write", "none"]);
    let array = folder.0.path().join("a.npy");
    let plain = sensor("absorbed = { region = 0 }");
    refused(ROOM, &plain, &["light", "--npy", text(&array)], &["--npy", "one sensor with bins", "has 0"]);
    refused(ROOM, &format!("{one}{one}"), &["light", "--vol", text(&array)], &["--vol", "has 2"]);
    refused(ROOM, &one, &["light", "--vol", text(&array)], &["--vol writes voxels", "--npy"]);
    let many = "mean-fluence = { min = [-1, -1, -1], max = [1, 1, 1], cells = [100, 100, 100] }";
    refused(
        ROOM,
        &sensor(many),
        &["light", "--memory", "100M"],
        &["1000000 bins takes about", "allowed: ", " bins"],
    );
    assert!(!array.exists());
}

/// Photons of lights from outside start on the slab, and those of a sun cover what is in the scene: bins elsewhere would miss light
/// that goes straight, and are refused unless they leave it out.
#[test]
fn bins_where_light_from_outside_has_not_been() {
    let folder = Folder::new();
    let slab = "cell = 2.0\n[[regions]]\nshape = { slab = { top = 0, thickness = 1 } }\nsigma_t = 1\nalbedo = 0.5\ng = 0\n";
    let ball = "[[regions]]\nshape = { sphere = { center = [0, 0, 0], radius = 1 } }\nsigma_t = 1\nalbedo = 0.5\ng = 0\n";
    let beam = "[[lights]]\nbeam = { dir = [0, 0, 1], irradiance = 1, section = \"unbounded\" }\n";
    let diffuse = "[[lights]]\nisotropic = { shape = { slab = { top = 0, thickness = 1 } }, faces = \"top\", radiance = 1 }\n";
    let sun = "[[lights]]\nsun = { dir = [0, 0, 1], irradiance = 1, angular_radius = 0 }\n";
    let voxels = |from: f64, to: f64| {
        format!("mean-fluence = {{ min = [0, 0, {from:?}], max = [1, 1, {to:?}], cells = [1, 1, 1] }}")
    };
    let flux = |z: f64, crossing: &str| {
        format!(
            "flux = {{ corner = [0, 0, {z:?}], u = [1, 0, 0], v = [0, 1, 0], bins = [1, 1], crossing = \"{crossing}\" }}"
        )
    };
    for (world, light, measure, orders, is_refused) in [
        (slab, beam, voxels(-0.5, 0.5), "", true),
        (slab, beam, voxels(-0.5, 0.5), "min_order = 1\n", false),
        (slab, beam, voxels(0.0, 1.5), "", false),
        (slab, beam, flux(-0.5, "net"), "", true),
        (slab, beam, flux(-0.5, "along"), "", true),
        (slab, beam, flux(-0.5, "against"), "", false),
        (slab, diffuse, voxels(-0.5, 0.5), "", true),
        (slab, diffuse, voxels(0.5, 1.5), "", false),
        (ball, sun, voxels(1.5, 2.0), "", true),
        (
            ball,
            sun,
            "mean-fluence = { min = [0, 0, 0], max = [0.5, 0.5, 0.5], cells = [1, 1, 1] }".into(),
            "",
            false,
        ),
    ] {
        let text_of =
            format!("{world}{light}[[sensors]]\nname = \"here\"\nmeasure = {{ {measure} }}\n{orders}");
        let file = folder.file("scene.toml", &text_of);
        for with in ["light", "photons"] {
            // Photon maps estimate fluences by themselves, in media.
            if with == "photons" && measure.starts_with("mean-fluence") {
                continue;
            }
            let maps: &[&str] = if with == "photons" { &["--maps", "2"] } else { &[] };
            let arguments =
                [&["measure", text(&file), "--with", with, "--photons", "2000"][..], maps].concat();
            if is_refused {
                refuses_naming(&arguments, &["sensor here: its bins reach", "give it `min_order = 1`"]);
            } else {
                succeeds(&arguments);
            }
        }
    }
    let scene = format!("{slab}{beam}[[sensors]]\nname = \"here\"\nmeasure = {{ {} }}\n", voxels(0.0, 1.0));
    let file = folder.file("scene.toml", &scene);
    let onto = ["measure", text(&file), "--with", "light", "--photons", "100", "--npy", text(&file)];
    refuses_naming(&onto, &["--npy names a file of the scene"]);
    assert_eq!(std::fs::read_to_string(&file).unwrap(), scene);
}

/// What is measured by guided paths says so, and is not what paths find; windows and guides are asked for one at a time.
#[test]
fn guided_measurements_say_so() {
    let folder = Folder::new();
    let file = folder.file("scene.toml", BELOW_A_PANE);
    let arguments = ["measure", text(&file), "--with", "paths", "--samples", "20000", "--format", "csv"];
    let paths = succeeds(&arguments);
    let guided = succeeds(&[&arguments[..], &["--guide", "20000"]].concat());
    let column = |table: &str, name: &str| -> String {
        let mut lines = table.lines().map(|line| line.split(',').map(str::to_string).collect::<Vec<_>>());
        let at = lines.next().unwrap().iter().position(|column| column == name).unwrap();
        lines.next().unwrap()[at].clone()
    };
    assert_eq!((column(&paths, "guide"), column(&guided, "guide")), (String::new(), "20000".to_string()));
    assert_ne!(column(&paths, "mean"), column(&guided, "mean"));
    refuses_naming(
        &[&arguments[..], &["--guide", "9", "--weight-windows"]].concat(),
        &["--weight-windows", "--guide"],
    );
    refuses_naming(&[&arguments[..], &["--guide", "2e7"]].concat(), &["--guide", "from 1 to 10000000"]);
}

/// Weight windows would end paths to light that comes from all sides.
#[test]
fn weight_windows_without_a_direction() {
    let folder = Folder::new();
    let scene = "cell = 2.0\n[[regions]]\nshape = { slab = { top = 0, thickness = 1 } }\nsigma_t = 1\nalbedo = 0.5\ng = 0\n\
                 [[lights]]\nvolume-source = { shape = { slab = { top = 0, thickness = 1 } }, density = 1 }\n\
                 [[sensors]]\nname = \"here\"\nmeasure = { fluence = { at = [1, 1, 0.5] } }\n";
    let file = folder.file("scene.toml", scene);
    let arguments = ["measure", text(&file), "--with", "path", "--samples", "2000"];
    succeeds(&arguments);
    refuses_naming(
        &[&arguments[..], &["--weight-windows"]].concat(),
        &["sources in a slab without end, are on all sides"],
    );
}
