//! No circles: within a crate no two files import from each other, neither directly nor by way of others.
//!
//! What counts as an import is said in `modules`. A circle is a set of files each of which can be reached from each other
//! (a strongly connected component); it is cut by moving what both sides need to where both can import it.
#![allow(clippy::unwrap_used, reason = "tests")]

mod modules;
mod tokens;

use modules::{Imports, Modules, Sources};
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

/// The crates by their root files, and how many files each has at least: a reader that loses files finds no circles.
const CRATES: [(&str, usize); 6] = [
    ("src/lib.rs", 150),
    ("src/bin/turbid/main.rs", 10),
    ("analytic/lib.rs", 50),
    ("analytic/exact/lib.rs", 25),
    ("experiments/src/lib.rs", 150),
    ("experiments/figure/src/lib.rs", 25),
];

fn read(folder: &Path, below: &Path, found: &mut Sources) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() && path.file_name().is_some_and(|name| name != "target") {
            read(&path, below, found);
        } else if path.extension().is_some_and(|e| e == "rs") {
            let text = fs::read_to_string(&path).unwrap();
            found.insert(path.strip_prefix(below).unwrap().to_path_buf(), text);
        }
    }
}

/// The circles among imports, each as the files in it.
fn circles(imports: &Imports) -> Vec<BTreeSet<PathBuf>> {
    let mut targets: BTreeMap<&Path, BTreeSet<&Path>> = BTreeMap::new();
    for (from, to) in imports.keys() {
        targets.entry(from).or_default().insert(to);
    }
    let mut reached: BTreeMap<&Path, BTreeSet<&Path>> = BTreeMap::new();
    for from in targets.keys() {
        let mut seen = BTreeSet::new();
        let mut open = vec![*from];
        while let Some(file) = open.pop() {
            open.extend(targets.get(file).into_iter().flatten().filter(|to| seen.insert(**to)));
        }
        reached.insert(from, seen);
    }
    let mut found = BTreeSet::new();
    for (file, others) in &reached {
        if others.contains(file) {
            let mutual = others.iter().filter(|other| reached.get(*other).is_some_and(|r| r.contains(file)));
            found.insert(mutual.map(|other| other.to_path_buf()).collect());
        }
    }
    found.into_iter().collect()
}

/// A circle in words: its files, and what each takes from the others.
fn describe(circle: &BTreeSet<PathBuf>, imports: &Imports) -> String {
    let mut text = format!("{} files import each other:\n", circle.len());
    for ((from, to), names) in imports {
        if circle.contains(from) && circle.contains(to) {
            let names: Vec<&str> = names.iter().map(String::as_str).collect();
            text += &format!("  {} takes {} from {}\n", from.display(), names.join(", "), to.display());
        }
    }
    text
}

/// The circles of a crate in words.
fn found(modules: &Modules) -> Vec<String> {
    let (imports, lost) = modules.imports();
    assert!(lost.is_empty(), "paths that lead nowhere: {lost:#?}");
    circles(&imports).iter().map(|circle| describe(circle, &imports)).collect()
}

#[test]
fn no_files_import_each_other() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut sources = Sources::new();
    for folder in ["src", "analytic", "experiments/src", "experiments/figure/src"] {
        read(&root.join(folder), root, &mut sources);
    }
    let mut texts = Vec::new();
    for (crate_root, least) in CRATES {
        let modules = Modules::read(&sources, Path::new(crate_root));
        assert!(modules.files().len() >= least, "{crate_root} has only {} files", modules.files().len());
        texts.extend(found(&modules));
    }
    assert!(texts.is_empty(), "{} circles\n{}", texts.len(), texts.concat());
}

/// The circles of a made-up crate, each as its files.
fn made_up(files: &[(&str, &str)]) -> Vec<Vec<String>> {
    let sources: Sources = files.iter().map(|(path, text)| (path.into(), text.to_string())).collect();
    let (imports, lost) = Modules::read(&sources, Path::new("lib.rs")).imports();
    assert!(lost.is_empty(), "{lost:?}");
    let names = |circle: &BTreeSet<PathBuf>| circle.iter().map(|file| file.display().to_string()).collect();
    circles(&imports).iter().map(names).collect()
}

/// The test of the test: circles of every form are found.
#[test]
fn circles_would_be_seen() {
    let pair = [vec!["a.rs", "b.rs"]];
    let root = ("lib.rs", "mod a;\nmod b;");
    let of = |a: &str, b: &str| made_up(&[root, ("a.rs", a), ("b.rs", b)]);
    assert_eq!(
        of("use crate::b::{f, g};\npub struct A;", "use super::{a::A};\npub fn f() {}\nfn g() {}"),
        pair
    );
    assert_eq!(of("pub struct A(crate::b::B);", "pub struct B;\nfn f(_: Vec<super::a::A>) {}"), pair);
    assert_eq!(of("use super::b;\npub fn f() { b::g(); }", "pub fn g() { crate::a::f() }"), pair);
    assert_eq!(of("pub enum A { X }", "use crate::a::A::X;"), [] as [Vec<&str>; 0]);
    // A long way round, through a name that the root hands on and all names of a module.
    let files = [
        ("lib.rs", "pub mod a;\nmod b;\nmod c;\npub use c::C;"),
        ("a.rs", "use crate::C as D;\npub const N: D = 1;"),
        ("b.rs", "use crate::a::*;\npub const M: u8 = N;"),
        ("c.rs", "use crate::b::M;\npub type C = u8;"),
    ];
    assert_eq!(made_up(&files), [["a.rs", "b.rs", "c.rs"]]);
    // A parent that defines what its child takes, and takes something from the child.
    let child = ("p/child.rs", "use super::T;\npub struct U(T);");
    let parent = "mod child;\npub struct T;\nfn f(u: child::U) {}";
    assert_eq!(made_up(&[("lib.rs", "mod p;"), ("p/mod.rs", parent), child]), [["p/child.rs", "p/mod.rs"]]);
}

/// And what is no circle is none: declared, handed on, in comments and texts, for tests alone, in one file, of others.
#[test]
fn what_is_no_circle_is_none() {
    let none: [Vec<String>; 0] = [];
    let files = [
        ("lib.rs", "mod p;\npub use p::{T, child::U};"),
        ("p/mod.rs", "pub mod child;\nmod t;\npub use child::U;\npub use t::T;"),
        ("p/child.rs", "use super::T;\npub struct U(T);\nmod inner { use super::U; struct V(U); }"),
        (
            "p/t.rs",
            "pub struct T;\n// crate::U\n/* /* super::U */ use crate::U; */\nconst C: &str = \"crate::U\";",
        ),
    ];
    assert_eq!(made_up(&files), none);
    let a = "use crate::b::B;\npub struct A<'a>(&'a B, char);\nfn f() -> char { '\"' }";
    let b = "pub struct B;\n#[cfg(test)]\nmod tests { use crate::a::A; }\n#[cfg(test)]\nuse crate::a::A;\nuse other::a::A;";
    assert_eq!(made_up(&[("lib.rs", "mod a;\nmod b;"), ("a.rs", a), ("b.rs", b)]), none);
}
