//! Smooth meshes: closed forms, and bodies of them by paths, photon maps and light tracing.

use super::light_tracing::{by_paths, by_photons, camera, compare};
use crate::checks::ledger::{Room, layers_of_the_scene_are_those_of_paths, settings};
use crate::checks::shading::smooth_meshes_scatter_photons_as_radiance;
use crate::support::scenes::{dielectric, faceted_ball, lambertian};
use glam::DVec3;
use turbid::Spectrum;
use turbid::integrators::Layer;
use turbid::photons::maps::Indirect;
use turbid::scene::{Filter, Interior, Object, Scene};

#[test]
fn closed_forms() {
    smooth_meshes_scatter_photons_as_radiance();
}

/// A room of fog with a diffuse ball of 128 triangles, and one of glass of 512.
fn room(has_glass: bool) -> Scene {
    let room = Room {
        floor: lambertian(Spectrum::grey(0.6)),
        sigma_t: Spectrum::grey(0.3),
        albedo: Spectrum::grey(0.8),
        g: 0.0,
        is_colored: false,
        has_glass: false,
        has_water: false,
    };
    let mut parts = room.parts();
    let ball = |center, radius, times| faceted_ball(center, radius, times, true);
    let diffuse = ball(DVec3::new(0.6, 1.5, 0.5), 0.35, 2);
    parts.objects.push(Object { shape: diffuse, surface: lambertian(Spectrum::grey(0.7)) });
    if has_glass {
        let glass = Interior { name: "glass".into(), index: 1.5, medium: None };
        parts.interiors = vec![Interior::surroundings(), glass];
        let shape = ball(DVec3::new(1.3, 0.8, 0.55), 0.4, 3);
        parts.objects.push(Object { shape, surface: dielectric(1, 0) });
    }
    Scene::new(parts).unwrap()
}

#[test]
fn bodies_by_paths_and_photon_maps() {
    layers_of_the_scene_are_those_of_paths(&room(true), Indirect::Seen, &settings(1), 3000, 11);
    layers_of_the_scene_are_those_of_paths(&room(false), Indirect::Gathered, &settings(4), 3000, 12);
}

/// The diffuse ball, and the floor beside it, where no glass stands before the eye.
#[test]
fn bodies_by_paths_and_light_tracing() {
    let scene = room(true);
    let eye = DVec3::new(1.2, 1.2, 1.1);
    let camera = camera(eye, DVec3::new(0.6, 1.5, 0.45), 50.0, Filter::Box);
    let (paths, photons) = (by_paths(&scene, &camera, 8), by_photons(&scene, &camera, 80_000));
    for layer in [Layer::Direct, Layer::Indirect] {
        compare("smooth", &paths, &photons, layer, 0);
    }
}
