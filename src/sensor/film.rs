//! The film: what the samples of each pixel brought, by layer.

use crate::Spectrum;
use crate::integrators::{Layer, Layers};

/// Layers, and their total behind them.
const VALUES: usize = Layer::ALL.len() + 1;
const TOTAL: usize = Layer::ALL.len();
/// Bytes of a pixel: samples, photons, means and squared deviations by channel.
const PIXEL_BYTES: usize = 8 * (2 + 2 * 3 * VALUES);

/// What one sample of a pixel brings.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Sample {
    /// Radiance by class [W/(L^2 sr)].
    pub layers: Layers,
    /// Photons that its estimates took; 0 for paths.
    pub photons: f64,
}

impl From<Layers> for Sample {
    fn from(layers: Layers) -> Self {
        Sample { layers, photons: 0.0 }
    }
}

/// Means and variances of one pixel, by Welford's recurrence: no digit is lost where the mean is large.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Pixel {
    n: u64,
    mean: [Spectrum; VALUES],
    /// Sums of squared deviations from the mean.
    squares: [Spectrum; VALUES],
    photons: f64,
}

impl Pixel {
    /// Counts a sample.
    pub fn push(&mut self, sample: &Sample) {
        self.n += 1;
        let n = self.n as f64;
        self.photons += (sample.photons - self.photons) / n;
        for i in 0..VALUES {
            let value = Layer::ALL.get(i).map_or_else(|| sample.layers.total(), |l| sample.layers[*l]);
            let before = value - self.mean[i];
            self.mean[i] += before / n;
            self.squares[i] += before * (value - self.mean[i]);
        }
    }

    /// Samples, or films, behind the means.
    pub fn n(&self) -> u64 {
        self.n
    }

    /// Mean radiance by class [W/(L^2 sr)].
    pub fn layers(&self) -> Layers {
        let mut layers = Layers::ZERO;
        for (i, layer) in Layer::ALL.into_iter().enumerate() {
            layers[layer] = self.mean[i];
        }
        layers
    }

    /// Mean radiance [W/(L^2 sr)].
    pub fn total(&self) -> Spectrum {
        self.mean[TOTAL]
    }

    /// Variance of the mean radiance; none with fewer than two samples.
    pub fn variance(&self) -> Option<Spectrum> {
        self.variance_at(TOTAL)
    }

    /// Variance of the mean radiance of a class; none with fewer than two samples.
    pub fn layer_variance(&self, layer: Layer) -> Option<Spectrum> {
        self.variance_at(layer as usize)
    }

    /// Mean radiance of a class, or of all [W/(L^2 sr)].
    pub fn mean_of(&self, layer: Option<Layer>) -> Spectrum {
        self.mean[layer.map_or(TOTAL, |layer| layer as usize)]
    }

    /// Variance of it; none with fewer than two samples.
    pub fn variance_of(&self, layer: Option<Layer>) -> Option<Spectrum> {
        self.variance_at(layer.map_or(TOTAL, |layer| layer as usize))
    }

    fn variance_at(&self, index: usize) -> Option<Spectrum> {
        let n = self.n as f64;
        (self.n >= 2).then(|| self.squares[index] / (n * (n - 1.0)))
    }

    /// Photons that a sample's estimates took, mean over samples.
    pub fn photons(&self) -> f64 {
        self.photons
    }

    /// The mean as one sample.
    fn as_sample(&self) -> Sample {
        Sample { layers: self.layers(), photons: self.photons }
    }
}

/// A picture on its way: a pixel each, row by row from the top.
#[derive(Debug, Clone, PartialEq)]
pub struct Film {
    width: u32,
    height: u32,
    pixels: Vec<Pixel>,
}

impl Film {
    /// An empty film.
    pub fn new(width: u32, height: u32) -> Self {
        Film { width, height, pixels: vec![Pixel::default(); width as usize * height as usize] }
    }

    /// Pixels across.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Pixels down.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// Every pixel, row by row from the top.
    pub fn pixels(&self) -> &[Pixel] {
        &self.pixels
    }

    /// Every pixel, to be changed.
    pub(super) fn pixels_mut(&mut self) -> &mut [Pixel] {
        &mut self.pixels
    }

    /// The pixel in column x and row y.
    pub fn pixel(&self, x: u32, y: u32) -> &Pixel {
        &self.pixels[y as usize * self.width as usize + x as usize]
    }

    /// The same, to be changed.
    pub fn pixel_mut(&mut self, x: u32, y: u32) -> &mut Pixel {
        &mut self.pixels[y as usize * self.width as usize + x as usize]
    }

    /// Samples a pixel, which all pixels have alike.
    pub fn samples(&self) -> u64 {
        self.pixels.first().map_or(0, Pixel::n)
    }

    /// Counts a whole film as one sample of each pixel.
    ///
    /// With independent films, of a photon map each, means are then those over maps, and variances those between maps:
    /// the pixels of one map share its photons, so that its own samples cannot tell how far it is off.
    ///
    /// # Panics
    /// If the films differ in size.
    pub fn push_film(&mut self, other: &Film) {
        assert_eq!((self.width, self.height), (other.width, other.height), "films of one picture");
        for (mine, others) in self.pixels.iter_mut().zip(&other.pixels) {
            mine.push(&others.as_sample());
        }
    }

    /// Adds the means of a film that holds the photons of one part of a map's histories, one of so many whose mean is that of
    /// the map; variances stay unknown.
    ///
    /// # Panics
    /// If the films differ in size.
    pub fn add_part(&mut self, other: &Film, parts: u64) {
        assert_eq!((self.width, self.height), (other.width, other.height), "films of one picture");
        for (mine, others) in self.pixels.iter_mut().zip(&other.pixels) {
            mine.n = 1;
            for (mean, other) in mine.mean.iter_mut().zip(others.mean) {
                *mean += other / parts as f64;
            }
            // Each part found its own.
            mine.photons += others.photons;
        }
    }

    /// Every number of the film, eight bytes each from the lowest: what goes on from them has the same bits.
    pub fn to_bytes(&self) -> Vec<u8> {
        let spectra = |pixel: &Pixel| pixel.mean.into_iter().chain(pixel.squares).collect::<Vec<_>>();
        let mut bytes = Vec::with_capacity(self.pixels.len() * PIXEL_BYTES);
        for pixel in &self.pixels {
            bytes.extend(pixel.n.to_le_bytes());
            bytes.extend(pixel.photons.to_le_bytes());
            for spectrum in spectra(pixel) {
                (0..3).for_each(|channel| bytes.extend(spectrum[channel].to_le_bytes()));
            }
        }
        bytes
    }

    /// How many bytes those of a film take.
    pub fn byte_count(width: u32, height: u32) -> u64 {
        u64::from(width) * u64::from(height) * PIXEL_BYTES as u64
    }

    /// The film of these bytes; none unless they are as many as its pixels take, every number finite, no square negative, and all
    /// pixels of as many samples, 1 to 4294967295.
    pub fn from_bytes(width: u32, height: u32, bytes: &[u8]) -> Option<Film> {
        let mut film = Film::new(width, height);
        if bytes.len() != film.pixels.len() * PIXEL_BYTES {
            return None;
        }
        for (pixel, bytes) in film.pixels.iter_mut().zip(bytes.chunks_exact(PIXEL_BYTES)) {
            let mut words =
                bytes.chunks_exact(8).filter_map(|word| Some(u64::from_le_bytes(word.try_into().ok()?)));
            pixel.n = words.next()?;
            let mut number = || words.next().map(f64::from_bits).filter(|x| x.is_finite());
            pixel.photons = number()?;
            for spectrum in pixel.mean.iter_mut().chain(&mut pixel.squares) {
                *spectrum = Spectrum::rgb(number()?, number()?, number()?);
            }
            if pixel.photons < 0.0 || pixel.squares.iter().any(|square| square.min() < 0.0) {
                return None;
            }
        }
        let samples = film.samples();
        let is_count = (1..=u64::from(u32::MAX)).contains(&samples);
        (is_count && film.pixels.iter().all(|pixel| pixel.n == samples)).then_some(film)
    }

    /// Independent films of one size as one: means over films, variances between them.
    ///
    /// # Panics
    /// If there is none, or they differ in size.
    pub fn combined(films: &[Film]) -> Film {
        let mut all = Film::new(films[0].width, films[0].height);
        films.iter().for_each(|film| all.push_film(film));
        all
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::{Purpose, Stream};
    use crate::stats::{normal_critical, student_critical};

    fn sample(direct: f64, single: f64) -> Sample {
        let (direct, single) = (Spectrum::rgb(direct, 2.0 * direct, 0.0), Spectrum::grey(single));
        Layers { direct, single, ..Layers::ZERO }.into()
    }

    /// Four numbers by hand, on a large offset that a sum of squares would not survive.
    #[test]
    fn means_and_variances_of_the_mean() {
        let mut pixel = Pixel::default();
        assert_eq!(pixel.variance(), None);
        for x in [1.0, 2.0, 4.0, 9.0] {
            pixel.push(&sample(1e9 + x, -1e9));
        }
        assert_eq!((pixel.n(), pixel.total()[0], pixel.layers().direct[1]), (4, 4.0, 2e9 + 8.0));
        // Squared deviations 9 + 4 + 0 + 25 = 38, over 4 and 3.
        let near = |a: f64, b: f64| (a / b - 1.0).abs() < 1e-6;
        assert!(near(pixel.variance().unwrap()[0], 38.0 / 12.0));
        assert!(near(pixel.layer_variance(Layer::Direct).unwrap()[1], 4.0 * 38.0 / 12.0));
        assert_eq!(pixel.layer_variance(Layer::Single), Some(Spectrum::ZERO));
        assert_eq!(pixel.layer_variance(Layer::Caustic), Some(Spectrum::ZERO));
    }

    /// The variance between films is that of their means, whatever varies within them.
    #[test]
    fn films_are_samples_of_a_combined_film() {
        let film = |values: [f64; 2]| {
            let mut film = Film::new(2, 1);
            for value in values {
                film.pixel_mut(1, 0).push(&Sample { photons: value, ..sample(value, 0.0) });
            }
            film
        };
        let all = Film::combined(&[film([0.0, 2.0]), film([100.0, -98.0]), film([4.0, 4.0])]);
        let pixel = all.pixel(1, 0);
        // Means 1, 1, 4: squared deviations 1 + 1 + 4, over 3 and 2.
        assert_eq!((pixel.n(), pixel.total()[0], pixel.photons()), (3, 2.0, 2.0));
        assert!((pixel.variance().unwrap()[0] - 1.0).abs() < 1e-15);
    }

    /// Intervals of Student's t from the variance of the mean cover the true mean as often as they say: 5 samples of
    /// unit numbers a pixel, 20,000 pixels, four seeds. Without the root of n, or with n for n - 1, they would not.
    #[test]
    fn intervals_cover() {
        let (pixels, samples, level) = (20_000u64, 5, 0.1);
        let critical = student_critical(level, samples - 1);
        for seed in 0..4 {
            let mut covered = 0u64;
            for history in 0..pixels {
                let mut stream = Stream::new(seed, Purpose::Synthetic, 0, history);
                let mut pixel = Pixel::default();
                for _ in 0..samples {
                    // The sum of four: near enough to normal that the coverage is right to 0.2 per cent.
                    pixel.push(&sample((0..4).map(|_| stream.unit()).sum(), 0.0));
                }
                let error = pixel.variance().unwrap()[0].sqrt();
                covered += u64::from((pixel.total()[0] - 2.0).abs() < critical * error);
            }
            let rate = covered as f64 / pixels as f64;
            let error = (level * (1.0 - level) / pixels as f64).sqrt();
            let allowed = normal_critical(1e-6) * error + 0.002;
            assert!((rate - (1.0 - level)).abs() < allowed, "seed {seed}: {rate}");
        }
    }
}
