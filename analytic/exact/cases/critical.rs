//! Rows of critical slabs and spheres: `w` is the number of secondaries, `r` the place over the size.

use super::Answered;
use super::row::Row;
use anyhow::Result;
use std::collections::HashMap;
use std::collections::hash_map::Entry;
use turbid_analytic::critical::{Critical, CriticalShape};

/// The bodies met so far, by geometry and secondaries.
#[derive(Default)]
pub struct Bodies(HashMap<(String, u64), Critical>);

/// Answers a row.
pub fn answer(row: &Row, bodies: &mut Bodies) -> Result<Answered> {
    let (geometry, secondaries) = (row.text("geometry"), row.number("w")?);
    let shape = if geometry == "critical_slab" { CriticalShape::Slab } else { CriticalShape::Sphere };
    let body = match bodies.0.entry((geometry.to_string(), secondaries.to_bits())) {
        Entry::Occupied(entry) => entry.into_mut(),
        Entry::Vacant(entry) => entry.insert(Critical::new(shape, secondaries)?),
    };
    Ok(Ok(match row.text("quantity") {
        "half_thickness_or_radius_mfp" => body.size(),
        "flux_ratio" => body.flux_ratio(row.number("r")?)?,
        other => return Ok(Err(format!("quantity {other} of a critical body is not answered here"))),
    }))
}
