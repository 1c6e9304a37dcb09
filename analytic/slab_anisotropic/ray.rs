//! Radiance in any direction: the source function of the modes along a ray, integrated mode by mode.
//!
//! What arrives at depth t with cosine mu is int J e^(-|t-t'|/|mu|) dt'/|mu| over the way from the face. J is what
//! light in the nodes scatters: of a beam, light that has been scattered before; of diffuse incidence, all light. So
//! the integral is the radiance scattered at least twice, or at least once, at directions that need not be nodes,
//! and it is smoother than the light in the nodes by one order.

use super::convolution::{falling, three, two};
use super::solution::{Basis, Beam, SLOW, Solution, Sum, decayed};
use libm::exp;
use nalgebra::DVector;

/// Where the ray is: depth, what lies below, the way to the face it comes from, 1/|mu|, and whether it goes up.
#[derive(Clone, Copy)]
pub(super) struct Ray {
    pub t: f64,
    pub rest: f64,
    pub c: f64,
    pub up: bool,
}

/// What a beam e^(-beta t) feeds into e^(-k t) upwards, e^(-beta t) (1 - e^(-(k+beta) (tau-t)))/(k+beta), and
/// downwards, int_0^t e^(-beta s) e^(-k (t-s)) ds, integrated along a ray but for the factor c.
fn fed(k: f64, beta: f64, Ray { t, rest, c, up }: Ray) -> (f64, f64) {
    let (a, fallen) = (k + beta, falling(beta, t));
    if up {
        (
            fallen * three(0.0, a, c + beta, rest),
            two(k, beta, t) * two(0.0, c + k, rest) + fallen * three(0.0, c + k, c + beta, rest),
        )
    } else {
        (
            decayed(a, rest) * two(beta, c, t) + falling(a, rest) * three(beta, c, c + a, t),
            three(k, beta, c, t),
        )
    }
}

/// Paths of light from a beam at `mu0` by way of +-`between` into `mu` (signed) at depth t: the integrals of all three
/// exponentials over the two collisions, for the way up and the way down in between.
pub(super) fn two_collisions(tau: f64, mu0: f64, between: f64, t: f64, mu: f64) -> [f64; 2] {
    let (beta, k, rest) = (1.0 / mu0, 1.0 / between, tau - t);
    if mu == 0.0 {
        return [beta * k * falling(beta, t) * decayed(k + beta, rest), beta * k * two(k, beta, t)];
    }
    let c = 1.0 / mu.abs();
    let (rising, sinking) = fed(k, beta, Ray { t, rest, c, up: mu > 0.0 });
    [beta * rising * k * c, beta * sinking * k * c]
}

/// Integrals along the ray of xi and eta of a mode, with the magnitude of the terms of the first and the second.
#[derive(Clone, Copy, Default)]
struct Along {
    xi: f64,
    eta: f64,
    xi_size: f64,
    eta_size: f64,
}

impl Along {
    fn add(&mut self, xi: f64, eta: f64, exponent: f64) {
        self.xi += xi;
        self.eta += eta;
        self.xi_size += xi.abs() * (1.0 + exponent);
        self.eta_size += eta.abs() * (1.0 + exponent);
    }
}

impl Solution {
    /// The part of the radiance at depth `t` and cosine `mu`, not 0, that the modes scatter last, per cos(m dphi);
    /// `source` is [`super::modes::Modes::source`] at |`mu`|.
    pub fn last_scattered(&self, t: f64, mu: f64, source: &[DVector<f64>; 2]) -> Sum {
        let ray = Ray { t, rest: self.tau - t, c: 1.0 / mu.abs(), up: mu > 0.0 };
        self.over_modes(source, ray.up, |j, k| {
            let mut along = self.homogeneous(j, k, ray);
            if let Some(beam) = &self.beam {
                beam.along(j, k, ray, &mut along);
            }
            along
        })
    }

    /// The source function itself, at mu = 0: what arrives along the horizon.
    pub fn along_horizon(&self, t: f64, source: &[DVector<f64>; 2]) -> Sum {
        let rest = self.tau - t;
        self.over_modes(source, true, |j, k| {
            let mut along = Along::default();
            let (shapes, slopes) = self.shapes(k, t, rest);
            let length = k * t.min(rest);
            along.add(self.first[j] * shapes[0], self.first[j] * slopes[0], length);
            along.add(self.second[j] * shapes[1], self.second[j] * slopes[1], length);
            if let Some(beam) = &self.beam {
                let [xi, eta, size] = beam.particular(j, k, t, rest);
                along.add(xi, eta, 0.0);
                along.xi_size += size;
                along.eta_size += k * size;
            }
            along
        })
    }

    fn over_modes(&self, source: &[DVector<f64>; 2], up: bool, f: impl Fn(usize, f64) -> Along) -> Sum {
        let mut sum = Sum::ZERO;
        for (j, &k) in self.modes.k.iter().enumerate() {
            let along = f(j, k);
            let (even, odd) = (source[0][j], if up { source[1][j] } else { -source[1][j] });
            sum = sum.plus(
                even * along.xi + odd * along.eta,
                (even * along.xi_size).abs() + (odd * along.eta_size).abs(),
            );
        }
        sum
    }

    /// Both solutions of mode j.
    fn homogeneous(&self, j: usize, k: f64, Ray { t, rest, c, up }: Ray) -> Along {
        let mut along = Along::default();
        let (first, second) = (self.first[j], self.second[j]);
        if self.basis == Basis::Halves && k * self.tau <= 1.0 {
            // f(t +- y) = f cosh(k y) +- f' sinh(k y)/k.
            let (shapes, slopes) = self.shapes(k, t, rest);
            let way = if up { rest } else { t };
            let even = 0.5 * c * (two(0.0, c - k, way) + two(0.0, c + k, way));
            let odd = c * three(0.0, c - k, c + k, way) * if up { 1.0 } else { -1.0 };
            for (amplitude, shape, slope) in [(first, shapes[0], slopes[0]), (second, shapes[1], slopes[1])] {
                along.add(amplitude * shape * even, amplitude * slope * even, 1.0);
                along.add(amplitude * slope * odd, amplitude * k * k * shape * odd, 1.0);
            }
            return along;
        }
        let (down, rise) = match self.basis {
            Basis::Halves => {
                let norm = 1.0 / (1.0 + exp(-k * self.tau));
                ((first - second / k) * norm, (first + second / k) * norm)
            }
            Basis::Faces | Basis::Deep => (first, second),
        };
        let (from_top, from_bottom) = if up {
            (falling(k, t) * c * two(0.0, c + k, rest), if rise == 0.0 { 0.0 } else { c * two(k, c, rest) })
        } else {
            (c * two(k, c, t), if rise == 0.0 { 0.0 } else { falling(k, rest) * c * two(0.0, c + k, t) })
        };
        let (a, b) = (down * from_top, rise * from_bottom);
        along.add(a, -k * a, k * t);
        along.add(b, k * b, if rise == 0.0 { 0.0 } else { k * rest });
        along
    }
}

impl Beam {
    /// The particular solution of mode j.
    fn along(&self, j: usize, k: f64, Ray { t, rest, c, up }: Ray, along: &mut Along) {
        let (beta, pi, kappa) = (self.beta, self.pi[j], self.kappa[j]);
        let fallen = falling(beta, t);
        if k < SLOW {
            let x = (beta * kappa - pi) / (beta * beta - k * k);
            let path = if up { fallen * c * two(0.0, c + beta, rest) } else { c * two(beta, c, t) };
            along.add(x * path, (kappa - beta * x) * path, beta * t);
            return;
        }
        let (rising, sinking) = fed(k, beta, Ray { t, rest, c, up });
        let (rising, sinking) = ((k * kappa + pi) * c * rising, (pi - k * kappa) * c * sinking);
        let exponent = k.min(beta) * t;
        along.add(rising / (2.0 * k), 0.5 * rising, exponent);
        along.add(sinking / (2.0 * k), -0.5 * sinking, exponent);
    }
}
