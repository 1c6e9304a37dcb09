//! Singular values of a graded matrix, each to its own relative accuracy: one-sided Jacobi rotations.

use crate::error::{Error, Result};

/// Sweeps over all pairs of columns. Convergence is quadratic at the end and takes six to twelve.
const SWEEPS: usize = 60;

/// Turns G into G V with orthogonal columns, V orthogonal.
///
/// The lengths of the columns of G V are the singular values of G, and V holds the right singular vectors. For
/// G = X D, X well conditioned and D diagonal, every singular value keeps its relative accuracy whatever D spans;
/// methods that first make the matrix tridiagonal lose all that lie below rounding of the largest.
/// # Arguments
/// `columns` of G; columns in falling order of length converge soonest
/// # Returns
/// the columns of V
/// # Source
/// Hestenes 1958; Demmel and Veselic 1992
pub(super) fn orthogonalize(columns: &mut [Vec<f64>]) -> Result<Vec<Vec<f64>>> {
    let n = columns.len();
    let tolerance = f64::EPSILON * (n as f64).sqrt();
    let mut v: Vec<Vec<f64>> = (0..n)
        .map(|i| {
            let mut unit = vec![0.0; n];
            unit[i] = 1.0;
            unit
        })
        .collect();
    for _ in 0..SWEEPS {
        let mut settled = true;
        for i in 0..n {
            for j in i + 1..n {
                let (left, right) = columns.split_at_mut(j);
                let (a, b) = (&mut left[i], &mut right[0]);
                let (aa, ab, bb) = products(a, b);
                if ab.abs() <= tolerance * (aa * bb).sqrt() {
                    continue;
                }
                settled = false;
                let zeta = (bb - aa) / (2.0 * ab);
                let t = 1f64.copysign(zeta) / (zeta.abs() + (1.0 + zeta * zeta).sqrt());
                let c = 1.0 / (1.0 + t * t).sqrt();
                rotate(a, b, c, c * t);
                let (left, right) = v.split_at_mut(j);
                rotate(&mut left[i], &mut right[0], c, c * t);
            }
        }
        if settled {
            // A rotation is orthogonal to rounding only, and its two columns swell or shrink together.
            for (column, unit) in columns.iter_mut().zip(&mut v) {
                let length = products(unit, unit).0.sqrt();
                column.iter_mut().for_each(|x| *x /= length);
                unit.iter_mut().for_each(|x| *x /= length);
            }
            return Ok(v);
        }
    }
    Err(Error::Infinite("the modes of the slab did not separate in f64"))
}

/// a.a, a.b, b.b, in four interleaved sums.
fn products(a: &[f64], b: &[f64]) -> (f64, f64, f64) {
    let mut sums = [[0.0; 4]; 3];
    let (fours_a, rest_a) = a.as_chunks::<4>();
    let (fours_b, rest_b) = b.as_chunks::<4>();
    for (x, y) in fours_a.iter().zip(fours_b) {
        for i in 0..4 {
            sums[0][i] += x[i] * x[i];
            sums[1][i] += x[i] * y[i];
            sums[2][i] += y[i] * y[i];
        }
    }
    for (&x, &y) in rest_a.iter().zip(rest_b) {
        sums[0][0] += x * x;
        sums[1][0] += x * y;
        sums[2][0] += y * y;
    }
    let [aa, ab, bb] = sums.map(|s| (s[0] + s[1]) + (s[2] + s[3]));
    (aa, ab, bb)
}

fn rotate(a: &mut [f64], b: &mut [f64], c: f64, s: f64) {
    for (x, y) in a.iter_mut().zip(b) {
        (*x, *y) = (c * *x - s * *y, s * *x + c * *y);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_graded_matrix_keeps_its_smallest_singular_value() {
        // X = 1 + u u^T with u = (1, 1, 1)/2, times D = diag(1e12, 1, 1e-12). The product of the singular values is
        // the determinant, 7/4; the largest is 1e12 |X e_1| to 1e-24, |X e_1| = sqrt(27)/4; the smallest is
        // 1e-12 / |X^-1 e_3| to 1e-24, X^-1 = 1 - u u^T / (1 + 3/4), |X^-1 e_3| = sqrt(36 + 1 + 1)/7.
        let column = |j: usize, d: f64| (0..3).map(|i| d * (f64::from(u8::from(i == j)) + 0.25)).collect();
        let mut g: Vec<Vec<f64>> = vec![column(0, 1e12), column(1, 1.0), column(2, 1e-12)];
        let v = orthogonalize(&mut g).unwrap();
        let k: Vec<f64> = g.iter().map(|c| products(c, c).0.sqrt()).collect();
        let largest = 1e12 * 27f64.sqrt() / 4.0;
        let smallest = 1e-12 * 7.0 / 38f64.sqrt();
        assert!((k[0] / largest - 1.0).abs() < 1e-14, "{k:?}");
        assert!((k[2] / smallest - 1.0).abs() < 1e-14, "{k:?}");
        assert!((k[0] * k[1] * k[2] / 1.75 - 1.0).abs() < 1e-14, "{k:?}");
        for i in 0..3 {
            for j in 0..3 {
                let exact = f64::from(u8::from(i == j));
                assert!((products(&v[i], &v[j]).1 - exact).abs() < 1e-15);
            }
        }
    }

    #[test]
    fn a_vanishing_column_is_no_obstacle() {
        let mut g = vec![vec![3.0, 4.0, 0.0], vec![3.0, 4.0, 0.0], vec![0.0, 0.0, 1.0]];
        orthogonalize(&mut g).unwrap();
        let mut k: Vec<f64> = g.iter().map(|c| products(c, c).0.sqrt()).collect();
        k.sort_by(f64::total_cmp);
        assert!(k[0] < 1e-15 && (k[1] - 1.0).abs() < 1e-15 && (k[2] - 50f64.sqrt()).abs() < 1e-14, "{k:?}");
    }
}
