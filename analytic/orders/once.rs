//! Light that a beam has scattered once: closed in depth, one integral over the cosine of its direction.

use super::scattering::{legendre, mean_phase};
use crate::error::Result;
use crate::phase::Phase;
use crate::quadrature::Adaptive;
use crate::slab_single::path;
use crate::value::Value;
use std::f64::consts::PI;

const METHOD: &str = "closed in depth, two Gauss rules over the cosine";

/// Phase functions with more moments than a list may have are closed forms.
const SERIES: usize = 2000;

/// The first order of a beam's light.
pub(super) struct Once {
    tau: f64,
    albedo: f64,
    mu0: f64,
    phase: Phase,
    /// Of a phase function that is their sum; none for a closed form.
    moments: Vec<f64>,
    /// P_l(mu0).
    table: Vec<f64>,
}

impl Once {
    pub fn new(tau: f64, albedo: f64, phase: &Phase, mu0: f64) -> Self {
        let degree = phase.degree(0.0, SERIES + 1);
        let end = if degree > SERIES { 0 } else { degree + 1 };
        let moments: Vec<f64> = (0..end).map(|l| phase.moment(l)).collect();
        let table = legendre(moments.len(), mu0);
        Once { tau, albedo, mu0, phase: phase.clone(), moments, table }
    }

    /// h(mu, -mu0), and the size of the terms that it is a sum of.
    fn mean(&self, mu: f64) -> (f64, f64) {
        if self.moments.is_empty() {
            let h = 4.0 * PI * self.phase.azimuthal_mean(mu, -self.mu0);
            (h, 8.0 * h)
        } else {
            mean_phase(&self.moments, -mu, &self.table)
        }
    }

    /// R_1 = (albedo/2) int_0^1 mu h(mu, -mu0) path dmu.
    pub fn reflectance(&self) -> Result<Value> {
        self.integral(|mu| mu * path(0.0, self.tau, self.mu0, mu), None, [0.0, self.tau])
    }

    /// T_1 = (albedo/2) int_0^1 mu h(-mu, -mu0) path dmu.
    pub fn transmittance(&self) -> Result<Value> {
        self.integral(|_| 0.0, Some(&|mu: f64| mu * path(self.tau, 0.0, self.mu0, -mu)), [self.tau, 0.0])
    }

    /// phi_1(t) = (albedo/2) int_(-1)^1 h(mu, -mu0) path dmu.
    pub fn fluence(&self, t: f64) -> Result<Value> {
        let rest = self.tau - t;
        self.integral(
            |mu| path(t, rest, self.mu0, mu),
            Some(&|mu: f64| path(t, rest, self.mu0, -mu)),
            [t, rest],
        )
    }

    /// (albedo/2) int_0^1 \[h(mu, -mu0) up(mu) + h(-mu, -mu0) down(mu)\] dmu; the light changes on the scales of mu given.
    fn integral(
        &self,
        up: impl Fn(f64) -> f64,
        down: Option<&dyn Fn(f64) -> f64>,
        scales: [f64; 2],
    ) -> Result<Value> {
        let mut breaks = vec![0.0, 1.0, self.mu0];
        for scale in scales.into_iter().filter(|&s| s > 0.0) {
            breaks.extend([1e-3, 0.03, 0.3, 3.0, 100.0].map(|f| (f * scale.min(1.0)).min(1.0)));
        }
        breaks.sort_by(f64::total_cmp);
        breaks.dedup();
        let sum_of = |pick: fn((f64, f64)) -> f64, tolerance: f64| {
            Adaptive::new(tolerance).integrate(&breaks, "radiance", METHOD, |mu| {
                let mut value = 0.0;
                for (sign, path) in [(1.0, up(mu)), (-1.0, down.map_or(0.0, |f| f(mu)))] {
                    if path != 0.0 {
                        value += pick(self.mean(sign * mu)) * path;
                    }
                }
                Ok(value)
            })
        };
        let sum = sum_of(|(h, _)| h, 1e-14)?;
        // The series cancels at all angles but the peak: its roundings are those of its largest terms.
        let terms = sum_of(|(_, magnitude)| magnitude, 0.1)?;
        let exponent = (2.0 * scales[0] / self.mu0).min(1500.0);
        let rounding = f64::EPSILON * ((32.0 + exponent) * sum.value.abs() + 8.0 * terms.value);
        Ok(Value::new(sum.value, sum.error + rounding, METHOD).scaled(0.5 * self.albedo))
    }
}
