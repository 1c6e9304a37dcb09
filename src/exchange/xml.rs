//! The text of an XML file, an element a line.

use crate::Spectrum;
use glam::DVec3;
use std::fmt::Write;

/// XML as it grows.
#[derive(Debug, Default)]
pub(super) struct Xml {
    text: String,
    depth: usize,
}

/// A number with every digit, without rows of zeros.
pub(super) fn number(x: f64) -> String {
    // Adding 0 makes -0 the same as 0.
    let x = x + 0.0;
    if x == 0.0 || (1e-4..1e9).contains(&x.abs()) { format!("{x}") } else { format!("{x:e}") }
}

/// Three numbers.
pub(super) fn triple(v: DVec3) -> String {
    v.to_array().map(number).join(", ")
}

fn escaped(value: &str) -> String {
    let mut text = String::with_capacity(value.len());
    for c in value.chars() {
        match c {
            '&' => text.push_str("&amp;"),
            '<' => text.push_str("&lt;"),
            '"' => text.push_str("&quot;"),
            c => text.push(c),
        }
    }
    text
}

impl Xml {
    fn begin(&mut self, tag: &str, attributes: &[(&str, &str)]) {
        for _ in 0..self.depth {
            self.text.push_str("    ");
        }
        self.text.push('<');
        self.text.push_str(tag);
        for (name, value) in attributes {
            // Writing to a string does not fail.
            let _ = write!(self.text, " {name}=\"{}\"", escaped(value));
        }
    }

    /// An element with others inside.
    pub fn within(&mut self, tag: &str, attributes: &[(&str, &str)], inside: impl FnOnce(&mut Xml)) {
        self.begin(tag, attributes);
        self.text.push_str(">\n");
        self.depth += 1;
        inside(self);
        self.depth -= 1;
        for _ in 0..self.depth {
            self.text.push_str("    ");
        }
        self.text.push_str("</");
        self.text.push_str(tag);
        self.text.push_str(">\n");
    }

    /// An element with nothing inside.
    pub fn element(&mut self, tag: &str, attributes: &[(&str, &str)]) {
        self.begin(tag, attributes);
        self.text.push_str("/>\n");
    }

    /// A named value of a kind.
    pub fn value(&mut self, kind: &str, name: &str, value: &str) {
        self.element(kind, &[("name", name), ("value", value)]);
    }

    /// A number.
    pub fn float(&mut self, name: &str, x: f64) {
        self.value("float", name, &number(x));
    }

    /// Three channels, linear.
    pub fn rgb(&mut self, name: &str, value: Spectrum) {
        self.value("rgb", name, &triple(value.0));
    }

    /// A remark, which stands on a line of its own.
    pub fn remark(&mut self, text: &str) {
        for _ in 0..self.depth {
            self.text.push_str("    ");
        }
        // Two hyphens would end it.
        let _ = writeln!(self.text, "<!-- {} -->", text.replace("--", "- -"));
    }

    /// All of it.
    pub fn into_text(self) -> String {
        self.text
    }
}
