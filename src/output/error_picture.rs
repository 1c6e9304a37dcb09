//! A picture of relative errors: blue below the reference, white at it, red above, with its scale underneath.

use super::{WriteError, write_png};
use std::path::Path;

/// Fewest pixels across: smaller pictures are enlarged.
const LEAST_WIDTH: u32 = 256;
/// Side of a pixel of the legend's letters.
const DOT: u32 = 2;
/// Rows of the legend: margins, the bar, letters of five dots.
const LEGEND: u32 = 4 + 12 + 4 + 5 * DOT + 4;
/// What has no light in the reference.
const NO_LIGHT: [u8; 3] = [128, 128, 128];
/// Colours at -1, -1/2, 0, 1/2 and 1 of the scale (ColorBrewer's RdBu, Harrower and Brewer 2003).
const COLORS: [[f64; 3]; 5] =
    [[5.0, 48.0, 97.0], [67.0, 147.0, 195.0], [247.0, 247.0, 247.0], [214.0, 96.0, 77.0], [103.0, 0.0, 31.0]];

/// The scale that suits relative errors: 1, 2 or 5 times a power of ten that 95 per cent of them do not exceed, 0.001 to 1.
pub fn error_scale(errors: impl Iterator<Item = f64>) -> f64 {
    let mut sizes: Vec<f64> = errors.map(f64::abs).filter(|e| e.is_finite()).collect();
    sizes.sort_by(f64::total_cmp);
    let most = sizes.get(sizes.len() * 95 / 100).copied().unwrap_or(0.0);
    let scales = [0.001, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5];
    scales.into_iter().find(|scale| most <= *scale).unwrap_or(1.0)
}

fn color(x: f64) -> [u8; 3] {
    let at = 2.0 * (x.clamp(-1.0, 1.0) + 1.0);
    let below = (at as usize).min(3);
    let part = at - below as f64;
    [0, 1, 2].map(|c| (COLORS[below][c] * (1.0 - part) + COLORS[below + 1][c] * part + 0.5) as u8)
}

/// Five rows of three dots, of the letters of a scale.
fn letter(character: char) -> [u8; 5] {
    match character {
        '0' => [7, 5, 5, 5, 7],
        '1' => [2, 6, 2, 2, 7],
        '2' => [7, 1, 7, 4, 7],
        '5' => [7, 4, 7, 1, 7],
        '+' => [0, 2, 7, 2, 0],
        '-' => [0, 0, 7, 0, 0],
        '.' => [0, 0, 0, 0, 2],
        '%' => [5, 1, 2, 4, 5],
        _ => [0; 5],
    }
}

/// Writes relative errors as a PNG: red where the picture is too bright, blue where it is too dark, grey where the reference
/// has no light; the ends of `scale` stand underneath.
///
/// # Arguments
/// `error` of the pixel in column x and row y
///
/// # Errors
/// [`WriteError`], naming the path; the old file is then untouched.
pub fn write_error_picture(
    path: impl AsRef<Path>,
    (width, height): (u32, u32),
    error: impl Fn(u32, u32) -> Option<f64>,
    scale: f64,
) -> Result<(), WriteError> {
    let times = LEAST_WIDTH.div_ceil(width);
    let (across, rows) = (width * times, height * times);
    let mut pixels = vec![[255; 3]; across as usize * (rows + LEGEND) as usize];
    let mut set = |x: u32, y: u32, color: [u8; 3]| pixels[y as usize * across as usize + x as usize] = color;
    for y in 0..rows {
        for x in 0..across {
            let error = error(x / times, y / times);
            set(x, y, error.map_or(NO_LIGHT, |error| color(error / scale)));
        }
    }
    for x in 4..across - 4 {
        let at = 2.0 * f64::from(x - 4) / f64::from(across - 9) - 1.0;
        (rows + 4..rows + 16).for_each(|y| set(x, y, color(at)));
    }
    let end = format!("{}%", (1000.0 * scale).round() / 10.0);
    let wide = |text: &str| 4 * DOT * text.len() as u32 - DOT;
    let (low, high) = (format!("-{end}"), format!("+{end}"));
    let labels = [(4, low.as_str()), ((across - wide("0")) / 2, "0"), (across - 4 - wide(&high), &high)];
    for (left, text) in labels {
        for (number, character) in text.chars().enumerate() {
            for (row, dots) in letter(character).into_iter().enumerate() {
                for column in (0..3).filter(|column| dots >> (2 - column) & 1 == 1) {
                    let x = left + DOT * (4 * number as u32 + column);
                    let y = rows + 20 + DOT * row as u32;
                    for (dx, dy) in (0..DOT).flat_map(|dx| (0..DOT).map(move |dy| (dx, dy))) {
                        set(x + dx, y + dy, [0; 3]);
                    }
                }
            }
        }
    }
    write_png(path, (across, rows + LEGEND), &pixels)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scales_hold_nineteen_of_twenty() {
        let errors = || (0..100).map(|i| f64::from(i - 50) / 1000.0);
        assert_eq!(error_scale(errors()), 0.05);
        assert_eq!(error_scale(errors().chain([f64::NAN, 9.0])), 0.05);
        assert_eq!(error_scale(std::iter::empty()), 0.001);
        assert_eq!(error_scale([-7.0].into_iter()), 1.0);
    }

    /// Blue below, white at, red above the reference, grey without one; the legend has both ends.
    #[test]
    fn signs_have_their_colors() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("error.png");
        let errors = [Some(-0.2), Some(0.0), Some(0.2), None];
        write_error_picture(&path, (4, 1), |x, _| errors[x as usize], 0.1).unwrap();
        let read = image::open(&path).unwrap().to_rgb8();
        assert_eq!((read.width(), read.height()), (256, 64 + LEGEND));
        let at = |x, y| read.get_pixel(x, y).0;
        assert_eq!(
            [at(0, 0), at(64, 0), at(191, 63), at(255, 63)],
            [[5, 48, 97], [247; 3], [103, 0, 31], NO_LIGHT]
        );
        assert_eq!((at(4, 70), at(251, 70)), ([5, 48, 97], [103, 0, 31]));
        assert!((0..256).any(|x| at(x, 64 + 24) == [0; 3]), "no letters");
    }
}
