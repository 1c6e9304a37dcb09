//! Phase functions: how scattering turns light, by Legendre moments.
//!
//! With c the cosine of the deflection,
//!
//! p(c) = 1/(4 pi) sum_l (2l+1) chi_l P_l(c),  chi_l = 2 pi int p(c) P_l(c) dc,  chi_0 = 1,  chi_1 = g
//!
//! and p is a density over directions: its integral over the sphere is 1. Henyey-Greenstein has chi_l = g^l, Rayleigh
//! (unpolarised, 3/4 (1 + c^2)/(4 pi)) has chi_2 = 1/10 and no others.
//!
//! Source: Henyey and Greenstein 1941; Chandrasekhar 1960, chapter I; Kattawar 1975 for the sum of two.

use crate::error::{Error, Result, within};
use crate::quadrature::GaussLegendre;
use crate::work;
use libm::{ceil, cos, log, pow};
use nalgebra::DMatrix;
use std::f64::consts::PI;

const OPEN: &str = "above -1, below 1";

/// A phase function: rotationally symmetric, normalised, nowhere negative.
#[derive(Debug, Clone, PartialEq)]
pub struct Phase(Kind);

#[derive(Debug, Clone, PartialEq)]
enum Kind {
    /// `share` of Henyey-Greenstein with `g1`, the rest with `g2`.
    HenyeyGreenstein {
        g1: f64,
        g2: f64,
        share: f64,
    },
    Moments(Vec<f64>),
}

impl Phase {
    /// The same in all directions: 1/(4 pi).
    pub fn isotropic() -> Self {
        Phase(Kind::Moments(vec![1.0]))
    }

    /// Whether light is scattered alike in all directions, and known to be: a single Legendre moment.
    pub fn is_isotropic(&self) -> bool {
        *self == Self::isotropic()
    }

    /// Henyey-Greenstein, p = (1-g^2)/(4 pi (1 + g^2 - 2 g c)^(3/2)).
    ///
    /// # Errors
    /// `Error::OutOfRange` naming `g` unless -1 < g < 1
    pub fn henyey_greenstein(g: f64) -> Result<Self> {
        let g = within("g", g, -1.0 + f64::EPSILON, 1.0 - f64::EPSILON, OPEN)?;
        Ok(Phase(Kind::HenyeyGreenstein { g1: g, g2: 0.0, share: 1.0 }))
    }

    /// `share` of Henyey-Greenstein with `g1`, 1 - `share` of one with `g2`.
    ///
    /// # Errors
    /// `Error::OutOfRange` naming `g1`, `g2` (above -1, below 1) or `share` (0 to 1)
    pub fn two_term(g1: f64, g2: f64, share: f64) -> Result<Self> {
        let g1 = within("g1", g1, -1.0 + f64::EPSILON, 1.0 - f64::EPSILON, OPEN)?;
        let g2 = within("g2", g2, -1.0 + f64::EPSILON, 1.0 - f64::EPSILON, OPEN)?;
        Ok(Phase(Kind::HenyeyGreenstein { g1, g2, share: within("share", share, 0.0, 1.0, "0 to 1")? }))
    }

    /// Rayleigh without polarisation, 3 (1 + c^2)/(16 pi).
    pub fn rayleigh() -> Self {
        Phase(Kind::Moments(vec![1.0, 0.0, 0.1]))
    }

    /// The sum of the given Legendre moments chi_0 = 1, chi_1 = g, ...
    ///
    /// # Arguments
    /// `moments` without the factor 2l+1, at most 2000
    /// # Errors
    /// `Error::OutOfRange` naming `moment 0` (1), `moment` (-1 to 1), `moments` (how many), or `phase function`:
    /// where the sum is negative by more than rounding on one of 16 (L+1) equally spaced angles, L the last moment
    /// (between two of which it moves by at most 2 per cent of its largest value)
    pub fn legendre(mut moments: Vec<f64>) -> Result<Self> {
        within("moments", moments.len() as f64, 1.0, 2000.0, "1 to 2000 of them")?;
        within("moment 0", moments[0], 1.0 - 1e-12, 1.0 + 1e-12, "1")?;
        moments[0] = 1.0;
        for &moment in &moments {
            within("moment", moment, -1.0, 1.0, "-1 to 1")?;
        }
        while moments.len() > 1 && moments.last() == Some(&0.0) {
            moments.pop();
        }
        let scale: f64 = moments.iter().enumerate().map(|(l, chi)| (2 * l + 1) as f64 * chi.abs()).sum();
        let angles = 16 * moments.len();
        for i in 0..=angles {
            let c = cos(PI * i as f64 / angles as f64);
            let value = series(&moments, c);
            if value < -1e-12 * scale {
                let (name, allowed) = ("phase function", "0 or more at every angle");
                return Err(Error::OutOfRange { name, value, allowed });
            }
        }
        Ok(Phase(Kind::Moments(moments)))
    }

    /// The moments up to `degree` of a function given by its values at some cosines, linear in between.
    ///
    /// The table is normalised; what is used is the sum of its moments, which must not be negative: a peak needs a
    /// `degree` of about pi over its width.
    /// # Arguments
    /// `cosines` rising from -1 to 1; `values` 0 or more, in any unit
    /// # Errors
    /// `Error::OutOfRange` naming `table` (its length), `cosine`, `value`, `degree` (0 to 1999), or as
    /// [`Phase::legendre`]
    pub fn tabulated(cosines: &[f64], values: &[f64], degree: usize) -> Result<Self> {
        let n = cosines.len();
        within("table", n as f64, 2.0, 1e5, "2 to 100000 cosines")?;
        within("table", values.len() as f64, n as f64, n as f64, "as many values as cosines")?;
        within("degree", degree as f64, 0.0, 1999.0, "0 to 1999")?;
        within("cosine", cosines[0], -1.0, -1.0, "-1 first")?;
        within("cosine", cosines[n - 1], 1.0, 1.0, "1 last")?;
        for pair in cosines.windows(2) {
            within("cosine", pair[1], pair[0] + f64::EPSILON, 1.0, "in rising order")?;
        }
        for &value in values {
            within("value", value, 0.0, 1e100, "0 to 1e100")?;
        }
        // A line times P_l has degree l + 1.
        let rule = GaussLegendre::rule(degree / 2 + 2);
        let mut moments = vec![0.0; degree + 1];
        for (c, v) in cosines.windows(2).zip(values.windows(2)) {
            for (x, w) in rule.nodes.iter().zip(&rule.weights) {
                let value = (c[1] - c[0]) * w * (v[0] + x * (v[1] - v[0]));
                for (moment, p) in moments.iter_mut().zip(polynomials(degree, c[0] + x * (c[1] - c[0]))) {
                    *moment += value * p;
                }
            }
        }
        let total = moments[0];
        within("value", total, 1e-200, f64::MAX, "not zero everywhere")?;
        moments.iter_mut().for_each(|m| *m /= total);
        Phase::legendre(moments)
    }

    /// chi_l \[1\].
    pub fn moment(&self, l: usize) -> f64 {
        match &self.0 {
            Kind::HenyeyGreenstein { g1, g2, share } => {
                let n = l as f64;
                share * pow(*g1, n) + (1.0 - share) * pow(*g2, n)
            }
            Kind::Moments(moments) => moments.get(l).copied().unwrap_or(0.0),
        }
    }

    /// Mean cosine of scattering \[1\], the moment l = 1.
    pub fn g(&self) -> f64 {
        self.moment(1)
    }

    /// Density over directions \[1/sr\] at the cosine of the deflection, -1 to 1.
    pub fn value(&self, cosine: f64) -> f64 {
        self.value_of(1.0 - cosine, 1.0 + cosine)
    }

    /// Density \[1/sr\] where one minus the cosine is `minus` and one plus it is `plus`, which keeps every digit at both
    /// peaks.
    pub(crate) fn value_of(&self, minus: f64, plus: f64) -> f64 {
        match &self.0 {
            Kind::HenyeyGreenstein { g1, g2, share } => {
                let term = |g: f64| {
                    let rest = 1.0 - g.abs();
                    let d = rest * rest + 2.0 * g.abs() * if g >= 0.0 { minus } else { plus };
                    rest * (1.0 + g.abs()) / (4.0 * PI * d * d.sqrt())
                };
                if *share == 1.0 { term(*g1) } else { share * term(*g1) + (1.0 - share) * term(*g2) }
            }
            Kind::Moments(moments) => series(moments, 0.5 * (plus - minus)),
        }
    }

    /// Mean over azimuth of the density \[1/sr\] between directions of cosines x and y.
    ///
    /// Henyey-Greenstein: (1-g^2) E(m) / (2 pi^2 (a-b) root(a+b)), a = 1 + g^2 - 2 g x y, b = 2 |g| times both sines,
    /// m = 2b/(a+b), E the complete elliptic integral of the second kind.
    pub(crate) fn azimuthal_mean(&self, x: f64, y: f64) -> f64 {
        match &self.0 {
            Kind::HenyeyGreenstein { g1, g2, share } => {
                let sine = |c: f64| ((1.0 - c) * (1.0 + c)).sqrt();
                let (s, r) = (sine(x), sine(y));
                let term = |g: f64| {
                    let (h, y) = (g.abs(), if g < 0.0 { -y } else { y });
                    let lateral = if s + r > 0.0 { (x - y) * (x + y) / (s + r) } else { 0.0 };
                    // (1-h)^2 + 2 h (1 - cos), at the nearest and the farthest azimuth.
                    let near = (1.0 - h) * (1.0 - h) + h * (lateral * lateral + (x - y) * (x - y));
                    let far = near + 4.0 * h * s * r;
                    (1.0 - h) * (1.0 + h) * elliptic_e(near / far) / (2.0 * PI * PI * near * far.sqrt())
                };
                if *share == 1.0 { term(*g1) } else { share * term(*g1) + (1.0 - share) * term(*g2) }
            }
            Kind::Moments(moments) => {
                let degree = moments.len() - 1;
                let (p, q) = (polynomials(degree, x), polynomials(degree, y));
                let sum: f64 = (0..=degree).map(|l| (2 * l + 1) as f64 * moments[l] * p[l] * q[l]).sum();
                sum / (4.0 * PI)
            }
        }
    }

    /// [`Phase::azimuthal_mean`] between every cosine x (rows) and y (columns). Of a list of moments it is one product of
    /// matrices: polynomials are found once a cosine, not once a pair.
    pub(crate) fn azimuthal_means(&self, x: &[f64], y: &[f64]) -> DMatrix<f64> {
        match &self.0 {
            Kind::HenyeyGreenstein { .. } => {
                DMatrix::from_fn(x.len(), y.len(), |i, j| self.azimuthal_mean(x[i], y[j]))
            }
            Kind::Moments(moments) => {
                let table = |cosines: &[f64]| {
                    let columns = cosines.iter().flat_map(|&c| polynomials(moments.len() - 1, c));
                    DMatrix::from_iterator(moments.len(), cosines.len(), columns)
                };
                let mut right = table(y);
                for (l, mut row) in right.row_iter_mut().enumerate() {
                    row *= (2 * l + 1) as f64 * moments[l] / (4.0 * PI);
                }
                table(x).transpose() * right
            }
        }
    }

    /// Whether `value` is a closed form, and not a sum over moments.
    pub(crate) fn is_closed(&self) -> bool {
        matches!(self.0, Kind::HenyeyGreenstein { .. })
    }

    /// The least L such that no moment beyond it exceeds `cut`; at most `most`.
    pub(crate) fn degree(&self, cut: f64, most: usize) -> usize {
        match &self.0 {
            Kind::HenyeyGreenstein { g1, g2, share } => {
                let term = |g: f64, part: f64| {
                    let (g, part) = (g.abs(), part.abs());
                    if g == 0.0 || part <= cut { 0.0 } else { ceil(log(cut / part) / log(g)) }
                };
                (term(*g1, *share).max(term(*g2, 1.0 - share)) as usize).min(most)
            }
            Kind::Moments(moments) => moments.iter().rposition(|chi| chi.abs() > cut).unwrap_or(0).min(most),
        }
    }
}

/// 1/(4 pi) sum (2l+1) chi_l P_l(c), by Clenshaw's recurrence.
fn series(moments: &[f64], c: f64) -> f64 {
    let (mut next, mut after) = (0.0, 0.0);
    for (l, chi) in moments.iter().enumerate().skip(1).rev() {
        let n = l as f64;
        let here = (2.0 * n + 1.0) * (chi + c * next / (n + 1.0)) - (n + 1.0) / (n + 2.0) * after;
        (next, after) = (here, next);
    }
    (moments[0] + c * next - 0.5 * after) / (4.0 * PI)
}

/// int_0^(pi/2) root(1 - m sin^2 a) da for the complement 1 - m in (0, 1], by arithmetic and geometric means.
fn elliptic_e(complement: f64) -> f64 {
    let (mut a, mut b) = (1.0, complement.sqrt());
    let (mut sum, mut power) = (0.5 * (1.0 - complement), 0.5);
    for _ in 0..12 {
        let c = 0.5 * (a - b);
        (a, b) = (0.5 * (a + b), (a * b).sqrt());
        power *= 2.0;
        sum += power * c * c;
        if c <= 1e-9 * a {
            break;
        }
    }
    0.5 * PI / a * (1.0 - sum)
}

/// P_0(x) to P_degree(x).
fn polynomials(degree: usize, x: f64) -> Vec<f64> {
    work::add(degree);
    let mut p = vec![1.0, x];
    for l in 2..=degree {
        let n = l as f64;
        p.push(((2.0 * n - 1.0) * x * p[l - 1] - (n - 1.0) * p[l - 2]) / n);
    }
    p.truncate(degree + 1);
    p
}

#[cfg(test)]
mod tests {
    use super::*;

    fn specimens() -> Vec<Phase> {
        vec![
            Phase::isotropic(),
            Phase::rayleigh(),
            Phase::henyey_greenstein(0.7).unwrap(),
            Phase::henyey_greenstein(-0.6).unwrap(),
            Phase::two_term(0.8, -0.4, 0.7).unwrap(),
            Phase::legendre(vec![1.0, 0.5, 0.2, 0.05]).unwrap(),
        ]
    }

    #[test]
    fn moments_are_integrals_of_the_value() {
        let rule = GaussLegendre::rule(120);
        for phase in specimens() {
            for l in 0..12 {
                let got = rule.integrate(-1.0, 1.0, |c| 2.0 * PI * phase.value(c) * polynomials(l, c)[l]);
                // 120 nodes leave 0.8^240 of the sharpest.
                assert!((got - phase.moment(l)).abs() < 1e-13, "{phase:?} {l} {got} {}", phase.moment(l));
            }
            let cut = 1e-9;
            let degree = phase.degree(cut, 1000);
            assert!((degree + 1..degree + 50).all(|l| phase.moment(l).abs() <= cut * (1.0 + 1e-9)));
        }
    }

    #[test]
    fn means_over_azimuth_are_sums_of_moments() {
        for phase in specimens() {
            let degree = phase.degree(1e-18, 1000);
            for (x, y) in [(0.3, -0.8), (1.0, -1.0), (0.5, 0.5), (0.0, 0.9), (-0.2, 0.6), (1e-9, -1e-9)] {
                let (p, q) = (polynomials(degree, x), polynomials(degree, y));
                let sum: f64 = (0..=degree).map(|l| (2 * l + 1) as f64 * phase.moment(l) * p[l] * q[l]).sum();
                let got = phase.azimuthal_mean(x, y);
                assert!(
                    (got - sum / (4.0 * PI)).abs() < 1e-13 * (1.0 + got),
                    "{phase:?} {x} {y} {got} {sum}"
                );
            }
        }
        // Beside the peak and far from it, E is 1 to pi/2.
        assert!((elliptic_e(1.0) - 0.5 * PI).abs() < 1e-15 && (elliptic_e(1e-12) - 1.0).abs() < 1e-10);
        let half = 1.350_643_881_047_675_5;
        assert!((elliptic_e(0.5) - half).abs() < 4e-16);
    }

    #[test]
    fn means_over_azimuth_of_many_pairs_are_those_of_each() {
        let (x, y) = ([1.0, 0.3, 1e-9], [-1.0, -0.8, 0.3, 0.9]);
        for phase in specimens() {
            let all = phase.azimuthal_means(&x, &y);
            for (i, &x) in x.iter().enumerate() {
                for (j, &y) in y.iter().enumerate() {
                    let one = phase.azimuthal_mean(x, y);
                    assert!((all[(i, j)] - one).abs() < 1e-15 * (1.0 + one), "{phase:?} {x} {y}");
                }
            }
        }
    }

    #[test]
    fn rayleigh_is_one_plus_the_square() {
        for c in [-1.0, -0.3, 0.0, 0.9] {
            assert!((Phase::rayleigh().value(c) - 3.0 * (1.0 + c * c) / (16.0 * PI)).abs() < 1e-16);
        }
    }

    #[test]
    fn a_table_of_a_polynomial_gives_its_moments() {
        // 1 + c/2 is linear, so the table is exact: chi_1 = 1/6.
        let phase = Phase::tabulated(&[-1.0, 0.2, 1.0], &[0.5, 1.1, 1.5], 4).unwrap();
        assert!((phase.g() - 1.0 / 6.0).abs() < 1e-15 && phase.moment(2).abs() < 1e-15);
    }

    #[test]
    fn what_is_no_density_is_refused() {
        for (phase, name) in [
            (Phase::henyey_greenstein(1.0), "g is"),
            (Phase::two_term(0.5, f64::NAN, 0.5), "g2 is"),
            (Phase::two_term(0.5, 0.5, 1.5), "share is"),
            (Phase::legendre(vec![]), "moments is"),
            (Phase::legendre(vec![0.9]), "moment 0 is"),
            (Phase::legendre(vec![1.0, 1.5]), "moment is"),
            (Phase::legendre(vec![1.0, f64::NAN]), "moment is"),
            (Phase::legendre(vec![1.0, 0.9]), "phase function is"),
            (Phase::tabulated(&[-1.0, 1.0], &[0.0, 0.0], 3), "value is"),
            (Phase::tabulated(&[-1.0, 0.5], &[1.0, 1.0], 3), "cosine is"),
        ] {
            let error = phase.err().unwrap().to_string();
            assert!(error.starts_with(name), "{error}");
        }
    }
}
