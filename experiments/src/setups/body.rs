//! Bodies of medium whose places are told by their depth.

use glam::DVec3;
use std::f64::consts::PI;
use turbid::geometry::{Cuboid, Shape, Slab, Sphere};
use turbid_analytic::boundary as referee;

/// Side of the periodic cell that stands for a slab \[mfp\].
pub const CELL: f64 = 4.0;

/// A body of medium; places in it are given by their depth below the surface (in a slab below the face at depth 0, in a
/// cuboid below the middle of a face).
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Body {
    /// Between two faces, unbounded along them.
    Slab {
        /// Optical thickness.
        thickness: f64,
    },
    /// A ball.
    Sphere {
        /// Radius \[mfp\].
        radius: f64,
    },
    /// A cuboid.
    Cuboid {
        /// Edges along x, y and z \[mfp\].
        edges: [f64; 3],
    },
}

/// Directions spread evenly over the sphere (Swinbank and Purser 2006); the nearest two are 3.09/sqrt(n) apart.
pub fn spiral(n: usize) -> impl Iterator<Item = DVec3> {
    let golden = PI * (3.0 - 5.0_f64.sqrt());
    (0..n).map(move |i| {
        let z = 1.0 - (2.0 * i as f64 + 1.0) / n as f64;
        let (sin, cos) = turbid::math::sin_cos(golden * i as f64);
        let across = (1.0 - z * z).sqrt();
        DVec3::new(across * cos, across * sin, z)
    })
}

impl Body {
    /// The body as the referee knows it.
    pub fn referee(self) -> referee::Body {
        match self {
            Body::Slab { thickness } => referee::Body::Slab { thickness },
            Body::Sphere { radius } => referee::Body::Sphere { radius },
            Body::Cuboid { edges } => referee::Body::Cuboid { edges },
        }
    }

    /// The body as the simulator knows it: a slab from z = 0 on, a ball about the origin, a cuboid from the origin on.
    pub fn shape(self) -> turbid::Result<Shape> {
        Ok(match self {
            Body::Slab { thickness } => Shape::Slab(Slab::new(0.0, thickness)?),
            Body::Sphere { radius } => Shape::Sphere(Sphere::new(DVec3::ZERO, radius)?),
            Body::Cuboid { edges } => Shape::Cuboid(Cuboid::new(DVec3::ZERO, DVec3::from_array(edges))?),
        })
    }

    /// The deepest place.
    pub fn deepest(self) -> f64 {
        match self {
            Body::Slab { thickness } => thickness,
            Body::Sphere { radius } => radius,
            Body::Cuboid { edges: [.., c] } => c,
        }
    }

    /// The distance from a place to the nearest point of the surface.
    pub fn room(self, depth: f64) -> f64 {
        match self {
            Body::Slab { thickness } => depth.min(thickness - depth),
            Body::Sphere { .. } => depth,
            Body::Cuboid { edges: [a, b, c] } => depth.min(c - depth).min(0.5 * a).min(0.5 * b),
        }
    }

    /// One of the places at a depth, as the referee has it.
    pub fn place(self, depth: f64) -> [f64; 3] {
        match self {
            Body::Slab { .. } => [0.0, 0.0, depth],
            Body::Sphere { radius } => [0.0, 0.0, radius - depth],
            Body::Cuboid { edges: [a, b, _] } => [0.5 * a, 0.5 * b, depth],
        }
    }

    /// The same in the scene: in the middle of a slab's cell.
    pub fn middle(self, depth: f64) -> DVec3 {
        match self {
            Body::Slab { .. } => DVec3::new(0.5 * CELL, 0.5 * CELL, depth),
            Body::Sphere { .. } | Body::Cuboid { .. } => DVec3::from_array(self.place(depth)),
        }
    }

    /// The places of a square lattice of so many along each side of a slab's cell, or as many on a spiral about a sphere;
    /// in a cuboid one.
    pub fn places(self, side: usize, depth: f64) -> Vec<DVec3> {
        match self {
            Body::Slab { .. } => {
                let step = CELL / side as f64;
                let place = |i: usize| (i as f64 + 0.5) * step;
                (0..side * side).map(|i| DVec3::new(place(i % side), place(i / side), depth)).collect()
            }
            Body::Sphere { radius } => spiral(side * side).map(|dir| dir * (radius - depth)).collect(),
            Body::Cuboid { .. } => vec![self.middle(depth)],
        }
    }

    /// The area of the places at a depth, of a slab that of the cell \[mfp²\].
    pub fn area(self, depth: f64) -> f64 {
        match self {
            Body::Slab { .. } => CELL * CELL,
            Body::Sphere { radius } => 4.0 * PI * (radius - depth) * (radius - depth),
            Body::Cuboid { edges: [a, b, _] } => a * b,
        }
    }

    /// Volume, of a slab that of the cell \[mfp³\].
    pub fn volume(self) -> f64 {
        match self {
            Body::Slab { thickness } => CELL * CELL * thickness,
            Body::Sphere { radius } => 4.0 / 3.0 * PI * radius * radius * radius,
            Body::Cuboid { edges: [a, b, c] } => a * b * c,
        }
    }

    /// Surface, of a slab both faces of the cell \[mfp²\].
    pub fn surface(self) -> f64 {
        match self {
            Body::Slab { .. } => 2.0 * CELL * CELL,
            Body::Sphere { radius } => 4.0 * PI * radius * radius,
            Body::Cuboid { edges: [a, b, c] } => 2.0 * (a * b + b * c + c * a),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spirals_keep_their_distance() {
        for n in [10, 50, 500] {
            let places: Vec<DVec3> = spiral(n).collect();
            let least = (0..n)
                .flat_map(|i| (0..i).map(move |j| (i, j)))
                .map(|(i, j)| places[i].distance(places[j]))
                .fold(f64::INFINITY, f64::min);
            // Far from the poles it is 3.09; the two places at a pole are nearer.
            assert!(least * (n as f64).sqrt() > 2.0, "{n}: {}", least * (n as f64).sqrt());
        }
    }
}
