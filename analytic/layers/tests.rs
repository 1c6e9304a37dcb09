//! What only the inside can see: the bounds against a third set of nodes.

use super::adding::Added;
use super::problem::{Ground, Layer, Problem};
use super::stratified::StratifiedSlab;
use crate::adding_doubling::Nodes;
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

proptest! {
    #![proptest_config(crate::fixed_cases(12))]

    /// The bound is earned: it covers what more nodes make of the same slab, everywhere.
    #[test]
    fn bounds_cover_a_third_set_of_nodes(
        layers in prop::collection::vec(any_layer(), 1..=4),
        ground in prop_oneof![
            Just(Ground::mirror()),
            (0.0..=1.0_f64).prop_map(|r| Ground::lambertian(r).unwrap().emitting(r).unwrap()),
        ],
        light in prop_oneof![
            Just(None),
            Just(Some(Incidence::Diffuse)),
            (-4.0..0.0_f64).prop_map(|x| Some(Incidence::Beam { mu0: libm::pow(10.0, x) })),
        ],
    ) {
        let slab = StratifiedSlab::new(&layers, ground, light).unwrap();
        let degree: Vec<usize> = layers.iter().map(|layer| layer.phase().degree(1e-15, 500)).collect();
        let most = degree.iter().copied().fold(0, usize::max);
        let problem = Arc::new(Problem::new(&layers, ground, light).unwrap());
        let cosines = [1.0, 0.3, 0.01];
        let nodes = Nodes::open(40.max(most / 2 + 8), 80);
        let finer = Added::on(problem.clone(), nodes, &cosines, &degree).unwrap();
        let check = |name: &str, got: Value, truth: f64| {
            prop_assert!(got.covers(truth), "{name}: {got:?}, finer {truth:e}");
            let relative = if name == "phi" { 1e-7 } else { 1e-8 };
            prop_assert!(got.error <= relative * got.value + 1e-16, "{name}: {got:?}");
            Ok(())
        };
        let [reflected, arrived] = finer.leaving();
        check("R", slab.reflectance(), reflected + problem.direct(0.0).unwrap().up)?;
        check("T", slab.transmittance_diffuse(), arrived)?;
        for (i, layer) in layers.iter().enumerate() {
            check("mean", slab.mean_fluence(i).unwrap(), finer.dwelt(i) / layer.tau())?;
            for share in [0.0, 1e-7, 1e-3, 0.4, 0.999] {
                let t = slab.depths()[i] + share * layer.tau();
                let (place, x) = problem.place(t);
                let [fluence, down, up] = finer.light(place, x).unwrap();
                check("phi", slab.fluence(t).unwrap(), fluence)?;
                check("down", slab.flux_down(t).unwrap(), down)?;
                check("up", slab.flux_up(t).unwrap(), up)?;
            }
        }
        let last = layers.len() - 1;
        let t = slab.depths()[last] + 0.3 * layers[last].tau();
        let (place, x) = problem.place(t);
        let got = slab.radiance(t, &[1.0, 0.3, 0.01, -1.0, -0.3, -0.01]).unwrap();
        for (i, got) in got.into_iter().enumerate() {
            let truth = finer.radiance(place, x, i % 3).unwrap()[usize::from(i < 3)];
            prop_assert!(got.covers(truth), "L {i}: {got:?}, finer {truth:e}");
        }
    }
}
