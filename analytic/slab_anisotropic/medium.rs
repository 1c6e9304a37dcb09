//! What belongs to a medium and not to a slab of it: its modes on two sets of nodes, order by order of azimuth.

use super::modes::Modes;
use super::nodes::Nodes;
use super::scattering::Scattering;
use super::{AnisotropicSlab, METHOD};
use crate::error::{Result, within};
use crate::incidence::{Incidence, check_albedo};
use crate::phase::Phase;
use std::sync::{Arc, OnceLock};

/// What the first Legendre moment left out may be in the finer and in the coarser solution. Its effect on a flux is
/// smaller by four orders (measured at g = 0.8 to 0.9 against 100-bit adding and doubling).
const CUT: [f64; 2] = [1e-11, 1e-8];

/// Nodes towards the horizon, the fewest and the most above it.
const LOWER: [usize; 2] = [60, 50];
const UPPER: [usize; 2] = [32, 26];
const MOST: [usize; 2] = [330, 250];

const TAIL: &str = "moments that beyond l = 498 are at most 0.1 and hardly change";

/// A medium whose modes are solved once, for any number of slabs. Cloning shares them.
#[derive(Clone)]
pub struct AnisotropicMedium(Arc<Medium>);

struct Medium {
    albedo: f64,
    phase: Phase,
    sets: [Set; 2],
}

/// One set of nodes.
struct Set {
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
    /// l = 300: Henyey-Greenstein from -0.95 to 0.99
    /// # Errors
    /// `Error::OutOfRange` naming `albedo` or `phase function`
    pub fn new(albedo: f64, phase: &Phase) -> Result<Self> {
        let upper = |i: usize| UPPER[i].max(2 + phase.degree(CUT[i], 2 * MOST[i]).div_ceil(2)).min(MOST[i]);
        let set = |i: usize| {
            let nodes = Nodes::new(upper(i), LOWER[i]);
            (
                Scattering::new(albedo, phase, nodes.degree, phase.degree(CUT[i], usize::MAX) > nodes.degree),
                nodes,
            )
        };
        check_albedo(albedo)?;
        let last = 2 * MOST[1] - 1;
        let (value, least) = (last..last + 8).fold((0.0, 1.0), |(most, least): (f64, f64), l| {
            (most.max(phase.moment(l)), least.min(phase.moment(l)))
        });
        // A peak that is cut off as straight on must be of light straight on.
        within("phase function", value, f64::MIN, 0.1f64.min(1.25 * least + 2e-5), TAIL)?;
        Self::of(albedo, phase, [set(0), set(1)])
    }

    /// The same on a plain Gauss rule on each hemisphere, as few as is wanted: for comparison with other programs.
    ///
    /// # Arguments
    /// `streams` on both hemispheres together, even, 8 to 256; bounds come from three quarters as many
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
        let sets = sets.map(|(scattering, nodes)| Set {
            modes: (0..=scattering.degree()).map(|_| OnceLock::new()).collect(),
            scattering: Arc::new(scattering),
            nodes: Arc::new(nodes),
        });
        let medium = AnisotropicMedium(Arc::new(Medium { albedo, phase: phase.clone(), sets }));
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

    /// A slab of this medium.
    ///
    /// # Arguments
    /// `tau` optical thickness \[1\], 1e-12 to 1e9; `incidence` of unit irradiance, a beam with a cosine of 1e-5 to 1
    /// # Errors
    /// `Error::OutOfRange` naming `tau` or `mu0`
    pub fn slab(&self, tau: f64, incidence: Incidence) -> Result<AnisotropicSlab> {
        within("tau", tau, 1e-12, 1e9, "1e-12 to 1e9 with anisotropic scattering")?;
        AnisotropicSlab::of(self.clone(), tau, incidence)
    }

    /// All of space below the lit face: a slab whose `tau` is infinite and whose transmittance is 0.
    ///
    /// # Arguments
    /// `incidence` of unit irradiance, a beam with a cosine of 1e-5 to 1
    /// # Errors
    /// `Error::OutOfRange` naming `mu0`
    pub fn half_space(&self, incidence: Incidence) -> Result<AnisotropicSlab> {
        AnisotropicSlab::of(self.clone(), f64::INFINITY, incidence)
    }

    /// What set 0 (the finer) or 1 sees of the medium.
    pub(crate) fn scattering(&self, set: usize) -> &Arc<Scattering> {
        &self.0.sets[set].scattering
    }

    /// The modes of an order of azimuth, at most the degree of `scattering(set)`, on set 0 (the finer) or 1.
    pub(crate) fn modes(&self, set: usize, order: usize) -> Result<Arc<Modes>> {
        let set = &self.0.sets[set];
        set.modes[order]
            .get_or_init(|| Modes::new(set.scattering.clone(), set.nodes.clone(), order).map(Arc::new))
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
