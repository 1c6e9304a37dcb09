//! A phase function given by its Legendre moments, as Mie programs print them.

use super::PhaseFunction;
use crate::error::{Error, Result};
use crate::math::{FOUR_PI, cos};
use std::f64::consts::PI;

/// `p = sum_l (2l+1) chi_l P_l(mu) / (4 pi)`, chi_0 = 1, chi_1 = g.
#[derive(Debug, Clone, PartialEq)]
pub struct Legendre {
    /// By degree, from 0 on.
    moments: Vec<f64>,
}

/// Most moments: a forward peak of a tenth of a degree.
const MOST: usize = 2000;

/// Part of the largest density by which rounding may make the density of a valid sum negative: each of 2000 terms rounds
/// some ten times.
const ROUNDING: f64 = 1e-11;

impl Legendre {
    /// The phase function of these moments, by degree from 0 on.
    ///
    /// # Errors
    /// `Error::Scene` or `Error::OutOfRange` for no moments or more than 2000, a first one that is not 1, others beyond -1 to 1,
    /// and sums that are negative at some cosine: then the cosine is named
    pub fn new(moments: &[f64]) -> Result<Self> {
        if !(1..=MOST).contains(&moments.len()) {
            return Err(Error::out_of_range("number of Legendre moments", moments.len() as f64, "1 to 2000"));
        }
        if moments[0] != 1.0 {
            return Err(Error::out_of_range(
                "Legendre moment 0",
                moments[0],
                "1, as of a normalised density",
            ));
        }
        if let Some(at) = moments.iter().position(|chi| !(-1.0..=1.0).contains(chi)) {
            return Err(Error::out_of_range(format!("Legendre moment {at}"), moments[at], "-1 to 1"));
        }
        let phase = Legendre { moments: moments.to_vec() };
        phase.check()?;
        Ok(phase)
    }

    /// Whether the density is at least 0: on 32 points a wavelength of the highest degree, and at the bottom of each valley
    /// between them.
    fn check(&self) -> Result<()> {
        let count = 32 * self.moments.len();
        let at = |place: f64| self.sums(cos(PI * place / count as f64)).0;
        let values: Vec<f64> = (0..=count).map(|i| at(i as f64)).collect();
        let least = -ROUNDING * values.iter().fold(0.0, |high: f64, value| high.max(*value));
        let refuse = |place: f64, value: f64| {
            Err(Error::Scene(format!(
                "the Legendre moments add up to {value:.3e} at cosine {:.6}; allowed: at least 0 everywhere (more moments, or smaller ones)",
                cos(PI * place / count as f64)
            )))
        };
        for (i, value) in values.iter().enumerate() {
            if *value < least {
                return refuse(i as f64, *value);
            }
            let is_valley = i > 0 && i < count && values[i - 1] >= *value && values[i + 1] >= *value;
            if is_valley {
                // The bottom of the parabola through the three: the points are so dense that it is the valley's.
                let (before, behind) = (values[i - 1] - value, values[i + 1] - value);
                let bend = before + behind;
                let place = i as f64 + if bend > 0.0 { 0.5 * (before - behind) / bend } else { 0.0 };
                let bottom = at(place);
                if bottom < least {
                    return refuse(place, bottom);
                }
            }
        }
        Ok(())
    }

    /// `sum (2l+1) chi_l P_l` and, from degree 1 on, `sum (2l+1) chi_l P_l' / (l (l+1))`.
    fn sums(&self, mu: f64) -> (f64, f64) {
        let (mut before, mut p) = (1.0, mu);
        // Slopes of the polynomials.
        let (mut slope_before, mut slope) = (0.0, 1.0);
        let (mut value, mut inner) = (1.0, 0.0);
        for (l, chi) in (1..).zip(&self.moments[1..]) {
            let l = f64::from(l);
            let weight = (2.0 * l + 1.0) * chi;
            value += weight * p;
            inner += weight * slope / (l * (l + 1.0));
            (before, p) = (p, ((2.0 * l + 1.0) * mu * p - l * before) / (l + 1.0));
            (slope_before, slope) = (slope, ((2.0 * l + 1.0) * mu * slope - (l + 1.0) * slope_before) / l);
        }
        (value, inner)
    }

    /// The distance from an end of the cosines, -1 or 1, within which a part `target` of at most 1/2 is scattered.
    ///
    /// What lies within x of the end is x/2 (1 -+ (2-x) sum (2l+1) chi_l P_l'/(l(l+1))), since (1-mu^2) P_l' is the integral of
    /// -l(l+1) P_l: no digits are lost at the end. Newton's method within a bracket.
    fn reach(&self, target: f64, is_backward: bool) -> f64 {
        if target == 0.0 {
            return 0.0;
        }
        let (mut low, mut high, mut x) = (0.0, 2.0, 2.0 * target);
        for _ in 0..200 {
            let mu = if is_backward { x - 1.0 } else { 1.0 - x };
            let (value, inner) = self.sums(mu);
            let sign = if is_backward { -1.0 } else { 1.0 };
            let within = 0.5 * x * (1.0 + sign * (2.0 - x) * inner);
            if within > target {
                high = x;
            } else {
                low = x;
            }
            let newton = x - (within - target) / (0.5 * value);
            // The sums round by more than a part in 2^52.
            if (newton - x).abs() <= 4.0 * f64::EPSILON * x {
                return newton.clamp(0.0, 2.0);
            }
            x = if low < newton && newton < high { newton } else { 0.5 * (low + high) };
        }
        x
    }
}

impl PhaseFunction for Legendre {
    fn eval(&self, one_minus_mu: f64, one_plus_mu: f64) -> f64 {
        let mu = if one_plus_mu < one_minus_mu { one_plus_mu - 1.0 } else { 1.0 - one_minus_mu };
        self.sums(mu).0.max(0.0) / FOUR_PI
    }

    fn sample(&self, u: f64) -> (f64, f64) {
        if u < 0.5 {
            let plus = self.reach(u, true);
            (2.0 - plus, plus)
        } else {
            let minus = self.reach(1.0 - u, false);
            (minus, 2.0 - minus)
        }
    }

    fn moment(&self, l: u32) -> f64 {
        self.moments.get(l as usize).copied().unwrap_or(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Asymmetry;
    use crate::phase::{HenyeyGreenstein, Rayleigh};

    /// Rayleigh's three moments are Rayleigh; 200 powers of 0.7 are Henyey and Greenstein, density and samples.
    #[test]
    fn moments_of_others_are_the_others() {
        let powers: Vec<f64> =
            (0..200).scan(1.0, |power, _| Some(std::mem::replace(power, *power * 0.7))).collect();
        let g = HenyeyGreenstein::new(Asymmetry::new("g", 0.7).unwrap());
        let pairs: [(Legendre, &dyn PhaseFunction); 2] =
            [(Legendre::new(&[1.0, 0.0, 0.1]).unwrap(), &Rayleigh), (Legendre::new(&powers).unwrap(), &g)];
        for (mine, other) in pairs {
            for i in 0..100 {
                let u = f64::from(i) / 100.0;
                let (minus, plus) = other.sample(u);
                let (m, p) = mine.sample(u);
                assert!((m - minus).abs() < 1e-13 && (p - plus).abs() < 1e-13, "{u}: {m} {minus}");
                let ratio = mine.eval(minus, plus) / other.eval(minus, plus);
                assert!((ratio - 1.0).abs() < 1e-12, "{u}: {ratio}");
            }
        }
    }

    #[test]
    fn what_is_no_density_is_refused() {
        let said = |moments: &[f64]| Legendre::new(moments).err().map_or(String::new(), |e| e.to_string());
        assert_eq!(said(&[]), "number of Legendre moments is 0; allowed: 1 to 2000");
        assert_eq!(said(&[0.5]), "Legendre moment 0 is 0.5; allowed: 1, as of a normalised density");
        assert_eq!(said(&[1.0, 1.5]), "Legendre moment 1 is 1.5; allowed: -1 to 1");
        assert_eq!(said(&[1.0, f64::NAN]), "Legendre moment 1 is NaN; allowed: -1 to 1");
        assert!(said(&[1.0, 0.5]).starts_with("the Legendre moments add up to -"));
        // Zero at an end and in the middle is allowed, a trace below is not: P_2 has its bottom -1/2 at 0.
        assert_eq!(said(&[1.0, 1.0 / 3.0]), "");
        assert_eq!(said(&[1.0, 0.0, 0.4]), "");
        assert!(said(&[1.0, 0.0, 0.4 + 1e-9]).contains("at cosine 0.000000"));
        // 1 + 3 a P_1 + 5 b P_2, whose bottom lies between the points: at mu = -a/(5 b), 1 - 5b/2 - 3a^2/(10 b) = 0.
        let (b, a): (f64, f64) = (0.3, (10.0f64 * 0.3 / 3.0 * (1.0 - 0.75)).sqrt());
        assert_eq!(said(&[1.0, a * (1.0 - 1e-9), b]), "");
        assert!(said(&[1.0, a * (1.0 + 1e-3), b]).contains("at cosine -0.3"));
    }
}
