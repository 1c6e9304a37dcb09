//! The cases asked of transported maps: where, with which gather, kernel and treatment.

use super::fields::{CaseSet, Field};
use crate::harness::{Parameters, Settings};
use crate::setups::{Body, CELL, FURNACE, Size, spiral};
use glam::DVec3;
use std::f64::consts::PI;
use turbid::estimators::boundary::Treatment;
use turbid::estimators::{Estimator, Kernel};

/// Where probes stand.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Place {
    /// At this depth, far from edges and corners [mfp].
    Face(f64),
    /// At this depth below both faces of an edge [mfp].
    Edge(f64),
    /// At this depth below the three faces of a corner [mfp].
    Corner(f64),
}

/// One question to a map.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Case {
    /// The field.
    pub field: &'static Field,
    /// Photons emitted into the map.
    pub photons: u64,
    /// Where.
    pub place: Place,
    /// Gather size.
    pub size: Size,
    /// Kernel.
    pub kernel: Kernel,
    /// What is done about the edge.
    pub treatment: Treatment,
}

/// The radius and the number of neighbours that every field and kernel is asked.
pub const MAIN: (f64, usize) = (0.4, 50);
/// Largest radius of nearest gathers [mfp].
pub const CAP: f64 = 0.9;
/// Depths at fixed radius, over the radius; beyond 1 the ball is whole.
const DEPTHS: [f64; 10] = [0.0, 0.125, 0.25, 0.375, 0.5, 0.625, 0.75, 0.875, 1.0, 1.25];
/// Depths of nearest gathers, over the radius of k photons far from any face.
const NEAREST_DEPTHS: [f64; 7] = [0.0, 0.25, 0.5, 0.75, 1.0, 1.25, 1.75];
/// Depths below edges and corners, and of the other kernels [mfp].
const FEW: [f64; 3] = [0.0, 0.1, 0.25];
/// Numbers of neighbours.
const NEIGHBORS: [usize; 3] = [20, 50, 200];
/// Probes along a side of a slab's lattice; they keep [`CAP`] and more from the cell's edges.
const SIDE: usize = 6;
/// Probes on a sphere.
const ON_SPHERE: usize = 32;

impl Place {
    /// Depth below the nearest face [mfp].
    pub fn depth(self) -> f64 {
        match self {
            Place::Face(h) | Place::Edge(h) | Place::Corner(h) => h,
        }
    }

    fn name(self) -> String {
        match self {
            Place::Face(h) => format!("h={h}"),
            Place::Edge(h) => format!("edge h={h}"),
            Place::Corner(h) => format!("corner h={h}"),
        }
    }
}

impl Case {
    /// Everything that maps of one field and number of photons are asked.
    pub fn all(settings: &Settings, field: &'static Field, photons: u64) -> Vec<Case> {
        let mut cases = Vec::new();
        let sizes = field.sizes(settings);
        let is_main = photons == field.main_size(settings);
        let mut add = |place, size, kernel, treatment| {
            // In whole balls all treatments are one.
            let is_whole = matches!(size, Size::Radius(r) if Place::depth(place) >= r);
            if !is_whole || treatment == Treatment::None {
                cases.push(Case { field, photons, place, size, kernel, treatment });
            }
        };
        let mut radii = vec![MAIN.0];
        let mut neighbors = vec![MAIN.1];
        if field.cases == CaseSet::All {
            // Wide balls for few photons, narrow ones for many.
            radii = if sizes.first().is_some_and(|s| s.0 == photons) {
                vec![0.2, 0.4, 0.8]
            } else {
                vec![0.1, 0.2, 0.4]
            };
            neighbors = NEIGHBORS.to_vec();
        } else if !field.setup.is_furnace() {
            radii = vec![0.1, 0.2, 0.4];
        }
        for treatment in Treatment::ALL {
            for &r in &radii {
                for x in DEPTHS {
                    add(Place::Face(rounded(x * r)), Size::Radius(r), Kernel::Uniform, treatment);
                }
            }
            for &k in &neighbors {
                let scale = whole_radius(field, photons, k);
                for x in NEAREST_DEPTHS {
                    add(Place::Face(rounded(x * scale)), Size::Nearest(k), Kernel::Uniform, treatment);
                }
            }
            for kernel in Kernel::ALL.into_iter().filter(|&k| is_main && k != Kernel::Uniform) {
                for h in FEW {
                    add(Place::Face(h), Size::Radius(MAIN.0), kernel, treatment);
                    add(Place::Face(h), Size::Nearest(MAIN.1), kernel, treatment);
                }
            }
            if let Body::Cuboid { .. } = field.setup.body {
                for kernel in Kernel::ALL {
                    for h in FEW {
                        for place in [Place::Edge(h), Place::Corner(h)] {
                            add(place, Size::Radius(MAIN.0), kernel, treatment);
                            if kernel == Kernel::Uniform {
                                add(place, Size::Nearest(MAIN.1), kernel, treatment);
                            }
                        }
                    }
                }
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
            depth: Some(self.place.depth()),
            kernel: Some(self.kernel),
            ..self.size.parameters()
        }
    }

    /// The name in tables.
    pub fn name(&self) -> String {
        format!(
            "{} n={} {} {} {} {}",
            self.field.name,
            self.photons,
            self.place.name(),
            self.size.name(),
            self.kernel.name(),
            self.treatment.name()
        )
    }

    /// What is asked.
    pub fn estimator(&self) -> turbid::Result<Estimator> {
        Ok(Estimator::new(self.kernel, self.size.gather(CAP)?).treated(self.treatment))
    }

    /// One place that stands for all probes.
    pub fn point(&self) -> [f64; 3] {
        match (self.field.setup.body, self.place) {
            (Body::Sphere { radius }, place) => [0.0, 0.0, radius - place.depth()],
            (Body::Cuboid { edges: [a, b, _] }, Place::Face(h)) => [0.5 * a, 0.5 * b, h],
            (Body::Cuboid { edges: [_, b, _] }, Place::Edge(h)) => [h, 0.5 * b, h],
            (Body::Cuboid { .. }, Place::Corner(h)) => [h, h, h],
            (Body::Slab { .. }, place) => [0.0, 0.0, place.depth()],
        }
    }

    /// The probes: alike by symmetry; a slab that is lit through one face has them there alone.
    pub fn probes(&self) -> Vec<DVec3> {
        let h = self.place.depth();
        match self.field.setup.body {
            Body::Sphere { radius } => spiral(ON_SPHERE).map(|dir| dir * (radius - h)).collect(),
            Body::Cuboid { edges } => in_cuboid(DVec3::from_array(edges), self.place),
            Body::Slab { thickness } => {
                let both = self.field.is_lit_alike();
                let step = (CELL - 2.0) / (SIDE - 1) as f64;
                let at = |i: usize| 1.0 + step * i as f64;
                let from_face = |i: usize| if both && i % 2 == 1 { thickness - h } else { h };
                (0..SIDE * SIDE)
                    .map(|i| DVec3::new(at(i % SIDE), at(i / SIDE), from_face(i + i / SIDE)))
                    .collect()
            }
        }
    }
}

/// A length in steps that names can show [mfp].
fn rounded(length: f64) -> f64 {
    (1e4 * length).round() / 1e4
}

/// The radius in which k photons are expected far from any face, where the fluence is that of the furnace [mfp]; at most
/// what keeps the deepest probe in the upper half of the bodies.
pub fn whole_radius(field: &Field, photons: u64, k: usize) -> f64 {
    let density = FURNACE * field.setup.density(photons);
    libm::cbrt(3.0 * k as f64 / (4.0 * PI * density)).min(0.5)
}

/// Places at a depth under the faces, edges or corners: of each face and edge at the middle.
fn in_cuboid(edges: DVec3, place: Place) -> Vec<DVec3> {
    let h = place.depth();
    let mut found = Vec::new();
    // Each coordinate is low, in the middle or high.
    for index in 0..27 {
        let digits = [index % 3, index / 3 % 3, index / 9];
        let faces = digits.iter().filter(|&&d| d != 1).count();
        let wanted = match place {
            Place::Face(_) => 1,
            Place::Edge(_) => 2,
            Place::Corner(_) => 3,
        };
        if faces == wanted {
            let place = |i: usize| [h, 0.5 * edges[i], edges[i] - h][digits[i]];
            found.push(DVec3::new(place(0), place(1), place(2)));
        }
    }
    found
}
