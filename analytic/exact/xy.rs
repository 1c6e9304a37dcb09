//! `exact xy`: Chandrasekhar's X and Y functions.

use crate::answer::{Answer, Reply};
use crate::plot::{Curve, even, figure, panel};
use crate::typed::Typed;
use anyhow::Result;
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
    pub albedo: f64,
    /// Cosines, 0 to 1.
    #[arg(long, num_args = 1.., value_delimiter = ',', value_name = "MU", default_values_t = [0.1, 0.5, 1.0], allow_negative_numbers = true)]
    mu: Vec<f64>,
    /// Cosine of incidence, above 0 to 1: gives R, T and the radiances that leave at every cosine.
    #[arg(long, allow_negative_numbers = true)]
    mu0: Option<f64>,
}

impl Args {
    /// What rounding touches.
    pub fn typed(&self) -> Typed {
        Typed { albedo: Some(self.albedo), g: Some(0.0), size: Some(self.tau), ..Typed::default() }
    }
}

/// Answers; the figure shows both functions.
pub fn answer(args: &Args, draw: bool) -> Result<Reply> {
    let xy = XAndY::new(args.tau, args.albedo)?;
    let mut answer = Answer::new("xy").with("tau", args.tau).with("albedo", args.albedo);
    if let Some(mu0) = args.mu0 {
        answer = answer.with("mu0", mu0);
    }
    let [a0, b0] = xy.integrals()?;
    answer.add("a0", a0);
    answer.add("b0", b0);
    if let Some(mu0) = args.mu0 {
        let [reflectance, transmittance] = xy.fluxes(mu0)?;
        answer.add("reflectance", reflectance);
        answer.add("transmittance", transmittance);
    }
    for &mu in &args.mu {
        let at = || vec![("mu", mu.into())];
        let [x, y] = xy.at(mu)?;
        answer.add_at("x", at(), x);
        answer.add_at("y", at(), y);
        if let Some(mu0) = args.mu0 {
            answer.add_at("radiance_up", at(), xy.radiance_up(mu0, mu)?);
            // At the beam's own cosine the formula is a difference over zero; `exact slab` has the value.
            if (mu - mu0).abs() >= 1e-6 {
                answer.add_at("radiance_down", at(), xy.radiance_down(mu0, mu)?);
            }
        }
    }
    let figure = if draw { Some(drawn(args, &xy)?) } else { None };
    Ok(Reply { answer, figure })
}

fn drawn(args: &Args, xy: &XAndY) -> Result<Figure> {
    // Closer towards the horizon, where X rises like mu ln mu.
    let cosines: Vec<f64> = even(0.0, 1.0, 41).into_iter().map(|x| x * x).collect();
    let curves = vec![
        Curve::sample("X", &cosines, |mu| Ok(xy.at(mu)?[0].value))?,
        Curve::sample("Y", &cosines, |mu| Ok(xy.at(mu)?[1].value))?,
    ];
    let title = format!("Chandrasekhar's X and Y, τ = {}, albedo {}", args.tau, args.albedo);
    Ok(figure(title, panel(Axis::linear("Cosine μ", ""), "X(μ), Y(μ)", "", curves)))
}
