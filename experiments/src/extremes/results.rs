//! What the maps say of each part.

use super::cases::Class;
use super::storage::{self, RADIUS, Rule};
use super::stretched::Case;
use crate::harness::{Estimate, Unit};
use turbid::stats::{MeanTest, Moments, t_test, z_test};

/// A row of batches.
pub struct SampledResult {
    /// What it is about.
    pub class: Class,
    /// Its case.
    pub name: String,
    /// Unit of its value.
    pub unit: Unit,
    /// The exact value and its bound.
    pub exact: (f64, f64),
    /// One value a batch.
    pub values: Vec<f64>,
    /// The same over batches.
    pub moments: Moments,
}

impl SampledResult {
    /// Difference from the exact value in standard errors.
    pub fn z(&self) -> f64 {
        let error = libm::hypot(self.moments.std_error(), self.exact.1);
        (self.moments.mean() - self.exact.0) / error
    }

    /// p-value of the exact value being the truth, which a value that is not finite never is.
    pub fn p(&self) -> f64 {
        t_test(&self.moments, self.exact.0, self.exact.1).p
    }

    /// The smallest relative bias that this row would hardly ever miss; none where nothing varies or 0 is exact.
    pub fn smallest_bias(&self) -> Option<f64> {
        let varies = self.moments.std_error() > 0.0 && self.exact.0 != 0.0;
        varies.then(|| t_test(&self.moments, self.exact.0, self.exact.1).smallest_bias / self.exact.0.abs())
    }
}

/// A row that was computed once.
pub struct CheckedResult {
    /// What it is about.
    pub class: Class,
    /// Its case, without the class.
    pub name: String,
    /// What the simulator says.
    pub value: f64,
    /// What is exact.
    pub exact: f64,
    /// How far apart they may be.
    pub bound: f64,
}

impl CheckedResult {
    /// Difference from the exact value over what is allowed; 0 where they are the same number.
    pub fn share(&self) -> f64 {
        let difference = (self.value - self.exact).abs();
        if difference == 0.0 { 0.0 } else { difference / self.bound }
    }

    /// Whether it is right.
    pub fn is_right(&self) -> bool {
        self.share() <= 1.0
    }
}

/// A count of one large pass.
pub struct LargeResult {
    /// Its case.
    pub name: String,
    /// Photons counted, of how many.
    pub count: (f64, f64),
    /// The exact rate and its bound.
    pub exact: (f64, f64),
}

impl LargeResult {
    fn test(&self) -> MeanTest {
        let ((count, emitted), (p, bound)) = (self.count, self.exact);
        z_test(count / emitted, libm::hypot((p * (1.0 - p) / emitted).sqrt(), bound), p)
    }

    /// Difference from the exact rate in binomial standard errors.
    pub fn z(&self) -> f64 {
        self.test().z
    }

    /// p-value of the exact rate being the truth.
    pub fn p(&self) -> f64 {
        self.test().p
    }

    /// The smallest relative bias that this count would hardly ever miss.
    pub fn smallest_bias(&self) -> f64 {
        self.test().smallest_bias / self.exact.0
    }
}

/// One gather at one extent: single against double precision.
pub struct StorageResult {
    /// Gather.
    pub rule: Rule,
    /// Power of two of the extent.
    pub power: i32,
    /// Predicted mean difference and its bound.
    pub predicted: (f64, f64),
    /// Predicted root mean square difference [standard errors of one estimate].
    pub predicted_rms: f64,
    /// Difference of each map.
    pub difference: Moments,
    /// Root mean square difference over the standard deviation of an estimate.
    pub rms: Estimate,
    /// Photons that were in one ball and not in the other.
    pub moved: f64,
    /// Error in single precision against the exact fluence, one a map.
    pub errors: Vec<f64>,
}

impl StorageResult {
    /// Extent over radius: of the fixed gather, for both.
    pub fn extent_in_radii(&self) -> f64 {
        storage::extent(self.power) / RADIUS
    }
}

/// One gather of a stretched map.
pub struct StretchedResult {
    /// The case.
    pub case: Case,
    /// Predicted error and its bound.
    pub predicted: (f64, f64),
    /// Error of each map.
    pub errors: Vec<f64>,
}

/// Everything that was found.
pub struct Results {
    /// Sampled rows.
    pub sampled: Vec<SampledResult>,
    /// Checked rows.
    pub checked: Vec<CheckedResult>,
    /// Counts of one large pass.
    pub large: Vec<LargeResult>,
    /// Single against double precision.
    pub storage: Vec<StorageResult>,
    /// Stretched maps.
    pub stretched: Vec<StretchedResult>,
    /// Where numbers were not finite, and how many.
    pub non_finite: Vec<(String, f64)>,
    /// Largest error of a stored coordinate over the tree's resolution.
    pub rounding: f64,
}

impl Results {
    /// Numbers that were not finite.
    pub fn lost(&self) -> f64 {
        // The sum of no f64 is -0.
        self.non_finite.iter().fold(0.0, |sum, (_, count)| sum + count)
    }
}

/// The unit of a difference that is held against the noise of one estimate.
pub const STANDARD_ERRORS: Unit = Unit::new("standard errors");
