//! Headers and records of PLY files.

use super::header::{Body, Header, check_size};
use super::layout::{Layout, Number, Place, whole_emitted};
use std::io::{BufRead, Read};

/// Longer headers are refused.
const MOST_HEADER: u64 = 1 << 16;

/// A property of a vertex: its name, and where it stands.
type Property = (String, Place);

/// What the header has said so far.
#[derive(Default)]
struct Said {
    is_text: Option<bool>,
    count: Option<u64>,
    properties: Vec<Property>,
    size: usize,
    /// Elements so far.
    elements: u32,
    emitted: Option<u64>,
}

/// What the header of a file of so many bytes says; its first four bytes have been read.
///
/// # Errors
/// What is wrong with it, and what is allowed
///
/// # Source
/// Turk 1994, The PLY Polygon File Format
pub(super) fn header(input: &mut impl BufRead, length: u64) -> Result<Header, String> {
    let mut limited = input.take(MOST_HEADER);
    let mut said = Said::default();
    let mut line = Vec::new();
    let mut number = 1;
    loop {
        line.clear();
        limited.read_until(b'\n', &mut line).map_err(|cause| format!("cannot read it: {cause}"))?;
        if !line.ends_with(b"\n") {
            return Err(match limited.limit() {
                0 => format!("has a header of more than {MOST_HEADER} bytes"),
                _ => format!("ends after {length} bytes, within its header"),
            });
        }
        // Where lines end with two characters, the second of the first line is still to come.
        if number == 1 && line == b"\n" {
            continue;
        }
        number += 1;
        let text = std::str::from_utf8(&line).map_err(|_| format!("line {number} is not text"))?;
        let words: Vec<&str> = text.split_whitespace().collect();
        if words[..] == ["end_header"] {
            break;
        }
        said.take(&words).map_err(|what| format!("line {number}: {what}"))?;
    }
    let read = 4 + MOST_HEADER - limited.limit();
    let rest = length.saturating_sub(read);
    let is_text = said.is_text.ok_or("its header has no line `format`")?;
    let count = said.count.ok_or("its header has no element vertex")?;
    let (layout, is_alone) = (said.layout()?, said.elements == 1);
    if is_text {
        // A digit and what parts it from the next, of each number; the last line may have no end.
        let least = count.checked_mul(2 * said.properties.len() as u64).and_then(|n| n.checked_sub(1));
        if count > 0 && least.is_none_or(|least| least > rest) {
            return Err(format!(
                "its header promises {count} photons, {rest} bytes follow; allowed: as many as it promises"
            ));
        }
        return Ok(Header { count, body: Body::Text(layout), is_alone, emitted: said.emitted });
    }
    check_size(count, layout.size, rest, is_alone)?;
    Ok(Header { count, body: Body::Binary(layout), is_alone, emitted: said.emitted })
}

impl Said {
    /// Takes a line of the header.
    fn take(&mut self, words: &[&str]) -> Result<(), String> {
        match words {
            ["format", format, "1.0"] => {
                self.is_text = Some(match *format {
                    "ascii" => true,
                    "binary_little_endian" => false,
                    _ => return Err(format!("format is {format}; allowed: binary_little_endian, ascii")),
                });
            }
            ["format", ..] => return Err("format; allowed: binary_little_endian 1.0, ascii 1.0".into()),
            ["comment", "emitted", number] => {
                let number =
                    number.parse::<f64>().map_err(|_| format!("emitted is {number}; allowed: a number"))?;
                if self.emitted.replace(whole_emitted(number)?).is_some() {
                    return Err("emitted for the second time".into());
                }
            }
            [] | ["comment" | "obj_info", ..] => {}
            ["element", name, count] => {
                self.elements += 1;
                if self.elements == 1 {
                    if *name != "vertex" {
                        return Err(format!("element {name}; allowed: vertex first, a photon each"));
                    }
                    let count =
                        count.parse().map_err(|_| format!("{count} vertices; allowed: a whole number"))?;
                    self.count = Some(count);
                } else if *name == "vertex" {
                    return Err("element vertex for the second time".into());
                }
            }
            ["property", kind, name] if self.elements == 1 => self.property(kind, name)?,
            ["property", "list", ..] if self.elements == 1 => {
                return Err("a vertex has a list; allowed: numbers".into());
            }
            ["property", ..] if self.elements > 1 => {}
            _ => return Err(format!("`{}` is no line of a header", words.join(" "))),
        }
        Ok(())
    }

    fn property(&mut self, kind: &str, name: &str) -> Result<(), String> {
        let number = match kind {
            "char" | "int8" => Number::Signed(1),
            "uchar" | "uint8" => Number::Unsigned(1),
            "short" | "int16" => Number::Signed(2),
            "ushort" | "uint16" => Number::Unsigned(2),
            "int" | "int32" => Number::Signed(4),
            "uint" | "uint32" => Number::Unsigned(4),
            "float" | "float32" => Number::F32,
            "double" | "float64" => Number::F64,
            _ => return Err(format!("property {name} is of the unknown type {kind}")),
        };
        if self.properties.iter().any(|(known, _)| known == name) {
            return Err(format!("property {name} for the second time"));
        }
        self.properties.push((name.to_string(), Place { offset: self.size, number }));
        self.size += number.size();
        Ok(())
    }

    /// Where the numbers of a photon stand; those of a line are doubles.
    fn layout(&self) -> Result<Layout, String> {
        const ALL: &str = "x, y, z, dir_x, dir_y, dir_z, power_r, power_g, power_b, order, and class and emitted, if they are there";
        let is_text = self.is_text == Some(true);
        let find = |name: &str| {
            let index = self.properties.iter().position(|(known, _)| known == name)?;
            Some(match is_text {
                true => Place { offset: 8 * index, number: Number::F64 },
                false => self.properties[index].1,
            })
        };
        let needed =
            |name: &str| find(name).ok_or_else(|| format!("the property {name} is missing; allowed: {ALL}"));
        let vector = |[x, y, z]: [&str; 3]| Ok::<_, String>([needed(x)?, needed(y)?, needed(z)?]);
        let is_float = |name: &str| {
            let kind = self.properties.iter().find(|(known, _)| known == name);
            kind.is_none_or(|(_, place)| place.number.is_float())
        };
        let vectors = [["x", "y", "z"], ["dir_x", "dir_y", "dir_z"], ["power_r", "power_g", "power_b"]];
        if let Some(name) = vectors.iter().flatten().find(|name| !is_float(name)) {
            return Err(format!("the property {name} is a whole number; allowed: float or double"));
        }
        Ok(Layout {
            size: if is_text { 8 * self.properties.len() } else { self.size },
            position: vector(vectors[0])?,
            direction: vector(vectors[1])?,
            power: vector(vectors[2])?,
            order: needed("order")?,
            class: find("class"),
            emitted: find("emitted"),
        })
    }
}
