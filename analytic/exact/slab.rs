//! `exact slab`: one slab, all its fluxes, and fluence, radiance and orders of scattering where asked.

use crate::answer::Answer;
use crate::fresnel::Refracting;
use crate::method::Method;
use crate::phase::{Named, PhaseArgs};
use crate::plot::{Curve, crowded, degrees, even, figure, panel};
use crate::question::{Question, Solved};
use crate::read::{incidence, incidence_field, incidence_title};
use crate::typed::Typed;
use crate::unit::Unit;
use anyhow::{Result, bail, ensure};
use clap::ValueEnum;
use libm::cos;
use std::rc::Rc;
use turbid_analytic::slab_single::single_radiance;
use turbid_analytic::{Incidence, Slab, SlabMedium, SlabOrders, Value};
use turbid_figure::{Axis, Figure};

/// A homogeneous slab: fluxes, fluence, radiance of scattered light, orders of scattering.
///
/// The radiance I of scattered light obeys, with t the depth below the lit face, mu > 0 upwards and w the albedo,
///
///   mu dI/dt = I - w int p(W.W') I(t, W') dW' - w p(W.W0) e^(-t/mu0)/mu0
///
/// for a beam of cosine mu0 and unit irradiance on the face (`diffuse`: radiance 1/pi from all directions outside).
/// Fluxes are fractions of the incident power, R + T + A = 1; T includes the direct light. The fluence includes the
/// direct light, the radiance [1/sr] leaves it out; both are per unit irradiance.
///
/// Isotropic scattering: the Peierls equation phi = phi_0 + (w/2) int E_1(|t-t'|) phi(t') dt' with a residual bound.
/// Any other phase function: discrete ordinates on two sets of nodes. Thickness 1e-12 to 1e9, g -0.95 to 0.99.
/// Source: Peierls 1939; Case and Zweifel 1967; Chandrasekhar 1960; Stamnes, Tsay, Wiscombe and Jayaweera 1988.
#[derive(Clone, clap::Args)]
#[command(verbatim_doc_comment)]
pub struct Args {
    /// Optical thickness, in mean free paths, 1e-12 to 1e9.
    #[arg(long, allow_negative_numbers = true)]
    tau: f64,
    /// Single-scattering albedo, 0 to 1.
    #[arg(long, allow_negative_numbers = true)]
    albedo: f64,
    #[command(flatten)]
    phase: PhaseArgs,
    /// Cosine of incidence of a beam, above 0 to 1, or the word diffuse (Lambertian light).
    #[arg(long, default_value = "1", value_parser = incidence, allow_negative_numbers = true)]
    mu0: Incidence,
    /// Refractive index inside over outside, 0.25 to 4: faces that reflect and refract (fluxes and fluence). Gives also the
    /// light that the first face sends back (`specular`), what leaves that was scattered (`reflectance_diffuse`), and the part
    /// of Lambertian light that one face reflects, from outside and from inside
    #[arg(verbatim_doc_comment, long, default_value_t = 1.0, allow_negative_numbers = true)]
    index: f64,
    /// For tables, which ask for the light of refracting faces by name, even where the index is 1.
    #[arg(long, hide = true)]
    between_refracting_faces: bool,
    /// Depths in mean free paths, 0 to tau, at which to give the fluence and the net flux downwards (direct light
    /// included)
    #[arg(verbatim_doc_comment, long, num_args = 1.., value_delimiter = ',', value_name = "T", allow_negative_numbers = true)]
    depth: Vec<f64>,
    /// Signed cosines (positive: towards the lit face) at which to give the radiance of scattered light, at every
    /// depth, or without depths where the light leaves
    #[arg(verbatim_doc_comment, long, num_args = 1.., value_delimiter = ',', value_name = "MU", allow_negative_numbers = true)]
    mu: Vec<f64>,
    /// Azimuths of those directions, in radians: that of propagation minus that of the beam.
    #[arg(long, num_args = 1.., value_delimiter = ',', value_name = "PHI", default_values_t = [0.0], requires = "mu", allow_negative_numbers = true)]
    azimuth: Vec<f64>,
    /// Orders of scattering to give one by one, 0 (direct light) to 100, to 1000 with isotropic scattering up to
    /// thickness 400
    #[arg(long, num_args = 1.., value_delimiter = ',', value_name = "N", allow_negative_numbers = true)]
    order: Vec<u32>,
    /// How to solve it.
    #[arg(long, value_enum, default_value = "auto")]
    method: Method,
    /// What --plot draws: fluence against depth (with --order, each order beside the whole), or radiance against the angle
    /// from straight up, in the plane of the first azimuth, one curve for each depth (without depths: at both faces)
    #[arg(verbatim_doc_comment, long, value_enum, default_value = "fluence")]
    draw: Draw,
}

/// What a figure of a slab shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Draw {
    /// Fluence against depth.
    Fluence,
    /// Radiance against direction.
    Radiance,
}

/// Solves a slab, with what slabs of the same medium or thickness have solved.
pub fn solve(
    tau: f64,
    albedo: f64,
    named: &Named,
    light: Incidence,
    method: Method,
    solved: &Solved,
) -> Result<Rc<Slab>> {
    let medium = solved.once((albedo, &named.name), || Ok(SlabMedium::new(albedo, &named.phase)?))?;
    solved.once((tau, albedo, &named.name, light, method), || {
        Ok(match method {
            Method::Auto => match solved.latest(|_, other: &Slab| other.tau().to_bits() == tau.to_bits()) {
                Some(other) => other.with(&medium, light)?,
                None => Slab::solve(tau, &medium, light)?,
            },
            Method::Peierls if !named.is_isotropic() => {
                bail!("phase function is {}; allowed with --method peierls: isotropic", named.name)
            }
            Method::Peierls => Slab::by_peierls(tau, albedo, light)?,
            Method::Ordinates => Slab::by_ordinates(tau, &medium, light)?,
            Method::Doubling => Slab::by_doubling(tau, &medium, light)?,
        })
    })
}

impl Args {
    fn slab(&self, named: &Named, solved: &Solved) -> Result<Rc<Slab>> {
        solve(self.tau, self.albedo, named, self.mu0, self.method, solved)
    }

    fn orders(&self, named: &Named, solved: &Solved) -> Result<Rc<SlabOrders>> {
        solved.once((self.tau, self.albedo, &named.name, self.mu0), || {
            Ok(SlabOrders::new(self.tau, self.albedo, &named.phase, self.mu0)?)
        })
    }

    /// The slab between refracting faces, if they refract.
    fn refracting(&self) -> Result<Option<Refracting<'_>>> {
        if self.index == 1.0 && !self.between_refracting_faces {
            return Ok(None);
        }
        ensure!(
            self.mu.is_empty() && self.order.is_empty() && self.draw == Draw::Fluence,
            "--index is {}; allowed with --mu, --order and --draw radiance: 1 (between refracting faces there are fluxes and \
             fluence)",
            self.index
        );
        let (tau, albedo, index, incidence) = (self.tau, self.albedo, self.index, self.mu0);
        Ok(Some(Refracting { tau, albedo, index, incidence, method: self.method, depth: &self.depth }))
    }

    /// Where and whither radiances are asked; isotropic scattering has one azimuth like the other.
    fn directions(&self, named: &Named) -> Vec<(f64, f64, f64)> {
        let azimuths = if named.is_isotropic() { &self.azimuth[..1] } else { &self.azimuth };
        let mut all = Vec::new();
        for &mu in &self.mu {
            let exit = [if mu >= 0.0 { 0.0 } else { self.tau }];
            let depths = if self.depth.is_empty() { exit.as_slice() } else { &self.depth };
            for &t in depths {
                all.extend(azimuths.iter().map(|&dphi| (t, mu, dphi)));
            }
        }
        all
    }

    fn add_orders(&self, named: &Named, answer: &mut Answer, solved: &Solved) -> Result<()> {
        let slab = || self.orders(named, solved);
        for &n in &self.order {
            let (at, power) = ([("order", n.into())], Unit::IncidentPower);
            answer.ask("reflectance_of_order", power, &at, || Ok(slab()?.reflectance(n)?))?;
            answer.ask("transmittance_of_order", power, &at, || Ok(slab()?.transmittance(n)?))?;
            for &t in &self.depth {
                let at = [("t", t.into()), ("order", n.into())];
                answer.ask("fluence_of_order", Unit::Irradiance, &at, || Ok(slab()?.fluence(n, t)?))?;
            }
            for (t, mu, dphi) in self.directions(named) {
                let (1, Incidence::Beam { mu0 }) = (n, self.mu0) else { continue };
                answer.ask_by_name("radiance_of_order", Unit::IrradiancePerSr, || {
                    let g = named.only_g("order=1")?;
                    Ok(single_radiance(self.tau, self.albedo, g, mu0, t, mu, dphi)?)
                })?;
            }
        }
        Ok(())
    }

    /// X and Y are functions of the cosine of incidence: that times the fluence on either face.
    fn add_x_and_y(&self, named: &Named, answer: &mut Answer, solved: &Solved) -> Result<()> {
        let Incidence::Beam { mu0 } = self.mu0 else { return Ok(()) };
        for (name, t) in [("x", 0.0), ("y", self.tau)] {
            answer.ask_by_name(name, Unit::One, || {
                let v = self.slab(named, solved)?.fluence(t)?;
                Ok(Value { value: v.value * mu0, error: v.error * mu0, ..v })
            })?;
        }
        Ok(())
    }

    fn title(&self, named: &Named) -> String {
        let light = incidence_title(self.mu0);
        format!("Slab τ = {}, albedo {}, {}, {light}", self.tau, self.albedo, named.name)
    }

    fn draw_fluence(&self, named: &Named, solved: &Solved) -> Result<Figure> {
        let slab = self.slab(named, solved)?;
        let axis = Axis::linear("Depth t", "mean free paths");
        let all = |depths: &[f64]| Curve::sample("all light", depths, |t| Ok(slab.fluence(t)?.value));
        let curves = if self.order.is_empty() {
            vec![all(&crowded(self.tau, 121))?]
        } else {
            let (by_order, depths) = (self.orders(named, solved)?, crowded(self.tau, 41));
            let mut curves = vec![all(&depths)?.into_reference()];
            for &n in &self.order {
                let label = if n == 0 { "direct light".into() } else { format!("scattered {n} ×") };
                curves.push(Curve::sample(label, &depths, |t| Ok(by_order.fluence(n, t)?.value))?);
            }
            curves
        };
        Ok(figure(self.title(named), panel(axis, "Fluence over irradiance", "", curves)))
    }

    fn draw_radiance(&self, named: &Named, solved: &Solved) -> Result<Figure> {
        let (slab, dphi) = (self.slab(named, solved)?, self.azimuth[0]);
        let faces = [0.0, self.tau];
        let depths = if self.depth.is_empty() { faces.as_slice() } else { &self.depth };
        let mut curves = Vec::new();
        for &t in depths {
            // On a face scattered light only leaves.
            let (from, to) = (if t == self.tau { 90.0 } else { 0.0 }, if t == 0.0 { 90.0 } else { 180.0 });
            curves.push(Curve::sample(format!("t = {t}"), &even(from, to, 61), |angle| {
                // Level is level, not a rounding above it.
                let mu = if angle == 90.0 { 0.0 } else { cos(angle.to_radians()) };
                Ok(slab.radiance(t, mu, dphi)?.value)
            })?);
        }
        let axis = degrees("Angle from straight up", 180);
        let plane = if named.is_isotropic() { String::new() } else { format!(", azimuth {dphi} rad") };
        let panel = panel(axis, "Scattered radiance over irradiance", "1/sr", curves);
        Ok(figure(format!("{}{plane}", self.title(named)), panel))
    }
}

impl Question for Args {
    fn answer(&self, answer: &mut Answer, solved: &Solved) -> Result<()> {
        let named = self.phase.read()?;
        if let Some(refracting) = self.refracting()? {
            return refracting.answer(&named, answer, solved);
        }
        let slab = || self.slab(&named, solved);
        answer
            .of("slab")
            .with("tau", self.tau)
            .with("albedo", self.albedo)
            .with("phase", named.name.as_str())
            .with("mu0", incidence_field(self.mu0));
        let power = Unit::IncidentPower;
        answer.ask("reflectance", power, &[], || Ok(slab()?.reflectance()))?;
        answer.ask("transmittance", power, &[], || Ok(slab()?.transmittance()))?;
        answer.ask("transmittance_direct", power, &[], || Ok(slab()?.transmittance_direct()))?;
        answer.ask("transmittance_diffuse", power, &[], || Ok(slab()?.transmittance_diffuse()))?;
        answer.ask("absorptance", power, &[], || Ok(slab()?.absorptance()))?;
        for &t in &self.depth {
            let at = [("t", t.into())];
            answer.ask("fluence", Unit::Irradiance, &at, || Ok(slab()?.fluence(t)?))?;
            // The other methods have no net flux at a depth, and ordinates no beam that grazes more.
            let grazes = matches!(self.mu0, Incidence::Beam { mu0 } if mu0 < 1e-5) && named.is_isotropic();
            let has_flux = self.method == Method::Ordinates || self.method == Method::Auto && !grazes;
            if has_flux {
                answer.ask("flux", Unit::Irradiance, &at, || Ok(slab()?.flux(t)?))?;
            }
        }
        for (t, mu, dphi) in self.directions(&named) {
            let mut at = vec![("t", t.into()), ("mu", mu.into())];
            if !named.is_isotropic() {
                at.push(("azimuth", dphi.into()));
            }
            answer.ask("radiance", Unit::IrradiancePerSr, &at, || Ok(slab()?.radiance(t, mu, dphi)?))?;
        }
        self.add_orders(&named, answer, solved)?;
        self.add_x_and_y(&named, answer, solved)
    }

    fn figure(&self, solved: &Solved) -> Result<Figure> {
        let named = self.phase.read()?;
        if let Some(refracting) = self.refracting()? {
            return refracting.figure(&named, solved);
        }
        match self.draw {
            Draw::Fluence => self.draw_fluence(&named, solved),
            Draw::Radiance => self.draw_radiance(&named, solved),
        }
    }

    fn typed(&self) -> Option<Typed> {
        Some(Typed {
            albedo: Some(self.albedo),
            g: self.phase.single_g(),
            index: Some(self.index),
            size: Some(self.tau),
            places: self.depth.clone(),
            ..Typed::default()
        })
    }

    fn moved(&self, to: f64) -> Option<Box<dyn Question>> {
        Some(Box::new(Args { albedo: to, ..self.clone() }))
    }
}
