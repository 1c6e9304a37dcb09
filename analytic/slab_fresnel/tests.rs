//! Both methods at every thickness, which the public face does not offer.

use super::*;
use proptest::prelude::*;

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
        (0.01, 0.9, 0.5, 1.33, grazing),
        (1e-3, 1.0, 0.0, 1.5, Incidence::Diffuse),
        (0.1, 1e-6, 0.75, 2.4, normal),
        (1.0, 0.5, -0.5, 0.7, Incidence::Diffuse),
        (100.0, 0.9, 0.75, 2.4, normal),
        (100.0, 1.0, 0.5, 1.5, Incidence::Diffuse),
        (2.0, 0.99, 0.3, 0.999, normal),
        (2.0, 0.9, 0.75, 1.0, grazing),
    ] {
        let phase = Phase::henyey_greenstein(g).unwrap();
        let a = FresnelSlab::solve(tau, albedo, &phase, index, light, false).unwrap();
        let b = FresnelSlab::solve(tau, albedo, &phase, index, light, true).unwrap();
        let name = |what: &str| format!("{what} at tau {tau}, w {albedo}, g {g}, n {index}, {light:?}");
        // Of thin slabs and of little scattering the modes keep some 1e-14/(w tau).
        let relative = if tau < 0.01 || albedo < 0.1 { 1e-9 } else { 1e-11 };
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

/// The slab on finer nodes, which crowd at the critical cosine however thick it is.
fn finer(slab: &FresnelSlab) -> Solution {
    let degree = slab.phase.degree(1e-15, 600);
    let rule = Rule { upper: 48, lower: 80, power: 4, degree: degree + 20, tau: 0.0 };
    if slab.method == ORDINATES {
        let scattering = Arc::new(Scattering::new(slab.albedo, &slab.phase, degree, false));
        let nodes = slab.direct.face.nodes(rule);
        return Solution::Ordinates(Box::new(Matched::new(&slab.direct, scattering, nodes).unwrap()));
    }
    let moments: Vec<f64> = (0..=degree).map(|l| slab.phase.moment(l)).collect();
    Solution::Doubling(Box::new(Closed::new(&slab.direct, slab.albedo, &moments, rule).unwrap()))
}

proptest! {
    #![proptest_config(crate::fixed_cases(12))]

    /// The bound is earned: it covers what more nodes make of the same slab, everywhere.
    #[test]
    fn bounds_cover_a_third_set_of_nodes(
        tau in (-9.0..4.0_f64).prop_map(|x| libm::pow(10.0, x)),
        albedo in prop_oneof![0.0..=1.0_f64, Just(1.0), (-12.0..0.0_f64).prop_map(|x| 1.0 - libm::pow(10.0, x))],
        g in -0.7..0.7_f64,
        index in prop_oneof![
            1.0..2.5_f64, 0.5..1.0_f64, (-12.0..0.0_f64).prop_map(|x| 1.0 + libm::pow(10.0, x)), Just(1.5)
        ],
        light in prop_oneof![
            Just(Incidence::Diffuse),
            Just(Incidence::Beam { mu0: 1.0 }),
            (0.01..1.0_f64).prop_map(|mu0| Incidence::Beam { mu0 }),
        ],
    ) {
        let slab = FresnelSlab::new(tau, albedo, g, index, light).unwrap();
        let finer = finer(&slab);
        let fluxes = finer.fluxes();
        let check = |name: &str, got: Value, truth: Light| {
            let off = (got.value - truth.value).abs();
            prop_assert!(off <= got.error + truth.rounding(), "{name}: {got:?}, finer {truth:?}, off {off:e}");
            prop_assert!(got.error <= 1e-8 * got.value + 1e-14, "{name}: {got:?}");
            Ok(())
        };
        check("R", slab.reflectance_diffuse, fluxes.reflected)?;
        check("T", slab.transmittance_diffuse, fluxes.transmitted)?;
        check("A", slab.absorptance, fluxes.absorbed)?;
        for share in [0.0, 1e-7, 1e-3, 0.03, 0.4, 0.9, 0.999, 1.0] {
            let t = tau * share;
            let direct = slab.direct.fluence(t).unwrap().value;
            let light = finer.fluence(t, &slab.direct);
            check("phi", slab.fluence(t).unwrap(), Light { value: light.value + direct, magnitude: light.magnitude + direct })?;
        }
    }
}
