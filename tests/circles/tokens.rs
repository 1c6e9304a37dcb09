//! Rust sources as words and signs: as much of the language as imports need.

/// A piece of code. Comments, characters, lifetimes and numbers that hold no name are left out.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Token {
    /// A name, a keyword or a number.
    Word(String),
    /// `::`.
    Colons,
    /// A literal text, which only `#[path = "..."]` needs.
    Text(String),
    /// Any other sign.
    Sign(char),
}

impl Token {
    /// The word, where it is one.
    pub fn word(&self) -> Option<&str> {
        if let Token::Word(word) = self { Some(word) } else { None }
    }

    /// Whether it is this word or sign.
    pub fn is(&self, what: &str) -> bool {
        match self {
            Token::Word(word) => word == what,
            Token::Colons => what == "::",
            Token::Sign(sign) => what.len() == 1 && what.starts_with(*sign),
            Token::Text(_) => false,
        }
    }
}

fn is_part_of_word(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

/// The place behind a block comment that begins at `at`; such comments nest.
fn behind_comment(code: &[char], mut at: usize) -> usize {
    let mut depth = 0;
    while at < code.len() {
        match (code[at], code.get(at + 1)) {
            ('/', Some('*')) => (depth, at) = (depth + 1, at + 2),
            ('*', Some('/')) => (depth, at) = (depth - 1, at + 2),
            _ => at += 1,
        }
        if depth == 0 {
            break;
        }
    }
    at
}

/// A text whose opening quote stands at `at`, and the place behind it; a raw one has its number of `#`.
fn text(code: &[char], at: usize, raw: Option<usize>) -> (String, usize) {
    let mut end = at + 1;
    while end < code.len() {
        match (code[end], raw) {
            ('\\', None) => end += 2,
            ('"', None) => break,
            ('"', Some(n)) if code[end + 1..].iter().take_while(|c| **c == '#').count() >= n => break,
            _ => end += 1,
        }
    }
    (code[at + 1..end].iter().collect(), end + 1 + raw.unwrap_or(0))
}

/// The tokens of a source.
pub fn tokens(source: &str) -> Vec<Token> {
    let code: Vec<char> = source.chars().collect();
    let mut found = Vec::new();
    let mut at = 0;
    while at < code.len() {
        let (c, next) = (code[at], code.get(at + 1).copied().unwrap_or(' '));
        if c == '/' && next == '/' {
            at += code[at..].iter().take_while(|c| **c != '\n').count();
        } else if c == '/' && next == '*' {
            at = behind_comment(&code, at);
        } else if c == '"' {
            let (inner, behind) = text(&code, at, None);
            found.push(Token::Text(inner));
            at = behind;
        } else if c == '\'' {
            // A character ends with a quote, a lifetime does not.
            let length = if next == '\\' {
                code[at + 3..].iter().position(|c| *c == '\'').map(|n| n + 4)
            } else {
                None
            };
            at += length.unwrap_or(if code.get(at + 2) == Some(&'\'') { 3 } else { 1 });
        } else if is_part_of_word(c) {
            let word: String = code[at..].iter().take_while(|c| is_part_of_word(**c)).collect();
            at += word.chars().count();
            let hashes = code[at..].iter().take_while(|c| **c == '#').count();
            let is_raw = matches!(word.as_str(), "r" | "br" | "cr") && code.get(at + hashes) == Some(&'"');
            if is_raw {
                let (inner, behind) = text(&code, at + hashes, Some(hashes));
                found.push(Token::Text(inner));
                at = behind;
            } else {
                found.push(Token::Word(word));
            }
        } else if c == ':' && next == ':' {
            found.push(Token::Colons);
            at += 2;
        } else {
            if !c.is_whitespace() {
                found.push(Token::Sign(c));
            }
            at += 1;
        }
    }
    found
}

/// Tokens without the items that only tests compile.
pub fn without_tests(tokens: &[Token]) -> Vec<Token> {
    let mark = ["#", "[", "cfg", "(", "test", ")", "]"];
    let is_mark = |at: usize| {
        tokens.len() >= at + mark.len() && tokens[at..].iter().zip(mark).all(|(token, sign)| token.is(sign))
    };
    let mut kept = Vec::new();
    let mut at = 0;
    while at < tokens.len() {
        if !is_mark(at) {
            kept.push(tokens[at].clone());
            at += 1;
            continue;
        }
        let mut depth = 0;
        at += mark.len();
        while at < tokens.len() {
            let token = &tokens[at];
            depth += i32::from(["{", "(", "["].iter().any(|sign| token.is(sign)));
            depth -= i32::from(["}", ")", "]"].iter().any(|sign| token.is(sign)));
            at += 1;
            if depth == 0 && (token.is(";") || token.is("}")) {
                break;
            }
        }
    }
    kept
}
