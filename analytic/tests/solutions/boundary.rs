//! Photon estimates of fixed radius at boundaries, against closed forms and other quadratures.

use crate::support::kernels::{BALL, KERNELS, agree};
use turbid_analytic::boundary::{
    Body, Treatment, body_moment, treated_mean, treated_mean_symmetric, treated_mean_uniform,
    treated_variance,
};
use turbid_analytic::quadrature::GaussLegendre;
use turbid_analytic::slab_kernel::{face_moment, slab_kernel_mean, slab_moment};
use turbid_analytic::volumes::lens_volume;
use turbid_analytic::{Incidence, IsotropicSlab, Kernel, Value};

#[test]
fn moments_at_flat_faces() {
    let slab = Body::Slab { thickness: 0.5 };
    for kernel in KERNELS {
        for h in [0.0, 1e-9, 0.1, 0.25, 0.4, 0.7] {
            for j in 0..3 {
                let got = body_moment(kernel, Body::HalfSpace, [3.0, -7.0, h], 0.4, j).unwrap();
                let want = face_moment(kernel, j, h / 0.4).unwrap();
                assert!(agree(got, want) && got.error < 1e-9, "{kernel:?} {h} {j}: {got:?} {want:?}");
                if h > 0.5 {
                    continue;
                }
                let got = body_moment(kernel, slab, [0.0, 0.0, h], 0.4, j).unwrap();
                // The nearest face is the other one in the lower half, and z points up there.
                let want = slab_moment(kernel, j, 0.4, if h > 0.25 { 0.5 - h } else { h }, 0.5).unwrap();
                assert!(agree(got, want) && got.error < 1e-9, "{kernel:?} {h} {j}: {got:?} {want:?}");
            }
        }
    }
    for x in [0.0, 0.3, 0.99] {
        let m = |j| body_moment(Kernel::Uniform, Body::HalfSpace, [0.0, 0.0, 2.0 * x], 2.0, j).unwrap();
        assert!(m(0).covers(0.5 + 0.75 * x - 0.25 * x * x * x));
        assert!(m(1).covers(3.0 / 16.0 * (1.0 - x * x) * (1.0 - x * x)));
    }
}

#[test]
fn lenses_of_a_sphere() {
    for a in [0.3, 1.0, 2.0] {
        for distance in [0.0, 1e-7, 0.05, 0.29, 0.3] {
            for r in [0.01, 0.2, 0.5, 5.0] {
                let at = [distance * 0.6, 0.0, -distance * 0.8];
                let got = body_moment(Kernel::Uniform, Body::Sphere { radius: a }, at, r, 0).unwrap();
                let want = over(lens_volume(a, r, distance).unwrap(), BALL * r * r * r);
                assert!(agree(got, want) && got.error < 1e-8, "{a} {distance} {r}: {got:?} {want:?}");
            }
        }
    }
}

/// The same value in a unit of `unit`.
fn over(value: Value, unit: f64) -> Value {
    Value { value: value.value / unit, error: value.error / unit, method: value.method }
}

/// int_a^b f by a rule of 40 nodes on 200 panels. A kink inside a panel of width w leaves about w^2/40^2 of its change
/// of slope, here 2e-8 of an order of 10.
fn many_panels(a: f64, b: f64, f: impl Fn(f64) -> f64) -> f64 {
    let rule = GaussLegendre::new(40).unwrap();
    let step = (b - a) / 200.0;
    (0..200).map(|i| rule.integrate(a + step * f64::from(i), a + step * f64::from(i + 1), &f)).sum()
}

#[test]
fn moments_in_a_sphere_by_discs() {
    let (a, distance, r): (f64, f64, f64) = (1.0, 0.8, 0.5);
    // Outwards from the probe, the ball and the sphere are both cut into discs.
    let disc = |x: f64| (r * r - x * x).min(a * a - (x + distance) * (x + distance)).max(0.0);
    for j in 0..3 {
        let power = |x: f64| (0..j).fold(1.0, |p, _| p * -x / r);
        let want = many_panels(-r, r, |x| std::f64::consts::PI * disc(x) * power(x)) / (BALL * r * r * r);
        let got =
            body_moment(Kernel::Uniform, Body::Sphere { radius: a }, [0.0, distance, 0.0], r, j).unwrap();
        assert!((got.value - want).abs() < 2e-7, "{j} {got:?} {want}");
    }
}

/// Area of 0 < x < a, 0 < y < b inside the circle of radius rho.
fn corner_area(a: f64, b: f64, rho: f64) -> f64 {
    let (a, b) = (a.min(rho), b.min(rho));
    if a * a + b * b <= rho * rho {
        return a * b;
    }
    // Under the circle from x = sqrt(rho^2 - b^2) to a, and the rectangle before it.
    let primitive =
        |x: f64| 0.5 * (x * (rho * rho - x * x).max(0.0).sqrt() + rho * rho * libm::asin((x / rho).min(1.0)));
    let x = (rho * rho - b * b).max(0.0).sqrt();
    b * x + primitive(a) - primitive(x)
}

#[test]
fn moments_in_a_cuboid_by_rectangles() {
    let edges = [1.0, 0.7, 0.9];
    for (at, r) in [([0.3, 0.25, 0.1], 0.45), ([0.1, 0.2, 0.05], 0.7), ([0.5, 0.35, 0.9], 0.6)] {
        // The nearest face is one of z in each.
        let up = at[2] < 0.45;
        let depth = if up { at[2] } else { edges[2] - at[2] };
        let area = |z: f64| {
            let rho = (r * r - z * z).max(0.0).sqrt();
            let mut sum = 0.0;
            for x in [at[0], edges[0] - at[0]] {
                for y in [at[1], edges[1] - at[1]] {
                    sum += corner_area(x, y, rho);
                }
            }
            sum
        };
        for j in 0..3 {
            let power = |z: f64| (0..j).fold(1.0, |p, _| p * z / r);
            let want = many_panels((-depth).max(-r), (edges[2] - depth).min(r), |z| area(z) * power(z))
                / (BALL * r * r * r);
            let got = body_moment(Kernel::Uniform, Body::Cuboid { edges }, at, r, j).unwrap();
            assert!((got.value - want).abs() < 2e-7 && got.error < 1e-7, "{at:?} {j} {got:?} {want}");
        }
    }
    // A corner keeps an eighth, and of the first moment a quarter of what a face keeps.
    for kernel in KERNELS {
        let m = |j| body_moment(kernel, Body::Cuboid { edges }, [1.0, 0.0, 0.9], 0.3, j).unwrap();
        assert!(m(0).covers(0.125), "{:?}", m(0));
        let face = face_moment(kernel, 1, 0.0).unwrap().value;
        assert!((m(1).value - 0.25 * face).abs() <= m(1).error + 1e-15, "{:?} {face}", m(1));
    }
}

#[test]
fn the_table_of_a_flat_face() {
    let (s, r) = (0.7, 0.3);
    let line = |z: f64| 2.0 + s * z;
    for kernel in KERNELS {
        let m1 = face_moment(kernel, 1, 0.0).unwrap().value;
        let half = |treatment, field: &dyn Fn(f64) -> f64| {
            treated_mean_symmetric(treatment, kernel, Body::HalfSpace, [0.0; 3], r, field).unwrap()
        };
        let want = [1.0 + s * r * m1, 2.0 + 2.0 * s * r * m1, 2.0 + 2.0 * s * r * m1, 2.0];
        for ((treatment, want), one) in Treatment::ALL.into_iter().zip(want).zip([0.5, 1.0, 1.0, 1.0]) {
            let got = half(treatment, &line);
            assert!((got.value - want).abs() <= got.error + 1e-15, "{treatment:?} {got:?} {want}");
            let got = half(treatment, &|_| 1.0);
            assert!(got.covers(one) && got.error < 1e-11, "{treatment:?} {got:?}");
        }
        if kernel == Kernel::Uniform {
            assert!((2.0 * m1 - 0.375).abs() < 1e-15);
        }
    }
}

#[test]
fn the_table_of_variances() {
    let at = |x: f64| {
        Treatment::ALL.map(|treatment| {
            treated_variance(treatment, Kernel::Uniform, Body::HalfSpace, [0.0, 0.0, x], 1.0).unwrap()
        })
    };
    // On the face M_0 = 1/2, M_1 = 3/16, M_2 = 1/10: local linear M_2/(M_0 M_2 - M_1^2) = 128/19.
    for (got, want) in at(0.0).iter().zip([0.5, 2.0, 2.0, 128.0 / 19.0]) {
        assert!(got.covers(want), "{got:?} {want}");
    }
    for x in [0.25, 0.5, 0.75] {
        let got = at(x).map(|v| v.value);
        // The square of the uniform kernel is proportional to itself: 1/M_0, and M_2/(M_0 M_2 - M_1^2) for the fit.
        let m = [0, 1, 2].map(|j| face_moment(Kernel::Uniform, j, x).unwrap().value);
        assert!((got[0] - m[0]).abs() < 1e-12 && (got[1] - 1.0 / m[0]).abs() < 1e-12, "{x} {got:?}");
        assert!((got[3] - m[2] / (m[0] * m[2] - m[1] * m[1])).abs() < 1e-11, "{x} {got:?}");
        // Reflection: 1 and the lens of two balls 2h apart.
        let lens = lens_volume(1.0, 1.0, 2.0 * x).unwrap().value / BALL;
        assert!((got[2] - 1.0 - lens).abs() < 1e-12, "{x} {} {lens}", got[2]);
    }
    let edges = [1.0, 0.8, 0.9];
    for kernel in KERNELS {
        let variance = |body, at| treated_variance(Treatment::Reflection, kernel, body, at, 0.2).unwrap();
        assert!(variance(Body::Cuboid { edges }, [1.0, 0.0, 0.0]).covers(8.0));
        assert!(variance(Body::Cuboid { edges }, [1.0, 0.4, 0.0]).covers(4.0));
        // A sphere so large that it is flat, but for r/a.
        let x = 0.05;
        let flat = variance(Body::HalfSpace, [0.0, 0.0, x]).value;
        let round = variance(Body::Sphere { radius: 1e6 }, [0.0, 0.0, 1e6 - x]);
        assert!((round.value - flat).abs() < 1e-6 + round.error, "{kernel:?} {round:?} {flat}");
        // The largest ball that a slab allows: images of images meet in it, at distances 0.2 and 0.4.
        let slab = variance(Body::Slab { thickness: 0.2 }, [0.0, 0.0, 0.1]).value;
        let lone = variance(Body::HalfSpace, [0.0, 0.0, 0.1]).value;
        assert!((slab - 1.0 - 2.0 * (lone - 1.0)).abs() < 1e-10, "{kernel:?} {slab} {lone}");
        for treatment in Treatment::ALL {
            let got = treated_variance(treatment, kernel, Body::HalfSpace, [0.0, 0.0, 0.3], 0.2).unwrap();
            assert!(got.covers(1.0), "{treatment:?} {got:?}");
        }
    }
}

#[test]
fn known_answers_in_a_slab() {
    let slab = IsotropicSlab::new(2.0, 0.9, Incidence::Beam { mu0: 1.0 }).unwrap();
    let phi = |t: f64| slab.fluence_interpolated(t).unwrap().value;
    for (r, h, percent) in [
        (0.2, 0.0, [-47.12, 5.76, 5.76, 2.36]),
        (0.2, 0.1, [-15.89, -0.32, -0.79, -0.92]),
        (0.05, 0.0, [-48.715, 2.57, 2.57, 0.60]),
        (0.4, 0.4, [-1.43; 4]),
    ] {
        let body = Body::Slab { thickness: 2.0 };
        for (treatment, percent) in Treatment::ALL.into_iter().zip(percent) {
            let got =
                treated_mean_symmetric(treatment, Kernel::Uniform, body, [0.0, 0.0, h], r, phi).unwrap();
            let off = 100.0 * (got.value / phi(h) - 1.0);
            // To the two decimals given.
            assert!((off - percent).abs() < 0.0051, "{r} {h} {treatment:?}: {off} {percent}");
            assert!(got.error < 1e-9, "{got:?}");
        }
    }
}

#[test]
fn a_slab_by_its_marginal() {
    let (thickness, r) = (0.9, 0.5);
    let f = |t: f64| libm::exp(-1.3 * t) + if t > 0.0 { t * libm::log(t) } else { 0.0 };
    let body = Body::Slab { thickness };
    for kernel in KERNELS {
        for h in [0.0, 0.05, 0.4, 0.6, 0.9] {
            let plain = slab_kernel_mean(kernel, r, h, thickness, f).unwrap();
            let mass = slab_moment(kernel, 0, r, h, thickness).unwrap().value;
            // A kernel at an image sees the slab as the even continuation shows it to the probe: a slab three times
            // as thick.
            let fold = |t: f64| {
                let x = (t - thickness).abs();
                f(if x > thickness { 2.0 * thickness - x } else { x })
            };
            let folded = slab_kernel_mean(kernel, r, h + thickness, 3.0 * thickness, fold).unwrap();
            let ask =
                |treatment| treated_mean_symmetric(treatment, kernel, body, [5.0, 0.0, h], r, f).unwrap();
            assert!(
                agree(ask(Treatment::None), plain),
                "{kernel:?} {h} {:?} {plain:?}",
                ask(Treatment::None)
            );
            assert!((ask(Treatment::Clipped).value * mass - plain.value).abs() < 1e-9);
            let got = ask(Treatment::Reflection);
            assert!((got.value - folded.value).abs() < 1e-8, "{kernel:?} {h} {got:?} {folded:?}");
            for treatment in Treatment::ALL {
                let any = treated_mean(treatment, kernel, body, [5.0, 0.0, h], r, |y| f(y[2])).unwrap();
                assert!(agree(any, ask(treatment)), "{treatment:?} {any:?} {:?}", ask(treatment));
            }
        }
    }
}

/// With the marginal p of the kernel, int_O K f = (1/D) int_(-a)^a rho f(|rho|) p(rho - D) drho in a sphere of radius a.
#[test]
fn a_sphere_by_its_odd_slab() {
    let (a, r) = (1.0, 0.4);
    let f = |rho: f64| 2.0 - rho * rho + 0.3 * libm::cos(2.0 * rho);
    let body = Body::Sphere { radius: a };
    let plain = |kernel, x: f64, most: f64| {
        // Images lie outside the sphere: a slab that reaches them, empty there.
        let odd = |t: f64| if (t - most).abs() <= a { (t - most) * f((t - most).abs()) } else { 0.0 };
        slab_kernel_mean(kernel, r, x + most, 2.0 * most, odd).unwrap().value / x
    };
    for kernel in KERNELS {
        for distance in [0.3, 0.7, 0.95, 1.0] {
            let at = [0.0, 0.6 * distance, 0.8 * distance];
            let ask = |treatment| treated_mean_symmetric(treatment, kernel, body, at, r, f).unwrap();
            let whole = plain(kernel, distance, a);
            let image = plain(kernel, 2.0 * a - distance, 2.0 * a);
            let mass = body_moment(kernel, body, at, r, 0).unwrap().value;
            let wants = [whole, whole / mass, whole + image];
            for (treatment, want) in Treatment::ALL.into_iter().zip(wants) {
                let got = ask(treatment);
                assert!(
                    (got.value - want).abs() < 1e-8,
                    "{kernel:?} {distance} {treatment:?} {got:?} {want}"
                );
            }
            for treatment in Treatment::ALL {
                let length = |y: [f64; 3]| (y[0] * y[0] + y[1] * y[1] + y[2] * y[2]).sqrt();
                let any = treated_mean(treatment, kernel, body, at, r, |y| f(length(y))).unwrap();
                assert!(agree(any, ask(treatment)), "{treatment:?} {any:?} {:?}", ask(treatment));
            }
        }
    }
}

/// What treatments promise: straight lines along the normal for the local fit, uniform fields for images behind flat
/// faces, and in a sphere an error of the first order in r/a.
#[test]
fn promises() {
    let cuboid = Body::Cuboid { edges: [1.0, 0.7, 0.9] };
    let sphere = Body::Sphere { radius: 2.0 };
    for kernel in KERNELS {
        for (at, r) in [([0.3, 0.25, 0.1], 0.45), ([0.1, 0.2, 0.05], 0.7), ([1.0, 0.7, 0.9], 0.6)] {
            let got = treated_mean(Treatment::Reflection, kernel, cuboid, at, r, |_| 1.0).unwrap();
            assert!((got.value - 1.0).abs() <= got.error && got.error < 1e-6, "{kernel:?} {at:?} {got:?}");
        }
        let line = |y: [f64; 3]| 1.0 + 3.0 * (y[2] - 0.1);
        let got = treated_mean(Treatment::LocalLinear, kernel, cuboid, [0.3, 0.25, 0.1], 0.45, line).unwrap();
        assert!(got.covers(1.0) && got.error < 1e-6, "{got:?}");
        let at = [0.0, -1.9, 0.0];
        let got = treated_mean(Treatment::LocalLinear, kernel, sphere, at, 0.5, |y| 1.0 - 2.0 * (y[1] + 1.9))
            .unwrap();
        assert!(got.covers(1.0), "{got:?}");
        let loss = |r: f64| {
            1.0 - treated_mean_uniform(Treatment::Reflection, kernel, sphere, [2.0, 0.0, 0.0], r)
                .unwrap()
                .value
        };
        // Between the surface and its tangent plane lies s^2/(2a) at distance s, and both halves miss it:
        // int K(s) s^2/a 2 pi s ds = r/a int 2 pi K u^3 du, m_1 r/(2a); the next order is (r/a)^3 on the axis.
        let first = 0.5 * kernel.moment(turbid_analytic::Dimension::Three, 1).unwrap().value;
        assert!((loss(0.02) - first * 0.01).abs() < 1e-6, "{kernel:?} {} {}", loss(0.02), first * 0.01);
        assert_eq!(treated_mean_uniform(Treatment::Clipped, kernel, sphere, at, 0.5).unwrap().value, 1.0);
        let got = treated_mean_symmetric(Treatment::Clipped, kernel, sphere, at, 0.5, |_| 1.0).unwrap();
        assert!(got.covers(1.0));
    }
}

/// In a slab much thinner than the ball photons are uniform in u = z/thickness: on its face the fit weights them with
/// 4 - 6 u.
#[test]
fn a_body_much_thinner_than_the_ball() {
    let body = Body::Slab { thickness: 1e-9 };
    let square = |z: f64| (z / 1e-9) * (z / 1e-9);
    let ask =
        |treatment| treated_mean_symmetric(treatment, Kernel::Biweight, body, [0.0; 3], 1.0, square).unwrap();
    // int u^2 (4 - 6 u) du = -1/6, int u^2 du = 1/3.
    let fitted = ask(Treatment::LocalLinear);
    assert!((fitted.value + 1.0 / 6.0).abs() < 1e-8, "{fitted:?}");
    assert!((ask(Treatment::Clipped).value - 1.0 / 3.0).abs() < 1e-8);
}

#[test]
fn whole_balls_need_no_treatment() {
    let f = |y: [f64; 3]| libm::exp(y[0] - 0.5 * y[1] * y[2]);
    for (body, at) in [
        (Body::HalfSpace, [1.0, -2.0, 0.3]),
        (Body::Slab { thickness: 0.7 }, [0.0, 0.0, 0.4]),
        (Body::Sphere { radius: 1.0 }, [0.0, 0.7, 0.0]),
        (Body::Cuboid { edges: [1.0, 0.8, 0.6] }, [0.3, 0.4, 0.3]),
    ] {
        for kernel in KERNELS {
            let all = Treatment::ALL.map(|t| treated_mean(t, kernel, body, at, 0.3, f).unwrap());
            for got in all {
                assert!(agree(got, all[0]) && got.error < 1e-8, "{body:?} {kernel:?} {all:?}");
            }
        }
    }
}
