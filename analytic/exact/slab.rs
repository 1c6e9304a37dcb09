//! `exact slab`: one slab, all its fluxes, and fluence, radiance and orders of scattering where asked.

use crate::answer::{Answer, Reply};
use crate::fresnel::{self, Asked};
use crate::orders::Orders;
use crate::phase::{Named, PhaseArgs};
use crate::plot::{Curve, crowded, degrees, even, figure, panel};
use crate::read::{incidence, incidence_field, incidence_title};
use crate::solved::{Method, Solved};
use crate::typed::Typed;
use anyhow::{Result, ensure};
use clap::ValueEnum;
use libm::cos;
use turbid_analytic::Incidence;
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
    pub albedo: f64,
    #[command(flatten)]
    phase: PhaseArgs,
    /// Cosine of incidence of a beam, above 0 to 1, or the word diffuse (Lambertian light).
    #[arg(long, default_value = "1", value_parser = incidence, allow_negative_numbers = true)]
    mu0: Incidence,
    /// Refractive index inside over outside, 0.25 to 4: faces that reflect and refract (fluxes and fluence). Gives also the
    /// light that the first face sends back (`specular`), reflectances without it (`reflectance_diffuse`), and the part of
    /// Lambertian light that one face reflects, from outside and from inside
    #[arg(verbatim_doc_comment, long, default_value_t = 1.0, allow_negative_numbers = true)]
    index: f64,
    /// Depths in mean free paths, 0 to tau, at which to give the fluence and the net flux downwards (direct light
    /// included)
    #[arg(verbatim_doc_comment, long, num_args = 1.., value_delimiter = ',', value_name = "T", allow_negative_numbers = true)]
    depth: Vec<f64>,
    /// Signed cosines (positive: towards the lit face) at which to give the radiance of scattered light, at every
    /// depth, or without depths where the light leaves
    #[arg(verbatim_doc_comment, long, num_args = 1.., value_delimiter = ',', value_name = "MU", allow_negative_numbers = true)]
    mu: Vec<f64>,
    /// Azimuths of those directions, in radians: that of propagation minus that of the beam.
    #[arg(long, num_args = 1.., value_delimiter = ',', value_name = "PHI", default_values_t = [0.0], allow_negative_numbers = true)]
    azimuth: Vec<f64>,
    /// Orders of scattering to give one by one, 0 (direct light) to 100, to 1000 with isotropic scattering.
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

impl Args {
    /// What rounding touches.
    pub fn typed(&self) -> Typed {
        Typed {
            albedo: Some(self.albedo),
            g: self.phase.single_g(),
            index: Some(self.index),
            size: Some(self.tau),
            places: self.depth.clone(),
            ..Typed::default()
        }
    }
}

/// What a figure of a slab shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Draw {
    /// Fluence against depth.
    Fluence,
    /// Radiance against direction.
    Radiance,
}

/// Solves the slab and answers.
pub fn answer(args: &Args, draw: bool) -> Result<Reply> {
    let named = args.phase.read()?;
    if args.index != 1.0 {
        ensure!(
            args.mu.is_empty() && args.order.is_empty() && args.draw == Draw::Fluence,
            "--index is {}; allowed with --mu, --order and --draw radiance: 1 (between refracting faces there are fluxes and \
             fluence)",
            args.index
        );
        let (tau, albedo, index) = (args.tau, args.albedo, args.index);
        let asked = Asked { tau, albedo, named: &named, index, incidence: args.mu0, depth: &args.depth };
        return fresnel::answer(&asked, args.method, draw);
    }
    let slab = Solved::new(args.tau, args.albedo, &named, args.mu0, args.method)?;
    let mut answer = Answer::new("slab")
        .with("tau", args.tau)
        .with("albedo", args.albedo)
        .with("phase", named.name.as_str())
        .with("mu0", incidence_field(args.mu0));
    answer.add("reflectance", slab.reflectance());
    answer.add("transmittance", slab.transmittance());
    answer.add("transmittance_direct", slab.transmittance_direct());
    answer.add("transmittance_diffuse", slab.transmittance_diffuse());
    answer.add("absorptance", slab.absorptance());
    // The other methods have no net flux at a depth.
    let ordinates = match &slab {
        Solved::Peierls(_) if args.method == Method::Auto && !args.depth.is_empty() => {
            Some(Solved::new(args.tau, args.albedo, &named, args.mu0, Method::Ordinates)?)
        }
        _ => None,
    };
    for &t in &args.depth {
        answer.add_at("fluence", vec![("t", t.into())], slab.fluence(t)?);
        if let flux @ (Solved::Ordinates(_) | Solved::Both(..)) = ordinates.as_ref().unwrap_or(&slab) {
            answer.add_at("flux", vec![("t", t.into())], flux.flux(t)?);
        }
    }
    for (t, mu, dphi) in directions(args, &named) {
        let mut at = vec![("t", t.into()), ("mu", mu.into())];
        if !named.is_isotropic() {
            at.push(("azimuth", dphi.into()));
        }
        answer.add_at("radiance", at, slab.radiance(t, mu, dphi)?);
    }
    if !args.order.is_empty() {
        orders(args, &named, &mut answer)?;
    }
    let figure = match (draw, args.draw) {
        (false, _) => None,
        (true, Draw::Fluence) => Some(fluence(args, &named, &slab)?),
        (true, Draw::Radiance) => Some(radiance(args, &named, &slab)?),
    };
    Ok(Reply { answer, figure })
}

/// Where and whither radiances are asked; isotropic scattering has one azimuth like the other.
fn directions(args: &Args, named: &Named) -> Vec<(f64, f64, f64)> {
    let azimuths = if named.is_isotropic() { &args.azimuth[..1] } else { &args.azimuth };
    let mut all = Vec::new();
    for &mu in &args.mu {
        let exit = [if mu >= 0.0 { 0.0 } else { args.tau }];
        let depths = if args.depth.is_empty() { exit.as_slice() } else { &args.depth };
        for &t in depths {
            all.extend(azimuths.iter().map(|&dphi| (t, mu, dphi)));
        }
    }
    all
}

fn orders(args: &Args, named: &Named, answer: &mut Answer) -> Result<()> {
    let slab = Orders::new(args.tau, args.albedo, named, args.mu0)?;
    for &n in &args.order {
        answer.add_at("reflectance_of_order", vec![("order", n.into())], slab.reflectance(n)?);
        answer.add_at("transmittance_of_order", vec![("order", n.into())], slab.transmittance(n)?);
        for &t in &args.depth {
            answer.add_at(
                "fluence_of_order",
                vec![("t", t.into()), ("order", n.into())],
                slab.fluence(n, t)?,
            );
        }
    }
    Ok(())
}

fn title(args: &Args, named: &Named) -> String {
    let light = incidence_title(args.mu0);
    format!("Slab τ = {}, albedo {}, {}, {light}", args.tau, args.albedo, named.name)
}

fn fluence(args: &Args, named: &Named, slab: &Solved) -> Result<Figure> {
    let axis = Axis::linear("Depth t", "mean free paths");
    let all = |depths: &[f64]| Curve::sample("all light", depths, |t| Ok(slab.fluence(t)?.value));
    let curves = if args.order.is_empty() {
        vec![all(&crowded(args.tau, 121))?]
    } else {
        let (by_order, depths) =
            (Orders::new(args.tau, args.albedo, named, args.mu0)?, crowded(args.tau, 41));
        let mut curves = vec![all(&depths)?.into_reference()];
        for &n in &args.order {
            let label = if n == 0 { "direct light".into() } else { format!("scattered {n} ×") };
            curves.push(Curve::sample(label, &depths, |t| Ok(by_order.fluence(n, t)?.value))?);
        }
        curves
    };
    Ok(figure(title(args, named), panel(axis, "Fluence over irradiance", "", curves)))
}

fn radiance(args: &Args, named: &Named, slab: &Solved) -> Result<Figure> {
    let dphi = args.azimuth[0];
    let faces = [0.0, args.tau];
    let depths = if args.depth.is_empty() { faces.as_slice() } else { &args.depth };
    let mut curves = Vec::new();
    for &t in depths {
        // On a face scattered light only leaves.
        let (from, to) = (if t == args.tau { 90.0 } else { 0.0 }, if t == 0.0 { 90.0 } else { 180.0 });
        curves.push(Curve::sample(format!("t = {t}"), &even(from, to, 61), |angle| {
            // Level is level, not a rounding above it.
            let mu = if angle == 90.0 { 0.0 } else { cos(angle.to_radians()) };
            Ok(slab.radiance(t, mu, dphi)?.value)
        })?);
    }
    let axis = degrees("Angle from straight up", 180);
    let plane = if named.is_isotropic() { String::new() } else { format!(", azimuth {dphi} rad") };
    let panel = panel(axis, "Scattered radiance over irradiance", "1/sr", curves);
    Ok(figure(format!("{}{plane}", title(args, named)), panel))
}
