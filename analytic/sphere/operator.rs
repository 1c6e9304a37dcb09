//! The operator of the sphere, (K f)(r) = int_0^a (r'/r) [E_1(|r-r'|) - E_1(r+r')] f(r') dr', on functions that are
//! polynomials of degree 19 on panels graded towards the surface.

use super::first_flight::{first_flight, shells};
use crate::peierls::{Mesh, NODES};
use crate::quadrature::GaussLegendre;
use nalgebra::{DMatrix, DVector, Dyn, LU};

/// Substitution z = L s^5 about the singular point, as in the slab.
const POWER_NODES: usize = 52;

/// Gauss nodes on each doubling of the distance from it.
const DOUBLING_NODES: usize = 24;

/// First panel over min(a, 1): f ln f is met to 1e-3 of it, and its width multiplies that once more.
const FIRST: f64 = 1e-7;

/// A function on the sphere by its values at the nodes, and the bound on their error.
#[derive(Debug, Clone)]
pub(crate) struct Field {
    pub values: DVector<f64>,
    pub bound: DVector<f64>,
}

/// A point where the polynomial is compared with the equation.
struct Probe {
    r: f64,
    depth: f64,
    row: DVector<f64>,
}

/// The discretised operator of one radius.
pub(crate) struct ShellOperator {
    pub radius: f64,
    /// Panels in the depth a - r, 0 to a.
    pub mesh: Mesh,
    /// Radii of the nodes.
    pub radii: Vec<f64>,
    matrix: DMatrix<f64>,
    probes: Vec<Probe>,
    power: GaussLegendre,
    doubling: GaussLegendre,
    /// Largest relative defect of a row from 2 (1 - P(r)), which is known in closed form.
    pub row_defect: f64,
}

impl ShellOperator {
    pub(crate) fn new(radius: f64) -> Self {
        let mesh = Mesh::new(2.0 * radius, FIRST);
        let radii: Vec<f64> = mesh.nodes.iter().map(|x| radius - x).collect();
        let n = radii.len();
        let mut operator = ShellOperator {
            radius,
            mesh,
            radii,
            matrix: DMatrix::zeros(n, n),
            probes: Vec::new(),
            power: GaussLegendre::rule(POWER_NODES),
            doubling: GaussLegendre::rule(DOUBLING_NODES),
            row_defect: 0.0,
        };
        let mut worst: f64 = 0.0;
        let mut defect = |r: f64, depth: f64, row: &DVector<f64>| {
            let known = 2.0 * first_flight(radius, r, depth).1;
            worst = worst.max((row.sum() / known - 1.0).abs());
        };
        for i in 0..n {
            let (r, depth) = (operator.radii[i], operator.mesh.nodes[i]);
            let row = operator.row(r, depth);
            defect(r, depth, &row);
            operator.matrix.row_mut(i).tr_copy_from(&row);
        }
        for i in 0..=2 * operator.mesh.panels() {
            let depth = operator.mesh.probe(i);
            let r = radius - depth;
            let row = operator.row(r, depth);
            defect(r, depth, &row);
            operator.probes.push(Probe { r, depth, row });
        }
        operator.row_defect = worst;
        operator
    }

    /// Weights of f's values for (K f)(r), with `depth` = a - r.
    pub(crate) fn row(&self, r: f64, depth: f64) -> DVector<f64> {
        let mut row = DVector::zeros(self.radii.len());
        for p in 0..self.mesh.panels() {
            self.panel(p, r, depth, &mut row.as_mut_slice()[p * NODES..(p + 1) * NODES]);
        }
        row
    }

    fn panel(&self, p: usize, r: f64, depth: f64, out: &mut [f64]) {
        let (start, length) = self.mesh.panel(p);
        let end = self.mesh.edges[p + 1];
        let distance = (start - depth).max(depth - end);
        if distance >= length {
            for (j, w) in out.iter_mut().enumerate() {
                let node = p * NODES + j;
                let gap = (self.mesh.nodes[node] - depth).abs();
                *w += self.mesh.lengths[node] * shells(r, self.radii[node], gap);
            }
        } else if distance > 0.0 {
            let inwards = depth < start;
            self.doublings(p, r, depth, inwards, distance, distance + length, out);
        } else {
            for (inwards, reach) in [(false, depth - start), (true, end - depth)] {
                if reach <= 0.0 {
                    continue;
                }
                // The image of the point in the centre, r' = -r, is singular too: outwards it is 2r behind the
                // point, so the substitution goes no farther than r. A point this near the centre is the centre.
                let image = if inwards { f64::INFINITY } else { r.max(1e-18 * reach) };
                let close = reach.min(1.0).min(image);
                for (s, w) in self.power.nodes.iter().zip(&self.power.weights) {
                    let s4 = s * s * s * s;
                    self.add(p, r, depth, inwards, close * s4 * s, 5.0 * w * close * s4, out);
                }
                self.doublings(p, r, depth, inwards, close, reach, out);
            }
        }
    }

    #[expect(clippy::too_many_arguments, reason = "one panel, one point, one range of distances")]
    fn doublings(&self, p: usize, r: f64, depth: f64, inwards: bool, near: f64, far: f64, out: &mut [f64]) {
        let mut near = near;
        while near < far {
            let next = if 2.5 * near >= far { far } else { 2.0 * near };
            for (x, w) in self.doubling.nodes.iter().zip(&self.doubling.weights) {
                self.add(p, r, depth, inwards, near + (next - near) * x, w * (next - near), out);
            }
            near = next;
        }
    }

    /// Adds the shell at distance `gap` from the point.
    #[expect(clippy::too_many_arguments, reason = "one panel, one point, one distance")]
    fn add(&self, p: usize, r: f64, depth: f64, inwards: bool, gap: f64, weight: f64, out: &mut [f64]) {
        let (start, length) = self.mesh.panel(p);
        let (source, sign) = if inwards { (r - gap, 1.0) } else { (r + gap, -1.0) };
        if source <= 0.0 || gap == 0.0 {
            return;
        }
        let weight = weight * shells(r, source, gap);
        let mut at = [0.0; NODES];
        self.mesh.basis.at((depth - start) / length + sign * gap / length, &mut at);
        for (w, b) in out.iter_mut().zip(&at) {
            *w += weight * b;
        }
    }

    /// The operator by the values at the nodes.
    #[cfg(test)]
    pub(crate) fn matrix(&self) -> &DMatrix<f64> {
        &self.matrix
    }

    /// K f at the nodes.
    pub(crate) fn apply(&self, f: &DVector<f64>) -> DVector<f64> {
        &self.matrix * f
    }

    /// Factors of 1 - (albedo/2) K; none are needed without scattering.
    pub(crate) fn factor(&self, albedo: f64) -> Option<LU<f64, Dyn, Dyn>> {
        let n = self.radii.len();
        (albedo > 0.0).then(|| (DMatrix::identity(n, n) - &self.matrix * (0.5 * albedo)).lu())
    }

    /// Values at the nodes of a function of radius and depth.
    pub(crate) fn sample(&self, f: impl Fn(f64, f64) -> f64) -> DVector<f64> {
        DVector::from_iterator(
            self.radii.len(),
            self.radii.iter().zip(&self.mesh.nodes).map(|(&r, &depth)| f(r, depth)),
        )
    }

    /// int_0^a f(r) g(r) r^2 dr, with g given r and depth.
    pub(crate) fn integrate(&self, f: &DVector<f64>, g: impl Fn(f64, f64) -> f64) -> f64 {
        let mut sum = 0.0;
        for (i, (&r, &depth)) in self.radii.iter().zip(&self.mesh.nodes).enumerate() {
            sum += self.mesh.lengths[i] * r * r * f[i] * g(r, depth);
        }
        sum
    }

    /// The polynomial at a depth, and the largest bound of its panel.
    pub(crate) fn interpolate(&self, f: &Field, depth: f64) -> (f64, f64) {
        let p = self.mesh.find(depth);
        let (start, length) = self.mesh.panel(p);
        let value = self.mesh.interpolate(f.values.as_slice(), p, (depth - start) / length);
        let bound = f.bound.rows(p * NODES, NODES).amax();
        (value, bound)
    }

    /// Per panel: twice the largest defect between `f` and `source` + (albedo/2) K `g` at its nodes, ends and middle,
    /// plus rounding and what the rows are off. `ulps` is what the source and the sums may have lost.
    pub(crate) fn residual(
        &self,
        half: f64,
        f: &DVector<f64>,
        g: &DVector<f64>,
        source: impl Fn(f64, f64) -> f64,
        ulps: f64,
    ) -> DVector<f64> {
        let image = self.apply(g);
        let absolute = self.apply(&g.abs());
        let mut out = DVector::zeros(f.len());
        let probes: Vec<f64> =
            self.probes.iter().map(|probe| source(probe.r, probe.depth) + half * probe.row.dot(g)).collect();
        for p in 0..self.mesh.panels() {
            let range = p * NODES..(p + 1) * NODES;
            let (mut worst, mut size, mut rows) = (0.0_f64, 0.0_f64, 0.0_f64);
            for i in range.clone() {
                let known = source(self.radii[i], self.mesh.nodes[i]);
                worst = worst.max((known + half * image[i] - f[i]).abs());
                size = size.max(known.abs() + half * absolute[i].abs()).max(f[i].abs());
                rows = rows.max(half * absolute[i].abs());
            }
            for (i, xi) in [(2 * p, 0.0), (2 * p + 1, 0.5), (2 * p + 2, 1.0)] {
                worst = worst.max((probes[i] - self.mesh.interpolate(f.as_slice(), p, xi)).abs());
            }
            // A depth has an error of a rounding of itself, seen on the scale of the panel.
            let (start, length) = self.mesh.panel(p);
            let rounding = f64::EPSILON * (ulps + 2.0 * (start + length) / length) * size;
            out.rows_mut(p * NODES, NODES).fill(2.0 * worst + rounding + self.row_defect * rows);
        }
        out
    }

    /// Solves f = source + (albedo/2) K f, with one step of refinement. The inverse is a positive operator, so the
    /// error is at most what it makes of the residual. `None` where the matrix is singular in f64.
    pub(crate) fn solve(
        &self,
        albedo: f64,
        factors: Option<&LU<f64, Dyn, Dyn>>,
        source: impl Fn(f64, f64) -> f64,
        ulps: f64,
    ) -> Option<Field> {
        let half = 0.5 * albedo;
        let known = self.sample(&source);
        let mut values = known.clone();
        if let Some(lu) = factors {
            values = lu.solve(&known)?;
            let defect = &known + self.apply(&values) * half - &values;
            values += lu.solve(&defect)?;
        }
        let residual = self.residual(half, &values, &values, source, ulps);
        let mut bound = residual.clone();
        if let Some(lu) = factors {
            bound += lu.solve(&(self.apply(&residual) * half))?.abs();
        }
        Some(Field { values, bound })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_give_the_collision_probability() {
        for a in [1e-12, 1e-3, 0.7, 1.0, 6.0, 40.0] {
            let operator = ShellOperator::new(a);
            // A rounding a node, and the four or so of each kernel value.
            let rounding = (operator.radii.len() as f64).sqrt() * 16.0 * f64::EPSILON;
            assert!(operator.row_defect < rounding, "{a}: {:e}", operator.row_defect);
            for part in [0.0, 1e-300, 1e-9, 1e-3, 0.2, 0.9, 1.0] {
                let r = part * a;
                let known = 2.0 * first_flight(a, r, a - r).1;
                let sum = operator.row(r, a - r).sum();
                assert!((sum / known - 1.0).abs() < rounding, "{a} {part}: {sum} {known}");
            }
        }
    }

    /// (1/2) K r^2 is, by the divergence of r^2 e^(-l) along each direction, known in closed form; here by the
    /// mean over directions of int_0^l (r^2 + 2 r mu s + s^2) e^(-s) ds.
    #[test]
    fn rows_integrate_squares() {
        let rule = GaussLegendre::rule(400);
        for a in [0.3_f64, 2.0, 9.0] {
            let operator = ShellOperator::new(a);
            let squares = operator.sample(|r, _| r * r);
            for part in [0.0, 1e-6, 0.04, 0.5, 0.95] {
                let r = part * a;
                let want = rule.integrate(0.0, 1.0, |x| {
                    let mu = 2.0 * x - 1.0;
                    let l = -r * mu + (a * a - r * r * (1.0 - mu * mu)).sqrt();
                    let e = libm::exp(-l);
                    let zeroth = -libm::expm1(-l);
                    let first = zeroth - l * e;
                    let second = 2.0 * first - l * l * e;
                    r * r * zeroth + 2.0 * r * mu * first + second
                });
                let got = 0.5 * operator.row(r, a - r).dot(&squares);
                assert!((got / want - 1.0).abs() < 2e-13, "{a} {part}: {got} {want}");
            }
        }
    }
}
