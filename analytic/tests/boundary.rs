//! Photon estimates at boundaries against closed forms, other quadratures and simulated points.
#![allow(clippy::unwrap_used, reason = "tests")]

use turbid_analytic::boundary::{Body, body_moment};
use turbid_analytic::slab_kernel::{face_moment, slab_moment};
use turbid_analytic::volumes::lens_volume;
use turbid_analytic::{Kernel, Value};

const BALL: f64 = 4.0 / 3.0 * std::f64::consts::PI;

const KERNELS: [Kernel; 5] = [
    Kernel::Uniform,
    Kernel::Epanechnikov,
    Kernel::Biweight,
    Kernel::Cone { kappa: 1.0 },
    Kernel::TruncatedGaussian,
];

/// Two values agree within their bounds.
fn agree(a: Value, b: Value) -> bool {
    (a.value - b.value).abs() <= a.error + b.error
}

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
                let want = lens_volume(a, r, distance).unwrap().scaled_to(BALL * r * r * r);
                assert!(agree(got, want) && got.error < 1e-8, "{a} {distance} {r}: {got:?} {want:?}");
            }
        }
    }
}

trait Scaled {
    fn scaled_to(self, unit: f64) -> Value;
}

impl Scaled for Value {
    fn scaled_to(self, unit: f64) -> Value {
        Value { value: self.value / unit, error: self.error / unit, method: self.method }
    }
}
