//! Both methods at every thickness, which the public face does not offer.

use super::*;

fn close(name: &str, a: Value, b: Value, relative: f64) {
    let off = (a.value - b.value).abs();
    assert!(off <= a.error + b.error, "{name}: {a:?} {b:?} off {off:e}");
    assert!(off <= relative * b.value.abs() + f64::MIN_POSITIVE, "{name}: {a:?} {b:?} off {off:e}");
}

#[test]
fn discrete_ordinates_agree_with_doubling() {
    let normal = Incidence::Beam { mu0: 1.0 };
    let grazing = Incidence::Beam { mu0: 0.02 };
    for (tau, albedo, g, index, light) in [
        (1.0, 0.9, 0.0, 1.5, normal),
        (1.0, 1.0, 0.5, 1.0001, Incidence::Diffuse),
        (0.01, 0.9, 0.5, 1.33, grazing),
        (1e-3, 1.0, 0.0, 1.5, Incidence::Diffuse),
        (0.1, 1e-6, 0.75, 2.4, normal),
        (1.0, 0.999999, 0.75, 2.4, Incidence::Diffuse),
        (1.0, 0.5, -0.5, 0.7, Incidence::Diffuse),
        (10.0, 0.9, 0.5, 1.0001, grazing),
        (10.0, 1.0, -0.8, 1.33, normal),
        (100.0, 0.9, 0.75, 2.4, normal),
        (100.0, 1.0, 0.5, 1.5, Incidence::Diffuse),
        (2.0, 0.99, 0.3, 0.999, normal),
        (2.0, 0.9, 0.75, 1.0, grazing),
    ] {
        let phase = Phase::henyey_greenstein(g).unwrap();
        let a = FresnelSlab::solve(tau, albedo, &phase, index, light, false).unwrap();
        let b = FresnelSlab::solve(tau, albedo, &phase, index, light, true).unwrap();
        let name = |what: &str| format!("{what} at tau {tau}, w {albedo}, g {g}, n {index}, {light:?}");
        // Of thin slabs the modes keep some 1e-14/tau.
        let relative = if tau < 0.01 { 1e-10 } else { 1e-11 };
        close(&name("R"), a.reflectance_diffuse(), b.reflectance_diffuse(), relative);
        close(&name("T"), a.transmittance_diffuse(), b.transmittance_diffuse(), relative);
        close(&name("A"), a.absorptance(), b.absorptance(), relative);
        for share in [0.0, 1e-4, 0.3, 0.99, 1.0] {
            let t = tau * share;
            close(&name("phi"), a.fluence(t).unwrap(), b.fluence(t).unwrap(), relative);
        }
        let parts = [a.reflectance(), a.transmittance(), a.absorptance()];
        let sum: f64 = parts.iter().map(|part| part.value).sum();
        let error: f64 = parts.iter().map(|part| part.error).sum();
        assert!((sum - 1.0).abs() < error, "{} {:e}", name("R + T + A"), sum - 1.0);
    }
}
