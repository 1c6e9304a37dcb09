//! Standard output, where a reader may leave early; and text that came from elsewhere, on its way to a terminal.

use std::io::{self, BufWriter, Write};

/// Writes to standard output through one lock and one buffer. A closed pipe ends the output quietly.
///
/// # Errors
/// Any other failure, a full disk among them.
pub fn print(write: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> io::Result<()> {
    let mut out = BufWriter::new(io::stdout().lock());
    let result = ignore_closed_pipe(write(&mut out).and_then(|()| out.flush()));
    // What is still buffered has been written or cannot be: dropping the buffer would try again.
    let _unwritten = out.into_parts();
    result
}

/// Takes a closed pipe for the wish of its reader, not for an error: `turbid measure | head` ends with 0.
///
/// # Errors
/// Any other failure.
pub fn ignore_closed_pipe(result: io::Result<()>) -> io::Result<()> {
    match result {
        Err(e) if e.kind() == io::ErrorKind::BrokenPipe => Ok(()),
        other => other,
    }
}

/// A text in one line that a terminal only shows: names and values from files and command lines may hold signs that it
/// would obey. Line ends of every kind become spaces, other control characters and those that turn the direction of writing
/// are spelt out.
pub fn one_line(text: &str) -> String {
    let mut line = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '\n' | '\r' | '\u{2028}' | '\u{2029}' => line.push(' '),
            '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}' => line.extend(c.escape_unicode()),
            c if c.is_control() => line.extend(c.escape_debug()),
            c => line.push(c),
        }
    }
    line
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_from_elsewhere_is_one_line_without_control_characters() {
        assert_eq!(one_line("a\u{1b}[31m b\nc\u{9b}d\u{7}é"), "a\\u{1b}[31m b c\\u{9b}d\\u{7}é");
        assert_eq!(one_line("a\u{2028}b\u{202e}c\u{2066}d"), "a b\\u{202e}c\\u{2066}d");
    }

    #[test]
    fn only_a_closed_pipe_is_ignored() {
        assert!(ignore_closed_pipe(Err(io::ErrorKind::BrokenPipe.into())).is_ok());
        assert!(ignore_closed_pipe(Err(io::ErrorKind::StorageFull.into())).is_err());
        assert!(print(|_| Err(io::ErrorKind::BrokenPipe.into())).is_ok());
    }
}
