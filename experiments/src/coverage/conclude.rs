//! What all repeats together say.

use super::field::{Exact, RADII};
use super::figures;
use super::intervals::Kind;
use super::measure::{GROUP, MAPS, SIZES, alarm_name, case, nearest_case, null_case, radius_case, repeats};
use super::nulls::{LEVELS, Population, VALUES};
use super::results::uniformity;
use crate::harness::{
    Cells, Claim, Estimate, Row, Section, Settings, Table, Unit, number, percent, percent_with_error,
    with_error,
};
use crate::prediction::{Entry, Prediction, Term};
use turbid::stats::{Moments, student_p};

/// How far coverage at 95 per cent and alarms at 1 per cent may lie from what they promise, on the mean over statistics: in
/// a study of a hundred claims one more or fewer.
const COVERAGE_MARGIN: f64 = 0.01;
const ALARM_MARGIN: f64 = 0.005;
/// What Student's t with few degrees of freedom leaves of the normal quantile's 95 per cent is predicted, and must be at
/// least this far from them to be detected.
const NORMAL_SEEN: f64 = 0.02;
/// Kolmogorov's distance that right p-values exceed once in 10^5, times the root of their number.
const KOLMOGOROV: f64 = 2.47;
/// Numerical error of the predictions, relative: quadrature to 1e-12, tables to 1e-8.
const NUMERICAL: f64 = 1e-7;

/// Coverage of the normal quantile where the error is estimated from so many maps.
fn normal_coverage(maps: usize) -> f64 {
    1.0 - student_p(turbid::stats::normal_critical(0.05), maps as u64 - 1)
}

/// What theory says.
pub fn predict(_settings: &Settings) -> anyhow::Result<Vec<Prediction>> {
    let exact = Exact::new()?;
    let mut all = Vec::new();
    let mut add = |case: String, quantity: &str, unit: Unit, value: f64, error: f64, source: &str| {
        all.push(Prediction::new(case, quantity, unit, (value, error), source));
    };
    for kind in Kind::ALL {
        for maps in SIZES {
            add(case(kind, maps), "coverage", Unit::FRACTION, 0.95, 0.0, "the level");
            add(case(kind, maps), "p below 0.01", Unit::FRACTION, 0.01, 0.0, "the level");
        }
        add(case(kind, MAPS), "truth", Unit::ONE, kind.truth(&exact), NUMERICAL, "independent photons");
    }
    for maps in SIZES {
        let source = "Student's t at the normal quantile";
        let value = normal_coverage(maps);
        add(case(Kind::Radius, maps), "coverage by normal", Unit::FRACTION, value, 1e-11, source);
    }
    for population in Population::ALL {
        for level in LEVELS {
            add(null_case(population), &alarm_name(level), Unit::ONE, level, 0.0, "the level");
        }
    }
    for (r, error) in RADII.into_iter().zip(exact.errors) {
        add(radius_case(r), "error", Unit::ONE, error, NUMERICAL, "mean over the ball");
    }
    add(nearest_case(), "error", Unit::ONE, exact.nearest, NUMERICAL, "independent points");
    Ok(all)
}

/// Concludes.
pub fn conclude(settings: &Settings, _predictions: &[Prediction], cells: &Cells) -> anyhow::Result<Section> {
    let mut section = Section { rows: rows(cells)?, claims: claims(cells)?, ..Section::default() };
    section.budget = budget(cells)?;
    section.figures = figures::all(cells)?;
    section.tables = vec![coverages(cells)?, alarms(cells)?];
    summarise(&mut section, settings, cells)?;
    Ok(section)
}

/// A row, unless every cell says the same, which is then a count without spread.
fn measured(case: &str, quantity: &str, unit: Unit, moments: &Moments) -> anyhow::Result<Row> {
    if moments.std_error() > 0.0 {
        return Row::measured(case, quantity, unit, moments);
    }
    Ok(Row::count(case, quantity, unit, moments.n(), 0))
}

fn rows(cells: &Cells) -> anyhow::Result<Vec<Row>> {
    let mut rows = Vec::new();
    for kind in Kind::ALL {
        for maps in SIZES {
            let name = case(kind, maps);
            for quantity in ["coverage", "p below 0.01", "coverage by normal"] {
                rows.push(measured(&name, quantity, Unit::FRACTION, &cells.moments(&name, quantity)?)?);
            }
        }
        let (test, n) = uniformity(cells, kind);
        let scaled = test.distance * (n as f64).sqrt();
        rows.push(Row::exact(&case(kind, MAPS), "scaled Kolmogorov distance of p", Unit::ONE, scaled, 0.0));
    }
    for population in Population::ALL {
        let name = null_case(population);
        for level in LEVELS {
            let quantity = alarm_name(level);
            rows.push(measured(&name, &quantity, Unit::ONE, &cells.moments(&name, &quantity)?)?);
        }
    }
    for name in RADII.into_iter().map(radius_case).chain([nearest_case()]) {
        rows.push(Row::measured(&name, "error", Unit::ONE, &cells.moments(&name, "error")?)?);
    }
    Ok(rows)
}

fn claims(cells: &Cells) -> anyhow::Result<Vec<Claim>> {
    let mut claims = Vec::new();
    // The statistics share repeats: the mean over them of each batch is one number.
    let of_all = |quantity: &str| -> anyhow::Result<Estimate> {
        let lists = Kind::MADE.map(|kind| cells.values(&case(kind, MAPS), quantity));
        let lists = lists.into_iter().collect::<anyhow::Result<Vec<Vec<f64>>>>()?;
        let batches = lists.iter().map(Vec::len).min().unwrap_or(0);
        let mean = |i: usize| lists.iter().map(|values| values[i]).sum::<f64>() / lists.len() as f64;
        Ok(Estimate::mean(&(0..batches).map(mean).collect::<Vec<f64>>().iter().collect()))
    };
    let text = format!("{MAPS} maps, all statistics: how often 95 % intervals cover");
    let statistic = of_all("coverage")?;
    claims.push(Claim::about("coverage", &text, Unit::FRACTION, statistic, 0.95, COVERAGE_MARGIN));
    let text = format!("{MAPS} maps, all statistics: how often p is below 0.01");
    let statistic = of_all("p below 0.01")?;
    claims.push(Claim::about("alarms", &text, Unit::FRACTION, statistic, 0.01, ALARM_MARGIN));
    let scaled = Kind::MADE.map(|kind| {
        let (test, n) = uniformity(cells, kind);
        test.distance * (n as f64).sqrt()
    });
    let text = "all statistics: largest distance of their p-values from uniform ones, times the root of n";
    let statistic = Estimate::exact(scaled.into_iter().fold(0.0, f64::max), 0.0);
    claims.push(Claim::at_most("uniform", text, Unit::ONE, statistic, KOLMOGOROV));
    let few = case(Kind::Radius, SIZES[0]);
    let text = format!(
        "wrong on purpose, {} maps and the normal quantile in the place of Student's: coverage at a fixed radius",
        SIZES[0]
    );
    let statistic = cells.estimate(&few, "coverage by normal")?;
    claims.push(Claim::detected("normal-quantile", &text, Unit::FRACTION, statistic, 0.95, NORMAL_SEEN));
    let name = null_case(Population::Normal);
    for (level, margin) in [(1e-2, 0.05), (1e-3, 0.15)] {
        let text = format!("means of {VALUES} normal numbers: alarms on right data at {level}, over {level}");
        let statistic = cells.estimate(&name, &alarm_name(level))?.times(1.0 / level);
        let id = format!("false-alarms-{level}");
        claims.push(Claim::about(&id, &text, Unit::ONE, statistic, 1.0, margin));
    }
    Ok(claims)
}

/// Mean errors of right estimators, known exactly: one number a batch of repeats.
fn budget(cells: &Cells) -> anyhow::Result<Vec<Entry>> {
    let exact = Exact::new()?;
    let mut entries = Vec::new();
    let radii = RADII.into_iter().map(radius_case).zip(exact.errors);
    for (name, error) in radii.chain([(nearest_case(), exact.nearest)]) {
        let maps = cells.values(&name, "error")?;
        entries.push(Entry::new(GROUP, name, &[(Term::Blur, error)], NUMERICAL, maps));
    }
    Ok(entries)
}

fn shown(cells: &Cells, name: &str, quantity: &str) -> anyhow::Result<String> {
    Ok(percent_with_error(&cells.moments(name, quantity)?))
}

fn coverages(cells: &Cells) -> anyhow::Result<Table> {
    let mut columns = vec!["interval".to_string()];
    columns.extend(SIZES.map(|maps| format!("{maps} maps [%]")));
    columns.extend([format!("p below 0.01, {MAPS} maps [%]"), "distance of p from uniform".to_string()]);
    let mut rows = Vec::new();
    for kind in Kind::ALL {
        let mut row = vec![kind.title().to_string()];
        for maps in SIZES {
            row.push(shown(cells, &case(kind, maps), "coverage")?);
        }
        row.push(shown(cells, &case(kind, MAPS), "p below 0.01")?);
        let (test, n) = uniformity(cells, kind);
        row.push(format!("{} (p = {})", number(test.distance * (n as f64).sqrt()), number(test.p)));
        rows.push(row);
    }
    let mut row = vec!["fixed radius, normal quantile".to_string()];
    for maps in SIZES {
        row.push(shown(cells, &case(Kind::Radius, maps), "coverage by normal")?);
    }
    row.extend([String::new(), String::new()]);
    rows.push(row);
    let caption = "How often 95 % intervals contain the exact value, by the number of maps behind them, with standard \
                   errors over batches of repeats; how often their p-value is below 0.01; and Kolmogorov's distance of \
                   one p-value a repeat from the uniform law, times the root of their number (above 1.36 once in \
                   twenty). The last row takes the normal quantile for Student's, wrongly."
        .to_string();
    Ok(Table { caption, columns, rows })
}

fn alarms(cells: &Cells) -> anyhow::Result<Table> {
    let mut columns = vec!["numbers".to_string()];
    columns.extend(LEVELS.map(|level| format!("at {}", number(level))));
    let mut rows = Vec::new();
    for population in Population::ALL {
        let name = null_case(population);
        let mut row = vec![population.title().to_string()];
        for level in LEVELS {
            let moments = cells.moments(&name, &alarm_name(level))?;
            row.push(with_error(moments.mean() / level, moments.std_error() / level));
        }
        rows.push(row);
    }
    let caption = format!(
        "Alarms of Student's t test on right data, over the number that its level promises: means of {VALUES} numbers, \
         normal ones and skewed ones."
    );
    Ok(Table { caption, columns, rows })
}

fn summarise(section: &mut Section, settings: &Settings, cells: &Cells) -> anyhow::Result<()> {
    let mut covered = Vec::new();
    for kind in Kind::MADE {
        covered.push(cells.moments(&case(kind, MAPS), "coverage")?.mean());
    }
    covered.sort_by(f64::total_cmp);
    let alarm = |population, level: f64| -> anyhow::Result<String> {
        let moments = cells.moments(&null_case(population), &alarm_name(level))?;
        Ok(with_error(moments.mean() / level, moments.std_error() / level))
    };
    section.summary.push(format!(
        "Over {} repeats of a study of {MAPS} maps, intervals that promise to contain the exact value 95 times in a \
         hundred contain it between {:.1} and {:.1} times, by the kind of statistic.",
        repeats(settings),
        percent(covered[0]),
        percent(covered[covered.len() - 1])
    ));
    section.summary.push(format!(
        "Tests on right data raise {} times the alarms that they promise at 1 in 100, and {} times at 1 in 10,000; where \
         the maps' numbers have a skewness of 1, {} times.",
        alarm(Population::Normal, 1e-2)?,
        alarm(Population::Normal, 1e-4)?,
        alarm(Population::Skewed, 1e-4)?
    ));
    section.notes.push(format!(
        "A lattice of {} x {} places is asked, row by row: a row is a study of its own, and its number of one map is the \
         mean over its places, as in the laboratory's experiments. Rows of one repeat use the same maps but no photon \
         twice; standard errors come from batches of repeats, so that they hold whatever rows share.",
        super::field::ROWS,
        super::field::PLACES
    ));
    section.notes.push(
        "Claims are about 64 maps, the fewest that verdicts allow. With fewer the skewness of a map's number is felt: at \
         32 maps, variances whose intervals are made on the numbers themselves are covered 94.3 % of the time, with twice \
         the alarms at 1 %. Hence they are made on the logarithm."
            .to_string(),
    );
    section.notes.push(
        "Fewer than 8 maps are not shown. At 64 the normal quantile would do little harm at 95 % and much at one in a \
         million."
            .to_string(),
    );
    Ok(())
}
