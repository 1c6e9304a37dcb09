//! What a case asks, as columns of results.csv.

use turbid::estimators::Kernel;

/// What a case asks: columns of results.csv, empty where a case has no such thing.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Parameters {
    /// Name of the field of light.
    pub field: Option<&'static str>,
    /// Photons emitted into a map.
    pub photons: Option<u64>,
    /// Depth below the nearest face, or the lit one \[mfp\].
    pub depth: Option<f64>,
    /// Radius of a fixed gather \[mfp\], or \[L\] where there is no medium.
    pub radius: Option<f64>,
    /// Photons of a nearest gather, the k-th included.
    pub k: Option<usize>,
    /// Kernel.
    pub kernel: Option<Kernel>,
}
