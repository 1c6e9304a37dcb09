//! A sinusoidal pattern of independent photons: what is left of its contrast at each radius.

use crate::harness::{CellId, CellOutput, Group, Settings, Unit};
use crate::prediction::Prediction;
use crate::theory::referee_kernel;
use glam::DVec3;
use std::f64::consts::PI;
use turbid::estimators::boundary::Boundary;
use turbid::estimators::{Estimator, Gather, Kernel};
use turbid::photons::synthetic::{Number, Profile, Synthetic};
use turbid_analytic::blur::kernel_transfer;

/// The name of the group of cells.
pub const GROUP: &str = "sinusoid";
/// Radii of the gathers, the wavelength being 1.
pub const RADII: [f64; 14] = [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0, 1.1, 1.2, 1.3, 1.4];
/// Waves across the box.
const PERIODS: u32 = 8;
/// The box's sides across the waves.
const SIDE: f64 = 3.2;
/// Waves over which probes lie, as far from the ends as the largest radius.
const PROBED: u32 = 5;
/// Probes a wave.
const PHASES: u32 = 8;
/// Most rows of probes along each side.
const MAX_ROWS: usize = 3;

/// Photons a map, and maps.
fn size(settings: &Settings) -> (u64, u64) {
    let (photons, maps) = settings.pick((20_000, 128), (80_000, 512));
    (((f64::from(photons) * settings.photon_scale) as u64).max(1), maps)
}

/// The name of a case.
pub fn case(kernel: Kernel, radius: f64) -> String {
    format!("sinusoid r={radius} {}", kernel.name())
}

/// The quantity measured.
pub const QUANTITY: &str = "contrast left";

/// The radius as a phase: 2 pi radius over wavelength.
pub fn phase(radius: f64) -> f64 {
    2.0 * PI * radius
}

/// The maps.
pub fn group(settings: &Settings) -> Group {
    let (photons, maps) = size(settings);
    // A synthetic photon costs little, but each is gathered often.
    Group::new(GROUP, maps, 2.0 * photons as f64, measure)
}

/// Measures one map.
///
/// The contrast is the projection of the estimates on the wave: the other terms of their series vanish on even probes.
fn measure(settings: &Settings, cell: &CellId) -> anyhow::Result<CellOutput> {
    let (photons, _) = size(settings);
    let ends = DVec3::new(f64::from(PERIODS), SIDE, SIDE);
    let wave = Synthetic::new(Profile::Sinusoid { amplitude: 1.0, periods: PERIODS }, DVec3::ZERO, ends)?;
    let map = wave.map(Number::Exact(photons), settings.seed, cell.stream("blur"))?;
    let mean = 1.0 / (ends.x * ends.y * ends.z);
    let mut output = CellOutput::new();
    output.count("synthetic photons", photons);
    let first = 0.5 * f64::from(PERIODS - PROBED);
    for radius in RADII {
        let gather = Gather::radius(radius)?;
        let (rows, step) = rows(radius);
        let at = |i: usize| 0.5 * SIDE + step * (i as f64 - 0.5 * (rows as f64 - 1.0));
        for kernel in Kernel::ALL {
            let estimator = Estimator::new(kernel, gather);
            let (mut sum, mut probes) = (0.0, 0u64);
            for i in 0..PROBED * PHASES {
                let x = first + (f64::from(i) + 0.5) / f64::from(PHASES);
                let cosine = libm::cos(2.0 * PI * x);
                for j in 0..rows * rows {
                    let probe = DVec3::new(x, at(j % rows), at(j / rows));
                    let estimate = estimator.collision_density(&map, probe, &Boundary::UNKNOWN);
                    sum += estimate.value[0] * cosine;
                    probes += 1;
                }
            }
            output.count("estimates", probes);
            output.push(case(kernel, radius), QUANTITY, 2.0 * sum / (probes as f64 * mean));
        }
    }
    Ok(output)
}

/// Rows of probes along a side and their distance: balls stay in the box and overlap a little.
fn rows(radius: f64) -> (usize, f64) {
    let room = SIDE - 2.0 * radius;
    let rows = ((room / (1.5 * radius)) as usize + 1).min(MAX_ROWS);
    (rows, if rows > 1 { room / (rows as f64 - 1.0) } else { 0.0 })
}

/// What theory says.
pub fn predict() -> anyhow::Result<Vec<Prediction>> {
    let mut predictions = Vec::new();
    for kernel in Kernel::ALL {
        for radius in RADII {
            let transfer = kernel_transfer(referee_kernel(kernel), phase(radius))?;
            let (value, source) =
                ((transfer.value, transfer.error), "cosine transform of the kernel's marginal");
            predictions.push(Prediction::new(case(kernel, radius), QUANTITY, Unit::ONE, value, source));
        }
    }
    Ok(predictions)
}
