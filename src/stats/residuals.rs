//! What is left over of several quantities of the same maps, resampled all at once.

use super::{Moments, student_p};
use crate::rng::Stream;

/// Values of several quantities, one of each map, less their means, in standard deviations; and bounds of their numerical errors in
/// standard errors.
#[derive(Debug, Clone)]
pub struct Residuals {
    maps: usize,
    quantities: usize,
    /// All quantities of the first map, then of the next. Single precision leaves 1e-5 of a distance.
    values: Vec<f32>,
    errors: Vec<f32>,
}

impl Residuals {
    /// Of quantities by their value in each of two maps or more, and by the bound of their numerical error in the same unit.
    ///
    /// # Limits
    /// a quantity without spread stays at no distance
    pub fn new<'a>(maps: usize, quantities: impl ExactSizeIterator<Item = (&'a [f64], f64)>) -> Self {
        let count = quantities.len();
        let mut values = vec![0.0; maps * count];
        let mut errors = vec![0.0; count];
        for (i, (of_maps, error)) in quantities.enumerate() {
            let m: Moments = of_maps.iter().collect();
            let scale = if m.std_dev() > 0.0 { 1.0 / m.std_dev() } else { 0.0 };
            for (map, value) in of_maps.iter().enumerate() {
                values[map * count + i] = ((value - m.mean()) * scale) as f32;
            }
            errors[i] = (error * scale * (maps as f64).sqrt()) as f32;
        }
        Residuals { maps, quantities: count, values, errors }
    }

    /// The smallest p-value among the quantities, by Student's t, in one sample of the maps with replacement.
    pub fn smallest_p(&self, stream: &mut Stream) -> f64 {
        let mut times = vec![0u16; self.maps];
        for _ in 0..self.maps {
            times[stream.index(self.maps)] += 1;
        }
        let mut sums = vec![0.0f32; self.quantities];
        let mut squares = vec![0.0f32; self.quantities];
        for (row, &times) in self.values.chunks_exact(self.quantities.max(1)).zip(&times) {
            if times > 0 {
                let times = f32::from(times);
                for ((sum, square), &x) in sums.iter_mut().zip(&mut squares).zip(row) {
                    let weighted = times * x;
                    *sum += weighted;
                    *square += weighted * x;
                }
            }
        }
        let count = self.maps as f32;
        let mut largest = 0.0f32;
        for ((sum, square), error) in sums.iter().zip(&squares).zip(&self.errors) {
            let mean = sum / count;
            // Variance of the mean, and of the numerical error, in the units of the values.
            let variance = (square / count - mean * mean) / (count - 1.0) + error * error / count;
            if variance > 0.0 {
                largest = largest.max(mean * mean / variance);
            }
        }
        student_p(f64::from(largest).sqrt(), self.maps as u64 - 1)
    }
}
