//! From radiance to pictures for the eye: exposure, tone curve, PNG; and signed errors as colours with their scale.

use super::Grid;
use anyhow::Context;
use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ColorType, ImageEncoder};
use turbid::Spectrum;
use turbid_figure::Shading;

/// Side of the squares over which pictures are averaged before errors are shown \[pixels\].
pub const SOFT: usize = 4;

/// Height of the scale under a picture of errors, and of the digits on it \[pixels\].
const BAR: usize = 16;

/// Three bytes a pixel, by rows from the top.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Print {
    /// Size of the picture.
    pub grid: Grid,
    /// Red, green, blue.
    pub bytes: Vec<u8>,
}

impl Print {
    /// The PNG file.
    pub fn png(&self) -> anyhow::Result<Vec<u8>> {
        let mut file = Vec::new();
        PngEncoder::new_with_quality(&mut file, CompressionType::Best, FilterType::Paeth)
            .write_image(&self.bytes, self.grid.width as u32, self.grid.height as u32, ColorType::Rgb8)
            .context("cannot encode a picture")?;
        Ok(file)
    }
}

/// The sRGB transfer function (IEC 61966-2-1), for values in [0, 1].
fn encoded(x: f64) -> f64 {
    if x <= 0.003_130_8 { 12.92 * x } else { 1.055 * libm::pow(x, 1.0 / 2.4) - 0.055 }
}

/// Where the tone curve leaves the straight line.
const SHOULDER: f64 = 0.7;

/// Straight up to [`SHOULDER`], then bent so that bright things keep their shape: 1 is reached at infinity only, with the
/// slope continuous.
fn toned(x: f64) -> f64 {
    if x <= SHOULDER {
        return x.max(0.0);
    }
    let rest = 1.0 - SHOULDER;
    let beyond = (x - SHOULDER) / rest;
    SHOULDER + rest * beyond / (1.0 + beyond)
}

/// A picture for the eye.
///
/// # Arguments   `exposure` what a radiance of 1 becomes on a scale where 1 is white
pub fn develop(grid: Grid, radiance: &[Spectrum], exposure: f64) -> Print {
    let byte = |x: f64| (255.0 * encoded(toned(exposure * x))).round() as u8;
    let bytes = radiance.iter().flat_map(|s| [byte(s[0]), byte(s[1]), byte(s[2])]).collect();
    Print { grid, bytes }
}

/// A picture whose numbers mean something to a program, such as a transmittance: sRGB without a tone curve.
pub fn plain(grid: Grid, values: &[Spectrum]) -> Print {
    let byte = |x: f64| (255.0 * encoded(x.clamp(0.0, 1.0))).round() as u8;
    Print { grid, bytes: values.iter().flat_map(|s| [byte(s[0]), byte(s[1]), byte(s[2])]).collect() }
}

/// The exposure that puts a share of 0.98 of all pixels below white.
pub fn exposure(radiance: &[Spectrum]) -> f64 {
    let mut bright: Vec<f64> = radiance.iter().map(|s| s.max()).collect();
    bright.sort_by(f64::total_cmp);
    let high = bright.get(bright.len() * 98 / 100).copied().unwrap_or(1.0);
    if high > 0.0 { 1.0 / high } else { 1.0 }
}

/// Signed relative errors: blue too dark, white right, red too bright, with a scale from -`limit` to +`limit` below.
///
/// Both pictures are averaged over squares of [`SOFT`] pixels, so that errors that stay show through noise. The error is the
/// difference of the channels' sums over the twin's, or over a hundredth of the twin's mean where the twin is darker than
/// that. What is masked is grey.
pub fn error_print(
    grid: Grid,
    ours: &[Spectrum],
    twin: &[Spectrum],
    masked: Option<&[bool]>,
    limit: f64,
) -> Print {
    let floor = 0.01 * twin.iter().map(|s| s.sum()).sum::<f64>() / twin.len() as f64;
    let mut bytes = Vec::with_capacity(3 * grid.width * (grid.height + BAR));
    let (ours, twin) = (softened(grid, ours), softened(grid, twin));
    for (i, (a, b)) in ours.iter().zip(&twin).enumerate() {
        let scale = b.max(floor);
        let error = if scale > 0.0 { (a - b) / scale } else { 0.0 };
        let (r, g, b) = if masked.is_some_and(|m| m[i]) {
            (150, 150, 150)
        } else {
            Shading::Diverging.rgb(0.5 + 0.5 * error / limit)
        };
        bytes.extend([r, g, b]);
    }
    bar(&mut bytes, grid.width, limit);
    Print { grid: Grid { width: grid.width, height: grid.height + BAR }, bytes }
}

/// Sums of channels, averaged over squares of [`SOFT`] pixels.
fn softened(grid: Grid, picture: &[Spectrum]) -> Vec<f64> {
    let square = |i: usize| {
        let (x, y) = (i % grid.width / SOFT * SOFT, i / grid.width / SOFT * SOFT);
        let (right, low) = ((x + SOFT).min(grid.width), (y + SOFT).min(grid.height));
        let pixels = (y..low).flat_map(|y| (x..right).map(move |x| y * grid.width + x));
        pixels.map(|j| picture[j].sum()).sum::<f64>() / ((right - x) * (low - y)) as f64
    };
    (0..grid.pixels()).map(square).collect()
}

fn bar(bytes: &mut Vec<u8>, width: usize, limit: f64) {
    let start = bytes.len();
    for y in 0..BAR {
        for x in 0..width {
            let (r, g, b) =
                if y < 2 { (255, 255, 255) } else { Shading::Diverging.rgb((x as f64 + 0.5) / width as f64) };
            bytes.extend([r, g, b]);
        }
    }
    let percent = (100.0 * limit).round();
    let (low, high) = (format!("-{percent}%"), format!("+{percent}%"));
    let mut write = |text: &str, left: usize, ink: u8| {
        for (n, c) in text.chars().enumerate() {
            for (row, bits) in digit(c).into_iter().enumerate() {
                for column in 0..3 {
                    if bits >> (2 - column) & 1 == 1 {
                        for (dx, dy) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
                            let (x, y) = (left + 8 * n + 2 * column + dx, 4 + 2 * row + dy);
                            let at = start + 3 * (y * width + x);
                            if x < width {
                                bytes[at..at + 3].fill(ink);
                            }
                        }
                    }
                }
            }
        }
    };
    write(&low, 3, 255);
    write("0", (width / 2).saturating_sub(3), 0);
    write(&high, width.saturating_sub(8 * high.len() + 1), 255);
}

/// Rows of a character, three bits each, from the top.
fn digit(c: char) -> [u8; 5] {
    match c {
        '0' => [7, 5, 5, 5, 7],
        '1' => [2, 6, 2, 2, 7],
        '2' => [7, 1, 7, 4, 7],
        '3' => [7, 1, 7, 1, 7],
        '4' => [5, 5, 7, 1, 1],
        '5' => [7, 4, 7, 1, 7],
        '6' => [7, 4, 7, 5, 7],
        '7' => [7, 1, 2, 2, 2],
        '8' => [7, 5, 7, 5, 7],
        '9' => [7, 5, 7, 1, 7],
        '+' => [0, 2, 7, 2, 0],
        '-' => [0, 0, 7, 0, 0],
        '%' => [5, 1, 2, 4, 5],
        _ => [0; 5],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GRID: Grid = Grid { width: 64, height: 4 };

    #[test]
    fn the_tone_curve_is_smooth_and_stays_below_white() {
        assert_eq!((toned(-1.0), toned(0.3)), (0.0, 0.3));
        assert!((toned(SHOULDER + 1e-6) - SHOULDER - 1e-6).abs() < 1e-11, "slope 1 at the shoulder");
        assert!((toned(1.0) - 0.85).abs() < 1e-15 && toned(1e9) < 1.0);
    }

    /// Mid-grey of sRGB: a linear 0.5 is 188.
    #[test]
    fn exposure_and_transfer_function() {
        let picture = vec![Spectrum::rgb(0.25, 0.0, 50.0); GRID.pixels()];
        assert_eq!(develop(GRID, &picture, 2.0).bytes[..3], [188, 0, 255]);
        assert_eq!(exposure(&picture), 1.0 / 50.0);
        assert_eq!(exposure(&[Spectrum::ZERO]), 1.0);
    }

    #[test]
    fn errors_have_their_colours_and_a_scale() {
        let twin = vec![Spectrum::grey(2.0); GRID.pixels()];
        let mut ours = twin.clone();
        for i in 0..GRID.pixels() {
            ours[i] *= [1.2, 0.5, 1.0][(i % GRID.width / SOFT).min(2)];
        }
        let mut masked = vec![false; GRID.pixels()];
        masked[12] = true;
        let print = error_print(GRID, &ours, &twin, Some(&masked), 0.2);
        assert_eq!(print.grid.height, GRID.height + BAR);
        assert_eq!(print.bytes.len(), 3 * print.grid.pixels());
        let pixel = |i: usize| (print.bytes[3 * i], print.bytes[3 * i + 1], print.bytes[3 * i + 2]);
        assert_eq!(pixel(0), Shading::Diverging.rgb(1.0));
        assert_eq!(pixel(4), Shading::Diverging.rgb(0.0));
        assert_eq!(pixel(8), Shading::Diverging.rgb(0.5));
        assert_eq!(pixel(12), (150, 150, 150));
        assert!(print.png().unwrap().starts_with(b"\x89PNG"));
    }
}
