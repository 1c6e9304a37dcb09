//! False photons: a thin opaque sheet between two uniform isotropic fields of independent photons.

use crate::harness::{CellId, CellOutput, Group, Settings, Unit};
use crate::prediction::Prediction;
use crate::setups::Size;
use crate::theory::referee_kernel;
use glam::DVec3;
use turbid::estimators::boundary::{Boundary, Rejection, Treatment};
use turbid::estimators::{Estimator, Gather, Kernel, for_each_photon};
use turbid::geometry::{Cuboid, Rectangle, Shape};
use turbid::photons::synthetic::{Number, Profile, Synthetic};
use turbid::photons::{PhotonMap, Photons};
use turbid::stats::Moments;
use turbid_analytic::boundary as referee;

/// The group of its maps.
pub const GROUP: &str = "sheet";
/// Photons expected on the bright side, in a box of 1 x 1 x 1/2.
const PHOTONS: u64 = 16_000;
/// The field on the dark side where it is 1 on the bright one.
pub const DARK: f64 = 0.25;
/// The radius [box].
const RADIUS: f64 = 0.1;
/// Neighbours, and their largest radius [box].
const NEAREST: (usize, f64) = (30, 0.2);
/// Distances from the sheet over the radius.
pub const DISTANCES: [f64; 5] = [0.05, 0.25, 0.5, 0.75, 1.0];
/// Probes along a side, from the box's edges in.
const SIDE: usize = 5;

/// Which side of the sheet the probe is on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Side {
    /// Field 1, darkness leaks in.
    Bright,
    /// Field [`DARK`], light leaks in.
    Dark,
}

/// One question.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sheet {
    /// Which side.
    pub side: Side,
    /// Distance from the sheet over [`RADIUS`].
    pub distance: f64,
    /// Gather.
    pub size: Size,
    /// Kernel.
    pub kernel: Kernel,
    /// What is rejected.
    pub rejection: Rejection,
    /// Whether the estimate is clipped at the sheet.
    pub is_clipped: bool,
}

/// What the k nearest photons of any kind give that are then rejected: the radius is too small.
pub const LATE: &str = "sheet dark x=0.25 k=30 late";

impl Sheet {
    /// All of them: the four other kernels at one distance.
    pub fn all() -> Vec<Sheet> {
        let mut all = Vec::new();
        for side in [Side::Bright, Side::Dark] {
            for rejection in Rejection::ALL {
                for is_clipped in [false, true] {
                    for kernel in Kernel::ALL {
                        for distance in DISTANCES {
                            if kernel != Kernel::Uniform && distance != 0.25 {
                                continue;
                            }
                            for size in [Size::Radius(RADIUS), Size::Nearest(NEAREST.0)] {
                                all.push(Sheet { side, distance, size, kernel, rejection, is_clipped });
                            }
                        }
                    }
                }
            }
        }
        all
    }

    /// Its name.
    pub fn name(&self) -> String {
        format!(
            "sheet {} x={} {} {} {}{}",
            if self.side == Side::Bright { "bright" } else { "dark" },
            self.distance,
            self.size.name(),
            self.kernel.name(),
            self.rejection.name(),
            if self.is_clipped { " clipped" } else { "" }
        )
    }

    /// The field on the probe's side, and on the other.
    pub fn fields(&self) -> (f64, f64) {
        match self.side {
            Side::Bright => (1.0, DARK),
            Side::Dark => (DARK, 1.0),
        }
    }

    fn estimator(&self) -> turbid::Result<Estimator> {
        let gather = self.size.gather(NEAREST.1)?;
        let treatment = if self.is_clipped { Treatment::Clipped } else { Treatment::None };
        Ok(Estimator::new(self.kernel, gather).treated(treatment).rejecting(self.rejection))
    }

    /// The exact expectation and its bound, for fields of [`Sheet::fields`].
    pub fn exact(&self, settings: &Settings) -> anyhow::Result<(f64, f64)> {
        let (inside, outside) = self.fields();
        let rejection = match self.rejection {
            Rejection::Off => referee::Rejection::Off,
            Rejection::Facing => referee::Rejection::Facing,
            Rejection::FacingBehind => referee::Rejection::FacingBehind,
            Rejection::BehindPlane => referee::Rejection::BehindPlane,
            Rejection::Visible => referee::Rejection::Visible,
        };
        let (kernel, h) = (referee_kernel(self.kernel), self.distance * RADIUS);
        let mean = match self.size {
            Size::Radius(r) => {
                referee::false_photon_mean(rejection, self.is_clipped, kernel, r, h, inside, outside)?
            }
            Size::Nearest(k) => referee::nearest_false_photon_mean(
                rejection,
                self.is_clipped,
                kernel,
                u32::try_from(k)?,
                NEAREST.1,
                h,
                2.0 * bright(settings) as f64,
                inside,
                outside,
            )?,
        };
        Ok((mean.value, mean.error))
    }
}

/// Photons expected on the bright side.
fn bright(settings: &Settings) -> u64 {
    settings.photons(PHOTONS, PHOTONS)
}

/// The maps.
pub fn group(settings: &Settings) -> Group {
    let photons = bright(settings);
    Group::new(GROUP, settings.pick(128, 1024), 4.0 * photons as f64, measure).holding(photons)
}

/// The two halves of the box, bright above and dark below z = 0, as one map in units of the bright field.
fn map(settings: &Settings, cell: &CellId) -> anyhow::Result<PhotonMap> {
    let number = bright(settings);
    let half = |low: f64, high: f64, number: u64, part: u64| -> anyhow::Result<PhotonMap> {
        let corners = (DVec3::new(0.0, 0.0, low), DVec3::new(1.0, 1.0, high));
        let field = Synthetic::new(Profile::Constant, corners.0, corners.1)?;
        // The parts of one map draw from streams of their own.
        let replicate = cell.stream(if part == 0 { "boundary" } else { "boundary, dark side" });
        Ok(field.map(Number::Expected(number), settings.seed, replicate)?)
    };
    let above = half(0.0, 0.5, number, 0)?;
    let below = half(-0.5, 0.0, (number as f64 * DARK).round() as u64, 1)?;
    let photons: Photons = above.tree().photons().chain(below.tree().photons()).collect();
    // Density 1 on the bright side is `number` in half the unit cube.
    Ok(PhotonMap::new(photons, 2 * number)?)
}

/// Measures one map.
fn measure(settings: &Settings, cell: &CellId) -> anyhow::Result<CellOutput> {
    let map = map(settings, cell)?;
    let mut output = CellOutput::new();
    output.count("photons emitted", map.stored() as u64);
    let corner = DVec3::new(-9.0, -9.0, 0.0);
    let walls = [Shape::Rectangle(Rectangle::new(corner, DVec3::X * 20.0, DVec3::Y * 20.0)?)];
    for sheet in Sheet::all() {
        let medium = medium(sheet.side)?;
        let boundary = Boundary::of(&medium)?.with_walls(&walls);
        let estimator = sheet.estimator()?;
        let mut values = Moments::new();
        for probe in probes(sheet.side, sheet.distance) {
            let estimate = estimator.collision_density(&map, probe, &boundary);
            values.push(estimate.value[0]);
            output.count("photons rejected", estimate.rejected as u64);
            output.count("photons accepted", estimate.found as u64);
        }
        output.count("estimates", values.n());
        output.push(sheet.name(), "density", values.mean());
        if is_spread_case(&sheet) {
            output.push(sheet.name(), "variance", values.variance());
        }
    }
    let values = late(&map)?;
    output.push(LATE, "density", values.mean());
    output.push(LATE, "variance", values.variance());
    Ok(output)
}

/// The right rule that [`LATE`] is compared with.
pub fn is_spread_case(sheet: &Sheet) -> bool {
    sheet.side == Side::Dark
        && sheet.distance == 0.25
        && sheet.size == Size::Nearest(NEAREST.0)
        && sheet.kernel == Kernel::Uniform
        && sheet.rejection == Rejection::BehindPlane
        && sheet.is_clipped
}

/// The side of the probe as the medium.
fn medium(side: Side) -> turbid::Result<Shape> {
    let (low, high) = match side {
        Side::Bright => (0.0, 9.0),
        Side::Dark => (-9.0, 0.0),
    };
    Ok(Shape::Cuboid(Cuboid::new(DVec3::new(-9.0, -9.0, low), DVec3::new(9.0, 9.0, high))?))
}

/// A lattice at a distance from the sheet; nearest gathers do not reach the box's edges.
fn probes(side: Side, distance: f64) -> impl Iterator<Item = DVec3> {
    let z = distance * RADIUS * if side == Side::Bright { 1.0 } else { -1.0 };
    let at = |i: usize| NEAREST.1 + (1.0 - 2.0 * NEAREST.1) * i as f64 / (SIDE - 1) as f64;
    (0..SIDE * SIDE).map(move |i| DVec3::new(at(i % SIDE), at(i / SIDE), z))
}

/// Rejected after they have set the radius: what is left of the k-1 nearer photons, over the clipped ball.
fn late(map: &PhotonMap) -> anyhow::Result<Moments> {
    let gather = Gather::nearest(NEAREST.0, NEAREST.1)?;
    let medium = Shape::Cuboid(Cuboid::new(DVec3::new(-9.0, -9.0, -9.0), DVec3::new(9.0, 9.0, 0.0))?);
    let one = |probe: DVec3| {
        let mut sum = 0.0;
        let ball = for_each_photon(map, probe, Kernel::Uniform, gather, |photon, weight| {
            if photon.position.z <= 0.0 {
                sum += weight;
            }
        });
        let r = ball.radius;
        let inside = turbid::estimators::boundary::body_moments(Kernel::Uniform, &medium, probe, r)[0];
        sum / (r * r * r * inside * map.emitted() as f64)
    };
    Ok(probes(Side::Dark, 0.25).map(one).collect())
}

/// The predictions.
pub fn predict(settings: &Settings) -> anyhow::Result<Vec<Prediction>> {
    let mut predictions = Vec::new();
    for sheet in Sheet::all() {
        let source = "exact mean beside a sheet between two uniform fields";
        predictions.push(Prediction::new(sheet.name(), "density", Unit::ONE, sheet.exact(settings)?, source));
    }
    Ok(predictions)
}
