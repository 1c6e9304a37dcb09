//! Rows that no command asks: constants, and closed forms of a kernel, with parameters in `extra` but for `a` and `r` (two
//! radii) and `n` (passes of a progressive map).

use super::row::Row;
use crate::read::dimension;
use anyhow::{Result, anyhow, ensure};
use turbid_analytic::half_space::hopf_constant;
use turbid_analytic::kernel::jensen_disc_mean_weight;
use turbid_analytic::volumes::{ball_slab_volume, lens_volume};
use turbid_analytic::{Dimension, Value, blur, progressive};

/// The value of a row, if it is one of these.
pub fn answer(row: &Row) -> Result<Option<Value>> {
    Ok(Some(match (row.text("geometry"), row.text("quantity")) {
        ("halfspace", "hopf_q_inf") => hopf_constant(),
        ("kernel", "jensen_gaussian_disc_mean_weight") => jensen_disc_mean_weight(),
        ("kernel", "mtf") => blur::modulation_transfer(space(row)?, row.number("q2pi_nu_r")?)?,
        ("kernel", "lens_volume") => lens_volume(row.number("a")?, row.number("r")?, row.number("D")?)?,
        ("kernel", "ball_cap_slab_volume") => {
            ball_slab_volume(row.number("r")?, row.number("h")?, row.number("T")?)?
        }
        ("kernel", "progressive_r_n_over_r1") => radius(row)?,
        _ => return Ok(None),
    }))
}

fn space(row: &Row) -> Result<Dimension> {
    dimension(row.text("d")).map_err(|e| anyhow!("{e}"))
}

fn radius(row: &Row) -> Result<Value> {
    let n = row.number("n")?;
    ensure!((1.0..=1e6).contains(&n) && n.fract() == 0.0, "n is {n}; allowed: 1 to 1e6, whole");
    let (d, alpha) = (space(row)?, row.number("alpha")?);
    // Tables print the optimum, 2/3 or 4/7, to eight digits: mean it, and say so.
    let optimum = 4.0 / (f64::from(d.number()) + 4.0);
    let printed = alpha != optimum && (alpha - optimum).abs() <= 5e-9;
    let radius = progressive::progressive(d, if printed { optimum } else { alpha }, n as u32)?.radius;
    Ok(if printed { Value { method: "alpha read as 4/(d+4); product and sums", ..radius } } else { radius })
}
