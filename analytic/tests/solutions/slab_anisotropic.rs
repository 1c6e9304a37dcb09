//! The Henyey-Greenstein slab against the reference table, the isotropic slab, closed forms and exact laws.

use crate::support::beam;
use crate::support::table::{check_to, incidence, number, rows};
use libm::{exp, pow, sqrt};
use proptest::prelude::*;
use std::collections::HashMap;
use std::f64::consts::PI;
use turbid_analytic::beer_lambert::{direct_transmittance, uncollided_fluence};
use turbid_analytic::quadrature::GaussLegendre;
use turbid_analytic::slab_single::single_radiance;
use turbid_analytic::{AnisotropicMedium, AnisotropicSlab, Incidence, IsotropicSlab, Phase, Value};

/// The table, made by adding and doubling in 100-bit arithmetic, has `digits` correct digits: a deviation of
/// 10^-(digits-1) of the value is allowed, and the bound must cover it but for the table's own last digits.
#[test]
fn every_row_is_reproduced_within_its_digits_and_within_the_bound() {
    let mut slabs: HashMap<[String; 4], AnisotropicSlab> = HashMap::new();
    for row in rows("slab_hg_flux.csv", 208) {
        let number = |name: &str| number(&row, name);
        let slab = slabs.entry(["tau", "w", "g", "mu0"].map(|name| row[name].clone())).or_insert_with(|| {
            AnisotropicSlab::new(number("tau"), number("w"), number("g"), incidence(&row["mu0"])).unwrap()
        });
        let got = match row["quantity"].as_str() {
            "R" => slab.reflectance(),
            "T_total" => slab.transmittance(),
            "A" => slab.absorptance(),
            "fluence" => slab.fluence(number("t")).unwrap(),
            other => panic!("{other}"),
        };
        check_to(&row, got, 2.0);
        assert!(got.error < 1e-9 * number("value"), "{row:?}: {got:?}");
    }
}

/// Two solvers that share nothing but the problem.
#[test]
fn at_g_zero_it_is_the_isotropic_slab() {
    for (tau, albedo) in [(1e-3, 0.9), (0.1, 0.5), (1.0, 1.0), (2.0, 0.9), (10.0, 0.999_999), (100.0, 0.99)] {
        for light in [beam(1.0), beam(0.3), beam(1e-3), Incidence::Diffuse] {
            let ours = AnisotropicSlab::new(tau, albedo, 0.0, light).unwrap();
            let theirs = IsotropicSlab::new(tau, albedo, light).unwrap();
            let agree = |a: Value, b: Value| {
                let off = (a.value - b.value).abs();
                assert!(off <= a.error + b.error, "{tau} {albedo} {light:?}: {a:?} {b:?} differs by {off:e}");
            };
            agree(ours.reflectance(), theirs.reflectance());
            agree(ours.transmittance(), theirs.transmittance());
            agree(ours.transmittance_diffuse(), theirs.transmittance_diffuse());
            agree(ours.absorptance(), theirs.absorptance());
            for share in [0.0, 1e-9, 1e-7, 1e-5, 1e-3, 0.1, 0.5, 0.999, 1.0] {
                agree(ours.fluence(tau * share).unwrap(), theirs.fluence(tau * share).unwrap());
            }
        }
    }
}

/// At an albedo of 1e-10 light is scattered once, which is a closed form in the phase function itself, with no
/// Legendre series: R is its integral over the hemisphere, to 1e-10 of itself for what is scattered twice.
#[test]
fn weak_scattering_is_single_scattering() {
    let (tau, albedo) = (0.7, 1e-10);
    for g in [0.9, 0.75, -0.7] {
        for mu0 in [1.0, 0.4] {
            let slab = AnisotropicSlab::new(tau, albedo, g, beam(mu0)).unwrap();
            // The trapezium rule over half a period of an even function is exact to rounding with 400 points: the
            // phase function is analytic in the azimuth, with a strip of width near 1-|g|.
            let rule = GaussLegendre::new(160).unwrap();
            let hemisphere = |t: f64, sign: f64| {
                rule.integrate(0.0, 1.0, |x| {
                    // mu = x^2 smooths the face's e^(-tau/mu).
                    let mu = x * x;
                    let turn: f64 = (0..=400)
                        .map(|i| {
                            let ends = if i == 0 || i == 400 { 0.5 } else { 1.0 };
                            let dphi = PI * f64::from(i) / 400.0;
                            ends * single_radiance(tau, albedo, g, mu0, t, sign * mu, dphi).unwrap().value
                        })
                        .sum();
                    2.0 * x * mu * 2.0 * PI * turn / 400.0
                })
            };
            for (got, want) in [
                (slab.reflectance(), hemisphere(0.0, 1.0)),
                (slab.transmittance_diffuse(), hemisphere(tau, -1.0)),
            ] {
                let off = (got.value - want).abs();
                assert!(off < 1e-9 * want && off < got.error + 1e-9 * want, "{g} {mu0}: {got:?} {want:e}");
            }
        }
    }
}

#[test]
fn without_scattering_only_direct_light_is_left() {
    for light in [beam(1.0), beam(0.2), Incidence::Diffuse] {
        let slab = AnisotropicSlab::new(1.5, 0.0, 0.8, light).unwrap();
        assert!(slab.reflectance().covers(0.0) && slab.reflectance().error < 1e-13);
        assert!(slab.transmittance_diffuse().covers(0.0) && slab.transmittance_diffuse().error < 1e-13);
        let direct = direct_transmittance(light, 1.5).unwrap();
        assert_eq!(slab.transmittance_direct(), direct);
        assert!((slab.absorptance().value - (1.0 - direct.value)).abs() < 1e-13);
        for t in [0.0, 0.3, 1.5] {
            let (got, want) = (slab.fluence(t).unwrap(), uncollided_fluence(light, t).unwrap());
            assert!((got.value - want.value).abs() <= got.error + want.error && got.error < 1e-9, "{got:?}");
        }
    }
}

/// R + T + (1-w) int phi dt = 1 with phi asked depth by depth, on panels graded towards both faces: in the last
/// panels, of 1e-7, phi ~ c + t ln t leaves less than 1e-12 to the rule.
#[test]
fn the_fluence_accounts_for_what_is_lost() {
    let rule = GaussLegendre::new(16).unwrap();
    for (tau, albedo, g, light) in [
        (2.0, 0.9, 0.75, beam(1.0)),
        (2.0, 0.9, 0.75, beam(0.1)),
        (0.1, 0.5, 0.9, Incidence::Diffuse),
        (20.0, 0.99, -0.5, Incidence::Diffuse),
    ] {
        let slab = AnisotropicSlab::new(tau, albedo, g, light).unwrap();
        let mut edges = vec![0.0];
        let mut edge = 1e-7;
        while edge < 0.5 * tau {
            edges.push(edge);
            edge = (3.0 * edge).min(edge + 1.0);
        }
        let (mut integral, mut error) = (0.0, 0.0);
        edges.push(0.5 * tau);
        for pair in edges.windows(2) {
            for mirrored in [false, true] {
                integral += rule.integrate(pair[0], pair[1], |x| {
                    let v = slab.fluence(if mirrored { tau - x } else { x }).unwrap();
                    error += v.error * (pair[1] - pair[0]) / 16.0;
                    v.value
                });
            }
        }
        let (r, t, a) = (slab.reflectance(), slab.transmittance(), slab.absorptance());
        let off = (1.0 - albedo) * integral - a.value;
        assert!(
            off.abs() <= a.error + 2.0 * error + 1e-12,
            "{tau} {albedo} {g} {light:?}: {off:e} {error:e}"
        );
        assert!((r.value + t.value + a.value - 1.0).abs() <= r.error + t.error + a.error);
    }
}

/// phi(t) + phi(tau-t) = 4 under diffuse light without absorption, whatever the phase function: both faces lit make
/// an isotropic field.
#[test]
fn the_furnace_is_uniform() {
    for (tau, g) in [(0.01, 0.9), (1.0, -0.6), (3.0, 0.75), (60.0, 0.85)] {
        let slab = AnisotropicSlab::new(tau, 1.0, g, Incidence::Diffuse).unwrap();
        for share in [0.0, 1e-8, 1e-5, 1e-2, 0.3, 0.5] {
            let (a, b) = (slab.fluence(share * tau).unwrap(), slab.fluence(tau - share * tau).unwrap());
            let off = a.value + b.value - 4.0;
            assert!(off.abs() <= a.error + b.error && a.error < 1e-9, "{tau} {g} {share}: {off:e} {a:?}");
        }
    }
}

/// Without absorption the fluence deep inside falls by 3 (1-g) T per mean free path, exactly, and the isotropic slab
/// of thickness 100 under diffuse light transmits (4/3)/(tau + 2 q), q Milne's extrapolation length.
#[test]
fn thick_slabs_without_absorption_diffuse() {
    for g in [0.0, 0.5, -0.5] {
        let slab = AnisotropicSlab::new(100.0, 1.0, g, beam(0.7)).unwrap();
        let (a, b) = (slab.fluence(42.0).unwrap(), slab.fluence(58.0).unwrap());
        let want = 3.0 * (1.0 - g) * slab.transmittance().value;
        let off = (a.value - b.value) / 16.0 - want;
        assert!(off.abs() <= (a.error + b.error) / 16.0 + 3.0 * slab.transmittance().error, "{g} {off:e}");
    }
    let slab = AnisotropicSlab::new(100.0, 1.0, 0.0, Incidence::Diffuse).unwrap();
    let want = (4.0 / 3.0) / (100.0 + 2.0 * 0.710_446_089_598_763_1);
    assert!(slab.transmittance().covers(want), "{:?} {want}", slab.transmittance());
    assert!(slab.transmittance().error < 1e-12 * want);
}

/// Through a thick absorbing slab light falls by e^(-k) per mean free path, and 1e-23 of it keeps its digits.
/// Isotropic scattering, w = 0.9: w atanh(k)/k = 1, k = 0.525; all else is gone by e^(-60 (1-k)) = 4e-13 at 60.
#[test]
fn little_light_is_known_well() {
    let mut k = 0.5;
    for _ in 0..200 {
        // A contraction near its root.
        k = libm::tanh(k / 0.9);
    }
    let t = |tau: f64| AnisotropicSlab::new(tau, 0.9, 0.0, beam(1.0)).unwrap().transmittance();
    let (thin, thick) = (t(60.0), t(100.0));
    assert!(thick.value < 1e-22 && thick.error < 1e-11 * thick.value, "{thick:?}");
    assert!((thick.value / thin.value * exp(40.0 * k) - 1.0).abs() < 1e-11, "{thin:?} {thick:?} {k}");
}

/// Peaks, by adding and doubling in double precision on 740 nodes (280 at 0.95), with the azimuthal mean of the phase function itself
/// between them, from a layer of 1e-14: thickness 1e4/2^n; albedo; g; mu0, or 0 for diffuse light; R, diffuse T, fluence in the
/// middle and on the lit face. They are good to 3e-10 of themselves.
const PEAKS: [(i32, f64, f64, f64, [f64; 4]); 17] = [
    (13, 0.9, 0.99, 1.0, [1.7176176360e-03, 5.8706941247e-01, 9.5207829317e-01, 1.0062916730e+00]),
    (13, 0.9, 0.99, 0.1, [1.0381282019e-01, 2.5953697351e-01, 4.4176453059e+00, 1.1005399081e+01]),
    (13, 0.9, 0.99, 0.0, [9.3272680566e-03, 6.2720119886e-01, 1.6148937575e+00, 2.0731017260e+00]),
    (7, 0.9, 0.99, 0.5, [1.6667083536e-02, 6.3424502553e-06, 1.4699638941e-03, 2.0552230937e+00]),
    (7, 0.9, 0.99, 0.0, [1.6490438231e-02, 3.0113488031e-05, 5.3365374607e-03, 2.0901204032e+00]),
    (13, 1.0, 0.99, 1.0, [2.6250338303e-03, 7.0235231000e-01, 1.0191430933e+00, 1.0113996992e+00]),
    (7, 1.0, 0.99, 0.1, [7.3199458509e-01, 2.6800541488e-01, 1.0276214427e+00, 1.3954012024e+01]),
    (7, 1.0, 0.99, 0.0, [3.9630828910e-01, 6.0369171087e-01, 2.0000000000e+00, 2.9827032390e+00]),
    (40, 0.9, 0.99, 0.5, [8.0819859694e-11, 1.6290084605e-08, 2.0000000022e+00, 2.0000000038e+00]),
    (24, 0.9, 0.99, 1.0, [1.1217365228e-06, 5.3514326875e-04, 9.9998691811e-01, 1.0000136771e+00]),
    (24, 0.9, 0.99, 0.1, [1.6026484141e-04, 5.1860650991e-03, 1.0006380628e+01, 1.0008285614e+01]),
    (24, 0.9, -0.95, 0.0, [1.0075835893e-03, 6.2364195163e-05, 1.9994840868e+00, 2.0058301681e+00]),
    (13, 0.9, -0.95, 1.0, [4.6662807677e-01, 1.1670568593e-01, 1.0043031604e+00, 1.5106922152e+00]),
    (7, 0.9, -0.95, 0.5, [6.0849995498e-01, 2.5902365166e-21, 6.8295742706e-11, 3.3102877766e+00]),
    (24, 0.9, 0.95, 0.0, [6.1728056609e-05, 1.0082197089e-03, 1.9994845647e+00, 2.0025840114e+00]),
    (13, 0.9, 0.95, 1.0, [9.6807144236e-03, 5.7418704827e-01, 9.9647169699e-01, 1.0301032516e+00]),
    (7, 0.9, 0.95, 0.1, [3.0703431090e-01, 2.7274193567e-07, 3.1839877393e-04, 1.2242520234e+01]),
];

#[test]
fn peaks_are_what_adding_and_doubling_makes_of_them() {
    let mut media: Vec<(f64, f64, AnisotropicMedium)> = vec![];
    for (halvings, albedo, g, mu0, want) in PEAKS {
        let tau = 1e4 / pow(2.0, f64::from(halvings));
        let light = if mu0 == 0.0 { Incidence::Diffuse } else { beam(mu0) };
        if !media.iter().any(|m| (m.0, m.1) == (albedo, g)) {
            let phase = Phase::henyey_greenstein(g).unwrap();
            media.push((albedo, g, AnisotropicMedium::new(albedo, &phase).unwrap()));
        }
        let medium = &media.iter().find(|m| (m.0, m.1) == (albedo, g)).unwrap().2;
        let slab = medium.slab(tau, light).unwrap();
        let got = [
            slab.reflectance(),
            slab.transmittance_diffuse(),
            slab.fluence(0.5 * tau).unwrap(),
            slab.fluence(0.0).unwrap(),
        ];
        for (got, want) in got.into_iter().zip(want) {
            let off = (got.value - want).abs();
            assert!(
                off <= got.error + 3e-10 * want,
                "{tau} {albedo} {g} {mu0}: {got:?} {want:e} off {off:e}"
            );
            assert!(
                got.error <= 1e-8 * want || got.error < 1e-12,
                "{tau} {albedo} {g} {mu0}: {got:?} {want:e}"
            );
        }
    }
}

/// Without absorption 1/T of a thick slab grows by (3/4) (1-g) per mean free path under diffuse light, and the light of a beam
/// is in a fixed proportion to it.
#[test]
fn thick_peaked_slabs_obey_their_law() {
    let g = 0.99;
    let medium = AnisotropicMedium::new(1.0, &Phase::henyey_greenstein(g).unwrap()).unwrap();
    let t = |tau: f64, light: Incidence| {
        let v = medium.slab(tau, light).unwrap().transmittance();
        (v.value, v.error / v.value)
    };
    let mut last: Option<[f64; 4]> = None;
    for tau in [1e4, 1e6, 1e9] {
        let (diffuse, bound) = t(tau, Incidence::Diffuse);
        let mut escape = [1.0 / diffuse - 0.75 * (1.0 - g) * tau, 0.0, 0.0, 0.0];
        let mut bounds = [bound / diffuse + 4.0 * f64::EPSILON / diffuse, 0.0, 0.0, 0.0];
        for (i, mu0) in [1.0, 0.5, 0.1].into_iter().enumerate() {
            let (value, error) = t(tau, beam(mu0));
            assert!(error < 1e-8, "{tau} {mu0}: {error:e}");
            escape[i + 1] = value / diffuse;
            bounds[i + 1] = 2.0 * (error + bound) * escape[i + 1];
        }
        if let Some(last) = last {
            for i in 0..4 {
                let off = (escape[i] - last[i]).abs();
                assert!(off < bounds[i] + 1e-9, "{tau} {i}: {} {} {:e}", escape[i], last[i], bounds[i]);
            }
        }
        last = Some(escape);
    }
}

/// Similar slabs (g' = 0, tau' = (1-g) tau, no absorption) are alike, not equal: here by 1.4 per cent.
#[test]
fn similarity_is_not_exact() {
    let real = AnisotropicSlab::new(20.0, 1.0, 0.85, beam(1.0)).unwrap().transmittance().value;
    let alike = AnisotropicSlab::new(3.0, 1.0, 0.0, beam(1.0)).unwrap().transmittance().value;
    assert!((alike / real - 1.0 + 0.014).abs() < 0.001, "{real} {alike}");
}

/// Beams of all directions make diffuse light: 2 int mu R(mu) dmu = R_diffuse.
#[test]
fn beams_add_up_to_diffuse_light() {
    let (tau, albedo, g) = (1.5, 0.8, 0.75);
    let diffuse = AnisotropicSlab::new(tau, albedo, g, Incidence::Diffuse).unwrap();
    let answers = |mu0: f64| {
        let slab = AnisotropicSlab::new(tau, albedo, g, beam(mu0)).unwrap();
        [slab.reflectance(), slab.transmittance_diffuse(), slab.fluence(0.5).unwrap()].map(|v| v.value)
    };
    // R(mu) behaves like mu ln mu at grazing incidence, which mu = x^3 smooths; a fraction mu^2 = 1e-8 of all light
    // comes in lower than x starts.
    let start: f64 = 0.0464;
    let lowest = start.powi(3);
    let mut sum = answers(lowest).map(|v| lowest * lowest * v);
    let rule = GaussLegendre::new(48).unwrap();
    for (x, w) in rule.nodes.iter().zip(&rule.weights) {
        let x = start + (1.0 - start) * x;
        let weight = (1.0 - start) * w * 6.0 * x.powi(5);
        for (sum, v) in sum.iter_mut().zip(answers(x * x * x)) {
            *sum += weight * v;
        }
    }
    // Taking the lowest light for one direction errs by the slope of R, ln(1e-4), times 1e-4 times 1e-8.
    let want = [diffuse.reflectance(), diffuse.transmittance_diffuse(), diffuse.fluence(0.5).unwrap()];
    for (got, want) in sum.iter().zip(want) {
        assert!((got - want.value).abs() < 1e-11 + want.error, "{got} {want:?}");
    }
}

/// A thin slab under straight light reflects R = w b tau + tau^2 (a + c ln tau) + ..., b the backward fraction of the
/// phase function. Thicknesses of 1, 2 and 4e-3 determine b, a and c; of the next term, tau^3 ln^2 tau, 6e-5 tau is left.
#[test]
fn thin_slabs_reflect_the_backward_fraction() {
    for g in [0.75, 0.5, -0.6] {
        let b = (1.0 - g) / (2.0 * g) * ((1.0 + g) / sqrt(1.0 + g * g) - 1.0);
        let per_tau =
            |tau: f64| AnisotropicSlab::new(tau, 0.9, g, beam(1.0)).unwrap().reflectance().value / tau;
        let (one, two, four) = (per_tau(1e-3), per_tau(2e-3), per_tau(4e-3));
        // tau and tau ln tau vanish from 4 f(1) - 4 f(2) + f(4).
        let got = 4.0 * one - 4.0 * two + four;
        assert!((got / (0.9 * b) - 1.0).abs() < 1e-4, "{g} {got:e} {b}");
    }
}

#[test]
fn what_is_not_known_is_refused() {
    for (tau, albedo, g, mu0, name) in [
        (9e-13, 0.5, 0.5, 1.0, "tau"),
        (1.1e9, 0.5, 0.5, 1.0, "tau"),
        (f64::NAN, 0.5, 0.5, 1.0, "tau"),
        (1.0, 1.1, 0.5, 1.0, "albedo"),
        (1.0, -0.1, 0.5, 1.0, "albedo"),
        (1.0, 0.5, 0.991, 1.0, "g"),
        (1.0, 0.5, -0.951, 1.0, "g"),
        (1.0, 0.5, f64::NAN, 1.0, "g"),
        (1.0, 0.5, 0.5, 0.0, "mu0"),
        (1.0, 0.5, 0.5, 1.5, "mu0"),
    ] {
        let error = AnisotropicSlab::new(tau, albedo, g, beam(mu0)).err().unwrap().to_string();
        assert!(error.starts_with(&format!("{name} is ")), "{error}");
    }
    let slab = AnisotropicSlab::new(1.0, 0.5, 0.5, beam(1.0)).unwrap();
    assert!(slab.fluence(-0.1).is_err() && slab.fluence(1.1).is_err() && slab.fluence(f64::NAN).is_err());
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 70,
        rng_seed: proptest::test_runner::RngSeed::Fixed(20_260_103),
        failure_persistence: None,
        ..ProptestConfig::default()
    })]

    /// R + T + A = 1 within the bounds, nothing negative, and no more light than came in anywhere it is counted.
    #[test]
    fn photons_are_conserved(
        tau in (-3.0..2.0_f64).prop_map(|x| pow(10.0, x)),
        albedo in prop_oneof![0.0..=1.0_f64, Just(0.0), Just(1.0), (-300.0..0.0_f64).prop_map(|x| pow(10.0, x))],
        g in prop_oneof![-0.95..=0.95_f64, Just(0.95), Just(0.0), (-300.0..-1.0_f64).prop_map(|x| -pow(10.0, x))],
        light in prop_oneof![
            Just(Incidence::Diffuse),
            Just(beam(1.0)),
            (-5.0..0.0_f64).prop_map(|x| beam(pow(10.0, x))),
        ],
        share in 0.0..=1.0_f64,
    ) {
        let slab = AnisotropicSlab::new(tau, albedo, g, light).unwrap();
        let (r, t, a) = (slab.reflectance(), slab.transmittance(), slab.absorptance());
        let off = (r.value + t.value + a.value - 1.0).abs();
        prop_assert!(off <= r.error + t.error + a.error, "{r:?} {t:?} {a:?} {off:e}");
        prop_assert!(off < 1e-12, "{off:e}");
        for v in [r, t, a, slab.transmittance_diffuse()] {
            prop_assert!(v.value >= -v.error && v.value <= 1.0 + v.error, "{v:?}");
            prop_assert!(v.error <= 1e-9 * v.value.abs() || v.error < 1e-12, "{v:?}");
        }
        let phi = slab.fluence(share * tau).unwrap();
        prop_assert!(phi.value >= 0.0 && phi.error <= 1e-7 * phi.value + 1e-300, "{phi:?}");
    }
}
