//! Slabs order by order, and kernel theory of beams: an answer or a refusal that names the parameter, whatever the bits.
#![allow(clippy::unwrap_used, reason = "tests")]

use proptest::prelude::*;
use turbid_analytic::slab_single::henyey_greenstein_mean;
use turbid_analytic::{Incidence, Phase, Result, ScatteringOrders, Value};

/// Any bits, and numbers near the ranges in use.
fn number() -> impl Strategy<Value = f64> {
    prop_oneof![
        3 => any::<f64>(),
        1 => 0.0..1.0_f64,
        1 => prop_oneof![Just(0.0), Just(-0.0), Just(1.0), Just(-1.0), Just(5e-324), Just(f64::INFINITY)],
        1 => (-320.0..308.0_f64).prop_map(|e| libm::pow(10.0, e)),
    ]
}

fn config(cases: u32) -> ProptestConfig {
    ProptestConfig {
        cases,
        rng_seed: proptest::test_runner::RngSeed::Fixed(20_260_104),
        failure_persistence: None,
        ..ProptestConfig::default()
    }
}

fn sound(answer: Result<Value>) -> std::result::Result<(), TestCaseError> {
    match answer {
        Ok(v) => prop_assert!(v.value.is_finite() && v.error.is_finite() && v.error >= 0.0, "{v:?}"),
        Err(e) => prop_assert!(e.to_string().contains(" is "), "{e}"),
    }
    Ok(())
}

proptest! {
    #![proptest_config(config(100_000))]

    #[test]
    fn any_bits(
        tau in number(), albedo in number(), g in number(), mu0 in number(), t in number(), n in any::<u32>(),
    ) {
        sound(henyey_greenstein_mean(g, albedo, t))?;
        // Deep orders are asked of the mixture below: here the first ones, that are closed in depth.
        let n = if n % 3 == 0 { n.max(101) } else { n % 2 };
        for incidence in [Incidence::Beam { mu0 }, Incidence::Diffuse] {
            let n = if incidence == Incidence::Diffuse { 0 } else { n };
            if let Ok(orders) = ScatteringOrders::new(tau, albedo, &Phase::isotropic(), incidence) {
                sound(orders.fluence(n, t))?;
                sound(orders.reflectance(n))?;
                sound(orders.transmittance(n))?;
            }
        }
    }
}

proptest! {
    #![proptest_config(config(16))]

    #[test]
    fn near_the_ranges(
        tau in (-12.0..4.0_f64).prop_map(|e| libm::pow(10.0, e)),
        albedo in prop_oneof![0.0..=1.0_f64, Just(1.0)],
        g in -0.6..0.8_f64,
        mu0 in (-5.0..0.0_f64).prop_map(|e| libm::pow(10.0, e)),
        diffuse in any::<bool>(),
        share in 0.0..=1.0_f64,
    ) {
        let incidence = if diffuse { Incidence::Diffuse } else { Incidence::Beam { mu0 } };
        let phase = Phase::henyey_greenstein(g).unwrap();
        let orders = ScatteringOrders::new(tau, albedo, &phase, incidence).unwrap();
        let mut before = f64::INFINITY;
        for n in 0..4 {
            let phi = orders.fluence(n, share * tau).unwrap();
            prop_assert!(phi.value >= -phi.error && phi.error <= 1e-6 * phi.value + 1e-20, "{n} {phi:?}");
            let (r, t) = (orders.reflectance(n).unwrap(), orders.transmittance(n).unwrap());
            prop_assert!(r.error <= 1e-8 * r.value + 1e-20 && t.error <= 1e-8 * t.value + 1e-20, "{r:?} {t:?}");
            // No more leaves after n scatterings than was left after n - 1.
            let leaves = r.value + t.value + orders.absorptance(n).unwrap().value;
            prop_assert!(leaves <= before.min(1.0) * (1.0 + 1e-9), "{n} {leaves} {before}");
            before = 1.0;
        }
    }
}
