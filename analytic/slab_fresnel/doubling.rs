//! Kernels of adding and doubling, closed by the two faces.

use super::direct::Direct;
use super::{Face, Fluxes};
use crate::adding_doubling::Stack;
use crate::error::{Error, Result};
use crate::incidence::Incidence;
use libm::{exp, expm1, sqrt};
use nalgebra::{DMatrix, DVector};
use std::f64::consts::PI;

/// Light between the faces on one set of nodes.
pub(super) struct Closed {
    stack: Stack,
    /// Light that enters the medium through the lit face and through the far one: what was not scattered yet and
    /// what the faces return of the rest.
    top: DVector<f64>,
    bottom: DVector<f64>,
    fluxes: Fluxes,
}

impl Closed {
    /// With s and d the sum and difference of scattered light that goes up at the lit face (U) and down at the far
    /// one (D), and b light on its way that never scattered, entering through the lit face,
    ///
    /// s = (R + T + e) r s + (R + T) b (1 + r e),  d = (R - T - e) r d + (R - T) b (1 - r e)
    pub fn new(direct: &Direct, albedo: f64, moments: &[f64], orders: (usize, usize)) -> Result<Self> {
        let face = direct.face;
        let beam: Vec<f64> = direct.beam().into_iter().collect();
        let nodes = face.nodes(orders.0, orders.1, 5).with(&beam);
        let stack = Stack::new(direct.tau, albedo, moments, 0, nodes)?;
        let nodes = &stack.nodes;
        let n = nodes.len();
        let root = DVector::from_fn(n, |i, _| sqrt(nodes.mu[i] * nodes.weight[i]));
        let faces: Vec<(f64, f64)> = nodes.mu.iter().map(|&mu| face.from_inside(mu)).collect();
        let light = DVector::from_fn(n, |i, _| match direct.incidence {
            Incidence::Beam { .. } if i == nodes.count => direct.entering() / (2.0 * PI * root[i]),
            Incidence::Diffuse if i < nodes.count => {
                let echo = faces[i].0 * stack.direct()[i];
                root[i] / PI * face.spread() * faces[i].1 / (1.0 - echo * echo)
            }
            _ => 0.0,
        });
        let returned = |u: DVector<f64>| DVector::from_fn(n, |i, _| faces[i].0 * u[i]);
        let echo = returned(light.component_mul(stack.direct()));
        let solve = |sign: f64| {
            let scattering = stack.reflected() + stack.scattered() * sign;
            let source = &scattering * (&light + &echo * sign);
            // 1 - e r without cancellation: light that no face lets out leaves a thin slab by scattering alone.
            let open = DMatrix::from_fn(n, n, |i, j| {
                let scattered = scattering[(i, j)] * faces[j].0;
                if i != j {
                    return -scattered;
                }
                let passing = if sign > 0.0 {
                    -expm1(-direct.tau / nodes.mu[i]) + stack.direct()[i] * faces[i].1
                } else {
                    1.0 + stack.direct()[i] * faces[i].0
                };
                passing - scattered
            });
            open.lu().solve(&source)
        };
        let singular = Error::Infinite("light between the faces does not die away in f64");
        let (sum, difference) = (solve(1.0).ok_or(singular.clone())?, solve(-1.0).ok_or(singular)?);
        let (up, down) = ((&sum + &difference) * 0.5, (sum - difference) * 0.5);
        let leaving =
            |u: &DVector<f64>| 2.0 * PI * (0..nodes.count).map(|i| root[i] * faces[i].1 * u[i]).sum::<f64>();
        let (reflected, transmitted) = (leaving(&up), leaving(&down));
        let (top, bottom) = (light + returned(up), echo + returned(down));
        let absorbed = 2.0 * PI * stack.absorbed().dot(&(&top + &bottom));
        let fluxes = Fluxes { reflected, transmitted, absorbed };
        Ok(Closed { stack, top, bottom, fluxes })
    }

    pub fn fluxes(&self) -> Fluxes {
        self.fluxes
    }

    pub fn doublings(&self) -> usize {
        self.stack.doublings()
    }

    /// Fluence of scattered light at depth t.
    pub fn fluence(&self, t: f64, direct: &Direct) -> f64 {
        let nodes = &self.stack.nodes;
        let (down, up) = self.stack.field(t, self.top.clone(), self.bottom.clone());
        let light = down + up;
        let sum: f64 = (0..nodes.count).map(|i| sqrt(nodes.weight[i] / nodes.mu[i]) * light[i]).sum();
        let unscattered = match direct.incidence {
            Incidence::Beam { .. } => 0.0,
            Incidence::Diffuse => 2.0 * nodes.sum(|mu| direct.radiance(mu, t)),
        };
        2.0 * PI * sum - unscattered
    }
}

/// e^(-x/mu) and its like where x/mu overflows are 0.
pub(super) fn faded(x: f64, mu: f64) -> f64 {
    exp(-x / mu)
}
