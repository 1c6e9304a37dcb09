//! `exact infinite`: a point source in an unbounded medium.

use crate::answer::Answer;
use crate::phase::{Named, PhaseArgs};
use crate::plot::{Curve, figure, panel, ratios};
use crate::question::{Question, Solved};
use crate::typed::Typed;
use crate::unit::Unit;
use anyhow::{Result, ensure};
use std::rc::Rc;
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
    albedo: f64,
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
    fn medium(&self, named: &Named, solved: &Solved) -> Result<Rc<InfiniteMedium>> {
        solved.once((self.albedo, &named.name), || {
            Ok(match named.single_g {
                // Whose moments are known to any order.
                Some(g) => InfiniteMedium::henyey_greenstein(self.albedo, g)?,
                None => InfiniteMedium::new(self.albedo, &named.phase)?,
            })
        })
    }
}

impl Question for Args {
    fn answer(&self, answer: &mut Answer, solved: &Solved) -> Result<()> {
        let named = self.phase.read()?;
        let medium = self.medium(&named, solved)?;
        answer.of("infinite").with("albedo", self.albedo).with("phase", named.name.as_str());
        for (j, k) in (0_u32..).zip(medium.decays()) {
            answer.add("decay", Unit::Mfp(-1), &[("mode", j.into())], k);
        }
        // Without absorption both grow beyond all limits.
        if self.albedo < 1.0 || answer.is_one() {
            answer.ask("total_fluence", Unit::PowerMfp, &[], || Ok(medium.total_fluence()?))?;
            answer.ask("mean_square_radius", Unit::Mfp(2), &[], || Ok(medium.mean_square_radius()?))?;
        }
        for &r in &self.r {
            let (at, unit) = ([("r", r.into())], Unit::PowerPerMfp2);
            answer.ask("fluence", unit, &at, || Ok(medium.fluence(r)?))?;
            answer.ask("flux", unit, &at, || Ok(medium.flux(r)?))?;
            answer.ask("asymptotic_fluence", unit, &at, || Ok(medium.asymptotic_fluence(r)?))?;
            answer.ask("diffusion_fluence", unit, &at, || Ok(medium.diffusion_fluence(r)?))?;
        }
        for &s in &self.wave {
            answer.ask("transform", Unit::PowerMfp, &[("s", s.into())], || Ok(medium.transform(s)?))?;
        }
        for &n in &self.scatterings {
            ensure!(n < 1_000_000, "scatterings is {n}; allowed: 0 to 999999");
            // Depends on the mean cosine alone, for any phase function.
            let (at, g) = ([("n", n.into())], named.phase.g());
            answer.add("mean_cosine", Unit::One, &at, mean_cosine(g, n)?);
            answer.add("mean_square_distance", Unit::Mfp(2), &at, mean_square_displacement(g, n + 1)?);
        }
        Ok(())
    }

    /// The fluence with its two approximations.
    fn figure(&self, solved: &Solved) -> Result<Figure> {
        let named = self.phase.read()?;
        let medium = self.medium(&named, solved)?;
        let (low, high) =
            self.r.iter().fold((0.1, 10.0), |(low, high): (f64, f64), &r| (low.min(r), high.max(r)));
        let places = ratios(low, high, 121);
        // Times r^2, so that spreading alone is flat.
        let times = |r: f64, fluence: f64| 4.0 * std::f64::consts::PI * r * r * fluence;
        let curves = vec![
            Curve::sample("exact", &places, |r| Ok(times(r, medium.fluence(r)?.value)))?.into_reference(),
            Curve::sample("slowest mode", &places, |r| Ok(times(r, medium.asymptotic_fluence(r)?.value)))?,
            Curve::sample("diffusion", &places, |r| Ok(times(r, medium.diffusion_fluence(r)?.value)))?,
        ];
        let title = format!("Point source in an unbounded medium, albedo {}, {}", self.albedo, named.name);
        let axis = Axis::log("Distance r", "mean free paths");
        Ok(figure(title, panel(axis, "4π r² × fluence over power", "", curves)))
    }

    fn typed(&self) -> Option<Typed> {
        Some(Typed {
            albedo: Some(self.albedo),
            g: self.phase.single_g(),
            places: self.r.clone(),
            ..Typed::default()
        })
    }

    fn moved(&self, to: f64) -> Option<Box<dyn Question>> {
        Some(Box::new(Args { albedo: to, ..self.clone() }))
    }
}
