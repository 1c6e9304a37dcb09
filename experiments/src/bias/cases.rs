//! The cases: at which depth, with which gather and kernel, each map is asked.

use super::fields::Field;
use crate::harness::Parameters;
use crate::setups::{Body, CELL, Size, spiral};
use glam::DVec3;
use turbid::estimators::{Estimator, Gather, Kernel};

/// One question to a map.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Case {
    /// The field.
    pub field: &'static Field,
    /// Photons emitted into the map.
    pub photons: u64,
    /// Depth of the probes [mfp].
    pub depth: f64,
    /// Gather size.
    pub size: Size,
    /// Whether all k nearest photons are summed, the k-th too: wrong on purpose.
    pub is_biased: bool,
    /// Kernel.
    pub kernel: Kernel,
}

/// Radii of fixed gathers [mfp].
const RADII: [f64; 4] = [0.1, 0.2, 0.4, 0.8];
/// Sizes of nearest gathers.
const NEIGHBORS: [usize; 5] = [4, 10, 50, 100, 500];
/// Sizes at which the biased rule is shown.
const BIASED: [usize; 2] = [10, 50];
/// Where all kernels are compared: one radius, one k.
const KERNELS_AT: (f64, usize) = (0.8, 100);
/// Most probes along one side of the lattice.
const MAX_SIDE: usize = 24;
/// Fewest photons that the widest nearest gather may leave in a map: below, the ball is no longer local.
const MIN_SHARE: u64 = 40;

impl Case {
    /// Everything that maps of one field and size are asked.
    pub fn all(field: &'static Field, photons: u64) -> Vec<Case> {
        let mut cases = Vec::new();
        let is_local = |k: usize| k as u64 * MIN_SHARE <= photons;
        for &depth in field.depths {
            let mut add =
                |size, kernel| cases.push(Case { field, photons, depth, size, is_biased: false, kernel });
            for kernel in Kernel::ALL {
                let is_first = kernel == Kernel::Uniform;
                for radius in RADII {
                    if is_first || radius == KERNELS_AT.0 {
                        add(Size::Radius(radius), kernel);
                    }
                }
                for k in NEIGHBORS {
                    if is_local(k) && (is_first || k == KERNELS_AT.1) {
                        add(Size::Nearest(k), kernel);
                    }
                }
            }
            for k in BIASED.into_iter().filter(|&k| is_local(k)) {
                let (size, kernel) = (Size::Nearest(k), Kernel::Uniform);
                cases.push(Case { field, photons, depth, size, is_biased: true, kernel });
            }
        }
        cases
    }

    /// The group of cells that answer it.
    pub fn group(field: &Field, photons: u64) -> String {
        format!("{}-n{photons}", field.name)
    }

    /// What it asks, as columns of the results.
    pub fn parameters(&self) -> Parameters {
        Parameters {
            field: Some(self.field.name),
            photons: Some(self.photons),
            depth: Some(self.depth),
            kernel: Some(self.kernel),
            ..self.size.parameters()
        }
    }

    /// The name in tables.
    pub fn name(&self) -> String {
        format!(
            "{} n={} t={} {} {}",
            self.field.name,
            self.photons,
            self.depth,
            self.gather_name(),
            self.kernel.name()
        )
    }

    /// The gather in words.
    pub fn gather_name(&self) -> String {
        format!("{}{}", self.size.name(), if self.is_biased { "(biased)" } else { "" })
    }

    /// The radius that the gather is given room for: a nearest one has it for four times the photons that a rough guess
    /// of the fluence lets one expect.
    fn reach(&self) -> f64 {
        match self.size {
            Size::Radius(r) => r,
            Size::Nearest(k) => {
                let guess = if self.field.has_clusters() { 0.5 } else { libm::exp(-self.depth) };
                let density = guess * self.field.setup.density(self.photons);
                libm::cbrt(4.0 * 3.0 * k as f64 / (4.0 * std::f64::consts::PI * density))
            }
        }
    }

    /// Probes along one side of a slab's lattice. Their balls neither overlap nor leave the cell.
    fn side(&self) -> usize {
        ((CELL / (2.0 * self.reach())) as usize).clamp(1, MAX_SIDE)
    }

    /// The cap of nearest gathers [mfp]: in a slab half the distance between probes.
    pub fn cap(&self) -> f64 {
        match self.field.setup.body {
            Body::Slab { .. } => 0.5 * CELL / self.side() as f64,
            Body::Sphere { .. } | Body::Cuboid { .. } => self.reach(),
        }
    }

    /// What is asked.
    pub fn estimator(&self) -> turbid::Result<Estimator> {
        let gather = match self.size {
            Size::Nearest(k) if self.is_biased => Gather::nearest_biased(k, self.cap()),
            size => size.gather(self.cap()),
        };
        Ok(Estimator::new(self.kernel, gather?))
    }

    /// The probes: on a lattice in a slab, on a spiral in a sphere. Their balls do not overlap, save a few at a
    /// spiral's ends.
    pub fn probes(&self) -> Vec<DVec3> {
        let body = self.field.setup.body;
        match body {
            Body::Slab { .. } | Body::Cuboid { .. } => body.places(self.side(), self.depth),
            Body::Sphere { radius } => {
                let from_centre = radius - self.depth;
                let along = 1.545 * from_centre / self.reach();
                let number = ((along * along) as usize).clamp(1, MAX_SIDE * MAX_SIDE);
                spiral(number).map(|dir| dir * from_centre).collect()
            }
        }
    }
}
