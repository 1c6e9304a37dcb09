//! Rows of slabs.

use super::Answered;
use super::row::Row;
use crate::orders::Orders;
use crate::phase::Named;
use crate::solved::{PEIERLS_UP_TO, Solved};
use anyhow::{Context, Result};
use std::collections::HashMap;
use std::collections::hash_map::Entry;
use turbid_analytic::slab_single::single_radiance;
use turbid_analytic::{AnisotropicMedium, Incidence, IsotropicSlab, Phase, Value};

/// Media with all that they have solved, and the slabs of the thickness at hand.
#[derive(Default)]
pub struct Slabs {
    tau: f64,
    /// By albedo and phase function.
    media: HashMap<(u64, String), AnisotropicMedium>,
    /// By albedo, phase function and light.
    solved: HashMap<(u64, String, u64), Solved>,
    orders: HashMap<(u64, String, u64), Orders>,
}

impl Slabs {
    fn get(&mut self, tau: f64, albedo: f64, named: &Named, incidence: Incidence) -> Result<&Solved> {
        if !named.is_isotropic() || tau > PEIERLS_UP_TO {
            return self.ordinates(tau, albedo, named, incidence);
        }
        self.turn_to(tau);
        let key = key(albedo, named, incidence);
        if !self.solved.contains_key(&key) {
            // Slabs of one thickness share an operator.
            let other = self.solved.values().find_map(|s| match s {
                Solved::Peierls(slab) => Some(slab),
                Solved::Both(slab, _) => Some(slab.as_ref()),
                _ => None,
            });
            let slab = match other {
                Some(other) => other.with(albedo, incidence)?,
                None => IsotropicSlab::new(tau, albedo, incidence)?,
            };
            let media = &mut self.media;
            let solved = Solved::isotropic(slab, tau, || {
                let medium = match media.entry((albedo.to_bits(), named.name.clone())) {
                    Entry::Occupied(entry) => entry.into_mut(),
                    Entry::Vacant(entry) => entry.insert(AnisotropicMedium::new(albedo, &named.phase)?),
                };
                medium.slab(tau, incidence)
            });
            self.solved.insert(key.clone(), solved);
        }
        self.solved.get(&key).context("the slab was just solved")
    }

    fn ordinates(&mut self, tau: f64, albedo: f64, named: &Named, incidence: Incidence) -> Result<&Solved> {
        self.turn_to(tau);
        let medium = (albedo.to_bits(), named.name.clone());
        let mut key = key(albedo, named, incidence);
        key.1.push_str(" by ordinates");
        if !self.solved.contains_key(&key) {
            if !self.media.contains_key(&medium) {
                self.media.insert(medium.clone(), AnisotropicMedium::new(albedo, &named.phase)?);
            }
            let solved = self.media.get(&medium).context("the medium was just solved")?;
            self.solved.insert(key.clone(), Solved::Ordinates(solved.slab(tau, incidence)?));
        }
        self.solved.get(&key).context("the slab was just solved")
    }

    fn orders(&mut self, tau: f64, albedo: f64, named: &Named, incidence: Incidence) -> Result<&Orders> {
        self.turn_to(tau);
        Ok(match self.orders.entry(key(albedo, named, incidence)) {
            Entry::Occupied(entry) => entry.into_mut(),
            Entry::Vacant(entry) => entry.insert(Orders::new(tau, albedo, named, incidence)?),
        })
    }

    fn turn_to(&mut self, tau: f64) {
        if tau.to_bits() != self.tau.to_bits() {
            self.solved.clear();
            self.orders.clear();
            self.tau = tau;
        }
    }
}

fn key(albedo: f64, named: &Named, incidence: Incidence) -> (u64, String, u64) {
    let light = match incidence {
        Incidence::Beam { mu0 } => mu0.to_bits(),
        Incidence::Diffuse => u64::MAX,
    };
    (albedo.to_bits(), named.name.clone(), light)
}

/// The phase function of a row: Henyey-Greenstein by its column, others by name in `extra`.
pub fn named(row: &Row) -> Result<std::result::Result<Named, String>> {
    Ok(match row.extra("phase") {
        Some("rayleigh") => Ok(Named { phase: Phase::rayleigh(), name: "Rayleigh".into(), single_g: None }),
        Some("two_term") => {
            let (g1, g2, share) = (row.number("g")?, row.extra_number("g2")?, row.extra_number("share")?);
            let name = format!("two-term g={g1} g2={g2} share={share}");
            Ok(Named { phase: Phase::two_term(g1, g2, share)?, name, single_g: None })
        }
        Some(other) => {
            Err(format!("phase function {other} is not known here; allowed: rayleigh, two_term, or none"))
        }
        None => Ok(Named::henyey_greenstein(row.number_or("g", 0.0)?)?),
    })
}

/// Answers a row.
pub fn answer(row: &Row, slabs: &mut Slabs) -> Result<Answered> {
    let quantity = row.text("quantity");
    let (tau, albedo) = (row.number("tau")?, row.number("w")?);
    let named = match named(row)? {
        Ok(named) => named,
        Err(note) => return Ok(Err(note)),
    };
    if row.number_or("n", 1.0)? != 1.0 {
        return Ok(Err("refracting faces are asked by geometry slab_fresnel".into()));
    }
    let radiance =
        matches!(quantity, "radiance_up" | "radiance_down_diffuse" | "radiance_total_diffuse" | "radiance");
    if let Some(n) = row.extra_whole("order", 0..=1000)? {
        return by_order(row, n, radiance, &named, slabs);
    }
    // X and Y are functions of the cosine mu, and mu times the fluence on the two faces under a beam of that cosine.
    let light = row.incidence(if matches!(quantity, "X" | "Y") { "mu" } else { "mu0" })?;
    // The Peierls equation has no net flux at a depth.
    let slab = if quantity == "flux" {
        slabs.ordinates(tau, albedo, &named, light)?
    } else {
        slabs.get(tau, albedo, &named, light)?
    };
    let times_mu = |v: Value, mu: f64| Value { value: v.value * mu, error: v.error * mu, ..v };
    Ok(match quantity {
        "R" => Ok(slab.reflectance()),
        "T_total" => Ok(slab.transmittance()),
        "T_diffuse" => Ok(slab.transmittance_diffuse()),
        "T_direct" => Ok(slab.transmittance_direct()),
        "A" => Ok(slab.absorptance()),
        "fluence" => Ok(slab.fluence(row.number("t")?)?),
        "flux" => Ok(slab.flux(row.number("t")?)?),
        _ if radiance => {
            Ok(slab.radiance(row.number("t")?, row.number("mu")?, row.number_or("dphi", 0.0)?)?)
        }
        "X" => Ok(times_mu(slab.fluence(0.0)?, row.number("mu")?)),
        "Y" => Ok(times_mu(slab.fluence(tau)?, row.number("mu")?)),
        other => Err(format!("quantity {other} of a slab is not answered here")),
    })
}

fn by_order(row: &Row, n: u32, radiance: bool, named: &Named, slabs: &mut Slabs) -> Result<Answered> {
    let (tau, albedo) = (row.number("tau")?, row.number("w")?);
    if radiance && n == 1 && row.text("mu0") != "diffuse" {
        let g = named.only_g("order=1")?;
        let (mu0, t, mu) = (row.number("mu0")?, row.number("t")?, row.number("mu")?);
        return Ok(Ok(single_radiance(tau, albedo, g, mu0, t, mu, row.number_or("dphi", 0.0)?)?));
    }
    let slab = slabs.orders(tau, albedo, named, row.incidence("mu0")?)?;
    Ok(match row.text("quantity") {
        "R" => Ok(slab.reflectance(n)?),
        "T_total" => Ok(slab.transmittance(n)?),
        "fluence" => Ok(slab.fluence(n, row.number("t")?)?),
        other => Err(format!("quantity {other} is not answered by order")),
    })
}
