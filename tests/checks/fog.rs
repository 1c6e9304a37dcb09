//! Height fog on nearly level rays, grids placed by a scene file, and fog before a black wall.

use super::point_light::{BESIDE, fog, ray, single_scattering_up_to};
use crate::support::quadrature::integrate;
use crate::support::run::paths;
use crate::support::scenes::{bounded, point_light, rectangle};
use crate::support::verdict;
use glam::DVec3;
use turbid::Spectrum;
use turbid::geometry::Shape;
use turbid::math::{Interval, Positive, Ray};
use turbid::medium::{Density, Grid, HeightFog};
use turbid::scene::{Orders, Quantity, SceneFile};
use turbid::surface::{Black, Surface};

/// The depth of height fog along rays that climb and fall by 1 to 1e-12 scale heights a length, from below the base and
/// above it, over a hundredth to eight scale heights: against quadrature of its density.
pub fn gentle_slopes_have_their_depth() {
    for scale in [0.5, 1.0, 30.0, 1e4] {
        let height = Positive::try_from(scale).unwrap();
        let fog = HeightFog::new(DVec3::Z, 0.0, height).unwrap();
        let density = Density::HeightFog(fog);
        for exponent in 0..13 {
            let climb = libm::pow(10.0, -f64::from(exponent));
            for (way, start) in [(1.0, 0.0), (1.0, 0.7), (1.0, -0.3), (-1.0, 2.0), (-1.0, 0.4)] {
                for rise in [0.01, 0.5, 2.0, 8.0] {
                    // The slope over the scale height is what counts, however it comes about.
                    let cosine = (climb * scale).min(1.0) * way;
                    let length = rise * scale / cosine.abs();
                    let dir = DVec3::new(((1.0 - cosine) * (1.0 + cosine)).sqrt(), 0.0, cosine);
                    let ray = Ray::new(DVec3::new(0.0, 0.0, start * scale), dir);
                    let part = Interval { start: 0.1 * length, end: length };
                    // Parts that end where the ray crosses the base, where the density has a kink.
                    let crossing = (-start * scale / cosine).clamp(part.start, part.end);
                    let f = |t: f64| density.at(ray.at(t));
                    let expected =
                        integrate(part.start, crossing, 4, f) + integrate(crossing, part.end, 4, f);
                    let found = density.integral(&ray, part);
                    assert!(
                        (found / expected - 1.0).abs() < 1e-9,
                        "{found} for {expected}: scale {scale}, climb {climb}, start {start}, rise {rise}"
                    );
                }
            }
        }
    }
}

/// The density that a scene file with a grid gives: `keys` stand beside `file`.
fn placed(folder: &std::path::Path, keys: &str) -> Density {
    let text = format!(
        "[[regions]]\nshape = {{ cuboid = {{ min = [-9.0, -9.0, -9.0], max = [9.0, 9.0, 9.0] }} }}\n\
         sigma_t = 1.0\nalbedo = 0.5\ng = 0.0\n\
         density = {{ grid = {{ file = \"a.vol\"{keys} }} }}\n\
         [[lights]]\npoint = {{ position = [9.5, 0.0, 0.0], power = 1.0 }}\n"
    );
    let scene = SceneFile::from_toml(&text).unwrap().scene(folder).unwrap();
    scene.regions()[0].medium.density().unwrap().clone()
}

/// A grid's file, its scale and its box, each given or not: a sample is the file's times the scale, where the box says.
pub fn a_grid_is_scaled_and_placed() {
    let own = (DVec3::ZERO, DVec3::new(2.0, 1.0, 4.0));
    let grid = Grid::new(own, [2, 1, 4], 1, (1..=8u8).map(f32::from).collect()).unwrap();
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("a.vol"), grid.to_bytes()).unwrap();
    let box_keys = ", min = [-3.0, 1.0, -2.0], max = [1.0, 2.0, 6.0]";
    let given = (DVec3::new(-3.0, 1.0, -2.0), DVec3::new(1.0, 2.0, 6.0));
    for (keys, corners, scale) in [
        (String::new(), own, 1.0),
        (", scale = 0.25".into(), own, 0.25),
        (box_keys.into(), given, 1.0),
        (format!(", scale = 0.25{box_keys}"), given, 0.25),
    ] {
        let density = placed(folder.path(), &keys);
        for z in 0..4 {
            for x in 0..2 {
                let part = DVec3::new(0.25 + 0.5 * x as f64, 0.5, 0.125 + 0.25 * z as f64);
                let p = corners.0 + (corners.1 - corners.0) * part;
                let expected = scale * (1 + x + 2 * z) as f64;
                assert_eq!(density.at(p), expected, "grid of `{keys}` at {p}");
            }
        }
        assert_eq!(density.high(), 8.0 * scale);
    }
}

/// Single scattering about a point light before a black wall, with fog behind it: the integral up to the wall.
pub fn a_wall_ends_the_angles() {
    const N: u64 = 1 << 16;
    let open = fog(Spectrum::ONE, Spectrum::grey(0.9));
    for wall in [0.3, 0.06] {
        let corner = DVec3::new(-2.0, -2.0, wall);
        let black = Shape::Rectangle(rectangle(corner, DVec3::X * 4.0, DVec3::Y * 4.0));
        let light = point_light(DVec3::ZERO, Spectrum::ONE);
        let scene = bounded(open.regions().to_vec(), vec![(black, Surface::Black(Black))], vec![light]);
        for nearest in [BESIDE, 0.4] {
            let expected = single_scattering_up_to(wall, 1.0, 0.9, nearest);
            let looked = Quantity::Radiance(ray(nearest));
            let found = paths(&scene, looked, Orders::only(1), N, 71)[0];
            let what = format!("wall at {wall}, ray past the light at {nearest}");
            verdict::agrees(&what, &found, (expected, 1e-9 * expected), 0.015 * expected, 71);
        }
    }
}
