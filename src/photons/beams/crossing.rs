//! Where a ray and a beam come nearest.

use crate::faults::{Fault, planted};
use crate::math::Ray;
use glam::DVec3;

/// Where a ray comes nearest to the line of a beam.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Crossing {
    /// Distance along the ray \[L\].
    pub along_ray: f64,
    /// Distance along the beam from its start \[L\].
    pub along_beam: f64,
    /// Unit vector across both.
    pub normal: DVec3,
    /// From the ray to the beam along the normal \[L\]; of either sign.
    pub offset: f64,
    /// Sine of the angle between both \[1\], above 0.
    pub sine: f64,
}

impl Crossing {
    /// With n = d x w, |n| the sine of the angle between ray and beam and y the way from the ray's origin to the beam's start,
    /// s = (y x w).n/n^2, t = (y x d).n/n^2 and u = y.n/|n|: no difference of products is divided, and small angles keep their
    /// digits. None of a beam that is exactly parallel to the ray.
    pub fn new(ray: &Ray, (start, dir): (DVec3, DVec3)) -> Option<Self> {
        let across = ray.dir.cross(dir);
        let squared = across.length_squared();
        if planted(Fault::NearParallelDropped) && squared < 1e-5 {
            return None;
        }
        if squared == 0.0 {
            return None;
        }
        let (way, sine) = (start - ray.origin, squared.sqrt());
        let normal = across / sine;
        Some(Crossing {
            along_ray: way.cross(dir).dot(normal) / sine,
            along_beam: way.cross(ray.dir).dot(normal) / sine,
            normal,
            offset: way.dot(normal),
            sine,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::{cos, sin};

    /// Square, aslant and within a thousandth of parallel, by hand; far from the origin too; none of parallel lines.
    #[test]
    fn nearest_points_by_hand() {
        let beam = (DVec3::ZERO, DVec3::Z);
        let square = Crossing::new(&Ray::new(DVec3::new(-2.0, 0.03, 0.7), DVec3::X), beam).unwrap();
        let aslant = Ray::new(DVec3::new(-1.0, 0.03, -0.5), DVec3::new(0.5, 0.0, 0.75f64.sqrt()));
        let angle = 1e-3;
        let thin = Ray::new(DVec3::new(-angle, 0.03, 0.0), DVec3::new(sin(angle), 0.0, cos(angle)));
        for (crossing, s, t, sine) in [
            (square, 2.0, 0.7, 1.0),
            (Crossing::new(&aslant, beam).unwrap(), 2.0, 3.0f64.sqrt() - 0.5, 0.5),
            (
                Crossing::new(&thin, beam).unwrap(),
                angle / sin(angle),
                cos(angle) * angle / sin(angle),
                sin(angle),
            ),
        ] {
            assert!((crossing.along_ray - s).abs() < 1e-12, "{crossing:?}");
            assert!((crossing.along_beam - t).abs() < 1e-12, "{crossing:?}");
            assert!((crossing.offset.abs() - 0.03).abs() < 1e-15, "{crossing:?}");
            assert!((crossing.sine / sine - 1.0).abs() < 1e-14, "{crossing:?}");
        }
        let far = DVec3::new(1e6, -3e6, 2e6);
        let moved = Ray::new(aslant.origin + far, aslant.dir);
        let crossing = Crossing::new(&moved, (far, DVec3::Z)).unwrap();
        assert!((crossing.along_beam - 3.0f64.sqrt() + 0.5).abs() < 1e-8);
        for sign in [1.0, -1.0] {
            assert!(Crossing::new(&Ray::new(DVec3::X, DVec3::Z * sign), beam).is_none());
        }
    }
}
