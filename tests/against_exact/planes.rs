//! Light scattered twice and more in slabs, from planes of photons' flights: the exact radiance without that of light scattered once,
//! which has a closed form. Planes blur nothing: the same number at faces and inside.

use super::henyey_greenstein::{medium, referee};
use super::radiance::{VIEWS, looking};
use crate::checks::beams::by_maps;
use crate::checks::planes::in_planes;
use crate::checks::slab::exact;
use crate::support::run::sensor;
use crate::support::scenes::{Incidence, incidence, layer, region};
use crate::support::verdict;
use glam::DVec2;
use turbid::scene::{Orders, Scene, SceneParts};
use turbid_analytic::slab_single::single_radiance;

#[test]
fn radiance_of_planes() {
    for ((tau, albedo, g), mu0, promise) in [((1.0, 0.9, 0.0), 1.0, 0.25), ((2.0, 0.9, 0.75), 0.5, 0.8)] {
        let exact_medium = medium(albedo, g);
        let how = Incidence::Beam(mu0);
        let exact_slab = referee(&exact_medium, tau, how);
        let shape = layer(tau);
        // Peaks have a wider spread, and take more photons and fewer views.
        let (step, photons) = if g == 0.0 { (1, 10_000) } else { (3, 20_000) };
        let views: Vec<_> = VIEWS.into_iter().step_by(step).collect();
        let scene = Scene::new(SceneParts {
            lights: vec![incidence(shape.clone(), how)],
            regions: vec![region(shape, 1.0, albedo, g)],
            sensors: views
                .iter()
                .map(|view| sensor(looking(tau, *view), Orders { min: 2, max: None }))
                .collect(),
            cell: Some(DVec2::splat(8.0)),
            ..SceneParts::default()
        })
        .unwrap();
        let measured = by_maps(&scene, (photons, 110), 4, &[in_planes()]).remove(0);
        for ((part, mu, dphi), moments) in views.into_iter().zip(measured) {
            let (all, error) = exact(exact_slab.radiance(part * tau, mu, dphi).unwrap());
            let (once, _) = exact(single_radiance(tau, albedo, g, mu0, part * tau, mu, dphi).unwrap());
            let expected = all - once;
            let what = format!("depth {part} tau, mu {mu}, dphi {dphi:.3}, g {g}, mu0 {mu0}");
            verdict::agrees_with_a_tail(&what, &moments[0], (expected, error), promise * expected, 4);
            if g == 0.0 {
                verdict::rejects(&format!("with light scattered once, {what}"), &moments[0], all, 4);
            }
        }
    }
}
