//! The orders against the isotropic slab, the whole slab, the closed first order and the balance of photons.

use super::*;
use crate::{AnisotropicSlab, IsotropicSlab};

fn light(mu0: f64) -> Incidence {
    if mu0 == 0.0 { Incidence::Diffuse } else { Incidence::Beam { mu0 } }
}

fn henyey_greenstein(tau: f64, albedo: f64, g: f64, mu0: f64) -> ScatteringOrders {
    ScatteringOrders::new(tau, albedo, &Phase::henyey_greenstein(g).unwrap(), light(mu0)).unwrap()
}

/// Two values agree within both bounds, and the first is known to `promise` of itself.
fn agree(a: Value, b: Value, promise: f64, what: &str) {
    let off = (a.value - b.value).abs();
    assert!(off <= a.error + b.error, "{what}: {a:?} {b:?} {off:e}");
    assert!(a.error <= promise * a.value.abs() + 1e-300, "{what}: {a:?}");
}

#[test]
fn isotropic_orders_agree_with_the_integral_equation() {
    for (tau, mu0) in [(1e-12, 1.0), (1e-3, 0.2), (1.0, 1e-4), (10.0, 1.0), (100.0, 0.5), (2.0, 0.0)] {
        let ours = ScatteringOrders::new(tau, 0.9, &Phase::isotropic(), light(mu0)).unwrap();
        let theirs = IsotropicSlab::new(tau, 0.9, light(mu0)).unwrap();
        for n in [0, 1, 2, 3, 10] {
            let what = format!("tau {tau} mu0 {mu0} n {n}");
            agree(ours.reflectance(n).unwrap(), theirs.reflectance_of_order(n).unwrap(), 1e-10, &what);
            agree(ours.transmittance(n).unwrap(), theirs.transmittance_of_order(n).unwrap(), 1e-10, &what);
            for share in [0.0, 1e-6, 0.1, 0.5, 0.9, 1.0] {
                let t = share * tau;
                let (a, b) = (ours.fluence(n, t).unwrap(), theirs.fluence_of_order(n, t).unwrap());
                // Where the light has fallen by e^(-100) the panels are coarse for it.
                let promise = if t > 10.0 { 1e-6 } else { 1e-9 };
                agree(a, b, promise, &format!("phi({share}) {what}"));
            }
        }
    }
}

#[test]
fn the_orders_add_up_to_the_slab() {
    for (tau, albedo, g, mu0) in
        [(1.0, 0.3, 0.75, 0.6), (0.3, 0.25, -0.5, 1.0), (5.0, 0.3, 0.5, 0.0), (1.0, 0.2, 0.9, 0.5)]
    {
        let orders = henyey_greenstein(tau, albedo, g, mu0);
        let slab = AnisotropicSlab::new(tau, albedo, g, light(mu0)).unwrap();
        let sum = |f: &dyn Fn(u32) -> Value| {
            let terms: Vec<Value> = (0..32).map(f).collect();
            // The terms fall by at most the albedo in the end, by 0.8 to be safe: rest = last/(1 - 0.8).
            let rest = 5.0 * terms[31].value;
            let error = rest + terms.iter().map(|v| v.error).sum::<f64>();
            Value::new(terms.iter().map(|v| v.value).sum(), error, METHOD)
        };
        let what = format!("tau {tau} albedo {albedo} g {g} mu0 {mu0}");
        agree(sum(&|n| orders.reflectance(n).unwrap()), slab.reflectance(), 1e-10, &what);
        agree(sum(&|n| orders.transmittance(n).unwrap()), slab.transmittance(), 1e-10, &what);
        agree(sum(&|n| orders.absorptance(n).unwrap()), slab.absorptance(), 1e-10, &what);
        for share in [0.0, 1e-3, 0.4, 1.0] {
            let t = share * tau;
            agree(sum(&|n| orders.fluence(n, t).unwrap()), slab.fluence(t).unwrap(), 1e-8, &what);
        }
    }
}

#[test]
fn what_is_not_absorbed_scatters_on() {
    let albedo = 0.8;
    for (tau, g, mu0, promise) in [
        (1.0, 0.75, 0.6, 1e-9),
        (1e-8, -0.95, 1.0, 1e-5),
        (1e4, 0.9, 0.5, 1e-9),
        (1.0, 0.99, 1.0, 1e-6),
        (30.0, 0.5, 0.0, 1e-9),
    ] {
        let orders = henyey_greenstein(tau, albedo, g, mu0);
        for n in 0..3 {
            // albedo C_n = R_(n+1) + T_(n+1) + C_(n+1), C_n the collisions after n scatterings.
            let [a, b] = [n, n + 1].map(|n| orders.absorptance(n).unwrap().scaled(1.0 / (1.0 - albedo)));
            let (r, t) = (orders.reflectance(n + 1).unwrap(), orders.transmittance(n + 1).unwrap());
            let off = (albedo * a.value - b.value - r.value - t.value).abs();
            let bound = a.error + b.error + r.error + t.error;
            assert!(off <= bound && bound < promise * a.value, "{tau} {g} {n}: {off:e} {bound:e}");
        }
        if orders.once.is_some() {
            // The first order on the grids, and closed in depth.
            // At g = 0.99 the coarser grid leaves 0.99^800 = 3e-4 of the phase function out.
            agree(orders.flux(1, |o| o.reflected), orders.reflectance(1).unwrap(), 3e-4, "R_1");
            agree(orders.reflectance(1).unwrap(), orders.flux(1, |o| o.reflected), 1e-9, "R_1");
            if tau < 1e3 {
                agree(orders.transmittance(1).unwrap(), orders.flux(1, |o| o.transmitted), 1e-9, "T_1");
            }
        }
    }
}

/// Rayleigh's azimuthal mean is 1 + P_2 P_2/2: R_1 of the half-space by a rule of our own; and limits.
#[test]
fn rayleigh_and_the_extremes() {
    let mu0 = 0.4;
    let orders = ScatteringOrders::new(1e300, 1.0, &Phase::rayleigh(), light(mu0)).unwrap();
    let p2 = |x: f64| 1.5 * x * x - 0.5;
    let rule = crate::quadrature::GaussLegendre::rule(40);
    let want = rule.integrate(0.0, 1.0, |mu| 0.5 * mu / (mu + mu0) * (1.0 + 0.5 * p2(mu) * p2(mu0)));
    agree(orders.reflectance(1).unwrap(), Value::new(want, 1e-14, ""), 1e-12, "R_1");
    let deep = orders.fluence(4, 1e300).unwrap();
    assert!(deep.value == 0.0 && deep.error < 1e-100, "{deep:?}");
    let dark = ScatteringOrders::new(1.0, 0.0, &Phase::isotropic(), light(0.5)).unwrap();
    assert!(dark.reflectance(3).unwrap().covers(0.0) && dark.fluence(1, 0.5).unwrap().covers(0.0));
    for (tau, albedo, mu0, name) in [
        (1e-13, 0.5, 1.0, "tau"),
        (1.0, 1.5, 1.0, "albedo"),
        (1.0, 0.5, 1e-6, "mu0"),
        (f64::NAN, 0.5, 1.0, "tau"),
    ] {
        let error = ScatteringOrders::new(tau, albedo, &Phase::isotropic(), light(mu0)).err().unwrap();
        assert!(error.to_string().starts_with(&format!("{name} is ")), "{error}");
    }
    let peaked = ScatteringOrders::new(1.0, 0.5, &Phase::henyey_greenstein(0.995).unwrap(), light(1.0));
    assert!(peaked.err().unwrap().to_string().starts_with("phase moment 1200 is "));
    assert!(
        dark.fluence(101, 0.5).is_err() && dark.fluence(1, 2.0).is_err() && dark.reflectance(101).is_err()
    );
}
