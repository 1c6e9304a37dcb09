//! How large a gather is.

use crate::harness::Parameters;
use turbid::estimators::Gather;

/// How large a gather is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Size {
    /// All photons within this radius \[mfp\].
    Radius(f64),
    /// The k nearest photons; the k-th sets the radius and is not summed.
    Nearest(usize),
}

impl Size {
    /// Its name in cases.
    pub fn name(self) -> String {
        match self {
            Size::Radius(r) => format!("r={r}"),
            Size::Nearest(k) => format!("k={k}"),
        }
    }

    /// For readers.
    pub fn title(self) -> String {
        match self {
            Size::Radius(r) => format!("radius {r}"),
            Size::Nearest(k) => format!("{k} nearest"),
        }
    }

    /// Radius or k as columns of the results.
    pub fn parameters(self) -> Parameters {
        match self {
            Size::Radius(r) => Parameters { radius: Some(r), ..Parameters::default() },
            Size::Nearest(k) => Parameters { k: Some(k), ..Parameters::default() },
        }
    }

    /// Whether the k-th photon sets the radius.
    pub fn is_nearest(self) -> bool {
        matches!(self, Size::Nearest(_))
    }

    /// The gather; the k nearest are sought within `cap` \[mfp\].
    pub fn gather(self, cap: f64) -> turbid::Result<Gather> {
        match self {
            Size::Radius(r) => Gather::radius(r),
            Size::Nearest(k) => Gather::nearest(k, cap),
        }
    }
}
