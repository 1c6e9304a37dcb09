//! What all cells together say.

use super::cases::{Case, LEVELS, Method, RAMP, estimates, level_name};
use super::claims::{self, CLOUD, NOISE};
use super::figures;
use super::results::{CaseResult, find, gain};
use crate::harness::{
    Cells, Estimate, Headline, Row, Section, Settings, Table, Unit, number, percent_with_error, with_error,
};
use crate::prediction::{Prediction, Predictions};

/// Concludes.
pub fn conclude(settings: &Settings, predictions: &[Prediction], cells: &Cells) -> anyhow::Result<Section> {
    let known = Predictions::new(predictions);
    let all = Case::all().into_iter().map(|case| CaseResult::new(case, &known, cells));
    let results = all.collect::<anyhow::Result<Vec<_>>>()?;
    let in_budget = |r: &&CaseResult| r.is_normal();
    let entry =
        |r: &CaseResult| r.mean.entry(format!("transmittance-{}", r.case().way.name()), &r.case().name());
    Ok(Section {
        summary: summary(&results),
        claims: claims::claims(&results, &known, cells)?,
        figures: figures::all(&results)?,
        tables: vec![ramp(&results), work(&results)],
        notes: notes(settings),
        rows: rows(&results, cells)?,
        budget: results.iter().filter(in_budget).map(entry).collect(),
        left_out: results.iter().filter(|r| !r.is_normal()).count(),
        headlines: headlines(&results),
        ..Section::default()
    })
}

/// Rows of what has a spread; what is the same in all cells is computed, or was met by no estimate.
fn rows(results: &[CaseResult], cells: &Cells) -> anyhow::Result<Vec<Row>> {
    let mut rows = Vec::new();
    for r in results {
        let name = r.case().name();
        if r.mean.error.std_error() > 0.0 {
            rows.extend(r.mean.rows(&name, ("transmittance", Unit::ONE), Default::default(), cells)?);
        }
        let squared = cells.moments(&name, "squared error")?;
        if squared.std_error() > 0.0 {
            let row = Row::measured(&name, "squared error", Unit::ONE, &squared)?;
            rows.push(row.predicted(r.expected.squared));
        }
        let look_ups = cells.moments(&name, "look-ups")?;
        rows.push(match look_ups.std_error() > 0.0 {
            true => Row::measured(&name, "look-ups", Unit::ONE, &look_ups)?.predicted(r.expected.look_ups),
            false => Row::exact(&name, "look-ups", Unit::ONE, look_ups.mean(), 0.0),
        });
        let work = r.work();
        if work.std_error() > 0.0 && work.value().is_finite() {
            rows.push(Row::estimated(&name, "work", Unit::ONE, &work)?.predicted(r.expected.work()));
        }
    }
    for level in 0..LEVELS {
        let name = level_name(level);
        let moments = cells.moments(&name, "squared difference")?;
        if moments.std_error() > 0.0 {
            rows.push(Row::measured(&name, "squared difference", Unit::ONE, &moments)?);
        }
    }
    Ok(rows)
}

fn strings(columns: &[&str]) -> Vec<String> {
    columns.iter().map(|c| c.to_string()).collect()
}

/// Every method on the ray of closed forms.
fn ramp(results: &[CaseResult]) -> Table {
    let row = |r: &CaseResult| {
        let squared = r.over_predicted().times(r.expected.squared);
        let look_ups: turbid::stats::Moments = r.look_ups.iter().collect();
        vec![
            r.case().method.title(),
            percent_with_error(&r.mean.error),
            number(100.0 * r.expected.bias),
            with_error(squared.value(), squared.std_error()),
            number(r.expected.squared),
            with_error(look_ups.mean(), look_ups.std_error()),
            number(r.expected.look_ups),
        ]
    };
    let columns = ["method", "bias [%]", "predicted", "squared error", "predicted", "look-ups", "predicted"];
    Table {
        caption: "The transmittance of mu = 4x over a length of 1, T = e^-2: bias, mean squared error over T², and densities looked up, \
                  each with its standard error over cells beside what was predicted. The squared error of telescoped marches \
                  is finite, but has no variance itself: its error is not to be relied on."
            .to_string(),
        columns: strings(&columns),
        rows: results.iter().filter(|r| r.case().way == RAMP).map(row).collect(),
    }
}

/// Work of every unbiased method on every ray.
fn work(results: &[CaseResult]) -> Table {
    let row = |way: &super::rays::Way| {
        let of = |method: &Method| match find(results, *way, *method) {
            Some(r) if r.expected.work() < 1e-9 => "0".to_string(),
            Some(r) if r.is_shown() => with_error(r.work().value(), r.work().std_error()),
            Some(r) => format!("({})", number(r.expected.work())),
            None => String::new(),
        };
        let mut cells = vec![way.title()];
        cells.extend(super::cases::UNBIASED.iter().map(of));
        cells
    };
    let mut columns = vec!["ray".to_string()];
    columns.extend(super::cases::UNBIASED.iter().map(|m| m.title()));
    Table {
        caption: "Relative variance times look-ups, with its standard error over cells; in brackets as predicted, where rare values \
                  carry the variance (relative variance above 10, or above 1 beyond optical depth 2, and all telescoped marches)."
            .to_string(),
        columns,
        rows: super::rays::Way::all().iter().map(row).collect(),
    }
}

fn summary(results: &[CaseResult]) -> Vec<String> {
    let words = |way, of, over| {
        gain(results, way, of, over).map(|(gain, predicted): (Estimate, f64)| {
            format!("{} (predicted {})", with_error(gain.value(), gain.std_error()), number(predicted))
        })
    };
    let mut summary = Vec::new();
    if let (Some(noise), Some(cloud)) =
        (words(NOISE, Method::Ratio, Method::Combs), words(CLOUD, Method::Ratio, Method::Combs))
    {
        summary.push(format!(
            "At optical depth 2, ratio tracking under the largest extinction of a ray costs {noise} times the look-ups of unbiased ray \
             marching for the same variance through noise, and {cloud} times through a cloud."
        ));
    }
    if let (Some(noise), Some(cloud)) =
        (words(NOISE, Method::Local, Method::LocalCombs), words(CLOUD, Method::Local, Method::LocalCombs))
    {
        summary.push(format!(
            "With the bounds by cell that the renderer has, its own tracking costs {noise} and {cloud} times the look-ups of combs laid out by \
             the bounds, of two places more than tracking has tentative collisions."
        ));
    }
    summary.push(
        "Marches are bright on every ray, as convexity says; the jackknife takes away the first order, and a telescoping sum of \
         marches all of the bias, in finite variance and work."
            .to_string(),
    );
    summary
}

fn notes(settings: &Settings) -> Vec<String> {
    vec![
        format!("{} estimates of each case in a cell.", estimates(settings)),
        "The power series has the optical depth as its pivot, and the residual its mean as control, which nobody knows who needs an \
         estimate: they show the best that such methods could do."
            .to_string(),
        "Series may leave the range from 0 to 1, and combs do where an order above 0 is drawn; tracking never does. What is used as a \
         weight in a random walk must not be negative."
            .to_string(),
        "A comb in step with a density that repeats itself asks the same place of every wave: through three waves unbiased ray marching \
         with three places a comb varies more than any tracking, with two or four next to nothing."
            .to_string(),
        "Look-ups of telescoped marches have a finite mean and no variance; neither has their squared error. Both are shown as \
         predicted."
            .to_string(),
    ]
}

fn headlines(results: &[CaseResult]) -> Vec<Headline> {
    let of = |(name, way, of, over): (&str, _, Method, Method)| {
        let text = format!("variance times look-ups, {} over {}", of.title(), over.title());
        Some(Headline::new(name, &text, Unit::ONE, gain(results, way, of, over)?.0))
    };
    let all = [
        ("Noise", NOISE, Method::Ratio, Method::Combs),
        ("Cloud", CLOUD, Method::Ratio, Method::Combs),
        ("NoiseLocal", NOISE, Method::Local, Method::LocalCombs),
        ("CloudLocal", CLOUD, Method::Local, Method::LocalCombs),
    ];
    all.into_iter().filter_map(of).collect()
}
