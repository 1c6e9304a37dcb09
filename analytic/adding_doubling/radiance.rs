//! Radiance in any direction: azimuthal modes of light scattered at least twice, and single scattering as it is.
//!
//! I(t, mu, dphi) = sum_m (2 - delta_m0) I_m(t, mu) cos(m dphi), each mode a slab of its own in which the beam and
//! the direction looked at are directions without weight. From each mode its own single scattering is taken out, so
//! that what is left dies away soon with m, and the peak of the phase function is never summed.

use super::nodes::{Nodes, legendre};
use super::{AddingDoubling, CUT_TWICE, LOWER, METHOD, MOST, Stack, degrees, entering, upper};
use crate::error::{Result, within};
use crate::incidence::{Incidence, check_depth};
use crate::phase::Phase;
use crate::slab_single::beam_path;
use crate::value::Value;
use libm::{cos, sin, sqrt};
use nalgebra::DVector;
use std::f64::consts::PI;

/// A mode below this share of the sum, twice in a row, is the last one.
pub(crate) const LAST: f64 = 1e-11;

impl AddingDoubling {
    /// Radiance of scattered light at depth t in the direction of signed cosine mu, per unit irradiance.
    ///
    /// # Arguments
    /// `t` depth in mean free paths, 0 to tau; `mu` -1 to 1, positive towards the lit face, at least 1e-5 from 0;
    /// `dphi` azimuth of the direction of travel minus that of the beam \[rad\], without effect in diffuse light
    /// # Returns
    /// \[1/sr\]; every query doubles the slab in all modes anew, which takes a second where there are many
    /// # Errors
    /// `Error::OutOfRange` naming `t`, `mu` or `dphi`
    pub fn radiance(&self, t: f64, mu: f64, dphi: f64) -> Result<Value> {
        check_depth(t, self.tau)?;
        within("mu", mu, -1.0, 1.0, "-1 to 1")?;
        within("mu", mu.abs(), 1e-5, 1.0, "1e-5 or more in magnitude with adding and doubling")?;
        within("dphi", dphi, -1e6, 1e6, "-1e6 to 1e6")?;
        let Incidence::Beam { mu0 } = self.incidence else {
            let all = degrees(&self.phase)?;
            let [fine, coarse] = [self.mode(0, all[0], 0, t, mu)?, self.mode(1, all[1], 0, t, mu)?];
            let error = 2.0 * (fine - coarse).abs() + self.rounding * fine.abs();
            return Ok(Value::new(fine, error + f64::MIN_POSITIVE, METHOD));
        };
        let path = self.albedo * beam_path(self.tau, mu0, t, mu);
        let [minus, plus] = deflection(mu0, mu, dphi);
        let single = path * self.phase.value_of(minus, plus);
        let degrees = CUT_TWICE.map(|cut| self.phase.degree(cut, MOST));
        let (mut sum, mut difference, mut magnitude, mut tail) = (0.0, 0.0, single.abs(), 0.0);
        let mut small = 0;
        for m in 0..=degrees[0] {
            let weight = if m == 0 { 1.0 } else { 2.0 };
            let several = |i: usize| -> Result<f64> {
                Ok(self.mode(i, degrees[i], m, t, mu)?
                    - path * single_mode(&self.phase, degrees[i], m, mu0, mu))
            };
            let [fine, coarse] = [several(0)?, several(1)?];
            sum += weight * fine * cos(m as f64 * dphi);
            difference += weight * (fine - coarse).abs();
            magnitude += weight * fine.abs();
            small = if (weight * fine).abs() <= LAST * magnitude { small + 1 } else { 0 };
            if small == 2 {
                // What follows falls like the square of the moments, at least.
                tail = 16.0 * LAST * magnitude;
                break;
            }
        }
        let value = single + sum;
        let rounding = (self.rounding + 16.0 * f64::EPSILON * (1.0 + self.tau / mu0).min(800.0)) * magnitude;
        Ok(Value::new(value, 2.0 * difference + rounding + tail + f64::MIN_POSITIVE, METHOD))
    }

    /// I_m at depth t and cosine mu on nodes i, single scattering included.
    fn mode(&self, i: usize, degree: usize, m: usize, t: f64, mu: f64) -> Result<f64> {
        let mut users = match self.incidence {
            Incidence::Beam { mu0 } => vec![mu0],
            Incidence::Diffuse => Vec::new(),
        };
        users.push(mu.abs());
        if m > degree {
            return Ok(0.0);
        }
        let nodes = Nodes::open(upper(i, degree), LOWER[i]).with(&users);
        let moments: Vec<f64> = (0..=degree).map(|l| self.phase.moment(l)).collect();
        let last = nodes.len() - 1;
        let stack = Stack::new(self.tau, self.albedo, &moments, m, nodes)?;
        let dark = DVector::zeros(last + 1);
        let (down, up) = stack.field(t, entering(&stack.nodes, self.incidence), dark);
        let u = if mu > 0.0 { up[last] } else { down[last] };
        Ok(u / sqrt(stack.nodes.mu[last] * stack.nodes.weight[last]))
    }
}

/// Mode m of a phase function up to `degree`, between the beam and mu.
pub(crate) fn single_mode(phase: &Phase, degree: usize, m: usize, mu0: f64, mu: f64) -> f64 {
    if m > degree {
        return 0.0;
    }
    let (a, b) = (legendre(m, degree, mu0), legendre(m, degree, mu.abs()));
    let terms = (m..=degree).map(|l| {
        // The beam goes down: up it turns P_l^m by (-1)^(l+m).
        let sign = if mu > 0.0 && (l + m) % 2 == 1 { -1.0 } else { 1.0 };
        sign * (2.0 * l as f64 + 1.0) * phase.moment(l) * a[l - m] * b[l - m]
    });
    terms.sum::<f64>() / (4.0 * PI)
}

fn sine(mu: f64) -> f64 {
    sqrt((1.0 - mu) * (1.0 + mu))
}

/// One minus and one plus the cosine of the deflection from the beam, each as half a squared distance.
pub(crate) fn deflection(mu0: f64, mu: f64, dphi: f64) -> [f64; 2] {
    let (s0, s) = (sine(mu0), sine(mu));
    let lateral = if s0 + s > 0.0 { (mu - mu0) * (mu + mu0) / (s0 + s) } else { 0.0 };
    let of =
        |turn: f64, normal: f64| 0.5 * (lateral * lateral + 4.0 * s0 * s * turn * turn + normal * normal);
    [of(sin(0.5 * dphi), mu + mu0), of(cos(0.5 * dphi), mu - mu0)]
}
