//! What passes from places along a ray to its near end, as estimates along rays ask for it.

use crate::Spectrum;
use crate::transport::Passage;

/// The part of the light from a distance along a ray that reaches the near end of a stretch of one medium.
///
/// Any `Fn(f64) -> Spectrum` is one. One that knows its closed form overrides [`Transmitted::decay`], and is then asked eight at a time.
pub trait Transmitted {
    /// The part from a distance `t` along the ray \[1\].
    fn from(&self, t: f64) -> Spectrum;

    /// Where the part is exp(-rate (t - start)): the start \[L\] and the rate [1/L].
    fn decay(&self) -> Option<(f64, Spectrum)> {
        None
    }
}

impl<F: Fn(f64) -> Spectrum> Transmitted for F {
    fn from(&self, t: f64) -> Spectrum {
        self(t)
    }
}

impl Transmitted for Passage<'_> {
    fn from(&self, t: f64) -> Spectrum {
        self.to(t)
    }

    fn decay(&self) -> Option<(f64, Spectrum)> {
        self.rate()
    }
}
