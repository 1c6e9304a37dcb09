//! Gathers of the k nearest photons at boundaries, false photons, and what is refused.

use crate::support::any_input::cases;
use crate::support::kernels::{BALL, KERNELS, agree};
use proptest::prelude::*;
use turbid_analytic::Kernel;
use turbid_analytic::boundary::{
    Body, Rejection, Treatment, body_moment, false_photon_mean, nearest_false_photon_mean,
    nearest_treated_mean, nearest_treated_mean_symmetric, nearest_treated_mean_uniform, treated_mean,
    treated_mean_symmetric, treated_mean_uniform, treated_variance,
};
use turbid_analytic::nearest::nearest_expectation;
use turbid_analytic::slab_kernel::{face_moment, slab_kernel_mean};
use turbid_analytic::volumes::ball_slab_volume;

#[test]
fn nearest_against_the_mixture_over_counts() {
    let (thickness, h, cap, density) = (0.9, 0.06, 0.5, 400.0);
    let f = |t: f64| libm::exp(-1.3 * t);
    let body = Body::Slab { thickness };
    let at = [0.0, 0.0, h];
    let lambda = |r: f64| {
        if r == 0.0 {
            return 0.0;
        }
        density * BALL * r * r * r * slab_kernel_mean(Kernel::Uniform, r, h, thickness, f).unwrap().value
    };
    for k in [2, 20, 60, 150] {
        for treatment in Treatment::ALL {
            let kernel = Kernel::Epanechnikov;
            let mean = |r: f64| {
                if r < 1e-9 {
                    return f(h);
                }
                treated_mean_symmetric(treatment, kernel, body, at, r, f).unwrap().value
            };
            let got =
                nearest_treated_mean_symmetric(treatment, kernel, k, cap, body, at, density, f).unwrap();
            assert!(got.error < 1e-8, "{got:?}");
            if k == 20 {
                let want = nearest_expectation(k, cap, lambda, mean).unwrap();
                assert!((got.value - want.value).abs() < 1e-8, "{treatment:?} {got:?} {want:?}");
                let any =
                    nearest_treated_mean(treatment, kernel, k, cap, body, at, density, |y| f(y[2])).unwrap();
                assert!(agree(any, got), "{any:?} {got:?}");
            }
        }
    }
    // So few photons that the cap is always used.
    let got = nearest_treated_mean_symmetric(Treatment::Clipped, Kernel::Uniform, 100, cap, body, at, 1.0, f)
        .unwrap();
    let want = treated_mean_symmetric(Treatment::Clipped, Kernel::Uniform, body, at, cap, f).unwrap();
    assert!(agree(got, want));
}

#[test]
fn nearest_in_a_uniform_field() {
    let sphere = Body::Sphere { radius: 1.0 };
    let cuboid = Body::Cuboid { edges: [1.0, 0.8, 0.6] };
    for (k, cap, density) in [(5, 0.3, 300.0), (50, 0.5, 1e4), (1000, 0.4, 3e4)] {
        for kernel in [Kernel::Uniform, Kernel::TruncatedGaussian] {
            for (body, at) in [(sphere, [0.0, 0.0, 0.98]), (Body::HalfSpace, [0.0; 3])] {
                let one = |treatment| {
                    nearest_treated_mean_symmetric(treatment, kernel, k, cap, body, at, density, |_| 1.0)
                        .unwrap()
                };
                for treatment in [Treatment::Clipped, Treatment::LocalLinear] {
                    assert!(
                        one(treatment).covers(1.0) && one(treatment).error < 1e-9,
                        "{:?}",
                        one(treatment)
                    );
                }
                if body == Body::HalfSpace {
                    assert!(one(Treatment::None).covers(0.5) && one(Treatment::Reflection).covers(1.0));
                }
            }
            let at = [0.05, 0.7, 0.02];
            let got =
                nearest_treated_mean_uniform(Treatment::None, kernel, k, cap, cuboid, at, density).unwrap();
            let any =
                nearest_treated_mean(Treatment::None, kernel, k, cap, cuboid, at, density, |_| 1.0).unwrap();
            assert!(agree(got, any) && got.error < 1e-8, "{got:?} {any:?}");
            assert_eq!(
                nearest_treated_mean_uniform(Treatment::Reflection, kernel, k, cap, cuboid, at, density)
                    .unwrap()
                    .value,
                1.0
            );
        }
    }
}

#[test]
fn false_photons_of_a_flat_sheet() {
    let (inside, outside, r) = (0.4, 3.0, 0.25);
    for kernel in KERNELS {
        for h in [0.0, 0.1, 0.2] {
            let m = face_moment(kernel, 0, h / r).unwrap().value;
            let wants = [
                inside * m + outside * (1.0 - m),
                0.5 * (inside * m + outside * (1.0 - m)),
                inside * m + 0.5 * outside * (1.0 - m),
                inside * m,
                inside * m,
            ];
            for (rejection, want) in Rejection::ALL.into_iter().zip(wants) {
                for (clipped, want) in [(false, want), (true, want / m)] {
                    let got = false_photon_mean(rejection, clipped, kernel, r, h, inside, outside).unwrap();
                    assert!((got.value - want).abs() <= got.error + 1e-15, "{rejection:?} {got:?} {want}");
                }
            }
        }
        for rejection in Rejection::ALL {
            let far = false_photon_mean(rejection, true, kernel, r, r, inside, outside).unwrap();
            assert!(far.covers(inside), "{far:?}");
        }
    }
}

#[test]
fn nearest_false_photons() {
    let (inside, outside, h, cap, density) = (0.4, 3.0, 0.1, 0.5, 2000.0);
    let ask = |rejection, clipped, k| {
        nearest_false_photon_mean(
            rejection,
            clipped,
            Kernel::Epanechnikov,
            k,
            cap,
            h,
            density,
            inside,
            outside,
        )
        .unwrap()
    };
    for k in [2, 50, 400] {
        assert!(ask(Rejection::Visible, true, k).covers(inside));
        assert!(ask(Rejection::BehindPlane, true, k).covers(inside));
    }
    for (rejection, near, far) in
        [(Rejection::Off, 1.0, 1.0), (Rejection::Facing, 0.5, 0.5), (Rejection::FacingBehind, 1.0, 0.5)]
    {
        let (f, g) = (near * inside, far * outside);
        let lambda = |r: f64| {
            let cut = ball_slab_volume(r, h, 1e6).unwrap().value;
            density * (f * cut + g * (BALL * r * r * r - cut))
        };
        let mean = |r: f64| {
            let m = face_moment(Kernel::Epanechnikov, 0, h / r.max(1e-9)).unwrap().value;
            f * m + g * (1.0 - m)
        };
        for k in [20, 120] {
            let want = nearest_expectation(k, cap, lambda, mean).unwrap();
            let got = ask(rejection, false, k);
            assert!((got.value - want.value).abs() < 1e-9, "{rejection:?} {k} {got:?} {want:?}");
        }
    }
}

#[test]
fn refusals() {
    let (none, one) = (Treatment::None, |_: [f64; 3]| 1.0);
    let cuboid = Body::Cuboid { edges: [1.0; 3] };
    assert!(treated_mean(none, Kernel::Gaussian, Body::HalfSpace, [0.0; 3], 1.0, one).is_err());
    assert!(treated_mean(none, Kernel::Uniform, Body::HalfSpace, [0.0, 0.0, -0.1], 1.0, one).is_err());
    assert!(treated_mean(none, Kernel::Uniform, Body::Sphere { radius: 1.0 }, [1.0; 3], 1.0, one).is_err());
    assert!(treated_mean(none, Kernel::Uniform, cuboid, [0.5, 0.5, 1.1], 1.0, one).is_err());
    assert!(treated_mean_symmetric(none, Kernel::Uniform, cuboid, [0.5; 3], 1.0, |_| 1.0).is_err());
    let error = treated_mean(none, Kernel::Uniform, cuboid, [0.5; 3], 1.0, |_| f64::NAN).err().unwrap();
    assert!(error.to_string().starts_with("field returned NaN at"), "{error}");
    let error =
        nearest_treated_mean(none, Kernel::Uniform, 5, 1.0, cuboid, [0.5; 3], 9.0, |_| -1.0).err().unwrap();
    assert!(error.to_string().starts_with("field is -1"), "{error}");
    assert!(treated_variance(Treatment::Reflection, Kernel::Uniform, cuboid, [0.5; 3], 1.1).is_err());
    assert!(body_moment(Kernel::Uniform, cuboid, [0.5; 3], 0.1, 3).is_err());
    assert!(false_photon_mean(Rejection::Off, false, Kernel::Uniform, 1.0, -0.1, 1.0, 1.0).is_err());
}

proptest! {
    #![proptest_config(cases(100, 20_260_103))]

    /// Lengths over twenty decades and places anywhere: a finite answer with a bound, or a refusal.
    #[test]
    fn any_lengths(
        which in 0_usize..4, treatment in 0_usize..4, kernel in 0_usize..5, k in 2_u32..500,
        logs in proptest::array::uniform4(-10.0..10.0_f64), place in proptest::array::uniform3(0.0..1.0_f64),
        density in -20.0..20.0_f64,
    ) {
        let length = logs.map(|x| libm::pow(10.0, x));
        let body = [
            Body::HalfSpace,
            Body::Slab { thickness: length[1] },
            Body::Sphere { radius: length[1] },
            Body::Cuboid { edges: [length[1], length[2], length[3]] },
        ][which];
        let at = match body {
            Body::Sphere { radius } => place.map(|x| 0.57 * x * radius),
            _ => [place[0] * length[1], place[1] * length[2], place[2] * if which == 3 { length[3] } else { length[1] }],
        };
        let (treatment, kernel) = (Treatment::ALL[treatment], KERNELS[kernel]);
        let answers = [
            treated_mean_uniform(treatment, kernel, body, at, length[0]),
            treated_variance(treatment, kernel, body, at, length[0]),
            nearest_treated_mean_uniform(treatment, kernel, k, length[0], body, at, libm::pow(10.0, density)),
        ];
        for v in answers.into_iter().flatten() {
            prop_assert!(v.value.is_finite() && v.error.is_finite() && v.error >= 0.0, "{v:?}");
            prop_assert!(v.value >= -v.error, "{v:?}");
        }
    }
}
