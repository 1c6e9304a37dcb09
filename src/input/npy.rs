//! Headers of NumPy arrays: the type, the order and the shape of what follows.

use super::literal::Literal;
use std::io::Read;

/// Larger headers are refused; NumPy itself refuses those of more than 10,000 characters.
const MOST_HEADER: u64 = 1 << 20;

/// What the header of an array says.
#[derive(Debug)]
pub(crate) struct NpyHeader {
    /// The type as Python writes it: a text such as `'<f8'`, or a list of fields.
    pub descr: Literal,
    /// Whether the first index runs fastest; the last does otherwise.
    pub is_fortran: bool,
    /// Elements along each axis.
    pub shape: Vec<u64>,
    /// Bytes of the file behind the header.
    pub rest: u64,
}

impl NpyHeader {
    /// The header of a file of so many bytes, from its first one on.
    ///
    /// # Errors
    /// What is wrong with it, and what is allowed
    ///
    /// # Source
    /// NEP 1, A Simple File Format for NumPy Arrays
    pub fn read(input: &mut impl Read, length: u64) -> Result<Self, String> {
        let ends_early = |_| format!("ends after {length} bytes, within its header");
        let mut start = [0; 8];
        input.read_exact(&mut start).map_err(ends_early)?;
        let [magic @ .., major, minor] = start;
        if magic != *b"\x93NUMPY" {
            return Err("does not begin as a NumPy array; allowed: one of version 1, 2 or 3".into());
        }
        let mut size = [0; 4];
        let digits = match major {
            1 => 2,
            2 | 3 => 4,
            _ => return Err(format!("is a NumPy array of version {major}.{minor}; allowed: 1, 2 and 3")),
        };
        input.read_exact(&mut size[..digits]).map_err(ends_early)?;
        let (size, before) = (u64::from(u32::from_le_bytes(size)), 8 + digits as u64);
        if size > MOST_HEADER {
            return Err(format!("has a header of {size} bytes; allowed: up to {MOST_HEADER}"));
        }
        if before + size > length {
            return Err(format!("ends after {length} bytes, within its header of {size}"));
        }
        let mut text = vec![0; size as usize];
        input.read_exact(&mut text).map_err(ends_early)?;
        let text = String::from_utf8(text).map_err(|_| "its header is not text".to_string())?;
        let dict = Literal::parse(&text)?;
        let Some(Literal::Truth(is_fortran)) = dict.get("fortran_order") else {
            return Err("its header has no truth `fortran_order`".into());
        };
        let Some(Literal::List(axes)) = dict.get("shape") else {
            return Err("its header has no tuple `shape`".into());
        };
        let whole = |axis: &Literal| if let Literal::Number(n) = axis { Some(*n) } else { None };
        let shape = axes.iter().map(whole).collect::<Option<Vec<u64>>>();
        let shape = shape.ok_or("its header has a `shape` of other things than whole numbers")?;
        let descr = dict.get("descr").ok_or("its header has no type `descr`")?.clone();
        Ok(NpyHeader { descr, is_fortran: *is_fortran, shape, rest: length - before - size })
    }
}
