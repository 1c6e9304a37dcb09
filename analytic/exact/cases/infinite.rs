//! Rows of point sources in unbounded media.

use super::Answered;
use super::row::Row;
use crate::infinite::solve;
use crate::phase::Named;
use anyhow::Result;
use std::collections::HashMap;
use std::collections::hash_map::Entry;
use turbid_analytic::infinite::InfiniteMedium;

/// The media met so far, by albedo and g.
#[derive(Default)]
pub struct Media(HashMap<(u64, u64), InfiniteMedium>);

/// Answers a row.
pub fn answer(row: &Row, media: &mut Media) -> Result<Answered> {
    let (albedo, g) = (row.number("w")?, row.number_or("g", 0.0)?);
    let medium = match media.0.entry((albedo.to_bits(), g.to_bits())) {
        Entry::Occupied(entry) => entry.into_mut(),
        Entry::Vacant(entry) => entry.insert(solve(albedo, &Named::henyey_greenstein(g)?)?),
    };
    let r = || row.number("r");
    Ok(Ok(match row.text("quantity") {
        "diffusion_exponent_k" => match medium.decays().first() {
            Some(decay) => *decay,
            None => return Ok(Err("there is no decay slower than that of direct light".into())),
        },
        "fluence_point" => medium.fluence(r()?)?,
        "flux_point" => medium.flux(r()?)?,
        "fluence_point_asymptotic_mode" => medium.asymptotic_fluence(r()?)?,
        "fluence_point_P1_diffusion" => medium.diffusion_fluence(r()?)?,
        "mean_square_r_fluence_weighted" => medium.mean_square_radius()?,
        "total_fluence" => medium.total_fluence()?,
        "transform" => medium.transform(row.extra_number("s")?)?,
        other => return Ok(Err(format!("quantity {other} of an infinite medium is not answered here"))),
    }))
}
