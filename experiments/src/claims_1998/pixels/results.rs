//! What the pictures say.

use crate::harness::Estimate;
use turbid::stats::Moments;

/// The picture at one number of neighbours; all as fractions of the pixel.
pub struct Picture {
    /// Number of neighbours.
    pub k: usize,
    /// Noise between independent maps, root mean square over the pixels.
    pub noise: Estimate,
    /// What was predicted of it.
    pub predicted: f64,
    /// Mean error of the whole picture, one a map.
    pub bias: Moments,
    /// Mean square over the pixels of what no number of maps removes.
    pub square: Estimate,
    /// Map against paths by pixel: mean error.
    pub by_pixel: Vec<f64>,
}
