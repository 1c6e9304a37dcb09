//! Laws of the isotropic slab: balance, reciprocity, limits, orders, and an answer or a refusal for every input.

use crate::support::any_input::cases;
use crate::support::beam;
use libm::{exp, log, pow};
use proptest::prelude::*;
use std::f64::consts::PI;
use turbid_analytic::quadrature::GaussLegendre;
use turbid_analytic::slab_single::single_radiance;
use turbid_analytic::{Incidence, IsotropicSlab, Value};

fn balance(slab: &IsotropicSlab) -> (f64, f64) {
    let (r, t, a) = (slab.reflectance(), slab.transmittance(), slab.absorptance());
    (r.value + t.value + a.value - 1.0, r.error + t.error + a.error)
}

#[test]
fn energy_balances_to_1e_12() {
    for tau in [1e-12, 1e-6, 0.1, 1.0, 4.0, 10.0] {
        let first = IsotropicSlab::new(tau, 0.5, beam(1.0)).unwrap();
        for albedo in [0.0, 0.3, 0.9, 0.999_999, 1.0] {
            for incidence in [beam(1.0), beam(0.3), beam(0.01), Incidence::Diffuse] {
                let slab = first.with(albedo, incidence).unwrap();
                let (off, bound) = balance(&slab);
                assert!(
                    off.abs() < 1e-12 && off.abs() <= bound,
                    "{tau} {albedo} {incidence:?}: {off:e} {bound:e}"
                );
                assert!(bound < 2e-12, "{tau} {albedo} {incidence:?}: {bound:e}");
            }
        }
    }
}

/// R(mu0) mu0-weighted over the hemisphere is the reflectance of diffuse light: 2 int mu R(mu) dmu = R_diffuse.
#[test]
fn beams_add_up_to_diffuse_light() {
    let (tau, albedo) = (1.5, 0.8);
    let diffuse = IsotropicSlab::new(tau, albedo, Incidence::Diffuse).unwrap();
    // R(mu) behaves like mu ln mu at grazing incidence: mu = x^3 makes that smooth enough for 24 nodes.
    let rule = GaussLegendre::new(24).unwrap();
    let mean = |f: &dyn Fn(&IsotropicSlab) -> f64| {
        rule.integrate(0.0, 1.0, |x| {
            let mu = x * x * x;
            2.0 * mu * 3.0 * x * x * f(&diffuse.with(albedo, beam(mu)).unwrap())
        })
    };
    let r = mean(&|s| s.reflectance().value);
    assert!((r - diffuse.reflectance().value).abs() < 1e-11, "{r}");
    let t = mean(&|s| s.transmittance().value);
    assert!((t - diffuse.transmittance().value).abs() < 1e-10, "{t}");
}

/// I_up(0, mu; mu0) mu is symmetric in mu and mu0 with unit flux on the beam's own face, mu0 I; the same downwards.
#[test]
fn radiance_is_reciprocal_and_follows_from_x_and_y() {
    for (tau, albedo) in [(0.3, 1.0), (2.0, 0.7), (8.0, 0.99)] {
        let (a, b) = (0.35, 0.9);
        let first = IsotropicSlab::new(tau, albedo, beam(a)).unwrap();
        let second = first.with(albedo, beam(b)).unwrap();
        let close = |p: Value, q: Value| (p.value - q.value).abs() <= p.error + q.error;
        assert!(close(first.radiance(0.0, b).unwrap(), second.radiance(0.0, a).unwrap()));
        assert!(close(first.radiance(tau, -b).unwrap(), second.radiance(tau, -a).unwrap()));
        // X(mu) = mu phi(0; mu), Y(mu) = mu phi(tau; mu):
        // I_up = (albedo/4 pi)(X X0 - Y Y0)/(mu + mu0), I_down = (albedo/4 pi)(Y X0 - X Y0)/(mu - mu0).
        let xy = |s: &IsotropicSlab, mu: f64| {
            (mu * s.fluence(0.0).unwrap().value, mu * s.fluence(tau).unwrap().value)
        };
        let ((xa, ya), (xb, yb)) = (xy(&first, a), xy(&second, b));
        let up = albedo / (4.0 * PI) * (xa * xb - ya * yb) / (a + b);
        let down = albedo / (4.0 * PI) * (yb * xa - xb * ya) / (b - a);
        let got = first.radiance(0.0, b).unwrap();
        // The products lose a few roundings of quantities near 4, over a sum or difference of cosines near 0.5.
        assert!((got.value - up).abs() < got.error + 1e-12, "{tau}: {got:?} {up}");
        let got = first.radiance(tau, -b).unwrap();
        assert!((got.value - down).abs() < got.error + 1e-12, "{tau}: {got:?} {down}");
    }
}

/// 2 pi int mu I dmu over each hemisphere is the flux, 2 pi int I dmu over both the scattered fluence.
#[test]
fn radiance_integrates_to_flux_and_fluence() {
    let (tau, albedo) = (2.0, 0.9);
    let rule = GaussLegendre::new(40).unwrap();
    for incidence in [beam(0.6), Incidence::Diffuse] {
        let slab = IsotropicSlab::new(tau, albedo, incidence).unwrap();
        // mu = x^3 resolves the layer of grazing directions.
        let hemisphere = |t: f64, sign: f64, power: f64| {
            rule.integrate(0.0, 1.0, |x| {
                let mu = x * x * x;
                let weight = if power == 1.0 { mu } else { 1.0 };
                2.0 * PI * weight * 3.0 * x * x * slab.radiance(t, sign * mu).unwrap().value
            })
        };
        assert!((hemisphere(0.0, 1.0, 1.0) - slab.reflectance().value).abs() < 1e-10);
        assert!((hemisphere(tau, -1.0, 1.0) - slab.transmittance_diffuse().value).abs() < 1e-10);
        let t = 0.7;
        let scattered = slab.fluence(t).unwrap().value - slab.fluence_of_order(0, t).unwrap().value;
        let sum = hemisphere(t, 1.0, 0.0) + hemisphere(t, -1.0, 0.0);
        assert!((sum - scattered).abs() < 1e-9 * scattered, "{sum} {scattered}");
    }
}

#[test]
fn orders_add_up_and_the_first_is_the_closed_form() {
    for incidence in [beam(0.7), Incidence::Diffuse] {
        let slab = IsotropicSlab::new(1.0, 0.9, incidence).unwrap();
        let t = 0.4;
        // The spectral radius at tau = 1 is below 0.9 (1 - E_2(1/2)) = 0.61: 80 orders leave 1e-17.
        let add = |f: &dyn Fn(u32) -> Value| {
            (0..80).map(f).fold((0.0, 0.0), |(v, e), x| (v + x.value, e + x.error))
        };
        let (phi, e) = add(&|n| slab.fluence_of_order(n, t).unwrap());
        let whole = slab.fluence(t).unwrap();
        assert!((phi - whole.value).abs() <= e + whole.error, "{phi} {whole:?}");
        let (r, e) = add(&|n| slab.reflectance_of_order(n).unwrap());
        assert!((r - slab.reflectance().value).abs() <= e + slab.reflectance().error);
        let (r, e) = add(&|n| slab.transmittance_of_order(n).unwrap());
        assert!((r - slab.transmittance().value).abs() <= e + slab.transmittance().error);
    }
    // Order 1 of diffuse light is the mean of the beams' closed form: phi_1 = 2 int mu phi_1(mu) dmu.
    let slab = IsotropicSlab::new(1.0, 0.9, Incidence::Diffuse).unwrap();
    let rule = GaussLegendre::new(60).unwrap();
    let mean = rule.integrate(0.0, 1.0, |x| {
        let mu = x * x * x;
        6.0 * x * x * mu * turbid_analytic::slab_single::single_fluence(1.0, 0.9, mu, 0.4).unwrap().value
    });
    assert!((slab.fluence_of_order(1, 0.4).unwrap().value - mean).abs() < 1e-10);
}

#[test]
fn thin_faint_and_thick_limits() {
    // albedo -> 0: single scattering, to albedo^2.
    let slab = IsotropicSlab::new(2.0, 1e-9, beam(0.5)).unwrap();
    let single = single_radiance(2.0, 1e-9, 0.0, 0.5, 0.6, -0.3, 0.0).unwrap();
    let got = slab.radiance(0.6, -0.3).unwrap();
    assert!((got.value / single.value - 1.0).abs() < 1e-8);
    // tau -> 0: R = albedo tau/(2 mu0), with corrections tau ln tau.
    let slab = IsotropicSlab::new(1e-12, 0.6, beam(0.5)).unwrap();
    assert!((slab.reflectance().value / 0.6e-12 - 1.0).abs() < 1e-10);
    assert!((slab.absorptance().value / 0.8e-12 - 1.0).abs() < 1e-10);
    // albedo 1, thick: T_diffuse light = (4/3)/(tau + 2 q), q = 0.71044608959876 (Milne), to e^(-tau).
    for tau in [30.0, 100.0, 200.0, 400.0] {
        let slab = IsotropicSlab::new(tau, 1.0, Incidence::Diffuse).unwrap();
        let milne = 4.0 / 3.0 / (tau + 2.0 * 0.710_446_089_598_763_1);
        let t = slab.transmittance();
        assert!((t.value - milne).abs() <= t.error + 1e-13 * milne, "{tau}: {t:?} {milne}");
        assert!(t.error < 1e-11, "{t:?}");
        let (off, bound) = balance(&slab);
        assert!(off.abs() <= bound, "{tau}: {off:e} {bound:e}");
        // Lit on one face, phi(t) + phi(tau - t) = 4.
        let (a, b) = (slab.fluence(0.3 * tau).unwrap(), slab.fluence(tau - 0.3 * tau).unwrap());
        let sum = a.value + b.value;
        assert!((sum - 4.0).abs() < a.error + b.error, "{tau}: {sum} {a:?}");
        assert!(a.error < 1e-13 * tau * tau);
    }
    // Absorbing and thick: T falls like e^(-k tau), k = 0.525429512658 for albedo 0.9 (albedo atanh(k)/k = 1); the
    // rest falls like e^(-tau), 7e-7 of it at tau = 30.
    let t = |tau: f64| IsotropicSlab::new(tau, 0.9, beam(1.0)).unwrap().transmittance_diffuse();
    let k = log(t(30.0).value / t(31.0).value);
    assert!((k - 0.525_429_512_658).abs() < 1e-5, "{k}");
}

#[test]
fn interpolation_agrees_with_the_integral_within_both_bounds() {
    for incidence in [beam(1.0), beam(0.05), beam(1e-9), Incidence::Diffuse] {
        let tau = 3.0;
        let slab = IsotropicSlab::new(tau, 0.95, incidence).unwrap();
        for i in 0..=60 {
            let t = if i <= 30 { tau * pow(0.5, 31.0 - f64::from(i)) } else { tau * f64::from(i) / 60.0 };
            let (exact, fast) = (slab.fluence(t).unwrap(), slab.fluence_interpolated(t).unwrap());
            assert!((exact.value - fast.value).abs() <= exact.error + fast.error, "{t}: {exact:?} {fast:?}");
            // In the last 1e-7 before a face the polynomial stands for t ln t on one panel.
            if t.min(tau - t) > 1e-6 {
                assert!(fast.error < 1e-11 * fast.value.max(1.0), "{t}: {fast:?}");
            }
        }
    }
}

#[test]
fn grazing_light_is_answered() {
    // mu0 -> 0: X -> 1, so mu0 phi(0) = 1, to mu0 ln mu0.
    for mu0 in [1e-3, 1e-12, 1e-100, 1e-300] {
        let slab = IsotropicSlab::new(1.0, 1.0, beam(mu0)).unwrap();
        let (off, bound) = balance(&slab);
        assert!(off.abs() <= bound && bound < 1e-9, "{mu0}: {off:e} {bound:e}");
        let x = slab.fluence(0.0).unwrap().value * mu0;
        assert!((x - 1.0).abs() < mu0 * (1.0 + log(1.0 / mu0)) + 1e-15, "{mu0:e}: {x}");
    }
}

proptest! {
    #![proptest_config(cases(60, 20_260_101))]

    #[test]
    fn bounds_hold_over_the_domain(
        lt in -12.0..1.7_f64, albedo in prop_oneof![0.0..=1.0_f64, Just(1.0), Just(0.0)],
        lm in -6.0..=0.0_f64, diffuse in any::<bool>(), place in 0.0..=1.0_f64, mu in -1.0..=1.0_f64,
    ) {
        let tau = pow(10.0, lt);
        let incidence = if diffuse { Incidence::Diffuse } else { beam(pow(10.0, lm).min(1.0)) };
        let slab = IsotropicSlab::new(tau, albedo, incidence).unwrap();
        let (off, bound) = balance(&slab);
        prop_assert!(off.abs() <= bound, "{off:e} {bound:e}");
        prop_assert!(bound < 1e-10);
        let t = place * tau;
        let (exact, fast) = (slab.fluence(t).unwrap(), slab.fluence_interpolated(t).unwrap());
        prop_assert!((exact.value - fast.value).abs() <= exact.error + fast.error);
        let radiance = slab.radiance(t, mu).unwrap();
        prop_assert!(radiance.value.is_finite() && radiance.value >= -radiance.error);
        prop_assert!(radiance.error < 1e-9 * (1.0 + radiance.value));
        for v in [slab.reflectance(), slab.transmittance(), slab.absorptance()] {
            prop_assert!(v.value >= -v.error && v.value <= 1.0 + v.error);
        }
    }

    #[test]
    fn any_bits_are_answered_or_refused(
        tau in any::<f64>(), albedo in any::<f64>(), mu0 in any::<f64>(), t in any::<f64>(), mu in any::<f64>(),
    ) {
        // Arbitrary bits are almost never in range: fold some of them into it.
        let fold = |x: f64, unit: f64| if x.abs() > 1e3 { x } else { x.abs() % unit };
        if let Ok(slab) = IsotropicSlab::new(fold(tau, 50.0), fold(albedo, 1.0), beam(fold(mu0, 1.0))) {
            for v in [slab.reflectance(), slab.transmittance(), slab.absorptance()] {
                prop_assert!(v.value.is_finite() && v.error.is_finite());
            }
            for answer in [slab.fluence(t), slab.fluence_interpolated(t), slab.radiance(fold(t, 1.0), mu)] {
                prop_assert!(answer.is_err() || answer.unwrap().error.is_finite());
            }
        }
        prop_assert!(IsotropicSlab::new(f64::NAN, 0.5, beam(0.5)).is_err());
    }
}

#[test]
fn refusals_name_the_parameter() {
    let says = |result: turbid_analytic::Result<IsotropicSlab>, name: &str| {
        assert!(result.err().unwrap().to_string().starts_with(name), "{name}");
    };
    says(IsotropicSlab::new(0.0, 0.5, beam(1.0)), "tau is 0; allowed");
    says(IsotropicSlab::new(1e9, 0.5, beam(1.0)), "tau");
    says(IsotropicSlab::new(1.0, 1.5, beam(1.0)), "albedo is 1.5; allowed: 0 to 1");
    says(IsotropicSlab::new(1.0, 0.5, beam(-0.1)), "mu0");
    let slab = IsotropicSlab::new(1.0, 0.5, beam(1.0)).unwrap();
    assert!(slab.fluence(1.0 + 1e-15).is_err() && slab.radiance(0.5, f64::NAN).is_err());
    assert!(slab.fluence_of_order(1001, 0.5).is_err());
    assert!(
        (slab.radiance(0.5, 0.0).unwrap().value - 0.125 / PI * slab.fluence(0.5).unwrap().value).abs()
            < 1e-15
    );
    let near_zero = slab.radiance(0.5, 1e-9).unwrap().value;
    assert!((near_zero / slab.radiance(0.5, 0.0).unwrap().value - 1.0).abs() < 1e-7);
    assert_eq!(slab.radiance(0.0, -0.5).unwrap().value, 0.0);
    assert!((slab.fluence_of_order(0, 0.5).unwrap().value - exp(-0.5)).abs() < 1e-15);
}
