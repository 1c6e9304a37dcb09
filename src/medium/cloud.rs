//! A cloud: a body whose edge is broken up by fractal noise.

use super::noise::{MOST_OCTAVES, Noise};
use super::{Along, Cells};
use crate::error::{Error, Result};
use crate::math::{Interval, Ray};
use glam::DVec3;

/// Cells of bounds along an axis.
const CELLS: usize = 32;

/// What a cloud's body is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Body {
    /// Densest in the middle of an ellipsoid: 1 - r^2, r the distance from the centre over that of the surface.
    Ellipsoid,
    /// Densest in the middle of a box: the least of 1 - x^2 over its axes.
    Cuboid,
}

/// What a cloud looks like; [`Cloud::new`] says what is allowed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CloudShape {
    /// Its middle \[L\].
    pub center: DVec3,
    /// Half its extent along each axis, before the noise \[L\].
    pub radii: DVec3,
    /// What it is without noise.
    pub body: Body,
    /// Which noise.
    pub seed: u64,
    /// Lattice steps of the first octave along a radius.
    pub frequency: f64,
    /// Octaves of noise.
    pub octaves: u32,
    /// Amplitude of an octave over that of the one before.
    pub gain: f64,
    /// Amplitude of the noise beside the body's 1: 0 is smooth, 2 leaves shreds.
    pub roughness: f64,
    /// How steeply the density rises at the edge; it is cut at 1.
    pub sharpness: f64,
}

impl CloudShape {
    /// An ellipsoid with noise of five octaves.
    pub fn plain(center: DVec3, radii: DVec3) -> Self {
        CloudShape {
            center,
            radii,
            body: Body::Ellipsoid,
            seed: 0,
            frequency: 2.0,
            octaves: 5,
            gain: 0.5,
            roughness: 1.0,
            sharpness: 2.0,
        }
    }
}

/// Density \[1\] = min(1, max(0, sharpness (body + roughness noise))): 1 in the core, 0 outside, shreds between.
#[derive(Debug, Clone, PartialEq)]
pub struct Cloud {
    shape: CloudShape,
    noise: Noise,
    cells: Cells,
}

impl Cloud {
    /// A cloud of this look.
    ///
    /// # Errors
    /// `Error::OutOfRange` for a centre beyond 1e100 and radii out of 1e-100 to 1e100; frequency, gain or sharpness not
    /// above 0; a roughness below 0; octaves out of 1 to 12; each at most 1e6 but for centre and radii
    pub fn new(shape: CloudShape) -> Result<Self> {
        // Farther out squares of lengths are no numbers.
        if let Some(bad) = shape.center.to_array().into_iter().find(|x| x.is_nan() || x.abs() > 1e100) {
            return Err(Error::out_of_range("coordinate of a cloud's centre", bad, "up to 1e100 in size"));
        }
        if let Some(bad) = shape.radii.to_array().into_iter().find(|r| !(1e-100..=1e100).contains(r)) {
            return Err(Error::out_of_range("radius of a cloud", bad, "1e-100 to 1e100"));
        }
        let above_0 = [("frequency", shape.frequency), ("gain", shape.gain), ("sharpness", shape.sharpness)];
        if let Some((name, bad)) = above_0.into_iter().find(|(_, x)| !(*x > 0.0 && *x <= 1e6)) {
            return Err(Error::out_of_range(format!("{name} of a cloud"), bad, "above 0, to 1e6"));
        }
        if !(0.0..=1e6).contains(&shape.roughness) {
            return Err(Error::out_of_range("roughness of a cloud", shape.roughness, "0 to 1e6"));
        }
        if !(1..=MOST_OCTAVES).contains(&shape.octaves) {
            return Err(Error::out_of_range("octaves of a cloud", f64::from(shape.octaves), "1 to 12"));
        }
        let noise = Noise::new(shape.seed, shape.octaves, shape.gain);
        // Where the body is below -roughness nothing is left; one more cell on each side is empty, and so is all
        // that it stands for.
        let reach = (1.0 + shape.roughness).sqrt() * (CELLS as f64) / (CELLS as f64 - 2.0) * (1.0 + 1e-9);
        let (min, max) = (shape.center - shape.radii * reach, shape.center + shape.radii * reach);
        let edge = (max - min) / CELLS as f64;
        let cells = Cells::new(min, max, [CELLS; 3], |index| {
            let first = min + edge * DVec3::from_array(index.map(|i| i as f64));
            // A point that rounding puts beside its cell still lies within its bounds.
            let margin = edge * 1e-6;
            bounds(&shape, &noise, first - margin, first + edge + margin)
        });
        Ok(Cloud { shape, noise, cells })
    }

    /// What it looks like.
    pub fn shape(&self) -> &CloudShape {
        &self.shape
    }

    /// How far from its centre nothing is left of it, along each axis \[L\].
    pub fn reach(&self) -> DVec3 {
        self.shape.radii * (1.0 + self.shape.roughness).sqrt()
    }

    /// Density at a point \[1\], 0 to 1.
    pub fn at(&self, p: DVec3) -> f64 {
        let CloudShape { roughness, sharpness, .. } = self.shape;
        let q = (p - self.shape.center) / self.shape.radii;
        let body = self.shape.body.at(q);
        // Where the body alone decides, no noise is asked for.
        if body + roughness <= 0.0 {
            return 0.0;
        }
        if sharpness * (body - roughness) >= 1.0 {
            return 1.0;
        }
        let noise = self.noise.at(q * self.shape.frequency);
        (sharpness * (body + roughness * noise)).clamp(0.0, 1.0)
    }

    /// Bounds of the density in a box: of the body and of the noise, each for itself.
    pub fn bounds(&self, min: DVec3, max: DVec3) -> (f64, f64) {
        bounds(&self.shape, &self.noise, min, max)
    }

    /// Bounds of the density along a part of a ray.
    #[inline]
    pub fn along(&self, ray: &Ray, part: Interval) -> Along<'_> {
        self.cells.along(ray, part)
    }

    /// The cells of its bounds.
    pub fn cells(&self) -> &Cells {
        &self.cells
    }
}

impl Body {
    /// 1 in the middle, 0 on the surface; `q` from the centre, in radii.
    fn at(self, q: DVec3) -> f64 {
        match self {
            Body::Ellipsoid => 1.0 - q.length_squared(),
            Body::Cuboid => 1.0 - (q * q).max_element(),
        }
    }
}

fn bounds(shape: &CloudShape, noise: &Noise, min: DVec3, max: DVec3) -> (f64, f64) {
    let CloudShape { roughness, sharpness, frequency, .. } = *shape;
    let (a, b) = ((min - shape.center) / shape.radii, (max - shape.center) / shape.radii);
    // The body falls from the middle along every axis: greatest at the point nearest it, least at the farthest.
    let nearest = DVec3::ZERO.clamp(a, b);
    let farthest = a.abs().max(b.abs());
    let (low, high) = noise.bounds(a * frequency, b * frequency);
    let density = |body: f64, noise: f64| (sharpness * (body + roughness * noise)).clamp(0.0, 1.0);
    // Sums of some ten terms round: 1e-12 of each is more than that.
    let margin = |body: f64| 1e-12 * (1.0 + body.abs());
    let low = density(shape.body.at(farthest) - margin(shape.body.at(farthest)), low - 1e-12);
    let high = density(shape.body.at(nearest) + margin(shape.body.at(nearest)), high + 1e-12);
    (low, high)
}
