//! Media in scene files: what `check` says of them, and every way in which their files can be wrong.

use crate::{Folder, refuses_naming, succeeds, text};

/// A ball of fog with other keys of its medium, and a light.
fn scene(keys: &str) -> String {
    format!(
        "[[regions]]\nshape = {{ cuboid = {{ min = [0, 0, 0], max = [1, 1, 1] }} }}\nsigma_t = 1.0\nalbedo = 0.5\n{keys}\n\
         [[lights]]\npoint = {{ position = [2, 0, 0], power = 1 }}\n"
    )
}

/// A `.vol` file byte by byte: 2 x 1 x 1 samples over the unit cube.
pub fn vol(values: [f32; 2]) -> Vec<u8> {
    let mut bytes = vec![b'V', b'O', b'L', 3];
    for number in [1i32, 2, 1, 1, 1] {
        bytes.extend(number.to_le_bytes());
    }
    for number in [0.0f32, 0.0, 0.0, 1.0, 1.0, 1.0].into_iter().chain(values) {
        bytes.extend(number.to_le_bytes());
    }
    bytes
}

#[test]
fn media_are_described() {
    let folder = Folder::new();
    std::fs::write(folder.0.path().join("fog.vol"), vol([1.0, 3.0])).unwrap();
    std::fs::write(folder.0.path().join("mie.txt"), "# angle value\n0 10\n90, 1\n180 2\n").unwrap();
    let density = "density = { grid = { file = \"fog.vol\", scale = 2 } }";
    for (keys, words) in [
        (format!("g = 0\n{density}"), "grid of 2 x 1 x 1 samples"),
        (format!("phase = {{ table = {{ file = \"mie.txt\" }} }}\n{density}"), "delta tracking"),
        ("phase = { rayleigh = {} }\ndensity = { cloud = { center = [0.5, 0.5, 0.5], radii = [0.4, 0.4, 0.4] } }".into(), "cloud of 5 octaves"),
        ("phase = { two-term = { g1 = 0.8, g2 = -0.3, share = 0.7 } }\nemission = 1".into(), "emitting media"),
        ("phase = { schlick = { k = 0.5 } }\ndensity = { height-fog = { base = 0, scale_height = 0.2, up = [0, 1, 0] } }".into(), "height fog"),
        ("g = 0.5".into(), "homogeneous media: flights and transmittance in closed form"),
    ] {
        let file = folder.file("scene.toml", &scene(&keys));
        let said = succeeds(&["check", text(&file)]);
        assert!(said.contains(words), "{keys}: {said}");
    }
}

#[test]
fn wrong_keys_of_a_medium() {
    let folder = Folder::new();
    for (keys, words) in [
        ("", "allowed: sigma_t, albedo (or sigma_a, sigma_s) and g (or phase)"),
        ("g = 0\nphase = { rayleigh = {} }", "regions[0]: g and phase"),
        ("phase = { raileigh = {} }", "nearest: `rayleigh`"),
        ("phase = { schlick = { k = 1 } }", "allowed: above -1 and below 1"),
        ("phase = { two-term = { g1 = 0, g2 = 0, share = 2 } }", "allowed: 0 to 1"),
        ("g = 0\nemission = -1", "allowed: finite and at least 0"),
        ("g = 0\nemission_by_density = 1", "allowed: beside density"),
        ("g = 0\ndensity = { cloud = { center = [0, 0, 0], radii = [0, 1, 1] } }", "radius of a cloud is 0"),
        ("g = 0\ndensity = { cloud = { center = [0, 0, 0], radii = [1, 1, 1], octaves = 13 } }", "1 to 12"),
        (
            "g = 0\ndensity = { cloud = { center = [0, 0, 0], radii = [1, 1, 1e308] } }",
            "radius of a cloud is 1e308; allowed: 1e-100 to 1e100",
        ),
        (
            "g = 0\ndensity = { cloud = { center = [0, -1e300, 0], radii = [1, 1, 1] } }",
            "coordinate of a cloud's centre is -1e300; allowed: up to 1e100 in size",
        ),
        ("g = 0\ndensity = { height-fog = { base = 0, scale_height = 0, up = [0, 1, 0] } }", "above 0"),
        (
            "g = 0\ndensity = { height-fog = { base = 0, scale_height = 1, up = [0, 0, 0] } }",
            "other than 0 0 0",
        ),
        ("g = 0\ndensity = { grid = { file = \"none.vol\" } }", "none.vol: No such file"),
        ("phase = { table = { file = \"none.txt\" } }", "none.txt: No such file"),
    ] {
        let file = folder.file("scene.toml", &scene(keys));
        refuses_naming(&["check", text(&file)], &["scene.toml", words]);
    }
}

#[test]
fn wrong_grids() {
    let folder = Folder::new();
    let file = folder.file("scene.toml", &scene("g = 0\ndensity = { grid = { file = \"fog.vol\" } }"));
    let right = vol([1.0, 3.0]);
    let changed = |at: usize, bytes: &[u8]| {
        let mut file = right.clone();
        file[at..at + bytes.len()].copy_from_slice(bytes);
        file
    };
    for (bytes, words) in [
        (Vec::new(), "does not start with `VOL`"),
        (changed(0, b"PNG"), "does not start with `VOL`"),
        (changed(3, &[2]), "version is 2; allowed: 3"),
        (right[..30].to_vec(), "ends after 30 bytes"),
        (right[..52].to_vec(), "has 52 bytes; allowed: 56"),
        (changed(4, &2i32.to_le_bytes()), "type of the values is 2"),
        (changed(8, &0i32.to_le_bytes()), "samples along x are 0"),
        (changed(12, &(-5i32).to_le_bytes()), "samples along y are -5"),
        (changed(20, &2i32.to_le_bytes()), "channels are 2; allowed: 1 or 3"),
        (changed(36, &0f32.to_le_bytes()), "at least 1e-100 long along each axis"),
        (vol([1.0, -1.0]), "sample 1 0 0 is -1"),
        (vol([f32::NAN, 1.0]), "sample 0 0 0 is NaN"),
        (vol([1.0, f32::INFINITY]), "inf"),
    ] {
        std::fs::write(folder.0.path().join("fog.vol"), bytes).unwrap();
        refuses_naming(&["check", text(&file)], &["fog.vol", words]);
    }
}

#[test]
fn wrong_tables_of_a_phase_function() {
    let folder = Folder::new();
    let file = folder.file("scene.toml", &scene("phase = { table = { file = \"mie.txt\" } }"));
    for (table, words) in [
        ("", "0 angles; allowed: 2 or more"),
        ("0 1\n", "1 angles"),
        ("0 1\n90 1\n", "run from 0 to 90"),
        ("0 1\n180 1\n90 1\n", "line 3: angle 90 after 180"),
        ("0 1\n90 -1\n180 1\n", "line 2: value is -1"),
        ("0 1\n90 nan\n180 1\n", "line 2: value is NaN"),
        ("0 1\n90 inf\n180 1\n", "line 2: value is inf"),
        ("0 0\n180 0\n", "every value is 0"),
        ("0 1\n90 one\n180 1\n", "line 2: `90 one` is no pair of numbers"),
        ("0 1 2\n180 1\n", "line 1 has 3 words"),
    ] {
        folder.file("mie.txt", table);
        refuses_naming(&["check", text(&file)], &["mie.txt", words]);
    }
}

/// Tracking through what varies takes tentative collisions by the depth of its upper bound, which is limited; a cloud is no
/// larger than itself, whatever the region.
#[test]
fn media_that_vary_have_a_limited_depth() {
    let folder = Folder::new();
    let of = |density: &str| {
        format!(
            "[[regions]]\nshape = {{ sphere = {{ center = [0, 0, 0], radius = 1000 }} }}\nsigma_t = 1000\nalbedo = 0.5\ng = 0\n\
             density = {{ {density} }}\n[[lights]]\npoint = {{ position = [0, 0, 0], power = 1 }}\n"
        )
    };
    let fog =
        folder.file("fog.toml", &of("height-fog = { base = 1000, scale_height = 1000, up = [0, 0, 1] }"));
    let words = "regions[0]: diameter over the shortest mean free path, of a density that varies is";
    refuses_naming(&["check", text(&fog)], &[words, "allowed: at most 1e5"]);
    let cloud = folder.file("cloud.toml", &of("cloud = { center = [0, 0, 0], radii = [2, 1, 1] }"));
    succeeds(&["check", text(&cloud)]);
}

/// A channel in which nothing collides has no light from the volume map, and no number that is none.
#[test]
fn a_clear_channel_has_no_scattered_light() {
    let folder = Folder::new();
    let file = folder.file(
        "clear.toml",
        "[[regions]]\nshape = { cuboid = { min = [-2, -2, -2], max = [2, 2, 2] } }\nsigma_t = [0, 2.4, 1]\nalbedo = 0.4\ng = 0.3\n\
         [[lights]]\npoint = { position = [0.8, 0.3, 0.6], power = 5 }\n\
         [[sensors]]\nname = \"s\"\nmeasure = { radiance = { origin = [-0.6, 0, -0.1], dir = [0.1, 0.2, 1] } }\n",
    );
    let arguments = ["measure", text(&file), "--with", "photons", "--photons", "1000", "--maps", "4"];
    let said = succeeds(&[&arguments[..], &["--format", "csv"]].concat());
    let mean = |channel: &str| -> f64 {
        let line = said.lines().find(|line| line.contains(&format!("radiance{channel}"))).unwrap();
        line.split(',').find_map(|field| field.parse().ok()).unwrap()
    };
    assert!(mean(".r") == 0.0 && mean(".g") > 0.0, "{said}");
}

/// A slab of a density in a cell, and a beam.
fn slab(cell: &str, density: &str) -> String {
    format!(
        "cell = {cell}\n[[regions]]\nshape = {{ slab = {{ top = 0, thickness = 0.25 }} }}\nsigma_t = 1\nalbedo = 1\ng = 0.85\n\
         density = {{ {density} }}\n\
         [[lights]]\nbeam = {{ dir = [0.6, 0, 0.8], irradiance = 1, section = \"unbounded\" }}\n"
    )
}

/// Densities in blocks, with what `check` says of them; and one medium said in three ways has the same fluxes, bit for bit.
#[test]
fn structured_slabs() {
    let folder = Folder::new();
    let table = "i, optical_depth, base, top\n0, 2, 0, 0.25\n1, 18, 0, 0.25\n";
    folder.file("step.csv", table);
    folder.file("two.csv", "i,j,extinction\n0,0,1\n1,0,2\n0,1,3\n1,1,4\n");
    let inline =
        "columns = { extinction = [8, 72], base = 0, top = [0.25, 0.25], width = [0.25], ground = 0.25 }";
    let voxels = "grid = { values = [8, 72], count = [2, 1, 1], min = [0, 0, 0], max = [0.5, 1, 0.25], interpolation = \"blocks\" }";
    let outflow = "[[sensors]]\nname = \"up\"\nmeasure = { outflow = { shape = { slab = { top = 0, thickness = 0.25 } }, face = \"top\" } }\n";
    let mut found = Vec::new();
    for (cell, density, words) in [
        (
            "0.5",
            "columns = { file = \"step.csv\", width = [0.25], ground = 0.25 }",
            "2 x 1 columns, constant in each; periodic",
        ),
        ("[0.5, 0.5]", inline, "2 x 1 columns, constant in each; periodic"),
        ("[0.5, 0.5]", voxels, "2 x 1 x 1 blocks, constant in each; periodic"),
    ] {
        let file = folder.file("scene.toml", &(slab(cell, density) + outflow));
        let said = succeeds(&["check", text(&file)]);
        assert!(said.contains(words), "{density}: {said}");
        let arguments = ["measure", text(&file), "--with", "photons", "--photons", "2000", "--maps", "1"];
        found.push(crate::turbid(&arguments).output().unwrap().stdout);
    }
    assert!(found[0] == found[1] && found[0] == found[2] && !found[0].is_empty());
    for (cell, density, words) in [
        (
            "[2, 3]",
            "columns = { file = \"two.csv\", width = [1, 1.5], ground = 0.25, base = 0, top = 0.2, corner = [5, 5] }",
            "2 x 2 columns",
        ),
        (
            "[0.5, 3]",
            "grid = { values = [8, 72, 3, 4], count = [4, 1, 1], min = [0, 0, 0], max = [0.5, 1, 0.25] }",
            "grid of 6 x 1 x 1 samples, majorants in 1 cells; periodic",
        ),
        (
            "1",
            "layers = { axis = \"z\", edges = [0, 0.1, 0.25], density = [1, 2], albedo = [1, 0.5] }",
            "1 x 1 x 2 blocks",
        ),
        (
            "[4, 1]",
            "markov = { axis = \"x\", from = 0, to = 2, mean_chord = [0.3, 0.2], density = [1, 20], albedo = [1, 0], seed = 3 }",
            "blocks, constant in each; periodic",
        ),
        (
            "[3, 2]",
            "cloud = { center = [9, 9, 0.1], radii = [0.6, 0.6, 0.05] }",
            "cloud of 5 octaves, majorants in 32768 cells; periodic",
        ),
    ] {
        let file = folder.file("scene.toml", &slab(cell, density));
        let said = succeeds(&["check", text(&file)]);
        assert!(said.contains(words), "{density}: {said}");
    }
}

#[test]
fn wrong_structures() {
    let folder = Folder::new();
    folder.file("step.csv", "i,extinction\n0,1\n1,2\n");
    let columns = |keys: &str| format!("columns = {{ width = [0.25], ground = 0.25, {keys} }}");
    let grid = |keys: &str| format!("grid = {{ min = [0, 0, 0], max = [1, 1, 0.25], {keys} }}");
    let markov =
        |keys: &str| format!("markov = {{ axis = \"z\", from = 0, density = [1, 2], seed = 1, {keys} }}");
    for (cell, density, words) in [
        ("[0.5, 0]", columns("file = \"step.csv\", base = 0, top = 0.1"), "allowed: finite and above 0"),
        ("[0.5]", columns("file = \"step.csv\", base = 0, top = 0.1"), "cell: invalid length 1"),
        (
            "\"wide\"",
            columns("file = \"step.csv\", base = 0, top = 0.1"),
            "allowed: a number, or two numbers",
        ),
        (
            "0.4",
            columns("file = \"step.csv\", base = 0, top = 0.1"),
            "0.5 wide along x; allowed: the side of the cell there, 0.4",
        ),
        ("0.5", columns("file = \"step.csv\", base = 0"), "no top; allowed: in the table, or a key"),
        (
            "0.5",
            columns("file = \"step.csv\", base = 0.2, top = 0.1"),
            "base of column 0 is 0.2; allowed: at most its top, 0.1",
        ),
        ("0.5", columns("file = \"step.csv\", base = nan, top = 0.1"), "base of column 0 is NaN"),
        (
            "0.5",
            columns("file = \"step.csv\", base = 0, top = [0.1]"),
            "top has 1 values; allowed: 2, one a column",
        ),
        (
            "0.5",
            columns("file = \"step.csv\", base = 0, top = \"high\""),
            "a height, or a list of them, one a column",
        ),
        ("0.5", columns("file = \"step.csv\", count = [2, 1], base = 0, top = 0.1"), "allowed: file alone"),
        ("0.5", columns("base = 0, top = 0.1"), "one of file, extinction and optical_depth"),
        ("0.5", columns("extinction = [1, -2], base = 0, top = 0.1"), "value of block 1 0 0 is -2"),
        (
            "0.5",
            columns("extinction = [1, 2, 3], count = [2, 2], base = 0, top = 0.1"),
            "width has 1 numbers; allowed: 2",
        ),
        (
            "0.5",
            columns("extinction = [1, 2], count = [3, 1], base = 0, top = 0.1"),
            "3 x 1 columns have 2 values",
        ),
        ("0.5", columns("extinction = [], base = 0, top = 0.1"), "have 0 values"),
        (
            "0.5",
            columns("optical_depth = [1, 2], base = 0.1, top = 0.1"),
            "optical_depth of column 0 is 1 between base and top that are the same",
        ),
        ("1", grid("values = [1, 2], count = [2, 1, 1], file = \"a.vol\""), "allowed: one of the two"),
        ("1", grid("values = [1, 2]"), "`file`, or `values` and `count`"),
        (
            "1",
            grid("values = [1, 2], count = [3, 1, 1], interpolation = \"blocks\""),
            "3 x 1 x 1 blocks with 1 channels have 2 values; allowed: 3",
        ),
        (
            "1",
            grid("values = [1, 2], count = [0, 1, 1], interpolation = \"blocks\""),
            "0 x 1 x 1 blocks; allowed: 1 to",
        ),
        ("1", grid("values = [1, 2], count = [2, 1, 1], interpolation = \"cubic\""), "nearest"),
        ("1", grid("values = [1, nan], count = [2, 1, 1]"), "finite and at least 0"),
        (
            "1",
            "layers = { axis = \"z\", edges = [0, 0.1, 0.1], density = [1, 2] }".into(),
            "do not rise: 0.1 comes after 0.1",
        ),
        (
            "1",
            "layers = { axis = \"z\", edges = [0, 1], density = [1, 2] }".into(),
            "1 x 1 x 1 blocks with 1 channels have 2 values",
        ),
        (
            "1",
            "layers = { axis = \"z\", edges = [0, 1], density = [1], albedo = [1.5] }".into(),
            "allowed: 0 to 1",
        ),
        ("1", "layers = { axis = \"w\", edges = [0, 1], density = [1] }".into(), "nearest"),
        (
            "1",
            "layers = { axis = \"x\", edges = [0, 0.3, 0.7], density = [1, 2] }".into(),
            "0.7 wide along x",
        ),
        (
            "1",
            markov("to = 0, mean_chord = [1, 1]"),
            "to of a Markov mixture is 0; allowed: finite and above from",
        ),
        ("1", markov("to = 1, mean_chord = [0, 1]"), "above 0"),
        (
            "1",
            markov("to = 1, mean_chord = [1e-9, 1e-9]"),
            "layers of a Markov mixture in the mean is 999999999",
        ),
        ("1e-7", columns("extinction = [1, 2], base = 0, top = 0.1"), "over the side of the cell"),
        (
            "1",
            "height-fog = { base = 0, scale_height = 1, up = [1, 0, 1] }".into(),
            "height fog does not repeat itself",
        ),
        (
            "1",
            "cloud = { center = [0, 0, 0], radii = [0.5, 0.1, 0.1] }".into(),
            "wide along x, with its shreds",
        ),
    ] {
        let file = folder.file("scene.toml", &slab(cell, &density));
        refuses_naming(&["check", text(&file)], &[words]);
    }
}

/// Tables of columns: every way in which one can be wrong names its file, line and column.
#[test]
fn wrong_tables_of_columns() {
    let folder = Folder::new();
    let density = "columns = { file = \"a.csv\", width = [0.25, 0.25], ground = 0.25 }";
    let scene = folder.file("scene.toml", &slab("[0.5, 0.25]", density));
    let good = "i,j,extinction,base,top\n0,0,1,0,0.25\n1,0,2,0,0.25\n";
    // Of a spreadsheet, too, which begins it with a byte-order mark.
    for table in [good.to_string(), format!("\u{feff}{good}")] {
        folder.file("a.csv", &table);
        succeeds(&["check", text(&scene)]);
    }
    let many: String = (0..1_000_000).map(|i| format!("{i},0,1,0,0.25\n")).collect();
    let half = format!("i,j,extinction,base,top\n{many}");
    for (table, words) in [
        ("", "line 1: no names of columns"),
        ("\n0,0,1,0,1\n", "line 1: no names of columns"),
        ("i,j,extinction,base,top\n", "no line behind its names"),
        (
            "i,j,extinktion,base,top\n",
            "line 1: unknown `extinktion`; allowed: i,j,extinction,optical_depth,base,top",
        ),
        ("i,i,extinction,base,top\n", "line 1, i: stands there twice"),
        ("j,extinction,base,top\n0,1,0,1\n", "line 1: no column i"),
        ("i,base,top\n0,0,1\n", "line 1: extinction or optical_depth; allowed: one of the two"),
        ("i,extinction,optical_depth,base,top\n0,1,1,0,1\n", "line 1: extinction or optical_depth"),
        ("i,extinction,base\n0,1,0\n", "no top"),
        ("i,extinction,base,top\n0,1,0,1\n1,nan,0,1\n", "line 3, extinction: `nan` is not a finite number"),
        ("i,extinction,base,top\n0,1,0,1\n1,,0,1\n", "line 3, extinction: `` is not a finite number"),
        ("i,extinction,base,top\n0,-1,0,1\n", "line 2, extinction: is -1; allowed: at least 0"),
        ("i,optical_depth,base,top\n0,-1,0,1\n", "line 2, optical_depth: is -1"),
        ("i,extinction,base,top\n0,1,2,1\n", "line 2, base: is 2; allowed: at most its top, 1"),
        ("i,extinction,base,top\n0,1,0\n", "line 2: 3 values; allowed: 4, as line 1 names"),
        ("i,extinction,base,top\n0,1,0,1,7,7,7\n", "line 2: 7 values; allowed: 4"),
        ("i,extinction,base,top\n0,1,0,1\n\n2,1,0,1\n", "line 4, i: is 2; allowed: 1, each column"),
        ("i,extinction,base,top\n1,1,0,1\n0,1,0,1\n", "line 2, i: is 1; allowed: 0"),
        ("i,j,extinction,base,top\n0,0,1,0,1\n0,2,1,0,1\n", "line 3, j: is 2; allowed: 1"),
        (
            "i,j,extinction,base,top\n0,0,1,0,1\n1,0,1,0,1\n0,1,1,0,1\n",
            "ends after 3 columns; allowed: a whole number of rows of 2",
        ),
        ("i,extinction,base,top\n0,1,0,1e999\n", "line 2, top: `1e999` is not a finite number"),
        ("i,extinction,base,top\n\u{1b}[2J,1,0,1\n", "line 2, i: `\\u{1b}[2J` is not a finite number"),
        (half.as_str(), "a lattice of columns is 250000 wide along x"),
    ] {
        folder.file("a.csv", table);
        refuses_naming(&["check", text(&scene)], &["scene.toml: regions[0]", words]);
        if words.starts_with("line") {
            refuses_naming(&["check", text(&scene)], &["a.csv: "]);
        }
    }
    std::fs::write(folder.0.path().join("a.csv"), b"i,extinction\n0,\xff\n").unwrap();
    refuses_naming(&["check", text(&scene)], &["a.csv: not UTF-8 text"]);
    std::fs::remove_file(folder.0.path().join("a.csv")).unwrap();
    refuses_naming(&["check", text(&scene)], &["a.csv: No such file"]);
}
