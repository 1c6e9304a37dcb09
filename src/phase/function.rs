//! The contract of phase functions.

/// What every phase function answers.
pub trait PhaseFunction {
    /// Density over directions [1/sr]: integrates to 1 over the sphere, and is the density of [`Self::sample`].
    fn eval(&self, one_minus_mu: f64, one_plus_mu: f64) -> f64;

    /// The pair (1-mu, 1+mu) by exact inversion of `u` in [0, 1): mu grows with `u`.
    fn sample(&self, u: f64) -> (f64, f64);

    /// Legendre moment of degree `l`, the mean of P_l(mu): moment 0 is 1, moment 1 is g.
    fn moment(&self, l: u32) -> f64;
}
