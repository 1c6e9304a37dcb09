//! Singular values of a graded matrix, each to its own relative accuracy: one-sided Jacobi rotations.

use crate::error::{Error, Result};
use crate::work;

/// Sweeps over all pairs of columns. Convergence is quadratic at the end: ten or eleven at 490 columns, and 14 at most in the
/// unit tests. Twice as many bound the work.
const SWEEPS: usize = 28;

/// Singular values k of G, with the columns of U K and of V, G = U K V^T.
pub(super) struct Singular {
    pub k: Vec<f64>,
    pub uk: Vec<Vec<f64>>,
    pub v: Vec<Vec<f64>>,
}

/// Decomposes a square matrix given by its columns.
///
/// For G = X D, X well conditioned and D diagonal, every singular value keeps its relative accuracy whatever D spans;
/// methods that first make the matrix tridiagonal lose all that lie below rounding of the largest. A QR
/// decomposition with pivoting comes first, G P = Q R: the columns of R^T are nearly orthogonal already.
/// # Source
/// Hestenes 1958; Demmel and Veselic 1992; Drmac and Veselic 2008
pub(super) fn singular(mut columns: Vec<Vec<f64>>) -> Result<Singular> {
    let n = columns.len();
    let (order, reflectors) = triangular(&mut columns);
    // Row i of R, from the diagonal on, is column i of R^T.
    let mut y: Vec<Vec<f64>> =
        (0..n).map(|i| (0..n).map(|j| if j < i { 0.0 } else { columns[j][i] }).collect()).collect();
    let mut uk = orthogonalize(&mut y)?;
    let k: Vec<f64> = y.iter().map(|column| dot(column, column).sqrt()).collect();
    complete(&mut y, &k);
    let v = y
        .iter()
        .map(|z| {
            let mut column = vec![0.0; n];
            for (&row, &z) in order.iter().zip(z) {
                column[row] = z;
            }
            column
        })
        .collect();
    for (column, k) in uk.iter_mut().zip(&k) {
        for (i, reflector) in reflectors.iter().enumerate().rev() {
            reflect(reflector, &mut column[i..]);
        }
        column.iter_mut().for_each(|x| *x *= k);
    }
    Ok(Singular { k, uk, v })
}

/// Householder's QR with column pivoting: R in the upper part of the columns, in the order returned; reflectors of
/// length root 2.
fn triangular(columns: &mut [Vec<f64>]) -> (Vec<usize>, Vec<Vec<f64>>) {
    let n = columns.len();
    let mut order: Vec<usize> = (0..n).collect();
    let mut reflectors = Vec::with_capacity(n);
    for i in 0..n {
        let norms = columns[i..].iter().map(|c| dot(&c[i..], &c[i..]));
        let (largest, square) =
            norms.enumerate().fold((0, 0.0), |best, (at, x)| if x > best.1 { (at, x) } else { best });
        columns.swap(i, i + largest);
        order.swap(i, i + largest);
        let mut reflector = columns[i][i..].to_vec();
        let length = square.sqrt();
        reflector[0] += length.copysign(reflector[0]);
        let norm = dot(&reflector, &reflector).sqrt();
        if norm > 0.0 {
            let scale = std::f64::consts::SQRT_2 / norm;
            reflector.iter_mut().for_each(|x| *x *= scale);
            for column in &mut columns[i..] {
                reflect(&reflector, &mut column[i..]);
            }
        }
        reflectors.push(reflector);
    }
    (order, reflectors)
}

fn reflect(reflector: &[f64], x: &mut [f64]) {
    let along = dot(reflector, x);
    for (x, r) in x.iter_mut().zip(reflector) {
        *x -= along * r;
    }
}

/// Normalises orthogonal columns of lengths k; one that vanished becomes what is orthogonal to the others.
fn complete(columns: &mut [Vec<f64>], k: &[f64]) {
    for (column, &k) in columns.iter_mut().zip(k) {
        if k > 0.0 {
            column.iter_mut().for_each(|x| *x /= k);
        }
    }
    let n = columns.len();
    let mut missing: Vec<usize> = (0..n).filter(|&j| k[j] == 0.0).collect();
    while let Some(at) = missing.pop() {
        let rest = |i: usize| {
            let mut unit = vec![0.0; n];
            unit[i] = 1.0;
            for _ in 0..2 {
                for (j, column) in columns.iter().enumerate() {
                    if j != at && !missing.contains(&j) {
                        let along = dot(column, &unit);
                        unit.iter_mut().zip(column).for_each(|(x, c)| *x -= along * c);
                    }
                }
            }
            let length = dot(&unit, &unit).sqrt();
            (length, unit)
        };
        let first = rest(0);
        let (length, mut best) = (1..n).map(rest).fold(first, |a, b| if b.0 > a.0 { b } else { a });
        best.iter_mut().for_each(|x| *x /= length);
        columns[at] = best;
    }
}

/// Turns X into X W with orthogonal columns and returns the columns of W, orthogonal.
fn orthogonalize(columns: &mut [Vec<f64>]) -> Result<Vec<Vec<f64>>> {
    let n = columns.len();
    let tolerance = f64::EPSILON * (n as f64).sqrt();
    let mut w: Vec<Vec<f64>> = (0..n)
        .map(|i| {
            let mut unit = vec![0.0; n];
            unit[i] = 1.0;
            unit
        })
        .collect();
    for _ in 0..SWEEPS {
        let mut settled = true;
        work::add(n * n * n / 2);
        let mut squares: Vec<f64> = columns.iter().map(|c| dot(c, c)).collect();
        for i in 0..n {
            for j in i + 1..n {
                let (left, right) = columns.split_at_mut(j);
                let (a, b) = (&mut left[i], &mut right[0]);
                let ab = dot(a, b);
                let (aa, bb) = (squares[i], squares[j]);
                if ab.abs() <= tolerance * (aa * bb).sqrt() {
                    continue;
                }
                settled = false;
                let zeta = (bb - aa) / (2.0 * ab);
                let t = 1f64.copysign(zeta) / (zeta.abs() + (1.0 + zeta * zeta).sqrt());
                let c = 1.0 / (1.0 + t * t).sqrt();
                rotate(a, b, c, c * t);
                (squares[i], squares[j]) = (dot(a, a), bb + t * ab);
                if bb + t * ab < 0.5 * bb {
                    squares[j] = dot(b, b);
                }
                let (left, right) = w.split_at_mut(j);
                rotate(&mut left[i], &mut right[0], c, c * t);
            }
        }
        if settled {
            // A rotation is orthogonal to rounding only, and its two columns swell or shrink together.
            for (column, unit) in columns.iter_mut().zip(&mut w) {
                let length = dot(unit, unit).sqrt();
                column.iter_mut().for_each(|x| *x /= length);
                unit.iter_mut().for_each(|x| *x /= length);
            }
            return Ok(w);
        }
    }
    Err(Error::Infinite("the modes of the slab did not separate in f64"))
}

/// a.b, in eight interleaved sums.
fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut sums = [0.0; 8];
    let (eights_a, rest_a) = a.as_chunks::<8>();
    let (eights_b, rest_b) = b.as_chunks::<8>();
    for (x, y) in eights_a.iter().zip(eights_b) {
        for i in 0..8 {
            sums[i] += x[i] * y[i];
        }
    }
    for (i, (&x, &y)) in rest_a.iter().zip(rest_b).enumerate() {
        sums[i] += x * y;
    }
    ((sums[0] + sums[1]) + (sums[2] + sums[3])) + ((sums[4] + sums[5]) + (sums[6] + sums[7]))
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
        let g: Vec<Vec<f64>> = vec![column(0, 1e12), column(1, 1.0), column(2, 1e-12)];
        let s = singular(g.clone()).unwrap();
        let mut k = s.k.clone();
        k.sort_by(|a, b| b.total_cmp(a));
        let largest = 1e12 * 27f64.sqrt() / 4.0;
        let smallest = 1e-12 * 7.0 / 38f64.sqrt();
        assert!((k[0] / largest - 1.0).abs() < 1e-14, "{k:?}");
        assert!((k[2] / smallest - 1.0).abs() < 1e-14, "{k:?}");
        assert!((k[0] * k[1] * k[2] / 1.75 - 1.0).abs() < 1e-14, "{k:?}");
        for i in 0..3 {
            for j in 0..3 {
                let exact = f64::from(u8::from(i == j));
                assert!((dot(&s.v[i], &s.v[j]) - exact).abs() < 1e-15);
            }
            // G v = k u, to a few roundings of the largest column.
            for (row, uk) in s.uk[i].iter().enumerate() {
                let gv: f64 = g.iter().zip(&s.v[i]).map(|(column, v)| column[row] * v).sum();
                assert!((gv - uk).abs() < 16.0 * f64::EPSILON * largest, "{gv} {uk}");
            }
        }
    }

    #[test]
    fn a_vanishing_column_is_no_obstacle() {
        let g = vec![vec![3.0, 4.0, 0.0], vec![3.0, 4.0, 0.0], vec![0.0, 0.0, 1.0]];
        let s = singular(g).unwrap();
        let mut k = s.k.clone();
        k.sort_by(f64::total_cmp);
        assert!(k[0] < 1e-14 && (k[1] - 1.0).abs() < 1e-14 && (k[2] - 50f64.sqrt()).abs() < 1e-14, "{k:?}");
        for i in 0..3 {
            assert!((dot(&s.v[i], &s.v[i]) - 1.0).abs() < 1e-14, "{:?}", s.v);
        }
        let s = singular(vec![vec![2.0, 0.0], vec![0.0, 0.0]]).unwrap();
        assert!(s.v.iter().all(|v| (dot(v, v) - 1.0).abs() < 1e-15), "{:?}", s.v);
    }
}
