//! The two normals of a surface: that of where it is, and that which light scatters about.
//!
//! Between triangles that stand for a curved body the normal is interpolated, so that light scatters as on the body. What is
//! inside and outside, where rays go and what they meet is asked of the triangles alone. A scattering function f about the
//! shading normal n_s becomes, over solid angle projected on the triangle with its geometric normal n_g,
//!
//! f'(wi, wo) = f(wi, wo) |wi . n_s| / |wi . n_g|,
//!
//! and 0 where a direction is not on the side of the triangle that it is on by f. That is not the same in both directions: radiance that
//! is gathered along wo is the integral of L f |wi . n_s|, as though n_s were the normal, while a photon that arrives along wi and
//! leaves along wo carries |wi . n_s| |wo . n_g| / (|wi . n_g| |wo . n_s|) of what it would. Either way what arrives is not
//! what leaves: energy is conserved no better than the one normal is the other.
//!
//! # Source     Veach 1997, "Robust Monte Carlo methods for light transport simulation", 5.3

use super::Hit;
use crate::faults::{Fault, planted};
use glam::DVec3;

/// The normals of a place on a surface, both on the side that a ray comes from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Normals {
    /// Unit geometric normal: it says which side is which.
    pub geometric: DVec3,
    /// Unit normal that light scatters about, less than a right angle from the other.
    pub shading: DVec3,
}

impl Hit {
    /// The normals on the side that a ray with this direction of travel comes from.
    pub fn normals(&self, dir: DVec3) -> Normals {
        if dir.dot(self.normal) < 0.0 {
            Normals { geometric: self.normal, shading: self.shading }
        } else {
            Normals { geometric: -self.normal, shading: -self.shading }
        }
    }
}

impl Normals {
    /// Whether light scatters about another normal than the geometric one.
    pub fn differ(&self) -> bool {
        self.geometric != self.shading
    }

    /// Whether a direction leaves on the side of arrival, or on the far one.
    pub fn is_on_side(&self, dir: DVec3, is_near: bool) -> bool {
        let [geometric, shading] = [self.geometric, self.shading].map(|normal| dir.dot(normal));
        if is_near { geometric > 0.0 && shading > 0.0 } else { geometric < 0.0 && shading < 0.0 }
    }

    /// Whether diffuse light can leave in a direction that was chosen about either normal.
    pub fn leaves(&self, dir: DVec3) -> bool {
        !self.differ() || dir.dot(self.geometric) > 0.0
    }

    /// Cosine that radiance from a direction is weighted by where it is gathered \[1\]: about the shading normal, and 0 from
    /// behind the surface.
    pub fn cosine(&self, towards: DVec3) -> f64 {
        let cosine = towards.dot(self.shading).max(0.0);
        if self.leaves(towards) { cosine } else { 0.0 }
    }

    /// What a photon counts that arrives at a diffuse surface with this direction of travel \[1\]: |wi . n_s| / |wi . n_g|.
    /// Photons fall on the triangle by the cosine with its own normal, and bring irradiance about the other. It leaves about
    /// the geometric normal, since f' |wo . n_g| is of that cosine.
    pub fn arriving(&self, dir: DVec3) -> f64 {
        if !self.differ() || planted(Fault::ShadingFactorForgotten) {
            return 1.0;
        }
        let [geometric, shading] = [self.geometric, self.shading].map(|normal| -dir.dot(normal));
        if geometric > 0.0 { shading.max(0.0) / geometric } else { 0.0 }
    }

    /// What a photon's power is multiplied by in a specular scattering between two directions of travel, the one before and the
    /// one after \[1\]: |wi . n_s| |wo . n_g| / (|wi . n_g| |wo . n_s|).
    pub fn turned(&self, before: DVec3, after: DVec3) -> f64 {
        if !self.differ() || planted(Fault::ShadingFactorForgotten) {
            return 1.0;
        }
        let ratio = |dir: DVec3| (dir.dot(self.shading) / dir.dot(self.geometric)).abs();
        ratio(before) / ratio(after)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec2;

    fn hit(shading: DVec3) -> Hit {
        Hit { t: 1.0, normal: DVec3::Z, shading: shading.normalize(), uv: DVec2::ZERO, primitive: 0 }
    }

    /// Equal normals change nothing, to the bit; a ray from behind sees both from behind.
    #[test]
    fn equal_normals_are_no_change() {
        let dir = DVec3::new(0.3, -0.2, -0.7).normalize();
        let flat = hit(DVec3::Z).normals(dir);
        assert_eq!((flat.differ(), flat.arriving(dir), flat.turned(dir, -DVec3::X)), (false, 1.0, 1.0));
        assert_eq!(flat.cosine(-dir), -dir.z);
        let tilted = hit(DVec3::new(0.1, 0.0, 1.0));
        let [front, back] = [dir, -dir].map(|dir| tilted.normals(dir));
        assert_eq!((back.geometric, back.shading), (-front.geometric, -front.shading));
    }

    /// By hand: normals 45 degrees apart, light along one of them or between.
    #[test]
    fn factors_by_hand() {
        let normals = hit(DVec3::new(1.0, 0.0, 1.0)).normals(-DVec3::Z);
        let root = std::f64::consts::FRAC_1_SQRT_2;
        assert!((normals.arriving(-DVec3::Z) - root).abs() < 1e-15);
        let (low, high) = (DVec3::new(1.0, 0.0, 0.1), DVec3::new(-0.1, 0.0, 1.0));
        assert!((normals.arriving(-low.normalize()) - 11.0 * root).abs() < 1e-12);
        // Behind one normal only.
        let behind = DVec3::new(1.0, 0.0, -0.1).normalize();
        assert_eq!((normals.cosine(behind), normals.arriving(-behind)), (0.0, 0.0));
        assert!(!normals.is_on_side(behind, true) && !normals.is_on_side(behind, false));
        let expected = (1.1 / 0.1) / (0.9 / 1.0);
        let turned = normals.turned(-low.normalize(), high.normalize());
        assert!((turned - expected).abs() < 1e-12, "{turned} {expected}");
    }
}
