//! The picture: the furnace sphere in section, every place of it.

use super::cases::MAIN;
use super::fields::FURNACE_SPHERE;
use crate::harness::{CellId, CellOutput, Group, Settings};
use glam::{DVec3, Vec3Swizzles};
use turbid::Spectrum;
use turbid::estimators::boundary::{Boundary, Treatment};
use turbid::estimators::{Estimator, Gather, Kernel};
use turbid::stats::Moments;

/// The group of its maps.
pub const GROUP: &str = "section";
/// Cells of the picture along the radius of the sphere.
pub const ALONG: usize = 16;
/// Width of a cell [mfp].
pub const WIDTH: f64 = 0.125;
/// Radius of the sphere [mfp].
pub const RADIUS: f64 = WIDTH * ALONG as f64;
/// Emitted photons a map.
const PHOTONS: u64 = 20_000;

/// The maps.
pub fn group(settings: &Settings) -> Group {
    let photons = settings.photons(PHOTONS, PHOTONS);
    Group::new(GROUP, settings.pick(64, 512), 6.0 * photons as f64, measure).holding(photons)
}

/// The places of one quadrant that are in the sphere: column, row and distance from the centre.
pub fn places() -> impl Iterator<Item = (usize, usize, f64)> {
    (0..ALONG * ALONG).filter_map(|index| {
        let (column, row) = (index % ALONG, index / ALONG);
        let middle = |i: usize| WIDTH * (i as f64 + 0.5);
        let distance = libm::hypot(middle(column), middle(row));
        (distance <= RADIUS).then_some((column, row, distance))
    })
}

/// The case of a place.
pub fn case(treatment: Treatment, column: usize, row: usize) -> String {
    format!("section {} {column} {row}", treatment.name())
}

/// Measures one map: at each place the four mirrored ones are averaged, in two planes.
fn measure(settings: &Settings, cell: &CellId) -> anyhow::Result<CellOutput> {
    let field = &FURNACE_SPHERE;
    let photons = settings.photons(PHOTONS, PHOTONS);
    let map = field.map(settings, cell, photons)?;
    let mut output = CellOutput::new();
    output.count("photons emitted", photons);
    output.count("photons stored", map.stored() as u64);
    let medium = field.setup.body.shape()?;
    let boundary = Boundary::of(&medium)?;
    let untreated = Estimator::new(Kernel::Uniform, Gather::radius(MAIN.0)?);
    for treatment in Treatment::ALL {
        let estimator = untreated.treated(treatment);
        for (column, row, distance) in places() {
            let along = DVec3::new(column as f64 + 0.5, 0.0, row as f64 + 0.5).normalize() * distance;
            let mut values = Moments::new();
            for (x, z) in [(1.0, 1.0), (-1.0, 1.0), (1.0, -1.0), (-1.0, -1.0)] {
                let probe = along * DVec3::new(x, 1.0, z);
                for probe in [probe, probe.zxy()] {
                    values.push(estimator.fluence(&map, probe, Spectrum::ONE, &boundary).value[0]);
                }
            }
            output.count("estimates", values.n());
            output.push(case(treatment, column, row), "fluence", values.mean());
        }
    }
    Ok(output)
}
