//! Radiance from its sources: I(t) = int S(t') e^(-|t-t'|/mu) dt'/mu, exactly for a polynomial S on every panel.

use super::mesh::Mesh;
use crate::quadrature::GaussLegendre;
use libm::exp;

/// Up to this optical length along the ray, Gauss's rule of 32 nodes integrates e^(-v) times a polynomial of degree 20
/// to rounding (the Bernstein ellipse of parameter 5 leaves e^(0.8 v) 5^(-44)); beyond it, e^(-v) has gone, and
/// Laguerre's rule of 12 nodes is exact.
const SHORT: f64 = 36.0;

/// Up to this one, 16 nodes do (the next coefficient of e^(-v) is 2 I_13(1/2) = 5e-18).
const SHORTEST: f64 = 1.0;

/// The rays of one direction through every class of panels.
pub(super) struct Ray {
    /// Per class: (nodes + 1) rows, the last for the panel's end, of `nodes` weights on the sources.
    weights: Vec<Vec<f64>>,
    /// Per class: what is left of the light that enters, at each node and at the end.
    decay: Vec<Vec<f64>>,
}

/// What all rays share: sources between nodes.
pub(super) struct Panels {
    /// Rules of 16 and of 32 nodes, and per target, per node on \[0, target\]: the Lagrange polynomials there.
    gauss: [(GaussLegendre, Vec<Vec<Vec<f64>>>); 2],
    laguerre: Vec<(f64, f64)>,
    targets: Vec<f64>,
}

impl Panels {
    pub fn new(mesh: &Mesh) -> Self {
        let mut targets = mesh.rule.nodes.clone();
        targets.push(1.0);
        let gauss = [16, 32].map(|order| {
            let rule = GaussLegendre::rule(order);
            let at = |x: &f64| rule.nodes.iter().map(|u| mesh.basis(x * u)).collect();
            let between = targets.iter().map(at).collect();
            (rule, between)
        });
        Panels { gauss, laguerre: laguerre(12), targets }
    }

    pub fn ray(&self, mesh: &Mesh, mu: f64) -> Ray {
        let (mut weights, mut decay) = (Vec::new(), Vec::new());
        for class in 0..mesh.classes() {
            let a = mesh.length(class) / mu;
            decay.push(self.targets.iter().map(|x| exp(-a * x)).collect());
            let mut rows = Vec::with_capacity(self.targets.len() * mesh.nodes());
            for (q, &x) in self.targets.iter().enumerate() {
                let mut row = vec![0.0; mesh.nodes()];
                let mut add = |weight: f64, basis: &[f64]| {
                    row.iter_mut().zip(basis).for_each(|(r, b)| *r += weight * b);
                };
                let length = a * x;
                if length <= SHORT {
                    let (rule, between) = &self.gauss[usize::from(length > SHORTEST)];
                    for ((u, w), basis) in rule.nodes.iter().zip(&rule.weights).zip(&between[q]) {
                        add(w * length * exp(-length * (1.0 - u)), basis);
                    }
                } else {
                    for &(v, w) in &self.laguerre {
                        add(w, &mesh.basis(x - v / a));
                    }
                }
                rows.extend(row);
            }
            weights.push(rows);
        }
        Ray { weights, decay }
    }
}

impl Ray {
    /// Radiance at all nodes from the `source` at all nodes, and where the light leaves: downwards through the far
    /// face, upwards through the lit one.
    pub fn trace(&self, mesh: &Mesh, upwards: bool, source: &[f64], out: &mut [f64]) -> f64 {
        let n = mesh.nodes();
        let mut entering = 0.0;
        let mut along = vec![0.0; n];
        for step in 0..mesh.panels() {
            let panel = if upwards { mesh.panels() - 1 - step } else { step };
            let class = mesh.class(panel);
            let (rows, decay) = (&self.weights[class], &self.decay[class]);
            let here = &source[panel * n..][..n];
            along.copy_from_slice(here);
            if upwards {
                along.reverse();
            }
            let at = |q: usize| -> f64 {
                let row = &rows[q * n..][..n];
                row.iter().zip(&along).map(|(w, s)| w * s).sum::<f64>() + decay[q] * entering
            };
            for q in 0..n {
                let node = if upwards { n - 1 - q } else { q };
                out[panel * n + node] = at(q);
            }
            entering = at(n);
        }
        entering
    }
}

/// Nodes and weights of int_0^inf e^(-v) f(v) dv, by Newton's method on the recurrence with deflation.
fn laguerre(n: usize) -> Vec<(f64, f64)> {
    let polynomial = |x: f64| {
        let (mut before, mut p) = (0.0, 1.0);
        for k in 0..n {
            let k = k as f64;
            let next = ((2.0 * k + 1.0 - x) * p - k * before) / (k + 1.0);
            before = p;
            p = next;
        }
        (p, before)
    };
    let mut found: Vec<(f64, f64)> = Vec::new();
    for _ in 0..n {
        // From the left of all roots that remain, Newton's steps on the deflated polynomial rise to the next one.
        let mut x = found.last().map_or(0.0, |&(v, _)| v);
        x += 1e-3;
        for _ in 0..200 {
            let (p, before) = polynomial(x);
            // x L_n' = n (L_n - L_(n-1)).
            let slope = n as f64 * (p - before) / x;
            let others: f64 = found.iter().map(|(v, _)| 1.0 / (x - v)).sum();
            let step = p / (slope - p * others);
            x -= step;
            if step.abs() <= 1e-15 * x {
                break;
            }
        }
        let (_, before) = polynomial(x);
        let nf = n as f64;
        found.push((x, x / (nf * nf * before * before)));
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn laguerre_integrates_factorials() {
        let rule = laguerre(12);
        let mut factorial = 1.0;
        for degree in 0..24 {
            let sum: f64 = rule.iter().map(|(v, w)| w * v.powi(degree)).sum();
            assert!((sum / factorial - 1.0).abs() < 1e-12, "{degree} {sum}");
            factorial *= f64::from(degree + 1);
        }
    }

    #[test]
    fn a_ray_through_a_polynomial_source_is_exact() {
        // S = t: I = t - mu + mu e^(-t/mu) downwards.
        let mesh = Mesh::new(3.0, 1e-6, 12);
        let panels = Panels::new(&mesh);
        let mut out = vec![0.0; mesh.depth.len()];
        for mu in [1.0, 0.3, 0.05, 1e-2, 1e-4, 1e-9] {
            let ray = panels.ray(&mesh, mu);
            let end = ray.trace(&mesh, false, &mesh.depth, &mut out);
            let exact = |t: f64| if t < 1e-2 * mu { 0.5 * t * t / mu } else { t - mu + mu * exp(-t / mu) };
            for (t, got) in mesh.depth.iter().zip(&out) {
                let rough = if *t < 1e-2 * mu { 1e-2 * exact(*t) } else { 0.0 };
                assert!((got - exact(*t)).abs() < 1e-14 + rough, "{mu} {t} {got}");
            }
            assert!((end - exact(3.0)).abs() < 1e-14, "{mu}");
            // Mirrored: S = height, upwards.
            let up = ray.trace(&mesh, true, &mesh.height, &mut out);
            assert!((up - end).abs() < 1e-14);
        }
    }
}
