//! What all cells together say.

use super::asked::{OwnStudy, asked};
use super::data::{self, Data, Half, Setting};
use super::reference::Sampler;
use super::{figures, tables, words};
use crate::harness::{
    Cells, Estimate, Headline, Section, Settings, Table, Unit, number, percent, signed, with_error,
};
use crate::prediction::Prediction;
use crate::theory::exponent_of_means;
use turbid::sensor::FEWEST_PATHS;
use turbid::stats::Moments;

/// Concludes.
pub fn conclude(settings: &Settings, predictions: &[Prediction], cells: &Cells) -> anyhow::Result<Section> {
    let study = asked(settings)?;
    let all = data::all(&study, cells)?;
    let mut figures = Vec::new();
    for (number, data) in all.iter().enumerate().take(figures::MOST_SCENES) {
        if data.usable() > 0 {
            figures.extend(figures::of_scene(data, number, study.file.target)?);
        }
    }
    Ok(Section {
        summary: summary(&study, &all),
        headlines: headlines(&study, &all),
        figures,
        tables: [Some(answers(&study, &all)), rates(&all), predicted(&all, predictions), references(&all)]
            .into_iter()
            .flatten()
            .collect(),
        notes: notes(&study, &all),
        files: vec![
            ("results.csv".to_string(), tables::results(&all, predictions)?),
            ("costs.csv".to_string(), tables::costs(&all)?),
        ],
        ..Section::default()
    })
}

fn in_percent(estimate: &Estimate) -> String {
    format!("{} %", with_error(percent(estimate.value()), percent(estimate.std_error())))
}

/// A scene in a sentence.
fn here(data: &Data) -> String {
    if data.point.label.is_empty() { "Here".to_string() } else { format!("With {}", data.point.label) }
}

/// Time of the rival to the error of a setting, over that of the setting, with its error.
fn speed(data: &Data, error: f64, setting: &Setting) -> Option<Estimate> {
    let rival = data.rival.as_ref()?;
    let factor = rival.seconds / (error * error * setting.time());
    Some(rival.variance.times(factor))
}

fn summary(study: &OwnStudy, all: &[Data]) -> Vec<String> {
    let target = study.file.target;
    let mut paragraphs = Vec::new();
    for data in all.iter().take(figures::MOST_SCENES) {
        if data.usable() == 0 {
            paragraphs.push(format!(
                "{} the reference of every place is 0, has an error of more than a fifth of it, or has none: nothing is said of relative errors.",
                here(data)
            ));
            continue;
        }
        let named = |s: &Setting| format!("{} photons read by {}", s.photons, s.estimator.name());
        let is_known = |error: &Estimate| error.value() > 0.0 && error.std_error().is_finite();
        let half = "the other half is too few maps to tell its error";
        let settings = match data.settings.len() {
            1 => "1 setting".to_string(),
            count => format!("{count} settings"),
        };
        let text = match data.cheapest(target) {
            Some(setting) => {
                let error = setting.rmse(Half::Telling);
                let beside = match speed(data, error.value(), setting) {
                    Some(speed) if error.value() > 0.0 => {
                        let (faster, than) = match speed.value() >= 1.0 {
                            true => (speed, "less CPU time than"),
                            false => (speed.inverse(), "more CPU time than"),
                        };
                        let factor = with_error(faster.value(), faster.std_error());
                        format!(", in ({factor}) times {than} {}", data.reference.sampler.name())
                    }
                    _ => String::new(),
                };
                let told = match is_known(&error) {
                    true => {
                        let error = in_percent(&error);
                        format!("Its error by the other half, which did not choose it, is {error}{beside}")
                    }
                    false => format!("But {half}"),
                };
                format!(
                    "{}, the cheapest of {settings} that reach an error of {} % by half of the maps is {}, in {} s. {told}.",
                    here(data),
                    number(percent(target)),
                    named(setting),
                    number(setting.time()),
                )
            }
            None => match data.most_accurate() {
                Some(setting) => {
                    let error = setting.rmse(Half::Telling);
                    let told = match is_known(&error) {
                        true => format!("its error by the other half is {}", in_percent(&error)),
                        false => half.to_string(),
                    };
                    format!(
                        "{}, of {settings} none reaches an error of {} % by half of the maps; the best is {}, and {told}.",
                        here(data),
                        number(percent(target)),
                        named(setting),
                    )
                }
                None => format!("{} no setting was measured.", here(data)),
            },
        };
        let main = data.point.places.iter().filter(|place| data.point.is_main(place)).count();
        let left_out = match main - data.usable() {
            0 => String::new(),
            count => format!(
                " Errors are of {} of the {main} places: of {count} the reference is not known well enough (below).",
                data.usable()
            ),
        };
        paragraphs.push(text + &left_out);
    }
    if all.len() > figures::MOST_SCENES {
        paragraphs.push(format!(
            "The first {} of {} scenes are told and drawn; all are in the tables and in results.csv.",
            figures::MOST_SCENES,
            all.len()
        ));
    }
    paragraphs
}

fn headlines(study: &OwnStudy, all: &[Data]) -> Vec<Headline> {
    // Names of LaTeX commands have letters alone: one scene has them.
    let [data] = all else { return Vec::new() };
    let chosen = data.cheapest(study.file.target).or_else(|| data.most_accurate());
    let Some(setting) = chosen.filter(|_| data.usable() > 0) else { return Vec::new() };
    let text = format!("error of {} photons read by {}", setting.photons, setting.estimator.name());
    vec![
        Headline::new("Error", &text, Unit::FRACTION, setting.rmse(Half::Telling)),
        Headline::new("Bias", &format!("bias part of the {text}"), Unit::FRACTION, setting.bias()),
    ]
}

/// The scene in tables.
fn label(data: &Data) -> String {
    if data.point.label.is_empty() { "the scene".to_string() } else { data.point.label.clone() }
}

/// Scene by scene: what reaches the target, and what each kind of gather does best.
fn answers(study: &OwnStudy, all: &[Data]) -> Table {
    let target = study.file.target;
    let mut rows = Vec::new();
    for data in all.iter().filter(|data| data.usable() > 0) {
        let mut row = |what: String, setting: &Setting| {
            let error = setting.rmse(Half::Telling);
            let needed = setting.photons_for(target).map(number).unwrap_or_default();
            rows.push(vec![
                label(data),
                what,
                setting.photons.to_string(),
                setting.estimator.name(),
                in_percent(&error),
                in_percent(&setting.bias()),
                in_percent(&setting.noise()),
                number(setting.time()),
                data.rival.as_ref().map(|r| number(r.time_to(error.value()))).unwrap_or_default(),
                needed,
            ]);
        };
        if let Some(setting) = data.cheapest(target) {
            row(format!("cheapest to {} %", number(percent(target))), setting);
        }
        for family in data.families() {
            if let Some(setting) = data.best(&family).last() {
                row(format!("best, {family}"), setting);
            }
        }
    }
    let columns = [
        "scene",
        "setting",
        "photons",
        "estimator",
        "RMS error",
        "bias",
        "noise",
        "CPU time [s]",
        "the reference's time [s]",
        "photons to the target",
    ];
    Table {
        caption: format!(
            "The setting that reaches {} % the cheapest, and the best size of each kind of gather at the most photons, chosen by \
             half of the maps and told by the other; bias and noise by all. CPU time is that of one map and all places, on this machine; \
             the reference's is that of its method to the same error. A bias of 0 is one whose square came out below 0. Photons to the target: of fixed radii, whose variance falls as one over them.",
            number(percent(target))
        ),
        columns: columns.map(String::from).to_vec(),
        rows,
    }
}

/// Fewest numbers of photons that an exponent is fitted to.
const FITTED: usize = 3;

/// How fast errors fall.
fn rates(all: &[Data]) -> Option<Table> {
    let mut rows = Vec::new();
    for data in all.iter().filter(|data| data.usable() > 0 && data.stored.len() >= FITTED) {
        for family in data.families() {
            let best = data.best(&family);
            let squares: Vec<Vec<f64>> = best.iter().map(|s| s.squares(Half::Telling)).collect();
            let maps = squares.iter().map(Vec::len).min().unwrap_or(0);
            let joined: Vec<Vec<f64>> =
                (0..maps).map(|map| squares.iter().map(|s| s[map]).collect()).collect();
            let floors: Vec<f64> = best.iter().map(|s| s.floor()).collect();
            let x: Vec<f64> = best.iter().map(|s| s.photons as f64).collect();
            let exponent = exponent_of_means(&x, &joined, &floors);
            let interval = exponent.interval(0.95);
            if exponent.value().is_finite() {
                let sizes: Vec<String> = best.iter().map(|s| number(words::size(s.estimator))).collect();
                rows.push(vec![
                    label(data),
                    family,
                    sizes.join(", "),
                    with_error(exponent.value(), exponent.std_error()),
                    format!("{} to {}", signed(interval.low, 2), signed(interval.high, 2)),
                ]);
            }
        }
    }
    let columns = ["scene", "gather", "best sizes", "exponent", "95 %"];
    (!rows.is_empty()).then(|| Table {
        caption: "Exponent of the mean squared error in the number of photons, at the best size for each. In the limit theory says −4/7 \
                  where a field bends, in a ball of the right radius; −1 is noise alone, 0 bias alone."
            .to_string(),
        columns: columns.map(String::from).to_vec(),
        rows,
    })
}

/// Measured against predicted bias of fixed radii.
fn predicted(all: &[Data], predictions: &[Prediction]) -> Option<Table> {
    let mut rows = Vec::new();
    for data in all {
        let most = data.stored.last().map_or(0, |(photons, _)| *photons);
        for setting in data.settings.iter().filter(|s| s.photons == most) {
            let case = words::case(data.point, setting.photons, setting.estimator);
            let own: Vec<&Prediction> = predictions.iter().filter(|p| p.case == case).collect();
            let (mut squares, mut biases, mut count) = (0.0, (0.0, 0.0), 0.0);
            for ((place, values), known) in data.point.places.iter().zip(&setting.values).zip(&data.known) {
                let Some(p) = own.iter().find(|p| p.quantity == place.name) else { continue };
                let moments: Moments = values.iter().collect();
                let z = (moments.mean() - p.value) / libm::hypot(moments.std_error(), p.error);
                if z.is_finite() && known.is_usable() {
                    squares += z * z;
                    biases.0 += (p.value / known.value - 1.0).powi(2);
                    biases.1 += (moments.mean() / known.value - 1.0).powi(2);
                    count += 1.0;
                }
            }
            if count > 0.0 {
                let root = |x: f64| format!("{} %", number(percent((x / count).sqrt())));
                rows.push(vec![
                    label(data),
                    setting.estimator.name(),
                    format!("{count}"),
                    root(biases.0),
                    root(biases.1),
                    number((squares / count).sqrt()),
                ]);
            }
        }
    }
    let columns = ["scene", "estimator", "places", "predicted bias", "measured", "residual z: RMS"];
    (!rows.is_empty()).then(|| Table {
        caption: "Bias of fixed radii at the most photons: root mean square over places as predicted before the run, and as measured (with \
                  its noise), and the distances of means over maps from the predictions in standard errors, expected 1 within their own \
                  spread: what theory leaves over."
            .to_string(),
        columns: columns.map(String::from).to_vec(),
        rows,
    })
}

/// What the maps are compared with.
fn references(all: &[Data]) -> Option<Table> {
    let mut rows = Vec::new();
    for data in all {
        let exact = data.known.iter().filter(|k| k.is_exact).count();
        let main = data.point.places.iter().zip(&data.known).filter(|(place, _)| data.point.is_main(place));
        let sampled: Vec<_> = main.map(|(_, known)| known).filter(|k| !k.is_exact && k.is_usable()).collect();
        let root = |values: Vec<f64>| {
            let n = values.len() as f64;
            (values.iter().map(|x| x * x).sum::<f64>() / n).sqrt()
        };
        let agreement: Vec<f64> = data
            .known
            .iter()
            .filter(|k| k.is_exact && k.sampled.1 > 0.0)
            .map(|k| (k.sampled.0 - k.value) / libm::hypot(k.sampled.1, k.error))
            .collect();
        let solved = data.reference.solved.as_ref().map_or("", |solved| solved.name);
        rows.push(vec![
            label(data),
            solved.to_string(),
            format!("{exact} of {}", data.known.len()),
            format!("{} x {}", super::reference::BATCHES, data.reference.samples),
            data.reference.sampler.name().to_string(),
            if sampled.is_empty() {
                String::new()
            } else {
                format!("{} %", number(percent(root(sampled.iter().map(|k| k.relative()).collect()))))
            },
            if agreement.is_empty() { String::new() } else { number(root(agreement)) },
        ]);
    }
    let columns =
        ["scene", "solved by", "exact places", "samples", "of", "their error", "against exact, z: RMS"];
    Some(Table {
        caption: "What the maps are compared with. Samples are those a place, a pixel of a picture, or photons of light tracing; where values are exact they are for comparison alone, and their distance from the exact \
                  values, in their standard errors, is expected to be about 1."
            .to_string(),
        columns: columns.map(String::from).to_vec(),
        rows,
    })
}

/// The first of some names.
fn first_names(names: &[&str]) -> String {
    let more = if names.len() > 10 { " and others" } else { "" };
    format!("{}{more}", names.iter().take(10).copied().collect::<Vec<_>>().join(", "))
}

fn notes(study: &OwnStudy, all: &[Data]) -> Vec<String> {
    let mut notes = vec![
        "One pass of photons fills the maps of a replicate, and all estimators read them at the same places. CPU times are of this \
         machine and stand in costs.csv; results.csv has the same bits on any number of threads."
            .to_string(),
    ];
    for data in all {
        let scene = label(data);
        if !data.point.left_out.is_empty() {
            notes.push(format!("{scene}: no map answers {}: left out.", data.point.left_out.join(", ")));
        }
        let unusable: Vec<&str> = data
            .point
            .places
            .iter()
            .zip(&data.known)
            .filter(|(_, known)| !known.is_usable() && !known.error.is_nan())
            .map(|(place, _)| place.name.as_str())
            .collect();
        if !unusable.is_empty() {
            notes.push(format!(
                "{scene}: the reference of {} of {} places is 0, or has an error of more than a fifth of it: they are not among the errors: \
                 {}.",
                unusable.len(),
                data.known.len(),
                first_names(&unusable)
            ));
        }
        let tailed = data.point.places.iter().zip(&data.known).filter(|(_, known)| known.sampled.1.is_nan());
        let tailed: Vec<&str> = tailed.map(|(place, _)| place.name.as_str()).collect();
        if !tailed.is_empty() {
            let sampler = data.reference.sampler;
            let few = match sampler {
                Sampler::Paths => format!(", or fewer than {FEWEST_PATHS} paths"),
                Sampler::Light => String::new(),
            };
            let has_bins = data.point.scene.sensors().iter().all(|sensor| sensor.binned().is_some());
            let other = match has_bins && sampler == Sampler::Paths {
                true => "; reference.with = \"light\" asks light tracing",
                false => "",
            };
            notes.push(format!(
                "{scene}: the samples of {} of {} places have no standard error, since rare large contributions carry them{few}: where the \
                 reference is no exact value, they are not among the errors: {}. A smaller reference.error or a larger reference.most \
                 takes more{other}.",
                tailed.len(),
                data.known.len(),
                first_names(&tailed)
            ));
        }
        if data.reference.is_cut && data.known.iter().any(|k| !k.is_exact) {
            notes.push(format!(
                "{scene}: the reference stops at reference.most samples, before the error of {} % that was asked for.",
                number(percent(study.file.reference.error))
            ));
        }
        let underfull = data.settings.iter().map(|s| s.underfull).fold(0.0, f64::max);
        if underfull > 0.0 {
            notes.push(format!(
                "{scene}: up to {} % of the estimates of a setting found fewer than k photons within max_radius, and used those.",
                number(percent(underfull))
            ));
        }
    }
    notes
}
