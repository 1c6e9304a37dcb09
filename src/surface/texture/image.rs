//! Pictures on surfaces.

use crate::Spectrum;
use crate::error::{Error, Result};
use glam::DVec2;
use std::path::Path;

/// A picture in linear light, bilinear between pixel centres and repeated.
///
/// The first surface parameter runs along a row, the second from the lowest row upwards, as in OBJ files.
#[derive(Debug, Clone, PartialEq)]
pub struct Image {
    width: usize,
    height: usize,
    /// Linear red, green and blue, by rows from the top.
    pixels: Vec<[f32; 3]>,
}

/// More pixels than this are refused, before any is decoded: 8192 x 8192, 0.8 GB, and up to 1.7 GB while they are read.
const MAX_PIXELS: u64 = 1 << 26;

/// Larger files are refused: so many pixels in 16 bits, not compressed.
const MOST_BYTES: u64 = 8 * MAX_PIXELS + (1 << 20);

/// Memory that a pixel takes while it is decoded \[bytes\]: 8 of 16-bit color, 6 without alpha, 12 of what is kept.
const PIXEL_BYTES: f64 = 20.0;

/// Linear light of a value of the sRGB transfer function (IEC 61966-2-1), both in [0, 1].
fn linear(value: f64) -> f64 {
    if value <= 0.04045 { value / 12.92 } else { libm::pow((value + 0.055) / 1.055, 2.4) }
}

impl Image {
    /// A picture from a PNG file of 8 or 16 bits, grey or in color, whose numbers are decoded by the sRGB transfer
    /// function; what is transparent counts as opaque.
    ///
    /// # Errors     `Error::Scene` with the file's name: missing, not PNG, truncated, too large
    pub fn read(path: &Path) -> Result<Self> {
        let name = path.display();
        let refuse = |what: String| Error::Scene(format!("{name}: {what}"));
        let bytes = crate::input::read(path, MOST_BYTES).map_err(|e| refuse(e.to_string()))?;
        if !bytes.starts_with(b"\x89PNG\r\n\x1a\n") {
            return Err(refuse("no PNG file; allowed: PNG of 8 or 16 bits".into()));
        }
        let broken = |e: image::ImageError| refuse(format!("a damaged or truncated PNG file ({e})"));
        let reader = || image::io::Reader::with_format(std::io::Cursor::new(&bytes), image::ImageFormat::Png);
        let (width, height) = reader().into_dimensions().map_err(broken)?;
        if u64::from(width) * u64::from(height) > MAX_PIXELS {
            return Err(refuse(format!("{width} x {height} pixels; allowed: up to 2^26")));
        }
        let (what, pixels) = (|| format!("{width} x {height} pixels"), f64::from(width) * f64::from(height));
        crate::memory::check(what, PIXEL_BYTES * pixels).map_err(|e| refuse(e.to_string()))?;
        let picture = reader().decode().map_err(broken)?;
        let pixels = if picture.color().bytes_per_pixel() / picture.color().channel_count() == 1 {
            let table: Vec<f32> = (0..=255).map(|i| linear(f64::from(i) / 255.0) as f32).collect();
            picture.into_rgb8().pixels().map(|p| p.0.map(|c| table[usize::from(c)])).collect()
        } else {
            let decode = |c: u16| linear(f64::from(c) / 65535.0) as f32;
            picture.into_rgb16().pixels().map(|p| p.0.map(decode)).collect()
        };
        Image::new(width as usize, height as usize, pixels).map_err(|e| refuse(e.to_string()))
    }

    /// A picture from linear red, green and blue in [0, 1], by rows from the top.
    ///
    /// # Errors     `Error::Scene` or `Error::OutOfRange` for no pixels, too few or too many, or values outside [0, 1]
    pub fn new(width: usize, height: usize, pixels: Vec<[f32; 3]>) -> Result<Self> {
        if width == 0 || height == 0 || width.checked_mul(height) != Some(pixels.len()) {
            return Err(Error::Scene(format!(
                "a picture of {width} x {height} with {} pixels; allowed: at least 1 x 1, with as many pixels",
                pixels.len()
            )));
        }
        match pixels.iter().flatten().find(|c| !(0.0..=1.0).contains(*c)) {
            Some(bad) => Err(Error::out_of_range("a pixel", f64::from(*bad), "0 to 1")),
            None => Ok(Image { width, height, pixels }),
        }
    }

    /// Width and height in pixels.
    pub fn size(&self) -> (usize, usize) {
        (self.width, self.height)
    }

    pub(super) fn at(&self, uv: DVec2) -> Spectrum {
        // The two neighbours along an axis, and the part of the second.
        let between = |x: f64, count: usize| {
            let place = x * count as f64 - 0.5;
            let low = place.floor();
            let wrapped = low.rem_euclid(count as f64);
            // Not finite, or rounded up to the count itself: the first pixel.
            let i = if wrapped < count as f64 { wrapped as usize } else { 0 };
            (i, (i + 1) % count, place - low)
        };
        let (i, i_next, x) = between(uv.x, self.width);
        let (j, j_next, y) = between(1.0 - uv.y, self.height);
        let pixel = |i: usize, j: usize| {
            let [r, g, b] = self.pixels[j * self.width + i].map(f64::from);
            Spectrum::rgb(r, g, b)
        };
        let row = |j: usize| pixel(i, j) * (1.0 - x) + pixel(i_next, j) * x;
        row(j) * (1.0 - y) + row(j_next) * y
    }

    pub(super) fn bounds(&self) -> (Spectrum, Spectrum) {
        let least = |f: fn(f32, f32) -> f32, start: f32| {
            let [r, g, b] = self.pixels.iter().fold([start; 3], |a, p| [0, 1, 2].map(|c| f(a[c], p[c])));
            Spectrum::rgb(r.into(), g.into(), b.into())
        };
        (least(f32::min, 1.0), least(f32::max, 0.0))
    }

    pub(super) fn is_grey(&self) -> bool {
        self.pixels.iter().all(|[r, g, b]| r == g && g == b)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two by two pixels: their centres, the middles between them, and the middles across the border.
    #[test]
    fn bilinear_and_repeated() {
        let (a, b, c, d) = ([0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.5, 0.5, 0.5]);
        let image = Image::new(2, 2, vec![a, b, c, d]).unwrap();
        let rgb = |p: [f32; 3]| Spectrum::rgb(p[0].into(), p[1].into(), p[2].into());
        let at = |u: f64, v: f64| image.at(DVec2::new(u, v));
        // The upper row is the farther one in v.
        assert_eq!((at(0.25, 0.75), at(0.75, 0.75)), (rgb(a), rgb(b)));
        assert_eq!((at(0.25, 0.25), at(0.75, 0.25)), (rgb(c), rgb(d)));
        assert_eq!(at(1.25, -0.25), rgb(a));
        assert_eq!(at(0.5, 0.75), (rgb(a) + rgb(b)) * 0.5);
        assert_eq!(at(0.0, 0.25), (rgb(c) + rgb(d)) * 0.5);
        assert_eq!(at(0.5, 0.5), (rgb(a) + rgb(b) + rgb(c) + rgb(d)) * 0.25);
        assert_eq!(image.bounds(), (Spectrum::ZERO, Spectrum::ONE));
        assert!(at(f64::NAN, 0.5).0.is_nan() && at(-1e-300, 1e300).is_finite());
    }

    /// sRGB from its standard: the linear foot, the joint, the ends and the middle grey.
    #[test]
    fn linear_light_of_srgb() {
        assert_eq!((linear(0.0), linear(1.0)), (0.0, 1.0));
        assert!((linear(0.04045) - 0.003_130_804_953_560_371).abs() < 1e-17);
        assert!((linear(0.5) - 0.214_041_140_482_232_5).abs() < 1e-15);
    }

    /// Files of 8 and 16 bits, grey and in color, and those that are none.
    #[test]
    fn files_are_read_or_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("picture.png");
        image::RgbImage::from_pixel(3, 2, image::Rgb([255, 0, 128])).save(&path).unwrap();
        let picture = Image::read(&path).unwrap();
        assert_eq!(picture.size(), (3, 2));
        assert!((picture.at(DVec2::ZERO)[2] - 0.215_860_500_113_899_2).abs() < 1e-7);
        let bytes = std::fs::read(&path).unwrap();
        image::ImageBuffer::from_pixel(2, 2, image::Luma([32768u16])).save(&path).unwrap();
        let picture = Image::read(&path).unwrap();
        assert!(picture.is_grey() && (picture.at(DVec2::ZERO)[0] - 0.214_048_96).abs() < 1e-6);

        let say = |bytes: &[u8]| {
            std::fs::write(&path, bytes).unwrap();
            Image::read(&path).unwrap_err().to_string()
        };
        for cut in [9, 30, bytes.len() / 2, bytes.len() - 14] {
            assert!(say(&bytes[..cut]).contains("a damaged or truncated PNG file"), "{cut}");
        }
        assert!(say(b"P3 1 1 255").ends_with("no PNG file; allowed: PNG of 8 or 16 bits"));
        assert!(say(b"").ends_with("no PNG file; allowed: PNG of 8 or 16 bits"));
        let missing = Image::read(&folder.path().join("none.png")).unwrap_err().to_string();
        assert!(missing.contains("none.png: No such file"), "{missing}");
        assert!(Image::new(0, 2, Vec::new()).is_err() && Image::new(1, 1, vec![[2.0; 3]]).is_err());
    }
}
