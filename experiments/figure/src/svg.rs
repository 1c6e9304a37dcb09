//! The page as an SVG document, kept small: a run of marks of one look says it once, and places are relative.

use crate::error::Error;
use crate::layer::Align;
use crate::mark::{Mark, Page, Paint, Point, Symbol, Text};
use crate::shape;
use std::fmt::Write;

/// Units of the document to the point: places are whole numbers, and 1/40 pt is beyond any printer.
const UNITS: f64 = 40.0;

/// Where DejaVu is absent, Verdana is nearly as wide.
const FAMILY: &str = "DejaVu Sans, Verdana, sans-serif";

fn units(length: f64) -> i64 {
    libm::round(length * UNITS) as i64
}

fn place((x, y): Point) -> (i64, i64) {
    (units(x), units(y))
}

fn hex((r, g, b): (u8, u8, u8)) -> String {
    format!("#{r:02X}{g:02X}{b:02X}")
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

/// Writes the page.
pub(crate) fn encode(page: &Page) -> Result<String, Error> {
    let mut out = String::new();
    write(page, &mut out).map_err(|e| Error::Backend(e.to_string()))?;
    Ok(out)
}

fn write(page: &Page, out: &mut String) -> std::fmt::Result {
    let millimetres = |points: f64| points * 25.4 / 72.0;
    let (width, height) = (units(page.width), units(page.height));
    writeln!(
        out,
        "<svg width=\"{:.2}mm\" height=\"{:.2}mm\" viewBox=\"0 0 {width} {height}\" \
         xmlns=\"http://www.w3.org/2000/svg\" font-family=\"{FAMILY}\" stroke-linejoin=\"round\">",
        millimetres(page.width),
        millimetres(page.height),
    )?;
    writeln!(out, "<title>{}</title>", escaped(&page.name))?;
    writeln!(out, "<path d=\"M0,0h{width}v{height}h-{width}z\" fill=\"{}\"/>", hex(Paint::PAPER.rgb))?;
    let mut marks = page.marks.as_slice();
    while let Some(first) = marks.first() {
        if let Mark::Text(text) = first {
            self::text(text, out)?;
            marks = &marks[1..];
            continue;
        }
        let look = look(first);
        let count = marks.iter().take_while(|m| self::look(m) == look).count();
        let (run, rest) = marks.split_at(count);
        marks = rest;
        if matches!(first, Mark::Stroke { paint, .. } if paint.alpha == 1.0) {
            // Opaque strokes of one colour look the same in one path.
            let path: String = run.iter().map(path).collect();
            writeln!(out, "<path {look} d=\"{path}\"/>")?;
            continue;
        }
        let is_group = run.len() > 1;
        let own = if is_group { String::new() } else { format!(" {look}") };
        if is_group {
            writeln!(out, "<g {look}>")?;
        }
        for mark in run {
            match mark {
                Mark::Symbol(Symbol { shape: crate::palette::Marker::Circle, center, radius, .. }) => {
                    let (x, y) = place(*center);
                    writeln!(out, "<circle{own} cx=\"{x}\" cy=\"{y}\" r=\"{}\"/>", units(*radius))?;
                }
                _ => writeln!(out, "<path{own} d=\"{}\"/>", path(mark))?,
            }
        }
        if is_group {
            writeln!(out, "</g>")?;
        }
    }
    writeln!(out, "</svg>")
}

/// Everything about a mark but its place, as attributes.
fn look(mark: &Mark) -> String {
    let opacity = |name: &str, paint: &Paint| {
        if paint.alpha == 1.0 { String::new() } else { format!(" {name}-opacity=\"{}\"", paint.alpha) }
    };
    match mark {
        Mark::Stroke { width, paint, .. } => format!(
            "fill=\"none\" stroke=\"{}\" stroke-width=\"{}\"{}",
            hex(paint.rgb),
            units(*width).max(1),
            opacity("stroke", paint)
        ),
        Mark::Area { paint, .. } => format!("fill=\"{}\"{}", hex(paint.rgb), opacity("fill", paint)),
        Mark::Symbol(Symbol { paint, rim, .. }) => {
            let rim = if *rim > 0.0 {
                // The stroke goes under the fill, so that its outer half is the rim.
                let (color, width) = (hex(Paint::PAPER.rgb), units(2.0 * rim));
                format!(" stroke=\"{color}\" stroke-width=\"{width}\" paint-order=\"stroke\"")
            } else {
                String::new()
            };
            format!("fill=\"{}\"{}{rim}", hex(paint.rgb), opacity("fill", paint))
        }
        Mark::Text(_) => String::new(),
    }
}

/// The outline as path data, with relative steps.
fn path(mark: &Mark) -> String {
    let (points, is_closed) = match mark {
        Mark::Stroke { points, .. } => (points.iter().map(|&p| place(p)).collect(), false),
        Mark::Area { points, .. } => (points.iter().map(|&p| place(p)).collect(), true),
        Mark::Symbol(s) => {
            let at = |c: &Point| place((s.center.0 + c.0, s.center.1 + c.1));
            (shape::corners(s.shape, s.radius).iter().map(at).collect(), true)
        }
        Mark::Text(_) => (Vec::<(i64, i64)>::new(), false),
    };
    let Some(&(x, y)) = points.first() else { return String::new() };
    let mut data = format!("M{x},{y}");
    let mut command = 'M';
    let (mut last, mut is_dot) = ((x, y), true);
    for &(x, y) in &points[1..] {
        let (dx, dy) = (x - last.0, y - last.1);
        if (dx, dy) == (0, 0) {
            continue;
        }
        is_dot = false;
        last = (x, y);
        let (next, step) = match (dx, dy) {
            (_, 0) => ('h', dx.to_string()),
            (0, _) => ('v', dy.to_string()),
            // A minus sign parts numbers by itself.
            _ if dy < 0 => ('l', format!("{dx}{dy}")),
            _ => ('l', format!("{dx},{dy}")),
        };
        if next != command {
            data.push(next);
        } else if !step.starts_with('-') {
            data.push(' ');
        }
        command = next;
        data.push_str(&step);
    }
    if is_dot {
        // Nothing but a start is not drawn; a step of no length is not either, without round ends.
        return data;
    }
    if is_closed {
        data.push('z');
    }
    data
}

fn text(text: &Text, out: &mut String) -> std::fmt::Result {
    let (x, y) = place(text.at);
    write!(out, "<text x=\"{x}\" y=\"{y}\" font-size=\"{}\"", units(text.size))?;
    match text.align {
        Align::Start => {}
        Align::Middle => write!(out, " text-anchor=\"middle\"")?,
        Align::End => write!(out, " text-anchor=\"end\"")?,
    }
    if text.bold {
        write!(out, " font-weight=\"bold\"")?;
    }
    if text.upright {
        write!(out, " transform=\"rotate(-90 {x} {y})\"")?;
    }
    if text.paint != Paint::INK {
        write!(out, " fill=\"{}\"", hex(text.paint.rgb))?;
    }
    writeln!(out, ">{}</text>", escaped(&text.text))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn stroke(points: Vec<Point>) -> Mark {
        Mark::Stroke { points, width: 1.0, paint: Paint::INK }
    }

    /// The places that path data mean, read back step by step.
    fn places(data: &str) -> Vec<(i64, i64)> {
        let mut out: Vec<(i64, i64)> = Vec::new();
        let mut rest = data.trim_end_matches('z');
        while let Some(command) = rest.chars().next() {
            let end = rest[1..].find(|c: char| c.is_ascii_alphabetic()).map_or(rest.len(), |i| i + 1);
            let spaced = rest[1..end].replace('-', " -").replace(',', " ");
            let numbers: Vec<i64> = spaced.split_whitespace().map(|n| n.parse().unwrap()).collect();
            let size = if "hv".contains(command) { 1 } else { 2 };
            assert_eq!(numbers.len() % size, 0, "{data}");
            for n in numbers.chunks(size) {
                let (x, y) = out.last().copied().unwrap_or_default();
                out.push(match command {
                    'M' => (n[0], n[1]),
                    'h' => (x + n[0], y),
                    'v' => (x, y + n[0]),
                    _ => (x + n[0], y + n[1]),
                });
            }
            rest = &rest[end..];
        }
        out
    }

    #[test]
    fn path_data_lead_back_to_the_places() {
        let mut state = 1_u64;
        let mut random = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            ((state >> 33) % 7) as f64 - 3.0
        };
        for length in 2..40 {
            let points: Vec<Point> = (0..length).map(|_| (random(), random())).collect();
            let mut expected: Vec<(i64, i64)> = points.iter().map(|&p| place(p)).collect();
            expected.dedup();
            assert_eq!(places(&path(&stroke(points))), expected);
        }
    }

    #[test]
    fn marks_of_one_look_share_it() {
        let marks = vec![
            stroke(vec![(0.0, 0.0), (1.0, 0.0)]),
            stroke(vec![(0.0, 1.0), (1.0, 2.0)]),
            Mark::Area { points: vec![(0.0, 0.0), (1.0, 0.0), (1.0, 1.0)], paint: Paint::INK },
        ];
        let svg = encode(&Page { width: 10.0, height: 10.0, name: "a < b".to_owned(), marks }).unwrap();
        assert_eq!(svg.matches("stroke-width").count(), 1);
        assert!(svg.contains("d=\"M0,0h40M0,40l40,40\""), "{svg}");
        assert!(svg.contains("<title>a &lt; b</title>") && svg.contains("d=\"M0,0h40v40z\""), "{svg}");
    }
}
