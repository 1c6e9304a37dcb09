//! The medium as a rule of finite degree sees it: moments up to that degree, the peak beyond it counted as no
//! scattering at all.

use crate::phase::Phase;

/// Albedo, moments and unit of length of a medium, without the part of its forward peak that a rule cannot follow.
pub(crate) struct Scattering {
    /// Single-scattering albedo of what is left \[1\].
    pub albedo: f64,
    /// One minus the albedo, with all its digits.
    pub lost: f64,
    /// Mean free paths of what is left in one of the medium \[1\].
    pub stretch: f64,
    /// Fraction of scattering that counts as straight on \[1\].
    pub peak: f64,
    /// chi_0 = 1 to the last.
    pub moments: Vec<f64>,
}

impl Scattering {
    /// Moments up to `degree`. If `peak` is set and the next moment f is positive, a fraction f of all scattering is
    /// straight on (delta-M): chi' = (chi - f)/(1 - f), w' = (1-f) w/(1 - f w), lengths times 1 - f w.
    ///
    /// # Source
    /// Wiscombe 1977
    pub fn new(albedo: f64, phase: &Phase, degree: usize, peak: bool) -> Self {
        let f = if peak { phase.moment(degree + 1).max(0.0) } else { 0.0 };
        let mut moments: Vec<f64> = (0..=degree).map(|l| (phase.moment(l) - f) / (1.0 - f)).collect();
        moments[0] = 1.0;
        while moments.len() > 1 && moments.last() == Some(&0.0) {
            moments.pop();
        }
        // 1 - w' = (1-w)/(1 - f w) keeps the digits of 1 - w only as far as f64 does.
        let stretch = 1.0 - f * albedo;
        let whole = albedo;
        let albedo = if albedo == 1.0 { 1.0 } else { (1.0 - f) * albedo / stretch };
        let lost = (1.0 - whole) / stretch;
        Scattering { albedo, lost, stretch, peak: f, moments }
    }

    /// The same with no moments beyond `degree`.
    pub fn up_to(mut self, degree: usize) -> Self {
        self.moments.truncate(degree + 1);
        self
    }

    /// Highest moment.
    pub fn degree(&self) -> usize {
        self.moments.len() - 1
    }
}
