//! Slabs by doubling and between refracting faces answer with finite numbers or refuse, whatever the bits.

use crate::support::any_input::{Outcome, cases, sound};
use proptest::prelude::*;
use turbid_analytic::slab_fresnel::hemispherical_reflectance;
use turbid_analytic::{AddingDoubling, FresnelSlab, Incidence};

/// Numbers near the ranges in use, ends and beyond included.
fn near() -> impl Strategy<Value = f64> {
    prop_oneof![
        0.0..1.0_f64,
        -1.0..1.5_f64,
        prop_oneof![Just(0.0), Just(-0.0), Just(1.0), Just(5e-324), Just(1.0 - 1e-16), Just(1.0 + 3e-16)],
        (-14.0..2.2_f64).prop_map(|e| libm::pow(10.0, e)),
    ]
}

fn light(mu0: f64, diffuse: bool) -> Incidence {
    if diffuse { Incidence::Diffuse } else { Incidence::Beam { mu0 } }
}

fn doubling(tau: f64, albedo: f64, g: f64, light: Incidence, t: f64) -> Outcome {
    let Ok(slab) = AddingDoubling::new(tau, albedo, g, light) else { return Ok(()) };
    for v in [slab.reflectance(), slab.transmittance(), slab.absorptance()] {
        sound(Ok(v))?;
        prop_assert!(v.value >= 0.0 && v.value <= 1.0 + v.error, "{v:?}");
    }
    sound(slab.fluence(t))?;
    sound(slab.fluence(t * tau))
}

fn fresnel(tau: f64, albedo: f64, g: f64, index: f64, light: Incidence, t: f64) -> Outcome {
    let Ok(slab) = FresnelSlab::new(tau, albedo, g, index, light) else { return Ok(()) };
    let parts = [slab.reflectance(), slab.transmittance(), slab.absorptance()];
    for v in parts {
        sound(Ok(v))?;
        prop_assert!(v.value >= -v.error && v.value <= 1.0 + v.error, "{v:?}");
    }
    let sum: f64 = parts.iter().map(|v| v.value).sum();
    let error: f64 = parts.iter().map(|v| v.error).sum();
    prop_assert!((sum - 1.0).abs() <= error + 1e-15, "{parts:?}");
    sound(slab.fluence(t))?;
    sound(slab.fluence(t * tau))
}

proptest! {
    #![proptest_config(cases(100_000, 20_260_103))]

    #[test]
    fn all_bits(
        tau in any::<f64>(), albedo in any::<f64>(), g in any::<f64>(), index in any::<f64>(), mu0 in any::<f64>(),
        t in any::<f64>(), diffuse in prop::bool::weighted(0.2),
    ) {
        doubling(tau, albedo, g, light(mu0, diffuse), t)?;
        fresnel(tau, albedo, g, index, light(mu0, diffuse), t)?;
        sound(hemispherical_reflectance(index, diffuse))?;
    }
}

proptest! {
    #![proptest_config(cases(40, 20_260_103))]

    #[test]
    fn near_the_ranges(
        tau in near(), albedo in near(), g in prop_oneof![near().prop_map(|g| 0.8 * g), -0.5..0.5_f64],
        index in prop_oneof![near().prop_map(|x| 1.0 + x), near(), Just(4.0), Just(0.25)],
        mu0 in near(), t in near(), diffuse in any::<bool>(),
    ) {
        doubling(tau, albedo, g, light(mu0, diffuse), t)?;
        fresnel(tau, albedo, g, index, light(mu0, diffuse), t)?;
        sound(hemispherical_reflectance(index, diffuse))?;
    }
}
