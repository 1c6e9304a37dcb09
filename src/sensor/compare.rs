//! A picture against an unbiased reference of the same camera: how far it is from it, and whether chance would bring that.

use super::film::{Film, Pixel};
use crate::Spectrum;
use crate::integrators::Layer;
use crate::stats::{HEAVY_TAIL, Moments, holm, smallest_detectable_bias, student_p};

/// Family-wise level of the test of all blocks of a comparison.
pub const LEVEL: f64 = 1e-3;
/// Largest side of a block \[pixels\].
const LARGEST_SIDE: u32 = 16;
/// Blocks along the shorter side of a picture that is too small for blocks of the largest side.
const ACROSS: u32 = 8;
/// Fewest samples of a block by paths for a test of it: means of fewer are not normal enough.
const FEWEST_SAMPLES: f64 = 1000.0;
/// Relative difference that roundings of two orders of summation stay below.
const ROUNDING: f64 = 1e-9;

/// What is compared: the total, and each layer.
pub const VALUES: [Option<Layer>; 7] = [
    None,
    Some(Layer::Emission),
    Some(Layer::Direct),
    Some(Layer::Caustic),
    Some(Layer::Indirect),
    Some(Layer::Single),
    Some(Layer::Multiple),
];

/// Mean radiance of a block, by [`VALUES`].
pub type BlockMean = [Spectrum; VALUES.len()];

/// The square blocks of a picture; those at the right and lower rim may be narrower.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Blocks {
    width: u32,
    height: u32,
    side: u32,
}

impl Blocks {
    /// Blocks of 16 pixels, of fewer in a picture that has fewer than 8 such across: a power of 2.
    pub fn of(width: u32, height: u32) -> Self {
        let fitting = (width.min(height) / ACROSS).clamp(1, LARGEST_SIDE);
        Blocks { width, height, side: 1 << fitting.ilog2() }
    }

    /// Side of a block \[pixels\].
    pub fn side(&self) -> u32 {
        self.side
    }

    /// How many there are.
    pub fn count(&self) -> usize {
        (self.columns() * self.height.div_ceil(self.side)) as usize
    }

    fn columns(&self) -> u32 {
        self.width.div_ceil(self.side)
    }

    /// The block of the pixel in column x and row y.
    pub fn at(&self, x: u32, y: u32) -> usize {
        (y / self.side * self.columns() + x / self.side) as usize
    }

    /// The block of each pixel of a film.
    fn pixels<'a>(&self, film: &'a Film) -> impl Iterator<Item = (usize, &'a Pixel)> + use<'a> {
        let (blocks, width) = (*self, film.width() as usize);
        let at = move |number: usize| blocks.at((number % width) as u32, (number / width) as u32);
        film.pixels().iter().enumerate().map(move |(number, pixel)| (at(number), pixel))
    }

    /// Pixels of each block.
    fn sizes(&self) -> Vec<f64> {
        let mut sizes = vec![0.0; self.count()];
        for y in 0..self.height {
            (0..self.width).for_each(|x| sizes[self.at(x, y)] += 1.0);
        }
        sizes
    }

    /// Means over the blocks of a film of this size.
    pub fn means(&self, film: &Film) -> Vec<BlockMean> {
        let mut means = vec![[Spectrum::ZERO; VALUES.len()]; self.count()];
        let sizes = self.sizes();
        for (block, pixel) in self.pixels(film) {
            for (mean, layer) in means[block].iter_mut().zip(VALUES) {
                *mean += pixel.mean_of(layer) / sizes[block];
            }
        }
        means
    }
}

/// Variance of the mean of a pixel, of a layer or in total; 0 where there is none.
pub(super) fn variance(pixel: &Pixel, layer: Option<Layer>) -> Spectrum {
    pixel.variance_of(layer).unwrap_or(Spectrum::ZERO)
}

/// What is known of the error of the picture itself.
#[derive(Debug, Clone, Copy)]
pub enum PictureError<'a> {
    /// Nothing: its pixels share the photons of one map.
    Unknown,
    /// Its pixels are independent, and know their variances: paths.
    ByPixel,
    /// Block means of each of several independent pictures, of a map each, whose mean it is.
    ByMap(&'a [Vec<BlockMean>]),
}

/// How far a picture is from its reference, in total or in one layer.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Comparison {
    /// The layer; none for the total.
    pub layer: Option<Layer>,
    /// Mean over the picture's pixels and channels [W/(L^2 sr)].
    pub mean: f64,
    /// The same of the reference.
    pub reference: f64,
    /// Standard error of their difference; that of the reference alone where the picture's is unknown.
    pub std_error: f64,
    /// Root mean square error over pixels and channels, without the reference's noise [W/(L^2 sr)].
    pub rmse: f64,
    /// Its standard error by the reference's noise, for this very picture.
    pub rmse_error: f64,
    /// What the blocks say, where the picture's error is known.
    pub test: Option<BlockTest>,
}

/// Blocks of a picture against those of its reference.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BlockTest {
    /// Blocks with light of either side.
    pub blocks: usize,
    /// Those that differ in a channel, after Holm over all blocks, channels and layers.
    pub differ: usize,
    /// Those without a verdict: fewer than 1000 samples, the reference found nothing in them, or a few of its pixels carry its variance.
    pub undecided: usize,
    /// Smallest bias of the mean that is hardly ever missed [W/(L^2 sr)].
    pub smallest: f64,
}

/// A mean with its variance and degrees of freedom.
#[derive(Clone, Copy)]
struct Known {
    mean: f64,
    variance: f64,
    freedom: f64,
}

impl Known {
    fn of(moments: &Moments) -> Self {
        let error = moments.std_error();
        Known { mean: moments.mean(), variance: error * error, freedom: (moments.n() - 1) as f64 }
    }
}

/// Standard error of a difference, and its degrees of freedom (Welch 1947), rounded down.
fn welch(a: Known, b: Known) -> (f64, u64) {
    let sum = a.variance + b.variance;
    let spread = a.variance * a.variance / a.freedom + b.variance * b.variance / b.freedom;
    let freedom = if spread > 0.0 { sum * sum / spread } else { a.freedom.min(b.freedom) };
    (sum.sqrt(), (freedom as u64).max(1))
}

/// Sums over independent pixels of one block and channel.
#[derive(Clone, Copy, Default)]
struct Sums {
    value: f64,
    variance: f64,
    squares: f64,
}

impl Sums {
    fn add(&mut self, value: f64, variance: f64) {
        self.value += value;
        self.variance += variance;
        self.squares += variance * variance;
    }

    /// Whether few pixels carry the variance.
    fn is_heavy_tailed(&self) -> bool {
        self.squares > HEAVY_TAIL * self.variance * self.variance
    }

    /// The mean over so many pixels, of so many samples each.
    fn known(&self, pixels: f64, samples: u64) -> Known {
        let of_pixel = (samples.max(2) - 1) as f64;
        // Satterthwaite 1946.
        let freedom = if self.squares > 0.0 { self.variance * self.variance / self.squares } else { pixels };
        Known {
            mean: self.value / pixels,
            variance: self.variance / (pixels * pixels),
            freedom: freedom * of_pixel,
        }
    }
}

/// A p-value on its way to Holm: which value, which block.
struct Tested {
    value: usize,
    block: usize,
    p: f64,
}

/// Compares a picture with a reference of independent pixels, with at least two samples each, in total and by layer; layers
/// that neither has are left out.
///
/// The mean square error over pixels is that of the differences less the variances that the reference states: nothing of it
/// is the reference's noise, in the mean. Blocks are tested where the picture's own error is known, every channel by Student's t
/// (Welch), all of them by Holm at [`LEVEL`].
///
/// # Arguments
/// `channels` 1 where the scene is grey, else 3
///
/// # Panics
/// If the films differ in size.
pub fn compare(
    blocks: Blocks,
    picture: &Film,
    reference: &Film,
    error: PictureError<'_>,
    channels: usize,
) -> Vec<Comparison> {
    let size = |film: &Film| (film.width(), film.height());
    assert_eq!(size(picture), size(reference), "films of one picture");
    let (mut compared, mut tested) = (Vec::new(), Vec::new());
    for (number, layer) in VALUES.into_iter().enumerate() {
        let Some((comparison, tests)) = one(blocks, picture, reference, error, channels, number) else {
            continue;
        };
        debug_assert_eq!(comparison.layer, layer);
        tested.extend(tests.into_iter().map(|(block, p)| Tested { value: compared.len(), block, p }));
        compared.push(comparison);
    }
    let adjusted = holm(&tested.iter().map(|test| test.p).collect::<Vec<_>>());
    let mut last = None;
    for (test, adjusted) in tested.iter().zip(adjusted) {
        let place = (test.value, test.block);
        // The channels of a block follow each other.
        if adjusted <= LEVEL && last != Some(place) {
            last = Some(place);
            if let Some(blocks) = &mut compared[test.value].test {
                blocks.differ += 1;
            }
        }
    }
    compared
}

/// One value of [`VALUES`], and the p-values of its blocks.
fn one(
    blocks: Blocks,
    picture: &Film,
    reference: &Film,
    error: PictureError<'_>,
    channels: usize,
    number: usize,
) -> Option<(Comparison, Vec<(usize, f64)>)> {
    let layer = VALUES[number];
    let pixels = picture.pixels().len() as f64;
    let (mut square, mut square_variance) = (0.0, 0.0);
    let mut ours = vec![[Sums::default(); 3]; blocks.count()];
    let mut theirs = vec![[Sums::default(); 3]; blocks.count()];
    // Over all pixels, the three channels of one as wholly correlated.
    let (mut all_ours, mut all_theirs) = (Sums::default(), Sums::default());
    let n = reference.samples() as f64;
    for ((block, mine), other) in blocks.pixels(picture).zip(reference.pixels()) {
        let (x, y) = (mine.mean_of(layer), other.mean_of(layer));
        let (vx, vy) = (variance(mine, layer), variance(other, layer));
        let (mut of_pixel, mut noise) = (0.0, 0.0);
        for c in 0..3 {
            let d = x[c] - y[c];
            of_pixel += (d * d - vy[c]) / 3.0;
            // (y - truth)^2 - vy is a mean over pairs of samples, of variance 2 vy^2 n/(n - 1); 2 d (y - truth) has 4 d^2 vy.
            let square = 4.0 * (d * d - vy[c]) * vy[c] + 2.0 * vy[c] * vy[c] * n / (n - 1.0);
            noise += square.max(0.0).sqrt() / 3.0;
            ours[block][c].add(x[c], vx[c]);
            theirs[block][c].add(y[c], vy[c]);
        }
        square += of_pixel / pixels;
        square_variance += noise * noise / (pixels * pixels);
        let wholly = |v: Spectrum| {
            let deviation = v.map(f64::sqrt).mean();
            deviation * deviation
        };
        all_ours.add(x.mean(), wholly(vx));
        all_theirs.add(y.mean(), wholly(vy));
    }
    let (mean, of_reference) = (all_ours.value / pixels, all_theirs.known(pixels, reference.samples()));
    if mean == 0.0 && of_reference.mean == 0.0 && square == 0.0 {
        return None;
    }
    let of_all = match error {
        PictureError::Unknown => None,
        PictureError::ByPixel => Some(all_ours.known(pixels, picture.samples())),
        PictureError::ByMap(maps) => Some(Known::of(&whole_means(blocks, maps, number))),
    };
    let (std_error, freedom) =
        of_all.map_or((of_reference.variance.sqrt(), 1), |own| welch(own, of_reference));
    let mut tests = Vec::new();
    let test = of_all.map(|_| {
        let smallest = smallest_detectable_bias(std_error, freedom);
        let mut test = BlockTest { blocks: 0, differ: 0, undecided: 0, smallest };
        for (block, size) in blocks.sizes().into_iter().enumerate() {
            let (mut has_light, mut is_undecided) = (false, false);
            for c in 0..channels {
                let other = theirs[block][c].known(size, reference.samples());
                let own = match error {
                    PictureError::ByMap(maps) => {
                        Known::of(&maps.iter().map(|map| map[block][number][c]).collect())
                    }
                    _ => ours[block][c].known(size, picture.samples()),
                };
                if own.mean == 0.0 && other.mean == 0.0 {
                    continue;
                }
                has_light = true;
                let is_by_pixel = matches!(error, PictureError::ByPixel);
                let found_nothing = other.mean == 0.0 || is_by_pixel && own.mean == 0.0;
                let is_heavy =
                    theirs[block][c].is_heavy_tailed() || is_by_pixel && ours[block][c].is_heavy_tailed();
                let samples = if is_by_pixel { n.min(picture.samples() as f64) } else { n };
                let are_few = size * samples < FEWEST_SAMPLES;
                // A block of few pixels has no tail to speak of: one pixel carries all of it.
                if found_nothing || are_few || is_heavy && size > 2.0 / HEAVY_TAIL {
                    is_undecided = true;
                    continue;
                }
                let (std_error, freedom) = welch(own, other);
                let difference = (own.mean - other.mean).abs();
                let p = match () {
                    () if difference <= ROUNDING * other.mean.abs() => 1.0,
                    () if std_error == 0.0 => 0.0,
                    () => student_p(difference / std_error, freedom),
                };
                tests.push((block, p));
            }
            test.blocks += usize::from(has_light);
            test.undecided += usize::from(is_undecided);
        }
        test
    });
    let deviation = square_variance.sqrt();
    let root = |x: f64| x.max(0.0).sqrt();
    let comparison = Comparison {
        layer,
        mean,
        reference: of_reference.mean,
        std_error,
        rmse: root(square),
        // Of a root; where the square is within its own error of 0, that of the error's own root.
        rmse_error: 0.5 * deviation / root(square.max(deviation)).max(f64::MIN_POSITIVE),
        test,
    };
    Some((comparison, tests))
}

/// The mean over pixels and channels of each map.
fn whole_means(blocks: Blocks, maps: &[Vec<BlockMean>], number: usize) -> Moments {
    let sizes = blocks.sizes();
    let all: f64 = sizes.iter().sum();
    let mean = |map: &Vec<BlockMean>| {
        map.iter().zip(&sizes).map(|(block, size)| block[number].mean() * size / all).sum::<f64>()
    };
    maps.iter().map(mean).collect()
}

/// Luminance of a block over that of the reference, less 1; none without light in the reference.
pub fn luminance_errors(blocks: Blocks, picture: &Film, reference: &Film) -> Vec<Option<f64>> {
    let luminance = |block: &BlockMean| 0.2126 * block[0][0] + 0.7152 * block[0][1] + 0.0722 * block[0][2];
    let (ours, theirs) = (blocks.means(picture), blocks.means(reference));
    let error = |(own, other): (&BlockMean, &BlockMean)| {
        let (own, other) = (luminance(own), luminance(other));
        (other > 0.0).then(|| own / other - 1.0)
    };
    ours.iter().zip(&theirs).map(error).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::integrators::Layers;
    use crate::rng::{Purpose, Stream};
    use crate::sensor::Sample;

    const SIDE: u32 = 32;

    /// Light of the direct and the single layer, one mean for all pixels, each pixel with noise of its own and what is added to its
    /// direct light.
    fn film(set: u64, samples: u64, noise: f64, added: impl Fn(u32, u32) -> f64) -> Film {
        let mut film = Film::new(SIDE, SIDE);
        for (y, x) in (0..SIDE).flat_map(|y| (0..SIDE).map(move |x| (y, x))) {
            let mut stream = Stream::new(5, Purpose::Synthetic, set, u64::from(y * SIDE + x));
            for _ in 0..samples {
                let direct = 1.0 + added(x, y) + noise * (stream.unit() - 0.5) * 12.0f64.sqrt();
                let layers =
                    Layers { direct: Spectrum::grey(direct), single: Spectrum::grey(0.5), ..Layers::ZERO };
                film.pixel_mut(x, y).push(&Sample::from(layers));
            }
        }
        film
    }

    fn total(compared: &[Comparison]) -> Comparison {
        *compared.iter().find(|one| one.layer.is_none()).unwrap()
    }

    /// Errors of 0.1 against references whose own noise is as large: the noise is no part of the answer, and errors of it over 200
    /// references are as large as stated, the RMS of z within 4 of its standard errors, 1/sqrt(400). Without the subtraction the
    /// answer would be 0.141.
    #[test]
    fn noise_of_the_reference_is_no_error_of_the_picture() {
        let error = |x: u32, _: u32| if x.is_multiple_of(2) { 0.1 } else { -0.1 };
        let picture = film(0, 1, 0.0, error);
        let blocks = Blocks::of(SIDE, SIDE);
        let mut squares = 0.0;
        for set in 1..=200 {
            let reference = film(set, 16, 0.4, |_, _| 0.0);
            let total = total(&compare(blocks, &picture, &reference, PictureError::Unknown, 1));
            assert!(total.test.is_none() && (total.rmse - 0.1).abs() < 0.02, "{total:?}");
            let z = (total.rmse - 0.1) / total.rmse_error;
            squares += z * z / 200.0;
        }
        assert!((squares.sqrt() - 1.0).abs() < 0.2, "{}", squares.sqrt());
    }

    /// Layers without light are left out; those that agree to the last bit differ nowhere.
    #[test]
    fn layers_are_told_apart() {
        let (picture, reference) = (film(0, 8, 0.1, |_, _| 0.0), film(1, 8, 0.1, |_, _| 0.0));
        let compared = compare(Blocks::of(SIDE, SIDE), &picture, &reference, PictureError::ByPixel, 1);
        let names: Vec<_> = compared.iter().map(|one| one.layer).collect();
        assert_eq!(names, [None, Some(Layer::Direct), Some(Layer::Single)]);
        let single = compared[2];
        assert_eq!((single.mean, single.rmse), (0.5, 0.0));
        for one in &compared {
            let test = one.test.unwrap();
            assert_eq!((test.blocks, test.differ), (64, 0), "{one:?}");
        }
        // 1024 pixels, twice 8 samples of deviation 0.1.
        let expected = 0.1 * (2.0f64 / (8.0 * 1024.0)).sqrt();
        assert!((compared[0].std_error / expected - 1.0).abs() < 0.05, "{}", compared[0].std_error);
    }

    /// Maps whose pixels share their noise in a block: none differs of right ones; one that is a quarter too bright does, and so does
    /// its layer. 16 maps of deviation 0.05: standard errors of 0.0125.
    #[test]
    fn blocks_of_maps_are_tested_by_their_spread() {
        let blocks = Blocks::of(SIDE, SIDE);
        let reference = film(1000, 64, 0.1, |_, _| 0.0);
        for (bias, differ) in [(0.0, 0), (0.25, 1)] {
            let mut all = Film::new(SIDE, SIDE);
            let mut means = Vec::new();
            for map in 0..16 {
                let of_block = |block: usize| {
                    let mut stream = Stream::new(6, Purpose::Synthetic, map, block as u64);
                    0.05 * (stream.unit() - 0.5) * 12.0f64.sqrt() + if block == 17 { bias } else { 0.0 }
                };
                let film = film(map, 1, 0.0, |x, y| of_block(blocks.at(x, y)));
                means.push(blocks.means(&film));
                all.push_film(&film);
            }
            let compared = compare(blocks, &all, &reference, PictureError::ByMap(&means), 1);
            let counts: Vec<_> = compared.iter().map(|one| one.test.unwrap().differ).collect();
            assert_eq!(counts, [differ, differ, 0], "bias {bias}");
            let errors = luminance_errors(blocks, &all, &reference);
            assert!((errors[17].unwrap() - bias / 1.5).abs() < 0.04, "{:?}", errors[17]);
        }
    }

    #[test]
    fn blocks_share_out_all_pixels() {
        for (width, height, side, count) in
            [(512, 256, 16, 512), (100, 70, 8, 13 * 9), (5, 3, 1, 15), (1, 1, 1, 1)]
        {
            let blocks = Blocks::of(width, height);
            assert_eq!((blocks.side(), blocks.count()), (side, count));
            assert_eq!(blocks.sizes().iter().sum::<f64>(), f64::from(width * height));
        }
    }
}
