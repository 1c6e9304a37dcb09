//! The fewest bodies that still show what is wrong.

use super::text::{SceneText, choice};
use toml::Value;

/// Scenes with one part less: an object, a region, a light, or an interior with all that names it.
pub fn smaller(text: &SceneText) -> Vec<SceneText> {
    let mut all = Vec::new();
    for kind in ["lights", "regions", "objects"] {
        let parts = text.parts(kind).len();
        for index in (0..parts).rev() {
            let mut less = text.clone();
            less.parts_mut(kind).remove(index);
            all.push(less.without_unused());
        }
    }
    for index in 0..text.parts("interiors").len() {
        let mut less = text.clone();
        let interior = less.parts_mut("interiors").remove(index);
        let Some(name) = interior.get("name").and_then(Value::as_str) else { continue };
        // What is outside of it takes its place.
        let mut outside = None;
        less.parts_mut("objects").retain(|object| {
            let names = object.get("surface").and_then(|s| s.get("dielectric"));
            let named = |key: &str| names.and_then(|n| n.get(key)).and_then(Value::as_str);
            if named("inside") == Some(name) {
                outside = named("outside").map(ToString::to_string);
                return false;
            }
            true
        });
        for object in less.parts_mut("objects") {
            let Some(names) =
                object.get_mut("surface").and_then(|s| s.get_mut("dielectric")).and_then(Value::as_table_mut)
            else {
                continue;
            };
            if names.get("outside").and_then(Value::as_str) == Some(name) {
                match &outside {
                    Some(other) => names.insert("outside".into(), Value::String(other.clone())),
                    None => names.remove("outside"),
                };
            }
        }
        all.push(less.without_unused());
    }
    // Simpler parts: the filling of an interior, a density, emission, a pattern.
    for kind in ["interiors", "regions", "objects"] {
        for index in 0..text.parts(kind).len() {
            for keys in [
                &["sigma_t", "albedo", "g", "phase", "emission"][..],
                &["density", "emission_by_density"],
                &["emission"],
            ] {
                let mut less = text.clone();
                let Some(part) = less.parts_mut(kind)[index].as_table_mut() else { continue };
                if kind == "regions" && keys.contains(&"sigma_t") {
                    continue;
                }
                let before = part.len();
                part.retain(|key, _| !keys.contains(&key));
                if part.len() < before {
                    all.push(less.without_unused());
                }
            }
            let mut less = text.clone();
            if is_plain(&mut less.parts_mut(kind)[index]) {
                all.push(less.without_unused());
            }
        }
    }
    all
}

/// Makes a pattern one colour; whether there was one.
fn is_plain(object: &mut Value) -> bool {
    let Some(surface) = object.get_mut("surface").and_then(Value::as_table_mut) else { return false };
    for (_, keys) in surface.iter_mut() {
        let Some(keys) = keys.as_table_mut() else { continue };
        for key in ["reflectance", "transmittance"] {
            if let Some(texture) = keys.get_mut(key)
                && choice(texture).is_some()
            {
                *texture = Value::Float(0.5);
                return true;
            }
        }
    }
    false
}

/// Leaves out one part after the other as long as `still` says that the alarm stays.
pub fn shrunk(text: &SceneText, mut still: impl FnMut(&SceneText) -> bool) -> SceneText {
    let mut least = text.clone();
    while let Some(less) = smaller(&least).into_iter().find(|less| less.scene().is_ok() && still(less)) {
        least = less;
    }
    least
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sweep::draw::draw;

    /// Down to a light and at most what it shines on, where everything may go; parts that are asked for stay.
    #[test]
    fn parts_go_one_by_one() {
        for seed in 0..20 {
            let text = draw(seed, 0).text;
            if text.scene().is_err() {
                continue;
            }
            let least = shrunk(&text, |_| true);
            // A sun needs something to shine on.
            let left: usize =
                ["objects", "regions", "lights"].iter().map(|kind| least.parts(kind).len()).sum();
            assert!(left <= 2 && least.parts("interiors").len() <= 1, "{}", least.toml());
            let objects = text.parts("objects").len();
            let kept = shrunk(&text, |less| less.parts("objects").len() == objects);
            assert_eq!(kept.parts("objects").len(), objects);
        }
    }
}
