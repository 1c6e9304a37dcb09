//! `turbid export` and `turbid import`: the text for Mitsuba, scenes that come back, and what is refused.

use crate::{Folder, refuses_naming, text, turbid};
use std::path::{Path, PathBuf};

/// A run that must succeed; what it says on stderr.
fn runs(arguments: &[&str]) -> String {
    let output = turbid(arguments).output().unwrap();
    let stderr = String::from_utf8(output.stderr).unwrap();
    assert!(output.status.success(), "{arguments:?}: {stderr}");
    stderr
}

fn exported(folder: &Folder, name: &str, scene: &str) -> (String, String) {
    let (file, xml) =
        (folder.file(&format!("{name}.toml"), scene), folder.0.path().join(format!("{name}.xml")));
    let notes = runs(&["export", text(&file), "--mitsuba", text(&xml)]);
    (std::fs::read_to_string(xml).unwrap(), notes)
}

const CAMERA: &str =
    "camera = { position = [0.0, 0.5, 4.0], look_at = [0.0, 0.0, 0.0], fov = 40.0, width = 8, height = 6 }\n";
const LAMP: &str = "[[lights]]\npoint = { position = [0, 3, 0], power = 4 }\n";

/// Text that Mitsuba 3.9 has rendered to turbid's values: `tests/mitsuba/compare.py` does so with nine scenes.
#[test]
fn the_text_for_mitsuba() {
    let folder = Folder::new();
    let scene = format!(
        "interiors = [{{ name = \"glass\", index = 1.5 }}]\n{CAMERA}
        [[regions]]\nshape = {{ sphere = {{ center = [0, 0, 0], radius = 2 }} }}\nsigma_t = [1, 2, 4]\nalbedo = 0.5\ng = -0.25
        [[objects]]\nshape = {{ sphere = {{ center = [0, 0.5, 0], radius = 0.5 }} }}\nsurface = {{ dielectric = {{ inside = \"glass\" }} }}
        [[objects]]\nshape = {{ rectangle = {{ corner = [-1, 0, 1], u = [2, 0, 0], v = [0, 0, -4] }} }}\nsurface = {{ lambertian = {{ reflectance = [0.5, 0.25, 0] }} }}
        [[lights]]\nspot = {{ position = [0, 3, 0], dir = [0, -1, 0], full_angle = 60, edge_angle = 60, power = 1 }}\n"
    );
    let (xml, _) = exported(&folder, "scene", &scene);
    let expected = [
        "<integrator type=\"volpathmis\">\n        <integer name=\"max_depth\" value=\"-1\"/>\n    </integrator>",
        "<medium type=\"homogeneous\" id=\"region-0\">\n        <float name=\"scale\" value=\"4\"/>\n        <rgb name=\"sigma_t\" value=\"0.25, 0.5, 1\"/>\n        <rgb name=\"albedo\" value=\"0.5, 0.5, 0.5\"/>\n        <phase type=\"hg\">\n            <float name=\"g\" value=\"-0.25\"/>\n        </phase>\n    </medium>",
        "<string name=\"fov_axis\" value=\"x\"/>\n        <float name=\"fov\" value=\"40\"/>",
        "<lookat origin=\"0, 0.5, 4\" target=\"0, 0, 0\" up=\"0, 1, 0\"/>",
        "<integer name=\"sample_count\" value=\"$spp\"/>",
        "<rfilter type=\"box\"/>",
        "<shape type=\"sphere\" id=\"boundary-0\">\n        <point name=\"center\" value=\"0, 0, 0\"/>\n        <float name=\"radius\" value=\"2\"/>\n        <ref name=\"interior\" id=\"region-0\"/>\n        <bsdf type=\"null\"/>\n    </shape>",
        "<ref name=\"exterior\" id=\"region-0\"/>\n        <bsdf type=\"dielectric\">\n            <float name=\"int_ior\" value=\"1.5\"/>\n            <float name=\"ext_ior\" value=\"1\"/>\n        </bsdf>",
        "<matrix value=\"1 0 0 0 0 0 1 0 0 -2 0 -1 0 0 0 1\"/>",
        "<bsdf type=\"twosided\">\n            <bsdf type=\"diffuse\">\n                <rgb name=\"reflectance\" value=\"0.5, 0.25, 0\"/>",
        // A spot of half angle 60 degrees fills pi sr.
        "<rgb name=\"intensity\" value=\"0.31830988618379",
        "<float name=\"cutoff_angle\" value=\"60\"/>\n        <float name=\"beam_width\" value=\"60\"/>",
    ];
    for snippet in expected {
        assert!(xml.contains(snippet), "{snippet}\nis missing in\n{xml}");
    }
}

/// The nine scenes that are compared with Mitsuba go out, come back, and go out again as the same text. Text that is the same in
/// every digit says the same scene.
#[test]
fn scenes_come_back() {
    let folder = Folder::new();
    let path = |name: &str| folder.0.path().join(name);
    let mut count = 0;
    for entry in std::fs::read_dir("tests/mitsuba/scenes").unwrap() {
        let scene = entry.unwrap().path();
        if scene.extension().is_none_or(|e| e != "toml") {
            continue;
        }
        count += 1;
        let stem = scene.file_stem().unwrap().to_str().unwrap();
        let (first, back, second) =
            (path(&format!("{stem}-1.xml")), path("back.toml"), path(&format!("{stem}-2.xml")));
        runs(&["export", text(&scene), "--mitsuba", text(&first)]);
        runs(&["import", text(&first), "-o", text(&back)]);
        runs(&["export", text(&back), "--mitsuba", text(&second)]);
        // Names of parts count regions and files anew, in the order of size; names of media are theirs.
        let plain = |path: &Path| -> Vec<String> {
            let text = std::fs::read_to_string(path).unwrap();
            let known = |line: &&str| !["id=", "filename", "values"].iter().any(|word| line.contains(word));
            let mut lines: Vec<String> =
                text.lines().filter(known).map(|line| number_words(line).join(" ")).collect();
            lines.sort();
            lines
        };
        for (a, b) in plain(&first).iter().zip(&plain(&second)) {
            assert!(is_nearly(a, b), "{stem}:\n{a}\n{b}");
        }
        assert_eq!(plain(&first).len(), plain(&second).len(), "{stem}");
    }
    assert_eq!(count, 9);
}

fn number_words(line: &str) -> Vec<String> {
    line.split([' ', ',', '"']).filter(|word| !word.is_empty()).map(str::to_string).collect()
}

/// The same words, and numbers up to a step behind a wall.
fn is_nearly(a: &str, b: &str) -> bool {
    let (a, b): (Vec<&str>, Vec<&str>) = (a.split(' ').collect(), b.split(' ').collect());
    a.len() == b.len()
        && a.iter().zip(&b).all(|(a, b)| match (a.parse::<f64>(), b.parse::<f64>()) {
            (Ok(a), Ok(b)) => (a - b).abs() <= 5e-3 * a.abs().max(1.0),
            _ => a == b,
        })
}

/// Normals at corners go with a smooth mesh, out and back, turned as normals are where the body is stretched; a file without any is
/// flat, which is told.
#[test]
fn normals_come_back() {
    let folder = Folder::new();
    let path = |name: &str| folder.0.path().join(name);
    let obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 3 4\nf 1//1 2//1 3//1\n";
    folder.file("part.obj", obj);
    let scene = |normals: &str| {
        format!(
            "{CAMERA}{LAMP}[[objects]]\nshape = {{ mesh = {{ file = \"part.obj\"{normals} }} }}\nsurface = {{ lambertian = {{ reflectance = 0.5 }} }}\n"
        )
    };
    let (smooth, _) = exported(&folder, "smooth", &scene(", normals = \"smooth\""));
    assert!(smooth.contains("<boolean name=\"face_normals\" value=\"false\"/>"), "{smooth}");
    let (flat, _) = exported(&folder, "flat", &scene(""));
    assert!(flat.contains("<boolean name=\"face_normals\" value=\"true\"/>"), "{flat}");
    runs(&["import", text(&path("smooth.xml")), "-o", text(&path("back.toml"))]);
    assert!(std::fs::read_to_string(path("back.toml")).unwrap().contains("smooth"));
    let xml = |file: &str, more: &str| {
        scene_of(&format!(
            "<shape type=\"obj\"><string name=\"filename\" value=\"{file}\"/>{more}</shape>{EMITTER}"
        ))
    };
    let stretched = "<transform name=\"to_world\"><scale x=\"1\" y=\"1\" z=\"2\"/></transform>";
    let file = folder.file("stretched.xml", &xml("part.obj", stretched));
    runs(&["import", text(&file), "-o", text(&path("stretched.toml"))]);
    let files = std::fs::read_dir(folder.0.path()).unwrap().map(|entry| entry.unwrap().path());
    let ply = files.into_iter().find(|p| {
        let name = p.file_name().unwrap().to_str().unwrap();
        name.starts_with("stretched") && name.ends_with(".ply")
    });
    let bytes = std::fs::read(ply.unwrap()).unwrap();
    let start = bytes.windows(11).position(|w| w == b"end_header\n").unwrap() + 11;
    let number = |i: usize| f64::from_le_bytes(bytes[start + 8 * i..][..8].try_into().unwrap());
    // (0, 3, 4) by the inverse of the scales is (0, 3, 2).
    let length = 13f64.sqrt();
    assert!((number(4) - 3.0 / length).abs() < 1e-15 && (number(5) - 2.0 / length).abs() < 1e-15);
    folder.file("plain.obj", &obj.replace("//1", ""));
    let file = folder.file("plain.xml", &xml("plain.obj", ""));
    let notes = runs(&["import", text(&file), "-o", text(&path("plain.toml"))]);
    assert!(notes.contains("Mitsuba makes normals of its own"), "{notes}");
    assert!(!std::fs::read_to_string(path("plain.toml")).unwrap().contains("smooth"));
}

/// Every number of a scene without walls comes back to the last bit.
#[test]
fn numbers_come_back() {
    let folder = Folder::new();
    let scene = format!(
        "{CAMERA}[[regions]]\nshape = {{ cuboid = {{ min = [-1, -1, -1], max = [1, 1, 1] }} }}\nsigma_t = [0.3, 0.7, 1.1]\nalbedo = [0.9, 0.8, 0.7]\nphase = {{ two-term = {{ g1 = 0.75, g2 = -0.25, share = 0.75 }} }}
        [[regions]]\nshape = {{ sphere = {{ center = [0.1, 0.2, 0.3], radius = 0.35 }} }}\nsigma_t = 3.0\nalbedo = 0.45\nphase = {{ rayleigh = {{}} }}
        [[objects]]\nshape = {{ rectangle = {{ corner = [-2.5, -1.5, 2.5], u = [5, 0, 0], v = [0, 0, -5] }} }}\nsurface = {{ mirror = {{ reflectance = 0.85 }} }}
        [[objects]]\nshape = {{ rectangle = {{ corner = [-2.5, 2.5, 2.5], u = [5, 0, 0], v = [0, 0, -5] }} }}\nsurface = {{ filter = {{ transmittance = 0.25 }} }}
        [[lights]]\narea = {{ shape = {{ sphere = {{ center = [0, 4, 0], radius = 0.3 }} }}, radiance = [1.7, 1.3, 0.9] }}\n"
    );
    let (_, notes) = exported(&folder, "out", &scene);
    assert_eq!(notes, "");
    let path = |name: &str| folder.0.path().join(name);
    assert_eq!(runs(&["import", text(&path("out.xml")), "-o", text(&path("back.toml"))]), "");
    let value = |name: &str| toml_words(&std::fs::read_to_string(path(name)).unwrap());
    let (given, back) = (value("out.toml"), value("back.toml"));
    let lost: Vec<&String> = given.iter().filter(|number| !back.contains(number)).collect();
    assert!(lost.is_empty(), "{lost:?} of {given:?} in {back:?}");
    // The scene is also read without a file between.
    let checked = |name: &str| turbid(&["check", text(&path(name))]).output().unwrap().stdout;
    assert!(!checked("out.toml").is_empty());
    assert_eq!(checked("out.xml"), checked("out.toml"));
}

/// The numbers of a TOML text, as they read.
fn toml_words(text: &str) -> Vec<String> {
    let words = text.split([' ', ',', '[', ']', '=', '{', '}', '\n']);
    words.filter_map(|word| word.parse::<f64>().ok()).map(|x| format!("{x:?}")).collect()
}

#[test]
fn what_mitsuba_cannot_say_is_refused_by_name() {
    let folder = Folder::new();
    let fog = |shape: &str, more: &str| {
        format!("[[regions]]\nshape = {shape}\nsigma_t = 1\nalbedo = 0.5\ng = 0\n{more}\n")
    };
    let ball = "{ sphere = { center = [0, 0, 0], radius = 1 } }";
    let cases: [(String, &[&str]); 14] = [
        (fog(ball, LAMP), &["no camera"]),
        (
            format!(
                "cell = 1.0\n{CAMERA}{}[[lights]]\nbeam = {{ dir = [0, 0, 1], irradiance = 1, section = \"unbounded\" }}\n",
                fog("{ slab = { top = 0, thickness = 1 } }", "")
            ),
            &["cell"],
        ),
        (
            format!("{CAMERA}{}{LAMP}", fog("{ slab = { top = 5, thickness = 1 } }", "")),
            &["regions[0]", "slab"],
        ),
        (format!("{CAMERA}{}{LAMP}", fog(ball, "emission = 1")), &["region-0", "emission"]),
        (
            format!(
                "{CAMERA}{}{LAMP}",
                fog(ball, "density = { height-fog = { base = 0, scale_height = 1, up = [0, 1, 0] } }")
            ),
            &["region-0", "height fog"],
        ),
        (
            format!(
                "{CAMERA}{}{LAMP}",
                fog(ball, "density = { cloud = { center = [0, 0, 0], radii = [1, 1, 1] } }")
            ),
            &["region-0", "cloud"],
        ),
        (
            format!(
                "{CAMERA}{}{LAMP}",
                fog(ball, "density = { layers = { axis = \"x\", edges = [-1, 0, 2], density = [1, 2] } }")
            ),
            &["region-0", "blocks of different widths"],
        ),
        (
            format!(
                "{CAMERA}{}{}{LAMP}",
                fog(ball, ""),
                fog("{ sphere = { center = [1, 0, 0], radius = 1 } }", "")
            ),
            &["regions[0] and regions[1]", "touch or cross"],
        ),
        (
            format!(
                "{CAMERA}{}[[lights]]\nspot = {{ position = [0, 3, 0], dir = [0, -1, 0], full_angle = 20, edge_angle = 30, power = 1 }}\n",
                fog(ball, "")
            ),
            &["lights[0]", "full_angle is 20"],
        ),
        (
            format!(
                "{CAMERA}{}[[lights]]\nsun = {{ dir = [0, -1, 0], irradiance = 1, angular_radius = 0.27 }}\n",
                fog(ball, "")
            ),
            &["lights[0]", "angular_radius"],
        ),
        (
            format!(
                "{CAMERA}{}[[lights]]\nvolume-source = {{ shape = {ball}, density = 1 }}\n",
                fog(ball, "")
            ),
            &["lights[0]", "volume-source"],
        ),
        (
            format!(
                "{CAMERA}{}[[lights]]\nisotropic = {{ shape = {ball}, faces = \"both\", radiance = 1 }}\n",
                fog(ball, "")
            ),
            &["isotropic", "about the camera"],
        ),
        (
            format!(
                "{CAMERA}{LAMP}[[objects]]\nshape = {ball}\nsurface = {{ filter = {{ transmittance = [1, 0.5, 0.5] }} }}\n"
            ),
            &["objects[0]", "transmittance"],
        ),
        (
            format!(
                "{CAMERA}{LAMP}[[objects]]\nshape = {ball}\nsurface = {{ lambertian = {{ reflectance = {{ checker = {{ values = [0, 1], tiles = [2, 2] }} }} }} }}\n"
            ),
            &["objects[0]", "reflectance varies"],
        ),
    ];
    let xml = folder.0.path().join("refused.xml");
    for (scene, words) in cases {
        let file = folder.file("refused.toml", &scene);
        refuses_naming(&["export", text(&file), "--mitsuba", text(&xml)], words);
        assert!(!xml.exists());
    }
    let file = folder
        .file("small.toml", &format!("{}{LAMP}", CAMERA.replace("4.0]", "0.01]").replace("0.5, ", "0.0, ")));
    refuses_naming(&["export", text(&file), "--mitsuba", "x.json"], &["--mitsuba", ".xml"]);
}

fn scene_of(inside: &str) -> String {
    format!("<scene version=\"3.0.0\">\n{inside}\n</scene>\n")
}

const EMITTER: &str = "<emitter type=\"point\"><point name=\"position\" x=\"0\" y=\"5\" z=\"0\"/></emitter>";

fn imports(folder: &Folder, name: &str, inside: &str, more: &[&str]) -> (String, String) {
    let (xml, toml) = (
        folder.file(&format!("{name}.xml"), &scene_of(inside)),
        folder.0.path().join(format!("{name}.toml")),
    );
    let arguments = [&["import", text(&xml), "-o", text(&toml)], more].concat();
    let notes = runs(&arguments);
    (std::fs::read_to_string(toml).unwrap(), notes)
}

/// Transforms in their order, parameters, includes, references, indices over that of air, colours of spectra.
#[test]
fn files_of_mitsuba_are_read() {
    let folder = Folder::new();
    folder.file(
        "lights.xml",
        &scene_of("<emitter type=\"point\"><spectrum name=\"intensity\" value=\"$bright\"/></emitter>"),
    );
    let (toml, notes) = imports(
        &folder,
        "all",
        "<default name=\"bright\" value=\"1\"/><default name=\"r\" value=\"9\"/>
         <include filename=\"lights.xml\"/>
         <integrator type=\"path\"><integer name=\"max_depth\" value=\"7\"/>
           <boolean name=\"hide_emitters\" value=\"true\"/></integrator>
         <shape type=\"rectangle\"><transform name=\"to_world\"><scale x=\"2\" y=\"3\"/><rotate x=\"1\" angle=\"-90\"/><translate y=\"-1\"/></transform>
           <ref id=\"paint\"/></shape>
         <bsdf type=\"diffuse\" id=\"paint\"><rgb name=\"reflectance\" value=\"0.1 0.2 0.3\"/></bsdf>
         <shape type=\"sphere\"><float name=\"radius\" value=\"$r\"/><transform name=\"to_world\"><scale value=\"0.5\"/><translate value=\"0 20 0\"/></transform>
           <bsdf type=\"dielectric\"/></shape>
         <sensor type=\"perspective\"><float name=\"fov\" value=\"90\"/><string name=\"fov_axis\" value=\"y\"/>
           <transform name=\"to_world\"><lookat origin=\"0, 3, 0\" target=\"0, 0, 0\" up=\"0, 0, 1\"/></transform>
           <film type=\"hdrfilm\"><integer name=\"width\" value=\"20\"/><integer name=\"height\" value=\"10\"/></film></sensor>",
        &["-D", "r=2"],
    );
    let numbers = toml_words(&toml);
    let has = |x: f64| numbers.iter().any(|word| (word.parse::<f64>().unwrap() - x).abs() < 1e-5);
    // Intensity 1 of all wavelengths, times 4 pi; index of glass over that of air; twice the tangent; a radius of 2/2.
    for x in [1.204_794 * 12.566_371, 1.5046 / 1.000277, 126.869_9, 1.0, 20.0, 0.3] {
        assert!(has(x), "{x} in {toml}");
    }
    let plain = |array: &str| toml.contains(array);
    assert!(
        plain("corner = [-2.0, -1.0, 3.0]") && plain("u = [4.0, 0.0, 0.0]") && plain("v = [0.0, 0.0, -6.0]"),
        "{toml}"
    );
    for word in [
        "max_depth is left out",
        "hide_emitters is left out",
        "the integrator `path` is left out",
        "filter `gaussian` is read as box",
        "1 diffuse surfaces without twosided",
    ] {
        assert!(notes.contains(word), "{word}: {notes}");
    }
}

/// A grid that ends within its cube is a cuboid of its own; one medium in two pairs of words is one.
#[test]
fn media_of_mitsuba_are_read() {
    let folder = Folder::new();
    std::fs::write(folder.0.path().join("fog.vol"), crate::media::vol([1.0, 3.0])).unwrap();
    let cube = |medium: &str| {
        format!(
            "<shape type=\"cube\"><transform name=\"to_world\"><scale value=\"2\"/></transform><bsdf type=\"null\"/>{medium}</shape>{EMITTER}"
        )
    };
    let grid = "<medium name=\"interior\" type=\"heterogeneous\"><float name=\"scale\" value=\"0.25\"/><volume name=\"sigma_t\" type=\"gridvolume\"><string name=\"filename\" value=\"fog.vol\"/><transform name=\"to_world\"><translate x=\"-0.5\"/></transform></volume><rgb name=\"albedo\" value=\"0.5\"/></medium>";
    let (toml, _) = imports(&folder, "grid", &cube(grid), &[]);
    assert!(
        toml.contains("min = [-0.5, 0.0, 0.0]")
            && toml.contains("max = [0.5, 1.0, 1.0]")
            && toml.contains("sigma_t = 0.25"),
        "{toml}"
    );
    assert!(!toml.contains("-2.0"), "{toml}");
    let medium = |pair: &str| {
        format!(
            "<medium name=\"interior\" type=\"homogeneous\"><float name=\"scale\" value=\"2\"/>{pair}<phase type=\"hg\"><float name=\"g\" value=\"0.5\"/></phase></medium>"
        )
    };
    let (a, _) = imports(
        &folder,
        "a",
        &cube(&medium("<float name=\"sigma_t\" value=\"0.5\"/><float name=\"albedo\" value=\"0.25\"/>")),
        &[],
    );
    let (b, _) = imports(
        &folder,
        "b",
        &cube(&medium("<float name=\"sigma_a\" value=\"0.375\"/><float name=\"sigma_s\" value=\"0.125\"/>")),
        &[],
    );
    assert_eq!(a, b);
    assert!(a.contains("sigma_t = 1.0\nalbedo = 0.25\ng = 0.5"), "{a}");
    let table = medium("<float name=\"sigma_t\" value=\"0.5\"/>").replace(
        "<phase type=\"hg\"><float name=\"g\" value=\"0.5\"/></phase>",
        "<phase type=\"tabphase\"><string name=\"values\" value=\"0, 1, 4\"/></phase>",
    );
    let (toml, _) = imports(&folder, "table", &cube(&table), &[]);
    assert!(toml.contains("file = \"table-phase-0.txt\""), "{toml}");
    let rows = std::fs::read_to_string(folder.0.path().join("table-phase-0.txt")).unwrap();
    assert!(rows.ends_with("-1.0 0e0\n0.0 1e0\n1.0 4e0\n"), "{rows}");
}

/// What is no scene, what is not imported, and what is meant to do harm: refused in one line, with its line, and nothing written.
#[test]
fn what_is_not_imported_is_refused_by_line() {
    let folder = Folder::new();
    folder.file("loop.xml", &scene_of("<include filename=\"loop.xml\"/>"));
    let deep = |n: usize| format!("{}{}", "<bsdf type=\"twosided\">".repeat(n), "</bsdf>".repeat(n));
    let sphere = |inside: &str| format!("<shape type=\"sphere\">{inside}</shape>{EMITTER}");
    let cases: Vec<(String, Vec<&str>)> = vec![
        ("<scene".into(), vec!["bad.xml:1:"]),
        ("<shape version=\"3.0.0\" type=\"cube\"/>".into(), vec!["bad.xml:1", "allowed: <scene>"]),
        ("<scene version=\"0.6.0\"/>".into(), vec!["version is `0.6.0`"]),
        (
            "<!DOCTYPE x [<!ENTITY a \"aaaa\"><!ENTITY b \"&a;&a;&a;\">]><scene version=\"3.0.0\">&b;</scene>".into(),
            vec!["DTD", "allowed: none"],
        ),
        (scene_of("\n<include filename=\"loop.xml\"/>"), vec!["bad.xml:3", "loop.xml", "includes itself"]),
        (scene_of("<include filename=\"absent.xml\"/>"), vec!["bad.xml:2", "absent.xml", "cannot be read"]),
        (scene_of("<float name=\"x\" value=\"$y\"/>"), vec!["bad.xml:2", "`$y` has no value"]),
        (scene_of("<alias id=\"a\" as=\"b\"/>"), vec!["bad.xml:2", "<alias>"]),
        (scene_of("hello"), vec!["bad.xml:1", "text `hello`"]),
        (scene_of("\n\n<emitter type=\"envmap\"/>"), vec!["bad.xml:4", "envmap", "allowed: point"]),
        (scene_of("<shape type=\"cylinder\"/>"), vec!["bad.xml:2", "cylinder", "allowed: rectangle"]),
        (scene_of(&sphere("<bsdf type=\"roughconductor\"/>")), vec!["bad.xml:2", "roughconductor", "allowed: diffuse"]),
        (scene_of(&sphere("<float name=\"radios\" value=\"1\"/>")), vec!["bad.xml:2", "radios", "not imported"]),
        (scene_of(&sphere("<float name=\"radius\" value=\"nan\"/>")), vec!["bad.xml:2", "`nan` is not a finite number"]),
        (scene_of(&sphere("<float name=\"radius\" value=\"1\"/><float name=\"radius\" value=\"2\"/>")), vec!["`radius` twice"]),
        (scene_of(&sphere("<float name=\"radius\" value=\"-1\"/>")), vec!["bad.xml:2", "radius"]),
        (scene_of(&sphere("<ref id=\"nothing\"/>")), vec!["bad.xml:2", "no element has this id"]),
        (scene_of(&sphere("<transform name=\"to_world\"><scale x=\"2\"/></transform>")), vec!["bad.xml:2", "skewed"]),
        (scene_of(&sphere("<transform name=\"to_world\"><scale x=\"-1\"/></transform>")), vec!["bad.xml:2", "mirrors"]),
        (scene_of(&sphere("<transform name=\"to_world\"><matrix value=\"1 2 3\"/></transform>")), vec!["bad.xml:2", "<matrix>"]),
        (scene_of(&sphere("<bsdf type=\"diffuse\"><rgb name=\"reflectance\" value=\"2\"/></bsdf>")), vec!["bad.xml:2", "reflectance is 2"]),
        (scene_of(&sphere("<bsdf type=\"diffuse\"><rgb name=\"reflectance\" value=\"#ffffff\"/></bsdf>")), vec!["`#ffffff`"]),
        (scene_of(&sphere("<bsdf type=\"dielectric\"><string name=\"int_ior\" value=\"jelly\"/></bsdf>")), vec!["`jelly`", "water"]),
        (scene_of(&sphere(&deep(20))), vec!["bad.xml:2", "scattering functions in each other"]),
        (scene_of(&deep(40)), vec!["bad.xml:2", "elements in each other"]),
        (
            scene_of(&sphere("<bsdf type=\"null\"/><medium name=\"interior\" type=\"homogeneous\"><phase type=\"sggx\"/></medium>")),
            vec!["bad.xml:2", "sggx", "allowed: isotropic"],
        ),
        (
            scene_of(&format!("<medium type=\"homogeneous\" id=\"a\"/>{}", sphere("<bsdf type=\"null\"/><ref name=\"exterior\" id=\"a\"/>"))),
            vec!["bad.xml:2", "its exterior is medium `a`, but it lies in no medium"],
        ),
        (
            scene_of(&format!(
                "<medium type=\"homogeneous\" id=\"a\"/>{}<sensor type=\"perspective\"><float name=\"fov\" value=\"9\"/></sensor>",
                sphere("<bsdf type=\"null\"/><ref name=\"interior\" id=\"a\"/>")
            )),
            vec!["bad.xml:2", "the sensor lies in medium `a`, but names no medium"],
        ),
        (
            scene_of("<emitter type=\"spot\"><float name=\"cutoff_angle\" value=\"30\"/></emitter>"),
            vec!["bad.xml:2", "beam_width is 22.5"],
        ),
        (scene_of("<shape type=\"ply\"><string name=\"filename\" value=\"gone.ply\"/></shape>"), vec!["bad.xml:2", "gone.ply"]),
    ];
    let toml = folder.0.path().join("bad.toml");
    for (xml, words) in cases {
        let file = folder.file("bad.xml", &xml);
        refuses_naming(&["import", text(&file), "-o", text(&toml)], &words);
        assert!(!toml.exists(), "{xml}");
    }
    let nested: PathBuf =
        folder.file("bad.xml", &format!("{}{}", "<a>".repeat(200_000), "</a>".repeat(200_000)));
    refuses_naming(&["import", text(&nested), "-o", text(&toml)], &["bad.xml"]);
    let outside = folder.file("bad.xml", &scene_of("<include filename=\"/etc/passwd\"/>"));
    refuses_naming(
        &["import", text(&outside), "-o", text(&toml), "--confined"],
        &["bad.xml:2", "outside of the scene's folder"],
    );
    refuses_naming(&["check", text(&outside), "--confined"], &["bad.xml:2", "outside of the scene's folder"]);
    refuses_naming(&["import", text(&outside), "-o", "x.txt"], &["--output", ".toml"]);
    refuses_naming(&["import", text(&outside), "-o", text(&toml), "-D", "x"], &["-D x", "NAME=VALUE"]);
    let unused = folder.file("unused.xml", &scene_of("<default name=\"spp\" value=\"4\"/>"));
    let words = ["import", text(&unused), "-o", text(&toml), "-D", "spq=3"];
    refuses_naming(&words, &["-D spq=3", "nothing names this parameter", "$spp"]);
}

/// Files that include others twice, each of which does the same, end by their number of bytes or their depth.
#[test]
fn includes_do_not_multiply_without_end() {
    let folder = Folder::new();
    let padding = format!("<!-- {} -->", "x".repeat(1 << 16));
    for i in 0..14 {
        let twice = format!("<include filename=\"{0}.xml\"/><include filename=\"{0}.xml\"/>{padding}", i + 1);
        folder.file(&format!("{i}.xml"), &scene_of(&twice));
    }
    folder.file("14.xml", &scene_of(&padding));
    let (file, toml) = (folder.0.path().join("0.xml"), folder.0.path().join("x.toml"));
    refuses_naming(&["import", text(&file), "-o", text(&toml)], &["more than 134217728 bytes"]);
}
