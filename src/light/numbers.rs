//! Emission as a function of numbers: what decides where a photon starts and where it goes.

/// The numbers behind one photon, each uniform in [0, 1).
///
/// Every light spreads its power evenly over them. A light uses as many as it needs, the rest are 0. Whoever restricts or
/// reweights emission does it here, where the density is known: photons of a part of the unit cube whose volume is v,
/// with weight v, are what that part sends out.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct PrimarySample {
    /// Where the photon starts.
    pub position: [f64; 3],
    /// Where it goes.
    pub direction: [f64; 2],
}

/// How many numbers a light needs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Needs {
    /// For the position: 0, 2 or 3.
    pub position: usize,
    /// For the direction: 0 or 2.
    pub direction: usize,
}
