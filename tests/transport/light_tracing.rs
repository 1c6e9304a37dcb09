//! Light tracing against the path tracer, on every class of light that both sample.

use crate::support::scenes::{
    area_light, bounded, cuboid, dielectric, filled, homogeneous, lambertian, rectangle,
};
use crate::support::{scenes, verdict};
use glam::DVec3;
use turbid::Spectrum;
use turbid::geometry::Shape;
use turbid::integrators::Layer;
use turbid::scene::{Camera, Filter, Interior, Object, Scene, SceneParts, View};
use turbid::sensor::{Film, Method, Streams, by_light};
use turbid::stats::Moments;
use turbid::surface::Surface;
use turbid::transport::NoProgress;

const SIDE: u32 = 8;
/// Independent pictures of each kind.
const FILMS: u64 = 64;

/// A box 2 wide, open in front, its walls of different colours, with a light below its ceiling and fog in it.
pub(super) fn room() -> Scene {
    let (x, y, z) = (DVec3::X * 2.0, DVec3::Y * 2.0, DVec3::Z * 2.0);
    let (low, high) = (DVec3::splat(-1.0), DVec3::splat(1.0));
    let diffuse = |shape, r, g, b| (Shape::Rectangle(shape), lambertian(Spectrum::rgb(r, g, b)));
    let objects = vec![
        diffuse(rectangle(low, x, z), 0.8, 0.7, 0.6),
        diffuse(rectangle(high, -x, -z), 0.7, 0.7, 0.7),
        diffuse(rectangle(low, y, x), 0.7, 0.7, 0.7),
        diffuse(rectangle(low, z, y), 0.6, 0.1, 0.1),
        diffuse(rectangle(high, -z, -y), 0.1, 0.4, 0.2),
    ];
    let light = rectangle(DVec3::new(-0.4, 0.9, -0.4), DVec3::X * 0.8, DVec3::Z * 0.8);
    let fog = scenes::region(cuboid(low, high), 0.5, 0.8, 0.5);
    bounded(vec![fog], objects, vec![area_light(light, Spectrum::rgb(3.0, 2.0, 1.0))])
}

pub(super) fn camera(position: DVec3, look_at: DVec3, fov: f64, filter: Filter) -> Camera {
    let up = DVec3::new(0.1, 1.0, 0.0);
    Camera::new(View { position, look_at, up, fov, width: SIDE, height: SIDE, filter }).unwrap()
}

/// Means over a quarter of the picture of a class and channel, a film each; over the whole picture without one.
fn mean(films: &[Film], layer: Layer, channel: usize, quarter: Option<u32>) -> Moments {
    let half = SIDE / 2;
    let is_in = |x: u32, y: u32| quarter.is_none_or(|q| (x / half, y / half) == (q % 2, q / 2));
    let places: Vec<(u32, u32)> =
        (0..SIDE).flat_map(|y| (0..SIDE).map(move |x| (x, y))).filter(|(x, y)| is_in(*x, *y)).collect();
    let mut moments = Moments::new();
    for film in films {
        let sum: f64 = places.iter().map(|(x, y)| film.pixel(*x, *y).layers()[layer][channel]).sum();
        moments.push(sum / places.len() as f64);
    }
    moments
}

/// The same light in both, in each quarter of the picture and more closely in the whole.
pub(super) fn compare(what: &str, paths: &[Film], photons: &[Film], layer: Layer, channel: usize) {
    for (part, promise) in [(None, 0.2), (Some(0), 0.4), (Some(1), 0.4), (Some(2), 0.4), (Some(3), 0.4)] {
        let what = format!("{what} {} {part:?} {channel}", layer.name());
        let (a, b) = (mean(paths, layer, channel, part), mean(photons, layer, channel, part));
        verdict::agree(&what, &a, &b, promise * a.mean(), 1);
    }
}

pub(super) fn by_paths(scene: &Scene, camera: &Camera, samples: u64) -> Vec<Film> {
    let film =
        |replicate| Method::Paths(scene).render(camera, samples, Streams { seed: 1, replicate }, &NoProgress);
    (0..FILMS).map(|replicate| film(replicate).unwrap()).collect()
}

pub(super) fn by_photons(scene: &Scene, camera: &Camera, histories: u64) -> Vec<Film> {
    let film = |replicate| by_light(scene, camera, histories, 1, Streams { seed: 1, replicate }, &NoProgress);
    (0..FILMS).map(|replicate| film(replicate).unwrap()).collect()
}

/// Each class and channel. The eye is outside the fog: light scattered close to an eye in it has a heavy tail, whatever
/// the distances are chosen by (the second moment of 1/distance of flights to a point diverges like a logarithm).
#[test]
fn a_room_of_fog_is_the_same_from_both_ends() {
    let scene = room();
    let camera = camera(DVec3::new(0.3, 0.1, 1.8), DVec3::new(0.0, 0.0, -0.4), 50.0, Filter::Box);
    let (paths, photons) = (by_paths(&scene, &camera, 20), by_photons(&scene, &camera, 5000));
    for layer in [Layer::Direct, Layer::Indirect, Layer::Single, Layer::Multiple] {
        (0..3).for_each(|channel| compare("room", &paths, &photons, layer, channel));
    }
    // A picture upside down would be seen: the light is above, so that its half has more single scattering.
    let above = mean(&photons, Layer::Single, 0, Some(0));
    verdict::differ("upside down", &above, &mean(&paths, Layer::Single, 0, Some(2)), 1);
}

/// Surfaces seen from within the fog, by the filter whose samples reach into the pixels beside theirs.
#[test]
fn walls_seen_from_within_fog() {
    let scene = room();
    let camera = camera(DVec3::new(0.3, 0.1, 0.95), DVec3::new(0.0, 0.0, -0.4), 70.0, Filter::Tent);
    let (paths, photons) = (by_paths(&scene, &camera, 16), by_photons(&scene, &camera, 4000));
    compare("walls", &paths, &photons, Layer::Direct, 0);
    compare("walls", &paths, &photons, Layer::Indirect, 1);
}

/// A floor with a ball of glass above it, below a lamp, in fog of this extinction; and a camera at its side, below the ball's middle: the spot
/// on the floor is seen below the ball.
pub(super) fn ball_of_glass(sigma_t: f64) -> (Scene, Camera) {
    let (x, z) = (DVec3::X * 4.0, DVec3::Z * 4.0);
    let floor = Shape::Rectangle(rectangle(DVec3::new(-2.0, 0.0, -2.0), x, z));
    let ball = scenes::sphere(DVec3::new(0.0, 0.7, 0.0), 0.5);
    let light = rectangle(DVec3::new(-0.7, 3.0, -0.7), DVec3::X * 1.4, DVec3::Z * 1.4);
    let glass = homogeneous(Spectrum::ZERO, Spectrum::ZERO, 0.0);
    let object = |shape: Shape, surface: Surface| Object { shape, surface };
    let fog = cuboid(DVec3::new(-2.0, 0.0, -2.0), DVec3::new(1.5, 2.5, 2.0));
    let scene = Scene::new(SceneParts {
        regions: (sigma_t > 0.0).then(|| scenes::region(fog, sigma_t, 0.8, 0.3)).into_iter().collect(),
        interiors: vec![Interior::surroundings(), filled("glass", 1.5, glass)],
        objects: vec![
            object(floor, lambertian(Spectrum::rgb(0.8, 0.6, 0.4))),
            object(ball, dielectric(1, 0)),
        ],
        lights: vec![area_light(light, Spectrum::grey(5.0))],
        ..SceneParts::default()
    })
    .unwrap();
    let eye = DVec3::new(2.0, 0.25, 0.0);
    (scene, camera(eye, DVec3::new(0.0, -0.02, 0.0), 10.0, Filter::Box))
}

/// The light that a ball of glass gathers on the floor, where nothing specular stands between it and the eye.
#[test]
fn light_through_a_ball_of_glass() {
    let (scene, camera) = ball_of_glass(0.0);
    let (paths, photons) = (by_paths(&scene, &camera, 32), by_photons(&scene, &camera, 15_000));
    compare("ball", &paths, &photons, Layer::Direct, 0);
    compare("ball", &paths, &photons, Layer::Caustic, 0);
}
