//! Records of photons, read one after the other.

use super::header::Body;
use super::layout::Layout;
use std::io::{BufRead, Read};

/// Longer lines are refused.
const MOST_LINE: u64 = 1 << 12;

/// Records, one after the other.
pub(super) enum Rows {
    /// Bytes as they are.
    Binary(Vec<u8>),
    /// A line, and its numbers as doubles.
    Text(Vec<u8>, Vec<u8>),
}

impl Rows {
    /// Those of a body, and where the numbers of a photon stand in them.
    pub fn of(body: Body) -> (Self, Layout) {
        match body {
            Body::Binary(layout) => (Rows::Binary(vec![0; layout.size]), layout),
            Body::Text(layout) => (Rows::Text(Vec::new(), vec![0; layout.size]), layout),
        }
    }

    /// The next record.
    ///
    /// # Errors
    /// A file that ends, or a line that has not the numbers it should have
    pub fn next(&mut self, input: &mut impl BufRead) -> Result<&[u8], String> {
        match self {
            Rows::Binary(record) => match input.read_exact(record) {
                Ok(()) => Ok(record),
                Err(cause) => Err(format!("the file ends early: {cause}")),
            },
            Rows::Text(line, record) => {
                line.clear();
                let read = input.take(MOST_LINE).read_until(b'\n', line);
                read.map_err(|cause| format!("cannot read it: {cause}"))?;
                if line.is_empty() {
                    return Err("the file ends before it".into());
                }
                if line.len() as u64 == MOST_LINE && !line.ends_with(b"\n") {
                    return Err(format!("its line has more than {MOST_LINE} bytes"));
                }
                let text = std::str::from_utf8(line).map_err(|_| "its line is not text".to_string())?;
                let (mut places, mut count) = (record.chunks_exact_mut(8), 0);
                for word in text.split_whitespace() {
                    let number: f64 =
                        word.parse().map_err(|_| format!("{word} in its line; allowed: numbers"))?;
                    if let Some(place) = places.next() {
                        place.copy_from_slice(&number.to_le_bytes());
                    }
                    count += 1;
                }
                let all = record.len() / 8;
                if count != all {
                    return Err(format!("its line has {count} numbers; allowed: {all}, one a property"));
                }
                Ok(record)
            }
        }
    }
}

/// Checks that nothing but white space is left.
///
/// # Errors
/// What could not be read, or that more follows
pub(super) fn check_end(input: &mut impl BufRead) -> Result<(), String> {
    loop {
        let rest = input.fill_buf().map_err(|cause| format!("cannot read it: {cause}"))?;
        if rest.is_empty() {
            return Ok(());
        }
        if rest.iter().any(|byte| !byte.is_ascii_whitespace()) {
            return Err("more follows its photons; allowed: nothing".into());
        }
        let read = rest.len();
        input.consume(read);
    }
}
