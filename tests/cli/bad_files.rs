//! Files that a scene names, missing, truncated or wrong; and keys of shapes, textures and boundaries out of range.

use crate::{Folder, refuses, refuses_naming, succeeds, text};
use std::path::{Path, PathBuf};

/// A mesh with a picture on it, under a lamp.
const SCENE: &str = r#"
[camera]
position = [0.0, 0.0, 4.0]
look_at = [0.0, 0.0, 0.0]
fov = 40.0
width = 4
height = 4

[[objects]]
shape = { mesh = { file = "part.obj" } }
surface = { lambertian = { reflectance = { image = { file = "paint.png" } } } }

[[lights]]
area = { shape = { sphere = { center = [0.0, 0.0, 3.0], radius = 0.5 } }, radiance = 1.0 }
"#;

const TRIANGLE: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\n";

/// A grey PNG of one pixel: header, data, end, each with its checksum.
pub const PIXEL: [u8; 67] = [
    0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a, 0x00, 0x00, 0x00, 0x0d, 0x49, 0x48, 0x44, 0x52, 0x00,
    0x00, 0x00, 0x01, 0x00, 0x00, 0x00, 0x01, 0x08, 0x00, 0x00, 0x00, 0x00, 0x3a, 0x7e, 0x9b, 0x55, 0x00,
    0x00, 0x00, 0x0a, 0x49, 0x44, 0x41, 0x54, 0x78, 0x9c, 0x63, 0x68, 0x00, 0x00, 0x00, 0x82, 0x00, 0x81,
    0x77, 0xcd, 0x72, 0xb6, 0x00, 0x00, 0x00, 0x00, 0x49, 0x45, 0x4e, 0x44, 0xae, 0x42, 0x60, 0x82,
];

/// The scene and its files, all right.
fn whole() -> (Folder, PathBuf) {
    let folder = Folder::new();
    let scene = folder.file("scene.toml", SCENE);
    folder.file("part.obj", TRIANGLE);
    std::fs::write(folder.0.path().join("paint.png"), PIXEL).unwrap();
    (folder, scene)
}

#[test]
fn wrong_meshes() {
    let (folder, scene) = whole();
    succeeds(&["check", text(&scene)]);
    for (mesh, words) in [
        ("", "part.obj: no faces"),
        ("v 0 0 0\nv 1 0 0\nv 0 1", "part.obj:3: a vertex `v` of 2 numbers; allowed: x y z"),
        ("v 0 0 zero\n", "part.obj:1: "),
        ("v 0 0 nan\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "part.obj"),
        ("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2\n", "part.obj:4: a face of 2 corners; allowed: 3 or more"),
        ("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n", "part.obj:4: a face names vertex 4; allowed: 1 to 3"),
        ("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 0\n", "part.obj:4: a face names vertex 0"),
        ("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1/1 2/1 3/1\n", "no vt stands before this line"),
        ("v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n", "part.obj"),
        ("curv 0 1\n", "part.obj:1: unknown statement `curv`"),
        ("\u{0}\u{1b}[2J", "part.obj:1: unknown statement `\\0\\u{1b}[2J`"),
    ] {
        folder.file("part.obj", mesh);
        refuses_naming(&["check", text(&scene)], &["scene.toml: objects[0]", words]);
    }
    std::fs::remove_file(folder.0.path().join("part.obj")).unwrap();
    refuses_naming(&["check", text(&scene)], &["part.obj: No such file"]);
}

/// A polygon of 800 corners, a scene whose name is no text, and a camera next to the face of a filled ball are right; what is on
/// that face is on neither side.
#[test]
fn what_is_unusual_and_right() {
    let (folder, scene) = whole();
    let corners: String = (0..800u32)
        .map(|i| {
            let (sin, cos) = turbid::math::sin_cos(std::f64::consts::TAU * f64::from(i) / 800.0);
            format!("v {cos} {sin} 0\nvt {cos} {sin}\n")
        })
        .collect();
    let face: String = (1..=800).map(|i| format!(" {i}/{i}")).collect();
    folder.file("part.obj", &format!("{corners}f{face}\n"));
    succeeds(&["check", text(&scene)]);
    #[cfg(unix)]
    {
        use std::os::unix::ffi::OsStrExt;
        let named = folder.0.path().join(std::ffi::OsStr::from_bytes(b"sc\xff.toml"));
        std::fs::copy(&scene, &named).unwrap();
        let status = crate::turbid(&["check"]).arg(&named).output().unwrap().status;
        assert!(status.success());
    }
    let ball = folder.file(
        "ball.toml",
        "[camera]\nposition = [0, 0, 1]\nlook_at = [0, 0, 0]\nfov = 50\nwidth = 4\nheight = 4\n\
         [[interiors]]\nname = \"milk\"\nindex = 1.33\nsigma_t = 2\nalbedo = 0.9\ng = 0\n\
         [[objects]]\nshape = { sphere = { center = [0, 0, 0], radius = 1 } }\n\
         surface = { dielectric = { inside = \"milk\" } }\n\
         [[lights]]\nisotropic = { shape = { sphere = { center = [0, 0, 0], radius = 3 } }, radiance = 1, faces = \"both\" }\n",
    );
    let on = "is on the surface of objects[0], where rounding decides on which side it is; move one of them";
    refuses_naming(&["check", text(&ball)], &["ball.toml: the camera ", on]);
    // Off it by a billionth, to both sides, wherever the camera looks.
    let picture = folder.0.path().join("ball.exr");
    for place in ["1.000000001", "0.999999999"] {
        for turned in ["look_at=[0,0,0]", "look_at=[0,0,4]", "look_at=[4,0,1]"] {
            for method in ["paths", "light", "photons"] {
                let (place, turned) = (format!("camera.position=[0,0,{place}]"), format!("camera.{turned}"));
                let set = ["--set", &place, "--set", &turned];
                let render = ["render", text(&ball), "--with", method, "--samples", "2"];
                succeeds(&[&render[..], &set, &["--output", text(&picture)]].concat());
            }
        }
    }
    for part in [
        "[[lights]]\npoint = { position = [0, 1, 0], power = 1 }\n",
        "[[sensors]]\nname = \"s\"\nmeasure = { fluence = { at = [0, 0.6, 0.8] } }\n",
        "[[sensors]]\nname = \"s\"\nmeasure = { radiance = { origin = [0, 0.6, 0.8], dir = [0, 1, 0] } }\n",
    ] {
        let scene = std::fs::read_to_string(&ball).unwrap().replace("[0, 0, 1]", "[0, 0, 2]");
        let scene = folder.file("part.toml", &(scene + part));
        refuses_naming(&["check", text(&scene)], &["part.toml: ", on]);
    }
    // On a wall, and on a lamp: a shadow ray from below the lamp met its face before the light in it, or not.
    let room = "[[objects]]\nshape = { cuboid = { min = [-1, -1, -1], max = [1, 1, 1] } }\n\
                surface = { lambertian = { reflectance = 0.5 } }\n\
                [[lights]]\narea = { radiance = 1, shape = { cuboid = { min = [-0.1, 0.1, -0.1], max = [0.1, 0.3, 0.1] } } }\n";
    for (part, body) in [
        (
            "[[lights]]\nspot = { position = [0.05, 0.1, 0], dir = [1, -0.6, 0], full_angle = 29, edge_angle = 50, power = 1 }\n",
            "lights[1] is on the surface of lights[0]",
        ),
        (
            "[[lights]]\npoint = { position = [0.05, 1, 0], power = 1 }\n",
            "lights[1] is on the surface of objects[0]",
        ),
        (
            "[camera]\nposition = [0, -1, 0.2]\nlook_at = [0, 0, 0]\nfov = 50\nwidth = 4\nheight = 4\n",
            "the camera is on the surface of objects[0]",
        ),
    ] {
        let scene = folder.file("room.toml", &(room.to_string() + part));
        refuses_naming(&["check", text(&scene)], &["room.toml: ", body, "; move one of them"]);
        let apart = part
            .replace("0.1, 0]", "0.0999999, 0]")
            .replace("1, 0]", "0.999999, 0]")
            .replace("-1, 0.2]", "-0.999999, 0.2]");
        succeeds(&["check", text(&folder.file("apart.toml", &(room.to_string() + &apart)))]);
    }
}

#[test]
fn wrong_textures() {
    let (folder, scene) = whole();
    let paint = folder.0.path().join("paint.png");
    let mut huge = PIXEL;
    huge[16..20].copy_from_slice(&0x7fff_ffff_u32.to_be_bytes());
    for (bytes, words) in [
        (&b""[..], "no PNG file; allowed: PNG of 8 or 16 bits"),
        (&b"\xff\xd8\xff\xe0 a JPEG"[..], "no PNG file"),
        (&PIXEL[..20], "damaged or truncated"),
        (&PIXEL[..45], "damaged or truncated"),
        (&huge[..], "paint.png: "),
    ] {
        std::fs::write(&paint, bytes).unwrap();
        refuses_naming(&["check", text(&scene)], &["scene.toml: objects[0]", "paint.png: ", words]);
    }
    std::fs::remove_file(&paint).unwrap();
    refuses_naming(&["check", text(&scene)], &["paint.png: No such file"]);
}

/// Wherever a scene file is cut off, it is refused in one line, or is a whole scene still.
#[test]
fn truncated_scenes() {
    let (folder, _) = whole();
    let mut refused = 0;
    // Without its last lines the scene has no lights.
    let last = SCENE.find("radiance").unwrap();
    for end in (0..last).step_by(20) {
        let file = folder.file("cut.toml", &SCENE[..end]);
        let line = refuses(&["check", text(&file)]);
        assert!(line.contains("cut.toml:"), "{line}");
        refused += 1;
    }
    assert!(refused > 8);
}

#[test]
fn wrong_shapes_textures_and_boundaries() {
    let (folder, _) = whole();
    let shape = r#"mesh = { file = "part.obj" }"#;
    let paint = r#"{ image = { file = "paint.png" } }"#;
    let surface = format!("lambertian = {{ reflectance = {paint} }}");
    let lathe = |keys: &str| format!("lathe = {{ {keys} }}");
    let ground = |keys: &str| format!("height-field = {{ corner = [0, 0], size = [1, 1], {keys} }}");
    let field = "waves = { seed = 1, count = 3, wavelength = 1, rms = 0.1 }";
    let cases = [
        (
            shape,
            r#"mesh = { file = "part.obj", scale = 0 }"#.into(),
            "scale is 0; allowed: finite and above 0",
        ),
        (
            shape,
            "mesh = { path = \"part.obj\" }".into(),
            "unknown key `path`; nearest: `at`; allowed: file, scale, rotate, at, translate",
        ),
        (shape, "mesh = {}".into(), "missing field `file`"),
        (shape, "cone = { radius = 1 }".into(), "unknown value `cone`"),
        (shape, lathe("profile = []"), "objects[0]"),
        (shape, lathe("profile = [[-1, 0], [1, 1]]"), "objects[0]"),
        (shape, lathe("profile = [[1, 0], [1, nan]]"), "objects[0]"),
        (shape, lathe("axis = [0, 0, 0], profile = [[1, 0], [1, 1]]"), "objects[0]"),
        (
            shape,
            lathe("profile = [[1, 0], [1, 1]], smooth = 0"),
            "objects[0].smooth is 0; allowed: 1 to 1000",
        ),
        (shape, ground(&format!("cells = [0, 4], heights = {{ {field} }}")), "objects[0]"),
        (shape, ground(&format!("cells = [99999, 99999], heights = {{ {field} }}")), "objects[0]"),
        (shape, ground(&format!("cells = [4, 4], floor = 9, heights = {{ {field} }}")), "objects[0]"),
        (shape, ground("cells = [2, 2], heights = { rows = [[0, 0], [0]] }"), "objects[0]"),
        (
            shape,
            ground(
                "cells = [2, 2], heights = { waves = { seed = 1, count = 0, wavelength = 1, rms = 0.1 } }",
            ),
            "objects[0].count is 0; allowed: 1 to 1000",
        ),
        (
            shape,
            ground(
                "cells = [2, 2], heights = { waves = { seed = 1, count = 1, wavelength = 0, rms = 0.1 } }",
            ),
            "wavelength is 0; allowed: finite and above 0",
        ),
        (paint, "{ checker = { values = [0, 2], tiles = [1, 1] } }".into(), "values is 2; allowed: 0 to 1"),
        (paint, "{ checker = { values = [0, 1], tiles = [0, 1] } }".into(), "tiles is 0; allowed"),
        (
            paint,
            "{ checker = { values = [0, 1, 1], tiles = [1, 1] } }".into(),
            "checker.values has 3 entries; allowed: 2",
        ),
        (
            paint,
            "{ wood = { values = [0, 1], center = [0, 0, 0], axis = [0, 0, 0], width = 1 } }".into(),
            "axis",
        ),
        (paint, "{ marble = {} }".into(), "unknown value `marble`; nearest"),
        (paint, "1.5".into(), "reflectance is 1.5; allowed: 0 to 1"),
        ("[0.0, 0.0, 4.0]", "[0.0, 0.0, 4.0, 1.0]".into(), "camera.position has 4 entries; allowed: 3"),
        (paint, "[0.5, 0.5, 0.5, 0.5]".into(), "reflectance has 4 entries; allowed: 3"),
        (paint, "[0.5, 0.5]".into(), "reflectance"),
        (&surface, "dielectric = { inside = \"glass\" }".into(), "unknown interior `glass`"),
        (&surface, "dielectric = { outside = \"glass\" }".into(), "missing field `inside`"),
        (&surface, "glass = {}".into(), "unknown value `glass`"),
        (&surface, "filter = { transmittance = -1 }".into(), "transmittance is -1; allowed: 0 to 1"),
    ];
    for (index, (from, to, words)) in cases.into_iter().enumerate() {
        assert!(SCENE.contains(from), "{from}");
        let name = format!("case{index}.toml");
        let file = folder.file(&name, &SCENE.replacen(from, &to, 1));
        refuses_naming(&["check", text(&file)], &[&name, words]);
    }
    for light in [
        "isotropic = { shape = { MESH }, faces = \"both\", radiance = 1 }",
        "volume-source = { shape = { MESH }, density = 1 }",
    ] {
        let file =
            folder.file("light.toml", &format!("{SCENE}\n[[lights]]\n{}\n", light.replace("MESH", shape)));
        refuses_naming(&["check", text(&file)], &["lights[1]", "a convex shape with an inside"]);
    }
    let media = [
        ("[[regions]]\nsigma_t = 1\nalbedo = 0.5\ng = 0\n", "missing field `shape`"),
        (
            "[[regions]]\nshape = { rectangle = { corner = [0, 0, 0], u = [1, 0, 0], v = [0, 1, 0] } }\nsigma_t = 1\nalbedo = 0.5\ng = 0\n",
            "regions[0] needs a convex shape with an inside",
        ),
        (
            "[[regions]]\nshape = { mesh = { file = \"part.obj\" } }\nsigma_t = 1\nalbedo = 0.5\ng = 0\n",
            "regions[0] needs a convex shape with an inside",
        ),
        (
            "[[interiors]]\nname = \"milk\"\nindex = 1.3\nsigma_t = 1\nalbedo = 0.5\ng = 0\n",
            "milk has no boundary",
        ),
        ("[[interiors]]\nname = \"milk\"\nindex = inf\n", "index is inf; allowed: 1 to 1000"),
        ("[[interiors]]\nname = \"milk\"\nindex = 1e308\n", "allowed: 1 to 1000"),
        (
            "[[regions]]\nshape = { sphere = { center = [0, 0, 0], radius = 1 } }\nsigma_t = 1\nalbedo = 0.5\ng = 0\nemission = 1e300\n",
            "regions[0]: emission is 1e300; allowed: 0, or 1e-30 to 1e30 in size",
        ),
        ("[[interiors]]\nname = \"milk\"\n", "missing field `index`"),
        (
            "[[sensors]]\nname = \"out\"\nmeasure = { outflow = { shape = { sphere = { center = [inf, 0, 0], radius = 1 } }, face = \"top\" } }\n",
            "sensor out",
        ),
        ("[[interiors]]\nname = \"surroundings\"\nindex = 1.3\n", "two interiors are called surroundings"),
    ];
    for (index, (keys, words)) in media.into_iter().enumerate() {
        let name = format!("medium{index}.toml");
        let file = folder.file(&name, &format!("{SCENE}\n{keys}"));
        refuses_naming(&["check", text(&file)], &[&name, words]);
    }
}

/// A file may say the version of its format, and another one is refused by name.
#[test]
fn formats_of_scenes() {
    let (folder, _) = whole();
    let file = folder.file("one.toml", &format!("format = 1\n{SCENE}"));
    succeeds(&["check", text(&file)]);
    let file = folder.file("two.toml", &format!("format = 2\n{SCENE}"));
    refuses_naming(&["check", text(&file)], &["two.toml:1:", "format is 2; allowed: 1"]);
}

/// Lights without bounds need a cell, and are told by their number.
#[test]
fn unbounded_lights_are_named() {
    let folder = Folder::new();
    let slab =
        "[[regions]]\nshape = { slab = { top = 0, thickness = 1 } }\nsigma_t = 1\nalbedo = 0.5\ng = 0\n";
    let other = "{ slab = { top = 0, thickness = 2 } }";
    for (index, (cell, light, words)) in [
        (
            "",
            "beam = { section = \"unbounded\", dir = [0, 0, 1], irradiance = 1 }",
            "lights[0] is unbounded, which needs a slab of medium and `cell`",
        ),
        (
            "cell = 1\n",
            "beam = { section = \"unbounded\", dir = [1, 0, 0], irradiance = 1 }",
            "lights[0] is an unbounded beam that runs along the faces of its slab",
        ),
        (
            "cell = 1\n",
            &format!("isotropic = {{ shape = {other}, faces = \"both\", radiance = 1 }}"),
            "lights[0] is unbounded and starts on a slab that is not the slab of the medium",
        ),
    ]
    .into_iter()
    .enumerate()
    {
        let name = format!("light{index}.toml");
        let file = folder.file(&name, &format!("{cell}{slab}[[lights]]\n{light}\n"));
        refuses_naming(&["check", text(&file)], &[&name, words]);
    }
}

/// A PNG file's checksum (ISO 3309).
fn checksum(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(!0u32, |sum, byte| {
        (0..8).fold(
            sum ^ u32::from(*byte),
            |sum, _| if sum & 1 == 1 { (sum >> 1) ^ 0xedb8_8320 } else { sum >> 1 },
        )
    })
}

/// What says that it is large is refused before it is read, and what has no end is not a file.
#[test]
fn large_and_endless_files_are_refused() {
    let (folder, scene) = whole();
    let mut large = PIXEL;
    large[16..24].copy_from_slice(&[0, 0, 64, 0, 0, 0, 64, 0]);
    let sum = checksum(&large[12..29]).to_be_bytes();
    large[29..33].copy_from_slice(&sum);
    assert_eq!(checksum(&PIXEL[12..29]).to_be_bytes(), PIXEL[29..33]);
    std::fs::write(folder.0.path().join("paint.png"), large).unwrap();
    refuses_naming(&["check", text(&scene)], &["paint.png: 16384 x 16384 pixels; allowed: up to 2^26"]);
    std::fs::write(folder.0.path().join("paint.png"), PIXEL).unwrap();
    if cfg!(unix) {
        let zero = SCENE.replace("part.obj", "/dev/zero");
        let zero = folder.file("zero.toml", &zero);
        refuses_naming(
            &["check", text(&zero)],
            &["/dev/zero: a folder, a device or a pipe; allowed: a file"],
        );
    }
    let table = SCENE.replace("[[lights]]", "[[regions]]\nshape = { sphere = { center = [0, 0, 0], radius = 2 } }\nsigma_t = 1\nalbedo = 0.5\nphase = { table = { file = \".\" } }\n[[lights]]");
    let table = folder.file("table.toml", &table);
    refuses_naming(&["check", text(&table)], &["a folder, a device or a pipe; allowed: a file"]);
    // A million cells are as many as may be, and a thousand sines in each are too many; triangles that lie in one place but
    // for their ninth digit would be sorted for minutes.
    let ground = |cells: usize, count: u32| {
        let field = format!(
            "height-field = {{ corner = [0, 0], size = [1, 1], level = 0, cells = [{cells}, {cells}], heights = {{ waves = {{ seed = 1, count = {count}, wavelength = 1, rms = 0.1 }} }} }}"
        );
        folder.file("ground.toml", &SCENE.replace("mesh = { file = \"part.obj\" }", &field))
    };
    refuses_naming(&["check", text(&ground(4000, 3))], &["4000 x 4000 cells; allowed: 1 to 2^20"]);
    refuses_naming(
        &["check", text(&ground(1024, 1000))],
        &["count times the cells", "allowed: at most 2^26"],
    );
    let points: Vec<String> = (0..1050).map(|i| format!("[1, {i}]")).collect();
    let lathe = format!("lathe = {{ profile = [{}], smooth = 1000 }}", points.join(", "));
    let lathe = folder.file("lathe.toml", &SCENE.replace("mesh = { file = \"part.obj\" }", &lathe));
    refuses_naming(
        &["check", text(&lathe)],
        &["smooth times the points of the profile is 1050000; allowed: at most 2^20"],
    );
    let mut alike = "v 0 0 0\nv 1 0 0\nv 0 1 0\n".to_string();
    for i in 0..100_000 {
        alike += &format!("v 0 0 {}\nf 1 2 {}\n", 1e-12 * f64::from(i), 4 + i);
    }
    std::fs::write(folder.0.path().join("part.obj"), alike).unwrap();
    refuses_naming(&["check", text(&scene)], &["part.obj: triangles nested too deeply"]);
}

/// Meshes, pictures, grids and scenes that do not fit into the memory that is free are refused before it is asked for.
#[cfg(target_os = "linux")]
#[test]
fn files_beyond_the_free_memory_are_refused() {
    let (folder, scene) = whole();
    let path = |name: &str| folder.0.path().join(name);
    let refused = |scene: &Path, file: &str, what: &str| {
        let output = std::process::Command::new("sh")
            .args(["-c", "ulimit -v 400000; exec \"$0\" \"$@\""])
            .arg(assert_cmd::cargo::cargo_bin("turbid"))
            .arg("check")
            .arg(scene)
            .output()
            .unwrap();
        let told = String::from_utf8(output.stderr).unwrap();
        let is_told = told.contains(&format!("{file}: {what}"))
            && told.contains("of memory; allowed: what is free, ")
            && told.lines().count() == 1;
        assert!(is_told && output.status.code() == Some(2), "{told}");
    };
    // Sparse files, which take no place on a disk.
    let hollow = |name: &str, head: &[u8], length: u64| {
        std::fs::write(path(name), head).unwrap();
        std::fs::OpenOptions::new().write(true).open(path(name)).unwrap().set_len(length).unwrap();
    };
    let mut picture = PIXEL;
    picture[16..24].copy_from_slice(&[0, 0, 32, 0, 0, 0, 32, 0]);
    let sum = checksum(&picture[12..29]).to_be_bytes();
    picture[29..33].copy_from_slice(&sum);
    std::fs::write(path("paint.png"), picture).unwrap();
    refused(&scene, "paint.png", "8192 x 8192 pixels takes about 1.3 GB");
    std::fs::write(path("paint.png"), PIXEL).unwrap();
    hollow("part.obj", b"", 50_000_000);
    refused(&scene, "part.obj", "a mesh of 50000000 bytes takes about 500 MB");
    hollow("fog.vol", b"VOL", 200_000_000);
    let fog = SCENE.replace("[[lights]]", "[[regions]]\nshape = { cuboid = { min = [-1, -1, -1], max = [1, 1, 1] } }\nsigma_t = 1\nalbedo = 0.5\ng = 0\ndensity = { grid = { file = \"fog.vol\" } }\n[[lights]]");
    let fog = folder.file("fog.toml", &fog.replace("part.obj", "whole.obj"));
    std::fs::write(path("whole.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap();
    refused(&fog, "fog.vol", "a grid of 200000000 bytes takes about 240 MB");
    let head = "{'descr': '<f4', 'fortran_order': True, 'shape': (1000, 1000, 50)}";
    hollow("fog.npy", &[b"\x93NUMPY\x01\x00B\x00", head.as_bytes()].concat(), 200_000_076);
    let array = std::fs::read_to_string(&fog).unwrap();
    let array = array.replace("\"fog.vol\"", "\"fog.npy\", min = [0, 0, 0], max = [1, 1, 1]");
    let array = folder.file("array.toml", &array);
    refused(&array, "fog.npy", "a grid of 50000000 samples takes about 500 MB");
    let waves = "height-field = { corner = [0, 0], size = [1, 1], cells = [1024, 1000], heights = { waves = { seed = 1, count = 1, wavelength = 1, rms = 0.1 } } }";
    let waves = folder.file("waves.toml", &SCENE.replace("mesh = { file = \"part.obj\" }", waves));
    refused(&waves, "objects[0]", "a height field of 1024 x 1000 cells takes about 1.0 GB");
    let long = format!("{SCENE}# {}", "-".repeat(10_000_000));
    let what = format!("a scene file of {} bytes takes about 800 MB", long.len());
    refused(&folder.file("long.toml", &long), "long.toml", &what);
}

/// Light that never ends is refused by every command, and filled glass farther across than numbers carry.
#[test]
fn endless_rooms_and_opaque_interiors_are_refused() {
    let folder = Folder::new();
    let corners =
        ["[-1, -1, -1]", "[-1, -1, 1]", "[-1, -1, -1]", "[-1, 1, -1]", "[-1, -1, -1]", "[1, -1, -1]"];
    let edges = [("[2, 0, 0]", "[0, 2, 0]"), ("[2, 0, 0]", "[0, 0, 2]"), ("[0, 2, 0]", "[0, 0, 2]")];
    let seen = "[camera]\nposition = [0, 0, 0.5]\nlook_at = [0, 0, 0]\nup = [0, 1, 0]\nfov = 50\nwidth = 4\nheight = 4\n[[lights]]\npoint = { position = [0.1, 0.2, 0.4], power = 1 }\n";
    let walls = corners.iter().enumerate().map(|(i, corner)| {
        let (u, v) = edges[i / 2];
        format!("[[objects]]\nshape = {{ rectangle = {{ corner = {corner}, u = {u}, v = {v} }} }}\nsurface = {{ lambertian = {{ reflectance = 1 }} }}\n")
    });
    let room = folder.file("room.toml", &format!("{seen}{}", walls.collect::<String>()));
    let picture = folder.0.path().join("a.exr");
    let told = ["hardly ever ends", "objects[0]", "objects[5]", "allowed: 20000 in the mean"];
    refuses_naming(&["check", text(&room)], &told);
    for with in ["photons", "paths", "light"] {
        refuses_naming(&["render", text(&room), "--with", with, "-o", text(&picture)], &told);
    }
    let ink = |sigma_t: &str| {
        let filling =
            format!("[[interiors]]\nname = \"ink\"\nindex = 1.3\nsigma_t = {sigma_t}\nalbedo = 0.5\ng = 0\n");
        let ball = "[[objects]]\nshape = { sphere = { center = [0, 0, -3], radius = 1 } }\nsurface = { dielectric = { inside = \"ink\" } }\n";
        folder.file("ink.toml", &format!("{seen}{filling}{ball}"))
    };
    succeeds(&["check", text(&ink("1e7"))]);
    refuses_naming(&["check", text(&ink("1e15"))], &["interior ink", "allowed: at most 1e9"]);
}

/// With `--confined` a scene reads nothing outside of its folder; without, it does.
#[test]
fn confined_scenes_stay_in_their_folder() {
    let (folder, _) = whole();
    let inner = folder.0.path().join("inner");
    std::fs::create_dir(&inner).unwrap();
    std::fs::copy(folder.0.path().join("paint.png"), inner.join("paint.png")).unwrap();
    let absolute = text(&folder.0.path().join("part.obj")).to_string();
    let mut names = vec!["../part.obj".to_string(), absolute];
    if cfg!(unix) {
        #[cfg(unix)]
        std::os::unix::fs::symlink("../part.obj", inner.join("link.obj")).unwrap();
        names.push("link.obj".to_string());
    }
    for name in names {
        let scene = inner.join("scene.toml");
        std::fs::write(&scene, SCENE.replace("part.obj", &name)).unwrap();
        succeeds(&["check", text(&scene)]);
        let said =
            format!("file {name:?} is outside of the scene's folder; allowed with --confined: files in it");
        refuses_naming(&["check", text(&scene), "--confined"], &[&said]);
    }
    std::fs::copy(folder.0.path().join("part.obj"), inner.join("part.obj")).unwrap();
    let scene = inner.join("scene.toml");
    std::fs::write(&scene, SCENE).unwrap();
    succeeds(&["check", text(&scene), "--confined"]);
}
