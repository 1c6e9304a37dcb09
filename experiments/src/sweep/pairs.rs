//! The same scene in other words: what must agree with it.

use super::draw::short;
use super::motion::Motion;
use super::text::{SceneText, array, choice, point, table};
use glam::{DMat3, DVec3};
use toml::Value;
use turbid::rng::{Purpose, Stream};
use turbid::scene::Scene;

/// A scene that must give the same picture.
#[derive(Debug, Clone)]
pub struct Pair {
    /// What was done, in words.
    pub name: String,
    /// The other scene.
    pub scene: Scene,
    /// Whether left and right are exchanged.
    pub is_mirrored: bool,
}

/// Draws one of the changes that a scene allows, the full plan among them.
///
/// # Errors
/// what the changed scene is refused for, which its pair was not
pub fn pair(text: &SceneText, scene: &Scene, seed: u64) -> anyhow::Result<Pair> {
    let mut stream = Stream::new(seed, Purpose::Synthetic, u64::MAX, 1);
    // From the one drawn on, the first that the scene allows: the full plan is the last, and always allowed.
    let first = stream.index(FULL_PLAN + 1);
    let made = (first..FULL_PLAN).find_map(|kind| change(text, kind, &mut stream));
    match made {
        Some((name, changed, is_mirrored)) => {
            let scene = changed.scene().map_err(|e| anyhow::anyhow!("{name}: {e:#}"))?;
            Ok(Pair { name: name.to_string(), scene, is_mirrored })
        }
        None => {
            let scene = scene.with_full_plan().map_err(|e| anyhow::anyhow!("full plan: {e}"))?;
            Ok(Pair { name: "full plan".into(), scene, is_mirrored: false })
        }
    }
}

/// The changes of the text are those before it.
const FULL_PLAN: usize = 6;

fn change(text: &SceneText, kind: usize, stream: &mut Stream) -> Option<(&'static str, SceneText, bool)> {
    let motion = |name, motion: Motion| {
        let is_mirrored = motion.is_mirror();
        motion.of(text).ok().map(|text| (name, text.without_unused(), is_mirrored))
    };
    let has_slab = text.toml().contains("slab");
    match kind {
        0 => motion("turned", Motion { turn: Motion::rotation(1 + stream.index(23)), ..Motion::NONE }),
        1 => {
            let axis = stream.index(if has_slab { 2 } else { 3 });
            let mut sides = DVec3::ONE;
            sides[axis] = -1.0;
            motion("mirrored", Motion { turn: DMat3::from_diagonal(sides), ..Motion::NONE })
        }
        2 => {
            let size = camera_distance(text)?;
            let offset = DVec3::from_array(stream.triple().map(|u| size * (4.0 * u - 2.0)));
            motion("moved", Motion { offset, ..Motion::NONE })
        }
        3 => {
            let scale = short(turbid::math::exp(14.0 * (stream.unit() - 0.5)));
            motion("rescaled", Motion { scale, ..Motion::NONE })
        }
        4 => split(text, stream).map(|text| ("split", text, false)),
        5 if text.parts("lights").len() > 1 => {
            let mut other = text.clone();
            other.parts_mut("lights").reverse();
            Some(("lights in another order", other, false))
        }
        _ => None,
    }
}

/// How far the camera looks \[L\].
fn camera_distance(text: &SceneText) -> Option<f64> {
    let camera = text.table.get("camera")?;
    let at = |key: &str| camera.get(key).and_then(point).map(DVec3::from);
    Some(at("position")?.distance(at("look_at")?))
}

/// A body, a region or a light in two.
fn split(text: &SceneText, stream: &mut Stream) -> Option<SceneText> {
    let mut found = Vec::new();
    for kind in ["objects", "regions", "lights"] {
        for index in 0..text.parts(kind).len() {
            if let Some(halves) = halves(text, kind, &text.parts(kind)[index], stream) {
                found.push((kind, index, halves));
            }
        }
    }
    if found.is_empty() {
        return None;
    }
    let (kind, index, halves) = found.swap_remove(stream.index(found.len()));
    let mut other = text.clone();
    other.parts_mut(kind).splice(index..=index, halves);
    Some(other)
}

/// A part in two, if two make the same.
fn halves(text: &SceneText, kind: &str, part: &Value, stream: &mut Stream) -> Option<[Value; 2]> {
    let at = short(0.25 + 0.5 * stream.unit());
    let with_shape = |shape: Value| {
        let mut half = part.as_table()?.clone();
        half.insert("shape".into(), shape);
        Some(Value::Table(half))
    };
    if kind == "lights" {
        let ("area", keys) = choice(part)? else { return None };
        let [a, b] = rectangles(keys.get("shape")?, at)?;
        let half = |shape| {
            let mut keys = keys.as_table()?.clone();
            keys.insert("shape".into(), shape);
            Some(table([("area", Value::Table(keys))]))
        };
        return Some([half(a)?, half(b)?]);
    }
    let shape = part.get("shape")?;
    if kind == "regions" {
        let [a, b] = cuboids(shape, at, stream.index(3))?;
        return Some([with_shape(a)?, with_shape(b)?]);
    }
    let surface = part.get("surface")?;
    // A pattern would begin anew in each half.
    let texture = surface.get("lambertian").and_then(|s| s.get("reflectance"));
    let texture = texture.or_else(|| surface.get("filter").and_then(|s| s.get("transmittance")));
    if texture.is_some_and(|t| t.get("checker").is_some() || t.get("image").is_some()) {
        return None;
    }
    if let Some([a, b]) = rectangles(shape, at) {
        return Some([with_shape(a)?, with_shape(b)?]);
    }
    // A room has no wall across its middle.
    let is_opaque = surface.get("dielectric").is_none() && surface.get("filter").is_none();
    let [a, b] = cuboids(shape, at, stream.index(3)).filter(|_| is_opaque && !is_room(text, shape))?;
    Some([with_shape(a)?, with_shape(b)?])
}

/// Whether a cuboid is a room: the camera is in it.
fn is_room(text: &SceneText, shape: &Value) -> bool {
    let eye = text.table.get("camera").and_then(|c| c.get("position")).and_then(point);
    let corner = |key: &str| choice(shape).and_then(|(_, keys)| keys.get(key)).and_then(point);
    let (Some(eye), Some(min), Some(max)) = (eye, corner("min"), corner("max")) else { return true };
    (0..3).all(|axis| min[axis] <= eye[axis] && eye[axis] <= max[axis])
}

/// A rectangle in two along its first side.
fn rectangles(shape: &Value, at: f64) -> Option<[Value; 2]> {
    let ("rectangle", keys) = choice(shape)? else { return None };
    let get = |key: &str| keys.get(key).and_then(point).map(DVec3::from);
    let (corner, u, v) = (get("corner")?, get("u")?, get("v")?);
    let one = |corner: DVec3, u: DVec3| {
        let keys = [("corner", corner), ("u", u), ("v", v)].map(|(key, p)| (key, array(&p.to_array())));
        table([("rectangle", table(keys))])
    };
    Some([one(corner, u * at), one(corner + u * at, u * (1.0 - at))])
}

/// A cuboid in two along an axis.
fn cuboids(shape: &Value, at: f64, axis: usize) -> Option<[Value; 2]> {
    let ("cuboid", keys) = choice(shape)? else { return None };
    let get = |key: &str| keys.get(key).and_then(point);
    let (min, max) = (get("min")?, get("max")?);
    let cut = min[axis] + at * (max[axis] - min[axis]);
    let one = |min: [f64; 3], max: [f64; 3]| {
        table([("cuboid", table([("min", array(&min)), ("max", array(&max))]))])
    };
    let (mut high, mut low) = (max, min);
    (high[axis], low[axis]) = (cut, cut);
    Some([one(min, high), one(low, max)])
}

#[cfg(test)]
mod tests {
    use super::super::draw::draw;
    use super::*;
    use std::collections::BTreeSet;

    /// Every kind of pair is drawn.
    #[test]
    fn every_kind_is_drawn() {
        let mut names = BTreeSet::new();
        for seed in 0..200 {
            let text = draw(seed, 0).text;
            if let Ok(pair) = text.scene().and_then(|scene| pair(&text, &scene, seed)) {
                names.insert(pair.name);
            }
        }
        let all =
            ["full plan", "lights in another order", "mirrored", "moved", "rescaled", "split", "turned"];
        assert_eq!(names, all.map(String::from).into());
    }
}
