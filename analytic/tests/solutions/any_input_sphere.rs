//! Spheres, cavities, critical bodies and mean paths answer with finite numbers or refuse, whatever the bits.

use crate::support::any_input::{cases, sound};
use proptest::prelude::*;
use turbid_analytic::mean_path::{
    chord_density_slab, chord_density_sphere, chord_moment_slab, chord_moment_sphere, mean_path,
    mean_path_cuboid, mean_path_slab, mean_path_sphere, mean_path_sphere_absorbing,
};
use turbid_analytic::sphere::{absorbing_transmittance, escape_from, escape_uniform};
use turbid_analytic::{Cavity, Critical, CriticalShape, Sphere, SphereSource};

fn source() -> impl Strategy<Value = SphereSource> {
    prop_oneof![Just(SphereSource::Uniform), Just(SphereSource::Centre), Just(SphereSource::Incident)]
}

/// Numbers near the ranges and their ends.
fn near(low: f64, high: f64) -> impl Strategy<Value = f64> {
    prop_oneof![
        6 => libm::log10(low)..libm::log10(high),
        1 => Just(libm::log10(low)),
        1 => Just(libm::log10(high)),
    ]
    .prop_map(move |e| libm::pow(10.0, e).clamp(0.5 * low, 2.0 * high))
}

fn unit() -> impl Strategy<Value = f64> {
    prop_oneof![
        3 => 0.0..=1.0_f64, 1 => Just(0.0), 1 => Just(1.0), 1 => Just(5e-324), 1 => Just(1.0 - f64::EPSILON),
        2 => (-18.0..0.0_f64).prop_map(|e| libm::pow(10.0, e)),
        1 => (-18.0..-1.0_f64).prop_map(|e| 1.0 - libm::pow(10.0, e)),
    ]
}

proptest! {
    #![proptest_config(cases(100_000, 20_260_104))]

    #[test]
    fn closed_forms_take_any_bits(x in any::<f64>(), y in any::<f64>(), z in any::<f64>(), n in any::<u32>()) {
        sound(escape_from(x, y))?;
        sound(escape_uniform(x))?;
        sound(absorbing_transmittance(x))?;
        sound(mean_path(x, y))?;
        sound(mean_path_sphere(x))?;
        sound(mean_path_slab(x))?;
        sound(mean_path_cuboid(x, y, z))?;
        sound(chord_moment_sphere(x, n % 200))?;
        sound(chord_moment_slab(x, n % 4))?;
        sound(chord_density_sphere(x, y))?;
        sound(chord_density_slab(x, y))?;
        if let Ok(cavity) = Cavity::empty(x, y) {
            sound(Ok(cavity.irradiance_centre()))?;
            sound(cavity.irradiance(z, x))?;
            sound(cavity.fluence_wall(z))?;
        }
        // Almost all of these are refused at the door; the others are below.
        if !(1e-12..=1e6).contains(&x) || !(0.0..=1.0).contains(&y) {
            prop_assert!(Sphere::new(x, y, SphereSource::Uniform).is_err());
            prop_assert!(Cavity::filled(x, 0.5, y).is_err());
        }
        if !(1.0 + 1e-12..=1000.0).contains(&x) {
            prop_assert!(Critical::new(CriticalShape::Slab, x).is_err());
        }
    }
}

proptest! {
    #![proptest_config(cases(30, 20_260_104))]

    #[test]
    fn solved_spheres(
        radius in near(1e-12, 1e6), albedo in unit(), source in source(), part in unit(), mu in unit(),
        r in any::<f64>(),
    ) {
        if let Ok(sphere) = Sphere::new(radius, albedo, source) {
            for v in [sphere.escape(), sphere.absorptance()] {
                sound(Ok(v))?;
                prop_assert!(v.value >= -v.error && v.value <= 1.0 + v.error, "{v:?}");
            }
            for r in [part * radius, r] {
                for answer in [sphere.fluence(r), sphere.fluence_interpolated(r), sphere.fluence_direct(r)] {
                    sound(answer.clone())?;
                    if let Ok(v) = answer {
                        prop_assert!(v.value >= -v.error, "{radius} {albedo} {source:?} {r}: {v:?}");
                    }
                }
            }
            if let (Ok(whole), Ok(direct)) = (sphere.fluence(part * radius), sphere.fluence_direct(part * radius)) {
                prop_assert!(direct.value - direct.error <= whole.value + whole.error);
            }
            for mu in [mu, r] {
                if let Ok(v) = sphere.exit_radiance(mu) {
                    sound(Ok(v))?;
                    prop_assert!(v.value >= -v.error, "{radius} {albedo} {source:?} {mu}: {v:?}");
                }
            }
        } else {
            let refused = !(1e-12..=1e6).contains(&radius) || radius > 64.0 && albedo < 1e-12;
            prop_assert!(refused, "{radius} {albedo}");
        }
    }
}

proptest! {
    #![proptest_config(cases(6, 20_260_104))]

    #[test]
    fn bodies_built_on_them(
        radius in near(1e-12, 1e6), albedo in unit(), wall in unit(), excess in near(1e-12, 999.0), x in unit(),
    ) {
        sound(mean_path_sphere_absorbing(radius, albedo))?;
        if let Ok(cavity) = Cavity::filled(radius, wall, albedo) {
            sound(Ok(cavity.rounds()))?;
            sound(Ok(cavity.irradiance_wall()))?;
            sound(Ok(cavity.irradiance_centre()))?;
            sound(cavity.irradiance_mean(x))?;
            sound(cavity.fluence_wall(x * radius))?;
        }
        for shape in [CriticalShape::Slab, CriticalShape::Sphere] {
            if let Ok(critical) = Critical::new(shape, 1.0 + excess) {
                let (size, ratio) = (critical.size(), critical.flux_ratio(x).unwrap());
                prop_assert!(size.value > 0.0 && size.error < 1e-10 * size.value, "{size:?}");
                prop_assert!(ratio.value > 0.0 && ratio.value <= 1.0 + ratio.error, "{ratio:?}");
            }
        }
    }
}
