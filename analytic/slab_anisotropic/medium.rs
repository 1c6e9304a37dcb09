//! What belongs to a medium and not to a slab of it: its modes on two sets of nodes, order by order of azimuth.

use super::modes::Modes;
use super::nodes::{Nodes, peaked};
use super::scattering::Scattering;
use crate::error::{Result, within};
use crate::incidence::check_albedo;
use crate::phase::Phase;
use std::ops::RangeInclusive;
use std::sync::{Arc, OnceLock};

pub(super) const METHOD: &str = "discrete ordinates, two node counts";

/// What the first Legendre moment left out may be in the finer and in the coarser solution. Its effect on a flux is
/// smaller by four orders (measured at g = 0.8 to 0.9 against 100-bit adding and doubling).
const CUT: [f64; 2] = [1e-11, 1e-8];

/// Nodes towards the horizon, the fewest and the most above it.
const LOWER: [usize; 2] = [60, 50];
const UPPER: [usize; 2] = [32, 26];
const MOST: [usize; 2] = [430, 370];
/// Where more nodes would be needed, they are made tighter at the zenith.
const PLAIN: usize = 128;

/// Radiances scattered three times and more: a moment left out of order m of azimuth is met by the square of chi_m at
/// least, and their product may be this.
const RAY: [f64; 2] = [1e-10, 1e-9];
const LOWER_RAY: [usize; 2] = [40, 34];
const UPPER_RAY: [usize; 2] = [32, 26];
const MOST_RAY: [usize; 2] = [116, 104];
/// The most where the peak is cut off, and how much looser the rules are; the same where what is cut off is slight.
const MOST_CUT: [usize; 2] = [72, 62];
const LOOSE: f64 = 1e4;
const MOST_SLIGHT: [usize; 2] = [112, 98];
const LOOSE_SLIGHT: f64 = 1e2;
const SLIGHT: f64 = 1e-4;
/// Numbers of nodes go in steps, so that many orders share theirs.
const STEP: usize = 8;

/// What the second power of a moment left out of light scattered twice may be; lists of more moments are too slow.
const TWICE: [f64; 2] = [1e-13, 1e-10];
const LONG: usize = 150;

/// What terms of the series in azimuth may be where it ends.
const SMALL: f64 = 1e-11;

const TAIL: &str = "at most 0.1, and hardly changing there";

/// A medium whose modes are solved once, for any number of slabs. Cloning shares them.
#[derive(Clone)]
pub struct AnisotropicMedium(Arc<Medium>);

struct Medium {
    albedo: f64,
    phase: Phase,
    sets: [Set; 2],
    azimuth: OnceLock<Azimuth>,
}

/// Two sets of nodes for every order of azimuth, for light scattered three times and more.
pub(super) struct Azimuth {
    orders: [Vec<Set>; 2],
    /// Rules for light scattered twice, of which every moment counts; none for long lists of moments.
    pub twice: Option<[Twice; 2]>,
    /// A term of the series below this, relative to the sum, is as good as none.
    pub small: f64,
}

/// A rule over all directions.
pub(super) struct Twice {
    pub nodes: Nodes,
    pub turns: usize,
}

/// One set of nodes.
struct Set {
    /// Nodes above the crowded ones.
    upper: usize,
    /// The first order of azimuth.
    first: usize,
    scattering: Arc<Scattering>,
    nodes: Arc<Nodes>,
    /// Modes by order of azimuth, solved when first asked for.
    modes: Vec<OnceLock<Result<Arc<Modes>>>>,
}

impl AnisotropicMedium {
    /// Solves for the modes of the azimuthal mean; the others follow when a radiance is asked for.
    ///
    /// # Arguments
    /// `albedo` 0 to 1; `phase` any whose moments, or their differences from a constant, have died away at
    /// l = 1100: Henyey-Greenstein from -0.95 to 0.99
    /// # Errors
    /// `Error::OutOfRange` naming `albedo` or `phase function`
    pub fn new(albedo: f64, phase: &Phase) -> Result<Self> {
        let set = |i: usize| {
            let degree = phase.degree(CUT[i], usize::MAX);
            let plain = 2 + degree.div_ceil(2);
            let nodes = if plain <= PLAIN {
                Nodes::new(plain.max(UPPER[i]), LOWER[i])
            } else {
                Nodes::peaked(peaked(degree).min(MOST[i]), LOWER[i])
            };
            (Scattering::new(albedo, phase, nodes.degree, degree > nodes.degree), nodes)
        };
        check_albedo(albedo)?;
        let last = Nodes::peaked(MOST[1], LOWER[1]).degree + 1;
        let (value, least) = (last..last + 8).fold((0.0, 1.0), |(most, least): (f64, f64), l| {
            (most.max(phase.moment(l)), least.min(phase.moment(l)))
        });
        // A peak that is cut off as straight on must be of light straight on.
        within(
            "largest Legendre moment beyond l = 1144",
            value,
            f64::MIN,
            0.1f64.min(1.25 * least + 2e-5),
            TAIL,
        )?;
        Self::of(albedo, phase, [set(0), set(1)])
    }

    /// The same on a plain Gauss rule on each hemisphere, as few as is wanted: for comparison with other programs.
    ///
    /// # Arguments
    /// `streams` on both hemispheres together, even, 8 to 256; bounds come from three quarters as many. Radiances
    /// have nodes of their own in any case
    /// # Errors
    /// `Error::OutOfRange` naming `albedo` or `streams`
    pub fn with_streams(albedo: f64, phase: &Phase, streams: usize) -> Result<Self> {
        check_albedo(albedo)?;
        let half = (streams / 2) as f64;
        within("streams", streams as f64, (2.0 * half).max(8.0), 256.0, "even, 8 to 256")?;
        let set = |half: usize| {
            let nodes = Nodes::double_gauss(half);
            (Scattering::new(albedo, phase, nodes.degree, true), nodes)
        };
        Self::of(albedo, phase, [set(streams / 2), set(3 * streams / 8)])
    }

    fn of(albedo: f64, phase: &Phase, sets: [(Scattering, Nodes); 2]) -> Result<Self> {
        let sets = sets.map(|(scattering, nodes)| {
            let last = scattering.degree();
            Set::new((scattering, nodes), 0, 0..=last)
        });
        let azimuth = OnceLock::new();
        let medium = AnisotropicMedium(Arc::new(Medium { albedo, phase: phase.clone(), sets, azimuth }));
        medium.modes(0, 0)?;
        medium.modes(1, 0)?;
        Ok(medium)
    }

    /// Single-scattering albedo \[1\].
    pub fn albedo(&self) -> f64 {
        self.0.albedo
    }

    /// How it scatters.
    pub fn phase(&self) -> &Phase {
        &self.0.phase
    }

    /// The modes of an order of azimuth, at most the degree of the moments in use, on set 0 (the finer) or 1.
    pub(crate) fn modes(&self, set: usize, order: usize) -> Result<Arc<Modes>> {
        self.0.sets[set].modes(order)
    }

    /// What radiances by azimuth need.
    pub(super) fn azimuth(&self) -> &Azimuth {
        self.0.azimuth.get_or_init(|| {
            let phase = &self.0.phase;
            let degree = |cut: f64| phase.degree(cut, usize::MAX);
            let beyond = 2 * MOST_RAY[1];
            let capped = degree(RAY[0]) > 2 * MOST_RAY[0] - 2;
            // Cut off what is a peak straight on; a peak backwards has moments of both signs.
            let cut = capped && (beyond..beyond + 8).all(|l| phase.moment(l) >= 0.0);
            // What is beyond the most that a slow peak is given.
            let left = phase.moment(2 * MOST_SLIGHT[0] - 1).abs();
            let (loose, most) = match (capped, cut) {
                (false, _) => (1.0, MOST_RAY),
                (true, false) => (LOOSE_SLIGHT, MOST_RAY),
                (true, true) if left <= SLIGHT => (LOOSE_SLIGHT, MOST_SLIGHT),
                (true, true) => (LOOSE, MOST_CUT),
            };
            let orders = [0, 1].map(|i| {
                let last = degree(RAY[i]).min(2 * most[i] - 2);
                let mut row: Vec<Set> = Vec::with_capacity(last + 1);
                let mut largest = 0.0_f64;
                let mut envelope: Vec<f64> = (0..=last)
                    .rev()
                    .map(|m| {
                        largest = largest.max(phase.moment(m).abs());
                        largest
                    })
                    .collect();
                envelope.reverse();
                for (m, chi) in envelope.into_iter().enumerate() {
                    let needed = degree(loose * RAY[i] / (chi * chi)).max(m);
                    let upper = (2 + needed.div_ceil(2)).next_multiple_of(STEP);
                    let upper = upper.clamp(UPPER_RAY[i], most[i]);
                    let set = match row.last().filter(|set| set.upper == upper) {
                        Some(set) => set.sharing(m),
                        None => {
                            let nodes = Nodes::new(upper, LOWER_RAY[i]);
                            // All orders lose the same peak.
                            let scattering = Scattering::new(self.0.albedo, phase, last, cut);
                            Set::new((scattering.up_to(nodes.degree), nodes), upper, m..=m)
                        }
                    };
                    row.push(set);
                }
                row
            });
            let twice = (phase.is_closed() || degree(0.0) <= LONG).then(|| {
                [0, 1].map(|i| {
                    let degree = degree(loose * TWICE[i]);
                    let nodes = Nodes::new(UPPER_RAY[i].max(2 + degree / 2), LOWER_RAY[i]);
                    Twice { nodes, turns: degree + 20 }
                })
            });
            Azimuth { orders, twice, small: loose * SMALL }
        })
    }
}

impl Azimuth {
    pub fn modes(&self, set: usize, order: usize) -> Result<Arc<Modes>> {
        self.orders[set][order].modes(order)
    }

    /// The highest order of azimuth of a set.
    pub fn degree(&self, set: usize) -> usize {
        self.orders[set].len() - 1
    }
}

impl Set {
    fn new((scattering, nodes): (Scattering, Nodes), upper: usize, orders: RangeInclusive<usize>) -> Self {
        Set {
            upper,
            first: *orders.start(),
            modes: orders.map(|_| OnceLock::new()).collect(),
            scattering: Arc::new(scattering),
            nodes: Arc::new(nodes),
        }
    }

    /// The same nodes for another order.
    fn sharing(&self, order: usize) -> Self {
        Set {
            upper: self.upper,
            first: order,
            modes: vec![OnceLock::new()],
            scattering: self.scattering.clone(),
            nodes: self.nodes.clone(),
        }
    }

    fn modes(&self, order: usize) -> Result<Arc<Modes>> {
        self.modes[order - self.first]
            .get_or_init(|| Modes::new(self.scattering.clone(), self.nodes.clone(), order).map(Arc::new))
            .clone()
    }
}

impl std::fmt::Debug for AnisotropicMedium {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        f.debug_struct("AnisotropicMedium")
            .field("albedo", &self.0.albedo)
            .field("phase", &self.0.phase)
            .field("method", &METHOD)
            .finish_non_exhaustive()
    }
}
