//! Photons as records of a NumPy array.

use super::header::{Body, Header, check_size};
use super::layout::{Layout, Number, Place};
use crate::input::literal::Literal;
use crate::input::npy::NpyHeader;
use std::io::Read;

/// Larger records are refused.
const MOST_RECORD: u64 = 1 << 20;

/// A field of a record: where it begins, of what type, how many of them.
struct Field<'a> {
    name: &'a str,
    kind: &'a str,
    offset: usize,
    count: u64,
    /// Whether it has a shape of its own.
    is_vector: bool,
}

/// What the header of a file of so many bytes says, from its first one on.
///
/// # Errors
/// What is wrong with it, and what is allowed
pub(super) fn header(input: &mut impl Read, length: u64) -> Result<Header, String> {
    let NpyHeader { descr, is_fortran, shape, rest } = NpyHeader::read(input, length)?;
    if is_fortran {
        return Err("is in Fortran order; allowed: 'fortran_order': False".into());
    }
    let [count] = shape[..] else {
        return Err(format!("has {} axes; allowed: one", shape.len()));
    };
    let layout = match &descr {
        Literal::List(fields) => layout(&fields_of(fields)?)?,
        Literal::Text(kind) => {
            return Err(format!("has numbers of type '{kind}'; allowed: records with the fields {FIELDS}"));
        }
        _ => return Err("its header has no type `descr`".into()),
    };
    check_size(count, layout.size, rest, true)?;
    Ok(Header { count, body: Body::Binary(layout), is_alone: true, emitted: None })
}

const FIELDS: &str = "position, direction, power, order, and class and emitted, if they are there";

/// The fields of a record, each behind the one before.
fn fields_of(fields: &[Literal]) -> Result<Vec<Field<'_>>, String> {
    let mut offset = 0;
    let mut found = Vec::new();
    for field in fields {
        let Literal::List(parts) = field else { return Err("a field of its type is no tuple".into()) };
        let (name, kind, shape) = match &parts[..] {
            [name, kind] => (name, kind, None),
            [name, kind, Literal::List(shape)] => (name, kind, Some(shape)),
            _ => return Err("a field of its type is no tuple of name, type and shape".into()),
        };
        let name = match name {
            Literal::Text(name) => name,
            // A title and the name.
            Literal::List(names) => match &names[..] {
                [_, Literal::Text(name)] => name,
                _ => return Err("a field of its type has no name".into()),
            },
            _ => return Err("a field of its type has no name".into()),
        };
        let Literal::Text(kind) = kind else {
            return Err(format!("the field {name} has fields itself; allowed: numbers"));
        };
        let mut count = 1u64;
        for axis in shape.into_iter().flatten() {
            let Literal::Number(size) = axis else { return Err(format!("the field {name} has no shape")) };
            count = count.checked_mul(*size).ok_or_else(|| format!("the field {name} is too large"))?;
        }
        let size =
            size_of_kind(kind).ok_or_else(|| format!("the field {name} is of the unknown type '{kind}'"))?;
        found.push(Field { name, kind, offset, count, is_vector: shape.is_some() });
        let size = usize::try_from(count).ok().and_then(|count| count.checked_mul(size));
        let end = size.and_then(|size| size.checked_add(offset)).filter(|end| *end as u64 <= MOST_RECORD);
        offset = end.ok_or_else(|| format!("the field {name} is too large"))?;
    }
    // One without a name says where the record ends.
    found.push(Field { name: "", kind: "", offset, count: 0, is_vector: false });
    Ok(found)
}

/// Bytes of one item of a type such as `<f8`.
fn size_of_kind(kind: &str) -> Option<usize> {
    let rest = kind.strip_prefix(['<', '>', '|', '=']).unwrap_or(kind);
    // Of dates the unit stands behind it.
    let rest = rest.split('[').next()?;
    let letter = rest.chars().next()?;
    let size: usize = rest.get(1..)?.parse().ok()?;
    match letter {
        'b' | 'i' | 'u' | 'f' | 'c' | 'S' | 'a' | 'V' | 'm' | 'M' => Some(size),
        'U' => size.checked_mul(4),
        _ => None,
    }
}

/// The type of numbers, if it is one that photons are made of.
fn number(kind: &str) -> Option<Number> {
    Some(match kind {
        "<f4" => Number::F32,
        "<f8" => Number::F64,
        "|u1" | "<u1" => Number::Unsigned(1),
        "<u2" => Number::Unsigned(2),
        "<u4" => Number::Unsigned(4),
        "<u8" => Number::Unsigned(8),
        "|i1" | "<i1" => Number::Signed(1),
        "<i2" => Number::Signed(2),
        "<i4" => Number::Signed(4),
        "<i8" => Number::Signed(8),
        _ => return None,
    })
}

fn layout(fields: &[Field<'_>]) -> Result<Layout, String> {
    let find = |name: &str| fields.iter().find(|field| field.name == name);
    let vector = |name: &str| {
        let field = find(name).ok_or_else(|| format!("the field {name} is missing; allowed: {FIELDS}"))?;
        match number(field.kind).filter(|number| number.is_float() && field.count == 3 && field.is_vector) {
            Some(number) => {
                Ok([0, 1, 2].map(|axis| Place { offset: field.offset + axis * number.size(), number }))
            }
            None => Err(format!(
                "the field {name} is {} of type '{}'; allowed: 3 of '<f4' or '<f8'",
                field.count, field.kind
            )),
        }
    };
    let scalar = |name: &str| {
        let Some(field) = find(name) else { return Ok(None) };
        match number(field.kind).filter(|_| field.count == 1) {
            Some(number) => Ok(Some(Place { offset: field.offset, number })),
            None => Err(format!(
                "the field {name} is {} of type '{}'; allowed: one number, little endian, such as '<u8'",
                field.count, field.kind
            )),
        }
    };
    Ok(Layout {
        size: fields.last().map_or(0, |end| end.offset),
        position: vector("position")?,
        direction: vector("direction")?,
        power: vector("power")?,
        order: scalar("order")?.ok_or_else(|| format!("the field order is missing; allowed: {FIELDS}"))?,
        class: scalar("class")?,
        emitted: scalar("emitted")?,
    })
}
