//! Phase functions.

use super::writer::refuse;
use crate::error::Result;
use crate::exchange::xml::{Xml, number};
use crate::phase::{HenyeyGreenstein, Phase, PhaseFunction};
use std::f64::consts::PI;

/// What is scattered elsewhere than the phase function says, at most.
const MOST_ELSEWHERE: f64 = 2e-4;

/// Most cosines of a table.
const MOST_COSINES: usize = (1 << 15) + 1;

/// A phase function as Mitsuba says it.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Said {
    Isotropic,
    HenyeyGreenstein(f64),
    Rayleigh,
    /// The second one, and how much of it.
    Blend([f64; 2], f64),
    /// Values at even cosines from -1 to 1.
    Table(Vec<f64>),
}

/// A phase function for Mitsuba, and the share of the light that goes elsewhere.
pub(super) fn said(phase: &Phase) -> Result<(Said, f64)> {
    Ok(match phase {
        Phase::Isotropic(_) => (Said::Isotropic, 0.0),
        Phase::HenyeyGreenstein(p) => (Said::HenyeyGreenstein(p.g()), 0.0),
        Phase::Rayleigh(_) => (Said::Rayleigh, 0.0),
        Phase::TwoTerm(p) => {
            let [(_, first), (share, second)] = p.terms();
            (Said::Blend([first, second].map(|term: HenyeyGreenstein| term.g()), share), 0.0)
        }
        Phase::Schlick(_) | Phase::Tabulated(_) | Phase::Legendre(_) => table(phase)?,
    })
}

/// Density over the cosine.
fn density(phase: &Phase, mu: f64) -> f64 {
    2.0 * PI * phase.eval(1.0 - mu, 1.0 + mu)
}

fn cosine(i: usize, count: usize) -> f64 {
    -1.0 + 2.0 * i as f64 / (count - 1) as f64
}

/// Half the integral of the difference between a density and the line between values at even cosines.
fn elsewhere(phase: &Phase, values: &[f64], kinks: &[f64]) -> f64 {
    let count = values.len();
    let sum: f64 =
        (0..count - 1).map(|i| 0.5 * (values[i] + values[i + 1])).sum::<f64>() * 2.0 / (count - 1) as f64;
    let mut places: Vec<f64> = (0..4 * (count - 1) + 1).map(|i| cosine(i, 4 * (count - 1) + 1)).collect();
    places.extend(kinks);
    places.sort_by(f64::total_cmp);
    let difference = |mu: f64| {
        let at = (0.5 * (mu + 1.0) * (count - 1) as f64).clamp(0.0, (count - 1) as f64);
        let i = (at as usize).min(count - 2);
        let line = values[i] + (at - i as f64) * (values[i + 1] - values[i]);
        (density(phase, mu) - line / sum).abs()
    };
    let differences: Vec<f64> = places.iter().map(|mu| difference(*mu)).collect();
    let pieces = places.windows(2).zip(differences.windows(2));
    0.5 * pieces.map(|(mu, d)| 0.5 * (d[0] + d[1]) * (mu[1] - mu[0])).sum::<f64>()
}

/// Values at even cosines: as few as are enough, those of the table itself where they are even.
fn table(phase: &Phase) -> Result<(Said, f64)> {
    let kinks: Vec<f64> = phase.kinks().iter().map(|(minus, plus)| 0.5 * (plus - minus)).collect();
    let is_even =
        kinks.len() > 1 && kinks.iter().enumerate().all(|(i, mu)| (mu - cosine(i, kinks.len())).abs() < 1e-9);
    let mut count = if is_even { kinks.len() } else { 65 };
    let mut last = 1.0;
    while count <= MOST_COSINES || is_even {
        let values: Vec<f64> = (0..count).map(|i| density(phase, cosine(i, count))).collect();
        last = elsewhere(phase, &values, &kinks);
        if last <= MOST_ELSEWHERE || is_even {
            return Ok((Said::Table(values), last));
        }
        count = 2 * count - 1;
    }
    refuse(format!(
        "the phase function is too narrow for Mitsuba's even steps of the cosine: of {MOST_COSINES} values {last:.1e} of the light go elsewhere; allowed: {MOST_ELSEWHERE:e}"
    ))
}

impl Said {
    pub(super) fn write(&self, xml: &mut Xml) {
        match self {
            Said::Isotropic => xml.element("phase", &[("type", "isotropic")]),
            Said::Rayleigh => xml.element("phase", &[("type", "rayleigh")]),
            // At 0 its sampling divides by 0.
            Said::HenyeyGreenstein(0.0) => Said::Isotropic.write(xml),
            Said::HenyeyGreenstein(g) => xml.within("phase", &[("type", "hg")], |xml| xml.float("g", *g)),
            Said::Blend(terms, weight) => xml.within("phase", &[("type", "blendphase")], |xml| {
                xml.float("weight", *weight);
                terms.iter().for_each(|g| Said::HenyeyGreenstein(*g).write(xml));
            }),
            Said::Table(values) => xml.within("phase", &[("type", "tabphase")], |xml| {
                let values: Vec<String> = values.iter().map(|value| number(*value)).collect();
                xml.value("string", "values", &values.join(", "));
            }),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::phase::{Schlick, Tabulated};
    use std::sync::Arc;

    /// Every specimen is said or refused; what a table says has the mean cosine of the phase function.
    #[test]
    fn tables_scatter_alike() {
        let mut tables = 0;
        for phase in Phase::specimens() {
            let Ok((Said::Table(values), off)) = said(&phase) else { continue };
            tables += 1;
            let n = values.len() - 1;
            // Of a line over a piece: the mean of mu times value, exactly.
            let (mut sum, mut first) = (0.0, 0.0);
            for i in 0..n {
                let (a, b) = (cosine(i, n + 1), cosine(i + 1, n + 1));
                sum += 0.5 * (b - a) * (values[i] + values[i + 1]);
                first += (b - a) / 6.0 * (values[i] * (2.0 * a + b) + values[i + 1] * (a + 2.0 * b));
            }
            assert!((first / sum - phase.moment(1)).abs() <= 2.0 * off + 1e-12, "{phase:?}");
        }
        assert!(tables >= 4, "{tables}");
    }

    #[test]
    fn even_tables_keep_their_values_and_narrow_ones_are_refused() {
        let angles = [180.0, 90.0, 0.0].map(|angle: f64| (angle, 3.0 - angle / 90.0));
        let rising: Vec<(f64, f64)> = angles.into_iter().rev().collect();
        let phase = Phase::Tabulated(Arc::new(Tabulated::new(&rising).unwrap()));
        let (Said::Table(values), _) = said(&phase).unwrap() else { panic!() };
        assert_eq!(values.len(), 3);
        assert!((values[2] / values[1] - 1.5).abs() < 1e-12 && (values[0] / values[1] - 0.5).abs() < 1e-12);
        let narrow = Phase::Schlick(Schlick::new(crate::math::Asymmetry::new("k", 1.0 - 1e-9).unwrap()));
        assert!(said(&narrow).unwrap_err().to_string().starts_with("the phase function is too narrow"));
    }
}
