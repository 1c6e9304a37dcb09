//! What is measured: one number (a channel) each.

use crate::geometry::{Face, Shape};
use crate::math::Ray;
use glam::DVec3;

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
    /// Unit of the quantity, in watts, scene lengths (L) and steradians.
    pub fn unit(&self) -> &'static str {
        match self.quantity {
            Quantity::Fluence(_) => "W/L^2",
            Quantity::Radiance(_) => "W/(L^2 sr)",
            Quantity::Outflow { .. } | Quantity::Absorbed(_) => "1",
        }
    }
}
