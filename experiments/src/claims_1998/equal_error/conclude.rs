//! What all maps say of "photon maps are faster than Monte Carlo".

use super::data::{Cell, Currency, Fit};
use super::results::{Crossing, PIXELS, PREVIEW_ERROR, Pictures, SIDES, gain};
use super::{SIDE, figure};
use crate::claims_1998::part::Part;
use crate::cost_model::{LOOKED_AT, STORED, cheapest};
use crate::harness::{
    Answer, Cells, Claim, Estimate, Headline, Reached, Row, Section, Settings, TARGETS, Table, Unit, percent,
};
use turbid::math::exp;
use turbid::stats::{Jackknife, jackknife, jackknife_log};

/// Samples a pixel of the results' errors.
const NUMBER: f64 = 24.0;

/// Concludes.
pub fn conclude(settings: &Settings, cells: &Cells) -> anyhow::Result<Part> {
    let pictures = Pictures::new(settings, cells)?;
    let in_rays = speed(&pictures, Currency::Rays, PREVIEW_ERROR);
    let text = format!(
        "\"photon maps are faster than Monte Carlo\": work of paths over that of photon maps, for a picture of \
         {SIDE} x {SIDE} pixels with an error of {:.0} %",
        percent(PREVIEW_ERROR)
    );
    let [rays, seconds] =
        [Currency::Rays, Currency::Seconds].map(|currency| Crossing::all(&pictures, currency));
    let measured = SIDES.iter().position(|&side| side == SIDE).unwrap_or(0);
    let said = vec![[
        "photon maps are faster than Monte Carlo".to_string(),
        format!(
            "down to an error of {} of the mean radiance in CPU time, {} in work, for {SIDE} x {SIDE} pixels and maps \
             of up to {} photons: {}; for 512 x 512 pixels down to {}. At an error of 20 % paths take {} times as \
             long for {SIDE} x {SIDE} pixels",
            seconds[measured].words(),
            rays[measured].words(),
            pictures.sizes.last().map_or(0, |size| size.photons),
            seconds[measured].verdict(),
            seconds[SIDES.len() - 1].words(),
            pictures.gain(0.2),
        ),
    ]];
    let section = Section {
        claims: vec![
            Claim::at_least("faster", &text, Unit::ONE, in_rays, 1.0)
                .chosen_after("statistic and the work of a photon", &[1]),
        ],
        figures: vec![figure::cost(&pictures, &seconds[measured], &rays[measured])?],
        tables: vec![size_table(&pictures), crossing_table(&pictures, &rays, &seconds)],
        notes: vec![format!(
            "Equal-error cost: a ray by a map takes direct light by shadow rays, and of light scattered into a ray one random \
             place. Work is counted in rays; a photon put into a tree counts {STORED} rays and one in an estimate \
             {LOOKED_AT}, round numbers near this machine's times in a first run. Costs and errors of other numbers \
             of samples follow from those of one sample. The crossing is that of the sizes of maps in the table: \
             larger maps may go lower where a picture has more pixels to pay for them."
        )],
        rows: rows(&pictures, &in_rays)?,
        answers: vec![answer(&pictures)],
        headlines: vec![Headline::new("Faster", &text, Unit::ONE, in_rays)],
        ..Section::default()
    };
    Ok(Part { section, said })
}

/// Cost of paths over that of the cheapest map at an error.
///
/// Not the crossing, which has an end where it may stick: what is constant but for a few cells has no jackknife. Where no map is
/// so good the gain is as good as 0, which has a logarithm.
fn speed(pictures: &Pictures, currency: Currency, error: f64) -> Estimate {
    let statistic =
        |chosen: &[&Cell]| gain(&Fit::of(chosen, currency), PIXELS, error).unwrap_or(f64::MIN_POSITIVE);
    let log = jackknife_log(&pictures.cells.iter().collect::<Vec<_>>(), statistic);
    let value = exp(log.value);
    Estimate::jackknife(&Jackknife { value, std_error: value * log.std_error, ..log })
}

/// The picture as an answer to the study's question.
fn answer(pictures: &Pictures) -> Answer {
    let fit = pictures.fit(Currency::Seconds);
    let cells: Vec<&Cell> = pictures.cells.iter().collect();
    let [times, works] =
        [Currency::Seconds, Currency::Rays].map(|currency| pictures.gains(currency, TARGETS));
    let reached = |index: usize| {
        let target = TARGETS[index];
        let square = (target * fit.mean) * (target * fit.mean);
        let (size, _) = cheapest(&fit.maps, PIXELS, square)?;
        let maps = &fit.maps[size];
        let parts = [
            ("noise of samples", maps.noise / maps.samples(square)?),
            ("noise of the map", maps.spread),
            ("bias", maps.bias),
        ];
        let largest = parts.into_iter().max_by(|a, b| a.1.total_cmp(&b.1));
        Some(Reached {
            time: times[index]?,
            pays_from: None,
            work: works[index]?,
            bias: Estimate::jackknife(&jackknife(&cells, |chosen: &[&Cell]| {
                let fit = Fit::of(chosen, Currency::Seconds);
                fit.squared_biases[size] / (fit.mean * fit.mean)
            }))
            .root(),
            limit: largest.map_or("", |(name, _)| name),
        })
    };
    Answer {
        scene: format!("box of fog, picture of {SIDE} x {SIDE}"),
        reached: std::array::from_fn(reached),
        untreated: None,
        curves: Some(figure::curves(pictures)),
    }
}

fn rows(pictures: &Pictures, gain: &Estimate) -> anyhow::Result<Vec<Row>> {
    let mut rows = vec![Row::estimated(
        "fog box",
        &format!("work of paths over maps at {:.0} %", percent(PREVIEW_ERROR)),
        Unit::ONE,
        gain,
    )?];
    let cells: Vec<&Cell> = pictures.cells.iter().collect();
    for (i, size) in pictures.sizes.iter().enumerate() {
        let square = |chosen: &[&Cell]| {
            let fit = Fit::of(chosen, Currency::Rays);
            fit.maps[i].square(NUMBER)
        };
        let relative = |chosen: &[&Cell]| square(chosen).sqrt() / Fit::of(chosen, Currency::Rays).mean;
        let log = jackknife_log(&cells, relative);
        let value = exp(log.value);
        let estimate = Estimate::jackknife(&Jackknife { value, std_error: value * log.std_error, ..log });
        let row = Row::estimated(&size.case(), "error of 24 samples", Unit::FRACTION, &estimate)?;
        rows.push(row.with(size.parameters()));
    }
    Ok(rows)
}

/// A root mean square over the mean, in per cent.
fn over(square: f64, mean: f64) -> String {
    format!("{:.2}", percent(square.max(0.0).sqrt() / mean))
}

fn size_table(pictures: &Pictures) -> Table {
    let [rays, seconds] = [Currency::Rays, Currency::Seconds].map(|currency| pictures.fit(currency));
    let mean = rays.mean;
    let mut rows: Vec<Vec<String>> = pictures
        .sizes
        .iter()
        .enumerate()
        .map(|(i, size)| {
            let (maps, timed) = (&rays.maps[i], &seconds.maps[i]);
            vec![
                format!("map of {}", size.photons),
                size.k.to_string(),
                over(maps.noise, mean),
                over(maps.spread, mean),
                over(maps.bias, mean),
                format!("{:.0}", maps.fill),
                format!("{:.1}", maps.sample),
                format!("{:.1}", 1e3 * timed.fill),
                format!("{:.2}", 1e6 * timed.sample),
            ]
        })
        .collect();
    rows.push(vec![
        "paths".to_string(),
        String::new(),
        over(rays.paths.noise, mean),
        String::new(),
        String::new(),
        String::new(),
        format!("{:.1}", rays.paths.sample),
        String::new(),
        format!("{:.2}", 1e6 * seconds.paths.sample),
    ]);
    Table {
        caption: "Photon maps of several sizes and paths in a box of fog: noise of one sample of a pixel, what is left of \
                  the error with all samples, apart between maps and common to all, in per cent of the mean radiance; \
                  the work of filling and of one sample in rays, and CPU time of this machine."
            .to_string(),
        columns: [
            "photons emitted",
            "k",
            "noise of a sample [%]",
            "spread of maps [%]",
            "bias [%]",
            "filling [rays]",
            "a sample [rays]",
            "filling [ms]",
            "a sample [µs]",
        ]
        .map(String::from)
        .to_vec(),
        rows,
    }
}

fn crossing_table(pictures: &Pictures, rays: &[Crossing], seconds: &[Crossing]) -> Table {
    let fit = pictures.fit(Currency::Seconds);
    let row = |(i, side): (usize, &u32)| {
        let pixels = f64::from(side * side);
        let error = fit.mean * seconds[i].at;
        let size = cheapest(&fit.maps, pixels, error * error * (1.0 + 1e-9))
            .map_or(String::new(), |(size, _)| pictures.sizes[size].photons.to_string());
        let mut row = vec![format!("{side} x {side}"), rays[i].words(), seconds[i].words(), size];
        for error in [0.3, 0.2, 0.1] {
            row.push(
                gain(&fit, pixels, error).map_or("none so good".to_string(), |gain| format!("{gain:.1}")),
            );
        }
        row
    };
    Table {
        caption: "Error below which paths are the cheaper, with bootstrap intervals of 95 % over cells, for pictures of \
                  several sizes, the map that is the cheapest there, and how many times longer paths take at three errors."
            .to_string(),
        columns: [
            "pixels",
            "crossing in work",
            "crossing in CPU time",
            "map of photons",
            "gain at 30 %",
            "gain at 20 %",
            "gain at 10 %",
        ]
        .map(String::from)
        .to_vec(),
        rows: SIDES.iter().enumerate().map(row).collect(),
    }
}
