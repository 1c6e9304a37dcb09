//! What results say of their run, what is told beside them, and what shells and manuals know of the program.

use crate::{Folder, RAYS, refuses_naming, succeeds, text, turbid};

/// The run of a table as JSON.
fn run_of(arguments: &[&str]) -> serde_json::Value {
    let output = turbid(&[arguments, &["--format", "json"]].concat()).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice::<serde_json::Value>(&output.stdout).unwrap()["run"].clone()
}

/// Of each method what it asks, and nothing of what it does not.
#[test]
fn tables_say_what_they_were_made_with() {
    let revision = succeeds(&["--version"]);
    let revision = revision.split(['(', ')']).nth(1);
    let of = |with: &str, more: serde_json::Value| {
        let mut run = serde_json::json!({
            "with": with, "seed": 3, "orders": "0..", "samples": null, "weight_windows": null, "guide": null, "photons": null, "maps": null, "radius": null, "k": null,
            "max_radius": null, "ray_radius": null, "ray_k": null, "beam_radius": null, "beam_blur": null, "beam_length": null, "beam_fluence": null, "ray_ends": null, "planes": null, "progressive": null, "kernel": null, "boundary": null, "reject": null, "version": env!("CARGO_PKG_VERSION"),
            "revision": revision,
        });
        more.as_object().unwrap().iter().for_each(|(key, value)| run[key] = value.clone());
        run
    };
    let measure = |with: &'static str| ["measure", "slab", "--seed", "3", "--with", with];
    let paths = [&measure("path")[..], &["--samples", "1200", "--orders", "0..2"]].concat();
    assert_eq!(run_of(&paths), of("paths", serde_json::json!({ "samples": 1200, "orders": "0..2" })));
    let light = [&measure("light")[..], &["--photons", "500", "--set", "probes=[]"]].concat();
    assert_eq!(run_of(&light), of("light", serde_json::json!({ "photons": 500 })));
    let nearest = serde_json::json!({
        "photons": 800, "maps": 2, "k": 50, "max_radius": 2.0, "kernel": "uniform", "boundary": "clipped", "reject": "off"
    });
    let photons = [&measure("photons")[..], &["--photons", "800", "--maps", "2"]].concat();
    assert_eq!(run_of(&photons), of("photons", nearest));
    let folder = Folder::new();
    let scene = folder.file("rays.toml", RAYS);
    let rays =
        ["measure", text(&scene), "--seed", "3", "--with", "photons", "--photons", "800", "--maps", "2"];
    let along = [&rays[..], &["--ray-radius", "0.5"]].concat();
    assert_eq!(run_of(&along)["ray_radius"], 0.5);
    refuses_naming(
        &[&photons[..], &["--ray-radius", "0"]].concat(),
        &["--ray-radius is 0; allowed: finite and above 0"],
    );
    let own = [&along[..], &["--ray-k", "20"]].concat();
    assert_eq!(run_of(&own)["ray_k"], 20);
    refuses_naming(&[&photons[..], &["--ray-k", "20"]].concat(), &["--ray-radius"]);
    refuses_naming(&[&along[..], &["--ray-k", "0"]].concat(), &["--ray-k", "from 1 to"]);
    refuses_naming(&[&own[..], &["--progressive"]].concat(), &["--ray-k", "--progressive"]);
    refuses_naming(
        &[&own[..], &["--radius", "0.5", "--passes", "2"]].concat(),
        &["--passes is 2, and --ray-k takes the k nearest photons", "allowed with it: 1"],
    );
    assert_eq!(run_of(&[&along[..], &["--ray-ends", "own"]].concat())["ray_ends"], "own");
    refuses_naming(&[&photons[..], &["--ray-ends", "own"]].concat(), &["with --ray-radius or --beam-radius"]);
    refuses_naming(&[&along[..], &["--ray-ends", "soft"]].concat(), &["--ray-ends", "cut, own"]);
    let across = [&rays[..], &["--beam-radius", "0.5"]].concat();
    let run = run_of(&across);
    assert_eq!(
        (&run["beam_radius"], &run["beam_blur"], &run["beam_length"]),
        (&0.5.into(), &"1d".into(), &"sampled".into())
    );
    assert!(run["beam_fluence"].is_null());
    let places = ["--beam-fluence", "--beam-blur", "3d", "--beam-length", "whole"];
    let run = run_of(&[&photons[..], &["--beam-radius", "0.5"], &places].concat());
    assert_eq!(
        (&run["beam_fluence"], &run["beam_blur"], &run["beam_length"]),
        (&true.into(), &"3d".into(), &"whole".into())
    );
    refuses_naming(
        &["render", "fogbox", "-o", "never.exr", "--beam-radius", "0.1", "--beam-blur", "3d"],
        &["--beam-blur is 3d, which is about places; allowed of pictures: 1d, 2d"],
    );
    let never = ["render", "fogbox", "-o", "never.exr"];
    refuses_naming(&[&never[..], &["--beam-length", "whole"]].concat(), &["--beam-radius"]);
    // What is about balls alone is refused where rays are read as a whole.
    for about in [["--beam-radius", "0.1"], ["--ray-radius", "0.1"]] {
        refuses_naming(&[&never[..], &about, &["--volume-k", "20"]].concat(), &["--volume-k"]);
        let treated = [&never[..], &about, &["--boundary", "reflection"]].concat();
        refuses_naming(&treated, &["--boundary is reflection, of balls", "none, clipped"]);
    }
    let alone = folder.file("alone.toml", RAYS.split("[[sensors]]\nname = 'inside'").next().unwrap());
    for about in [&["--beam-radius", "0.1"], &["--ray-radius", "0.1"], &["--planes", "--orders=2.."]] {
        for of_balls in [&["--k", "20"][..], &["--max-radius", "0.2"], &["--boundary", "local-linear"]] {
            let asked = ["measure", text(&alone), "--with", "photons", "--photons", "800"];
            refuses_naming(&[&asked[..], about, of_balls].concat(), &[of_balls[0], "of balls"]);
        }
    }
    // What would be ignored is refused, also where what it depends on is kept away by another flag.
    for (given, ignored) in [
        (&along, &["--beam-fluence"][..]),
        (&along, &["--beam-blur", "2d"]),
        (&along, &["--beam-length", "whole"]),
        (&across, &["--ray-k", "20"]),
    ] {
        refuses_naming(&[&given[..], ignored].concat(), &[ignored[0]]);
    }
    refuses_naming(&[&photons[..], &["--orders", "2..", "--planes", "--ray-k", "20"]].concat(), &["--ray-k"]);
    // The built-in slab has no sensor of radiance: what reads rays would do nothing.
    let slab = ["measure", "slab", "--with", "photons", "--photons", "1000"];
    for option in [&["--planes"][..], &["--ray-radius", "0.1"], &["--beam-radius", "0.1"]] {
        refuses_naming(&[&slab[..], option].concat(), &[option[0], "allowed: with sensors of radiance"]);
    }
    assert_eq!(
        run_of(&[&slab[..], &["--beam-radius", "0.1", "--beam-fluence"]].concat())["beam_fluence"],
        true
    );
    refuses_naming(
        &["render", "fogbox", "-o", "never.exr", "--beam-radius", "0.1", "--ray-k", "5"],
        &["--ray-k"],
    );
    refuses_naming(
        &[&photons[..], &["--beam-radius", "1e-170"]].concat(),
        &["--beam-radius is", "allowed: from 1e-30 to 1e30"],
    );
    refuses_naming(&[&across[..], &["--beam-blur", "4d"]].concat(), &["--beam-blur", "1d, 2d, 3d"]);
    refuses_naming(&[&photons[..], &["--beam-fluence"]].concat(), &["--beam-radius"]);
    refuses_naming(&[&photons[..], &["--beam-length", "whole"]].concat(), &["--beam-radius"]);
    refuses_naming(
        &[&across[..], &["--beam-fluence", "--progressive"]].concat(),
        &["--beam-fluence", "--progressive"],
    );
    assert_eq!(run_of(&[&across[..], &["--radius", "0.5", "--progressive"]].concat())["progressive"], true);
    refuses_naming(
        &[&photons[..], &["--beam-radius", "inf"]].concat(),
        &["--beam-radius is inf; allowed: finite and above 0"],
    );
    refuses_naming(&[&across[..], &["--ray-radius", "0.5"]].concat(), &["--beam-radius", "--ray-radius"]);
    assert_eq!(run_of(&[&across[..], &["--planes"]].concat())["planes"], true);
    refuses_naming(&[&along[..], &["--planes"]].concat(), &["--planes", "--ray-radius"]);
    refuses_naming(&[&rays[..], &["--beam-radius", "1e3"]].concat(), &["beyond the periodic cell"]);
    let npy = folder.0.path().join("a.npy");
    succeeds(&["map", "slab", "--photons", "500", "--npy", text(&npy)]);
    let read = [
        "--radius",
        "0.25",
        "--kernel",
        "cone",
        "--boundary",
        "local-linear",
        "--orders",
        "1",
        "--reject",
        "behind-plane",
    ];
    let given = [&measure("photons")[..], &["--photons-from", text(&npy)], &read].concat();
    let within = serde_json::json!({
        "orders": "1", "maps": 1, "radius": 0.25, "kernel": "cone", "boundary": "local-linear", "reject": "behind-plane"
    });
    assert_eq!(run_of(&given), of("photons-from", within));
}

/// Fluence by beams at places of a slab: uncollided light of a beam along the normal, exact at any radius, in W/L^2 for an irradiance of 1,
/// by beams of both lengths; blurred in balls it is more, by what the exponential has over a ball of this radius.
#[test]
fn fluence_of_beams_is_the_exact_one() {
    let measure =
        ["measure", "slab", "--set", "tau=1", "--set", "probes=[0.5]", "--with", "photons", "--orders", "0"];
    let many = ["--maps", "50", "--beam-radius", "0.45", "--beam-fluence", "--format", "json"];
    let radius: f64 = 0.45;
    let (up, down) = (turbid::math::exp(radius), turbid::math::exp(-radius));
    let ball = 1.5 * (radius * (up + down) - (up - down)) / (radius * radius * radius);
    for (blur, factor) in [("1d", 1.0), ("3d", ball)] {
        // Long beams have half the variance.
        for (length, photons) in [("sampled", "4e6"), ("whole", "2e6")] {
            let of = ["--beam-blur", blur, "--beam-length", length, "--photons", photons];
            let asked = [&measure[..], &many, &of].concat();
            let table: serde_json::Value = serde_json::from_str(&succeeds(&asked)).unwrap();
            let rows = table["rows"].as_array().unwrap();
            let row = rows.iter().find(|row| row["quantity"] == "fluence").unwrap();
            let [mean, error] = ["mean", "std_error"].map(|key| row[key].as_f64().unwrap());
            let exact = turbid::math::exp(-0.5) * factor;
            // Student's t of 49 freedoms exceeds 5.6 once in a million.
            assert!(
                (mean - exact).abs() < 5.6 * error && error < 0.003,
                "{blur} {length}: {mean} {error} {exact}"
            );
            assert_eq!(row["unit"], "W/L^2");
        }
    }
}

/// What a picture's header says, as JSON.
#[test]
fn pictures_say_their_settings_in_json() {
    use exr::prelude::{AttributeValue, ReadChannels, ReadLayers, Text, read};
    let folder = Folder::new();
    let exr = folder.0.path().join("a.exr");
    let header = |more: &[&str]| -> serde_json::Value {
        let render = ["render", "fogbox", "-o", text(&exr), "--width", "4", "--samples", "1"];
        let output = turbid(&[&render[..], more].concat()).output().unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let image =
            read().no_deep_data().largest_resolution_level().all_channels().all_layers().all_attributes();
        let image = image.from_file(&exr).unwrap();
        let name = Text::from(turbid::output::PROVENANCE);
        let Some(AttributeValue::Text(text)) = image.layer_data[0].attributes.other.get(&name) else {
            panic!("no provenance")
        };
        serde_json::from_str(&text.to_string()).unwrap()
    };
    let maps =
        ["--global", "emit:500", "--volume", "400", "--gather-rays", "2", "--step", "0.25", "--adapt", "0"];
    let read_as = ["--volume-k", "20", "--kernel", "biweight", "--boundary", "reflection", "--seed", "5"];
    let said = header(&[&maps[..], &read_as].concat());
    let (filled, read) = (&said["map_settings"], &said["mapper_settings"]);
    assert_eq!((&filled["global"]["emitted"], &filled["volume"]["stored"]), (&500.into(), &400.into()));
    assert_eq!((&filled["seed"], &filled["global_is_read"]), (&5.into(), &"by final gathering".into()));
    let volume = serde_json::json!({ "kernel": "biweight", "k": 20, "max_radius": read["volume"]["max_radius"], "boundary": "reflection", "reject": "off" });
    assert!(read["volume"] == volume && read["volume"]["max_radius"].as_f64().unwrap() > 0.0, "{read}");
    assert_eq!((&read["caustic"]["kernel"], &read["gather_rays"]), (&"cone".into(), &2.into()));
    assert_eq!(
        (&read["step"], &read["step_rule"], &read["adapt"]),
        (&0.25.into(), &"integrated".into(), &0.0.into())
    );
    assert!(
        read["jitter"] == true
            && read["shortest_step"].is_null()
            && said["scene"].as_str().unwrap().contains("[camera]")
    );
    let by_radius = header(&[&maps[..], &["--radius", "0.2"]].concat());
    assert_eq!(
        by_radius["mapper_settings"]["global"],
        serde_json::json!({ "kernel": "uniform", "radius": 0.2 })
    );
    let by_paths = header(&["--with", "paths"]);
    assert!(by_paths["map_settings"].is_null() && by_paths["mapper_settings"].is_null(), "{by_paths}");
}

/// Quiet: numbers alone, and errors.
#[test]
fn quiet_runs_tell_nothing_beside_their_numbers() {
    let noisy = ["measure", "slab", "--with", "photons", "--photons", "1000", "--maps", "2"];
    let run = |arguments: &[&str]| {
        let output = turbid(arguments).output().unwrap();
        assert!(output.status.success());
        [output.stdout, output.stderr].map(|bytes| String::from_utf8(bytes).unwrap())
    };
    let [table, notes] = run(&noisy);
    assert!(notes.contains("energy ledger"), "{notes}");
    for quiet in [[&noisy[..], &["--quiet"]].concat(), [&["--quiet"][..], &noisy].concat()] {
        assert_eq!(run(&quiet), [table.clone(), String::new()]);
    }
    refuses_naming(
        &["measure", "slab", "--with", "photons", "--k", "1", "--quiet"],
        &["k is 1; allowed: at least 2"],
    );
}

/// A scene on standard input is that of a file, relative names start at the folder of the run, and what is wrong names the line.
#[test]
fn scenes_on_standard_input() {
    let folder = Folder::new();
    let scene = succeeds(&["scenes", "slab", "--resolved"]);
    let file = folder.file("slab.toml", &scene);
    let piped = |arguments: &[&str], scene: &str| {
        turbid(arguments).current_dir(folder.0.path()).write_stdin(scene).output().unwrap()
    };
    for arguments in [
        &["check", "SCENE"][..],
        &["measure", "SCENE", "--with", "paths", "--samples", "1000", "--format", "csv"],
        &["measure", "SCENE", "--with", "paths", "--samples", "1000", "--set", "regions.0.albedo=0.5"],
        &["map", "SCENE", "--npy", "a.npy", "--photons", "100"],
    ] {
        let of = |name: &'static str, given: &str| -> Vec<u8> {
            let words: Vec<&str> =
                arguments.iter().map(|word| if *word == "SCENE" { name } else { *word }).collect();
            let words: Vec<&str> =
                words.iter().map(|w| if *w == "FILE" { text(&file) } else { *w }).collect();
            let output = piped(&words, given);
            assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
            output.stdout
        };
        assert_eq!(of("-", &scene), of("FILE", ""), "{arguments:?}");
    }
    let fogbox = succeeds(&["scenes", "fogbox", "--resolved"]);
    let render = ["render", "-", "-o", "a.exr", "--with", "paths", "--width", "4", "--samples", "1"];
    assert!(piped(&render, &fogbox).status.success());
    folder.file("part.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    let mesh = "[[objects]]\nshape = { mesh = { file = \"part.obj\" } }\nsurface = \"black\"\n[[lights]]\npoint = { position = [0, 0, 3], power = 1 }\n";
    assert!(piped(&["check", "-"], mesh).status.success());
    assert!(piped(&["check", "-", "--confined"], mesh).status.success());
    for (scene, words) in [
        (scene.replacen("albedo = 0.9", "albedo = 2", 1).as_str(), "albedo is 2; allowed: 0 to 1"),
        ("", "standard input: a scene needs at least one light"),
        ("cell = [", "standard input:1:"),
    ] {
        let output = piped(&["check", "-"], scene);
        let told = String::from_utf8(output.stderr).unwrap();
        assert!(
            output.status.code() == Some(2) && told.contains(words) && told.lines().count() == 1,
            "{told}"
        );
        assert!(told.contains("standard input"), "{told}");
    }
}

/// The scripts name every command and option of the program, the pages too.
#[test]
fn shells_and_manuals_know_the_program() {
    let folder = Folder::new();
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let script = succeeds(&["completions", shell]);
        for word in ["turbid", "measure", "photons-from", "gather-rays", "completions"] {
            assert!(script.contains(word), "{shell}: no {word}");
        }
    }
    refuses_naming(&["completions", "csh"], &["csh", "allowed: bash"]);
    let pages = folder.0.path().join("share").join("man1");
    assert!(succeeds(&["man", text(&pages)]).contains("written        11 pages"));
    let page = |name: &str| std::fs::read_to_string(pages.join(name)).unwrap();
    assert!(page("turbid.1").starts_with(".ie") || page("turbid.1").contains(".TH turbid"));
    for (name, words) in [
        ("turbid-measure.1", ["photons\\-from", "independent maps", "quiet"]),
        ("turbid-map.1", ["npy", "\\-\\-which", "camera"]),
        ("turbid-render.1", ["gather\\-rays", "OpenEXR", "\\-\\-with"]),
    ] {
        words.iter().for_each(|word| assert!(page(name).contains(word), "{name}: no {word}"));
    }
    let names = std::fs::read_dir(&pages).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap());
    assert!(names.into_iter().all(|name| name.starts_with("turbid") && name.ends_with(".1")));
    refuses_naming(&["man", "/dev/null/pages"], &["cannot make the folder"]);
}
