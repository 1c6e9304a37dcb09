//! `exact half-space`: the half-space with isotropic scattering.

use crate::answer::{Answer, Reply};
use crate::phase::{Named, PhaseArgs};
use crate::plot::{Curve, degrees, even, figure, panel};
use crate::read::{incidence, incidence_field, incidence_title};
use crate::typed::Typed;
use anyhow::{Result, bail, ensure};
use clap::ValueEnum;
use turbid_analytic::half_space::HalfSpace;
use turbid_analytic::{AnisotropicMedium, Incidence};
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
    pub albedo: f64,
    #[command(flatten)]
    phase: PhaseArgs,
    /// Cosine of incidence of a beam, above 0 to 1, or the word diffuse (Lambertian light).
    #[arg(long, default_value = "1", value_parser = incidence, allow_negative_numbers = true)]
    mu0: Incidence,
    /// Cosines, 0 to 1, at which to give the radiance that leaves, and H.
    #[arg(long, num_args = 1.., value_delimiter = ',', value_name = "MU", allow_negative_numbers = true)]
    mu: Vec<f64>,
    /// Azimuths of those directions, in radians, where scattering is not isotropic: that of propagation minus the beam's.
    #[arg(long, num_args = 1.., value_delimiter = ',', value_name = "PHI", default_values_t = [0.0], allow_negative_numbers = true)]
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

impl Args {
    /// What rounding touches.
    pub fn typed(&self) -> Typed {
        Typed {
            albedo: Some(self.albedo),
            g: self.phase.single_g(),
            places: self.depth.clone(),
            ..Typed::default()
        }
    }
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

/// Answers.
pub fn answer(args: &Args, draw: bool) -> Result<Reply> {
    let named = args.phase.read()?;
    let mut answer = Answer::new("half-space").with("albedo", args.albedo).with("phase", named.name.as_str());
    if !named.is_isotropic() {
        return anisotropic(args, &named, answer, draw);
    }
    let space = HalfSpace::new(args.albedo)?;
    if args.milne {
        answer = answer.with("source", "infinitely deep");
        answer.add("extrapolation_length", space.extrapolation_length()?);
        answer.add("decay", space.decay());
    } else {
        answer = answer.with("mu0", incidence_field(args.mu0));
        answer.add("reflectance", space.reflectance(args.mu0)?);
        answer.add("absorptance", space.absorptance(args.mu0)?);
    }
    for n in 0..=2_u32 {
        answer.add_at("h_moment", vec![("n", n.into())], space.moment(n)?);
    }
    for &mu in &args.mu {
        let at = || vec![("mu", mu.into())];
        answer.add_at("h", at(), space.h(mu)?);
        let radiance = if args.milne { space.milne_radiance(mu)? } else { space.radiance(args.mu0, mu)? };
        answer.add_at("radiance", at(), radiance);
    }
    for &t in &args.depth {
        let at = || vec![("t", t.into())];
        if args.milne {
            answer.add_at("fluence", at(), space.milne_fluence(t)?);
        } else {
            answer.add_at("fluence", at(), space.fluence(args.mu0, t)?);
            answer.add_at("flux", at(), space.flux(args.mu0, t)?);
        }
    }
    let figure = if draw { Some(drawn(args, &space)?) } else { None };
    Ok(Reply { answer, figure })
}

/// Discrete ordinates, which answer for any phase function.
fn anisotropic(args: &Args, named: &Named, answer: Answer, draw: bool) -> Result<Reply> {
    ensure!(
        !args.milne && args.draw != Draw::H,
        "phase function is {}; allowed with --milne and --draw h: isotropic",
        named.name
    );
    if let Some(mu) = args.mu.iter().find(|mu| !(0.0..=1.0).contains(*mu)) {
        bail!("mu is {mu}; allowed: 0 to 1");
    }
    let space = AnisotropicMedium::new(args.albedo, &named.phase)?.half_space(args.mu0)?;
    let mut answer = answer.with("mu0", incidence_field(args.mu0));
    answer.add("reflectance", space.reflectance());
    answer.add("absorptance", space.absorptance());
    for &mu in &args.mu {
        for &dphi in &args.azimuth {
            let at = vec![("mu", mu.into()), ("azimuth", dphi.into())];
            answer.add_at("radiance", at, space.radiance(0.0, mu, dphi)?);
        }
    }
    for &t in &args.depth {
        answer.add_at("fluence", vec![("t", t.into())], space.fluence(t)?);
        answer.add_at("flux", vec![("t", t.into())], space.flux(t)?);
    }
    let figure = if draw {
        let light = incidence_title(args.mu0);
        let title = format!("Half-space, albedo {}, {}, {light}", args.albedo, named.name);
        let panel = if args.draw == Draw::Radiance {
            let curve = |&dphi: &f64| {
                Curve::sample(format!("azimuth {dphi}"), &even(0.0, 90.0, 46), |angle| {
                    Ok(space.radiance(0.0, libm::cos(angle.to_radians()), dphi)?.value)
                })
            };
            let curves = args.azimuth.iter().map(curve).collect::<Result<Vec<_>>>()?;
            panel(degrees("Angle to the normal", 90), "Radiance over irradiance", "1/sr", curves)
        } else {
            let curve = Curve::sample("", &depths(args), |t| Ok(space.fluence(t)?.value))?;
            panel(Axis::linear("Depth t", "mean free paths"), "Fluence over irradiance", "", vec![curve])
        };
        Some(figure(title, panel))
    } else {
        None
    };
    Ok(Reply { answer, figure })
}

/// Depths to draw, closer at the face, where the field bends most.
fn depths(args: &Args) -> Vec<f64> {
    let last = args.depth.iter().fold(5.0, |a: f64, &t| a.max(t));
    even(0.0, 1.0, 101).into_iter().map(|x| last * x * x).collect()
}

fn drawn(args: &Args, space: &HalfSpace) -> Result<Figure> {
    let (light, per) = if args.milne {
        ("light from deep inside".to_string(), "flux that leaves")
    } else {
        (incidence_title(args.mu0), "irradiance")
    };
    let title = format!("Half-space, albedo {}, isotropic, {light}", args.albedo);
    let (title, panel) = match args.draw {
        Draw::H => {
            let curve = Curve::sample("", &even(0.0, 1.0, 101), |mu| Ok(space.h(mu)?.value))?;
            let title = format!("Chandrasekhar's H function, albedo {}", args.albedo);
            (title, panel(Axis::linear("Cosine μ", ""), "H(μ)", "", vec![curve]))
        }
        Draw::Radiance => {
            let curve = Curve::sample("", &even(0.0, 90.0, 91), |angle| {
                let mu = libm::cos(angle.to_radians());
                let radiance =
                    if args.milne { space.milne_radiance(mu) } else { space.radiance(args.mu0, mu) };
                Ok(radiance?.value)
            })?;
            let axis = degrees("Angle to the normal", 90);
            (title, panel(axis, &format!("Radiance over {per}"), "1/sr", vec![curve]))
        }
        Draw::Fluence => {
            let curve = Curve::sample("", &depths(args), |t| {
                let fluence = if args.milne { space.milne_fluence(t) } else { space.fluence(args.mu0, t) };
                Ok(fluence?.value)
            })?;
            let axis = Axis::linear("Depth t", "mean free paths");
            (title, panel(axis, &format!("Fluence over {per}"), "", vec![curve]))
        }
    };
    Ok(figure(title, panel))
}
