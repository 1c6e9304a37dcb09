//! The modes of the slab: every solution without a source is a sum of them.
//!
//! With I+ and I- the azimuthal means of the radiance upwards and downwards at cosine mu, p = I+ + I- and
//! q = I+ - I- obey
//!
//! mu dq/dt = A p,  mu dp/dt = B q,  A = 1 - w sum_even (2l+1) g^l P_l P_l^T,  B = 1 - w sum_odd (2l+1) g^l P_l P_l^T
//!
//! on vectors multiplied by the roots of the weights, which makes A and B symmetric. With B = L L^T, A = F F^T and
//! M = diag(mu) a mode p_j f(t), q_j f'(t), f'' = k_j^2 f, comes from the singular value decomposition
//! G = F^T M^-1 L = U K V^T: q_j = L^-T v_j, p_j = M^-1 L v_j. F is known without a decomposition where it is
//! delicate: with e the root of the weights, A e = (1-w) e, so that F = (1 - (1 - sqrt(1-w)) e e^T) C, C C^T = A
//! without its term l = 0, which stays well conditioned up to w = 1.
//!
//! Source: Stamnes, Tsay, Wiscombe and Jayaweera 1988 for the method; the symmetric form is that of Nakajima and
//! Tanaka 1986.

use super::jacobi::orthogonalize;
use super::nodes::{Nodes, legendre};
use crate::error::{Error, Result};
use nalgebra::{Cholesky, DMatrix, DVector};
use std::f64::consts::PI;

/// Modes of a medium on given nodes, in no order.
pub(super) struct Modes {
    pub nodes: Nodes,
    /// Roots of the weights.
    pub root: DVector<f64>,
    /// Inverse decay lengths, 0 or more.
    pub k: Vec<f64>,
    /// Columns p_j and q_j.
    pub even: DMatrix<f64>,
    pub odd: DMatrix<f64>,
    /// sum of root weight and p_j: times 2 pi the fluence of a mode.
    pub fluence: Vec<f64>,
    /// sum of root weight, mu and q_j: times 2 pi the net flux upwards of a mode.
    pub flux: Vec<f64>,
    /// Columns of the moments l = 2, 4, ... and l = 1, 3, ...
    moments: (DMatrix<f64>, DMatrix<f64>),
    albedo: f64,
    g: f64,
}

impl Modes {
    pub fn new(albedo: f64, g: f64, nodes: Nodes) -> Result<Self> {
        const INDEFINITE: Error = Error::Infinite("the scattering matrix of the slab is not positive in f64");
        let n = nodes.len();
        let root = DVector::from_iterator(n, nodes.weight.iter().map(|w| w.sqrt()));
        let mu = DVector::from_column_slice(&nodes.mu);
        let moments = moments(&nodes, &root, g);
        let a = DMatrix::identity(n, n) - (&moments.0 * moments.0.transpose()) * albedo;
        let b = DMatrix::identity(n, n) - (&moments.1 * moments.1.transpose()) * (albedo * 1f64.copysign(g));
        let c = Cholesky::new(a).ok_or(INDEFINITE)?.unpack();
        let l = Cholesky::new(b).ok_or(INDEFINITE)?.unpack();

        let mut h = l.clone();
        for i in 0..n {
            h.row_mut(i).unscale_mut(mu[i]);
        }
        let gap = albedo / (1.0 + (1.0 - albedo).sqrt());
        let along = h.tr_mul(&root);
        h.ger(-gap, &root, &along, 1.0);
        let product = c.tr_mul(&h);
        // Columns fall like 1/mu: the order in which the rotations converge soonest.
        let mut columns: Vec<Vec<f64>> = product.column_iter().map(|x| x.iter().copied().collect()).collect();
        let v = orthogonalize(&mut columns)?;
        let v = DMatrix::from_iterator(n, n, v.into_iter().flatten());
        let ku = DMatrix::from_iterator(n, n, columns.into_iter().flatten());
        let k = ku.column_iter().map(|x| x.norm()).collect();

        // p_j but for its part along e, from the side of U, where the horizon does not magnify roundings ...
        let mut p = c.tr_solve_lower_triangular(&ku).ok_or(INDEFINITE)?;
        let along = p.tr_mul(&root);
        p.ger(-1.0, &root, &along, 1.0);
        // ... and that part from e^T M p_j = e^T L v_j.
        let slant = root.component_mul(&mu);
        let known = (&l * &v).tr_mul(&root) - p.tr_mul(&slant);
        let fluence = known / root.dot(&slant);
        p.ger(1.0, &root, &fluence, 1.0);
        let q = l.tr_solve_lower_triangular(&v).ok_or(INDEFINITE)?;
        let flux = q.tr_mul(&slant);
        Ok(Modes {
            nodes,
            root,
            k,
            even: p,
            odd: q,
            fluence: fluence.iter().copied().collect(),
            flux: flux.iter().copied().collect(),
            moments,
            albedo,
            g,
        })
    }

    /// The slowest decay, per mean free path.
    pub fn slowest(&self) -> f64 {
        self.k.iter().fold(f64::INFINITY, |a, &b| a.min(b))
    }

    /// What a beam of unit irradiance at cosine `mu0` scatters, at t = 0: the sources s_p of q and s_q of p in
    /// mu dq/dt = A p - s_p e^(-t/mu0), mu dp/dt = B q - s_q e^(-t/mu0), projected on the modes.
    pub fn beam(&self, mu0: f64) -> (DVector<f64>, DVector<f64>) {
        let p = legendre(self.nodes.degree, mu0);
        let scale = self.albedo / (2.0 * PI * mu0);
        let strengths = |start: usize, count: usize| {
            DVector::from_fn(count, |i, _| strength(self.g, start + 2 * i) * p[start + 2 * i])
        };
        let even = &self.root + &self.moments.0 * strengths(2, self.moments.0.ncols());
        // Odd moments change sign: the beam goes down.
        let odd = &self.moments.1 * strengths(1, self.moments.1.ncols()) * 1f64.copysign(-self.g);
        (self.even.tr_mul(&even) * scale, self.odd.tr_mul(&odd) * scale)
    }
}

/// Root of (2l+1) |g|^l.
fn strength(g: f64, l: usize) -> f64 {
    ((2.0 * l as f64 + 1.0) * g.abs().powi(l as i32)).sqrt()
}

/// Columns root(weight (2l+1) |g|^l) P_l for even l > 0 and for odd l.
///
/// What the rule gets wrong by rounding in sum w P_l (even) and sum w mu P_l (odd) is taken out, so that photons
/// and the first moment of scattering are conserved exactly.
fn moments(nodes: &Nodes, root: &DVector<f64>, g: f64) -> (DMatrix<f64>, DMatrix<f64>) {
    let n = nodes.len();
    let table: Vec<Vec<f64>> = nodes.mu.iter().map(|&mu| legendre(nodes.degree, mu)).collect();
    let column = |l: usize| DVector::from_iterator(n, (0..n).map(|i| root[i] * table[i][l]));
    let family = |first: usize| {
        let conserved = column(first).normalize();
        let start = if first == 0 { 2 } else { 1 };
        let columns: Vec<DVector<f64>> = (start..=nodes.degree)
            .step_by(2)
            .map(|l| {
                let mut p = column(l);
                if l > first {
                    p.axpy(-conserved.dot(&p), &conserved, 1.0);
                }
                p * strength(g, l)
            })
            .collect();
        DMatrix::from_columns(&columns)
    };
    (family(0), family(1))
}
