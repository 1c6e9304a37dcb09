//! All scenes together: figure, table, sentences.

use crate::cost_model::{LOOKED_AT, STORED};
use crate::harness::{
    Answer, Estimate, FigureFiles, Headline, Point, QUERIES, Reached, Section, SectionReport, Settings,
    TARGETS, Table, Unit, Untreated, number, percent, with_rough_error,
};
use std::cmp::Ordering;
use turbid_figure::{Axis, Figure, Line, Panel, Points, Width};

/// The targets that the sentences are about.
const MIDDLE: usize = 1;
const LAST: usize = TARGETS.len() - 1;
/// Panels of the figure in a row.
const COLUMNS: usize = 3;

/// Concludes; without a scene, in one line.
pub fn conclude(_settings: &Settings, sections: &[SectionReport]) -> anyhow::Result<Section> {
    let answers: Vec<&Answer> = sections.iter().flat_map(|s| &s.section.answers).collect();
    if answers.is_empty() {
        let why = "Left out: no experiment of this run races photon maps against paths.";
        return Ok(Section { summary: vec![why.to_string()], ..Section::default() });
    }
    Ok(Section {
        summary: summary(&answers),
        figures: vec![figure(&answers)?],
        tables: vec![table(&answers)],
        headlines: headlines(&answers),
        ..Section::default()
    })
}

/// "12.3 ± 0.4".
fn times(speed: &Estimate) -> String {
    with_rough_error(speed.value(), speed.std_error())
}

/// "1.2 ± 0.1 %"; what came out at or below 0 has an upper end alone.
fn in_percent(fraction: &Estimate) -> String {
    if fraction.value() <= 0.0 {
        let tenths = (10.0 * percent(fraction.interval(0.95).high)).ceil();
        return format!("below {} %", number(tenths / 10.0));
    }
    format!("{} %", with_rough_error(percent(fraction.value()), percent(fraction.std_error())))
}

/// Whether a speed is below 1, above it, or neither by its 95 per cent interval.
fn against_one(speed: &Estimate) -> Ordering {
    match speed.interval(0.95) {
        i if i.high < 1.0 => Ordering::Less,
        i if i.low > 1.0 => Ordering::Greater,
        _ => Ordering::Equal,
    }
}

fn summary(answers: &[&Answer]) -> Vec<String> {
    let mut summary = Vec::new();
    let per_cent = |index: usize| number(percent(TARGETS[index]));
    let reached = || answers.iter().filter_map(|a| Some((a.scene.as_str(), a.reached[MIDDLE].as_ref()?)));
    let by = |(_, a): &(&str, &Estimate), (_, b): &(&str, &Estimate)| a.value().total_cmp(&b.value());
    let speeds = || reached().map(|(scene, r)| (scene, &r.time));
    if let (Some((slow, least)), Some((fast, most))) = (speeds().min_by(by), speeds().max_by(by)) {
        let queries = || reached().filter_map(|(scene, r)| Some((scene, r.pays_from.as_ref()?)));
        let pays = match (queries().min_by(by), queries().max_by(by)) {
            (Some((_, few)), Some((_, many))) => format!(
                "; with fewer than {} to {} queries of one map, depending on the scene, paths are the faster",
                times(few),
                times(many)
            ),
            _ => String::new(),
        };
        summary.push(format!(
            "Speed: for {QUERIES} queries with an error of {} %, turbid's path tracer takes {} times ({slow}) to {} times ({fast}) \
             as long as the fastest photon map{pays}.",
            per_cent(MIDDLE),
            times(least),
            times(most),
        ));
    }
    let untreated: Vec<&Untreated> = answers.iter().filter_map(|a| a.untreated.as_ref()).collect();
    if let (Some((low, high)), Some((least, most))) =
        (range(reached().map(|r| &r.1.bias)), range(untreated.iter().map(|u| &u.error)))
    {
        let by_faces = untreated.iter().filter(|u| u.limit == "faces").count();
        summary.push(format!(
            "Accuracy: the bias of those maps is {} to {}. With the faces of the medium untreated, the best map tried keeps an \
             error of {} to {}, mostly from the faces, where half of each ball is empty, in {by_faces} of {} scenes.",
            in_percent(low),
            in_percent(high),
            in_percent(least),
            in_percent(most),
            untreated.len(),
        ));
    }
    let scenes = |index: usize, what: &str, test: &dyn Fn(Option<&Reached>) -> bool| {
        let chosen = answers.iter().filter(|a| test(a.reached[index].as_ref()));
        let found: Vec<&str> = chosen.map(|a| a.scene.as_str()).collect();
        match found.len() {
            0 => None,
            n if n > 3 => Some(format!("{what} in {n}")),
            n => Some(format!("{what} in {n} ({})", found.join("; "))),
        }
    };
    let lost = |index: usize| {
        let is = |order| move |r: Option<&Reached>| r.is_some_and(|r| against_one(&r.time) == order);
        let faster = scenes(index, "paths are the faster", &is(Ordering::Less));
        let level = scenes(index, "neither is clearly the faster", &is(Ordering::Equal));
        let never = scenes(index, "no map tried gets there", &|r| r.is_none());
        let all: Vec<String> = faster.into_iter().chain(level).chain(never).collect();
        let all = if all.is_empty() { "nowhere".to_string() } else { all.join(", ") };
        format!("at {} % {all}", per_cent(index))
    };
    summary.push(format!("Where maps lose, of {} scenes: {}; {}.", answers.len(), lost(MIDDLE), lost(LAST)));
    summary
}

/// The numbers of the sentences.
fn headlines(answers: &[&Answer]) -> Vec<Headline> {
    let reached = || answers.iter().filter_map(|a| a.reached[MIDDLE].as_ref());
    let untreated = range(answers.iter().filter_map(|a| a.untreated.as_ref().map(|u| &u.error)));
    let text = "the fastest photon map with an error of 10 %, over scenes";
    let mut headlines = Vec::new();
    for (names, what, unit, found) in [
        (["SpeedLeast", "SpeedMost"], "times as fast as paths", Unit::ONE, range(reached().map(|r| &r.time))),
        (["BiasLeast", "BiasMost"], "its bias", Unit::FRACTION, range(reached().map(|r| &r.bias))),
        (["UntreatedLeast", "UntreatedMost"], "best error, faces untreated", Unit::FRACTION, untreated),
    ] {
        for (name, (end, estimate)) in names
            .into_iter()
            .zip(found.into_iter().flat_map(|(least, most)| [("least", least), ("most", most)]))
        {
            headlines.push(Headline::new(name, &format!("{text}: {what}, {end}"), unit, *estimate));
        }
    }
    headlines
}

/// The smallest and the largest.
fn range<'a>(estimates: impl Iterator<Item = &'a Estimate>) -> Option<(&'a Estimate, &'a Estimate)> {
    let mut sorted: Vec<&Estimate> = estimates.collect();
    sorted.sort_by(|a, b| a.value().total_cmp(&b.value()));
    Some((sorted.first().copied()?, sorted.last().copied()?))
}

fn table(answers: &[&Answer]) -> Table {
    let mut columns = vec!["scene".to_string()];
    columns.extend(TARGETS.map(|target| format!("error {} %", number(percent(target)))));
    columns.push("untreated, best".to_string());
    let cell = |reached: &Option<Reached>| match reached {
        None => "none".to_string(),
        Some(r) => format!(
            "{} ×\n{}work {} ×\nbias {}\n{}",
            times(&r.time),
            r.pays_from.as_ref().map_or(String::new(), |q| format!("from {} queries\n", times(q))),
            times(&r.work),
            in_percent(&r.bias),
            r.limit
        ),
    };
    let row = |answer: &&Answer| {
        let mut row = vec![answer.scene.clone()];
        row.extend(answer.reached.iter().map(cell));
        row.push(
            answer
                .untreated
                .as_ref()
                .map_or(String::new(), |u| format!("{}\n{}", in_percent(&u.error), u.limit)),
        );
        row
    };
    Table {
        caption: format!(
            "How many times as long turbid's path tracer takes to a root mean square error as the fastest photon map that reaches \
             it, in CPU time of this machine, for {QUERIES} queries of one map, its filling included; in the box of fog for a \
             picture. Then the number of queries from which that map pays; the same ratio for the map of the least work, counted in \
             rays, where a photon stored counts {STORED} and one in an estimate {LOOKED_AT}: the same on every machine; the bias of \
             the fastest map, and the largest part of its error. None: no map of the sizes tried reaches the error. Last, the \
             smallest error with the faces of the medium untreated. The map holds all light, that which comes straight from the \
             source too; the albedo is 0.99 in the slabs of τ = 8 and 0.9 in the others. Settings are chosen by the errors of one half of \
             the maps, and untreated ones judged by the other."
        ),
        columns,
        rows: answers.iter().map(row).collect(),
    }
}

fn figure(answers: &[&Answer]) -> anyhow::Result<FigureFiles> {
    let mut panels = Vec::new();
    for answer in answers {
        let Some(curves) = &answer.curves else { continue };
        let x = Axis::log("CPU time", "s");
        let y = Axis::log("RMS error", "%").with_range(1.0, 100.0);
        let (seconds, errors) = curves.paths.iter().map(|&(t, e)| (t, percent(e))).unzip();
        let mut panel = Panel::new(x, y).with_title(answer.scene.clone());
        panel = panel.with(Line::theory("path tracer", seconds, errors));
        for (class, label, points) in [
            (0, "photon map, faces untreated", &curves.untreated),
            (1, "photon map, faces treated", &curves.maps),
        ] {
            if points.is_empty() {
                continue;
            }
            let x: Vec<f64> = points.iter().map(|p| p.seconds).collect();
            let y: Vec<f64> = points.iter().map(|p| percent(p.error)).collect();
            let bars =
                points.iter().map(|p: &Point| (percent(p.interval.0), percent(p.interval.1))).collect();
            panel = panel.with(Line::new(label, class, x.clone(), y.clone()));
            panel = panel.with(Points::new(label, class, x, y).with_y_interval(bars));
        }
        panels.push(panel);
    }
    let figure =
        Figure { width: Width::Double, columns: COLUMNS, shared_legend: true, ..Figure::new(panels) };
    let caption = format!(
        "Error against CPU time of one thread, for {QUERIES} queries (the box of fog: a picture): those of the photon maps tried \
         that no other map beats in both (points, 95 % intervals), and turbid's path tracer. Left of the black line the map is the \
         faster. A larger map costs more and has a smaller error, down to its bias; at untreated faces that is soon reached."
    );
    FigureFiles::draw("time", &caption, &figure)
}
