//! What storage on a lattice does to an estimate, exactly.
//!
//! A stored coordinate is a number of single precision in a power-of-two unit u: between u/2 and u its spacing is
//! h = 2^-24 u. A map stretched along x has photons on planes h apart, and the query point, rounded alike, on one of
//! them. All photons of the layer within h/2 of a plane are found on it, so that in a uniform field an estimate by a
//! kernel of radius r is, relative to the field,
//!
//! (h/r) sum_j m(j h/r),   m the kernel's integral over the plane at a distance (in radii) from its centre,
//!
//! the rule of midpoints for int m = 1: right while h is small against r.

use crate::theory::referee_kernel;
use turbid::estimators::Kernel;

/// Spacing in radii below which the sum is taken for the integral. The rule of midpoints has an error of at most (s^2/8)
/// int |m''|, 2 s^2 for the steepest of the kernels.
const FINE: f64 = 1e-4;

/// An estimate by a fixed radius in a uniform field, over the field, and a bound on its rounding; `spacing` in radii.
pub fn kernel_on_lattice(kernel: Kernel, spacing: f64) -> anyhow::Result<(f64, f64)> {
    let planes = (1.0 / spacing) as u64;
    if kernel == Kernel::Uniform {
        // sum_j (1 - j^2 s^2) by the sums of ones and of squares, m = (3/4)(1 - z^2).
        let j = planes as f64;
        let sum = (2.0 * j + 1.0) * (1.0 - spacing * spacing * j * (j + 1.0) / 3.0);
        return Ok((0.75 * spacing * sum, 8.0 * f64::EPSILON * (1.0 + spacing)));
    }
    if spacing < FINE {
        return Ok((1.0, 2.0 * spacing * spacing));
    }
    let kernel = referee_kernel(kernel);
    let middle = kernel.marginal(0.0)?;
    let (mut sum, mut error) = (middle.value, middle.error);
    for j in 1..=planes {
        let plane = kernel.marginal(j as f64 * spacing)?;
        sum += 2.0 * plane.value;
        error += 2.0 * plane.error;
    }
    Ok((spacing * sum, spacing * error + f64::EPSILON))
}

/// The part of a ball's volume that changes sides when photons and query point are rounded, in ball volumes: photons
/// that are found and should not be, and the other way round. Mean over where the query point lies between planes.
///
/// A photon at x is found at its plane, the centre c at the plane 0: the discs that the two balls cut out at x are
/// concentric, so that |A(x - c) - A(x_j)| changes sides, A(z) = pi max(r^2 - z^2, 0). Small spacings: h/(2r), since
/// two independent roundings differ by h/3 on average and |A'| integrates to 2 pi r^2.
pub fn changed_sides(spacing: f64) -> f64 {
    const STEPS: u32 = 64;
    if spacing < 1e-3 {
        return 0.5 * spacing;
    }
    let disc = |z: f64| (1.0 - z * z).max(0.0);
    let planes = (1.0 / spacing) as i64 + 2;
    let between = |i: u32| (f64::from(i) + 0.5) / f64::from(STEPS) - 0.5;
    let mut sum = 0.0;
    for centre in (0..STEPS).map(between) {
        for j in -planes..=planes {
            let found = disc(j as f64 * spacing);
            for within in (0..STEPS).map(between) {
                sum += (disc((j as f64 + within - centre) * spacing) - found).abs();
            }
        }
    }
    0.75 * sum * spacing / f64::from(STEPS * STEPS)
}

#[cfg(test)]
mod tests {
    use super::*;
    use turbid::rng::{Purpose, Stream};

    #[test]
    fn fine_lattices_are_no_lattices() {
        for kernel in Kernel::ALL {
            let (value, error) = kernel_on_lattice(kernel, 1.0 / 4096.0).unwrap();
            assert!((value - 1.0).abs() < 1e-6 && error < 1e-9, "{kernel:?} {value} {error}");
        }
    }

    /// One plane only: the disc through the centre, h pi r^2 over (4/3) pi r^3; and with three, by hand.
    #[test]
    fn few_planes_by_hand() {
        assert!((kernel_on_lattice(Kernel::Uniform, 2.0).unwrap().0 - 1.5).abs() < 1e-14);
        assert!((kernel_on_lattice(Kernel::Uniform, 0.5).unwrap().0 - 0.9375).abs() < 1e-14);
        // The closed sum, plane by plane.
        for spacing in [0.013, 0.1, 0.3, 0.7] {
            let planes = (1.0 / spacing) as i32;
            let sum: f64 = (-planes..=planes).map(|j| 1.0 - (f64::from(j) * spacing).powi(2)).sum();
            let (value, _) = kernel_on_lattice(Kernel::Uniform, spacing).unwrap();
            assert!((value - 0.75 * spacing * sum).abs() < 1e-13);
        }
    }

    /// Random points, rounded by `round` along one coordinate: kernel sums and changes of side as predicted.
    #[test]
    fn rounded_points() {
        let (spacing, count) = (0.7, 400_000);
        let mut stream = Stream::new(5, Purpose::Synthetic, 0, 0);
        let round = |x: f64| (x / spacing).round() * spacing;
        let (mut found, mut changed) = (0u32, 0u32);
        for _ in 0..count {
            let [x, y, z] = stream.triple().map(|u| 4.0 * u - 2.0);
            let centre = (stream.unit() - 0.5) * spacing;
            let is_in = |x: f64| x * x + y * y + z * z <= 1.0;
            found += u32::from(is_in(round(x)));
            changed += u32::from(is_in(round(x)) != is_in(x - centre));
        }
        // Points fill a cube of side 4; the layer of the outermost plane within reach ends at 1.05.
        let per_ball = f64::from(count) * (4.0 / 3.0 * std::f64::consts::PI) / 64.0;
        let tolerance = |expected: f64| 5.0 * (expected / per_ball).sqrt();
        let (mean, _) = kernel_on_lattice(Kernel::Uniform, spacing).unwrap();
        assert!((f64::from(found) / per_ball - mean).abs() < tolerance(mean));
        let sides = changed_sides(spacing);
        assert!((f64::from(changed) / per_ball - sides).abs() < tolerance(sides), "{sides}");
        assert!((changed_sides(1e-3) / 5e-4 - 1.0).abs() < 0.01);
    }
}
