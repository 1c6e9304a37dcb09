//! Volume estimates where bodies of any shape part a medium: independent photons of known density on both sides, expected to
//! be read as the field at the point, whatever the radius. Each kind of body has its negative control.

use crate::support::scenes::{
    bounded, cuboid, dielectric, filled, homogeneous, lambertian, point_light, rectangle, region, sphere,
};
use crate::support::verdict;
use glam::{DVec2, DVec3};
use std::sync::Arc;
use turbid::Spectrum;
use turbid::estimators::boundary::{Boundary, Treatment, treated_density};
use turbid::estimators::{Gather, Kernel};
use turbid::geometry::{Ground, Lathe, Mesh, Shape, Up, height_field};
use turbid::integrators::mapper::medium_extents;
use turbid::photons::PhotonMap;
use turbid::photons::synthetic::{Number, Profile, Synthetic};
use turbid::rng::{Purpose, Stream};
use turbid::scene::{Interior, Object, Parts, Region, Scene};
use turbid::stats::Moments;
use turbid::surface::Surface;

const SEED: u64 = 61;
const MAPS: u64 = 128;

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
    Scene::new(Parts {
        regions,
        interiors: vec![
            Interior::surroundings(),
            filled("milk", 1.3, homogeneous(Spectrum::ONE, Spectrum::grey(0.9), 0.0)),
        ],
        objects: objects.into_iter().map(|(shape, surface)| Object { shape, surface }).collect(),
        lights: vec![point_light(DVec3::new(0.91, 0.92, 0.93), Spectrum::ONE)],
        ..Parts::default()
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
    Shape::Lathe(Arc::new(Lathe::new(DVec3::ZERO, DVec3::Z, &profile).unwrap()))
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
    let centers: Vec<DVec3> = (0..343)
        .map(|n| DVec3::from([n % 7, n / 7 % 7, n / 49].map(|i| f64::from(i) * 0.25 - 0.75)))
        .collect();
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
            "between hundreds of regions",
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
    let kept = all.tree().photons().filter(|photon| stream.unit() < field(photon.position)).collect();
    PhotonMap::new(kept, all.emitted()).unwrap()
}

/// Estimates over the field at their points, in the mean over the points of a case, one value a map.
fn relative(
    case: &Case,
    photons: u64,
    maps: u64,
    (kernel, gather): (Kernel, Gather),
    boundary: &Boundary<'_>,
) -> Moments {
    let one = |replicate: u64| {
        let map = map(&case.field, photons, replicate);
        let scale = 8.0 * map.emitted() as f64 / photons as f64;
        let ask = |p: &DVec3| {
            treated_density(&map, *p, kernel, gather, boundary).estimate.value[0] * scale / (case.field)(*p)
        };
        case.points.iter().map(ask).sum::<f64>() / case.points.len() as f64
    };
    (0..maps).map(one).collect()
}

/// Uniform fields on every side of a body are read as they are, at any radius and k; without the body they are not.
#[test]
fn fields_parted_by_bodies() {
    for case in cases() {
        let extents = medium_extents(&case.scene);
        let boundary = extents[case.number].boundary(Treatment::Clipped);
        for (kernel, gather) in [
            (Kernel::Uniform, Gather::nearest(40, 0.5).unwrap()),
            (Kernel::Epanechnikov, Gather::radius(0.2).unwrap()),
        ] {
            let values = relative(&case, 20_000, MAPS, (kernel, gather), &boundary);
            let what = format!("{}, {kernel:?}, {gather:?}", case.name);
            verdict::agrees(&what, &values, (1.0, 0.0), 0.15, SEED);
        }
    }
}
