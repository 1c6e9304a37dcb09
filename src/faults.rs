//! Faults that shipped in other renderers and simulators, as switches: each is planted in tests, which must notice.
//!
//! Without the feature `faults` nothing can be planted: [`planted`] is constant, and the compiler removes what it guards.
//! Only the tests of this package turn the feature on; the commands that `cargo run` builds are without it.

/// A fault that can be planted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u8)]
pub enum Fault {
    /// The albedo is applied twice where a history survives.
    AlbedoTwice,
    /// The albedo is not applied: every history survives.
    AlbedoNever,
    /// A matt surface counts the cosine of incidence twice where paths connect to a light.
    CosineTwice,
    /// An area light sends photons uniformly over the hemisphere, not in proportion to the cosine.
    EmissionUniform,
    /// Henyey-Greenstein with a negative asymmetry is sampled as isotropic.
    BackwardIsotropic,
    /// The asymmetry is cut at 0.99 in size.
    AsymmetryClamped,
    /// An asymmetry below 1e-3 in size is taken for 0.
    SmallAsymmetryIgnored,
    /// Henyey-Greenstein is sampled rightly and evaluated for the opposite direction.
    EvaluationMirrored,
    /// The largest random word gives 1, not a number below it.
    UnitReachesOne,
    /// Transmittance is computed in single precision, and is 0 past an optical depth of 104.
    TransmittanceUnderflows,
    /// Values that are not finite are left out of the moments, and not counted.
    NonFiniteDropped,
    /// A running mean is held in single precision.
    SinglePrecisionMean,
    /// A flight forgets the depth that it has flown where one region ends and the next begins.
    DepthForgotten,
    /// A ray along an axis misses every box.
    AxisRaysMiss,
    /// Photons play no roulette: they carry the albedo as a weight and go on until they leave.
    NoRoulette,
    /// Direct light from a rectangle forgets its area, and is right for one of area 1.
    AreaForgotten,
    /// The blocks of histories are as many as the threads.
    BlocksByThreads,
    /// Paths count their last scattering to the order before it.
    OrderOffByOne,
    /// The mean absolute deviation stands for the variance.
    AbsoluteDeviation,
    /// The standard error of a mean forgets the root of n.
    RootForgotten,
    /// The k nearest photons behind a wall set the radius, rejected ones among them.
    RejectedSetRadius,
    /// A march sums its steps and forgets how long they are.
    StepForgotten,
    /// A path's radiance is not scaled where it is refracted.
    RadianceUnscaled,
    /// A photon's power is scaled like radiance where it is refracted.
    PhotonPowerScaled,
    /// A dielectric reflects nothing but what it reflects totally.
    FresnelForgotten,
    /// The volume map holds photons that come straight from a light, beside the shadow rays.
    DirectInVolumeMap,
    /// The caustic class is in the global map that is seen, beside the caustic map.
    CausticTwice,
    /// Estimates on surfaces divide by the stored photons, not by the emitted ones.
    StoredOnSurfaces,
    /// A grid's samples are taken to lie half a cell from where they do.
    GridHalfCellOff,
    /// Light that meets nothing at a tentative collision keeps the weight that it came with.
    NullWeightForgotten,
}

impl Fault {
    /// Every fault, in the order of their definition.
    pub const ALL: [Fault; 30] = [
        Fault::AlbedoTwice,
        Fault::AlbedoNever,
        Fault::CosineTwice,
        Fault::EmissionUniform,
        Fault::BackwardIsotropic,
        Fault::AsymmetryClamped,
        Fault::SmallAsymmetryIgnored,
        Fault::EvaluationMirrored,
        Fault::UnitReachesOne,
        Fault::TransmittanceUnderflows,
        Fault::NonFiniteDropped,
        Fault::SinglePrecisionMean,
        Fault::DepthForgotten,
        Fault::AxisRaysMiss,
        Fault::NoRoulette,
        Fault::AreaForgotten,
        Fault::BlocksByThreads,
        Fault::OrderOffByOne,
        Fault::AbsoluteDeviation,
        Fault::RootForgotten,
        Fault::RejectedSetRadius,
        Fault::StepForgotten,
        Fault::RadianceUnscaled,
        Fault::PhotonPowerScaled,
        Fault::FresnelForgotten,
        Fault::DirectInVolumeMap,
        Fault::CausticTwice,
        Fault::StoredOnSurfaces,
        Fault::GridHalfCellOff,
        Fault::NullWeightForgotten,
    ];
}

/// Whether a fault is planted: never, in this build.
#[cfg(not(feature = "faults"))]
#[inline(always)]
pub const fn planted(_fault: Fault) -> bool {
    false
}

#[cfg(feature = "faults")]
pub use switch::{planted, with};

#[cfg(feature = "faults")]
mod switch {
    use crate::faults::Fault;
    use std::sync::atomic::{AtomicU8, Ordering};
    use std::sync::{Mutex, PoisonError};

    /// 0 for none, else one more than the fault's number.
    static PLANTED: AtomicU8 = AtomicU8::new(0);
    /// One fault at a time, in the whole process.
    static ALONE: Mutex<()> = Mutex::new(());

    /// Whether a fault is planted.
    #[inline(always)]
    pub fn planted(fault: Fault) -> bool {
        PLANTED.load(Ordering::Relaxed) == fault as u8 + 1
    }

    /// Takes the fault out again, however its user ends.
    struct Planted;

    impl Drop for Planted {
        fn drop(&mut self) {
            PLANTED.store(0, Ordering::SeqCst);
        }
    }

    /// Does something with a fault planted, or surely none, on all threads of the process; others who ask wait.
    pub fn with<T>(fault: Option<Fault>, f: impl FnOnce() -> T) -> T {
        let _alone = ALONE.lock().unwrap_or_else(PoisonError::into_inner);
        let _planted = Planted;
        PLANTED.store(fault.map_or(0, |fault| fault as u8 + 1), Ordering::SeqCst);
        f()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_are_named_in_order() {
        assert!(Fault::ALL.iter().enumerate().all(|(i, fault)| *fault as usize == i));
        assert_eq!(Fault::ALL.len(), Fault::NullWeightForgotten as usize + 1);
        assert!(Fault::ALL.iter().all(|fault| !planted(*fault)));
    }
}
