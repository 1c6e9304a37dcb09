//! Radiance of anisotropic slabs and half-spaces: foreign numbers, laws, and closed forms.

use crate::support::beam;
use crate::support::table::{check_to, number, rows};
use libm::exp;
use std::collections::HashMap;
use std::f64::consts::PI;
use turbid_analytic::quadrature::GaussLegendre;
use turbid_analytic::slab_single::single_radiance;
use turbid_analytic::{AnisotropicMedium, AnisotropicSlab, Incidence, IsotropicSlab, Phase, Value};

fn medium(albedo: f64, g: f64) -> AnisotropicMedium {
    AnisotropicMedium::new(albedo, &Phase::henyey_greenstein(g).unwrap()).unwrap()
}

/// The table, made by discrete ordinates on 88 and 56 plain Gauss nodes with exact single scattering, has `digits`
/// correct digits.
#[test]
fn every_row_is_reproduced_within_its_digits_and_within_the_bound() {
    let mut slabs: HashMap<[String; 4], AnisotropicSlab> = HashMap::new();
    for row in rows("slab_hg_radiance.csv", 36) {
        let number = |name: &str| number(&row, name);
        let slab = slabs.entry(["tau", "w", "g", "mu0"].map(|name| row[name].clone())).or_insert_with(|| {
            AnisotropicSlab::new(number("tau"), number("w"), number("g"), beam(number("mu0"))).unwrap()
        });
        let got = slab.radiance(number("t"), number("mu"), number("dphi")).unwrap();
        check_to(&row, got, 2.0);
        assert!(got.error < 1e-9 * number("value"), "{row:?}: {got:?}");
    }
}

fn agree(a: Value, b: Value, what: &str) {
    let off = (a.value - b.value).abs();
    assert!(off <= a.error + b.error, "{what}: {a:?} {b:?} differs by {off:e}");
}

/// Light may be sent back: the beam and the eye change places, at either face.
#[test]
fn light_finds_its_way_back() {
    for (tau, albedo, g) in [(1.5, 0.9, 0.6), (1e-3, 1.0, -0.5), (30.0, 0.999, 0.8)] {
        let m = medium(albedo, g);
        for (a, b, dphi) in [(0.9, 0.2, 0.7), (0.35, 0.6, 3.0)] {
            let (one, other) = (m.slab(tau, beam(a)).unwrap(), m.slab(tau, beam(b)).unwrap());
            for (t, sign) in [(0.0, 1.0), (tau, -1.0)] {
                let (x, y) =
                    (one.radiance(t, sign * b, dphi).unwrap(), other.radiance(t, sign * a, dphi).unwrap());
                agree(x, y, &format!("{tau} {g} {a} {b} {t}"));
                assert!(x.error < 1e-8 * x.value, "{x:?}");
            }
        }
    }
    let m = medium(0.95, 0.5);
    let (one, other) = (m.half_space(beam(0.8)).unwrap(), m.half_space(beam(0.3)).unwrap());
    agree(one.radiance(0.0, 0.3, 1.0).unwrap(), other.radiance(0.0, 0.8, 1.0).unwrap(), "half-space");
}

/// Radiance over all directions is the fluence but for the direct light, and weighted by the cosine the flux. The
/// light varies with mu ln mu at the horizon, which mu = x^3 smooths, and g^64 = 1e-10 is left of its harmonics.
#[test]
fn radiance_adds_up_to_fluence_and_flux() {
    let (tau, albedo, g, mu0) = (1.0, 0.9, 0.5, 0.6);
    let slab = medium(albedo, g).slab(tau, beam(mu0)).unwrap();
    let (rule, turns) = (GaussLegendre::new(28).unwrap(), 16);
    for t in [0.0, 0.4, 1.0] {
        let (mut fluence, mut flux) = (exp(-t / mu0) / mu0, exp(-t / mu0));
        for (x, w) in rule.nodes.iter().zip(&rule.weights) {
            let (mu, weight) = (x * x * x, 3.0 * x * x * w);
            for sign in [1.0, -1.0] {
                for i in 0..=turns {
                    // Half a turn of an even function.
                    let ends = if i == 0 || i == turns { 0.5 } else { 1.0 };
                    let dphi = PI * f64::from(i) / f64::from(turns);
                    let radiance = slab.radiance(t, sign * mu, dphi).unwrap().value;
                    let part = weight * ends * radiance * 2.0 * PI / f64::from(turns);
                    fluence += part;
                    flux -= sign * mu * part;
                }
            }
        }
        let (phi, h) = (slab.fluence(t).unwrap(), slab.flux(t).unwrap());
        assert!((fluence - phi.value).abs() < 1e-7 * phi.value, "{t} {fluence} {phi:?}");
        assert!((flux - h.value).abs() < 1e-7, "{t} {flux} {h:?}");
    }
}

/// -dH/dt = (1-w) phi, at any depth: the flux between two depths is lost to absorption.
#[test]
fn flux_is_lost_to_absorption() {
    let rule = GaussLegendre::new(16).unwrap();
    for (albedo, g, light) in [(0.9, 0.75, beam(0.4)), (0.5, -0.5, Incidence::Diffuse), (1.0, 0.9, beam(1.0))]
    {
        for (tau, a, b) in [(2.0, 0.5, 1.5), (50.0, 20.0, 21.0)] {
            let slab = medium(albedo, g).slab(tau, light).unwrap();
            let (top, bottom) = (slab.flux(a).unwrap(), slab.flux(b).unwrap());
            let lost = (1.0 - albedo) * rule.integrate(a, b, |t| slab.fluence(t).unwrap().value);
            let off = top.value - bottom.value - lost;
            assert!(off.abs() <= top.error + bottom.error + 1e-10 * lost, "{albedo} {g} {tau}: {off:e}");
            let (r, t) = (slab.reflectance(), slab.transmittance());
            let (lit, far) = (slab.flux(0.0).unwrap(), slab.flux(tau).unwrap());
            assert!((lit.value - (1.0 - r.value)).abs() <= lit.error + r.error);
            assert!((far.value - t.value).abs() <= far.error + t.error);
        }
    }
}

/// At an albedo of 1e-9 light is scattered once.
#[test]
fn weak_scattering_is_single_scattering() {
    let (albedo, tau, mu0) = (1e-9, 2.0, 0.7);
    for g in [0.8, -0.6, 0.97] {
        let slab = AnisotropicSlab::new(tau, albedo, g, beam(mu0));
        let Ok(slab) = slab else { continue };
        for (t, mu, dphi) in
            [(0.0, 0.3, 1.0), (0.5, -0.7, 0.0), (2.0, -0.1, 2.0), (1.0, 0.0, 0.4), (1.0, 1.0, 0.0)]
        {
            let got = slab.radiance(t, mu, dphi).unwrap();
            let want = single_radiance(tau, albedo, g, mu0, t, mu, dphi).unwrap().value;
            assert!((got.value / want - 1.0).abs() < 1e-7, "{g} {mu}: {got:?} {want:e}");
        }
    }
}

/// Two solvers that share nothing but the problem; without anisotropy there is no azimuth.
#[test]
fn at_g_zero_it_is_the_isotropic_slab() {
    for (tau, albedo) in [(1e-8, 0.9), (0.3, 1.0), (5.0, 0.9), (60.0, 0.999_999)] {
        let m = AnisotropicMedium::new(albedo, &Phase::isotropic()).unwrap();
        for light in [beam(1.0), beam(0.2), Incidence::Diffuse] {
            let (ours, theirs) =
                (m.slab(tau, light).unwrap(), IsotropicSlab::new(tau, albedo, light).unwrap());
            for (share, mu) in [(0.0, 0.5), (0.0, 1.0), (0.3, 0.1), (0.3, -0.9), (1.0, -0.4), (0.5, 1e-3)] {
                let t = share * tau;
                let (a, b) = (ours.radiance(t, mu, 0.9).unwrap(), theirs.radiance(t, mu).unwrap());
                agree(a, b, &format!("{tau} {light:?} {share} {mu}"));
                assert!(a.error < 1e-8 * a.value, "{tau} {light:?} {share} {mu} {a:?}");
            }
        }
    }
}

/// A half-space that scatters isotropically, by the H function (Chandrasekhar 1960, chapter V): fluence on the face
/// H(mu0)/mu0, R = 1 - H(mu0) sqrt(1-w), radiance (w/4 pi) H(mu) H(mu0)/(mu+mu0). H(1) without absorption is
/// 2.90781052907860571.
#[test]
fn half_spaces_obey_the_h_function() {
    let h = 2.907_810_529_078_606;
    let m = AnisotropicMedium::new(1.0, &Phase::isotropic()).unwrap();
    let deep = m.half_space(beam(1.0)).unwrap();
    assert!(deep.fluence(0.0).unwrap().covers(h), "{:?}", deep.fluence(0.0));
    let leaving = deep.radiance(0.0, 1.0, 0.0).unwrap();
    assert!(leaving.covers(h * h / (8.0 * PI)) && leaving.error < 1e-11, "{leaving:?}");
    assert!(deep.reflectance().covers(1.0) && deep.absorptance().covers(0.0));
    assert!(deep.transmittance().covers(0.0) && deep.tau() == f64::INFINITY);
    for albedo in [1e-6, 0.9, 1.0 - 1e-9] {
        let m = AnisotropicMedium::new(albedo, &Phase::isotropic()).unwrap();
        for mu0 in [0.2, 1.0] {
            let deep = m.half_space(beam(mu0)).unwrap();
            let (phi, r, a) = (deep.fluence(0.0).unwrap(), deep.reflectance(), deep.absorptance());
            let want = mu0 * phi.value * (1.0 - albedo).sqrt();
            assert!(
                (a.value - want).abs() <= a.error + phi.error * (1.0 - albedo).sqrt(),
                "{albedo} {a:?} {want}"
            );
            assert!((r.value + a.value - 1.0).abs() <= r.error + a.error, "{r:?} {a:?}");
        }
    }
}

/// Without absorption T = (4/3)/((1-g) tau + 2 q') under diffuse light through a thick slab, up to 1e9 mean free paths:
/// the extrapolation length q' of Henyey-Greenstein scattering is a law of its own.
#[test]
fn thick_slabs_without_absorption_diffuse() {
    for (g, q) in [
        (0.0, 0.710_446_089_6),
        (0.5, 0.711_955_667_2),
        (0.75, 0.713_363_290_8),
        (-0.5, 0.714_075_4),
        (0.99, 0.714_938),
    ] {
        let m = medium(1.0, g);
        // In 200 mean free paths the sharpest peak does not settle.
        let thick = if g > 0.9 { [2e4, 1e5, 1e6, 1e9] } else { [200.0, 1e4, 1e6, 1e9] };
        for tau in thick {
            let t = m.slab(tau, Incidence::Diffuse).unwrap().transmittance();
            let want = (4.0 / 3.0) / ((1.0 - g) * tau + 2.0 * q);
            // Twice the last printed half digit of q.
            let known = if g > 0.9 {
                1e-6
            } else if g < 0.0 {
                1e-7
            } else {
                1e-10
            };
            assert!(
                (t.value - want).abs() <= t.error + known * t.value / ((1.0 - g) * tau),
                "{g} {tau} {t:?} {want:e}"
            );
            assert!(t.error < if g > 0.9 { 1e-8 } else { 1e-11 } * t.value, "{t:?}");
        }
    }
}

/// R = w tau b/mu0 and T - T_direct = w tau (1-b)/mu0 of a slab of thickness 1e-8, b the backward fraction: closed
/// at normal incidence. What is scattered twice is smaller by tau ln(1/tau).
#[test]
fn the_thinnest_slabs_keep_their_digits() {
    for (g, albedo) in [(0.75, 1.0), (0.9, 1e-6), (-0.95, 0.5), (0.99, 1.0)] {
        let (tau, m): (f64, _) = (1e-8, medium(albedo, g));
        let slab = m.slab(tau, beam(1.0)).unwrap();
        let b = (1.0 - g) / (2.0 * g) * ((1.0 + g) / (1.0_f64 + g * g).sqrt() - 1.0);
        let (r, t, a) = (slab.reflectance(), slab.transmittance_diffuse(), slab.absorptance());
        let twice = 40.0 * tau;
        assert!((r.value / (albedo * tau * b) - 1.0).abs() < twice / b, "{g} {r:?} {b}");
        assert!((t.value / (albedo * tau * (1.0 - b)) - 1.0).abs() < twice / (1.0 - b), "{g} {t:?} {b}");
        let scale = if g.abs() > 0.9 { 1e-7 } else { 1e-10 };
        assert!(r.error < scale * r.value && t.error < scale * t.value, "{g} {r:?} {t:?}");
        let sum = r.value + t.value + a.value;
        assert!((sum / tau - 1.0).abs() < 1e-7, "{sum:e}");
    }
}

/// Rayleigh scattering straight back and forth from a thin slab is 3/2 of what goes aside at 90 degrees, twice:
/// p = 3 (1 + cos^2)/(16 pi); and a sum of moments is what it sums to.
#[test]
fn any_phase_function_will_do() {
    let m = AnisotropicMedium::new(1.0, &Phase::rayleigh()).unwrap();
    let slab = m.slab(1e-6, beam(1.0)).unwrap();
    let back = slab.radiance(0.0, 1.0, 0.0).unwrap().value;
    assert!((back / (1e-6 * 6.0 / (16.0 * PI)) - 1.0).abs() < 1e-4, "{back:e}");
    let one = Phase::henyey_greenstein(0.4).unwrap();
    let list = Phase::legendre((0..45).map(|l| one.moment(l)).collect()).unwrap();
    let two = Phase::two_term(0.4, -0.2, 1.0).unwrap();
    let slabs = [one, list, two]
        .map(|phase| AnisotropicMedium::new(0.9, &phase).unwrap().slab(2.0, beam(0.5)).unwrap());
    for other in &slabs[1..] {
        agree(slabs[0].reflectance(), other.reflectance(), "R");
        let [a, b] = [&slabs[0], other].map(|s| s.radiance(0.7, -0.3, 1.1).unwrap());
        agree(a, b, "radiance");
        assert!(b.error < 1e-8 * b.value, "{b:?}");
    }
    // A backward and a forward peak.
    let both = Phase::two_term(0.7, -0.5, 0.8).unwrap();
    let m = AnisotropicMedium::new(0.95, &both).unwrap();
    let (a, b) = (m.slab(1.0, beam(0.9)).unwrap(), m.slab(1.0, beam(0.4)).unwrap());
    agree(a.radiance(0.0, 0.4, 0.5).unwrap(), b.radiance(0.0, 0.9, 0.5).unwrap(), "two peaks");
}

/// As few streams as a climate model uses are a medium too, with bounds to match.
#[test]
fn few_streams_know_how_few_they_are() {
    let phase = Phase::henyey_greenstein(0.75).unwrap();
    let truth = AnisotropicMedium::new(0.9, &phase).unwrap().slab(2.0, beam(0.6)).unwrap();
    for streams in [16, 32, 64] {
        let few =
            AnisotropicMedium::with_streams(0.9, &phase, streams).unwrap().slab(2.0, beam(0.6)).unwrap();
        agree(few.reflectance(), truth.reflectance(), "R");
        agree(few.transmittance(), truth.transmittance(), "T");
        assert!(few.reflectance().error < 1e-3);
    }
    assert!(AnisotropicMedium::with_streams(0.9, &phase, 7).is_err());
}

/// The azimuth is a cosine: even, of period 2 pi, and nothing at the zenith.
#[test]
fn azimuth_is_an_angle() {
    let slab = medium(0.9, 0.6).slab(1.0, beam(0.5)).unwrap();
    let at = |mu: f64, dphi: f64| slab.radiance(0.4, mu, dphi).unwrap();
    for mu in [0.7, -0.2, 0.0] {
        agree(at(mu, 1.0), at(mu, -1.0), "even");
        agree(at(mu, 1.0), at(mu, 1.0 + 2.0 * PI), "period");
    }
    for mu in [1.0, -1.0] {
        agree(at(mu, 0.0), at(mu, 2.0), "zenith");
    }
    // The limit at the horizon, where light comes within mu of it.
    assert!((at(1e-9, 1.0).value / at(0.0, 1.0).value - 1.0).abs() < 1e-7);
    assert!(slab.radiance(0.4, 1.1, 0.0).is_err() && slab.radiance(0.4, 0.1, f64::NAN).is_err());
}

/// A peak, at thickness 1, albedo 0.9, g = 0.95 and mu0 = 0.55: a plain series of 225 orders of azimuth of everything but
/// single scattering, on 248 nodes, with 404 moments of which none is cut off. Depth, mu, azimuth, radiance.
#[test]
fn a_peak_is_its_plain_series() {
    let slab = medium(0.9, 0.95).slab(1.0, beam(0.55)).unwrap();
    for (t, mu, dphi, want) in [
        (0.0, 0.6, 0.0, 1.731498448044e-2),
        (0.0, 0.6, 2.5, 3.336889409029e-3),
        (0.4, 1.0, 0.0, 1.558511063431e-3),
        (0.4, 1.0, 2.5, 1.558511063431e-3),
        (0.4, 0.05, 0.0, 2.421402056291e-1),
        (0.4, 0.05, 2.5, 9.902931468451e-3),
        (0.4, -0.3, 0.0, 6.609194059389e-1),
        (0.4, -0.3, 2.5, 4.000475579863e-3),
        (1.0, -0.9, 0.0, 8.402978927055e-2),
        (1.0, -0.9, 2.5, 6.967417792211e-3),
    ] {
        let got = slab.radiance(t, mu, dphi).unwrap();
        let off = (got.value - want).abs();
        // The moment left out is 1e-9.
        assert!(off <= got.error + 1e-9 * want, "{t} {mu} {dphi}: {got:?} {want:e} off {off:e}");
        assert!(got.error < 1e-6 * want, "{t} {mu} {dphi}: {got:?} {want:e}");
    }
}
