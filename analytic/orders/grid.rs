//! One grid of depths and directions, and the orders of scattering on it.

use super::directions::Directions;
use super::mesh::Mesh;
use super::rays::{Panels, Ray};
use super::scattering::{Field, Scattering, legendre, mean_phase};
use crate::incidence::Incidence;
use crate::slab_single::path;
use libm::exp;

/// Depths, directions, rays and the scattering between them.
pub(super) struct Grid {
    pub mesh: Mesh,
    directions: Directions,
    rays: Vec<Ray>,
    scattering: Scattering,
    albedo: f64,
    moments: Vec<f64>,
    incidence: Incidence,
}

/// What is known of one order.
pub(super) struct Order {
    /// Radiances 2 pi J, as long as the next order is not known.
    light: Option<Field>,
    /// At all depths.
    pub fluence: Vec<f64>,
    /// Power through the lit face and through the far face.
    pub reflected: f64,
    pub transmitted: f64,
    /// Integral of the fluence.
    pub collided: f64,
    /// Per panel: the largest relative difference from the other grid.
    pub defect: Vec<f64>,
}

impl Order {
    pub fn forget(&mut self) {
        self.light = None;
    }
}

impl Grid {
    pub fn new(tau: f64, albedo: f64, moments: &[f64], incidence: Incidence, cut: f64, nodes: usize) -> Self {
        // In the first panel t ln t is met to about 1e-3 of its length; a grazing beam needs panels below its depth.
        let first = match incidence {
            Incidence::Beam { mu0 } => (1e-5 * mu0 / (0.5 * tau).min(1.0)).clamp(1e-15, 1e-9),
            Incidence::Diffuse => 1e-9,
        };
        let mesh = Mesh::new(tau, first, nodes);
        let directions = Directions::new(moments.len(), tau.min(1.0), cut);
        let panels = Panels::new(&mesh);
        let rays = directions.mu.iter().map(|&mu| panels.ray(&mesh, mu)).collect();
        let scattering = Scattering::new(&directions, albedo, moments);
        Grid { mesh, directions, rays, scattering, albedo, moments: moments.to_vec(), incidence }
    }

    /// The order after `last`, or the first.
    pub fn next(&self, last: Option<&Order>) -> Order {
        match (last.and_then(|order| order.light.as_ref()), self.incidence) {
            (Some(light), _) => self.again(light.clone()),
            (None, Incidence::Beam { mu0 }) => self.once(mu0),
            (None, Incidence::Diffuse) => {
                // Radiance 1/pi on the face, times 2 pi.
                let mut light = Field::zero(self.directions.len(), self.mesh.depth.len());
                for (row, mu) in light.down.iter_mut().zip(&self.directions.mu) {
                    row.iter_mut().zip(&self.mesh.depth).for_each(|(j, t)| *j = 2.0 * exp(-t / mu));
                }
                self.again(light)
            }
        }
    }

    fn again(&self, mut light: Field) -> Order {
        self.scattering.scatter(&mut light);
        let (mut reflected, mut transmitted) = (0.0, 0.0);
        let mut source = vec![0.0; self.mesh.depth.len()];
        for (i, ray) in self.rays.iter().enumerate() {
            let projected = self.directions.weight[i] * self.directions.mu[i];
            source.copy_from_slice(&light.up[i]);
            reflected += projected * ray.trace(&self.mesh, true, &source, &mut light.up[i]);
            source.copy_from_slice(&light.down[i]);
            transmitted += projected * ray.trace(&self.mesh, false, &source, &mut light.down[i]);
        }
        self.order(light, reflected, transmitted)
    }

    /// Light that a beam has scattered once, closed in depth.
    fn once(&self, mu0: f64) -> Order {
        let mut light = Field::zero(self.directions.len(), self.mesh.depth.len());
        let table = legendre(self.moments.len(), mu0);
        let (mut reflected, mut transmitted) = (0.0, 0.0);
        let tau = self.mesh.tau;
        for (i, &mu) in self.directions.mu.iter().enumerate() {
            let projected = self.directions.weight[i] * mu;
            let [up, down] = [-mu, mu].map(|x| 0.5 * self.albedo * mean_phase(&self.moments, x, &table).0);
            for (q, (&t, &h)) in self.mesh.depth.iter().zip(&self.mesh.height).enumerate() {
                light.up[i][q] = up * path(t, h, mu0, mu);
                light.down[i][q] = down * path(t, h, mu0, -mu);
            }
            reflected += projected * up * path(0.0, tau, mu0, mu);
            transmitted += projected * down * path(tau, 0.0, mu0, -mu);
        }
        self.order(light, reflected, transmitted)
    }

    fn order(&self, light: Field, reflected: f64, transmitted: f64) -> Order {
        let mut fluence = vec![0.0; self.mesh.depth.len()];
        for (i, w) in self.directions.weight.iter().enumerate() {
            for (q, phi) in fluence.iter_mut().enumerate() {
                *phi += w * (light.up[i][q] + light.down[i][q]);
            }
        }
        let collided = fluence.iter().zip(&self.mesh.weight).map(|(phi, w)| phi * w).sum();
        Order { light: Some(light), fluence, reflected, transmitted, collided, defect: Vec::new() }
    }

    /// Per panel, the largest relative difference of a fluence at its nodes from the one of another grid.
    pub fn defects(&self, mine: &Order, other: &Grid, theirs: &Order) -> Vec<f64> {
        let n = self.mesh.nodes();
        let mut defects = vec![0.0_f64; self.mesh.panels()];
        for (i, (t, phi)) in self.mesh.depth.iter().zip(&mine.fluence).enumerate() {
            let off = (phi - other.mesh.interpolate(&theirs.fluence, *t)).abs();
            if *phi != 0.0 {
                defects[i / n] = defects[i / n].max(off / phi.abs());
            }
        }
        defects
    }
}
