//! The page as an SVG document.

use crate::error::Error;
use crate::layer::Align;
use crate::mark::{Mark, Page, Paint, Point, Text};
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use std::fmt::Display;

/// Units of the canvas to the point: plotters knows whole units only, and 1/40 pt is beyond any printer.
const UNITS: f64 = 40.0;

/// Where DejaVu is absent, Verdana is nearly as wide.
const FAMILY: &str = "DejaVu Sans, Verdana, sans-serif";

fn failed(e: impl Display) -> Error {
    Error::Backend(e.to_string())
}

fn units(length: f64) -> i32 {
    libm::round(length * UNITS) as i32
}

fn place((x, y): Point) -> (i32, i32) {
    (units(x), units(y))
}

fn style(paint: Paint, width: f64) -> ShapeStyle {
    let (r, g, b) = paint.rgb;
    RGBAColor(r, g, b, paint.alpha).stroke_width(units(width).max(1) as u32)
}

/// Writes the page.
pub(crate) fn encode(page: &Page) -> Result<String, Error> {
    let size = (units(page.width) as u32, units(page.height) as u32);
    let mut document = String::new();
    {
        let mut svg = SVGBackend::with_string(&mut document, size);
        let paper = style(Paint::PAPER, 0.0);
        svg.draw_rect((0, 0), (size.0 as i32, size.1 as i32), &paper, true).map_err(failed)?;
        for mark in &page.marks {
            draw(&mut svg, mark)?;
        }
        svg.present().map_err(failed)?;
    }
    let body = document.split_once('\n').map_or("", |(_, body)| body);
    let millimetres = |points: f64| points * 25.4 / 72.0;
    let name = page.name.replace('&', "&amp;").replace('<', "&lt;");
    Ok(format!(
        "<svg width=\"{:.2}mm\" height=\"{:.2}mm\" viewBox=\"0 0 {} {}\" xmlns=\"http://www.w3.org/2000/svg\" stroke-linejoin=\"round\">\n<title>{name}</title>\n{body}",
        millimetres(page.width),
        millimetres(page.height),
        size.0,
        size.1,
    ))
}

fn draw(svg: &mut SVGBackend<'_>, mark: &Mark) -> Result<(), Error> {
    match mark {
        Mark::Stroke { points, width, paint } => {
            svg.draw_path(points.iter().map(|&p| place(p)), &style(*paint, *width))
        }
        Mark::Area { points, paint } => {
            svg.fill_polygon(points.iter().map(|&p| place(p)), &style(*paint, 0.0))
        }
        Mark::Disc { center, radius, paint } => {
            svg.draw_circle(place(*center), units(*radius) as u32, &style(*paint, 0.0), true)
        }
        Mark::Text(text) => {
            let (style, at) = text_style(text);
            svg.draw_text(&text.text, &style, at)
        }
    }
    .map_err(failed)
}

/// The style and the place that put the baseline where it belongs.
fn text_style(text: &Text) -> (TextStyle<'static>, (i32, i32)) {
    let h = match text.align {
        Align::Start => HPos::Left,
        Align::Middle => HPos::Center,
        Align::End => HPos::Right,
    };
    let weight = if text.bold { FontStyle::Bold } else { FontStyle::Normal };
    let turn = if text.upright { FontTransform::Rotate270 } else { FontTransform::None };
    let (r, g, b) = text.paint.rgb;
    // plotters writes size / 1.24 as the font size, and 0.76 em as the distance of the baseline from the top.
    let font = FontDesc::new(FontFamily::Name(FAMILY), 1.24 * text.size * UNITS, weight).transform(turn);
    let color = RGBAColor(r, g, b, text.paint.alpha).to_backend_color();
    let style = TextStyle { font, color, pos: Pos::new(h, VPos::Top) };
    let top = 0.76 * text.size;
    let at = if text.upright { (text.at.0 - top, text.at.1) } else { (text.at.0, text.at.1 - top) };
    (style, place(at))
}
