//! Lamps in awkward places: across a boundary, in one place with something else, touching.

use crate::support::run::{histories, numbers, pass, paths};
use crate::support::scenes::{
    area_light, bounded, cuboid, dielectric, filled, homogeneous, lambertian, outflow, rectangle, region,
    sphere, volume_source,
};
use crate::support::verdict;
use glam::{DVec2, DVec3};
use std::f64::consts::PI;
use std::sync::Arc;
use turbid::Spectrum;
use turbid::geometry::{Face, Ground, Rectangle, Shape, Up, Waves, height_field};
use turbid::integrators::mapper::{Mapper, Settings};
use turbid::integrators::{Layer, path};
use turbid::light::{Area, Beam, Light, Section};
use turbid::math::{Frame, Ray, exp};
use turbid::photons::maps::{Indirect, Maps};
use turbid::scene::{Interior, Object, Orders, Quantity, Scene, SceneParts};
use turbid::sensor::sample;
use turbid::surface::{Filter, Mirror, Surface};

const N: u64 = 1 << 16;

fn lamp(shape: Shape) -> Light {
    Light::Area(Area::new(shape, Spectrum::ONE).unwrap())
}

/// A ball of glass that absorbs and scatters, or a box of it, and a lamp.
fn glass(shape: Shape, lamp: Light) -> Scene {
    let medium = homogeneous(Spectrum::grey(2.0), Spectrum::grey(0.3), 0.0);
    Scene::new(SceneParts {
        interiors: vec![Interior::surroundings(), filled("glass", 1.5, medium)],
        objects: vec![Object { shape, surface: dielectric(1, 0) }],
        lights: vec![lamp],
        ..SceneParts::default()
    })
    .unwrap()
}

/// Lamps that stand half in glass: what leaves, and what the glass absorbs, by photons and by paths, which do not know
/// where photons start. What is absorbed is the absorption coefficient times the integral of the fluence.
#[test]
fn a_lamp_across_a_boundary_lights_both_sides() {
    let ball = || sphere(DVec3::ZERO, 1.0);
    let block = || cuboid(DVec3::splat(-1.0), DVec3::splat(1.0));
    let round = |x: f64| lamp(sphere(DVec3::new(x, 0.0, 0.0), 0.4));
    let upright = rectangle(DVec3::new(0.3, -0.5, 0.1), DVec3::X * 1.2, DVec3::Y);
    let cases = [
        ("round in a ball", ball(), round(0.9)),
        ("round in a block", block(), round(1.1)),
        ("flat in a block", block(), area_light(upright, Spectrum::ONE)),
        ("box in a block", block(), lamp(cuboid(DVec3::new(0.7, -0.2, -0.2), DVec3::new(1.2, 0.3, 0.2)))),
    ];
    for (what, shape, lamp) in cases {
        let scene = glass(shape.clone(), lamp);
        let around = outflow(sphere(DVec3::ZERO, 2.5));
        let asked = [(around.clone(), Orders::ALL), (Quantity::Absorbed(0), Orders::ALL)];
        let tallies = pass(&scene, &asked, N, 1, |_| false).tallies;
        let out = paths(&scene, around, Orders::ALL, 4 * N, 2)[0];
        verdict::agree(&format!("{what}, leaves"), &tallies[0][0], &out, 0.1, 1);
        let power = scene.power()[0];
        let absorbed = histories(N, 3, |stream| {
            let (p, volume) = shape.sample_inside(glam::DVec2::ZERO, stream.triple());
            let fluence = sample(&scene, &Quantity::Fluence(p), Orders::ALL, stream);
            fluence * (2.0 * (1.0 - 0.3) * volume / power)
        })[0];
        verdict::agree(&format!("{what}, absorbed"), &tallies[1][0], &absorbed, 0.1, 1);
    }
}

/// Small volume sources far from a white wall that faces them, one behind a filter: outside of them their irradiance is
/// that of a point, power/(4 pi d^2) (Gauss), of a cube but for its octupole. Directions that know nothing of them would
/// meet the ball with one path in 160,000.
#[test]
fn small_volume_sources_are_aimed_at() {
    let (radius, distance) = (0.01, 2.0);
    let at = DVec3::new(0.0, 0.0, distance);
    let cube = cuboid(at - DVec3::splat(radius), at + DVec3::splat(radius));
    let wall = || {
        let floor = rectangle(DVec3::new(-1.0, -1.0, 0.0), DVec3::X * 2.0, DVec3::Y * 2.0);
        (Shape::Rectangle(floor), lambertian(Spectrum::ONE))
    };
    let pane = rectangle(DVec3::new(-1.0, -1.0, 1.5), DVec3::X * 2.0, DVec3::Y * 2.0);
    let pane = (Shape::Rectangle(pane), Surface::Filter(Filter::new(Spectrum::grey(0.25)).unwrap()));
    let cases = [
        ("ball", sphere(at, radius), vec![wall()], 1.0),
        ("cube", cube, vec![wall()], 1.0),
        ("behind a filter", sphere(at, radius), vec![wall(), pane], 0.25),
    ];
    let ray = Ray::new(DVec3::new(0.3, 0.0, 1.0), DVec3::new(-0.3, 0.0, -1.0).normalize());
    for (what, shape, objects, passed) in cases {
        let scene = bounded(Vec::new(), objects, vec![volume_source(shape)]);
        let radiance = passed / (4.0 * PI * PI * distance * distance);
        let by_paths = numbers(N, 4, |stream| path::layers(&scene, ray, None, 0, stream).0[Layer::Direct][0]);
        // Rays to points of the source bring nearly the same: the mean is as good as its distance is many radii, squared.
        let off = (by_paths.mean() - radiance).abs().max(by_paths.std_error());
        let allowed = 4.0 * (radius / distance) * (radius / distance) * radiance;
        assert!(off < allowed, "{what}, paths: {} for {radiance}, {off:e} off", by_paths.mean());
        let maps = Maps::none(Indirect::Gathered);
        let settings = Settings::for_scene(&scene, 100).unwrap();
        let mapper = Mapper::new(&scene, &maps, &settings);
        let by_mapper = numbers(N, 5, |stream| mapper.radiance(ray, None, 0, stream).0[Layer::Direct][0]);
        verdict::agrees(&format!("{what}, photon mapper"), &by_mapper, (radiance, 0.0), 0.04 * radiance, 5);
    }
}

/// A beam a thousandth of a mean free path wide, seen from the side, from behind and along its shaft: single scattering is a
/// closed form. Of free flights one in a thousand would end in it.
#[test]
fn narrow_beams_are_met_by_every_ray_that_crosses_them() {
    let (half, sigma_t, albedo, irradiance) = (5e-4, 1.0, 0.8, 1e3);
    let fog = || vec![region(cuboid(DVec3::splat(-1.0), DVec3::splat(1.0)), sigma_t, albedo, 0.0)];
    let corner = DVec3::new(-half, -half, -2.0);
    let square = Section::Rectangle(rectangle(corner, DVec3::X * 2.0 * half, DVec3::Y * 2.0 * half));
    let round = Section::Disc { center: DVec3::Z * -2.0, radius: half };
    // Origin, direction, and where the ray enters and leaves the beam; light has come to a height h through 1 + h.
    let eyes = [
        ("from the side", DVec3::new(3.0, 0.0, 0.25), DVec3::NEG_X, (3.0 - half, 3.0 + half)),
        (
            "obliquely",
            DVec3::new(0.0, -1.5, -1.5),
            DVec3::new(0.0, 0.6, 0.8),
            (2.5 - half / 0.6, 2.5 + half / 0.6),
        ),
        ("along it", DVec3::new(0.0, 0.0, 3.0), DVec3::NEG_Z, (2.0, 4.0)),
    ];
    for (name, section) in [("square", square), ("round", round)] {
        for (what, origin, dir, (near, far)) in eyes {
            let beam = Light::Beam(Beam::new(DVec3::Z, Spectrum::grey(irradiance), section).unwrap());
            let ray = Ray::new(origin, dir);
            let scene = bounded(fog(), Vec::new(), vec![beam]);
            let enters = scene.regions()[0].shape.interval(&ray).unwrap().start;
            // int of e^(-(1 + z) - (t - enters)) over the beam: an exponential in t.
            let rate = sigma_t * (1.0 + dir.z);
            let at = |t: f64| exp(-sigma_t * (1.0 + origin.z + dir.z * t + t - enters));
            let integral = if rate == 0.0 { at(near) * (far - near) } else { (at(near) - at(far)) / rate };
            let radiance = irradiance * albedo * sigma_t / (4.0 * PI) * integral;
            let by_paths =
                numbers(N, 6, |stream| path::layers(&scene, ray, None, 0, stream).0[Layer::Single][0]);
            let promise = 0.02 * radiance;
            verdict::agrees(&format!("{name}, {what}"), &by_paths, (radiance, 0.0), promise, 6);
        }
    }
}

fn refused(objects: Vec<(Shape, Surface)>, lights: Vec<Light>) -> String {
    let objects = objects.into_iter().map(|(shape, surface)| Object { shape, surface }).collect();
    let interiors =
        vec![Interior::surroundings(), Interior { name: "glass".into(), index: 1.5, medium: None }];
    let names_glass = |o: &Vec<Object>| o.iter().any(|o| matches!(o.surface, Surface::Dielectric(_)));
    let interiors = if names_glass(&objects) { interiors } else { Vec::new() };
    match Scene::new(SceneParts { interiors, objects, lights, ..SceneParts::default() }) {
        Ok(_) => String::new(),
        Err(error) => error.to_string(),
    }
}

fn level(z: f64, half: f64) -> Rectangle {
    rectangle(DVec3::new(-half, -half, z), DVec3::X * 2.0 * half, DVec3::Y * 2.0 * half)
}

/// Which of two surfaces in one place is met would be chance: photons of both lamps leave, a path finds one; a ceiling
/// shades the lamp in it at random.
#[test]
fn surfaces_in_one_place_are_refused() {
    let diffuse = || lambertian(Spectrum::grey(0.5));
    let flat = |z: f64, half: f64| Shape::Rectangle(level(z, half));
    let block = |low: f64, high: f64| cuboid(DVec3::splat(low), DVec3::splat(high));
    let glow = |z: f64, half: f64| area_light(level(z, half), Spectrum::ONE);
    let elsewhere = || vec![glow(9.0, 1.0)];
    let clear = || Surface::Filter(Filter::new(Spectrum::grey(0.5)).unwrap());
    let ball = |radius: f64| sphere(DVec3::new(0.1, 0.2, 0.3), radius);
    // Ground of a side of 2 on a flat bottom at a height, turned with its file's axes.
    let ground = |floor: f64, rms: f64| {
        let waves = Waves::new(1, 2, 0.7, rms).unwrap();
        let ground = Ground { corner: DVec2::splat(-1.0), size: DVec2::splat(2.0), cells: [3, 3] };
        Shape::Mesh(Arc::new(height_field(&ground, Up::Z, Some(floor), |p| waves.height(p)).unwrap()))
    };
    let chance = [
        ("two lamps", vec![], vec![glow(1.0, 1.0), glow(1.0, 0.3)]),
        ("round lamps", vec![], vec![lamp(ball(0.7)), lamp(ball(0.7))]),
        ("lamp in the ceiling of a box", vec![(block(-1.0, 1.0), diffuse())], vec![glow(1.0, 0.3)]),
        ("box of light on a floor", vec![(flat(0.0, 2.0), diffuse())], vec![lamp(block(0.0, 1.0))]),
        ("lamp on glass", vec![(block(-1.0, 1.0), dielectric(1, 0))], vec![glow(1.0, 0.3)]),
        (
            "glass on a floor",
            vec![(flat(0.0, 2.0), diffuse()), (block(0.0, 1.0), dielectric(1, 0))],
            elsewhere(),
        ),
        ("glass in stone", vec![(ball(0.5), diffuse()), (ball(0.5), dielectric(1, 0))], elsewhere()),
        ("a pane on a wall", vec![(flat(0.0, 2.0), diffuse()), (flat(0.0, 1.0), clear())], elsewhere()),
        (
            "two grounds of glass",
            vec![(ground(-1.0, 0.02), clear()), (ground(-1.0, 0.03), clear())],
            elsewhere(),
        ),
        (
            "water on a floor",
            vec![(flat(-1.0, 2.0), diffuse()), (ground(-1.0, 0.0), dielectric(1, 0))],
            elsewhere(),
        ),
        (
            "a pane on a block of facets",
            vec![(ground(-1.0, 0.0), diffuse()), (flat(0.0, 0.3), clear())],
            elsewhere(),
        ),
        (
            "a block of facets beside a pane",
            vec![(flat(-1.0, 0.2), clear()), (ground(-1.0, 0.1), diffuse())],
            elsewhere(),
        ),
        (
            "a picture on a block",
            vec![(flat(1.0, 0.5), diffuse()), (block(-1.0, 1.0), diffuse())],
            elsewhere(),
        ),
    ];
    for (what, objects, lights) in chance {
        let said = refused(objects, lights);
        assert!(said.contains("have surfaces in one place") && said.contains("move one"), "{what}: {said}");
    }
    let mirror = || Surface::Mirror(Mirror::new(Spectrum::ONE).unwrap());
    let right = [
        ("lamp in a ceiling", vec![(flat(1.0, 2.0), diffuse())], vec![glow(1.0, 0.3)]),
        ("a picture on a wall", vec![(flat(0.0, 2.0), diffuse()), (flat(0.0, 1.0), diffuse())], elsewhere()),
        ("lamp below a ceiling", vec![(flat(1.0, 2.0), diffuse())], vec![glow(1.0 - 1e-6, 0.3)]),
        (
            "lamps side by side",
            vec![],
            vec![
                area_light(rectangle(DVec3::ZERO, DVec3::X, DVec3::Y), Spectrum::ONE),
                area_light(rectangle(DVec3::X, DVec3::X, DVec3::Y), Spectrum::ONE),
            ],
        ),
        ("a block on a floor", vec![(flat(0.0, 2.0), diffuse()), (block(0.0, 1.0), mirror())], elsewhere()),
        (
            "a block on a block",
            vec![(block(0.0, 1.0), diffuse()), (cuboid(DVec3::Z, DVec3::new(1.0, 1.0, 2.0)), diffuse())],
            elsewhere(),
        ),
        (
            "facets on a floor",
            vec![(flat(-1.0, 2.0), diffuse()), (ground(-1.0, 0.1), diffuse())],
            elsewhere(),
        ),
        (
            "water above a floor",
            vec![(flat(-1.001, 2.0), diffuse()), (ground(-1.0, 0.1), dielectric(1, 0))],
            elsewhere(),
        ),
        ("balls that touch", vec![(ball(0.5), diffuse()), (ball(0.4), diffuse())], elsewhere()),
    ];
    for (what, objects, lights) in right {
        assert_eq!(refused(objects, lights), "", "{what}");
    }
}

/// A box of light cut in two: the same light outside, though the halves' sides that touch send out power that ends in
/// the other half at once.
#[test]
fn lamps_that_touch_are_one() {
    let half = |low: f64, high: f64| lamp(cuboid(DVec3::new(low, 0.0, 0.0), DVec3::new(high, 1.0, 1.0)));
    let floor = || {
        let floor = Shape::Rectangle(rectangle(DVec3::new(-3.0, -3.0, -1.0), DVec3::X * 6.0, DVec3::Y * 6.0));
        vec![(floor, lambertian(Spectrum::grey(0.5)))]
    };
    let one = bounded(Vec::new(), floor(), vec![half(0.0, 1.0)]);
    let two = bounded(Vec::new(), floor(), vec![half(0.0, 0.4), half(0.4, 1.0)]);
    let around = Quantity::Outflow { shape: sphere(DVec3::ZERO, 6.0), face: Face::Top };
    let leaves = |scene: &Scene, seed| {
        let by_photons = pass(scene, &[(around.clone(), Orders::ALL)], N, seed, |_| false).tallies[0][0];
        let by_paths = paths(scene, around.clone(), Orders::ALL, 4 * N, seed)[0];
        (by_photons, by_paths)
    };
    let ((whole, whole_by_paths), (parts, parts_by_paths)) = (leaves(&one, 4), leaves(&two, 5));
    verdict::agree("whole", &whole, &whole_by_paths, 0.15, 4);
    verdict::agree("in two parts", &parts, &parts_by_paths, 0.15, 5);
    let (a, b) = (whole.mean() * one.power()[0], parts.mean() * two.power()[0]);
    let error = libm::hypot(whole.std_error() * one.power()[0], parts.std_error() * two.power()[0]);
    assert!((a - b).abs() < 5.0 * error, "{a} {b} +- {error}");
}

/// A frame whose axes are no coordinates', so that planes in one place differ by rounding.
fn tilted() -> Frame {
    Frame::new(DVec3::new(0.3, 0.5, 0.8).normalize())
}

/// A square about a point of a height, facing up or down.
fn tilted_level(height: f64, half: f64, is_up: bool) -> Rectangle {
    let Frame { x, y, z } = tilted();
    let (u, v) = if is_up { (x, y) } else { (y, x) };
    rectangle(DVec3::splat(0.1) + z * height - (u + v) * half, u * (2.0 * half), v * (2.0 * half))
}

/// A lamp flush with its ceiling is the lamp a little below it, by photons and by paths: seen from below, where it lights
/// and is met; from above it is dark.
#[test]
fn a_lamp_in_its_ceiling_is_one_below_it() {
    let diffuse = |rectangle| (Shape::Rectangle(rectangle), lambertian(Spectrum::grey(0.6)));
    let room = |gap: f64| {
        let objects = vec![diffuse(tilted_level(1.0, 1.5, true)), diffuse(tilted_level(-0.5, 1.5, true))];
        bounded(Vec::new(), objects, vec![area_light(tilted_level(1.0 - gap, 0.4, false), Spectrum::ONE)])
    };
    let (flush, lowered) = (room(0.0), room(1e-6));
    let around = outflow(sphere(DVec3::splat(0.1), 3.0));
    let asked =
        [(around.clone(), Orders::ALL), (around.clone(), Orders::only(1)), (around.clone(), Orders::only(0))];
    let (in_ceiling, below) =
        (pass(&flush, &asked, N, 6, |_| false), pass(&lowered, &asked, N, 7, |_| false));
    for (i, (_, orders)) in asked.iter().enumerate() {
        let (a, b) = (&in_ceiling.tallies[i][0], &below.tallies[i][0]);
        verdict::agree(&format!("flush and lowered, {orders:?}"), a, b, 0.1, 6);
        let by_paths = paths(&flush, around.clone(), *orders, 4 * N, 8)[0];
        verdict::agree(&format!("photons and paths, {orders:?}"), a, &by_paths, 0.15, 8);
    }
    let Frame { x, y, z } = tilted();
    for height in [0.99, 0.5, -0.4] {
        let place = Quantity::Fluence(DVec3::splat(0.1) + z * height + x * 0.1 + y * 0.2);
        let [a, b] = [&flush, &lowered].map(|scene| paths(scene, place.clone(), Orders::ALL, N, 9)[0]);
        verdict::agree(&format!("fluence at {height}"), &a, &b, 0.2 * b.mean(), 9);
    }
    for i in 0..200 {
        let [u, v] = [f64::from(i % 20) / 19.0, f64::from(i / 20) / 9.0].map(|u| 0.02 + 0.96 * u);
        let target = tilted_level(1.0, 0.4, false).sample([u, v]);
        for (eye, expected) in [(-0.2, 1.0), (2.0, 0.0)] {
            let eye = DVec3::new(0.3, 0.2, 0.1) + z * eye;
            let ray = Ray::new(eye, (target - eye).normalize());
            let seen = paths(&flush, Quantity::Radiance(ray), Orders::only(0), 1, 10)[0].mean();
            assert_eq!(seen, expected, "{u} {v} from {eye}");
        }
    }
}

/// A picture on a wall: whichever comes first is all that is there. Where both are met rounding may differ.
#[test]
fn a_picture_on_a_wall_is_not_shaded_by_it() {
    let picture = (Shape::Rectangle(tilted_level(0.0, 0.4, true)), lambertian(Spectrum::grey(0.8)));
    let wall = (Shape::Rectangle(tilted_level(0.0, 1.0, false)), lambertian(Spectrum::grey(0.3)));
    let lit = |objects: Vec<(Shape, Surface)>| {
        let lamp = sphere(DVec3::splat(0.1) + tilted().z * 1.5, 0.3);
        bounded(Vec::new(), objects, vec![Light::Area(Area::new(lamp, Spectrum::ONE).unwrap())])
    };
    let (alone, hung) = (lit(vec![picture.clone()]), lit(vec![picture.clone(), wall.clone()]));
    let (bare, hidden) = (lit(vec![wall.clone()]), lit(vec![wall, picture]));
    let eye = DVec3::splat(0.1) + tilted().z + DVec3::new(0.4, -0.1, 0.0);
    for i in 0..400 {
        let [u, v] = [f64::from(i % 20) / 19.0, f64::from(i / 20) / 19.0].map(|u| 0.01 + 0.98 * u);
        let target = tilted_level(0.0, 0.4, true).sample([u, v]);
        let ray = Quantity::Radiance(Ray::new(eye, (target - eye).normalize()));
        let direct = |scene| paths(scene, ray.clone(), Orders::only(1), 4, 11)[0].mean();
        for (one, both) in [(&alone, &hung), (&bare, &hidden)] {
            let (one, both) = (direct(one), direct(both));
            assert!(one > 0.0 && (both / one - 1.0).abs() < 1e-9, "{u} {v}: {one} {both}");
        }
    }
}
