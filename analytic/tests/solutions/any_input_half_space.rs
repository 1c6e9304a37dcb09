//! Half-spaces, infinite media, X and Y, asymptotics and two streams answer with finite numbers or refuse.

use crate::support::any_input::{Outcome, cases, sound};
use proptest::prelude::*;
use turbid_analytic::asymptotics::thin_slab;
use turbid_analytic::half_space::h_function;
use turbid_analytic::infinite::{mean_cosine, mean_square_displacement};
use turbid_analytic::two_stream::Method;
use turbid_analytic::{Asymptotics, HalfSpace, Incidence, InfiniteMedium, Phase, Result, TwoStream, XAndY};

/// Numbers near the ranges in use.
fn near() -> impl Strategy<Value = f64> {
    prop_oneof![
        4 => 0.0..1.0_f64,
        2 => -3.0..3.0_f64,
        1 => prop_oneof![Just(0.0), Just(-0.0), Just(1.0), Just(1.0 - 1e-16), Just(5e-324), Just(f64::INFINITY)],
        2 => (-20.0..8.0_f64).prop_map(|e| libm::pow(10.0, e)),
        1 => (-320.0..308.0_f64).prop_map(|e| libm::pow(10.0, e)),
    ]
}

fn half_space(albedo: f64, mu0: f64, mu: f64, t: f64) -> Outcome {
    let Ok(space) = HalfSpace::new(albedo) else { return Ok(()) };
    sound(space.h(mu))?;
    sound(Ok(space.decay()))?;
    sound(space.extrapolation_length())?;
    sound(space.milne_radiance(mu))?;
    sound(space.milne_fluence(t))?;
    for incidence in [Incidence::Beam { mu0 }, Incidence::Diffuse] {
        sound(space.reflectance(incidence))?;
        sound(space.absorptance(incidence))?;
        sound(space.radiance(incidence, mu))?;
        sound(space.fluence(incidence, t))?;
        sound(space.flux(incidence, t))?;
    }
    Ok(())
}

fn infinite(medium: Result<InfiniteMedium>, r: f64, s: f64) -> Outcome {
    let Ok(medium) = medium else { return Ok(()) };
    sound(medium.fluence(r))?;
    sound(medium.flux(r))?;
    sound(medium.asymptotic_fluence(r))?;
    sound(medium.diffusion_fluence(r))?;
    sound(medium.total_fluence())?;
    sound(medium.mean_square_radius())?;
    if s < 1e4 {
        sound(medium.transform(s))?;
    }
    medium.decays().into_iter().try_for_each(|k| sound(Ok(k)))
}

fn x_and_y(tau: f64, albedo: f64, mu0: f64, mu: f64) -> Outcome {
    let Ok(xy) = XAndY::new(tau, albedo) else { return Ok(()) };
    for pair in [xy.at(mu), xy.integrals(), xy.fluxes(mu0)].into_iter().flatten() {
        pair.into_iter().try_for_each(|v| sound(Ok(v)))?;
    }
    sound(xy.radiance_up(mu0, mu))?;
    sound(xy.radiance_down(mu0, mu))
}

fn asymptotics(constants: Result<Asymptotics>, tau: f64, mu0: f64, u: f64) -> Outcome {
    let Ok(a) = constants else { return Ok(()) };
    for value in [a.decay(), a.second_decay(), a.m(), a.n(), a.l(), a.extrapolation_length()] {
        sound(Ok(value))?;
    }
    sound(a.pattern(u))?;
    for incidence in [Incidence::Beam { mu0 }, Incidence::Diffuse] {
        sound(a.escape(incidence))?;
        if let Ok(slab) = a.slab(tau, incidence) {
            sound(Ok(slab.reflectance))?;
            sound(Ok(slab.transmittance))?;
            sound(Ok(slab.absorptance))?;
        }
    }
    Ok(())
}

fn two_stream(tau: f64, albedo: f64, g: f64, mu0: f64, t: f64) -> Outcome {
    for method in Method::ALL {
        for incidence in [Incidence::Beam { mu0 }, Incidence::Diffuse] {
            let slab = TwoStream::slab(method, tau, albedo, g, incidence);
            for model in [slab, TwoStream::half_space(method, albedo, g, incidence)].into_iter().flatten() {
                for number in [model.reflectance(), model.transmittance(), model.absorptance()] {
                    prop_assert!(number.value.is_finite(), "{model:?} {number:?}");
                }
                if let Ok(number) = model.fluence(t) {
                    prop_assert!(number.value.is_finite(), "{model:?} {t} {number:?}");
                }
            }
        }
    }
    Ok(())
}

proptest! {
    #![proptest_config(cases(40_000, 20_260_111))]

    /// All bits. A positive number below 1 is as often as not in range, and far below 1: what takes milliseconds is
    /// asked one time in 1024.
    #[test]
    fn any_bits(
        a in any::<f64>(), b in any::<f64>(), c in any::<f64>(), d in any::<f64>(), n in any::<u32>(), lot in 0..1024_u32,
    ) {
        sound(h_function(a, b))?;
        sound(mean_cosine(a, n))?;
        if n % 256 == 0 || n < 1000 {
            sound(mean_square_displacement(a, n % 2_000_000))?;
        }
        two_stream(a, b, c, d, d)?;
        asymptotics(Asymptotics::isotropic(a), b, c, d)?;
        for incidence in [Incidence::Beam { mu0: c }, Incidence::Diffuse] {
            if let Ok(thin) = thin_slab(a, b, incidence) {
                sound(Ok(thin.reflectance))?;
                sound(Ok(thin.transmittance))?;
            }
        }
        if lot == 0 {
            half_space(a, b, c, d)?;
            infinite(InfiniteMedium::henyey_greenstein(a, b), c, d)?;
            x_and_y(a, b, c, d)?;
        }
    }
}

proptest! {
    #![proptest_config(cases(100, 20_260_112))]

    #[test]
    fn near_the_ranges(a in near(), b in near(), c in near(), d in near(), n in 0_u32..2000) {
        half_space(a, b, c, d)?;
        // The sharpest peaks take the longest.
        infinite(InfiniteMedium::henyey_greenstein(a, if n < 200 { b.clamp(-0.99, 0.99) } else { b }), c, d)?;
        sound(mean_square_displacement(a, n))?;
        two_stream(a, b, c, d, d)?;
        two_stream(b, a, c, d, 0.5 * b)?;
        asymptotics(Asymptotics::isotropic(a), b, c, d)?;
        if n < 100 {
            x_and_y(a, b, c, d)?;
        }
        if let (Ok(phase), true) = (Phase::henyey_greenstein(b), n < 50) {
            asymptotics(Asymptotics::new(a, &phase), 1.0 / d, c, d)?;
            infinite(InfiniteMedium::new(a, &phase), c, d)?;
        }
    }
}
