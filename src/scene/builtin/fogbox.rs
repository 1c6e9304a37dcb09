//! The built-in box of fog: a closed room of coloured walls with two blocks and a lamp, seen from within.

use super::region::region;
use crate::error::Result;
use crate::math::{Albedo, Asymmetry, NonNegative};
use crate::scene::Filter;
use crate::scene::file::{
    CameraFile, Channels, LightFile, ObjectFile, SceneFile, ShapeFile, SurfaceFile, TextureFile,
};
use serde::Deserialize;

/// Defaults and meanings of the parameters.
pub(super) const DEFAULTS: &str = "\
sigma_t = 0.5       # extinction of the fog, in 1/L; the box is 2 L wide; 0 is no fog
albedo = 0.8        # single-scattering albedo, 0 to 1
g = 0.0             # asymmetry of the Henyey-Greenstein phase function, above -1 and below 1
width = 128         # pixels across
height = 128        # pixels down
";

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Parameters {
    sigma_t: NonNegative,
    albedo: Albedo,
    g: Asymmetry,
    width: u32,
    height: u32,
}

/// A rectangle: corner, u, v \[L\].
type Corner = [[f64; 3]; 3];

/// Reflectances of the white, red and green paint.
const PAINT: [[f64; 3]; 3] =
    [[0.885809, 0.698859, 0.666422], [0.570068, 0.0430135, 0.0443706], [0.105421, 0.37798, 0.076425]];

/// Floor, ceiling, back wall, front wall, then the tall block and the low one.
const WHITE: [Corner; 16] = [
    [[-1.0, -1.0, 1.0], [2.0, 0.0, 0.0], [0.0, 0.0, -2.0]],
    [[-1.0, 1.0, -1.0], [2.0, 0.0, 0.0], [0.0, 0.0, 2.0]],
    [[-1.0, -1.0, -1.0], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0]],
    [[-1.0, 1.0, 1.0], [2.0, 0.0, 0.0], [0.0, -2.0, 0.0]],
    [[-0.5209609, -1.01, 0.0988591], [0.0, 1.22, 0.0], [-0.1878982, 0.0, -0.56982]],
    [[-0.1390391, -1.01, -0.6588591], [0.0, 1.22, 0.0], [0.1878982, 0.0, 0.56982]],
    [[-0.7088591, -1.01, -0.4709609], [0.56982, 0.0, -0.1878982], [0.1878982, 0.0, 0.56982]],
    [[-0.5209609, 0.21, 0.0988591], [0.56982, 0.0, -0.1878982], [-0.1878982, 0.0, -0.56982]],
    [[-0.7088591, 0.21, -0.4709609], [0.56982, 0.0, -0.1878982], [0.0, -1.22, 0.0]],
    [[-0.5209609, -1.01, 0.0988591], [0.56982, 0.0, -0.1878982], [0.0, 1.22, 0.0]],
    [[-0.0396025, -1.0, 0.5791795], [0.0, 0.6, 0.0], [0.175423, 0.0, -0.573782]],
    [[0.7096025, -1.0, 0.1808205], [0.0, 0.6, 0.0], [-0.175423, 0.0, 0.573782]],
    [[0.1358205, -1.0, 0.0053975], [0.573782, 0.0, 0.175423], [-0.175423, 0.0, 0.573782]],
    [[-0.0396025, -0.4, 0.5791795], [0.573782, 0.0, 0.175423], [0.175423, 0.0, -0.573782]],
    [[0.1358205, -0.4, 0.0053975], [0.573782, 0.0, 0.175423], [0.0, -0.6, 0.0]],
    [[-0.0396025, -1.0, 0.5791795], [0.573782, 0.0, 0.175423], [0.0, 0.6, 0.0]],
];

/// The wall on the left.
const RED: [Corner; 1] = [[[-1.0, -1.0, -1.0], [0.0, 2.0, 0.0], [0.0, 0.0, 2.0]]];

/// The wall on the right.
const GREEN: [Corner; 1] = [[[1.0, -1.0, 1.0], [0.0, 2.0, 0.0], [0.0, 0.0, -2.0]]];

/// The lamp below the ceiling, and its radiance.
const LAMP: (Corner, [f64; 3]) =
    ([[-0.23, 0.99, -0.18], [0.46, 0.0, 0.0], [0.0, 0.0, 0.38]], [18.387, 13.9873, 6.75357]);

fn rectangle([corner, u, v]: Corner) -> ShapeFile {
    ShapeFile::Rectangle { corner, u, v }
}

fn wall(place: Corner, paint: [f64; 3]) -> Result<ObjectFile> {
    let [r, g, b] = paint.map(|c| Albedo::new("reflectance", c));
    let reflectance = TextureFile::Constant(Channels([r?, g?, b?]));
    Ok(ObjectFile { shape: rectangle(place), surface: SurfaceFile::Lambertian { reflectance } })
}

pub(super) fn file(p: Parameters) -> Result<SceneFile> {
    let objects = [(&WHITE[..], PAINT[0]), (&RED[..], PAINT[1]), (&GREEN[..], PAINT[2])]
        .into_iter()
        .flat_map(|(places, paint)| places.iter().map(move |place| wall(*place, paint)))
        .collect::<Result<_>>()?;
    let fog = region(ShapeFile::Cuboid { min: [-1.0; 3], max: [1.0; 3] }, p.sigma_t.get(), p.albedo, p.g)?;
    let [r, g, b] = LAMP.1.map(|c| NonNegative::new("radiance", c));
    let lamp = LightFile::Area { shape: rectangle(LAMP.0), radiance: Channels([r?, g?, b?]) };
    let camera = CameraFile {
        position: [0.0, 0.0, 0.95],
        look_at: [0.0; 3],
        up: [0.0, 1.0, 0.0],
        fov: 80.0,
        width: p.width,
        height: p.height,
        filter: Filter::Box,
    };
    let regions = if p.sigma_t.get() > 0.0 { vec![fog] } else { Vec::new() };
    Ok(SceneFile { regions, objects, lights: vec![lamp], camera: Some(camera), ..SceneFile::default() })
}
