//! Against quadrature in the field, and against isotropic lines thrown at a ray.

use super::*;
use libm::{exp, log, sqrt};

const PAIRINGS: [Pairing; 4] =
    [Pairing::PointPoints, Pairing::RayPoints, Pairing::RayBeams { sine: 0.5 }, Pairing::RayIsotropicBeams];

/// Beams at a point are thrown through a disc across them: the mean and the variance of a Poisson number of places, and the field on
/// the disc, as of points along a ray.
#[test]
fn beams_at_a_point_are_places_on_a_disc() {
    let any = Ray { length: 7.0, extinction: 3.0 };
    let mut random = Random(3);
    let (density, r, trials) = (400.0, 0.2, 20_000);
    let (mut sum, mut square) = (0.0, 0.0);
    for _ in 0..trials {
        // A Poisson number in a square of side 0.4 about the disc, by exponential gaps.
        let (mut arrived, mut estimate) = (0.0, 0.0);
        loop {
            arrived -= log(1.0 - random.unit()) / (density * 0.16);
            if arrived > 1.0 {
                break;
            }
            let [x, y] = [0.0; 2].map(|_: f64| 0.4 * (random.unit() - 0.5));
            estimate += if x * x + y * y <= r * r { 1.0 / (PI * r * r) } else { 0.0 };
        }
        sum += estimate;
        square += estimate * estimate;
    }
    let n = f64::from(trials);
    let (mean, variance) = (sum / n, square / n - (sum / n) * (sum / n));
    let relative = Pairing::PointBeams.relative_variance(Kernel::Uniform, r, density, any).unwrap().value;
    assert!((mean / density - 1.0).abs() < 5.0 * sqrt(relative / n), "{mean}");
    // The variance of a nearly normal number is known to sqrt(2/n).
    assert!((variance / (relative * density * density) - 1.0).abs() < 5.0 * sqrt(2.1 / n), "{variance}");
    for x in [0.3, 2.0] {
        let [mine, theirs] = [Pairing::PointBeams, Pairing::RayPoints]
            .map(|pairing| pairing.exponential_mean(Kernel::Biweight, x).unwrap().value);
        assert!(mine == theirs && mine > 1.0);
    }
}

#[test]
fn the_mean_is_the_field_under_the_kernel() {
    for kernel in [Kernel::Uniform, Kernel::Epanechnikov, Kernel::Cone { kappa: 1.0 }] {
        for x in [0.1, -2.0, 5.0] {
            for d in Dimension::ALL {
                let b = 1.0 / sqrt(f64::from(d.number()));
                let field = |p: [f64; 3]| exp(x * b * (p[0] + p[1] + p[2]));
                let want = blurred_field(kernel, d, 1.0, field).unwrap();
                let pairing = PAIRINGS[3 - d.number() as usize];
                let got = pairing.exponential_mean(kernel, x).unwrap();
                assert!(
                    (got.value - want.value).abs() <= got.error + want.error,
                    "{pairing:?} {got:?} {want:?}"
                );
                assert!(want.error < 1e-10 * want.value, "{want:?}");
            }
            // Isotropic beams: an interval in a random azimuth.
            let got = Pairing::RayIsotropicBeams.exponential_mean(kernel, x).unwrap();
            let turns = 200;
            let mean: f64 = (0..turns)
                .map(|i| {
                    let slope = x * cos(PI * (f64::from(i) + 0.3) / f64::from(turns));
                    blurred_field(kernel, Dimension::One, 1.0, |p| exp(slope * p[0])).unwrap().value
                })
                .sum();
            let want = mean / f64::from(turns);
            assert!(
                (got.value / want - 1.0).abs() < 1e-12 && got.error < 1e-12 * got.value,
                "{got:?} {want}"
            );
        }
    }
    // 1 + sum of (x/2)^(2k)/((2k+1) k!^2), the uniform kernel's mean of sinh(x c)/(x c) over azimuths.
    let x = 60.0;
    let (mut term, mut want, mut k) = (1.0, 1.0, 0.0);
    while term > 1e-18 * want {
        k += 1.0;
        term *= 0.25 * x * x / (k * k);
        want += term / (2.0 * k + 1.0);
    }
    // (2k)!/(4^k k!^2) is the mean of cos^(2k); over (2k+1)!: 1/((2k+1) 4^k k!^2).
    let got = Pairing::RayIsotropicBeams.exponential_mean(Kernel::Uniform, x).unwrap();
    assert!((got.value / want - 1.0).abs() < 1e-12, "{got:?} {want}");
}

#[test]
fn small_gradients_read_the_bias_coefficient() {
    let known = [0.1, 0.125, 1.0 / 6.0, 1.0 / 12.0];
    for (pairing, want) in PAIRINGS.into_iter().zip(known) {
        let coefficient = pairing.bias_coefficient(Kernel::Uniform).unwrap();
        assert!(coefficient.covers(want), "{coefficient:?}");
        let x = 1e-3;
        let got = pairing.exponential_mean(Kernel::Uniform, x).unwrap();
        // The next term is below x^4/120.
        assert!((got.value - 1.0 - want * x * x).abs() < got.error + 1e-14, "{pairing:?} {got:?}");
    }
    assert!(Pairing::RayBeams { sine: 0.0 }.inverse_sine().is_err());
}

#[test]
fn other_fields_are_blurred_too() {
    // A wave is weakened by the modulation transfer; a power law's Laplacian is exact for |x|^2.
    let q = 3.0;
    for d in Dimension::ALL {
        let got = blurred_field(Kernel::Uniform, d, 0.5, |p| 1.0 + cos(q / 0.5 * p[0])).unwrap();
        let want = 1.0 + crate::blur::modulation_transfer(d, q).unwrap().value;
        assert!((got.value - want).abs() <= got.error + 1e-14 && got.error < 1e-12, "{d:?} {got:?} {want}");
    }
    assert!(blurred_field(Kernel::Uniform, Dimension::Two, 1.0, |_| f64::NAN).is_err());
}

/// A small generator of our own (Steele, Lea and Flood 2014), for lines in space.
struct Random(u64);

impl Random {
    fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }
}

/// Contributions of isotropic lines, through a ball of unit radius about a ray of length 1, to the estimate at radius
/// r, and how much length of lines there is in a volume.
fn thrown(lines: u32, r: f64) -> (Vec<f64>, f64) {
    let mut random = Random(1);
    let mut found = Vec::new();
    for _ in 0..lines {
        let z = 2.0 * random.unit() - 1.0;
        let sine = ((1.0 - z) * (1.0 + z)).sqrt();
        // A point of the disc across the line: along the horizontal common normal with the ray, and across both.
        let (rho, chi) = (random.unit().sqrt(), 2.0 * PI * random.unit());
        let (along, up) = (rho * cos(chi), rho * libm::sin(chi));
        // The line passes the ray at distance |along| where its horizontal offset along itself vanishes.
        let height = up / sine;
        if along.abs() <= r && height.abs() <= 0.5 {
            found.push(0.5 / (r * sine));
        }
    }
    (found, f64::from(lines) / PI)
}

#[test]
fn lines_thrown_at_a_ray_give_mean_variance_and_tail() {
    let (r, lines) = (0.05, 2_000_000);
    let (found, density) = thrown(lines, r);
    let ray = Ray { length: 1.0, extinction: 0.0 };
    let relative =
        Pairing::RayIsotropicBeams.relative_variance(Kernel::Uniform, r, density, ray).unwrap().value;
    // The mean: density times length, five standard deviations wide by the predicted variance.
    let mean: f64 = found.iter().sum();
    assert!((mean / density - 1.0).abs() < 5.0 * sqrt(relative), "{} {}", mean / density, sqrt(relative));
    // The predicted sum of squares up to a cap, whose own spread is known from the fourth moment up to it.
    let crossing = density * 2.0 * r * PI / 4.0;
    let count = found.len() as f64;
    assert!((count / crossing - 1.0).abs() < 5.0 / sqrt(crossing), "{count} {crossing}");
    let cap = 20.0;
    let squares: f64 = found.iter().map(|x| 2.0 * r * x).filter(|x| *x <= cap).map(|x| x * x).sum();
    let want = crossing * crossing_moment(2, cap).unwrap().value;
    let spread = sqrt(crossing * crossing_moment(4, cap).unwrap().value);
    assert!((squares - want).abs() < 5.0 * spread, "{squares} {want} {spread}");
    // Without a cap it is the variance, in units of a perpendicular beam's contribution.
    let whole = crossing * 2.0 / (4.0 * r * r);
    assert!((whole / (relative * density * density) - 1.0).abs() < 1e-12, "{whole}");
    for x in [1.5, 3.0, 6.0, 12.0] {
        let beyond = found.iter().filter(|c| 2.0 * r * **c > x).count() as f64;
        let want = crossing * crossing_tail(x).unwrap().value;
        assert!((beyond - want).abs() < 5.0 * sqrt(want) + 5.0, "{x} {beyond} {want}");
    }
}

#[test]
fn variances_follow_the_three_laws() {
    let ray = Ray { length: 2.0, extinction: 0.0 };
    for (pairing, power) in PAIRINGS.into_iter().zip([3.0, 2.0, 1.0, 1.0]) {
        let at = |r| pairing.relative_variance(Kernel::Epanechnikov, r, 100.0, ray).unwrap().value;
        assert!((log(at(0.1) / at(0.2)) / log(2.0) - power).abs() < 1e-12, "{pairing:?}");
    }
    // Points: one over the number expected, in the ball and in the cylinder.
    let at = |p: Pairing, r| p.relative_variance(Kernel::Uniform, r, 100.0, ray).unwrap();
    assert!(at(Pairing::PointPoints, 0.5).covers(1.0 / (100.0 * 4.0 / 3.0 * PI * 0.125)));
    assert!(at(Pairing::RayPoints, 0.5).covers(1.0 / (100.0 * PI * 0.25 * 2.0)));
    assert!(at(Pairing::RayIsotropicBeams, 0.5).covers(PI / (4.0 * 100.0 * 2.0 * 0.5)));
    // With extinction: (1 - e^-y)^2/s^2 over (1 - e^(-2y))/(2s), by a rule.
    for extinction in [1e-12, 1e-3, 0.7, 40.0] {
        let ray = Ray { length: 2.0, extinction };
        let rule = crate::quadrature::GaussLegendre::rule(100);
        let integral = |k: f64| rule.integrate(0.0, 2.0, |s| exp(-k * extinction * s));
        let want = integral(1.0) * integral(1.0) / integral(2.0);
        assert!((ray.sampled().unwrap() / want - 1.0).abs() < 1e-8, "{extinction}");
    }
    assert!(Ray { length: f64::NAN, extinction: 0.0 }.sampled().is_err());
}

#[test]
fn at_the_optimum_the_variance_is_four_over_d_of_the_squared_bias() {
    let ray = Ray { length: 1.0, extinction: 0.5 };
    for pairing in PAIRINGS {
        let (radius, error) = pairing.optimum(Kernel::Biweight, -3.0, 1e5, ray).unwrap();
        let mse = |r: f64| {
            let bias = pairing.bias_coefficient(Kernel::Biweight).unwrap().value * 3.0 * r * r;
            let variance = pairing.relative_variance(Kernel::Biweight, r, 1e5, ray).unwrap().value;
            (bias * bias, variance)
        };
        let (bias, variance) = mse(radius.value);
        let d = f64::from(pairing.dimension().number());
        assert!((variance * d / (4.0 * bias) - 1.0).abs() < 1e-10, "{pairing:?}");
        assert!((error.value / (bias + variance) - 1.0).abs() < 1e-12);
        for factor in [0.99, 1.01] {
            let (b, v) = mse(factor * radius.value);
            assert!(b + v > error.value);
        }
    }
}
