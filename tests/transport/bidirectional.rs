//! Bidirectional and guided paths against the path tracer, each class and order, by every kind of light and through every kind of body;
//! against the exact ball with a light in its centre; and in a furnace.

use crate::against_exact::sphere::{light_of, referee};
use crate::against_exact::sphere_fields::scattered;
use crate::checks::connected::{
    a_furnace_of_lamps_is_as_bright_everywhere, two_reflections_are_those_of_paths,
};
use crate::support::run::numbers;
use crate::support::scenes::{
    Incidence, area_light, ball, bounded, cuboid, dielectric, emitting_sphere, faceted_ball, filled,
    homogeneous, isotropic, lambertian, point_light, rectangle, region, slab, sphere,
};
use crate::support::verdict;
use crate::transport::light_tracing::{self, ball_of_glass, by_paths, by_photons, camera, compare};
use glam::DVec3;
use turbid::Spectrum;
use turbid::geometry::Shape;
use turbid::integrators::{Guides, Layer, bidirectional, fluence, path};
use turbid::light::{Beam, Faces, Light, Section, Spot, Sun, VolumeSource};
use turbid::math::{Asymmetry, Ray};
use turbid::medium::{Cloud, CloudShape, Density, Heterogeneous, Homogeneous, Medium};
use turbid::phase::Phase;
use turbid::photons::{Guide, GuideSettings};
use turbid::rng::{Purpose, Stream};
use turbid::scene::{Camera, Filter as PixelFilter, Interior, Object, Orders, Region, Scene, SceneParts};
use turbid::sensor::{Film, Method, Streams};
use turbid::stats::Moments;
use turbid::surface::{Filter, Mirror, Surface, Texture};
use turbid::transport::NoProgress;
use turbid_analytic::SphereSource;

/// Independent batches of samples, and samples of each.
const BATCHES: u64 = 64;
const SAMPLES: u64 = 1000;
/// Orders that are told apart, the last one with all above.
const ORDERS: usize = 6;
/// Numbers by class and order.
const CELLS: usize = Layer::ALL.len() * ORDERS;

type Sample<'a> = dyn Fn(&mut Stream, &mut dyn FnMut(u32, Layer, Spectrum)) + 'a;

/// Means by class and order over batches.
fn batches(seed: u64, sample: &Sample) -> Vec<[Moments; 3]> {
    let mut moments = vec![<[Moments; 3]>::default(); CELLS];
    for batch in 0..BATCHES {
        let mut sums = [Spectrum::ZERO; CELLS];
        for i in 0..SAMPLES {
            let mut stream = Stream::new(seed, Purpose::Paths, 0, batch * SAMPLES + i);
            sample(&mut stream, &mut |order, layer, value| {
                let class = Layer::ALL.iter().position(|l| *l == layer).unwrap();
                sums[class * ORDERS + (order as usize).min(ORDERS - 1)] += value;
            });
        }
        for (m, sum) in moments.iter_mut().zip(sums) {
            (0..3).for_each(|c| m[c].push(sum[c] / SAMPLES as f64));
        }
    }
    moments
}

/// The light that rays from one place bring, by all methods; guided ones take half of their directions from what photons say.
///
/// # Arguments
/// `least` numbers by class, order and channel that must be known well enough to be compared: to a sixteenth of their value
fn agree(what: &str, scene: &Scene, least: usize) {
    let eye = DVec3::new(0.3, 0.1, 0.9);
    let interior = scene.interior_at(eye);
    let ray = |stream: &mut Stream| {
        let off = DVec3::from(stream.triple()) - 0.5;
        Ray::new(eye, (DVec3::new(-0.3, -0.4, -1.8) + off).normalize())
    };
    let paths = batches(1, &|stream, add| {
        let ray = ray(stream);
        path::classes(scene, ray, None, interior, Orders::ALL, stream, add);
    });
    let connected = batches(2, &|stream, add| {
        let ray = ray(stream);
        bidirectional::classes(scene, ray, None, interior, Orders::ALL, stream, add);
    });
    same(&format!("connected, {what}"), &paths, &connected, least);
    let settings = GuideSettings { histories: 20_000, seed: 3, replicate: 0, share: Some(0.5) };
    let guide = Guide::learn(scene, &settings, &NoProgress).unwrap();
    assert!(guide.counts().iter().any(|[_, used]| *used > 4), "{what}: {:?}", guide.counts());
    let guides = Guides { windows: None, learned: Some(&guide) };
    let guided = batches(3, &|stream, add| {
        let ray = ray(stream);
        path::guided_classes(scene, (ray, interior), Orders::ALL, guides, stream, add);
    });
    same(&format!("guided, {what}"), &paths, &guided, least);
}

/// Means by class and order, where they are known well enough.
fn same(what: &str, paths: &[[Moments; 3]], others: &[[Moments; 3]], least: usize) {
    let mut compared = 0;
    for (cell, (a, b)) in paths.iter().zip(others).enumerate() {
        let (layer, order) = (Layer::ALL[cell / ORDERS], cell % ORDERS);
        for channel in 0..3 {
            let (a, b) = (&a[channel], &b[channel]);
            let error = libm::hypot(a.std_error(), b.std_error());
            if a.mean() == 0.0 && b.mean() == 0.0 {
                continue;
            }
            if a.is_heavy_tailed() || b.is_heavy_tailed() || error > b.mean() / 16.0 {
                continue;
            }
            let what = format!("{what}, {} of order {order}, channel {channel}", layer.name());
            verdict::agree(&what, a, b, 0.6 * b.mean(), 1);
            compared += usize::from(order >= 2);
        }
    }
    assert!(compared >= least, "{what}: {compared} numbers compared, at least {least} expected");
}

/// Diffuse walls of a box 2 wide, each of its own colour.
fn walls() -> Vec<Object> {
    let (low, high) = (DVec3::splat(-1.0), DVec3::splat(1.0));
    let [x, y, z] = DVec3::AXES.map(|axis| axis * 2.0);
    let walls = [(low, x, z), (low, y, x), (high, -y, -x), (low, z, y), (high, -z, -y)];
    let wall = |(i, (corner, u, v)): (usize, (DVec3, DVec3, DVec3))| {
        let color = Spectrum::rgb(0.5, 0.4 + 0.1 * i as f64, 0.3);
        Object { shape: Shape::Rectangle(rectangle(corner, u, v)), surface: lambertian(color) }
    };
    walls.into_iter().enumerate().map(wall).collect()
}

fn fog() -> Region {
    let medium = homogeneous(Spectrum::rgb(0.7, 0.5, 1.5), Spectrum::rgb(0.8, 0.9, 0.7), 0.4);
    Region { shape: cuboid(DVec3::splat(-1.0), DVec3::splat(1.0)), medium }
}

fn lamp() -> Light {
    let shape = rectangle(DVec3::new(-0.4, 0.9, -0.4), DVec3::X * 0.8, DVec3::Z * 0.8);
    area_light(shape, Spectrum::rgb(3.0, 2.0, 1.0))
}

fn room(lights: Vec<Light>) -> SceneParts {
    SceneParts { regions: vec![fog()], objects: walls(), lights, ..SceneParts::default() }
}

fn object(shape: Shape, surface: Surface) -> Object {
    Object { shape, surface }
}

/// A room open above, with fog: a large lamp and a small one, a cone of light, a shaft, and the sun with and without a disc. Of
/// a point light paths know too little to be compared with: the ball below does.
#[test]
fn a_foggy_room_by_every_light() {
    let (down, at) = (DVec3::new(0.3, -1.0, 0.1), DVec3::new(0.0, 0.5, 0.2));
    let scene = |lights| Scene::new(room(lights)).unwrap();
    agree("lamps", &scene(vec![lamp(), emitting_sphere(at, 0.1)]), 20);
    let spot = Spot::new(at, down, (20.0, 40.0), Spectrum::rgb(1.0, 2.0, 0.5)).unwrap();
    agree("spot", &scene(vec![Light::Spot(spot), lamp()]), 10);
    let section = Section::Disc { center: at, radius: 0.3 };
    agree("beam", &scene(vec![Light::Beam(Beam::new(down, Spectrum::ONE, section).unwrap())]), 5);
    for angle in [0.0, 10.0] {
        let sun = Light::Sun(Sun::new(down, Spectrum::rgb(1.0, 2.0, 0.5), angle).unwrap());
        agree(&format!("sun {angle}"), &scene(vec![sun]), 10);
    }
}

/// No medium at all: walls and a ball of triangles that scatter about the normals of a sphere.
#[test]
fn a_clear_room_with_a_smooth_mesh() {
    let mut parts = SceneParts { regions: Vec::new(), ..room(vec![lamp()]) };
    parts.objects.push(object(
        faceted_ball(DVec3::new(-0.1, -0.4, 0.0), 0.5, 1, true),
        lambertian(Spectrum::rgb(0.7, 0.8, 0.9)),
    ));
    agree("mesh", &Scene::new(parts).unwrap(), 10);
}

/// Foggy glass, a mirror, a body of the surroundings' index, a filter before the lamp, and a cloud; the eye outside, and in the glass.
#[test]
fn through_glass_mirror_filter_and_cloud() {
    let phase = || Phase::with_asymmetry(Asymmetry::try_from(0.5).unwrap());
    let puffs = Homogeneous::new(Spectrum::grey(4.0), Spectrum::grey(0.9), phase()).unwrap();
    let cloud = Cloud::new(CloudShape::plain(DVec3::new(-0.5, 0.3, -0.5), DVec3::splat(0.3))).unwrap();
    let puffs = Heterogeneous::new(puffs, Density::Cloud(cloud.into()));
    let medium = |sigma_t: Spectrum| homogeneous(sigma_t, Spectrum::grey(0.9), 0.3);
    let glass = |at, radius| object(sphere(at, radius), dielectric(1, 0));
    let panes = Texture::constant("transmittance", Spectrum::rgb(0.9, 0.5, 0.7)).unwrap();
    let pane = rectangle(DVec3::new(-0.5, 0.7, -0.5), DVec3::X, DVec3::Z);
    for (what, at, radius) in
        [("before", DVec3::new(0.0, -0.5, -0.1), 0.4), ("in it", DVec3::new(0.3, 0.1, 0.7), 0.28)]
    {
        let mut parts = room(vec![lamp(), emitting_sphere(DVec3::new(0.3, 0.3, -0.3), 0.1)]);
        parts.interiors = vec![
            Interior::surroundings(),
            filled("glass", 1.5, medium(Spectrum::rgb(1.0, 2.0, 3.0))),
            filled("drop", 1.0, medium(Spectrum::grey(3.0))),
        ];
        parts.regions.push(Region {
            shape: sphere(DVec3::new(-0.5, 0.3, -0.5), 0.3),
            medium: Medium::from(puffs.clone()),
        });
        parts.objects[0].surface = Surface::Mirror(Mirror::new(Spectrum::rgb(0.9, 0.8, 0.7)).unwrap());
        parts.objects.push(glass(at, radius));
        parts.objects.push(object(sphere(DVec3::new(0.65, -0.2, -0.4), 0.3), dielectric(2, 0)));
        parts.objects.push(object(Shape::Rectangle(pane), Surface::Filter(Filter::textured(panes.clone()))));
        agree(&format!("glass, the eye {what}"), &Scene::new(parts).unwrap(), 10);
    }
}

/// Lights that no subpath starts from are the path tracer's, beside one from which some do.
#[test]
fn what_fills_space_is_found_as_by_paths() {
    let block = cuboid(DVec3::new(-0.6, -0.8, -0.6), DVec3::new(-0.2, -0.3, 0.0));
    let source = Light::VolumeSource(VolumeSource::new(block, Spectrum::rgb(1.0, 2.0, 3.0)).unwrap());
    let mut parts =
        room(vec![lamp(), source, isotropic(cuboid(DVec3::splat(-2.0), DVec3::splat(2.0)), Faces::Both)]);
    let glowing = Homogeneous::new(
        Spectrum::grey(2.0),
        Spectrum::grey(0.5),
        Phase::with_asymmetry(Asymmetry::try_from(0.0).unwrap()),
    );
    let glowing = glowing.unwrap().with_emission(Spectrum::rgb(3.0, 1.0, 0.5)).unwrap();
    parts.regions.push(Region { shape: sphere(DVec3::new(0.4, 0.2, -0.2), 0.25), medium: glowing.into() });
    agree("fillings", &Scene::new(parts).unwrap(), 20);
}

#[test]
fn a_furnace_of_lamps() {
    a_furnace_of_lamps_is_as_bright_everywhere();
}

#[test]
fn two_reflections() {
    two_reflections_are_those_of_paths();
}

/// A point light in the centre of a ball of fog: what leaves it, scattered any number of times, where paths have hardly a variance.
#[test]
fn a_point_light_in_a_ball_of_fog() {
    for (radius, albedo, n) in [(0.5, 1.0, 1 << 16), (1.0, 0.9, 1 << 16), (5.0, 0.99, 1 << 14)] {
        let scene = ball(radius, albedo, 0.0, light_of(SphereSource::Centre, radius));
        let exact = referee(radius, albedo, SphereSource::Centre);
        for mu in [0.2f64, 0.6] {
            let dir = DVec3::new(((1.0 - mu) * (1.0 + mu)).sqrt(), 0.0, -mu);
            let ray = Ray::new(DVec3::new(0.0, 0.0, radius), dir);
            let moments = numbers(n, 3, |stream| {
                let mut sum = 0.0;
                bidirectional::classes(&scene, ray, None, 0, Orders::SCATTERED, stream, |_, _, v| {
                    sum += v[0]
                });
                sum
            });
            let (value, error) = scattered(&exact, mu);
            let what = format!("mu {mu}, radius {radius}, albedo {albedo}");
            verdict::agrees(&what, &moments, (value, error), 0.25 * value, 3);
        }
    }
}

/// A range of orders is that part of all, in radiance and in fluence.
#[test]
fn orders_are_a_part_of_all() {
    let scene =
        Scene::new(room(vec![lamp(), point_light(DVec3::new(0.0, 0.4, 0.0), Spectrum::ONE)])).unwrap();
    let (eye, dir) = (DVec3::new(0.3, 0.1, 0.9), DVec3::new(0.1, -0.3, -0.9).normalize());
    let sum = |orders: Orders, kept: Orders, seed: u64| {
        numbers(1 << 14, seed, |stream| {
            let mut sum = 0.0;
            let mut add = |order: u32, _: Layer, value: Spectrum| {
                assert!(orders.contains(order));
                sum += if kept.contains(order) { value[0] } else { 0.0 };
            };
            bidirectional::classes(&scene, Ray::new(eye, dir), None, 0, orders, stream, &mut add);
            sum
        })
    };
    for orders in [Orders::only(2), Orders::only(3), Orders { min: 2, max: Some(4) }] {
        let (part, all) = (sum(orders, orders, 1), sum(Orders::ALL, orders, 2));
        verdict::agree(&format!("{orders:?}"), &part, &all, 0.3 * all.mean(), 1);
    }
    let at = DVec3::new(0.2, -0.3, 0.4);
    for orders in [Orders::only(0), Orders::only(2), Orders { min: 0, max: Some(4) }] {
        let connected = numbers(1 << 14, 3, |stream| {
            let mut sum = 0.0;
            bidirectional::fluence(&scene, at, orders, stream, |_, value| sum += value[0]);
            sum
        });
        let paths = numbers(1 << 15, 4, |stream| {
            let mut sum = 0.0;
            fluence(&scene, at, orders, Guides::default(), stream, |_, value| sum += value[0]);
            sum
        });
        verdict::agree(&format!("fluence {orders:?}"), &connected, &paths, 0.5 * connected.mean(), 3);
    }
}

/// Pictures, whose caustics and whatever is scattered twice or more photons bring to the camera as well: each class in a foggy room from
/// outside and, by the filter that reaches into other pixels, from within; and below a ball of glass without fog and with it.
#[test]
fn pictures_are_those_of_paths() {
    let films = |scene: &Scene, camera: &Camera, samples: u64| -> Vec<Film> {
        let film = |replicate| {
            let streams = Streams { seed: 2, replicate };
            Method::Bidirectional(scene).render(camera, samples, streams, &NoProgress).unwrap()
        };
        (0..BATCHES).map(film).collect()
    };
    let scene = light_tracing::room();
    for (what, z, filter) in [("outside", 1.8, PixelFilter::Box), ("within", 0.9, PixelFilter::Tent)] {
        let camera = camera(DVec3::new(0.3, 0.1, z), DVec3::new(0.0, 0.0, -0.4), 50.0, filter);
        let (paths, connected) = (by_paths(&scene, &camera, 32), films(&scene, &camera, 16));
        for layer in [Layer::Indirect, Layer::Multiple] {
            (0..3).for_each(|channel| compare(what, &paths, &connected, layer, channel));
        }
        compare(what, &paths, &connected, Layer::Single, 0);
    }
    let (scene, camera) = ball_of_glass(0.0);
    let (paths, connected) = (by_paths(&scene, &camera, 64), films(&scene, &camera, 64));
    for layer in [Layer::Direct, Layer::Caustic] {
        compare("ball", &paths, &connected, layer, 0);
    }
    let photons = by_photons(&scene, &camera, 10_000);
    compare("ball by photons", &photons, &connected, Layer::Caustic, 0);
    let (scene, camera) = ball_of_glass(0.5);
    let (paths, connected) = (by_paths(&scene, &camera, 64), films(&scene, &camera, 32));
    for layer in [Layer::Indirect, Layer::Multiple] {
        compare("ball in fog", &paths, &connected, layer, 0);
    }
}

/// A film of n samples is the same in one call and in three, on one thread and on two.
#[test]
fn the_same_bits_on_any_number_of_threads_and_in_any_number_of_passes() {
    let (scene, camera) = ball_of_glass(0.5);
    let in_calls = |threads: usize, calls: &[u64]| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let (mut film, streams) = (Film::new(8, 8), Streams { seed: 3, replicate: 1 });
        let method = Method::Bidirectional(&scene);
        pool.install(|| {
            for samples in calls {
                method.extend(&mut film, &camera, *samples, streams, &NoProgress).unwrap();
            }
        });
        film
    };
    let whole = in_calls(2, &[40]);
    assert!(whole.samples() == 40 && whole == in_calls(1, &[1, 30, 9]));
}

/// A periodic cell is refused, in words; everything else is not.
#[test]
fn cells_are_refused() {
    let text = bidirectional::check(&slab(1.0, 0.9, 0.0, Incidence::Beam(1.0))).unwrap_err().to_string();
    assert!(text.contains("periodic cell") && text.contains("allowed: "), "{text}");
    let open = bounded(vec![region(sphere(DVec3::ZERO, 1.0), 1.0, 0.9, 0.0)], Vec::new(), vec![lamp()]);
    assert!(bidirectional::check(&open).is_ok());
}
