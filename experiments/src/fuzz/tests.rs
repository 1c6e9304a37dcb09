//! A few hundred inputs, and the harness itself.

use super::{Input, Kind, Thoroughness, Verdict, Workbench, shrink, tree};

/// Kinds that are tried in this process.
const KINDS: [Kind; 7] =
    [Kind::Scenes, Kind::Vol, Kind::Png, Kind::Obj, Kind::Tables, Kind::Cells, Kind::Figures];

/// Every input is refused in a line or does what it says, and both happen.
#[test]
fn inputs_by_chance_are_refused_or_do_what_they_say() {
    let bench = Workbench::new(Thoroughness::All).unwrap();
    for kind in KINDS {
        let (mut accepted, mut refused) = (0, 0);
        let count = if kind == Kind::Scenes { 160 } else { 24 };
        for number in 0..count {
            let input = Input::of(Some(kind), 1, number);
            match bench.judge(&input) {
                Verdict::Accepted => accepted += 1,
                Verdict::Refused(_) => refused += 1,
                Verdict::Failed(what) => panic!(
                    "{what}; cargo run --release --bin fuzz -- --only {} --first {number} --count 1",
                    kind.name()
                ),
            }
        }
        assert!(refused > 0, "{}: none refused of {count}", kind.name());
        assert!(accepted > 0, "{}: none accepted of {count}", kind.name());
    }
}

#[test]
fn an_input_is_a_function_of_its_kind_seed_and_number() {
    for number in 0..20 {
        let input = Input::of(None, 5, number);
        assert_eq!(input, Input::of(None, 5, number));
        assert!(!(0..20).any(|other| input.kind == Kind::Scenes && input == Input::of(None, 6, other)));
    }
}

/// Failures are of one sort if they differ in numbers; every part of a scene is found, and can be left out.
#[test]
fn sorts_and_parts() {
    assert_eq!(shrink::sort("panic at src/a.rs:12: index 4 of 27"), "panic at src/a.rs:#: index # of #");
    let scene: toml::Value = toml::Value::Table(toml::from_str("a = [1, { b = 2 }]\n[c]\nd = 3\n").unwrap());
    let places = tree::places(&scene);
    assert_eq!(places.len(), 7);
    let mut smaller = scene.clone();
    for place in places.iter().rev().filter(|place| place.len() == 1) {
        tree::remove(&mut smaller, place);
    }
    assert_eq!(tree::places(&smaller).len(), 1);
}
