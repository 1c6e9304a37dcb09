//! Light that was never scattered: refracted, and thrown to and fro between the faces.

use super::face::Face;
use crate::error::Result;
use crate::incidence::Incidence;
use crate::quadrature::Adaptive;
use crate::value::Value;
use libm::{exp, expm1, sqrt};

const METHOD: &str = "closed form";

/// Unscattered light of a slab between two like faces.
pub(super) struct Direct {
    pub face: Face,
    pub tau: f64,
    pub incidence: Incidence,
}

impl Direct {
    /// Cosine of the beam inside.
    pub fn beam(&self) -> Option<f64> {
        match self.incidence {
            Incidence::Beam { mu0 } => self.face.inside(mu0),
            Incidence::Diffuse => None,
        }
    }

    /// Irradiance within the medium on the lit face, of the beam and all its echoes: (1-r)/(1 - r^2 e^2).
    pub fn entering(&self) -> f64 {
        let (Incidence::Beam { mu0 }, Some(mu)) = (self.incidence, self.beam()) else { return 0.0 };
        let (r, t) = self.face.reflected(mu, mu0);
        let echo = r * faded(self.tau, mu);
        t / (1.0 - echo * echo)
    }

    /// What one passage and one reflection leave of light at cosine `mu`: r e.
    pub fn echo(&self, mu: f64) -> f64 {
        self.face.reflected_inside(mu).0 * faded(self.tau, mu)
    }

    /// Power that meets with a first collision: the integral of the fluence over depth.
    pub fn collided(&self) -> Result<Value> {
        let lost = |inside: f64, r: f64, through: f64| {
            let echo = r * faded(self.tau, inside);
            through * -expm1(-self.tau / inside) / (1.0 - echo)
        };
        match self.incidence {
            Incidence::Beam { mu0 } => {
                let Some(mu) = self.face.inside(mu0) else { return Ok(Value::new(0.0, 0.0, METHOD)) };
                let (r, through) = self.face.reflected(mu, mu0);
                Ok(Value::rounded(lost(mu, r, through), 32.0, METHOD))
            }
            Incidence::Diffuse => self.mean(&|inside, outside| {
                let (r, through) = self.face.reflected(inside, outside);
                lost(inside, r, through)
            }),
        }
    }

    /// Radiance times pi at cosine `mu` inside and depth `t`, both senses together, of Lambertian light.
    pub fn radiance(&self, mu: f64, t: f64) -> f64 {
        let (r, through) = self.face.reflected_inside(mu);
        self.face.spread() * through * self.both(mu, r, t)
    }

    /// e^(-t/mu) + r e^(-(2 tau-t)/mu), over 1 - r^2 e^(-2 tau/mu).
    fn both(&self, mu: f64, r: f64, t: f64) -> f64 {
        let echo = r * faded(self.tau, mu);
        (faded(t, mu) + r * faded(2.0 * self.tau - t, mu)) / (1.0 - echo * echo)
    }

    /// What returns at the lit face without entering.
    pub fn specular(&self) -> Result<Value> {
        match self.incidence {
            Incidence::Beam { mu0 } => {
                let r = self.face.inside(mu0).map_or(1.0, |mu| self.face.reflected(mu, mu0).0);
                // n^2 - 1 and the cosines are good to a few roundings; r_p may vanish at Brewster's angle.
                Ok(Value::new(r, 32.0 * f64::EPSILON * r.max(1e-8 * (1.0 - r)), METHOD))
            }
            Incidence::Diffuse => self.face.diffuse(true),
        }
    }

    /// What leaves through the lit face after at least one passage of the slab and no scattering.
    pub fn returned(&self) -> Result<Value> {
        self.flux(|r, e| r * e * e)
    }

    /// What leaves through the far face without scattering.
    pub fn transmitted(&self) -> Result<Value> {
        self.flux(|_, e| e)
    }

    /// (1-r)^2 f(r, e)/(1 - r^2 e^2), or its mean over Lambertian light.
    fn flux(&self, f: impl Fn(f64, f64) -> f64) -> Result<Value> {
        let of = |inside: f64, outside: f64| {
            let (r, t) = self.face.reflected(inside, outside);
            let e = faded(self.tau, inside);
            t * t * f(r, e) / (1.0 - r * r * e * e)
        };
        match self.incidence {
            Incidence::Beam { mu0 } => {
                let Some(mu) = self.face.inside(mu0) else { return Ok(Value::new(0.0, 0.0, METHOD)) };
                let roundings = 32.0 + 4.0 * (self.tau / mu).min(800.0);
                Ok(Value::rounded(of(mu, mu0), roundings, METHOD))
            }
            Incidence::Diffuse => self.mean(&of),
        }
    }

    /// Fluence at depth t of light that was never scattered.
    pub fn fluence(&self, t: f64) -> Result<Value> {
        match self.incidence {
            Incidence::Beam { mu0 } => {
                let Some(mu) = self.face.inside(mu0) else { return Ok(Value::new(0.0, 0.0, METHOD)) };
                let (r, through) = self.face.reflected(mu, mu0);
                let value = through * self.both(mu, r, t) / mu;
                let roundings = 32.0 + 4.0 * ((2.0 * self.tau - t) / mu).min(800.0);
                Ok(Value::rounded(value, roundings, METHOD))
            }
            Incidence::Diffuse => self.mean(&|inside, outside| {
                let (r, through) = self.face.reflected(inside, outside);
                through * self.both(inside, r, t) / inside
            }),
        }
    }

    /// int_0^1 2 mu_o f dmu_o over the directions outside that enter.
    ///
    /// Beyond a denser medium's face in the cosine outside, of which all is analytic; else in the cosine inside.
    fn mean(&self, f: &dyn Fn(f64, f64) -> f64) -> Result<Value> {
        let face = self.face;
        let dense = face.critical() > 0.0;
        let spread = face.spread();
        let integrand = |mu: f64| {
            if mu <= 0.0 {
                return Ok(0.0);
            }
            let pair = if dense { (face.inside(mu), Some(mu)) } else { (Some(mu), face.outside(mu)) };
            let (Some(inside), Some(outside)) = pair else { return Ok(0.0) };
            let measure = if dense { 2.0 * outside } else { 2.0 * spread * inside };
            Ok(measure * f(inside, outside))
        };
        let scale = if dense { face.critical() } else { sqrt((1.0 - spread).max(0.0)) };
        let mut breaks = vec![0.0, 1.0];
        for start in [scale, self.tau] {
            breaks.extend((-3..30).map(|k| start * f64::powi(4.0, k)).filter(|&x| x > 1e-12 && x < 1.0));
        }
        breaks.sort_by(f64::total_cmp);
        Adaptive::new(1e-15).integrate(&breaks, "unscattered light", "quadrature", integrand)
    }
}

/// e^(-x/mu) and its like where x/mu overflows are 0.
pub(super) fn faded(x: f64, mu: f64) -> f64 {
    exp(-x / mu)
}
