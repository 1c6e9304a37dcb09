//! Meshes from Wavefront OBJ files.
//!
//! Read here and not by a crate, since the crates' errors do not say in which line a file is wrong.

use super::Mesh;
use super::polygon::cut;
use super::shading::Turn;
use crate::error::{Error, Result};
use glam::{DVec2, DVec3};

/// Statements that say nothing about the triangles.
const PASSED_OVER: [&str; 15] = [
    "vp",
    "g",
    "o",
    "s",
    "mg",
    "usemtl",
    "mtllib",
    "l",
    "p",
    "lod",
    "bevel",
    "c_interp",
    "d_interp",
    "shadow_obj",
    "trace_obj",
];

/// What has been read so far.
#[derive(Default)]
struct Obj<'a> {
    positions: Vec<DVec3>,
    parameters: Vec<DVec2>,
    triangles: Vec<[u32; 3]>,
    uvs: Vec<[DVec2; 3]>,
    has_uvs: bool,
    /// What is to become of normals, if they are read.
    turn: Option<Turn<'a>>,
    normals: Vec<DVec3>,
    /// Those of the triangles' corners, 0 where there is none.
    shading: Vec<[DVec3; 3]>,
    has_normals: bool,
}

/// Surface parameters beyond have lost the place within a picture that repeats.
const MOST_UV: f64 = 1e9;

/// What is wrong, and in which line if in one.
#[derive(Debug, PartialEq)]
enum Failure {
    At(usize, String),
    Whole(String),
}

/// What the file says of a corner: position, surface parameters, normal.
type Corner = (u32, Option<DVec2>, Option<DVec3>);

/// A mesh from the text of a Wavefront OBJ file: `v`, `vt` and `f` are read, `vn` if normals have a `turn`, the rest is passed over.
///
/// # Errors     `Error::Scene` with name and line for what cannot be read
pub(super) fn read(
    name: &str,
    text: &str,
    place: impl Fn(DVec3) -> DVec3,
    turn: Option<Turn<'_>>,
) -> Result<Mesh> {
    parse(text, place, turn).map_err(|e| match e {
        Failure::At(line, what) => Error::Scene(format!("{name}:{line}: {what}")),
        Failure::Whole(what) => Error::Scene(format!("{name}: {what}")),
    })
}

fn parse(
    text: &str,
    place: impl Fn(DVec3) -> DVec3,
    turn: Option<Turn<'_>>,
) -> std::result::Result<Mesh, Failure> {
    let mut obj = Obj { turn, ..Obj::default() };
    for (i, line) in text.lines().enumerate() {
        let line = line.split('#').next().unwrap_or_default();
        obj.statement(line).map_err(|what| Failure::At(i + 1, what))?;
    }
    if obj.triangles.is_empty() {
        return Err(Failure::Whole("no faces; a mesh needs at least one line `f`".into()));
    }
    let positions: Vec<DVec3> = obj.positions.into_iter().map(place).collect();
    let uvs = obj.has_uvs.then_some(&obj.uvs[..]);
    match obj.has_normals {
        true => Mesh::smooth(&positions, &obj.triangles, uvs, &obj.shading),
        false => Mesh::new(&positions, &obj.triangles, uvs),
    }
    .map_err(|e| Failure::Whole(e.to_string()))
}

impl Obj<'_> {
    fn statement(&mut self, line: &str) -> std::result::Result<(), String> {
        let mut words = line.split_whitespace();
        match words.next() {
            None => Ok(()),
            Some("v") => {
                // Some programs add a weight or a color, which say nothing about the place.
                let numbers = numbers(words)?;
                let [x, y, z, ..] = numbers[..] else {
                    return Err(format!("a vertex `v` of {} numbers; allowed: x y z", numbers.len()));
                };
                self.positions.push(DVec3::new(x, y, z));
                Ok(())
            }
            Some("vt") => {
                let numbers = numbers(words)?;
                let [u, ref rest @ ..] = numbers[..] else {
                    return Err("surface parameters `vt` without a number; allowed: u, or u v".into());
                };
                let v = rest.first().copied().unwrap_or(0.0);
                if let Some(far) = [u, v].iter().find(|x| x.abs() > MOST_UV) {
                    return Err(format!(
                        "surface parameters `vt` of {far:e}; allowed: -{MOST_UV:e} to {MOST_UV:e}"
                    ));
                }
                self.parameters.push(DVec2::new(u, v));
                Ok(())
            }
            Some("vn") => {
                let Some(turn) = self.turn else { return Ok(()) };
                let numbers = numbers(words)?;
                let [x, y, z] = numbers[..] else {
                    return Err(format!("a normal `vn` of {} numbers; allowed: x y z", numbers.len()));
                };
                self.normals.push(turn(DVec3::new(x, y, z)));
                Ok(())
            }
            Some("f") => self.face(words),
            Some(word) if PASSED_OVER.contains(&word) => Ok(()),
            Some(word) => Err(format!(
                "unknown statement `{}`; allowed: v, vt, vn, f, o, g, s, mtllib, usemtl",
                shown(word)
            )),
        }
    }

    /// A polygon.
    fn face<'a>(&mut self, words: impl Iterator<Item = &'a str>) -> std::result::Result<(), String> {
        let corners: Vec<Corner> =
            words.map(|word| self.corner(word)).collect::<std::result::Result<_, _>>()?;
        if corners.len() < 3 {
            return Err(format!("a face of {} corners; allowed: 3 or more", corners.len()));
        }
        let positions = std::mem::take(&mut self.positions);
        let is_cut =
            cut(&corners, |(place, ..)| positions[place as usize], |triangle| self.triangle(triangle));
        self.positions = positions;
        is_cut.map_err(|what| format!("a face of {what}"))
    }

    fn triangle(&mut self, corners: [Corner; 3]) {
        self.triangles.push(corners.map(|(place, ..)| place));
        if self.turn.is_some() {
            self.has_normals |= corners.iter().any(|(.., normal)| normal.is_some());
            self.shading.push(corners.map(|(.., normal)| normal.unwrap_or_default()));
        }
        if let [Some(a), Some(b), Some(c)] = corners.map(|(_, uv, _)| uv) {
            self.has_uvs = true;
            self.uvs.push([a, b, c]);
        } else {
            self.uvs.push([DVec2::ZERO, DVec2::X, DVec2::Y]);
        }
    }

    /// `position`, `position/parameters`, `position//normal` or `position/parameters/normal`.
    fn corner(&self, word: &str) -> std::result::Result<Corner, String> {
        let mut parts = word.split('/');
        let first = parts.next().unwrap_or_default();
        let position = place(first, self.positions.len(), "vertex")?;
        let uv = match parts.next() {
            None | Some("") => None,
            Some(part) => Some(self.parameters[place(part, self.parameters.len(), "vt")?]),
        };
        let normal = match parts.next() {
            Some(part) if self.turn.is_some() && !part.is_empty() => {
                Some(self.normals[place(part, self.normals.len(), "vn")?])
            }
            _ => None,
        };
        Ok((position as u32, uv, normal))
    }
}

/// A place in a list: counted from 1, or backwards from the end with -1.
fn place(word: &str, count: usize, what: &str) -> std::result::Result<usize, String> {
    let allowed = || {
        if count == 0 {
            format!("no {what} stands before this line")
        } else {
            format!("allowed: 1 to {count}, or -{count} to -1")
        }
    };
    let index: i64 = word.parse().map_err(|_| {
        format!("a face names {what} `{}`, which is no whole number; {}", shown(word), allowed())
    })?;
    let from_start = if index < 0 { index + count as i64 } else { index - 1 };
    usize::try_from(from_start)
        .ok()
        .filter(|i| *i < count)
        .ok_or_else(|| format!("a face names {what} {index}; {}", allowed()))
}

/// Of a word of a file that is none of ours a few signs, and none that a terminal would obey.
fn shown(word: &str) -> String {
    word.chars().take(20).flat_map(char::escape_debug).collect()
}

/// Finite numbers.
fn numbers<'a>(words: impl Iterator<Item = &'a str>) -> std::result::Result<Vec<f64>, String> {
    words
        .map(|word| match word.parse::<f64>() {
            Ok(number) if number.is_finite() => Ok(number),
            _ => Err(format!("`{}` is not a finite number", shown(word))),
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A quadrilateral as two triangles; indices from the end, with and without parameters.
    #[test]
    fn polygons_and_places() {
        let text = "# square\nv 0 0 0\nv 1 0 0 # right\nv 1 1 0\r\nv 0 1 0 1.0\n\nvt 0 0\nvt 1 1 0\nvn 0 0 1\n\
                    usemtl x\nf -4/1/1 2/2 3/-1/1 4/1\nf 1//1 2//1 4\n";
        let mesh = parse(text, |p| p, None).unwrap();
        assert_eq!((mesh.len(), mesh.area()), (3, 1.5));
    }

    /// Regular polygons of 3 to 800 corners, of n - 2 triangles that turn alike; parameters go with their corners.
    #[test]
    fn polygons_of_many_corners() {
        for n in (3..40).chain([800]) {
            let angle = |i: u32| std::f64::consts::TAU * f64::from(i) / f64::from(n);
            let mut text = String::new();
            for i in 0..n {
                let (sin, cos) = crate::math::sin_cos(angle(i));
                text += &format!("v {cos} {sin} 0\nvt {} {}\n", 3.0 * cos, 3.0 * sin);
            }
            text += "f";
            (1..=n).for_each(|i| text += &format!(" {i}/{i}"));
            let mut obj = Obj::default();
            text.lines().for_each(|line| obj.statement(line).unwrap());
            assert_eq!(obj.triangles.len(), n as usize - 2);
            for (corners, uvs) in obj.triangles.iter().zip(&obj.uvs) {
                let [a, b, c] = corners.map(|i| obj.positions[i as usize]);
                assert!((b - a).cross(c - a).z > 0.0);
                assert_eq!(*uvs, [a, b, c].map(|p| 3.0 * p.truncate()));
            }
            let mesh = parse(&text, |p| p, None).unwrap();
            let area = 0.5 * f64::from(n) * crate::math::sin_cos(angle(1)).0;
            assert!((mesh.area() / area - 1.0).abs() < 1e-12, "{n}");
        }
    }

    /// Each wrong file names its line and what is allowed.
    #[test]
    fn errors_name_the_line() {
        let square = "v 0 0 0\nv 1 0 0\nv 1 1 0\n";
        let at = |line: usize, what: &str| Failure::At(line, what.to_string());
        let cases = [
            ("v 0 0\n".to_string(), at(1, "a vertex `v` of 2 numbers; allowed: x y z")),
            ("v 0 0 nan\n".to_string(), at(1, "`nan` is not a finite number")),
            ("v 0 0 1e400\n".to_string(), at(1, "`1e400` is not a finite number")),
            ("vt 0 -1e308\n".to_string(), at(1, "surface parameters `vt` of -1e308; allowed: -1e9 to 1e9")),
            ("f 1 2 3\n".to_string(), at(1, "a face names vertex 1; no vertex stands before this line")),
            (format!("{square}f 1 2 4\n"), at(4, "a face names vertex 4; allowed: 1 to 3, or -3 to -1")),
            (format!("{square}f 0 2 3\n"), at(4, "a face names vertex 0; allowed: 1 to 3, or -3 to -1")),
            (format!("{square}f 1 2 -4\n"), at(4, "a face names vertex -4; allowed: 1 to 3, or -3 to -1")),
            (format!("{square}f 1 2\n"), at(4, "a face of 2 corners; allowed: 3 or more")),
            (
                format!("{square}v 0 2 0\nf 1 3 2 4\n"),
                at(5, "a face of sides that cross each other; allowed: polygons without"),
            ),
            (format!("{square}f 1/1 2/1 3/1\n"), at(4, "a face names vt 1; no vt stands before this line")),
            (
                format!("{square}f 1 2 x\n"),
                at(4, "a face names vertex `x`, which is no whole number; allowed: 1 to 3, or -3 to -1"),
            ),
            (
                format!("{square}face 1 2 3\n"),
                at(4, "unknown statement `face`; allowed: v, vt, vn, f, o, g, s, mtllib, usemtl"),
            ),
            (square.to_string(), Failure::Whole("no faces; a mesh needs at least one line `f`".into())),
            (
                format!("{square}f 1 1 2\n"),
                Failure::Whole("a mesh needs a triangle with an area; here none of 1".into()),
            ),
        ];
        for (text, expected) in cases {
            assert_eq!(parse(&text, |p| p, None).err(), Some(expected), "{text}");
        }
    }
}
