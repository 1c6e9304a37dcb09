//! `SCENES.md`: every key that a scene file may have is in it, and every example in it is a scene.

use crate::{Folder, succeeds, text};
use std::collections::BTreeSet;

const PAGE: &str = "SCENES.md";

/// `TwoTerm` as files write it.
fn kebab(name: &str) -> String {
    let mut word = String::new();
    for (i, c) in name.chars().enumerate() {
        if c.is_uppercase() && i > 0 {
            word.push('-');
        }
        word.extend(c.to_lowercase());
    }
    word
}

/// The names of fields and variants of the structs and enums that a file is read into.
fn keys(source: &str) -> BTreeSet<String> {
    let mut keys = BTreeSet::new();
    let mut is_inside = false;
    for line in source.lines() {
        if line.starts_with("pub struct ") || line.starts_with("pub enum ") {
            is_inside = line.contains("File") && line.ends_with('{');
        } else if line == "}" {
            is_inside = false;
        } else if is_inside && !line.trim_start().starts_with(['/', '#']) {
            let words = line.replace("::", " ").replace(['{', ',', '('], " ");
            for word in words.split_whitespace() {
                if let Some(field) = word.strip_suffix(':') {
                    keys.insert(field.to_string());
                }
            }
            let first = line.trim().trim_end_matches(',');
            let variant: String = first.chars().take_while(|c| c.is_alphanumeric()).collect();
            if line.starts_with("    ") && variant.starts_with(char::is_uppercase) {
                keys.insert(kebab(&variant));
            }
        }
    }
    keys
}

#[test]
fn every_key_is_explained() {
    let page = std::fs::read_to_string(PAGE).unwrap();
    let mut all = BTreeSet::new();
    for entry in std::fs::read_dir("src/scene/file").unwrap() {
        all.extend(keys(&std::fs::read_to_string(entry.unwrap().path()).unwrap()));
    }
    for known in
        ["sigma_t", "look_at", "volume-source", "angular_radius", "scale_height", "tiles", "outside", "cells"]
    {
        assert!(all.contains(known), "{known} is not found in the sources: {all:?}");
    }
    // What is no key: a texture is a number or a table, and these are its two cases.
    for case in ["constant", "varying"] {
        all.remove(case);
    }
    let is_explained = |key: &str| {
        let alone =
            [format!("`{key}`"), format!("`\"{key}\"`"), format!("`[{key}]`"), format!("`[[{key}]]`")];
        alone.iter().any(|form| page.contains(form))
    };
    let missing: Vec<&String> = all.iter().filter(|key| !is_explained(key)).collect();
    assert!(missing.is_empty(), "{PAGE} does not explain {missing:?}");
}

#[test]
fn every_example_is_a_scene() {
    let folder = Folder::new();
    folder.file("part.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\n");
    folder.file("mie.txt", "0 10\n90 1\n180 2\n");
    std::fs::write(folder.0.path().join("paint.png"), crate::bad_files::PIXEL).unwrap();
    std::fs::write(folder.0.path().join("fog.vol"), crate::media::vol([1.0, 3.0])).unwrap();
    let page = std::fs::read_to_string(PAGE).unwrap();
    let lamp =
        "[[lights]]\narea = { shape = { sphere = { center = [0, 9, 0], radius = 0.2 } }, radiance = 1 }\n";
    let ball = "[[regions]]\nshape = { sphere = { center = [0, 0, 0], radius = 1 } }\nsigma_t = 1\nalbedo = 0\ng = 0\n";
    let examples: Vec<&str> =
        page.split("```toml\n").skip(1).map(|rest| rest.split("```").next().unwrap()).collect();
    assert!(examples.len() > 7);
    for (number, example) in examples.into_iter().enumerate() {
        let mut scene = example.to_string();
        if !example.contains("[[lights]]") {
            scene.push_str(lamp);
        } else if !example.contains("[[regions]]") {
            scene.push_str(ball);
        }
        let file = folder.file(&format!("example{number}.toml"), &scene);
        succeeds(&["check", text(&file)]);
    }
}
