//! What all cells together say.

use super::cases::{LARGEST, MAPS, PILOT, Selector, TARGETS, THUMB, advised, all, name};
use super::fields::Field;
use super::figures;
use super::predict::Expected;
use super::results::{Advised, Choice, worst};
use crate::harness::{
    Cells, Claim, Estimate, Headline, Parameters, Row, Section, Settings, Table, Unit, number, signed,
    with_error,
};
use crate::prediction::{Entry, Prediction, Term};
use turbid::estimators::Kernel;

/// The interval test promises so much: what it chooses agrees with the best radius, as long as it is not stopped short of it, within five
/// standard deviations of that one's noise, and the best radius errs by its own error.
const PROMISE: f64 = 6.0;
/// What a selector may cost where the field is as smooth as it takes it to be: an error of half as much again.
const SMOOTH: f64 = 1.5;
/// What half the best radius costs at most where nothing bends: the root of 2^3. An interval test that nothing stops ends at the largest
/// radius, and is halved.
const HALVED: f64 = 2.0 * std::f64::consts::SQRT_2;
/// How far mean squared errors at the best radius may lie from theory: a tenth of the root, a fifth of the smallest regret that claims call
/// one.
const THEORY: f64 = 0.2;

/// Concludes.
pub fn conclude(settings: &Settings, _: &[Prediction], cells: &Cells) -> anyhow::Result<Section> {
    let mut choices = Vec::new();
    for case in all(settings) {
        choices.extend(Choice::all(cells, case)?);
    }
    let mut advice = Vec::new();
    for field in [Field::Places, Field::Light] {
        for target in TARGETS {
            advice.push(Advised::new(cells, field, target)?);
        }
    }
    Ok(Section {
        summary: summary(&choices, &advice),
        claims: claims(&choices),
        figures: vec![figures::selection(&choices)?],
        tables: vec![regrets(&choices), radii(&choices), of_advice(&advice)],
        notes: notes(),
        rows: rows(&choices, &advice)?,
        budget: entries(&choices)?,
        headlines: headlines(&choices),
        ..Section::default()
    })
}

/// What does not depend on the photons has a predicted error.
fn entries(choices: &[Choice]) -> anyhow::Result<Vec<Entry>> {
    let fixed = choices.iter().filter(|c| c.selector.is_fixed());
    let entry = |c: &Choice| {
        let radius = if c.selector == Selector::Fixed { THUMB } else { c.best.radius };
        let blur = Expected::new(c.field, c.photons, radius)?.blur;
        let group = format!("selection-{}-n{}", c.field.source().name(), c.photons);
        Ok(Entry::new(
            group,
            name(c.field, c.photons, c.selector),
            &[(Term::Blur, blur)],
            1e-9,
            c.errors.clone(),
        ))
    };
    fixed.map(entry).collect()
}

fn place(choice: &Choice) -> String {
    format!("{}, {} photons", choice.field.title(), choice.photons)
}

fn claims(choices: &[Choice]) -> Vec<Claim> {
    let mut claims = Vec::new();
    for field in Field::ALL {
        let own = choices.iter().filter(|c| c.field == field && c.selector == Selector::Oracle);
        let Some(mean) = Estimate::average(&own.map(Choice::squared).collect::<Vec<_>>()) else { continue };
        let text = format!(
            "{}, best radius: mean squared error over the predicted one, mean of all numbers of photons",
            field.title()
        );
        claims.push(Claim::about(&format!("theory-{}", field.name()), &text, Unit::ONE, mean, 1.0, THEORY));
    }
    if let Some(choice) = worst(choices, Selector::Iterated, Field::is_smooth) {
        let text = format!(
            "plug-in, iterated, smooth fields: largest root mean square error over that of the best radius ({})",
            place(choice)
        );
        claims.push(Claim::at_most("smooth-iterated", &text, Unit::ONE, choice.regret(), SMOOTH));
    }
    if let Some(choice) = worst(choices, Selector::Interval, Field::is_smooth) {
        let text = format!(
            "interval test, smooth fields: largest root mean square error over that of the best radius ({}), where halving costs the root of 2^c in \
             noise",
            place(choice)
        );
        let claim = Claim::at_most("smooth-interval", &text, Unit::ONE, choice.regret(), HALVED);
        claims.push(claim.chosen_after("margin", &[100]));
    }
    if let Some(choice) = worst(choices, Selector::Interval, |_| true) {
        let text = format!(
            "interval test, all fields: largest root mean square error over that of the best radius ({})",
            place(choice)
        );
        claims.push(Claim::at_most("interval-promise", &text, Unit::ONE, choice.regret(), PROMISE));
    }
    if let Some(choice) = worst(choices, Selector::PlugIn, |field| field == Field::Dip) {
        let text = format!(
            "plug-in from {LARGEST} mfp, caught by its first radius ({}): error over that of the best radius",
            place(choice)
        );
        let claim = Claim::at_least("plug-in-caught", &text, Unit::ONE, choice.regret(), SMOOTH);
        claims.push(claim.chosen_after("width of the dip", &[100]));
    }
    for selector in [Selector::Nearest(50), Selector::Fixed] {
        if let Some(choice) = worst(choices, selector, Field::is_smooth) {
            let text = format!(
                "{}, smooth fields: largest root mean square error over that of the best radius ({})",
                selector.title(),
                place(choice)
            );
            let id = format!("thumb-{}", selector.name().replace('=', "-"));
            claims.push(Claim::at_least(&id, &text, Unit::ONE, choice.regret(), SMOOTH));
        }
    }
    let whole = choices.iter().filter(|c| c.selector == Selector::Whole && c.field.is_smooth());
    if let Some(mean) = Estimate::average(&whole.map(Choice::regret).collect::<Vec<_>>()) {
        let text = "wrong on purpose, the last radius of the interval test not halved: mean over smooth fields of the error over that of \
                    the best radius";
        claims.push(Claim::detected("whole-is-too-wide", text, Unit::ONE, mean, 1.0, SMOOTH - 1.0));
    }
    claims
}

fn rows(choices: &[Choice], advice: &[Advised]) -> anyhow::Result<Vec<Row>> {
    let mut rows = Vec::new();
    for choice in choices {
        let name = name(choice.field, choice.photons, choice.selector);
        let asked = Parameters {
            field: Some(choice.field.name()),
            photons: Some(choice.photons),
            kernel: Some(Kernel::Uniform),
            ..Parameters::default()
        };
        let error = Row::measured(&name, "error", Unit::ONE, &choice.errors.iter().collect())?;
        rows.push(error.with(asked));
        rows.push(Row::estimated(&name, "regret", Unit::ONE, &choice.regret())?.with(asked));
        if choice.octaves.n() > 0 && choice.octaves.std_error() > 0.0 {
            let octaves = Row::measured(&name, "octaves from the best radius", Unit::ONE, &choice.octaves)?;
            rows.push(octaves.with(asked));
        }
    }
    for a in advice {
        let name = advised(a.field, a.target);
        let asked = Parameters { field: Some(a.field.name()), ..Parameters::default() };
        if a.squared.std_error() > 0.0 {
            rows.push(Row::estimated(&name, "regret", Unit::ONE, &a.regret())?.with(asked));
            rows.push(Row::measured(&name, "error over target", Unit::ONE, &a.error)?.with(asked));
        }
    }
    Ok(rows)
}

/// The selectors of tables: all but the oracle.
fn shown() -> impl Iterator<Item = Selector> {
    Selector::ALL.into_iter().filter(|s| *s != Selector::Oracle)
}

fn table(
    choices: &[Choice],
    caption: &str,
    of: impl Fn(&Choice) -> String,
    first: impl Fn(&Choice) -> String,
    label: &str,
) -> Table {
    let mut columns = vec!["field".to_string(), "photons".to_string(), label.to_string()];
    columns.extend(shown().map(Selector::title));
    let row = |oracle: &Choice| {
        let mut row = vec![oracle.field.title().to_string(), oracle.photons.to_string(), first(oracle)];
        let own = |selector: Selector| {
            let mut own = choices.iter().filter(|c| c.field == oracle.field && c.photons == oracle.photons);
            own.find(|c| c.selector == selector).map(&of).unwrap_or_default()
        };
        row.extend(shown().map(own));
        row
    };
    let oracles = choices.iter().filter(|c| c.selector == Selector::Oracle);
    Table { caption: caption.to_string(), columns, rows: oracles.map(row).collect() }
}

fn regrets(choices: &[Choice]) -> Table {
    let caption = "Root mean square error over that of the best radius, with its standard error over cells, for each selector, and the error of the \
                   best radius itself, predicted, relative to the exact value. There is no gather of the nearest photons along rays.";
    let of = |c: &Choice| with_error(c.regret().value(), c.regret().std_error());
    let first = |c: &Choice| number(100.0 * c.best.squared.sqrt());
    table(choices, caption, of, first, "error at the best radius [%]")
}

fn radii(choices: &[Choice]) -> Table {
    let caption = "The best radius, and the geometric mean of those that are chosen, over the best.";
    let of = |c: &Choice| match c.selector {
        Selector::Nearest(_) => String::new(),
        _ => signed(libm::exp2(c.octaves.mean()), 2),
    };
    table(choices, caption, of, |c| number(c.best.radius), "best radius [mfp]")
}

fn of_advice(advice: &[Advised]) -> Table {
    let row = |a: &Advised| {
        let of = |m: &turbid::stats::Moments| with_error(m.mean(), m.std_error());
        let regret = a.regret();
        vec![
            a.field.title().to_string(),
            number(100.0 * a.target),
            of(&a.photons),
            with_error(regret.value(), regret.std_error()),
            of(&a.error),
        ]
    };
    let columns =
        ["field", "error asked for [%]", "photons advised", "regret", "exact error over that asked for"];
    Table {
        caption: format!(
            "What `advise` says from pilots of {} independent maps of {PILOT} photons: how many photons, the error of its radius over that of the \
             best radius with as many photons (root mean square over pilots), and the exact root mean square error of a map by its advice over what \
             was asked for, with standard errors over pilots.",
            MAPS
        ),
        columns: columns.map(String::from).to_vec(),
        rows: advice.iter().map(row).collect(),
    }
}

/// The largest regret of a selector on some fields, in words.
fn words(choices: &[Choice], selector: Selector, is_in: impl Fn(Field) -> bool) -> String {
    worst(choices, selector, is_in).map_or_else(String::new, |c| {
        format!("{} ({})", with_error(c.regret().value(), c.regret().std_error()), place(c))
    })
}

fn summary(choices: &[Choice], advice: &[Advised]) -> Vec<String> {
    let of = |selector: Selector| words(choices, selector, |_| true);
    let smooth = |selector: Selector| words(choices, selector, Field::is_smooth);
    let of_advice = |field: Field| {
        let own = advice.iter().filter(|a| a.field == field).map(Advised::regret);
        let worst = own.max_by(|a, b| a.value().total_cmp(&b.value()));
        worst.map_or_else(String::new, |e| with_error(e.value(), e.std_error()))
    };
    vec![
        format!(
            "Over all fields, what the interval test chooses has at most {} times the error of the best radius; what the iterated plug-in rule \
             chooses {}, and without iteration {}.",
            of(Selector::Interval),
            of(Selector::Iterated),
            of(Selector::PlugIn)
        ),
        format!(
            "In smooth fields the iterated plug-in rule costs at most {}, the interval test {}: where the largest radius holds few more than the 30 \
             photons that the test starts from, nothing stops it, and half that radius is too small.",
            smooth(Selector::Iterated),
            smooth(Selector::Interval)
        ),
        format!(
            "Rules of thumb cost up to {} with the 50 nearest photons, {} with the 100 nearest, {} with a radius of {THUMB} mean free paths.",
            of(Selector::Nearest(50)),
            of(Selector::Nearest(100)),
            of(Selector::Fixed)
        ),
        format!(
            "The simulator's own advice, from independent pilot maps, costs at most {} in the exponential and {} near the point light.",
            of_advice(Field::Places),
            of_advice(Field::Light)
        ),
    ]
}

fn headlines(choices: &[Choice]) -> Vec<Headline> {
    let of = |name: &str, text: &str, selector| {
        worst(choices, selector, |_| true).map(|c| Headline::new(name, text, Unit::ONE, c.regret()))
    };
    [
        of("Interval", "largest error of the interval test over that of the best radius", Selector::Interval),
        of(
            "Iterated",
            "largest error of the iterated plug-in rule over that of the best radius",
            Selector::Iterated,
        ),
    ]
    .into_iter()
    .flatten()
    .collect()
}

fn notes() -> Vec<String> {
    vec![
        format!(
            "The exponential is the uncollided light of \"dimension\", from real passes, and so are the face, 0.1 mean free paths below which half \
             of a large ball holds no medium, and the point light, about which the field has no bend of second order that holds as far as a ball \
             reaches; the dip is a trough of a wave of amplitude 0.8 and length 2/3 mean free paths among independent points. No history brings two \
             photons here; where it does, all variances that a selector uses must be multiplied by one plus the clustering. All selectors look at \
             radii up to {LARGEST} mean free paths, with the uniform kernel, one question at a time, and know the number of photons and what one \
             brings. Regret is the root mean square error of what they then read from the same photons, over that of the best fixed radius; it may be below 1, since a radius that follows the photons is another one at every question."
        ),
        "Plug-in: the bend is the difference of two estimates, of radii in the ratio of the root of 2, not taken for less than its own noise, put into the \
         formula of the best radius; as Kaplanyan and Dachsbacher 2013 (\"Adaptive progressive photon mapping\") set radii from the data so far. Iterated: \
         again from twice the radius found, five times more."
            .to_string(),
        "Interval test: radii in the ratio 2^(1/4) upwards from 30 photons, as long as the estimate differs from that of every smaller one by less than \
         five standard deviations of their difference; half the last one. After Lepski 1991; Goldenshluger and Lepski 2011 (\"Bandwidth selection in \
         kernel density estimation: oracle inequalities and adaptive minimax optimality\")."
            .to_string(),
        "`advise` chooses a radius for an error and says how many photons it takes, from independent maps; its regret is exact, with as many photons as it \
         advises. It never reaches beyond a mean free path, a face, or half way to a point light, and asks for a hundred photons in the largest \
         ball: next to the face it refuses pilots of this size."
            .to_string(),
    ]
}
