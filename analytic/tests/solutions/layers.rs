//! The stratified slab: by two methods, and by the laws that layers obey.

use crate::support::any_input::{cases, number, sound};
use crate::support::kernels::agree;
use crate::support::{NORMAL, beam, close};
use proptest::prelude::*;
use std::f64::consts::PI;
use turbid_analytic::{
    AddingDoubling, Error, Ground, Incidence, Layer, Phase, Slab, SlabMedium, StratifiedSlab, Value,
    VaryingAlbedo,
};

fn layer(tau: f64, albedo: f64, g: f64) -> Layer {
    Layer::new(tau, albedo, &Phase::henyey_greenstein(g).unwrap()).unwrap()
}

fn by_adding(layers: &[Layer], ground: Ground, light: Option<Incidence>) -> StratifiedSlab {
    StratifiedSlab::new(layers, ground, light).unwrap()
}

fn any_layer() -> impl Strategy<Value = Layer> {
    let tau = (-3.0..1.0_f64).prop_map(|x| libm::pow(10.0, x));
    let albedo = prop_oneof![0.0..=1.0_f64, Just(1.0), Just(0.0), 0.99..1.0_f64];
    let g = prop_oneof![-0.7..0.8_f64, Just(0.0)];
    let source = prop_oneof![2 => Just(0.0), 1 => 0.0..3.0_f64];
    (tau, albedo, g, source).prop_map(|(tau, albedo, g, q)| layer(tau, albedo, g).emitting(q).unwrap())
}

fn any_ground() -> impl Strategy<Value = Ground> {
    let shining = prop_oneof![Just(0.0), 0.0..1.0_f64];
    let ground = prop_oneof![
        Just(Ground::black()),
        Just(Ground::mirror()),
        (0.0..=1.0_f64).prop_map(|r| Ground::lambertian(r).unwrap()),
        Just(Ground::lambertian(1.0).unwrap()),
    ];
    (ground, shining)
        .prop_map(|(ground, m)| if ground == Ground::mirror() { ground } else { ground.emitting(m).unwrap() })
}

fn any_light() -> impl Strategy<Value = Option<Incidence>> {
    prop_oneof![
        Just(None),
        Just(Some(Incidence::Diffuse)),
        Just(Some(NORMAL)),
        (-2.0..0.0_f64).prop_map(|x| Some(beam(libm::pow(10.0, x)))),
    ]
}

/// All that a slab answers, by name.
fn answers(slab: &StratifiedSlab) -> Vec<(String, Value)> {
    let mut all = vec![
        ("R".to_string(), slab.reflectance()),
        ("T".to_string(), slab.transmittance_diffuse()),
        ("A ground".to_string(), slab.absorptance_ground().unwrap()),
    ];
    for (i, layer) in slab.layers().iter().enumerate() {
        all.push((format!("A {i}"), slab.absorptance(i).unwrap()));
        all.push((format!("mean {i}"), slab.mean_fluence(i).unwrap()));
        for share in [0.0, 1e-4, 0.3, 1.0] {
            let t = slab.depths()[i] + share * layer.tau();
            let t = t.min(slab.tau());
            all.push((format!("phi {t}"), slab.fluence(t).unwrap()));
            all.push((format!("down {t}"), slab.flux_down(t).unwrap()));
            all.push((format!("up {t}"), slab.flux_up(t).unwrap()));
        }
    }
    all
}

proptest! {
    #![proptest_config(cases(12, 20_270_101))]

    #[test]
    fn adding_agrees_with_discrete_ordinates(
        layers in prop::collection::vec(any_layer(), 1..=3),
        ground in any_ground(),
        light in any_light(),
    ) {
        let a = by_adding(&layers, ground, light);
        let b = StratifiedSlab::by_ordinates(&layers, ground, light).unwrap();
        for ((name, a), (_, b)) in answers(&a).into_iter().zip(answers(&b)) {
            prop_assert!(agree(a, b), "{name}: {a:?} {b:?} off {:e}", (a.value - b.value).abs());
        }
    }
}

proptest! {
    #![proptest_config(cases(8, 20_270_102))]

    /// A plane drawn through a layer is no interface.
    #[test]
    fn a_layer_split_in_two_is_the_same(
        layers in prop::collection::vec(any_layer(), 1..=4),
        ground in any_ground(),
        light in any_light(),
        which in 0..4_usize,
        share in 0.01..0.99_f64,
    ) {
        let i = which % layers.len();
        let whole = by_adding(&layers, ground, light);
        let part = |share: f64| {
            let one = &layers[i];
            Layer::new(one.tau() * share, one.albedo(), one.phase()).unwrap().emitting(one.emission()).unwrap()
        };
        let mut split = layers.clone();
        split.splice(i..=i, [part(share), part(1.0 - share)]);
        let parts = by_adding(&split, ground, light);
        let same = |name: &str, a: Value, b: Value| {
            prop_assert!(agree(a, b), "{name}: {a:?} {b:?} off {:e}", (a.value - b.value).abs());
            Ok(())
        };
        same("R", whole.reflectance(), parts.reflectance())?;
        same("T", whole.transmittance_diffuse(), parts.transmittance_diffuse())?;
        let sum = parts.absorptance(i).unwrap().value + parts.absorptance(i + 1).unwrap().value;
        let one = whole.absorptance(i).unwrap();
        let bound = one.error + parts.absorptance(i).unwrap().error + parts.absorptance(i + 1).unwrap().error;
        prop_assert!((one.value - sum).abs() <= bound, "A: {one:?} {sum}");
        for t in parts.depths() {
            let t = t.min(whole.tau()).min(parts.tau());
            same("phi", whole.fluence(t).unwrap(), parts.fluence(t).unwrap())?;
            same("down", whole.flux_down(t).unwrap(), parts.flux_down(t).unwrap())?;
            same("up", whole.flux_up(t).unwrap(), parts.flux_up(t).unwrap())?;
        }
    }

    /// What enters and what starts is what leaves and what is absorbed; and nothing is absorbed where nothing absorbs.
    #[test]
    fn power_is_conserved(
        layers in prop::collection::vec(any_layer(), 1..=4),
        ground in any_ground(),
        light in any_light(),
        conservative in any::<bool>(),
    ) {
        let conserving = |one: &Layer| {
            Layer::new(one.tau(), 1.0, one.phase()).unwrap().emitting(one.emission()).unwrap()
        };
        let layers: Vec<Layer> = if conservative { layers.iter().map(conserving).collect() } else { layers };
        let slab = by_adding(&layers, ground, light);
        let mut income = if light.is_some() { 1.0 } else { 0.0 };
        let mut outcome = vec![slab.reflectance(), slab.absorptance_ground().unwrap()];
        for (i, layer) in layers.iter().enumerate() {
            income += layer.emission() * layer.tau();
            outcome.push(slab.absorptance(i).unwrap());
            prop_assert!(!conservative || outcome[i + 2].value == 0.0);
        }
        let sum: f64 = outcome.iter().map(|v| v.value).sum();
        let bound: f64 = outcome.iter().map(|v| v.error).sum();
        prop_assert!((sum - income).abs() <= bound, "{sum} {income} off {:e} of {bound:e}", sum - income);
        // The net flux falls by what is absorbed, layer by layer.
        for (i, pair) in slab.depths().windows(2).enumerate() {
            let [above, below] = [pair[0], pair[1]].map(|t| slab.flux(t).unwrap());
            let (kept, started) = (outcome[i + 2], layers[i].emission() * layers[i].tau());
            let off = above.value + started - below.value - kept.value;
            prop_assert!(off.abs() <= above.error + below.error + kept.error, "layer {i}: {off:e}");
        }
    }

    /// Turned upside down, a slab over a black ground transmits alike; and light finds its way back.
    #[test]
    fn transmission_is_reciprocal(
        layers in prop::collection::vec(any_layer(), 2..=3),
        mu0 in 0.02..1.0_f64,
        mu in 0.02..1.0_f64,
    ) {
        let dark = |one: &Layer| one.clone().emitting(0.0).unwrap();
        let layers: Vec<Layer> = layers.iter().map(dark).collect();
        let turned: Vec<Layer> = layers.iter().rev().cloned().collect();
        let through = |layers: &[Layer], light| by_adding(layers, Ground::black(), Some(light));
        let (a, b) = (through(&layers, Incidence::Diffuse), through(&turned, Incidence::Diffuse));
        prop_assert!(agree(a.transmittance_diffuse(), b.transmittance_diffuse()));
        let (a, b) = (through(&layers, beam(mu0)), through(&turned, beam(mu)));
        let (a, b) = (a.radiance(a.tau(), &[-mu]).unwrap()[0], b.radiance(b.tau(), &[-mu0]).unwrap()[0]);
        prop_assert!(agree(a, b), "{a:?} {b:?}");
        let ground = Ground::lambertian(0.4).unwrap();
        let [a, b] = [(mu0, mu), (mu, mu0)].map(|(from, to)| {
            by_adding(&layers, ground, Some(beam(from))).radiance(0.0, &[to]).unwrap()[0]
        });
        prop_assert!(agree(a, b), "{a:?} {b:?}");
    }

    /// One temperature everywhere: layers, ground and the light outside.
    #[test]
    fn a_furnace_is_uniform(
        layers in prop::collection::vec(any_layer(), 1..=4),
        reflectance in 0.0..=1.0_f64,
        mirror in any::<bool>(),
    ) {
        // Lambertian light of irradiance 1: pi B = 1.
        let layers: Vec<Layer> =
            layers.iter().map(|one| one.clone().emitting(4.0 * (1.0 - one.albedo())).unwrap()).collect();
        let ground = Ground::lambertian(reflectance).unwrap().emitting(1.0 - reflectance).unwrap();
        let ground = if mirror { Ground::mirror() } else { ground };
        let slab = by_adding(&layers, ground, Some(Incidence::Diffuse));
        let mut all = vec![(slab.reflectance(), 1.0), (slab.transmittance().unwrap(), 1.0)];
        for (i, layer) in layers.iter().enumerate() {
            all.push((slab.mean_fluence(i).unwrap(), 4.0));
            for share in [0.0, 1e-5, 0.4] {
                let t = slab.depths()[i] + share * layer.tau();
                all.push((slab.fluence(t).unwrap(), 4.0));
                all.push((slab.flux_down(t).unwrap(), 1.0));
                all.push((slab.flux_up(t).unwrap(), 1.0));
            }
        }
        for (value, exact) in all {
            prop_assert!(value.covers(exact), "{value:?} {exact}");
        }
        // Light from the lit face that has met nothing is left out of radiances.
        if !mirror {
            let t = 0.5 * slab.tau();
            for (value, mu) in slab.radiance(t, &[0.7, -0.3]).unwrap().into_iter().zip([0.7, -0.3_f64]) {
                let direct = if mu < 0.0 { libm::exp(t / mu) } else { 0.0 };
                prop_assert!(value.covers((1.0 - direct) / PI), "{value:?} {mu}");
            }
        }
    }
}

proptest! {
    #![proptest_config(cases(32, 20_270_103))]

    /// Numbers of any bits are answered or refused.
    #[test]
    fn any_layers_are_answered_or_refused(
        tau in prop_oneof![number(), 0.0..2.0_f64],
        albedo in prop_oneof![number(), 0.0..=1.0_f64],
        emission in prop_oneof![number(), Just(0.0)],
        reflectance in prop_oneof![number(), 0.0..=1.0_f64],
        mu0 in prop_oneof![number(), 0.0..=1.0_f64],
        t in number(),
        mu in number(),
    ) {
        let solve = || -> turbid_analytic::Result<StratifiedSlab> {
            let first = Layer::new(tau, albedo, &Phase::rayleigh())?.emitting(emission)?;
            let second = layer(0.5, 0.9, 0.0);
            StratifiedSlab::new(&[first, second], Ground::lambertian(reflectance)?, Some(beam(mu0)))
        };
        match solve() {
            Err(error) => sound(Err(error))?,
            Ok(slab) => {
                sound(Ok(slab.reflectance()))?;
                sound(slab.transmittance())?;
                sound(slab.mean_fluence(0))?;
                for t in [t, 0.5 * slab.tau()] {
                    sound(slab.fluence(t))?;
                    sound(slab.flux(t))?;
                    sound(slab.radiance(t, &[mu]).map(|all| all[0]))?;
                }
            }
        }
    }
}

#[test]
fn one_layer_is_a_slab() {
    for (tau, albedo, g, light) in [
        (1.0, 0.9, 0.75, beam(0.5)),
        (10.0, 1.0, 0.0, NORMAL),
        (1e-6, 0.99, -0.4, Incidence::Diffuse),
        (100.0, 0.999, 0.6, beam(0.1)),
        (3.0, 0.0, 0.0, Incidence::Diffuse),
    ] {
        let one = layer(tau, albedo, g);
        let slab = Slab::solve(tau, &SlabMedium::new(albedo, one.phase()).unwrap(), light).unwrap();
        let layers = by_adding(&[one], Ground::black(), Some(light));
        let near = |name: &str, a: Value, b: Value| close(&format!("{name} {tau} {albedo} {g}"), a, b, 1e-9);
        near("R", layers.reflectance(), slab.reflectance());
        near("T", layers.transmittance().unwrap(), slab.transmittance());
        near("diffuse T", layers.transmittance_diffuse(), slab.transmittance_diffuse());
        near("A", layers.absorptance(0).unwrap(), slab.absorptance());
        for share in [0.0, 1e-3, 0.4, 1.0] {
            near("phi", layers.fluence(share * tau).unwrap(), slab.fluence(share * tau).unwrap());
            let (a, b) = (layers.flux(share * tau).unwrap(), slab.flux(share * tau).unwrap());
            assert!(agree(a, b), "net flux {a:?} {b:?}");
        }
        if light == Incidence::Diffuse {
            for mu in [0.8, -0.3] {
                let a = layers.radiance(0.4 * tau, &[mu]).unwrap()[0];
                near("L", a, slab.radiance(0.4 * tau, mu, 0.0).unwrap());
            }
        }
    }
}

/// Radiance by azimuth under a beam: of one layer, cut in two, that of the slab; its mean over azimuth; and light finds its way back
/// through layers that differ.
#[test]
fn radiance_has_an_azimuth() {
    let light = beam(0.6);
    let slab = AddingDoubling::new(1.5, 0.9, 0.3, light).unwrap();
    let two = by_adding(&[layer(0.5, 0.9, 0.3), layer(1.0, 0.9, 0.3)], Ground::black(), Some(light));
    for (t, mu) in [(0.0, 0.4), (0.7, -0.6)] {
        let all = two.radiance_towards(t, mu, &[0.3, 2.0]).unwrap();
        close("L", all[0], slab.radiance(t, mu, 0.3).unwrap(), 1e-8);
        // Another azimuth is another radiance.
        assert!((all[0].value - all[1].value).abs() > 1e-2 * all[0].value, "{t} {mu} {all:?}");
    }
    let layers = [layer(0.4, 0.9, 0.3).emitting(0.3).unwrap(), layer(0.8, 0.7, -0.2)];
    let ground = Ground::lambertian(0.3).unwrap();
    let one = by_adding(&layers, ground, Some(light));
    // Sixteen azimuths have the mean but for modes 16, 32, ..., which g to that power makes small.
    let azimuths: Vec<f64> = (0..16).map(|k| PI * f64::from(k) / 8.0).collect();
    let mean: f64 =
        one.radiance_towards(0.3, 0.5, &azimuths).unwrap().iter().map(|value| value.value / 16.0).sum();
    let exact = one.radiance(0.3, &[0.5]).unwrap()[0];
    assert!((mean - exact.value).abs() < 1e-7 * exact.value, "{mean} {exact:?}");
    let dark: Vec<Layer> = layers.iter().map(|one| one.clone().emitting(0.0).unwrap()).collect();
    let back = [(0.6, 0.3), (0.3, 0.6)].map(|(from, to)| {
        by_adding(&dark, ground, Some(beam(from))).radiance_towards(0.0, to, &[1.0]).unwrap()[0]
    });
    assert!(agree(back[0], back[1]), "{back:?}");
    let refused = by_adding(&[layer(1.0, 0.5, 0.0).refracting(1.5).unwrap()], ground, Some(light));
    assert!(matches!(
        refused.radiance_towards(0.0, 0.5, &[0.0]),
        Err(Error::OutOfRange { name: "index", .. })
    ));
}

/// Twice the thickness and symmetric light are a slab over a mirror.
#[test]
fn a_mirror_shows_the_slab_again() {
    let half = [layer(0.5, 0.9, 0.5), layer(0.7, 0.3, 0.0).emitting(2.0).unwrap()];
    let twice: Vec<Layer> = half.iter().chain(half.iter().rev()).cloned().collect();
    let (a, b) = (by_adding(&half, Ground::mirror(), None), by_adding(&twice, Ground::black(), None));
    for t in [0.0, 0.2, 0.5, 0.9, 1.2] {
        close("phi", a.fluence(t).unwrap(), b.fluence(t).unwrap(), 1e-10);
    }
    close("R", a.reflectance(), b.reflectance(), 1e-10);
    // A beam comes back as if it had gone on.
    let half = [layer(0.5, 0.9, 0.5), layer(0.7, 0.3, 0.0)];
    let twice: Vec<Layer> = half.iter().chain(half.iter().rev()).cloned().collect();
    let light = Some(beam(0.4));
    let (a, b) = (by_adding(&half, Ground::mirror(), light), by_adding(&twice, Ground::black(), light));
    let (back, on) = (b.reflectance(), b.transmittance().unwrap());
    let sum = Value { value: back.value + on.value, error: back.error + on.error, ..back };
    close("R", a.reflectance(), sum, 1e-10);
}

/// Without scattering, light is direct, or once reflected.
#[test]
fn absorbing_layers_over_a_ground_have_a_closed_form() {
    let e_n = |n, x| turbid_analytic::exponential_integral::exponential_integral(n, x).unwrap().value;
    let layers = [layer(0.3, 0.0, 0.0), layer(1.1, 0.0, 0.5), layer(0.02, 0.0, 0.0)];
    let (tau, rho) = (1.42, 0.35);
    let ground = Ground::lambertian(rho).unwrap();
    for light in [beam(0.6), Incidence::Diffuse] {
        let slab = by_adding(&layers, ground, Some(light));
        let down = |t: f64| match light {
            Incidence::Beam { mu0 } => [libm::exp(-t / mu0), libm::exp(-t / mu0) / mu0],
            Incidence::Diffuse => [2.0 * e_n(3, t), 2.0 * e_n(2, t)],
        };
        let arrived = down(tau)[0];
        let check = |value: Value, exact: f64| {
            assert!(value.covers(exact) && value.error < 1e-9, "{value:?} {exact}");
        };
        check(slab.reflectance(), rho * arrived * 2.0 * e_n(3, tau));
        check(slab.transmittance_diffuse(), 0.0);
        check(slab.absorptance_ground().unwrap(), (1.0 - rho) * arrived);
        for t in [0.0, 0.3, 0.9, 1.41, tau] {
            check(slab.flux_down(t).unwrap(), down(t)[0]);
            check(slab.flux_up(t).unwrap(), rho * arrived * 2.0 * e_n(3, tau - t));
            check(slab.fluence(t).unwrap(), down(t)[1] + rho * arrived * 2.0 * e_n(2, tau - t));
        }
        for mu in [0.9, 0.05] {
            check(slab.radiance(0.0, &[mu]).unwrap()[0], rho * arrived * libm::exp(-tau / mu) / PI);
        }
    }
}

#[test]
fn what_is_out_of_range_is_refused_by_name() {
    let name = |error: Error| match error {
        Error::OutOfRange { name, .. } => name,
        other => panic!("{other}"),
    };
    let isotropic = Phase::isotropic();
    let one = layer(1.0, 0.5, 0.0);
    assert_eq!(name(Layer::new(0.0, 0.5, &isotropic).unwrap_err()), "tau");
    assert_eq!(name(Layer::new(101.0, 0.5, &isotropic).unwrap_err()), "tau");
    assert_eq!(name(Layer::new(1.0, 1.5, &isotropic).unwrap_err()), "albedo");
    assert_eq!(name(one.clone().emitting(-1.0).unwrap_err()), "emission");
    assert_eq!(name(layer(1e-9, 0.5, 0.0).emitting(1.0).unwrap_err()), "tau");
    assert_eq!(name(Ground::lambertian(f64::NAN).unwrap_err()), "ground");
    assert_eq!(name(Ground::black().emitting(f64::INFINITY).unwrap_err()), "exitance");
    let solve = |layers: &[Layer], mu0: f64| {
        StratifiedSlab::new(layers, Ground::black(), Some(beam(mu0))).err().unwrap()
    };
    assert_eq!(name(solve(&[], 1.0)), "layers");
    assert_eq!(name(solve(std::slice::from_ref(&one), 0.0)), "mu0");
    assert_eq!(name(solve(&vec![layer(100.0, 0.5, 0.0); 5], 1.0)), "tau");
    let slab = by_adding(&[one], Ground::black(), None);
    assert_eq!(name(slab.fluence(1.1).unwrap_err()), "t");
    assert_eq!(name(slab.radiance(0.5, &[0.0]).unwrap_err()), "mu");
    assert_eq!(name(slab.radiance(0.5, &[]).unwrap_err()), "cosines");
    assert_eq!(name(slab.absorptance(1).unwrap_err()), "layer");
}

/// An albedo that falls with depth: the bound covers finer layerings, a step may stand at a break, and a constant is the slab.
#[test]
fn a_varying_albedo_is_extrapolated() {
    let phase = Phase::henyey_greenstein(0.5).unwrap();
    let solve = |breaks: &[f64], albedo: fn(f64) -> f64, layers: usize| {
        VaryingAlbedo::new(breaks, albedo, &phase, Ground::black(), Some(beam(0.6)), layers).unwrap()
    };
    let both = |slab: &VaryingAlbedo| {
        let mut all = vec![slab.reflectance(), slab.transmittance().unwrap()];
        for t in [0.0, 0.5, 2.0, 5.0] {
            all.push(slab.fluence(t).unwrap());
            all.push(slab.flux(t).unwrap());
        }
        all.extend(slab.radiance(0.0, &[0.3, 1.0]).unwrap());
        all
    };
    let stepped = |t: f64| if t < 2.0 { libm::exp(-t / 10.0) } else { 0.3 + 0.1 * t };
    let [coarse, fine] = [1, 4].map(|layers| both(&solve(&[0.0, 0.5, 2.0, 5.0], stepped, layers)));
    for (coarse, fine) in coarse.into_iter().zip(fine) {
        assert!(agree(coarse, fine), "{coarse:?} {fine:?}");
    }
    let slab = Slab::solve(5.0, &SlabMedium::new(0.9, &phase).unwrap(), beam(0.6)).unwrap();
    let constant = solve(&[0.0, 1.0, 5.0], |_| 0.9, 1);
    close("R", constant.reflectance(), slab.reflectance(), 1e-11);
    close("phi", constant.fluence(1.0).unwrap(), slab.fluence(1.0).unwrap(), 1e-9);
    assert!(constant.fluence(2.0).unwrap_err().to_string().starts_with("t is 2; allowed: an interface"));
    let refuse = |breaks: &[f64], albedo: fn(f64) -> f64| {
        let slab = VaryingAlbedo::new(breaks, albedo, &phase, Ground::black(), None, 4);
        slab.err().unwrap().to_string()
    };
    assert!(refuse(&[0.0, 1.0], |t| 1.0 + t).contains("albedo is"));
    assert!(refuse(&[0.0, 1.0], |_| f64::NAN).contains("albedo returned NaN"));
    assert!(refuse(&[0.0, 1.0, 0.5], |_| 0.5).contains("breaks is 0.5"));
}
