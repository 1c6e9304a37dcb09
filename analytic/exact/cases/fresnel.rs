//! Rows of slabs between refracting faces.

use super::Answered;
use super::row::Row;
use super::slab::named;
use crate::fresnel::{Asked, solve};
use crate::solved::Method;
use anyhow::Result;
use std::collections::HashMap;
use std::collections::hash_map::Entry;
use turbid_analytic::{FresnelSlab, Incidence};

/// The slabs met so far, by all their parameters.
#[derive(Default)]
pub struct FresnelSlabs(HashMap<([u64; 4], String), FresnelSlab>);

/// Answers a row.
pub fn answer(row: &Row, slabs: &mut FresnelSlabs) -> Result<Answered> {
    let quantity = row.text("quantity");
    // Of Lambertian light, whatever the beam of the other rows.
    let spherical = matches!(quantity, "Rs" | "Ts");
    let incidence = if spherical { Incidence::Diffuse } else { row.incidence("mu0")? };
    let named = match named(row)? {
        Ok(named) => named,
        Err(note) => return Ok(Err(note)),
    };
    let (tau, albedo, index) = (row.number("tau")?, row.number("w")?, row.number_or("n", 1.0)?);
    let light = if let Incidence::Beam { mu0 } = incidence { mu0.to_bits() } else { u64::MAX };
    let key = ([tau.to_bits(), albedo.to_bits(), index.to_bits(), light], named.name.clone());
    let slab = match slabs.0.entry(key) {
        Entry::Occupied(entry) => entry.into_mut(),
        Entry::Vacant(entry) => {
            let asked = Asked { tau, albedo, named: &named, index, incidence, depth: &[] };
            entry.insert(solve(&asked, Method::Auto)?)
        }
    };
    Ok(Ok(match quantity {
        "Rspec" => slab.specular(),
        "Rdiff" => slab.reflectance_diffuse(),
        "Rtot" | "R" | "Rs" => slab.reflectance(),
        "Tcoll" | "T_direct" => slab.transmittance_direct(),
        "Tdiff" | "T_diffuse" => slab.transmittance_diffuse(),
        "Ttot" | "T_total" | "Ts" => slab.transmittance(),
        "A" => slab.absorptance(),
        "fluence" => slab.fluence(row.number("t")?)?,
        other => {
            return Ok(Err(format!(
                "quantity {other} of a slab between refracting faces is not answered here"
            )));
        }
    }))
}
