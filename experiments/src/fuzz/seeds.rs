//! What inputs start from: built-in scenes, those of the gallery, scenes of a few parts drawn by chance, and small files.

use super::Kind;
use crate::harness::Digest;
use glam::DVec3;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;
use toml::{Table, Value};
use turbid::medium::Grid;
use turbid::rng::Stream;
use turbid::scene::BUILTIN;
use turbid_figure::{Axis, Figure, Line, Panel, Points};

/// The folder of the gallery's scenes.
pub fn gallery() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes")
}

/// Whole scenes: the gallery's, and the built-in ones.
fn whole() -> &'static [Table] {
    static WHOLE: OnceLock<Vec<Table>> = OnceLock::new();
    WHOLE.get_or_init(|| {
        let built_in = BUILTIN.iter().filter_map(|builtin| {
            let file = (builtin.resolve)(builtin.defaults).ok()?.ok()?;
            toml::from_str(&file.to_toml().ok()?).ok()
        });
        let mut files: Vec<PathBuf> = std::fs::read_dir(gallery())
            .map(|folder| folder.flatten().map(|entry| entry.path()).collect())
            .unwrap_or_default();
        files.retain(|path| path.extension().is_some_and(|e| e == "toml"));
        files.sort();
        let kept = files.iter().filter_map(|path| toml::from_str(&std::fs::read_to_string(path).ok()?).ok());
        built_in.chain(kept).collect()
    })
}

/// A scene: one in eight is a whole one, the others are drawn.
pub fn scene(stream: &mut Stream) -> Table {
    let whole = whole();
    if stream.unit() < 0.125 && !whole.is_empty() {
        return whole[stream.index(whole.len())].clone();
    }
    drawn(stream)
}

fn pick<'a>(stream: &mut Stream, of: &[&'a str]) -> &'a str {
    of[stream.index(of.len())]
}

/// A number of two digits between two.
fn between(stream: &mut Stream, low: f64, high: f64) -> f64 {
    ((low + (high - low) * stream.unit()) * 100.0).round() / 100.0
}

fn point(stream: &mut Stream) -> String {
    let mut x = || between(stream, -1.0, 1.0);
    format!("[{}, {}, {}]", x(), x(), x())
}

fn spectrum(stream: &mut Stream, most: f64) -> String {
    let mut x = || between(stream, 0.0, most);
    let grey = x();
    if grey < 0.6 * most { format!("{grey}") } else { format!("[{grey}, {}, {}]", x(), x()) }
}

fn shape_text(stream: &mut Stream) -> String {
    let size = between(stream, 0.05, 1.5);
    match stream.index(9) {
        0 | 1 => format!("{{ sphere = {{ center = {}, radius = {size} }} }}", point(stream)),
        2 | 3 => {
            let mut low = || between(stream, -1.0, 0.5);
            let (x, y, z) = (low(), low(), low());
            format!(
                "{{ cuboid = {{ min = [{x}, {y}, {z}], max = [{}, {}, {}] }} }}",
                x + size,
                y + 0.5 * size,
                z + 0.01 + size * size
            )
        }
        4 | 5 => format!(
            "{{ rectangle = {{ corner = {}, u = [{size}, 0, 0], v = [0, {}, {}] }} }}",
            point(stream),
            between(stream, 0.1, 1.0),
            between(stream, -1.0, 1.0)
        ),
        6 => format!("{{ mesh = {{ file = \"part.obj\", scale = {size}, at = {} }} }}", point(stream)),
        7 => format!(
            "{{ lathe = {{ profile = [[0.0, 0.0], [{size}, 0.2], [0.3, 0.6], [0.0, 0.7]], smooth = {} }} }}",
            1 + stream.index(4)
        ),
        _ => format!(
            "{{ height-field = {{ corner = [-1, -1], size = [2, 2], cells = [6, 6], up = \"{}\", floor = -1.0, heights = {{ waves = {{ seed = 3, count = 4, wavelength = {size}, rms = 0.02 }} }} }} }}",
            pick(stream, &["z", "y"])
        ),
    }
}

fn surface_text(stream: &mut Stream) -> String {
    match stream.index(9) {
        0..=2 => format!("{{ lambertian = {{ reflectance = {} }} }}", spectrum(stream, 1.0)),
        3 => "{ lambertian = { reflectance = { image = { file = \"paint.png\" } } } }".to_string(),
        4 => "{ lambertian = { reflectance = { checker = { values = [0.8, [0.2, 0.3, 0.5]], tiles = [3, 5] } } } }"
            .to_string(),
        5 => format!("{{ mirror = {{ reflectance = {} }} }}", spectrum(stream, 1.0)),
        6 => "{ dielectric = { inside = \"glass\" } }".to_string(),
        7 => format!("{{ filter = {{ transmittance = {} }} }}", spectrum(stream, 1.0)),
        _ => pick(
            stream,
            &[
                "\"black\"",
                "{ lambertian = { reflectance = { wood = { values = [[0.6, 0.4, 0.2], 0.1], center = [0, 0, 0], axis = [0, 1, 0], width = 0.05 } } } }",
            ],
        )
        .to_string(),
    }
}

fn medium_text(stream: &mut Stream, can_vary: bool) -> String {
    let mut text = format!(
        "sigma_t = {}\nalbedo = {}\n",
        spectrum(stream, 4.0),
        if stream.unit() < 0.1 { "1".to_string() } else { spectrum(stream, 1.0) }
    );
    text += match stream.index(7) {
        0..=2 => "g = 0.5\n",
        3 => "phase = { rayleigh = {} }\n",
        4 => "phase = { two-term = { g1 = 0.8, g2 = -0.3, share = 0.9 } }\n",
        5 => "phase = { schlick = { k = 0.4 } }\n",
        _ => "phase = { table = { file = \"mie.txt\" } }\n",
    };
    if stream.unit() < 0.1 {
        text += "emission = 0.3\n";
    }
    if can_vary {
        text += match stream.index(6) {
            0 => "density = { grid = { file = \"fog.vol\", scale = 0.5 } }\n",
            1 => {
                "density = { cloud = { center = [0, 0, 0], radii = [0.8, 0.5, 0.8], seed = 7, octaves = 3 } }\n"
            }
            2 => "density = { height-fog = { base = 0.0, scale_height = 0.5, up = [0, 1, 0] } }\n",
            _ => "",
        };
    }
    text
}

fn light_text(stream: &mut Stream) -> String {
    let (p, d) = (point(stream), point(stream));
    match stream.index(8) {
        0..=2 => format!("area = {{ shape = {}, radiance = {} }}", shape_text(stream), spectrum(stream, 9.0)),
        3 => format!("point = {{ position = {p}, power = {} }}", spectrum(stream, 9.0)),
        4 => format!(
            "spot = {{ position = {p}, dir = {d}, full_angle = 20, edge_angle = 30, power = {} }}",
            spectrum(stream, 9.0)
        ),
        5 => format!(
            "sun = {{ dir = {d}, irradiance = {}, angular_radius = {} }}",
            spectrum(stream, 9.0),
            pick(stream, &["0", "0.27", "20"])
        ),
        6 => format!(
            "beam = {{ dir = {d}, irradiance = 2, section = {{ disc = {{ center = {p}, radius = 0.3 }} }} }}"
        ),
        _ => pick(
            stream,
            &[
                "isotropic = { shape = { sphere = { center = [0, 0, 0], radius = 3 } }, faces = \"both\", radiance = 1 }",
                "volume-source = { shape = { cuboid = { min = [-1, -1, -1], max = [1, 0, 1] } }, density = 1 }",
            ],
        )
        .to_string(),
    }
}

/// A scene of a few parts in a space of a few units, most of them valid.
fn drawn(stream: &mut Stream) -> Table {
    let mut text = String::new();
    text += &format!(
        "[camera]\nposition = {}\nlook_at = [0, 0, 0]\nup = [0.1, 1, 0.2]\nfov = 50\nwidth = 8\nheight = 8\nfilter = \"{}\"\n",
        pick(stream, &["[0, 1, 4]", "[0.3, 0.2, 0.1]", "[-2, 0, 1]"]),
        pick(stream, &["box", "tent"])
    );
    for _ in 0..stream.index(3) {
        let shape = match stream.index(3) {
            0 => "{ sphere = { center = [0.1, 0, 0], radius = 1.5 } }",
            1 => "{ cuboid = { min = [-2, -2, -2], max = [2, 2, 2] } }",
            _ => "{ cuboid = { min = [-1, -1, -1], max = [0, 1, 1] } }",
        };
        text += &format!("[[regions]]\nshape = {shape}\n{}", medium_text(stream, true));
    }
    let objects: Vec<(String, String)> =
        (0..stream.index(5)).map(|_| (shape_text(stream), surface_text(stream))).collect();
    if objects.iter().any(|(_, surface)| surface.contains("dielectric")) {
        text += "[[interiors]]\nname = \"glass\"\nindex = 1.5\n";
        if stream.unit() < 0.5 {
            text += &medium_text(stream, false);
        }
    }
    for (shape, surface) in objects {
        text += &format!("[[objects]]\nshape = {shape}\nsurface = {surface}\n");
    }
    for _ in 0..1 + stream.index(2) {
        text += &format!("[[lights]]\n{}\n", light_text(stream));
    }
    for i in 0..stream.index(3) {
        let measure = match stream.index(4) {
            0 => format!("fluence = {{ at = {} }}", point(stream)),
            1 => format!("radiance = {{ origin = {}, dir = [0.1, 0.2, 1] }}", point(stream)),
            2 => "outflow = { shape = { sphere = { center = [0, 0, 0], radius = 3.5 } }, face = \"top\" }"
                .to_string(),
            _ => "absorbed = { region = 0 }".to_string(),
        };
        text += &format!("[[sensors]]\nname = \"s{i}\"\nmeasure = {{ {measure} }}\n");
    }
    toml::from_str(&text).unwrap_or_default()
}

fn value(text: &str) -> Value {
    let table: Table = toml::from_str(&format!("x = {text}")).unwrap_or_default();
    table.get("x").cloned().unwrap_or(Value::Boolean(false))
}

/// A shape by chance.
pub fn shape(stream: &mut Stream) -> Value {
    value(&shape_text(stream))
}

/// A surface by chance.
pub fn surface(stream: &mut Stream) -> Value {
    value(&surface_text(stream))
}

/// The text of a mesh: a pyramid, a square with parameters.
const MESHES: [&str; 3] = [
    "v -0.5 0 -0.5\nv 0.5 0 -0.5\nv 0.5 0 0.5\nv -0.5 0 0.5\nv 0 1 0\nf 1 2 3 4\nf 1 5 2\nf 2 5 3\nf 3 5 4\nf 4 5 1\n",
    "# square\no part\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nvn 0 0 1\nf 1/1/1 2/2/1 3/3/1 4/4/1\n",
    "v 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -2 -1\n",
];

const TABLES: [&str; 3] = [
    "0 5\n30 1\n90 0.3\n180 0.2\n",
    "# angle, value\n0, 10\n1e-3, 9\n45, 1\n179.9, 0.1\n180, 3\n",
    "0\t1\n180\t1\n",
];

fn grid(count: [usize; 3], channels: usize) -> Vec<u8> {
    let values = (0..count.iter().product::<usize>() * channels).map(|i| (i % 5) as f32 * 0.25).collect();
    let corners = (DVec3::splat(-1.0), DVec3::ONE);
    Grid::new(corners, count, channels, values).map(|grid| grid.to_bytes()).unwrap_or_default()
}

fn png(which: usize) -> Vec<u8> {
    use image::{DynamicImage, ImageFormat};
    let picture = match which {
        0 => DynamicImage::new_rgb8(4, 3),
        1 => DynamicImage::new_rgba16(2, 2),
        2 => DynamicImage::new_luma8(5, 1),
        _ => DynamicImage::new_luma_a16(1, 4),
    };
    let mut bytes = std::io::Cursor::new(Vec::new());
    match picture.write_to(&mut bytes, ImageFormat::Png) {
        Ok(()) => bytes.into_inner(),
        Err(_) => Vec::new(),
    }
}

fn cell() -> Vec<u8> {
    let head = "#{\"format\":4,\"experiment\":\"bias\",\"id\":\"slab-000001\",\"settings\":\"quick\",\"program\":\"00\",\
                \"cpu_seconds\":0.1,\"phases\":{\"shooting\":0.05},\"non_finite\":0,\"counters\":{\"photons\":10}}\n";
    let mut bytes =
        format!("{head}case,quantity,value\nr = 1,bias,0.5\n\"a, b\",variance,1e-12\n").into_bytes();
    bytes.extend(b"#end ");
    seal(&mut bytes);
    bytes
}

/// Puts the digest of what is above behind the end mark, so that changes reach the readers behind it.
pub fn seal(bytes: &mut Vec<u8>) {
    const END: &[u8] = b"#end ";
    let Some(at) = bytes.windows(END.len()).rposition(|w| w == END) else { return };
    bytes.truncate(at);
    let mark = format!("#end {}\n", Digest::of(bytes));
    bytes.extend(mark.as_bytes());
}

fn figure(which: usize) -> Vec<u8> {
    let x = vec![1e3, 1e4, 1e5];
    let figure = match which {
        0 => {
            let measured = Points::new("measured", 0, x.clone(), vec![0.31, 0.11, 0.033])
                .with_y_interval(vec![(0.26, 0.36), (0.09, 0.13), (0.028, 0.038)]);
            let theory = Line::theory("N to the -1/2", x, vec![0.316, 0.1, 0.0316]);
            let axes = (Axis::log("Photons", "1"), Axis::log("Error", "%"));
            Figure::new(vec![Panel::new(axes.0, axes.1).with(theory).with(measured)])
        }
        1 => {
            let axes = || (Axis::linear("x", "L"), Axis::linear("y", "L"));
            let line = Line::theory("law", vec![0.0, 1.0, 2.0], vec![0.0, 1.0, 4.0]);
            let (a, b) = (axes(), axes());
            Figure::new(vec![Panel::new(a.0, a.1).with(line.clone()), Panel::new(b.0, b.1).with(line)])
        }
        _ => {
            let line = Line::theory("law", x.clone(), x);
            Figure::new(vec![Panel::new(Axis::linear("x", ""), Axis::log("y", "")).with(line)])
        }
    };
    figure.csv("What is seen.").unwrap_or_default().into_bytes()
}

/// A file to begin with.
pub fn file(kind: Kind, stream: &mut Stream) -> Vec<u8> {
    match kind {
        Kind::Vol => {
            let counts = [[2, 2, 2], [1, 1, 4], [3, 2, 1], [1, 1, 1]];
            grid(counts[stream.index(4)], [1, 1, 1, 3][stream.index(4)])
        }
        Kind::Png => png(stream.index(4)),
        Kind::Obj => MESHES[stream.index(MESHES.len())].into(),
        Kind::Tables => TABLES[stream.index(TABLES.len())].into(),
        Kind::Cells => cell(),
        Kind::Figures => figure(stream.index(3)),
        Kind::Scenes | Kind::Arguments => Vec::new(),
    }
}

/// Files that drawn scenes name.
pub fn files() -> [(&'static str, Vec<u8>); 4] {
    [
        ("fog.vol", grid([3, 3, 3], 1)),
        ("part.obj", MESHES[0].into()),
        ("paint.png", png(0)),
        ("mie.txt", TABLES[0].into()),
    ]
}

/// A command line, a word a line. Numbers that set the work are small or refused; none is large.
pub fn arguments(stream: &mut Stream) -> Vec<u8> {
    const NUMBERS: [&str; 14] =
        ["1", "2", "10", "0", "-1", "nan", "inf", "1e999", "0x10", "", "1_0", " 3", "two", "1e-320"];
    let mut words: Vec<String> = Vec::new();
    let command = pick(
        stream,
        &["check", "check", "scenes", "measure", "advise", "render", "map", "frobnicate", "--help"],
    );
    words.push(command.into());
    words.push(
        pick(
            stream,
            &[
                "slab",
                "sphere",
                "shaft",
                "fogbox",
                "drawn.toml",
                "cloud.toml",
                "no.toml",
                "",
                "\u{1b}[31m",
                ".",
            ],
        )
        .into(),
    );
    for _ in 0..stream.index(3) {
        let key = pick(
            stream,
            &["albedo", "tau", "g", "regions.0.albedo", "objects.9.x", "camera.fov", "lights", "", "a\nb"],
        );
        let value = pick(
            stream,
            &[
                "0.5",
                "1",
                "nan",
                "-1",
                "1e999",
                "[1,2",
                "\"x\ny\"",
                "{ a = 1 }",
                "\u{1b}[0m",
                "''",
                "1..2",
                "[]",
                "é",
            ],
        );
        words.push("--set".into());
        words.push(if stream.unit() < 0.9 { format!("{key}={value}") } else { key.to_string() });
    }
    let number = |stream: &mut Stream| pick(stream, &NUMBERS).to_string();
    let flags: &[&str] = match command {
        "measure" => {
            &["--samples", "--photons", "--k", "--radius", "--orders", "--seed", "--threads", "--max-radius"]
        }
        "advise" => &["--target", "--pilot", "--samples"],
        "render" => &[
            "--samples",
            "--exposure",
            "--k",
            "--radius",
            "--gather-rays",
            "--step",
            "--near",
            "--adapt",
            "--volume",
        ],
        "map" => &["--exposure", "--global", "--caustic", "--volume", "--seed"],
        "scenes" => &["--resolved"],
        _ => &["--format"],
    };
    match command {
        "measure" => {
            // What the method would ignore is refused.
            let with = pick(stream, &["path", "photons", "light"]);
            words.extend(["--with", with].map(String::from));
            let count = if with == "path" { ["--samples", "20"] } else { ["--photons", "500"] };
            words.extend(count.map(String::from));
        }
        "advise" => words.extend(["--target", "50%", "--pilot", "2000", "--samples", "20"].map(String::from)),
        "render" => {
            words.extend(["-o", "out.exr", "--width", "4", "--samples", "1"].map(String::from));
            let with = pick(stream, &["photons", "paths", "light"]);
            words.extend(["--with", with].map(String::from));
            if with == "photons" {
                words.extend(["--global", "500", "--caustic", "100", "--volume", "300"].map(String::from));
            }
        }
        "map" => words.extend(
            ["-o", "out.png", "--width", "8", "--global", "500", "--volume", "300"].map(String::from),
        ),
        _ => {}
    }
    for _ in 0..stream.index(3) {
        let flag = pick(stream, flags);
        // What is given twice is refused: the later one takes the earlier one's place.
        if let Some(at) = words.iter().position(|w| w == flag) {
            words.drain(at..(at + 2).min(words.len()));
        }
        words.push(flag.into());
        words.push(number(stream));
    }
    // A line feed in a word would make two of it.
    words.iter().map(|w| w.replace('\n', "\u{b}")).collect::<Vec<_>>().join("\n").into_bytes()
}
