//! Which interior a place is in, where bodies hide boundaries and where interiors have no end.

use crate::support::run::paths;
use crate::support::scenes::{
    bounded, cuboid, dielectric, emitting_sphere, faceted_ball, filled, lambertian, rectangle, region, sphere,
};
use crate::support::verdict;
use glam::DVec3;
use turbid::Spectrum;
use turbid::geometry::Shape;
use turbid::math::Asymmetry;
use turbid::medium::{Homogeneous, Medium};
use turbid::phase::Phase;
use turbid::rng::{Purpose, Stream};
use turbid::scene::{Interior, Object, Orders, Quantity, Scene, SceneParts};
use turbid::surface::{Filter, Surface};

fn wall(corner: DVec3, u: DVec3, v: DVec3) -> Object {
    Object { shape: Shape::Rectangle(rectangle(corner, u, v)), surface: grey() }
}

fn grey() -> Surface {
    lambertian(Spectrum::grey(0.5))
}

fn scene(index: f64, medium: Medium, objects: Vec<Object>, lamp: DVec3) -> Scene {
    let interiors = vec![Interior::surroundings(), filled("water", index, medium)];
    let lights = vec![emitting_sphere(lamp, 0.5)];
    Scene::new(SceneParts { interiors, objects, lights, ..SceneParts::default() }).unwrap()
}

fn water(emission: f64) -> Medium {
    let phase = Phase::with_asymmetry(Asymmetry::try_from(0.0).unwrap());
    let half = Spectrum::grey(0.5);
    Homogeneous::new(half, half, phase).unwrap().with_emission(Spectrum::grey(emission)).unwrap().into()
}

/// That every place of a cube is in the water or not, as expected where that is said; so many are in it, of 4000.
fn check(scene: &Scene, half: f64, expected: impl Fn(DVec3) -> Option<bool>) -> usize {
    let mut stream = Stream::new(21, Purpose::Synthetic, 0, 0);
    let mut wet = 0;
    for _ in 0..4000 {
        let p = half * (2.0 * DVec3::from(stream.triple()) - 1.0);
        if let Some(is_wet) = expected(p) {
            assert_eq!(scene.interior_at(p), usize::from(is_wet), "{p}");
            wet += usize::from(is_wet);
        }
    }
    wet
}

/// A sea without end about bubbles, a body that hides them and a tinted shell about one.
fn sea(medium: Medium) -> Scene {
    let bubbles = [
        sphere(DVec3::ZERO, 1.0),
        cuboid(DVec3::new(2.0, 1.0, -1.0), DVec3::new(3.0, 1.7, 0.0)),
        faceted_ball(DVec3::new(-2.0, 2.0, 1.0), 0.5, 2, false),
    ];
    let bubbles = bubbles.map(|shape| Object { shape, surface: dielectric(0, 1) });
    let filter = Surface::Filter(Filter::new(Spectrum::grey(0.7)).unwrap());
    let others = [
        Object { shape: sphere(DVec3::new(1.5, 1.5, 2.0), 1.0), surface: grey() },
        Object { shape: sphere(DVec3::new(-2.0, 2.0, 1.0), 0.7), surface: filter },
    ];
    scene(1.0, medium, bubbles.into_iter().chain(others).collect(), DVec3::ZERO)
}

#[test]
fn a_sea_lies_about_its_bubbles() {
    let in_a_bubble = |p: DVec3| {
        let is_in_box = (p - DVec3::new(2.5, 1.35, -0.5)).abs().cmplt(DVec3::new(0.5, 0.35, 0.5)).all();
        p.length() < 1.0 || is_in_box || p.distance(DVec3::new(-2.0, 2.0, 1.0)) < 0.45
    };
    // The facets lie within the ball, and the body is opaque.
    let is_told = |p: DVec3| {
        let from_facets = p.distance(DVec3::new(-2.0, 2.0, 1.0));
        !(0.45..0.5).contains(&from_facets) && p.distance(DVec3::new(1.5, 1.5, 2.0)) > 1.0
    };
    let wet = check(&sea(water(0.0)), 5.0, |p| is_told(p).then(|| !in_a_bubble(p)));
    assert!((3000..4000).contains(&wet), "{wet}");
}

/// Light from a bubble, beside the same sea as a large region with a void in it.
#[test]
fn light_enters_a_sea_as_it_enters_a_region() {
    let bubble = Object { shape: sphere(DVec3::ZERO, 1.0), surface: dielectric(0, 1) };
    let by_interior = scene(1.0, water(0.0), vec![bubble], DVec3::ZERO);
    let regions = vec![
        region(sphere(DVec3::ZERO, 60.0), 0.5, 0.5, 0.0),
        region(sphere(DVec3::ZERO, 1.0), 0.0, 0.0, 0.0),
    ];
    let by_region = bounded(regions, vec![], vec![emitting_sphere(DVec3::ZERO, 0.5)]);
    for (p, seed) in [(DVec3::new(1.2, 1.2, 1.1), 22), (DVec3::new(0.02, 0.03, 2.0), 24)] {
        let [one, other] = [(&by_interior, seed), (&by_region, seed + 1)]
            .map(|(scene, seed)| paths(scene, Quantity::Fluence(p), Orders::ALL, 20_000, seed)[0]);
        verdict::agree(&format!("fluence at {p}"), &one, &other, 0.05 * other.mean(), seed);
    }
}

/// A sea that emits has no end for photons to start in; what closed bodies or a basin hold has.
#[test]
fn photons_do_not_start_in_a_sea_without_end() {
    assert!(sea(water(0.1)).check_emission().is_err());
    assert!(sea(water(0.0)).check_emission().is_ok());
    assert!(basin(water(0.1)).check_emission().is_ok());
    let drop = Object { shape: sphere(DVec3::Z * 3.0, 1.0), surface: dielectric(1, 0) };
    assert!(scene(1.3, water(0.1), vec![drop], DVec3::ZERO).check_emission().is_ok());
}

/// Water in a basin, half of it under a lid, with a ball that hangs from that.
fn basin(medium: Medium) -> Scene {
    let [x, y, z] = DVec3::AXES;
    let corner = DVec3::new(-1.0, -1.0, -0.4);
    let level = Shape::Rectangle(rectangle(DVec3::new(-1.0, -1.0, 0.0), 1.3 * x, 2.0 * y));
    let objects = vec![
        Object { shape: level, surface: dielectric(1, 0) },
        wall(DVec3::new(0.3, -1.0, 0.0), 0.7 * x, 2.0 * y),
        wall(corner, 2.0 * x, 2.0 * y),
        wall(corner, 2.0 * x, 0.6 * z),
        wall(corner + 2.0 * y, 2.0 * x, 0.6 * z),
        wall(corner, 2.0 * y, 0.6 * z),
        wall(corner + 2.0 * x, 2.0 * y, 0.6 * z),
        Object { shape: sphere(DVec3::new(0.5, 0.0, -0.2), 0.1), surface: grey() },
    ];
    scene(1.33, medium, objects, DVec3::Z * 3.0)
}

#[test]
fn water_ends_at_the_walls_of_its_basin() {
    let is_wet = |p: DVec3| p.x.abs() < 1.0 && p.y.abs() < 1.0 && -0.4 < p.z && p.z < 0.0;
    let is_body = |p: DVec3| p.distance(DVec3::new(0.5, 0.0, -0.2)) <= 0.1;
    let wet = check(&basin(water(0.0)), 1.5, |p| (!is_body(p)).then(|| is_wet(p)));
    assert!((100..400).contains(&wet), "{wet}");
}

/// A level alone has no end below, nor has what is above it.
#[test]
fn a_level_alone_has_a_side_each() {
    let level = Shape::Rectangle(rectangle(DVec3::new(-9.0, -9.0, 0.0), DVec3::X * 18.0, DVec3::Y * 18.0));
    let open =
        scene(1.33, water(0.1), vec![Object { shape: level, surface: dielectric(1, 0) }], DVec3::Z * 3.0);
    check(&open, 1.5, |p| Some(p.z < 0.0));
    assert!(open.check_emission().is_err());
}
