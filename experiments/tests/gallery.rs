//! The commands on the gallery's page make the pictures beside them, and the kept page is of the kept numbers.
#![allow(clippy::unwrap_used, reason = "tests")]

mod program;

use assert_cmd::Command;
use exr::prelude::{FlatSamples, read_first_flat_layer_from_file};
use program::{root, turbid};
use std::collections::BTreeSet;
use std::path::Path;
use turbid::Spectrum;
use turbid::photons::maps::Amount;
use turbid::transport::NoProgress;
use turbid_experiments::gallery::pictures::{ALL, Picture};
use turbid_experiments::gallery::recipe::{arguments, command};
use turbid_experiments::gallery::studio::Studio;

/// Red, green and blue of an EXR file, row by row from the top.
fn read(path: &Path) -> Vec<[f32; 3]> {
    let layer = read_first_flat_layer_from_file(path).unwrap().layer_data;
    let plane = |name: &str| {
        let channel = layer.channel_data.list.iter().find(|channel| channel.name.eq(name)).unwrap();
        let FlatSamples::F32(values) = &channel.sample_data else { panic!("{name} is no float") };
        values.clone()
    };
    let [r, g, b] = ["R", "G", "B"].map(plane);
    r.into_iter().zip(g).zip(b).map(|((r, g), b)| [r, g, b]).collect()
}

/// Every picture with fewer photons and pixels, by the arguments that the page shows: the gallery's own numbers.
#[test]
fn the_commands_make_the_pictures() {
    let folder = tempfile::tempdir().unwrap();
    for picture in ALL {
        let photons = picture.photons.map(|amount| match amount {
            Amount::Stored(_) => Amount::Emitted(2000),
            emitted @ Amount::Emitted(_) => emitted,
        });
        let small = Picture { photons, samples: 1, ..*picture };
        let studio = Studio::open(&small, &root().join("experiments/scenes"), 0.025, 7, "").unwrap();
        let file = folder.path().join(format!("{}.exr", small.name));
        let mut arguments = arguments(&small, 7).unwrap();
        let output = 1 + arguments.iter().position(|a| a == "--output").unwrap();
        arguments[output] = file.to_str().unwrap().to_string();
        let (width, height) = (studio.camera.width(), studio.camera.height());
        arguments
            .extend(["--width", &width.to_string(), "--height", &height.to_string()].map(str::to_string));
        turbid().current_dir(root()).args(&arguments).assert().success();
        let ours = studio.photons(1, 0, 1, &NoProgress).unwrap();
        let rounded = |s: &Spectrum| [s[0] as f32, s[1] as f32, s[2] as f32];
        let expected: Vec<[f32; 3]> = ours.total.iter().map(rounded).collect();
        assert!(expected.iter().flatten().any(|x| *x > 0.0), "{}: all black", small.name);
        assert!(read(&file) == expected, "{}: the command makes another picture", small.name);
    }
}

/// What the page shows is those arguments, with the picture's own numbers, for a shell: nothing in them needs quotes.
#[test]
fn the_commands_are_for_a_shell() {
    for picture in ALL {
        let text = command(picture, 1).unwrap();
        let tail = text.strip_prefix("cargo run --release --bin turbid -- ").unwrap();
        assert_eq!(tail.split(' ').collect::<Vec<_>>(), arguments(picture, 1).unwrap());
        let is_plain = |c: char| c.is_ascii_alphanumeric() || " -_./:".contains(c);
        assert!(text.chars().all(is_plain), "{text}");
        // The binary's own parser takes every flag and value; only the file's ending is wrong.
        let mut arguments = arguments(picture, 1).unwrap();
        let output = 1 + arguments.iter().position(|a| a == "--output").unwrap();
        arguments[output] = "a.txt".to_string();
        let run = turbid().current_dir(root()).args(&arguments).assert().code(2);
        let said = String::from_utf8(run.get_output().stderr.clone()).unwrap();
        assert!(said.contains("ends in .exr"), "{}: {said}", picture.name);
    }
}

/// The kept page is what the program writes from the kept numbers, and every file that it shows is there.
#[test]
fn the_kept_page_shows_the_kept_numbers() {
    let kept = root().join("results/gallery");
    let folder = tempfile::tempdir().unwrap();
    for of in ["gallery", "print"] {
        std::fs::create_dir(folder.path().join(of)).unwrap();
        for picture in ALL {
            let file = Path::new(of).join(format!("{}.json", picture.name));
            // Not all pictures are printed.
            if of == "gallery" || root().join("results").join(&file).exists() {
                std::fs::copy(root().join("results").join(&file), folder.path().join(&file)).unwrap();
            }
        }
    }
    let out = folder.path().join("gallery");
    let mut gallery = Command::new(env!("CARGO_BIN_EXE_gallery"));
    gallery.args(["--page", "--out"]).arg(&out).assert().success();
    let page = std::fs::read_to_string(out.join("index.html")).unwrap();
    assert!(
        page == std::fs::read_to_string(kept.join("index.html")).unwrap(),
        "gallery --page writes another"
    );
    for picture in ALL {
        let command = command(picture, 1).unwrap();
        assert!(page.contains(&command), "{}: not by {command}", picture.name);
    }
    let shown: BTreeSet<&str> =
        page.split("src=\"").skip(1).map(|rest| rest.split('"').next().unwrap()).collect();
    let files =
        std::fs::read_dir(&kept).unwrap().map(|file| file.unwrap().file_name().into_string().unwrap());
    let files: BTreeSet<String> = files.filter(|file| file.ends_with(".png")).collect();
    assert_eq!(shown, files.iter().map(String::as_str).collect());
    let printed = page.split("href=\"../print/").skip(1).map(|rest| rest.split('"').next().unwrap());
    for file in printed {
        assert!(root().join("results/print").join(file).exists(), "{file}");
    }
}

/// Pictures for print show what the page has compared; without a page there is nothing to show.
#[test]
fn prints_need_the_page() {
    let folder = tempfile::tempdir().unwrap();
    let mut gallery = Command::new(env!("CARGO_BIN_EXE_gallery"));
    gallery.current_dir(folder.path()).args(["--print", "--only", "pool", "--scenes"]);
    let run = gallery.arg(root().join("experiments/scenes")).assert().code(2);
    let said = String::from_utf8(run.get_output().stderr.clone()).unwrap();
    assert!(said.contains("pool is not in results/gallery"), "{said}");
    assert!(!folder.path().join("results/print/pool.json").exists());
}
