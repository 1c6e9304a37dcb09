//! `exact half-space`: the half-space with isotropic scattering.

use crate::answer::Answer;
use crate::phase::{Named, PhaseArgs};
use crate::plot::{Curve, degrees, even, figure, panel};
use crate::question::{Question, Solved};
use crate::read::{incidence, incidence_field, incidence_title};
use crate::typed::Typed;
use crate::unit::Unit;
use anyhow::{Result, bail, ensure};
use clap::ValueEnum;
use std::rc::Rc;
use turbid_analytic::half_space::HalfSpace;
use turbid_analytic::{AnisotropicMedium, AnisotropicSlab, Incidence, Value};
use turbid_figure::{Axis, Figure};

/// A half-space: H function, reflectance, radiance, fluence, Milne's problem.
///
/// The medium fills t > 0, with unit irradiance on its face. With w the albedo, H Chandrasekhar's function and
/// isotropic scattering,
///
///   H(mu) = 1 + (w/2) mu H(mu) int_0^1 H(m)/(mu + m) dm
///   R     = 1 - sqrt(1-w) H(mu0)                           (diffuse: averaged over 2 mu0 dmu0)
///   I(mu) = (w/4 pi) H(mu) H(mu0)/(mu + mu0)               [1/sr], leaving at cosine mu
///
/// `h_moment` is int_0^1 mu^n H dmu. The fluence includes the direct light. In Milne's problem light comes from infinitely
/// deep: far from the face the fluence goes as sinh(k (t + z0)), with decay k and extrapolation length z0 in mean free
/// paths; radiance and fluence are per unit power that leaves. With any other phase function by discrete ordinates.
/// Source: Hopf 1934; Chandrasekhar 1960, chapter V; Stibbs and Weir 1959; Case and Zweifel 1967, chapter 6.
#[derive(Clone, clap::Args)]
#[command(verbatim_doc_comment)]
pub struct Args {
    /// Single-scattering albedo, 0 to 1.
    #[arg(long, allow_negative_numbers = true)]
    albedo: f64,
    #[command(flatten)]
    phase: PhaseArgs,
    /// Cosine of incidence of a beam, above 0 to 1, or the word diffuse (Lambertian light).
    #[arg(long, default_value = "1", value_parser = incidence, allow_negative_numbers = true)]
    mu0: Incidence,
    /// Cosines, 0 to 1, at which to give the radiance that leaves, and H.
    #[arg(long, num_args = 1.., value_delimiter = ',', value_name = "MU", allow_negative_numbers = true)]
    mu: Vec<f64>,
    /// Azimuths of those directions, in radians, where scattering is not isotropic: that of propagation minus the beam's.
    #[arg(long, num_args = 1.., value_delimiter = ',', value_name = "PHI", default_values_t = [0.0], requires = "mu", allow_negative_numbers = true)]
    azimuth: Vec<f64>,
    /// Depths in mean free paths, 0 or more, at which to give fluence and net flux downwards.
    #[arg(long, num_args = 1.., value_delimiter = ',', value_name = "T", allow_negative_numbers = true)]
    depth: Vec<f64>,
    /// Answer Milne's problem at these cosines and depths, instead of the lit face (albedo 0.01 to 1).
    #[arg(long)]
    milne: bool,
    /// What --plot draws: fluence against depth, radiance that leaves against the angle to the normal, or H against mu.
    #[arg(long, value_enum, default_value = "fluence")]
    draw: Draw,
}

/// What a figure of a half-space shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Draw {
    /// Fluence against depth.
    Fluence,
    /// Radiance that leaves.
    Radiance,
    /// The H function.
    H,
}

impl Args {
    fn space(&self, solved: &Solved) -> Result<Rc<HalfSpace>> {
        solved.once(self.albedo, || Ok(HalfSpace::new(self.albedo)?))
    }

    /// Discrete ordinates, which answer for any phase function.
    fn ordinates(&self, named: &Named, solved: &Solved) -> Result<Rc<AnisotropicSlab>> {
        ensure!(
            !self.milne && self.draw != Draw::H,
            "phase function is {}; allowed with --milne and --draw h: isotropic",
            named.name
        );
        if let Some(mu) = self.mu.iter().find(|mu| !(0.0..=1.0).contains(*mu)) {
            bail!("mu is {mu}; allowed: 0 to 1");
        }
        solved.once((self.albedo, &named.name, self.mu0), || {
            Ok(AnisotropicMedium::new(self.albedo, &named.phase)?.half_space(self.mu0)?)
        })
    }

    fn isotropic(&self, answer: &mut Answer, space: &HalfSpace) -> Result<()> {
        let (fluence, radiance) = if self.milne {
            answer.with("source", "infinitely deep");
            answer.ask("extrapolation_length", Unit::Mfp(1), &[], || Ok(space.extrapolation_length()?))?;
            answer.add("decay", Unit::Mfp(-1), &[], space.decay());
            (Unit::Exitance, Unit::ExitancePerSr)
        } else {
            answer.with("mu0", incidence_field(self.mu0));
            answer.ask("reflectance", Unit::IncidentPower, &[], || Ok(space.reflectance(self.mu0)?))?;
            answer.ask("absorptance", Unit::IncidentPower, &[], || Ok(space.absorptance(self.mu0)?))?;
            (Unit::Irradiance, Unit::IrradiancePerSr)
        };
        for n in 0..=2_u32 {
            answer.ask("h_moment", Unit::One, &[("n", n.into())], || Ok(space.moment(n)?))?;
        }
        for &mu in &self.mu {
            let at = [("mu", mu.into())];
            answer.ask("h", Unit::One, &at, || Ok(space.h(mu)?))?;
            answer.ask("radiance", radiance, &at, || self.radiance(space, mu))?;
        }
        for &t in &self.depth {
            let at = [("t", t.into())];
            answer.ask("fluence", fluence, &at, || self.fluence(space, t))?;
            if !self.milne {
                answer.ask("flux", Unit::Irradiance, &at, || Ok(space.flux(self.mu0, t)?))?;
            }
        }
        Ok(())
    }

    fn radiance(&self, space: &HalfSpace, mu: f64) -> Result<Value> {
        Ok(if self.milne { space.milne_radiance(mu)? } else { space.radiance(self.mu0, mu)? })
    }

    fn fluence(&self, space: &HalfSpace, t: f64) -> Result<Value> {
        Ok(if self.milne { space.milne_fluence(t)? } else { space.fluence(self.mu0, t)? })
    }

    fn anisotropic(&self, answer: &mut Answer, space: &AnisotropicSlab) -> Result<()> {
        answer.with("mu0", incidence_field(self.mu0));
        answer.add("reflectance", Unit::IncidentPower, &[], space.reflectance());
        answer.add("absorptance", Unit::IncidentPower, &[], space.absorptance());
        for &mu in &self.mu {
            for &dphi in &self.azimuth {
                let at = [("mu", mu.into()), ("azimuth", dphi.into())];
                answer.ask("radiance", Unit::IrradiancePerSr, &at, || Ok(space.radiance(0.0, mu, dphi)?))?;
            }
        }
        for &t in &self.depth {
            let at = [("t", t.into())];
            answer.ask("fluence", Unit::Irradiance, &at, || Ok(space.fluence(t)?))?;
            answer.ask("flux", Unit::Irradiance, &at, || Ok(space.flux(t)?))?;
        }
        Ok(())
    }

    /// Depths to draw, closer at the face, where the field bends most.
    fn depths(&self) -> Vec<f64> {
        let last = self.depth.iter().fold(5.0, |a: f64, &t| a.max(t));
        even(0.0, 1.0, 101).into_iter().map(|x| last * x * x).collect()
    }

    fn drawn_anisotropic(&self, named: &Named, space: &AnisotropicSlab) -> Result<Figure> {
        let light = incidence_title(self.mu0);
        let title = format!("Half-space, albedo {}, {}, {light}", self.albedo, named.name);
        let panel = if self.draw == Draw::Radiance {
            let curve = |&dphi: &f64| {
                Curve::sample(format!("azimuth {dphi}"), &even(0.0, 90.0, 46), |angle| {
                    Ok(space.radiance(0.0, libm::cos(angle.to_radians()), dphi)?.value)
                })
            };
            let curves = self.azimuth.iter().map(curve).collect::<Result<Vec<_>>>()?;
            panel(degrees("Angle to the normal", 90), "Radiance over irradiance", "1/sr", curves)
        } else {
            let curve = Curve::sample("", &self.depths(), |t| Ok(space.fluence(t)?.value))?;
            panel(Axis::linear("Depth t", "mean free paths"), "Fluence over irradiance", "", vec![curve])
        };
        Ok(figure(title, panel))
    }
}

impl Question for Args {
    fn answer(&self, answer: &mut Answer, solved: &Solved) -> Result<()> {
        let named = self.phase.read()?;
        answer.of("half-space").with("albedo", self.albedo).with("phase", named.name.as_str());
        if named.is_isotropic() {
            return self.isotropic(answer, &*self.space(solved)?);
        }
        self.anisotropic(answer, &*self.ordinates(&named, solved)?)
    }

    fn figure(&self, solved: &Solved) -> Result<Figure> {
        let named = self.phase.read()?;
        if !named.is_isotropic() {
            return self.drawn_anisotropic(&named, &*self.ordinates(&named, solved)?);
        }
        let space = self.space(solved)?;
        let (light, per) = if self.milne {
            ("light from deep inside".to_string(), "flux that leaves")
        } else {
            (incidence_title(self.mu0), "irradiance")
        };
        let title = format!("Half-space, albedo {}, isotropic, {light}", self.albedo);
        let (title, panel) = match self.draw {
            Draw::H => {
                let curve = Curve::sample("", &even(0.0, 1.0, 101), |mu| Ok(space.h(mu)?.value))?;
                let title = format!("Chandrasekhar's H function, albedo {}", self.albedo);
                (title, panel(Axis::linear("Cosine μ", ""), "H(μ)", "", vec![curve]))
            }
            Draw::Radiance => {
                let curve = Curve::sample("", &even(0.0, 90.0, 91), |angle| {
                    Ok(self.radiance(&space, libm::cos(angle.to_radians()))?.value)
                })?;
                let axis = degrees("Angle to the normal", 90);
                (title, panel(axis, &format!("Radiance over {per}"), "1/sr", vec![curve]))
            }
            Draw::Fluence => {
                let curve = Curve::sample("", &self.depths(), |t| Ok(self.fluence(&space, t)?.value))?;
                let axis = Axis::linear("Depth t", "mean free paths");
                (title, panel(axis, &format!("Fluence over {per}"), "", vec![curve]))
            }
        };
        Ok(figure(title, panel))
    }

    fn typed(&self) -> Option<Typed> {
        Some(Typed {
            albedo: Some(self.albedo),
            g: self.phase.single_g(),
            places: self.depth.clone(),
            ..Typed::default()
        })
    }

    fn moved(&self, to: f64) -> Option<Box<dyn Question>> {
        Some(Box::new(Args { albedo: to, ..self.clone() }))
    }
}
