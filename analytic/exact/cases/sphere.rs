//! Rows of spheres.

use super::Answered;
use super::row::Row;
use anyhow::{Context, Result};
use std::collections::HashMap;
use turbid_analytic::sphere::{Sphere, SphereSource, escape_from, escape_uniform};

/// The spheres of the radius at hand.
#[derive(Default)]
pub struct Spheres {
    radius: f64,
    solved: HashMap<(u64, &'static str), Sphere>,
}

impl Spheres {
    fn get(&mut self, radius: f64, albedo: f64, source: SphereSource) -> Result<&Sphere> {
        if radius.to_bits() != self.radius.to_bits() {
            self.solved.clear();
            self.radius = radius;
        }
        let name = match source {
            SphereSource::Uniform => "uniform",
            SphereSource::Centre => "centre",
            SphereSource::Incident => "incident",
        };
        let key = (albedo.to_bits(), name);
        if !self.solved.contains_key(&key) {
            let sphere = match self.solved.values().next() {
                Some(other) => other.with(albedo, source)?,
                None => Sphere::new(radius, albedo, source)?,
            };
            self.solved.insert(key, sphere);
        }
        self.solved.get(&key).context("the sphere was just solved")
    }
}

/// Answers a row.
pub fn answer(row: &Row, spheres: &mut Spheres) -> Result<Answered> {
    use SphereSource::{Centre, Incident, Uniform};
    if row.number_or("g", 0.0)? != 0.0 {
        return Ok(Err("a sphere is answered here with isotropic scattering only".into()));
    }
    let (a, albedo) = (row.number("a")?, row.number("w")?);
    Ok(Ok(match row.text("quantity") {
        "escape_uniform_source" => spheres.get(a, albedo, Uniform)?.escape(),
        "escape_central_point" => spheres.get(a, albedo, Centre)?.escape(),
        "escape_iso_incidence" => spheres.get(a, albedo, Incident)?.escape(),
        "absorbed_uniform_source" => spheres.get(a, albedo, Uniform)?.absorptance(),
        "absorbed_central_point" => spheres.get(a, albedo, Centre)?.absorptance(),
        "absorbed_iso_incidence" => spheres.get(a, albedo, Incident)?.absorptance(),
        "fluence_uniform_source_unit_power" => spheres.get(a, albedo, Uniform)?.fluence(row.number("r")?)?,
        "fluence_central_point" => spheres.get(a, albedo, Centre)?.fluence(row.number("r")?)?,
        "fluence_iso_incidence_unit_irradiance" => {
            spheres.get(a, albedo, Incident)?.fluence(row.number("r")?)?
        }
        "exit_radiance_uniform_unit_power" => {
            spheres.get(a, albedo, Uniform)?.exit_radiance(row.number("mu")?)?
        }
        "exit_radiance_central_point" => spheres.get(a, albedo, Centre)?.exit_radiance(row.number("mu")?)?,
        "exit_radiance_iso_incidence" => {
            spheres.get(a, albedo, Incident)?.exit_radiance(row.number("mu")?)?
        }
        "escape_first_flight_uniform" => escape_uniform(a)?,
        "escape_first_flight_from" => escape_from(a, row.number("r")?)?,
        other => return Ok(Err(format!("quantity {other} of a sphere is not answered here"))),
    }))
}
