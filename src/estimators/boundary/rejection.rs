//! False photons: those that a wall parts from the point.

use crate::geometry::{Face, Shape};
use crate::math::Ray;
use crate::photons::Photon;
use glam::DVec3;

/// Which photons are rejected where a wall stands in the ball.
///
/// n is the unit normal, on the side of the point, of the wall nearest to it within the ball's largest radius, and s0
/// the foot of the perpendicular on it. Nothing is rejected where no wall is that near. Rejection takes false
/// photons away; it does not repair the low density at an edge, which is clipping's work.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Rejection {
    /// None.
    Off,
    /// Keeps photons that travel towards the wall, dir . n < 0: half of the good ones go too.
    Facing,
    /// Keeps photons in front of the wall's plane, and of those behind it the ones with dir . n < 0.
    FacingBehind,
    /// Keeps photons in front of the wall's plane, (x - s0) . n >= 0. Exact for a flat wall.
    BehindPlane,
    /// Keeps photons that the point sees past all walls: a ray for each. Exact for any walls.
    Visible,
}

impl Rejection {
    /// Every one.
    pub const ALL: [Rejection; 5] = [
        Rejection::Off,
        Rejection::Facing,
        Rejection::FacingBehind,
        Rejection::BehindPlane,
        Rejection::Visible,
    ];

    /// Its name in files and tables.
    pub fn name(self) -> &'static str {
        match self {
            Rejection::Off => "off",
            Rejection::Facing => "facing",
            Rejection::FacingBehind => "facing behind",
            Rejection::BehindPlane => "behind plane",
            Rejection::Visible => "visible",
        }
    }
}

/// The foot of the perpendicular from a point on a wall.
#[derive(Debug, Clone, Copy)]
struct Foot {
    place: DVec3,
    normal: DVec3,
    distance: f64,
}

/// A rejection about one point.
pub(in crate::estimators) struct PhotonFilter<'a> {
    rejection: Rejection,
    foot: Foot,
    walls: &'a [Shape],
    point: DVec3,
}

impl<'a> PhotonFilter<'a> {
    /// The filter about a point, unless nothing is rejected there.
    pub(in crate::estimators) fn new(
        rejection: Rejection,
        walls: &'a [Shape],
        point: DVec3,
        reach: f64,
    ) -> Option<Self> {
        if rejection == Rejection::Off {
            return None;
        }
        let feet = walls.iter().filter_map(|wall| foot(wall, point, rejection));
        let nearest = feet.reduce(|best, other| if other.distance < best.distance { other } else { best })?;
        (nearest.distance < reach).then_some(PhotonFilter { rejection, foot: nearest, walls, point })
    }

    /// Whether a photon is kept.
    pub(in crate::estimators) fn keeps(&self, photon: &Photon) -> bool {
        let normal = self.foot.normal;
        let in_front = || (photon.position - self.foot.place).dot(normal) >= 0.0;
        let faces = || photon.dir.as_dvec3().dot(normal) < 0.0;
        match self.rejection {
            Rejection::Off => true,
            Rejection::Facing => faces(),
            Rejection::FacingBehind => in_front() || faces(),
            Rejection::BehindPlane => in_front(),
            Rejection::Visible => self.sees(photon.position),
        }
    }

    fn sees(&self, place: DVec3) -> bool {
        let away = place - self.point;
        let distance = away.length();
        let Some(dir) = away.try_normalize() else { return true };
        let ray = Ray::new(self.point, dir);
        // A point on the wall itself looks away from it, not at it.
        let is_on =
            |wall: &Shape| foot(wall, self.point, Rejection::Visible).is_some_and(|f| f.distance == 0.0);
        !self
            .walls
            .iter()
            .any(|wall| wall.hit(&ray, is_on(wall).then_some(0)).is_some_and(|hit| hit.t < distance))
    }
}

/// The foot on a wall. A rectangle has one under the points that it covers; where only its plane matters, as for
/// seeing past it, the foot on the plane stands for it. Meshes and lathes have none: no closed form says where.
fn foot(wall: &Shape, p: DVec3, rejection: Rejection) -> Option<Foot> {
    // On the wall itself the side is that of the outward normal.
    let from = |place: DVec3, outward: DVec3| {
        let distance = p.distance(place);
        Foot { place, normal: (p - place).try_normalize().unwrap_or(outward), distance }
    };
    match wall {
        Shape::Rectangle(r) => {
            let (normal, height) = (r.normal(), r.height(p));
            let counts = rejection == Rejection::Visible || r.covers(p);
            counts.then(|| Foot {
                place: p - normal * height,
                normal: if height < 0.0 { -normal } else { normal },
                distance: height.abs(),
            })
        }
        Shape::Sphere(s) => {
            let outward = (p - s.center()).try_normalize().unwrap_or(DVec3::Z);
            Some(from(s.center() + outward * s.radius(), outward))
        }
        Shape::Slab(s) => {
            let is_top = p.z - s.top() <= s.face(Face::Bottom) - p.z;
            let face = if is_top { Face::Top } else { Face::Bottom };
            Some(from(DVec3::new(p.x, p.y, s.face(face)), face.normal()))
        }
        Shape::Cuboid(c) => {
            let (low, high) = (p - c.min(), c.max() - p);
            let axis = low.min(high).min_position();
            let is_low = low[axis] <= high[axis];
            let outward = DVec3::AXES[axis] * if is_low { -1.0 } else { 1.0 };
            let mut place = p.clamp(c.min(), c.max());
            if wall.contains(p) {
                place[axis] = if is_low { c.min()[axis] } else { c.max()[axis] };
            }
            Some(from(place, outward))
        }
        Shape::Mesh(_) | Shape::Revolution(_) => None,
    }
}
