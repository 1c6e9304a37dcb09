//! The tables.

use super::results::Results;
use super::storage::{self};
use crate::harness::{Table, number, percent, percent_with_error, signed, with_error};

fn columns(names: &[&str]) -> Vec<String> {
    names.iter().map(|name| name.to_string()).collect()
}

/// Sampled rows: measured, exact, z.
pub fn sampled(results: &Results) -> Table {
    let word = |z: f64| if z.abs() < 4.9 { "agrees" } else { "differs" }.to_string();
    let mut rows: Vec<Vec<String>> = results
        .sampled
        .iter()
        .map(|r| {
            let (mean, error) = (r.moments.mean(), r.moments.std_error());
            let measured = with_error(mean, error);
            vec![
                r.class.name().to_string(),
                r.name.clone(),
                measured,
                number(r.exact.0),
                signed(percent(mean / r.exact.0 - 1.0), 3),
                signed(r.z(), 1),
                r.smallest_bias().map_or("exact".to_string(), |bias| number(percent(bias))),
                word(r.z()),
            ]
        })
        .collect();
    for r in &results.large {
        let ((count, emitted), (p, _)) = (r.count, r.exact);
        let error = (p * (1.0 - p) / emitted).sqrt();
        rows.push(vec![
            "number".to_string(),
            r.name.clone(),
            with_error(count / emitted, error),
            number(p),
            signed(percent(count / emitted / p - 1.0), 3),
            signed(r.z(), 1),
            number(percent(r.smallest_bias())),
            word(r.z()),
        ]);
    }
    Table {
        caption: "Sampled rows: means with their standard error over 64 batches (binomial, for the one large pass), \
                  beside exact values; lengths in mean free paths, w the albedo, fluxes as parts of the incident \
                  power, fluence per unit of irradiance. Visible is the smallest bias, as a part of the exact value, that the \
                  row would hardly ever miss; 'exact' where nothing varies. A row differs beyond 4.9 standard errors, which happens once \
                  in a million rows that are right."
            .to_string(),
        columns: columns(&["about", "case", "measured", "exact", "error [%]", "z", "visible [%]", ""]),
        rows,
    }
}

/// Checked rows: value, exact, difference over what roundings allow.
pub fn checked(results: &Results) -> Table {
    let rows = results
        .checked
        .iter()
        .map(|r| {
            let share = if r.bound == 0.0 { "same number".to_string() } else { number(r.share()) };
            vec![
                r.class.name().to_string(),
                r.name.clone(),
                number(r.value),
                number(r.exact),
                if r.bound == 0.0 { "0".to_string() } else { number(r.bound) },
                if r.is_right() { share } else { format!("wrong: {}", number(r.share())) },
            ]
        })
        .collect();
    Table {
        caption: "Checked rows: computed once. The bound counts the roundings that the way to the number has; the \
                  last column is the difference from the exact value over that bound, or says that the two must be, \
                  and are, the same number. A refusal is 1 if an error named what was wrong."
            .to_string(),
        columns: columns(&["about", "case", "value", "exact", "bound", "difference / bound"]),
        rows,
    }
}

/// Single against double precision.
pub fn storage(results: &Results) -> Table {
    let rows = results
        .storage
        .iter()
        .map(|r| {
            vec![
                r.rule.name(),
                number(storage::extent(r.power)),
                number(r.extent_in_radii()),
                number(storage::spacing(r.power)),
                with_error(r.rms.value(), r.rms.std_error()),
                number(r.predicted_rms),
                percent_with_error(&r.difference),
                number(percent(r.predicted.0)),
            ]
        })
        .collect();
    Table {
        caption: "The same photons in single precision (the tree) and in double precision (a plain search), in fog of \
                  radius 1 with one photon more at the extent: root mean square difference in standard errors of one \
                  estimate, and mean difference in per cent of the exact fluence. Extent over the radius 0.25, for \
                  both gathers. At short extents hardly any photon changes sides, and what is left at k = 50 is the \
                  radius itself."
            .to_string(),
        columns: columns(&[
            "gather",
            "extent [mfp]",
            "extent / radius",
            "spacing [mfp]",
            "rms difference",
            "predicted",
            "mean difference [%]",
            "predicted [%]",
        ]),
        rows,
    }
}
