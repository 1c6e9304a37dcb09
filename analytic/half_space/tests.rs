use super::*;
use crate::{IsotropicSlab, quadrature::GaussLegendre};

const ALBEDOS: [f64; 9] = [0.0, 1e-6, 0.05, 0.1, 0.3, 0.5, 0.9, 0.999_999, 1.0];

/// The other method: 1/H = sqrt(1-w) + (w/2) int m H(m)/(mu+m) dm, iterated on a rule graded towards mu = 0, each
/// step averaged with the last.
fn iterated(albedo: f64) -> Vec<(f64, f64)> {
    let rule = GaussLegendre::new(24).unwrap();
    let mut nodes = Vec::new();
    for i in 0..=13 {
        let (low, high) =
            (if i == 13 { 0.0 } else { libm::ldexp(1.0, -2 * i - 2) }, libm::ldexp(1.0, -2 * i));
        nodes.extend(
            rule.nodes.iter().zip(&rule.weights).map(|(x, w)| (low + (high - low) * x, (high - low) * w)),
        );
    }
    let root = (1.0 - albedo).sqrt();
    let mut h = vec![1.0; nodes.len()];
    for _ in 0..60 {
        let next: Vec<f64> = nodes
            .iter()
            .map(|&(mu, _)| {
                let sum: f64 = nodes.iter().zip(&h).map(|(&(m, w), h)| w * m * h / (mu + m)).sum();
                1.0 / (root + 0.5 * albedo * sum)
            })
            .collect();
        h = h.iter().zip(&next).map(|(a, b)| 0.5 * (a + b)).collect();
    }
    nodes.iter().zip(h).map(|(&(mu, _), h)| (mu, h)).collect()
}

#[test]
fn two_methods_agree_on_h() {
    for albedo in ALBEDOS {
        let space = HalfSpace::new(albedo).unwrap();
        for (mu, h) in iterated(albedo).into_iter().step_by(5) {
            let got = space.h(mu).unwrap();
            // The rule integrates H m/(mu+m) to about 1e-14.
            assert!((got.value / h - 1.0).abs() < 5e-14, "w {albedo} mu {mu}: {got:?} {h}");
            assert!(got.error < 1e-14 * got.value);
        }
    }
}

/// H and R at the ends of the range of albedos, from the Fock integral with 30 digits.
#[test]
fn known_values_at_the_extremes() {
    for (w, mu, h, r) in [
        (1e-6, 1e-4, 1.000000000460522, 4.995396031772175e-7),
        (1e-6, 0.3, 1.0000002199506557, 2.800495793218616e-7),
        (1e-6, 1.0, 1.0000003465737912, 1.5342650699343306e-7),
        (0.999_999, 1e-4, 1.000567243061598, 0.998999432756924),
        (0.999_999, 0.3, 1.6416689150214916, 0.9983583310849549),
        (0.999_999, 1.0, 2.9027819233470624, 0.9970972180766112),
    ] {
        let space = HalfSpace::new(w).unwrap();
        let got = space.h(mu).unwrap();
        assert!(got.covers(h), "{w} {mu} {got:?}");
        let got = space.reflectance(Incidence::Beam { mu0: mu }).unwrap();
        assert!(got.covers(r) && got.error < 1e-13 * r, "{w} {mu} {got:?}");
    }
}

/// 25 digits of the Fock integral, rounded.
#[test]
fn known_values() {
    let h = |mu, w| h_function(mu, w).unwrap();
    assert!(h(1.0, 1.0).covers(2.907_810_529_078_606), "{:?}", h(1.0, 1.0));
    assert!(h(0.1, 0.5).covers(1.072_368_762_029_909_1));
    assert!(h(0.5, 0.9).covers(1.556_033_802_021_362_6));
    let hopf = hopf_constant();
    assert!(hopf.covers(0.710_446_089_598_763_1) && hopf.error < 1e-14, "{hopf:?}");
    let last = HalfSpace::new(1.0).unwrap().h(1e7).unwrap();
    // H = sqrt 3 (mu + q) + O(1/mu).
    assert!((last.value / (3f64.sqrt() * (1e7 + hopf.value)) - 1.0).abs() < 1e-13);
}

#[test]
fn moments_in_closed_form() {
    for albedo in ALBEDOS {
        let space = HalfSpace::new(albedo).unwrap();
        let (zeroth, by_rule) = (
            space.moment(0).unwrap(),
            over_face(|mu| {
                let h = space.h.h(mu);
                (h.value, h.error)
            }),
        );
        assert!(
            (zeroth.value - by_rule.value).abs() < zeroth.error + by_rule.error,
            "{zeroth:?} {by_rule:?}"
        );
        // The mean of R over the face, and 1 - R.
        let r = space.reflectance(Incidence::Diffuse).unwrap();
        let a = space.absorptance(Incidence::Diffuse).unwrap();
        assert!((r.value + a.value - 1.0).abs() <= r.error + a.error + f64::EPSILON, "{albedo} {r:?} {a:?}");
    }
    let white = HalfSpace::new(1.0).unwrap().moment(1).unwrap();
    assert!(white.covers(2.0 / 3f64.sqrt()), "{white:?}");
}

/// R = (w/2) (1 - mu ln(1 + 1/mu)) for small w.
#[test]
fn weak_scattering_keeps_its_digits() {
    let w = 1e-12;
    let space = HalfSpace::new(w).unwrap();
    for mu0 in [1e-3, 0.5, 1.0] {
        let r = space.reflectance(Incidence::Beam { mu0 }).unwrap();
        let single = 0.5 * w * (1.0 - mu0 * log1p(1.0 / mu0));
        assert!((r.value / single - 1.0).abs() < 1e-11 && r.error < 3e-14 * r.value, "{r:?} {single:e}");
    }
}

#[test]
fn the_two_forms_of_the_extrapolation_length_agree() {
    for albedo in [0.4, 0.5, 0.7, 0.9, 0.99, 0.999_9] {
        let space = HalfSpace::new(albedo).unwrap();
        let (a, b) = (space.length_by_h(), length_by_spectrum(albedo, &space.decay));
        assert!((a.value - b.value).abs() <= a.error + b.error, "{albedo} {a:?} {b:?}");
        assert!(b.error < 1e-13);
    }
    // albedo -> 0.
    let z = HalfSpace::new(1e-3).unwrap().extrapolation_length().unwrap().value;
    assert!((1e-3 * z - 1.0).abs() < 5e-3, "{z}");
}

/// A slab of thickness 60 is a half-space to e^-62 at albedo 0.9 (decay 0.525 a mean free path, both ways).
#[test]
fn thick_slabs_solved_in_depth() {
    for albedo in [0.3, 0.9] {
        let space = HalfSpace::new(albedo).unwrap();
        for incidence in [Incidence::Beam { mu0: 1.0 }, Incidence::Beam { mu0: 0.05 }, Incidence::Diffuse] {
            let slab = IsotropicSlab::new(60.0, albedo, incidence).unwrap();
            let same = |name: &str, a: Value, b: Value| {
                let off = (a.value - b.value).abs();
                assert!(off <= a.error + b.error, "{albedo} {incidence:?} {name}: {a:?} {b:?}");
                assert!(a.error < 1e-12 * a.value.max(1e-3), "{albedo} {incidence:?} {name}: {a:?}");
            };
            same("R", space.reflectance(incidence).unwrap(), slab.reflectance());
            same("A", space.absorptance(incidence).unwrap(), slab.absorptance());
            for t in [0.0, 1e-9, 1e-3, 0.1, 1.0, 4.0, 20.0] {
                same(&format!("phi({t})"), space.fluence(incidence, t).unwrap(), slab.fluence(t).unwrap());
            }
            for mu in [0.0, 0.1, 1.0] {
                same("radiance", space.radiance(incidence, mu).unwrap(), slab.radiance(0.0, mu).unwrap());
            }
        }
    }
}

#[test]
fn laws_of_the_face_and_of_the_depth() {
    for albedo in ALBEDOS {
        let space = HalfSpace::new(albedo).unwrap();
        for incidence in [Incidence::Beam { mu0: 1.0 }, Incidence::Beam { mu0: 0.01 }, Incidence::Diffuse] {
            let close = |what: &str, a: Value, b: f64| {
                assert!(
                    (a.value - b).abs() <= a.error + 1e-14 * b.abs(),
                    "{albedo} {incidence:?} {what}: {a:?} {b}"
                );
            };
            // The net flux through the face is what is absorbed, the fluence there H(mu0)/mu0.
            close("flux", space.flux(incidence, 0.0).unwrap(), space.absorptance(incidence).unwrap().value);
            let face = match incidence {
                Incidence::Beam { mu0 } => space.h(mu0).unwrap().value / mu0,
                Incidence::Diffuse => 4.0 / (1.0 + (1.0 - albedo).sqrt()),
            };
            close("fluence", space.fluence(incidence, 0.0).unwrap(), face);
            // dF/dt = -(1-w) phi over one panel.
            let rule = GaussLegendre::new(24).unwrap();
            let (a, b) = (1.0, 1.5);
            let lost = (1.0 - albedo) * rule.integrate(a, b, |t| space.fluence(incidence, t).unwrap().value);
            let [fa, fb] = [a, b].map(|t| space.flux(incidence, t).unwrap());
            assert!(
                (fa.value - fb.value - lost).abs() <= fa.error + fb.error + 1e-14 * lost,
                "{albedo} {incidence:?}"
            );
        }
    }
    let white = HalfSpace::new(1.0).unwrap();
    let deep = white.fluence(Incidence::Beam { mu0: 0.3 }, 1e6).unwrap();
    assert!(deep.covers(3f64.sqrt() * white.h(0.3).unwrap().value), "{deep:?}");
    assert!(white.fluence(Incidence::Diffuse, 3.0).unwrap().covers(4.0));
}

/// Milne's problem: one unit leaves, dF/dt = -(1-w) phi, and far inside the field extrapolates to -z0.
#[test]
fn milne() {
    let rule = GaussLegendre::new(24).unwrap();
    for albedo in [0.8, 0.9, 0.999_999, 1.0] {
        let space = HalfSpace::new(albedo).unwrap();
        let leaving = over_face(|mu| {
            let l = space.milne_radiance(mu).unwrap();
            (2.0 * PI * mu * l.value, 2.0 * PI * mu * l.error)
        });
        assert!(leaving.covers(1.0) && leaving.error < 1e-12, "{albedo} {leaving:?}");
        let at_face = over_face(|mu| {
            let l = space.milne_radiance(mu).unwrap();
            (2.0 * PI * l.value, 2.0 * PI * l.error)
        });
        let face = space.milne_fluence(0.0).unwrap();
        assert!((face.value - at_face.value).abs() < face.error + at_face.error, "{face:?} {at_face:?}");
        let (k, z) = (space.decay().value, space.extrapolation_length().unwrap().value);
        let shape = |t: f64| if k == 0.0 { t + z } else { libm::sinh(k * (t + z)) };
        let [near, far] = [36.0, 40.0].map(|t| space.milne_fluence(t).unwrap().value);
        // The transient is e^-36 of the growing mode or less.
        assert!((near / far * shape(40.0) / shape(36.0) - 1.0).abs() < 1e-13, "{albedo}");
        // Fluence and flux: the flux grows inward as light is absorbed on its way out; its value at depth 2 from the
        // deep shape is compared by integrating over the transient.
        let grown = (1.0 - albedo)
            * (0..40)
                .map(|i| {
                    let t = f64::from(i);
                    if i == 0 {
                        // t ln t at the face: panels that shrink.
                        (0..40)
                            .map(|j| {
                                rule.integrate(
                                    if j == 39 { 0.0 } else { libm::ldexp(1.0, -j - 1) },
                                    libm::ldexp(1.0, -j),
                                    |t| space.milne_fluence(t).unwrap().value,
                                )
                            })
                            .sum::<f64>()
                    } else {
                        rule.integrate(t, t + 1.0, |t| space.milne_fluence(t).unwrap().value)
                    }
                })
                .sum::<f64>();
        // Deep inside flux = (1-w)/k coth(k (t+z)) phi, or phi/(3 (t+z)).
        let ratio =
            if k == 0.0 { 1.0 / (3.0 * (40.0 + z)) } else { (1.0 - albedo) / k / libm::tanh(k * (40.0 + z)) };
        assert!((far * ratio / (1.0 + grown) - 1.0).abs() < 1e-12, "{albedo}");
    }
}
