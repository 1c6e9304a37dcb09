//! Estimators on maps of independent photons of known density: the mean of every kernel and gather against
//! its exact value, and the variance against the stated one. Each law has negative controls that must be rejected.
//!
//! The exact mean at a fixed radius is that of the kernel over the density. For the k-nearest rule the mass P
//! of the ball through the k-th of N photons is Beta(k, N-k+1), and given the ball the k-1 photons in it are
//! independent with the density over P, so the mean is E((k-1)/(N P) x (kernel mean at r(P))), an integral
//! over the radius.

use crate::common::ALPHA;
use glam::DVec3;
use statrs::distribution::{ContinuousCDF, StudentsT};
use std::f64::consts::PI;
use turbid::Spectrum;
use turbid::estimators::boundary::Boundary;
use turbid::estimators::{Estimator, Gather, Kernel};
use turbid::math::{Asymmetry, FOUR_PI, exp, ln, sin_cos};
use turbid::phase::HenyeyGreenstein;
use turbid::photons::PhotonMap;
use turbid::photons::synthetic::{Number, Profile, Synthetic};

const SEED: u64 = 41;
const MAPS: u64 = 512;
const PHOTONS: u64 = 4000;
const RADIUS: f64 = 0.12;
const K: usize = 20;
const CAP: f64 = 0.2;

/// Mean over maps of one number a map, and what a t test makes of it.
struct Verdict {
    mean: f64,
    reference: f64,
    std_error: f64,
    p: f64,
    /// The smallest detectable bias with 99 % power.
    detectable: f64,
}

impl Verdict {
    fn new(values: &[f64], reference: f64) -> Self {
        let n = values.len() as f64;
        let mean = values.iter().sum::<f64>() / n;
        let variance = values.iter().map(|v| (v - mean) * (v - mean)).sum::<f64>() / (n - 1.0);
        let std_error = (variance / n).sqrt();
        let student = StudentsT::new(0.0, 1.0, n - 1.0).unwrap();
        let p = 2.0 * student.sf(((mean - reference) / std_error).abs());
        let threshold = student.inverse_cdf(1.0 - 0.5 * ALPHA);
        Verdict { mean, reference, std_error, p, detectable: (threshold + 2.4) * std_error }
    }

    fn describe(&self, what: &str) -> String {
        let Verdict { mean, reference, std_error, p, detectable } = self;
        let z = (mean - reference) / std_error;
        format!(
            "{what}: {mean:.5} +- {std_error:.5}, reference {reference:.5}, z {z:.2}, p {p:.1e}, seed {SEED}, \
             detectable {detectable:.5}; cargo test --release -p turbid --test physics photons::statistics"
        )
    }

    /// The mean is the reference, and a bias of `promised` would have been detected.
    fn accept(&self, what: &str, promised: f64) {
        assert!(self.p >= ALPHA, "{}", self.describe(what));
        assert!(self.detectable <= promised, "promised {promised}: {}", self.describe(what));
    }

    fn reject(&self, what: &str) {
        assert!(self.p < ALPHA, "not rejected: {}", self.describe(what));
    }
}

fn synthetic(profile: Profile) -> Synthetic {
    Synthetic::new(profile, DVec3::ZERO, DVec3::ONE).unwrap()
}

fn maps(synthetic: Synthetic, number: Number) -> impl Iterator<Item = PhotonMap> {
    (0..MAPS).map(move |replicate| synthetic.map(number, SEED, replicate).unwrap())
}

/// 27 places whose largest balls neither leave the box nor meet.
fn probes() -> impl Iterator<Item = DVec3> {
    let at = |i: usize| [0.2, 0.5, 0.8][i];
    (0..27).map(move |i| DVec3::new(at(i % 3), at(i / 3 % 3), at(i / 9)))
}

/// Simpson's rule with n even.
fn integral(n: u32, from: f64, to: f64, f: impl Fn(f64) -> f64) -> f64 {
    let h = (to - from) / f64::from(n);
    let weight = |i: u32| f64::from(if i == 0 || i == n { 1 } else { 2 + 2 * (i % 2) });
    (0..=n).map(|i| weight(i) * f(from + h * f64::from(i))).sum::<f64>() * h / 3.0
}

/// The density about a point: its means over spheres of radius r are steady + varying x mean(r).
struct Local {
    steady: f64,
    varying: f64,
    mean: fn(f64) -> f64,
    wave: f64,
}

impl Local {
    fn new(profile: Profile, at: DVec3) -> Self {
        let here = synthetic(profile).density(at);
        let flat = |_: f64| 1.0;
        let sinh = |x: f64| if x < 1e-4 { 1.0 + x * x / 6.0 } else { (exp(x) - exp(-x)) / (2.0 * x) };
        let sine = |x: f64| if x < 1e-4 { 1.0 - x * x / 6.0 } else { sin_cos(x).0 / x };
        match profile {
            Profile::Exponential { rate } => {
                Local { steady: 0.0, varying: here, mean: sinh, wave: rate.abs() }
            }
            Profile::Sinusoid { periods, .. } => {
                Local { steady: 1.0, varying: here - 1.0, mean: sine, wave: 2.0 * PI * f64::from(periods) }
            }
            _ => Local { steady: here, varying: 0.0, mean: flat, wave: 0.0 },
        }
    }

    fn sphere_mean(&self, r: f64) -> f64 {
        self.steady + self.varying * (self.mean)(self.wave * r)
    }

    fn kernel_mean(&self, kernel: Kernel, r: f64) -> f64 {
        let shell = |u: f64| 4.0 * PI * u * u * kernel.peak() * kernel.profile(u * u);
        integral(200, 0.0, 1.0, |u| shell(u) * self.sphere_mean(u * r))
    }

    fn mass(&self, r: f64) -> f64 {
        4.0 / 3.0 * PI * r * r * r * self.kernel_mean(Kernel::Uniform, r)
    }

    /// The exact mean of the k-nearest rule, balls beyond the cap left out: at these densities they are rarer
    /// than 1e-9, which the weight's integral, one, shows.
    fn nearest_mean(&self, kernel: Kernel) -> f64 {
        let (n, k) = (PHOTONS as f64, K as f64);
        let log_beta = libm::lgamma(n + 1.0) - libm::lgamma(k) - libm::lgamma(n - k + 1.0);
        let weight = |r: f64| {
            let mass = self.mass(r);
            let log = log_beta + (k - 1.0) * ln(mass) + (n - k) * libm::log1p(-mass);
            exp(log) * 4.0 * PI * r * r * self.sphere_mean(r)
        };
        let total = integral(400, 1e-3, CAP, weight);
        assert!((total - 1.0).abs() < 1e-6, "the radius is within the cap: {total}");
        integral(400, 1e-3, CAP, |r| weight(r) * (k - 1.0) / (n * self.mass(r)) * self.kernel_mean(kernel, r))
    }
}

/// One number a map: the mean over probes of estimate over exact value, for each question.
fn ratios(map: &PhotonMap, questions: &[Estimator], exact: &[Vec<f64>]) -> Vec<f64> {
    let ratio = |(estimator, exact): (&Estimator, &Vec<f64>)| {
        let each = probes().zip(exact).map(|(at, exact)| {
            let estimate = estimator.collision_density(map, at, &Boundary::UNKNOWN);
            assert!(!estimate.underfull || estimator.gather.k().is_none());
            estimate.value.mean() / exact
        });
        each.sum::<f64>() / 27.0
    };
    questions.iter().zip(exact).map(ratio).collect()
}

/// Maps share their photons between the questions asked of them, so the verdicts of one profile are not
/// independent; each holds by itself.
#[test]
fn every_kernel_and_gather_has_its_exact_mean() {
    let profiles = [
        Profile::Constant,
        Profile::Linear { slope: 0.9 },
        Profile::Exponential { rate: 1.5 },
        Profile::Sinusoid { amplitude: 0.5, periods: 3 },
    ];
    let questions: Vec<Estimator> = Kernel::ALL
        .into_iter()
        .flat_map(|kernel| {
            [Gather::radius(RADIUS), Gather::nearest(K, CAP)]
                .map(|gather| Estimator::new(kernel, gather.unwrap()))
        })
        .collect();
    for profile in profiles {
        let exact: Vec<Vec<f64>> = questions
            .iter()
            .map(|&Estimator { kernel, gather, .. }| {
                let mean = |at: DVec3| match gather.k() {
                    None => Local::new(profile, at).kernel_mean(kernel, gather.cap()),
                    Some(_) => Local::new(profile, at).nearest_mean(kernel),
                };
                probes().map(mean).collect()
            })
            .collect();
        let by_map: Vec<Vec<f64>> = maps(synthetic(profile), Number::Exact(PHOTONS))
            .map(|map| ratios(&map, &questions, &exact))
            .collect();
        for (i, estimator) in questions.iter().enumerate() {
            let kernel = estimator.kernel;
            let column: Vec<f64> = by_map.iter().map(|row| row[i]).collect();
            let verdict = Verdict::new(&column, 1.0);
            let what = format!("{profile:?} {}", estimator.name());
            verdict.accept(&what, 0.03);
            // The negative control of a normalisation: the Gaussian of infinite extent, three per cent low.
            if kernel == Kernel::Gaussian && profile == Profile::Constant {
                let uncut = 1.0 / (2.0 * PI / 9.0 * (2.0 * PI / 9.0).sqrt()) / kernel.peak();
                let wrong: Vec<f64> = column.iter().map(|v| v * uncut).collect();
                Verdict::new(&wrong, 1.0).reject(&what);
            }
        }
    }
}

/// One number a map: the mean over the probes.
fn by_map(synthetic: Synthetic, number: Number, mean: impl Fn(&PhotonMap, DVec3) -> f64) -> Vec<f64> {
    maps(synthetic, number).map(|map| probes().map(|at| mean(&map, at)).sum::<f64>() / 27.0).collect()
}

fn density_at(map: &PhotonMap, at: DVec3, kernel: Kernel, gather: Gather) -> f64 {
    Estimator::new(kernel, gather).collision_density(map, at, &Boundary::UNKNOWN).value.mean()
}

#[test]
fn all_k_photons_read_high_as_stated() {
    let gather = Gather::nearest_biased(K, CAP).unwrap();
    for kernel in [Kernel::Uniform, Kernel::Gaussian] {
        let values = by_map(synthetic(Profile::Constant), Number::Exact(PHOTONS), |map, at| {
            density_at(map, at, kernel, gather)
        });
        let stated = 1.0 + gather.expected_bias(kernel, 1.0, 0.0, PHOTONS as f64);
        Verdict::new(&values, stated).accept(&format!("k for k-1, {}", kernel.name()), 0.03);
        if kernel == Kernel::Uniform {
            assert!((stated - K as f64 / (K as f64 - 1.0)).abs() < 1e-12);
            Verdict::new(&values, 1.0).reject("k for k-1");
        }
    }
}

#[test]
fn the_nearest_rule_reads_a_uniform_field() {
    crate::checks::points::a_uniform_field_is_read_as_it_is(crate::checks::points::nearest());
}

#[test]
fn estimates_divide_by_emitted() {
    crate::checks::points::a_thinned_field_is_read_as_what_is_left(|_| 1.0);
}

/// A cap that holds k photons on average: about half of the gathers are under-full, and the mixture of the
/// two rules is unbiased in a uniform field of Poisson number. k-1 for k in the under-full ones is not.
#[test]
fn the_mixture_with_under_full_gathers_is_unbiased() {
    let cap = libm::cbrt(K as f64 / (PHOTONS as f64 * 4.0 / 3.0 * PI));
    let estimator = Estimator::new(Kernel::Epanechnikov, Gather::nearest(K, cap).unwrap());
    let ask = |wrong: bool| {
        by_map(synthetic(Profile::Constant), Number::Expected(PHOTONS), |map, at| {
            let estimate = estimator.collision_density(map, at, &Boundary::UNKNOWN);
            let n = estimate.found as f64;
            let factor = if wrong && estimate.underfull && n > 0.0 { (n - 1.0) / n } else { 1.0 };
            estimate.value.mean() * factor
        })
    };
    Verdict::new(&ask(false), 1.0).accept("mixture", 0.03);
    Verdict::new(&ask(true), 1.0).reject("mixture with k-1 throughout");
}

/// The mean of (estimate/field - 1)^2 over probes and maps, against the stated variance. A square of kurtosis
/// 4 has a standard error of sqrt(3/(27 x 512)), 1.5 per cent, so 15 per cent can be promised.
#[test]
fn variances_are_as_stated() {
    for kernel in Kernel::ALL {
        let gathers = [Gather::radius(RADIUS), Gather::nearest(K, CAP), Gather::nearest_biased(K, CAP)];
        for gather in gathers.map(|gather| gather.unwrap()) {
            let bias = match gather {
                Gather::NearestBiased { .. } => gather.expected_bias(kernel, 1.0, 0.0, PHOTONS as f64),
                Gather::Radius(_) | Gather::Nearest { .. } => 0.0,
            };
            let stated = gather.expected_relative_variance(kernel, PHOTONS as f64, 1.0);
            let squares = by_map(synthetic(Profile::Constant), Number::Expected(PHOTONS), |map, at| {
                let error = density_at(map, at, kernel, gather) - 1.0 - bias;
                error * error / stated
            });
            let what = format!("variance, {} {gather:?}", kernel.name());
            Verdict::new(&squares, 1.0).accept(&what, 0.15);
            // The negative control: the variance of the uniform kernel for all of them.
            if kernel == Kernel::Gaussian {
                let uniform = gather.expected_relative_variance(Kernel::Uniform, PHOTONS as f64, 1.0);
                let wrong: Vec<f64> = squares.iter().map(|s| s * stated / uniform).collect();
                Verdict::new(&wrong, 1.0).reject(&what);
            }
        }
    }
}

/// On the edge of a half-space every kernel sees half the plateau, inside at depth h the box kernel sees
/// 1/2 + 3x/4 - x^3/4 of it, x = h/r.
#[test]
fn an_edge_is_blurred_as_stated() {
    let (edge, plateau, x) = (0.4, 1.0 / 0.6, 0.5);
    let gather = Gather::radius(RADIUS).unwrap();
    let step = synthetic(Profile::Step { edge });
    let beside = |at: DVec3, depth: f64| DVec3::new(edge + depth * RADIUS, at.y, at.z);
    for (kernel, depth, share) in [
        (Kernel::Uniform, 0.0, 0.5),
        (Kernel::Cone, 0.0, 0.5),
        (Kernel::Gaussian, 0.0, 0.5),
        (Kernel::Uniform, x, 0.5 + 0.75 * x - 0.25 * x * x * x),
        (Kernel::Uniform, -x, 0.5 - 0.75 * x + 0.25 * x * x * x),
        (Kernel::Uniform, 1.1, 1.0),
    ] {
        // Probes that differ in x only fall together: nine places, three times each.
        let values = by_map(step, Number::Exact(PHOTONS), |map, at| {
            density_at(map, beside(at, depth), kernel, gather) / plateau
        });
        Verdict::new(&values, share).accept(&format!("edge, {} at {depth}", kernel.name()), 0.05);
    }
    let outside = step.map(Number::Exact(PHOTONS), SEED, 0).unwrap();
    assert_eq!(density_at(&outside, beside(DVec3::splat(0.5), -1.01), Kernel::Uniform, gather), 0.0);
}

/// Directions are isotropic, so the in-scattered radiance is the fluence over 4 pi whatever the phase
/// function.
#[test]
fn isotropic_light_scatters_alike() {
    let estimator = Estimator::new(Kernel::Epanechnikov, Gather::radius(RADIUS).unwrap());
    for g in [-0.5, 0.0, 0.8] {
        let phase = HenyeyGreenstein::new(Asymmetry::new("g", g).unwrap());
        let (sigma_t, wo) = (Spectrum::grey(2.5), DVec3::new(0.0, 0.6, -0.8));
        let values = by_map(synthetic(Profile::Constant), Number::Exact(PHOTONS), |map, at| {
            let found = estimator.in_scattered(map, at, wo, &phase, sigma_t, &Boundary::UNKNOWN);
            found.value.mean() * FOUR_PI * 2.5
        });
        Verdict::new(&values, 1.0).accept(&format!("in-scattered, g = {g}"), 0.06);
    }
}

/// Exactly, no statistics: the bias of the k-nearest rule goes with E(r_{k-1}^2), and is left by terms of the
/// order of (rate r)^2 of itself. With r_k for r_{k-1} it would be 7 per cent off at k = 20.
#[test]
fn the_blur_of_the_nearest_rule_is_as_stated() {
    let rate = 1.5;
    let at = DVec3::splat(0.5);
    let local = Local::new(Profile::Exponential { rate }, at);
    let field = synthetic(Profile::Exponential { rate }).density(at);
    for kernel in Kernel::ALL {
        let gather = Gather::nearest(K, CAP).unwrap();
        let density = PHOTONS as f64 * field;
        let stated = gather.expected_bias(kernel, field, rate * rate * field, density);
        let exact = local.nearest_mean(kernel) - field;
        let order = rate * rate * gather.effective_squared_radius(density);
        assert!((exact / stated - 1.0).abs() < order, "{}: {exact} for {stated}", kernel.name());
    }
}
