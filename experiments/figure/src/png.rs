//! The page as a PNG file.

use crate::error::Error;
use crate::mark::{Mark, Page, Paint, Point, Symbol};
use crate::shape;
use crate::text::Fonts;
use image::{
    ColorType, ImageEncoder,
    codecs::png::{CompressionType, FilterType, PngEncoder},
};
use plotters::prelude::*;
use std::fmt::Display;

/// Pixels to the point: 300 to the inch.
const PIXELS: f64 = 300.0 / 72.0;

/// Shapes are drawn this many times as large and averaged: plotters knows whole pixels only.
const FINE: usize = 4;

fn failed(e: impl Display) -> Error {
    Error::Backend(e.to_string())
}

fn fine(length: f64) -> f64 {
    length * PIXELS * FINE as f64
}

fn place((x, y): Point) -> (i32, i32) {
    (libm::round(fine(x)) as i32, libm::round(fine(y)) as i32)
}

fn style(paint: Paint) -> ShapeStyle {
    let (r, g, b) = paint.rgb;
    RGBAColor(r, g, b, paint.alpha).filled()
}

/// Writes the page.
pub(crate) fn encode(page: &Page) -> Result<Vec<u8>, Error> {
    let size = |length: f64| libm::ceil(length * PIXELS) as usize;
    let (width, height) = (size(page.width), size(page.height));
    let mut pixels = averaged(&shapes(page, width, height)?, width, height);
    let fonts = Fonts::load()?;
    for mark in &page.marks {
        let Mark::Text(text) = mark else { continue };
        let ink = [text.paint.rgb.0, text.paint.rgb.1, text.paint.rgb.2];
        fonts.draw(text, PIXELS, |x, y, cover| {
            if x < 0 || y < 0 || x >= width as i64 || y >= height as i64 {
                return;
            }
            let at = 3 * (y as usize * width + x as usize);
            for (under, ink) in pixels[at..at + 3].iter_mut().zip(ink) {
                let mixed =
                    f64::from(*under) + cover * text.paint.alpha * (f64::from(ink) - f64::from(*under));
                *under = mixed.round() as u8;
            }
        });
    }
    let mut file = Vec::new();
    PngEncoder::new_with_quality(&mut file, CompressionType::Best, FilterType::NoFilter)
        .write_image(&pixels, width as u32, height as u32, ColorType::Rgb8)
        .map_err(failed)?;
    Ok(file)
}

/// All but the text, on the fine grid.
fn shapes(page: &Page, width: usize, height: usize) -> Result<Vec<u8>, Error> {
    let (w, h) = (FINE * width, FINE * height);
    let mut buffer = vec![255; 3 * w * h];
    let mut canvas = BitMapBackend::with_buffer(&mut buffer, (w as u32, h as u32));
    for mark in &page.marks {
        match mark {
            Mark::Stroke { points, width, paint } => stroke(&mut canvas, points, *width, *paint)?,
            Mark::Area { points, paint } => {
                canvas.fill_polygon(points.iter().map(|&p| place(p)), &style(*paint)).map_err(failed)?
            }
            Mark::Symbol(s) => symbol(&mut canvas, s)?,
            Mark::Text(_) => {}
        }
    }
    canvas.present().map_err(failed)?;
    drop(canvas);
    Ok(buffer)
}

/// A marker on its rim.
fn symbol(canvas: &mut BitMapBackend<'_>, s: &Symbol) -> Result<(), Error> {
    let mut corners: Vec<Point> =
        shape::corners(s.shape, s.radius).iter().map(|c| (s.center.0 + c.0, s.center.1 + c.1)).collect();
    if corners.is_empty() {
        let rim = (s.rim > 0.0).then_some((s.radius + s.rim, Paint::PAPER));
        for (radius, paint) in rim.into_iter().chain([(s.radius, s.paint)]) {
            let radius = libm::round(fine(radius)) as u32;
            canvas.draw_circle(place(s.center), radius, &style(paint), true).map_err(failed)?;
        }
        return Ok(());
    }
    let outline = corners.iter().map(|&p| place(p)).collect::<Vec<_>>();
    if s.rim > 0.0 {
        corners.extend([corners[0], corners[1]]);
        stroke(canvas, &corners, 2.0 * s.rim, Paint::PAPER)?;
    }
    canvas.fill_polygon(outline, &style(s.paint)).map_err(failed)
}

/// A line as one quadrangle a piece with discs at the bends: plotters' own wide lines leave holes at sharp ones.
fn stroke(canvas: &mut BitMapBackend<'_>, points: &[Point], width: f64, paint: Paint) -> Result<(), Error> {
    let half = 0.5 * width;
    for w in points.windows(2) {
        let (dx, dy) = (w[1].0 - w[0].0, w[1].1 - w[0].1);
        let length = libm::hypot(dx, dy);
        if length == 0.0 {
            continue;
        }
        let (nx, ny) = (-dy / length * half, dx / length * half);
        let corners = [(1.0, w[0]), (1.0, w[1]), (-1.0, w[1]), (-1.0, w[0])]
            .map(|(s, p)| place((p.0 + s * nx, p.1 + s * ny)));
        canvas.fill_polygon(corners, &style(paint)).map_err(failed)?;
    }
    for bend in points.iter().skip(1).take(points.len().saturating_sub(2)) {
        canvas
            .draw_circle(place(*bend), libm::floor(fine(half)) as u32, &style(paint), true)
            .map_err(failed)?;
    }
    Ok(())
}

/// Means over squares of the fine grid.
fn averaged(fine: &[u8], width: usize, height: usize) -> Vec<u8> {
    let mut out = Vec::with_capacity(3 * width * height);
    let (row, count) = (3 * FINE * width, (FINE * FINE) as u32);
    let mut sums = vec![0_u32; 3 * width];
    for rows in fine.chunks_exact(FINE * row).take(height) {
        sums.fill(0);
        for row in rows.chunks_exact(row) {
            for (sum, square) in sums.chunks_exact_mut(3).zip(row.chunks_exact(3 * FINE)) {
                for pixel in square.chunks_exact(3) {
                    sum[0] += u32::from(pixel[0]);
                    sum[1] += u32::from(pixel[1]);
                    sum[2] += u32::from(pixel[2]);
                }
            }
        }
        out.extend(sums.iter().map(|sum| ((sum + count / 2) / count) as u8));
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn averages_are_of_the_right_squares() {
        // Two pixels by one: the left square all 8, the right all 200, but for one fine pixel.
        let (width, height) = (2, 1);
        let mut grid = vec![8_u8; 3 * FINE * width * FINE * height];
        for (i, v) in grid.iter_mut().enumerate() {
            if (i / 3) % (FINE * width) >= FINE {
                *v = 200;
            }
        }
        grid[0] = 8 + 16;
        assert_eq!(averaged(&grid, width, height), [9, 8, 8, 200, 200, 200]);
    }

    #[test]
    fn a_stroke_covers_its_width() {
        // A horizontal line 2.4 pt = 10 pixels wide: its ink adds up to ten rows of pixels, within one fine row a side.
        let points = vec![(0.0, 12.0), (24.0, 12.0)];
        let page = Page {
            width: 24.0,
            height: 24.0,
            name: String::new(),
            marks: vec![Mark::Stroke { points, width: 2.4, paint: Paint::INK }],
        };
        let pixels = averaged(&shapes(&page, 100, 100).unwrap(), 100, 100);
        let ink: f64 = (0..100).map(|y| f64::from(255 - pixels[3 * (100 * y + 50)]) / 255.0).sum();
        assert!((ink - 10.0).abs() <= 2.0 / FINE as f64, "{ink}");
    }
}
