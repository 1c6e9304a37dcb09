//! `turbid render` and `turbid map`: what they write, and what they refuse.

use crate::{Folder, refuses_naming, succeeds, text};
use std::path::{Path, PathBuf};

/// A diffuse floor in a box of fog under a lamp, seen from the side.
const ROOM: &str = r#"
[camera]
position = [0.0, 1.0, 4.0]
look_at = [0.0, 0.7, 0.0]
fov = 40.0
width = 12
height = 8

[[regions]]
shape = { cuboid = { min = [-1.0, 0.0, -1.0], max = [1.0, 2.0, 1.0] } }
sigma_t = 0.5
albedo = 0.8
g = 0.0

[[objects]]
shape = { rectangle = { corner = [-1.0, 0.0, -1.0], u = [0.0, 0.0, 2.0], v = [2.0, 0.0, 0.0] } }
surface = { lambertian = { reflectance = [0.8, 0.5, 0.2] } }

[[lights]]
point = { position = [0.0, 1.5, 0.0], power = 10.0 }
"#;

const QUICK: [&str; 8] =
    ["--samples", "2", "--global", "emit:2000", "--volume", "emit:2000", "--gather-rays", "2"];

fn room(folder: &Folder, name: &str, change: (&str, &str)) -> PathBuf {
    assert!(ROOM.contains(change.0), "{}", change.0);
    folder.file(name, &ROOM.replacen(change.0, change.1, 1))
}

/// Every renderer writes an EXR and a PNG, alike on one thread and on two.
#[test]
fn pictures_have_the_same_bits_on_any_number_of_threads() {
    let folder = Folder::new();
    let scene = room(&folder, "room.toml", ("", ""));
    let out = |name: &str| folder.0.path().join(name);
    for with in ["photons", "paths", "light"] {
        let render = |file: &str, threads: &str| {
            let path = out(file);
            let arguments = ["render", text(&scene), "-o", text(&path), "--with", with, "--threads", threads];
            let quick = if with == "photons" { &QUICK[..] } else { &QUICK[..2] };
            let said = succeeds(&[&arguments[..], quick].concat());
            assert!(said.contains("12 x 8") && said.contains("non-finite     0 of 192 samples"), "{said}");
            (std::fs::read(&path).unwrap(), std::fs::read(path.with_extension("png")).unwrap())
        };
        let (one, two) = (render("one.exr", "1"), render("two.exr", "2"));
        assert!(one == two, "{with}: the picture depends on the number of threads");
        assert!(one.0.starts_with(&[0x76, 0x2f, 0x31, 0x01]) && one.1.starts_with(b"\x89PNG"));
        let header = String::from_utf8_lossy(&one.0);
        assert!(header.contains(&format!("\"with\":\"{with}\"")), "no provenance");
        assert!(!header.contains(text(folder.0.path())), "a path of this machine is in the file");
    }
    // Repetitions make variances between maps; one sample in a limited time, at least.
    let path = out("maps.exr");
    let arguments = ["render", text(&scene), "-o", text(&path), "--maps", "3", "--width", "6"];
    let said = succeeds(&[&arguments[..], &QUICK].concat());
    assert!(said.contains("6 x 4") && said.contains("3 repetitions") && said.contains("map 2"), "{said}");
    for with in ["paths", "light"] {
        let timed = ["render", text(&scene), "-o", text(&path), "--with", with, "--seconds", "1e-6"];
        assert!(succeeds(&timed).contains("samples        1 a pixel"));
    }
    let repeated = ["--with", "light", "--maps", "3", "--samples", "2"];
    let said = succeeds(&[&["render", text(&scene), "-o", text(&path)][..], &repeated].concat());
    assert!(said.contains("3 repetitions") && said.contains("histories      576 photons"), "{said}");
    assert!(said.contains(" to the camera"), "{said}");
}

/// By planes the same bits on any number of threads, what was found told by its kind, the settings in the header; beams that find nothing
/// and peaks are told of.
#[test]
fn pictures_by_planes_tell_what_they_rest_on() {
    let folder = Folder::new();
    let scene = room(&folder, "room.toml", ("", ""));
    let path = folder.0.path().join("a.exr");
    let render = |scene: &Path, more: &[&str]| {
        let arguments = ["render", text(scene), "-o", text(&path), "--planes"];
        let done = crate::turbid(&[&arguments[..], &QUICK, more].concat()).output().unwrap();
        assert!(done.status.success(), "{more:?}");
        [done.stdout, done.stderr].map(|text| String::from_utf8(text).unwrap())
    };
    let threads = |number: &str| {
        let [said, told] = render(&scene, &["--beam-radius", "0.1", "--threads", number]);
        let volume = said.lines().find(|line| line.starts_with("gathers        volume")).unwrap();
        assert!(
            volume.contains(" beams within 1.00e-1 L and ") && volume.ends_with(" planes in the mean"),
            "{said}"
        );
        assert!(said.contains("planes and beams stored of 2000 photons emitted"), "{said}");
        assert!(!told.contains("peak") && !told.contains("none of"), "{told}");
        std::fs::read(&path).unwrap()
    };
    let picture = threads("1");
    assert!(picture == threads("2"));
    assert!(String::from_utf8_lossy(&picture).contains("\"planes\":true"));
    let [_, told] = render(&scene, &["--beam-radius", "1e-30"]);
    assert!(
        told.contains(
            "found a beam within 1.00e-30 L, so that it brings no light that comes to media from bodies"
        ),
        "{told}"
    );
    // Without bodies there are no beams to be found.
    let start = ROOM.find("[[objects]]").unwrap();
    let open =
        [&ROOM[..start], &ROOM[ROOM.find("[[lights]]").unwrap()..]].concat().replace("g = 0.0", "g = 0.9");
    let [said, told] = render(&folder.file("open.toml", &open), &[]);
    assert!(said.contains(" planes stored of 2000 photons emitted") && !said.contains("beams"), "{said}");
    assert!(
        told.contains("a plane in the peak of a phase function brings 190 times")
            && !told.contains("none of"),
        "{told}"
    );
    let own = ["render", text(&scene), "-o", text(&path), "--ray-radius", "0.1", "--ray-ends", "own"];
    refuses_naming(&own, &["--ray-ends: rays end for each photon"]);
}

/// Where photons know no better a guided picture is that of paths, bit by bit, and says so; provenance has the guide of a picture
/// by paths. Other methods refuse it, but for a reference's sake.
#[test]
fn guided_pictures_are_those_of_paths_where_photons_know_no_better() {
    let folder = Folder::new();
    let scene = room(&folder, "room.toml", ("", ""));
    let render = |name: &str, more: &[&str]| {
        let path = folder.0.path().join(name);
        let start = ["render", text(&scene), "-o", text(&path), "--samples", "2"];
        let done = crate::turbid(&[&start[..], more].concat()).output().unwrap();
        assert!(done.status.success());
        let notes = String::from_utf8(done.stderr).unwrap();
        (std::fs::read(path.with_extension("png")).unwrap(), std::fs::read(&path).unwrap(), notes)
    };
    let (paths, _, _) = render("paths.exr", &["--with", "paths"]);
    let plain = succeeds(&[
        "render",
        text(&scene),
        "-o",
        text(&folder.0.path().join("plain.exr")),
        "--with",
        "paths",
    ]);
    assert!(!plain.contains("guide"), "{plain}");
    let (guided, file, notes) = render("guided.exr", &["--with", "paths", "--guide", "3000"]);
    assert!(paths == guided && notes.contains("--guide changes nothing"), "{notes}");
    assert!(String::from_utf8_lossy(&file).contains("\"guide\":3000"), "no provenance");
    let compared = ["--with", "light", "--samples", "9", "--guide", "3000"];
    let path = folder.0.path().join("light.exr");
    refuses_naming(
        &[&["render", text(&scene), "-o", text(&path)][..], &compared].concat(),
        &["--guide says nothing to --with light; allowed: with --with paths or --compare"],
    );
}

/// Sum of a channel over the picture and, of pixels taken for independent, its standard error.
fn summed(file: &Path, channel: &str) -> (f64, f64) {
    use exr::prelude::{ReadChannels, ReadLayers, read};
    let image = read().no_deep_data().largest_resolution_level().all_channels().all_layers().all_attributes();
    let image = image.from_file(file).unwrap();
    let sum = |name: &str| {
        let channels = &image.layer_data[0].channel_data.list;
        let found = channels.iter().find(|c| c.name.to_string() == name).unwrap();
        found.sample_data.values_as_f32().map(f64::from).sum::<f64>()
    };
    (sum(channel), sum(&format!("variance.{channel}")).sqrt())
}

/// Bodies that hide photons and cover discs, glass for the caustic map, and fog that varies.
const CROWDED: &str = r#"
interiors = [{ name = "glass", index = 1.5 }]

[[objects]]
shape = { sphere = { center = [0.4, 0.2, 0.3], radius = 0.2 } }
surface = { lambertian = { reflectance = 0.6 } }

[[objects]]
shape = { sphere = { center = [-0.3, 0.5, 0.0], radius = 0.3 } }
surface = { dielectric = { inside = "glass" } }

[[regions]]
shape = { cuboid = { min = [-0.9, 0.0, -0.9], max = [0.0, 1.0, 0.9] } }
sigma_t = 2.0
albedo = 0.9
g = 0.3
density = { height-fog = { base = 0.0, scale_height = 0.4, up = [0, 1, 0] } }
"#;

/// The same photons, a part of them at a time, which march in equal steps: each pixel within 1e-5, the same bits on any number of threads.
#[test]
fn pictures_in_passes_are_those_of_one() {
    let folder = Folder::new();
    let scene = folder.file("crowded.toml", &(CROWDED.to_string() + ROOM.trim_start()));
    let render = |name: &str, more: &[&str]| {
        let path = folder.0.path().join(name);
        let arguments = ["render", text(&scene), "-o", text(&path), "--maps", "2", "--radius", "0.2"];
        let caustic = ["--caustic", "emit:2001", "--global", "emit:3001"];
        succeeds(&[&arguments[..], &QUICK[..2], &QUICK[4..], &caustic, more].concat());
        path
    };
    let whole = means(&render("whole.exr", &["--adapt", "0"]));
    for passes in ["2", "5"] {
        let parts = means(&render("parts.exr", &["--passes", passes]));
        assert_eq!(parts.len(), whole.len());
        for ((name, a), (_, b)) in whole.iter().zip(&parts) {
            let largest = a.iter().fold(0.0f32, |most, x| most.max(x.abs()));
            let is_near = |(x, y): (&f32, &f32)| (x - y).abs() <= 1e-5 * x.abs() + 1e-7 * largest;
            assert!(a.iter().zip(b).all(is_near), "{passes} passes: {name}");
            let wanted = ["caustic.R", "indirect.G", "multiple.B", "single.R", "direct.G"];
            assert!(!wanted.contains(&name.as_str()) || largest > 0.0, "{name} is black");
        }
    }
    let read = |name: &str, threads: &str| {
        std::fs::read(render(name, &["--passes", "3", "--threads", threads])).unwrap()
    };
    assert!(read("one.exr", "1") == read("two.exr", "2"));
}

/// Steps follow the light, but for media whose density varies: there it costs more than it brings.
#[test]
fn steps_follow_the_light_in_homogeneous_media() {
    let folder = Folder::new();
    for (scene, adapt) in [(ROOM.to_string(), "0.5"), (CROWDED.to_string() + ROOM.trim_start(), "0")] {
        let scene = folder.file("room.toml", &scene);
        let render = |more: &[&str]| {
            let path = folder.0.path().join("room.exr");
            succeeds(&[&["render", text(&scene), "-o", text(&path)], &QUICK[..], more].concat());
            means(&path)
        };
        let [usual, adaptive, equal] = [&[][..], &["--adapt", "0.5"], &["--adapt", "0"]].map(render);
        assert!(adaptive != equal && usual == if adapt == "0" { equal } else { adaptive }, "{adapt}");
    }
}

/// Why steps are equal where a density varies: in a cloud adaptive ones take 22 times the shadow rays, and bring 12 % less
/// variance.
#[test]
fn adaptive_steps_do_not_pay_in_a_cloud() {
    let folder = Folder::new();
    let scene = Path::new(env!("CARGO_MANIFEST_DIR")).join("experiments/scenes/cloud.toml");
    let [adaptive, equal] = ["0.5", "0"].map(|adapt| {
        let path = folder.0.path().join("cloud.exr");
        let one =
            ["render", text(&scene), "-o", text(&path), "--adapt", adapt, "--width", "48", "--samples", "8"];
        let maps = ["--volume", "300000", "--volume-k", "40", "--max-radius", "0.15", "--gather-rays", "0"];
        let said = succeeds(&[&one[..], &maps, &["--global", "emit:1", "--caustic", "emit:1"]].concat());
        let line = said.lines().find(|line| line.starts_with("shadow rays")).unwrap();
        let rays: f64 = line.split_whitespace().last().unwrap().parse().unwrap();
        let channels = channels(&path);
        let (_, variance) = channels.iter().find(|(name, _)| name == "variance.G").unwrap();
        (rays, variance.iter().map(|&x| f64::from(x)).sum::<f64>())
    });
    assert!(adaptive.0 > 15.0 * equal.0, "{adaptive:?} {equal:?}");
    assert!(adaptive.1 > 0.7 * equal.1, "{adaptive:?} {equal:?}");
}

/// What a picture in passes needs is said.
#[test]
fn what_cannot_be_made_in_passes_is_refused() {
    let folder = Folder::new();
    let exr = folder.0.path().join("a.exr");
    let fogbox = ["render", "fogbox", "-o", text(&exr), "--passes", "2"];
    let (radius, maps) = (["--radius", "0.1"], ["--maps", "2"]);
    for (more, words) in [
        (&[&maps[..]].concat(), ["--passes is 2", "needs --radius"]),
        (&[&radius[..]].concat(), ["--passes is 2", "several --maps"]),
        (&[&radius[..], &maps, &["--adapt", "0.5"]].concat(), ["--passes is 2", "--adapt 0"]),
        (&[&radius[..], &maps, &["--seconds", "1"]].concat(), ["--passes is 2", "--samples"]),
        (&vec!["--with", "paths"], ["--passes says nothing to --with paths", "allowed: with --with photons"]),
    ] {
        refuses_naming(&[&fogbox[..], more].concat(), &words);
    }
    let large = ["--maps", "2", "--radius", "0.1", "--global", "1e8", "--memory", "200M", "--width", "8"];
    refuses_naming(&[&fogbox[..4], &large].concat(), &["--global ", "or --passes "]);
    assert!(!exr.exists());
}

/// Every channel of a file but variances, by name.
fn means(file: &Path) -> Vec<(String, Vec<f32>)> {
    channels(file).into_iter().filter(|(name, _)| !name.starts_with("variance")).collect()
}

/// Every channel of an EXR file.
fn channels(file: &Path) -> Vec<(String, Vec<f32>)> {
    use exr::prelude::{ReadChannels, ReadLayers, read};
    let image = read().no_deep_data().largest_resolution_level().all_channels().all_layers().all_attributes();
    let image = image.from_file(file).unwrap();
    let channels = &image.layer_data[0].channel_data.list;
    channels.iter().map(|c| (c.name.to_string(), c.sample_data.values_as_f32().collect())).collect()
}

/// Light that a ball of glass gathers on the floor beside it: paths and light tracing see as much of it, each layer by
/// layer; what light tracing cannot see is black, and said to be.
#[test]
fn light_tracing_is_a_witness_for_caustics() {
    let scene = r#"
interiors = [{ name = "glass", index = 1.5 }]
[camera]
position = [2.0, 0.25, 0.0]
look_at = [0.0, -0.02, 0.0]
fov = 10.0
width = 8
height = 8

[[objects]]
shape = { rectangle = { corner = [-2.0, 0.0, -2.0], u = [0.0, 0.0, 4.0], v = [4.0, 0.0, 0.0] } }
surface = { lambertian = { reflectance = 0.8 } }

[[objects]]
shape = { sphere = { center = [0.0, 0.7, 0.0], radius = 0.5 } }
surface = { dielectric = { inside = "glass" } }

[[lights]]
area = { shape = { rectangle = { corner = [-0.7, 3.0, -0.7], u = [1.4, 0.0, 0.0], v = [0.0, 0.0, 1.4] } }, radiance = 5.0 }
"#;
    let folder = Folder::new();
    let scene = folder.file("ball.toml", scene);
    let out = |with: &str| folder.0.path().join(format!("{with}.exr"));
    for (with, samples) in [("paths", "512"), ("light", "8000")] {
        let file = out(with);
        let arguments = ["render", text(&scene), "-o", text(&file), "--with", with, "--samples", samples];
        let output = crate::turbid(&arguments).output().unwrap();
        let said = String::from_utf8(output.stderr).unwrap();
        assert!(output.status.success(), "{said}");
        assert_eq!(said.contains("not what is seen in mirrors and through glass"), with == "light", "{said}");
    }
    for layer in ["direct", "caustic"] {
        let [(a, a_error), (b, b_error)] =
            ["paths", "light"].map(|with| summed(&out(with), &format!("{layer}.R")));
        let error = libm::hypot(a_error, b_error);
        assert!(error < 0.03 * a, "{layer}: {a} {b}, error {error}");
        // Five standard errors of a normal law: one in two million.
        assert!((a - b).abs() < 5.0 * error, "{layer}: paths {a}, light {b}, error {error}");
    }
    assert_eq!(summed(&out("light"), "emission.G").0, 0.0);
}

/// What light tracing cannot do is refused before any work.
#[test]
fn light_tracing_refuses() {
    let folder = Folder::new();
    let out = folder.0.path().join("out.exr");
    let render = |scene: &str, more: &[&str], words: &[&str]| {
        refuses_naming(&[&["render", scene, "-o", text(&out), "--with", "light"], more].concat(), words);
    };
    let layer = "cell = 4.0\n[camera]\nposition = [0, 0, -2]\nlook_at = [0, 0, 0]\nfov = 40\nwidth = 4\nheight = 4\n\
                 [[regions]]\nshape = { slab = { top = 0, thickness = 1 } }\nsigma_t = 1\nalbedo = 0.8\ng = 0\n\
                 [[lights]]\nbeam = { dir = [0, 0, 1], irradiance = 1, section = \"unbounded\" }\n";
    let layer = folder.file("layer.toml", layer);
    render(text(&layer), &[], &["an unbounded slab", "--with paths"]);
    render("fogbox", &["--plan", "full"], &["--plan full", "allowed with --with light: auto"]);
    refuses_naming(
        &["render", "fogbox", "-o", text(&out), "--with", "lights"],
        &["--with", "allowed: photons, paths, bidirectional, light"],
    );
    assert!(!out.exists());
}

/// The statistics tell all that was done, and that nothing was done that the scene does not require.
#[test]
fn statistics_of_a_picture_tell_its_work() {
    let folder = Folder::new();
    let scene = room(&folder, "room.toml", ("", ""));
    let path = folder.0.path().join("out.exr");
    let arguments = ["render", text(&scene), "-o", text(&path)];
    let said = succeeds(&[&arguments[..], &QUICK].concat());
    let nothing =
        "tracking       0 majorants, 0 densities, 0 transmittances, 0 flights by channel; 0 projection cells";
    for told in [
        "photons stored of 2000 emitted",
        "first pass of 2000: ",
        " escaped, 0 truncated",
        " of final gatherings",
        "shadow rays    ",
        "march steps    ",
        "gathers        global   ",
        "gathers        caustic  0\n",
        "gathers        volume   ",
        " L in the mean; ",
        " found fewer than k",
        "non-finite     0 of ",
        "time           pilot ",
        "time           of these: emission ",
        "time           samples ",
        nothing,
    ] {
        assert!(said.contains(told), "{told} is not in:\n{said}");
    }
    // Photons that importance splits end more often than they are sent out.
    let split = "; what importance split counts by its parts";
    assert!(!said.contains(split));
    let led = succeeds(&[&arguments[..], &["--importance"], &QUICK].concat());
    assert!(led.contains(split), "{led}");
    let full = succeeds(&[&arguments[..], &["--plan", "full"], &QUICK].concat());
    assert!(!full.contains("tracking       0 ") && !full.contains("; 0 projection cells"), "{full}");
    assert!(!full.contains("gathers        caustic  0\n"), "{full}");
}

/// Where nothing is asked for an estimate takes more photons from maps that hold more, where they are read without a mean over
/// many places; 100 at least.
#[test]
fn photons_of_an_estimate_follow_those_of_the_map() {
    let folder = Folder::new();
    let path = folder.0.path().join("out.exr");
    // Photons of each map, and those of an estimate.
    let common = ["render", "fogbox", "-o", text(&path), "--width", "4", "--samples", "1"];
    let taken = |more: &[&str]| -> Vec<[usize; 2]> {
        let said = succeeds(&[&common[..], more].concat());
        let lines = said.lines().filter(|line| line.contains(" photons stored of "));
        let number = |text: &str| text.split_whitespace().next().unwrap().parse().unwrap();
        let numbers = |line: &str| [number(&line[15..]), number(line.split(", the ").nth(1).unwrap())];
        lines.map(numbers).collect()
    };
    let many = ["--global", "280000", "--volume", "160000", "--gather-rays"];
    let seen = taken(&[&many[..], &["0", "--maps", "2"]].concat());
    for (index, (from, power)) in [(70_000.0, 2.0 / 3.0), (20_000.0, 4.0 / 7.0)].into_iter().enumerate() {
        let [stored, k] = seen[index];
        assert!((k as f64 - 100.0 * libm::pow(stored as f64 / from, power)).abs() <= 0.51, "{seen:?}");
        // The second map is read as the first is.
        assert!(seen[index + 2][1] == k && k > 200, "{seen:?}");
    }
    let k = |more: &[&str]| taken(more).iter().map(|numbers| numbers[1]).collect::<Vec<_>>();
    assert_eq!(k(&["--global", "20000", "--volume", "2000", "--gather-rays", "0"]), [100, 100]);
    assert_eq!(k(&[&many[..2], &["--volume", "2000", "--gather-rays", "1"]].concat()), [100, 100]);
    assert_eq!(k(&[&many[..], &["0", "--k", "30", "--volume-k", "40"]].concat()), [30, 40]);
    let by_radius = succeeds(&[&common[..], &["--radius", "0.1"]].concat());
    assert!(by_radius.contains(" photons stored of ") && !by_radius.contains(" an estimate"), "{by_radius}");
}

#[test]
fn photons_are_drawn_and_exported() {
    let folder = Folder::new();
    let scene = room(&folder, "room.toml", ("", ""));
    let (png, ply) = (folder.0.path().join("map.png"), folder.0.path().join("map.ply"));
    let arguments = ["map", text(&scene), "-o", text(&png), "--ply", text(&ply)];
    let said = succeeds(&[&arguments[..], &QUICK[2..6]].concat());
    let count: usize = said.split_whitespace().nth(1).unwrap().parse().unwrap();
    assert!(count > 100, "{said}");
    let cloud = std::fs::read(&ply).unwrap();
    let header = format!("element vertex {count}\n");
    assert!(String::from_utf8_lossy(&cloud[..500]).contains(&header));
    assert!(std::fs::read(&png).unwrap().starts_with(b"\x89PNG"));
    let caustic = ["map", text(&scene), "-o", text(&png), "--which", "caustic"];
    refuses_naming(&caustic, &["the map is empty"]);
}

#[test]
fn cameras_that_see_nothing() {
    let folder = Folder::new();
    let out = folder.0.path().join("a.exr");
    let cases = [
        ("fov = 40.0", "fov = 180.0", "camera.fov is 180; allowed: above 0 and below 180"),
        ("fov = 40.0", "fov = nan", "camera.fov is NaN"),
        ("width = 12", "width = 0", "camera.width is 0; allowed: 1 to 16384"),
        ("height = 8", "height = -8", "height"),
        ("height = 8", "heigth = 8", "unknown key `heigth`; nearest: `height`"),
        ("height = 8", "height = 8\nfilter = \"gauss\"", "unknown value `gauss`"),
        ("look_at = [0.0, 0.7, 0.0]", "look_at = [0.0, 1.0, 4.0]", "camera.look_at"),
        ("fov = 40.0", "up = [0.0, -0.3, -4.0]\nfov = 40.0", "camera.up"),
        ("position = [0.0, 1.0, 4.0]", "position = [0.0, inf, 4.0]", "camera.position"),
    ];
    for (i, (from, to, words)) in cases.into_iter().enumerate() {
        let name = format!("case{i}.toml");
        let path = room(&folder, &name, (from, to));
        refuses_naming(&["render", text(&path), "-o", text(&out)], &[&name, words]);
    }
    let start = ROOM.find("[[regions]]").unwrap();
    let blind = folder.file("blind.toml", &ROOM[start..]);
    refuses_naming(&["render", text(&blind), "-o", text(&out)], &["no [camera]"]);
    let stone =
        "[[objects]]\nshape = { sphere = { center = [0.0, 1.0, 4.0], radius = 0.5 } }\nsurface = \"black\"\n";
    let enclosed = folder.file("stone.toml", &format!("{ROOM}\n{stone}"));
    for command in ["render", "map"] {
        let file = folder.0.path().join(if command == "map" { "a.png" } else { "a.exr" });
        let words = ["enclosed camera", "objects[1]"];
        refuses_naming(&[command, text(&enclosed), "-o", text(&file)], &words);
    }
    assert!(!out.exists());
}

#[test]
fn wrong_options_of_pictures() {
    let folder = Folder::new();
    let scene = room(&folder, "room.toml", ("", ""));
    let out = folder.0.path().join("a.exr");
    let refuse = |options: &[&str], words: &[&str]| {
        refuses_naming(&[&["render", text(&scene), "-o", text(&out)], options].concat(), words);
    };
    refuse(&["--global", "some"], &["--global", "emit:1e6"]);
    refuse(&["--volume", "0"], &["--volume", "allowed"]);
    refuse(&["--k", "1"], &["--k", "1; allowed"]);
    refuse(&["--radius", "0"], &["--radius", "0; allowed"]);
    refuse(&["--step", "-1"], &["--step"]);
    refuse(&["--adapt", "nan"], &["--adapt is NaN"]);
    refuse(&["--width", "0"], &["--width", "allowed: whole numbers from 1 to 16384"]);
    refuse(&["--seconds", "0"], &["--seconds is 0; allowed"]);
    refuse(&["--seconds", "1", "--samples", "2"], &["--samples", "--seconds"]);
    refuse(&["--exposure", "nan"], &["--exposure is NaN"]);
    refuse(&["--with", "magic"], &["magic", "photons, paths"]);
    refuses_naming(&["render", text(&scene)], &["--output"]);
    refuses_naming(&["render", text(&scene), "-o", "a.jpg"], &["a.jpg", ".exr"]);
    refuses_naming(&["map", text(&scene), "-o", "a.exr"], &["a.exr", ".png"]);
    let nowhere = folder.0.path().join("nowhere").join("a.exr");
    refuses_naming(&["render", text(&scene), "-o", text(&nowhere)], &["cannot write", "nowhere"]);
    // The lamp by way of a mirror: no path finds it.
    let mirror = room(&folder, "mirror.toml", ("lambertian", "mirror"));
    let paths = ["render", text(&mirror), "-o", text(&out), "--with", "paths"];
    refuses_naming(&paths, &["path tracer cannot sample", "extent"]);
    assert!(!out.exists());
}

/// A link to a device that is always full stands for a full disk.
#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_told_in_one_line() {
    let folder = Folder::new();
    let scene = room(&folder, "room.toml", ("", ""));
    let full = |name: &str| {
        let link = folder.0.path().join(name);
        std::os::unix::fs::symlink("/dev/full", &link).unwrap();
        link
    };
    let exr = full("full.exr");
    let arguments = ["render", text(&scene), "-o", text(&exr)];
    refuses_naming(&[&arguments[..], &QUICK].concat(), &["cannot write", "full.exr", "No space left"]);
    let png = full("full.png");
    let arguments = ["map", text(&scene), "-o", text(&png)];
    refuses_naming(&[&arguments[..], &QUICK[2..6]].concat(), &["cannot write", "full.png", "No space left"]);
}
