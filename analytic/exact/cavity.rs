//! `exact cavity`: the Lambertian cavity.

use crate::answer::Answer;
use crate::plot::{Curve, even, figure, panel};
use crate::question::{Question, Solved};
use crate::typed::Typed;
use crate::unit::Unit;
use anyhow::Result;
use turbid_analytic::cavity::Cavity;
use turbid_figure::{Axis, Figure};

/// A spherical cavity with a diffusely reflecting wall, empty or filled: irradiance of the wall.
///
/// With rho the wall's albedo, A the fraction of isotropic incident light that the medium absorbs and E_1 the irradiance
/// before the wall's first reflection,
///
///   E = E_1/(1 - rho (1-A))          empty, any source: E(x) = E_0(x) + rho mean(E_0)/(1 - rho)
///
/// `irradiance_wall` is per unit of exitance that the wall itself emits evenly (a pure number); `irradiance_centre` per unit
/// power of a point source at the centre, in 1/length^2; `irradiance_mean` of any source, in the unit of --first. `rounds`
/// = 1/(1 - rho (1-A)). Lengths are mean free paths (empty: any unit). Irradiance is counted before reflection.
/// Source: Sumpner 1892; Walsh 1958, chapter 8.
#[derive(Clone, clap::Args)]
#[command(verbatim_doc_comment)]
pub struct Args {
    /// Radius in mean free paths; empty: in any unit.
    #[arg(long, default_value_t = 1.0, allow_negative_numbers = true)]
    radius: f64,
    /// Albedo of the wall, 0 to 1 (1 only if the medium absorbs).
    #[arg(long, allow_negative_numbers = true)]
    wall_albedo: f64,
    /// Single-scattering albedo of the medium, 0 to 1; without it the cavity is empty.
    #[arg(long, allow_negative_numbers = true)]
    albedo: Option<f64>,
    /// Mean irradiance of the wall before its first reflection, of any source: gives the mean irradiance.
    #[arg(long, allow_negative_numbers = true)]
    first: Option<f64>,
    /// Distances from the centre, 0 to the radius, at which to give the fluence if the wall emits evenly, per unit exitance.
    #[arg(long, num_args = 1.., value_delimiter = ',', value_name = "R", allow_negative_numbers = true)]
    r: Vec<f64>,
}

fn solve(args: &Args, wall_albedo: f64) -> turbid_analytic::Result<Cavity> {
    match args.albedo {
        Some(albedo) => Cavity::filled(args.radius, wall_albedo, albedo),
        None => Cavity::empty(args.radius, wall_albedo),
    }
}

impl Question for Args {
    fn answer(&self, answer: &mut Answer, _: &Solved) -> Result<()> {
        let cavity = solve(self, self.wall_albedo)?;
        answer.of("cavity").with("radius", self.radius).with("wall_albedo", self.wall_albedo);
        let at_centre = match self.albedo {
            Some(albedo) => {
                answer.with("albedo", albedo);
                Unit::PowerPerMfp2
            }
            None => {
                answer.with("medium", "none");
                Unit::PowerPerLength2
            }
        };
        answer.add("rounds", Unit::One, &[], cavity.rounds());
        answer.add("irradiance_wall", Unit::Exitance, &[], cavity.irradiance_wall());
        answer.add("irradiance_centre", at_centre, &[], cavity.irradiance_centre());
        if let Some(first) = self.first {
            let mean = cavity.irradiance_mean(first)?;
            answer.add("irradiance_mean", Unit::First, &[("first", first.into())], mean);
        }
        for &r in &self.r {
            answer.add("fluence_wall", Unit::Exitance, &[("r", r.into())], cavity.fluence_wall(r)?);
        }
        Ok(())
    }

    /// The wall's irradiance against its albedo.
    fn figure(&self, _: &Solved) -> Result<Figure> {
        // What a black wall receives of its own light, 1 - A, decides about all others.
        let reach = solve(self, 0.0)?.irradiance_wall().value;
        let curve = Curve::sample("", &even(0.0, 0.98, 99), |rho| Ok(reach / (1.0 - rho * reach)))?;
        let medium =
            self.albedo.map_or("empty".to_string(), |w| format!("radius {}, albedo {w}", self.radius));
        let axis = Axis::linear("Albedo of the wall ρ", "");
        Ok(figure(
            format!("Lambertian cavity, {medium}"),
            panel(axis, "Irradiance over exitance of the wall", "", vec![curve]),
        ))
    }

    fn typed(&self) -> Option<Typed> {
        Some(Typed {
            albedo: self.albedo,
            g: Some(0.0),
            size: Some(self.radius),
            places: self.r.clone(),
            ..Typed::default()
        })
    }

    fn moved(&self, to: f64) -> Option<Box<dyn Question>> {
        Some(Box::new(Args { albedo: Some(to), ..self.clone() }))
    }
}
