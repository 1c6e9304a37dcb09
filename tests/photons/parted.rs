//! Volume estimates where bodies of any shape part a medium: independent photons of known density on both sides, expected to
//! be read as the field at the point, whatever the radius. Each kind of body has its negative control.

use crate::checks::ledger::{filling, settings};
use crate::support::scenes::{
    bounded, cuboid, dielectric, emitting_sphere, filled, homogeneous, lambertian, point_light, rectangle,
    region, sphere,
};
use crate::support::{run, verdict};
use glam::{DVec2, DVec3};
use std::f64::consts::PI;
use std::sync::Arc;
use turbid::Spectrum;
use turbid::estimators::boundary::{Boundary, Treatment};
use turbid::estimators::{Estimator, Gather, Kernel};
use turbid::geometry::{Ground, Mesh, Revolution, Shape, Up, height_field};
use turbid::integrators::mapper::{Mapper, Settings, medium_extents};
use turbid::integrators::path;
use turbid::math::{Asymmetry, FOUR_PI, Ray};
use turbid::phase::Phase;
use turbid::photons::maps::{Indirect, fill};
use turbid::photons::synthetic::{Number, Profile, Synthetic};
use turbid::photons::{PhotonMap, Photons};
use turbid::rng::{Purpose, Stream};
use turbid::scene::{Interior, Object, Orders, Quantity, Region, Scene, SceneParts};
use turbid::sensor::{PhotonSettings, by_photons};
use turbid::stats::Moments;
use turbid::surface::Surface;
use turbid::transport::NoProgress;

const SEED: u64 = 61;
/// As many as a verdict asks for.
const MAPS: u64 = 64;
/// Photons of a map at density 1.
const PHOTONS: u64 = 8000;

/// A scene, the medium that is asked, the density of its photons by place and the points: where a body hides nothing, the
/// field is what it is at the point.
struct Case {
    name: &'static str,
    scene: Scene,
    number: usize,
    field: Box<dyn Fn(DVec3) -> f64>,
    points: Vec<DVec3>,
}

fn white() -> Surface {
    lambertian(Spectrum::grey(0.5))
}

fn wall(corner: [f64; 3], u: [f64; 3], v: [f64; 3]) -> (Shape, Surface) {
    (Shape::Rectangle(rectangle(corner.into(), u.into(), v.into())), white())
}

fn fog() -> Region {
    region(cuboid(DVec3::splat(-1.0), DVec3::ONE), 1.0, 0.9, 0.0)
}

/// Fog with these bodies in it.
fn foggy(objects: Vec<(Shape, Surface)>) -> Scene {
    bounded(vec![fog()], objects, vec![point_light(DVec3::new(0.91, 0.92, 0.93), Spectrum::ONE)])
}

/// A medium that fills interior 1, which these surfaces bound.
fn interior(objects: Vec<(Shape, Surface)>, regions: Vec<Region>) -> Scene {
    Scene::new(SceneParts {
        regions,
        interiors: vec![
            Interior::surroundings(),
            filled("milk", 1.3, homogeneous(Spectrum::ONE, Spectrum::grey(0.9), 0.0)),
        ],
        objects: objects.into_iter().map(|(shape, surface)| Object { shape, surface }).collect(),
        lights: vec![point_light(DVec3::new(0.91, 0.92, 0.93), Spectrum::ONE)],
        ..SceneParts::default()
    })
    .unwrap()
}

/// A ball of triangles: an octahedron, cut four times.
fn mesh_ball(center: DVec3, radius: f64) -> Shape {
    let [x, y, z] = DVec3::AXES;
    let corner = |n: usize| [x, y, z][n % 3];
    let mut triangles: Vec<[DVec3; 3]> = Vec::new();
    for (sx, sy, sz) in (0..8).map(|i| (i & 1, i >> 1 & 1, i >> 2)) {
        let sign = |s: i32| 1.0 - 2.0 * f64::from(s);
        let [a, b, c] = [corner(0) * sign(sx), corner(1) * sign(sy), corner(2) * sign(sz)];
        triangles.push(if (sx + sy + sz) % 2 == 0 { [a, b, c] } else { [a, c, b] });
    }
    for _ in 0..3 {
        triangles = triangles
            .into_iter()
            .flat_map(|[a, b, c]| {
                let [ab, bc, ca] = [(a + b), (b + c), (c + a)].map(DVec3::normalize);
                [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
            })
            .collect();
    }
    let positions: Vec<DVec3> = triangles.iter().flatten().map(|p| center + *p * radius).collect();
    let places: Vec<[u32; 3]> = (0..triangles.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    Shape::Mesh(Arc::new(Mesh::new(&positions, &places, None).unwrap()))
}

fn lathe(profile: &[[f64; 2]]) -> Shape {
    let profile: Vec<DVec2> = profile.iter().map(|p| DVec2::from(*p)).collect();
    Shape::Revolution(Arc::new(Revolution::new(DVec3::ZERO, DVec3::Z, &profile).unwrap()))
}

/// Ground with hills, closed below: heights of a tenth about z = 0.
fn hills() -> Shape {
    let ground = Ground { corner: DVec2::splat(-1.0), size: DVec2::splat(2.0), cells: [12, 12] };
    let height = |p: DVec2| 0.1 * libm::sin(7.0 * p.x) * libm::cos(5.0 * p.y);
    Shape::Mesh(Arc::new(height_field(&ground, Up::Z, Some(-0.9), height).unwrap()))
}

/// A room of rectangles, from -0.5 to 0.5 along every axis.
fn room() -> Vec<(Shape, Surface)> {
    [
        ([-0.5; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]),
        ([-0.5, -0.5, 0.5], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]),
        ([-0.5; 3], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]),
        ([0.5, -0.5, -0.5], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]),
        ([-0.5; 3], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]),
        ([-0.5, 0.5, -0.5], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]),
    ]
    .map(|(corner, u, v)| wall(corner, u, v))
    .to_vec()
}

fn is_in_room(p: DVec3) -> bool {
    p.abs().max_element() < 0.5
}

/// A density inside a body and one outside.
fn inside(body: Shape, [inside, outside]: [f64; 2]) -> Box<dyn Fn(DVec3) -> f64> {
    Box::new(move |p| if body.contains(p) { inside } else { outside })
}

fn cases() -> Vec<Case> {
    let glass = |shape: Shape| (shape, dielectric(1, 0));
    let level = || {
        let corner = DVec3::new(-9.0, -9.0, 0.1);
        glass(Shape::Rectangle(rectangle(corner, DVec3::X * 18.0, DVec3::Y * 18.0)))
    };
    let vase = lathe(&[[0.0, -0.6], [0.3, -0.5], [0.5, 0.0], [0.2, 0.4], [0.0, 0.5]]);
    let ball = mesh_ball(DVec3::ZERO, 0.4);
    let thin = cuboid(DVec3::new(-0.5, -0.5, -0.005), DVec3::new(0.5, 0.5, 0.005));
    let rooms = [room(), vec![(thin.clone(), white())]].concat();
    let centers =
        [[0.0, 0.0, 0.0], [0.25, 0.0, 0.0], [0.25, 0.25, 0.0], [-0.25, 0.0, 0.0], [0.0, 0.25, 0.25]];
    let centers = centers.map(DVec3::from);
    let crowd: Vec<Region> = centers.iter().map(|at| region(sphere(*at, 0.1), 2.0, 0.5, 0.0)).collect();
    let crowd = [vec![fog()], crowd].concat();
    let case = |name, scene, number, field: Box<dyn Fn(DVec3) -> f64>, list: &[[f64; 3]]| Case {
        name,
        scene,
        number,
        field,
        points: list.iter().map(|p| DVec3::from(*p)).collect(),
    };
    vec![
        case(
            "about a mesh",
            foggy(vec![(ball.clone(), white())]),
            0,
            inside(ball.clone(), [0.0, 1.0]),
            &[[0.0, 0.25, 0.33], [0.41, 0.0, 0.0], [0.3, 0.3, -0.3], [-0.5, 0.1, 0.0]],
        ),
        case(
            "about a lathe",
            foggy(vec![(vase.clone(), white())]),
            0,
            inside(vase.clone(), [0.0, 1.0]),
            &[[0.51, 0.0, 0.0], [0.0, 0.36, 0.25], [0.0, 0.0, 0.55], [-0.3, -0.3, -0.3]],
        ),
        case(
            "over hills",
            foggy(vec![(hills(), white())]),
            0,
            inside(hills(), [0.0, 1.0]),
            &[[0.0, 0.0, 0.01], [1.0 / 6.0, 0.0, 0.1], [-1.0 / 6.0, 0.0, -0.085], [-0.2, 0.05, 0.05]],
        ),
        case(
            "at a screen",
            foggy(vec![wall([-2.0, -2.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0])]),
            0,
            Box::new(|p| if p.z > 0.0 { 1.0 } else { 0.2 }),
            &[[0.0, 0.0, 1e-3], [0.3, 0.0, -1e-3], [0.0, 0.3, 0.1], [-0.3, 0.0, -0.1]],
        ),
        case(
            "in a room with fog beyond",
            foggy(room()),
            0,
            Box::new(|p| if is_in_room(p) { 1.0 } else { 0.0 }),
            &[[0.0, 0.0, 0.49], [0.0, 0.49, 0.49], [0.48, 0.48, -0.48], [0.4, -0.2, 0.1]],
        ),
        case(
            "beyond a room",
            foggy(room()),
            0,
            Box::new(|p| if is_in_room(p) { 1.0 } else { 0.3 }),
            &[[0.0, 0.0, 0.51], [0.0, 0.52, 0.0], [0.58, 0.2, 0.0], [0.0, -0.6, 0.3]],
        ),
        case(
            "two rooms and a thin wall",
            foggy(rooms),
            0,
            Box::new(move |p| match p.z {
                _ if thin.contains(p) => 0.0,
                _ if !is_in_room(p) => 0.5,
                z if z > 0.0 => 1.0,
                _ => 0.25,
            }),
            &[[0.0, 0.0, 0.01], [0.3, 0.0, -0.01], [0.0, 0.0, 0.05], [0.45, 0.45, -0.05]],
        ),
        case(
            "under a level",
            interior([room(), vec![level()]].concat(), Vec::new()),
            0,
            Box::new(|p| if p.z < 0.1 && is_in_room(p) { 1.0 } else { 0.0 }),
            &[[0.0, 0.0, 0.099], [0.4, 0.0, 0.05], [0.49, 0.49, 0.09], [0.0, 0.1, -0.45]],
        ),
        case(
            "over a level",
            interior([room(), vec![level()]].concat(), vec![fog()]),
            0,
            Box::new(|p| if p.z > 0.1 && is_in_room(p) { 0.5 } else { 1.0 }),
            &[[0.0, 0.0, 0.101], [0.4, 0.0, 0.15], [0.49, 0.49, 0.11], [0.0, 0.1, 0.45]],
        ),
        case(
            "in a lathe of glass",
            interior(vec![glass(vase.clone())], vec![fog()]),
            1,
            inside(vase, [1.0, 0.4]),
            &[[0.49, 0.0, 0.0], [0.0, 0.3, 0.2], [0.0, 0.0, 0.45], [-0.1, 0.1, -0.5]],
        ),
        case(
            "in a mesh of glass",
            interior(vec![glass(ball.clone())], Vec::new()),
            0,
            inside(ball, [1.0, 0.0]),
            &[[0.0, 0.24, 0.31], [0.39, 0.0, 0.0], [-0.2, 0.2, -0.2], [0.3, 0.0, 0.0]],
        ),
        case(
            "between regions",
            bounded(crowd, Vec::new(), vec![point_light(DVec3::splat(0.9), Spectrum::ONE)]),
            0,
            Box::new(move |p| if centers.iter().any(|at| at.distance(p) < 0.1) { 0.3 } else { 1.0 }),
            &[[0.11, 0.0, 0.0], [0.125, 0.125, 0.125], [-0.36, 0.02, 0.0], [0.0, 0.12, 0.24]],
        ),
    ]
}

/// Independent photons of this density by place, `photons` of them at density 1 in the cube, as one pass would have
/// stored them.
fn map(field: &dyn Fn(DVec3) -> f64, photons: u64, replicate: u64) -> PhotonMap {
    let even = Synthetic::new(Profile::Constant, DVec3::splat(-1.0), DVec3::ONE).unwrap();
    let all = even.map(Number::Expected(photons), SEED, replicate).unwrap();
    let mut stream = Stream::new(SEED, Purpose::Synthetic, 1 << 32 | replicate, 0);
    let kept: Photons =
        all.tree().photons().filter(|photon| stream.unit() < field(photon.position)).collect();
    PhotonMap::new(kept, all.emitted()).unwrap()
}

/// Estimates over the field at their points, in the mean over the points of a case: for each way to gather one value a
/// map.
fn relative(case: &Case, maps: u64, ways: &[Estimator], boundary: &Boundary<'_>) -> Vec<Moments> {
    let mut all = vec![Moments::new(); ways.len()];
    for replicate in 0..maps {
        let map = map(&case.field, PHOTONS, replicate);
        let scale = 8.0 * map.emitted() as f64 / PHOTONS as f64;
        for (moments, estimator) in all.iter_mut().zip(ways) {
            let ask = |p: &DVec3| {
                let found = estimator.collision_density(&map, *p, boundary);
                found.value[0] * scale / (case.field)(*p)
            };
            moments.push(case.points.iter().map(ask).sum::<f64>() / case.points.len() as f64);
        }
    }
    all
}

fn ways(treatment: Treatment) -> [Estimator; 2] {
    [
        Estimator::new(Kernel::Uniform, Gather::nearest(30, 0.6).unwrap()),
        Estimator::new(Kernel::Epanechnikov, Gather::radius(0.25).unwrap()),
    ]
    .map(|way| way.treated(treatment))
}

/// Uniform fields on every side of a body are read as they are, at any radius and k, beside every kind of body. Negative
/// control: with the medium's own faces alone they are not.
#[test]
fn fields_parted_by_bodies() {
    for case in cases() {
        let extents = medium_extents(&case.scene);
        let (boundary, ways) = (extents[case.number].boundary(), ways(Treatment::Clipped));
        for (values, way) in relative(&case, MAPS, &ways, &boundary).iter().zip(ways) {
            verdict::agrees(&format!("{}, {}", case.name, way.name()), values, (1.0, 0.0), 0.25, SEED);
        }
        for (values, way) in relative(&case, MAPS, &ways, &Boundary::UNKNOWN).iter().zip(ways) {
            verdict::rejects(&format!("{}, {}, bodies not known", case.name, way.name()), values, 1.0, SEED);
        }
    }
}

/// Every treatment reads a uniform field right where a body parts the medium, in a corner too.
#[test]
fn treatments_beside_bodies() {
    let case = cases().into_iter().find(|case| case.name == "in a room with fog beyond").unwrap();
    let extents = medium_extents(&case.scene);
    for treatment in [Treatment::Reflection, Treatment::LocalLinear] {
        let values = relative(&case, MAPS, &ways(treatment), &extents[case.number].boundary());
        for (values, way) in values.iter().zip(ways(treatment)) {
            verdict::agrees(&way.name(), values, (1.0, 0.0), 0.25, SEED);
        }
    }
}

/// A step of a march may begin on a body: what counts is the side that the ray goes on to.
#[test]
fn points_on_a_screen_look_ahead() {
    let case = cases().into_iter().find(|case| case.name == "at a screen").unwrap();
    let extents = medium_extents(&case.scene);
    let boundary = extents[case.number].boundary();
    let [estimator, _] = ways(Treatment::Clipped);
    let phase = Phase::with_asymmetry(Asymmetry::new("g", 0.0).unwrap());
    for (ahead, expected) in [(DVec3::Z, 1.0), (DVec3::NEG_Z, 0.2)] {
        let one = |replicate: u64| {
            let map = map(&case.field, PHOTONS, replicate);
            let ask = |x: f64| {
                let p = DVec3::new(x, 0.1, 0.0);
                estimator.in_scattered(&map, p, -ahead, &phase, Spectrum::ONE, &boundary).value[0]
            };
            let scale = FOUR_PI * 8.0 * map.emitted() as f64 / PHOTONS as f64;
            (0..4).map(|i| ask(0.4 * f64::from(i) - 0.6)).sum::<f64>() / 4.0 * scale
        };
        let values: Moments = (0..MAPS).map(one).collect();
        verdict::agrees(&format!("towards {ahead}"), &values, (expected, 1e-6), 0.25 * expected, SEED);
    }
}

/// A wall on a region's own face parts nothing: the same bits with it and without.
#[test]
fn walls_on_faces_cost_nothing() {
    let even = map(&|_| 1.0, PHOTONS, 0);
    let wall = wall([-1.0, -1.0, -1.0], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0]);
    let (bare, walled) = (foggy(Vec::new()), foggy(vec![wall]));
    let (bare, walled) = (medium_extents(&bare), medium_extents(&walled));
    for p in [[0.0, 0.0, -0.99], [0.9, 0.9, -0.9], [0.2, 0.1, 0.0]].map(DVec3::from) {
        for estimator in ways(Treatment::Clipped) {
            let [bare, walled] =
                [&bare, &walled].map(|extents| estimator.collision_density(&even, p, &extents[0].boundary()));
            assert_eq!(bare, walled, "{p}");
        }
    }
}

/// Lit by a small ball in the room, fog beyond the walls: rays that run along the floor.
fn lit_room() -> Scene {
    bounded(vec![fog()], room(), vec![emitting_sphere(DVec3::new(0.0, 0.0, 0.1), 0.1)])
}

/// What the fog scatters more than once along the floor of a room that stands in it, by maps and by paths: half of each
/// ball is beyond the floor, where no light is.
#[test]
fn light_along_a_floor_with_fog_below() {
    let scene = lit_room();
    let ray = |stream: &mut Stream| {
        let [y, z] = stream.pair();
        Ray::new(DVec3::new(-0.45, 0.6 * y - 0.3, -0.499 + 0.02 * z), DVec3::X)
    };
    let volume = Estimator { gather: Gather::nearest(40, 0.3).unwrap(), ..settings(1).volume };
    let settings = Settings { volume, ..settings(1) };
    let (mut by_maps, mut by_paths) = (Moments::new(), Moments::new());
    for replicate in 0..64 {
        let maps = fill(&scene, &filling(5000, Indirect::Seen, SEED, replicate), &NoProgress).unwrap();
        let mapper = Mapper::new(&scene, &maps, &settings);
        let (mut map, mut path) = (0.0, 0.0);
        for history in 0..200 {
            let mut stream = Stream::new(SEED, Purpose::Paths, replicate, history);
            let ray = ray(&mut stream);
            if history < 20 {
                map += mapper.radiance(ray, None, 0, &mut stream).0.multiple[0] / 20.0;
            }
            path += path::layers(&scene, ray, None, 0, &mut stream).0.multiple[0] / 200.0;
        }
        by_maps.push(map);
        by_paths.push(path);
    }
    verdict::agree("along the floor", &by_maps, &by_paths, 0.35 * by_paths.mean(), SEED);
}

/// The fluence of scattered light next to a wall with fog beyond it, as `measure` reads it, and by paths.
#[test]
fn fluence_beside_a_wall_with_fog_beyond() {
    let at = Quantity::Fluence(DVec3::new(0.1, 0.2, -0.49));
    let orders = Orders { min: 1, max: None };
    let by_paths = run::paths(&lit_room(), at.clone(), orders, 1 << 16, SEED)[0];
    let scene = {
        let sensors = vec![run::sensor(at, orders)];
        let objects = room().into_iter().map(|(shape, surface)| Object { shape, surface }).collect();
        let lights = vec![emitting_sphere(DVec3::new(0.0, 0.0, 0.1), 0.1)];
        Scene::new(SceneParts { regions: vec![fog()], objects, lights, sensors, ..SceneParts::default() })
            .unwrap()
    };
    let by_maps = |treatment: Treatment| -> Moments {
        let one = |seed: u64| {
            let settings = PhotonSettings {
                photons: 5000,
                maps: 1,
                seed,
                orders: Orders::ALL,
                estimator: Estimator::new(Kernel::Uniform, Gather::nearest(40, 0.3).unwrap())
                    .treated(treatment),
            };
            let result = by_photons(&scene, &settings, &NoProgress).unwrap();
            assert_eq!(result.beyond, 0);
            result.measurements[0].mean
        };
        (0..64).map(one).collect()
    };
    verdict::agree("fluence", &by_maps(Treatment::Clipped), &by_paths, 0.35 * by_paths.mean(), SEED);
    verdict::rejects("fluence, not treated", &by_maps(Treatment::None), by_paths.mean(), SEED);
}

/// The part of a kernel within a radius, by midpoints.
#[test]
fn kernels_within_a_radius() {
    for kernel in Kernel::ALL {
        let (n, mut sum, mut on_disc) = (20_000, 0.0, 0.0);
        for i in 0..n {
            let u = (f64::from(i) + 0.5) / f64::from(n);
            sum += 4.0 * PI * u * u * kernel.peak() * kernel.profile(u * u) / f64::from(n);
            on_disc += 2.0 * PI * u * kernel.disc_peak() * kernel.profile(u * u) / f64::from(n);
            let end = f64::from(i + 1) / f64::from(n);
            // Midpoints err by h^2/24 times the slope of the integrand, which stays below 100.
            assert!((kernel.within(end) - sum).abs() < 2e-8, "{kernel:?} within {end}: {sum}");
            assert!((kernel.within_disc(end) - on_disc).abs() < 2e-8, "{kernel:?} on disc {end}: {on_disc}");
        }
        assert!((kernel.within(1.0) - 1.0).abs() < 1e-14, "{kernel:?}");
        assert!((kernel.within_disc(1.0) - 1.0).abs() < 1e-14, "{kernel:?}");
    }
}
