//! Failures made smaller: a scene loses tables and keys for as long as it fails in the same way.

use super::batch::alone;
use super::input::Input;
use super::judge::Verdict;
use super::kind::Kind;
use super::tree::{at, places, remove};
use toml::Value;

/// Trials of a scene, at most; each is a process of its own.
const TRIALS: usize = 120;

/// What a failure has in common with others: its words without numbers and names of files.
pub fn sort(what: &str) -> String {
    let short: String = what.chars().take(160).collect();
    let mut sort = String::new();
    for c in short.chars() {
        match c {
            '0'..='9' if sort.ends_with('#') => {}
            '0'..='9' => sort.push('#'),
            c => sort.push(c),
        }
    }
    sort
}

/// The same input with as little as fails in the same way; as it is where it is no scene, or takes long.
pub fn shrink(input: &Input, expected: &str) -> anyhow::Result<Input> {
    let text = String::from_utf8_lossy(&input.bytes).to_string();
    let slow = expected.contains("ended after") || expected.contains("memory");
    let Ok(table) = toml::from_str(&text) else { return Ok(input.clone()) };
    if input.kind != Kind::Scenes {
        return Ok(input.clone());
    }
    let mut scene = Value::Table(table);
    let mut left = if slow { TRIALS / 6 } else { TRIALS };
    let as_input = |scene: &Value| -> Option<Input> {
        let text = toml::to_string(scene.as_table()?).ok()?;
        Some(Input { kind: Kind::Scenes, bytes: text.into_bytes() })
    };
    let mut is_smaller = true;
    while is_smaller && left > 0 {
        is_smaller = false;
        let mut all = places(&scene);
        // The largest parts first, of lists the last ones.
        all.sort_by_key(|place| (place.len(), std::cmp::Reverse(at(&scene, place).map_or(0, size))));
        for place in all.into_iter().skip(1) {
            if left == 0 {
                break;
            }
            if at(&scene, &place).is_none() {
                continue;
            }
            let mut smaller = scene.clone();
            remove(&mut smaller, &place);
            let Some(candidate) = as_input(&smaller) else { continue };
            left -= 1;
            if let Verdict::Failed(what) = alone(&candidate)?
                && sort(&what) == expected
            {
                scene = smaller;
                is_smaller = true;
                break;
            }
        }
    }
    Ok(as_input(&scene).unwrap_or_else(|| input.clone()))
}

fn size(value: &Value) -> usize {
    places(value).len()
}
