//! Literals of Python, in which NumPy writes the headers of arrays: texts, whole numbers, truth, tuples, lists, dictionaries.

use std::iter::Peekable;
use std::str::Chars;

/// A literal.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Literal {
    Text(String),
    Number(u64),
    Truth(bool),
    /// A tuple or a list.
    List(Vec<Literal>),
    /// Keys and values.
    Dict(Vec<(Literal, Literal)>),
}

/// Literals within literals: arrays have four.
const DEEPEST: usize = 16;

impl Literal {
    /// The one literal that a text holds.
    ///
    /// # Errors
    /// Where it is none
    pub fn parse(text: &str) -> Result<Self, String> {
        let mut reader = Reader { rest: text.chars().peekable() };
        let literal = reader.literal(0)?;
        match reader.next_sign() {
            None => Ok(literal),
            Some(sign) => Err(format!("`{sign}` stands behind the header's dictionary")),
        }
    }

    /// The value of a key of a dictionary.
    pub fn get(&self, key: &str) -> Option<&Literal> {
        let Literal::Dict(pairs) = self else { return None };
        let is_it = |pair: &&(Literal, Literal)| matches!(&pair.0, Literal::Text(text) if text == key);
        pairs.iter().find(is_it).map(|(_, value)| value)
    }
}

struct Reader<'a> {
    rest: Peekable<Chars<'a>>,
}

impl Reader<'_> {
    /// The next character that is no space.
    fn next_sign(&mut self) -> Option<char> {
        while self.rest.peek().is_some_and(|c| c.is_whitespace()) {
            self.rest.next();
        }
        self.rest.next()
    }

    /// Whether a character comes next, which is then taken.
    fn takes(&mut self, wanted: char) -> bool {
        while self.rest.peek().is_some_and(|c| c.is_whitespace()) {
            self.rest.next();
        }
        self.rest.next_if_eq(&wanted).is_some()
    }

    fn literal(&mut self, depth: usize) -> Result<Literal, String> {
        if depth > DEEPEST {
            return Err("the header's dictionary is too deep".into());
        }
        match self.next_sign() {
            Some(quote @ ('\'' | '"')) => self.text(quote),
            Some('(') => self.list(')', depth),
            Some('[') => self.list(']', depth),
            Some('{') => self.dict(depth),
            Some(c) if c.is_ascii_alphanumeric() => self.word(c),
            Some(c) => Err(format!("`{c}` in the header's dictionary")),
            None => Err("the header's dictionary has no end".into()),
        }
    }

    fn text(&mut self, quote: char) -> Result<Literal, String> {
        let mut text = String::new();
        loop {
            match self.rest.next() {
                Some(c) if c == quote => return Ok(Literal::Text(text)),
                Some('\\') if self.rest.peek().is_some_and(|c| !c.is_control()) => {
                    text.extend(self.rest.next())
                }
                // It would break the line of a refusal.
                Some(c) if c.is_control() => {
                    return Err("a name in the header's dictionary has control characters".into());
                }
                Some(c) => text.push(c),
                None => return Err("a name in the header's dictionary has no end".into()),
            }
        }
    }

    fn word(&mut self, first: char) -> Result<Literal, String> {
        let mut word = String::from(first);
        while let Some(c) = self.rest.next_if(|c| c.is_ascii_alphanumeric()) {
            word.push(c);
        }
        match word.as_str() {
            "True" => Ok(Literal::Truth(true)),
            "False" => Ok(Literal::Truth(false)),
            // Python 2 wrote long numbers with their letter.
            number => match number.trim_end_matches('L').parse() {
                Ok(number) => Ok(Literal::Number(number)),
                Err(_) => Err(format!("`{word}` in the header's dictionary; allowed: whole numbers")),
            },
        }
    }

    fn list(&mut self, end: char, depth: usize) -> Result<Literal, String> {
        let mut list = Vec::new();
        while !self.takes(end) {
            list.push(self.literal(depth + 1)?);
            if !self.takes(',') && self.rest.peek() != Some(&end) {
                return Err("a list in the header's dictionary has no end".into());
            }
        }
        Ok(Literal::List(list))
    }

    fn dict(&mut self, depth: usize) -> Result<Literal, String> {
        let mut pairs = Vec::new();
        while !self.takes('}') {
            let key = self.literal(depth + 1)?;
            if !self.takes(':') {
                return Err("a key in the header's dictionary has no value".into());
            }
            pairs.push((key, self.literal(depth + 1)?));
            if !self.takes(',') && self.rest.peek() != Some(&'}') {
                return Err("the header's dictionary has no end".into());
            }
        }
        Ok(Literal::Dict(pairs))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn literals_are_read() {
        let text =
            "{'descr': [('a', '<f8', (3,)), (\"b\", '|u1')], 'fortran_order': False, 'shape': (5,), }  \n";
        let read = Literal::parse(text).unwrap();
        let name = |text: &str| Literal::Text(text.into());
        let fields = [
            Literal::List(vec![name("a"), name("<f8"), Literal::List(vec![Literal::Number(3)])]),
            Literal::List(vec![name("b"), name("|u1")]),
        ];
        assert_eq!(read.get("descr"), Some(&Literal::List(fields.to_vec())));
        assert_eq!(read.get("fortran_order"), Some(&Literal::Truth(false)));
        assert_eq!(read.get("shape"), Some(&Literal::List(vec![Literal::Number(5)])));
        assert_eq!((read.get("other"), name("a").get("a")), (None, None));
        assert_eq!(
            Literal::parse("('it\\'s', 12L)").unwrap(),
            Literal::List(vec![name("it's"), Literal::Number(12)])
        );
    }

    #[test]
    fn what_is_no_literal_is_refused() {
        let deep = "[".repeat(100_000);
        let bad = [
            "",
            "{",
            "{'a'}",
            "{'a': 1",
            "[1 2]",
            "'a",
            "'a\n'",
            "'a\\\n'",
            "None",
            "-1",
            "1.5",
            "{} {}",
            "99999999999999999999",
            &deep,
        ];
        for text in bad {
            assert!(Literal::parse(text).is_err(), "{text}");
        }
    }
}
