//! The modes of a medium: every solution without a source is a sum of them.
//!
//! With I+ and I- the part of the radiance upwards and downwards at cosine mu that goes with cos(m dphi), p = I+ + I-
//! and q = I+ - I- obey
//!
//! mu dq/dt = A p,  mu dp/dt = B q,  A = 1 - w sum_(l-m even) (2l+1) chi_l P_l P_l^T,  B the same over l-m odd,
//!
//! P_l the normalised associated Legendre functions of order m, on vectors multiplied by the roots of the weights,
//! which makes A and B symmetric. With B = L L^T, A = F F^T and M = diag(mu) a mode p_j f(t), q_j f'(t), f'' = k_j^2 f,
//! comes from the singular value decomposition G = F^T M^-1 L = U K V^T: q_j = L^-T v_j, p_j = M^-1 L v_j. For m = 0,
//! F is known without a decomposition where it is delicate: with e the root of the weights, A e = (1-w) e, so that
//! F = (1 - (1 - sqrt(1-w)) e e^T) C, C C^T = A without its term l = 0, which stays well conditioned up to w = 1.
//!
//! Source: Stamnes, Tsay, Wiscombe and Jayaweera 1988 for the method; the symmetric form is that of Nakajima and
//! Tanaka 1986.

use super::jacobi::singular;
use super::nodes::{Nodes, legendre};
use super::scattering::Scattering;
use crate::error::{Error, Result};
use nalgebra::{Cholesky, DMatrix, DVector};
use std::f64::consts::PI;
use std::sync::{Arc, OnceLock};

/// Below this decay the balance of power gives k to more digits than the decomposition.
const SLOW: f64 = 0.1;

/// Modes of a medium on given nodes, in no order.
pub(crate) struct Modes {
    pub nodes: Arc<Nodes>,
    pub scattering: Arc<Scattering>,
    /// The part of the radiance that goes with cos(m dphi).
    pub order: usize,
    /// Roots of the weights.
    pub root: DVector<f64>,
    /// Inverse decay lengths, 0 or more, per mean free path of `scattering`.
    pub k: Vec<f64>,
    /// Columns p_j and q_j.
    pub even: DMatrix<f64>,
    pub odd: DMatrix<f64>,
    /// sum of root weight and p_j: times 2 pi the fluence of a mode (m = 0).
    pub fluence: Vec<f64>,
    /// sum of root weight, mu and q_j: times 2 pi the net flux upwards of a mode (m = 0).
    pub flux: Vec<f64>,
    /// The moments with l - m even (l > 0) and odd.
    families: [Family; 2],
    /// Moments of p_j and of q_j in their families.
    projections: OnceLock<[DMatrix<f64>; 2]>,
}

/// Moments of one parity.
struct Family {
    /// The first l, from which they go up in twos.
    start: usize,
    /// Columns root((2l+1) |chi_l|) P_l on the nodes, times the roots of the weights.
    columns: DMatrix<f64>,
    /// root((2l+1) |chi_l|), and the sign of chi_l.
    strength: Vec<f64>,
    sign: Vec<f64>,
}

impl Family {
    /// sum of sign, column and column^T.
    fn product(&self) -> DMatrix<f64> {
        let mut signed = self.columns.clone();
        for (mut column, sign) in signed.column_iter_mut().zip(&self.sign) {
            column *= *sign;
        }
        signed * self.columns.transpose()
    }

    /// sign times strength times `p`, which starts at l = m, of every moment.
    fn at(&self, order: usize, p: &[f64]) -> DVector<f64> {
        DVector::from_fn(self.sign.len(), |i, _| {
            self.sign[i] * self.strength[i] * p[self.start + 2 * i - order]
        })
    }
}

impl Modes {
    /// The modes of order m.
    pub fn new(scattering: Arc<Scattering>, nodes: Arc<Nodes>, order: usize) -> Result<Self> {
        const INDEFINITE: Error = Error::Infinite("the scattering matrix of the slab is not positive in f64");
        let (n, albedo) = (nodes.len(), scattering.albedo);
        let root = DVector::from_iterator(n, nodes.weight.iter().map(|w| w.sqrt()));
        let families = families(&nodes, &scattering, &root, order);
        let identity = DMatrix::<f64>::identity(n, n);
        let c = Cholesky::new(&identity - families[0].product() * albedo).ok_or(INDEFINITE)?.unpack();
        let l = Cholesky::new(&identity - families[1].product() * albedo).ok_or(INDEFINITE)?.unpack();

        let mut h = l.clone();
        for i in 0..n {
            h.row_mut(i).unscale_mut(nodes.mu[i]);
        }
        if order == 0 {
            let gap = albedo / (1.0 + scattering.lost.sqrt());
            let along = h.tr_mul(&root);
            h.ger(-gap, &root, &along, 1.0);
        }
        let product = c.tr_mul(&h);
        let decomposed = singular(product.column_iter().map(|x| x.iter().copied().collect()).collect())?;
        let v = DMatrix::from_iterator(n, n, decomposed.v.into_iter().flatten());
        let ku = DMatrix::from_iterator(n, n, decomposed.uk.into_iter().flatten());
        let mut k = decomposed.k;

        let mut p = c.tr_solve_lower_triangular(&ku).ok_or(INDEFINITE)?;
        let q = l.tr_solve_lower_triangular(&v).ok_or(INDEFINITE)?;
        let (mut fluence, mut flux) = (vec![], vec![]);
        if order == 0 {
            // p_j but for its part along e, from the side of U, where the horizon does not magnify roundings ...
            let along = p.tr_mul(&root);
            p.ger(-1.0, &root, &along, 1.0);
            // ... and that part from e^T M p_j = e^T L v_j.
            let slant = DVector::from_fn(n, |i, _| root[i] * nodes.mu[i]);
            let known = (&l * &v).tr_mul(&root) - p.tr_mul(&slant);
            let share = known / root.dot(&slant);
            p.ger(1.0, &root, &share, 1.0);
            fluence = share.iter().copied().collect::<Vec<f64>>();
            flux = q.tr_mul(&slant).iter().copied().collect::<Vec<f64>>();
            let slowest = (0..n).fold(0, |best, j| if k[j] < k[best] { j } else { best });
            if k[slowest] < SLOW {
                // k^2 M q = A p along e.
                k[slowest] = (scattering.lost * (fluence[slowest] / flux[slowest]).abs()).sqrt();
            }
        }
        let projections = OnceLock::new();
        Ok(Modes { nodes, scattering, order, root, k, even: p, odd: q, fluence, flux, families, projections })
    }

    /// The slowest decay, per mean free path.
    pub fn slowest(&self) -> f64 {
        self.k.iter().fold(f64::INFINITY, |a, &b| a.min(b))
    }

    /// What a beam of unit irradiance at cosine `mu0` scatters, at t = 0: the sources s_p of q and s_q of p in
    /// mu dq/dt = A p - s_p e^(-t/mu0), mu dp/dt = B q - s_q e^(-t/mu0), projected on the modes.
    pub fn beam(&self, mu0: f64) -> (DVector<f64>, DVector<f64>) {
        let p = legendre(self.order, self.scattering.degree().max(self.order), mu0);
        let turns = if self.order == 0 { 1.0 } else { 2.0 };
        let scale = turns * self.scattering.albedo / (2.0 * PI * mu0);
        let [even, odd] = &self.families;
        let mut up = &even.columns * even.at(self.order, &p);
        if self.order == 0 {
            up += &self.root;
        }
        // Odd moments change sign: the beam goes down.
        let down = &odd.columns * odd.at(self.order, &p);
        (self.even.tr_mul(&up) * scale, self.odd.tr_mul(&down) * -scale)
    }

    /// The source function at cosine +-`mu` of every mode, (w/2) sum (2l+1) chi_l P_l(mu) int P_l I dmu': even part,
    /// times f, and odd part, times f'. Upwards it is their sum, downwards their difference.
    pub fn source(&self, mu: f64) -> [DVector<f64>; 2] {
        let [even, odd] = self.projections.get_or_init(|| {
            let [even, odd] = &self.families;
            [even.columns.tr_mul(&self.even), odd.columns.tr_mul(&self.odd)]
        });
        let p = legendre(self.order, self.scattering.degree().max(self.order), mu);
        let half = 0.5 * self.scattering.albedo;
        let mut up = even.tr_mul(&self.families[0].at(self.order, &p)) * half;
        if self.order == 0 {
            up.iter_mut().zip(&self.fluence).for_each(|(x, phi)| *x += half * phi);
        }
        [up, odd.tr_mul(&self.families[1].at(self.order, &p)) * half]
    }

    /// The part of the radiance that goes with cos(m dphi) of light scattered exactly twice, as the nodes have it: from a
    /// beam at `mu0` into `mu` (signed), over paths `up` and `down` by way of every node.
    pub fn twice(&self, mu0: f64, mu: f64, paths: &[[f64; 2]]) -> f64 {
        let degree = self.scattering.degree().max(self.order);
        let (lit, seen) = (legendre(self.order, degree, mu0), legendre(self.order, degree, mu.abs()));
        let at = |p: &[f64]| {
            let [even, odd] = [0, 1].map(|parity| {
                let family: &Family = &self.families[parity];
                &family.columns * family.at(self.order, p)
            });
            // Without the root of the weight.
            let whole = if self.order == 0 { 1.0 } else { 0.0 };
            (even.component_div(&self.root).add_scalar(whole), odd.component_div(&self.root))
        };
        let ((lit_even, lit_odd), (even, odd)) = (at(&lit), at(&seen));
        let sign = if mu < 0.0 { -1.0 } else { 1.0 };
        let sum: f64 = (0..paths.len())
            .map(|i| {
                let up = (even[i] + sign * odd[i]) * (lit_even[i] - lit_odd[i]) * paths[i][0];
                let down = (even[i] - sign * odd[i]) * (lit_even[i] + lit_odd[i]) * paths[i][1];
                self.nodes.weight[i] * (up + down)
            })
            .sum();
        let turns = if self.order == 0 { 1.0 } else { 2.0 };
        turns * self.scattering.albedo * self.scattering.albedo / (8.0 * PI) * sum
    }
}

/// The moments of both parities.
///
/// For m = 0, what the rule gets wrong by rounding in sum w P_l (even) and sum w mu P_l (odd) is taken out, so that
/// photons and the first moment of scattering are conserved exactly.
fn families(nodes: &Nodes, scattering: &Scattering, root: &DVector<f64>, order: usize) -> [Family; 2] {
    let n = nodes.len();
    let degree = scattering.degree().max(order);
    let table: Vec<Vec<f64>> = nodes.mu.iter().map(|&mu| legendre(order, degree, mu)).collect();
    let column = |l: usize| DVector::from_iterator(n, (0..n).map(|i| root[i] * table[i][l - order]));
    [0, 1].map(|parity| {
        let start = if order == 0 && parity == 0 { 2 } else { order + parity };
        let moments: Vec<(usize, f64)> =
            (start..=scattering.degree()).step_by(2).map(|l| (l, scattering.moments[l])).collect();
        let strength: Vec<f64> =
            moments.iter().map(|&(l, chi)| ((2 * l + 1) as f64 * chi.abs()).sqrt()).collect();
        let sign = moments.iter().map(|&(_, chi)| 1f64.copysign(chi)).collect();
        let conserved = (order == 0 && scattering.degree() >= parity).then(|| column(parity).normalize());
        let columns: Vec<DVector<f64>> = moments
            .iter()
            .zip(&strength)
            .map(|(&(l, _), strength)| {
                let mut p = column(l);
                if let Some(conserved) = conserved.as_ref().filter(|_| l > parity) {
                    p.axpy(-conserved.dot(&p), conserved, 1.0);
                }
                p * *strength
            })
            .collect();
        let columns = if columns.is_empty() { DMatrix::zeros(n, 0) } else { DMatrix::from_columns(&columns) };
        Family { start, columns, strength, sign }
    })
}
