//! The same slab order by order: phi_n = (albedo/2) K phi_(n-1), order 0 the direct light.

use super::IsotropicSlab;
use super::equation::{Iterate, METHOD, ULPS, flux_of, residual, source};
use crate::beer_lambert::uncollided_fluence;
use crate::error::{Result, within};
use crate::exponential_integral::e_n;
use crate::incidence::{Incidence, check_depth};
use crate::value::Value;
use std::sync::PoisonError;

impl IsotropicSlab {
    /// Fluence of light scattered exactly n times \[1\].
    ///
    /// phi_n = (albedo/2) int E_1(|t-t'|) phi_(n-1)(t') dt', phi_0 the direct light.
    /// # Arguments
    /// `n` order, 0 to 1000; `t` depth in mean free paths, 0 to tau
    /// # Errors
    /// `Error::OutOfRange` naming `n` or `t`
    pub fn fluence_of_order(&self, n: u32, t: f64) -> Result<Value> {
        check_order(n)?;
        check_depth(t, self.tau)?;
        if n == 0 {
            return uncollided_fluence(self.incidence, t);
        }
        if n == self.first_order() {
            let value = source(self.albedo, self.incidence, t, self.tau - t);
            return Ok(Value::new(value, rounding(value), METHOD));
        }
        let before = self.iterate(n - 1);
        let (value, bound) = self.through_kernel(t, &before.values, &before.bound);
        Ok(Value::new(value, bound + rounding(value), METHOD))
    }

    /// Fraction of the incident power that leaves the lit face after exactly n scatterings \[1\].
    ///
    /// # Errors
    /// `Error::OutOfRange` naming `n`
    pub fn reflectance_of_order(&self, n: u32) -> Result<Value> {
        check_order(n)?;
        if n == 0 {
            return Ok(Value::new(0.0, 0.0, "direct light is not reflected"));
        }
        if n == 1 && self.first_order() == 1 {
            return Ok(self.once_up);
        }
        Ok(self.flux_of_order(n, |t, _| e_n(2, t)))
    }

    /// Fraction of the incident power that leaves the far face after exactly n scatterings \[1\].
    ///
    /// # Errors
    /// `Error::OutOfRange` naming `n`
    pub fn transmittance_of_order(&self, n: u32) -> Result<Value> {
        check_order(n)?;
        if n == 0 {
            return Ok(self.transmittance_direct());
        }
        if n == 1 && self.first_order() == 1 {
            return Ok(self.once_down);
        }
        Ok(self.flux_of_order(n, |_, rest| e_n(2, rest)))
    }

    fn flux_of_order(&self, n: u32, kernel: impl Fn(f64, f64) -> f64) -> Value {
        let before = self.iterate(n - 1);
        let nothing = Value::new(0.0, 0.0, METHOD);
        flux_of(&self.operator, self.albedo, &before.values, &before.bound, nothing, kernel)
    }

    /// The first order that is a polynomial on the panels, known in closed form.
    fn first_order(&self) -> u32 {
        match self.incidence {
            Incidence::Beam { .. } => 1,
            Incidence::Diffuse => 0,
        }
    }

    /// Iterate of order n, at least the first; made from its predecessors, which are kept.
    fn iterate(&self, n: u32) -> Iterate {
        let index = (n - self.first_order()) as usize;
        let mut kept = self.iterates.lock().unwrap_or_else(PoisonError::into_inner);
        let half = 0.5 * self.albedo;
        let mesh = &self.operator.mesh;
        while kept.len() <= index {
            let next = match kept.last() {
                None => {
                    let value = |t, rest| source(self.albedo, self.incidence, t, rest);
                    let values = mesh.halves(value);
                    let bound = residual(&self.operator, &values, None, |i| {
                        let x = self.operator.probes[i].x;
                        (value(x, self.tau - x), value(self.tau - x, x))
                    });
                    Iterate { values, bound }
                }
                Some(before) => {
                    let image = self.operator.apply(&before.values);
                    let values = image.zip(&image, |k, _| half * k);
                    let interpolation = residual(&self.operator, &values, None, |i| {
                        let (a, b) = self.operator.at_probe(&self.operator.probes[i], &before.values);
                        (half * a, half * b)
                    });
                    let carried = self.operator.apply(&before.bound);
                    let bound = interpolation.zip(&carried, |r, k| r + (half * k).abs());
                    Iterate { values, bound }
                }
            };
            kept.push(next);
        }
        kept[index].clone()
    }
}

fn check_order(n: u32) -> Result<()> {
    within("n", f64::from(n), 0.0, 1000.0, "0 to 1000").map(|_| ())
}

fn rounding(value: f64) -> f64 {
    2.0 * ULPS * f64::EPSILON * value + f64::MIN_POSITIVE
}
