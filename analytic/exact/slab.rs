//! `exact slab`: one slab, all its fluxes, and the fluence and, with isotropic scattering, radiance where asked.

use crate::table::Table;
use turbid_analytic::{AnisotropicSlab, Incidence, IsotropicSlab};

/// What to ask of a slab.
#[derive(clap::Args)]
pub struct Args {
    /// Optical thickness, 1e-12 to 400; 1e-3 to 100 with anisotropic scattering.
    #[arg(long, allow_negative_numbers = true)]
    tau: f64,
    /// Single-scattering albedo, 0 to 1.
    #[arg(long, allow_negative_numbers = true)]
    albedo: f64,
    /// Mean cosine of scattering (Henyey-Greenstein), -0.95 to 0.95; other than 0 it gives fluxes and fluence only.
    #[arg(long, default_value_t = 0.0, allow_negative_numbers = true)]
    g: f64,
    /// Cosine of incidence of a beam, above 0 to 1, or the word diffuse (Lambertian light).
    #[arg(long, default_value = "1", value_parser = incidence, allow_negative_numbers = true)]
    mu0: Incidence,
    /// Depths in mean free paths at which to give the fluence (direct light included).
    #[arg(long, num_args = 1.., value_name = "T", allow_negative_numbers = true)]
    depth: Vec<f64>,
    /// Signed cosines (positive: towards the lit face) at which to give the radiance of scattered light, at every
    /// depth, or without depths where the light leaves.
    #[arg(long, num_args = 1.., value_name = "MU", allow_negative_numbers = true)]
    mu: Vec<f64>,
    /// Orders of scattering to give one by one: 0 is direct light.
    #[arg(long, num_args = 1.., value_name = "N")]
    order: Vec<u32>,
}

/// Reads `diffuse` or a cosine; its range is checked by the solver.
pub fn incidence(text: &str) -> Result<Incidence, String> {
    if text == "diffuse" {
        return Ok(Incidence::Diffuse);
    }
    match text.parse() {
        Ok(mu0) => Ok(Incidence::Beam { mu0 }),
        Err(_) => Err(format!("mu0 is '{text}'; allowed: a number above 0 to 1, or diffuse")),
    }
}

/// Solves the slab and answers.
pub fn answer(args: &Args) -> anyhow::Result<Table> {
    if args.g != 0.0 {
        return answer_anisotropic(args);
    }
    let slab = IsotropicSlab::new(args.tau, args.albedo, args.mu0)?;
    let mut table = Table::default();
    table.add("reflectance", slab.reflectance());
    table.add("transmittance", slab.transmittance());
    table.add("transmittance direct", slab.transmittance_direct());
    table.add("transmittance diffuse", slab.transmittance_diffuse());
    table.add("absorptance", slab.absorptance());
    for &t in &args.depth {
        table.add(format!("fluence t={t}"), slab.fluence(t)?);
    }
    for &mu in &args.mu {
        let exit = [if mu >= 0.0 { 0.0 } else { args.tau }];
        let depths = if args.depth.is_empty() { exit.as_slice() } else { &args.depth };
        for &t in depths {
            table.add(format!("radiance t={t} mu={mu}"), slab.radiance(t, mu)?);
        }
    }
    for &n in &args.order {
        table.add(format!("reflectance order={n}"), slab.reflectance_of_order(n)?);
        table.add(format!("transmittance order={n}"), slab.transmittance_of_order(n)?);
        for &t in &args.depth {
            table.add(format!("fluence t={t} order={n}"), slab.fluence_of_order(n, t)?);
        }
    }
    Ok(table)
}

fn answer_anisotropic(args: &Args) -> anyhow::Result<Table> {
    let slab = AnisotropicSlab::new(args.tau, args.albedo, args.g, args.mu0)?;
    anyhow::ensure!(
        args.mu.is_empty() && args.order.is_empty(),
        "g is {}; allowed with --mu and --order: 0",
        args.g
    );
    let mut table = Table::default();
    table.add("reflectance", slab.reflectance());
    table.add("transmittance", slab.transmittance());
    table.add("transmittance direct", slab.transmittance_direct());
    table.add("transmittance diffuse", slab.transmittance_diffuse());
    table.add("absorptance", slab.absorptance());
    for &t in &args.depth {
        table.add(format!("fluence t={t}"), slab.fluence(t)?);
    }
    Ok(table)
}
