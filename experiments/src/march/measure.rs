//! Measuring one map.

use super::cases::{ALBEDO, Case, REACH, SETUP, TAU, maps, photons};
use crate::harness::{CellId, CellOutput, Group, Settings};
use glam::DVec3;
use turbid::Spectrum;
use turbid::estimators::boundary::Boundary;
use turbid::integrators::{March, along};
use turbid::math::{Interval, Positive};
use turbid::photons::{Histories, is_in, shoot};
use turbid::rng::{Purpose, Stream};
use turbid::scene::Orders;
use turbid::stats::Moments;
use turbid::transport::NoProgress;

/// The group of all cells.
pub const GROUP: &str = "slab";

/// All cells.
pub fn groups(settings: &Settings) -> Vec<Group> {
    // A history has some three collisions; the rays of a map cost as much as its photons.
    let photons = photons(settings);
    vec![Group::new(GROUP, maps(settings), 8.0 * photons as f64, measure).holding(photons)]
}

/// Measures one cell.
fn measure(settings: &Settings, cell: &CellId) -> anyhow::Result<CellOutput> {
    let scene = SETUP.scene()?;
    let medium = &scene.regions()[0].medium;
    let (phase, albedo) = (medium.phase(), Spectrum::grey(ALBEDO));
    let histories = Histories {
        count: photons(settings),
        seed: settings.seed,
        replicate: cell.stream("march"),
        max_order: None,
    };
    let pass = shoot(&scene, histories, &[], is_in(Orders::ALL), &NoProgress)?;
    let mut output = CellOutput::new();
    output.count("photons emitted", pass.emitted());
    let map = pass.into_map(REACH)?;
    for case in Case::all() {
        let estimator = case.estimator()?;
        let equal = March::equal(Positive::new("the step", case.step)?, case.rule);
        let span = Interval { start: 0.0, end: case.length() };
        let mut values = Moments::new();
        for ray in case.rays() {
            let source = |place: DVec3| {
                let (wo, one) = (-ray.dir, Spectrum::ONE);
                albedo * estimator.in_scattered(&map, place, wo, phase, one, &Boundary::UNKNOWN).value
            };
            // Nothing is drawn.
            let mut stream = Stream::new(settings.seed, Purpose::Synthetic, 0, 0);
            let radiance = along(medium, (&ray, span), &equal, TAU, &mut stream, source);
            values.push(radiance[0]);
            output.count("steps", (case.length() / case.step).round() as u64);
        }
        output.push(case.name(), "radiance", values.mean());
    }
    Ok(output)
}
