//! The built-in scenes: a few parameters each, from which the whole scene file follows.

mod fogbox;
mod region;

use super::file::{
    CellFile, Channels, LightFile, QuantityFile, SceneFile, SectionFile, SensorFile, ShapeFile,
};
use crate::error::{Error, Result};
use crate::geometry::Face;
use crate::light::Faces;
use crate::math::{Albedo, Asymmetry, FOUR_PI, NonNegative, Positive};
use region::{grey, region};
use serde::{Deserialize, Serialize};
use std::f64::consts::PI;

/// A built-in scene: what it is, its parameters at their defaults, and the file that follows from parameters.
pub struct Builtin {
    /// Name on the command line.
    pub name: &'static str,
    /// What it is, in a line.
    pub about: &'static str,
    /// Defaults and meanings of the parameters, as TOML.
    pub defaults: &'static str,
    /// The scene file that follows from parameters.
    pub resolve: fn(&str) -> Resolved,
}

/// Parameters that are not TOML or not allowed, else the scene file, or why the parameters do not fit each other.
pub type Resolved = std::result::Result<Result<SceneFile>, toml::de::Error>;

// Functions with names, so that only this crate compiles the reading of parameters.
fn resolve_slab(text: &str) -> Resolved {
    toml::from_str(text).map(slab)
}

fn resolve_sphere(text: &str) -> Resolved {
    toml::from_str(text).map(sphere)
}

fn resolve_shaft(text: &str) -> Resolved {
    toml::from_str(text).map(shaft)
}

fn resolve_fogbox(text: &str) -> Resolved {
    toml::from_str(text).map(fogbox::file)
}

/// Every built-in scene.
pub const BUILTIN: [Builtin; 4] = [
    Builtin {
        name: "slab",
        about: "a plane-parallel layer of fog, without lateral end, lit on its top face with irradiance 1",
        defaults: "\
tau = 2.0           # optical thickness, above 0
albedo = 0.9        # single-scattering albedo, 0 to 1
g = 0.0             # asymmetry of the Henyey-Greenstein phase function, above -1 and below 1
mu0 = 1.0           # cosine of incidence, above 0 and at most 1, or \"diffuse\" (Lambertian incidence)
cell = 4.0          # side of the cell that stands for the layer, in mean free paths
scale = 1.0         # length of a mean free path in scene units
probes = [0.1, 0.25, 0.5, 0.75, 0.9]  # depths of the fluence probes, in parts of the thickness
",
        resolve: resolve_slab,
    },
    Builtin {
        name: "sphere",
        about: "a ball of fog with a source of power 1 inside, or lit from all sides with irradiance 1",
        defaults: "\
radius = 1.0        # in mean free paths, above 0
albedo = 0.9        # single-scattering albedo, 0 to 1
g = 0.0             # asymmetry of the Henyey-Greenstein phase function, above -1 and below 1
source = \"volume\"   # volume (uniform), point (at the centre), or incidence (isotropic, radiance 1/pi)
probes = [0.0, 0.25, 0.5, 0.75, 0.9]  # distances of the fluence probes from the centre, in parts of the radius
",
        resolve: resolve_sphere,
    },
    Builtin {
        name: "shaft",
        about: "a wide square beam with a straight edge at x = 0, straight down into a layer of fog",
        defaults: "\
tau = 4.0           # optical thickness of the layer, above 0
albedo = 0.5        # single-scattering albedo, 0 to 1
g = 0.0             # asymmetry of the Henyey-Greenstein phase function, above -1 and below 1
width = 8.0         # side of the beam, which fills 0 < x < width, -width/2 < y < width/2, in mean free paths
depth = 2.0         # depth of the fluence probes, in mean free paths
probes = [-1.0, -0.5, -0.25, 0.0, 0.25, 0.5, 1.0]  # x of the fluence probes, in mean free paths
",
        resolve: resolve_shaft,
    },
    Builtin {
        name: "fogbox",
        about: "a closed box of coloured walls with two blocks and a lamp, full of fog, with a camera: for render and map",
        defaults: fogbox::DEFAULTS,
        resolve: resolve_fogbox,
    },
];

/// A cosine of incidence, or the word `diffuse`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "toml::Value")]
enum Incidence {
    Beam(f64),
    Diffuse,
}

impl TryFrom<toml::Value> for Incidence {
    type Error = String;
    fn try_from(value: toml::Value) -> std::result::Result<Self, String> {
        const ALLOWED: &str = "allowed: above 0 and at most 1, or \"diffuse\"";
        let number = match &value {
            toml::Value::String(word) if word == "diffuse" => return Ok(Incidence::Diffuse),
            toml::Value::Float(x) => *x,
            toml::Value::Integer(x) => *x as f64,
            other => return Err(format!("the value is {other}; {ALLOWED}")),
        };
        if number > 0.0 && number <= 1.0 {
            Ok(Incidence::Beam(number))
        } else {
            Err(format!("the value is {number}; {ALLOWED}"))
        }
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct SlabParameters {
    tau: Positive,
    albedo: Albedo,
    g: Asymmetry,
    mu0: Incidence,
    cell: Positive,
    scale: Positive,
    probes: Vec<NonNegative>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct SphereParameters {
    radius: Positive,
    albedo: Albedo,
    g: Asymmetry,
    source: SphereSource,
    probes: Vec<NonNegative>,
}

#[derive(Deserialize)]
#[serde(rename_all = "kebab-case")]
enum SphereSource {
    Volume,
    Point,
    Incidence,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ShaftParameters {
    tau: Positive,
    albedo: Albedo,
    g: Asymmetry,
    width: Positive,
    depth: NonNegative,
    probes: Vec<f64>,
}

/// A grey emission that the scene file takes.
fn emission(value: f64) -> Result<Channels<NonNegative>> {
    NonNegative::new("emission", value).map(grey)
}

fn sensor(
    name: impl Into<String>,
    label: Option<&str>,
    min_order: Option<u32>,
    measure: QuantityFile,
) -> SensorFile {
    SensorFile { name: name.into(), label: label.map(str::to_string), measure, min_order, max_order: None }
}

fn slab(p: SlabParameters) -> Result<SceneFile> {
    let scale = p.scale.get();
    let thickness = p.tau.get() * scale;
    let shape = ShapeFile::Slab { top: 0.0, thickness: Positive::new("tau", thickness)? };
    let side = Positive::new("cell", p.cell.get() * scale)?;
    let light = match p.mu0 {
        Incidence::Beam(mu0) => LightFile::Beam {
            dir: [((1.0 - mu0) * (1.0 + mu0)).sqrt(), 0.0, mu0],
            irradiance: emission(1.0 / mu0)?,
            section: SectionFile::Unbounded,
        },
        Incidence::Diffuse => {
            LightFile::Isotropic { shape: shape.clone(), faces: Faces::Top, radiance: emission(1.0 / PI)? }
        }
    };
    let middle = 0.5 * side.get();
    let mut sensors = vec![
        sensor(
            "slab",
            Some("reflectance"),
            None,
            QuantityFile::Outflow { shape: shape.clone(), face: Face::Top },
        ),
        sensor(
            "slab",
            Some("transmittance"),
            None,
            QuantityFile::Outflow { shape: shape.clone(), face: Face::Bottom },
        ),
        sensor(
            "slab",
            Some("transmittance_diffuse"),
            Some(1),
            QuantityFile::Outflow { shape: shape.clone(), face: Face::Bottom },
        ),
        sensor("slab", Some("absorptance"), None, QuantityFile::Absorbed { region: 0 }),
    ];
    for part in &p.probes {
        let at = [middle, middle, part.get() * thickness];
        sensors.push(sensor(
            format!("depth {}", part.get() * p.tau.get()),
            None,
            None,
            QuantityFile::Fluence { at },
        ));
    }
    let regions = vec![region(shape, 1.0 / scale, p.albedo, p.g)?];
    Ok(SceneFile {
        cell: Some(CellFile([side; 2])),
        regions,
        lights: vec![light],
        sensors,
        ..SceneFile::default()
    })
}

fn sphere(p: SphereParameters) -> Result<SceneFile> {
    let radius = p.radius.get();
    let shape = ShapeFile::Sphere { center: [0.0; 3], radius: p.radius };
    let light = match p.source {
        SphereSource::Volume => LightFile::VolumeSource {
            shape: shape.clone(),
            density: emission(3.0 / (FOUR_PI * radius * radius * radius))?,
        },
        SphereSource::Point => LightFile::Point { position: [0.0; 3], power: emission(1.0)? },
        SphereSource::Incidence => {
            LightFile::Isotropic { shape: shape.clone(), faces: Faces::Both, radiance: emission(1.0 / PI)? }
        }
    };
    let mut sensors = vec![
        sensor(
            "sphere",
            Some("escape"),
            None,
            QuantityFile::Outflow { shape: shape.clone(), face: Face::Top },
        ),
        sensor("sphere", Some("absorptance"), None, QuantityFile::Absorbed { region: 0 }),
    ];
    for part in &p.probes {
        let r = part.get() * radius;
        // The fluence of a point source is infinite at the source.
        if r > 0.0 || !matches!(p.source, SphereSource::Point) {
            sensors.push(sensor(
                format!("radius {r}"),
                None,
                None,
                QuantityFile::Fluence { at: [r, 0.0, 0.0] },
            ));
        }
    }
    let regions = vec![region(shape, 1.0, p.albedo, p.g)?];
    Ok(SceneFile { regions, lights: vec![light], sensors, ..SceneFile::default() })
}

fn shaft(p: ShaftParameters) -> Result<SceneFile> {
    let shape = ShapeFile::Slab { top: 0.0, thickness: p.tau };
    let width = p.width.get();
    let section = SectionFile::Rectangle {
        corner: [0.0, -0.5 * width, 0.0],
        u: [width, 0.0, 0.0],
        v: [0.0, width, 0.0],
    };
    if p.depth.get() > p.tau.get() {
        return Err(Error::out_of_range("depth", p.depth.get(), "at most tau"));
    }
    let light = LightFile::Beam { dir: [0.0, 0.0, 1.0], irradiance: emission(1.0)?, section };
    let sensors = p.probes.iter().map(|&x| {
        sensor(format!("x {x}"), None, None, QuantityFile::Fluence { at: [x, 0.0, p.depth.get()] })
    });
    let sensors = sensors.collect();
    let regions = vec![region(shape, 1.0, p.albedo, p.g)?];
    Ok(SceneFile { regions, lights: vec![light], sensors, ..SceneFile::default() })
}
