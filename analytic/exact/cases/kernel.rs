//! Rows of kernels: parameters in `extra`, but for `a` and `r` (two radii) and `n` (passes of a progressive map).

use super::Answered;
use super::row::Row;
use crate::read::kernel;
use anyhow::{Result, anyhow, ensure};
use turbid_analytic::ball_mean::exponential_mean;
use turbid_analytic::{Kernel, Value, blur, progressive, volumes};

/// Answers a row.
pub fn answer(row: &Row) -> Result<Answered> {
    let named = || kernel(row.extra("kernel").unwrap_or("")).map_err(|e| anyhow!("{e}"));
    let value = match row.text("quantity") {
        "m2" => named()?.moment(row.dimension()?, 2)?,
        "m4" => named()?.moment(row.dimension()?, 4)?,
        "roughness_R" => named()?.roughness(row.dimension()?)?,
        "bias_coeff_r2_laplacian" => named()?.bias_coefficient(row.dimension()?)?,
        "bias_coeff_r4_bilaplacian" => named()?.second_bias_coefficient(row.dimension()?)?,
        "jensen_gaussian_disc_mean_weight" => turbid_analytic::kernel::jensen_disc_mean_weight(),
        "equivalent_width_over_r" => blur::equivalent_width(row.dimension()?),
        "esf" => blur::edge_spread(row.dimension()?, row.extra_number("x_over_r")?)?,
        "lsf" => blur::line_spread(row.dimension()?, row.extra_number("x_over_r")?)?,
        "mtf" => blur::modulation_transfer(row.dimension()?, row.extra_number("q2pi_nu_r")?)?,
        "esf_10_90_width_over_r" => blur::rise_width(row.dimension()?),
        "lsf_std_over_r" => blur::line_deviation(row.dimension()?),
        "halfspace_missing_length_over_r" => blur::missing_length(row.dimension()?),
        "lens_volume" => volumes::lens_volume(row.number("a")?, row.number("r")?, row.extra_number("D")?)?,
        "ball_cap_slab_volume" => {
            volumes::ball_slab_volume(row.number("r")?, row.extra_number("h")?, row.extra_number("T")?)?
        }
        "progressive_r_n_over_r1" => radius(row)?,
        "ball_mean_of_exp_field_ratio" => {
            let kernel = if row.extra("kernel").is_some() { named()? } else { Kernel::Uniform };
            exponential_mean(kernel, row.dimension()?, row.extra_number("b_r")?)?
        }
        other => return Ok(Err(format!("quantity {other} of a kernel is not answered here"))),
    };
    Ok(Ok(value))
}

fn radius(row: &Row) -> Result<Value> {
    let n = row.number("n")?;
    ensure!((1.0..=1e6).contains(&n) && n.fract() == 0.0, "n is {n}; allowed: 1 to 1e6, whole");
    let (d, alpha) = (row.dimension()?, row.extra_number("alpha")?);
    // Tables print the optimum, 2/3 or 4/7, to eight digits: mean it, and say so.
    let optimum = 4.0 / (f64::from(d.number()) + 4.0);
    let printed = alpha != optimum && (alpha - optimum).abs() <= 5e-9;
    let radius = progressive::progressive(d, if printed { optimum } else { alpha }, n as u32)?.radius;
    Ok(if printed { Value { method: "alpha read as 4/(d+4); product and sums", ..radius } } else { radius })
}
