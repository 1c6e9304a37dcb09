//! The cases: four media, the rays that ask for the light scattered twice and more in them, and what answers.

use crate::harness::Settings;
use crate::setups::{Body, CELL, Lighting, Setup, spiral};
use glam::DVec3;
use turbid::math::{Interval, Ray};

/// A medium, seen along rays.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Medium {
    /// A ball of a tenth of a mean free path, under light from all sides.
    Thin,
    /// A slab of eight under a beam, within it and along its faces.
    Thick,
    /// A slab of four whose scattering hardly turns the light, seen aslant from behind.
    Peaked,
    /// A ball of two under light from all sides, close to its surface.
    Bounded,
}

/// Radius of the thin ball, in mean free paths.
const THIN: f64 = 0.1;
/// Radius of the bounded one.
const BALL: f64 = 2.0;
/// Thickness of the thick slab.
const THICK: f64 = 8.0;
/// Thickness of the peaked one.
const PEAKED: f64 = 4.0;
/// Depth of the rays in the thick slab: the largest radius ends short of the lit face.
pub const INSIDE: f64 = 1.0;
/// Cosine of the rays with the normal of the peaked one.
pub const COSINE: f64 = 0.5;
/// Albedo of all of them.
pub const ALBEDO: f64 = 0.9;
/// Asymmetry of the peaked one.
pub const PEAK: f64 = 0.9;

/// Rays of a map. They ask alike: symmetries of a medium and its light carry each into each other.
pub const RAYS: usize = 4;
/// Maps of each medium, number of photons and kind: half of them tell the error at the best radius, and a verdict takes 64.
pub const CELLS: u64 = 128;
/// Radii, each of the root of two times the one before.
const RADII: i32 = 5;

impl Medium {
    /// All of them.
    pub const ALL: [Medium; 4] = [Medium::Thin, Medium::Thick, Medium::Peaked, Medium::Bounded];

    /// Its name in cases.
    pub fn name(self) -> &'static str {
        match self {
            Medium::Thin => "thin",
            Medium::Thick => "thick",
            Medium::Peaked => "peaked",
            Medium::Bounded => "bounded",
        }
    }

    /// Its title in figures and tables.
    pub fn title(self) -> &'static str {
        match self {
            Medium::Thin => "thin: a ball of radius 0.1",
            Medium::Thick => "thick: a slab of 8",
            Medium::Peaked => "peaked: a slab of 4, g = 0.9",
            Medium::Bounded => "bounded: near the surface of a ball of 2",
        }
    }

    /// The body and its light; extinction 1.
    pub fn setup(self) -> Setup {
        let within = |body| Setup { body, lighting: Lighting::Isotropic, albedo: ALBEDO, g: 0.0 };
        match self {
            Medium::Thin => within(Body::Sphere { radius: THIN }),
            Medium::Thick => Setup::slab(THICK, ALBEDO, 0.0),
            Medium::Peaked => Setup::slab(PEAKED, ALBEDO, PEAK),
            Medium::Bounded => within(Body::Sphere { radius: BALL }),
        }
    }

    /// The rays, each from where it enters the medium.
    pub fn rays(self) -> Vec<Ray> {
        // Side by side around the cell of a slab.
        let beside = |i: usize, depth: f64| DVec3::new(0.0, (i as f64 + 0.5) * CELL / RAYS as f64, depth);
        let aslant = DVec3::new((1.0 - COSINE * COSINE).sqrt(), 0.0, -COSINE);
        match self {
            Medium::Thin | Medium::Bounded => spiral(RAYS)
                .map(|dir| {
                    let across = dir.any_orthonormal_vector();
                    Ray::new(self.aside() * across - 0.5 * self.span().end * dir, dir)
                })
                .collect(),
            Medium::Thick => (0..RAYS).map(|i| Ray::new(beside(i, INSIDE), DVec3::X)).collect(),
            Medium::Peaked => (0..RAYS).map(|i| Ray::new(beside(i, PEAKED), aslant)).collect(),
        }
    }

    /// Distance of the rays from the centre of a ball.
    fn aside(self) -> f64 {
        if self == Medium::Thin { 0.5 * THIN } else { 0.9 * BALL }
    }

    /// The whole of a ray.
    pub fn span(self) -> Interval {
        let end = match self {
            Medium::Thin => 2.0 * (THIN * THIN - self.aside() * self.aside()).sqrt(),
            Medium::Bounded => 2.0 * (BALL * BALL - self.aside() * self.aside()).sqrt(),
            Medium::Thick => CELL,
            Medium::Peaked => PEAKED / COSINE,
        };
        Interval { start: 0.0, end }
    }

    /// The radii that are tried \[mfp\], from the largest.
    pub fn radii(self) -> Vec<f64> {
        let most = match self {
            Medium::Thin => 0.14,
            Medium::Thick => 0.8,
            Medium::Peaked => 1.1,
            Medium::Bounded => 0.56,
        };
        (0..RADII).map(|i| most * libm::exp2(-0.5 * f64::from(i))).collect()
    }

    /// Whether faces cut the kernels, so that what is left of them is to make up for it.
    pub fn is_clipped(self) -> bool {
        self != Medium::Thick
    }

    /// The group of cells of a number of photons.
    pub fn group(self, photons: u64) -> String {
        format!("{}-n{photons}", self.name())
    }
}

/// What answers a ray.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Method {
    /// Points, in balls a radius apart.
    Balls,
    /// Points about the whole of the ray.
    Points,
    /// Flights that pass the ray.
    Beams,
    /// Planes of flights that the ray meets.
    Planes,
    /// Flights that pass the ray, their blur taken out by a sum of differences whose level is drawn.
    Debiased,
}

impl Method {
    /// All of them, in the order of the literature.
    pub const ALL: [Method; 5] =
        [Method::Balls, Method::Points, Method::Beams, Method::Planes, Method::Debiased];

    /// Its name in cases.
    pub fn name(self) -> &'static str {
        match self {
            Method::Balls => "balls",
            Method::Points => "points",
            Method::Beams => "beams",
            Method::Planes => "planes",
            Method::Debiased => "debiased",
        }
    }

    /// Its title in figures and tables.
    pub fn title(self) -> &'static str {
        match self {
            Method::Balls => "points in balls",
            Method::Points => "points along rays",
            Method::Beams => "beams",
            Method::Planes => "planes",
            Method::Debiased => "beams, debiased",
        }
    }

    /// Whether a radius is to be chosen.
    pub fn has_radius(self) -> bool {
        matches!(self, Method::Balls | Method::Points | Method::Beams)
    }

    /// What the typical error tends to as a power of the number of photons N: -2/(c + 4) at the best radius, c the power of the radius in
    /// the variance, and the same for debiased estimates; of planes, whose squares fall as ln N/N, that between two numbers.
    pub fn exponent(self, fewest: u64, most: u64) -> f64 {
        let along = |n: u64| libm::sqrt(libm::log(n as f64) / n as f64);
        match self {
            Method::Balls | Method::Points => -1.0 / 3.0,
            Method::Beams | Method::Debiased => -0.4,
            Method::Planes => libm::log(along(most) / along(fewest)) / libm::log(most as f64 / fewest as f64),
        }
    }
}

/// Photons of a map, from few to many.
pub fn sizes(settings: &Settings) -> Vec<u64> {
    let most = settings.photons(4_000, 32_000).max(64);
    let rungs = settings.pick(3, 4);
    (0..rungs).rev().map(|i| (most >> (2 * i)).max(1)).collect()
}

/// The name of a case in tables; none has a radius where none is chosen.
pub fn name(medium: Medium, method: Method, photons: u64, radius: Option<f64>) -> String {
    let radius = radius.map_or(String::new(), |radius| format!(" r={radius:.4}"));
    format!("{} {} n={photons}{radius}", medium.name(), method.name())
}

/// The quantity that is what a ray found.
pub fn answer(ray: usize) -> String {
    format!("ray {ray}")
}

/// The quantity that is how many records, photons or flights or planes, were looked at for a ray.
pub const LOOKED_AT: &str = "looked at";

/// The phase of the work that is a map, as it is stored.
pub fn filling(stored: Method) -> String {
    format!("{} map", stored.name())
}

/// The phase of the work that is reading it.
pub fn reading(method: Method, radius: Option<f64>) -> String {
    let radius = radius.map_or(String::new(), |radius| format!(" r={radius:.4}"));
    format!("{} reading{radius}", method.name())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rays that are not in a medium all along enter it where they begin and leave it where they end.
    #[test]
    fn rays_cross_their_media() {
        for medium in Medium::ALL {
            let (shape, rays, span) = (medium.setup().body.shape().unwrap(), medium.rays(), medium.span());
            assert_eq!(rays.len(), RAYS);
            for ray in rays {
                assert!((ray.dir.length() - 1.0).abs() < 1e-12);
                let inside = shape.interval(&ray).unwrap();
                if medium == Medium::Thick {
                    assert!(inside.start <= 0.0 && inside.end >= span.end);
                } else {
                    assert!(inside.start.abs() < 1e-9 && (inside.end - span.end).abs() < 1e-9, "{medium:?}");
                }
            }
        }
        assert!(!Medium::Thick.is_clipped() && Medium::Thick.radii()[0] < INSIDE);
    }
}
