//! Photon maps against paths: what a picture costs by each at a given error, and the error at which both cost the same.
//!
//! A picture from a map of one size has, after n samples per pixel, the mean squared error `floor + noise/n`: the noise of
//! samples falls, the map's own error stays. It costs `fill + pixels x n x sample`. Paths have no floor and nothing to
//! fill. At each error the cheapest size of map counts.

/// A photon put into a tree takes the time of so many rays, and one looked at in an estimate: round numbers near what the
/// first runs took. Work that is the same on every machine is counted in them.
pub const STORED: f64 = 0.5;
/// See [`STORED`].
pub const LOOKED_AT: f64 = 0.1;

/// A size of map and how its picture is taken.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Maps {
    /// Cost of filling, once a picture.
    pub fill: f64,
    /// Cost of one sample of a pixel.
    pub sample: f64,
    /// Variance of one sample about the mean of its pixel and map.
    pub noise: f64,
    /// Variance of that mean from map to map.
    pub spread: f64,
    /// Squared bias of the mean over maps.
    pub bias: f64,
}

impl Maps {
    /// The mean squared error that no number of samples removes.
    pub fn floor(&self) -> f64 {
        self.spread + self.bias
    }

    /// Samples a pixel for a mean squared error, at least one; none below the floor.
    pub fn samples(&self, square: f64) -> Option<f64> {
        let left = square - self.floor();
        (left > 0.0).then(|| (self.noise / left).max(1.0))
    }

    /// Cost of a picture of so many pixels with a mean squared error; none below the floor.
    pub fn cost(&self, pixels: f64, square: f64) -> Option<f64> {
        self.samples(square).map(|n| self.fill + pixels * n * self.sample)
    }

    /// Mean squared error after n samples per pixel.
    pub fn square(&self, samples: f64) -> f64 {
        self.floor() + self.noise / samples
    }
}

/// A path tracer.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Paths {
    /// Cost of one sample of a pixel.
    pub sample: f64,
    /// Its variance.
    pub noise: f64,
}

impl Paths {
    /// Cost of a picture of so many pixels with a mean squared error, of at least one sample a pixel.
    pub fn cost(&self, pixels: f64, square: f64) -> f64 {
        pixels * self.sample * (self.noise / square).max(1.0)
    }
}

/// The number of the cheapest size at a mean squared error, and its cost; none below all floors.
pub fn cheapest(maps: &[Maps], pixels: f64, square: f64) -> Option<(usize, f64)> {
    let costs = maps.iter().enumerate().filter_map(|(i, m)| Some((i, m.cost(pixels, square)?)));
    costs.min_by(|a, b| a.1.total_cmp(&b.1))
}

/// Root mean square errors that are looked at, over the picture's mean.
pub const RANGE: (f64, f64) = (0.002, 2.0);
/// Steps from one end to the other, even in the logarithm.
const STEPS: u32 = 240;

/// The least root mean square error at which maps cost no more than paths, over `mean`; the upper end of what is looked
/// at, 2, if they never do. `maps` of the sizes that there are: larger ones might go lower.
pub fn crossing(maps: &[Maps], paths: &Paths, pixels: f64, mean: f64) -> f64 {
    let square = |error: f64| (error * mean) * (error * mean);
    let is_cheaper = |error: f64| {
        cheapest(maps, pixels, square(error))
            .is_some_and(|(_, cost)| cost <= paths.cost(pixels, square(error)))
    };
    let ratio = libm::exp(libm::log(RANGE.1 / RANGE.0) / f64::from(STEPS));
    let mut low = RANGE.0;
    if is_cheaper(low) {
        return low;
    }
    for _ in 0..STEPS {
        let high = low * ratio;
        if is_cheaper(high) {
            let (mut a, mut b) = (low, high);
            for _ in 0..40 {
                let middle = (a * b).sqrt();
                if is_cheaper(middle) { b = middle } else { a = middle }
            }
            return b;
        }
        low = high;
    }
    RANGE.1
}

#[cfg(test)]
mod tests {
    use super::*;

    const PATHS: Paths = Paths { sample: 1.0, noise: 4.0 };

    fn maps(fill: f64, floor: f64) -> Maps {
        Maps { fill, sample: 2.0, noise: 0.5, spread: 0.5 * floor, bias: 0.5 * floor }
    }

    /// Nothing to fill: 2 x 0.5/(e² - f) = 4/e² at e² = 4 f/3.
    #[test]
    fn the_floor_decides_where_filling_is_free() {
        let found = crossing(&[maps(0.0, 0.03)], &PATHS, 100.0, 1.0);
        assert!((found * found - 0.04).abs() < 1e-9, "{found}");
        // Relative to the mean.
        let found = crossing(&[maps(0.0, 0.03)], &PATHS, 100.0, 2.0);
        assert!((4.0 * found * found - 0.04).abs() < 1e-9, "{found}");
    }

    /// No floor: F + P 2 x 0.5/e² = P 4/e² at e² = 3 P/F; where that is above 1/2 one sample is too many.
    #[test]
    fn filling_decides_where_there_is_no_floor() {
        let maps = [maps(2000.0, 0.0)];
        // Maps are cheaper from the least error that is looked at up to e² = 0.15.
        assert_eq!(crossing(&maps, &PATHS, 100.0, 1.0), RANGE.0);
        assert!(maps[0].cost(100.0, 0.149).unwrap() < PATHS.cost(100.0, 0.149));
        assert!(maps[0].cost(100.0, 0.151).unwrap() > PATHS.cost(100.0, 0.151));
    }

    #[test]
    fn the_cheapest_of_two_sizes_counts() {
        let both = [maps(10.0, 0.03), maps(400.0, 0.003)];
        assert_eq!(cheapest(&both, 100.0, 1.0).unwrap().0, 0);
        assert_eq!(cheapest(&both, 100.0, 0.01).unwrap().0, 1);
        assert!(cheapest(&both, 100.0, 0.002).is_none());
        assert!(crossing(&both, &PATHS, 100.0, 1.0) < crossing(&both[..1], &PATHS, 100.0, 1.0));
    }

    /// Maps with a bias of 40 % are never as good as 30 %, and dear ones never worth it.
    #[test]
    fn a_planted_error_is_seen() {
        let right = maps(10.0, 0.01);
        assert!(crossing(&[right], &PATHS, 1000.0, 1.0) < 0.3);
        let high = Maps { bias: 0.16, ..right };
        assert!(crossing(&[high], &PATHS, 1000.0, 1.0) > 0.4);
        let dear = Maps { sample: 50.0, ..right };
        assert_eq!(crossing(&[dear], &PATHS, 1000.0, 1.0), RANGE.1);
    }
}
