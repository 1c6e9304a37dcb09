//! What all cells together say.

use super::cases::{BLURRED, DEPTHS, FACE, INSIDE, NOISY, name, radii, sizes};
use super::figures;
use super::predict::Case;
use super::results::{Point, ladder};
use crate::harness::{
    Cells, Claim, Estimate, PREDICTED, Parameters, Row, Section, Settings, Table, Unit, signed, with_error,
};
use crate::prediction::{Entry, Prediction, Term};
use crate::theory::{Curve, best_by_halves, exponent};
use turbid::estimators::Kernel;
use turbid::stats::Moments;

/// Concludes.
pub fn conclude(settings: &Settings, _: &[Prediction], cells: &Cells) -> anyhow::Result<Section> {
    let sizes: Vec<u64> = sizes(settings).iter().map(|s| s.photons).collect();
    let mut points = Vec::new();
    for &photons in &sizes {
        for depth in DEPTHS {
            for radius in radii() {
                let case = name(photons, depth, radius);
                points.push(Point {
                    photons,
                    depth,
                    radius,
                    theory: Case::new(photons, depth, radius)?,
                    errors: cells.values(&case, "error")?,
                    squares: cells.values(&case, "squared error")?,
                });
            }
        }
    }
    let curves = [best(&points, &sizes, INSIDE), fixed(&points, &sizes), best(&points, &sizes, FACE)];
    let (rows, claims) = (rows(&points, &curves)?, claims(&points, &curves, &sizes));
    Ok(Section {
        summary: summary(&curves),
        claims,
        figures: vec![figures::rates(&points, &curves, &sizes)?],
        tables: vec![table(&curves, &sizes)],
        notes: notes(),
        rows,
        budget: points.iter().map(entry).collect(),
        ..Section::default()
    })
}

fn entry(point: &Point) -> Entry {
    let Case { edge, blur, error, .. } = point.theory;
    Entry::new(
        format!("rates-n{}", point.photons),
        name(point.photons, point.depth, point.radius),
        &[(Term::Edge, edge), (Term::Blur, blur)],
        error,
        point.errors.clone(),
    )
}

/// The best radius of each size.
fn best(points: &[Point], sizes: &[u64], depth: f64) -> Curve {
    let ladders: Vec<Vec<&Point>> = sizes.iter().map(|&photons| ladder(points, photons, depth)).collect();
    let squares: Vec<Vec<&[f64]>> =
        ladders.iter().map(|ladder| ladder.iter().map(|p| p.squares.as_slice()).collect()).collect();
    let (chosen, reported) = best_by_halves(&squares);
    let least =
        |ladder: &Vec<&Point>| ladder.iter().map(|p| p.theory.squared()).fold(f64::INFINITY, f64::min);
    let predicted = ladders.iter().map(least).collect();
    let (name, title, limit) = if depth == INSIDE {
        ("best", "best radius, depth 1".to_string(), (-4.0 / 7.0, "−4/7"))
    } else {
        ("face", "best radius, at the lit face".to_string(), (0.0, "0"))
    };
    let floors = vec![0.0; sizes.len()];
    Curve::new((name, title, limit), sizes, chosen, &reported, predicted, floors)
}

/// One radius for all sizes, at which noise rules; its blur is subtracted.
fn fixed(points: &[Point], sizes: &[u64]) -> Curve {
    let chosen: Vec<&Point> = sizes.iter().map(|&n| ladder(points, n, INSIDE)[NOISY]).collect();
    let title = format!("radius {:.2}, depth 1, less its floor", radii()[NOISY]);
    Curve::new(
        ("fixed", title, (-1.0, "−1")),
        sizes,
        vec![NOISY; sizes.len()],
        &chosen.iter().map(|p| p.squares.clone()).collect::<Vec<_>>(),
        chosen.iter().map(|p| p.theory.squared()).collect(),
        chosen.iter().map(|p| p.theory.bias() * p.theory.bias()).collect(),
    )
}

fn claims(points: &[Point], curves: &[Curve], sizes: &[u64]) -> Vec<Claim> {
    let mut claims = Vec::new();
    for (curve, margin) in curves.iter().zip([0.05, 0.05, 0.02]) {
        let text = format!("{}: exponent of the mean squared error in the number of photons", curve.title);
        let id = format!("exponent-{}", curve.name);
        claims.push(Claim::about(&id, &text, Unit::ONE, curve.exponent, curve.theory, margin));
    }
    if let Some(&most) = sizes.last() {
        let point = ladder(points, most, INSIDE)[BLURRED];
        let floor = point.theory.bias() * point.theory.bias();
        let ratios: Moments = point.squares.iter().map(|s| (s - point.theory.variance) / floor).collect();
        let text = format!(
            "radius {:.2}, depth 1, most photons: mean squared error, less the predicted variance, over the floor that \
             its blur sets",
            point.radius
        );
        claims.push(Claim::about("floor", &text, Unit::ONE, Estimate::mean(&ratios), 1.0, PREDICTED));
    }
    // The mistake to which noise invites: a rate read off at a face would be taken for that of the inside.
    let face = &curves[2];
    let text = "wrong on purpose, the rate at an untreated face taken for that of the inside: exponent";
    claims.push(Claim::detected("face-is-not-inside", text, Unit::ONE, face.exponent, curves[0].theory, 0.3));
    claims
}

fn rows(points: &[Point], curves: &[Curve]) -> anyhow::Result<Vec<Row>> {
    let mut rows = Vec::new();
    for point in points {
        let case = name(point.photons, point.depth, point.radius);
        let error: Moments = point.errors.iter().collect();
        let asked = Parameters {
            photons: Some(point.photons),
            depth: Some(point.depth),
            radius: Some(point.radius),
            kernel: Some(Kernel::Uniform),
            ..Parameters::default()
        };
        rows.push(
            Row::measured(&case, "error", Unit::ONE, &error)?
                .reference(point.theory.bias(), point.theory.error)
                .with(asked),
        );
        rows.push(
            Row::measured(&case, "squared error", Unit::ONE, &point.squared())?
                .reference(point.theory.squared(), 1e-12)
                .with(asked),
        );
    }
    for curve in curves {
        rows.push(
            Row::estimated(curve.name, "exponent", Unit::ONE, &curve.exponent)?.predicted(curve.theory),
        );
    }
    Ok(rows)
}

fn table(curves: &[Curve], sizes: &[u64]) -> Table {
    let radii = radii();
    let mut rows = Vec::new();
    for curve in curves {
        for (i, &photons) in sizes.iter().enumerate() {
            // Between this size and the next, what theory says.
            let local = sizes.get(i + 1).map(|&next| {
                let above = |i: usize| curve.predicted[i] - curve.floors[i];
                exponent(&[photons as f64, next as f64], &[above(i), above(i + 1)])
            });
            rows.push(vec![
                curve.title.clone(),
                photons.to_string(),
                format!("{:.3}", radii[curve.chosen[i]]),
                with_error(curve.measured[i].mean(), curve.measured[i].std_error()),
                crate::harness::number(curve.predicted[i]),
                local.map(|x| signed(x, 3)).unwrap_or_default(),
            ]);
        }
    }
    let columns =
        ["rule", "photons", "radius", "mean squared error", "predicted", "exponent to the next, predicted"];
    Table {
        caption: "Mean squared error, relative to the square of the exact fluence, with its standard error over cells, \
                  beside the prediction, at the radius used (in mean free paths), and the predicted exponent between \
                  neighbouring sizes; where a floor is spoken of, it is subtracted in the exponent only."
            .to_string(),
        columns: columns.map(String::from).to_vec(),
        rows,
    }
}

fn summary(curves: &[Curve]) -> Vec<String> {
    let words = |c: &Curve| {
        format!(
            "{} (theory at these numbers {}, in the limit {})",
            with_error(c.exponent.value(), c.exponent.std_error()),
            signed(c.theory, 3),
            c.limit.1
        )
    };
    vec![
        format!(
            "At the best radius the mean squared error falls with the number of photons by the exponent {}.",
            words(&curves[0])
        ),
        format!(
            "At a fixed radius it falls by {} down to the floor of its blur, and no further. At a lit face that nothing \
             is done about, by {}: half of the light stays missing, and more photons buy next to nothing.",
            words(&curves[1]),
            words(&curves[2])
        ),
    ]
}

fn notes() -> Vec<String> {
    vec![
        "Uncollided photons in e^-t, uniform kernel, fixed radii. Small maps are measured in batches, so that a cell of any \
         size costs alike; a cell gives the mean over its maps and probes."
            .to_string(),
        "The best radius is chosen on one half of the cells and its error reported by the other half. The prediction beside \
         it is the smallest of the ladder; a neighbouring radius chosen by noise costs at most a few per cent, alike at \
         every size."
            .to_string(),
        "Exponents are those of a straight line through the logarithms of all sizes, refitted without each cell in turn. \
         At the face a smaller radius trades the light lost beyond it against noise, so that the exponent is not \
         quite 0 at any finite number."
            .to_string(),
    ]
}
