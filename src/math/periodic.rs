//! Places in a world that repeats along x and y.

use glam::{DVec2, DVec3};

/// The position modulo the cell's sides in x and y, in [0, side).
pub fn wrap(p: DVec3, side: DVec2) -> DVec3 {
    let wrapped = |x: f64, side: f64| {
        if (0.0..side).contains(&x) {
            return x;
        }
        let rest = x - side * (x / side).floor();
        // A tiny negative x rounds to the side itself.
        if rest < side { rest } else { 0.0 }
    };
    DVec3::new(wrapped(p.x, side.x), wrapped(p.y, side.y), p.z)
}
