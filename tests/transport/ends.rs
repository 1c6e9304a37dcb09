//! Light comes to an end, or the scene is refused in a line that says what keeps it; work is counted, not timed.

use crate::support::run::pass;
use crate::support::scenes::{
    bounded, cuboid, isotropic, lambertian, outflow, point_light, rectangle, region, sphere,
};
use crate::support::verdict;
use glam::DVec3;
use turbid::Spectrum;
use turbid::geometry::Shape;
use turbid::light::{Faces, Light};
use turbid::math::{Asymmetry, Interval, Positive, Ray, exp, ln_1p};
use turbid::medium::{Density, Grid, HeightFog, Heterogeneous, Homogeneous, Medium};
use turbid::phase::Phase;
use turbid::photons::importance::{Importance, ImportanceSettings};
use turbid::photons::maps::{Amount, Indirect, MapSettings, MediumSamples, fill};
use turbid::photons::{Histories, MOST_EVENTS, check_end, shoot};
use turbid::rng::{Purpose, Stream};
use turbid::scene::{
    Camera, Filter, Interior, Object, Orders, Quantity, Region, Scene, SceneParts, Sensor, View,
};
use turbid::sensor::{PathSettings, Streams, by_light, by_paths};
use turbid::stats::Moments;
use turbid::surface::{Dielectric, Mirror, Surface};
use turbid::transport::{
    LONG, NoProgress, Roulette, Step, Visitor, Walker, emission, segment_transmittance, walk,
};

/// The six walls of a box of side 2, as rectangles.
fn walls(surface: impl Fn(usize) -> Surface) -> Vec<(Shape, Surface)> {
    let low = DVec3::splat(-1.0);
    let (x, y, z) = (DVec3::X * 2.0, DVec3::Y * 2.0, DVec3::Z * 2.0);
    let sides = [(low, x, y), (low + z, x, y), (low, x, z), (low + y, x, z), (low, y, z), (low + x, y, z)];
    let wall = |(i, (corner, u, v))| (Shape::Rectangle(rectangle(corner, u, v)), surface(i));
    sides.into_iter().enumerate().map(wall).collect()
}

fn objects(bodies: Vec<(Shape, Surface)>) -> Vec<Object> {
    bodies.into_iter().map(|(shape, surface)| Object { shape, surface }).collect()
}

fn white(_: usize) -> Surface {
    lambertian(Spectrum::ONE)
}

fn mirror(_: usize) -> Surface {
    Surface::Mirror(Mirror::new(Spectrum::ONE).unwrap())
}

fn lamp() -> Light {
    point_light(DVec3::new(0.1, 0.2, 0.3), Spectrum::ONE)
}

fn probe() -> Sensor {
    Sensor {
        name: "middle".into(),
        label: "fluence".into(),
        quantity: Quantity::Fluence(DVec3::new(0.5, 0.4, 0.3)),
        orders: Orders::ALL,
    }
}

fn camera() -> Camera {
    let (position, look_at) = (DVec3::new(0.0, 0.0, -0.9), DVec3::ZERO);
    Camera::new(View { position, look_at, up: DVec3::Y, fov: 60.0, width: 4, height: 4, filter: Filter::Box })
        .unwrap()
}

fn room(surface: impl Fn(usize) -> Surface) -> Scene {
    let parts = SceneParts {
        objects: objects(walls(surface)),
        lights: vec![lamp()],
        sensors: vec![probe()],
        camera: Some(camera()),
        ..SceneParts::default()
    };
    Scene::new(parts).unwrap()
}

/// Counts the events of histories, and keeps the weight of the last one.
#[derive(Default)]
struct Events {
    count: u64,
    last: f64,
}

impl Visitor for Events {
    const LOOKS_AHEAD: bool = false;

    fn visit(&mut self, walker: &Walker, step: Step, _stream: &mut Stream) {
        if let Step::Ahead(_) = step {
            self.count += 1;
            self.last = walker.weight.max();
        }
    }
}

/// Rooms that keep light, whatever they are made of; and the same with a way out, or a wall that absorbs.
#[test]
fn rooms_that_keep_light_are_refused_and_others_are_not() {
    let grey = |value: f64| move |_: usize| lambertian(Spectrum::grey(value));
    let text = |scene: &Scene| check_end(scene).unwrap_err().to_string();
    let told = text(&room(white));
    for part in ["light from lights[0]", "objects[0]", "objects[5]", "allowed: 20000"] {
        assert!(told.contains(part) && !told.contains('\n'), "{told}");
    }
    text(&room(mirror));
    // A million events a history, expected.
    text(&room(grey(0.999_999)));
    assert_eq!(check_end(&room(grey(0.999))), Ok(()));
    assert_eq!(check_end(&room(|i| if i == 3 { grey(0.5)(i) } else { white(i) })), Ok(()));
    let mut open = walls(white);
    open.pop();
    assert_eq!(check_end(&bounded(Vec::new(), open, vec![lamp()])), Ok(()));
    // A medium that absorbs ends it too; one that does not keeps it.
    let fog = |albedo: f64| region(cuboid(DVec3::splat(-1.0), DVec3::ONE), 1.0, albedo, 0.0);
    assert_eq!(check_end(&bounded(vec![fog(0.9)], walls(white), vec![lamp()])), Ok(()));
    text(&bounded(vec![fog(1.0)], walls(white), vec![lamp()]));
    // Light of a lamp outside comes to an end; what a sensor inside could measure does not.
    let outside = point_light(DVec3::X * 3.0, Spectrum::ONE);
    assert_eq!(check_end(&bounded(Vec::new(), walls(white), vec![outside.clone()])), Ok(()));
    let parts = SceneParts {
        objects: objects(walls(white)),
        lights: vec![outside],
        sensors: vec![probe()],
        ..SceneParts::default()
    };
    let told = text(&Scene::new(parts).unwrap());
    assert!(told.contains("sensor middle"), "{told}");
}

/// Behind a pane that encloses nothing a medium has no end: if it absorbs nothing, light does not come back, and if it
/// emits, a ray gathers without end. What absorbs, and what bodies enclose, is right.
#[test]
fn media_without_end_are_refused_where_light_does_not_end_in_them() {
    let matter = |(sigma_t, albedo, emission): (f64, f64, f64)| {
        let phase = Phase::with_asymmetry(Asymmetry::try_from(0.0).unwrap());
        let matter = Homogeneous::new(Spectrum::grey(sigma_t), Spectrum::grey(albedo), phase).unwrap();
        matter.with_emission(Spectrum::grey(emission)).unwrap()
    };
    let filled = |medium: Medium, body: Shape| {
        let milk = Interior { name: "milk".into(), index: 1.4, medium: Some(medium) };
        let interiors = vec![Interior::surroundings(), milk];
        let boundary = Surface::Dielectric(Dielectric::new(1, 0));
        let parts = SceneParts {
            interiors,
            objects: objects(vec![(body, boundary)]),
            lights: vec![lamp()],
            camera: Some(camera()),
            ..SceneParts::default()
        };
        check_end(&Scene::new(parts).unwrap()).map_or_else(|error| error.to_string(), |()| String::new())
    };
    let says = |medium, body: Shape| filled(matter(medium).into(), body);
    let pane = || Shape::Rectangle(rectangle(DVec3::new(-0.3, -0.3, 0.5), DVec3::X * 0.6, DVec3::Y * 0.6));
    let ball = || sphere(DVec3::new(0.0, 0.0, 0.5), 0.2);
    let lost = says((1.0, 1.0, 0.0), pane());
    assert!(
        lost.contains("milk, which no body encloses and whose medium absorbs nothing; allowed"),
        "{lost}"
    );
    let emits = says((0.0, 0.5, 0.2), pane());
    assert!(emits.contains("whose medium emits where nothing absorbs; allowed"), "{emits}");
    for (medium, body) in [
        ((1.0, 0.999, 0.0), pane()),
        ((0.0, 0.5, 0.0), pane()),
        ((0.3, 0.5, 0.2), pane()),
        ((1.0, 1.0, 0.0), ball()),
        ((0.0, 0.5, 0.2), ball()),
    ] {
        assert_eq!(says(medium, body), "", "{medium:?}");
    }
    // Fog ends above, its light where it is as dense; light that is the same everywhere does not.
    let fog = |medium, by_density: f64| {
        let height = Positive::try_from(0.3).unwrap();
        let density = Density::HeightFog(HeightFog::new(DVec3::Z, 0.0, height).unwrap());
        let medium = Heterogeneous::new(matter(medium), density);
        filled(medium.with_emission_by_density(Spectrum::grey(by_density)).unwrap().into(), pane())
    };
    let emits = fog((0.5, 0.5, 0.2), 0.0);
    assert!(emits.contains("whose medium emits where nothing absorbs; allowed"), "{emits}");
    assert_eq!(fog((0.5, 0.5, 0.0), 0.2), "");
    let clear = fog((0.0, 0.5, 0.0), 0.2);
    assert!(clear.contains("whose medium emits where nothing absorbs; allowed"), "{clear}");
}

/// No method hangs: each refuses the room itself.
#[test]
fn every_method_refuses_a_room_that_keeps_light() {
    let scene = room(white);
    let histories = Histories { count: 10, seed: 1, replicate: 0, max_order: None };
    let told = |refused: turbid::Result<()>| {
        let text = refused.unwrap_err().to_string();
        assert!(text.contains("hardly ever ends"), "{text}");
    };
    told(shoot(&scene, histories, &[], |_| true, &NoProgress).map(|_| ()));
    let amount = Amount::Stored(10);
    let indirect = Indirect::Seen;
    let maps = MapSettings {
        global: amount,
        caustic: amount,
        volume: amount,
        media: MediumSamples::Points,
        indirect,
        seed: 1,
        replicate: 0,
    };
    told(fill(&scene, &maps, &NoProgress).map(|_| ()));
    let streams = Streams { seed: 1, replicate: 0 };
    told(by_light(&scene, &camera(), 10, 1, streams, &NoProgress).map(|_| ()));
    let settings = PathSettings { samples: 10, seed: 1, replicate: 0, orders: Orders::ALL };
    told(by_paths(&scene, &settings, &NoProgress).map(|_| ()));
    let learned = ImportanceSettings::default();
    told(Importance::of(&scene, &camera(), indirect, &learned, &NoProgress).map(|_| ()));
}

/// The furnace with a white ball in it: nothing is trapped, and the fluence is 4 everywhere.
#[test]
fn a_white_ball_in_a_medium_that_is_lit_from_outside_is_a_furnace() {
    let shell = sphere(DVec3::ZERO, 1.0);
    let objects = vec![(sphere(DVec3::ZERO, 0.3), white(0))];
    let fog = region(shell.clone(), 2.0, 1.0, 0.3);
    let scene = bounded(vec![fog], objects, vec![isotropic(shell, Faces::Both)]);
    let at = Quantity::Fluence(DVec3::X * 0.5);
    let fluence = crate::support::run::paths(&scene, at, Orders::ALL, 1 << 14, 5);
    verdict::agrees("fluence of the furnace", &fluence[0], (4.0, 1e-14), 0.2, 5);
    let booked = pass(&scene, &[], 1 << 12, 5, |_| false).report.ledger;
    assert!((booked.escaped / booked.emitted - 1.0).abs() < 1e-12);
}

/// A mirror in a cube of glass is no way out: what is caught is given up after some ten thousand reflections, and booked.
#[test]
fn light_caught_in_glass_with_a_mirror_in_it_is_given_up() {
    let glass = Interior { name: "glass".into(), index: 1.6, medium: None };
    let pane = rectangle(DVec3::new(-0.5, -0.5, 0.5), DVec3::X, DVec3::Y);
    let parts = SceneParts {
        interiors: vec![Interior::surroundings(), glass],
        objects: vec![
            Object {
                shape: cuboid(DVec3::splat(-1.0), DVec3::ONE),
                surface: Surface::Dielectric(Dielectric::new(1, 0)),
            },
            Object { shape: Shape::Rectangle(pane), surface: mirror(0) },
        ],
        lights: vec![lamp()],
        ..SceneParts::default()
    };
    let scene = Scene::new(parts).unwrap();
    let out = (outflow(sphere(DVec3::ZERO, 3.0)), Orders::ALL);
    let pass = pass(&scene, &[out], 1 << 9, 3, |_| false);
    let ledger = &pass.report.ledger;
    let booked = ledger.escaped + ledger.absorbed + ledger.truncated;
    assert!((booked / ledger.emitted - 1.0).abs() < 1e-12 && ledger.absorbed == 0.0);
    // The cube without the mirror keeps a third; the mirror turns light, not its angles to the faces.
    let cone = 0.5 * (1.0 - (1.0f64 - 1.0 / (1.6 * 1.6)).sqrt());
    verdict::agrees("out of the cube", &pass.tallies[0][0], (6.0 * cone, 1e-15), 0.2, 3);
    for history in 0..64 {
        let mut stream = Stream::new(3, Purpose::Synthetic, 0, history);
        let dir = turbid::math::warp::square_to_sphere(stream.pair()).normalize();
        let start = Walker { interior: 1, ..Walker::new(Ray::new(DVec3::ZERO, dir), Spectrum::ONE) };
        let mut events = Events::default();
        walk(&scene, start, Roulette::Analog, None, &mut stream, &mut events);
        assert!(events.count < 40_000, "{}", events.count);
    }
}

/// Histories that nothing ends play for their lives: with odds of 1e5 to 1 at each event, and weights that keep the mean.
#[test]
fn long_histories_end_by_a_game_that_keeps_the_mean() {
    let scene = room(white);
    let odds = 1e5f64;
    let mut lives = Moments::new();
    for history in 0..64 {
        let mut stream = Stream::new(9, Purpose::Synthetic, 0, history);
        let start = Walker { events: LONG, ..Walker::new(Ray::new(DVec3::ZERO, DVec3::X), Spectrum::ONE) };
        let mut events = Events::default();
        walk(&scene, start, Roulette::Analog, None, &mut stream, &mut events);
        let expected = exp(-(events.count as f64) * ln_1p(-1.0 / odds));
        assert!((events.last / expected - 1.0).abs() < 1e-9, "{} {expected}", events.last);
        lives.push(events.count as f64 / odds);
    }
    // Exponential with mean 1: that of 64 is between these but for one chance in 1e9.
    assert!((0.4..2.0).contains(&lives.mean()), "{}", lives.mean());
    // Refused scenes have longer histories than that in the mean, so that the game is rare in others.
    assert!(u64::from(LONG) >= 10 * MOST_EVENTS);
}

/// Along the layers of a dense grid every tentative collision lets 0.6 pass: after some fifty of them, not a million, the
/// game decides.
#[test]
fn ratio_tracking_of_dense_layers_ends_soon() {
    let layers = Grid::new((DVec3::ZERO, DVec3::ONE), [1, 1, 2], 1, vec![0.0, 1.0]).unwrap();
    let dense = varying(Spectrum::grey(1e6), layers);
    let ray = Ray::new(DVec3::new(0.0, 0.5, 0.45), DVec3::X);
    let part = Interval { start: 0.0, end: 1.0 };
    for history in 0..64 {
        let mut stream = Stream::new(4, Purpose::Synthetic, 0, history);
        let through = segment_transmittance(&dense, &ray, part, &mut stream);
        assert!(stream.work.densities < 1000, "{}", stream.work.densities);
        assert!(through.max() <= 1e-12, "{through:?}");
    }
}

/// The game of faint transmittances keeps their mean: at a tau of 30, in steps of which each lets nine tenths pass.
#[test]
fn roulette_of_faint_transmittances_keeps_the_mean() {
    let layers = Grid::new((DVec3::ZERO, DVec3::ONE), [1, 1, 2], 1, vec![0.0, 1.0]).unwrap();
    let tau = 30.0;
    let medium = varying(Spectrum::grey(tau / 0.1), layers);
    // Density 0.1 below a bound of 1.
    let ray = Ray::new(DVec3::new(0.0, 0.5, 0.3), DVec3::X);
    let part = Interval { start: 0.0, end: 1.0 };
    let exact = exp(-tau);
    let through = crate::support::run::numbers(1 << 14, 6, |stream| {
        segment_transmittance(&medium, &ray, part, stream)[0] / exact
    });
    verdict::agrees("transmittance over the exact one", &through, (1.0, 1e-6), 0.3, 6);
}

/// A channel that lets nothing pass does not set the pace of the others: the game ends each by itself, wherever along the
/// ray, and keeps the mean of what the others meet behind.
#[test]
fn roulette_of_faint_transmittances_is_by_channel() {
    let tau = Spectrum::rgb(1.0, 1e5, 30.0);
    let ray = Ray::new(DVec3::new(0.0, 0.5, 0.3), DVec3::X);
    let part = Interval { start: 0.0, end: 1.0 };
    // Nothing below the density; half of it or more; bounds that differ along the ray, and are often met.
    let samples: [fn(usize, usize) -> f32; 3] =
        [|_, z| z as f32, |_, z| [0.5, 1.0][z], |x, z| (1.0 + (x % 7) as f32) * [0.1, 0.5][z]];
    for (i, sample) in samples.into_iter().enumerate() {
        let values = (0..128).map(|i| sample(i % 64, i / 64)).collect();
        let grid = Grid::new((DVec3::ZERO, DVec3::ONE), [64, 1, 2], 1, values).unwrap();
        let density = Density::grid(grid.clone()).unwrap();
        let medium = varying(tau / density.integral(&ray, part), grid);
        let mut through = [Moments::new(), Moments::new()];
        for history in 0..1 << 13 {
            let mut stream = Stream::new(6, Purpose::Synthetic, 1, history);
            let transmitted = segment_transmittance(&medium, &ray, part, &mut stream);
            // The dense channel alone has 1e5.
            assert!(stream.work.densities < 10_000, "{}", stream.work.densities);
            assert!(transmitted[1] <= 1e-12, "{transmitted:?}");
            through[0].push(transmitted[0] / exp(-tau[0]));
            through[1].push(transmitted[2] / exp(-tau[2]));
        }
        verdict::agrees(&format!("the thin channel, {i}"), &through[0], (1.0, 1e-6), 0.1, 6);
        verdict::agrees(&format!("the faint channel, {i}"), &through[1], (1.0, 1e-6), 0.9, 6);
    }
}

/// The same where the layers emit, and what is behind them: emission is collected by a game of its own.
#[test]
fn roulette_of_faint_emission_keeps_the_mean_and_ends() {
    let layers = Grid::new((DVec3::ZERO, DVec3::ONE), [1, 1, 2], 1, vec![0.0, 1.0]).unwrap();
    let behind = |emission: f64| {
        let thin = Homogeneous::new(Spectrum::ZERO, Spectrum::ZERO, even()).unwrap();
        let medium = thin.with_emission(Spectrum::grey(emission)).unwrap().into();
        Region { shape: cuboid(DVec3::X * 2.0, DVec3::new(3.0, 1.0, 1.0)), medium }
    };
    let before = |sigma_t: f64| {
        let dense = heterogeneous(Spectrum::grey(sigma_t), layers.clone());
        let medium = dense.with_emission_by_density(Spectrum::grey(sigma_t)).unwrap().into();
        Region { shape: cuboid(DVec3::ZERO, DVec3::ONE), medium }
    };
    // What the layers send is 1, and so is what passes them from behind.
    let tau = 30.0;
    let scene = bounded(vec![before(tau / 0.1), behind(exp(tau))], Vec::new(), Vec::new());
    let ray = Ray::new(DVec3::new(0.0, 0.5, 0.3), DVec3::X);
    let light = crate::support::run::numbers(1 << 15, 6, |stream| emission(&scene, &ray, 4.0, 0, stream)[0]);
    verdict::agrees("emission of layers and from behind", &light, (2.0, 1e-6), 0.2, 6);
    // Without the game each of these takes fifty thousand look-ups.
    let dense = bounded(vec![before(5e4), behind(1.0)], Vec::new(), Vec::new());
    let ray = Ray::new(DVec3::new(0.0, 0.5, 0.45), DVec3::X);
    for history in 0..64 {
        let mut stream = Stream::new(4, Purpose::Synthetic, 0, history);
        let light = emission(&dense, &ray, 4.0, 0, &mut stream)[0];
        assert!(stream.work.densities < 1000 && light.is_finite(), "{} {light}", stream.work.densities);
    }
}

/// A stretch through an emitting medium may be so short that one over its length is not finite: it sends nothing then. Longer
/// ones send their length times the density, 0.9, which is found at about one place in each.
#[test]
fn emission_of_the_shortest_stretch_ends() {
    let ray = Ray::new(DVec3::new(0.5, 0.0, 0.7), DVec3::new(0.0, 0.8, 0.6));
    for (thickness, expected) in [(5e-324, 0.0), (2e-309, 0.0), (5e-308, 0.9), (1e-300, 0.9), (1e-20, 0.9)] {
        let layers = Grid::new((DVec3::ZERO, DVec3::ONE), [1, 1, 2], 1, vec![0.0, 1.0]).unwrap();
        let shape = cuboid(DVec3::splat(-1.0), DVec3::new(2.0, thickness, 2.0));
        let medium = heterogeneous(Spectrum::ONE, layers).with_emission_by_density(Spectrum::ONE).unwrap();
        let scene = bounded(vec![Region { shape, medium: medium.into() }], Vec::new(), Vec::new());
        let mut light = Moments::new();
        for history in 0..1 << 14 {
            let mut stream = Stream::new(4, Purpose::Synthetic, 0, history);
            light.push(emission(&scene, &ray, 4.0, 0, &mut stream)[0] / (thickness / ray.dir.y));
            assert!(stream.work.densities < 100, "{thickness:e}: {}", stream.work.densities);
        }
        if expected == 0.0 {
            assert_eq!(light.mean(), 0.0, "{thickness:e}");
        } else {
            verdict::agrees(&format!("over {thickness:e}"), &light, (expected, 1e-6), 0.1, 4);
        }
    }
}

fn varying(sigma_t: Spectrum, grid: Grid) -> Medium {
    heterogeneous(sigma_t, grid).into()
}

fn heterogeneous(sigma_t: Spectrum, grid: Grid) -> Heterogeneous {
    let matter = Homogeneous::new(sigma_t, Spectrum::grey(0.5), even()).unwrap();
    Heterogeneous::new(matter, Density::grid(grid).unwrap())
}

fn even() -> Phase {
    Phase::with_asymmetry(Asymmetry::try_from(0.0).unwrap())
}
