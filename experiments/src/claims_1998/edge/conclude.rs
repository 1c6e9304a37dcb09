//! What all maps say of the edge of a medium and of false photons behind a thin wall.

use super::results::Edges;
use super::{BEHIND, FIXED, NEAREST, SIZES, edge_case, figure, photons, wall_case};
use crate::claims_1998::part::Part;
use crate::harness::{
    Cells, Claim, Estimate, PREDICTED, Parameters, Row, Section, Settings, Table, Unit, number, percent,
    percent_with_error,
};
use crate::prediction::Predictions;
use turbid::estimators::boundary::Rejection;

/// Distance behind the wall that claims and words are about [mfp].
const NEAR: f64 = BEHIND[1];

/// Concludes.
pub fn conclude(settings: &Settings, known: &Predictions, cells: &Cells) -> anyhow::Result<Part> {
    let edges = Edges::read(cells, known)?;
    let section = Section {
        summary: Vec::new(),
        claims: claims(&edges),
        figures: vec![figure::edges(&edges)?],
        tables: vec![wall_table(&edges)],
        notes: vec![
            format!("Maps of the edge and the wall have {} photons.", photons(settings)),
            "Behind the wall one side is wholly dark, the worst case: what the incoming direction cannot tell is light that \
             travels away from the wall on its lit side."
                .to_string(),
        ],
        rows: rows(&edges)?,
        ..Section::default()
    };
    Ok(Part { section, said: said(&edges) })
}

fn claims(edges: &Edges) -> Vec<Claim> {
    let mut claims = Vec::new();
    for (size, id) in [(NEAREST, "edge-nearest"), (FIXED, "edge-radius")] {
        let Some(at) = edges.at_edge(size) else { continue };
        let text = format!(
            "\"the estimate is too low near the edge of a medium\": error on the edge over what the empty part of the ball \
             predicts, {}",
            size.title()
        );
        claims.push(Claim::about(id, &text, Unit::ONE, at.ratio(), 1.0, PREDICTED));
    }
    // At a fixed radius less is found, and less decided.
    for (rejection, id, what) in [
        (Rejection::Off, "leak", "false photons behind a thin wall"),
        (
            Rejection::FacingBehind,
            "incoming",
            "\"looking at the incoming direction avoids false photons\": those left",
        ),
    ] {
        let Some(leak) = edges.leak(NEAREST, rejection, NEAR) else { continue };
        let text = format!("{what}, {}: measured over predicted leak", NEAREST.title());
        claims.push(Claim::about(id, &text, Unit::ONE, leak.ratio(), 1.0, PREDICTED));
    }
    let (off, facing) =
        (edges.leak(FIXED, Rejection::Off, NEAR), edges.leak(FIXED, Rejection::FacingBehind, NEAR));
    if let (Some(off), Some(facing)) = (off, facing) {
        let text = "\"looking at the incoming direction avoids false photons\": leak left, of what leaks without a look, \
                    radius 0.2";
        let left = Estimate::mean(&facing.measured).times(1.0 / off.measured.mean());
        claims.push(Claim::at_most("avoids", text, Unit::FRACTION, left, 0.5));
    }
    claims
}

fn rows(edges: &Edges) -> anyhow::Result<Vec<Row>> {
    let mut rows = Vec::new();
    for (size, depth, at) in &edges.edge {
        let row = Row::measured(&edge_case(*size, *depth), "error", Unit::FRACTION, &at.measured)?;
        rows.push(row.with(Parameters { depth: Some(*depth), ..size.parameters() }));
    }
    for (size, rejection, distance, leak) in &edges.wall {
        let name = wall_case(*size, *rejection, *distance);
        let row = match leak.predicted {
            0.0 => Row::exact(&name, "leak", Unit::FRACTION, leak.measured.mean(), 0.0),
            _ => Row::measured(&name, "leak", Unit::FRACTION, &leak.measured)?,
        };
        rows.push(row.with(size.parameters()));
    }
    Ok(rows)
}

fn wall_table(edges: &Edges) -> Table {
    let mut rows = Vec::new();
    for size in SIZES {
        for rejection in Rejection::ALL {
            let mut row = vec![size.title(), rejection.name().to_string()];
            for distance in BEHIND {
                let cell = edges.leak(size, rejection, distance).map_or(String::new(), |leak| {
                    match leak.predicted {
                        0.0 => number(percent(leak.measured.mean())),
                        predicted => {
                            format!("{} | {:.2}", percent_with_error(&leak.measured), percent(predicted))
                        }
                    }
                });
                row.push(cell);
            }
            rows.push(row);
        }
    }
    let mut columns = vec!["gather".to_string(), "rejection".to_string()];
    columns.extend(BEHIND.map(|h| format!("{h} behind")));
    Table {
        caption: "Light that a gather finds in the dark behind a thin wall, in per cent of the fluence on its lit side, at \
                  distances in mean free paths: measured | predicted. \"Facing\" and \"facing behind\" look at the \
                  incoming direction."
            .to_string(),
        columns,
        rows,
    }
}

fn said(edges: &Edges) -> Vec<[String; 2]> {
    let mut said = Vec::new();
    let mut add = |sentence: &str, found: String| said.push([sentence.to_string(), found]);
    if let Some(at) = edges.at_edge(NEAREST) {
        add("the estimate is too low near the edge of a medium", format!("on the edge by {}", at.words()));
    }
    if let (Some(off), Some(facing)) =
        (edges.leak(FIXED, Rejection::Off, NEAR), edges.leak(FIXED, Rejection::FacingBehind, NEAR))
    {
        add(
            "looking at the incoming direction avoids false photons",
            format!(
                "in part: {NEAR} mean free paths behind a wall {} of the light in front leaks, with the look {}; \
                 looking on which side of the wall they lie avoids all",
                off.words(),
                facing.words()
            ),
        );
    }
    said
}
