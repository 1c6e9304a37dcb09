//! The cases: with which gather and kernel the edges of each map are probed, and where.

use super::shaft::{CAP, DEPTH, LENGTH, WIDTH, density};
use crate::harness::Parameters;
use crate::setups::Size;
use glam::DVec3;
use std::f64::consts::PI;
use turbid::estimators::{Estimator, Gather, Kernel};

/// One profile across the edges of a map.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Case {
    /// Photons emitted into the map.
    pub photons: u64,
    /// Gather size: a radius is that of the uniform kernel of the same standard deviation, if `is_deviation`.
    pub size: Size,
    /// Whether kernels are compared at equal standard deviation, and not at equal radius.
    pub is_deviation: bool,
    /// Kernel.
    pub kernel: Kernel,
}

/// Radii of the uniform kernel [mfp].
pub const RADII: [f64; 3] = [0.1, 0.2, 0.4];
/// The radius at which all kernels are compared [mfp].
pub const KERNELS_AT: f64 = 0.2;
/// Sizes of nearest gathers.
pub const NEIGHBORS: [usize; 4] = [20, 50, 100, 500];
/// The k at which all kernels are compared.
pub const KERNELS_K: usize = 100;
/// Largest plateau radius over the cap: beyond, too much of the profile is the cap's and not the k-th photon's.
const LARGEST: f64 = 0.5;
/// Most places along the edge.
const MAX_ALONG: usize = 24;

impl Case {
    /// Everything that maps of one number of photons are asked: all of it in the largest maps, the uniform kernel in
    /// the others.
    pub fn all(photons: u64, is_largest: bool) -> Vec<Case> {
        let mut cases = Vec::new();
        let mut add = |size, is_deviation, kernel| {
            let case = Case { photons, size, is_deviation, kernel };
            if case.scale() <= LARGEST * CAP {
                cases.push(case);
            }
        };
        for radius in RADII {
            add(Size::Radius(radius), false, Kernel::Uniform);
        }
        for k in NEIGHBORS {
            add(Size::Nearest(k), false, Kernel::Uniform);
        }
        if is_largest {
            for kernel in Kernel::ALL.into_iter().filter(|&k| k != Kernel::Uniform) {
                add(Size::Radius(KERNELS_AT), false, kernel);
                add(Size::Radius(KERNELS_AT), true, kernel);
                add(Size::Nearest(KERNELS_K), false, kernel);
            }
        }
        cases
    }

    /// The group of cells that answer it.
    pub fn group(photons: u64) -> String {
        format!("shaft-n{photons}")
    }

    /// What it asks, as columns of the results.
    pub fn parameters(&self) -> Parameters {
        Parameters {
            field: Some("shaft"),
            photons: Some(self.photons),
            radius: matches!(self.size, Size::Radius(_)).then(|| self.scale()),
            kernel: Some(self.kernel),
            ..self.size.parameters()
        }
    }

    /// The name in tables.
    pub fn name(&self) -> String {
        format!("shaft n={} {} {}", self.photons, self.gather_name(), self.kernel.name())
    }

    /// The gather in words.
    pub fn gather_name(&self) -> String {
        format!("{}{}", if self.is_deviation { "deviation of " } else { "" }, self.size.name())
    }

    /// The radius, or that of the ball that holds k photons far inside on average [mfp].
    pub fn scale(&self) -> f64 {
        match self.size {
            Size::Radius(r) if !self.is_deviation => r,
            Size::Radius(r) => r * (Kernel::Uniform.m2() / self.kernel.m2()).sqrt(),
            Size::Nearest(k) => libm::cbrt(3.0 * k as f64 / (4.0 * PI * density(self.photons))),
        }
    }

    /// What is asked.
    pub fn estimator(&self) -> turbid::Result<Estimator> {
        let gather = match self.size {
            Size::Nearest(k) => Gather::nearest(k, CAP),
            Size::Radius(_) => Gather::radius(self.scale()),
        };
        Ok(Estimator::new(self.kernel, gather?))
    }

    /// Distances of the probes inside the edge over the scale, negative outside, rising. Fixed radii see nothing
    /// beyond -1.
    pub fn places(&self) -> Vec<f64> {
        if self.size.is_nearest() {
            (-13..=10).map(|i| 0.15 * f64::from(i)).collect()
        } else {
            (-9..=11).map(|i| 0.1 * f64::from(i)).collect()
        }
    }

    /// The quantity of one place of the profile.
    pub fn quantity(place: f64) -> String {
        format!("profile at {place:.2}")
    }

    /// Probes at one place, along both edges.
    pub fn probes(&self, place: f64) -> impl Iterator<Item = DVec3> {
        let inside = place * self.scale();
        let along = self.along();
        let margin = self.reach();
        let step = (LENGTH - 2.0 * margin) / along as f64;
        (0..2 * along).map(move |i| {
            let x = if i < along { inside } else { WIDTH - inside };
            DVec3::new(x, margin + (0.5 + (i % along) as f64) * step, DEPTH)
        })
    }

    /// Probes along one edge: balls of the plateau overlap a little.
    pub fn along(&self) -> usize {
        let room = (LENGTH - 2.0 * self.reach()) / (1.5 * self.scale());
        (room as usize).clamp(1, MAX_ALONG)
    }

    /// Farthest that a photon is taken from [mfp].
    pub fn reach(&self) -> f64 {
        if self.size.is_nearest() { CAP } else { self.scale() }
    }
}

#[cfg(test)]
mod tests {
    use super::super::shaft::THICKNESS;
    use super::*;

    /// No ball of any probe touches the lit face, the far one, another edge or an end of the shaft.
    #[test]
    fn balls_meet_their_own_edge_only() {
        let room = 1e-9;
        for photons in [2_000, 16_000, 64_000, 512_000] {
            let cases = Case::all(photons, true);
            assert!(cases.len() > 10, "{photons}: {}", cases.len());
            for case in cases {
                let reach = case.reach();
                assert!(reach < DEPTH && DEPTH + reach < THICKNESS, "{}", case.name());
                for place in case.places() {
                    let inside = place * case.scale();
                    assert!(inside + reach <= WIDTH + room, "{} {place}", case.name());
                    for probe in case.probes(place) {
                        let is_first = (probe.x - inside).abs() < room;
                        assert!(
                            is_first || (WIDTH - probe.x - inside).abs() < room,
                            "{} {place}",
                            case.name()
                        );
                        assert!(
                            probe.y >= reach - room && probe.y + reach <= LENGTH + room,
                            "{}",
                            case.name()
                        );
                    }
                }
            }
        }
    }

    /// Kernels at equal deviation have the uniform one's.
    #[test]
    fn deviations_are_equal() {
        for kernel in Kernel::ALL {
            let case = Case { photons: 1, size: Size::Radius(0.2), is_deviation: true, kernel };
            let deviation = case.scale() * (kernel.m2() / 3.0).sqrt();
            assert!((deviation - 0.2 / 5.0f64.sqrt()).abs() < 1e-15, "{kernel:?} {deviation}");
        }
    }
}
