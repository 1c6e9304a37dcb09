//! The edge as the k nearest points show it.

use super::{Edge, LARGEST_DECAY};
use crate::error::{Result, within};
use crate::kernel::{Dimension, Kernel};
use crate::nearest::nearest_expectation;
use crate::poisson::at_most;
use crate::value::Value;
use std::f64::consts::PI;

/// The edge in k-nearest gathers (k - 1 points over the ball of the k-th) of independent points.
///
/// The ball grows where light is missing, so that the edge is wider than in the ball of the plateau, and reaches
/// farther into the dark than into the light: as h^-3. On the edge itself the estimate is half the plateau, for every
/// k, but for what the decay along the shaft does.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NearestEdge {
    kernel: Kernel,
    k: u32,
    density: f64,
    decay: f64,
    cap: f64,
}

impl NearestEdge {
    /// # Arguments
    /// `k` 2 to 1e6; `density` of points inside the shaft at the probe's depth \[1/length^3\]; `decay`
    /// \[1/length\]; `cap` the largest radius \[length\], decay times cap up to 5
    /// # Errors
    /// `Error::OutOfRange` naming the parameter
    pub fn new(kernel: Kernel, k: u32, density: f64, decay: f64, cap: f64) -> Result<Self> {
        within("k", f64::from(k), 2.0, 1e6, "2 to 1e6")?;
        within("density", density, 1e-100, 1e100, "1e-100 to 1e100")?;
        within("cap", cap, 1e-30, 1e30, "1e-30 to 1e30")?;
        within("decay", decay, 0.0, LARGEST_DECAY / cap, "0 to 5 over the cap")?;
        Edge::new(kernel, 0.0)?;
        Ok(NearestEdge { kernel, k, density, decay, cap })
    }

    /// Radius of the ball that holds k points in the plateau, on average \[length\]: (3k/(4 pi density))^(1/3).
    pub fn plateau_radius(&self) -> f64 {
        libm::cbrt(3.0 * f64::from(self.k) / (4.0 * PI * self.density))
    }

    /// Expectation at `h` inside the edge (negative outside), over the field inside at the same depth \[1\].
    ///
    /// # Errors
    /// `Error::OutOfRange` naming `h`
    pub fn mean(&self, h: f64) -> Result<Value> {
        within("h", h, f64::MIN, f64::MAX, "finite numbers")?;
        let at = |kernel, r: f64| self.edge(kernel, r).image(h / r);
        nearest_expectation(
            self.k,
            self.cap,
            |r| if r > 0.0 { self.ball(r) * at(Kernel::Uniform, r) } else { 0.0 },
            |r| at(self.kernel, r),
        )
    }

    /// Expectation far inside, over the field there.
    ///
    /// # Errors
    /// none in practice: those of [`nearest_expectation`]
    pub fn plateau(&self) -> Result<Value> {
        let at = |kernel, r: f64| 2.0 * self.edge(kernel, r).below(0.0);
        nearest_expectation(
            self.k,
            self.cap,
            |r| if r > 0.0 { self.ball(r) * at(Kernel::Uniform, r) } else { 0.0 },
            |r| at(self.kernel, r),
        )
    }

    /// Where the expectation has this share of the plateau \[length\], negative outside.
    ///
    /// # Arguments
    /// `level` 0.01 to 0.99
    /// # Returns
    /// the bound brackets the crossing: the expectation rises with h
    /// # Errors
    /// `Error::OutOfRange` naming `level`
    pub fn place(&self, level: f64) -> Result<Value> {
        within("level", level, 0.01, 0.99, "0.01 to 0.99")?;
        let plateau = self.plateau()?;
        let target = level * plateau.value;
        let excess = |h: f64| self.mean(h).map(|v| (v.value - target, v.error + level * plateau.error));
        let reach = self.cap.min(8.0 * self.plateau_radius());
        let (mut low, mut high) = (-reach, reach);
        let (mut below, mut above) = (excess(low)?.0, excess(high)?.0);
        let (mut at, mut last) = (0.0, 0.0f64);
        for step in 0..100 {
            let slope = (above - below) / (high - low);
            at = low - below / slope;
            if step % 8 == 7 || !(at > low && at < high) {
                at = 0.5 * (low + high);
            }
            let (value, error) = excess(at)?;
            if value.abs() <= error || high - low < 1e-13 * reach {
                break;
            }
            // The Illinois rule: an end that stays counts half the next time.
            if value < 0.0 {
                (low, below) = (at, value);
                above *= if last < 0.0 { 0.5 } else { 1.0 };
            } else {
                (high, above) = (at, value);
                below *= if last > 0.0 { 0.5 } else { 1.0 };
            }
            last = value;
        }
        // Wide enough that the expectation is beyond the level on both sides, its own bound included.
        let mut error = 1e-13 * self.plateau_radius();
        loop {
            let ((left, a), (right, b)) = (excess(at - error)?, excess(at + error)?);
            if (left < -a && right > b) || error > reach {
                return Ok(Value::new(at, error, "false position, bracketed"));
            }
            error *= 4.0;
        }
    }

    /// Distance over which the expectation rises from 10 to 90 per cent of the plateau \[length\].
    ///
    /// # Errors
    /// none in practice: those of [`NearestEdge::place`]
    /// # Limits
    /// no decay, large cap, uniform kernel, over the plateau radius: 1.895, 1.923, 1.932, 1.940 for k = 20, 50, 100, 1000,
    /// where a fixed radius has 1.217
    pub fn rise_width(&self) -> Result<Value> {
        let (low, high) = (self.place(0.1)?, self.place(0.9)?);
        Ok(Value::new(high.value - low.value, high.error + low.error, high.method))
    }

    /// Inverse slope of the expectation at the edge, over the plateau \[length\].
    ///
    /// With lambda(r, h) points and the mean M(r, h) in the fixed radius r, the slope is the expectation of M's
    /// derivative in h where lambda stays, M_h - M_r lambda_h/lambda_r; at the cap M_h alone.
    /// # Errors
    /// none in practice: those of [`nearest_expectation`]
    /// # Limits
    /// no decay, large cap, uniform kernel: (4/3) (2/k)^(1/3) Gamma(k-1)/Gamma(k-4/3) plateau radii
    pub fn equivalent_width(&self) -> Result<Value> {
        let by_place = |r: f64| self.edge(self.kernel, r).slope(0.0) / r;
        let along = |r: f64| {
            let uniform = self.edge(Kernel::Uniform, r);
            let growth = 3.0 * uniform.below(0.0) / r + 0.5 * self.decay * uniform.plateau_slope();
            let by_radius = 0.5 * self.decay * self.edge(self.kernel, r).plateau_slope();
            by_place(r) - by_radius * uniform.slope(0.0) / (r * growth)
        };
        let number = |r: f64| {
            if r > 0.0 { self.ball(r) * self.edge(Kernel::Uniform, r).below(0.0) } else { 0.0 }
        };
        let slope = nearest_expectation(self.k, self.cap, number, along)?;
        let full = at_most(self.k - 2, number(self.cap)) * (by_place(self.cap) - along(self.cap));
        let (value, plateau) = (slope.value + full, self.plateau()?);
        let relative = (slope.error + 1e-13 * full.abs()) / value + plateau.error / plateau.value;
        let width = plateau.value / value;
        Ok(Value::new(width, width * (relative + 4.0 * f64::EPSILON), slope.method))
    }

    fn edge(&self, kernel: Kernel, r: f64) -> Edge {
        Edge { kernel, s: self.decay * r }
    }

    /// Points in a ball far inside, but for the decay.
    fn ball(&self, r: f64) -> f64 {
        self.density * Dimension::Three.ball_volume() * r * r * r
    }
}
