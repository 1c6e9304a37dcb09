//! The tables.

use super::cases::{FIELDS, Field, Setting, Treatment};
use super::choose::{Currency, best, break_even, cheapest, guided_rays, is_last, most_efficient, regret};
use super::data::{Data, Guided, Measured, Paths, mean};
use super::predict::{TARGETS, known_optimum};
use super::split::rms;
use crate::harness::{Estimate, Table, number, percent, with_error};
use crate::prediction::Predictions;
use crate::setups::Size;

/// Numbers of queries at which costs are shown.
pub const QUERIES: [f64; 4] = [1.0, 64.0, 4096.0, 1e6];

/// All tables.
pub fn all(data: &Data, known: &Predictions) -> anyhow::Result<Vec<Table>> {
    Ok(vec![
        prices(data, known)?,
        queries(data),
        regrets(data),
        counts(data),
        seconds(data),
        rivals(data),
        deviations(data),
    ])
}

fn table(caption: &str, columns: &[&str], rows: Vec<Vec<String>>) -> Table {
    let columns = columns.iter().map(|c| c.to_string()).collect();
    Table { caption: caption.to_string(), columns, rows }
}

/// A number to two digits, for costs.
fn rough(x: f64) -> String {
    let text = format!("{x:.1e}");
    number(text.parse().unwrap_or(x))
}

/// A setting without its field.
pub fn short(setting: &Setting) -> String {
    format!("{} photons, {}", setting.photons, setting.size.name())
}

/// The price list.
fn prices(data: &Data, known: &Predictions) -> anyhow::Result<Table> {
    let mut rows = Vec::new();
    for field in FIELDS {
        for treatment in Treatment::ALL {
            let cases = data.of(field, treatment, None);
            for target in TARGETS {
                let theory = known_optimum(known, field, treatment, target)?;
                let found = cheapest(&cases, target, |m| m.cost(4096.0));
                let (setting, error, cost) = match &found {
                    Some(c) => (short(&c.case.setting), c.rms.in_percent(), rough(c.case.cost(4096.0))),
                    None => {
                        let tried = best(&cases).map_or(String::new(), |b| {
                            let theory = b.case.predicted();
                            let (total, bias) = (percent(theory.total()), percent(theory.bias));
                            format!(
                                "best tried {} (predicted {total:.1}, bias {bias:.1})",
                                b.rms.in_percent()
                            )
                        });
                        ("none".to_string(), tried, String::new())
                    }
                };
                let by_paths = data.paths(field).map_or(f64::NAN, |p| 4096.0 * p.cost(target));
                rows.push(vec![
                    field.title.to_string(),
                    treatment.title().to_string(),
                    format!("{} %", number(percent(target))),
                    setting,
                    error,
                    cost,
                    format!("{:.3}", theory.radius),
                    rough(theory.density * field.setup.power() / field.setup.body.volume()),
                    rough(theory.cost),
                    rough(by_paths),
                ]);
            }
        }
    }
    let columns = [
        "fog",
        "at faces",
        "target",
        "cheapest setting",
        "its RMS error [%]",
        "operations",
        "theory: radius [mfp]",
        "photons per mfp³",
        "operations",
        "by paths",
    ];
    let caption = "The price list: what a root mean square error of 10, 3 and 1 per cent costs for 4096 queries, in \
                   operations (rays, records put into the tree, photons gathered). The cheapest of the measured \
                   settings was chosen on half of the maps, and its error is that of the other half. Where none \
                   reaches the target the lowest error of all tried stands there, with the predicted one and its bias, which more \
                   photons in balls of the same size leave: plain, it is what the faces take. Theory searched all radii for the \
                   cheapest, with as many photons as it takes (emitted photons per cubic mean free path of fog); \
                   the path tracer takes as many samples as its variance asks for.";
    Ok(table(caption, &columns, rows))
}

/// Cost against the number of queries.
fn queries(data: &Data) -> Table {
    let mut rows = Vec::new();
    for field in FIELDS {
        let Some(paths) = data.paths(field) else { continue };
        for treatment in Treatment::ALL {
            let cases = data.of(field, treatment, None);
            let Some(chosen) = most_efficient(&cases) else { continue };
            let error = chosen.rms.value();
            let even = |case, currency| {
                let queries = break_even(case, paths, currency).queries;
                queries.map_or("never".to_string(), |q| with_error(q.value(), q.std_error()))
            };
            let tenth = |currency| {
                cheapest(&cases, TARGETS[0], |m| m.cost(4096.0))
                    .map_or("none".to_string(), |c| even(c.case, currency))
            };
            let mut row = vec![
                field.title.to_string(),
                treatment.title().to_string(),
                short(&chosen.case.setting),
                chosen.rms.in_percent(),
                even(chosen.case, Currency::Operations),
                even(chosen.case, Currency::Seconds),
                tenth(Currency::Operations),
                tenth(Currency::Seconds),
            ];
            row.extend(QUERIES.map(|q| {
                let (map, by_paths) = (chosen.case.cost(q), q * paths.cost(error));
                format!("{} / {}", rough(map), rough(by_paths))
            }));
            rows.push(row);
        }
    }
    let columns = [
        "fog",
        "at faces",
        "most efficient setting",
        "its RMS error [%]",
        "break-even [queries]",
        "in seconds, on this machine",
        "break-even at 10 %",
        "in seconds",
        "Q = 1",
        "Q = 64",
        "Q = 4096",
        "Q = 1000000",
    ];
    let caption = "Operations for Q queries from the map, and by paths to the same error. The setting has the best \
                   figure of merit, the least squared error times cost of 4096 queries, of those with an \
                   error of at most a third. From the break-even on the map is the \
                   cheaper; it never is where a path query of that error takes fewer rays than the map gathers \
                   photons. At 10 per cent it is that of the cheapest setting which reaches it, if one does. Seconds \
                   weigh the operations as this machine does, and belong to it.";
    table(caption, &columns, rows)
}

/// What a fixed choice of k costs.
fn regrets(data: &Data) -> Table {
    let mut rows = Vec::new();
    for field in FIELDS {
        for treatment in Treatment::ALL {
            let cases = data.of(field, treatment, Some(data.largest(field)));
            let Some(best) = best(&cases) else { continue };
            let is_last = is_last(best.case, &cases);
            let regret_of = |k: usize| {
                let found = cases.iter().find(|c| c.setting.size == Size::Nearest(k));
                found.map_or(String::new(), |case| {
                    let value = regret(case, &cases);
                    let text = with_error(value.value(), value.std_error());
                    if is_last { format!("at least {text}") } else { text }
                })
            };
            rows.push(vec![
                field.title.to_string(),
                treatment.title().to_string(),
                best.case.setting.photons.to_string(),
                best.case.setting.size.name(),
                if is_last { format!("at most {}", best.rms.in_percent()) } else { best.rms.in_percent() },
                regret_of(50),
                regret_of(100),
            ]);
        }
    }
    let columns = [
        "fog",
        "at faces",
        "photons",
        "best gather",
        "its RMS error [%]",
        "k = 50 over best",
        "k = 100 over best",
    ];
    let caption = "Regret: the root mean square error with 50 and 100 neighbours over that of the best gather for the \
                   same photons, each half of the maps with the gather that the other half chose. At least and at most stand where \
                   the best gather is the largest tried.";
    table(caption, &columns, rows)
}

/// Costs apart, in counts.
fn counts(data: &Data) -> Table {
    let row = |size: &super::data::MapSize| {
        let gather = |wanted: Size| {
            let cases = data.of(size.field, Treatment::Plain, Some(size.photons));
            let found = cases.iter().find(|c| c.setting.size == wanted);
            found.map_or(String::new(), |c| number(mean(&c.found)))
        };
        let paths = data.paths(size.field);
        let volume = size.field.setup.body.volume();
        vec![
            size.field.title.to_string(),
            size.photons.to_string(),
            number(size.photons as f64 / volume),
            number(mean(&size.stored) / volume),
            rough(mean(&size.rays)),
            rough(mean(&size.collisions)),
            number((mean(&size.bytes) / 1e6 * 1e3).round() / 1e3),
            gather(Size::Radius(0.2)),
            gather(Size::Nearest(50)),
            paths.map_or(String::new(), |p| number(mean(&p.rays))),
            paths.map_or(String::new(), |p| number(mean(&p.variance))),
        ]
    };
    let columns = [
        "fog",
        "photons",
        "emitted per mfp³",
        "stored per mfp³",
        "rays",
        "records",
        "memory [MB]",
        "gathered, r=0.2",
        "gathered, k=50",
        "rays of a path sample",
        "its relative variance",
    ];
    let caption = "Costs apart, by counts that do not depend on the machine: rays that photons follow and records put \
                   into the tree for one map, its memory, photons gathered for a query, and for one sample of the path \
                   tracer its rays and the relative variance that says how many samples an error takes.";
    table(caption, &columns, data.sizes.iter().map(row).collect())
}

/// The same in seconds.
fn seconds(data: &Data) -> Table {
    let row = |size: &super::data::MapSize| {
        let query = |wanted: Size| {
            let cases = data.of(size.field, Treatment::Plain, Some(size.photons));
            let found = cases.iter().find(|c| c.setting.size == wanted);
            found.map_or(String::new(), |c| format!("{:.2}", 1e6 * mean(&c.query_seconds)))
        };
        let [shooting, building] = [mean(&size.seconds[0]), mean(&size.seconds[1])];
        vec![
            size.field.title.to_string(),
            size.photons.to_string(),
            format!("{:.2}", 1e3 * shooting),
            format!("{:.2}", 1e3 * building),
            query(Size::Radius(0.2)),
            query(Size::Nearest(50)),
            data.paths(size.field).map_or(String::new(), |p| format!("{:.2}", 1e6 * mean(&p.seconds))),
        ]
    };
    let columns = [
        "fog",
        "photons",
        "shooting [ms]",
        "building [ms]",
        "query, r=0.2 [µs]",
        "query, k=50 [µs]",
        "path sample [µs]",
    ];
    let caption = "The same in CPU time on this machine, one thread: seconds are no results, and another machine has \
                   others. Building is charged for the photons of the cell alone, without the copies across its edges \
                   that the study needs.";
    table(caption, &columns, data.sizes.iter().map(row).collect())
}

/// Guided paths beside those that nothing leads.
fn rivals(data: &Data) -> Table {
    let row = |(guided, paths): (&Guided, &Paths)| {
        let ratio = guided_rays(&guided.paths, paths);
        vec![
            paths.field.title.to_string(),
            format!("{:.0}", percent(mean(&guided.led))),
            format!("{:.0}", percent(mean(&guided.flights))),
            number(mean(&paths.variance)),
            number(mean(&guided.paths.variance)),
            number(mean(&paths.rays)),
            number(mean(&guided.paths.rays)),
            with_error(ratio.value(), ratio.std_error()),
            format!("{:.2}", 1e6 * mean(&paths.seconds)),
            format!("{:.2}", 1e6 * mean(&guided.paths.seconds)),
            format!("{:.0}", 1e3 * mean(&guided.learning)),
        ]
    };
    let columns = [
        "fog",
        "cells led [%]",
        "flights led [%]",
        "relative variance of a path sample",
        "of a guided one",
        "rays of a path sample",
        "of a guided one",
        "rays to the same error, guided over not",
        "path sample [µs]",
        "guided one [µs]",
        "learning [ms]",
    ];
    let caption = "The best that paths can do: paths led by photons, in direction in the cells of fog where that gains a fifth of the second \
                   moment or more, in distance where it gains two fifths, beside paths that nothing leads. A flight that is led takes \
                   longer, which rays do not tell and times do. Learning is paid for once, as a map is.";
    table(caption, &columns, data.guided.iter().zip(&data.paths).map(row).collect())
}

/// Standard errors from which a measured error is listed as off its prediction.
const OFF: f64 = 4.0;

/// Every case whose measured error is off its prediction.
pub fn off(data: &Data) -> Vec<(&Measured, Estimate, f64)> {
    let all = data.measured.iter().map(|m| (m, rms(&m.maps), m.predicted().total()));
    all.filter(|(_, found, theory)| (found.value() - theory).abs() > OFF * found.std_error()).collect()
}

/// The list of them.
fn deviations(data: &Data) -> Table {
    let row = |(m, found, theory): (&Measured, Estimate, f64)| {
        vec![
            m.case(),
            found.in_percent(),
            format!("{:.2}", percent(theory)),
            format!("{:.3}", found.value() / theory),
            format!("{:.1}", (found.value() - theory) / found.std_error()),
        ]
    };
    let columns = ["case", "RMS error [%]", "predicted [%]", "measured over predicted", "standard errors"];
    let caption = format!(
        "Every setting whose measured root mean square error is more than {OFF} standard errors from the predicted \
         one, of {} settings, untreated and clipped.",
        data.measured.len()
    );
    table(&caption, &columns, off(data).into_iter().map(row).collect())
}

/// The smallest error of all settings of a field.
pub fn best_error(data: &Data, field: &Field, treatment: Treatment) -> Option<Estimate> {
    best(&data.of(field, treatment, None)).map(|choice| choice.rms)
}
