//! Text that came from elsewhere, on its way to a terminal or a file; and what an internal error says.

use std::panic::PanicHookInfo;

/// A text in one line that a terminal only shows: names, cells and command lines may hold characters that it would obey.
/// Line ends of every kind become spaces, other control characters and those that turn the direction of writing are spelt
/// out.
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

/// What a panic says: an answer that the program owes, and where it stopped.
pub fn panicked(info: &PanicHookInfo<'_>) -> String {
    let place = info.location().map(|l| format!(" at {}:{}", l.file(), l.line())).unwrap_or_default();
    let what = info.payload_as_str().unwrap_or("no message");
    format!("internal error{place}, please report: {what}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_from_elsewhere_is_one_line_without_control_characters() {
        assert_eq!(one_line("a\u{1b}[31m b\nc\u{9b}d\u{7}é\te\0"), "a\\u{1b}[31m b c\\u{9b}d\\u{7}é\\te\\0");
        assert_eq!(one_line("a\r\nb\u{2028}c\u{2029}d\u{85}e"), "a  b c d\\u{85}e");
        for c in ('\u{202a}'..='\u{202e}').chain('\u{2066}'..='\u{2069}') {
            assert_eq!(one_line(&format!("a{c}b")), format!("a\\u{{{:x}}}b", u32::from(c)));
        }
        // What is only text stays: a soft hyphen, the joiners of scripts, a backslash.
        for text in ["a\\n b", "naïve θ₀", "क्\u{200d}ष", "\u{2027}\u{202f}\u{2065}\u{206a}"] {
            assert_eq!(one_line(text), text);
        }
    }
}
