//! Kernels of adding and doubling, closed by the two faces.

use super::direct::Direct;
use super::face::Rule;
use super::fluxes::{Fluxes, Light};
use crate::adding_doubling::Stack;
use crate::error::{Error, Result};
use crate::incidence::Incidence;
use libm::{expm1, sqrt};
use nalgebra::{DMatrix, DVector};
use std::f64::consts::PI;

/// Light between the faces on one set of nodes.
pub(super) struct Closed {
    stack: Stack,
    /// Light that enters the medium through the lit face and through the far one: what was not scattered yet and
    /// what the faces return of the rest.
    top: DVector<f64>,
    bottom: DVector<f64>,
    roundings: f64,
    fluxes: Fluxes,
}

impl Closed {
    /// Light b on its way that never scattered enters through the lit face, its echo r e b through the far one; with U
    /// scattered light that goes up at the lit face and D such that goes down at the far one,
    ///
    /// U = R (r U + b) + (T + e) r D + T (r e b),  D = (T + e) r U + T b + R (r D + r e b)
    pub fn new(direct: &Direct, albedo: f64, moments: &[f64], rule: Rule) -> Result<Self> {
        let face = direct.face;
        let beam: Vec<f64> = direct.beam().into_iter().collect();
        let nodes = face.nodes(rule).with(&beam);
        let stack = Stack::new(direct.tau, albedo, moments, 0, nodes)?;
        let nodes = &stack.nodes;
        let n = nodes.len();
        let root = DVector::from_fn(n, |i, _| sqrt(nodes.mu[i] * nodes.weight[i]));
        let faces: Vec<(f64, f64)> = nodes.mu.iter().map(|&mu| face.reflected_inside(mu)).collect();
        let light = DVector::from_fn(n, |i, _| match direct.incidence {
            Incidence::Beam { .. } if i == nodes.count => direct.entering() / (2.0 * PI * root[i]),
            Incidence::Diffuse if i < nodes.count => {
                let echo = faces[i].0 * stack.direct()[i];
                root[i] / PI * face.spread() * faces[i].1 / (1.0 - echo * echo)
            }
            _ => 0.0,
        });
        let returning = DVector::from_fn(n, |i, _| faces[i].0);
        let echo = light.component_mul(stack.direct()).component_mul(&returning);
        let faces_of = |u: &DVector<f64>| u.component_mul(&returning);
        let (up, down) = if direct.tau < 1.0 {
            halves(&stack, direct.tau, &faces, &light, &echo)
        } else {
            passages(&stack, &returning, &light, &echo)
        }
        .ok_or(Error::Infinite("light between the faces does not die away in f64"))?;
        let leaving =
            |u: &DVector<f64>| 2.0 * PI * (0..nodes.count).map(|i| root[i] * faces[i].1 * u[i]).sum::<f64>();
        let (reflected, transmitted) = (leaving(&up), leaving(&down));
        let (top, bottom) = (light + faces_of(&up), echo + faces_of(&down));
        let absorbed = 2.0 * PI * stack.absorbed().dot(&(&top + &bottom));
        // As in AddingDoubling: a relative rounding for each doubling, and all along the way of conserved photons.
        let roundings = 0.5 * (stack.doublings() as f64 + 4.0) * (1.0 + direct.tau);
        let light = |value: f64| Light { value, magnitude: roundings * value };
        let fluxes = Fluxes {
            reflected: light(reflected),
            transmitted: light(transmitted),
            absorbed: light(absorbed),
        };
        Ok(Closed { stack, top, bottom, roundings, fluxes })
    }

    pub fn fluxes(&self) -> Fluxes {
        self.fluxes
    }

    /// Fluence of scattered light at depth t.
    pub fn fluence(&self, t: f64, direct: &Direct) -> Light {
        let nodes = &self.stack.nodes;
        let (down, up) = self.stack.field(t, self.top.clone(), self.bottom.clone());
        let light = down + up;
        let sum: f64 = (0..nodes.count).map(|i| sqrt(nodes.weight[i] / nodes.mu[i]) * light[i]).sum();
        let unscattered = match direct.incidence {
            Incidence::Beam { .. } => 0.0,
            Incidence::Diffuse => 2.0 * nodes.sum(|mu| direct.radiance(mu, t)),
        };
        Light { value: 2.0 * PI * sum - unscattered, magnitude: self.roundings * 2.0 * PI * sum }
    }
}

/// U and D by their sum and difference, for which light that no face lets out leaves a thin slab by scattering alone:
/// 1 - e r has no cancellation here.
fn halves(
    stack: &Stack,
    tau: f64,
    faces: &[(f64, f64)],
    light: &DVector<f64>,
    echo: &DVector<f64>,
) -> Option<(DVector<f64>, DVector<f64>)> {
    let n = faces.len();
    let solve = |sign: f64| {
        let scattering = stack.reflected() + stack.scattered() * sign;
        let source = &scattering * (light + echo * sign);
        let open = DMatrix::from_fn(n, n, |i, j| {
            let scattered = scattering[(i, j)] * faces[j].0;
            if i != j {
                return -scattered;
            }
            let passing = if sign > 0.0 {
                -expm1(-tau / stack.nodes.mu[i]) + stack.direct()[i] * faces[i].1
            } else {
                1.0 + stack.direct()[i] * faces[i].0
            };
            passing - scattered
        });
        open.lu().solve(&source)
    };
    let (sum, difference) = (solve(1.0)?, solve(-1.0)?);
    Some(((&sum + &difference) * 0.5, (sum - difference) * 0.5))
}

/// U and D by what returns from one face to itself, all of positive terms: D keeps its digits however little arrives.
fn passages(
    stack: &Stack,
    returning: &DVector<f64>,
    light: &DVector<f64>,
    echo: &DVector<f64>,
) -> Option<(DVector<f64>, DVector<f64>)> {
    let n = returning.len();
    let turned = |matrix: &DMatrix<f64>| {
        let mut matrix = matrix.clone();
        for (mut column, r) in matrix.column_iter_mut().zip(returning) {
            column *= *r;
        }
        matrix
    };
    let mut through = stack.scattered().clone();
    for (i, e) in stack.direct().iter().enumerate() {
        through[(i, i)] += e;
    }
    let near = (DMatrix::identity(n, n) - turned(stack.reflected())).lu();
    // M (T + e) r, where M sums what goes to and fro at one face.
    let across = near.solve(&turned(&through))?;
    let top = near.solve(&(stack.reflected() * light + stack.scattered() * echo))?;
    let bottom = near.solve(&(stack.scattered() * light + stack.reflected() * echo))?;
    let twice = (DMatrix::identity(n, n) - &across * &across).lu();
    let up = twice.solve(&(&top + &across * &bottom))?;
    let down = &bottom + &across * &up;
    Some((up, down))
}
