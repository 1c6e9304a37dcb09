//! Faults as switches: those that shipped in other renderers and simulators, and changes by hand that no test noticed at
//! first. Each is planted in tests, which must notice.
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
    /// A diffuse surface counts the cosine of incidence twice where paths connect to a light.
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
    /// A gather that steps of a march share counts for one of them.
    SharedForOne,
    /// Directions that were drawn from what photons told are weighted as though they were not.
    LobeForgotten,
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
    /// A scene counts as grey whatever the colour of its lights.
    LightColorIgnored,
    /// A medium counts as grey whatever the colour of its emission.
    EmissionColorIgnored,
    /// Photons leave lights in proportion to the largest channel of their power, weighted for its sum.
    LightByLargestChannel,
    /// Extinction counts as grey where that of all regions is, whatever fills interiors.
    FillingColorIgnored,
    /// A coloured homogeneous medium beside a varying one is flown by its first channel.
    StretchColorIgnored,
    /// Photons of an emitting medium have its mean colour, not that of where they start.
    GlowColorOfAll,
    /// Height fog along a ray that climbs by less than 1e-3 scale heights a length is taken for level.
    GentleFogLevel,
    /// A grid's scale is forgotten where its box is given.
    GridScaleForgotten,
    /// The share of equal angles takes a ray to go on behind the wall that ends it.
    WallForgotten,
    /// Free flights through homogeneous media are too long by [`size`].
    FlightStretched,
    /// The same of homogeneous media beside varying ones.
    PieceStretched,
    /// The same of tentative collisions.
    TrackStretched,
    /// A photon that is split shares its weight among as many as there are mostly, not on average.
    WindowUnfair,
    /// A path that learned directions have made too heavy loses one of its parts.
    PartLost,
    /// Flights that are led to bright places keep their weight.
    LedFlightsForgotten,
    /// The noise that is advised forgets that photons of one history gather.
    ClustersForgotten,
    /// The variance of the k nearest is that of k + 1.
    FreedomOfThree,
    /// A picture's file holds the variance of the first channel in all three.
    VarianceOfRed,
    /// The weights of the channels in a picture's luminance are in reverse order.
    LuminanceReversed,
    /// The albedo is a little too low where a history survives: by [`size`].
    AlbedoLowered,
    /// Photons leave lights with a little too much power.
    PowerRaised,
    /// Scattering is sampled a little too far forwards: the mean cosine is too large by [`size`].
    PhaseTurned,
    /// Kernels weigh a little too much.
    KernelRaised,
    /// Light of volumes that a ray meets by chance counts in full beside what is aimed at.
    EmitterShareForgotten,
    /// Photons are scattered on smooth meshes as paths are, without the factor of the two normals.
    ShadingFactorForgotten,
    /// Beams nearly parallel to a ray, of a squared sine below 1e-5, are dropped.
    NearParallelDropped,
    /// The sine between beam and ray is no less than 0.01.
    SineClamped,
    /// Beams have the power with which their flights end.
    BeamsArrive,
    /// The kernel of beams is that of half the line.
    LineHalved,
    /// The radii of all progressive sequences shrink as those of balls do.
    ScheduleOfSpace,
    /// The radius of a photon is that of its sqrt(k) nearest, extrapolated.
    RadiiExtrapolated,
    /// Planes stand on flights that collided only.
    PlanesCollided,
    /// Nothing stands in the way from a plane's first leg to the ray, and no medium is too deep.
    PlanesUnseen,
    /// The determinant of plane and ray is no less than 0.01.
    DeterminantClamped,
    /// Weights of connections with subpaths of light do not know next-event estimation.
    NextEventForgotten,
    /// A connection forgets the cosine on the side of the light.
    ConnectionCosineForgotten,
    /// The density of light behind glass forgets the squared index, where its subpath asks for it.
    LightIndexForgotten,
}

impl Fault {
    /// Every fault, in the order of their definition.
    pub const ALL: [Fault; 69] = [
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
        Fault::SharedForOne,
        Fault::LobeForgotten,
        Fault::RadianceUnscaled,
        Fault::PhotonPowerScaled,
        Fault::FresnelForgotten,
        Fault::DirectInVolumeMap,
        Fault::CausticTwice,
        Fault::StoredOnSurfaces,
        Fault::GridHalfCellOff,
        Fault::NullWeightForgotten,
        Fault::LightColorIgnored,
        Fault::EmissionColorIgnored,
        Fault::LightByLargestChannel,
        Fault::FillingColorIgnored,
        Fault::StretchColorIgnored,
        Fault::GlowColorOfAll,
        Fault::GentleFogLevel,
        Fault::GridScaleForgotten,
        Fault::WallForgotten,
        Fault::FlightStretched,
        Fault::PieceStretched,
        Fault::TrackStretched,
        Fault::WindowUnfair,
        Fault::PartLost,
        Fault::LedFlightsForgotten,
        Fault::ClustersForgotten,
        Fault::FreedomOfThree,
        Fault::VarianceOfRed,
        Fault::LuminanceReversed,
        Fault::AlbedoLowered,
        Fault::PowerRaised,
        Fault::PhaseTurned,
        Fault::KernelRaised,
        Fault::EmitterShareForgotten,
        Fault::ShadingFactorForgotten,
        Fault::NearParallelDropped,
        Fault::SineClamped,
        Fault::BeamsArrive,
        Fault::LineHalved,
        Fault::ScheduleOfSpace,
        Fault::RadiiExtrapolated,
        Fault::PlanesCollided,
        Fault::PlanesUnseen,
        Fault::DeterminantClamped,
        Fault::NextEventForgotten,
        Fault::ConnectionCosineForgotten,
        Fault::LightIndexForgotten,
    ];
}

/// Whether a fault is planted: never, in this build.
#[cfg(not(feature = "faults"))]
#[inline(always)]
pub const fn planted(_fault: Fault) -> bool {
    false
}

/// How large a small bias is that is planted: 0.003, in this build.
#[cfg(not(feature = "faults"))]
pub const fn size() -> f64 {
    SMALL
}

#[cfg(feature = "faults")]
pub use switch::{planted, size, with};

/// A small bias, unless another is asked for.
const SMALL: f64 = 0.003;

#[cfg(feature = "faults")]
mod switch {
    use crate::faults::{Fault, SMALL};
    use std::sync::atomic::{AtomicU8, Ordering};
    use std::sync::{Mutex, OnceLock, PoisonError};

    /// 0 for none, else one more than the fault's number.
    static PLANTED: AtomicU8 = AtomicU8::new(UNREAD);
    /// Nobody has looked yet which fault the environment plants.
    const UNREAD: u8 = u8::MAX;
    /// One fault at a time, in the whole process.
    static ALONE: Mutex<()> = Mutex::new(());

    /// Whether a fault is planted.
    #[inline(always)]
    pub fn planted(fault: Fault) -> bool {
        match PLANTED.load(Ordering::Relaxed) {
            UNREAD => asked() == fault as u8 + 1,
            now => now == fault as u8 + 1,
        }
    }

    /// What the environment plants, by its name in `TURBID_FAULT`: a study can be run with a fault from its start.
    #[cold]
    fn asked() -> u8 {
        let name = std::env::var("TURBID_FAULT").unwrap_or_default();
        let fault = Fault::ALL.into_iter().find(|fault| format!("{fault:?}") == name);
        assert!(name.is_empty() || fault.is_some(), "TURBID_FAULT names no fault: {name}");
        let number = fault.map_or(0, |fault| fault as u8 + 1);
        // Whoever has planted something meanwhile is right.
        let _ = PLANTED.compare_exchange(UNREAD, number, Ordering::SeqCst, Ordering::SeqCst);
        number
    }

    /// How large a small bias is that is planted: 0.003, or what `TURBID_FAULT_SIZE` says.
    pub fn size() -> f64 {
        static SIZE: OnceLock<f64> = OnceLock::new();
        *SIZE.get_or_init(|| {
            let text = std::env::var("TURBID_FAULT_SIZE").unwrap_or_default();
            if text.is_empty() { SMALL } else { text.parse().unwrap_or(f64::NAN) }
        })
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
        assert_eq!(Fault::ALL.len(), Fault::LightIndexForgotten as usize + 1);
        assert!(Fault::ALL.iter().all(|fault| !planted(*fault)));
    }
}
