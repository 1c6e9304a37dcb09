//! Pictures for the eye: exposure, a curve, 8 bits in sRGB, PNG.

use super::{WriteError, write_atomically};
use crate::Spectrum;
use crate::faults::{Fault, planted};
use image::ImageEncoder;
use std::io;
use std::path::Path;

/// What happens to light too bright for the screen.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Curve {
    /// Everything above 1 is cut: radiance ratios below stay what they are.
    Clip,
    /// The same up to a knee, k = 0.6, and above it k + (1 - k) (1 - e^(-(x - k)/(1 - k))): smooth at the knee, below 1
    /// everywhere.
    Soft,
}

/// How radiance becomes a picture to look at.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tone {
    /// Stops: radiance is multiplied by 2 to this power. Pictures to be compared have the same.
    pub exposure: f64,
    /// What happens to what is too bright.
    pub curve: Curve,
}

const KNEE: f64 = 0.6;

impl Tone {
    /// The screen's value of a radiance, in [0, 1], linear. Negative and undefined values are black.
    pub fn linear(&self, radiance: f64) -> f64 {
        let x = (radiance * libm::exp2(self.exposure)).max(0.0);
        match self.curve {
            Curve::Clip => x.min(1.0),
            Curve::Soft if x <= KNEE => x,
            Curve::Soft => 1.0 - (1.0 - KNEE) * crate::math::exp(-(x - KNEE) / (1.0 - KNEE)),
        }
    }

    /// Red, green and blue in sRGB.
    pub fn pixel(&self, radiance: Spectrum) -> [u8; 3] {
        [0, 1, 2].map(|c| to_srgb(self.linear(radiance[c])))
    }
}

/// The curve of sRGB (IEC 61966-2-1), rounded to 8 bits.
pub fn to_srgb(linear: f64) -> u8 {
    let x = linear.clamp(0.0, 1.0);
    let encoded = if x <= 0.003_130_8 { 12.92 * x } else { 1.055 * libm::pow(x, 1.0 / 2.4) - 0.055 };
    (255.0 * encoded + 0.5) as u8
}

/// Stops that bring the radiance which nine tenths of a picture do not exceed to the knee of [`Curve::Soft`], rounded to
/// a tenth; 0 for a black picture.
pub fn auto_exposure(picture: impl Iterator<Item = Spectrum>) -> f64 {
    let (first, last) = if planted(Fault::LuminanceReversed) { (2, 0) } else { (0, 2) };
    let luminance = |s: Spectrum| 0.2126 * s[first] + 0.7152 * s[1] + 0.0722 * s[last];
    let mut sorted: Vec<f64> = picture.map(luminance).filter(|y| *y > 0.0 && y.is_finite()).collect();
    sorted.sort_by(f64::total_cmp);
    match sorted.get(sorted.len() * 9 / 10) {
        Some(bright) => (10.0 * libm::log2(KNEE / bright)).round() / 10.0,
        None => 0.0,
    }
}

/// Writes 8 bits a channel, row by row from the top.
///
/// # Errors
/// [`WriteError`], naming the path; the old file is then untouched.
pub fn write_png(
    path: impl AsRef<Path>,
    (width, height): (u32, u32),
    pixels: &[[u8; 3]],
) -> Result<(), WriteError> {
    write_atomically(path, |out| {
        image::codecs::png::PngEncoder::new(out)
            .write_image(pixels.as_flattened(), width, height, image::ColorType::Rgb8)
            .map_err(|error| match error {
                image::ImageError::IoError(cause) => cause,
                other => io::Error::other(other.to_string()),
            })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Values of the standard: mid grey 0.2140 is 127.5 of 255, the ends stay.
    #[test]
    fn srgb_of_known_values() {
        let known = [(0.0, 0), (1.0, 255), (0.215_861, 128), (0.005, 16), (0.001, 3), (2.0, 255), (-1.0, 0)];
        for (x, expected) in known {
            assert_eq!(to_srgb(x), expected, "{x}");
        }
    }

    #[test]
    fn curves_are_linear_below_the_knee_and_never_above_one() {
        let tone = |curve| Tone { exposure: 1.0, curve };
        for curve in [Curve::Clip, Curve::Soft] {
            assert_eq!((tone(curve).linear(0.25), tone(curve).linear(0.0)), (0.5, 0.0));
            assert_eq!(tone(curve).linear(f64::NAN), 0.0);
            assert_eq!(tone(curve).pixel(Spectrum::grey(-3.0)), [0, 0, 0]);
            assert!(tone(curve).linear(1e9) <= 1.0);
        }
        // Continuous with its slope at the knee.
        let (x, step) = (0.3, 1e-6);
        let slope = (tone(Curve::Soft).linear(x + step) - tone(Curve::Soft).linear(x)) / step;
        assert!((slope - 2.0).abs() < 1e-4, "{slope}");
    }

    #[test]
    fn exposure_brings_the_ninth_tenth_to_the_knee() {
        let picture = || (1..=100).map(|i| Spectrum::grey(f64::from(i)));
        let stops = auto_exposure(picture());
        assert!((91.0 * libm::exp2(stops) / KNEE - 1.0).abs() < 0.04, "{stops}");
        assert_eq!(auto_exposure([Spectrum::ZERO].into_iter()), 0.0);
        assert_eq!(auto_exposure(std::iter::empty()), 0.0);
    }

    #[test]
    fn png_reads_back() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.png");
        let pixels = [[1, 2, 3], [4, 5, 6], [7, 8, 9], [10, 11, 12], [13, 14, 15], [16, 17, 18]];
        write_png(&path, (3, 2), &pixels).unwrap();
        let read = image::open(&path).unwrap().to_rgb8();
        assert_eq!((read.width(), read.height()), (3, 2));
        assert_eq!(read.get_pixel(0, 1).0, [10, 11, 12]);
        #[cfg(unix)]
        assert!(write_png("/dev/full", (3, 2), &pixels).unwrap_err().to_string().contains("/dev/full"));
    }
}
