//! The rays: one through each kind of density, at known optical depths.

use super::line::Line;
use glam::DVec3;
use std::sync::Arc;
use turbid::Spectrum;
use turbid::math::{Interval, Positive, Ray};
use turbid::medium::{Blocks, Cloud, CloudShape, Density, Grid, HeightFog, Heterogeneous, Homogeneous};
use turbid::phase::{Isotropic, Phase};
use turbid::rng::{Purpose, Stream};

/// What the density along a ray is like.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Profile {
    /// Rising from 0 in a line.
    Ramp,
    /// Thin, and from three tenths to half of the way ten times as dense.
    Step,
    /// Thin, with a narrow peak.
    Peak,
    /// Three waves.
    Sine,
    /// Falling by e^3, as in height fog.
    Fog,
    /// Aslant through a grid of random values.
    Noise,
    /// Through a cloud.
    Cloud,
}

/// A ray: what it passes, and how much of it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Way {
    /// The density along it.
    pub profile: Profile,
    /// Optical depth \[1\].
    pub depth: f64,
}

/// Samples of a waving or peaked density along a unit of length.
const SAMPLES: usize = 64;

impl Way {
    /// All rays: each density at optical depth 2, noise and cloud at others too.
    pub fn all() -> Vec<Way> {
        let of =
            |profile, depths: &[f64]| depths.iter().map(|&depth| Way { profile, depth }).collect::<Vec<_>>();
        let usual = [Profile::Ramp, Profile::Step, Profile::Peak, Profile::Sine, Profile::Fog];
        let mut all: Vec<Way> = usual.into_iter().flat_map(|profile| of(profile, &[2.0])).collect();
        all.extend(of(Profile::Noise, &[0.1, 0.5, 2.0, 8.0, 30.0]));
        all.extend(of(Profile::Cloud, &[0.5, 2.0, 8.0]));
        all
    }

    /// The name in tables, that of its group of cells.
    pub fn name(&self) -> String {
        format!("{}-{}", self.profile.name(), self.depth)
    }

    /// What it is, for readers.
    pub fn title(&self) -> String {
        format!("{}, τ = {}", self.profile.name(), self.depth)
    }

    /// The line itself.
    ///
    /// # Errors
    /// If a density is refused
    pub fn line(&self) -> anyhow::Result<Line> {
        let (density, ray, part) = self.profile.path()?;
        let breaks = match &density {
            Density::Grid(grid) => grid.kinks(&ray, part),
            // Smooth within its pieces, but for shreds' edges: so many pieces that those do not count.
            Density::Cloud(_) => {
                (1..2048).map(|i| part.start + part.length() * f64::from(i) / 2048.0).collect()
            }
            _ => Vec::new(),
        };
        let line = |sigma_t: f64| -> anyhow::Result<Line> {
            let matter =
                Homogeneous::new(Spectrum::grey(sigma_t), Spectrum::ZERO, Phase::Isotropic(Isotropic))?;
            let medium = Heterogeneous::new(matter, density.clone()).into();
            Ok(Line::new(medium, ray, part, breaks.clone()))
        };
        line(self.depth / line(1.0)?.depth())
    }
}

impl Profile {
    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Profile::Ramp => "ramp",
            Profile::Step => "step",
            Profile::Peak => "peak",
            Profile::Sine => "sine",
            Profile::Fog => "fog",
            Profile::Noise => "noise",
            Profile::Cloud => "cloud",
        }
    }

    /// A density, and a ray through it.
    fn path(self) -> anyhow::Result<(Density, Ray, Interval)> {
        let unit = (Ray::new(DVec3::ZERO, DVec3::X), Interval { start: 0.0, end: 1.0 });
        let sampled = |f: &dyn Fn(f64) -> f64| -> anyhow::Result<Density> {
            let box_of = (DVec3::ZERO, DVec3::ONE);
            Ok(Density::grid(Grid::sampled(box_of, [SAMPLES, 1, 1], |p| f(p.x))?)?)
        };
        let density = match self {
            Profile::Ramp => {
                // Samples in the middles of two cells stand at 0 and at 1.
                let corners = (DVec3::new(-0.5, 0.0, 0.0), DVec3::new(1.5, 1.0, 1.0));
                Density::grid(Grid::new(corners, [2, 1, 1], 1, vec![0.0, 1.0])?)?
            }
            Profile::Step => {
                let edges = vec![0.0, 0.3, 0.5, 1.0];
                Density::blocks(Blocks::layers(0, edges, vec![0.1, 1.0, 0.1])?)?
            }
            Profile::Peak => sampled(&|x| 0.02 + libm::exp(-0.5 * (x - 0.6) * (x - 0.6) / (0.03 * 0.03)))?,
            Profile::Sine => sampled(&|x| 1.0 + 0.9 * libm::sin(6.0 * std::f64::consts::PI * x))?,
            Profile::Fog => {
                Density::HeightFog(HeightFog::new(DVec3::X, 0.0, Positive::new("height", 1.0 / 3.0)?)?)
            }
            Profile::Noise => {
                let mut stream = Stream::new(13, Purpose::Mixture, 0, 0);
                let values = (0..24 * 24 * 24).map(|_| stream.unit() as f32).collect();
                let grid = Grid::new((DVec3::ZERO, DVec3::ONE), [24; 3], 1, values)?;
                let (from, to) = (DVec3::new(0.02, 0.1, 0.15), DVec3::new(0.98, 0.87, 0.8));
                let ray = Ray::new(from, (to - from).normalize());
                return Ok((Density::grid(grid)?, ray, Interval { start: 0.0, end: (to - from).length() }));
            }
            Profile::Cloud => {
                let cloud = Cloud::new(CloudShape { seed: 3, ..CloudShape::plain(DVec3::ZERO, DVec3::ONE) })?;
                let (from, to) = (DVec3::new(-1.5, 0.2, -0.1), DVec3::new(1.5, -0.1, 0.3));
                let ray = Ray::new(from, (to - from).normalize());
                let part = Interval { start: 0.0, end: (to - from).length() };
                return Ok((Density::Cloud(Arc::new(cloud)), ray, part));
            }
        };
        Ok((density, unit.0, unit.1))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Optical depths by the laboratory's quadrature are those of the closed forms, and of the library's.
    #[test]
    fn depths_are_what_they_are_called() {
        for way in Way::all() {
            let line = way.line().unwrap();
            assert!((line.depth() / way.depth - 1.0).abs() < 1e-12, "{way:?}");
            let (medium, ray, part) = line.way();
            let by_library = medium.integrated_depth(ray, part)[0];
            // A cloud's is good to 1e-4 of its extent there.
            let bound = if way.profile == Profile::Cloud { 1e-3 } else { 1e-10 };
            assert!((by_library / way.depth - 1.0).abs() < bound, "{way:?}: {by_library}");
        }
        // mu = 4 x; ten times as dense over a fifth: 0.08 + 0.2; e^-3x.
        let ramp = Way { profile: Profile::Ramp, depth: 2.0 }.line().unwrap();
        assert!((ramp.extinction(0.3) - 1.2).abs() < 1e-12 && ramp.bounds() == (0.0, 4.0));
        let step = Way { profile: Profile::Step, depth: 2.0 }.line().unwrap();
        assert!((step.extinction(0.4) - 2.0 / 0.28).abs() < 1e-12);
        let fog = Way { profile: Profile::Fog, depth: 2.0 }.line().unwrap();
        assert!((fog.extinction(0.5) - 6.0 * libm::exp(-1.5) / -libm::expm1(-3.0)).abs() < 1e-9);
    }
}
