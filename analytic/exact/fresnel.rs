//! `exact slab --index`: the slab between refracting faces.

use crate::answer::{Answer, Reply};
use crate::phase::Named;
use crate::plot::{Curve, crowded, figure, panel};
use crate::read::{incidence_field, incidence_title};
use crate::solved::Method;
use anyhow::{Result, bail};
use turbid_analytic::slab_fresnel::hemispherical_reflectance;
use turbid_analytic::{FresnelSlab, Incidence};
use turbid_figure::Axis;

/// A slab between refracting faces.
pub struct Asked<'a> {
    /// Optical thickness.
    pub tau: f64,
    /// Single-scattering albedo.
    pub albedo: f64,
    /// How it scatters.
    pub named: &'a Named,
    /// Refractive index inside over outside.
    pub index: f64,
    /// How the light falls.
    pub incidence: Incidence,
    /// Depths.
    pub depth: &'a [f64],
}

/// Solves a slab.
pub fn solve(asked: &Asked<'_>, method: Method) -> Result<FresnelSlab> {
    let Asked { tau, albedo, index, incidence, named, .. } = *asked;
    match method {
        Method::Auto | Method::Ordinates => {
            Ok(FresnelSlab::with_phase(tau, albedo, &named.phase, index, incidence)?)
        }
        Method::Doubling => Ok(FresnelSlab::by_doubling(tau, albedo, &named.phase, index, incidence)?),
        Method::Peierls => bail!("--method is peierls; allowed with --index: auto, ordinates, doubling"),
    }
}

/// Answers; the figure shows the fluence against depth.
pub fn answer(asked: &Asked<'_>, method: Method, draw: bool) -> Result<Reply> {
    let slab = solve(asked, method)?;
    let mut answer = Answer::new("slab")
        .with("tau", asked.tau)
        .with("albedo", asked.albedo)
        .with("phase", asked.named.name.as_str())
        .with("index", asked.index)
        .with("mu0", incidence_field(asked.incidence));
    answer.add("specular", slab.specular());
    answer.add("face_reflectance_outside", hemispherical_reflectance(asked.index, true)?);
    answer.add("face_reflectance_inside", hemispherical_reflectance(asked.index, false)?);
    answer.add("reflectance", slab.reflectance());
    answer.add("reflectance_diffuse", slab.reflectance_diffuse());
    answer.add("transmittance", slab.transmittance());
    answer.add("transmittance_direct", slab.transmittance_direct());
    answer.add("transmittance_diffuse", slab.transmittance_diffuse());
    answer.add("absorptance", slab.absorptance());
    for &t in asked.depth {
        answer.add_at("fluence", vec![("t", t.into())], slab.fluence(t)?);
    }
    let figure = if draw {
        let curve = Curve::sample("", &crowded(asked.tau, 121), |t| Ok(slab.fluence(t)?.value))?;
        let (named, light) = (&asked.named.name, incidence_title(asked.incidence));
        let title = format!(
            "Slab τ = {}, albedo {}, {named}, index {}, {light}",
            asked.tau, asked.albedo, asked.index
        );
        let axis = Axis::linear("Depth t", "mean free paths");
        Some(figure(title, panel(axis, "Fluence over irradiance", "", vec![curve])))
    } else {
        None
    };
    Ok(Reply { answer, figure })
}
