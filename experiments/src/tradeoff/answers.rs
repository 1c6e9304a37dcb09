//! The fields as answers to the study's question: maps against paths at equal error.

use super::cases::{
    FIELDS, Field, MODERATE, MODERATE_FORWARD, PROBES, SPHERE, THICK_FORWARD, THIN, Treatment,
};
use super::choose::{Choice, Currency, best, break_even_at, cheapest, frontier};
use super::data::{Data, Measured, Paths, mean};
use super::split::rms_bias;
use crate::harness::{Answer, Curves, Point, QUERIES, Reached, TARGETS, Untreated};

/// Fields that are drawn.
const DRAWN: [&Field; 5] = [&THIN, &MODERATE, &MODERATE_FORWARD, &THICK_FORWARD, &SPHERE];
/// What answers are for is what is measured.
const _: () = assert!(QUERIES == PROBES as u64);

/// One answer a field.
pub fn all(data: &Data) -> Vec<Answer> {
    FIELDS.into_iter().filter_map(|field| Some(answer(data, field, data.paths(field)?))).collect()
}

fn answer(data: &Data, field: &Field, paths: &Paths) -> Answer {
    let clipped = data.of(field, Treatment::Clipped, None);
    let plain = data.of(field, Treatment::Plain, None);
    let reached = |target| {
        let fastest = cheapest(&clipped, target, |m| m.seconds(QUERIES as f64))?.case;
        let least = cheapest(&clipped, target, |m| m.rays(QUERIES as f64))?.case;
        let in_time = break_even_at(fastest, paths, Currency::Seconds, Some(target));
        Some(Reached {
            time: in_time.share.inverse(),
            pays_from: in_time.queries,
            work: break_even_at(least, paths, Currency::Rays, Some(target)).share.inverse(),
            bias: rms_bias(&fastest.maps),
            limit: fastest.limit(),
        })
    };
    let untreated = best(&plain).map(|choice| Untreated { error: choice.rms, limit: choice.case.limit() });
    let kind = match field.name {
        name if name == SPHERE.name => "",
        _ => "slab ",
    };
    Answer {
        scene: format!("{kind}{}", field.title),
        reached: TARGETS.map(reached),
        untreated,
        curves: DRAWN.contains(&field).then(|| Curves {
            maps: points(&clipped),
            untreated: points(&plain),
            paths: path_curve(paths),
        }),
    }
}

fn points(cases: &[&Measured]) -> Vec<Point> {
    let point = |choice: &Choice| {
        let interval = choice.rms.interval(0.95);
        Point {
            seconds: choice.case.seconds(QUERIES as f64),
            error: choice.rms.value(),
            interval: (interval.low.max(0.0), interval.high),
        }
    };
    frontier(cases, |m| m.seconds(QUERIES as f64)).iter().map(point).collect()
}

/// From one sample a query down to an error of 1 per cent.
fn path_curve(paths: &Paths) -> Vec<(f64, f64)> {
    let (one, seconds) = (mean(&paths.variance).sqrt(), mean(&paths.seconds));
    let errors = (0..=40).map(|i| one * libm::exp(-0.15 * f64::from(i))).take_while(|error| *error > 0.009);
    errors.map(|error| (QUERIES as f64 * seconds * one * one / (error * error), error)).collect()
}
