//! Anisotropic media, slabs and phase functions answer with finite numbers or refuse, whatever the bits.

use crate::support::any_input::{cases, number, sound};
use proptest::prelude::*;
use turbid_analytic::{AnisotropicMedium, AnisotropicSlab, Error, Incidence, Phase};

fn light() -> impl Strategy<Value = Incidence> {
    prop_oneof![Just(Incidence::Diffuse), number().prop_map(|mu0| Incidence::Beam { mu0 })]
}

/// Between slabs of a few media: a mixture of what is asked and what is nearly asked.
fn near(low: f64, high: f64) -> impl Strategy<Value = f64> {
    prop_oneof![3 => (low..high).prop_map(|e| libm::pow(10.0, e)), 1 => number()]
}

proptest! {
    #![proptest_config(cases(100_000, 20_260_104))]

    #[test]
    fn slabs(tau in any::<f64>(), albedo in any::<f64>(), g in any::<f64>(), light in light()) {
        if let Err(error) = AnisotropicSlab::new(tau, albedo, g, light) {
            prop_assert!(matches!(error, Error::OutOfRange { .. }), "{error}");
        }
    }

    #[test]
    fn phase_functions(a in number(), b in number(), c in number(), cosine in -1.0..=1.0_f64) {
        let phases = [
            Phase::henyey_greenstein(a),
            Phase::two_term(a, b, c),
            Phase::legendre(vec![1.0, a, b, c]),
            Phase::tabulated(&[-1.0, a, 1.0], &[a, b, c], 2),
        ];
        for phase in phases.into_iter().flatten() {
            prop_assert!(phase.g().abs() <= 1.0 + 1e-12 && phase.moment(0) == 1.0, "{phase:?}");
            // Between the angles at which a sum was checked it may dip by 2 per cent of its largest value.
            let value = phase.value(cosine);
            prop_assert!(value.is_finite() && value > -0.02 * 15.0, "{phase:?} {value}");
        }
    }
}

proptest! {
    #![proptest_config(cases(120, 20_260_104))]

    #[test]
    fn what_a_slab_answers(
        which in 0_usize..5,
        tau in near(-13.0, 10.0),
        mu0 in near(-5.5, 0.2),
        diffuse in any::<bool>(),
        t in prop_oneof![3 => 0.0..=1.0_f64, 1 => number()],
        mu in prop_oneof![3 => -1.0..=1.0_f64, 1 => number()],
        dphi in number(),
        deep in any::<bool>(),
    ) {
        static MEDIA: std::sync::OnceLock<Vec<AnisotropicMedium>> = std::sync::OnceLock::new();
        let media = MEDIA.get_or_init(|| {
            [(1.0, 0.0), (0.9, 0.4), (1.0 - 1e-12, -0.3), (0.0, 0.5), (1e-300, 0.2)]
                .map(|(albedo, g)| AnisotropicMedium::new(albedo, &Phase::henyey_greenstein(g).unwrap()).unwrap())
                .to_vec()
        });
        let light = if diffuse { Incidence::Diffuse } else { Incidence::Beam { mu0 } };
        let slab = if deep { media[which].half_space(light) } else { media[which].slab(tau, light) };
        match slab {
            Ok(slab) => {
                for v in [slab.reflectance(), slab.transmittance(), slab.transmittance_diffuse(), slab.absorptance()] {
                    sound(Ok(v))?;
                    prop_assert!(v.value > -v.error && v.value < 1.0 + v.error, "{v:?}");
                }
                let sum = slab.reflectance().value + slab.transmittance().value + slab.absorptance().value;
                prop_assert!((sum - 1.0).abs() < 1e-11, "{sum}");
                let t = if deep { t * 100.0 } else { t * tau };
                let phi = slab.fluence(t);
                if let Ok(v) = &phi {
                    prop_assert!(v.value >= -v.error, "{v:?}");
                }
                sound(phi)?;
                sound(slab.flux(t))?;
                let radiance = slab.radiance(t, mu, dphi);
                if let Ok(v) = &radiance {
                    prop_assert!(v.value >= -v.error, "{v:?}");
                }
                sound(radiance)?;
            }
            Err(error) => prop_assert!(matches!(error, Error::OutOfRange { .. }), "{error}"),
        }
    }
}
