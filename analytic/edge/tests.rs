use super::*;
use crate::ball_mean::exponential_mean;
use crate::blur;
use crate::quadrature::GaussLegendre;
use crate::slab_kernel::face_moment;
use libm::{cos, exp, sin};
use proptest::prelude::*;

#[test]
fn without_decay_the_edge_is_the_cut_kernel() {
    for kernel in Kernel::SAMPLES {
        let edge = Edge::new(kernel, 0.0).unwrap();
        assert!((edge.plateau().value - 1.0).abs() < edge.plateau().error, "{kernel:?}");
        for x in [-1.5, -1.0, -0.9, -0.3, 0.0, 0.01, 0.6, 1.0, 2.0] {
            let (spread, cut) = (edge.spread(x).unwrap(), face_moment(kernel, 0, x).unwrap());
            assert!((spread.value - cut.value).abs() <= spread.error + cut.error, "{kernel:?} {x}");
            let (line, plane) = (edge.line(x).unwrap(), kernel.marginal(x).unwrap());
            assert!((line.value - plane.value).abs() <= line.error + plane.error, "{kernel:?} {x}");
        }
    }
    let uniform = Edge::new(Kernel::Uniform, 0.0).unwrap();
    let (width, known) = (uniform.rise_width().unwrap(), blur::rise_width(Dimension::Three));
    assert!((width.value - known.value).abs() <= width.error + known.error);
    assert!(uniform.equivalent_width().covers(4.0 / 3.0));
    let gaussian = Edge::new(Kernel::Gaussian, 0.7).unwrap();
    assert!((gaussian.rise_width().unwrap().value - 2.0 * 1.281_551_565_544_600_4).abs() < 1e-13);
}

/// The plane's integral by a rule in two dimensions, the shaft's decay along one of them.
fn plane(kernel: Kernel, s: f64, t: f64) -> f64 {
    let (radial, around) = (GaussLegendre::rule(48), GaussLegendre::rule(32));
    let end = if kernel == Kernel::Gaussian { 12.0 } else { f64::sqrt((1.0 - t) * (1.0 + t)) };
    let ring = |p: f64| {
        let decay = around.integrate(0.0, PI, |angle| exp(-s * p * cos(angle)));
        2.0 * p * kernel.density(Dimension::Three, libm::hypot(t, p)) * decay
    };
    // The cone's tip is near p = 0 for small t: short panels there.
    (0..6).map(|i| 0.25f64.powi(i) * end).fold(0.0, |sum, b| sum + radial.integrate(0.25 * b, b, ring))
        + radial.integrate(0.0, 0.25f64.powi(6) * end, ring)
}

proptest! {
    #![proptest_config(crate::fixed_cases(64))]

    #[test]
    fn lines_and_edges_are_integrals_over_the_kernel(s in 0.0..4.9_f64, x in -0.99..0.99_f64, which in 0_usize..7) {
        let kernel = Kernel::SAMPLES[which];
        let edge = Edge::new(kernel, s).unwrap();
        let plateau = edge.plateau();
        let mean = exponential_mean(kernel, Dimension::Three, s).unwrap();
        prop_assert!((plateau.value - mean.value).abs() <= plateau.error + mean.error, "{kernel:?} {plateau:?} {mean:?}");
        let line = edge.line(x).unwrap();
        let want = plane(kernel, s, x) / mean.value;
        prop_assert!((line.value - want).abs() <= line.error + 1e-10, "{kernel:?} {s} {x}: {line:?} {want}");
        // The edge is the integral of its line.
        let rule = GaussLegendre::rule(40);
        let from = if kernel == Kernel::Gaussian { -10.0 } else { -1.0 };
        let middle = 0.5 * (from + x.min(0.0));
        let part = |a: f64, b: f64| rule.integrate(a, b, |t| edge.line(t).unwrap().value);
        let sum = part(from, middle) + part(middle, x.min(0.0)) + part(0.0, x.max(0.0));
        let spread = edge.spread(x).unwrap();
        prop_assert!((spread.value - sum).abs() <= spread.error + 1e-12, "{kernel:?} {s} {x}: {spread:?} {sum}");
        // Slices across the shaft: discs with a closed edge each (uniform kernel).
        if kernel == Kernel::Uniform {
            let slice = |theta: f64| {
                let (z, p) = (sin(theta), cos(theta));
                0.75 * p * p * p * exp(-s * z) * blur::edge_spread(Dimension::Two, x / p).unwrap().value
            };
            let knee = libm::acos(x.abs());
            let ends = [-0.5 * PI, -knee, knee, 0.5 * PI];
            let sum: f64 = ends.windows(2).map(|e| {
                // Square roots at the knee: towards both ends of the panel in powers of three.
                let half = 0.5 * (e[1] - e[0]);
                let bent = |a: f64, sign: f64| rule.integrate(0.0, 1.0, |v| 3.0 * v * v * half * slice(a + sign * half * v * v * v));
                bent(e[0], 1.0) + bent(e[1], -1.0)
            }).sum();
            prop_assert!((spread.value * mean.value - sum).abs() < 1e-7 * mean.value, "{s} {x}: {spread:?} {sum}");
        }
    }
}

/// Widths of a shaft in mean free paths, computed elsewhere and printed to three decimals.
#[test]
fn decay_along_the_shaft_narrows_the_edge() {
    for (s, width) in [(0.0, 1.2168), (0.5, 1.212), (1.0, 1.198)] {
        let found = Edge::new(Kernel::Uniform, s).unwrap().rise_width().unwrap();
        assert!((found.value - width).abs() < 6e-4 && found.error < 1e-12, "{s}: {found:?}");
    }
    assert!(Edge::new(Kernel::Uniform, 5.1).is_err() && Edge::new(Kernel::Cone { kappa: 0.3 }, 0.0).is_err());
    assert!(Edge::new(Kernel::Uniform, 0.0).unwrap().place(1.0).is_err());
}

/// Known widths without decay, in plateau radii.
#[test]
fn nearest_points_widen_the_edge() {
    for (k, rise, equivalent) in
        [(20, 1.895, 1.632), (50, 1.923, 1.661), (100, 1.932, 1.671), (1000, 1.940, 1.679)]
    {
        let r0 = libm::cbrt(f64::from(k) * 0.75 / PI);
        let edge = NearestEdge::new(Kernel::Uniform, k, 1.0, 0.0, 20.0 * r0).unwrap();
        assert!((edge.plateau_radius() - r0).abs() < 1e-14 * r0);
        let width = edge.rise_width().unwrap();
        assert!((width.value / r0 - rise).abs() < 5.01e-4 && width.error < 1e-9 * r0, "{k}: {width:?}");
        let inverse = edge.equivalent_width().unwrap();
        assert!((inverse.value / r0 - equivalent).abs() < 5.01e-4, "{k}: {inverse:?}");
        let n = f64::from(k);
        let closed =
            4.0 / 3.0 * libm::cbrt(2.0 / n) * exp(libm::lgamma(n - 1.0) - libm::lgamma(n - 4.0 / 3.0));
        // Logarithms of gamma functions of 1000 are good to a few 1e-12.
        assert!((inverse.value / r0 / closed - 1.0).abs() < 1e-10, "{k}: {inverse:?} {closed}");
        let half = edge.mean(0.0).unwrap();
        assert!(half.covers(0.5), "{k}: {half:?}");
    }
}

/// The slope at the edge against differences of the expectation, for every kernel, with decay and a cap that matters.
#[test]
fn the_inverse_slope_is_that_of_the_expectation() {
    for kernel in &Kernel::SAMPLES[..6] {
        for (k, decay, cap) in [(5, 0.8, 3.0), (30, 0.5, 1.6), (30, 0.0, 1.4)] {
            let edge = NearestEdge::new(*kernel, k, 3.0, decay, cap).unwrap();
            let difference =
                |d: f64| (edge.mean(d).unwrap().value - edge.mean(-d).unwrap().value) / (2.0 * d);
            // Richardson's step leaves d^3 (the cone bends at 0) and d^4: less than it changes over two doublings.
            let extrapolated = |d: f64| (4.0 * difference(d) - difference(2.0 * d)) / 3.0;
            let [fine, middle, coarse] = [0.01, 0.02, 0.04].map(extrapolated);
            let left = (fine - middle).abs() + (middle - coarse).abs();
            let got = edge.equivalent_width().unwrap();
            let off = (edge.plateau().unwrap().value / got.value - fine).abs();
            // Expectations are good to 1e-12, their differences are over 0.02.
            assert!(off <= left + 1e-10 && left < 1e-3, "{kernel:?} {k} {decay} {cap}: {got:?} {off} {left}");
        }
    }
}

/// Without a cap to speak of and far inside, the expectation is that of the exponential field.
#[test]
fn the_plateau_is_that_of_an_exponential_field() {
    for kernel in &Kernel::SAMPLES[..6] {
        let (k, density, decay, cap) = (20, 50.0, 0.9, 2.0);
        let edge = NearestEdge::new(*kernel, k, density, decay, cap).unwrap();
        let want = crate::nearest::nearest_expectation_exponential(
            *kernel,
            Dimension::Three,
            k,
            density,
            decay,
            cap,
        )
        .unwrap();
        let plateau = edge.plateau().unwrap();
        assert!(
            (plateau.value - want.value).abs() <= plateau.error + want.error,
            "{kernel:?} {plateau:?} {want:?}"
        );
        let inside = edge.mean(cap).unwrap();
        assert!((inside.value - want.value).abs() <= inside.error + want.error, "{kernel:?} {inside:?}");
        assert_eq!(edge.mean(-cap).unwrap().value, 0.0);
    }
    assert!(NearestEdge::new(Kernel::Uniform, 20, 1.0, 3.0, 2.0).is_err());
    assert!(NearestEdge::new(Kernel::Uniform, 1, 1.0, 0.0, 2.0).is_err());
}
