//! A typed decimal is not a number of double precision: what its rounding does to an answer.
//!
//! 0.999999 is read as the nearest f64, up to 5.6e-17 off. Where little is absorbed that matters: thick media let through
//! T ~ e^(-k tau), k^2 = 3 (1-w)(1-wg), so that T changes by k tau/(2 (1-w)) times as much, relatively: 2.4e-10 at
//! tau = 1e4, w = 0.999999, g = 0.75. Absorption goes as 1 - w, critical sizes as (c-1)^(-1/2).
//!
//! The effect of the albedo w, and of the secondaries c, is measured: the question is asked again nearby, and the difference,
//! scaled down to a whole last place, is added to the bound (half a place is what rounding can do). Fields are power series in
//! w of terms that are not negative, so that they bend one way only between the two places. The effect of the other parameters
//! is bounded in closed form: lengths by decays no faster than k, g through p and k, the index through its distance from 1.

use anyhow::Result;
use turbid_analytic::Value;

/// Half a unit in the last place of x is no more than this times x.
const HALF: f64 = 0.5 * f64::EPSILON;

/// Exponents beyond leave nothing of an f64.
const DEAD: f64 = 745.0;

/// The parameters of a question that rounding touches.
#[derive(Debug, Clone, Default)]
pub struct Typed {
    /// Single-scattering albedo.
    pub albedo: Option<f64>,
    /// Secondaries a collision of a critical body.
    pub secondaries: Option<f64>,
    /// Mean cosine of Henyey-Greenstein scattering; none for other phase functions.
    pub g: Option<f64>,
    /// Refractive index.
    pub index: Option<f64>,
    /// Thickness or radius of the medium.
    pub size: Option<f64>,
    /// Depths or distances.
    pub places: Vec<f64>,
}

/// The same question nearby.
struct Step {
    /// Albedo or secondaries to ask with.
    moved: f64,
    /// A whole last place over the distance.
    share: f64,
    /// Estimate from above of what the rounding does, relatively.
    relative: f64,
}

/// Whether the number differs from the shortest decimal that reads as it.
pub fn is_rounded(number: f64) -> bool {
    let digits = format!("{number:.1100}");
    digits.trim_end_matches('0').trim_end_matches('.') != format!("{number}")
}

impl Typed {
    fn decay(&self) -> f64 {
        let w = self.albedo.unwrap_or(0.0);
        libm::sqrt(3.0 * (1.0 - w) * (1.0 - w * self.g.unwrap_or(-1.0))).min(1.0)
    }

    fn longest(&self) -> f64 {
        let length = self.places.iter().copied().chain(self.size).fold(0.0, f64::max);
        (self.decay() * length).min(DEAD)
    }

    /// What rounding all but albedo and secondaries does, relatively.
    fn others(&self) -> f64 {
        let exponent = |length: f64| 2.0 + (self.decay() * length).min(DEAD);
        let rounded = |x: &f64| is_rounded(*x);
        let mut sum = self.size.filter(rounded).map_or(0.0, exponent);
        sum += self.places.iter().copied().filter(rounded).map(exponent).fold(0.0, f64::max);
        if let Some(g) = self.g.filter(rounded) {
            let (w, size) = (self.albedo.unwrap_or(0.0), g.abs());
            sum += 3.0 * size / (1.0 - size) + 0.5 * w * size * self.longest() / (1.0 - w * g);
        }
        sum += self.index.filter(rounded).map_or(0.0, |n| 2.0 + 2.0 * n / (n - 1.0).abs());
        HALF * sum
    }

    fn step(&self) -> Option<Step> {
        let (parameter, rest, away) = match (self.albedo, self.secondaries) {
            (Some(w), _) => (w, 1.0 - w, -1.0),
            (None, Some(c)) => (c, c - 1.0, 1.0),
            (None, None) => return None,
        };
        if !is_rounded(parameter) || rest <= 0.0 {
            return None;
        }
        // Away from 1, where there is always an answer.
        let moved = parameter + away * (rest / 1024.0).max(f64::EPSILON * parameter);
        Some(Step {
            moved,
            share: HALF * parameter / (moved - parameter).abs(),
            relative: HALF * parameter * (1.0 + 0.5 * self.longest()) / rest,
        })
    }

    /// Widens the bounds of all values of one question; `again` asks it with this albedo, or these secondaries, in place of
    /// those typed, and may fail to find the same values there.
    pub fn widen(
        &self,
        values: &mut [&mut Value],
        again: impl FnOnce(f64) -> Result<Option<Vec<Value>>>,
    ) -> Result<()> {
        let others = self.others();
        for value in values.iter_mut() {
            value.error += others * value.value.abs();
        }
        let Some(step) = self.step() else { return Ok(()) };
        let matters = |v: &Value| step.relative * v.value.abs() > 0.1 * v.error;
        let nearby = if values.iter().any(|v| matters(v)) { again(step.moved)? } else { None };
        for (i, value) in values.iter_mut().enumerate() {
            let nearby = nearby.as_ref().and_then(|all| all.get(i));
            value.error += match nearby {
                Some(other) => step.share * (value.value - other.value).abs(),
                None => step.relative * value.value.abs(),
            };
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn short_binary_fractions_are_not_rounded() {
        for exact in [0.0, 0.5, 0.75, 1.0, 400.0, 1e4, 1e22, 0.984375] {
            assert!(!is_rounded(exact), "{exact}");
        }
        for rounded in [0.1, 0.9, 0.999999, 1.1, 1e-3, 1e23] {
            assert!(is_rounded(rounded), "{rounded}");
        }
    }

    /// (1-w)^2: the derivative is 2 (1-w), the half place of w is 2^-54.
    #[test]
    fn the_effect_is_that_of_half_a_place_or_more() {
        let w = 0.999_999;
        let typed = Typed { albedo: Some(w), ..Typed::default() };
        let field = |w: f64| Value { value: (1.0 - w) * (1.0 - w), error: 0.0, method: "" };
        let mut value = field(w);
        typed.widen(&mut [&mut value], |moved| Ok(Some(vec![field(moved)]))).unwrap();
        let half = 2.0 * (1.0 - w) * libm::pow(2.0, -54.0);
        assert!(value.error >= half && value.error <= 2.01 * half, "{value:?} {half:e}");
        // Where it cannot matter, the estimate stands in for the second answer.
        let mut wide = Value { error: 1.0, ..field(w) };
        typed.widen(&mut [&mut wide], |_| panic!("not asked")).unwrap();
        assert!(wide.error >= 1.0);
    }
}
