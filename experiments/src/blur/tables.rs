//! The tables.

use super::cases::NEIGHBORS;
use super::results::CaseResult;
use crate::harness::{Table, number, percent, with_error};
use crate::theory::kernel_title;
use std::f64::consts::PI;
use turbid_analytic::edge::{Edge, NearestEdge};
use turbid_analytic::kernel as referee;

/// Widths of every profile.
pub fn widths(results: &[CaseResult]) -> Table {
    let row = |r: &CaseResult| {
        let scale = r.case.scale();
        let by_scale = |value: f64, error: f64| with_error(value / scale, error / scale);
        let single = &r.single;
        vec![
            r.case.photons.to_string(),
            r.case.gather_name(),
            kernel_title(r.case.kernel).to_string(),
            format!("{scale:.4}"),
            by_scale(r.rise.value(), r.rise.std_error()),
            format!("{:.4}", r.theory.rise_probed / scale),
            r.equivalent.map_or_else(String::new, |e| by_scale(e.value(), e.std_error())),
            format!("{:.4}", r.theory.equivalent_probed / scale),
            by_scale(single.mean(), single.std_error()),
        ]
    };
    let columns = [
        "photons a map",
        "gather",
        "kernel",
        "radius [mfp]",
        "10–90 % width / radius",
        "predicted",
        "equivalent width / radius",
        "predicted",
        "10–90 % width of one map / radius",
    ];
    Table {
        caption: "Widths of the edge's image over the radius, which for the k nearest is that of the ball that holds k \
                  photons in full light, on average. They are read off the mean profile of all maps, with jackknifed \
                  standard errors. The last column is the mean of the widths of single maps' profiles, another number \
                  where noise is large, since the crossings of a noisy profile do not average to those of its mean. \
                  It is never the one that is claimed."
            .to_string(),
        columns: columns.map(String::from).to_vec(),
        rows: results.iter().map(row).collect(),
    }
}

/// Photons that a sharpness costs, computed.
pub fn cost() -> anyhow::Result<Table> {
    let fixed = Edge::new(referee::Kernel::Uniform, 0.0)?.rise_width()?.value;
    let mut rows = Vec::new();
    for width in [0.1, 0.2, 0.5] {
        for k in NEIGHBORS {
            let k = u32::try_from(k)?;
            // One photon a unit of volume; the cap is far away.
            let unit =
                NearestEdge::new(referee::Kernel::Uniform, k, 1.0, 0.0, 30.0 * libm::cbrt(f64::from(k)))?;
            let ratio = unit.rise_width()?.value / width;
            let density = ratio * ratio * ratio;
            let noise = 1.0 / (f64::from(k) - 2.0).sqrt();
            let radius = width / fixed;
            let in_ball = 4.0 / 3.0 * PI * radius * radius * radius;
            rows.push(vec![
                width.to_string(),
                k.to_string(),
                number(density),
                format!("{:.1} %", percent(noise)),
                format!("{:.4}", radius),
                format!("{:.0}", density * in_ball),
                format!("{:.1} %", percent(1.0 / (density * in_ball).sqrt())),
                number(1.0 / (noise * noise * in_ball)),
            ]);
        }
    }
    let columns = [
        "10–90 % width [mfp]",
        "k",
        "photons per cubic mfp",
        "noise in full light",
        "fixed radius of that width [mfp]",
        "photons in its ball",
        "its noise with as many photons",
        "photons per cubic mfp it needs for the noise of k",
    ];
    Ok(Table {
        caption: "What a sharp edge costs: photons stored per cubic mean free path that give the image of an edge a \
                  10–90 % width, for the k nearest, and what the fixed radius of the same width does with them \
                  (uniform kernel, computed without decay along the shaft, which changes widths by less than half a \
                  per cent here). At equal sharpness the k nearest need about four times the photons for the same \
                  noise in full light, and have twice the noise with the same photons."
            .to_string(),
        columns: columns.map(String::from).to_vec(),
        rows,
    })
}
