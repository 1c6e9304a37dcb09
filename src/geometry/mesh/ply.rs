//! Meshes as PLY files, text or binary.

use super::Mesh;
use super::polygon::cut;
use super::shading::Turn;
use crate::error::{Error, Result};
use glam::{DVec2, DVec3};

/// Types of numbers, under both names that files give them.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Number {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

impl Number {
    fn named(word: &str) -> Option<Self> {
        Some(match word {
            "char" | "int8" => Number::I8,
            "uchar" | "uint8" => Number::U8,
            "short" | "int16" => Number::I16,
            "ushort" | "uint16" => Number::U16,
            "int" | "int32" => Number::I32,
            "uint" | "uint32" => Number::U32,
            "float" | "float32" => Number::F32,
            "double" | "float64" => Number::F64,
            _ => return None,
        })
    }

    fn size(self) -> usize {
        match self {
            Number::I8 | Number::U8 => 1,
            Number::I16 | Number::U16 => 2,
            Number::I32 | Number::U32 | Number::F32 => 4,
            Number::F64 => 8,
        }
    }

    /// The number that these bytes are, the lowest first.
    fn of(self, bytes: [u8; 8]) -> f64 {
        let [a, b, c, d, ..] = bytes;
        match self {
            Number::I8 => f64::from(a as i8),
            Number::U8 => f64::from(a),
            Number::I16 => f64::from(i16::from_le_bytes([a, b])),
            Number::U16 => f64::from(u16::from_le_bytes([a, b])),
            Number::I32 => f64::from(i32::from_le_bytes([a, b, c, d])),
            Number::U32 => f64::from(u32::from_le_bytes([a, b, c, d])),
            Number::F32 => f64::from(f32::from_le_bytes([a, b, c, d])),
            Number::F64 => f64::from_le_bytes(bytes),
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Form {
    Text,
    Little,
    Big,
}

/// A property: the type of its numbers, and that of their count if it is a list.
#[derive(Debug)]
struct Property {
    name: String,
    number: Number,
    count: Option<Number>,
}

#[derive(Debug)]
struct Element {
    name: String,
    count: u64,
    properties: Vec<Property>,
}

/// Elements and properties that a header may name: more are no mesh.
const MOST_NAMES: usize = 256;

/// Corners of a face, at most.
const MOST_CORNERS: f64 = 1e6;

fn refuse<T>(text: impl Into<String>) -> Result<T> {
    Err(Error::Scene(text.into()))
}

/// Of a word of a file that is none of ours a few signs, and none that a terminal would obey.
fn shown(word: &str) -> String {
    word.chars().take(20).flat_map(char::escape_debug).collect()
}

/// The elements that a header names, their form, and where their numbers begin.
fn header(bytes: &[u8]) -> Result<(Form, Vec<Element>, usize)> {
    let (mut form, mut elements, mut at): (Option<Form>, Vec<Element>, usize) = (None, Vec::new(), 0);
    let mut names = 0;
    for line in 1.. {
        let rest = &bytes[at..];
        let Some(length) = rest.iter().position(|b| *b == b'\n') else {
            return refuse("ends within its header; allowed: a header up to `end_header`");
        };
        let text = String::from_utf8_lossy(&rest[..length]);
        at += length + 1;
        let words: Vec<&str> = text.split_whitespace().collect();
        if (line == 1) != (words[..] == ["ply"]) {
            return refuse(format!(
                "line {line}: `{}`; allowed: `ply` in the first line alone",
                shown(text.trim())
            ));
        }
        names += 1;
        if names > MOST_NAMES {
            return refuse(format!("a header of more than {MOST_NAMES} lines"));
        }
        match words[..] {
            ["ply"] | [] | ["comment" | "obj_info", ..] => {}
            ["format", name, "1.0"] => {
                form = Some(match name {
                    "ascii" => Form::Text,
                    "binary_little_endian" => Form::Little,
                    "binary_big_endian" => Form::Big,
                    other => {
                        return refuse(format!(
                            "line {line}: format `{}`; allowed: ascii, binary_little_endian, binary_big_endian",
                            shown(other)
                        ));
                    }
                });
            }
            ["element", name, count] => match count.parse() {
                Ok(count) => elements.push(Element { name: name.to_string(), count, properties: Vec::new() }),
                Err(_) => {
                    return refuse(format!("line {line}: `{}` is not a number of elements", shown(count)));
                }
            },
            ["property", ref rest @ ..] => {
                let property = match rest {
                    ["list", count, number, name] => {
                        Number::named(count).zip(Number::named(number)).map(|(count, number)| Property {
                            name: name.to_string(),
                            number,
                            count: Some(count),
                        })
                    }
                    [number, name] => Number::named(number).map(|number| Property {
                        name: name.to_string(),
                        number,
                        count: None,
                    }),
                    _ => None,
                };
                match (property, elements.last_mut()) {
                    (Some(property), Some(element)) => element.properties.push(property),
                    _ => {
                        return refuse(format!(
                            "line {line}: `{}`; allowed: `property float x`, `property list uchar int vertex_indices`, below an element",
                            shown(text.trim())
                        ));
                    }
                }
            }
            ["end_header"] => {
                let Some(form) = form else { return refuse("no line `format` in its header") };
                return Ok((form, elements, at));
            }
            _ => return refuse(format!("line {line}: unknown `{}` in its header", shown(text.trim()))),
        }
    }
    refuse("no header")
}

/// Numbers one after the other.
struct Numbers<'a> {
    form: Form,
    bytes: &'a [u8],
}

impl Numbers<'_> {
    fn next(&mut self, number: Number) -> Option<f64> {
        if self.form == Form::Text {
            let start = self.bytes.iter().position(|b| !b.is_ascii_whitespace())?;
            let word = &self.bytes[start..];
            let length = word.iter().position(u8::is_ascii_whitespace).unwrap_or(word.len());
            self.bytes = &word[length..];
            return std::str::from_utf8(&word[..length]).ok()?.parse().ok();
        }
        let (mut bytes, size) = ([0; 8], number.size());
        bytes[..size].copy_from_slice(self.bytes.get(..size)?);
        if self.form == Form::Big {
            bytes[..size].reverse();
        }
        self.bytes = &self.bytes[size..];
        Some(number.of(bytes))
    }
}

/// A mesh from the bytes of a PLY file, each position where `place` puts it: `x y z` of each `vertex` and the
/// `vertex_indices` of each `face` are read, `u v` or `s t` where they are there, `nx ny nz` too if normals have a `turn`, the
/// rest is passed over.
///
/// # Errors     `Error::Scene` that says what cannot be read, and where
pub(super) fn parse(bytes: &[u8], place: impl Fn(DVec3) -> DVec3, turn: Option<Turn<'_>>) -> Result<Mesh> {
    let (form, elements, start) = header(bytes)?;
    let mut numbers = Numbers { form, bytes: &bytes[start..] };
    let (mut positions, mut parameters) = (Vec::new(), Vec::new());
    // Corners of all faces, one after the other, and how many each has.
    let (mut rings, mut lengths) = (Vec::new(), Vec::new());
    let mut has_parameters = false;
    // One a vertex, 0 where there is none, if they are asked for.
    let (mut normals, mut has_normals) = (Vec::new(), false);
    for element in &elements {
        let find = |names: &[&str]| element.properties.iter().position(|p| names.contains(&p.name.as_str()));
        let (is_vertex, is_face) = (element.name == "vertex", element.name == "face");
        let number = |name| find(&[name]).filter(|i| element.properties[*i].count.is_none());
        let xyz = ["x", "y", "z"].map(number);
        let normal = match ["nx", "ny", "nz"].map(number) {
            [Some(x), Some(y), Some(z)] => Some([x, y, z]),
            _ => None,
        };
        has_normals |= is_vertex && turn.is_some() && normal.is_some();
        let uv = [find(&["u", "s", "texture_u"]), find(&["v", "t", "texture_v"])];
        let corners = find(&["vertex_indices", "vertex_index"]);
        if is_vertex && xyz.contains(&None) {
            return refuse("its vertices have no x, y and z; allowed: all three");
        }
        if is_face && corners.is_none_or(|i| element.properties[i].count.is_none()) {
            return refuse("its faces have no list vertex_indices; allowed: one");
        }
        has_parameters |= is_vertex && uv.iter().all(Option::is_some);
        // Every one takes a byte, or this ends soon.
        let count = if element.properties.is_empty() { 0 } else { element.count };
        let mut row = vec![0.0; element.properties.len()];
        for index in 0..count {
            let ends = || {
                Error::Scene(format!(
                    "ends, or has no number, in {} {index} of {count}",
                    shown(&element.name)
                ))
            };
            let mut ring = Vec::new();
            for (i, property) in element.properties.iter().enumerate() {
                let Some(count) = property.count else {
                    row[i] = numbers.next(property.number).ok_or_else(ends)?;
                    continue;
                };
                let length = numbers.next(count).ok_or_else(ends)?;
                if !(0.0..=MOST_CORNERS).contains(&length) {
                    return refuse(format!(
                        "a list of {length} in {} {index}; allowed: 0 to {MOST_CORNERS}",
                        shown(&element.name)
                    ));
                }
                for _ in 0..length as usize {
                    let corner = numbers.next(property.number).ok_or_else(ends)?;
                    if is_face && corners == Some(i) {
                        ring.push(corner);
                    }
                }
            }
            if is_vertex {
                let [x, y, z] = xyz.map(|i| i.map_or(0.0, |i| row[i]));
                let p = DVec3::new(x, y, z);
                if !p.is_finite() {
                    return refuse(format!("vertex {index} is not finite"));
                }
                positions.push(place(p));
                if let Some(turn) = turn {
                    let normal = normal.map_or(DVec3::ZERO, |places| DVec3::from(places.map(|i| row[i])));
                    if !normal.is_finite() {
                        return refuse(format!("the normal of vertex {index} is not finite"));
                    }
                    normals.push(turn(normal));
                }
                let [u, v] = uv.map(|i| i.map_or(0.0, |i| row[i]));
                parameters.push(DVec2::new(u, v));
            } else if is_face {
                if ring.len() < 3 {
                    return refuse(format!("face {index} has {} corners; allowed: 3 or more", ring.len()));
                }
                lengths.push(ring.len());
                rings.append(&mut ring);
            }
        }
    }
    let highest = positions.len() as f64;
    if let Some(bad) = rings.iter().find(|corner| !(0.0..highest).contains(*corner)) {
        return refuse(format!("a face names vertex {bad}; allowed: 0 to {}", highest - 1.0));
    }
    if rings.is_empty() {
        return refuse("no faces; a mesh needs at least one");
    }
    // Now that all vertices are known, which may stand behind the faces.
    let rings: Vec<u32> = rings.into_iter().map(|corner| corner as u32).collect();
    let (mut triangles, mut rest) = (Vec::with_capacity(lengths.len()), &rings[..]);
    for (index, length) in lengths.into_iter().enumerate() {
        let (ring, behind) = rest.split_at(length);
        rest = behind;
        if let Err(what) = cut(ring, |i: u32| positions[i as usize], |corners| triangles.push(corners)) {
            return refuse(format!("face {index} has {what}"));
        }
    }
    let uvs: Option<Vec<[DVec2; 3]>> = has_parameters
        .then(|| triangles.iter().map(|corners| corners.map(|i| parameters[i as usize])).collect());
    if !has_normals {
        return Mesh::new(&positions, &triangles, uvs.as_deref());
    }
    let normals: Vec<[DVec3; 3]> =
        triangles.iter().map(|corners| corners.map(|i| normals[i as usize])).collect();
    Mesh::smooth(&positions, &triangles, uvs.as_deref(), &normals)
}

impl Mesh {
    /// The bytes of a PLY file: binary, in double precision, corners that triangles share once; with the normals of a smooth
    /// mesh.
    pub fn to_ply(&self) -> Vec<u8> {
        let mut places = std::collections::HashMap::new();
        let (mut vertices, mut faces) = (Vec::new(), Vec::new());
        for number in 0..self.len() as u32 {
            let normals = if self.is_smooth() { self.normals(number) } else { [DVec3::ZERO; 3] };
            let corners = self.triangle(number);
            faces.push([0, 1, 2].map(|i| {
                let (p, normal) = (corners[i], normals[i]);
                // Adding 0 makes -0 the same as 0.
                let key = [p, normal].map(|v| (v + DVec3::ZERO).to_array().map(f64::to_bits));
                *places.entry(key).or_insert_with(|| {
                    vertices.push((p, normal));
                    vertices.len() as u32 - 1
                })
            }));
        }
        let names = if self.is_smooth() { &["x", "y", "z", "nx", "ny", "nz"][..] } else { &["x", "y", "z"] };
        let properties: String = names.iter().map(|name| format!("property double {name}\n")).collect();
        let mut bytes = format!(
            "ply\nformat binary_little_endian 1.0\nelement vertex {}\n{properties}\
             element face {}\nproperty list uchar uint vertex_indices\nend_header\n",
            vertices.len(),
            faces.len()
        )
        .into_bytes();
        for (p, normal) in vertices {
            let numbers = p.to_array().into_iter().chain(normal.to_array());
            numbers.take(names.len()).for_each(|x| bytes.extend(x.to_le_bytes()));
        }
        for corners in faces {
            bytes.push(3);
            corners.into_iter().for_each(|corner| bytes.extend(corner.to_le_bytes()));
        }
        bytes
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SQUARE: &str = "ply\nformat ascii 1.0\ncomment a square\nelement vertex 4\nproperty float x\nproperty float y\n\
                          property float z\nproperty float nx\nelement face 1\nproperty list uchar int vertex_index\nend_header\n\
                          0 0 0 1\n2 0 0 1\n2 3 0 1\n0 3 0 1\n4 0 1 2 3\n";

    #[test]
    fn text_and_both_orders_of_bytes_are_one_mesh() {
        let square = parse(SQUARE.as_bytes(), |p| p, None).unwrap();
        assert_eq!((square.len(), square.area()), (2, 6.0));
        for (name, is_big) in [("binary_little_endian", false), ("binary_big_endian", true)] {
            let mut bytes = SQUARE.split("0 0 0 1").next().unwrap().replace("ascii", name).into_bytes();
            let mut put = |low_first: &[u8]| {
                let mut number = low_first.to_vec();
                if is_big {
                    number.reverse();
                }
                bytes.extend(number);
            };
            for corner in [[0.0f32, 0.0], [2.0, 0.0], [2.0, 3.0], [0.0, 3.0]] {
                [corner[0], corner[1], 0.0, 1.0].iter().for_each(|x| put(&x.to_le_bytes()));
            }
            put(&[4]);
            (0i32..4).for_each(|i| put(&i.to_le_bytes()));
            assert_eq!(parse(&bytes, |p| p, None).unwrap(), square);
            bytes.pop();
            let short = parse(&bytes, |p| p, None).unwrap_err().to_string();
            assert_eq!(short, "ends, or has no number, in face 0 of 1");
        }
    }

    /// Faces may stand before their vertices, and need not be convex.
    #[test]
    fn polygons_that_are_not_convex() {
        let arrow = "ply\nformat ascii 1.0\nelement face 2\nproperty list uchar int vertex_indices\nelement vertex 4\n\
                     property float x\nproperty float y\nproperty float z\nend_header\n\
                     4 0 1 2 3\n3 0 1 2\n0 0 0\n2 0 0\n2 2 0\n1.75 0.25 0\n";
        let mesh = parse(arrow.as_bytes(), |p| p, None).unwrap();
        assert_eq!((mesh.len(), mesh.area()), (3, 2.5));
    }

    /// What is written reads back to the last bit, in whatever order the tree has the triangles.
    #[test]
    fn written_meshes_read_back() {
        let positions =
            [[0.1, 0.2, 0.3], [1.0 / 3.0, 0.0, 1e-20], [0.0, 7.0, -1.0], [5.0, 5.0, 5.0]].map(DVec3::from);
        let mesh = Mesh::new(&positions, &[[0, 1, 2], [2, 1, 3], [0, 2, 3]], None).unwrap();
        let again = parse(&mesh.to_ply(), |p| p, None).unwrap();
        let corners = |mesh: &Mesh| {
            let mut all: Vec<_> = (0..mesh.len() as u32)
                .map(|i| mesh.triangle(i).map(|p| p.to_array().map(f64::to_bits)))
                .collect();
            all.sort_unstable();
            all
        };
        assert_eq!(corners(&mesh), corners(&again));
    }

    #[test]
    fn wrong_files_say_what_is_wrong() {
        let with = |from: &str, to: &str| SQUARE.replacen(from, to, 1);
        let cases = [
            (String::new(), "ends within its header; allowed: a header up to `end_header`"),
            ("plx\n".into(), "line 1: `plx`; allowed: `ply` in the first line alone"),
            (
                with("ascii", "gzip"),
                "line 2: format `gzip`; allowed: ascii, binary_little_endian, binary_big_endian",
            ),
            (with("element vertex 4", "element vertex -4"), "line 4: `-4` is not a number of elements"),
            (
                with("element vertex 4", "element vertex 999999999999"),
                "ends, or has no number, in vertex 5 of 999999999999",
            ),
            (with("float z", "float w"), "its vertices have no x, y and z; allowed: all three"),
            (with("vertex_index", "corners"), "its faces have no list vertex_indices; allowed: one"),
            (with("4 0 1 2 3", "4 0 1 2 4"), "a face names vertex 4; allowed: 0 to 3"),
            (with("4 0 1 2 3", "4 0 1 2 -1"), "a face names vertex -1; allowed: 0 to 3"),
            (
                with("4 0 1 2 3", "4 0 2 1 3"),
                "face 0 has sides that cross each other; allowed: polygons without",
            ),
            (with("4 0 1 2 3", "2 0 1"), "face 0 has 2 corners; allowed: 3 or more"),
            (with("4 0 1 2 3", "9e9 0 1"), "a list of 9000000000 in face 0; allowed: 0 to 1000000"),
            (with("2 3 0 1", "2 inf 0 1"), "vertex 2 is not finite"),
            (with("2 3 0 1", "2 x 0 1"), "ends, or has no number, in vertex 2 of 4"),
            (with("element face 1", "element face 0"), "no faces; a mesh needs at least one"),
            (
                with("property float x", "property half x"),
                "line 5: `property half x`; allowed: `property float x`, `property list uchar int vertex_indices`, below an element",
            ),
            (with("element face 1", "element nothing 99999999999999\nelement face 1"), ""),
        ];
        for (text, expected) in cases {
            let said = parse(text.as_bytes(), |p| p, None).err().map_or(String::new(), |e| e.to_string());
            assert_eq!(said, expected, "{text}");
        }
    }
}
