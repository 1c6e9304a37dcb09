//! Changes of scenes as trees: keys, tables and lists, and the numbers at their ends.

use super::seeds;
use toml::{Table, Value};
use turbid::rng::Stream;

/// A step from a value to one inside it.
#[derive(Debug, Clone, PartialEq)]
pub enum Part {
    /// The value of a key.
    Key(String),
    /// An entry of a list.
    Entry(usize),
}

/// Every value inside, the deepest last; the whole first.
pub fn places(value: &Value) -> Vec<Vec<Part>> {
    let mut all = vec![Vec::new()];
    let mut add = |part: Part, inner: &Value| {
        for place in places(inner) {
            all.push([vec![part.clone()], place].concat());
        }
    };
    match value {
        Value::Table(table) => table.iter().for_each(|(key, inner)| add(Part::Key(key.clone()), inner)),
        Value::Array(list) => list.iter().enumerate().for_each(|(i, inner)| add(Part::Entry(i), inner)),
        _ => {}
    }
    all
}

/// The value at a place.
pub fn at<'a>(value: &'a Value, place: &[Part]) -> Option<&'a Value> {
    place.iter().try_fold(value, |value, part| match part {
        Part::Key(key) => value.get(key),
        Part::Entry(i) => value.get(*i),
    })
}

fn at_mut<'a>(value: &'a mut Value, place: &[Part]) -> Option<&'a mut Value> {
    place.iter().try_fold(value, |value, part| match part {
        Part::Key(key) => value.get_mut(key),
        Part::Entry(i) => value.get_mut(*i),
    })
}

/// Leaves out what is at a place.
pub fn remove(value: &mut Value, place: &[Part]) {
    let Some((last, way)) = place.split_last() else { return };
    match (at_mut(value, way), last) {
        (Some(Value::Table(table)), Part::Key(key)) => {
            table.remove(key);
        }
        (Some(Value::Array(list)), Part::Entry(i)) if *i < list.len() => {
            list.remove(*i);
        }
        _ => {}
    }
}

/// Numbers at which something may go wrong.
const EXTREMES: [f64; 26] = [
    0.0,
    -0.0,
    1.0,
    -1.0,
    0.5,
    1e-3,
    1e3,
    1e-9,
    1e9,
    1e-16,
    1e16,
    1e-154,
    1e154,
    1e-308,
    1e308,
    -1e308,
    5e-324,
    f64::MAX,
    f64::NAN,
    f64::INFINITY,
    f64::NEG_INFINITY,
    0.999_999,
    1.0 - f64::EPSILON / 2.0,
    1.000_001,
    180.0,
    90.0,
];

/// A scene file by chance: one of the seeds, changed a few times.
pub fn changed(stream: &mut Stream) -> String {
    let mut scene = Value::Table(seeds::scene(stream));
    // The number of changes is geometric: mostly few, so that many scenes stay valid.
    loop {
        change(&mut scene, stream);
        if stream.unit() < 0.4 {
            break;
        }
    }
    match scene {
        Value::Table(table) => toml::to_string(&table).unwrap_or_default(),
        _ => String::new(),
    }
}

fn number(value: &Value) -> Option<f64> {
    match value {
        Value::Float(x) => Some(*x),
        Value::Integer(x) => Some(*x as f64),
        _ => None,
    }
}

/// One of the places of which a question is answered with yes.
fn pick(value: &Value, stream: &mut Stream, is: impl Fn(&Value) -> bool) -> Option<Vec<Part>> {
    let mut all = places(value);
    all.retain(|place| !place.is_empty() && at(value, place).is_some_and(&is));
    if all.is_empty() { None } else { Some(all.swap_remove(stream.index(all.len()))) }
}

fn change(scene: &mut Value, stream: &mut Stream) {
    let is_number = |v: &Value| number(v).is_some();
    let choice = stream.index(20);
    match choice {
        // A number, a little or a lot.
        0..=8 => {
            let Some(place) = pick(scene, stream, is_number) else { return };
            let other = pick(scene, stream, is_number).and_then(|p| at(scene, &p).cloned());
            let Some(value) = at_mut(scene, &place) else { return };
            let x = number(value).unwrap_or(0.0);
            *value = match stream.index(6) {
                0 | 1 => Value::Float(EXTREMES[stream.index(EXTREMES.len())]),
                2 => Value::Float(x * [0.5, 2.0, 0.1, 10.0, 1e-3, 1e3][stream.index(6)]),
                3 => Value::Float(-x),
                4 => other.unwrap_or(Value::Integer(0)),
                _ if matches!(value, Value::Integer(_)) => {
                    Value::Integer([0, 1, 2, 3, -1, 1 << 20, i64::MAX, i64::MIN][stream.index(8)])
                }
                _ => Value::Float(x + stream.unit() - 0.5),
            };
        }
        // One thing left out, or twice.
        9 | 10 => {
            if let Some(place) = pick(scene, stream, |_| true) {
                remove(scene, &place);
            }
        }
        11 | 12 => {
            let Some(mut place) = pick(scene, stream, |v| matches!(v, Value::Array(l) if !l.is_empty()))
            else {
                return;
            };
            let Some(Value::Array(list)) = at_mut(scene, &place) else { return };
            let entry = list[stream.index(list.len())].clone();
            list.push(entry);
            // A copy in exactly the same place is a case of its own; more often it is changed a little.
            place.push(Part::Entry(list.len() - 1));
            if stream.unit() < 0.7
                && let Some(copy) = at_mut(scene, &place)
            {
                change(copy, stream);
            }
        }
        // One thing in the place of another.
        13 => {
            let is_inner = |v: &Value| matches!(v, Value::Table(_) | Value::Array(_));
            let (Some(a), Some(b)) = (pick(scene, stream, is_inner), pick(scene, stream, is_inner)) else {
                return;
            };
            let copy = at(scene, &a).cloned();
            if let (Some(copy), Some(to)) = (copy, at_mut(scene, &b)) {
                *to = copy;
            }
        }
        // What another scene says under the same key.
        14..=16 => {
            let donor = Value::Table(seeds::scene(stream));
            let Some(place) = pick(scene, stream, |_| true) else { return };
            let key =
                place.iter().rev().find_map(|p| if let Part::Key(k) = p { Some(k.clone()) } else { None });
            let mut same: Vec<Vec<Part>> = places(&donor);
            same.retain(|p| matches!((p.last(), &key), (Some(Part::Key(k)), Some(key)) if k == key));
            if same.is_empty() {
                return;
            }
            let from = same.swap_remove(stream.index(same.len()));
            let to = match place.iter().rposition(|p| matches!(p, Part::Key(_))) {
                Some(i) => &place[..=i],
                None => return,
            };
            if let (Some(value), Some(to)) = (at(&donor, &from).cloned(), at_mut(scene, to)) {
                match (to, value) {
                    // Of lists both count: bodies of two scenes in one.
                    (Value::Array(mine), Value::Array(others))
                        if !others.is_empty() && stream.unit() < 0.7 =>
                    {
                        mine.push(others[stream.index(others.len())].clone());
                    }
                    (to, value) => *to = value,
                }
            }
        }
        // A shape, surface or light of any sort.
        17 | 18 => {
            let key = ["shape", "surface"][stream.index(2)];
            let mut all = places(scene);
            all.retain(|p| matches!(p.last(), Some(Part::Key(k)) if k == key));
            if all.is_empty() {
                return;
            }
            let place = all.swap_remove(stream.index(all.len()));
            let new = if key == "shape" { seeds::shape(stream) } else { seeds::surface(stream) };
            if let Some(to) = at_mut(scene, &place) {
                *to = new;
            }
        }
        // A misspelt key, a word for a number, something nested.
        _ => {
            let Some(place) = pick(scene, stream, |_| true) else { return };
            let Some(value) = at_mut(scene, &place) else { return };
            let inner = value.clone();
            *value = match stream.index(4) {
                0 => Value::Array(vec![inner]),
                1 => Value::Table(Table::from_iter([("x".to_string(), inner)])),
                2 => Value::String("surroundings\u{1b}[31m\n".to_string()),
                _ => Value::Boolean(true),
            };
        }
    }
}
