//! A smooth boundary between two indices of refraction.

use glam::DVec3;

/// Glass, water: reflects or refracts, absorbs nothing. It names the interiors on its two sides.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Dielectric {
    inside: usize,
    outside: usize,
    is_matched: bool,
}

/// What a ray meets at a smooth boundary.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Refraction {
    /// Fraction of unpolarised light that is reflected \[1\]; exactly 1 beyond the critical angle, 0 without a boundary.
    pub reflectance: f64,
    /// Cosine of the angle of the refracted ray; 0 beyond the critical angle.
    pub cos_far: f64,
}

/// Fresnel's equations for unpolarised light that meets a boundary from index `near` to index `far`.
///
/// r_s = (n1 c1 - n2 c2)/(n1 c1 + n2 c2), r_p = (n2 c1 - n1 c2)/(n2 c1 + n1 c2), R = (r_s^2 + r_p^2)/2, and Snell's law
/// in the form n2^2 c2^2 = (n2 - n1)(n2 + n1) + n1^2 c1^2, which keeps its digits at grazing incidence, near the
/// critical angle and for nearly equal indices.
///
/// # Arguments
/// `near`, `far` indices \[1\], at least 1; `cosine` of the angle of incidence, in [0, 1]
/// # Limits
/// Equal indices: nothing is reflected and nothing bent, exactly; grazing incidence: everything is reflected.
/// # Source
/// Born and Wolf 1999, 1.5.2
pub fn fresnel(near: f64, far: f64, cosine: f64) -> Refraction {
    if near == far {
        return Refraction { reflectance: 0.0, cos_far: cosine };
    }
    let (n1c1, n2c1) = (near * cosine, far * cosine);
    let squared = (far - near) * (far + near) + n1c1 * n1c1;
    if squared <= 0.0 {
        return Refraction { reflectance: 1.0, cos_far: 0.0 };
    }
    let n2c2 = squared.sqrt();
    let c2 = (n2c2 / far).min(1.0);
    let s = (n1c1 - n2c2) / (n1c1 + n2c2);
    let p = (n2c1 - near * c2) / (n2c1 + near * c2);
    Refraction { reflectance: 0.5 * (s * s + p * p), cos_far: c2 }
}

/// The refracted direction of travel, from the one before, the normal on the side of arrival, the ratio of the indices
/// (near over far) and the cosines of both angles.
pub fn refract(dir: DVec3, normal: DVec3, ratio: f64, (cos_near, cos_far): (f64, f64)) -> DVec3 {
    (ratio * dir + (ratio * cos_near - cos_far) * normal).normalize()
}

impl Dielectric {
    /// A boundary with the interiors of these numbers on its inner side, against its outward normal, and its outer side.
    pub fn new(inside: usize, outside: usize) -> Self {
        Dielectric { inside, outside, is_matched: false }
    }

    /// The same boundary between these indices of refraction, inner and outer: a scene tells it.
    pub(crate) fn between(self, (inside, outside): (f64, f64)) -> Self {
        Dielectric { is_matched: inside == outside, ..self }
    }

    /// Whether the indices on both sides are equal, so that light goes straight on as though there were nothing.
    pub fn is_matched(&self) -> bool {
        self.is_matched
    }

    /// Number of the interior on the inner side.
    pub fn inside(&self) -> usize {
        self.inside
    }

    /// Number of the interior on the outer side.
    pub fn outside(&self) -> usize {
        self.outside
    }

    /// The interiors before and behind the boundary, for a ray that meets it along `dir` where its outward normal is
    /// `normal`.
    pub fn sides(&self, dir: DVec3, normal: DVec3) -> (usize, usize) {
        if dir.dot(normal) < 0.0 { (self.outside, self.inside) } else { (self.inside, self.outside) }
    }
}
