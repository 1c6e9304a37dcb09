//! What is measured: one number (a channel) each, or one a bin.

use crate::geometry::{Face, FaceBins, Shape, Voxels};
use crate::light::PeriodicCell;
use crate::math::Ray;
use glam::{DVec2, DVec3};

/// A range of orders of scattering, both ends included; without upper end where `max` is none.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Orders {
    /// Smallest order that counts.
    pub min: u32,
    /// Largest order that counts.
    pub max: Option<u32>,
}

impl Orders {
    /// Every order.
    pub const ALL: Orders = Orders { min: 0, max: None };
    /// Everything but uncollided light.
    pub const SCATTERED: Orders = Orders { min: 1, max: None };

    /// Light scattered exactly `order` times.
    pub fn only(order: u32) -> Self {
        Orders { min: order, max: Some(order) }
    }

    /// Whether an order is in the range.
    pub fn contains(&self, order: u32) -> bool {
        self.min <= order && self.max.is_none_or(|max| order <= max)
    }

    /// The orders in both ranges; empty ranges contain nothing.
    pub fn and(&self, other: &Orders) -> Orders {
        let max = match (self.max, other.max) {
            (Some(a), Some(b)) => Some(a.min(b)),
            (a, b) => a.or(b),
        };
        Orders { min: self.min.max(other.min), max }
    }
}

/// What a sensor measures.
#[derive(Debug, Clone, PartialEq)]
pub enum Quantity {
    /// Radiance integrated over all directions at a point [W/L^2].
    Fluence(DVec3),
    /// Radiance that arrives at the origin of the ray from ahead of it [W/(L^2 sr)].
    Radiance(Ray),
    /// Power that leaves through a shape's boundary (through `face` of a slab), per unit of emitted power \[1\].
    Outflow {
        /// The shape.
        shape: Shape,
        /// The face of a slab; other shapes are taken whole.
        face: Face,
    },
    /// Power absorbed in a region of this index, per unit of emitted power \[1\].
    Absorbed(usize),
    /// The mean of a field over each of many bins.
    Binned(Binned),
}

/// A field whose mean over each bin is measured.
#[derive(Debug, Clone, PartialEq)]
pub enum Binned {
    /// Power that crosses the bins of a rectangle, by area [W/L^2].
    Flux {
        /// Where.
        bins: FaceBins,
        /// Which way.
        crossing: Crossing,
    },
    /// Radiance that arrives at the points of the bins of a rectangle from ahead [W/(L^2 sr)].
    Radiance {
        /// Where.
        bins: FaceBins,
        /// Unit direction that the rays look in; light comes against it.
        dir: DVec3,
    },
    /// Radiance integrated over all directions [W/L^2].
    Fluence {
        /// Where.
        space: Space,
        /// How photons estimate it.
        scoring: Scoring,
    },
    /// Power that media absorb, by volume [W/L^3].
    Absorption {
        /// Where.
        space: Space,
        /// How photons estimate it.
        scoring: Scoring,
    },
}

/// Which way light crosses a rectangle.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Crossing {
    /// Along the normal u x v.
    #[default]
    Along,
    /// Against it.
    Against,
    /// Along minus against.
    Net,
}

/// What of a photon's way is scored in a volume.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Scoring {
    /// Power times the length of each flight: in a void too.
    TrackLength,
    /// Each collision, with what it expects.
    Collision,
    /// Power where a photon ends.
    Analog,
}

/// Where a field is averaged.
#[derive(Debug, Clone, PartialEq)]
pub enum Space {
    /// Over each of many equal boxes.
    Voxels(Voxels),
    /// Over one solid shape, whatever is in it; of a slab, over the part in the cell.
    Shape(Shape),
}

impl Space {
    /// Volume of a bin \[L^3\], in a scene whose cell has these sides.
    pub fn volume(&self, side: DVec2) -> f64 {
        match self {
            Space::Voxels(voxels) => voxels.volume(),
            Space::Shape(shape) => shape.sample_inside(side, [0.5; 3]).1,
        }
    }
}

impl Binned {
    /// Bins along each axis; where there are fewer axes, 1.
    pub fn count(&self) -> [usize; 3] {
        match self {
            Binned::Flux { bins, .. } | Binned::Radiance { bins, .. } => {
                let [nu, nv] = bins.count();
                [nu, nv, 1]
            }
            Binned::Fluence { space, .. } | Binned::Absorption { space, .. } => match space {
                Space::Voxels(voxels) => voxels.count(),
                Space::Shape(_) => [1; 3],
            },
        }
    }

    /// All bins.
    pub fn bins(&self) -> usize {
        self.count().iter().product()
    }

    /// A uniform point of a bin from three numbers in [0, 1) \[L\], in a scene with this cell.
    pub fn point(&self, bin: usize, periodic_cell: Option<&PeriodicCell>, u: [f64; 3]) -> DVec3 {
        match self {
            Binned::Flux { bins, .. } | Binned::Radiance { bins, .. } => bins.point(bin, [u[0], u[1]]),
            Binned::Fluence { space, .. } | Binned::Absorption { space, .. } => match space {
                Space::Voxels(voxels) => voxels.point(bin, u),
                Space::Shape(shape) => shape.sample_inside(PeriodicCell::side(periodic_cell), u).0,
            },
        }
    }

    /// What photons' scores are divided by: area or volume of a bin, in a scene with this cell.
    pub fn size(&self, periodic_cell: Option<&PeriodicCell>) -> f64 {
        match self {
            Binned::Flux { bins, .. } | Binned::Radiance { bins, .. } => bins.area(),
            Binned::Fluence { space, .. } | Binned::Absorption { space, .. } => {
                space.volume(PeriodicCell::side(periodic_cell))
            }
        }
    }
}

/// A named quantity.
#[derive(Debug, Clone, PartialEq)]
pub struct Sensor {
    /// Where or of what, as the user calls it.
    pub name: String,
    /// The quantity's name in tables: fluence, radiance, reflectance, ...
    pub label: String,
    /// What is measured.
    pub quantity: Quantity,
    /// Which orders count.
    pub orders: Orders,
}

impl Sensor {
    /// What is measured in bins, if it is.
    pub fn binned(&self) -> Option<&Binned> {
        if let Quantity::Binned(binned) = &self.quantity { Some(binned) } else { None }
    }

    /// Unit of the quantity, in watts, scene lengths (L) and steradians.
    pub fn unit(&self) -> &'static str {
        match self.quantity {
            Quantity::Fluence(_) | Quantity::Binned(Binned::Flux { .. } | Binned::Fluence { .. }) => "W/L^2",
            Quantity::Radiance(_) | Quantity::Binned(Binned::Radiance { .. }) => "W/(L^2 sr)",
            Quantity::Binned(Binned::Absorption { .. }) => "W/L^3",
            Quantity::Outflow { .. } | Quantity::Absorbed(_) => "1",
        }
    }
}
