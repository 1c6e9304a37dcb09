//! What all maps say of importance.

use super::{GROUP, PIXELS, Way};
use crate::claims_1998::part::Part;
use crate::harness::{Cells, Claim, Estimate, Row, Section, Settings, Table, Unit, percent};
use turbid::math::exp;
use turbid::stats::{Jackknife, Moments, jackknife, jackknife_log};

/// How far the means may differ: weights that are lost where photons are split or aimed would make them differ by
/// factors.
const MARGIN: f64 = 0.2;

/// Both kinds of map in one cell.
#[derive(Debug, Clone, PartialEq)]
struct Cell {
    by: [Filled; 2],
}

/// One map.
#[derive(Debug, Clone, PartialEq)]
struct Filled {
    pixels: Vec<f64>,
    events: f64,
    in_view: f64,
    seconds: f64,
}

fn read(cells: &Cells) -> anyhow::Result<Vec<Cell>> {
    let of = |way: Way| -> anyhow::Result<Vec<Filled>> {
        let list: Vec<String> = (0..PIXELS).map(|pixel| way.pixel(pixel)).collect();
        let (pixels, seconds) = (cells.per_map(&list, "radiance")?, cells.seconds(GROUP, way.case()));
        let (events, in_view) =
            (cells.values(way.case(), "events")?, cells.values(way.case(), "stored in view")?);
        let filled =
            |(i, pixels)| Filled { pixels, events: events[i], in_view: in_view[i], seconds: seconds[i] };
        Ok(pixels.into_iter().enumerate().map(filled).collect())
    };
    Ok(of(Way::Power)?.into_iter().zip(of(Way::Importance)?).map(|(a, b)| Cell { by: [a, b] }).collect())
}

fn total(cells: &[Cell], value: impl Fn(&Cell) -> f64) -> f64 {
    cells.iter().map(value).sum()
}

/// Mean relative variance of the pixels of one kind of map.
fn variance(cells: &[Cell], way: usize) -> f64 {
    let pixel = |p: usize| {
        let moments: Moments = cells.iter().map(|c| c.by[way].pixels[p]).collect();
        moments.variance() / (moments.mean() * moments.mean())
    };
    (0..PIXELS).map(pixel).sum::<f64>() / PIXELS as f64
}

/// Photons stored in view for each event, by importance over by power.
fn photons(cells: &[Cell]) -> f64 {
    let rate = |way: usize| total(cells, |c| c.by[way].in_view) / total(cells, |c| c.by[way].events);
    rate(1) / rate(0)
}

/// Variance at equal cost, by power over by importance.
fn gain(cells: &[Cell], cost: impl Fn(&Cell, usize) -> f64) -> f64 {
    let price = |way: usize| variance(cells, way) * total(cells, |c| cost(c, way));
    price(0) / price(1)
}

/// Mean of the picture by importance over that by power, less 1.
fn difference(cells: &[Cell]) -> f64 {
    let sum = |way: usize| total(cells, |c| c.by[way].pixels.iter().sum());
    sum(1) / sum(0) - 1.0
}

fn positive(cells: &[Cell], statistic: impl Fn(&[Cell]) -> f64) -> Estimate {
    let log = jackknife_log(cells, statistic);
    let value = exp(log.value);
    Estimate::jackknife(&Jackknife { value, std_error: value * log.std_error, ..log })
}

/// Everything said of some cells.
struct Effect {
    photons: Estimate,
    by_events: Estimate,
    difference: Estimate,
}

impl Effect {
    fn of(cells: &[Cell]) -> Self {
        Effect {
            photons: positive(cells, photons),
            by_events: positive(cells, |c| gain(c, |c, way| c.by[way].events)),
            difference: Estimate::jackknife(&jackknife(cells, difference)),
        }
    }

    fn claims(&self) -> Vec<Claim> {
        let photons = "importance: photons stored where the camera looks, for each event of their histories, over those \
                       without it";
        let gain = "importance: variance of pixels without it over that with it, at equal events";
        let mean = "importance changes no mean: picture with it against the one without";
        vec![
            Claim::at_least("importance-photons", photons, Unit::ONE, self.photons, 2.0),
            Claim::at_least("importance-gain", gain, Unit::ONE, self.by_events, 1.0),
            Claim::about("importance-mean", mean, Unit::FRACTION, self.difference, 0.0, MARGIN)
                .chosen_after("margin and number of photons", &[1]),
        ]
    }
}

/// Value with its 95 % interval.
fn words(estimate: &Estimate) -> String {
    let interval = estimate.interval(0.95);
    format!("{:.2} ({:.2} to {:.2})", estimate.value(), interval.low, interval.high)
}

/// Concludes.
pub fn conclude(_settings: &Settings, cells: &Cells) -> anyhow::Result<Part> {
    // Learned once by one cell, and again if a run was taken up.
    let learning: Moments = cells.seconds(GROUP, "learning").iter().collect();
    let cells = read(cells)?;
    let effect = Effect::of(&cells);
    let by_time = positive(&cells, |c| gain(c, |c, way| c.by[way].seconds));
    let said = vec![[
        "importance would send photons where they are needed".to_string(),
        format!(
            "for the same number of events {} times as many are stored where the camera looks, and the variance of pixels \
             is {} times smaller; at equal CPU time it is {} times smaller, {:.2} s of learning not counted: {}. \
             The picture's mean differs by {} %",
            words(&effect.photons),
            words(&effect.by_events),
            words(&by_time),
            learning.mean(),
            match by_time.interval(0.95) {
                i if i.low > 1.0 => "once learned, it pays in time",
                i if i.high < 1.0 => "even once learned, it does not pay in time here",
                _ => "whether it pays in time is undecided, in this run",
            },
            effect.difference.in_percent(),
        ),
    ]];
    let section = Section {
        claims: effect.claims(),
        tables: vec![table(&cells)],
        rows: vec![
            Row::estimated("hall", "photons in view, ratio", Unit::ONE, &effect.photons)?,
            Row::estimated("hall", "variance at equal events, ratio", Unit::ONE, &effect.by_events)?,
            Row::estimated("hall", "difference of means", Unit::FRACTION, &effect.difference)?
                .reference(0.0, 0.0),
        ],
        notes: vec![
            "Importance: after a first run with seed 1 the pilot got eight times as many photons, maps by power three times \
             as many, and the means a margin of 20 per cent in place of 5; the claims stayed."
                .to_string(),
        ],
        ..Section::default()
    };
    Ok(Part { section, said })
}

fn table(cells: &[Cell]) -> Table {
    let count = cells.len() as f64;
    let row = |way: usize| {
        let mean = |value: &dyn Fn(&Filled) -> f64| total(cells, |c| value(&c.by[way])) / count;
        let noise = positive(cells, |c| percent(variance(c, way).sqrt()));
        vec![
            Way::ALL[way].case().to_string(),
            format!("{:.0}", mean(&|s| s.events)),
            format!("{:.0}", mean(&|s| s.in_view)),
            words(&noise),
            format!("{:.1}", 1e3 * mean(&|s| s.seconds)),
        ]
    };
    Table {
        caption: "A long foggy hall, lit at one end, seen in a corner at the other: maps by the lights' power and by \
                  importance, a mean map each; photons of both maps in the corner; noise of a pixel from map to map with its \
                  95 % interval; CPU time of this machine."
            .to_string(),
        columns: ["maps", "events", "photons in view", "noise [%]", "filling [ms]"]
            .map(String::from)
            .to_vec(),
        rows: vec![row(0), row(1)],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::harness::{Verdict, judge};
    use turbid::rng::{Purpose, Stream};

    /// Cells whose maps by importance have twice the events, eight times the photons in view and a sixteenth of the variance.
    fn cells(mean_by_importance: f64) -> Vec<Cell> {
        let mut stream = Stream::new(3, Purpose::Synthetic, 0, 0);
        let mut map = |mean: f64, half: f64, events: f64, in_view: f64| {
            let pixels = (0..PIXELS).map(|_| mean * (1.0 + 2.0 * half * (stream.unit() - 0.5))).collect();
            Filled { pixels, events: events * (0.9 + 0.2 * stream.unit()), in_view, seconds: 1.0 }
        };
        let one = |_| Cell { by: [map(1.0, 0.4, 100.0, 50.0), map(mean_by_importance, 0.1, 200.0, 400.0)] };
        (0..64).map(one).collect()
    }

    fn verdicts(cells: &[Cell]) -> Vec<Verdict> {
        judge(Effect::of(cells).claims(), 100).iter().map(|judged| judged.verdict).collect()
    }

    #[test]
    fn right_weights_are_upheld_and_lost_ones_are_seen() {
        let right = cells(1.0);
        let effect = Effect::of(&right);
        assert!((effect.photons.value() - 4.0).abs() < 0.2 && (effect.by_events.value() - 8.0).abs() < 1.0);
        assert_eq!(verdicts(&right), [Verdict::Upheld; 3]);
        // Split photons that keep their whole weight make the picture brighter.
        assert_eq!(verdicts(&cells(1.4))[2], Verdict::Rejected);
    }
}
