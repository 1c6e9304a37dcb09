//! What only the inside can see: the bounds against a third set of nodes, decay lengths, resonances.

use super::modes::Modes;
use super::nodes::Nodes;
use super::scattering::Scattering;
use super::solution::Solution;
use super::*;
use libm::log;
use proptest::prelude::*;
use std::sync::Arc;

fn modes(albedo: f64, g: f64, nodes: Nodes) -> Arc<Modes> {
    let phase = Phase::henyey_greenstein(g).unwrap();
    let scattering = Scattering::new(albedo, &phase, nodes.degree, false);
    Arc::new(Modes::new(Arc::new(scattering), Arc::new(nodes), 0).unwrap())
}

/// The slab on nodes finer than any in use.
fn finer(tau: f64, albedo: f64, g: f64, incidence: Incidence) -> Solution {
    let moments = if g == 0.0 { 0.0 } else { log(1e-14) / log(g.abs()) };
    let modes = modes(albedo, g, Nodes::new((0.5 * moments) as usize + 40, 96));
    Solution::new(tau, incidence, modes).unwrap()
}

/// All answers of the slab lie within their bounds of those of the finer one; returns the largest bound.
fn covered(slab: &AnisotropicSlab, finer: &Solution) -> std::result::Result<f64, String> {
    let mut largest = 0.0_f64;
    let mut check = |name: String, got: Value, truth: f64| {
        largest = largest.max(got.error / got.value.abs().max(1e-4));
        let off = (got.value - truth).abs();
        if off <= got.error { Ok(()) } else { Err(format!("{name}: {got:?}, finer {truth:e}, off {off:e}")) }
    };
    check("R".into(), slab.reflectance(), finer.reflectance().value)?;
    check("T".into(), slab.transmittance_diffuse(), finer.transmittance_diffuse().value)?;
    check("A".into(), slab.absorptance(), finer.absorptance().value)?;
    for i in 0..40 {
        let share = 0.5 * exp(-0.6 * f64::from(i));
        for t in [slab.tau * share, slab.tau - slab.tau * share] {
            let got = slab.fluence(t).map_err(|e| e.to_string())?;
            check(format!("phi({t:e})"), got, finer.fluence(t).value)?;
        }
    }
    Ok(largest)
}

proptest! {
    #![proptest_config(crate::fixed_cases(30))]

    /// The bound is earned: it covers what far more nodes make of the same slab, everywhere.
    #[test]
    fn bounds_cover_a_third_set_of_nodes(
        tau in (-3.0..2.0_f64).prop_map(|x| libm::pow(10.0, x)),
        albedo in prop_oneof![0.0..=1.0_f64, Just(1.0), (-12.0..0.0_f64).prop_map(|x| 1.0 - libm::pow(10.0, x))],
        g in prop_oneof![-0.9..=0.9_f64, Just(0.75), Just(0.9), Just(-0.9)],
        light in prop_oneof![
            Just(Incidence::Diffuse),
            Just(Incidence::Beam { mu0: 1.0 }),
            (0.05..1.0_f64).prop_map(|mu0| Incidence::Beam { mu0 }),
            (-5.0..0.0_f64).prop_map(|x| Incidence::Beam { mu0: libm::pow(10.0, x) }),
        ],
    ) {
        let slab = AnisotropicSlab::new(tau, albedo, g, light).unwrap();
        let bound = covered(&slab, &finer(tau, albedo, g, light)).map_err(TestCaseError::fail)?;
        prop_assert!(bound < 1e-7, "{bound:e}");
    }
}

#[test]
fn the_ends_of_the_range_are_covered_too() {
    for (tau, g) in [(1e-3, 0.95), (2.0, -0.95), (100.0, 0.95)] {
        let light = Incidence::Beam { mu0: 0.6 };
        let slab = AnisotropicSlab::new(tau, 0.99, g, light).unwrap();
        let bound = covered(&slab, &finer(tau, 0.99, g, light)).unwrap();
        assert!(bound < 1e-7, "{tau} {g} {bound:e}");
    }
}

/// The slowest decay is the root of h_0 = k^2/(h_1 - 4 k^2/(h_2 - 9 k^2/...)), h_l = (2l+1)(1 - w g^l) (van de Hulst
/// 1980, section 5.2), an equation without directions.
#[test]
fn the_slowest_decay_obeys_the_continued_fraction() {
    for (albedo, g) in
        [(0.9, 0.0), (0.5, 0.3), (0.9, 0.75), (0.99, 0.85), (0.999, 0.9), (0.99, 0.95), (0.9, -0.7)]
    {
        let moments = if g == 0.0 { 0.0 } else { log(1e-13) / log(f64::abs(g)) };
        let modes = modes(albedo, g, Nodes::new((0.5 * moments) as usize + 32, 40));
        let k = modes.slowest();
        let defect = |k: f64| {
            let h = |l: i32| (2.0 * f64::from(l) + 1.0) * (1.0 - albedo * g.powi(l));
            let tail = (1..2000).rev().fold(0.0, |tail, l| f64::from(l).powi(2) * k * k / (h(l) - tail));
            h(0) - tail
        };
        // Newton's step from our k is its error.
        let h = 1e-6 * k;
        let step = defect(k) * 2.0 * h / (defect(k + h) - defect(k - h));
        assert!((step / k).abs() < 1e-13, "{albedo} {g}: k {k} differs by {step:e}");
    }
}

/// 1/mu0 equal to a decay, or mu0 equal to a node, is a direction like any other.
#[test]
fn resonances_lose_nothing() {
    let (tau, albedo, g) = (2.0, 0.9, 0.75);
    let medium = AnisotropicMedium::new(albedo, &Phase::henyey_greenstein(g).unwrap()).unwrap();
    let modes = medium.modes(0, 0).unwrap();
    let directions: Vec<f64> = modes.nodes.mu.iter().copied().filter(|mu| *mu > 0.01).step_by(7).collect();
    let decays = modes.k.iter().filter(|k| **k > 1.0 && **k < 100.0).step_by(5).map(|k| 1.0 / k);
    let mut count = 0;
    for mu0 in decays.chain(directions) {
        let light = Incidence::Beam { mu0 };
        let slab = AnisotropicSlab::new(tau, albedo, g, light).unwrap();
        let bound = covered(&slab, &finer(tau, albedo, g, light)).unwrap();
        assert!(bound < 1e-9, "{mu0} {bound:e}");
        count += 1;
    }
    assert!(count >= 10, "{count}");
}

/// On a node the integral along the ray is the light in that node, of every order of azimuth.
#[test]
fn rays_on_nodes_are_the_nodes() {
    for (tau, albedo, g, order) in [
        (1.0, 1.0, 0.5, 0),
        (1e-3, 0.9, 0.5, 0),
        (40.0, 0.9, 0.75, 0),
        (2.0, 0.9, 0.75, 3),
        (0.1, 1.0, -0.6, 1),
        (f64::INFINITY, 0.99, 0.6, 0),
        (f64::INFINITY, 1.0, 0.6, 2),
    ] {
        let medium = AnisotropicMedium::new(albedo, &Phase::henyey_greenstein(g).unwrap()).unwrap();
        let modes = medium.modes(1, order).unwrap();
        let lights = [Incidence::Beam { mu0: 0.6 }, Incidence::Beam { mu0: 1.0 }, Incidence::Diffuse];
        for light in &lights[..if order == 0 { 3 } else { 2 }] {
            let s = Solution::new(tau, *light, modes.clone()).unwrap();
            for t in [0.0, 0.3, 0.9].map(|share| share * tau.min(5.0)) {
                for i in (0..modes.nodes.len()).step_by(6) {
                    let mu = modes.nodes.mu[i];
                    let source = modes.source(mu);
                    let [up, down] = [mu, -mu].map(|mu| s.last_scattered(t, mu, &source));
                    let [p, q] = s.light(i, t);
                    // The beam's own light, and what enters, is not scattered last by the modes.
                    let once = match *light {
                        Incidence::Beam { mu0 } => [1.0, -1.0].map(|sign| {
                            let terms = super::nodes::legendre(order, s.modes.scattering.degree(), mu)
                                .into_iter()
                                .zip(super::nodes::legendre(order, s.modes.scattering.degree(), mu0));
                            let turns = if order == 0 { 1.0 } else { 2.0 };
                            let phase: f64 = terms
                                .enumerate()
                                .map(|(n, (a, b))| {
                                    let l = n + order;
                                    // The direction of the beam is -mu0.
                                    let parity = if sign > 0.0 && n % 2 == 1 { -1.0 } else { 1.0 };
                                    (2 * l + 1) as f64 * s.modes.scattering.moments[l] * a * b * parity
                                })
                                .sum::<f64>()
                                * turns
                                / (4.0 * std::f64::consts::PI);
                            albedo * phase * crate::slab_single::beam_path(tau, mu0, t, sign * mu)
                        }),
                        Incidence::Diffuse => [0.0, exp(-t / mu) / std::f64::consts::PI],
                    };
                    let scale = up.magnitude + down.magnitude + once[0].abs() + once[1].abs();
                    for (got, want) in [(up.value + once[0], p + q), (down.value + once[1], p - q)] {
                        let off = got - 0.5 * want;
                        assert!(
                            off.abs() < 1e-11 * scale.max(1e-3),
                            "{tau} {g} {order} {light:?} t {t} mu {mu}: {got:e} {:e}",
                            0.5 * want
                        );
                    }
                }
            }
        }
    }
}

/// Radiances lie within their bounds of those of a series to which no moment is lost, on more nodes.
#[test]
fn bounds_of_radiances_cover_plain_series_on_more_nodes() {
    for (tau, albedo, g) in [(1.0, 0.9, 0.6), (0.01, 1.0, -0.5), (20.0, 0.99, 0.5), (3.0, 0.7, 0.8)] {
        let phase = Phase::henyey_greenstein(g).unwrap();
        let nodes = Arc::new(Nodes::new(2 + phase.degree(1e-13, 1000) / 2, 44));
        let scattering = Arc::new(Scattering::new(albedo, &phase, nodes.degree, false));
        let mu0 = 0.55;
        let light = Incidence::Beam { mu0 };
        let slab = AnisotropicSlab::new(tau, albedo, g, light).unwrap();
        // Terms of the series fall as the second power of the moments: light scattered once is not in it.
        let orders = phase.degree(3e-7, 1000);
        let solutions: Vec<Solution> = (0..=orders)
            .map(|m| {
                let modes = Arc::new(Modes::new(scattering.clone(), nodes.clone(), m).unwrap());
                Solution::new(tau, light, modes).unwrap()
            })
            .collect();
        for share in [0.0, 1e-3, 0.4, 1.0] {
            for mu in [1.0, 0.6, 0.05, 1e-4, -1e-3, -0.3, -0.55, -0.9] {
                for dphi in [0.0, 0.5, 2.5] {
                    let t = share * tau;
                    let got = slab.radiance(t, mu, dphi).unwrap();
                    let once = crate::slab_single::single_radiance(tau, albedo, g, mu0, t, mu, dphi).unwrap();
                    let rest: f64 = solutions
                        .iter()
                        .map(|s| {
                            let source = s.modes.source(f64::abs(mu));
                            s.last_scattered(t, mu, &source).value * libm::cos(s.modes.order as f64 * dphi)
                        })
                        .sum();
                    let (want, off) = (once.value + rest, (got.value - once.value - rest).abs());
                    assert!(
                        off <= got.error + 1e-12 * want,
                        "{tau} {g} {t} {mu} {dphi}: {got:?} {want:e} {off:e}"
                    );
                    assert!(got.error < 1e-8 * got.value + 1e-14, "{tau} {g} {t} {mu} {dphi}: {got:?}");
                }
            }
        }
    }
}

/// Slabs far thinner than the lowest nodes, scattering isotropically, against the integral equation: fluence and radiance within both bounds. The first
/// one, at its lit face, was 24 times the bounds off.
#[test]
fn the_thinnest_slabs_are_within_their_bounds() {
    let mut cases = vec![(3.37757149800944e-05, 0.6127988221751758, 0.9848402454752797)];
    for tau in [1e-12, 5e-10, 7e-9, 1e-7, 2e-6, 1e-4, 1e-3] {
        cases.extend([(tau, 0.54, 0.43), (tau, 0.99, 0.73), (tau, 0.84, 0.98)]);
    }
    for (tau, albedo, mu0) in cases {
        for incidence in [Incidence::Beam { mu0 }, Incidence::Diffuse] {
            let integral = crate::IsotropicSlab::new(tau, albedo, incidence).unwrap();
            let medium = AnisotropicMedium::new(albedo, &Phase::isotropic()).unwrap();
            let ordinates = medium.slab(tau, incidence).unwrap();
            let agree = |what: &str, a: Value, b: Value| {
                let (off, most) = ((a.value - b.value).abs(), a.error + b.error);
                assert!(
                    off <= most,
                    "{what}, tau {tau:e}, albedo {albedo}, {incidence:?}: off {off:e}, bounds {most:e}"
                );
            };
            for part in [0.0, 0.5, 1.0] {
                let t = part * tau;
                agree("fluence", ordinates.fluence(t).unwrap(), integral.fluence(t).unwrap());
                for mu in [-0.3, 0.3, 0.9] {
                    let inside = integral.radiance(t, mu).unwrap();
                    agree("radiance", ordinates.radiance(t, mu, 0.0).unwrap(), inside);
                }
            }
        }
    }
}
