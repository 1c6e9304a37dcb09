//! What all cells together say.

use super::cases::{
    Estimator, FIRST, MEAN_LEVELS, ONE, QUERIES, STOPS, beyond, constant, difference, photons, radius,
    thresholds, work,
};
use super::figures;
use super::predict::{best, least, limit};
use super::results::{Answer, Level, Tail, find, ratio};
use crate::harness::{
    Cells, Claim, Estimate, Parameters, Row, Section, Settings, Table, Unit, number, percent_with_error,
    signed, with_error,
};
use crate::prediction::{Entry, Prediction, Term};
use crate::setups::levels::Schedule;
use crate::setups::uncollided::Query;
use turbid::estimators::Kernel;

/// How far a ratio of two variances may lie from the predicted one, relative: the largest that still tells the prices of c = 3, 2 and 1
/// apart, which are 2.1, 3.0 and 5.8, from each other by a factor of 1.4 or more.
const PRICE: f64 = 0.15;
/// How far a mean magnitude may lie from the predicted one, relative.
const MAGNITUDE: f64 = 0.1;

/// Concludes.
pub fn conclude(settings: &Settings, _: &[Prediction], cells: &Cells) -> anyhow::Result<Section> {
    let (mut answers, mut levels, mut tails) = (Vec::new(), Vec::new(), Vec::new());
    for query in QUERIES {
        for estimator in Estimator::of_photons() {
            answers.push(Answer::new(settings, cells, query, estimator)?);
        }
        for estimator in [Estimator::Drawn, Estimator::Equal] {
            answers.push(Answer::new(settings, cells, query, estimator)?);
            tails.push(Tail::new(cells, query, estimator)?);
        }
        let (number, photons) = constant(query);
        for level in 0..number {
            levels.push(Level::new(cells, query, level, photons)?);
        }
    }
    Ok(Section {
        summary: summary(&answers, &levels, &tails),
        claims: claims(&answers, &levels, &tails),
        figures: vec![figures::stopped(&answers, settings)?, figures::drawn(&levels, &tails, settings)?],
        tables: vec![prices(&answers), far(&answers, &tails, cells, settings)?],
        notes: notes(settings)?,
        rows: rows(settings, &answers, &levels, &tails)?,
        budget: answers.iter().filter(|a| a.estimator != Estimator::Drawn).map(entry).collect(),
        left_out: QUERIES.len(),
        ..Section::default()
    })
}

fn entry(answer: &Answer) -> Entry {
    // Estimates of one pass and sums beside it are of the same cells.
    let part = if answer.estimator == Estimator::Equal { "equal" } else { "stopped" };
    Entry::new(
        format!("debiasing-{part}-{}", answer.query.name()),
        answer.estimator.name(answer.query),
        &[(Term::Blur, answer.expected.blur)],
        1e-12,
        answer.errors.clone(),
    )
}

/// What a sum of so many levels has as variance, over that of the plain estimate at its last radius: measured, and predicted.
fn price(answers: &[Answer], query: Query, levels: u32) -> Option<(Estimate, f64)> {
    let sum = find(answers, query, Estimator::Stopped(levels))?;
    let plain = find(answers, query, Estimator::Plain(levels))?;
    Some((ratio(&sum.deviations(), &plain.deviations()), sum.variance() / plain.variance()))
}

/// Mean squared error of the sum at the number of levels that theory finds best for it, over that of the plain estimate at its best
/// radius: the levels, measured, and predicted.
fn against_best(answers: &[Answer], query: Query) -> Option<(u32, Estimate, f64)> {
    let plain = find(answers, query, Estimator::Best)?;
    let sums =
        (1..=STOPS).filter_map(|levels| Some((levels, find(answers, query, Estimator::Stopped(levels))?)));
    let (levels, sum) = sums.min_by(|a, b| a.1.expected.squared.total_cmp(&b.1.expected.squared))?;
    Some((levels, ratio(&sum.squares, &plain.squares), sum.expected.squared / plain.expected.squared))
}

fn claims(answers: &[Answer], levels: &[Level], tails: &[Tail]) -> Vec<Claim> {
    let mut claims = Vec::new();
    for query in QUERIES {
        let (name, title) = (query.name(), query.title());
        if let Some((measured, predicted)) = price(answers, query, STOPS) {
            let text = format!(
                "{title}, sum stopped at level {STOPS}: variance over that of the plain estimate at its last radius, equal photons, over the \
                 predicted {}",
                number(predicted)
            );
            let statistic = measured.times(1.0 / predicted);
            claims.push(Claim::about(&format!("price-{name}"), &text, Unit::ONE, statistic, 1.0, PRICE));
        }
        if let Some((levels, measured, _)) = against_best(answers, query) {
            let text = format!(
                "{title}, sum of {levels} {}, the best for it: mean squared error over that of the plain estimate at its best radius, \
                 equal photons",
                if levels == 1 { "level" } else { "levels" }
            );
            claims.push(Claim::at_least(&format!("no-gain-{name}"), &text, Unit::ONE, measured, 1.0));
        }
        claims.extend(means(answers, query));
        claims.extend(magnitudes(levels, query));
        if let Some(tail) = tails.iter().find(|t| t.query == query && t.estimator == Estimator::Drawn) {
            let text = format!(
                "{title}, levels drawn at random: part of the answers that are farther off than the root mean square of the plain \
                 estimate at its best radius, equal photons on average"
            );
            let part = Estimate::mean(&tail.beyond(ONE));
            claims.push(Claim::at_least(&format!("median-{name}"), &text, Unit::ONE, part, 0.5));
        }
    }
    claims
}

/// What the levels are for.
fn means(answers: &[Answer], query: Query) -> Vec<Claim> {
    let (Some(sum), Some(off), title) = (
        find(answers, query, Estimator::Stopped(MEAN_LEVELS)),
        find(answers, query, Estimator::Off),
        query.title(),
    ) else {
        return Vec::new();
    };
    // The blur that the levels take away; a quarter of it is looked for.
    let taken = off.expected.blur - sum.expected.blur;
    let text =
        format!("{title}, sum of {MEAN_LEVELS} levels: error of the mean, less the blur of its last radius");
    let left = Estimate::mean(&sum.error()).minus(sum.expected.blur);
    let name = query.name();
    let mean = Claim::about(&format!("mean-{name}"), &text, Unit::FRACTION, left, 0.0, 0.25 * taken);
    let text = format!(
        "wrong on purpose, {title}, levels switched off: error of the mean, less the blur that the sum would have"
    );
    let left = Estimate::mean(&off.error()).minus(sum.expected.blur);
    vec![mean, Claim::detected(&format!("levels-off-{name}"), &text, Unit::FRACTION, left, 0.0, 0.5 * taken)]
}

/// Of differences of one number of photons: the sum of their magnitudes must end for the sum to have a mean.
fn magnitudes(levels: &[Level], query: Query) -> Vec<Claim> {
    let own: Vec<&Level> = levels.iter().filter(|l| l.query == query).collect();
    let [.., before, _, last] = own.as_slice() else { return Vec::new() };
    let (name, title) = (query.name(), query.title());
    let text = format!(
        "{title}, one number of photons at all levels: mean magnitude of the difference of level {}, over the predicted {}",
        last.level,
        number(last.predicted)
    );
    let measured = Estimate::mean(&last.moments()).times(1.0 / last.predicted);
    let as_predicted = Claim::about(&format!("magnitude-{name}"), &text, Unit::ONE, measured, 1.0, MAGNITUDE);
    // As fast as the blur of the levels falls: a quarter a level.
    let text = format!(
        "wrong on purpose, {title}, one number of photons at all levels taken for a sum with a mean: magnitude of level {} over that of level \
         {}, from the 1/16 of the blur",
        last.level, before.level
    );
    let fall = ratio(&last.magnitudes, &before.magnitudes);
    let id = format!("no-mean-{name}");
    vec![as_predicted, Claim::detected(&id, &text, Unit::ONE, fall, 1.0 / 16.0, 0.5)]
}

fn rows(
    settings: &Settings,
    answers: &[Answer],
    levels: &[Level],
    tails: &[Tail],
) -> anyhow::Result<Vec<Row>> {
    let mut rows = Vec::new();
    for answer in answers {
        let name = answer.estimator.name(answer.query);
        let (photons, radius) = match answer.estimator {
            Estimator::Plain(levels) => (photons(settings), Some(radius(levels))),
            Estimator::Best => (photons(settings), Some(best(answer.query, photons(settings))?)),
            Estimator::Equal => (work(settings), Some(best(answer.query, work(settings))?)),
            Estimator::Drawn => (work(settings), None),
            Estimator::Stopped(_) | Estimator::Off => (photons(settings), None),
        };
        let kernel = Some(Kernel::Uniform);
        let asked = Parameters { photons: Some(photons), radius, kernel, ..Parameters::default() };
        let error = Row::measured(&name, "error", Unit::ONE, &answer.error())?;
        rows.push(error.predicted(answer.expected.blur).with(asked));
        let squared = Row::measured(&name, "squared error", Unit::ONE, &answer.squared())?;
        rows.push(squared.predicted(answer.expected.squared).with(asked));
    }
    for query in QUERIES {
        for levels in 1..=STOPS {
            let Some((measured, predicted)) = price(answers, query, levels) else { continue };
            let name = Estimator::Stopped(levels).name(query);
            let row = Row::estimated(&name, "variance over plain", Unit::ONE, &measured)?;
            rows.push(row.predicted(predicted));
        }
    }
    for level in levels {
        let moments = level.moments();
        if moments.std_error() > 0.0 {
            let name = difference(level.query, level.level);
            let row = Row::measured(&name, "magnitude", Unit::ONE, &moments)?;
            rows.push(row.predicted(level.predicted));
        }
    }
    for tail in tails {
        let name = tail.estimator.name(tail.query);
        for (place, threshold) in thresholds().into_iter().enumerate() {
            let moments = tail.beyond(place);
            if moments.std_error() > 0.0 {
                rows.push(Row::measured(&name, &beyond(threshold), Unit::ONE, &moments)?);
            }
        }
        let median = tail.median();
        if median.std_error() > 0.0 {
            rows.push(Row::estimated(&name, "median over plain root mean square", Unit::ONE, &median)?);
        }
    }
    Ok(rows)
}

/// What stopped sums pay.
fn prices(answers: &[Answer]) -> Table {
    let mut rows = Vec::new();
    for query in QUERIES {
        for levels in 1..=STOPS {
            let (Some((measured, predicted)), Some(sum), Some(best)) = (
                price(answers, query, levels),
                find(answers, query, Estimator::Stopped(levels)),
                find(answers, query, Estimator::Best),
            ) else {
                continue;
            };
            let over = ratio(&sum.squares, &best.squares);
            rows.push(vec![
                query.title().to_string(),
                levels.to_string(),
                number(radius(levels)),
                percent_with_error(&sum.error()),
                signed(100.0 * sum.expected.blur, 2),
                with_error(measured.value(), measured.std_error()),
                number(predicted),
                number(limit(query)),
                with_error(over.value(), over.std_error()),
                number(sum.expected.squared / best.expected.squared),
            ]);
        }
    }
    let columns = [
        "what is asked by whom",
        "levels",
        "last radius [mfp]",
        "mean error [%]",
        "predicted",
        "variance over plain, last radius",
        "predicted",
        "most",
        "mean squared error over plain, best radius",
        "predicted",
    ];
    Table {
        caption: format!(
            "Sums that start at {FIRST} mean free paths, halve the radius at each level and stop, their photons shared out as the roots of the \
             variances: what is left of the blur, the variance over that of a plain estimate at the last radius, and the mean squared error \
             over that of a plain estimate at its best radius, all of equal photons, with standard errors over cells, beside what was predicted. \
             With ever more levels the price tends to that in the column \"most\"."
        ),
        columns: columns.map(String::from).to_vec(),
        rows,
    }
}

/// How far off answers of equal work are.
fn far(answers: &[Answer], tails: &[Tail], cells: &Cells, settings: &Settings) -> anyhow::Result<Table> {
    let mut rows = Vec::new();
    for tail in tails {
        let Some(answer) = find(answers, tail.query, tail.estimator) else { continue };
        let median = tail.median();
        let name = tail.estimator.name(tail.query);
        let far = |place: usize| {
            let part = tail.beyond(place);
            percent_with_error(&part)
        };
        let (title, photons) = match tail.estimator {
            Estimator::Drawn => {
                let photons = cells.moments(&name, "photons")?;
                ("levels drawn", with_error(photons.mean(), photons.std_error()))
            }
            _ => ("plain, best radius", work(settings).to_string()),
        };
        rows.push(vec![
            tail.query.title().to_string(),
            title.to_string(),
            photons,
            with_error(median.value(), median.std_error()),
            far(ONE),
            far(ONE + 4),
            far(ONE + 6),
            with_error(
                answer.squared().mean().sqrt(),
                0.5 * answer.squared().std_error() / answer.squared().mean().sqrt(),
            ),
            number(answer.expected.squared.sqrt()),
        ]);
    }
    let columns = [
        "what is asked by whom",
        "estimate",
        "photons of an answer",
        "median distance",
        "beyond 1 [%]",
        "beyond 4 [%]",
        "beyond 8 [%]",
        "root mean square error",
        "predicted",
    ];
    Ok(Table {
        caption: "How far answers are from the exact value, in units of the root mean square error of the plain estimate at its best radius \
                  (predicted), with standard errors over cells. Seldom levels carry the root mean square of the sums that are drawn: its error is \
                  not to be relied on, and medians and parts are what to read."
            .to_string(),
        columns: columns.map(String::from).to_vec(),
        rows,
    })
}

fn summary(answers: &[Answer], levels: &[Level], tails: &[Tail]) -> Vec<String> {
    let list = |of: &dyn Fn(Query) -> Option<String>| -> String {
        let words: Vec<String> =
            QUERIES.iter().filter_map(|q| Some(format!("{} for {}", of(*q)?, q.title()))).collect();
        words.join(", ")
    };
    let prices = list(&|query| {
        let (measured, predicted) = price(answers, query, STOPS)?;
        Some(format!(
            "{} (predicted {})",
            with_error(measured.value(), measured.std_error()),
            number(predicted)
        ))
    });
    let best = list(&|query| {
        let (_, measured, predicted) = against_best(answers, query)?;
        Some(format!(
            "{} (predicted {})",
            with_error(measured.value(), measured.std_error()),
            number(predicted)
        ))
    });
    let median = |estimator: Estimator| {
        list(&|query| {
            let median = tails.iter().find(|t| t.query == query && t.estimator == estimator)?.median();
            Some(with_error(median.value(), median.std_error()))
        })
    };
    let falls = list(&|query| {
        let own: Vec<&Level> = levels.iter().filter(|l| l.query == query).collect();
        let [.., before, _, last] = own.as_slice() else { return None };
        let fall = ratio(&last.magnitudes, &before.magnitudes);
        Some(with_error(fall.value(), fall.std_error()))
    });
    vec![
        format!(
            "A sum that halves the radius {STOPS} times and stops has, at equal photons, the variance of the plain estimate at its last radius times \
             {prices}. With the best number of levels, its mean squared error is that of the plain estimate at its best radius times {best}."
        ),
        format!(
            "Levels drawn at random, which take the blur away altogether, are farther off: in units of the root mean square error of the plain \
             estimate at its best radius, the median answer is off by {}, at equal photons; that of the plain estimate by {}.",
            median(Estimator::Drawn),
            median(Estimator::Equal)
        ),
        format!(
            "With one number of photons at all levels the differences do not fall (their mean magnitude, over two levels: {falls}), so that such a sum \
             has no mean at all."
        ),
        "Kernels gain nothing: a difference of two radii varies as much as what it corrects. Where differences fall faster than their work grows, \
         as of marches through a varying density, such a sum has finite variance in finite work: the experiment \"transmittance\" measures \
         that."
            .to_string(),
    ]
}

fn notes(settings: &Settings) -> anyhow::Result<Vec<String>> {
    let schedules: Vec<String> = QUERIES
        .iter()
        .map(|&query| {
            let schedule = Schedule::of(query.codimension());
            format!(
                "{}: {} times as many photons a level, the chance 2^-{} of it, {} replicates an answer",
                query.title(),
                schedule.growth,
                query.codimension() + 4.5,
                schedule.replicates(work(settings))
            )
        })
        .collect();
    let last = Schedule::of(Query::Places.codimension()).last;
    let mut words = Vec::new();
    for query in QUERIES {
        words.push(format!("{} for {}", number(least(query, photons(settings))?), query.title()));
    }
    Ok(vec![
        format!(
            "The first radius of the sums is no handicap that better settings would lift: the least mean squared error of any stopped sum, whatever its \
             first radius and number of levels, is in theory that of the plain estimate at its best radius times {}.",
            words.join(", ")
        ),
        format!(
            "Uncollided light in an exponential slab, uniform kernel, as in \"dimension\": photons are independent, and means, variances and counts \
             are known exactly. The real estimators read real passes; every part of a sum has photons of its own, and a difference reads both \
             radii from the same ones. Stopped sums and the plain estimates beside them have {} photons.",
            photons(settings)
        ),
        format!(
            "Sums drawn at random start from 50 photons a replicate. {}. Levels beyond {last} are not drawn, in favour of the sums: a \
             radius of {} leaves a blur far below every error here, and one more level would take more photons than the whole answer, a few times \
             in a million. Work counts photons, not time.",
            schedules.join("; "),
            number(radius(last + 1))
        ),
        "No schedule of levels can do better in the limit: (sum of the roots of v_k)² is at most variance times work, and it diverges where v_k \
         grows with the photons' rarity, r^-c, whatever the order of the blur. Nor does it help to pay for photons near the question \
         only. The argument is that of Rhee and Glynn 2015 (\"Unbiased estimation with square root convergence for SDE models\"); Misso, Bitterli, \
         Georgiev and Jarosz 2022 (\"Unbiased and consistent rendering using biased estimators\") take the blur of photon maps away in this way."
            .to_string(),
    ])
}
