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
        ("", "allowed: sigma_t, albedo and g (or phase)"),
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

/// A cell stands for an unbounded slab only if nothing changes along x and y.
#[test]
fn densities_that_no_cell_can_stand_for() {
    let folder = Folder::new();
    let cloud = "density = { cloud = { center = [0, 0, 1], radii = [1, 1, 1] } }\n";
    let slab =
        succeeds(&["scenes", "slab", "--resolved"]).replacen("g = 0.0\n", &format!("g = 0.0\n{cloud}"), 1);
    let file = folder.file("slab.toml", &slab);
    refuses_naming(&["check", text(&file)], &["a density must depend on z alone"]);
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
