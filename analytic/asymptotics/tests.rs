use super::*;
use crate::work;
use crate::{AnisotropicSlab, IsotropicSlab};

const BEAMS: [Incidence; 3] =
    [Incidence::Beam { mu0: 1.0 }, Incidence::Beam { mu0: 0.2 }, Incidence::Diffuse];

fn henyey_greenstein(albedo: f64, g: f64) -> Asymptotics {
    Asymptotics::new(albedo, &Phase::henyey_greenstein(g).unwrap()).unwrap()
}

fn agree(a: Value, b: Value, what: &str) {
    assert!((a.value - b.value).abs() <= a.error + b.error, "{what}: {a:?} {b:?}");
}

/// m, n, l found with 30 digits elsewhere.
#[test]
fn known_constants() {
    for (w, g, m, n, l) in [
        (0.9, 0.0, 1.66646331, 0.66542004, 0.43616870),
        (0.9, 0.75, 3.30302430, 0.51204580, 0.19620799),
        (0.99, 0.85, 1.21029063, 0.74533680, 0.52688548),
    ] {
        let a = henyey_greenstein(w, g);
        for (got, known) in [(a.m(), m), (a.n(), n), (a.l(), l)] {
            assert!((got.value - known).abs() < 6e-9 && got.error < 1e-9, "{w} {g}: {got:?} {known}");
        }
    }
    // (1-g) z at w = 1.
    for (g, q) in [
        (0.0, 0.7104460896),
        (0.3, 0.7110726163),
        (0.5, 0.7119556672),
        (0.75, 0.7133632908),
        (0.85, 0.7139965861),
        (0.9, 0.7143258616),
        (0.95, 0.7146628434),
        (-0.3, 0.7115160),
        (-0.5, 0.7140754),
        (-0.9, 0.7298801),
    ] {
        let z = henyey_greenstein(1.0, g).extrapolation_length();
        let digits = if g < 0.0 { 6e-8 } else { 6e-11 };
        assert!(((1.0 - g) * z.value - q).abs() < digits + z.error && z.error < 1e-9, "{g}: {z:?} {q}");
    }
}

#[test]
fn closed_form_and_ordinates_agree() {
    for w in [0.5, 0.9, 0.999_999, 1.0] {
        let (a, b) = (Asymptotics::isotropic(w).unwrap(), henyey_greenstein(w, 0.0));
        for (name, one, two) in [
            ("m", a.m(), b.m()),
            ("n", a.n(), b.n()),
            ("l", a.l(), b.l()),
            ("z", a.extrapolation_length(), b.extrapolation_length()),
        ] {
            agree(one, two, &format!("{w} {name}"));
            assert!((one.value - two.value).abs() <= 1e-10 * one.value, "{w} {name} {one:?} {two:?}");
        }
        for incidence in BEAMS {
            let (one, two) = (a.escape(incidence).unwrap(), b.escape(incidence).unwrap());
            agree(one, two, &format!("{w} {incidence:?}"));
            assert!((one.value - two.value).abs() < 1e-10 * one.value, "{w} {incidence:?} {one:?} {two:?}");
        }
    }
}

/// The deep pattern has mean 1 and, isotropic, is w/(1 - ku); 2 int u K P du = 1 by K at Gauss nodes.
#[test]
fn the_pattern() {
    let rule = crate::quadrature::GaussLegendre::new(32).unwrap();
    for (w, g) in [(0.9, 0.0), (0.9, 0.75), (0.99, -0.5)] {
        let a = henyey_greenstein(w, g);
        let mean = 0.5 * rule.integrate(-1.0, 1.0, |u| a.pattern(u).unwrap().value);
        assert!((mean - 1.0).abs() < 1e-12, "{w} {g} {mean}");
        let m = 2.0 * rule.integrate(-1.0, 1.0, |u| u * a.pattern(u).unwrap().value.powi(2));
        assert!((m - a.m().value).abs() < 1e-12 * m.max(1.0), "{w} {g} {m} {:?}", a.m());
        let k = |u: f64| a.escape(Incidence::Beam { mu0: u }).unwrap().value;
        // u ln u at 0: squares of the nodes.
        let few = crate::quadrature::GaussLegendre::new(12).unwrap();
        let flux =
            2.0 * few.integrate(0.0, 1.0, |x| 2.0 * x * x * x * k(x * x) * a.pattern(x * x).unwrap().value);
        assert!((flux - 1.0).abs() < 1e-7, "{w} {g} {flux}");
    }
}

/// Slabs solved in depth lie within the bounds, and the bounds within reason.
#[test]
fn slabs_lie_within_the_bounds() {
    for (w, g) in [(0.5, 0.0), (0.9, 0.0), (1.0, 0.0), (0.99, 0.85), (1.0, 0.75), (0.99, -0.9)] {
        let a = if g == 0.0 { Asymptotics::isotropic(w).unwrap() } else { henyey_greenstein(w, g) };
        let gap = a.second_decay().value - a.decay().value;
        for tau in [3.0, 10.0, 40.0] {
            for incidence in BEAMS {
                let thick = a.slab(tau, incidence).unwrap();
                let (r, t, absorbed) = if g == 0.0 {
                    let slab = IsotropicSlab::new(tau, w, incidence).unwrap();
                    (slab.reflectance(), slab.transmittance(), slab.absorptance())
                } else {
                    let slab = AnisotropicSlab::new(tau, w, g, incidence).unwrap();
                    (slab.reflectance(), slab.transmittance(), slab.absorptance())
                };
                let case = format!("w {w} g {g} tau {tau} {incidence:?}");
                agree(thick.reflectance, r, &case);
                agree(thick.transmittance, t, &case);
                agree(thick.absorptance, absorbed, &case);
                let scale = libm::exp(-gap * tau);
                let bound = thick.transmittance.error / thick.transmittance.value;
                assert!(bound < 1000.0 * scale + 1e-8, "{case}: {bound:e} {scale:e}");
            }
        }
    }
}

/// R + T + A = 1, no absorption without absorption, at any thickness.
#[test]
fn far_beyond_what_can_be_solved_in_depth() {
    for (w, g) in [(1.0, 0.0), (1.0, 0.85), (1.0 - 1e-12, 0.0), (0.999, 0.5)] {
        let a = if g == 0.0 { Asymptotics::isotropic(w).unwrap() } else { henyey_greenstein(w, g) };
        for tau in [1e2, 1e4, 1e8, 1e12] {
            let s = a.slab(tau, BEAMS[0]).unwrap();
            let sum = s.reflectance.value + s.transmittance.value + s.absorptance.value;
            let allowed = s.reflectance.error + s.transmittance.error + s.absorptance.error;
            assert!((sum - 1.0).abs() <= allowed && allowed < 1e-8, "{w} {g} {tau:e}: {s:?}");
        }
    }
    let (a, tau) = (Asymptotics::isotropic(1.0).unwrap(), 1e4);
    // (4/3)/(tau + 2 q), and with (sqrt 3/4) H(1) for a beam.
    let q = 0.710_446_089_598_763_1;
    let t = a.slab(tau, Incidence::Diffuse).unwrap().transmittance;
    assert!(t.covers(4.0 / 3.0 / (tau + 2.0 * q)) && t.error < 1e-12 * t.value, "{t:?}");
    let t = a.slab(tau, BEAMS[0]).unwrap().transmittance;
    assert!(t.covers(3f64.sqrt() / 3.0 * 2.907_810_529_078_606 / (tau + 2.0 * q)), "{t:?}");
}

/// Discrete ordinates carry their modes through any thickness.
#[test]
fn ordinates_at_great_thickness() {
    for (w, g) in [(1.0, 0.85), (0.999_999, 0.75)] {
        let a = henyey_greenstein(w, g);
        for incidence in BEAMS {
            let (thick, slab) =
                (a.slab(1e4, incidence).unwrap(), AnisotropicSlab::new(1e4, w, g, incidence).unwrap());
            agree(thick.reflectance, slab.reflectance(), "R");
            agree(thick.transmittance, slab.transmittance(), "T");
            agree(thick.absorptance, slab.absorptance(), "A");
            let t = slab.transmittance().value;
            assert!(
                (thick.transmittance.value / t - 1.0).abs() < 1e-9,
                "{w} {g} {incidence:?} {thick:?} {t:e}"
            );
        }
    }
}

/// A question takes two decompositions, of 490 and 420 modes in ten or eleven sweeps, and six systems; more thicknesses
/// take none, and diffuse light on a list of moments one recurrence a direction, not one a pair of directions.
#[test]
fn work_is_bounded() {
    let list = Phase::legendre((0..2000).map(|l| libm::pow(0.99, f64::from(l))).collect()).unwrap();
    let cube = |n: usize| n * n * n;
    let sweep = (cube(490) + cube(420)) / 2;
    let systems = (cube(490) + cube(420)) / 3;
    for (phase, albedo, incidence) in [
        (Phase::henyey_greenstein(0.99).unwrap(), 1.0 - f64::EPSILON / 2.0, BEAMS[0]),
        (Phase::henyey_greenstein(-0.95).unwrap(), 0.9, BEAMS[2]),
        (list, 1.0, BEAMS[2]),
    ] {
        let (deep, solved) = work::of(|| Asymptotics::new(albedo, &phase).unwrap());
        let (_, first) = work::of(|| deep.slab(10.0, incidence).unwrap());
        let (_, more) = work::of(|| {
            for tau in 1..100 {
                deep.slab(f64::from(tau), incidence).unwrap();
            }
        });
        assert!(solved <= 14 * sweep + 2 * systems, "{phase:?}: {solved} terms, {sweep} a sweep");
        assert!(first <= systems + systems / 4, "{phase:?}: {first} terms, {systems} a pair of systems");
        assert_eq!(more, 0, "{phase:?}");
    }
}

#[test]
fn thin_slabs() {
    for incidence in BEAMS {
        for tau in [1e-8, 1e-3, 0.05] {
            let (thin, slab) =
                (thin_slab(tau, 0.9, incidence).unwrap(), IsotropicSlab::new(tau, 0.9, incidence).unwrap());
            agree(thin.reflectance, slab.reflectance(), "R");
            agree(thin.transmittance, slab.transmittance(), "T");
            agree(thin.transmittance_diffuse, slab.transmittance_diffuse(), "T diffuse");
        }
        let leading = match incidence {
            Incidence::Beam { mu0 } => 0.45 * 1e-8 / mu0,
            Incidence::Diffuse => 0.9 * 1e-8,
        };
        let r = thin_slab(1e-8, 0.9, incidence).unwrap().reflectance;
        assert!((r.value / leading - 1.0).abs() < 1e-6, "{r:?} {leading:e}");
    }
}
