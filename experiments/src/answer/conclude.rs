//! All scenes together: figure, table, sentences.

use crate::harness::{
    Answer, Estimate, FigureFiles, Headline, Point, Reached, Section, SectionReport, Settings, TARGETS,
    Table, Unit, number, percent, with_rough_error,
};
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

/// "1.2 ± 0.1 %".
fn in_percent(fraction: &Estimate) -> String {
    format!("{} %", with_rough_error(percent(fraction.value()), percent(fraction.std_error())))
}

fn summary(answers: &[&Answer]) -> Vec<String> {
    let mut summary = Vec::new();
    let per_cent = |index: usize| number(percent(TARGETS[index]));
    let mut reached: Vec<(&str, &Reached)> =
        answers.iter().filter_map(|a| Some((a.scene.as_str(), a.reached[MIDDLE].as_ref()?))).collect();
    reached.sort_by(|a, b| a.1.time.value().total_cmp(&b.1.time.value()));
    if let (Some((slow, least)), Some((fast, most))) = (reached.first(), reached.last()) {
        summary.push(format!(
            "Speed: to an error of {} %, the cheapest photon map is {} times ({slow}) to {} times ({fast}) as fast as a path \
             tracer.",
            per_cent(MIDDLE),
            times(&least.time),
            times(&most.time),
        ));
    }
    let untreated = range(answers.iter().filter_map(|a| a.untreated.as_ref().map(|u| &u.error)));
    if let (Some((low, high)), Some((least, most))) = (range(reached.iter().map(|r| &r.1.bias)), untreated) {
        summary.push(format!(
            "Accuracy: the bias of those maps is {} to {}. With the faces of the medium untreated, as in 1998, the best of all \
             maps tried keeps an error of {} to {}, since half of each ball is empty at a face.",
            in_percent(low),
            in_percent(high),
            in_percent(least),
            in_percent(most)
        ));
    }
    let is_slower = |r: &Reached| r.time.value() < 1.0;
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
        let faster = scenes(index, "paths are faster", &|r| r.is_some_and(is_slower));
        let less_work = scenes(index, "paths take fewer operations, though more time,", &|r| {
            r.is_some_and(|r| r.work.value() < 1.0 && !is_slower(r))
        });
        let never = scenes(index, "no map tried gets there", &|r| r.is_none());
        let all: Vec<String> = faster.into_iter().chain(less_work).chain(never).collect();
        let all = if all.is_empty() { "nowhere".to_string() } else { all.join(", and ") };
        format!("at {} % {all}", per_cent(index))
    };
    summary.push(format!("Where maps lose, of {} scenes: {}; {}.", answers.len(), lost(MIDDLE), lost(LAST)));
    summary
}

/// The numbers of the sentences.
fn headlines(answers: &[&Answer]) -> Vec<Headline> {
    let reached = || answers.iter().filter_map(|a| a.reached[MIDDLE].as_ref());
    let untreated = range(answers.iter().filter_map(|a| a.untreated.as_ref().map(|u| &u.error)));
    let text = "the cheapest photon map with an error of 10 %, over scenes";
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
            "{} ×\nwork {} ×\nbias {}\n{}",
            times(&r.time),
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
        caption: "How many times as fast as a path tracer of the same root mean square error the cheapest photon map is that \
                  reaches the error, with all that it costs: in CPU time of this machine (first line), and in operations, \
                  which are the same on every machine; below 1 paths win. Then its bias and the largest part of its error. \
                  None: no map of the sizes tried reaches it. Last, the smallest error with the faces of the medium untreated, as in \
                  1998, and what limits it. Settings are chosen on one half of the maps and judged on the other."
            .to_string(),
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
        for (class, label, points) in
            [(0, "photon map of 1998, faces untreated", &curves.untreated), (1, "photon map", &curves.maps)]
        {
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
    let caption = "Error against CPU time of one thread: photon maps of all sizes tried that no other beats in both (points, 95 % \
                   intervals), and the path tracer. Left of the black line the map is the faster. A larger map costs more and has \
                   a smaller error, down to its bias; at untreated faces that is soon reached.";
    FigureFiles::draw("time", caption, &figure)
}
