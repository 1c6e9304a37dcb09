//! `exact xy`: Chandrasekhar's X and Y functions.

use crate::answer::Answer;
use crate::plot::{Curve, even, figure, panel};
use crate::question::{Question, Solved};
use crate::typed::Typed;
use crate::unit::Unit;
use anyhow::Result;
use std::rc::Rc;
use turbid_analytic::xy::XAndY;
use turbid_figure::{Axis, Figure};

/// Chandrasekhar's X and Y functions: all that leaves a slab of isotropic scattering, by two functions of one cosine.
///
/// With w the albedo, tau the thickness and phi the fluence under a beam of cosine mu and unit irradiance,
///
///   X(mu) = mu phi(0),  Y(mu) = mu phi(tau),  a_0 = int_0^1 X dmu,  b_0 = int_0^1 Y dmu
///   I_up(mu) = (w/4 pi) (X X_0 - Y Y_0)/(mu + mu0),  I_down(mu) = (w/4 pi) (Y X_0 - X Y_0)/(mu - mu0)     [1/sr]
///   R = 1 - X_0 (1 - w a_0/2) - Y_0 w b_0/2,         T = Y_0 (1 - w a_0/2) + X_0 w b_0/2
///
/// tau in mean free paths; all but the radiances are pure numbers. (1 - w a_0/2)^2 - (w b_0/2)^2 = 1 - w.
/// Source: Chandrasekhar 1960, chapter VIII; Mullikin 1964; Sobolev 1975; van de Hulst 1980, chapter 7.
#[derive(Clone, clap::Args)]
#[command(verbatim_doc_comment)]
pub struct Args {
    /// Optical thickness, 1e-12 to 400 mean free paths.
    #[arg(long, allow_negative_numbers = true)]
    tau: f64,
    /// Single-scattering albedo, 0 to 1.
    #[arg(long, allow_negative_numbers = true)]
    albedo: f64,
    /// Cosines, 0 to 1.
    #[arg(long, num_args = 1.., value_delimiter = ',', value_name = "MU", default_values_t = [0.1, 0.5, 1.0], allow_negative_numbers = true)]
    mu: Vec<f64>,
    /// Cosine of incidence, above 0 to 1: gives R, T and the radiances that leave at every cosine.
    #[arg(long, allow_negative_numbers = true)]
    mu0: Option<f64>,
}

impl Args {
    fn xy(&self, solved: &Solved) -> Result<Rc<XAndY>> {
        solved.once((self.tau, self.albedo), || Ok(XAndY::new(self.tau, self.albedo)?))
    }
}

impl Question for Args {
    fn answer(&self, answer: &mut Answer, solved: &Solved) -> Result<()> {
        let xy = self.xy(solved)?;
        answer.of("xy").with("tau", self.tau).with("albedo", self.albedo);
        if let Some(mu0) = self.mu0 {
            answer.with("mu0", mu0);
        }
        let [a0, b0] = xy.integrals()?;
        answer.add("a0", Unit::One, &[], a0);
        answer.add("b0", Unit::One, &[], b0);
        if let Some(mu0) = self.mu0 {
            let [reflectance, transmittance] = xy.fluxes(mu0)?;
            answer.add("reflectance", Unit::IncidentPower, &[], reflectance);
            answer.add("transmittance", Unit::IncidentPower, &[], transmittance);
        }
        for &mu in &self.mu {
            let at = [("mu", mu.into())];
            let [x, y] = xy.at(mu)?;
            answer.add("x", Unit::One, &at, x);
            answer.add("y", Unit::One, &at, y);
            if let Some(mu0) = self.mu0 {
                answer.add("radiance_up", Unit::IrradiancePerSr, &at, xy.radiance_up(mu0, mu)?);
                // At the beam's own cosine the formula is a difference over zero; `exact slab` has the value.
                if (mu - mu0).abs() >= 1e-6 {
                    answer.add("radiance_down", Unit::IrradiancePerSr, &at, xy.radiance_down(mu0, mu)?);
                }
            }
        }
        Ok(())
    }

    /// Both functions.
    fn figure(&self, solved: &Solved) -> Result<Figure> {
        let xy = self.xy(solved)?;
        // Closer towards the horizon, where X rises like mu ln mu.
        let cosines: Vec<f64> = even(0.0, 1.0, 41).into_iter().map(|x| x * x).collect();
        let curves = vec![
            Curve::sample("X", &cosines, |mu| Ok(xy.at(mu)?[0].value))?,
            Curve::sample("Y", &cosines, |mu| Ok(xy.at(mu)?[1].value))?,
        ];
        let title = format!("Chandrasekhar's X and Y, τ = {}, albedo {}", self.tau, self.albedo);
        Ok(figure(title, panel(Axis::linear("Cosine μ", ""), "X(μ), Y(μ)", "", curves)))
    }

    fn typed(&self) -> Option<Typed> {
        Some(Typed { albedo: Some(self.albedo), g: Some(0.0), size: Some(self.tau), ..Typed::default() })
    }

    fn moved(&self, to: f64) -> Option<Box<dyn Question>> {
        Some(Box::new(Args { albedo: to, ..self.clone() }))
    }
}
