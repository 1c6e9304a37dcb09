//! Which revision of the sources the program was built from.

use std::sync::LazyLock;

/// Digits of a revision that are told.
const DIGITS: usize = 12;

/// None where what the build found is from another folder, in which these sources may be of another revision.
const NEWEST: [u8; DIGITS] =
    match is_same(env!("TURBID_SOURCES").as_bytes(), env!("CARGO_MANIFEST_DIR").as_bytes()) {
        true => newest(include_bytes!(env!("TURBID_LOG"))),
        false => [0; DIGITS],
    };

const fn is_same(a: &[u8], b: &[u8]) -> bool {
    let mut place = 0;
    while place < a.len() && place < b.len() && a[place] == b[place] {
        place += 1;
    }
    place == a.len() && place == b.len()
}

/// The revision, where the build knew one.
pub fn revision() -> Option<&'static str> {
    std::str::from_utf8(&NEWEST).ok().filter(|digits| !digits.contains('\0'))
}

/// Version and revision.
pub fn version() -> &'static str {
    const NUMBER: &str = env!("CARGO_PKG_VERSION");
    static BOTH: LazyLock<Option<String>> =
        LazyLock::new(|| revision().map(|revision| format!("{NUMBER} ({revision})")));
    BOTH.as_deref().unwrap_or(NUMBER)
}

/// The second word of the last line, which in git's log of HEAD is the revision that it is at; zeros where there is none. Done by the
/// compiler: the rest of the log does not come into the program.
const fn newest(log: &[u8]) -> [u8; DIGITS] {
    let mut none = [0; DIGITS];
    // A line feed at the end ends the last line, and begins none.
    let mut start = log.len().saturating_sub(1);
    while start > 0 && log[start - 1] != b'\n' {
        start -= 1;
    }
    while start < log.len() && log[start] != b' ' {
        start += 1;
    }
    let mut digit = 0;
    while digit < DIGITS {
        let place = start + 1 + digit;
        if place >= log.len() || !log[place].is_ascii_alphanumeric() {
            return [0; DIGITS];
        }
        none[digit] = log[place];
        digit += 1;
    }
    none
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_are_compared() {
        assert!(is_same(b"", b"") && is_same(b"ab", b"ab"));
        assert!(!is_same(b"ab", b"a") && !is_same(b"a", b"ab") && !is_same(b"ab", b"ac"));
    }

    #[test]
    fn the_last_line_tells_the_revision() {
        let line = |a: char, b: char| {
            format!(
                "{} {} A. Person <a@b.c> 1700000000 +0000\tcommit: words\n",
                a.to_string().repeat(40),
                b.to_string().repeat(40)
            )
        };
        assert_eq!(&newest(line('0', 'a').as_bytes()), b"aaaaaaaaaaaa");
        assert_eq!(&newest((line('0', 'a') + &line('a', '7')).as_bytes()), b"777777777777");
        assert_eq!(&newest(b"- 1234567890abcdef\n"), b"1234567890ab");
        for none in [&b""[..], b"\n", b" ", b"word", b"a short\n", b"a 12345678901\n"] {
            assert_eq!(newest(none), [0; DIGITS], "{none:?}");
        }
    }
}
