//! The slab between refracting faces: tables, laws, limits.

use crate::support::table::{check, number, rows};
use crate::support::{NORMAL, close};
use turbid_analytic::quadrature::GaussLegendre;
use turbid_analytic::slab_fresnel::hemispherical_reflectance;
use turbid_analytic::{AnisotropicSlab, Error, FresnelSlab, Incidence, Phase};

/// Rs and Ts of the table are those of Lambertian light from outside, the rest is of the beam.
#[test]
fn the_reference_table_is_reproduced_by_both_methods() {
    for row in rows("slab_fresnel.csv", 16) {
        let number = |name: &str| number(&row, name);
        let quantity = row["quantity"].as_str();
        let light = match quantity {
            "Rs" | "Ts" => Incidence::Diffuse,
            _ => Incidence::Beam { mu0: number("mu0") },
        };
        let phase = Phase::henyey_greenstein(number("g")).unwrap();
        let (tau, albedo, index) = (number("tau"), number("w"), number("n"));
        for slab in [
            FresnelSlab::with_phase(tau, albedo, &phase, index, light).unwrap(),
            FresnelSlab::by_doubling(tau, albedo, &phase, index, light).unwrap(),
        ] {
            let got = match quantity {
                "Rspec" => slab.specular(),
                "Rdiff" => slab.reflectance_diffuse(),
                "Rtot" | "Rs" => slab.reflectance(),
                "Tcoll" => slab.transmittance_direct(),
                "Tdiff" => slab.transmittance_diffuse(),
                "Ttot" | "Ts" => slab.transmittance(),
                other => panic!("{other}"),
            };
            check(&row, got);
            assert!(got.error < 1e-11 * number("value"), "{row:?} {got:?}");
        }
    }
}

/// Giovanelli 1955, half-space of albedo 0.9 with n = 1.5, isotropic scattering, normal incidence: 0.2600, as it has
/// been used to test Monte Carlo programs since Wang, Jacques and Zheng 1995. Both methods here have 0.25992: the last
/// printed digit is one too high.
#[test]
fn a_half_space_of_giovanelli() {
    let slab = FresnelSlab::new(200.0, 0.9, 0.0, 1.5, NORMAL).unwrap();
    assert!((slab.reflectance().value - 0.2600).abs() < 1e-4, "{:?}", slab.reflectance());
}

/// A grid of both methods, |g| to 0.92, with an index on each side of 1 and as close to it as 1e-4.
#[test]
fn discrete_ordinates_agree_with_doubling() {
    let grazing = Incidence::Beam { mu0: 0.1 };
    for (tau, albedo, g, index, light) in [
        (0.01, 0.9, 0.5, 1.0001, NORMAL),
        (1.0, 1.0, 0.0, 1.0001, grazing),
        (1.0, 0.9, 0.75, 1.33, grazing),
        (100.0, 0.999999, 0.5, 1.33, Incidence::Diffuse),
        (1.0, 1e-6, 0.0, 1.5, Incidence::Diffuse),
        (10.0, 0.9, -0.5, 1.5, grazing),
        (3.0, 1.0, 0.75, 2.4, NORMAL),
        (0.1, 0.99, 0.0, 2.4, grazing),
        (1.0, 0.9, 0.5, 0.8, Incidence::Diffuse),
        (2.0, 0.99, 0.92, 1.5, NORMAL),
    ] {
        let phase = Phase::henyey_greenstein(g).unwrap();
        let a = FresnelSlab::with_phase(tau, albedo, &phase, index, light).unwrap();
        let b = FresnelSlab::by_doubling(tau, albedo, &phase, index, light).unwrap();
        let name = |what: &str| format!("{what} at tau {tau}, w {albedo}, g {g}, n {index}, {light:?}");
        close(&name("R"), a.reflectance_diffuse(), b.reflectance_diffuse(), 1e-10);
        close(&name("T"), a.transmittance_diffuse(), b.transmittance_diffuse(), 1e-10);
        close(&name("A"), a.absorptance(), b.absorptance(), 1e-10);
        for share in [0.0, 0.01, 0.5, 1.0] {
            close(&name("phi"), a.fluence(tau * share).unwrap(), b.fluence(tau * share).unwrap(), 1e-10);
        }
    }
}

#[test]
fn an_index_of_one_is_no_face() {
    for (tau, albedo, g, light) in [
        (1.0, 0.9, 0.75, NORMAL),
        (1e-5, 1.0, 0.5, Incidence::Diffuse),
        (50.0, 0.99, 0.0, Incidence::Beam { mu0: 0.05 }),
    ] {
        let open = AnisotropicSlab::new(tau, albedo, g, light).unwrap();
        let slab = FresnelSlab::new(tau, albedo, g, 1.0, light).unwrap();
        assert_eq!(slab.specular().value, 0.0);
        close("R", slab.reflectance(), open.reflectance(), 1e-10);
        close("T", slab.transmittance(), open.transmittance(), 1e-10);
        close("A", slab.absorptance(), open.absorptance(), 1e-10);
        for share in [0.0, 0.2, 1.0] {
            close("phi", slab.fluence(tau * share).unwrap(), open.fluence(tau * share).unwrap(), 1e-10);
        }
        // And n -> 1 leads there: light within mu_c = root(2 (n-1)) of the horizon is all that changes much.
        let near = FresnelSlab::new(tau, albedo, g, 1.0 + 1e-12, light).unwrap();
        let off = (near.reflectance().value - slab.reflectance().value).abs();
        assert!(off < 5.0 * 1.5e-6 * slab.reflectance().value, "{off:e}");
    }
}

/// What leaves, what is absorbed and what returned add up to 1; at albedo 1 without absorption. Thick and thin.
#[test]
fn light_is_conserved() {
    for (tau, albedo, g, index, light) in [
        (1e4, 1.0, 0.75, 1.5, NORMAL),
        (1e4, 0.999999, 0.5, 1.33, Incidence::Diffuse),
        (1e5, 0.9, 0.0, 4.0, NORMAL),
        (1e-8, 0.999999, 0.5, 1.5, Incidence::Diffuse),
        (1e-12, 1.0, 0.0, 2.0, Incidence::Beam { mu0: 1e-5 }),
        (1.0, 0.9, 0.3, 0.25, Incidence::Diffuse),
        (1.0, 1e-6, -0.9, 1.4, Incidence::Beam { mu0: 1e-3 }),
    ] {
        let slab = FresnelSlab::new(tau, albedo, g, index, light).unwrap();
        let parts = [slab.reflectance(), slab.transmittance(), slab.absorptance()];
        let sum: f64 = parts.iter().map(|part| part.value).sum();
        let error: f64 = parts.iter().map(|part| part.error).sum();
        assert!((sum - 1.0).abs() <= error && error < 1e-9, "{tau} {albedo} {g} {index}: {parts:?}");
    }
}

/// Albedo 1 and Lambertian light on both faces: radiance n^2/pi everywhere inside, so that the fluence is 4 n^2.
#[test]
fn the_furnace_is_uniform() {
    for (tau, g, index) in [
        (1e-4, 0.0, 1.5),
        (2.0, 0.5, 1.33),
        (2.0, 0.0, 0.6),
        (1e-6, 0.3, 0.9),
        (0.3, 0.0, 1.001),
        (300.0, 0.75, 2.4),
    ] {
        let slab = FresnelSlab::new(tau, 1.0, g, index, Incidence::Diffuse).unwrap();
        for share in [0.0, 1e-3, 0.3, 0.5] {
            let (a, b) = (slab.fluence(tau * share).unwrap(), slab.fluence(tau - tau * share).unwrap());
            let off = a.value + b.value - 4.0 * index * index;
            assert!(off.abs() < a.error + b.error + 1e-12, "{tau} {g} {index} {share}: {off:e}");
        }
    }
}

/// Lambertian light is beams, 2 mu0 dmu0 of each: R and T are their mean.
#[test]
fn lambertian_light_is_the_mean_of_beams() {
    let rule = GaussLegendre::new(14).unwrap();
    let of = |light| FresnelSlab::new(1.5, 0.95, 0.5, 1.5, light).unwrap();
    let diffuse = of(Incidence::Diffuse);
    let (mut r, mut t, mut phi) = (0.0, 0.0, 0.0);
    for (mu0, w) in rule.nodes.iter().zip(&rule.weights) {
        let slab = of(Incidence::Beam { mu0: *mu0 });
        r += 2.0 * mu0 * w * slab.reflectance().value;
        t += 2.0 * mu0 * w * slab.transmittance().value;
        phi += 2.0 * mu0 * w * slab.fluence(0.4).unwrap().value;
    }
    // Fresnel's law is analytic from mu0 = 0 on, up to poles at -1/n: 14 nodes leave 1e-9 of it.
    assert!((r - diffuse.reflectance().value).abs() < 1e-9, "{:e}", r - diffuse.reflectance().value);
    assert!((t - diffuse.transmittance().value).abs() < 1e-9, "{:e}", t - diffuse.transmittance().value);
    assert!((phi - diffuse.fluence(0.4).unwrap().value).abs() < 1e-8);
}

/// Without scattering, a plate: T = (1-r)^2 e/(1 - r^2 e^2), R = r + r (1-r)^2 e^2/(1 - r^2 e^2).
#[test]
fn a_plate_that_only_absorbs() {
    let slab = FresnelSlab::new(0.7, 0.0, 0.3, 1.5, NORMAL).unwrap();
    let (r, e) = (0.04, libm::exp(-0.7));
    let t = (1.0 - r) * (1.0 - r) * e / (1.0 - r * r * e * e);
    assert!((slab.transmittance().value - t).abs() < 1e-15);
    assert!((slab.reflectance().value - r - r * e * t).abs() < 1e-15);
    assert_eq!(slab.reflectance_diffuse().value, 0.0);
}

#[test]
fn a_rarer_medium_reflects_whole() {
    let slab = FresnelSlab::new(1.0, 0.9, 0.5, 0.7, Incidence::Beam { mu0: 0.5 }).unwrap();
    assert_eq!(slab.specular().value, 1.0);
    assert_eq!((slab.transmittance().value, slab.absorptance().value), (0.0, 0.0));
    assert_eq!(slab.fluence(0.3).unwrap().value, 0.0);
}

/// Duntley's closed form at n = 1.5, and reciprocity of the two sides.
#[test]
fn hemispherical_reflectances() {
    let outer = hemispherical_reflectance(1.5, true).unwrap();
    let inner = hemispherical_reflectance(1.5, false).unwrap();
    assert!((outer.value - 0.0917779593).abs() < 5e-11, "{outer:?}");
    assert!((2.25 * (1.0 - inner.value) - (1.0 - outer.value)).abs() < 1e-14);
    close("sides", hemispherical_reflectance(2.0 / 3.0, true).unwrap(), inner, 1e-13);
}

#[test]
fn refusals_name_the_parameter() {
    let name = |answer: turbid_analytic::Result<FresnelSlab>| match answer.err().unwrap() {
        Error::OutOfRange { name, .. } => name,
        other => panic!("{other}"),
    };
    assert_eq!(name(FresnelSlab::new(1e6, 0.9, 0.0, 1.5, NORMAL)), "tau");
    assert_eq!(name(FresnelSlab::new(1.0, 1.1, 0.0, 1.5, NORMAL)), "albedo");
    assert_eq!(name(FresnelSlab::new(1.0, 0.9, 0.97, 1.5, NORMAL)), "g");
    assert_eq!(name(FresnelSlab::new(1.0, 0.9, 0.0, f64::NAN, NORMAL)), "index");
    assert_eq!(name(FresnelSlab::new(1.0, 0.9, 0.0, 1.5, Incidence::Beam { mu0: 0.0 })), "mu0");
    // Refracted to the horizon itself.
    let horizon = Incidence::Beam { mu0: libm::sqrt(1.0 - 0.7 * 0.7) + 1e-12 };
    assert_eq!(name(FresnelSlab::new(1.0, 0.9, 0.0, 0.7, horizon)), "mu0");
    assert!(FresnelSlab::new(1.0, 0.9, 0.0, 1.5, NORMAL).unwrap().fluence(1.1).is_err());
}
