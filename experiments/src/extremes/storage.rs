//! Storage: one set of photons asked twice, by the tree in single precision and by a plain search in double precision.
//!
//! A ball of fog that absorbs nothing, lit alike from all sides: fluence 4 everywhere inside. One photon more, far away
//! along x, stands for the rest of a large scene: the tree's unit follows it. The extent is 1.5 x 2^m mean free paths,
//! half of which is three quarters of the unit u = 2^m, so that the ball lies between u/2 and u from the middle of the
//! map, where stored coordinates are h = 2^-24 u apart.

use super::plain::Plain;
use super::scenes::furnace_ball;
use crate::harness::{CellId, CellOutput, Group, Settings};
use glam::{DVec3, Vec3};
use turbid::estimators::boundary::Boundary;
use turbid::estimators::{Estimate, Estimator, Gather, Kernel};
use turbid::math::evenly_in_cube;
use turbid::photons::{Histories, Photon, PhotonMap, shoot};
use turbid::transport::NoProgress;

/// The group of cells.
pub const GROUP: &str = "storage";
/// Radius of the fixed gather [mfp].
pub const RADIUS: f64 = 0.25;
/// Neighbours of the nearest gather.
pub const K: usize = 50;
/// Farthest photon of the nearest gather [mfp].
pub const CAP: f64 = 0.35;
/// The fluence inside.
pub const FLUENCE: f64 = 4.0;
/// Powers of two of the extents.
pub const POWERS: [i32; 13] = [1, 3, 5, 7, 9, 11, 13, 15, 17, 18, 19, 20, 21];
/// Probes of a map, and the ball they fill [mfp]: with the radius and a step of the lattice they stay in the fog.
const PROBES: usize = 160;
const PROBED: f64 = 0.6;

/// How photons are gathered.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Rule {
    /// Within [`RADIUS`].
    Fixed,
    /// The [`K`] nearest.
    Nearest,
}

impl Rule {
    /// Both.
    pub const ALL: [Rule; 2] = [Rule::Fixed, Rule::Nearest];

    /// In words.
    pub fn name(self) -> String {
        match self {
            Rule::Fixed => format!("r={RADIUS}"),
            Rule::Nearest => format!("k={K}"),
        }
    }

    fn gather(self) -> turbid::Result<Gather> {
        match self {
            Rule::Fixed => Gather::radius(RADIUS),
            Rule::Nearest => Gather::nearest(K, CAP),
        }
    }
}

/// Extent of the map along x [mfp].
pub fn extent(power: i32) -> f64 {
    libm::ldexp(1.5, power)
}

/// Distance between stored coordinates at the ball [mfp].
pub fn spacing(power: i32) -> f64 {
    libm::ldexp(1.0, power - 24)
}

/// Photons emitted a map.
pub fn photons(settings: &Settings) -> u64 {
    settings.photons(12_000, 12_000)
}

/// The name of a rule at an extent.
pub fn case(rule: Rule, power: i32) -> String {
    format!("furnace {} extent=1.5x2^{power}", rule.name())
}

/// The name of a rule in double precision.
pub fn case_double(rule: Rule) -> String {
    format!("furnace {} double", rule.name())
}

/// The maps.
pub fn group(settings: &Settings) -> Group {
    let cost = photons(settings) as f64 * 40.0;
    Group::new(GROUP, settings.pick(176, 512), cost, measure)
}

/// Points that fill a ball evenly.
pub fn probes() -> Vec<DVec3> {
    (1u32..)
        .map(|i| DVec3::from_array(evenly_in_cube(i).map(|x| PROBED * (2.0 * x - 1.0))))
        .filter(|p| p.length() <= PROBED)
        .take(PROBES)
        .collect()
}

/// What one probe says by both searches, over the exact fluence.
struct Pair {
    single: f64,
    double: f64,
    /// Photons in one ball and not in the other, at least.
    moved: u64,
}

/// Measures one map.
fn measure(settings: &Settings, cell: &CellId) -> anyhow::Result<CellOutput> {
    let scene = furnace_ball(DVec3::ZERO, 0.0)?;
    let replicate = cell.stream("extremes");
    let histories = Histories { count: photons(settings), seed: settings.seed, replicate, max_order: None };
    let pass = shoot(&scene, histories, &[], |_| true, &NoProgress)?;
    let mut output = CellOutput::new();
    output.count("photons emitted", pass.emitted());
    output.count("collisions", pass.report.collisions);
    let stored = pass.photons().collect::<Vec<_>>();
    let plain = Plain::new(&stored, pass.emitted());
    let probes = probes();
    let mut exact: Vec<Vec<(f64, usize)>> = Vec::new();
    for rule in Rule::ALL {
        let answers: Vec<(f64, usize)> = probes
            .iter()
            .map(|&p| match rule {
                Rule::Fixed => plain.within(p, RADIUS),
                Rule::Nearest => (plain.nearest(p, K, CAP).0, K),
            })
            .collect();
        let errors = || answers.iter().map(|(value, _)| value / FLUENCE - 1.0);
        output.push(case_double(rule), "error", mean(errors()));
        output.push(case_double(rule), "squared error", mean(errors().map(|e| e * e)));
        exact.push(answers);
    }
    for power in POWERS {
        let mut photons = stored.clone();
        let far = DVec3::X * extent(power);
        photons.push(Photon { position: far, ..photons.first().copied().unwrap_or(NOBODY) });
        // The second channel tells photons apart; nobody gathers it.
        for (index, photon) in photons.iter_mut().enumerate() {
            photon.power.y = index as f32;
        }
        let map = PhotonMap::new(photons.clone(), pass.emitted())?;
        let resolution = map.tree().resolution();
        let worst = map
            .tree()
            .photons()
            .map(|stored| (stored.position - photons[stored.power.y as usize].position).abs().max_element());
        output.push(
            case(Rule::Fixed, power),
            "rounding over resolution",
            worst.fold(0.0, f64::max) / resolution,
        );
        for (rule, answers) in Rule::ALL.into_iter().zip(&exact) {
            let estimator = Estimator::new(Kernel::Uniform, rule.gather()?);
            let pairs: Vec<Pair> = probes
                .iter()
                .zip(answers)
                .map(|(&p, &(double, found))| {
                    let estimate = estimator.collision_density(&map, p, &Boundary::UNKNOWN);
                    pair(rule, estimate, double, found)
                })
                .collect();
            output.count("estimates", pairs.len() as u64);
            let name = case(rule, power);
            output.push(&name, "error", mean(pairs.iter().map(|p| p.single - 1.0)));
            output.push(&name, "difference", mean(pairs.iter().map(|p| p.single - p.double)));
            let squared = pairs.iter().map(|p| (p.single - p.double) * (p.single - p.double));
            output.push(&name, "squared difference", mean(squared));
            output.push(&name, "photons moved", pairs.iter().map(|p| p.moved).sum::<u64>() as f64);
        }
    }
    Ok(output)
}

/// Stands where a map has no photon to copy.
const NOBODY: Photon = Photon {
    position: DVec3::ZERO,
    dir: Vec3::Z,
    normal: Vec3::ZERO,
    power: Vec3::ONE,
    order: 0,
    flags: turbid::photons::Flags::NONE,
};

fn pair(rule: Rule, estimate: Estimate, double: f64, found: usize) -> Pair {
    let moved = match rule {
        Rule::Fixed => estimate.found.abs_diff(found) as u64,
        Rule::Nearest => 0,
    };
    Pair { single: estimate.value[0] / FLUENCE, double: double / FLUENCE, moved }
}

fn mean(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, n) = values.fold((0.0, 0u32), |(sum, n), v| (sum + v, n + 1));
    sum / f64::from(n.max(1))
}
