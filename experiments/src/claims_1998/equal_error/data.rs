//! What the cells measured, and errors and costs of any choice of them.

use super::{GROUP, PATHS, PIXELS, Size, path_pixel, sizes};
use crate::cost_model::{LOOKED_AT, Maps, Paths, STORED};
use crate::harness::{Cells, Settings};

/// What work costs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Currency {
    /// Rays, with photons counted as parts of them: the same on every machine.
    Rays,
    /// CPU seconds of this machine.
    Seconds,
}

/// A picture by maps of one size or by paths, in one cell.
#[derive(Debug, Clone)]
pub struct Picture {
    /// Radiance of each pixel.
    pub pixels: Vec<f64>,
    /// Variance of one sample, mean over the pixels.
    pub noise: f64,
    /// Cost of filling, in rays and seconds.
    pub fill: [f64; 2],
    /// Cost of a sample, in rays and seconds.
    pub sample: [f64; 2],
    /// Samples of a pixel.
    pub samples: f64,
}

/// One cell.
#[derive(Debug, Clone)]
pub struct Cell {
    /// By size of map.
    pub maps: Vec<Picture>,
    /// By paths.
    pub paths: Picture,
}

/// Reads the cells.
pub fn read(settings: &Settings, cells: &Cells) -> anyhow::Result<Vec<Cell>> {
    let sizes = sizes(settings);
    let maps = sizes.iter().map(|&size| maps(size, cells)).collect::<anyhow::Result<Vec<_>>>()?;
    let paths = paths(cells)?;
    let cell =
        |(i, paths): (usize, Picture)| Cell { maps: maps.iter().map(|m| m[i].clone()).collect(), paths };
    Ok(paths.into_iter().enumerate().map(cell).collect())
}

fn maps(size: Size, cells: &Cells) -> anyhow::Result<Vec<Picture>> {
    let case = size.case();
    let list: Vec<String> = (0..PIXELS).map(|pixel| size.pixel(pixel)).collect();
    let pixels = cells.per_map(&list, "radiance")?;
    let value = |quantity: &str| cells.values(&case, quantity);
    let (noise, rays, stored) = (value("noise")?, value("rays to fill")?, value("photons stored")?);
    let (looks, found) = (value("rays a sample")?, value("photons a sample")?);
    let (fill, look) =
        (cells.seconds(GROUP, &format!("fill {case}")), cells.seconds(GROUP, &format!("look {case}")));
    let all = value("samples")?;
    let picture = |(i, pixels): (usize, Vec<f64>)| Picture {
        pixels,
        noise: noise[i],
        fill: [rays[i] + STORED * stored[i], fill[i]],
        sample: [looks[i] + LOOKED_AT * found[i], look[i] / all[i]],
        samples: all[i] / PIXELS as f64,
    };
    Ok(pixels.into_iter().enumerate().map(picture).collect())
}

fn paths(cells: &Cells) -> anyhow::Result<Vec<Picture>> {
    let list: Vec<String> = (0..PIXELS).map(path_pixel).collect();
    let pixels = cells.per_map(&list, "radiance")?;
    let value = |quantity: &str| cells.values(PATHS, quantity);
    let (noise, rays, samples) = (value("noise")?, value("rays a sample")?, value("samples")?);
    let seconds = cells.seconds(GROUP, "paths");
    let picture = |(i, pixels): (usize, Vec<f64>)| Picture {
        pixels,
        noise: noise[i],
        fill: [0.0; 2],
        sample: [rays[i], seconds[i] / samples[i]],
        samples: samples[i] / PIXELS as f64,
    };
    Ok(pixels.into_iter().enumerate().map(picture).collect())
}

/// Errors and costs of some cells together.
pub struct Fit {
    /// By size of map.
    pub maps: Vec<Maps>,
    /// The path tracer.
    pub paths: Paths,
    /// Squared bias by size of map as it came out, below zero where there is none.
    pub squared_biases: Vec<f64>,
    /// Mean radiance of the picture, by paths.
    pub mean: f64,
}

/// Mean and variance of one pixel.
fn moments(values: impl Iterator<Item = f64> + Clone, count: f64) -> (f64, f64) {
    let mean = values.clone().sum::<f64>() / count;
    let squares: f64 = values.map(|v| (v - mean) * (v - mean)).sum();
    (mean, squares / (count - 1.0))
}

impl Fit {
    /// Of at least two cells.
    ///
    /// The square of a mean difference over cells is high by its variance over cells, that of the paths' mean included:
    /// it is taken off, so that no reference's own noise is counted as bias, which may come out below zero and is then 0.
    pub fn of(cells: &[&Cell], currency: Currency) -> Self {
        let (count, which) = (cells.len() as f64, currency as usize);
        let pixels = PIXELS as f64;
        let of_paths: Vec<(f64, f64)> =
            (0..PIXELS).map(|p| moments(cells.iter().map(|c| c.paths.pixels[p]), count)).collect();
        let average = |value: &dyn Fn(&Cell) -> f64| cells.iter().map(|c| value(c)).sum::<f64>() / count;
        let mut squared_biases = Vec::new();
        let maps = (0..cells[0].maps.len())
            .map(|size| {
                let (mut between, mut bias) = (0.0, 0.0);
                for (p, (mean, variance)) in of_paths.iter().enumerate() {
                    let own = moments(cells.iter().map(|c| c.maps[size].pixels[p]), count);
                    between += own.1 / pixels;
                    bias += ((own.0 - mean) * (own.0 - mean) - (own.1 + variance) / count) / pixels;
                }
                squared_biases.push(bias);
                let (noise, samples) = (average(&|c| c.maps[size].noise), cells[0].maps[size].samples);
                Maps {
                    fill: average(&|c| c.maps[size].fill[which]),
                    sample: average(&|c| c.maps[size].sample[which]),
                    noise,
                    spread: (between - noise / samples).max(0.0),
                    bias: bias.max(0.0),
                }
            })
            .collect();
        let paths = Paths { sample: average(&|c| c.paths.sample[which]), noise: average(&|c| c.paths.noise) };
        Fit { maps, paths, squared_biases, mean: of_paths.iter().map(|m| m.0).sum::<f64>() / pixels }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use turbid::rng::{Purpose, Stream};

    /// Cells of known noise, spread and bias: uniform deviates of variance 1/12 each.
    fn cells(count: usize, bias: f64) -> Vec<Cell> {
        let mut stream = Stream::new(9, Purpose::Synthetic, 0, 0);
        let mut even = |half: f64| 2.0 * half * (stream.unit() - 0.5);
        let picture = |pixels: Vec<f64>, noise| Picture {
            pixels,
            noise,
            fill: [10.0, 1.0],
            sample: [2.0, 0.1],
            samples: 8.0,
        };
        let one = |_| {
            let paths = (0..PIXELS).map(|_| 1.0 + even(0.3)).collect();
            let mut pixel = || {
                let spread = even(0.2);
                let noise = (0..8).map(|_| even(1.0)).sum::<f64>() / 8.0;
                1.0 + bias + spread + noise
            };
            let maps = (0..PIXELS).map(|_| pixel()).collect();
            Cell { maps: vec![picture(maps, 1.0 / 3.0)], paths: picture(paths, 0.03 * 64.0) }
        };
        (0..count).map(one).collect()
    }

    #[test]
    fn parts_of_the_error_come_out_as_they_went_in() {
        let cells = cells(64, 0.1);
        let fit = Fit::of(&cells.iter().collect::<Vec<_>>(), Currency::Rays);
        let [maps] = fit.maps[..] else { panic!("one size") };
        // 0.2²/3 over 4096 pixels with the noise's 1/24 on top: relative error 2 % of the sum.
        assert!((maps.spread - 0.04 / 3.0).abs() < 0.005, "{maps:?}");
        assert!((maps.bias - 0.01).abs() < 0.002, "{maps:?}");
        assert!((fit.mean - 1.0).abs() < 0.01 && (maps.fill, maps.sample) == (10.0, 2.0));
    }

    /// Without bias the plain square of the mean difference would be (1/24 + 0.0133 + 0.03)/64 = 0.0013.
    #[test]
    fn noise_of_the_reference_is_no_bias() {
        let cells = cells(64, 0.0);
        let fit = Fit::of(&cells.iter().collect::<Vec<_>>(), Currency::Seconds);
        assert!(fit.maps[0].bias < 0.0005, "{:?}", fit.maps);
        // A mean of 64 equal numbers, to rounding.
        assert!((fit.maps[0].fill - 1.0).abs() < 1e-12 && (fit.maps[0].sample - 0.1).abs() < 1e-12);
    }
}
