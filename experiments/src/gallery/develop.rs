//! From radiance to pictures for the eye; and signed errors as colours.

use super::Grid;
use std::path::Path;
use turbid::Spectrum;
use turbid::output::{Curve, Tone, WriteError, write_png};
use turbid_figure::Shading;

/// Side of the squares over which pictures are averaged before errors are shown \[pixels of the half-size grid\].
pub const SOFT: usize = 2;

/// What is masked, in a picture of errors.
const MASKED: [u8; 3] = [150; 3];

/// Eight bits a channel, by rows from the top.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Print {
    /// Size of the picture.
    pub grid: Grid,
    /// Red, green, blue.
    pub pixels: Vec<[u8; 3]>,
}

impl Print {
    /// Writes the PNG file.
    ///
    /// # Errors
    /// those of writing
    pub fn write(&self, path: &Path) -> Result<(), WriteError> {
        write_png(path, (self.grid.width as u32, self.grid.height as u32), &self.pixels)
    }
}

/// How a radiance of 1 that becomes `exposure`, on a scale where 1 is white, is shown: as `turbid render` does.
pub fn tone(exposure: f64) -> Tone {
    Tone { exposure: libm::log2(exposure), curve: Curve::Soft }
}

/// A picture for the eye.
pub fn develop(grid: Grid, radiance: &[Spectrum], tone: Tone) -> Print {
    Print { grid, pixels: radiance.iter().map(|s| tone.pixel(*s)).collect() }
}

/// A picture whose numbers mean something to a program, such as a transmittance: sRGB without a tone curve.
pub fn plain(grid: Grid, values: &[Spectrum]) -> Print {
    develop(grid, values, Tone { exposure: 0.0, curve: Curve::Clip })
}

/// Signed relative errors on the half-size grid, drawn twice as large: blue too dark, white right, red too bright, full
/// colour at `limit`.
///
/// Both pictures are averaged over squares of [`SOFT`] pixels, so that errors that stay show through noise. The error is the
/// difference of the channels' sums over the reference's, or over a hundredth of the reference's mean where the reference is darker than
/// that. What is masked is grey.
pub fn error_print(
    grid: Grid,
    ours: &[Spectrum],
    reference: &[Spectrum],
    masked: &[bool],
    limit: f64,
) -> Print {
    let floor = 0.01 * reference.iter().map(|s| s.sum()).sum::<f64>() / reference.len() as f64;
    let (ours, reference) = (softened(grid, ours), softened(grid, reference));
    let pixel = |i: usize| {
        let scale = reference[i].max(floor);
        let error = if scale > 0.0 { (ours[i] - reference[i]) / scale } else { 0.0 };
        let (r, g, b) = Shading::Diverging.rgb(0.5 + 0.5 * error / limit);
        if masked[i] { MASKED } else { [r, g, b] }
    };
    doubled(grid, pixel)
}

/// The mask alone, twice as large, over a paled picture: what is masked is grey.
pub fn mask_print(grid: Grid, picture: &[Spectrum], masked: &[bool], tone: Tone) -> Print {
    let pale = |x: u8| 128 + x / 2;
    doubled(grid, |i| if masked[i] { [90; 3] } else { tone.pixel(picture[i]).map(pale) })
}

/// Every pixel of a picture on the half-size grid as two by two.
fn doubled(grid: Grid, pixel: impl Fn(usize) -> [u8; 3]) -> Print {
    let large = Grid { width: 2 * grid.width, height: 2 * grid.height };
    let small: Vec<[u8; 3]> = (0..grid.pixels()).map(pixel).collect();
    let at = |i: usize| small[i / large.width / 2 * grid.width + i % large.width / 2];
    Print { grid: large, pixels: (0..large.pixels()).map(at).collect() }
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

#[cfg(test)]
mod tests {
    use super::*;

    const GRID: Grid = Grid { width: 64, height: 4 };

    /// Below the knee of the curve an exposure of 2 doubles: a linear 0.5 is 188 in sRGB.
    #[test]
    fn exposures_are_factors() {
        let picture = vec![Spectrum::rgb(0.25, 0.0, 50.0); GRID.pixels()];
        assert_eq!(develop(GRID, &picture, tone(2.0)).pixels[0], [188, 0, 255]);
        assert_eq!(plain(GRID, &picture).pixels[0], [137, 0, 255]);
    }

    #[test]
    fn errors_have_their_colours() {
        let reference = vec![Spectrum::grey(2.0); GRID.pixels()];
        let mut ours = reference.clone();
        for i in 0..GRID.pixels() {
            ours[i] *= [1.2, 0.5, 1.0][(i % GRID.width / SOFT).min(2)];
        }
        let mut masked = vec![false; GRID.pixels()];
        masked[12] = true;
        let print = error_print(GRID, &ours, &reference, &masked, 0.2);
        assert_eq!((print.grid.width, print.pixels.len()), (2 * GRID.width, 4 * GRID.pixels()));
        let shade = |u| <[u8; 3]>::from(Shading::Diverging.rgb(u));
        let pixel = |i: usize| print.pixels[2 * i];
        assert_eq!([pixel(0), pixel(SOFT), pixel(2 * SOFT)], [shade(1.0), shade(0.0), shade(0.5)]);
        assert_eq!(pixel(12), MASKED);
        assert_eq!(mask_print(GRID, &reference, &masked, tone(0.1)).pixels[24], [90; 3]);
    }
}
