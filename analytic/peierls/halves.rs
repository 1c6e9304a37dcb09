//! Functions on the slab and integrals of them, half by half.

/// A function on the slab by its values at the nodes of the upper half and at their mirror images.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Halves {
    /// Values at depth x of each node.
    pub upper: Vec<f64>,
    /// Values at depth tau - x of each node.
    pub lower: Vec<f64>,
}

impl Halves {
    pub(crate) fn zip(&self, other: &Halves, f: impl Fn(f64, f64) -> f64) -> Halves {
        let join = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(&a, &b)| f(a, b)).collect();
        Halves { upper: join(&self.upper, &other.upper), lower: join(&self.lower, &other.lower) }
    }

    pub(crate) fn largest(&self) -> f64 {
        self.upper.iter().chain(&self.lower).fold(0.0, |a, b| a.max(b.abs()))
    }

    /// The function mirrored in the middle of the slab.
    #[cfg(test)]
    pub(crate) fn mirrored(&self) -> Halves {
        Halves { upper: self.lower.clone(), lower: self.upper.clone() }
    }
}

/// One row of the operator: weights of a function's values for its integral seen from one point.
#[derive(Debug, Clone)]
pub(crate) struct Row {
    pub same: Vec<f64>,
    pub other: Vec<f64>,
}

impl Row {
    /// The integral with the halves of `f` named as seen from the row's point.
    pub(crate) fn apply(&self, f: &Halves) -> f64 {
        dot(&self.same, &f.upper) + dot(&self.other, &f.lower)
    }

    /// The integral seen from the mirror image of the row's point.
    pub(crate) fn apply_mirrored(&self, f: &Halves) -> f64 {
        dot(&self.same, &f.lower) + dot(&self.other, &f.upper)
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
