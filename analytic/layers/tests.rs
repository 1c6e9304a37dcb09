//! What only the inside can see: the bounds against a third set of nodes.

use super::adding::Added;
use super::grid::Rule;
use super::problem::{Ground, Layer, Problem};
use super::stratified::StratifiedSlab;
use crate::incidence::Incidence;
use crate::phase::Phase;
use crate::value::Value;
use proptest::prelude::*;
use std::sync::Arc;

fn any_layer() -> impl Strategy<Value = Layer> {
    let tau = (-6.0..1.5_f64).prop_map(|x| libm::pow(10.0, x));
    let albedo = prop_oneof![0.0..=1.0_f64, Just(1.0), (-9.0..0.0_f64).prop_map(|x| libm::pow(10.0, x))];
    let source = prop_oneof![Just(0.0), 0.0..3.0_f64];
    (tau, albedo, -0.8..0.8_f64, source).prop_map(|(tau, albedo, g, source)| {
        let phase = Phase::henyey_greenstein(g).unwrap();
        Layer::new(tau, albedo, &phase).unwrap().emitting(source).unwrap()
    })
}

/// The bound is earned: it covers what more nodes make of the same slab, everywhere. `relative` is the most that it may be.
fn check_bounds(
    layers: &[Layer],
    ground: Ground,
    light: Option<Incidence>,
    relative: [f64; 2],
) -> Result<(), TestCaseError> {
    let slab = StratifiedSlab::new(layers, ground, light).unwrap();
    let degree: Vec<usize> = layers.iter().map(|layer| layer.phase().degree(1e-15, 500)).collect();
    let most = degree.iter().copied().fold(0, usize::max);
    let problem = Arc::new(Problem::new(layers, ground, light).unwrap());
    let cosines = [1.0, 0.3, 0.01];
    let rule = Rule { upper: 40, lower: 80, power: 5, open: 3.0, degree: most + 6 };
    let last = layers.len() - 1;
    let finer = Added::on(problem.clone(), rule, layers[last].index(), &cosines, &degree, 0).unwrap();
    let check = |name: &str, got: Value, truth: f64| {
        prop_assert!(got.covers(truth), "{name}: {got:?}, finer {truth:e}");
        let relative = if name == "phi" { relative[1] } else { relative[0] };
        prop_assert!(got.error <= relative * got.value + 1e-16, "{name}: {got:?}");
        Ok(())
    };
    let [reflected, arrived] = finer.leaving();
    check("R", slab.reflectance_diffuse(), reflected)?;
    check("T", slab.transmittance_diffuse(), arrived)?;
    for (i, layer) in layers.iter().enumerate() {
        if problem.scattering().contains(&i) {
            check("mean", slab.mean_fluence(i).unwrap(), finer.dwelt(i) / layer.tau())?;
        }
        for share in [0.0, 1e-7, 1e-3, 0.4, 0.999] {
            let t = slab.depths()[i] + share * layer.tau();
            let (place, x) = problem.place(t);
            let scattered = finer.light(place, x).unwrap();
            let direct = problem.direct(place, x).unwrap();
            let [fluence, down, up] = [0, 1, 2].map(|which| scattered[which] + direct[which].value);
            check("phi", slab.fluence(t).unwrap(), fluence)?;
            check("down", slab.flux_down(t).unwrap(), down)?;
            check("up", slab.flux_up(t).unwrap(), up)?;
        }
    }
    let t = slab.depths()[last] + 0.3 * layers[last].tau();
    let (place, x) = problem.place(t);
    let got = slab.radiance(t, &[1.0, 0.3, 0.01, -1.0, -0.3, -0.01]).unwrap();
    for (i, got) in got.into_iter().enumerate() {
        let truth = finer.radiance(place, x, i % 3).unwrap()[usize::from(i < 3)];
        prop_assert!(got.covers(truth), "L {i}: {got:?}, finer {truth:e}");
    }
    Ok(())
}

fn any_light() -> impl Strategy<Value = Option<Incidence>> {
    prop_oneof![
        Just(None),
        Just(Some(Incidence::Diffuse)),
        (-4.0..0.0_f64).prop_map(|x| Some(Incidence::Beam { mu0: libm::pow(10.0, x) })),
    ]
}

fn any_ground() -> impl Strategy<Value = Ground> {
    prop_oneof![
        Just(Ground::mirror()),
        (0.0..=1.0_f64).prop_map(|r| Ground::lambertian(r).unwrap().emitting(r).unwrap()),
    ]
}

proptest! {
    #![proptest_config(crate::fixed_cases(8))]

    #[test]
    fn bounds_cover_a_third_set_of_nodes(
        layers in prop::collection::vec(any_layer(), 1..=4),
        ground in any_ground(),
        light in any_light(),
    ) {
        check_bounds(&layers, ground, light, [1e-8, 1e-7])?;
    }
}

proptest! {
    #![proptest_config(crate::fixed_cases(2))]

    #[test]
    fn bounds_cover_a_third_set_of_nodes_between_faces(
        layers in prop::collection::vec((any_layer(), prop_oneof![Just(1.0), Just(1.37), 0.7..2.4_f64]), 1..=2),
        plate in prop_oneof![Just(1.0), Just(1.5)],
        ground in prop_oneof![any_ground(), (0.0..=1.0_f64).prop_map(|r| Ground::specular(r).unwrap())],
        contact in any::<bool>(),
        light in prop_oneof![
            Just(None),
            Just(Some(Incidence::Diffuse)),
            (0.75..1.0_f64).prop_map(|mu0| Some(Incidence::Beam { mu0 })),
        ],
    ) {
        let mut layers: Vec<Layer> = layers.into_iter().map(|(layer, n)| layer.refracting(n).unwrap()).collect();
        layers.insert(0, Layer::plate(plate).unwrap());
        let below = if contact { layers[layers.len() - 1].index() } else { 1.0 };
        check_bounds(&layers, ground.within(below).unwrap(), light, [1e-7, 1e-6])?;
    }
}
