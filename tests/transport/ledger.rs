//! The ledger of the photon mapper: each class of light is the path tracer's, and they add up to the whole.

use crate::checks::ledger::{
    Room, a_clear_room_keeps_its_ledger, a_foggy_room_keeps_its_ledger,
    a_foggy_room_keeps_its_ledger_when_gathered, by_paths, layers_are_those_of_paths,
    layers_are_those_of_the_reference, layers_of_maps, layers_of_the_scene_are_those_of_paths, mirror,
    reference, settings, what_is_absent_is_not_asked,
};
use crate::support::scenes::{homogeneous, lambertian, rectangle};
use crate::support::verdict;
use glam::DVec3;
use turbid::Spectrum;
use turbid::geometry::Shape;
use turbid::integrators::mapper::Settings;
use turbid::math::Positive;
use turbid::medium::{Density, Grid, Heterogeneous};
use turbid::photons::maps::Indirect;
use turbid::scene::{Object, Scene};
use turbid::surface::{Checker, Filter, Lambertian, Surface, Texture};

#[test]
fn seen() {
    a_foggy_room_keeps_its_ledger();
}

#[test]
fn gathered() {
    a_foggy_room_keeps_its_ledger_when_gathered();
}

#[test]
fn in_clear_air() {
    a_clear_room_keeps_its_ledger();
}

#[test]
fn in_color_and_forward() {
    let room = Room {
        floor: mirror(),
        sigma_t: Spectrum::rgb(0.3, 0.6, 0.9),
        albedo: Spectrum::rgb(0.9, 0.7, 0.5),
        g: 0.6,
        is_colored: true,
        has_glass: false,
        has_water: false,
    };
    let scene = room.scene();
    let paths = reference(&scene, 3);
    layers_are_those_of_the_reference((&scene, &paths), Indirect::Seen, &settings(1), 4000, 3);
    layers_are_those_of_the_reference((&scene, &paths), Indirect::Gathered, &settings(4), 4000, 4);
}

/// Light through a ball of glass, which focuses it on the floor; seen through the ball too.
#[test]
fn with_glass() {
    let room = Room {
        floor: lambertian(Spectrum::grey(0.6)),
        sigma_t: Spectrum::grey(0.3),
        albedo: Spectrum::grey(0.8),
        g: 0.0,
        is_colored: false,
        has_glass: true,
        has_water: false,
    };
    let scene = room.scene();
    let paths = reference(&scene, 6);
    layers_are_those_of_the_reference((&scene, &paths), Indirect::Seen, &settings(1), 3000, 6);
    layers_are_those_of_the_reference((&scene, &paths), Indirect::Gathered, &settings(4), 3000, 7);
}

/// Walls above water and a floor below it light each other: rays of a gathering carry radiance across the level, scaled
/// by the squared index.
#[test]
fn gathered_across_water() {
    let room = Room {
        floor: lambertian(Spectrum::grey(0.9)),
        sigma_t: Spectrum::grey(0.0),
        albedo: Spectrum::grey(0.0),
        g: 0.0,
        is_colored: false,
        has_glass: false,
        has_water: true,
    };
    layers_are_those_of_paths(&room, Indirect::Gathered, &settings(4), 1000, 9);
}

/// Rays of the gathering that collide read photons or beams about the collision, where those of the camera read them along the way.
#[test]
fn gathered_beside_rays_that_are_read_at_once() {
    let room = Room {
        floor: lambertian(Spectrum::grey(0.6)),
        sigma_t: Spectrum::grey(0.8),
        albedo: Spectrum::grey(0.9),
        g: 0.0,
        is_colored: false,
        has_glass: false,
        has_water: false,
    };
    // Wide enough that no few photons next to the eye make the spread.
    let radius = Positive::new("the radius", 0.2).unwrap();
    let standard = settings(4);
    let scene = room.scene();
    let paths = reference(&scene, 41);
    for (volume, seed) in
        [(standard.volume.along_rays(radius), 41), (standard.volume.along_beams(radius), 42)]
    {
        let settings = Settings { volume, ..standard };
        layers_are_those_of_the_reference((&scene, &paths), Indirect::Gathered, &settings, 800, seed);
    }
}

#[test]
fn absent_maps() {
    what_is_absent_is_not_asked();
}

/// Short rays of the gathering traced on: the same light by other means, most of it here.
#[test]
fn gathered_twice() {
    let room = Room {
        floor: mirror(),
        sigma_t: Spectrum::grey(0.3),
        albedo: Spectrum::grey(0.8),
        g: 0.0,
        is_colored: true,
        has_glass: false,
        has_water: false,
    };
    let near = Settings { near: 1.2, ..settings(4) };
    layers_are_those_of_paths(&room, Indirect::Gathered, &near, 2000, 8);
}

/// A diffuse room of grey fog.
fn plain() -> Room {
    Room {
        floor: lambertian(Spectrum::grey(0.6)),
        sigma_t: Spectrum::grey(0.6),
        albedo: Spectrum::grey(0.8),
        g: 0.3,
        is_colored: false,
        has_glass: false,
        has_water: false,
    }
}

/// Fog three times as dense on one side of the room as on the other, linear between: a ball reads as much too much on
/// one side of its middle as too little on the other.
#[test]
fn in_uneven_fog() {
    let mut parts = plain().parts();
    let corners = (DVec3::ZERO, DVec3::splat(2.0));
    let grid = Grid::sampled(corners, [8, 4, 4], |p| 0.5 + 0.5 * p.x).unwrap();
    let medium = parts.regions[0].medium.matter().clone();
    parts.regions[0].medium = Heterogeneous::new(medium, Density::grid(grid).unwrap()).into();
    let scene = Scene::new(parts).unwrap();
    assert!(scene.plan().has_heterogeneous);
    layers_of_the_scene_are_those_of_paths(&scene, Indirect::Gathered, &settings(4), 3000, 9);
}

/// A floor of tiles, and a red pane of glass that stands in the room and bends nothing: direct light and photons pass it.
#[test]
fn with_tiles_and_a_stained_pane() {
    let mut parts = plain().parts();
    let tiles = Checker::new([Spectrum::rgb(0.9, 0.7, 0.5), Spectrum::grey(0.1)], [4.0, 4.0]).unwrap();
    parts.objects[0].surface = Surface::Lambertian(Lambertian::textured(Texture::Checker(tiles)));
    let pane = rectangle(DVec3::new(1.0, 0.3, 0.8), DVec3::X * 0.9, DVec3::new(0.0, 0.9, 0.0));
    let red = Filter::new(Spectrum::rgb(0.8, 0.2, 0.1)).unwrap();
    parts.objects.push(Object { shape: Shape::Rectangle(pane), surface: Surface::Filter(red) });
    let scene = Scene::new(parts).unwrap();
    assert!(scene.plan().has_filters);
    layers_of_the_scene_are_those_of_paths(&scene, Indirect::Seen, &settings(1), 2000, 10);
}

/// Fog that emits where it is dense, more in one colour, and a ball of emitting glass in it: no light but theirs.
#[test]
fn lit_by_media_alone() {
    let mut parts = Room { has_glass: true, ..plain() }.parts();
    let corners = (DVec3::ZERO, DVec3::splat(2.0));
    let grid = Grid::sampled(corners, [8, 4, 4], |p| 0.5 + 0.5 * p.x).unwrap();
    let fog = Heterogeneous::new(parts.regions[0].medium.matter().clone(), Density::grid(grid).unwrap());
    let glow = Spectrum::rgb(0.02, 0.01, 0.005);
    parts.regions[0].medium = fog.with_emission_by_density(glow).unwrap().into();
    let glass = homogeneous(Spectrum::grey(0.5), Spectrum::grey(0.5), 0.0).matter().clone();
    parts.interiors[1].medium = Some(glass.with_emission(Spectrum::grey(0.1)).unwrap().into());
    parts.lights.clear();
    let scene = Scene::new(parts).unwrap();
    assert_eq!((scene.named_lights().len(), scene.lights().len()), (0, 2));
    layers_of_the_scene_are_those_of_paths(&scene, Indirect::Gathered, &settings(4), 1500, 11);
}

/// In a white room filled with anything of one temperature, which emits as it absorbs, the radiance is the source function
/// everywhere and along every ray.
#[test]
fn an_isothermal_cavity_is_as_bright_as_its_source() {
    let room = Room { floor: lambertian(Spectrum::ONE), albedo: Spectrum::rgb(0.2, 0.5, 0.8), ..plain() };
    let mut parts = room.parts();
    parts.objects.truncate(6);
    for wall in &mut parts.objects {
        wall.surface = lambertian(Spectrum::ONE);
    }
    parts.lights.clear();
    let corners = (DVec3::ZERO, DVec3::splat(2.0));
    let grid = Grid::sampled(corners, [8, 4, 4], |p| 0.5 + 0.5 * p.x).unwrap();
    let fog = Heterogeneous::new(parts.regions[0].medium.matter().clone(), Density::grid(grid).unwrap());
    let (source, absorbed) = (Spectrum::rgb(1.0, 2.0, 3.0), fog.matter().sigma_a());
    parts.regions[0].medium = fog.with_emission_by_density(source * absorbed).unwrap().into();
    let scene = Scene::new(parts).unwrap();
    let total = source.sum();
    verdict::agrees("paths", &by_paths(&scene, 40 * 400, 13)[6], (total, 0.0), 0.05 * total, 13);
    for (indirect, rays) in [(Indirect::Seen, 1), (Indirect::Gathered, 4)] {
        let maps = layers_of_maps(&scene, &settings(rays), 2000, indirect, 14);
        verdict::agrees(&format!("{indirect:?}"), &maps[6], (total, 0.0), 0.05 * total, 14);
    }
}
