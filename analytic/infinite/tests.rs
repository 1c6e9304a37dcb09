use super::*;
use crate::quadrature::GaussLegendre;
use libm::sin;

const MEDIA: [(f64, f64); 12] = [
    (0.0, 0.0),
    (1e-6, 0.5),
    (0.1, 0.0),
    (0.2, 0.0),
    (0.5, 0.0),
    (0.9, 0.0),
    (0.9, 0.75),
    (0.99, -0.5),
    (0.99, 0.95),
    (0.999_999, 0.85),
    (0.5, -0.95),
    (0.7, 0.99),
];

fn medium(albedo: f64, g: f64) -> InfiniteMedium {
    InfiniteMedium::henyey_greenstein(albedo, g).unwrap()
}

/// int phi = 1/(1-w) and int r^2 phi / int phi = 2/((1-w)(1-wg)): sums over the same modes and continuum.
#[test]
fn the_spectrum_conserves_power_and_second_moment() {
    for (albedo, g) in MEDIA {
        let m = medium(albedo, g);
        let total = m.sum(0.0, |k| 1.0 / (k * k), |x| 1.0 / (x * x));
        let second = m.sum(0.0, |k| 6.0 / (k * k * k * k), |x| 6.0 / (x * x * x * x));
        let exact = m.total_fluence().unwrap().value;
        // The roundings of k count twice and four times.
        let allowed = 4.0 * m.mode_rounding() * f64::EPSILON + total.error / total.value;
        assert!((total.value / exact - 1.0).abs() < allowed, "{albedo} {g} {total:?} {exact}");
        let radius = second.value / total.value;
        let exact = m.mean_square_radius().unwrap().value;
        assert!((radius / exact - 1.0).abs() < 2.0 * allowed, "{albedo} {g} {radius} {exact} {allowed:e}");
    }
}

/// The other method: the continued fraction's sine transform, (1/(2 pi^2 r)) int s sin(sr) (transform - atan(s)/s) ds
/// plus the uncollided light, half waves summed with Euler's transformation.
fn by_fourier(m: &InfiniteMedium, r: f64) -> f64 {
    let rule = GaussLegendre::new(24).unwrap();
    let wave = PI / r;
    let f = |s: f64| s * sin(s * r) * (m.transform(s).unwrap().value - libm::atan(s) / s);
    let panel = |i: usize| {
        let (a, b) = (i as f64 * wave, (i + 1) as f64 * wave);
        // The transform varies on scales of 0.1 and more, and far out on those of s.
        let parts = (wave / (0.25 + 0.25 * a)).ceil().max(1.0);
        (0..parts as usize)
            .map(|j| {
                let edge = |j: usize| a + (b - a) * j as f64 / parts;
                rule.integrate(edge(j), edge(j + 1), f)
            })
            .sum::<f64>()
    };
    let mut sum: f64 = (0..20).map(panel).sum();
    let mut terms: Vec<f64> = (20..46).map(|i| panel(i) * if i % 2 == 0 { 1.0 } else { -1.0 }).collect();
    let mut scale = 0.5;
    while !terms.is_empty() {
        sum += scale * terms[0];
        terms = terms.windows(2).map(|p| p[0] - p[1]).collect();
        scale *= 0.5;
    }
    sum / (2.0 * PI * PI * r) + exp(-r) / (4.0 * PI * r * r)
}

#[test]
fn the_fourier_integral_agrees() {
    for (albedo, g, tolerance) in
        [(0.9, 0.0, 1e-10), (0.5, 0.5, 1e-10), (0.9, 0.75, 1e-10), (0.99, -0.5, 1e-10), (0.95, 0.93, 1e-8)]
    {
        let m = medium(albedo, g);
        for r in [0.5, 2.0, 6.0] {
            let (a, b) = (m.fluence(r).unwrap(), by_fourier(&m, r));
            assert!((a.value / b - 1.0).abs() < tolerance, "{albedo} {g} {r} {a:?} {b}");
        }
    }
}

/// Without scattering the transform is atan(s)/s; isotropic q/(1 - w q); at small s the power balance.
#[test]
fn the_transform_in_closed_form() {
    for s in [1e-9, 0.1, 1.0, 10.0, 1000.0, 1e5] {
        let exact = libm::atan(s) / s;
        let got = medium(0.0, 0.75).transform(s).unwrap();
        assert!(got.covers(exact) && got.error < 1e-10 * exact, "s {s} {got:?} {exact}");
        let got = medium(0.9, 0.0).transform(s).unwrap();
        assert!(
            (got.value - exact / (1.0 - 0.9 * exact)).abs()
                <= got.error + 1e-15 * exact / (1.0 - 0.9 * exact)
        );
    }
    for g in [-0.5, 0.0, 0.75] {
        assert!((medium(0.9, g).transform(1e-6).unwrap().value - 10.0).abs() < 1e-8);
    }
}

#[test]
fn bounds_are_small_and_limits_are_met() {
    for (albedo, g) in MEDIA {
        let m = medium(albedo, g);
        let mut worst = 0.0_f64;
        for r in [1e-12, 1e-3, 0.1, 1.0, 5.0, 20.0, 50.0, 200.0] {
            let phi = m.fluence(r).unwrap();
            worst = worst.max(phi.error / phi.value);
            let uncollided = exp(-r) / (4.0 * PI * r * r);
            assert!(phi.value >= uncollided * (1.0 - 1e-11), "{albedo} {g} {r} {phi:?} {uncollided}");
            if albedo == 0.0 {
                assert!(
                    (phi.value - uncollided).abs() <= phi.error + 1e-13 * uncollided,
                    "{r} {phi:?} {uncollided}"
                );
            }
        }
        assert!(worst < 1e-9, "{albedo} {g} {worst:e}");
        // Near the source nothing has been scattered but w pi^2 r/4 per unit, or little more with a forward peak.
        let near = 4.0 * PI * 1e-24 * m.fluence(1e-12).unwrap().value;
        assert!(
            (near - 1.0).abs() < 1e-8 && (4.0 * PI * 1e-24 * m.flux(1e-12).unwrap().value - 1.0).abs() < 1e-8
        );
    }
}

/// d/dr (4 pi r^2 F) = -(1-w) 4 pi r^2 phi.
#[test]
fn flux_falls_by_absorption() {
    let rule = GaussLegendre::new(24).unwrap();
    for (albedo, g) in [(0.5, 0.0), (0.9, 0.75), (0.99, -0.5)] {
        let m = medium(albedo, g);
        let power = |r: f64| 4.0 * PI * r * r * m.flux(r).unwrap().value;
        let lost =
            (1.0 - albedo) * rule.integrate(0.5, 1.0, |r| 4.0 * PI * r * r * m.fluence(r).unwrap().value);
        assert!((power(0.5) - power(1.0) - lost).abs() < 1e-13, "{albedo} {g}");
    }
}

#[test]
fn walks() {
    for (g, n, exact) in [(0.0, 7, 14.0), (1.0, 3, 12.0), (0.5, 2, 5.0), (-0.5, 2, 3.0), (0.3, 0, 0.0)] {
        let got = mean_square_displacement(g, n).unwrap();
        assert!(got.covers(exact), "{g} {n} {got:?}");
    }
    // The two forms meet.
    for n in [10_u32, 1000, 100_000] {
        let gap = 1.0 / f64::from(n);
        let (below, above) = (1.0 - gap * (1.0 + 1e-9), 1.0 - gap * (1.0 - 1e-9));
        let (a, b) =
            (mean_square_displacement(below, n).unwrap(), mean_square_displacement(above, n).unwrap());
        assert!((a.value / b.value - 1.0).abs() < 2e-9 && a.method != b.method, "{a:?} {b:?}");
    }
    assert!(mean_cosine(-0.5, 3).unwrap().covers(-0.125));
}

/// The same two terms by adaptive quadrature with 30 to 40 digits.
#[test]
fn known_fluences() {
    for (w, r, known) in [
        (0.02, 1e-3, 79501.83700565656),
        (0.02, 1.0, 0.029977802137282027),
        (0.02, 50.0, 6.815474117537966e-27),
        (0.1, 1e-3, 79517.45925074953),
        (0.1, 1.0, 0.033052213021676484),
        (0.1, 50.0, 1.0895353865095043e-26),
        (0.1, 300.0, 1.0446993341346e-136),
        (0.25, 1.0, 0.04022214087472053),
        (0.999_999, 1.0, 0.2606029336522464),
        (0.999_999, 50.0, 0.004378543826958662),
        (0.999_999, 300.0, 0.00047328582661019847),
    ] {
        let got = medium(w, 0.0).fluence(r).unwrap();
        assert!((got.value - known).abs() <= got.error + 5e-14 * known, "{w} {r} {got:?} {known:e}");
        assert!(got.error < 1e-12 * known, "{w} {r} {got:?}");
    }
}
