//! The error budget: what was predicted of every case of a study, term by term, beside what was measured.

/// Why an estimate is wrong on average; each is predicted before it is measured.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Term {
    /// The rule that sets the radius by the k-th photon: what it adds to the mean in a uniform field of independent
    /// photons. 0 for the right rule.
    Nearest,
    /// Photons of one history lie near each other.
    Clusters,
    /// The field bends, or ends, inside the ball.
    Blur,
    /// The medium ends inside the ball, or a wall stands in it: what the estimate makes of a uniform field.
    Edge,
    /// A ray is marched in steps of finite length.
    Step,
    /// Positions are stored in single precision.
    Storage,
}

impl Term {
    /// Every term, in the order of figures and of [`Entry::terms`].
    pub const ALL: [Term; 6] =
        [Term::Nearest, Term::Clusters, Term::Blur, Term::Edge, Term::Step, Term::Storage];

    /// Its name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Term::Nearest => "k nearest",
            Term::Clusters => "clusters",
            Term::Blur => "blur",
            Term::Edge => "edge",
            Term::Step => "step",
            Term::Storage => "storage",
        }
    }
}

/// One case of the study's error budget: an estimate whose mean error is predicted.
///
/// Errors are relative: (estimate - exact) / scale, with the same scale in all parts; the scale is the exact value
/// unless that is zero, as outside an edge, where it is the value inside.
#[derive(Debug, Clone, PartialEq)]
pub struct Entry {
    /// The group of cells that measured it: entries of one group share their maps, others share nothing.
    pub group: String,
    /// The case, as in the result rows.
    pub case: String,
    /// The predicted error by term, in the order of [`Term::ALL`].
    pub terms: [f64; Term::ALL.len()],
    /// Bound on the numerical error of their sum.
    pub error: f64,
    /// The measured error, one a map, in the order of the replicates.
    pub maps: Vec<f64>,
}

impl Entry {
    /// An entry with the given terms, the others 0.
    pub fn new(
        group: impl Into<String>,
        case: impl Into<String>,
        terms: &[(Term, f64)],
        error: f64,
        maps: Vec<f64>,
    ) -> Self {
        let mut all = [0.0; Term::ALL.len()];
        for &(term, value) in terms {
            all[term as usize] += value;
        }
        Entry { group: group.into(), case: case.into(), terms: all, error, maps }
    }

    /// The predicted error.
    pub fn predicted(&self) -> f64 {
        self.terms.iter().sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn terms_stand_in_their_places() {
        let entry =
            Entry::new("g", "c", &[(Term::Step, 2.0), (Term::Nearest, 1.0), (Term::Step, 0.5)], 0.0, vec![]);
        assert_eq!(entry.terms, [1.0, 0.0, 0.0, 0.0, 2.5, 0.0]);
        assert!(Term::ALL.iter().enumerate().all(|(i, &term)| term as usize == i));
    }
}
