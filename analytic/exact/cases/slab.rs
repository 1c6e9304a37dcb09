//! Rows of slabs.

use super::Answered;
use super::row::Row;
use anyhow::{Context, Result};
use std::collections::HashMap;
use std::collections::hash_map::Entry;
use turbid_analytic::slab_single::single_radiance;
use turbid_analytic::{AnisotropicSlab, Incidence, IsotropicSlab, Value};

/// The slabs of the thickness at hand.
#[derive(Default)]
pub struct Slabs {
    tau: f64,
    solved: HashMap<(u64, u64), IsotropicSlab>,
    anisotropic: HashMap<(u64, u64, u64), AnisotropicSlab>,
}

impl Slabs {
    fn get(&mut self, tau: f64, albedo: f64, incidence: Incidence) -> Result<&IsotropicSlab> {
        self.turn_to(tau);
        let key = (albedo.to_bits(), light_bits(incidence));
        if !self.solved.contains_key(&key) {
            let slab = match self.solved.values().next() {
                Some(other) => other.with(albedo, incidence)?,
                None => IsotropicSlab::new(tau, albedo, incidence)?,
            };
            self.solved.insert(key, slab);
        }
        self.solved.get(&key).context("the slab was just solved")
    }

    fn get_anisotropic(&mut self, tau: f64, albedo: f64, g: f64, incidence: Incidence) -> Result<&AnisotropicSlab> {
        self.turn_to(tau);
        let key = (albedo.to_bits(), g.to_bits(), light_bits(incidence));
        Ok(match self.anisotropic.entry(key) {
            Entry::Occupied(entry) => entry.into_mut(),
            Entry::Vacant(entry) => entry.insert(AnisotropicSlab::new(tau, albedo, g, incidence)?),
        })
    }

    fn turn_to(&mut self, tau: f64) {
        if tau.to_bits() != self.tau.to_bits() {
            self.solved.clear();
            self.anisotropic.clear();
            self.tau = tau;
        }
    }
}

fn light_bits(incidence: Incidence) -> u64 {
    match incidence {
        Incidence::Beam { mu0 } => mu0.to_bits(),
        Incidence::Diffuse => u64::MAX,
    }
}

/// Answers a row.
pub fn answer(row: &Row, slabs: &mut Slabs) -> Result<Answered> {
    let quantity = row.text("quantity");
    let (tau, albedo) = (row.number("tau")?, row.number("w")?);
    let (g, index) = (row.number_or("g", 0.0)?, row.number_or("n", 1.0)?);
    let order = row.extra_whole("order", 0..=1000)?;
    if index != 1.0 {
        return Ok(Err("refracting faces are not answered here".into()));
    }
    let radiance = matches!(quantity, "radiance_up" | "radiance_down_diffuse" | "radiance_total_diffuse");
    if radiance && order == Some(1) && row.text("mu0") != "diffuse" {
        let (mu0, t, mu) = (row.number("mu0")?, row.number("t")?, row.number("mu")?);
        return Ok(Ok(single_radiance(tau, albedo, g, mu0, t, mu, row.number_or("dphi", 0.0)?)?));
    }
    if g != 0.0 {
        if order.is_some() || !matches!(quantity, "R" | "T_total" | "T_diffuse" | "T_direct" | "A" | "fluence") {
            return Ok(Err(format!(
                "quantity {quantity} is not answered for anisotropic scattering, or not by order"
            )));
        }
        let slab = slabs.get_anisotropic(tau, albedo, g, row.incidence("mu0")?)?;
        return Ok(Ok(match quantity {
            "R" => slab.reflectance(),
            "T_total" => slab.transmittance(),
            "T_diffuse" => slab.transmittance_diffuse(),
            "T_direct" => slab.transmittance_direct(),
            "A" => slab.absorptance(),
            _ => slab.fluence(row.number("t")?)?,
        }));
    }
    // X and Y are functions of the cosine mu, and mu times the fluence on the two faces under a beam of that cosine.
    let chandrasekhar = matches!(quantity, "X" | "Y");
    let slab = slabs.get(tau, albedo, row.incidence(if chandrasekhar { "mu" } else { "mu0" })?)?;
    if let Some(n) = order {
        return Ok(match quantity {
            "R" => Ok(slab.reflectance_of_order(n)?),
            "T_total" => Ok(slab.transmittance_of_order(n)?),
            "fluence" => Ok(slab.fluence_of_order(n, row.number("t")?)?),
            other => Err(format!("quantity {other} is not answered by order")),
        });
    }
    let times_mu = |v: Value, mu: f64| Value { value: v.value * mu, error: v.error * mu, ..v };
    Ok(match quantity {
        "R" => Ok(slab.reflectance()),
        "T_total" => Ok(slab.transmittance()),
        "T_diffuse" => Ok(slab.transmittance_diffuse()),
        "T_direct" => Ok(slab.transmittance_direct()),
        "A" => Ok(slab.absorptance()),
        "fluence" => Ok(slab.fluence(row.number("t")?)?),
        _ if radiance => Ok(slab.radiance(row.number("t")?, row.number("mu")?)?),
        "X" => Ok(times_mu(slab.fluence(0.0)?, row.number("mu")?)),
        "Y" => Ok(times_mu(slab.fluence(tau)?, row.number("mu")?)),
        other => Err(format!("quantity {other} of a slab is not answered here")),
    })
}
