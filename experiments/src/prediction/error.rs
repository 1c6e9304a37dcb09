//! The predicted error of a case, term by term.

use super::term::Term;
use super::written::{Prediction, Predictions};
use crate::harness::Unit;

/// The predicted error of a case by term, each as a fraction of the exact value.
#[derive(Debug, Clone, PartialEq)]
pub struct PredictedError {
    /// The exact value, and the bound on its error.
    pub exact: (f64, f64),
    /// The terms, in the order in which they are stated.
    pub terms: Vec<(Term, f64)>,
    /// Bound on the numerical error of their sum.
    pub error: f64,
}

/// The quantity under which a term is written down.
fn quantity_of(term: Term) -> String {
    format!("error from {}", term.name())
}

impl PredictedError {
    /// One term; 0 if it is not stated.
    pub fn of(&self, term: Term) -> f64 {
        self.terms.iter().filter(|(t, _)| *t == term).map(|(_, value)| value).sum()
    }

    /// The predicted relative error: the sum of the terms.
    pub fn total(&self) -> f64 {
        self.terms.iter().map(|(_, value)| value).sum()
    }

    /// The largest term.
    pub fn dominant(&self) -> Option<Term> {
        // The first of equals.
        let largest = self.terms.iter().rev().max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()));
        largest.map(|(term, _)| *term)
    }

    /// The predictions of a case, as they are written down: the exact value, the expected one, its error and the terms,
    /// each with its source.
    pub fn predictions(
        &self,
        case: &str,
        (quantity, unit): (&str, Unit),
        [exact, expected]: [&str; 2],
        source: impl Fn(Term) -> &'static str,
    ) -> Vec<Prediction> {
        let value = (self.exact.0 * (1.0 + self.total()), self.exact.0 * self.error);
        let mut all = vec![
            Prediction::new(case, format!("exact {quantity}"), unit, self.exact, exact),
            Prediction::new(case, quantity, unit, value, expected),
            Prediction::new(case, "error", Unit::FRACTION, (self.total(), self.error), "sum of the parts"),
        ];
        let of_term = |&(term, value): &(Term, f64)| {
            Prediction::new(case, quantity_of(term), Unit::FRACTION, (value, self.error), source(term))
        };
        all.extend(self.terms.iter().map(of_term));
        all
    }

    /// What was written down of a case with these terms.
    ///
    /// # Errors
    /// If something was not predicted.
    pub fn read(known: &Predictions, case: &str, quantity: &str, terms: &[Term]) -> anyhow::Result<Self> {
        let one = |&term: &Term| Ok((term, known.get(case, &quantity_of(term))?.0));
        Ok(PredictedError {
            exact: known.get(case, &format!("exact {quantity}"))?,
            terms: terms.iter().map(one).collect::<anyhow::Result<_>>()?,
            error: known.get(case, "error")?.1,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What is written down is what is read again.
    #[test]
    fn written_and_read_again() {
        let terms = vec![(Term::Edge, -0.4), (Term::Blur, 0.01), (Term::Nearest, 0.0), (Term::Clusters, 0.4)];
        let stated = PredictedError { exact: (2.0, 1e-9), terms, error: 1e-8 };
        assert_eq!(
            (stated.dominant(), stated.of(Term::Blur), stated.of(Term::Step)),
            (Some(Term::Edge), 0.01, 0.0)
        );
        let all = stated.predictions("a", ("fluence", Unit::FLUENCE), ["e", "f"], Term::name);
        assert_eq!((all.len(), all[1].quantity.as_str()), (7, "fluence"));
        assert!((all[1].value - 2.02).abs() < 1e-15 && (all[2].value - 0.01).abs() < 1e-15);
        let known = Predictions::new(&all);
        let terms = [Term::Edge, Term::Blur, Term::Nearest, Term::Clusters];
        let read = PredictedError::read(&known, "a", "fluence", &terms).unwrap();
        assert_eq!(read, stated);
        assert!(PredictedError::read(&known, "a", "fluence", &[Term::Step]).is_err());
        assert!(PredictedError::read(&known, "b", "fluence", &terms).is_err());
    }
}
