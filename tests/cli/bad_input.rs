//! Everything a user can get wrong, and what the one line says about it: what, where, and what is allowed.

use crate::{Folder, refuses, refuses_naming, succeeds, text};

/// A scene file, whole and right: the built-in slab as it resolves.
fn slab() -> String {
    succeeds(&["scenes", "slab", "--resolved"])
}

#[test]
fn scenes_that_are_not_there() {
    refuses_naming(&["measure", "slap", "--with", "path"], &["`slap`", "slab, sphere, shaft, fogbox"]);
    refuses_naming(&["check", "missing.toml"], &["missing.toml", "No such file"]);
    refuses_naming(&["scenes", "slap"], &["`slap`", "allowed: slab"]);
    refuses_naming(&["check", "."], &["."]);
}

#[test]
fn scene_files_that_cannot_be_read() {
    let folder = Folder::new();
    let file = |name: &str, content: &str| folder.file(name, content);
    let broken = file("syntax.toml", "cell = 4.0\nregions = [\n");
    refuses_naming(&["check", text(&broken)], &["syntax.toml:2:", "array"]);
    let empty = file("empty.toml", "");
    refuses_naming(&["check", text(&empty)], &["empty.toml: a scene needs at least one light"]);
    let bytes = folder.0.path().join("bytes.toml");
    std::fs::write(&bytes, [0xff, 0xfe, 0x00]).unwrap();
    refuses_naming(&["check", text(&bytes)], &["cannot read", "bytes.toml", "UTF-8"]);
}

/// A number or name of the slab's file replaced by another: the refusal names line, column and key.
#[test]
fn wrong_values_in_a_file() {
    let folder = Folder::new();
    let right = slab();
    let cases = [
        ("albedo = 0.9", "albedo = 1.5", "albedo is 1.5; allowed: 0 to 1"),
        ("albedo = 0.9", "albedo = nan", "albedo is NaN; allowed: 0 to 1"),
        ("albedo = 0.9", "albedo = inf", "albedo is inf; allowed: 0 to 1"),
        ("albedo = 0.9", "albedo = [0.5, 2, 0.5]", "albedo is 2; allowed: 0 to 1"),
        ("sigma_t = 1.0", "sigma_t = -1.0", "sigma_t is -1; allowed: finite and at least 0"),
        ("sigma_t = 1.0", "sigma_t = nan", "sigma_t is NaN"),
        ("g = 0.0", "g = 1.0", "g is 1; allowed: above -1 and below 1"),
        ("thickness = 2.0", "thickness = -2.0", "thickness is -2; allowed: finite and above 0"),
        ("cell = 4.0", "cell = 0.0", "cell is 0; allowed: finite and above 0"),
        ("irradiance = 1.0", "irradiance = -1", "irradiance is -1; allowed: finite and at least 0"),
        ("albedo = 0.9", "albdo = 0.9", "unknown key `albdo`; nearest: `albedo`"),
        ("face = \"top\"", "face = \"topp\"", "unknown value `topp`; nearest: `top`; allowed: top, bottom"),
        ("albedo = 0.9", "albedo = \"white\"", "albedo"),
    ];
    for (i, (from, to, words)) in cases.into_iter().enumerate() {
        assert!(right.contains(from), "{from}");
        let wrong = right.replacen(from, to, 1);
        let line = 1 + wrong[..wrong.find(to).unwrap()].matches('\n').count();
        let name = format!("case{i}.toml");
        let path = folder.file(&name, &wrong);
        refuses_naming(&["check", text(&path)], &[&format!("{name}:{line}:"), words]);
    }
}

/// Files whose parts are each right, but not together.
#[test]
fn parts_that_do_not_fit_together() {
    let folder = Folder::new();
    let right = slab();
    let cases = [
        ("nocell.toml", right.replacen("cell = 4.0\n", "", 1), "`cell`"),
        (
            "dark.toml",
            right.replacen("irradiance = 1.0", "irradiance = 0.0", 1),
            "irradiance is 0; allowed: above 0",
        ),
        (
            "along.toml",
            right.replacen("dir = [0.0, 0.0, 1.0]", "dir = [1.0, 0.0, 0.0]", 1),
            "along the faces",
        ),
        ("nowhere.toml", right.replacen("dir = [0.0, 0.0, 1.0]", "dir = [0.0, 0.0, 0.0]", 1), "direction"),
        ("far.toml", right.replacen("at = [2.0, 2.0, 0.2]", "at = [nan, 2.0, 0.2]", 1), "not finite"),
        ("region.toml", right.replacen("region = 0", "region = 3", 1), "region 3; allowed: 0 to 0"),
    ];
    for (name, content, words) in cases {
        assert_ne!(content, right, "{name}");
        let path = folder.file(name, &content);
        refuses_naming(&["check", text(&path)], &[name, words]);
    }
    let none = folder.file("none.toml", &right[..right.find("[[sensors]]").unwrap()]);
    refuses_naming(&["measure", text(&none), "--with", "paths"], &["no sensors"]);
}

#[test]
fn commands_that_are_none() {
    refuses_naming(&["foo"], &["'foo'", "allowed: ", "render, ", "measure, "]);
}

#[test]
fn wrong_sets() {
    let cases = [
        ("albedo=1.5", "albedo is 1.5; allowed: 0 to 1"),
        ("albedo=nan", "albedo is NaN; allowed: 0 to 1"),
        ("albedo=inf", "albedo is inf; allowed: 0 to 1"),
        ("tau=-1", "tau is -1; allowed: finite and above 0"),
        ("tau=0", "tau is 0; allowed: finite and above 0"),
        ("tau=nan", "tau is NaN"),
        ("tau=inf", "tau is inf"),
        ("tau=NaN", "tau is string \"NaN\"; allowed: a number"),
        ("tau=[1]", "tau is a list; allowed: a number"),
        ("g=1", "g is 1; allowed: above -1 and below 1"),
        ("g=-1", "g is -1"),
        ("mu0=0", "mu0 is 0; allowed: above 0 and at most 1, or \"diffuse\""),
        ("mu0=1.1", "mu0 is 1.1"),
        ("mu0=nan", "mu0 is NaN"),
        ("mu0=sideways", "mu0 is \"sideways\""),
        ("scale=0", "scale is 0"),
        ("probes=[-1]", "probes is -1; allowed: finite and at least 0"),
        ("probes=0.5", "probes"),
        ("albdo=0.5", "unknown key `albdo`; nearest: `albedo`"),
        ("albedo", "allowed: KEY=VALUE"),
        ("=1", "unknown key"),
        ("tau=1e-300=2", "tau"),
    ];
    for (set, words) in cases {
        refuses_naming(&["check", "slab", "--set", set], &[&format!("--set {set}"), words]);
    }
    refuses_naming(
        &["check", "sphere", "--set", "source=sun"],
        &["`sun`", "allowed: volume, point, incidence"],
    );
    refuses_naming(&["check", "shaft", "--set", "depth=9"], &["depth is 9; allowed: at most tau"]);
    let folder = Folder::new();
    let file = folder.file("slab.toml", &slab());
    let cases = [
        ("regions.7.albedo=0.5", "`7` is no entry of a list of 1"),
        ("regionss.0.albedo=0.5", "nearest: `regions`"),
        ("regions.0.albdo=0.5", "nearest: `albedo`"),
        ("regions.0.albedo=2", "albedo is 2; allowed: 0 to 1"),
        ("cell.side=2", "has no parts"),
        ("regions.0=1", "is integer `1`; allowed: a table"),
    ];
    for (set, words) in cases {
        refuses_naming(&["check", text(&file), "--set", set], &[&format!("--set {set}"), words]);
    }
}

#[test]
fn wrong_options() {
    let cases: [(&[&str], &[&str]); 26] = [
        (&["--k", "1"], &["--k", "k is 1; allowed: at least 2"]),
        (&["--k", "0"], &["--k", "allowed: at least 2"]),
        (&["--k", "many"], &["--k", "many"]),
        (&["--radius", "0"], &["--radius", "is 0; allowed: finite and above 0"]),
        (&["--radius", "-1"], &["--radius", "is -1; allowed: finite and above 0"]),
        (&["--radius", "nan"], &["--radius", "is NaN"]),
        (&["--radius", "inf"], &["--radius", "is inf"]),
        (&["--radius", "100"], &["100 L", "periodic cell", "allowed: at most its shorter side, 4 L"]),
        (&["--max-radius", "0"], &["--max-radius", "is 0; allowed: finite and above 0"]),
        (&["--k", "5", "--radius", "1"], &["--k", "--radius", "cannot be used with"]),
        (&["--radius", "1", "--max-radius", "1"], &["--radius", "--max-radius", "cannot be used with"]),
        (&["--photons", "0"], &["--photons", "allowed: whole numbers from 1"]),
        (&["--photons", "1.5"], &["--photons", "allowed: whole numbers from 1"]),
        (&["--photons", "1e99"], &["--photons", "allowed: whole numbers from 1"]),
        (&["--samples", "-5"], &["--samples", "allowed: whole numbers from 1"]),
        (&["--maps", "0"], &["--maps", "allowed: whole numbers from 1"]),
        (&["--format", "xml"], &["--format", "allowed: table, csv, json"]),
        (&["--kernel", "box"], &["--kernel", "allowed: uniform"]),
        (&["--orders", "3..1"], &["--orders", "allowed: an order such as 1"]),
        (&["--orders", "-1"], &["--orders", "allowed: an order such as 1"]),
        (&["--threads", "0"], &["--threads", "allowed: whole numbers from 1 to 1024"]),
        (&["--photons", "3"], &["--photons is 3; allowed: at least one for each of the 16 maps"]),
        (&["--seed", "-1"], &["--seed"]),
        (&["--radios", "1"], &["--radios", "--radius"]),
        (&["extra"], &["extra"]),
        (&["--with", "beams"], &["--with"]),
    ];
    for (options, words) in cases {
        let arguments: Vec<&str> =
            ["measure", "slab", "--with", "photons"].iter().chain(options).copied().collect();
        refuses_naming(&arguments, words);
    }
    refuses_naming(
        &["measure", "slab", "--with", "beams"],
        &["--with", "allowed: paths, bidirectional, photons, light"],
    );
    refuses_naming(&["measure", "slab"], &["--with"]);
    refuses_naming(&["measure"], &["SCENE"]);
    refuses_naming(&["render", "slab"], &["--output"]);
    refuses_naming(&[], &["allowed: measure, advise, render, map, check, scenes"]);
    assert!(refuses(&["scenes", "--resolved"]).contains("NAME"));
}

/// Lights that cannot be: each refusal names the light and the key.
#[test]
fn lights_that_cannot_be() {
    let folder = Folder::new();
    let ball = "[[regions]]\nshape = { sphere = { center = [0, 0, 0], radius = 1 } }\nsigma_t = 1\nalbedo = 0.5\ng = 0\n";
    let spot = |angles: &str, power: &str| {
        format!("spot = {{ position = [0, 0, 3], dir = [0, 0, -1], {angles}, power = {power} }}")
    };
    let cases = [
        (
            spot("full_angle = 20, edge_angle = 10", "1"),
            "lights[0].full_angle is 20; allowed: 0 to edge_angle",
        ),
        (spot("full_angle = 0, edge_angle = 200", "1"), "lights[0].edge_angle is 200; allowed: 1e-6 to 180"),
        (
            spot("full_angle = 0, edge_angle = 1e-7", "1"),
            "lights[0].edge_angle is 1e-7; allowed: 1e-6 to 180",
        ),
        (spot("full_angle = 0, edge_angle = 10", "0"), "lights[0].power is 0; allowed: above 0"),
        ("sun = { dir = [0, 0, 0], irradiance = 1, angular_radius = 1 }".into(), "lights[0]: a sun needs"),
        (
            "sun = { dir = [0, 0, 1], irradiance = 1, angular_radius = 90 }".into(),
            "lights[0].angular_radius is 90; allowed: 0, or 1e-6 to 45 degrees",
        ),
        // Its solid angle is not a number.
        (
            "sun = { dir = [0, 0, 1], irradiance = 1, angular_radius = 1e-160 }".into(),
            "allowed: 0, or 1e-6 to 45",
        ),
        ("sun = { dir = [0, 0, 1], irradiance = 0, angular_radius = 1 }".into(), "lights[0].irradiance is 0"),
        (
            "area = { shape = { sphere = { center = [0, 0, 2], radius = 0.5 } }, radiance = [0, 0, 0] }"
                .into(),
            "lights[0].radiance is 0; allowed: above 0 in at least one channel",
        ),
        (
            "area = { shape = { slab = { top = 2, thickness = 1 } }, radiance = 1 }".into(),
            "lights[0]: an area light needs a bounded shape",
        ),
        ("area = { corner = [0, 0, 0], u = [1, 0, 0], v = [0, 1, 0], radiance = 1 }".into(), "corner"),
    ];
    for (index, (light, words)) in cases.into_iter().enumerate() {
        let file = folder.file(&format!("light{index}.toml"), &format!("{ball}[[lights]]\n{light}\n"));
        refuses_naming(&["check", text(&file)], &[words]);
    }
    let sky = "[[lights]]\nsun = { dir = [0, 0, 1], irradiance = 1, angular_radius = 1 }\n";
    let file = folder.file("sky.toml", sky);
    refuses_naming(&["check", text(&file)], &["a sun needs something to shine on"]);
}

/// A mirror turns a beam: no path from the sensor can find it, and photons without a medium leave no map.
#[test]
fn what_no_sampler_reaches() {
    let folder = Folder::new();
    let scene = "\
[[objects]]
shape = { rectangle = { corner = [-1, -1, 0], u = [2, 0, 0], v = [0, 2, 0] } }
surface = { mirror = { reflectance = 0.9 } }
[[lights]]
beam = { dir = [0, 0, -1], irradiance = 1, section = { disc = { center = [0, 0, 1], radius = 0.2 } } }
[[sensors]]
name = \"p\"
measure = { fluence = { at = [0, 0, 0.5] } }
";
    let file = folder.file("mirror.toml", scene);
    refuses_naming(&["measure", text(&file), "--with", "path"], &["path tracer", "mirrors", "use photons"]);
    refuses_naming(&["measure", text(&file), "--with", "photons"], &["sensor p", "outside", "use paths"]);
    assert!(succeeds(&["check", text(&file)]).contains("out of reach of the path tracer"));
    let outside = ["measure", "sphere", "--with", "photons", "--set", "probes=[2.0]"];
    refuses_naming(&outside, &["sensor radius 2", "(2, 0, 0) is outside", "use paths"]);
}

#[test]
fn wrong_advice() {
    let cases: [(&[&str], &[&str]); 9] = [
        (&[], &["--target"]),
        (&["--target", "0"], &["--target", "allowed: a relative error above 0, up to 100%"]),
        (&["--target", "-1%"], &["--target", "allowed"]),
        (&["--target", "101%"], &["--target", "allowed"]),
        (&["--target", "nan"], &["--target", "allowed"]),
        (&["--target", "1", "--pilot", "0"], &["--pilot", "allowed: whole numbers from 1"]),
        (&["--target", "1", "--set", "probes=[]"], &["no fluence probe inside a medium"]),
        (&["--target", "1", "--set", "probes=[0]"], &["no fluence probe inside a medium"]),
        (&["--target", "1", "--pilot", "256"], &["photons about depth", "larger pilot"]),
    ];
    for (options, words) in cases {
        let arguments: Vec<&str> = ["advise", "slab"].iter().chain(options).copied().collect();
        refuses_naming(&arguments, words);
    }
}

/// Interiors and the boundaries that name them.
#[test]
fn boundaries_in_a_file() {
    let folder = Folder::new();
    let right = "\
interiors = [{ name = \"glass\", index = 1.5 }]
[[objects]]
shape = { sphere = { center = [0, 0, 0], radius = 1.0 } }
surface = { dielectric = { inside = \"glass\" } }
[[lights]]
point = { position = [0, 0, 5], power = 1.0 }
";
    let file = folder.file("glass.toml", right);
    assert!(succeeds(&["check", text(&file)]).contains("dielectric boundaries"));
    let cases = [
        ("index = 1.5", "index = 0.9", "1:40: index is 0.9; allowed: 1 to 1000"),
        (
            "inside = \"glass\"",
            "inside = \"glas\"",
            "unknown interior `glas`; nearest: `glass`; allowed: surroundings, glass",
        ),
        ("inside = \"glass\"", "outside = \"glass\"", "inside"),
        ("dielectric = { inside = \"glass\" }", "filter = { transmittance = 0.5 }", "glass has no boundary"),
        (
            "dielectric = { inside = \"glass\" }",
            "filter = { transmittance = 1.5 }",
            "transmittance is 1.5; allowed: 0 to 1",
        ),
        ("index = 1.5", "index = 1.5, sigma_t = 1.0", "interior glass"),
    ];
    for (i, (from, to, words)) in cases.into_iter().enumerate() {
        let name = format!("glass{i}.toml");
        let path = folder.file(&name, &right.replacen(from, to, 1));
        refuses_naming(&["check", text(&path)], &[&name, words]);
    }
}

/// Radiance along a ray through a point light in a medium has no end; where the medium keeps off the light, it has.
#[test]
fn rays_through_a_point_light_in_fog() {
    let folder = Folder::new();
    let scene = |light: &str, origin: &str, dir: &str, low: f64| {
        let text = format!(
            "[[regions]]\nshape = {{ cuboid = {{ min = [-9, -9, {low}], max = [9, 9, 9] }} }}\nsigma_t = 1\nalbedo = 0.5\ng = 0\n\
             [[lights]]\n{light}\n\
             [[sensors]]\nname = \"ahead\"\nmeasure = {{ radiance = {{ origin = {origin}, dir = {dir} }} }}\n"
        );
        folder.file("fog.toml", &text)
    };
    let bulb = "point = { position = [1, 2, 3], power = 1 }";
    let spot = |dir: &str| {
        format!("spot = {{ position = [1, 2, 3], dir = {dir}, full_angle = 10, edge_angle = 20, power = 1 }}")
    };
    let infinite = [
        (bulb.to_string(), "[1, 2, 3]", "[0.3, 0.1, 0.7]", -9.0),
        (bulb.to_string(), "[0, 0, 0]", "[1, 2, 3]", -9.0),
        (spot("[0, 0, 1]"), "[1, 2, 3]", "[0.1, 0, 1]", -9.0),
        // The sensor looks into the spot, which the fog scatters forwards.
        (spot("[0, 0, -1]"), "[1, 2, 0]", "[0, 0, 1]", -9.0),
        // At the face of the fog, inwards.
        (bulb.to_string(), "[1, 2, 3]", "[0, 0, 1]", 3.0),
    ];
    for (light, origin, dir, low) in infinite {
        let file = scene(&light, origin, dir, low);
        let words =
            ["fog.toml", "sensor ahead looks through lights[0]", "the radiance is infinite", "move the ray"];
        refuses_naming(&["check", text(&file)], &words);
    }
    let finite = [
        (bulb.to_string(), "[1.001, 2, 3]", "[0.3, 0.1, 0.7]", -9.0),
        // Away from the light.
        (bulb.to_string(), "[0, 0, 0]", "[-1, -2, -3]", -9.0),
        // The fog begins behind the light.
        (bulb.to_string(), "[1, 2, 3]", "[0, 0, 1]", 3.1),
        // The spot shines to the side.
        (spot("[1, 0, 0]"), "[1, 2, 3]", "[0.1, 0, 1]", -9.0),
    ];
    for (light, origin, dir, low) in finite {
        succeeds(&["check", text(&scene(&light, origin, dir, low))]);
    }
    let camera = "[camera]\nposition = [1, 2, 3]\nlook_at = [1, 2, 9]\nfov = 40\nwidth = 8\nheight = 8\n";
    let with = |low: f64| {
        let file = scene(&spot("[0.1, 0, 1]"), "[0, 0, 0]", "[0, 0, 1]", low);
        let both = camera.to_string() + &std::fs::read_to_string(file).unwrap();
        folder.file("camera.toml", &both)
    };
    refuses_naming(&["check", text(&with(-9.0))], &["camera.toml", "the camera is at lights[0]", "infinite"]);
    succeeds(&["check", text(&with(3.5))]);
}

/// Light that starts, or is measured, on the very surface of a body is refused in one line: paths took one side of it and
/// photons the other. A millionth off it is a scene.
#[test]
fn light_and_sensors_on_a_body() {
    let folder = Folder::new();
    let fog = "[[regions]]\nshape = { sphere = { center = [0, 0, 0], radius = 2 } }\nsigma_t = 1\nalbedo = 0.5\ng = 0\n";
    let lamp = "[[lights]]\npoint = { position = [0, 0, 1], power = 1 }\n";
    let object = |shape: &str| {
        format!("[[objects]]\nshape = {{ {shape} }}\nsurface = {{ lambertian = {{ reflectance = 0.5 }} }}\n")
    };
    let (ball, floor) = (
        "sphere = { center = [0, 0, 0], radius = 2 }",
        "rectangle = { corner = [-1, -1, -0.5], u = [2, 0, 0], v = [0, 2, 0] }",
    );
    let disc = "lathe = { base = [0, 0, -0.5], axis = [0, 0, 1], profile = [[0, 0], [1, 0], [1, -0.2]] }";
    let isotropic = "[[lights]]\nisotropic = { shape = { sphere = { center = [0, 0, 0], radius = @2 } }, radiance = 1, faces = \"both\" }\n";
    let beam = "[[lights]]\nbeam = { dir = [0, 0, 1], irradiance = 1, section = { disc = { center = [0, 0, @-0.5], radius = 0.4 } } }\n";
    let square = "[[lights]]\nbeam = { dir = [0, 0, 1], irradiance = 1, section = { rectangle = { corner = [0, 0, @-0.5], u = [0.5, 0, 0], v = [0, 0.5, 0] } } }\n";
    let outflow = "[[sensors]]\nname = \"s\"\nmeasure = { outflow = { shape = { sphere = { center = [0, 0, 0], radius = @2 } }, face = \"top\" } }\n";
    for (part, body, name) in [
        (isotropic, ball, "lights[1]"),
        (beam, floor, "lights[1]"),
        (square, floor, "lights[1]"),
        (beam, disc, "lights[1]"),
        (square, disc, "lights[1]"),
        (outflow, ball, "sensor s"),
    ] {
        let on = folder.file("on.toml", &format!("{fog}{lamp}{}{}", object(body), part.replace('@', "")));
        let words = [
            "on.toml",
            name,
            " lies on the surface of objects[0], where rounding decides",
            "; move one of them",
        ];
        refuses_naming(&["check", text(&on)], &words);
        let apart = part.replace("@2", "2.00001").replace("@-0.5", "-0.49999");
        let apart = folder.file("apart.toml", &format!("{fog}{lamp}{}{apart}", object(body)));
        succeeds(&["check", text(&apart)]);
    }
}

/// Surfaces of revolution in one place: two that differ by less than rounding, and flat ends on other faces, where rays
/// went from one to the other without end (found by `fuzz`), or met one or the other.
#[test]
fn revolutions_in_one_place() {
    let folder = Folder::new();
    let clear = "surface = { filter = { transmittance = 0.5 } }";
    let diffuse = "surface = { lambertian = { reflectance = 0.5 } }";
    let lathe = |base: &str, least: &str| {
        format!(
            "shape = {{ lathe = {{ base = [0, 0, {base}], profile = [[0, 0], [0.8, {least}], [0.3, 0.6], [0, 0.7]] }} }}"
        )
    };
    let rectangle =
        "shape = { rectangle = { corner = [-1, -1, 0], u = [2, 0, 0], v = [0, 2, 0] } }".to_string();
    let aside = "shape = { rectangle = { corner = [0.9, -1, 0], u = [2, 0, 0], v = [0, 2, 0] } }".to_string();
    let within =
        "shape = { rectangle = { corner = [-0.1, -0.1, 0], u = [0.2, 0, 0], v = [0, 0.2, 0] } }".to_string();
    let ring = "shape = { lathe = { profile = [[0.5, 0], [0.8, 0]] } }".to_string();
    let block = "shape = { cuboid = { min = [-1, -1, -1], max = [1, 1, 0] } }".to_string();
    for (a, b, is_refused) in [
        (lathe("0", "0.2"), lathe("1e-160", "0.2"), true),
        (lathe("0", "0.2"), lathe("0", "0.20000000000000001"), true),
        (lathe("0", "0.2"), lathe("0", "0.2001"), false),
        (lathe("0", "0"), rectangle.clone(), true),
        (lathe("0", "0"), aside, false),
        (lathe("1e-5", "0"), rectangle.clone(), false),
        (lathe("0", "0"), block, true),
        (ring.clone(), rectangle, true),
        (ring.clone(), within, false),
        (lathe("0", "0"), ring, true),
    ] {
        let lamp = "[[lights]]\npoint = { position = [0, 0, 3], power = 1 }\n";
        let scene = format!("{lamp}[[objects]]\n{a}\n{clear}\n[[objects]]\n{b}\n{diffuse}\n");
        let file = folder.file("lathes.toml", &scene);
        if is_refused {
            let words = ["lathes.toml", "objects[0] and objects[1] have surfaces in one place"];
            refuses_naming(&["check", text(&file)], &words);
        } else {
            succeeds(&["check", text(&file)]);
        }
    }
}

/// Two lamps in one place are refused in one line that says what to do.
#[test]
fn two_lamps_in_one_place() {
    let folder = Folder::new();
    let scene = |height: &str| {
        let text = format!(
            "[[lights]]\narea = {{ shape = {{ rectangle = {{ corner = [0, 2, 0], u = [2, 0, 0], v = [0, 0, 2] }} }}, radiance = 2 }}\n\
             [[lights]]\narea = {{ shape = {{ rectangle = {{ corner = [0.5, {height}, 0.5], u = [1, 0, 0], v = [0, 0, 1] }} }}, radiance = 1 }}\n"
        );
        folder.file("lamps.toml", &text)
    };
    let words = ["lamps.toml", "lights[0] and lights[1] have surfaces in one place", "move one of them"];
    refuses_naming(&["check", text(&scene("2"))], &words);
    succeeds(&["check", text(&scene("1.999999"))]);
}
