//! Refraction: the cavity, the slab between refracting faces, nested boundaries.

use crate::checks::glass;
use crate::checks::glass::{faces, referee};
use crate::support::run::{pass, paths, tallies};
use crate::support::scenes::{
    CELL, Incidence, area_light, around, bounded, cuboid, dielectric, filled, fresnel_slab, homogeneous,
    incidence, isotropic, lambertian, layer, outflow, point_light, rectangle, region, sphere,
};
use crate::support::verdict;
use glam::{DVec2, DVec3};
use std::f64::consts::PI;
use turbid::Spectrum;
use turbid::geometry::{Shape, Slab};
use turbid::light::{Faces, Light};
use turbid::math::Ray;
use turbid::scene::{Interior, Object, Orders, Quantity, Scene, SceneParts};
use turbid::surface::{Filter, Surface};
use turbid_analytic::{Ground, Layer, Phase, StratifiedSlab};

#[test]
fn a_cavity_is_brighter_by_the_squared_index() {
    glass::a_cavity_is_brighter_by_the_squared_index();
}

#[test]
fn photons_in_a_cavity_collide_as_its_fluence() {
    glass::photons_in_a_cavity_collide_as_its_fluence();
}

#[test]
fn photons_cross_a_refracting_slab() {
    glass::photons_cross_a_refracting_slab();
}

/// Paths find light with an extent only: Lambertian incidence, by radiance that arrives at the faces of the layer around.
#[test]
fn paths_cross_a_refracting_slab() {
    for (tau, albedo, g, index) in [(1.0, 0.9, 0.0, 1.5), (2.0, 1.0, -0.5, 1.33), (0.3, 0.5, 0.75, 2.0)] {
        let exact = referee(tau, albedo, g, index, Incidence::Diffuse);
        let scene = fresnel_slab(tau, albedo, g, index, Incidence::Diffuse);
        let what = format!("tau {tau}, albedo {albedo}, g {g}, n {index}");
        for (name, quantity, value) in [
            ("R", faces(tau)[0].clone(), exact.reflectance()),
            ("T", faces(tau)[1].clone(), exact.transmittance()),
        ] {
            let moments = paths(&scene, quantity, Orders::ALL, 1 << 16, 4)[0];
            verdict::agrees(&format!("{name}, {what}"), &moments, (value.value, value.error), 0.02, 4);
        }
    }
}

/// A slab between two layers of another index: clear plates of glass, and a scattering layer on either side; photons against
/// the adding of layers. As a slab of one index it is another one.
#[test]
fn photons_cross_plates_of_another_index() {
    let plates = Layers { depth: 0.1, index: 1.5, medium: None };
    let skin = Layers { depth: 0.3, index: 1.33, medium: Some((1.0, 0.9, 0.5)) };
    for (outer, index, (tau, albedo, g), how) in [
        (plates, 1.2, (1.0, 0.9, 0.5), Incidence::Beam(0.4)),
        (skin, 1.7, (1.0, 0.5, 0.0), Incidence::Diffuse),
    ] {
        let whole = 2.0 * outer.depth + tau;
        let medium = |(sigma_t, albedo, g): (f64, f64, f64)| {
            homogeneous(Spectrum::grey(sigma_t), Spectrum::grey(albedo), g)
        };
        let inner = Shape::Slab(Slab::new(outer.depth, tau).unwrap());
        let scene = Scene::new(SceneParts {
            interiors: vec![
                Interior::surroundings(),
                Interior { name: "outer".into(), index: outer.index, medium: outer.medium.map(medium) },
                filled("inner", index, medium((1.0, albedo, g))),
            ],
            objects: vec![
                Object { shape: layer(whole), surface: dielectric(1, 0) },
                Object { shape: inner, surface: dielectric(2, 1) },
            ],
            lights: vec![incidence(around(whole), how)],
            cell: Some(DVec2::splat(CELL)),
            ..SceneParts::default()
        })
        .unwrap();
        let exact = |outer_index: f64| {
            let of = |tau: f64, albedo: f64, g: f64, index: f64| {
                let phase = Phase::henyey_greenstein(g).unwrap();
                Layer::new(tau, albedo, &phase).unwrap().refracting(index).unwrap()
            };
            let beside = match outer.medium {
                Some((sigma_t, albedo, g)) => of(sigma_t * outer.depth, albedo, g, outer_index),
                None => Layer::plate(outer_index).unwrap(),
            };
            let layers = [beside.clone(), of(tau, albedo, g, index), beside];
            let light = match how {
                Incidence::Beam(mu0) => turbid_analytic::Incidence::Beam { mu0 },
                _ => turbid_analytic::Incidence::Diffuse,
            };
            let slab = StratifiedSlab::new(&layers, Ground::black(), Some(light)).unwrap();
            [slab.reflectance(), slab.transmittance().unwrap(), slab.absorptance(1).unwrap()]
        };
        let number = usize::from(outer.medium.is_some());
        let [r, t] = faces(whole).map(|quantity| (quantity, Orders::ALL));
        let measured = tallies(&scene, &[r, t, (Quantity::Absorbed(number), Orders::ALL)], 1 << 16, 12);
        let (right, wrong) = (exact(outer.index), exact(index));
        for (i, name) in ["R", "T", "A"].into_iter().enumerate() {
            let what = format!("{name} between layers of index {}", outer.index);
            verdict::agrees(&what, &measured[i][0], (right[i].value, right[i].error), 0.015, 12);
        }
        verdict::rejects("R of one index", &measured[0][0], wrong[0].value, 12);
    }
}

/// What lies on either side of a slab: extinction, albedo and g of its medium, if it has one.
struct Layers {
    depth: f64,
    index: f64,
    medium: Option<(f64, f64, f64)>,
}

/// A ball in a ball, cognac in glass: each has the brightness of its own index, whatever lies around it; and a point
/// knows where it is.
#[test]
fn nested_boundaries_have_each_their_brightness() {
    let fog = |sigma_t: f64| homogeneous(Spectrum::grey(sigma_t), Spectrum::ONE, 0.2);
    let (glass, cognac) = (1.5, 1.36);
    let scene = Scene::new(SceneParts {
        interiors: vec![
            Interior::surroundings(),
            filled("glass", glass, fog(0.4)),
            filled("cognac", cognac, fog(0.8)),
        ],
        objects: vec![
            Object { shape: sphere(DVec3::ZERO, 1.0), surface: dielectric(1, 0) },
            Object { shape: sphere(DVec3::new(0.1, 0.0, 0.2), 0.5), surface: dielectric(2, 1) },
        ],
        lights: vec![isotropic(sphere(DVec3::ZERO, 1.5), Faces::Both)],
        ..SceneParts::default()
    })
    .unwrap();
    for (p, number, index) in [
        (DVec3::new(0.1, 0.1, 0.2), 2, cognac),
        (DVec3::new(-0.7, 0.1, 0.0), 1, glass),
        (DVec3::new(0.0, -1.2, 0.1), 0, 1.0),
    ] {
        assert_eq!(scene.interior_at(p), number);
        let moments = paths(&scene, Quantity::Fluence(p), Orders::ALL, 500, 7)[0];
        let expected = 4.0 * index * index;
        let off = (moments.mean() - expected).abs().max(moments.std_error());
        assert!(off < 1e-12 * expected, "{p}: {} for {expected}", moments.mean());
    }
}

/// Fog about a ball of glass does not fill it: light from the middle passes the shell alone, e^-1, however often it is
/// reflected at the boundary on its way.
#[test]
fn a_region_does_not_count_inside() {
    let scene = Scene::new(SceneParts {
        regions: vec![region(sphere(DVec3::ZERO, 2.0), 1.0, 0.0, 0.0)],
        interiors: vec![
            Interior::surroundings(),
            Interior { name: "glass".into(), index: 2.4, medium: None },
        ],
        objects: vec![Object { shape: sphere(DVec3::ZERO, 1.0), surface: dielectric(1, 0) }],
        lights: vec![point_light(DVec3::ZERO, Spectrum::ONE)],
        ..SceneParts::default()
    })
    .unwrap();
    let sensors = [(outflow(sphere(DVec3::ZERO, 2.0)), Orders::ALL), (Quantity::Absorbed(0), Orders::ALL)];
    let tallies = tallies(&scene, &sensors, 1 << 16, 8);
    let transmitted = turbid::math::exp(-1.0);
    verdict::agrees("through the shell", &tallies[0][0], (transmitted, 1e-15), 0.02, 8);
    verdict::agrees("in the shell", &tallies[1][0], (1.0 - transmitted, 1e-15), 0.02, 8);
}

/// A filter is no event: light of order 0 behind it is light of order 0, in the filter's colour. A lamp that is met by
/// chance and aimed at keeps its balance through it: what the two bring is the exact irradiance times the colour.
#[test]
fn a_filter_colors_and_is_no_event() {
    let color = Spectrum::rgb(0.3, 1.0, 0.6);
    let filter = |color| Surface::Filter(Filter::new(color).unwrap());
    let shell = sphere(DVec3::ZERO, 1.0);
    let scene = bounded(
        Vec::new(),
        vec![(shell, filter(color))],
        vec![point_light(DVec3::new(0.2, 0.0, -0.3), Spectrum::ONE)],
    );
    let out = (outflow(sphere(DVec3::ZERO, 1.5)), Orders::only(0));
    let transmitted = &tallies(&scene, &[out], 1 << 16, 9)[0];
    verdict::agrees("red", &transmitted[0], (0.3, 0.0), 0.03, 9);
    assert!((transmitted[1].mean() - 1.0).abs() < 0.02 && (transmitted[2].mean() - 0.6).abs() < 0.02);
    // A floor under a lamp of radiance 1, with and without filters between; the lamp is 2 x 2 at height 1.
    let lamp =
        || area_light(rectangle(DVec3::new(-1.0, 1.0, 1.0), DVec3::X * 2.0, -DVec3::Y * 2.0), Spectrum::ONE);
    let pane =
        |z: f64| Shape::Rectangle(rectangle(DVec3::new(-9.0, -9.0, z), DVec3::X * 18.0, DVec3::Y * 18.0));
    let eye = DVec3::new(-1.0, 0.0, 0.2);
    let look = Quantity::Radiance(Ray::new(eye, (-eye).normalize()));
    let seen = |panes: &[(f64, Spectrum)]| {
        let mut objects = vec![(pane(0.0), lambertian(Spectrum::grey(0.5)))];
        objects.extend(panes.iter().map(|(z, color)| (pane(*z), filter(*color))));
        paths(&bounded(Vec::new(), objects, vec![lamp()]), look.clone(), Orders::ALL, 1 << 16, 10)
    };
    // View factor of a square of side 2 at height 1 from under its middle: four times that of its quarter's corner
    // (Howell, Menguc and Siegel, configuration factor B-4, both sides over the height 1).
    let root = 2.0f64.sqrt();
    let factor = 4.0 * 2.0 * turbid::math::atan2(1.0, root) / root / (2.0 * PI);
    let expected = 0.5 * factor;
    verdict::agrees("bare", &seen(&[])[0], (expected, 1e-14), 0.02 * expected, 10);
    let clear = seen(&[(0.5, Spectrum::ONE), (0.7, Spectrum::ONE)]);
    verdict::agrees("through clear panes", &clear[0], (expected, 1e-14), 0.02 * expected, 10);
    let dim = seen(&[(0.5, color), (0.7, Spectrum::grey(0.5))]);
    for c in 0..3 {
        let value = expected * color[c] * 0.5;
        verdict::agrees("through colored panes", &dim[c], (value, 1e-14), 0.03 * value, 10);
    }
}

/// Light that starts in a cube of glass and is reflected totally for ever is given up, and booked; the rest comes out:
/// what leaves a cube is what lies in the six cones of escape, which do not meet for an index above root 2.
#[test]
fn light_caught_in_a_cube_is_booked() {
    let index = 1.6f64;
    let scene = Scene::new(SceneParts {
        interiors: vec![Interior::surroundings(), Interior { name: "glass".into(), index, medium: None }],
        objects: vec![Object {
            shape: cuboid(DVec3::splat(-1.0), DVec3::splat(1.0)),
            surface: dielectric(1, 0),
        }],
        lights: vec![point_light(DVec3::new(0.1, 0.2, -0.3), Spectrum::ONE)],
        ..SceneParts::default()
    })
    .unwrap();
    let out = (outflow(sphere(DVec3::ZERO, 3.0)), Orders::ALL);
    let pass = pass(&scene, &[out], 2300, 11, |_| false);
    let cone = 0.5 * (1.0 - (1.0 - 1.0 / (index * index)).sqrt());
    verdict::agrees("out of the cube", &pass.tallies[0][0], (6.0 * cone, 1e-15), 0.08, 11);
    let ledger = &pass.report.ledger;
    let booked = ledger.escaped + ledger.absorbed + ledger.truncated;
    assert!((booked / ledger.emitted - 1.0).abs() < 1e-12 && ledger.absorbed == 0.0);
}

/// What does not fit together is refused, with the names of what is wrong.
#[test]
fn boundaries_that_do_not_fit_are_refused() {
    let named = |name: &str| Interior { name: name.into(), index: 1.5, medium: None };
    let ball = |radius: f64| sphere(DVec3::ZERO, radius);
    let refused = |interiors: Vec<Interior>, objects: Vec<(Shape, Surface)>, light: Light| {
        let objects = objects.into_iter().map(|(shape, surface)| Object { shape, surface }).collect();
        let interiors = [vec![Interior::surroundings()], interiors].concat();
        let parts = SceneParts { interiors, objects, lights: vec![light], ..SceneParts::default() };
        Scene::new(parts).map(|_| ()).unwrap_err().to_string()
    };
    let lamp = || point_light(DVec3::new(0.0, 0.0, 5.0), Spectrum::ONE);
    let cases = [
        (refused(vec![named("glass")], Vec::new(), lamp()), "glass has no boundary"),
        (
            refused(vec![named("glass"), named("glass")], vec![(ball(1.0), dielectric(1, 0))], lamp()),
            "two interiors",
        ),
        (refused(vec![named("glass")], vec![(ball(1.0), dielectric(1, 1))], lamp()), "on both sides"),
        (
            refused(
                vec![named("glass")],
                vec![(ball(1.0), dielectric(1, 0)), (ball(2.0), dielectric(4, 0))],
                lamp(),
            ),
            "not there",
        ),
        (
            refused(
                vec![named("glass"), named("wine")],
                vec![(ball(2.0), dielectric(1, 0)), (ball(1.0), dielectric(2, 0))],
                lamp(),
            ),
            "the same on both",
        ),
        (
            refused(
                vec![Interior { index: 0.9, ..named("bubble") }],
                vec![(ball(1.0), dielectric(1, 0))],
                lamp(),
            ),
            "index of refraction of interior bubble is 0.9; allowed: 1 to 1000",
        ),
        (
            refused(
                vec![named("glass")],
                vec![(ball(1.0), dielectric(1, 0))],
                isotropic(ball(1.0), Faces::Both),
            ),
            "outside every dielectric surface",
        ),
    ];
    for (message, words) in cases {
        assert!(message.contains(words), "{message}: {words}");
    }
}
