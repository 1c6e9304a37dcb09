//! Photons of one history lie near each other: how many, and what that does to an estimate.

use std::f64::consts::PI;

/// Other photons of the same history around each photon of a ball of radius `r` \[mfp\], on average.
///
/// With L the distance from a uniform point of the ball to its surface along any direction, the next collision is
/// inside with probability w <1 - e^-L> = w (3/4 r - 2/5 r^2 + ...), and so was the last one: 3/2 w r to first order,
/// whatever the asymmetry. Isotropic scattering adds the next but one, w^2 <L~^2> with L~ the mean of L over
/// directions. Behind other phase functions that term is left out with the rest of the second order: it lies between
/// the isotropic one and 2/5 w^2 r^2, which straight paths have.
pub fn clustering(albedo: f64, g: f64, r: f64) -> f64 {
    let w = albedo;
    let first = 1.5 * w * r;
    if g == 0.0 { first + 2.0 * (w * w * MEAN_SQUARE - 0.4 * w) * r * r } else { first }
}

/// The mean of L~^2 over a ball of radius 1, L~(u) = (1 + (1-u^2)/(2u) ln((1+u)/(1-u)))/2, by quadrature (a test does it
/// again).
const MEAN_SQUARE: f64 = 0.578_986_8;

/// What clusters add to a nearest estimate, relative to it, inside the medium: clustering grows with the radius, which
/// is averaged over the k-th distance; r_1 is the radius of the ball in which one photon is expected.
pub fn nearest_clustering(albedo: f64, g: f64, photons_per_volume: f64, k: usize) -> f64 {
    let r1 = libm::cbrt(3.0 / (4.0 * PI * photons_per_volume));
    let k = k as f64;
    clustering(albedo, g, r1) * libm::exp(libm::lgamma(k - 5.0 / 3.0) - libm::lgamma(k - 1.0)) / 3.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_mean_square_distance_to_the_surface_of_a_ball() {
        let steps = 200_000;
        let sum: f64 = (0..steps)
            .map(|i| (f64::from(i) + 0.5) / f64::from(steps))
            .map(|u| {
                let mean = 0.5 * (1.0 + (1.0 - u * u) / (2.0 * u) * libm::log((1.0 + u) / (1.0 - u)));
                3.0 * u * u * mean * mean
            })
            .sum();
        // The midpoint rule leaves h^2 ln h at the surface: 1e-9 here; the constant has seven digits.
        assert!((sum / f64::from(steps) - MEAN_SQUARE).abs() < 1e-7);
    }
}
