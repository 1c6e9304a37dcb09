//! What is tried: a function of kind, seed and number.

use super::kind::{Kind, TURNS};
use super::{seeds, tree};
use turbid::rng::{Purpose, Stream};

/// One input.
#[derive(Debug, Clone, PartialEq)]
pub struct Input {
    /// What it is taken for.
    pub kind: Kind,
    /// What is in its file.
    pub bytes: Vec<u8>,
}

impl Input {
    /// The input of this number; kinds by turns unless one is named.
    pub fn of(only: Option<Kind>, seed: u64, number: u64) -> Self {
        let turn = number % 100;
        let by_turns = || TURNS.iter().find(|(_, end)| turn < *end).map_or(Kind::Scenes, |(kind, _)| *kind);
        let kind = only.unwrap_or_else(by_turns);
        let mut stream = Stream::new(seed, Purpose::Synthetic, kind as u64, number);
        Input { kind, bytes: bytes(kind, &mut stream) }
    }
}

fn bytes(kind: Kind, stream: &mut Stream) -> Vec<u8> {
    let mut bytes = match kind {
        Kind::Scenes => {
            let text = tree::changed(stream).into_bytes();
            // One in twenty is not TOML any more.
            if stream.unit() < 0.95 {
                return text;
            }
            text
        }
        Kind::Arguments => return seeds::arguments(stream),
        _ => seeds::file(kind, stream),
    };
    // One in four is left as it is.
    let changes = stream.index(4);
    for _ in 0..changes {
        change(&mut bytes, kind, stream);
    }
    if kind == Kind::Cells && stream.unit() < 0.7 {
        seeds::seal(&mut bytes);
    }
    bytes
}

/// Words that mean something to a reader of text, or just fail to.
const WORDS: [&str; 24] = [
    "0",
    "-0",
    "1",
    "-1",
    "1e308",
    "-1e308",
    "1e-308",
    "5e-324",
    "nan",
    "inf",
    "-inf",
    "1e400",
    "16777216",
    "4294967296",
    "18446744073709551616",
    "\n",
    "\r\n",
    "#",
    ",",
    "\"",
    "/",
    "\u{1b}[31m",
    "\u{0}",
    "é",
];

/// Numbers of four bytes at the ends of their range.
const EXTREMES: [u32; 12] = [
    0,
    1,
    2,
    0x7fff_ffff,
    0x8000_0000,
    0xffff_ffff,
    0x7f80_0000,
    0xff80_0000,
    0x7fc0_0000,
    0x7f7f_ffff,
    0x0000_0001,
    0x0010_0000,
];

/// One change of bytes: bits, bytes, numbers, words, stretches.
fn change(bytes: &mut Vec<u8>, kind: Kind, stream: &mut Stream) {
    if bytes.is_empty() {
        bytes.push(stream.bits() as u8);
        return;
    }
    let is_text = !matches!(kind, Kind::Vol | Kind::Png);
    let at = stream.index(bytes.len());
    let length = 1 + stream.index((bytes.len() - at).min(64));
    match stream.index(8) {
        0 => bytes[at] ^= 1 << stream.index(8),
        1 => bytes[at] = stream.bits() as u8,
        2 => {
            bytes.drain(at..at + length);
        }
        3 => {
            let copy = bytes[at..at + length].to_vec();
            let to = stream.index(bytes.len());
            bytes.splice(to..to, copy);
        }
        4 => bytes.truncate(at),
        5 if is_text => word(bytes, at, stream),
        5 => {
            let place = at.min(bytes.len().saturating_sub(4));
            let number = EXTREMES[stream.index(EXTREMES.len())].to_le_bytes();
            number.iter().zip(&mut bytes[place..]).for_each(|(new, old)| *old = *new);
        }
        6 if is_text => lines(bytes, stream),
        6 => {
            let to = stream.index(bytes.len());
            bytes.swap(at, to);
        }
        _ if is_text => word(bytes, at, stream),
        _ => bytes[at] = [0, 255, 1, 127, 128][stream.index(5)],
    }
}

/// Puts a word in the place of the one there.
fn word(bytes: &mut Vec<u8>, at: usize, stream: &mut Stream) {
    let is_apart = |b: &u8| b" ,/\t\n:".contains(b);
    let start = bytes[..at].iter().rposition(is_apart).map_or(0, |i| i + 1);
    let end = bytes[at..].iter().position(is_apart).map_or(bytes.len(), |i| at + i);
    let word = WORDS[stream.index(WORDS.len())];
    bytes.splice(start..end.max(start), word.bytes());
}

/// Leaves out a line, repeats one, or swaps two.
fn lines(bytes: &mut Vec<u8>, stream: &mut Stream) {
    let mut lines: Vec<Vec<u8>> = bytes.split(|b| *b == b'\n').map(<[u8]>::to_vec).collect();
    let (a, b) = (stream.index(lines.len()), stream.index(lines.len()));
    match stream.index(3) {
        0 => {
            lines.remove(a);
        }
        1 => lines.insert(b, lines[a].clone()),
        _ => lines.swap(a, b),
    }
    *bytes = lines.join(&b'\n');
}
