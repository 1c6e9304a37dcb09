//! Critical sizes against the eigenvalue of the integral equation.

use super::*;
use crate::peierls::Operator;
use crate::sphere::operator::ShellOperator;

/// Largest eigenvalue of a matrix close to `guess`, with its vector: three steps of inverse iteration.
fn eigenvector(matrix: &DMatrix<f64>, guess: f64) -> (f64, DVector<f64>) {
    let n = matrix.nrows();
    // A shift a little below leaves the matrix regular and the gain of a step at 1e6 or more.
    let lu = (matrix - DMatrix::identity(n, n) * (guess * (1.0 + 1e-7))).lu();
    let mut v = DVector::from_element(n, 1.0);
    for _ in 0..3 {
        v = lu.solve(&v).unwrap();
        v /= v.amax();
    }
    if v[n - 1] < 0.0 {
        v = -v;
    }
    let image = matrix * &v;
    // The quotient at the middle, where v is 1: v is the vector to rounding.
    (image[n - 1] / v[n - 1], v)
}

/// The eigenvalue moves with the size as dlambda/da = lambda f(a)^2/int_0^a f^2 (f = u for the sphere): both ends of
/// the interval give 2 (1/2) f (2 lambda f) - lambda f^2.
#[test]
fn the_integral_equation_has_the_eigenvalue_at_that_size() {
    for c in [1.02, 1.1, 1.3, 2.0, 10.0, 100.0] {
        for shape in [CriticalShape::Slab, CriticalShape::Sphere] {
            let critical = Critical::new(shape, c).unwrap();
            let size = critical.size();
            let a = size.value;
            let (lambda, v, mesh, radii) = match shape {
                CriticalShape::Slab => {
                    let operator = Operator::new(2.0 * a, 1e-7);
                    let (lambda, v) = eigenvector(&(operator.even_matrix() * 0.5), 1.0 / c);
                    let ones = vec![1.0; v.len()];
                    (lambda, v, operator.mesh, ones)
                }
                CriticalShape::Sphere => {
                    let operator = ShellOperator::new(a);
                    let (lambda, v) = eigenvector(&(operator.matrix() * 0.5), 1.0 / c);
                    (lambda, v, operator.mesh, operator.radii)
                }
            };
            let u: Vec<f64> = v.iter().zip(&radii).map(|(v, r)| v * r).collect();
            let square: f64 = u.iter().zip(&mesh.lengths).map(|(u, l)| u * u * l).sum();
            let slope = lambda * u[0] * u[0] / square;
            let shift = (1.0 / c - lambda) / slope;
            // The operator's rows and the quotient are good to some 30 roundings.
            let rounding = 32.0 * f64::EPSILON * lambda / slope;
            assert!(
                shift.abs() <= size.error + rounding,
                "{c} {shape:?}: {shift:e} beside {:e} and {rounding:e}",
                size.error
            );
            assert!(shift.abs() <= 1e-11 * a, "{c} {shape:?}: {shift:e}");
            // The shape, over that at the innermost node.
            let place = |i: usize| match shape {
                CriticalShape::Slab => 1.0 - mesh.nodes[i] / a,
                CriticalShape::Sphere => radii[i] / a,
            };
            let n = v.len();
            let middle = critical.flux_ratio(place(n - 1)).unwrap().value;
            for i in [0, n / 4, n / 2, n - 30, n - 10] {
                let ratio = critical.flux_ratio(place(i)).unwrap();
                let got = v[i] / v[n - 1] * middle;
                assert!((got / ratio.value - 1.0).abs() < 1e-11, "{c} {shape:?} {i}: {got} {ratio:?}");
            }
        }
    }
}
