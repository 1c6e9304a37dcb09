//! Irradiance on every shape from either side, apart from transport: synthetic photons of known irradiance, independent and
//! uniform over what light falls on, read as pictures read them.

use crate::checks::ledger::{filling, settings};
use crate::support::scenes::{bounded, cuboid, emitting_sphere, lambertian, rectangle, sphere};
use crate::support::verdict;
use glam::{DVec2, DVec3, Vec3};
use std::f64::consts::PI;
use std::sync::Arc;
use turbid::Spectrum;
use turbid::estimators::{Gather, Kernel};
use turbid::geometry::{Face, Ground, Mesh, Revolution, Shape, Slab, Up, Waves, height_field};
use turbid::integrators::mapper::{Mapper, Settings};
use turbid::integrators::path;
use turbid::light::{Light, Spot};
use turbid::math::{Ray, sin_cos};
use turbid::photons::maps::{Indirect, Maps, fill};
use turbid::photons::{Flags, Photon, PhotonMap};
use turbid::rng::{Purpose, Stream};
use turbid::scene::Scene;
use turbid::stats::Moments;
use turbid::transport::NoProgress;

/// Irradiance of a body's side at a point: its number, the point, and whether it is the outer side.
type IrradianceOf = Box<dyn Fn(usize, DVec3, bool) -> f64>;

/// Bodies, and what falls on them.
struct Specimen {
    name: &'static str,
    shapes: Vec<Shape>,
    lit: IrradianceOf,
}

fn specimen(
    name: &'static str,
    shapes: Vec<Shape>,
    lit: impl Fn(usize, DVec3, bool) -> f64 + 'static,
) -> Specimen {
    Specimen { name, shapes, lit: Box::new(lit) }
}

/// Light on the outer side, and three times as much on the inner one.
fn both(_: usize, _: DVec3, is_outer: bool) -> f64 {
    if is_outer { 1.0 } else { 3.0 }
}

fn outer(_: usize, _: DVec3, is_outer: bool) -> f64 {
    if is_outer { 1.0 } else { 0.0 }
}

fn lathe(profile: &[[f64; 2]]) -> Shape {
    let profile: Vec<DVec2> = profile.iter().map(|p| DVec2::from_array(*p)).collect();
    Shape::Revolution(Arc::new(Revolution::new(DVec3::ZERO, DVec3::Z, &profile).unwrap()))
}

fn floor() -> Shape {
    Shape::Rectangle(rectangle(DVec3::new(-0.5, -0.5, 0.0), DVec3::X, DVec3::Y))
}

/// A ball of flat facets about the origin.
fn faceted_ball(radius: f64, around: u32, along: u32) -> Shape {
    let ring = |i: u32, j: u32| {
        let (s, c) = sin_cos(PI * f64::from(i) / f64::from(along));
        let (y, x) = sin_cos(2.0 * PI * f64::from(j % around) / f64::from(around));
        radius * DVec3::new(s * x, s * y, c)
    };
    let positions: Vec<DVec3> = (0..=along).flat_map(|i| (0..around).map(move |j| ring(i, j))).collect();
    let corner = |i: u32, j: u32| i * around + j % around;
    let cells = (0..along).flat_map(|i| (0..around).map(move |j| (i, j)));
    let triangles: Vec<[u32; 3]> = cells
        .flat_map(|(i, j)| {
            let [a, b, c, d] = [corner(i, j), corner(i, j + 1), corner(i + 1, j), corner(i + 1, j + 1)];
            [[a, c, b], [b, c, d]]
        })
        .collect();
    Shape::Mesh(Arc::new(Mesh::new(&positions, &triangles, None).unwrap()))
}

/// A box of twelve triangles.
fn mesh_box(min: DVec3, max: DVec3) -> Shape {
    let positions: Vec<DVec3> = (0..8u32)
        .map(|i| {
            let pick = |axis: usize| if i >> axis & 1 == 1 { max[axis] } else { min[axis] };
            DVec3::new(pick(0), pick(1), pick(2))
        })
        .collect();
    let quads = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    let triangles: Vec<[u32; 3]> =
        quads.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]).collect();
    Shape::Mesh(Arc::new(Mesh::new(&positions, &triangles, None).unwrap()))
}

fn waves(floor: Option<f64>) -> Shape {
    let waves = Waves::new(3, 6, 0.5, 0.03).unwrap();
    let ground = Ground { corner: DVec2::splat(-0.5), size: DVec2::ONE, cells: [16, 16] };
    Shape::Mesh(Arc::new(height_field(&ground, Up::Z, floor, |p| waves.height(p)).unwrap()))
}

/// Every shape, alone.
fn alone() -> Vec<Specimen> {
    let bowl: Vec<[f64; 2]> = (0..=12).map(|i| f64::from(i) / 24.0).map(|r| [r, 1.2 * r * r]).collect();
    let half = DVec3::new(0.5, 0.3, 0.2);
    vec![
        specimen("ball", vec![sphere(DVec3::ZERO, 0.4)], both),
        specimen("small ball", vec![sphere(DVec3::ZERO, 0.05)], outer),
        specimen("cuboid", vec![cuboid(-half, half)], both),
        specimen("plate", vec![cuboid(DVec3::ZERO, DVec3::new(1.0, 1.0, 1e-5))], outer),
        specimen("rectangle", vec![floor()], both),
        specimen("slab", vec![Shape::Slab(Slab::new(0.0, 0.7).unwrap())], both),
        specimen("cylinder", vec![lathe(&[[0.0, 0.0], [0.3, 0.0], [0.3, 0.5], [0.0, 0.5]])], both),
        specimen("bowl", vec![lathe(&bowl)], both),
        specimen("rod", vec![lathe(&[[0.0, 0.0], [0.02, 0.0], [0.02, 0.6], [0.0, 0.6]])], outer),
        specimen("faceted ball", vec![faceted_ball(0.4, 24, 12)], both),
        specimen("mesh box", vec![mesh_box(-half, half)], both),
        specimen("waves", vec![waves(None)], both),
        specimen("block with waves", vec![waves(Some(-0.4))], outer),
    ]
}

/// Shapes that stand on, cover or part each other.
fn together() -> Vec<Specimen> {
    let (low, high) = (DVec3::new(-0.2, -0.2, 0.0), DVec3::new(0.2, 0.2, 0.3));
    // A floor lit from above but for what stands on it, and the sides and the top of that.
    let standing = move |body: usize, p: DVec3, is_outer: bool| {
        let is_under = p.x.abs() < 0.2 && p.y.abs() < 0.2;
        match body {
            0 => f64::from(is_outer && !is_under),
            _ => f64::from(is_outer && p.z > 1e-9),
        }
    };
    let round = move |body: usize, p: DVec3, is_outer: bool| match body {
        0 => f64::from(is_outer && p.length() > 0.3),
        _ => f64::from(is_outer && p.z > 0.0),
    };
    let shifted = rectangle(DVec3::new(-0.1, -0.3, 0.0), DVec3::X, DVec3::Y);
    let wall = rectangle(DVec3::new(0.0, -0.5, -0.1), DVec3::Y, DVec3::Z * 0.6);
    let side = |x: f64| if x < 0.0 { 3.0 } else { 1.0 };
    let parted = move |body: usize, p: DVec3, is_outer: bool| match body {
        0 if is_outer => side(p.x),
        1 if p.z > 0.0 => side(if is_outer { 1.0 } else { -1.0 }),
        _ => 0.0,
    };
    let room = |x: f64| cuboid(DVec3::new(x, 0.0, 0.0), DVec3::new(x + 0.6, 0.6, 0.6));
    let tube = lathe(&[[0.2, 0.0], [0.2, 0.3]]);
    vec![
        specimen("block on a floor", vec![floor(), cuboid(low, high)], standing),
        specimen("mesh on a floor", vec![floor(), mesh_box(low, high)], standing),
        specimen(
            "cylinder on a floor",
            vec![floor(), lathe(&[[0.0, 0.0], [0.3, 0.0], [0.3, 0.2], [0.0, 0.2]])],
            {
                move |body, p, is_outer| match body {
                    0 => f64::from(is_outer && p.length() > 0.3),
                    _ => f64::from(is_outer && p.z > 1e-9),
                }
            },
        ),
        specimen("ball half sunk", vec![floor(), sphere(DVec3::ZERO, 0.3)], round),
        specimen(
            "ball within a faceted ball",
            vec![sphere(DVec3::ZERO, 0.25), faceted_ball(0.3, 24, 12)],
            |body, _, is_outer| f64::from(body == 1 && is_outer),
        ),
        specimen("floors that overlap", vec![floor(), Shape::Rectangle(shifted)], |body, p, is_outer| {
            f64::from(is_outer && !(body == 1 && p.x < 0.5 && p.y < 0.5))
        }),
        specimen("floor on both sides of a wall", vec![floor(), Shape::Rectangle(wall)], parted),
        specimen("rooms side by side", vec![room(0.0), room(0.6)], |body, _, is_outer| {
            if is_outer { 0.0 } else { [1.0, 3.0][body] }
        }),
        specimen(
            "tube with a round end",
            vec![tube, sphere(DVec3::new(0.0, 0.0, 0.3), 0.2)],
            |body, p, is_outer| f64::from(is_outer && (body == 0 || p.z > 0.3)),
        ),
    ]
}

/// A point of a body's surface, uniform, and its outward normal; of a slab on either face, over a cell of side 2.
fn on_surface(shape: &Shape, stream: &mut Stream) -> (DVec3, DVec3) {
    let face = if stream.unit() < 0.5 { Face::Top } else { Face::Bottom };
    let (point, normal, _) = shape.sample_boundary(face, glam::DVec2::splat(2.0), stream.triple());
    (point, normal)
}

fn area(shape: &Shape) -> f64 {
    if matches!(shape, Shape::Slab(_)) { 8.0 } else { shape.area() }
}

impl Specimen {
    fn scene(&self) -> Scene {
        let objects = self.shapes.iter().map(|s| (s.clone(), lambertian(Spectrum::grey(0.5)))).collect();
        bounded(Vec::new(), objects, vec![emitting_sphere(DVec3::new(0.3, 0.2, 9.0), 0.1)])
    }

    /// Some `count` photons, for an irradiance of `lit` if `emitted` were sent out.
    fn photons(&self, count: f64, emitted: u64, stream: &mut Stream) -> Vec<Photon> {
        let total: f64 = self.shapes.iter().map(area).sum();
        let mut photons = Vec::new();
        for (body, shape) in self.shapes.iter().enumerate() {
            for is_outer in [true, false] {
                let places = (count * area(shape) / total).ceil();
                let power = emitted as f64 * area(shape) / places;
                for _ in 0..places as u64 {
                    let (position, outward) = on_surface(shape, stream);
                    let lit = (self.lit)(body, position, is_outer);
                    let normal = if is_outer { outward } else { -outward };
                    let (dir, normal) = (-normal.as_vec3(), normal.as_vec3());
                    let power = Vec3::splat((power * lit) as f32);
                    if lit > 0.0 {
                        photons.push(Photon {
                            position,
                            dir,
                            normal,
                            power,
                            order: 1,
                            flags: Flags::DIFFUSE,
                        });
                    }
                }
            }
        }
        photons
    }

    /// Some lit place, the normal there and its irradiance; of a slab in the middle of the cell.
    fn place(&self, stream: &mut Stream) -> (DVec3, DVec3, f64) {
        loop {
            let body = stream.index(self.shapes.len());
            let (point, outward) = on_surface(&self.shapes[body], stream);
            let is_outer = stream.unit() < 0.5;
            let lit = (self.lit)(body, point, is_outer);
            let is_inside = !matches!(self.shapes[body], Shape::Slab(_))
                || (0.5..1.5).contains(&point.x) && (0.5..1.5).contains(&point.y);
            if lit > 0.0 && is_inside {
                return (point, if is_outer { outward } else { -outward }, lit);
            }
        }
    }
}

/// Of 1000 photons sent out.
fn global_map(photons: Vec<Photon>) -> Maps {
    Maps { global: Some(PhotonMap::new(photons, 1000).unwrap()), ..Maps::none(Indirect::Seen) }
}

/// With more photons than a curved body has within its reach the last takes what there is.
fn gathers() -> [(Kernel, Gather); 4] {
    [
        (Kernel::Uniform, Gather::radius(0.12).unwrap()),
        (Kernel::Cone, Gather::nearest(20, 0.3).unwrap()),
        (Kernel::Gaussian, Gather::radius(0.25).unwrap()),
        (Kernel::Cone, Gather::nearest(400, 0.3).unwrap()),
    ]
}

/// Irradiance over what it should be, for each gather, in the mean over some places of each of 64 maps.
fn read(specimen: &Specimen, clips_discs: bool, seed: u64) -> [Moments; 4] {
    let scene = specimen.scene();
    let mut moments = [(); 4].map(|()| Moments::new());
    for replicate in 0..64 {
        let mut stream = Stream::new(seed, Purpose::Synthetic, replicate, 0);
        let photons = specimen.photons(5000.0, 1000, &mut stream);
        let maps = global_map(photons);
        let mut sums = [0.0; 4];
        const PLACES: u32 = 48;
        for _ in 0..PLACES {
            let (point, normal, lit) = specimen.place(&mut stream);
            // Beyond what rounding may do, and before anything else stands in the way.
            let ray = Ray::new(point + normal * 1e-7, -normal);
            for (sum, global) in sums.iter_mut().zip(gathers()) {
                let settings = Settings { global, slope: 0.1, clips_discs, ..settings(1) };
                let mapper = Mapper::new(&scene, &maps, &settings);
                let seen = mapper.radiance(ray, None, 0, &mut stream).0.indirect[1];
                *sum += seen * PI / 0.5 / lit / f64::from(PLACES);
            }
        }
        for (moments, sum) in moments.iter_mut().zip(sums) {
            moments.push(sum);
        }
    }
    moments
}

/// Lines on a spiral know half of a disc or more to 2 per cent of the disc, a quarter to 8 per cent of it: what that does to
/// the mean of the inverse is below one per cent. Independent lines do nothing to it.
const LINES: f64 = 0.01;

#[test]
fn every_shape_from_either_side() {
    for specimen in alone() {
        for (moments, gather) in read(&specimen, true, 31).iter().zip(gathers()) {
            let what = format!("{}, {gather:?}", specimen.name);
            verdict::agrees(&what, moments, (1.0, LINES), 0.1, 31);
            // With all photons in place of k 0.0025; with lines over a disc much larger than what is accepted 0.0075.
            if specimen.name == "faceted ball" && gather.1.k() == Some(400) {
                assert!(moments.std_error() < 0.005, "{}", moments.std_error());
            }
        }
    }
}

#[test]
fn shapes_that_cover_and_part_each_other() {
    for specimen in together() {
        for (moments, gather) in read(&specimen, true, 32).iter().zip(gathers()) {
            let what = format!("{}, {gather:?}", specimen.name);
            verdict::agrees(&what, moments, (1.0, LINES), 0.1, 32);
        }
    }
}

/// Divided by the whole disc estimates on curved and on covered surfaces are too small.
#[test]
fn whole_discs_are_found_out() {
    let alone =
        alone().into_iter().filter(|s| ["ball", "small ball", "cylinder", "faceted ball"].contains(&s.name));
    let together = together().into_iter().filter(|s| s.name == "block on a floor");
    for specimen in alone.chain(together) {
        // The k nearest may lie as near as the curvature lets them.
        for (moments, gather) in read(&specimen, false, 33).iter().zip(gathers()).step_by(2) {
            verdict::rejects(&format!("{}, {gather:?}", specimen.name), moments, 1.0, 33);
        }
    }
}

/// Where a ray goes, from two numbers in [0, 1).
type Look = Box<dyn Fn([f64; 2]) -> Ray>;

/// Indirect light along some rays by the photon mapper, a value a map, and by paths, a value as many rays.
fn by_both(
    scene: &Scene,
    settings: &Settings,
    (indirect, emitted, rays): (Indirect, u64, u64),
    seed: u64,
    looks: &[(&str, Look)],
) -> Vec<[Moments; 2]> {
    let mut moments = vec![[Moments::new(), Moments::new()]; looks.len()];
    for replicate in 0..64 {
        let maps = fill(scene, &filling(emitted, indirect, seed, replicate), &NoProgress).unwrap();
        let mapper = Mapper::new(scene, &maps, settings);
        for (index, ((_, look), moments)) in looks.iter().zip(&mut moments).enumerate() {
            let mut sums = [0.0; 2];
            for history in 0..rays {
                let history = history * looks.len() as u64 + index as u64;
                let mut stream = Stream::new(seed, Purpose::Paths, replicate, history);
                let ray = look(stream.pair());
                sums[0] += mapper.radiance(ray, None, 0, &mut stream).0.indirect[1];
                // Paths are cheap and noisy.
                for _ in 0..8 {
                    sums[1] += path::layers(scene, ray, None, 0, &mut stream).0.indirect[1] / 8.0;
                }
            }
            for (moments, sum) in moments.iter_mut().zip(sums) {
                moments.push(sum / rays as f64);
            }
        }
    }
    moments
}

/// A room that is the inside of a cuboid, with a ball, a faceted ball and a block in it: what maps say of each, seen
/// directly, is what paths say. Discs are small: what is left of blur is a per cent or two.
#[test]
fn maps_agree_with_paths_in_a_room_of_one_cuboid() {
    let shapes = [
        cuboid(DVec3::ZERO, DVec3::splat(2.0)),
        sphere(DVec3::new(1.3, 1.2, 0.9), 0.3),
        cuboid(DVec3::new(0.3, 0.3, 0.0), DVec3::new(0.8, 0.8, 0.5)),
    ];
    let objects = shapes.map(|shape| (shape, lambertian(Spectrum::grey(0.6)))).to_vec();
    let scene = bounded(Vec::new(), objects, vec![emitting_sphere(DVec3::new(1.0, 1.0, 1.7), 0.1)]);
    let global = (Kernel::Uniform, Gather::radius(0.09).unwrap());
    let settings = Settings { global, slope: 0.1, ..settings(1) };
    let looking = |eye: DVec3, target: DVec3| Ray::new(eye, (target - eye).normalize());
    let looks: [(&str, Look); 3] = [
        ("wall", Box::new(move |[u, v]| looking(DVec3::splat(1.0), DVec3::new(0.0, 0.3 + 1.4 * u, 0.8 + v)))),
        (
            "ball",
            Box::new(move |[u, v]| {
                let eye = DVec3::new(1.3, 0.2, 0.9);
                looking(eye, DVec3::new(1.1 + 0.4 * u, 1.2, 0.7 + 0.4 * v))
            }),
        ),
        // Up to half a disc from the foot.
        (
            "foot of the block",
            Box::new(move |[u, v]| {
                looking(DVec3::new(1.0, 0.5, 0.4), DVec3::new(0.801 + 0.03 * u, 0.35 + 0.4 * v, 0.0))
            }),
        ),
    ];
    let found = by_both(&scene, &settings, (Indirect::Seen, 15_000, 100), 34, &looks);
    for ((name, _), [maps, paths]) in looks.iter().zip(found) {
        verdict::agree(name, &maps, &paths, 0.2 * paths.mean(), 34);
    }
}

/// A wall lit only by a ball that a spot light falls on, through final gathering.
#[test]
fn a_wall_lit_by_a_ball() {
    let wall = rectangle(DVec3::new(0.6, -1.0, -1.0), DVec3::Z * 2.0, DVec3::Y * 2.0);
    let objects = vec![
        (Shape::Rectangle(wall), lambertian(Spectrum::grey(0.7))),
        (sphere(DVec3::ZERO, 0.3), lambertian(Spectrum::grey(0.7))),
    ];
    let spot = Spot::new(DVec3::Z * 3.0, DVec3::NEG_Z, (4.0, 5.0), Spectrum::ONE).unwrap();
    let scene = bounded(Vec::new(), objects, vec![Light::Spot(spot)]);
    let global = (Kernel::Uniform, Gather::nearest(20, 0.2).unwrap());
    let settings = Settings { global, slope: 0.1, ..settings(16) };
    let look =
        |[u, v]: [f64; 2]| Ray::new(DVec3::new(0.4, -0.5, 0.3), DVec3::new(0.2, u, v - 0.5).normalize());
    let looks: [(&str, Look); 1] = [("wall", Box::new(look))];
    let found = by_both(&scene, &settings, (Indirect::Gathered, 1000, 300), 35, &looks);
    for ((name, _), [maps, paths]) in looks.iter().zip(found) {
        verdict::agree(name, &maps, &paths, 0.2 * paths.mean(), 35);
    }
}

/// A cuboid so thin that its narrow faces make no rectangle: a ray that meets one finds no light there, and no panic.
#[test]
fn a_film_without_narrow_faces() {
    let film = cuboid(DVec3::ZERO, DVec3::new(1.0, 1.0, 1e-310));
    let specimen = specimen("film", vec![film], outer);
    let scene = specimen.scene();
    let mut stream = Stream::new(36, Purpose::Synthetic, 0, 0);
    let maps = global_map(specimen.photons(2000.0, 1000, &mut stream));
    let settings = Settings { slope: 0.1, ..settings(1) };
    let mapper = Mapper::new(&scene, &maps, &settings);
    for dir in [DVec3::X, DVec3::Y] {
        let ray = Ray::new(DVec3::new(0.5, 0.5, 0.0) - 2.0 * dir, dir);
        let indirect = mapper.radiance(ray, None, 0, &mut stream).0.indirect[1];
        assert!(indirect >= 0.0 && indirect.is_finite(), "{dir}: {indirect}");
    }
}
