//! Rows of half-spaces.

use super::Answered;
use super::row::Row;
use anyhow::Result;
use std::collections::HashMap;
use std::collections::hash_map::Entry;
use turbid_analytic::Incidence;
use turbid_analytic::half_space::{HalfSpace, hopf_constant};

/// The half-spaces met so far, by albedo.
#[derive(Default)]
pub struct HalfSpaces(HashMap<u64, HalfSpace>);

/// Answers a row.
pub fn answer(row: &Row, spaces: &mut HalfSpaces) -> Result<Answered> {
    let quantity = row.text("quantity");
    if quantity == "hopf_q_inf" {
        return Ok(Ok(hopf_constant()));
    }
    if row.number_or("g", 0.0)? != 0.0 {
        return Ok(Err("a half-space is answered here with isotropic scattering only".into()));
    }
    let albedo = row.number("w")?;
    let space = match spaces.0.entry(albedo.to_bits()) {
        Entry::Occupied(entry) => entry.into_mut(),
        Entry::Vacant(entry) => entry.insert(HalfSpace::new(albedo)?),
    };
    Ok(Ok(match quantity {
        "H" => space.h(row.number("mu")?)?,
        "R_plane" | "R" => space.reflectance(row.incidence("mu0")?)?,
        "R_spherical" => space.reflectance(Incidence::Diffuse)?,
        "A" => space.absorptance(row.incidence("mu0")?)?,
        "radiance_up_mu0_1_unit_irradiance" => {
            space.radiance(Incidence::Beam { mu0: row.number_or("mu0", 1.0)? }, row.number("mu")?)?
        }
        "radiance_up" => space.radiance(row.incidence("mu0")?, row.number("mu")?)?,
        "fluence" => space.fluence(row.incidence("mu0")?, row.number("t")?)?,
        "flux" => space.flux(row.incidence("mu0")?, row.number("t")?)?,
        "extrapolation_length" => space.extrapolation_length()?,
        "diffusion_exponent_k" => space.decay(),
        other => return Ok(Err(format!("quantity {other} of a half-space is not answered here"))),
    }))
}
