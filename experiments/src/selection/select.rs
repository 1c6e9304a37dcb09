//! How a radius is chosen from estimates.

use super::cases::{LARGEST, Selector, THUMB};
use std::cell::RefCell;

/// Radii of the interval test are in the ratio 2^(-1/4).
const STEPS: i32 = 4;
/// The smallest of them holds so many photons.
const FEWEST: f64 = 30.0;
/// Differences of nested estimates within so many of their standard deviations are noise.
const KAPPA: f64 = 5.0;
/// The least radius tried, over the largest.
const LEAST: i32 = 40;

/// One question to one map.
pub struct Question<'a> {
    /// Exponent c of the radius in the variance.
    codimension: f64,
    /// The radius that is best in theory.
    best: f64,
    /// What one photon brings at the largest radius, in the unit of the estimates; at others it goes as the radius to the power -c.
    weight: f64,
    /// The estimate with a radius.
    read: &'a dyn Fn(f64) -> anyhow::Result<f64>,
    /// Estimates that were asked for before.
    known: RefCell<Vec<(f64, f64)>>,
}

impl<'a> Question<'a> {
    /// One that was not asked anything yet.
    pub fn new(
        codimension: f64,
        best: f64,
        weight: f64,
        read: &'a dyn Fn(f64) -> anyhow::Result<f64>,
    ) -> Self {
        Question { codimension, best, weight, read, known: RefCell::default() }
    }

    /// The estimate with a radius.
    ///
    /// # Errors
    /// Those of the estimate.
    pub fn read(&self, radius: f64) -> anyhow::Result<f64> {
        let known = self.known.borrow().iter().find(|known| known.0 == radius).map(|known| known.1);
        if let Some(value) = known {
            return Ok(value);
        }
        let value = (self.read)(radius)?;
        self.known.borrow_mut().push((radius, value));
        Ok(value)
    }

    /// What one photon brings at a radius. A sum of so many equal parts varies as Poisson's: the variance is the mean times this.
    fn weight(&self, radius: f64) -> f64 {
        self.weight * libm::pow(LARGEST / radius, self.codimension)
    }

    /// The radius that a selector chooses; none where it chooses a number of photons.
    ///
    /// # Errors
    /// Those of the estimates.
    pub fn radius(&self, selector: Selector) -> anyhow::Result<Option<f64>> {
        Ok(Some(match selector {
            Selector::Nearest(_) => return Ok(None),
            Selector::Oracle => self.best,
            Selector::Fixed => THUMB,
            Selector::PlugIn => self.plug_in(LARGEST)?,
            Selector::Iterated => {
                let mut radius = self.plug_in(LARGEST)?;
                for _ in 0..5 {
                    radius = self.plug_in((2.0 * radius).min(LARGEST))?;
                }
                radius
            }
            Selector::Interval => 0.5 * self.interval()?,
            Selector::Whole => self.interval()?,
        }))
    }

    /// The least asymptotic error for the bend that two radii show, which is not taken for less than its own noise; at most the larger.
    fn plug_in(&self, first: f64) -> anyhow::Result<f64> {
        let (c, half) = (self.codimension, 0.5 * first * first);
        let small = first * std::f64::consts::FRAC_1_SQRT_2;
        let (large, less) = (self.read(first)?, self.read(small)?);
        if large <= 0.0 {
            return Ok(first);
        }
        let bend = (large - less) / half;
        let noise = large * (self.weight(small) - self.weight(first)) / (half * half);
        let variance = large * self.weight(first) * libm::pow(first, c);
        let best = c * variance / (4.0 * (bend * bend).max(noise));
        Ok(libm::pow(best, 1.0 / (c + 4.0)).min(first))
    }

    /// The last radius whose estimate differs from that of no smaller one by more than noise does.
    fn interval(&self) -> anyhow::Result<f64> {
        // Downwards, while there are photons.
        let mut ladder = Vec::new();
        for step in 0..=LEAST {
            let radius = LARGEST * libm::exp2(-f64::from(step) / f64::from(STEPS));
            let value = self.read(radius)?;
            if step > 0 && value < (FEWEST - 0.5) * self.weight(radius) {
                break;
            }
            ladder.push((radius, value));
        }
        let mut last = 0;
        ladder.reverse();
        while last + 1 < ladder.len() {
            let (radius, value) = ladder[last + 1];
            let contradicts = |&(smaller, estimate): &(f64, f64)| {
                let noise = estimate * (self.weight(smaller) - self.weight(radius));
                (value - estimate).abs() > KAPPA * noise.max(0.0).sqrt()
            };
            if ladder[..=last].iter().any(contradicts) {
                break;
            }
            last += 1;
        }
        Ok(ladder[last].0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn chosen(c: f64, weight: f64, read: &dyn Fn(f64) -> anyhow::Result<f64>, selector: Selector) -> f64 {
        Question::new(c, 0.5, weight, read).radius(selector).unwrap().unwrap()
    }

    /// r^(c+4) = c B/(4 A^2) with the bend found exactly and the mean as the larger radius has it.
    #[test]
    fn plug_in_is_the_best_radius_of_its_bend() {
        for c in [1.0, 2.0, 3.0] {
            let (a, weight) = (2.0, 1e-4);
            let read = move |r: f64| Ok(1.0 + a * r * r);
            let radius = chosen(c, weight, &read, Selector::PlugIn);
            let variance = (1.0 + a * LARGEST * LARGEST) * weight * libm::pow(LARGEST, c);
            assert!((libm::pow(radius, c + 4.0) / (c * variance / (4.0 * a * a)) - 1.0).abs() < 1e-12);
            let steady = |_: f64| Ok(1.0);
            // No bend: that of the noise, F (2^(c/2) - 1) w/(r^2/2)^2.
            let radius = chosen(c, weight, &steady, Selector::PlugIn);
            let floor = weight * (libm::exp2(0.5 * c) - 1.0) / libm::pow(0.5 * LARGEST * LARGEST, 2.0);
            let expected = c * weight * libm::pow(LARGEST, c) / (4.0 * floor);
            assert!((libm::pow(radius, c + 4.0) / expected - 1.0).abs() < 1e-12);
        }
    }

    /// From 30 photons up to the step whose difference is beyond five standard deviations.
    #[test]
    fn the_interval_test_stops_at_a_jump() {
        let jump = 0.3;
        let read = move |r: f64| Ok(if r < jump { 1.0 } else { 2.0 });
        // At 0.3 a photon brings 19 times as much as at 0.8: noise is 0.1 there, five of it 0.4.
        let whole = chosen(3.0, 5e-4, &read, Selector::Whole);
        assert!(whole < jump && whole * libm::exp2(0.25) >= jump, "{whole}");
        assert_eq!(chosen(3.0, 5e-4, &read, Selector::Interval), 0.5 * whole);
        let even = |_: f64| Ok(1.0);
        assert_eq!(chosen(3.0, 5e-4, &even, Selector::Whole), LARGEST);
    }

    /// Where there is no light nothing contradicts anything.
    #[test]
    fn darkness_takes_the_largest_radius() {
        let dark = |_: f64| Ok(0.0);
        for selector in [Selector::PlugIn, Selector::Iterated, Selector::Whole] {
            assert_eq!(chosen(3.0, 1e-3, &dark, selector), LARGEST);
        }
        assert_eq!(Question::new(3.0, 0.5, 1e-3, &dark).radius(Selector::Nearest(50)).unwrap(), None);
    }
}
