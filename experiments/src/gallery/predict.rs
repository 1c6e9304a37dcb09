//! What blur and edges do to each pixel of a photon-mapped picture, predicted before anything is compared.
//!
//! A gather averages the layer that it estimates over its disc or ball: the blur of a pixel is the mean of the layer over
//! the footprint, minus the layer. The layers come from two replicates with many more photons, whose own blur is smaller, and
//! which take no part in the comparison. Where a layer curves evenly the mean over a footprint differs from the layer in
//! proportion to the mean square distance from the middle: means over the pixels of the footprint and of half of it, and
//! those distances, tell what a disc or ball does that is no whole number of pixels. Noise must not be taken for blur, and
//! the two replicates share none: the product of their two blurs, each the mean of a pixel and its neighbours, has the mean
//! of the blur's square. It is averaged over 5 x 5 pixels, and its root is the blur.
//!
//! Of media it is the mean along the way through them that is averaged: that the way of the next pixel is longer blurs
//! nothing. What balls bring from farther or nearer on the way of the eye itself is not predicted: before a dark face in
//! the shade that is light from beyond the shadow, and the k nearest reach for it. Pictures with such places keep the
//! reach short.
//!
//! A disc that reaches over the edge of its surface, or under a body that stands there, misses nothing: estimates are divided
//! by the part of their kernel that lies on the surface. A ball beside a wall misses its cap; along a ray that ends at a wall
//! that is r times the integral of (1-s)^2 (2+s)/4 over s from 0 to 1, 3/16, over the cosine and the length of the way,
//! unless the estimate is divided by the part of its kernel that lies inside, as at the faces of a region of fog.

use super::Grid;
use super::look::View;
use glam::DVec3;
use turbid::integrators::{Layer, Layers, mapper};
use turbid::transport::in_parallel;

/// Largest reach of a footprint \[pixels\]; a larger one is taken as this.
const REACH: f64 = 40.0;

/// How far the gathers of a pixel reach \[L\]; 0 of a map that is not seen directly.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Radii {
    /// Of the global map, where the eye looks.
    pub global: f64,
    /// Of the caustic map.
    pub caustic: f64,
    /// Of the volume map.
    pub volume: f64,
}

/// Mean square distance of a gather's kernel from its middle, as the eye sees it, over the square of the radius.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spreads {
    /// Of the global map's discs.
    pub global: f64,
    /// Of the caustic map's discs.
    pub caustic: f64,
    /// Of the volume map's balls, across the way of the eye.
    pub volume: f64,
}

impl Spreads {
    /// Of the kernels that a picture is read with.
    pub fn of(settings: &mapper::Settings) -> Self {
        Spreads {
            global: settings.global.0.disc_m2(),
            caustic: settings.caustic.0.disc_m2(),
            volume: settings.volume.kernel.m2() * 2.0 / 3.0,
        }
    }
}

/// Pixels to either side over which blurs are averaged, and then products of two.
const SMOOTH: (i64, i64) = (1, 2);

/// The relative error that blur and edges may cause, by pixel: a bound, the sum of the absolute values of all terms.
///
/// # Arguments   `halves` layers by pixel of two independent replicates; `pixel` angle between neighbouring pixels \[rad\]
pub fn predicted(
    grid: Grid,
    views: &[View],
    halves: [&[Layers]; 2],
    radii: &[Radii],
    spreads: Spreads,
    pixel: f64,
) -> Vec<f64> {
    let of = |i: usize, layer: Layer| 0.5 * (halves[0][i][layer].sum() + halves[1][i][layer].sum());
    let total = |i: usize| 0.5 * (halves[0][i].total().sum() + halves[1][i].total().sum());
    let floor = 0.01 * (0..grid.pixels()).map(total).sum::<f64>() / grid.pixels() as f64;
    let all = |f: &(dyn Fn(usize) -> f64 + Sync)| in_parallel(grid.pixels(), f);
    let mut errors = all(&|i| missing(&views[i], radii[i], |layer| of(i, layer)));
    for layer in [Layer::Indirect, Layer::Caustic, Layer::Multiple] {
        let [one, other] = halves.map(|half| {
            let blurs = all(&|i| blurred(grid, i, layer, views, half, (radii[i], spreads), pixel));
            all(&|i| smoothed(grid, i, SMOOTH.0, &blurs))
        });
        let products: Vec<f64> = one.iter().zip(&other).map(|(a, b)| a * b).collect();
        let squares = all(&|i| smoothed(grid, i, SMOOTH.1, &products));
        errors.iter_mut().zip(squares).for_each(|(error, square)| *error += square.max(0.0).sqrt());
    }
    errors
        .iter()
        .enumerate()
        .map(|(i, e)| if total(i) > 0.0 { e / total(i).max(floor) } else { 0.0 })
        .collect()
}

/// What one layer of a pixel gains by blur.
fn blurred(
    grid: Grid,
    i: usize,
    layer: Layer,
    views: &[View],
    layers: &[Layers],
    (radii, spreads): (Radii, Spreads),
    pixel: f64,
) -> f64 {
    let view = &views[i];
    let (length, middle) = view.medium;
    let on_surface = |radius: f64, spread: f64| {
        if radius <= 0.0 || view.surface.is_none() {
            return 0.0;
        }
        let value = |j: usize| is_same_surface(view, &views[j]).then(|| layers[j][layer].sum());
        blur(grid, i, radius / view.distance / pixel, spread, value)
    };
    match layer {
        Layer::Indirect => on_surface(radii.global, spreads.global),
        Layer::Caustic => on_surface(radii.caustic, spreads.caustic),
        Layer::Multiple if radii.volume > 0.0 && length > 0.0 => {
            blur(grid, i, radii.volume / middle / pixel, spreads.volume, |j| {
                let near = (views[j].distance - view.distance).abs() <= 2.0 * radii.volume;
                let (other, _) = views[j].medium;
                (near && other > 0.0).then(|| layers[j][layer].sum() * length / other)
            })
        }
        _ => 0.0,
    }
}

/// What a pixel's balls miss beyond a wall.
fn missing(view: &View, radii: Radii, of: impl Fn(Layer) -> f64) -> f64 {
    let (length, _) = view.medium;
    if radii.volume > 0.0 && length > 0.0 && view.surface.is_some() && !view.is_at_face {
        let cap = (3.0 / 16.0 * radii.volume / view.cosine.max(0.05) / length).min(1.0);
        return cap * of(Layer::Multiple);
    }
    0.0
}

/// The mean of the values up to `far` pixels away in both directions.
fn smoothed(grid: Grid, i: usize, far: i64, values: &[f64]) -> f64 {
    let (width, height) = (grid.width as i64, grid.height as i64);
    let (x, y) = (i as i64 % width, i as i64 / width);
    let (mut sum, mut count) = (0.0, 0.0);
    for py in (y - far).max(0)..=(y + far).min(height - 1) {
        for px in (x - far).max(0)..=(x + far).min(width - 1) {
            sum += values[(py * width + px) as usize];
            count += 1.0;
        }
    }
    sum / count
}

/// Radius within which the k nearest photons lie where a layer of radiance L leaves a surface: the irradiance pi L/0.7 of
/// a surface of reflectance 0.7, over the power of a photon, is their number by area \[L\].
///
/// # Arguments   `power` of a photon, summed over channels \[W\]; `radiance` summed too; `largest` what gathers may reach
pub fn radius(k: usize, power: f64, radiance: f64, largest: f64) -> f64 {
    let density = std::f64::consts::PI * radiance / 0.7 / power;
    (k as f64 / (std::f64::consts::PI * density)).sqrt().min(largest)
}

/// Whether two pixels see one smooth surface.
fn is_same_surface(a: &View, b: &View) -> bool {
    let same = |(p, n): (DVec3, DVec3), (q, m): (DVec3, DVec3)| {
        n.dot(m) > 0.9 && (q - p).dot(n).abs() <= 0.2 * (q - p).length() + 1e-9
    };
    matches!((a.surface, b.surface), (Some(a), Some(b)) if same(a, b))
}

/// The blur that a footprint of this radius \[pixels\] causes.
///
/// # Arguments   `spread` mean square distance from its middle, over the square of the radius
fn blur(grid: Grid, i: usize, radius: f64, spread: f64, value: impl Fn(usize) -> Option<f64>) -> f64 {
    let radius = radius.min(REACH);
    let (x, y) = ((i % grid.width) as i64, (i / grid.width) as i64);
    // At most some 300 pixels are looked at: of a large footprint every second, third... in both directions; of one smaller
    // than a pixel the neighbours.
    let far = radius.max(1.0);
    let (reach, step) = (far.floor() as i64, (far / 9.0).ceil() as i64);
    let (mut wide, mut narrow) = (Mean::default(), Mean::default());
    for dy in (-reach..=reach).filter(|d| d % step == 0) {
        for dx in (-reach..=reach).filter(|d| d % step == 0) {
            let (px, py, square) = (x + dx, y + dy, (dx * dx + dy * dy) as f64);
            let is_on = px >= 0 && py >= 0 && px < grid.width as i64 && py < grid.height as i64;
            if !is_on || square > far * far {
                continue;
            }
            let Some(v) = value(py as usize * grid.width + px as usize) else { continue };
            wide.add(v, square);
            if square <= 0.25 * far * far {
                narrow.add(v, square);
            }
        }
    }
    let (wide, narrow) = (wide.of(), narrow.of());
    let apart = wide.1 - narrow.1;
    if apart > 0.0 { (wide.0 - narrow.0) / apart * spread * radius * radius } else { 0.0 }
}

/// Of some pixels the sums of a layer and of the square distance, and their number.
#[derive(Default)]
struct Mean {
    value: f64,
    square: f64,
    count: f64,
}

impl Mean {
    fn add(&mut self, value: f64, square: f64) {
        self.value += value;
        self.square += square;
        self.count += 1.0;
    }

    fn of(&self) -> (f64, f64) {
        (self.value / self.count, self.square / self.count)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use turbid::Spectrum;

    const GRID: Grid = Grid { width: 81, height: 81 };
    const PIXEL: f64 = 0.01;
    /// Of uniform kernels.
    const SPREADS: Spreads = Spreads { global: 0.5, caustic: 0.5, volume: 0.4 };

    /// A plane at distance 1, seen at right angles.
    fn views() -> Vec<View> {
        let view = |i: usize| {
            let place = DVec3::new((i % GRID.width) as f64 * PIXEL, (i / GRID.width) as f64 * PIXEL, 0.0);
            View {
                surface: Some((place, DVec3::Z)),
                cosine: 1.0,
                distance: 1.0,
                medium: (0.0, 0.0),
                is_at_face: false,
            }
        };
        (0..GRID.pixels()).map(view).collect()
    }

    fn layers(value: impl Fn(f64, f64) -> f64) -> Vec<Layers> {
        let one = |i: usize| {
            let (x, y) = ((i % GRID.width) as f64 * PIXEL, (i / GRID.width) as f64 * PIXEL);
            Layers { caustic: Spectrum::grey(value(x, y)), direct: Spectrum::grey(1.0), ..Layers::ZERO }
        };
        (0..GRID.pixels()).map(one).collect()
    }

    /// Of one replicate, taken twice.
    fn of(views: &[View], layers: &[Layers], radii: Radii) -> Vec<f64> {
        predicted(GRID, views, [layers, layers], &vec![radii; GRID.pixels()], SPREADS, PIXEL)
    }

    /// Mean squares over a uniform disc, the disc of a cone, and a uniform ball seen from the side.
    #[test]
    fn kernels_spread_as_the_eye_sees_them() {
        let settings = mapper::Settings::for_size(1.0, 50).unwrap();
        let Spreads { global, caustic, volume } = Spreads::of(&settings);
        for (got, expected) in [(global, 1.0 / 2.0), (caustic, 3.0 / 10.0), (volume, 2.0 / 5.0)] {
            assert!((got - expected).abs() < 1e-12, "{got} {expected}");
        }
    }

    /// Noise of 10 per cent a pixel, none of it common to the replicates, is no blur of 2 per cent.
    #[test]
    fn noise_is_no_blur() {
        let mut stream = turbid::rng::Stream::new(3, turbid::rng::Purpose::Synthetic, 0, 0);
        let mut noisy = || {
            let mut layers = layers(|_, _| 1.0);
            layers.iter_mut().for_each(|l| l.caustic *= 1.0 + 0.35 * (stream.unit() - 0.5));
            layers
        };
        let (one, other) = (noisy(), noisy());
        let radii = vec![Radii { caustic: 0.03, ..Radii::default() }; GRID.pixels()];
        let errors = |halves| predicted(GRID, &views(), halves, &radii, SPREADS, PIXEL);
        let mean = |errors: &[f64]| errors.iter().sum::<f64>() / errors.len() as f64;
        let (apart, same) = (errors([&one, &other]), errors([&one, &one]));
        let share = apart.iter().filter(|&&e| e > 0.02).count() as f64 / apart.len() as f64;
        assert!(share < 0.1, "{share}");
        // The same noise twice is blur: 0.1 sqrt(1/9 - 1/29) 4.5/3.36, halved by the mean over neighbours, and by direct light.
        assert!(mean(&same) > 0.005 && mean(&same) > 2.0 * mean(&apart), "{} {}", mean(&same), mean(&apart));
    }

    /// A uniform disc blurs a paraboloid x^2 + y^2 by r^2/2, wherever it stands and however many pixels it covers, and
    /// a plane not at all. The light about the middle changes over the pixels of the mean: within 2 in 1000.
    #[test]
    fn a_curved_layer_is_blurred_as_the_disc_says() {
        let middle = GRID.pixels() / 2;
        for radius in [0.004, 0.01, 0.017, 0.12, 0.25] {
            let radii = Radii { caustic: radius, ..Radii::default() };
            let curved = of(&views(), &layers(|x, y| x * x + y * y), radii)[middle];
            let expected = 0.5 * radius * radius / (1.0 + 2.0 * 0.4 * 0.4);
            assert!((curved / expected - 1.0).abs() < 2e-3, "{radius}: {curved} {expected}");
        }
        let radii = Radii { caustic: 0.12, ..Radii::default() };
        let plane = of(&views(), &layers(|x, y| 2.0 * x - y + 1.0), radii)[middle];
        assert!(plane < 1e-12);
        let without = of(&views(), &layers(|x, _| x * x), Radii::default());
        assert!(without.iter().all(|&e| e == 0.0));
    }

    /// A step between two surfaces is no blur, the same step on one surface is.
    #[test]
    fn other_surfaces_are_no_part_of_a_footprint() {
        let radii = Radii { caustic: 0.06, ..Radii::default() };
        let step = layers(|x, _| if x < 0.4 { 1.0 } else { 3.0 });
        let beside = GRID.pixels() / 2 - 2;
        assert!(of(&views(), &step, radii)[beside] > 0.1);
        let mut other = views();
        for (view, _) in other.iter_mut().zip(&step).filter(|(_, l)| l.caustic[0] > 2.0) {
            view.surface = view.surface.map(|(p, _)| (p, DVec3::X));
        }
        assert!(of(&other, &step, radii)[beside] < 1e-12);
    }

    /// A ray of length 2 that ends at a wall, balls of radius 0.1, all light from the volume map: 3/16 of 0.05; nothing
    /// where the fog itself ends.
    #[test]
    fn balls_lose_their_caps_at_walls() {
        let mut views = views();
        views.iter_mut().for_each(|view| view.medium = (2.0, 1.0));
        let layers = vec![Layers { multiple: Spectrum::ONE, ..Layers::ZERO }; GRID.pixels()];
        let radii = Radii { volume: 0.1, ..Radii::default() };
        let error = of(&views, &layers, radii)[0];
        assert!((error - 3.0 / 16.0 * 0.05).abs() < 1e-12, "{error}");
        views.iter_mut().for_each(|view| view.is_at_face = true);
        assert_eq!(of(&views, &layers, radii)[0], 0.0);
    }

    /// Even fog behind a slanted front: the way grows from pixel to pixel, and the light with it, but nothing is blurred; light
    /// that curves along the rows is, as the disc says.
    #[test]
    fn longer_ways_are_no_blur() {
        let mut views = views();
        for (i, view) in views.iter_mut().enumerate() {
            view.surface = None;
            view.medium = (1.0 + 0.1 * (i % GRID.width) as f64, 1.0);
        }
        let lit = |source: &dyn Fn(usize) -> f64| -> Vec<Layers> {
            let one = |(i, view): (usize, &View)| Layers {
                multiple: Spectrum::grey(source(i) * view.medium.0),
                ..Layers::ZERO
            };
            views.iter().enumerate().map(one).collect()
        };
        let radii = Radii { volume: 0.12, ..Radii::default() };
        let even = of(&views, &lit(&|_| 1.0), radii);
        assert!(even.iter().all(|&e| e < 1e-12));
        let away = |i: usize| (i / GRID.width) as f64 * PIXEL - 0.4;
        let curved = lit(&|i| 1.0 + away(i) * away(i));
        let middle = of(&views, &curved, radii)[GRID.pixels() / 2];
        assert!((middle / (0.5 * 0.4 * 0.12 * 0.12) - 1.0).abs() < 0.01, "{middle}");
    }
}
