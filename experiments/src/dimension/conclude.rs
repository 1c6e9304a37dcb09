//! What all cells together say.

use super::cases::{BEAMS, POINTS, SHOOTING, name, questions, radii, reading, sizes};
use super::figures;
use super::media;
use super::results::{Answer, PICTURE, Point, ladder};
use crate::harness::{
    Cells, Claim, Estimate, Parameters, Row, Section, Settings, Table, Unit, number, signed, with_error,
};
use crate::prediction::{Entry, Prediction, Term};
use crate::setups::uncollided::{Case, Query};
use crate::theory::{Curve, best_by_halves, exponent};
use turbid::estimators::Kernel;
use turbid::stats::{Moments, jackknife};

/// Concludes.
pub fn conclude(settings: &Settings, _: &[Prediction], cells: &Cells) -> anyhow::Result<Section> {
    let all = sizes(settings);
    let sizes: Vec<u64> = all.iter().map(|s| s.photons).collect();
    let (mut points, mut filling) = (Vec::new(), Vec::new());
    for size in &all {
        let seconds = |phase: &str, times: usize| -> Moments {
            let each = cells.seconds(&size.group(), phase);
            each.iter().map(|seconds| seconds / (size.batch as f64 * times as f64)).collect()
        };
        filling.push([SHOOTING, POINTS, BEAMS].map(|phase| seconds(phase, 1).mean()));
        for query in Query::ALL {
            for radius in radii() {
                let case = name(query, size.photons, radius);
                points.push(Point {
                    query,
                    photons: size.photons,
                    radius,
                    theory: Case::new(query, size.photons, radius)?,
                    errors: cells.values(&case, "error")?,
                    squares: cells.values(&case, "squared error")?,
                    seconds: seconds(&reading(query, radius), questions(query)),
                });
            }
        }
    }
    let answers: Vec<Answer> =
        Query::ALL.into_iter().map(|query| best(&points, (&sizes, &filling), query)).collect();
    let mut media = media::conclude(settings, cells)?;
    let mut section = Section {
        summary: summary(&answers, &sizes),
        claims: claims(&points, &answers, &sizes),
        figures: vec![figures::dimension(&points, &answers, &sizes)?],
        tables: vec![table(&answers, &sizes)],
        notes: notes(),
        rows: rows(&points, &answers)?,
        budget: points.iter().map(entry).collect(),
        ..Section::default()
    };
    section.summary.append(&mut media.summary);
    section.figures.append(&mut media.figures);
    section.tables.append(&mut media.tables);
    section.notes.append(&mut media.notes);
    section.rows.append(&mut media.rows);
    Ok(section)
}

fn entry(point: &Point) -> Entry {
    let Case { blur, error, .. } = point.theory;
    Entry::new(
        format!("dimension-n{}", point.photons),
        name(point.query, point.photons, point.radius),
        &[(Term::Blur, blur)],
        error,
        point.errors.clone(),
    )
}

/// The best radius of each size.
fn best(points: &[Point], (sizes, filling): (&[u64], &[[f64; 3]]), query: Query) -> Answer {
    let ladders: Vec<Vec<&Point>> = sizes.iter().map(|&photons| ladder(points, query, photons)).collect();
    let squares: Vec<Vec<&[f64]>> =
        ladders.iter().map(|ladder| ladder.iter().map(|p| p.squares.as_slice()).collect()).collect();
    let (chosen, reported) = best_by_halves(&squares);
    let least =
        |ladder: &Vec<&Point>| ladder.iter().map(|p| p.theory.squared()).fold(f64::INFINITY, f64::min);
    let seconds = ladders.iter().zip(&chosen).map(|(ladder, &place)| ladder[place].seconds).collect();
    let words = match query.codimension() {
        3.0 => "−4/7",
        2.0 => "−2/3",
        _ => "−4/5",
    };
    let words = (query.name(), query.title().to_string(), (-4.0 / (query.codimension() + 4.0), words));
    let predicted = ladders.iter().map(least).collect();
    let tree =
        |[shooting, points, beams]: &[f64; 3]| shooting + if query.is_of_beams() { beams } else { points };
    Answer {
        query,
        curve: Curve::new(words, sizes, chosen, &reported, predicted, vec![0.0; sizes.len()]),
        seconds,
        filling: filling.iter().map(tree).collect(),
    }
}

fn claims(points: &[Point], answers: &[Answer], sizes: &[u64]) -> Vec<Claim> {
    let mut claims = Vec::new();
    for Answer { query, curve, .. } in answers {
        let text = format!("{}: exponent of the mean squared error in the number of photons", curve.title);
        let id = format!("exponent-{}", curve.name);
        claims.push(Claim::about(&id, &text, Unit::ONE, curve.exponent, curve.theory, 0.15));
        let over = over_theory(points, *query, *query, sizes);
        let text = format!(
            "{}, the radius that is best in theory: mean squared error over the predicted one, mean of all sizes",
            curve.title
        );
        claims.push(Claim::about(&format!("error-{}", query.name()), &text, Unit::ONE, over, 1.0, 0.15));
    }
    // The dimension of the kernel taken for that of who asks.
    let text = "wrong on purpose, a ray that is marched in balls taken to be as noisy as a ball: mean squared error over \
                that, mean of all sizes";
    let over = over_theory(points, Query::Marched, Query::Places, sizes);
    claims.push(Claim::detected("balls-along-rays-are-rays", text, Unit::ONE, over, 1.0, 0.2));
    claims.extend(sentences(points, sizes));
    claims
}

/// What papers say of points and beams along a ray, where no clock is needed: at the radii that are best in theory, from all cells.
fn sentences(points: &[Point], sizes: &[u64]) -> Vec<Claim> {
    let ladders = [Query::Rays, Query::Beams].map(|query| -> Vec<Vec<&Point>> {
        sizes.iter().map(|&photons| ladder(points, query, photons)).collect()
    });
    let x: Vec<f64> = sizes.iter().map(|&n| n as f64).collect();
    let best: Vec<Vec<&[f64]>> = ladders
        .iter()
        .map(|of_query| {
            of_query.iter().map(|ladder| ladder[best_in_theory(ladder)].squares.as_slice()).collect()
        })
        .collect();
    // Sizes have different maps; joining them by number is a free choice.
    let count = points.iter().map(|point| point.squares.len()).min().unwrap_or(0);
    let cells: Vec<usize> = (0..count).collect();
    let slope = |cells: &[usize], squares: &[&[f64]]| {
        let sum = |of_size: &&[f64]| cells.iter().map(|&cell| of_size[cell]).sum::<f64>();
        exponent(&x, &squares.iter().map(sum).collect::<Vec<f64>>())
    };
    let difference = |cells: &[usize]| slope(cells, &best[1]) - slope(cells, &best[0]);
    let found = Estimate::jackknife(&jackknife(&cells, difference));
    let text = "\"beams converge faster than points\": exponent of the mean squared error of beams along a ray less that of points along it";
    let faster = Claim::at_most("beams-converge-faster", text, Unit::ONE, found, 0.0);
    // The mean of the logarithms of radius times variance over variance, which is the same at all radii as long as they are small.
    let pairs = || ladders[0].iter().flatten().zip(ladders[1].iter().flatten());
    let radius = |variances: &[(f64, f64)]| {
        let logs =
            pairs().zip(variances).map(|((ray, _), (over, under))| libm::log(ray.radius * over / under));
        libm::exp(logs.sum::<f64>() / variances.len() as f64)
    };
    let predicted: Vec<(f64, f64)> =
        pairs().map(|(ray, beam)| (ray.theory.variance, beam.theory.variance)).collect();
    let deviations: Vec<[Vec<f64>; 2]> =
        pairs().map(|(ray, beam)| [ray.deviations(), beam.deviations()]).collect();
    let of_cells = |cells: &[usize]| {
        let sum = |values: &[f64]| cells.iter().map(|&cell| values[cell]).sum::<f64>();
        radius(&deviations.iter().map(|[ray, beam]| (sum(ray), sum(beam))).collect::<Vec<_>>())
    };
    let found = Estimate::jackknife(&jackknife(&cells, of_cells));
    let text = "\"points beat beams at large radii\": the radius at which both have the same variance along a ray, light falling across it: 2/π mean \
                free paths where radii are small (4/π² = 0.405 under light from all sides)";
    // Seven standard errors of the quick preset, a fifth of the radius.
    let from = Claim::about("points-beat-beams-from", text, Unit::MFP, found, radius(&predicted), 0.13);
    vec![faster, from]
}

/// The place of the radius that theory finds best.
fn best_in_theory(ladder: &[&Point]) -> usize {
    let squared = |&place: &usize| ladder[place].theory.squared();
    (0..ladder.len()).min_by(|a, b| squared(a).total_cmp(&squared(b))).unwrap_or(0)
}

/// Mean squared error of one kind of question over what theory says of a kind, at the radius that theory finds best for it: the mean
/// over all sizes. Sizes have different maps; joining them by number is a free choice.
fn over_theory(points: &[Point], query: Query, of: Query, sizes: &[u64]) -> Estimate {
    let mut ratios: Vec<Vec<f64>> = Vec::new();
    for &photons in sizes {
        let (asked, theory) = (ladder(points, query, photons), ladder(points, of, photons));
        let best = best_in_theory(&theory);
        let predicted = theory[best].theory.squared();
        ratios.push(asked[best].squares.iter().map(|square| square / predicted).collect());
    }
    let cells = ratios.iter().map(Vec::len).min().unwrap_or(0);
    let joined = |c: usize| ratios.iter().map(|of_size| of_size[c]).sum::<f64>() / ratios.len() as f64;
    Estimate::mean(&(0..cells).map(joined).collect::<Moments>())
}

fn rows(points: &[Point], answers: &[Answer]) -> anyhow::Result<Vec<Row>> {
    let mut rows = Vec::new();
    for point in points {
        let case = name(point.query, point.photons, point.radius);
        let error: Moments = point.errors.iter().collect();
        let asked = Parameters {
            photons: Some(point.photons),
            radius: Some(point.radius),
            kernel: Some(Kernel::Uniform),
            ..Parameters::default()
        };
        let Case { blur, error: bound, .. } = point.theory;
        rows.push(Row::measured(&case, "error", Unit::ONE, &error)?.reference(blur, bound).with(asked));
        let squared = Row::measured(&case, "squared error", Unit::ONE, &point.squared())?;
        rows.push(squared.reference(point.theory.squared(), 1e-12).with(asked));
    }
    for Answer { curve, .. } in answers {
        rows.push(
            Row::estimated(curve.name, "exponent", Unit::ONE, &curve.exponent)?.predicted(curve.theory),
        );
    }
    Ok(rows)
}

fn table(answers: &[Answer], sizes: &[u64]) -> Table {
    let radii = radii();
    let mut rows = Vec::new();
    for Answer { curve, seconds, .. } in answers {
        for (i, &photons) in sizes.iter().enumerate() {
            rows.push(vec![
                curve.title.clone(),
                photons.to_string(),
                format!("{:.3}", radii[curve.chosen[i]]),
                with_error(curve.measured[i].mean(), curve.measured[i].std_error()),
                number(curve.predicted[i]),
                with_error(1e6 * seconds[i].mean(), 1e6 * seconds[i].std_error()),
            ]);
        }
    }
    let columns =
        ["what is asked by whom", "photons", "radius", "mean squared error", "predicted", "CPU microseconds"];
    Table {
        caption: "Mean squared error, relative to the square of the exact value, with its standard error over cells, beside the \
                  least one predicted, at the radius used (in mean free paths), and the CPU time of one question on this machine, \
                  without the map's."
            .to_string(),
        columns: columns.map(String::from).to_vec(),
        rows,
    }
}

fn summary(answers: &[Answer], sizes: &[u64]) -> Vec<String> {
    let words = |a: &Answer| {
        let c = &a.curve;
        let exponent = with_error(c.exponent.value(), c.exponent.std_error());
        format!("{exponent} for {} (theory {}, in the limit {})", c.title, signed(c.theory, 3), c.limit.1)
    };
    let all: Vec<String> = answers.iter().map(words).collect();
    let mut paragraphs = vec![format!(
        "At the best radius the mean squared error falls with the number of photons by the exponents {}.",
        all.join("; ")
    )];
    let last = sizes.len() - 1;
    let rays: Vec<&Answer> = answers.iter().filter(|a| a.query.is_ray()).collect();
    let told = |a: &&Answer| {
        let (error, seconds) = (a.curve.measured[last].mean(), a.picture()[last]);
        format!("{}: {} % in {} s", a.curve.title, number(100.0 * error.sqrt()), number(seconds))
    };
    let told: Vec<String> = rays.iter().map(told).collect();
    paragraphs.push(format!(
        "Root mean square error of a ray with {} photons, and the CPU time of the map and {} rays: {}.",
        sizes[last],
        number(PICTURE),
        told.join("; ")
    ));
    paragraphs
}

fn notes() -> Vec<String> {
    vec![
        "Uncollided photons of a beam under a cosine of 0.6, in a slab: the fluence falls as e^(-t/0.6). Asked is the fluence at places \
         of depth 1, and its integral along rays of that depth, across the beam and once round the periodic cell: nothing is lost at \
         ends, and nothing is attenuated along the ray, so that a ray is the same all along. Uniform kernels, fixed radii; nothing \
         is treated, since no radius reaches a face."
            .to_string(),
        "A ray that is marched in balls, with steps of half the least radius or less, counts a photon by the chord of their centres: it \
         blurs in three dimensions, and its variance is that of a kernel on the disc, 9/8 that of points along the ray of the same \
         radius. Its best error is 0.97 of theirs, so that rays can win by time alone."
            .to_string(),
        "The best radius is chosen on one half of the cells and its error reported by the other half. Small maps are measured in \
         batches, so that a cell of any size costs alike."
            .to_string(),
    ]
}
