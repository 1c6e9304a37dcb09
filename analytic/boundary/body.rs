//! The bodies that a medium may fill, and how a ball about a probe stands in them.

use super::shell::{Ends, Region, Shells};
use crate::error::{Error, Result, within};

/// A medium with a face, in any unit of length.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Body {
    /// z >= 0.
    HalfSpace,
    /// 0 <= z <= thickness.
    Slab {
        /// \[length\], 1e-12 to 1e12
        thickness: f64,
    },
    /// The ball about the origin.
    Sphere {
        /// \[length\], 1e-12 to 1e12
        radius: f64,
    },
    /// 0 <= x <= edge along each axis.
    Cuboid {
        /// \[length\], 1e-12 to 1e12 each
        edges: [f64; 3],
    },
}

/// Bodies with flat faces along the axes, and the sphere.
pub(super) enum Shape {
    Flat(Ends),
    Round(f64),
}

const RANGE: &str = "1e-12 to 1e12";

/// A length in range.
pub(super) fn length(name: &'static str, value: f64) -> Result<f64> {
    within(name, value, 1e-12, 1e12, RANGE)
}

/// A probe in a body: its depth, and the shells about it and about its mirror images.
pub(super) struct Place {
    /// Distance to the nearest boundary point.
    pub(super) depth: f64,
    pub(super) own: Shells,
    pub(super) images: Vec<Shells>,
}

impl Body {
    pub(super) fn shape(self) -> Shape {
        let all = (f64::NEG_INFINITY, f64::INFINITY);
        match self {
            Body::HalfSpace => Shape::Flat([all, all, (0.0, f64::INFINITY)]),
            Body::Slab { thickness } => Shape::Flat([all, all, (0.0, thickness)]),
            Body::Cuboid { edges } => Shape::Flat(edges.map(|edge| (0.0, edge))),
            Body::Sphere { radius } => Shape::Round(radius),
        }
    }

    /// The largest radius up to which mirror images complete every ball, so that reflection is exact in a uniform
    /// field: the shortest edge; 0 behind a curved face.
    pub(super) fn completed_up_to(self) -> f64 {
        match self.shape() {
            Shape::Flat(ends) => ends.iter().fold(f64::INFINITY, |least, (low, high)| least.min(high - low)),
            Shape::Round(_) => 0.0,
        }
    }

    pub(super) fn check(self) -> Result<()> {
        match self {
            Body::HalfSpace => {}
            Body::Slab { thickness } => {
                length("thickness", thickness)?;
            }
            Body::Sphere { radius } => {
                length("the body's radius", radius)?;
            }
            Body::Cuboid { edges } => {
                for edge in edges {
                    length("edges", edge)?;
                }
            }
        }
        Ok(())
    }

    /// The probe at `at`, with those images that lie within `reach` of the body.
    pub(super) fn place(self, at: [f64; 3], reach: f64) -> Result<Place> {
        self.check()?;
        for x in at {
            within("at", x, -1e12, 1e12, "-1e12 to 1e12")?;
        }
        match self.shape() {
            Shape::Flat(ends) => flat_place(ends, at, reach),
            Shape::Round(radius) => sphere_place(radius, at, reach),
        }
    }
}

fn outside(value: f64) -> Error {
    Error::OutOfRange { name: "at", value, allowed: "places inside the body" }
}

fn flat_place(ends: Ends, mut at: [f64; 3], reach: f64) -> Result<Place> {
    // Of faces at equal distances the first counts: low before high, x before y before z.
    let (mut depth, mut axis, mut sign) = (f64::INFINITY, 2, 1.0);
    for i in 0..3 {
        let (low, high) = ends[i];
        // A place on a face may differ by roundings.
        let slack = 1e-12 * if high.is_finite() { high } else { 1.0 };
        if at[i] < low - slack || at[i] > high + slack {
            return Err(outside(at[i]));
        }
        at[i] = at[i].clamp(low, high);
        for (distance, inward) in [(at[i] - low, 1.0), (high - at[i], -1.0)] {
            if distance < depth {
                (depth, axis, sign) = (distance, i, inward);
            }
        }
    }
    let shells = |centre: [f64; 3]| Shells::in_box(centre, axis, sign, ends);
    let mut images = Vec::new();
    for code in 1..27 {
        let mut centre = at;
        let mut exists = true;
        let mut distance = 0.0;
        for (i, power) in [1, 3, 9].into_iter().enumerate() {
            let (low, high) = ends[i];
            let mirror = match (code / power) % 3 {
                0 => continue,
                1 => low,
                _ => high,
            };
            exists &= mirror.is_finite();
            distance += (mirror - at[i]) * (mirror - at[i]);
            centre[i] = 2.0 * mirror - at[i];
        }
        if exists && distance < reach * reach {
            images.push(shells(centre));
        }
    }
    Ok(Place { depth, own: shells(at), images })
}

fn sphere_place(radius: f64, at: [f64; 3], reach: f64) -> Result<Place> {
    let distance = at.iter().fold(0.0, |length, x| libm::hypot(length, *x));
    if distance > radius * (1.0 + 1e-12) {
        return Err(outside(distance));
    }
    let outward = if distance > 0.0 { at.map(|x| x / distance) } else { [0.0, 0.0, 1.0] };
    let distance = distance.min(radius);
    let shells = |distance: f64| Shells::new(outward, -1.0, Region::Ball { radius, distance });
    let depth = radius - distance;
    // The photon's image in the tangent plane at the nearest boundary point: the probe's own image sees the photon.
    let images = if depth < reach { vec![shells(radius + depth)] } else { Vec::new() };
    Ok(Place { depth, own: shells(distance), images })
}
