//! `exact thick`: slabs of any thickness by asymptotics.

use crate::answer::Answer;
use crate::phase::{Named, PhaseArgs};
use crate::plot::{Curve, even, figure, panel};
use crate::question::{Question, Solved};
use crate::read::{incidence, incidence_field};
use crate::typed::Typed;
use crate::unit::Unit;
use anyhow::Result;
use std::rc::Rc;
use turbid_analytic::Incidence;
use turbid_analytic::asymptotics::Asymptotics;
use turbid_figure::{Axis, Figure};

/// Thick slabs by asymptotics: decays, deep pattern, escape, and R and T of any thickness above some.
///
/// Deep inside, light decays as P(u) e^(-kt), u the cosine to the direction of decay. With K the escape function,
///
///   T = m n K(mu0) e^(-k tau)/(1 - l^2 e^(-2k tau)),   R = R_inf - l e^(-k tau) T
///   m = 2 int_-1^1 u P^2 du,  n = 2 int_0^1 u K du,  l = 2 int_0^1 u K(u) P(-u) du
///   albedo 1: T = (4/3) K/((1-g)(tau + 2z)),  R = 1 - T
///
/// z is Milne's extrapolation length; lengths in mean free paths, decays in their inverse. The bound says how much the
/// faster decays, k2 and beyond, may still do: in thin slabs as much as the answer. A peak, by --g or by moments, takes some
/// seconds, however many thicknesses are asked.
/// Source: van de Hulst 1980, chapter 5; Sobolev 1975, chapter 3.
#[derive(Clone, clap::Args)]
#[command(verbatim_doc_comment)]
pub struct Args {
    /// Single-scattering albedo, 0.1 to 1, where the slowest decay is below 0.999: from 0.263 on if scattering is isotropic.
    #[arg(long, allow_negative_numbers = true)]
    albedo: f64,
    #[command(flatten)]
    phase: PhaseArgs,
    /// Cosine of incidence of a beam, 1e-5 to 1, or the word diffuse (Lambertian light).
    #[arg(long, default_value = "1", value_parser = incidence, allow_negative_numbers = true)]
    mu0: Incidence,
    /// Optical thicknesses, 1 to 1e15: gives R, T and A.
    #[arg(long, num_args = 1.., value_delimiter = ',', value_name = "TAU", allow_negative_numbers = true)]
    tau: Vec<f64>,
    /// Cosines u to the direction of decay, -1 to 1: gives the pattern P(u) of light deep inside.
    #[arg(long, num_args = 1.., value_delimiter = ',', value_name = "U", allow_negative_numbers = true)]
    u: Vec<f64>,
}

impl Args {
    fn deep(&self, named: &Named, solved: &Solved) -> Result<Rc<Asymptotics>> {
        solved.once((self.albedo, &named.name), || {
            Ok(if named.is_isotropic() {
                Asymptotics::isotropic(self.albedo)?
            } else {
                Asymptotics::new(self.albedo, &named.phase)?
            })
        })
    }
}

impl Question for Args {
    fn answer(&self, answer: &mut Answer, solved: &Solved) -> Result<()> {
        let named = self.phase.read()?;
        let deep = self.deep(&named, solved)?;
        answer
            .of("thick")
            .with("albedo", self.albedo)
            .with("phase", named.name.as_str())
            .with("mu0", incidence_field(self.mu0));
        answer.add("decay", Unit::Mfp(-1), &[], deep.decay());
        answer.add("second_decay", Unit::Mfp(-1), &[], deep.second_decay());
        answer.add("m", Unit::One, &[], deep.m());
        answer.add("n", Unit::One, &[], deep.n());
        answer.add("l", Unit::One, &[], deep.l());
        answer.add("extrapolation_length", Unit::Mfp(1), &[], deep.extrapolation_length());
        answer.add("escape", Unit::One, &[], deep.escape(self.mu0)?);
        for &tau in &self.tau {
            let slab = deep.slab(tau, self.mu0)?;
            let at = [("tau", tau.into())];
            answer.add("reflectance", Unit::IncidentPower, &at, slab.reflectance);
            answer.add("transmittance", Unit::IncidentPower, &at, slab.transmittance);
            answer.add("absorptance", Unit::IncidentPower, &at, slab.absorptance);
        }
        for &u in &self.u {
            answer.add("pattern", Unit::One, &[("u", u.into())], deep.pattern(u)?);
        }
        Ok(())
    }

    /// The pattern of light deep inside.
    fn figure(&self, solved: &Solved) -> Result<Figure> {
        let named = self.phase.read()?;
        let deep = self.deep(&named, solved)?;
        let curve = Curve::sample("", &even(-1.0, 1.0, 101), |u| Ok(deep.pattern(u)?.value))?;
        let title = format!("Light deep inside, albedo {}, {}", self.albedo, named.name);
        let axis = Axis::linear("Cosine u to the direction of decay", "");
        Ok(figure(title, panel(axis, "Radiance over its mean, P(u)", "", vec![curve])))
    }

    fn typed(&self) -> Option<Typed> {
        Some(Typed {
            albedo: Some(self.albedo),
            g: self.phase.single_g(),
            places: self.tau.clone(),
            ..Typed::default()
        })
    }

    fn moved(&self, to: f64) -> Option<Box<dyn Question>> {
        Some(Box::new(Args { albedo: to, ..self.clone() }))
    }
}
