//! What all cells together say.

use super::cases::{QUERIES, Schedule, best, name, photons, radii, schedules, stops};
use super::figures;
use super::predict::Expected;
use super::results::{Answer, Point, sequence};
use crate::harness::{
    Cells, Claim, Estimate, Parameters, Row, Section, Settings, Table, Unit, number, signed, with_error,
};
use crate::prediction::{Entry, Prediction, Term};
use crate::setups::uncollided::Query;
use crate::theory::{exponent, exponent_of_means};
use turbid::estimators::Kernel;
use turbid::stats::{Moments, jackknife};

/// Maps from which on exponents are fitted.
const FROM: u64 = 4;

/// Concludes.
pub fn conclude(settings: &Settings, _: &[Prediction], cells: &Cells) -> anyhow::Result<Section> {
    let photons = photons(settings);
    let mut points = Vec::new();
    for query in QUERIES {
        let (first, oracle) = best(settings, query)?;
        for schedule in schedules(query) {
            for maps in stops(settings) {
                let case = name(query, schedule, maps);
                let radii = radii(query, schedule, maps, first, oracle);
                let coverage = if maps >= 2 { cells.values(&case, "coverage")? } else { Vec::new() };
                points.push(Point {
                    query,
                    schedule,
                    maps,
                    radius: radii[radii.len() - 1],
                    theory: Expected::after(query, photons, &radii)?,
                    errors: cells.values(&case, "error")?,
                    squares: cells.values(&case, "squared error")?,
                    coverage,
                });
            }
        }
    }
    let answers: Vec<Answer> = QUERIES.into_iter().map(|query| answer(&points, query)).collect();
    Ok(Section {
        summary: summary(&answers, settings),
        claims: claims(&answers),
        figures: vec![figures::progressive(&points)?],
        tables: vec![table(&points)],
        notes: notes(),
        rows: rows(&points, &answers, photons)?,
        budget: points.iter().map(|point| entry(point, photons)).collect(),
        ..Section::default()
    })
}

fn entry(point: &Point, photons: u64) -> Entry {
    let Expected { blur, error, .. } = point.theory;
    let name = name(point.query, point.schedule, point.maps);
    Entry::new(format!("progressive-n{photons}"), name, &[(Term::Blur, blur)], error, point.errors.clone())
}

fn answer(points: &[Point], query: Query) -> Answer {
    let own = sequence(points, query, Schedule::Own);
    let last = own[own.len() - 1];
    let fitted: Vec<&&Point> = own.iter().filter(|p| p.maps >= FROM).collect();
    let x: Vec<f64> = fitted.iter().map(|p| p.maps as f64).collect();
    let cells = fitted.iter().map(|p| p.squares.len()).min().unwrap_or(0);
    let joined: Vec<Vec<f64>> = (0..cells).map(|c| fitted.iter().map(|p| p.squares[c]).collect()).collect();
    let theory: Vec<f64> = fitted.iter().map(|p| p.theory.squared()).collect();
    let over = schedules(query).filter(|s| *s != Schedule::Own).filter_map(|schedule| {
        let other = *sequence(points, query, schedule).last()?;
        let pairs: Vec<[f64; 2]> =
            last.squares.iter().copied().zip(other.squares.iter().copied()).map(<[f64; 2]>::from).collect();
        let ratio = |pairs: &[[f64; 2]]| {
            let [mine, others] = [0, 1].map(|i| pairs.iter().map(|pair| pair[i]).sum::<f64>());
            mine / others
        };
        let predicted = last.theory.squared() / other.theory.squared();
        Some((schedule, Estimate::jackknife(&jackknife(&pairs, ratio)), predicted))
    });
    Answer {
        query,
        exponent: exponent_of_means(&x, &joined, &vec![0.0; x.len()]),
        theory: exponent(&x, &theory),
        over: over.collect(),
        coverage: (last.held(), last.theory.coverage()),
    }
}

fn claims(answers: &[Answer]) -> Vec<Claim> {
    let mut claims = Vec::new();
    for Answer { query, exponent, theory, over, coverage } in answers {
        let (title, short) = (query.title(), query.name());
        let text = format!("{title}: exponent of the mean squared error in the number of maps");
        claims.push(Claim::about(&format!("exponent-{short}"), &text, Unit::ONE, *exponent, *theory, 0.15));
        for (schedule, ratio, predicted) in over {
            let id = format!("{}-{short}", schedule.name());
            match schedule {
                Schedule::Oracle => {
                    let text = format!(
                        "{title}: mean squared error after all maps over that of the best fixed radius for all photons"
                    );
                    claims.push(Claim::about(&id, &text, Unit::ONE, *ratio, *predicted, 0.15));
                }
                Schedule::Constant => {
                    let text = format!(
                        "wrong on purpose, {title}, radii that stay as the first: mean squared error after all maps of those that \
                         shrink over that"
                    );
                    claims.push(Claim::detected(&id, &text, Unit::ONE, *ratio, 1.0, 0.3));
                }
                Schedule::Balls if *query == Query::Beams => {
                    let text = format!(
                        "wrong on purpose, {title}, radii that shrink as those of balls: mean squared error after all maps of those \
                         that shrink by their own power over that"
                    );
                    claims.push(Claim::detected(&id, &text, Unit::ONE, *ratio, 1.0, 0.1));
                }
                // A tenth of the error, which a study of this size would not decide.
                Schedule::Balls | Schedule::Own => {}
            }
        }
        let text = format!(
            "{title}: part of the intervals of 95 % from the spread between maps that hold the exact value, blur and all"
        );
        claims.push(Claim::about(
            &format!("coverage-{short}"),
            &text,
            Unit::ONE,
            coverage.0,
            coverage.1,
            0.1,
        ));
    }
    claims
}

fn rows(points: &[Point], answers: &[Answer], photons: u64) -> anyhow::Result<Vec<Row>> {
    let mut rows = Vec::new();
    for point in points {
        let case = name(point.query, point.schedule, point.maps);
        let asked = Parameters {
            photons: Some(photons * point.maps),
            radius: Some(point.radius),
            kernel: Some(Kernel::Uniform),
            ..Parameters::default()
        };
        let Expected { blur, error, .. } = point.theory;
        let errors: Moments = point.errors.iter().collect();
        rows.push(Row::measured(&case, "error", Unit::ONE, &errors)?.reference(blur, error).with(asked));
        let squared = Row::measured(&case, "squared error", Unit::ONE, &point.squared())?;
        rows.push(squared.reference(point.theory.squared(), 1e-12).with(asked));
        if !point.coverage.is_empty() {
            let row = Row::estimated(&case, "coverage", Unit::ONE, &point.held())?;
            rows.push(row.predicted(point.theory.coverage()).with(asked));
        }
    }
    for Answer { query, exponent, theory, .. } in answers {
        rows.push(Row::estimated(query.name(), "exponent", Unit::ONE, exponent)?.predicted(*theory));
    }
    Ok(rows)
}

fn table(points: &[Point]) -> Table {
    let mut rows = Vec::new();
    for query in QUERIES {
        for schedule in schedules(query) {
            let Some(last) = sequence(points, query, schedule).last().copied() else { continue };
            let (squared, held) = (last.squared(), last.held());
            rows.push(vec![
                query.title().to_string(),
                schedule.title().to_string(),
                format!("{:.3}", last.radius),
                with_error(squared.mean(), squared.std_error()),
                number(last.theory.squared()),
                number(last.theory.blur / last.theory.variance.sqrt()),
                with_error(held.value(), held.std_error()),
                format!("{:.3}", last.theory.coverage()),
            ]);
        }
    }
    let columns = [
        "what is asked by whom",
        "the radius",
        "in the last map",
        "mean squared error",
        "predicted",
        "blur over noise",
        "intervals that hold",
        "predicted",
    ];
    Table {
        caption: "After all maps: the radius of the last one (in mean free paths), mean squared error, relative to the square of the exact \
                  value, with its standard error over sequences; the blur that is left, in standard deviations of the mean; the part of the \
                  95 % intervals between maps that hold the exact value."
            .to_string(),
        columns: columns.map(String::from).to_vec(),
        rows,
    }
}

fn summary(answers: &[Answer], settings: &Settings) -> Vec<String> {
    let words = |a: &Answer| {
        let found = with_error(a.exponent.value(), a.exponent.std_error());
        let limit = -4.0 / (a.query.codimension() + 4.0);
        format!(
            "{found} for {} (theory {}, in the limit {})",
            a.query.title(),
            signed(a.theory, 3),
            signed(limit, 3)
        )
    };
    let price = |a: &Answer| {
        let (_, ratio, predicted) = a.over.iter().find(|(schedule, ..)| *schedule == Schedule::Oracle)?;
        let found = with_error(ratio.value(), ratio.std_error());
        Some(format!("{found} for {} (predicted {})", a.query.title(), number(*predicted)))
    };
    let held = |a: &Answer| {
        let (found, predicted) = (100.0 * a.coverage.0.value(), 100.0 * a.coverage.1);
        format!("{} % for {} (predicted {})", number(found), a.query.title(), number(predicted))
    };
    let list = |texts: Vec<String>| texts.join("; ");
    vec![
        format!(
            "The mean squared error falls with the number of maps by the exponents {}.",
            list(answers.iter().map(words).collect())
        ),
        format!(
            "After {} maps it is, over that of the best fixed radius for the same photons, {}.",
            super::cases::maps(settings),
            list(answers.iter().filter_map(price).collect())
        ),
        format!(
            "The spread between maps does not know the blur that is left: its 95 % intervals hold the exact value in {}.",
            list(answers.iter().map(held).collect())
        ),
    ]
}

fn notes() -> Vec<String> {
    vec![
        "The setup is that of the experiment before: uncollided photons of a beam aslant in a slab, places and rays of depth 1, uniform \
         kernels. Each sequence has maps of its own, all schedules read the same ones. The first radius, and the fixed one, are those that \
         theory finds best for the last map."
            .to_string(),
        "A mean over maps has the mean of their blurs, and their mean variance over their number. At the best radius blur and noise fall at one \
         pace, so that the blur stays a fixed part of the standard error however long one waits: an interval between maps is an \
         interval for the blurred light. Half the first radius quarters the blur."
            .to_string(),
    ]
}
