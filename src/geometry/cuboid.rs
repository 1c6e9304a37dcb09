//! A box along the axes.

use super::{Front, Hit, Rectangle};
use crate::error::{Error, Result};
use crate::faults::{Fault, planted};
use crate::math::{Interval, Ray};
use glam::{DVec2, DVec3};

/// All points between two corners.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cuboid {
    min: DVec3,
    max: DVec3,
}

/// A hit of a face.
fn face(t: f64, normal: DVec3) -> Hit {
    Hit { t, normal, shading: normal, uv: DVec2::ZERO, primitive: 0 }
}

/// The unit vector along an axis.
fn axis(index: usize) -> DVec3 {
    DVec3::AXES[index]
}

impl Cuboid {
    /// A box from its lower and upper corners \[L\].
    pub fn new(min: DVec3, max: DVec3) -> Result<Self> {
        if !(min.is_finite() && max.is_finite() && min.cmplt(max).all()) {
            return Err(Error::Scene(
                "a cuboid needs finite corners with min below max on every axis".into(),
            ));
        }
        Ok(Cuboid { min, max })
    }

    /// Lower corner \[L\].
    pub fn min(&self) -> DVec3 {
        self.min
    }

    /// Upper corner \[L\].
    pub fn max(&self) -> DVec3 {
        self.max
    }

    /// Entry and exit along the line: distance and axis of each, or none if it misses.
    fn crossings(&self, ray: &Ray) -> Option<((f64, usize), (f64, usize))> {
        let (mut entry, mut exit) = ((f64::NEG_INFINITY, 0), (f64::INFINITY, 0));
        for i in 0..3 {
            let (o, d) = (ray.origin[i], ray.dir[i]);
            if d == 0.0 {
                if o < self.min[i] || o > self.max[i] {
                    return None;
                }
                continue;
            }
            let (a, b) = ((self.min[i] - o) / d, (self.max[i] - o) / d);
            let (near, far) = (a.min(b), a.max(b));
            if near > entry.0 {
                entry = (near, i);
            }
            if far < exit.0 {
                exit = (far, i);
            }
        }
        (entry.0 < exit.0).then_some((entry, exit))
    }

    /// Axis and outward sign of the face that the point lies on, the nearest one.
    fn face_at(&self, p: DVec3) -> (usize, f64) {
        let mut best = (f64::INFINITY, 0, 1.0);
        for i in 0..3 {
            for (plane, sign) in [(self.min[i], -1.0), (self.max[i], 1.0)] {
                let distance = (p[i] - plane).abs();
                if distance < best.0 {
                    best = (distance, i, sign);
                }
            }
        }
        (best.1, best.2)
    }

    pub(super) fn hit(&self, ray: &Ray, from_here: bool) -> Option<Hit> {
        let exit_hit = |(t, i): (f64, usize)| face(t, axis(i) * ray.dir[i].signum());
        if from_here {
            let (i, sign) = self.face_at(ray.origin);
            if ray.dir[i] * sign >= 0.0 {
                return None;
            }
            return self.crossings(ray).map(|(_, exit)| exit_hit(exit));
        }
        let (entry, exit) = self.crossings(ray)?;
        if entry.0 > 0.0 {
            return Some(face(entry.0, -axis(entry.1) * ray.dir[entry.1].signum()));
        }
        (exit.0 > 0.0).then(|| exit_hit(exit))
    }

    pub(super) fn interval(&self, ray: &Ray) -> Option<Interval> {
        if planted(Fault::AxisRaysMiss) && ray.dir.to_array().contains(&0.0) {
            return None;
        }
        let (entry, exit) = self.crossings(ray)?;
        (exit.0 > 0.0).then_some(Interval { start: entry.0.max(0.0), end: exit.0 })
    }

    pub(super) fn front(&self, p: DVec3) -> Option<Front> {
        let away = (self.min - p).max(p - self.max);
        let face = away.max_position();
        let sign = if p[face] > self.max[face] { 1.0 } else { -1.0 };
        (away[face] > 0.0).then(|| Front { normal: axis(face) * sign, distance: away[face] })
    }

    /// Whether its front face covers all that its plane cuts of a ball about a point outside.
    pub(super) fn parts_ball(&self, p: DVec3, radius: f64) -> bool {
        let away = (self.min - p).max(p - self.max);
        let face = away.max_position();
        let across = (radius - away[face]).sqrt() * (radius + away[face]).sqrt();
        away[face] > 0.0 && (0..3).all(|axis| axis == face || -away[axis] >= across)
    }

    pub(super) fn contains(&self, p: DVec3) -> bool {
        p.cmpge(self.min).all() && p.cmple(self.max).all()
    }

    /// Surface area [L^2].
    pub fn area(&self) -> f64 {
        let e = self.max - self.min;
        2.0 * (e.x * e.y + e.y * e.z + e.z * e.x)
    }

    /// Volume [L^3].
    pub fn volume(&self) -> f64 {
        (self.max - self.min).element_product()
    }

    /// A uniform point on the surface and the outward normal there, from three numbers in [0, 1).
    pub fn sample_surface(&self, [u, v, w]: [f64; 3]) -> (DVec3, DVec3) {
        let e = self.max - self.min;
        let areas = [e.y * e.z, e.z * e.x, e.x * e.y];
        let mut target = u * (areas[0] + areas[1] + areas[2]);
        let mut i = 0;
        while i < 2 && target >= areas[i] {
            target -= areas[i];
            i += 1;
        }
        // What is left of the first number says which of the two opposite faces.
        let is_upper = target >= 0.5 * areas[i];
        let mut p = self.min;
        p[(i + 1) % 3] = self.min[(i + 1) % 3] + e[(i + 1) % 3] * v;
        p[(i + 2) % 3] = self.min[(i + 2) % 3] + e[(i + 2) % 3] * w;
        p[i] = if is_upper { self.max[i] } else { self.min[i] };
        (p, axis(i) * if is_upper { 1.0 } else { -1.0 })
    }

    /// Its faces as rectangles that face outwards; none of one that is too small or too thin for numbers to tell.
    pub fn faces(&self) -> Vec<Rectangle> {
        let mut faces = Vec::with_capacity(6);
        for i in 0..3 {
            let [u, v] = [(i + 1) % 3, (i + 2) % 3].map(|j| axis(j) * (self.max[j] - self.min[j]));
            faces.extend(Rectangle::new(self.min, v, u));
            faces.extend(Rectangle::new(self.max, -u, -v));
        }
        faces
    }

    /// Where the first number of [`Self::sample_surface`] goes from one face to the next, 0 and 1 included.
    pub fn face_ends(&self) -> [f64; 7] {
        let e = self.max - self.min;
        let areas = [e.y * e.z, e.z * e.x, e.x * e.y];
        let total = areas[0] + areas[1] + areas[2];
        let mut ends = [0.0; 7];
        for i in 0..6 {
            ends[i + 1] = if i == 5 { 1.0 } else { (ends[i] + 0.5 * areas[i / 2] / total).min(1.0) };
        }
        ends
    }

    /// Areas of the faces that a point outside sees, one an axis, and whether it is the upper one [L^2].
    fn facing(&self, p: DVec3) -> [(f64, bool); 3] {
        let e = self.max - self.min;
        let area = [e.y * e.z, e.z * e.x, e.x * e.y];
        std::array::from_fn(|i| {
            let is_seen = p[i] < self.min[i] || p[i] > self.max[i];
            (if is_seen { area[i] } else { 0.0 }, p[i] > self.max[i])
        })
    }

    /// Area of the faces whose outside a point sees [L^2]; 0 inside.
    pub fn facing_area(&self, p: DVec3) -> f64 {
        self.facing(p).iter().map(|(area, _)| area).sum()
    }

    /// A uniform point on the faces whose outside `p` sees, and the normal there; none inside.
    pub fn sample_facing(&self, p: DVec3, [u, v]: [f64; 2]) -> Option<(DVec3, DVec3)> {
        let faces = self.facing(p);
        let mut target = u * faces.iter().map(|(area, _)| area).sum::<f64>();
        let last = faces.iter().rposition(|(area, _)| *area > 0.0)?;
        let i = (0..last).find(|&i| {
            let is_here = target < faces[i].0;
            target -= if is_here { 0.0 } else { faces[i].0 };
            is_here
        });
        let i = i.unwrap_or(last);
        // What is left of the first number is uniform in the face that it chose.
        let (a, is_upper) = (target / faces[i].0, faces[i].1);
        let e = self.max - self.min;
        let mut point = self.min;
        point[(i + 1) % 3] = self.min[(i + 1) % 3] + e[(i + 1) % 3] * a.min(1.0);
        point[(i + 2) % 3] = self.min[(i + 2) % 3] + e[(i + 2) % 3] * v;
        point[i] = if is_upper { self.max[i] } else { self.min[i] };
        Some((point, axis(i) * if is_upper { 1.0 } else { -1.0 }))
    }

    /// A uniform point inside.
    pub fn sample_inside(&self, u: [f64; 3]) -> DVec3 {
        self.min + (self.max - self.min) * DVec3::from_array(u)
    }
}
