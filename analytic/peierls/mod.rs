//! The operator of the isotropic slab, (K f)(t) = int_0^tau E_1(|t-t'|) f(t') dt', on functions that are
//! polynomials of degree 19 on panels graded towards both faces.
//!
//! The slab is its own mirror image, so everything is said for its upper half: a point by its distance x from the
//! nearer face, a function by two lists of values, on the near half and on the far one.

pub(crate) mod fast;
mod halves;
mod mesh;
mod weights;

use crate::exponential_integral::e1;
pub(crate) use halves::Halves;
use halves::Row;
use libm::expm1;
pub(crate) use mesh::{Mesh, NODES};
use nalgebra::{DMatrix, DVector, Dyn, LU};
use weights::Weights;

/// A point of a panel where the polynomial is compared with the equation.
pub(crate) struct Probe {
    /// Distance from the nearer face.
    pub x: f64,
    row: Row,
}

/// The discretised operator of one thickness, with rows at the nodes and at the probes.
pub(crate) struct Operator {
    pub mesh: Mesh,
    weights: Weights,
    /// Rows at the nodes: sum and difference of the two halves act on even and odd functions.
    even: DMatrix<f64>,
    odd: DMatrix<f64>,
    /// Panel edges and panel middles, alternating, from the face inwards.
    pub probes: Vec<Probe>,
    /// Largest defect of a row sum from int_0^l E_1 = l E_1(l) + 1 - e^(-l), which is known exactly.
    pub row_defect: f64,
}

impl Operator {
    /// The operator of thickness `tau` with a first panel of length `first` times min(tau/2, 1).
    pub(crate) fn new(tau: f64, first: f64) -> Self {
        let mesh = Mesh::new(tau, first);
        let weights = Weights::new();
        let n = mesh.nodes.len();
        let (mut even, mut odd) = (DMatrix::zeros(n, n), DMatrix::zeros(n, n));
        let mut row_defect: f64 = 0.0;
        let defect = |x: f64, row: &Row| {
            let side = |l: f64| if l > 0.0 { l * e1(l) - expm1(-l) } else { 0.0 };
            let sum: f64 = row.same.iter().chain(&row.other).sum();
            (sum - side(x) - side(tau - x)).abs()
        };
        for i in 0..n {
            let row = weights.row(&mesh, mesh.nodes[i]);
            row_defect = row_defect.max(defect(mesh.nodes[i], &row));
            for j in 0..n {
                even[(i, j)] = row.same[j] + row.other[j];
                odd[(i, j)] = row.same[j] - row.other[j];
            }
        }
        let probes: Vec<Probe> = (0..=2 * mesh.panels())
            .map(|i| {
                let x = mesh.probe(i);
                Probe { x, row: weights.row(&mesh, x) }
            })
            .collect();
        for probe in &probes {
            row_defect = row_defect.max(defect(probe.x, &probe.row));
        }
        Operator { mesh, weights, even, odd, probes, row_defect }
    }

    /// The row of the point at distance x from the nearer face.
    pub(crate) fn row(&self, x: f64) -> Row {
        self.weights.row(&self.mesh, x)
    }

    /// K f at the nodes.
    pub(crate) fn apply(&self, f: &Halves) -> Halves {
        let (even, odd) = parts(f);
        join(&self.even * even, &self.odd * odd)
    }

    /// K f at a probe of the upper half and at its mirror image.
    pub(crate) fn at_probe(&self, probe: &Probe, f: &Halves) -> (f64, f64) {
        (probe.row.apply(f), probe.row.apply_mirrored(f))
    }

    /// The operator on even functions, by their values at the nodes.
    #[cfg(test)]
    pub(crate) fn even_matrix(&self) -> &DMatrix<f64> {
        &self.even
    }

    /// Factors of 1 - (albedo/2) K.
    pub(crate) fn factor(&self, albedo: f64) -> Factors {
        let n = self.mesh.nodes.len();
        let lu = |k: &DMatrix<f64>| (DMatrix::identity(n, n) - k * (0.5 * albedo)).lu();
        Factors { even: lu(&self.even), odd: lu(&self.odd) }
    }
}

/// The inverse of 1 - (albedo/2) K, which is a positive operator.
pub(crate) struct Factors {
    even: LU<f64, Dyn, Dyn>,
    odd: LU<f64, Dyn, Dyn>,
}

impl Factors {
    /// Solves for f; `None` where the matrix is singular in f64.
    pub(crate) fn solve(&self, right: &Halves) -> Option<Halves> {
        let (even, odd) = parts(right);
        Some(join(self.even.solve(&even)?, self.odd.solve(&odd)?))
    }
}

fn parts(f: &Halves) -> (DVector<f64>, DVector<f64>) {
    let pairs = || f.upper.iter().zip(&f.lower);
    let n = f.upper.len();
    (
        DVector::from_iterator(n, pairs().map(|(a, b)| 0.5 * (a + b))),
        DVector::from_iterator(n, pairs().map(|(a, b)| 0.5 * (a - b))),
    )
}

fn join(even: DVector<f64>, odd: DVector<f64>) -> Halves {
    Halves {
        upper: even.iter().zip(odd.iter()).map(|(e, o)| e + o).collect(),
        lower: even.iter().zip(odd.iter()).map(|(e, o)| e - o).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::exponential_integral::e_n;

    /// int_0^tau E_1(|x-t|) t^n dt is known for n = 0 and 1: int_0^L z E_1 dz = 1/2 - L E_2(L) - E_3(L).
    #[test]
    fn rows_integrate_constants_and_slopes() {
        for tau in [1e-12, 0.3, 1.0, 7.0, 60.0] {
            let operator = Operator::new(tau, 1e-7);
            let mesh = &operator.mesh;
            for x in [0.0, 1e-11 * tau, 0.01 * tau, 0.3 * tau, 0.5 * tau, mesh.nodes[40]] {
                let row = operator.row(x);
                let ones = mesh.halves(|_, _| 1.0);
                let slope = mesh.halves(|t, _| t / tau);
                let (a, b) = (x, tau - x);
                // 1 - E_2(L) without cancellation for small L is int_0^L E_1.
                let zeroth = |l: f64| {
                    if l < 0.1 {
                        crate::quadrature::integrate_from_singular(l, crate::exponential_integral::e1, "")
                            .value
                    } else {
                        1.0 - e_n(2, l)
                    }
                };
                let first = |l: f64| {
                    if l < 0.1 {
                        let f = |z| z * crate::exponential_integral::e1(z);
                        crate::quadrature::integrate_from_singular(l, f, "").value
                    } else {
                        0.5 - l * e_n(2, l) - e_n(3, l)
                    }
                };
                let zero = |l: f64| if l > 0.0 { (zeroth(l), first(l)) } else { (0.0, 0.0) };
                let ((a0, a1), (b0, b1)) = (zero(a), zero(b));
                let want = a0 + b0;
                assert!(
                    (row.apply(&ones) - want).abs() < 1e-14 * want,
                    "{tau} {x}: {} {want}",
                    row.apply(&ones)
                );
                let want = (x * (a0 + b0) + b1 - a1) / tau;
                assert!((row.apply(&slope) - want).abs() < 2e-14 * (a0 + b0), "slope {tau} {x}");
            }
            // The sum over all nodes may lose a rounding a node.
            let rounding = 2.0 * operator.mesh.nodes.len() as f64 * f64::EPSILON;
            assert!(operator.row_defect < rounding, "{tau}: {:e}", operator.row_defect);
        }
    }

    #[test]
    fn factors_invert_and_the_mirror_is_respected() {
        let operator = Operator::new(2.0, 1e-7);
        let f = operator.mesh.halves(|t, _| t);
        let image = operator.apply(&f);
        let mirrored = operator.apply(&f.mirrored()).mirrored();
        assert!(image.zip(&mirrored, |a, b| a - b).largest() < 1e-14);
        let right = f.zip(&image, |f, k| f - 0.45 * k);
        let back = operator.factor(0.9).solve(&right).unwrap();
        assert!(back.zip(&f, |a, b| a - b).largest() < 1e-13);
    }
}
