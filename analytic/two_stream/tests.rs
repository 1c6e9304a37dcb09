use super::*;
use crate::IsotropicSlab;

fn slab(method: Method, tau: f64, albedo: f64, g: f64, incidence: Incidence) -> TwoStream {
    TwoStream::slab(method, tau, albedo, g, incidence).unwrap()
}

/// Conservative, diffuse light in: T = 1/(1 + g1 tau), g1 = (3/4)(1-g) (Eddington), (sqrt 3/2)(1-g) (quadrature).
#[test]
fn known_transmittances() {
    for (method, tau, known) in [
        (Method::Eddington, 1.0, 0.5714),
        (Method::Eddington, 10.0, 0.1176),
        (Method::Quadrature, 1.0, 0.5359),
        (Method::Quadrature, 10.0, 0.1035),
    ] {
        let t = slab(method, tau, 1.0, 0.0, Incidence::Diffuse).transmittance().value;
        assert!((t - known).abs() < 5e-5, "{method:?} {tau} {t}");
        let exact = IsotropicSlab::new(tau, 1.0, Incidence::Diffuse).unwrap().transmittance();
        let [_, compared, _] = compare(method, tau, 1.0, 0.0, Incidence::Diffuse).unwrap();
        assert!((compared.relative_error - (t / exact.value - 1.0)).abs() < 1e-9);
    }
    // Diffusion from the extrapolated boundaries has the exact asymptote (4/3)/(tau + 2q).
    let t = slab(Method::Diffusion, 100.0, 1.0, 0.0, Incidence::Diffuse).transmittance().value;
    assert!((t * 0.75 * (100.0 + 2.0 * hopf_constant().value) - 1.0).abs() < 1e-13);
}

/// Meador and Weaver's closed forms for a beam (their equations 14 and 15), which lose digits but not all.
#[test]
fn closed_forms() {
    for (method, tau, w, g, mu0) in [
        (Method::Eddington, 1.0, 0.9, 0.5, 0.6),
        (Method::Eddington, 8.0, 0.5, -0.3, 1.0),
        (Method::Quadrature, 0.2, 0.99, 0.8, 0.3),
        (Method::Quadrature, 3.0, 0.7, 0.0, 0.9),
    ] {
        let root = 3f64.sqrt();
        let (g1, g2, g3) = if method == Method::Eddington {
            (
                (7.0 - w * (4.0 + 3.0 * g)) / 4.0,
                -(1.0 - w * (4.0 - 3.0 * g)) / 4.0,
                (2.0 - 3.0 * g * mu0) / 4.0,
            )
        } else {
            (root * (2.0 - w * (1.0 + g)) / 2.0, root * w * (1.0 - g) / 2.0, (1.0 - root * g * mu0) / 2.0)
        };
        let g4 = 1.0 - g3;
        let (a1, a2) = (g1 * g4 + g2 * g3, g1 * g3 + g2 * g4);
        let k = (g1 * g1 - g2 * g2).sqrt();
        let (up, down, beam) = (exp(k * tau), exp(-k * tau), exp(-tau / mu0));
        let scale = w / ((1.0 - k * k * mu0 * mu0) * ((k + g1) * up + (k - g1) * down));
        let r = scale
            * ((1.0 - k * mu0) * (a2 + k * g3) * up
                - (1.0 + k * mu0) * (a2 - k * g3) * down
                - 2.0 * k * (g3 - a2 * mu0) * beam);
        let t = beam
            * (1.0
                - scale
                    * ((1.0 + k * mu0) * (a1 + k * g4) * up
                        - (1.0 - k * mu0) * (a1 - k * g4) * down
                        - 2.0 * k * (g4 + a1 * mu0) / beam));
        let ours = slab(method, tau, w, g, Incidence::Beam { mu0 });
        assert!((ours.reflectance().value - r).abs() < 1e-12, "{method:?} {tau} {r}");
        assert!((ours.transmittance().value - t).abs() < 1e-12, "{method:?} {tau} {t}");
    }
}

/// A = (1-w) int phi (not diffusion's, whose faces are not a balance of what enters), and limits.
#[test]
fn power_balance_and_limits() {
    let rule = crate::quadrature::GaussLegendre::new(40).unwrap();
    for method in [Method::Eddington, Method::Quadrature, Method::DeltaEddington] {
        for incidence in [Incidence::Beam { mu0: 0.5 }, Incidence::Diffuse] {
            for (tau, w, g) in [(0.5, 0.9, 0.7), (5.0, 0.99, -0.4), (2.0, 0.3, 0.0)] {
                let s = slab(method, tau, w, g, incidence);
                let lost = (1.0 - w) * rule.integrate(0.0, tau, |t| s.fluence(t).unwrap().value);
                assert!((s.absorptance().value - lost).abs() < 1e-12, "{method:?} {incidence:?} {tau}");
            }
            let white = slab(method, 3.0, 1.0, 0.5, incidence);
            assert!(white.absorptance().value.abs() < 1e-14);
            let deep = TwoStream::half_space(method, 0.9, 0.5, incidence).unwrap().reflectance().value;
            let thick = slab(method, 200.0, 0.9, 0.5, incidence).reflectance().value;
            assert!((deep - thick).abs() < 1e-14, "{method:?} {deep} {thick}");
            assert!(
                (TwoStream::half_space(method, 1.0, 0.5, incidence).unwrap().reflectance().value - 1.0).abs()
                    < 1e-14
            );
        }
        let clear = slab(method, 2.0, 0.0, 0.5, Incidence::Beam { mu0: 0.5 });
        assert!((clear.transmittance().value - exp(-4.0)).abs() < 1e-15);
    }
}

/// k mu0 = 1 is no exception.
#[test]
fn resonance() {
    // Eddington, w = 0: k = sqrt 3; with w = 0.2, g = 0, k^2 = 2.4.
    let mu0 = 1.0 / 2.4f64.sqrt();
    let at = |mu0: f64| slab(Method::Eddington, 1.0, 0.2, 0.0, Incidence::Beam { mu0 }).reflectance().value;
    let beside = 0.5 * (at(mu0 * 1.001) + at(mu0 * 0.999));
    assert!((at(mu0) / beside - 1.0).abs() < 1e-5, "{} {beside}", at(mu0));
}
