//! The homogeneous slab between two smooth faces that refract: index n inside over 1 outside, the same on both sides.
//!
//! Within the slab light obeys the equation of [`crate::AnisotropicSlab`]; at each face a share r(mu) of it returns,
//!
//! I(0, -mu) = r(mu) I(0, mu) + entering light,  I(tau, mu) = r(mu) I(tau, -mu),  mu > 0
//!
//! with Fresnel's reflectance for unpolarised light. For n > 1 all light below the critical cosine
//! mu_c = root(1 - 1/n^2) returns; for n < 1 it is light from outside below root(1 - n^2) that never enters. A beam is
//! refracted to the cosine root(1 - (1 - mu0^2)/n^2) and goes to and fro as (1-r)/(1 - r^2 e^(-2 tau/mu)) of itself;
//! Lambertian light from outside has the radiance (1-r) n^2/pi inside, where it enters. What leaves is
//! (1-r) times what arrives at a face, per solid angle outside 1/n^2 times that.
//!
//! The directions are chosen so that the critical cosine is the edge of a rule in the root of mu - mu_c. Every answer
//! is computed on two sets of nodes, whose difference is the bound.
//!
//! Limits: n = 1 is [`crate::AnisotropicSlab`]; albedo 0 a plate of glass; albedo 1: R + T = 1; tau -> infinity:
//! reflection of a half-space behind a face.
//!
//! Source: Giovanelli 1955; van de Hulst 1980, chapter 4 (adding with a surface); Prahl, van Gemert and Welch 1993.

mod direct;
mod doubling;
mod face;

use crate::adding_doubling::bounded;
use crate::error::{Result, within};
use crate::incidence::{Incidence, check_albedo, check_depth};
use crate::value::Value;
use direct::Direct;
use doubling::Closed;
pub(crate) use face::Face;
use libm::log;

/// What the first Legendre moment left out, |g|^l, may be on the finer and on the coarser nodes.
const CUT: [f64; 2] = [1e-13, 1e-10];

/// Nodes towards the horizon, and the fewest of each panel above it.
const LOWER: [usize; 2] = [56, 44];
const UPPER: [usize; 2] = [36, 28];

/// Light of one solution: scattered, through the lit face, through the far one, and all that is absorbed.
#[derive(Debug, Clone, Copy)]
struct Fluxes {
    reflected: f64,
    transmitted: f64,
    absorbed: f64,
}

/// A solved slab between refracting faces.
pub struct FresnelSlab {
    direct: Direct,
    index: f64,
    albedo: f64,
    g: f64,
    solutions: [Closed; 2],
    specular: Value,
    reflectance_direct: Value,
    reflectance_diffuse: Value,
    transmittance_direct: Value,
    transmittance_diffuse: Value,
    absorptance: Value,
    rounding: f64,
}

impl FresnelSlab {
    /// Solves the slab by adding and doubling: the second method.
    ///
    /// # Arguments
    /// as for [`Self::new`], `tau` 1e-12 to 100
    /// # Errors
    /// as for [`Self::new`]
    pub fn by_doubling(tau: f64, albedo: f64, g: f64, index: f64, incidence: Incidence) -> Result<Self> {
        within("tau", tau, 1e-12, 100.0, "1e-12 to 100 with adding and doubling")?;
        check_albedo(albedo)?;
        within("g", g, -0.95, 0.95, "-0.95 to 0.95 between refracting faces")?;
        check_index(index)?;
        let face = Face::new(index);
        if let Incidence::Beam { mu0 } = incidence {
            within("mu0", mu0, 1e-5, 1.0, "1e-5 to 1 on a refracting face, or diffuse")?;
            if let Some(inside) = face.inside(mu0) {
                within("mu0", mu0, if inside < 1e-5 { 1.0 } else { 0.0 }, 1.0, "refracted to 1e-5 to 1")?;
            }
        }
        let direct = Direct { face, tau, incidence };
        let count = |cut: f64| if g == 0.0 { 1 } else { 1 + (log(cut) / log(g.abs())).ceil() as usize };
        let moments: Vec<f64> = (0..count(CUT[0])).map(|l| g.powi(l as i32)).collect();
        let solve = |i: usize| {
            let used = count(CUT[i]);
            let upper = UPPER[i].max(6 + i + used / 2);
            Closed::new(&direct, albedo, &moments[..used], (upper, LOWER[i]))
        };
        let solutions = [solve(0)?, solve(1)?];
        let pair = solutions.each_ref().map(Closed::fluxes);
        let fluxes = [pair.map(|f| f.reflected), pair.map(|f| f.transmitted), pair.map(|f| f.absorbed)];
        let rounding = 8.0 * f64::EPSILON * (solutions[0].doublings() as f64 + 4.0) * (1.0 + tau);
        let [reflectance_diffuse, transmittance_diffuse, absorptance] = bounded(fluxes, rounding);
        Ok(FresnelSlab {
            specular: direct.specular()?,
            reflectance_direct: direct.returned()?,
            transmittance_direct: direct.transmitted()?,
            direct,
            index,
            albedo,
            g,
            solutions,
            reflectance_diffuse,
            transmittance_diffuse,
            absorptance,
            rounding,
        })
    }

    /// What the lit face reflects before any light enters \[1\]; of Lambertian light, the hemispherical reflectance.
    pub fn specular(&self) -> Value {
        self.specular
    }

    /// Fraction of the incident power that leaves on the lit side: specular, unscattered from the far face, and
    /// scattered light \[1\].
    pub fn reflectance(&self) -> Value {
        sum(&[self.specular, self.reflectance_direct, self.reflectance_diffuse])
    }

    /// Fraction of the incident power that leaves through the lit face after at least one scattering \[1\].
    pub fn reflectance_diffuse(&self) -> Value {
        self.reflectance_diffuse
    }

    /// Fraction of the incident power that leaves through the far face \[1\].
    pub fn transmittance(&self) -> Value {
        sum(&[self.transmittance_direct, self.transmittance_diffuse])
    }

    /// Fraction of the incident power that leaves through the far face without scattering, echoes included \[1\].
    pub fn transmittance_direct(&self) -> Value {
        self.transmittance_direct
    }

    /// Fraction of the incident power that leaves through the far face after at least one scattering \[1\].
    pub fn transmittance_diffuse(&self) -> Value {
        self.transmittance_diffuse
    }

    /// Fraction of the incident power that is absorbed \[1\].
    pub fn absorptance(&self) -> Value {
        self.absorptance
    }

    /// Fluence in the medium at depth t, per unit irradiance on the lit face from outside \[1\].
    ///
    /// # Arguments
    /// `t` depth in mean free paths, 0 to tau
    /// # Errors
    /// `Error::OutOfRange` naming `t`
    pub fn fluence(&self, t: f64) -> Result<Value> {
        check_depth(t, self.direct.tau)?;
        let unscattered = self.direct.fluence(t)?;
        let [fine, coarse] = self.solutions.each_ref().map(|s| s.fluence(t, &self.direct));
        let scattered = Value::new(fine, (fine - coarse).abs() + self.rounding * fine.abs(), METHOD);
        Ok(sum(&[unscattered, scattered]))
    }
}

const METHOD: &str = "";

fn sum(parts: &[Value]) -> Value {
    let value: f64 = parts.iter().map(|p| p.value).sum();
    let error: f64 = parts.iter().map(|p| p.error).sum();
    Value::new(value, error + 2.0 * f64::EPSILON * value.abs(), METHOD)
}

fn check_index(index: f64) -> Result<f64> {
    within("index", index, 0.25, 4.0, "0.25 to 4, inside over outside")
}

#[cfg(test)]
mod tests {
    use super::*;
    #[test]
    fn probe() {
        for (tau, w, g, n, inc) in [
            (1.0, 0.9, 0.0, 1.5, Incidence::Beam { mu0: 1.0 }),
            (1.0, 0.9, 0.0, 1.5, Incidence::Diffuse),
            (1.0, 1.0, 0.0, 1.33, Incidence::Beam { mu0: 1.0 }),
            (1.0, 1.0, 0.0, 1.33, Incidence::Diffuse),
            (1.0, 1.0, 0.5, 1.0001, Incidence::Diffuse),
            (1.0, 1.0, 0.75, 2.4, Incidence::Diffuse),
            (1.0, 1.0, 0.75, 0.7, Incidence::Diffuse),
            (1.0, 1.0, 0.75, 0.7, Incidence::Beam { mu0: 0.9 }),
            (100.0, 0.99999, 0.75, 2.4, Incidence::Beam { mu0: 0.9 }),
            (1e-8, 0.99999, 0.75, 2.4, Incidence::Beam { mu0: 0.9 }),
            (1.0, 0.9, 0.5, 1.0, Incidence::Diffuse),
            (1.0, 0.9, 0.5, 1.0 + 1e-9, Incidence::Diffuse),
        ] {
            let start = std::time::Instant::now();
            let s = FresnelSlab::by_doubling(tau, w, g, n, inc).unwrap();
            eprintln!(
                "{tau} {w} {g} n {n} {inc:?} {:?} nodes {}",
                start.elapsed(),
                s.direct.face.nodes(UPPER[0], LOWER[0], 5).len()
            );
            let show =
                |name: &str, v: Value| eprintln!("   {name} {:.17} +- {:.1e}", v.value, v.error / v.value);
            show("spec", s.specular());
            show("Rback", s.reflectance_direct);
            show("Rdif", s.reflectance_diffuse());
            show("R", s.reflectance());
            show("Tcol", s.transmittance_direct());
            show("Tdif", s.transmittance_diffuse());
            show("T", s.transmittance());
            show("A", s.absorptance());
            show("phi0", s.fluence(0.0).unwrap());
            show("phi", s.fluence(0.3 * tau).unwrap());
            eprintln!(
                "   sum-1 {:.1e}",
                s.reflectance().value + s.transmittance().value + s.absorptance().value - 1.0
            );
        }
    }
}
