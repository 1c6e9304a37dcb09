//! The cases: which ray, which estimator.

use super::estimators::Estimator;
use super::line::Line;
use super::rays::{Profile, Way};
use super::series::Orders;
use crate::harness::Settings;

/// A way to estimate the transmittance of any line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Method {
    /// Delta tracking.
    Analogue,
    /// Ratio tracking.
    Ratio,
    /// Ratio tracking of what differs from the mean.
    ResidualMean,
    /// Ratio tracking of what is above the least.
    ResidualLeast,
    /// The renderer's ratio tracking between local bounds.
    Local,
    /// The power series about the optical depth.
    Series,
    /// Unbiased ray marching: combs over the length, with a look-up for each tentative collision of ratio tracking.
    Combs,
    /// Combs spread as the local bounds are, of two places more than the renderer's tracking has tentative collisions.
    LocalCombs,
    /// One comb of as many places, biased.
    Marched,
    /// A march of so many places at random, biased.
    March(u32),
    /// The same, less the bias of order 1/n.
    Jackknife(u32),
    /// A march and a difference of marches.
    Telescoped,
}

/// Places of marches on every ray.
pub const PLACES: u32 = 8;
/// Places of the first march of the telescoping sum.
const FIRST: u32 = 2;

/// Methods without bias, in the order of figures.
pub const UNBIASED: [Method; 9] = [
    Method::Analogue,
    Method::Ratio,
    Method::ResidualMean,
    Method::ResidualLeast,
    Method::Local,
    Method::Series,
    Method::Telescoped,
    Method::Combs,
    Method::LocalCombs,
];

impl Method {
    /// All that are asked of a ray.
    fn on_all() -> Vec<Method> {
        let biased = [Method::Marched, Method::March(PLACES), Method::Jackknife(PLACES)];
        UNBIASED.into_iter().chain(biased).collect()
    }

    /// The name in cases and claims.
    pub fn name(self) -> String {
        match self {
            Method::Analogue => "analogue".into(),
            Method::Ratio => "ratio".into(),
            Method::ResidualMean => "residual-mean".into(),
            Method::ResidualLeast => "residual-least".into(),
            Method::Local => "local".into(),
            Method::Series => "series".into(),
            Method::Combs => "combs".into(),
            Method::LocalCombs => "local-combs".into(),
            Method::Marched => "marched".into(),
            Method::March(n) => format!("march-{n}"),
            Method::Jackknife(n) => format!("jackknife-{n}"),
            Method::Telescoped => "telescoped".into(),
        }
    }

    /// What it is, for readers.
    pub fn title(self) -> String {
        match self {
            Method::Analogue => "delta tracking".into(),
            Method::Ratio => "ratio tracking".into(),
            Method::ResidualMean => "residual, mean as control".into(),
            Method::ResidualLeast => "residual, least as control".into(),
            Method::Local => "the renderer's: ratio, local bounds".into(),
            Method::Series => "power series, best pivot".into(),
            Method::Combs => "unbiased ray marching".into(),
            Method::LocalCombs => "unbiased ray marching, local bounds".into(),
            Method::Marched => "ray marching by a comb".into(),
            Method::March(n) => format!("march, {n} places at random"),
            Method::Jackknife(n) => format!("jackknife, {n} places at random"),
            Method::Telescoped => "telescoped marches".into(),
        }
    }

    /// Whether its squared error has a variance: what the telescoping sum divides by chances has none.
    pub fn has_known_spread(self) -> bool {
        self != Method::Telescoped
    }

    /// The estimator for a line.
    pub fn on(self, line: &Line) -> Estimator {
        let ((low, high), length) = (line.bounds(), line.length());
        // A look-up in the mean for each tentative collision of a tracking, one tooth at least.
        let teeth = |collisions: f64, combs: f64| (collisions / combs).round().max(1.0) as u32;
        let combs = 1.0 + Orders::Seldom.mean();
        match self {
            Method::Analogue => Estimator::Analogue,
            Method::Ratio => Estimator::Ratio,
            Method::ResidualMean => Estimator::Residual(line.depth() / length),
            Method::ResidualLeast => Estimator::Residual(low),
            Method::Local => Estimator::Local,
            Method::Series => Estimator::Series { orders: Orders::Geometric(0.7), pivot: line.depth() },
            Method::Combs => Method::combs(line, teeth(high * length, combs)),
            Method::LocalCombs => {
                let places = line.by_bounds();
                let teeth = places.total().ceil() as u32 + 2;
                Estimator::Comb { orders: Orders::Seldom, places, teeth }
            }
            Method::Marched => Estimator::Marched(line.even(), teeth(high * length, 1.0)),
            Method::March(n) => Estimator::March(n),
            Method::Jackknife(n) => Estimator::Jackknife(n),
            Method::Telescoped => Estimator::Telescoped(FIRST),
        }
    }

    /// Unbiased ray marching by combs of so many teeth over the length.
    pub fn combs(line: &Line, teeth: u32) -> Estimator {
        Estimator::Comb { orders: Orders::Seldom, places: line.even(), teeth }
    }
}

/// One question: a ray and a method.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Case {
    /// The ray.
    pub way: Way,
    /// The method.
    pub method: Method,
}

/// Places of the marches that the ramp is asked by.
pub const LADDER: [u32; 5] = [2, 4, 8, 16, 32];

/// The ray whose variances are closed forms: mu = 4 x.
pub const RAMP: Way = Way { profile: Profile::Ramp, depth: 2.0 };

impl Case {
    /// The cases of a ray.
    pub fn of(way: Way) -> Vec<Case> {
        let mut methods = Method::on_all();
        if way == RAMP {
            let others = LADDER.into_iter().filter(|n| *n != PLACES);
            methods.extend(others.flat_map(|n| [Method::March(n), Method::Jackknife(n)]));
        }
        // The renderer has the closed form of height fog, and draws nothing.
        methods.retain(|m| !(way.profile == Profile::Fog && *m == Method::Local));
        methods.into_iter().map(|method| Case { way, method }).collect()
    }

    /// Every case.
    pub fn all() -> Vec<Case> {
        Way::all().into_iter().flat_map(Case::of).collect()
    }

    /// The name in tables.
    pub fn name(&self) -> String {
        format!("{} {}", self.way.name(), self.method.name())
    }
}

/// Levels of the telescoping sum whose differences are measured.
pub const LEVELS: u32 = 6;

/// Name of the case of a level.
pub fn level_name(level: u32) -> String {
    format!("ramp-2 level={level}")
}

/// Cells a ray.
pub fn cells(settings: &Settings) -> u64 {
    settings.pick(128, 256)
}

/// Estimates of each case in a cell.
pub fn estimates(settings: &Settings) -> u64 {
    settings.photons(200, 400)
}
