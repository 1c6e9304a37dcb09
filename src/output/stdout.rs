//! Standard output, where a reader may leave early.

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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_a_closed_pipe_is_ignored() {
        assert!(ignore_closed_pipe(Err(io::ErrorKind::BrokenPipe.into())).is_ok());
        assert!(ignore_closed_pipe(Err(io::ErrorKind::StorageFull.into())).is_err());
        assert!(print(|_| Err(io::ErrorKind::BrokenPipe.into())).is_ok());
    }
}
