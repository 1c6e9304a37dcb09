//! Transmittance: the fraction of light that passes a stretch of media without a collision.

use crate::Spectrum;
use crate::math::Ray;
use crate::rng::Stream;
use crate::scene::{Scene, decay};

/// The fraction of light that passes up to distance `end` \[1\], in the interior of number `within`: exact where the
/// optical depth has a closed form.
pub fn transmittance(scene: &Scene, ray: &Ray, end: f64, within: usize, _stream: &mut Stream) -> Spectrum {
    decay(scene.optical_depth(ray, end, within))
}
