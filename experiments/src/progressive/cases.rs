//! The cases: who asks, by which schedule, after how many maps.

use crate::harness::Settings;
use crate::setups::CELL;
use crate::setups::uncollided::{Case, DEPTH, Query};
use glam::DVec3;
use turbid::estimators::Codimension;
use turbid::math::Ray;

/// Who asks, by the powers of the radius 3, 2, 1.
pub const QUERIES: [Query; 3] = [Query::Places, Query::Rays, Query::Beams];

/// Runs of a whole sequence of maps.
pub const CELLS: u64 = 256;

/// Rays of a map.
const RAYS: usize = 8;

/// How radii go from map to map.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Schedule {
    /// As the codimension of the question asks.
    Own,
    /// As for balls, whoever asks: the root of a fault that shipped.
    Balls,
    /// They stay as the first one.
    Constant,
    /// They are the one that is best for all photons of the sequence together.
    Oracle,
}

impl Schedule {
    /// All of them.
    pub const ALL: [Schedule; 4] = [Schedule::Own, Schedule::Balls, Schedule::Constant, Schedule::Oracle];

    /// Its name in cases.
    pub fn name(self) -> &'static str {
        match self {
            Schedule::Own => "own",
            Schedule::Balls => "balls",
            Schedule::Constant => "constant",
            Schedule::Oracle => "oracle",
        }
    }

    /// Its title in figures.
    pub fn title(self) -> &'static str {
        match self {
            Schedule::Own => "shrinks by its own power",
            Schedule::Balls => "shrinks as balls do",
            Schedule::Constant => "stays",
            Schedule::Oracle => "best for all photons",
        }
    }
}

/// The rays at the depth, once round the cell.
pub fn rays() -> impl Iterator<Item = Ray> {
    (0..RAYS).map(|i| Ray::new(DVec3::new((i as f64 + 0.5) * CELL / RAYS as f64, 0.0, DEPTH), DVec3::Y))
}

/// Photons of each map.
pub fn photons(settings: &Settings) -> u64 {
    // Below that, radii would leave the slab.
    settings.photons(1000, 1000).max(250)
}

/// Maps of a sequence.
pub fn maps(settings: &Settings) -> u64 {
    settings.pick(64, 256)
}

/// Numbers of maps after which the mean is looked at.
pub fn stops(settings: &Settings) -> Vec<u64> {
    (0..=maps(settings).ilog2()).map(|power| 1 << power).collect()
}

/// The codimension of the simulator's schedule.
pub fn codimension(query: Query) -> Codimension {
    match query.codimension() {
        1.0 => Codimension::One,
        2.0 => Codimension::Two,
        _ => Codimension::Three,
    }
}

/// Radii of all maps by a schedule [mfp]. Those of the schedules that are judged are the simulator's.
pub fn radii(query: Query, schedule: Schedule, maps: u64, first: f64, oracle: f64) -> Vec<f64> {
    let radius = |map: u64| match schedule {
        Schedule::Own => first * codimension(query).shrinkage(map),
        // The root alone is that of balls, as it shipped.
        Schedule::Balls => first * libm::pow(codimension(query).shrinkage(map), query.codimension() / 3.0),
        Schedule::Constant => first,
        Schedule::Oracle => oracle,
    };
    (0..maps).map(radius).collect()
}

/// The schedules of a question: balls shrink as balls do.
pub fn schedules(query: Query) -> impl Iterator<Item = Schedule> {
    Schedule::ALL.into_iter().filter(move |s| !(query == Query::Places && *s == Schedule::Balls))
}

/// The first radius and the fixed one that are best at the last map where they are small: the squared blur A^2 r^4 and the variance B/r^c
/// of a map, with means of the schedule's squares and inverse powers [mfp].
pub fn best(settings: &Settings, query: Query) -> anyhow::Result<(f64, f64)> {
    let (maps, c, small) = (maps(settings), query.codimension(), 1e-3);
    let Case { blur, variance, .. } = Case::new(query, photons(settings), small)?;
    let (a, b) = (blur / (small * small), variance * libm::pow(small, c));
    let shrinkage = || (0..maps).map(|map| codimension(query).shrinkage(map));
    let squares = shrinkage().map(|s| s * s).sum::<f64>() / maps as f64;
    let inverse = shrinkage().map(|s| libm::pow(s, -c)).sum::<f64>() / maps as f64;
    let least = |squares: f64, inverse: f64| {
        libm::pow(c * b * inverse / (4.0 * a * a * squares * squares * maps as f64), 1.0 / (c + 4.0))
    };
    Ok((least(squares, inverse), least(1.0, 1.0)))
}

/// The name of a case in tables.
pub fn name(query: Query, schedule: Schedule, maps: u64) -> String {
    format!("{} {} maps={maps}", query.name(), schedule.name())
}
