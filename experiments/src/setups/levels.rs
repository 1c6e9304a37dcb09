//! Levels of a telescoping sum, drawn at random: how often, and from how many photons each.

/// A schedule of levels drawn at random.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Schedule {
    /// Photons of the first estimate, and of the difference of level 0.
    pub first: u64,
    /// Photons grow by this a level, a power of two.
    pub growth: u64,
    /// The chance falls by this a level; less than photons grow, to have finite work.
    pub fall: f64,
    /// The last level that is drawn: it has the chances of all behind it, and the bias of the radius behind it is left.
    pub last: u32,
}

impl Schedule {
    /// N_k = N_0 2^(k (c + 4)), p_k ~ 2^(-k (c + 4.5)): finite work, and the lightest tail that such a schedule can have.
    ///
    /// # Arguments
    /// `c` the power of the radius in the variance; each level halves the radius
    pub fn of(c: f64) -> Self {
        Schedule { first: 50, growth: 1 << (c as u32 + 4), fall: libm::exp2(-(c + 4.5)), last: 2 }
    }

    /// The chance of a level.
    pub fn chance(&self, level: u32) -> f64 {
        let from = libm::pow(self.fall, f64::from(level));
        if level < self.last { from * (1.0 - self.fall) } else { from }
    }

    /// The photons of a level.
    pub fn photons(&self, level: u32) -> u64 {
        self.first * self.growth.pow(level)
    }

    /// Photons of one replicate, on average.
    pub fn mean_photons(&self) -> f64 {
        let levels = (0..=self.last).map(|level| self.chance(level) * self.photons(level) as f64);
        self.first as f64 + levels.sum::<f64>()
    }

    /// Replicates whose mean is one answer of so much work on average.
    pub fn replicates(&self, work: u64) -> u64 {
        ((work as f64 / self.mean_photons()).round() as u64).max(1)
    }

    /// The level of a number that is uniform from 0 to 1.
    pub fn level(&self, u: f64) -> u32 {
        let (mut level, mut tail) = (0, self.fall);
        while level < self.last && u < tail {
            level += 1;
            tail *= self.fall;
        }
        level
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use turbid::rng::{Purpose, Stream};
    use turbid::stats::{ALPHA, wilson_interval};

    /// Chances add up to one, levels come as often, and each level costs less than the one before.
    #[test]
    fn schedules_are_chances_of_finite_work() {
        for c in [3.0, 2.0, 1.0] {
            let schedule = Schedule::of(c);
            let chances: Vec<f64> = (0..=schedule.last).map(|level| schedule.chance(level)).collect();
            assert!((chances.iter().sum::<f64>() - 1.0).abs() < 1e-15);
            let mut stream = Stream::new(1, Purpose::Synthetic, 0, 0);
            let drawn = (0..200_000).filter(|_| schedule.level(stream.unit()) > 0).count();
            let interval = wilson_interval(drawn as u64, 200_000, 1.0 - ALPHA);
            assert!(interval.contains(schedule.fall), "{c}: {interval:?}");
            let cost =
                |level: u32| libm::pow(schedule.fall, f64::from(level)) * schedule.photons(level) as f64;
            assert!((cost(1) / cost(0) - 0.5f64.sqrt()).abs() < 1e-12);
        }
    }
}
