//! The claims, by counts alone.

use super::cases::{SLABS, Size, Slab, Treatment};
use super::choose::break_even;
use super::data::{Data, Measured};
use super::split::rms;
use crate::harness::{Claim, Estimate, Unit};
use turbid::stats::Moments;

/// All claims of the experiment.
pub fn all(data: &Data) -> anyhow::Result<Vec<Claim>> {
    let mut claims = Vec::new();
    for slab in &SLABS {
        claims.extend(error_claims(data, slab));
    }
    for slab in &SLABS {
        claims.extend(break_even_claim(data, slab));
    }
    for slab in &SLABS {
        claims.extend(path_claim(data, slab));
    }
    Ok(claims)
}

fn find<'a>(data: &'a Data, slab: &Slab, treatment: Treatment, size: Size) -> Option<&'a Measured> {
    data.of(slab, treatment, Some(data.largest(slab))).into_iter().find(|m| m.setting.size == size)
}

fn error_claims(data: &Data, slab: &Slab) -> Vec<Claim> {
    let mut claims = Vec::new();
    for size in [Size::Radius(0.2), Size::Nearest(50)] {
        for treatment in Treatment::ALL {
            let Some(case) = find(data, slab, treatment, size) else { continue };
            let id = format!("{}-{}-{}", slab.name, size.name().replace('=', ""), treatment.name());
            let text = format!(
                "{}, {} {}: RMS error over probes and maps, measured over predicted",
                slab.title,
                treatment.name(),
                size.name()
            );
            let statistic = rms(&case.maps).times(1.0 / case.predicted().total());
            claims.push(Claim::within(&id, &text, Unit::ONE, statistic, 0.95, 1.05));
        }
    }
    claims
}

fn break_even_claim(data: &Data, slab: &Slab) -> Option<Claim> {
    let cases = data.of(slab, Treatment::Plain, Some(data.largest(slab)));
    let statistic = break_even(&cases, data.paths(slab)?)?;
    let id = format!("{}-break-even", slab.name);
    let text = format!(
        "{}: queries from which the best plain setting costs fewer operations than paths of the same error",
        slab.title
    );
    Some(Claim::at_most(&id, &text, Unit::ONE, statistic, 4096.0))
}

fn path_claim(data: &Data, slab: &Slab) -> Option<Claim> {
    let errors: Moments =
        data.paths(slab)?.error.iter().map(|e| 100.0 * e).collect::<Vec<f64>>().iter().collect();
    let text = format!("{}: error of the path tracer, averaged over depth", slab.title);
    Some(Claim::within(
        &format!("{}-paths", slab.name),
        &text,
        Unit::PERCENT,
        Estimate::mean(&errors),
        -2.0,
        2.0,
    ))
}
