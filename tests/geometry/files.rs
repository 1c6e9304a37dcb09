//! Shapes and textures from scene files: what is read, and what is said of files that cannot be.

use glam::{DVec2, DVec3};
use std::path::Path;
use turbid::Spectrum;
use turbid::geometry::Shape;
use turbid::scene::{Scene, SceneFile};
use turbid::surface::Surface;

const LIGHT: &str = "[[lights]]\npoint = { position = [9.0, 9.0, 9.0], power = 1.0 }\n";

fn scene(folder: &Path, objects: &str) -> Result<Scene, String> {
    let file = SceneFile::from_toml(&format!("{LIGHT}{objects}")).map_err(|e| e.to_string())?;
    // What is written reads back as what was read.
    let again = SceneFile::from_toml(&file.to_toml().unwrap()).unwrap();
    assert_eq!(again, file);
    file.scene(folder).map_err(|e| e.to_string())
}

fn object(shape: &str, surface: &str) -> String {
    format!("[[objects]]\nshape = {{ {shape} }}\nsurface = {{ {surface} }}\n")
}

const DIFFUSE: &str = "lambertian = { reflectance = 0.5 }";

#[test]
fn shapes_are_read() {
    let folder = tempfile::tempdir().unwrap();
    let square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n";
    std::fs::write(folder.path().join("square.obj"), square).unwrap();
    let objects = [
        object("mesh = { file = \"square.obj\" }", DIFFUSE),
        object("mesh = { file = \"square.obj\", scale = 2, at = [0, 0, 1] }", DIFFUSE),
        object("lathe = { profile = [[0.0, 0.0], [1.0, 0.0], [1.0, 2.0], [0.0, 2.0]] }", DIFFUSE),
        object(
            "lathe = { base = [0, 1, 0], axis = [0, 1, 0], smooth = 4, profile = [[1, 0], [2, 1], [1, 2]] }",
            DIFFUSE,
        ),
        object(
            "height-field = { corner = [0, 0], size = [2, 2], cells = [4, 4], up = \"y\", level = 1.0, floor = 0.0, \
             heights = { rows = [[0, 0], [0, 0]] } }",
            DIFFUSE,
        ),
        object(
            "height-field = { corner = [0, 0], size = [2, 2], cells = [4, 4], \
             heights = { waves = { seed = 1, count = 3, wavelength = 1.0, rms = 0.1 } } }",
            DIFFUSE,
        ),
    ];
    let scene = scene(folder.path(), &objects.concat()).unwrap();
    let shape = |i: usize| &scene.objects()[i].shape;
    assert_eq!((shape(0).area(), shape(1).area()), (1.0, 4.0));
    assert_eq!(shape(1).bounds().unwrap().0, DVec3::ONE);
    assert!((shape(2).volume() - 2.0 * std::f64::consts::PI).abs() < 1e-14 && shape(2).is_closed());
    let Shape::Revolution(pot) = shape(3) else { panic!() };
    assert!(!pot.is_closed() && pot.bounds().0.distance(DVec3::Y * 2.0) < 1e-15);
    assert!((shape(4).volume() - 4.0).abs() < 1e-14 && shape(4).is_closed());
    assert!(!shape(5).is_closed() && shape(5).area() > 4.0);
}

#[test]
fn textures_are_read() {
    let folder = tempfile::tempdir().unwrap();
    image::RgbImage::from_pixel(2, 2, image::Rgb([255, 0, 0])).save(folder.path().join("red.png")).unwrap();
    let square = "rectangle = { corner = [0, 0, 0], u = [1, 0, 0], v = [0, 1, 0] }";
    let objects = [
        object(square, "lambertian = { reflectance = [0.1, 0.2, 0.3] }"),
        object(square, "lambertian = { reflectance = { image = { file = \"red.png\" } } }"),
        object(
            "rectangle = { corner = [0, 0, 1], u = [1, 0, 0], v = [0, 1, 0] }",
            "filter = { transmittance = { checker = { values = [0, [1, 0, 1]], tiles = [2, 1] } } }",
        ),
        object(
            square,
            "lambertian = { reflectance = { wood = { values = [0.5, 0.1], center = [0, 0, 0], axis = [0, 0, 1], width = 0.1 } } }",
        ),
    ];
    let scene = scene(folder.path(), &objects.concat()).unwrap();
    let at = |i: usize, u: f64| match &scene.objects()[i].surface {
        Surface::Lambertian(s) => s.reflectance(DVec3::ZERO, DVec2::new(u, 0.5)),
        Surface::Filter(s) => s.transmittance(DVec3::ZERO, DVec2::new(u, 0.5)),
        other => panic!("{other:?}"),
    };
    assert_eq!(at(0, 0.0), Spectrum::rgb(0.1, 0.2, 0.3));
    assert_eq!(at(1, 0.3), Spectrum::rgb(1.0, 0.0, 0.0));
    assert_eq!((at(2, 0.25), at(2, 0.75)), (Spectrum::ZERO, Spectrum::rgb(1.0, 0.0, 1.0)));
    assert_eq!(at(3, 0.0), Spectrum::grey(0.5));
}

/// Each refusal says what is wrong, where, and what is allowed.
#[test]
fn what_cannot_be_read_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("cut.obj"), "v 0 0 0\nv 1 0 0\nv 1 1\n").unwrap();
    std::fs::write(folder.path().join("no.png"), "no picture").unwrap();
    let field =
        |rest: &str| object(&format!("height-field = {{ corner = [0, 0], size = [1, 1], {rest} }}"), DIFFUSE);
    let ball = "sphere = { center = [0, 0, 0], radius = 1 }";
    let cases: [(String, &[&str]); 14] = [
        (object("mesh = { file = \"none.obj\" }", DIFFUSE), &["none.obj: No such file"]),
        (
            object("mesh = { file = \"cut.obj\" }", DIFFUSE),
            &["cut.obj:3: a vertex `v` of 2 numbers; allowed: x y z"],
        ),
        (object("mesh = { file = \"cut.obj\", scale = 0 }", DIFFUSE), &["0; allowed: finite and above 0"]),
        (
            object("mesh = { name = \"cut.obj\" }", DIFFUSE),
            &["unexpected keys in table: name, available keys: file, scale, rotate"],
        ),
        (object("lathe = { profile = [[-1, 0], [1, 1]] }", DIFFUSE), &["radius of a profile is -1; allowed"]),
        (object("lathe = { profile = [] }", DIFFUSE), &["a profile needs two points"]),
        (
            object("lathe = { profile = [[1, 0], [1, 1]], smooth = 0 }", DIFFUSE),
            &["smooth is 0; allowed: 1 to 1000"],
        ),
        (field("cells = [0, 1], heights = { rows = [[0, 0], [0, 0]] }"), &["0 x 1 cells; allowed"]),
        (field("cells = [1, 1], heights = { rows = [[0, 0]] }"), &["at least 2 rows"]),
        (
            field("cells = [1, 1], heights = { waves = { seed = 1, count = 0, wavelength = 1, rms = 1 } }"),
            &["count is 0; allowed: 1 to 1000"],
        ),
        (object(ball, "lambertian = { reflectance = 1.5 }"), &["1.5; allowed: 0 to 1"]),
        (
            object(ball, "lambertian = { reflectance = { image = { file = \"no.png\" } } }"),
            &["no.png: no PNG file; allowed: PNG of 8 or 16 bits"],
        ),
        (
            object(ball, "lambertian = { reflectance = { picture = 1 } }"),
            &["unknown variant `picture`", "`image`"],
        ),
        (
            object(ball, "lambertian = { reflectance = { checker = { values = [0, 2], tiles = [1, 1] } } }"),
            &["2; allowed: 0 to 1"],
        ),
    ];
    for (objects, words) in cases {
        let said = scene(folder.path(), &objects).unwrap_err();
        for word in words {
            assert!(said.contains(word), "{objects}{said}");
        }
    }
}
