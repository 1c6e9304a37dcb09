//! What all maps together say.

use super::edge::{self, BEHIND, DEPTHS, SIZES, Size, edge_case, wall_case};
use super::figures;
use super::pixels::{self, NEIGHBORS, SIDE, case, map_case, path_case};
use super::walls::{self, PAIRS, TRIANGLES, phase};
use crate::harness::{
    Cells, Claim, Estimate, Known, Prediction, Row, Section, Settings, Table, Unit, bar, number, signed,
    with_error,
};
use turbid::estimators::boundary::Rejection;
use turbid::math::{exp, ln};
use turbid::stats::{Jackknife, Moments, jackknife, jackknife_log, mean_interval};

/// The picture at one number of neighbours; all in per cent of the pixel.
pub struct Picture {
    /// Number of neighbours.
    pub k: usize,
    /// Noise between independent maps, root mean square over the pixels.
    pub noise: Estimate,
    /// What was predicted of it.
    pub predicted: f64,
    /// Mean error of the whole picture, one a map.
    pub bias: Moments,
    /// Mean square over the pixels of what no number of maps removes [%²].
    pub square: Estimate,
    /// Map against paths by pixel: mean error.
    pub by_pixel: Vec<f64>,
}

fn pictures(cells: &Cells, known: &Known) -> anyhow::Result<Vec<Picture>> {
    let list = |case: &dyn Fn(usize) -> String| (0..SIDE * SIDE).map(case).collect::<Vec<_>>();
    let multiple = cells.per_map(&list(&path_case), "multiple")?;
    let totals = list(&path_case);
    let totals: Vec<f64> =
        totals.iter().map(|c| Ok(cells.moments(c, "radiance")?.mean())).collect::<anyhow::Result<_>>()?;
    let pixels = totals.len() as f64;
    let whole = totals.iter().sum::<f64>();
    let mut pictures = Vec::new();
    for k in NEIGHBORS {
        let maps = cells.per_map(&list(&|pixel| map_case(k, pixel)), "multiple")?;
        // One map's pixels over the whole ones, and its errors against the paths of its own cell.
        let relative: Vec<Vec<f64>> = maps
            .iter()
            .map(|map| map.iter().zip(&totals).map(|(value, total)| 100.0 * value / total).collect())
            .collect();
        let errors: Vec<Vec<f64>> = maps
            .iter()
            .zip(&multiple)
            .map(|(map, paths)| {
                map.iter().zip(paths).zip(&totals).map(|((a, b), total)| 100.0 * (a - b) / total).collect()
            })
            .collect();
        let column = |maps: &[Vec<f64>], pixel: usize| maps.iter().map(|m| m[pixel]).collect::<Moments>();
        let noise = |maps: &[Vec<f64>]| {
            ((0..totals.len()).map(|p| column(maps, p).variance()).sum::<f64>() / pixels).sqrt()
        };
        let log = jackknife_log(&relative, noise);
        let value = exp(log.value);
        let noise = Estimate::jackknife(&Jackknife { value, std_error: value * log.std_error, ..log });
        // The square of a mean over maps is high by its variance.
        let square = |maps: &[Vec<f64>]| {
            let one = |p| {
                let moments = column(maps, p);
                moments.mean() * moments.mean() - moments.std_error() * moments.std_error()
            };
            (0..totals.len()).map(one).sum::<f64>() / pixels
        };
        let bias = maps
            .iter()
            .zip(&multiple)
            .map(|(map, paths)| 100.0 * (map.iter().sum::<f64>() - paths.iter().sum::<f64>()) / whole)
            .collect();
        pictures.push(Picture {
            k,
            noise,
            predicted: known.get(&case(k), "noise")?.0,
            bias,
            square: Estimate::jackknife(&jackknife(&errors, square)),
            by_pixel: (0..totals.len()).map(|p| column(&errors, p).mean()).collect(),
        });
    }
    Ok(pictures)
}

/// One measured number beside its prediction [%].
pub struct Beside {
    /// Over maps.
    pub measured: Moments,
    /// Before the run.
    pub predicted: f64,
}

impl Beside {
    fn of(cells: &Cells, known: &Known, case: &str, quantity: &str) -> anyhow::Result<Self> {
        Ok(Beside { measured: cells.moments(case, quantity)?, predicted: known.get(case, quantity)?.0 })
    }

    fn ratio(&self) -> Estimate {
        Estimate::mean(&self.measured).times(1.0 / self.predicted)
    }

    fn words(&self) -> String {
        format!(
            "{} % (predicted {})",
            with_error(self.measured.mean(), self.measured.std_error()),
            signed(self.predicted, 1).replace('+', "")
        )
    }
}

/// The error below the open edge, and what leaks through the wall.
pub struct Edges {
    /// By size and depth.
    pub edge: Vec<(Size, f64, Beside)>,
    /// By size, rejection and distance.
    pub wall: Vec<(Size, Rejection, f64, Beside)>,
}

impl Edges {
    fn read(cells: &Cells, known: &Known) -> anyhow::Result<Self> {
        let (mut edge, mut wall) = (Vec::new(), Vec::new());
        for size in SIZES {
            for depth in DEPTHS {
                edge.push((size, depth, Beside::of(cells, known, &edge_case(size, depth), "error")?));
            }
            for rejection in Rejection::ALL {
                for distance in BEHIND {
                    let case = wall_case(size, rejection, distance);
                    wall.push((size, rejection, distance, Beside::of(cells, known, &case, "leak")?));
                }
            }
        }
        Ok(Edges { edge, wall })
    }

    fn at_edge(&self, size: Size) -> Option<&Beside> {
        self.edge.iter().find(|e| e.0 == size && e.1 == DEPTHS[0]).map(|e| &e.2)
    }

    fn leak(&self, size: Size, rejection: Rejection, distance: f64) -> Option<&Beside> {
        self.wall.iter().find(|w| w.0 == size && w.1 == rejection && w.2 == distance).map(|w| &w.3)
    }
}

/// Distance behind the wall that claims and words are about [mfp].
const NEAR: f64 = BEHIND[1];

/// Time amid many triangles over time amid few: geometric mean over pairs and its 95 % interval.
struct Times {
    ratio: f64,
    low: f64,
    high: f64,
}

impl Times {
    fn of(cells: &Cells, what: &str) -> Option<Self> {
        let mut logs = Moments::new();
        for pair in 0..PAIRS {
            let took =
                |triangles| cells.seconds(walls::GROUP, &phase(what, triangles, pair)).first().copied();
            let (few, many) = (took(TRIANGLES[0])?, took(TRIANGLES[1])?);
            if few > 0.0 && many > 0.0 {
                logs.push(ln(many / few));
            }
        }
        let interval = mean_interval(&logs, 0.95);
        (logs.n() > 1).then(|| Times {
            ratio: exp(logs.mean()),
            low: exp(interval.low),
            high: exp(interval.high),
        })
    }

    fn words(&self) -> String {
        format!("{:.3} ({:.3} to {:.3})", self.ratio, self.low, self.high)
    }

    /// What the interval says of 0.9 to 1.1.
    fn verdict(&self) -> &'static str {
        if 0.9 <= self.low && self.high <= 1.1 {
            "the whole interval is within 0.9 to 1.1"
        } else if self.high < 0.9 || self.low > 1.1 {
            "the whole interval is outside 0.9 to 1.1"
        } else {
            "undecided against 0.9 to 1.1 on this machine, in this run"
        }
    }
}

/// Concludes.
pub fn conclude(settings: &Settings, predictions: &[Prediction], cells: &Cells) -> anyhow::Result<Section> {
    let known = Known::new(predictions);
    let pictures = pictures(cells, &known)?;
    let edges = Edges::read(cells, &known)?;
    Ok(Section {
        summary: summary(cells, &pictures, &edges),
        claims: claims(cells, &pictures, &edges),
        figures: vec![figures::pixels(&pictures)?, figures::edges(&edges)?],
        tables: vec![picture_table(&pictures), wall_table(&edges), sentences(cells, &pictures, &edges)],
        notes: notes(settings, cells),
        rows: rows(&pictures, &edges)?,
        ..Section::default()
    })
}

fn picture(pictures: &[Picture], k: usize) -> Option<&Picture> {
    pictures.iter().find(|p| p.k == k)
}

fn claims(cells: &Cells, pictures: &[Picture], edges: &Edges) -> Vec<Claim> {
    let mut claims = Vec::new();
    for k in [50, 100] {
        let Some(p) = picture(pictures, k) else { continue };
        let text = format!("\"50 to 100 photons an estimate work well\": noise of a marched pixel with {k}");
        claims.push(Claim::at_most(&format!("noise-{k}"), &text, Unit::PERCENT, p.noise, 5.0));
        let text = format!("\"50 to 100 photons an estimate work well\": mean error of the picture with {k}");
        let bias = Estimate::mean(&p.bias);
        claims.push(Claim::within(&format!("bias-{k}"), &text, Unit::PERCENT, bias, -1.0, 1.0));
    }
    for (size, id) in [(Size::Nearest, "edge-nearest"), (Size::Radius, "edge-radius")] {
        let Some(at) = edges.at_edge(size) else { continue };
        let title = size.title();
        let text =
            format!("\"the estimate is too low near the edge of a medium\": error on the edge, {title}");
        let low = Estimate::mean(&at.measured);
        claims.push(Claim::within(id, &text, Unit::PERCENT, low, -60.0, -40.0));
        let text = format!("the same over what the empty part of the ball predicts, {title}");
        claims.push(Claim::within(&format!("{id}-theory"), &text, Unit::ONE, at.ratio(), 0.95, 1.05));
    }
    for (size, id) in [(Size::Nearest, "nearest"), (Size::Radius, "radius")] {
        let title = size.title();
        for (rejection, name) in [(Rejection::Off, "leak"), (Rejection::FacingBehind, "incoming")] {
            let Some(leak) = edges.leak(size, rejection, NEAR) else { continue };
            let what = match rejection {
                Rejection::Off => "false photons behind a thin wall",
                _ => "\"looking at the incoming direction avoids false photons\": those left",
            };
            let text = format!("{what}, {title}: measured over predicted leak");
            claims.push(Claim::within(&format!("{name}-{id}"), &text, Unit::ONE, leak.ratio(), 0.9, 1.1));
        }
    }
    let (off, facing) = (
        edges.leak(Size::Radius, Rejection::Off, NEAR),
        edges.leak(Size::Radius, Rejection::FacingBehind, NEAR),
    );
    if let (Some(off), Some(facing)) = (off, facing) {
        let text = "\"looking at the incoming direction avoids false photons\": leak left, of what leaks without a look, \
                    radius 0.2";
        let left = Estimate::mean(&facing.measured).times(100.0 / off.measured.mean());
        claims.push(Claim::at_most("avoids", text, Unit::PERCENT, left, 50.0));
    }
    for rejection in [Rejection::BehindPlane, Rejection::Visible] {
        let leaks = edges.wall.iter().filter(|w| w.1 == rejection);
        let most = leaks.map(|w| w.3.measured.mean().abs()).fold(0.0, f64::max);
        let text = format!(
            "photons that are rejected as \"{}\" leave no light behind the wall, in any gather of any map",
            rejection.name()
        );
        let id = rejection.name().replace(' ', "-");
        claims.push(Claim::at_most(&id, &text, Unit::PERCENT, Estimate::exact(most, 0.0), 0.0));
    }
    let text = format!(
        "\"maps are decoupled from geometry\": part of the gathers amid {} triangles with the bits of those amid {}",
        TRIANGLES[1], TRIANGLES[0]
    );
    let same = Estimate::exact(same(cells), 0.0);
    claims.push(Claim::within("decoupled", &text, Unit::PERCENT, same, 100.0, 100.0));
    claims
}

/// Gathers whose bits do not depend on the walls [%].
fn same(cells: &Cells) -> f64 {
    let count = |name| cells.counter(name) as f64;
    100.0 * count("gathers amid walls, the same bits") / count("gathers amid walls, asked twice")
}

fn rows(pictures: &[Picture], edges: &Edges) -> anyhow::Result<Vec<Row>> {
    let mut rows = Vec::new();
    for p in pictures {
        let name = case(p.k);
        rows.push(Row::estimated(&name, "noise", Unit::PERCENT, &p.noise)?);
        rows.push(Row::measured(&name, "mean error", Unit::PERCENT, &p.bias)?.reference(0.0, 0.0));
        rows.push(Row::estimated(&name, "squared bias of pixels", Unit::new("%^2"), &p.square)?);
    }
    for (size, depth, at) in &edges.edge {
        rows.push(Row::measured(&edge_case(*size, *depth), "error", Unit::PERCENT, &at.measured)?);
    }
    for (size, rejection, distance, leak) in &edges.wall {
        let name = wall_case(*size, *rejection, *distance);
        rows.push(match leak.predicted {
            0.0 => Row::exact(&name, "leak", Unit::PERCENT, leak.measured.mean(), 0.0),
            _ => Row::measured(&name, "leak", Unit::PERCENT, &leak.measured)?,
        });
    }
    Ok(rows)
}

/// The root of a mean square that may have come out below zero, as an upper end of 95 %.
fn root_of(square: &Estimate) -> String {
    let root = |x: f64| x.max(0.0).sqrt();
    let interval = square.interval(0.95);
    format!("{:.2} ({:.2} to {:.2})", root(square.value()), root(interval.low), root(interval.high))
}

fn picture_table(pictures: &[Picture]) -> Table {
    let row = |p: &Picture| {
        let worst =
            p.by_pixel.iter().fold(0.0, |worst: f64, e| if e.abs() > worst.abs() { *e } else { worst });
        vec![
            p.k.to_string(),
            with_error(p.noise.value(), p.noise.std_error()),
            number(p.predicted),
            with_error(p.bias.mean(), p.bias.std_error()),
            root_of(&p.square),
            signed(worst, 1),
        ]
    };
    Table {
        caption: "A small picture of a box of fog, its multiple scattering marched through a volume map and everything \
                  else exact; per cent of the whole pixel. Noise between independent maps, root mean square over the \
                  pixels; mean error of the whole picture against paths; root mean square over the pixels of the error \
                  that no number of maps removes, with its 95 % interval; the pixel that is farthest off."
            .to_string(),
        columns: [
            "photons an estimate",
            "noise",
            "predicted",
            "mean error",
            "bias of pixels",
            "worst pixel",
        ]
        .map(String::from)
        .to_vec(),
        rows: pictures.iter().map(row).collect(),
    }
}

fn wall_table(edges: &Edges) -> Table {
    let mut rows = Vec::new();
    for size in SIZES {
        for rejection in Rejection::ALL {
            let mut row = vec![size.title().to_string(), rejection.name().to_string()];
            for distance in BEHIND {
                let cell = edges.leak(size, rejection, distance).map_or(String::new(), |leak| {
                    match leak.predicted {
                        0.0 => number(leak.measured.mean()),
                        predicted => format!(
                            "{} | {predicted:.2}",
                            with_error(leak.measured.mean(), leak.measured.std_error())
                        ),
                    }
                });
                row.push(cell);
            }
            rows.push(row);
        }
    }
    let mut columns = vec!["gather".to_string(), "rejection".to_string()];
    columns.extend(BEHIND.map(|h| format!("{h} behind")));
    Table {
        caption: "Light that a gather finds in the dark behind a thin wall, in per cent of the fluence on its lit side, at \
                  distances in mean free paths: measured | predicted. \"Facing\" and \"facing behind\" look at the \
                  incoming direction."
            .to_string(),
        columns,
        rows,
    }
}

/// Each sentence of the talk with what was found.
fn sentences(cells: &Cells, pictures: &[Picture], edges: &Edges) -> Table {
    let mut rows = Vec::new();
    let mut add = |sentence: &str, found: String| rows.push(vec![sentence.to_string(), found]);
    if let (Some(few), Some(many)) = (picture(pictures, 50), picture(pictures, 100)) {
        add(
            "50 to 100 photons an estimate work well",
            format!(
                "after marching a pixel has a noise of {} to {} % and a mean error of {} to {} %",
                with_error(few.noise.value(), few.noise.std_error()),
                with_error(many.noise.value(), many.noise.std_error()),
                with_error(few.bias.mean(), few.bias.std_error()),
                with_error(many.bias.mean(), many.bias.std_error()),
            ),
        );
    }
    if let Some(at) = edges.at_edge(Size::Nearest) {
        add("the estimate is too low near the edge of a medium", format!("on the edge by {}", at.words()));
    }
    if let (Some(off), Some(facing)) = (
        edges.leak(Size::Radius, Rejection::Off, NEAR),
        edges.leak(Size::Radius, Rejection::FacingBehind, NEAR),
    ) {
        add(
            "looking at the incoming direction avoids false photons",
            format!(
                "most of them: {NEAR} mean free paths behind a wall {} of the light in front leaks, with the look {}; \
                 looking on which side of the wall they lie avoids all",
                off.words(),
                facing.words()
            ),
        );
    }
    if let (Some(gathers), Some(rays)) = (Times::of(cells, "gathers"), Times::of(cells, "rays")) {
        add(
            "maps are decoupled from geometry",
            format!(
                "{} % of the gathers have the same bits; amid {} triangles they take {} of the time amid {} (95 %): {}. \
                 Rays to the walls take {}",
                number(same(cells)),
                TRIANGLES[1],
                gathers.words(),
                TRIANGLES[0],
                gathers.verdict(),
                rays.words()
            ),
        );
    }
    Table {
        caption: "The talk's sentences and what was found. Times are CPU seconds of this machine, side by side in one \
                  run; no claim rests on them."
            .to_string(),
        columns: ["the talk", "found"].map(String::from).to_vec(),
        rows,
    }
}

fn summary(cells: &Cells, pictures: &[Picture], edges: &Edges) -> Vec<String> {
    let table = sentences(cells, pictures, edges);
    let mut paragraphs = Vec::new();
    if let (Some(few), Some(at)) = (picture(pictures, 50), edges.at_edge(Size::Nearest)) {
        let (low, high) = bar(&few.bias);
        paragraphs.push(format!(
            "With 50 photons an estimate a marched pixel of a box of fog has a noise of {} % and the picture a mean error \
             of {low:.2} to {high:.2} %; on the edge of a medium the same estimate is off by {}.",
            with_error(few.noise.value(), few.noise.std_error()),
            at.words()
        ));
    }
    paragraphs.extend(table.rows.iter().map(|row| format!("\"{}\": {}.", row[0], row[1])));
    paragraphs
}

fn notes(settings: &Settings, cells: &Cells) -> Vec<String> {
    let stored = cells.counter("photons stored") / pixels::cells(settings).len().max(1) as u64;
    vec![
        format!(
            "The picture is {SIDE} x {SIDE} pixels of a closed box with two blocks; a map stores {stored} photons in its \
             fog, the talk's picture had some 65,000. Steps of a twentieth of a mean free path, estimates divided by the part of \
             the ball inside the box; what the blocks cut off is not made good, as in 1998."
        ),
        format!(
            "Noise is predicted as though the light were even: its share of the pixel, photons per volume and the overlap \
             of balls along a ray are in it, the light's own shape and the walls are not. Maps of the edge have {} photons.",
            edge::photons(settings)
        ),
        "Behind the wall one side is wholly dark, the worst case: what the incoming direction cannot tell is light that \
         travels away from the wall on its lit side."
            .to_string(),
    ]
}
