//! Spectrum: three channels (linear red, green, blue); grey is three equal ones.

use glam::DVec3;
use std::ops::{Add, AddAssign, Div, Index, Mul, MulAssign, Sub};

/// A quantity by channel; its unit is that of the quantity it holds.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Spectrum(pub DVec3);

impl Spectrum {
    /// Nothing in any channel.
    pub const ZERO: Spectrum = Spectrum(DVec3::ZERO);
    /// One in every channel.
    pub const ONE: Spectrum = Spectrum(DVec3::ONE);

    /// The same value in every channel.
    pub const fn grey(value: f64) -> Self {
        Spectrum(DVec3::splat(value))
    }

    /// One value a channel.
    pub const fn rgb(r: f64, g: f64, b: f64) -> Self {
        Spectrum(DVec3::new(r, g, b))
    }

    /// Whether the three channels are equal.
    pub fn is_grey(self) -> bool {
        self.0.x == self.0.y && self.0.y == self.0.z
    }

    /// Whether every channel is exactly zero.
    pub fn is_black(self) -> bool {
        self.0 == DVec3::ZERO
    }

    /// Whether every channel is finite.
    pub fn is_finite(self) -> bool {
        self.0.is_finite()
    }

    /// Sum over channels.
    pub fn sum(self) -> f64 {
        self.0.x + self.0.y + self.0.z
    }

    /// Mean over channels; exact for grey ones whose sum does not round.
    pub fn mean(self) -> f64 {
        if self.is_grey() { self.0.x } else { self.sum() / 3.0 }
    }

    /// Largest channel.
    pub fn max(self) -> f64 {
        self.0.max_element()
    }

    /// Smallest channel.
    pub fn min(self) -> f64 {
        self.0.min_element()
    }

    /// The quotient by channel, and 0 where the divisor is: what never collides has left nothing to be divided.
    pub fn over(self, other: Spectrum) -> Self {
        let over = |a: f64, b: f64| if b == 0.0 { 0.0 } else { a / b };
        Spectrum::rgb(over(self[0], other[0]), over(self[1], other[1]), over(self[2], other[2]))
    }

    /// A function applied to each channel.
    pub fn map(self, f: impl Fn(f64) -> f64) -> Self {
        Spectrum(DVec3::new(f(self.0.x), f(self.0.y), f(self.0.z)))
    }
}

impl Add for Spectrum {
    type Output = Spectrum;
    fn add(self, other: Spectrum) -> Spectrum {
        Spectrum(self.0 + other.0)
    }
}

impl AddAssign for Spectrum {
    fn add_assign(&mut self, other: Spectrum) {
        self.0 += other.0;
    }
}

impl Sub for Spectrum {
    type Output = Spectrum;
    fn sub(self, other: Spectrum) -> Spectrum {
        Spectrum(self.0 - other.0)
    }
}

impl Mul for Spectrum {
    type Output = Spectrum;
    fn mul(self, other: Spectrum) -> Spectrum {
        Spectrum(self.0 * other.0)
    }
}

impl MulAssign for Spectrum {
    fn mul_assign(&mut self, other: Spectrum) {
        self.0 *= other.0;
    }
}

impl Div for Spectrum {
    type Output = Spectrum;
    fn div(self, other: Spectrum) -> Spectrum {
        Spectrum(self.0 / other.0)
    }
}

impl Mul<f64> for Spectrum {
    type Output = Spectrum;
    fn mul(self, factor: f64) -> Spectrum {
        Spectrum(self.0 * factor)
    }
}

impl MulAssign<f64> for Spectrum {
    fn mul_assign(&mut self, factor: f64) {
        self.0 *= factor;
    }
}

impl Div<f64> for Spectrum {
    type Output = Spectrum;
    fn div(self, divisor: f64) -> Spectrum {
        Spectrum(self.0 / divisor)
    }
}

impl Index<usize> for Spectrum {
    type Output = f64;
    fn index(&self, channel: usize) -> &f64 {
        match channel {
            0 => &self.0.x,
            1 => &self.0.y,
            _ => &self.0.z,
        }
    }
}
