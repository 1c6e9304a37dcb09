//! What is left over of several quantities of the same maps, resampled all at once.

use super::{Moments, student_p};
use crate::rng::Stream;

/// Values of several quantities, one of each map, less their means, in standard deviations; and bounds of their numerical errors in
/// standard errors.
#[derive(Debug, Clone)]
pub struct Residuals {
    maps: usize,
    /// All quantities of the first map, then of the next. Single precision leaves 1e-5 of a distance.
    values: Vec<f32>,
    errors: Vec<f32>,
}

impl Residuals {
    /// Of quantities by their value in each of the maps, and by the bound of their numerical error in the same unit.
    ///
    /// # Limits
    /// as many maps as the quantity with the fewest values has; a quantity without spread stays at no distance
    pub fn new(quantities: &[(&[f64], f64)]) -> Self {
        let maps = quantities.iter().map(|(of_maps, _)| of_maps.len()).min().unwrap_or(0);
        let count = quantities.len();
        let mut values = vec![0.0; maps * count];
        let mut errors = vec![0.0; count];
        for (i, (of_maps, error)) in quantities.iter().enumerate() {
            let m: Moments = of_maps[..maps].iter().collect();
            let scale = if m.std_dev() > 0.0 { 1.0 / m.std_dev() } else { 0.0 };
            for (map, value) in of_maps[..maps].iter().enumerate() {
                values[map * count + i] = ((value - m.mean()) * scale) as f32;
            }
            errors[i] = (error * scale * (maps as f64).sqrt()) as f32;
        }
        Residuals { maps, values, errors }
    }

    /// The smallest p-value among the quantities, by Student's t, in one sample of the maps with replacement; 1 below two maps.
    pub fn smallest_p(&self, stream: &mut Stream) -> f64 {
        if self.maps < 2 {
            return 1.0;
        }
        let mut times = vec![0u32; self.maps];
        for _ in 0..self.maps {
            times[stream.index(self.maps)] += 1;
        }
        let mut sums = vec![0.0f32; self.errors.len()];
        let mut squares = vec![0.0f32; self.errors.len()];
        for (row, &times) in self.values.chunks_exact(self.errors.len().max(1)).zip(&times) {
            if times > 0 {
                let times = times as f32;
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::Purpose;

    /// Maps drawn by hand, and the distance of each quantity's mean from that of all maps, its numerical error among the variances.
    #[test]
    fn a_sample_is_that_of_the_maps_drawn() {
        let mut made = Stream::new(3, Purpose::Synthetic, 0, 0);
        let columns: Vec<Vec<f64>> =
            (0..3).map(|i| (0..20 + i).map(|_| made.unit() * 5.0 - 1.0).collect()).collect();
        let errors = [0.0, 0.3, 2.0];
        let quantities: Vec<(&[f64], f64)> = columns.iter().map(Vec::as_slice).zip(errors).collect();
        let residuals = Residuals::new(&quantities);
        for number in 0..50 {
            let mut stream = Stream::new(4, Purpose::Resampling, 0, number);
            let found = residuals.smallest_p(&mut stream.clone());
            let drawn: Vec<usize> = (0..20).map(|_| stream.index(20)).collect();
            let one = |(column, error): &(&[f64], f64)| {
                let whole: Moments = column[..20].iter().collect();
                let m: Moments = drawn.iter().map(|&map| column[map]).collect();
                let variance = m.std_error() * m.std_error() + error * error;
                student_p((m.mean() - whole.mean()).abs() / variance.sqrt(), 19)
            };
            let expected = quantities.iter().map(one).fold(1.0, f64::min);
            assert!((found / expected - 1.0).abs() < 1e-3, "{found} for {expected}");
        }
        for few in [&[][..], &[1.0]] {
            assert_eq!(Residuals::new(&[(few, 0.0)]).smallest_p(&mut made), 1.0);
        }
    }
}
