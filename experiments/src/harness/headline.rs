//! The numbers of a study that a paper would quote, as LaTeX commands and as a table.

use super::format::with_error;
use super::{Estimate, Unit};
use serde::Serialize;
use turbid_figure::latex;

/// One number that stands for an experiment.
#[derive(Debug, Clone, PartialEq)]
pub struct Headline {
    /// Letters alone, unique in its experiment. The LaTeX command is `\turbid`, the letters of the experiment, then these.
    pub name: String,
    /// What it is, in words.
    pub text: String,
    /// Its unit.
    pub unit: Unit,
    /// The number with its error.
    pub estimate: Estimate,
}

impl Headline {
    /// A number of this name.
    pub fn new(name: &str, text: &str, unit: Unit, estimate: Estimate) -> Self {
        Headline { name: name.to_string(), text: text.to_string(), unit, estimate }
    }

    /// Whether LaTeX takes the name for that of a command.
    pub fn has_a_name(&self) -> bool {
        !self.name.is_empty() && self.name.bytes().all(|b| b.is_ascii_alphabetic())
    }

    /// Value, error and unit as LaTeX, on one line; nothing without an error.
    fn latex(&self) -> Option<String> {
        let (value, error) = (self.estimate.value(), self.estimate.std_error());
        let text = self.unit.after(&with_error(self.unit.shown(value), self.unit.shown(error)));
        (value.is_finite() && error.is_finite()).then(|| latex(&text).replace(' ', "~"))
    }
}

/// A row of headlines.csv.
#[derive(Default, Serialize)]
pub(super) struct HeadlineRecord<'a> {
    experiment: &'a str,
    name: &'a str,
    value: f64,
    error: f64,
    unit: Unit,
    text: &'a str,
}

/// The name of a number in the study: Bias and Face make BiasFace.
pub(super) fn whole_name(experiment: &str, headline: &Headline) -> String {
    let letters: String = experiment.chars().filter(char::is_ascii_alphabetic).collect();
    let (first, rest) = letters.split_at(letters.len().min(1));
    format!("{}{rest}{}", first.to_ascii_uppercase(), headline.name)
}

/// The rows of headlines.csv.
pub(super) fn records<'a>(all: &'a [(&'a str, String, &'a Headline)]) -> Vec<HeadlineRecord<'a>> {
    let record = |(experiment, name, h): &'a (&'a str, String, &'a Headline)| {
        let (value, error) = (h.estimate.value(), h.estimate.std_error());
        HeadlineRecord { experiment, name, value, error, unit: h.unit, text: &h.text }
    };
    all.iter().map(record).collect()
}

/// numbers.tex: one command a number. A number without an error has none, so that LaTeX says where it is missing.
pub(super) fn commands(all: &[(&str, String, &Headline)]) -> String {
    let mut out = String::from(
        "% Headline numbers with their standard errors: \\input this file, then write \\turbidNAME{}.\n",
    );
    for (experiment, name, headline) in all {
        out.push_str(&format!("% {experiment}: {}\n", latex(&headline.text)));
        out.push_str(&match headline.latex() {
            Some(text) => format!("\\newcommand{{\\turbid{name}}}{{{text}}}\n"),
            None => format!("% turbid{name} has no error\n"),
        });
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    fn headline(name: &str, value: f64, error: f64, unit: Unit) -> Headline {
        Headline::new(name, "95 % of a_b", unit, Estimate::exact(value, error))
    }

    #[test]
    fn numbers_become_commands() {
        let all = [
            headline("Loss", -0.123_45, 0.004_21, Unit::FRACTION),
            headline("Cases", 1234.0, 0.0, Unit::ONE),
            headline("Light", 2.5e-7, 1.1e-8, Unit::FLUENCE),
            headline("Lost", f64::NAN, 0.1, Unit::ONE),
        ];
        let all: Vec<_> = all.iter().map(|h| ("bias-2", whole_name("bias-2", h), h)).collect();
        let text = commands(&all);
        for line in [
            r"\newcommand{\turbidBiasLoss}{(\ensuremath{-}12.35~\ensuremath{\pm}~0.42)~\%}",
            r"\newcommand{\turbidBiasCases}{1234}",
            r"\newcommand{\turbidBiasLight}{((2.50~\ensuremath{\pm}~0.11)~\ensuremath{\times}~10\ensuremath{^-}\ensuremath{^7})~W/L\ensuremath{^2}}",
            "% turbidBiasLost has no error",
            r"% bias-2: 95 \% of a\_b",
        ] {
            assert!(text.lines().any(|l| l == line), "{line} in {text}");
        }
        assert!(text.is_ascii());
    }

    #[test]
    fn names_are_letters() {
        for (name, is_good) in
            [("BiasFace", true), ("", false), ("Rim2", false), ("a-b", false), ("é", false)]
        {
            assert_eq!(headline(name, 1.0, 0.1, Unit::ONE).has_a_name(), is_good, "{name}");
        }
    }
}
