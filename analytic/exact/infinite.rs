//! `exact infinite`: a point source in an unbounded medium.

use crate::answer::{Answer, Reply};
use crate::phase::{Named, PhaseArgs};
use crate::plot::{Curve, figure, panel, ratios};
use crate::typed::Typed;
use anyhow::{Result, ensure};
use turbid_analytic::infinite::{InfiniteMedium, mean_cosine, mean_square_displacement};
use turbid_figure::{Axis, Figure};

/// An isotropic point source of unit power in an unbounded medium, beside its asymptote and diffusion theory.
///
/// With w the albedo, chi_l the Legendre moments of the phase function and h_l = (2l+1)(1 - w chi_l), the fluence obeys
///
///   int phi(r) e^(i s.r) d^3r = 1/(h_0 + s^2/(h_1 + 4 s^2/(h_2 + 9 s^2/(h_3 + ...))))
///   phi(r) = 1/(4 pi r) [sum_j N_j e^(-k_j r) + a continuum of decays of 1 and more]
///
/// r in mean free paths, fluence and net flux outwards in 1/mean free path^2 per unit power. `asymptotic_fluence` is
/// the slowest exponential alone; `diffusion_fluence` = 3 (1-wg) e^(-kr)/(4 pi r), k^2 = 3 (1-w)(1-wg), is an
/// approximation, whose bound is that of the formula.
/// Source: Case, de Hoffmann and Placzek 1953; Grosjean 1956; Case and Zweifel 1967, chapter 5.
#[derive(Clone, clap::Args)]
#[command(verbatim_doc_comment)]
pub struct Args {
    /// Single-scattering albedo, 0 to 1.
    #[arg(long, allow_negative_numbers = true)]
    pub albedo: f64,
    #[command(flatten)]
    phase: PhaseArgs,
    /// Distances in mean free paths, 1e-12 to 1e6.
    #[arg(long, num_args = 1.., value_delimiter = ',', value_name = "R", allow_negative_numbers = true)]
    r: Vec<f64>,
    /// Wave numbers s in 1/mean free path, 0 to 1e5: gives the transform of the fluence, the fraction above.
    #[arg(long, num_args = 1.., value_delimiter = ',', value_name = "S", allow_negative_numbers = true)]
    wave: Vec<f64>,
    /// Numbers n of scatterings, 0 to 999999: gives the mean cosine between the first direction and that after n, g^n, and the
    /// mean square distance from the source after the flight that follows the n-th, absorption aside
    #[arg(verbatim_doc_comment, long, num_args = 1.., value_delimiter = ',', value_name = "N", allow_negative_numbers = true)]
    scatterings: Vec<u32>,
}

impl Args {
    /// What rounding touches.
    pub fn typed(&self) -> Typed {
        Typed {
            albedo: Some(self.albedo),
            g: self.phase.single_g(),
            places: self.r.clone(),
            ..Typed::default()
        }
    }
}

/// Answers; the figure shows the fluence with its two approximations.
pub fn answer(args: &Args, draw: bool) -> Result<Reply> {
    let named = args.phase.read()?;
    let medium = solve(args.albedo, &named)?;
    let mut answer = Answer::new("infinite").with("albedo", args.albedo).with("phase", named.name.as_str());
    for (j, k) in (0_u32..).zip(medium.decays()) {
        answer.add_at("decay", vec![("mode", j.into())], k);
    }
    // Without absorption both grow beyond all limits.
    if args.albedo < 1.0 {
        answer.add("total_fluence", medium.total_fluence()?);
        answer.add("mean_square_radius", medium.mean_square_radius()?);
    }
    for &r in &args.r {
        let at = || vec![("r", r.into())];
        answer.add_at("fluence", at(), medium.fluence(r)?);
        answer.add_at("flux", at(), medium.flux(r)?);
        answer.add_at("asymptotic_fluence", at(), medium.asymptotic_fluence(r)?);
        answer.add_at("diffusion_fluence", at(), medium.diffusion_fluence(r)?);
    }
    for &s in &args.wave {
        answer.add_at("transform", vec![("s", s.into())], medium.transform(s)?);
    }
    for &n in &args.scatterings {
        ensure!(n < 1_000_000, "scatterings is {n}; allowed: 0 to 999999");
        // Depends on the mean cosine alone, for any phase function.
        let (at, g) = (|| vec![("n", n.into())], named.phase.g());
        answer.add_at("mean_cosine", at(), mean_cosine(g, n)?);
        answer.add_at("mean_square_distance", at(), mean_square_displacement(g, n + 1)?);
    }
    let figure = if draw { Some(drawn(args, &named, &medium)?) } else { None };
    Ok(Reply { answer, figure })
}

/// The medium of a phase function.
pub fn solve(albedo: f64, named: &Named) -> Result<InfiniteMedium> {
    Ok(match named.single_g {
        // Whose moments are known to any order.
        Some(g) => InfiniteMedium::henyey_greenstein(albedo, g)?,
        None => InfiniteMedium::new(albedo, &named.phase)?,
    })
}

fn drawn(args: &Args, named: &Named, medium: &InfiniteMedium) -> Result<Figure> {
    let (low, high) =
        args.r.iter().fold((0.1, 10.0), |(low, high): (f64, f64), &r| (low.min(r), high.max(r)));
    let places = ratios(low, high, 121);
    // Times r^2, so that spreading alone is flat.
    let times = |r: f64, fluence: f64| 4.0 * std::f64::consts::PI * r * r * fluence;
    let curves = vec![
        Curve::sample("exact", &places, |r| Ok(times(r, medium.fluence(r)?.value)))?.into_reference(),
        Curve::sample("slowest mode", &places, |r| Ok(times(r, medium.asymptotic_fluence(r)?.value)))?,
        Curve::sample("diffusion", &places, |r| Ok(times(r, medium.diffusion_fluence(r)?.value)))?,
    ];
    let title = format!("Point source in an unbounded medium, albedo {}, {}", args.albedo, named.name);
    let axis = Axis::log("Distance r", "mean free paths");
    Ok(figure(title, panel(axis, "4π r² × fluence over power", "", curves)))
}
