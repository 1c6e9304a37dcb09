//! The tables.

use super::fields::FIELDS;
use super::measure::path_case;
use super::results::{CaseResult, exact_at, largest, pick};
use crate::harness::{Cells, Table, percent, percent_with_error, signed, with_error};
use crate::prediction::Term;
use crate::setups::Size;
use turbid::estimators::Kernel;

/// Measured and predicted error with its parts.
pub fn errors(results: &[CaseResult]) -> Table {
    let columns = [
        "field",
        "photons",
        "depth",
        "gather",
        "measured error",
        "predicted",
        "edge",
        "blur",
        "clusters",
        "z",
        "",
    ];
    let part = |x: f64| if x.abs() < 5e-5 { "0".to_string() } else { signed(percent(x), 2) };
    let chosen = pick(results, |r| {
        let is_shown = matches!(r.case.size, Size::Radius(_) | Size::Nearest(50 | 500));
        is_shown && r.case.kernel == Kernel::Uniform && r.case.photons == largest(results, r.case.field)
    });
    let row = |r: &&CaseResult| {
        vec![
            r.case.field.name.to_string(),
            r.case.photons.to_string(),
            r.case.depth.to_string(),
            r.case.gather_name(),
            percent_with_error(&r.error),
            part(r.expected.total()),
            part(r.expected.of(Term::Edge)),
            part(r.expected.of(Term::Blur)),
            part(r.expected.of(Term::Clusters)),
            signed(r.z(), 1),
            if r.sees_prediction() { "" } else { "cannot see its prediction" }.to_string(),
        ]
    };
    Table {
        caption: "Signed error of the fluence at the largest number of photons, in per cent of the exact value, with \
                  its standard error over maps, beside what was predicted and its parts; depths and radii in mean \
                  free paths, uniform kernel. A row whose standard error is more than half of the predicted error \
                  says so: it can confirm nothing. Every case is in results.csv."
            .to_string(),
        columns: columns.map(String::from).to_vec(),
        rows: chosen.iter().map(row).collect(),
    }
}

/// Exact fluence, path tracer and photon map.
pub fn paths(cells: &Cells, results: &[CaseResult]) -> anyhow::Result<Table> {
    let mut rows = Vec::new();
    for field in FIELDS.into_iter().filter(|f| f.has_clusters()) {
        for &depth in field.depths {
            let paths = cells.moments(&path_case(field, depth), "fluence")?;
            let (exact, bound) = exact_at(results, field, depth);
            let map = results.iter().find(|r| {
                let c = &r.case;
                c.field == field
                    && c.depth == depth
                    && c.size == Size::Nearest(50)
                    && !c.is_biased
                    && c.photons == largest(results, field)
            });
            let map = map.map_or_else(String::new, |r| {
                with_error(exact * (1.0 + r.error.mean()), exact * r.error.std_error())
            });
            rows.push(vec![
                field.name.to_string(),
                depth.to_string(),
                format!("{exact:.9}"),
                format!("{bound:.0e}").replace('-', "−"),
                with_error(paths.mean(), paths.std_error()),
                map,
            ]);
        }
    }
    let columns = ["field", "depth", "exact fluence", "bound", "path tracer", "photon map, k = 50"];
    Ok(Table {
        caption: "Fluence per unit of irradiance on the face: exact, by the path tracer, and by the k nearest photons \
                  of the largest maps. The path tracer has no bias; the photon map's is the subject of this study."
            .to_string(),
        columns: columns.map(String::from).to_vec(),
        rows,
    })
}
