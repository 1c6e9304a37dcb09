//! The fields as answers to the study's question: maps against paths at equal error.

use super::cases::{
    FIELDS, Field, MODERATE, MODERATE_FORWARD, PROBES, SPHERE, THICK_FORWARD, THIN, Treatment,
};
use super::choose::{Choice, best, cheapest, frontier};
use super::data::{Data, Measured, Paths, Work, mean};
use super::split::{positive, rms_bias};
use crate::harness::{Answer, Curves, Estimate, Point, Reached, TARGETS, Untreated};

/// Fields that are drawn.
const DRAWN: [&Field; 5] = [&THIN, &MODERATE, &MODERATE_FORWARD, &THICK_FORWARD, &SPHERE];
/// Queries of one map.
const QUERIES: f64 = PROBES as f64;

/// One answer a field.
pub fn all(data: &Data) -> Vec<Answer> {
    FIELDS.into_iter().filter_map(|field| Some(answer(data, field, data.paths(field)?))).collect()
}

fn answer(data: &Data, field: &Field, paths: &Paths) -> Answer {
    let clipped = data.of(field, Treatment::Clipped, None);
    let plain = data.of(field, Treatment::Plain, None);
    let reached = |target| {
        let fastest = cheapest(&clipped, target, |m| m.seconds(QUERIES))?.case;
        let seconds = Race {
            target,
            prepare: &fastest.prepare_seconds,
            query: &fastest.query_seconds,
            sample: &paths.seconds,
            paths,
        };
        let work = |m: &Measured| data.work(m);
        let least = cheapest(&clipped, target, |m| work(m).of(QUERIES))?.case;
        let Work { prepare, query } = work(least);
        let rays = Race { target, prepare: &prepare, query: &query, sample: &paths.rays, paths };
        Some(Reached {
            time: seconds.speed(),
            pays_from: seconds.pays_from(),
            work: rays.speed(),
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

/// A map against the path tracer at one error: what each map costs before its first query and a query, and what a path costs.
struct Race<'a> {
    target: f64,
    prepare: &'a [f64],
    query: &'a [f64],
    sample: &'a [f64],
    paths: &'a Paths,
}

/// Mean costs: of a query by paths, of one from the map, and before the first.
struct Costs {
    by_paths: f64,
    query: f64,
    prepare: f64,
}

impl Race<'_> {
    /// A statistic of the costs. Joining maps and batches of paths by number is a free choice: they share nothing.
    fn estimate(&self, statistic: impl Fn(Costs) -> f64) -> Estimate {
        let maps = self.prepare.iter().zip(self.query);
        let batches = self.paths.variance.iter().zip(self.sample);
        let joined: Vec<[f64; 4]> =
            maps.zip(batches).map(|((&p, &q), (&variance, &sample))| [p, q, variance, sample]).collect();
        let square = self.target * self.target;
        positive(&joined, |joined| {
            let mean = |i: usize| joined.iter().map(|one| one[i]).sum::<f64>() / joined.len() as f64;
            statistic(Costs {
                by_paths: mean(3) * (mean(2) / square).max(1.0),
                query: mean(1),
                prepare: mean(0),
            })
        })
    }

    /// Cost of the path tracer over that of the map, for all queries.
    fn speed(&self) -> Estimate {
        self.estimate(|c| c.by_paths / (c.prepare / QUERIES + c.query))
    }

    /// The number of queries has a pole where a query saves nothing: it is told only well away from there.
    fn pays_from(&self) -> Option<Estimate> {
        let saved = self.estimate(|c| c.by_paths / c.query);
        (saved.value() - 1.0 > 5.0 * saved.std_error())
            .then(|| self.estimate(|c| c.prepare / (c.by_paths - c.query)))
    }
}

fn points(cases: &[&Measured]) -> Vec<Point> {
    let point = |choice: &Choice| {
        let interval = choice.rms.interval(0.95);
        Point {
            seconds: choice.case.seconds(QUERIES),
            error: choice.rms.value(),
            interval: (interval.low.max(0.0), interval.high),
        }
    };
    frontier(cases, |m| m.seconds(QUERIES)).iter().map(point).collect()
}

/// From one sample a query down to an error of 1 per cent.
fn path_curve(paths: &Paths) -> Vec<(f64, f64)> {
    let (one, seconds) = (mean(&paths.variance).sqrt(), mean(&paths.seconds));
    let errors = (0..=40).map(|i| one * libm::exp(-0.15 * f64::from(i))).take_while(|error| *error > 0.009);
    errors.map(|error| (QUERIES * seconds * one * one / (error * error), error)).collect()
}
