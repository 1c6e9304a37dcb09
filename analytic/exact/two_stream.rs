//! `exact two-stream`: the approximations beside the exact values.

use crate::answer::Answer;
use crate::method;
use crate::phase::Named;
use crate::plot::{Curve, crowded, figure, panel};
use crate::question::{Question, Solved};
use crate::read::{incidence, incidence_field, incidence_title};
use crate::slab;
use crate::typed::Typed;
use crate::unit::Unit;
use anyhow::Result;
use std::rc::Rc;
use turbid_analytic::two_stream::{Approximation, Method, TwoStream};
use turbid_analytic::{Incidence, Slab, Value};
use turbid_figure::{Axis, Figure};

/// Two streams and diffusion beside the exact slab: how wrong they are.
///
/// The radiance is replaced by one flux up, F+, and one down, F-; with s = F+ + F-, d = F+ - F-, b = 1/mu0:
///
///   ds/dt = c_s d - w b D e^(-bt),   dd/dt = c_d s - w b e^(-bt)
///
///   Eddington    c_d = 2 (1-w)      c_s = (3/2)(1-wg)      D = -(3/2) g mu0     fluence 2 s
///   quadrature   c_d = sqrt3 (1-w)  c_s = sqrt3 (1-wg)     D = -sqrt3 g mu0     fluence sqrt3 s
///   delta-Eddington: Eddington, a share g^2 of all scattering counted as straight on
///   diffusion: Eddington, with the field vanishing 0.7104/(1-wg) mean free paths outside
///
/// tau in mean free paths. Each quantity comes exactly, then in every approximation, whose `error` is what it differs by (with
/// the bound of the exact value), so that here too it covers the truth.
/// Source: Eddington 1916; Joseph, Wiscombe and Weinman 1976; Meador and Weaver 1980.
#[derive(Clone, clap::Args)]
#[command(verbatim_doc_comment)]
pub struct Args {
    /// Optical thickness, 1e-12 to 1e9 mean free paths.
    #[arg(long, allow_negative_numbers = true)]
    tau: f64,
    /// Single-scattering albedo, 0 to 1.
    #[arg(long, allow_negative_numbers = true)]
    albedo: f64,
    /// Mean cosine of Henyey-Greenstein scattering, -0.95 to 0.99.
    #[arg(long, default_value_t = 0.0, allow_negative_numbers = true)]
    g: f64,
    /// Cosine of incidence of a beam, 1e-5 to 1, or the word diffuse (Lambertian light).
    #[arg(long, default_value = "1", value_parser = incidence, allow_negative_numbers = true)]
    mu0: Incidence,
    /// Depths in mean free paths, 0 to tau, at which to give the fluence.
    #[arg(long, num_args = 1.., value_delimiter = ',', value_name = "T", allow_negative_numbers = true)]
    depth: Vec<f64>,
}

/// As short as a legend wants it.
fn name(method: Method) -> &'static str {
    match method {
        Method::Eddington => "Eddington",
        Method::Quadrature => "quadrature",
        Method::DeltaEddington => "delta-Eddington",
        Method::Diffusion => "diffusion",
    }
}

/// An approximation beside its method.
type Approximate = (Method, TwoStream);

impl Args {
    /// The exact slab, and the approximations to hold against it.
    fn models(&self, named: &Named, solved: &Solved) -> Result<(Rc<Slab>, Vec<Approximate>)> {
        let exact = slab::solve(self.tau, self.albedo, named, self.mu0, method::Method::Auto, solved)?;
        let approximation =
            |method| Ok((method, TwoStream::slab(method, self.tau, self.albedo, self.g, self.mu0)?));
        Ok((exact, Method::ALL.into_iter().map(approximation).collect::<Result<_>>()?))
    }
}

impl Question for Args {
    fn answer(&self, answer: &mut Answer, solved: &Solved) -> Result<()> {
        let named = Named::henyey_greenstein(self.g)?;
        let (exact, approximations) = self.models(&named, solved)?;
        answer
            .of("two-stream")
            .with("tau", self.tau)
            .with("albedo", self.albedo)
            .with("phase", named.name.as_str())
            .with("mu0", incidence_field(self.mu0));
        let mut compare = |quantity,
                           unit: Unit,
                           t: Option<f64>,
                           truth: Value,
                           of: &dyn Fn(&TwoStream) -> Result<Approximation>| {
            let at = |model: &str| {
                let mut at = vec![("model", model.into())];
                at.extend(t.map(|t| ("t", t.into())));
                at
            };
            answer.add(quantity, unit, &at("exact"), truth);
            for (method, two_stream) in &approximations {
                let Approximation { value, .. } = of(two_stream)?;
                let error = (value - truth.value).abs() + truth.error;
                let value = Value { value, error, method: "approximation" };
                answer.add(quantity, unit, &at(name(*method)), value);
            }
            anyhow::Ok(())
        };
        let power = Unit::IncidentPower;
        compare("reflectance", power, None, exact.reflectance(), &|s| Ok(s.reflectance()))?;
        compare("transmittance", power, None, exact.transmittance(), &|s| Ok(s.transmittance()))?;
        compare("absorptance", power, None, exact.absorptance(), &|s| Ok(s.absorptance()))?;
        for &t in &self.depth {
            compare("fluence", Unit::Irradiance, Some(t), exact.fluence(t)?, &|s| Ok(s.fluence(t)?))?;
        }
        Ok(())
    }

    /// The exact fluence and the approximations against depth.
    fn figure(&self, solved: &Solved) -> Result<Figure> {
        let named = Named::henyey_greenstein(self.g)?;
        let (exact, approximations) = self.models(&named, solved)?;
        let depths = crowded(self.tau, 81);
        let mut curves =
            vec![Curve::sample("exact", &depths, |t| Ok(exact.fluence(t)?.value))?.into_reference()];
        for (method, two_stream) in &approximations {
            curves.push(Curve::sample(name(*method), &depths, |t| Ok(two_stream.fluence(t)?.value))?);
        }
        let light = incidence_title(self.mu0);
        let title =
            format!("Approximations, slab τ = {}, albedo {}, {}, {light}", self.tau, self.albedo, named.name);
        let axis = Axis::linear("Depth t", "mean free paths");
        Ok(figure(title, panel(axis, "Fluence over irradiance", "", curves)))
    }

    fn typed(&self) -> Option<Typed> {
        Some(Typed {
            albedo: Some(self.albedo),
            g: Some(self.g),
            size: Some(self.tau),
            places: self.depth.clone(),
            ..Typed::default()
        })
    }

    fn moved(&self, to: f64) -> Option<Box<dyn Question>> {
        Some(Box::new(Args { albedo: to, ..self.clone() }))
    }
}
