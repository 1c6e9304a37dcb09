//! A window for the sun: only light that passes it exists.

use super::EmissionCell;
use crate::error::{Error, Result};
use crate::geometry::{Rectangle, Sphere};
use crate::math::{Ray, warp};
use glam::DVec3;

/// A rectangle through whose front the light of a distant disc comes; where it goes elsewhere there is none.
///
/// It is a rule about the lines of rays, before anything bends or blocks them, and no body: it may lie in a pane of glass,
/// and what stands before it casts shadows. The disc with axis a and angular radius alpha sends through a rectangle of
/// area A and normal n the power irradiance x A (a . n), as long as the whole disc is in front: the vector irradiance of
/// a disc lies along its axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Portal {
    rectangle: Rectangle,
    /// Unit vector in the plane towards which the axis leans, and the one across it.
    lean: DVec3,
    across: DVec3,
    /// Sine and cosine of the angle between axis and normal.
    sin_tilt: f64,
    cos_tilt: f64,
}

impl Portal {
    /// A portal of the disc about a unit `axis` (the direction of travel), with the sine of its angular radius.
    pub(super) fn new(rectangle: Rectangle, axis: DVec3, sin_radius: f64) -> Result<Self> {
        let normal = rectangle.normal();
        let cos_tilt = axis.dot(normal);
        // Beyond the rounding of the normal, a cross product of two rounded edges.
        if cos_tilt <= sin_radius + 1e-12 {
            return Err(Error::Scene(format!(
                "portal: the sun's light leaves through the front, u x v, from all of its disc; here it goes {:.4} degrees \
                 from u x v, allowed: below {:.4}",
                libm::acos(cos_tilt.clamp(-1.0, 1.0)).to_degrees(),
                libm::acos(sin_radius).to_degrees(),
            )));
        }
        let leaning = axis - normal * cos_tilt;
        let lean = leaning.try_normalize().unwrap_or_else(|| normal.any_orthonormal_vector());
        Ok(Portal { rectangle, lean, across: normal.cross(lean), sin_tilt: leaning.length(), cos_tilt })
    }

    /// Its area, seen along the axis [L^2].
    pub(super) fn projected_area(&self) -> f64 {
        self.rectangle.area() * self.cos_tilt
    }

    /// Whether the line of a ray passes.
    pub(super) fn passes(&self, line: &Ray) -> bool {
        let normal = self.rectangle.normal();
        let t = -self.rectangle.height(line.origin) / line.dir.dot(normal);
        self.rectangle.covers(line.at(t))
    }

    /// A uniform point \[L\].
    pub(super) fn point(&self, u: [f64; 2]) -> DVec3 {
        self.rectangle.sample(u)
    }

    /// A direction of the cone (sine and cosine of its half-angle), in proportion to the cosine with the normal, which is
    /// what crosses a part of the portal.
    ///
    /// Such directions lie uniformly on the plane that they are projected on along the normal, and the cone's edge, a
    /// circle, is projected on an ellipse.
    pub(super) fn direction(&self, u: [f64; 2], (sin_radius, cos_radius): (f64, f64)) -> DVec3 {
        let p = warp::square_to_disc(u) * sin_radius;
        let (x, y) = (cos_radius * self.sin_tilt + p.x * self.cos_tilt, p.y);
        let up = (1.0 - x * x - y * y).max(0.0).sqrt();
        (self.lean * x + self.across * y + self.rectangle.normal() * up).normalize()
    }

    /// How far before the portal every line is outside a ball, by its radius at least \[L\].
    pub(super) fn run_up(&self, ball: Sphere) -> f64 {
        let middle = self.point([0.5; 2]);
        middle.distance(ball.center()) + 0.5 * self.rectangle.diagonal() + 2.0 * ball.radius()
    }

    /// The middle of the points of a cell and how far they are from it \[L\].
    pub(super) fn patch(&self, cell: &EmissionCell) -> (DVec3, f64) {
        let [a, b] = [cell.low.position, cell.high.position].map(|[u, v, _]| self.point([u, v]));
        (0.5 * (a + b), 0.5 * a.distance(b))
    }
}
