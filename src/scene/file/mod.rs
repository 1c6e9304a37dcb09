//! The scene file: TOML, strict. Every error names the line, the column and the key, and says what is allowed.

mod blocks;
mod interior;
mod medium;
mod shape;
mod texture;
mod values;

pub use interior::{DielectricFile, InteriorFile};
pub use medium::{DensityFile, GridFile, Interpolation, PhaseFile};
pub use shape::{NormalsFile, RotateFile, ShapeFile};
pub use texture::TextureFile;
pub use values::{CellFile, Channels};

use values::rectangle;

use super::{
    Binned, Camera, Crossing, Filter, Interior, Object, Orders, Quantity, Region, Scene, SceneParts, Scoring,
    Sensor, Space, View,
};
use crate::error::{Error, Result};
use crate::geometry::{Cuboid, Face, FaceBins, Voxels};
use crate::light::{Area, Beam, Faces, Isotropic, Light, Point, Section, Spot, Sun, VolumeSource};
use crate::math::{Albedo, Asymmetry, NonNegative, Positive, Ray};
use crate::surface::{self, Black, Lambertian, Mirror, Surface};
use glam::{DVec2, DVec3};
use serde::{Deserialize, Serialize};
use std::path::Path;

/// The version of the format of scene files: 1, also of a file that does not say.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(try_from = "u32", into = "u32")]
pub struct SceneFormat(u32);

impl Default for SceneFormat {
    fn default() -> Self {
        SceneFormat(1)
    }
}

impl TryFrom<u32> for SceneFormat {
    type Error = Error;
    fn try_from(version: u32) -> Result<Self> {
        let known = SceneFormat::default();
        if known.0 != version {
            return Err(Error::out_of_range("the value", f64::from(version), "1"));
        }
        Ok(known)
    }
}

impl From<SceneFormat> for u32 {
    fn from(format: SceneFormat) -> u32 {
        format.0
    }
}

/// A whole scene file.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SceneFile {
    /// Version of the format.
    #[serde(default)]
    pub format: SceneFormat,
    /// Side of the cell that stands for an unbounded slab, or its sides along x and y \[L\].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cell: Option<CellFile>,
    /// Media.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub regions: Vec<RegionFile>,
    /// What fills the space between dielectric surfaces, beside the surroundings.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub interiors: Vec<InteriorFile>,
    /// Surfaces.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub objects: Vec<ObjectFile>,
    /// Lights.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub lights: Vec<LightFile>,
    /// What is measured.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub sensors: Vec<SensorFile>,
    /// Who looks.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub camera: Option<CameraFile>,
}

/// A camera.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CameraFile {
    /// Where it is \[L\].
    pub position: [f64; 3],
    /// A point in the middle of the picture \[L\].
    pub look_at: [f64; 3],
    /// What is up in the picture; +y if absent.
    #[serde(default = "up", skip_serializing_if = "is_up")]
    pub up: [f64; 3],
    /// Full horizontal angle \[degrees\].
    pub fov: f64,
    /// Pixels across.
    pub width: u32,
    /// Pixels down.
    pub height: u32,
    /// How the samples of a pixel are spread; uniformly over it if absent.
    #[serde(default, skip_serializing_if = "is_box")]
    pub filter: Filter,
}

fn up() -> [f64; 3] {
    [0.0, 1.0, 0.0]
}

fn is_up(given: &[f64; 3]) -> bool {
    *given == up()
}

fn is_box(filter: &Filter) -> bool {
    *filter == Filter::Box
}

impl CameraFile {
    fn camera(&self) -> Result<Camera> {
        let CameraFile { fov, width, height, filter, .. } = *self;
        let (position, look_at, up) = (self.position.into(), self.look_at.into(), self.up.into());
        Camera::new(View { position, look_at, up, fov, width, height, filter })
    }
}

/// A medium in a shape.
///
/// The keys of a medium stand here and in [`InteriorFile`]: `flatten` would let them stand once, but serde does not refuse
/// unknown keys where it flattens, and a misspelt key must not pass.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RegionFile {
    /// Where.
    pub shape: ShapeFile,
    /// Extinction [1/L].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sigma_t: Option<Channels<NonNegative>>,
    /// Single-scattering albedo.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub albedo: Option<Channels<Albedo>>,
    /// Absorption, with `sigma_s` in place of the two [1/L].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sigma_a: Option<Channels<NonNegative>>,
    /// Scattering [1/L].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sigma_s: Option<Channels<NonNegative>>,
    /// Albedo from place to place, times `albedo`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub albedo_grid: Option<GridFile>,
    /// Asymmetry of the Henyey-Greenstein phase function; 0 is isotropic.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub g: Option<Asymmetry>,
    /// Another phase function, in place of `g`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub phase: Option<PhaseFile>,
    /// Emission, the same everywhere [W/(L^3 sr)]; none if absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub emission: Option<Channels<NonNegative>>,
    /// Emission that follows the density, where it is 1 [W/(L^3 sr)]; none if absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub emission_by_density: Option<Channels<NonNegative>>,
    /// How much of it is where: the extinction is this times `sigma_t`; 1 everywhere if absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub density: Option<DensityFile>,
}

/// A surface on a shape.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ObjectFile {
    /// Where.
    pub shape: ShapeFile,
    /// How it reflects.
    pub surface: SurfaceFile,
}

/// A surface.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
#[allow(
    missing_docs,
    reason = "the names are those of the surfaces' own constructors, which say their meaning"
)]
pub enum SurfaceFile {
    Lambertian { reflectance: TextureFile },
    Mirror { reflectance: Channels<Albedo> },
    Dielectric(DielectricFile),
    Filter { transmittance: TextureFile },
    Black,
}

/// The section of a beam.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
#[allow(missing_docs, reason = "the names are those of `light::Section`, which says their meaning")]
pub enum SectionFile {
    Unbounded,
    Disc { center: [f64; 3], radius: Positive },
    Rectangle { corner: [f64; 3], u: [f64; 3], v: [f64; 3] },
}

/// What the sun's light comes through.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
#[allow(missing_docs, reason = "the names are those of `geometry::Rectangle`")]
pub enum PortalFile {
    Rectangle { corner: [f64; 3], u: [f64; 3], v: [f64; 3] },
}

/// A light.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
#[allow(
    missing_docs,
    reason = "the names are those of the lights' own constructors, which say their meaning"
)]
pub enum LightFile {
    Beam {
        dir: [f64; 3],
        irradiance: Channels<NonNegative>,
        section: SectionFile,
    },
    Area {
        shape: ShapeFile,
        radiance: Channels<NonNegative>,
    },
    Point {
        position: [f64; 3],
        power: Channels<NonNegative>,
    },
    Spot {
        position: [f64; 3],
        dir: [f64; 3],
        full_angle: f64,
        edge_angle: f64,
        power: Channels<NonNegative>,
    },
    Sun {
        dir: [f64; 3],
        irradiance: Channels<NonNegative>,
        angular_radius: f64,
        #[serde(default, skip_serializing_if = "Option::is_none")]
        portal: Option<PortalFile>,
    },
    Isotropic {
        shape: ShapeFile,
        faces: Faces,
        radiance: Channels<NonNegative>,
    },
    VolumeSource {
        shape: ShapeFile,
        density: Channels<NonNegative>,
    },
}

/// A sensor.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SensorFile {
    /// Where or of what.
    pub name: String,
    /// Name of the quantity in tables; that of the sensor's kind if absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub label: Option<String>,
    /// What is measured.
    pub measure: QuantityFile,
    /// Smallest order that counts.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub min_order: Option<u32>,
    /// Largest order that counts.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub max_order: Option<u32>,
}

/// What a sensor measures.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
#[allow(missing_docs, reason = "the names are those of `scene::Quantity`, which says their meaning")]
pub enum QuantityFile {
    Fluence {
        at: [f64; 3],
    },
    Radiance {
        origin: [f64; 3],
        dir: [f64; 3],
    },
    Outflow {
        shape: ShapeFile,
        face: Face,
    },
    Absorbed {
        region: usize,
    },
    Flux {
        corner: [f64; 3],
        u: [f64; 3],
        v: [f64; 3],
        bins: [usize; 2],
        #[serde(default, skip_serializing_if = "is_along")]
        crossing: Crossing,
    },
    MeanRadiance {
        corner: [f64; 3],
        u: [f64; 3],
        v: [f64; 3],
        bins: [usize; 2],
        dir: [f64; 3],
    },
    MeanFluence(SpaceFile),
    MeanAbsorption(SpaceFile),
}

fn is_along(crossing: &Crossing) -> bool {
    *crossing == Crossing::Along
}

/// Where a field is averaged: over voxels, or over the shape of a region.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SpaceFile {
    /// Lower corner \[L\].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub min: Option<[f64; 3]>,
    /// Upper corner \[L\].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub max: Option<[f64; 3]>,
    /// Voxels along x, y and z.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cells: Option<[usize; 3]>,
    /// A region, in place of the three.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub region: Option<usize>,
    /// How photons estimate it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub scoring: Option<Scoring>,
}

impl SpaceFile {
    fn space(&self, regions: &[Region]) -> Result<Space> {
        match (self.min, self.max, self.cells, self.region) {
            (Some(min), Some(max), Some(cells), None) => {
                Ok(Space::Voxels(Voxels::new(Cuboid::new(min.into(), max.into())?, cells)?))
            }
            (None, None, None, Some(number)) => match regions.get(number) {
                Some(region) => Ok(Space::Shape(region.shape.clone())),
                None if regions.is_empty() => {
                    Err(Error::Scene(format!("`region` is {number}; the scene has none")))
                }
                None => {
                    Err(Error::Scene(format!("`region` is {number}; allowed: 0 to {}", regions.len() - 1)))
                }
            },
            _ => Err(Error::Scene("allowed: `min`, `max` and `cells` of voxels, or a `region`".into())),
        }
    }
}

impl RegionFile {
    fn region(&self, folder: &Path) -> Result<Region> {
        let keys = medium::Keys {
            sigma_t: self.sigma_t,
            albedo: self.albedo,
            sigma_a: self.sigma_a,
            sigma_s: self.sigma_s,
            albedo_grid: self.albedo_grid.as_ref(),
            g: self.g,
            phase: self.phase.as_ref(),
            emission: self.emission,
            emission_by_density: self.emission_by_density,
            density: self.density.as_ref(),
        };
        let Some(medium) = keys.medium(folder)? else {
            return Err(Error::Scene(
                "a region without medium; allowed: sigma_t, albedo and g (or phase)".into(),
            ));
        };
        Ok(Region { shape: self.shape.shape(folder)?, medium })
    }
}

impl SurfaceFile {
    fn surface(&self, folder: &Path, interiors: &[Interior]) -> Result<Surface> {
        Ok(match self {
            SurfaceFile::Lambertian { reflectance } => {
                Surface::Lambertian(Lambertian::textured(reflectance.texture("reflectance", folder)?))
            }
            SurfaceFile::Mirror { reflectance } => Surface::Mirror(Mirror::new(reflectance.spectrum())?),
            SurfaceFile::Dielectric(names) => Surface::Dielectric(names.dielectric(interiors)?),
            SurfaceFile::Filter { transmittance } => {
                Surface::Filter(surface::Filter::textured(transmittance.texture("transmittance", folder)?))
            }
            SurfaceFile::Black => Surface::Black(Black),
        })
    }
}

impl LightFile {
    fn light(&self, folder: &Path) -> Result<Light> {
        Ok(match *self {
            LightFile::Beam { dir, irradiance, section } => {
                let section = match section {
                    SectionFile::Unbounded => Section::Unbounded,
                    SectionFile::Disc { center, radius } => {
                        Section::Disc { center: center.into(), radius: radius.get() }
                    }
                    SectionFile::Rectangle { corner, u, v } => Section::Rectangle(rectangle(corner, u, v)?),
                };
                Light::Beam(Beam::new(dir.into(), irradiance.spectrum(), section)?)
            }
            LightFile::Area { ref shape, radiance } => {
                Light::Area(Area::new(shape.shape(folder)?, radiance.spectrum())?)
            }
            LightFile::Spot { position, dir, full_angle, edge_angle, power } => Light::Spot(Spot::new(
                position.into(),
                dir.into(),
                (full_angle, edge_angle),
                power.spectrum(),
            )?),
            LightFile::Sun { dir, irradiance, angular_radius, portal } => {
                let sun = Sun::new(dir.into(), irradiance.spectrum(), angular_radius)?;
                Light::Sun(match portal {
                    Some(PortalFile::Rectangle { corner, u, v }) => {
                        sun.through(rectangle(corner, u, v).map_err(|e| e.within("portal"))?)?
                    }
                    None => sun,
                })
            }
            LightFile::Point { position, power } => {
                Light::Point(Point::new(position.into(), power.spectrum())?)
            }
            LightFile::Isotropic { ref shape, faces, radiance } => {
                Light::Isotropic(Isotropic::new(shape.shape(folder)?, faces, radiance.spectrum())?)
            }
            LightFile::VolumeSource { ref shape, density } => {
                Light::VolumeSource(VolumeSource::new(shape.shape(folder)?, density.spectrum())?)
            }
        })
    }
}

impl SensorFile {
    fn sensor(&self, folder: &Path, regions: &[Region]) -> Result<Sensor> {
        let within = |e: Error| e.within(&format!("sensor {}", self.name));
        let face = |corner, u, v, bins| FaceBins::new(rectangle(corner, u, v)?, bins);
        let (kind, quantity) = match self.measure {
            QuantityFile::Fluence { at } => ("fluence", Quantity::Fluence(at.into())),
            QuantityFile::Radiance { origin, dir } => {
                let Some(dir) = DVec3::from(dir).try_normalize() else {
                    return Err(Error::Scene(format!(
                        "sensor {} needs a finite direction other than 0 0 0",
                        self.name
                    )));
                };
                ("radiance", Quantity::Radiance(Ray::new(origin.into(), dir)))
            }
            QuantityFile::Outflow { ref shape, face } => {
                let shape = shape.shape(folder).map_err(|e| e.within(&format!("sensor {}", self.name)))?;
                ("outflow", Quantity::Outflow { shape, face })
            }
            QuantityFile::Absorbed { region } => ("absorptance", Quantity::Absorbed(region)),
            QuantityFile::Flux { corner, u, v, bins, crossing } => {
                let bins = face(corner, u, v, bins).map_err(within)?;
                ("flux", Quantity::Binned(Binned::Flux { bins, crossing }))
            }
            QuantityFile::MeanRadiance { corner, u, v, bins, dir } => {
                let bins = face(corner, u, v, bins).map_err(within)?;
                let Some(dir) = DVec3::from(dir).try_normalize() else {
                    return Err(within(Error::Scene("needs a finite direction other than 0 0 0".into())));
                };
                ("radiance", Quantity::Binned(Binned::Radiance { bins, dir }))
            }
            QuantityFile::MeanFluence(place) => {
                let scoring = place.scoring.unwrap_or(Scoring::TrackLength);
                if scoring == Scoring::Analog {
                    let text = "`scoring` is analog, which no fluence is; allowed: track-length, collision";
                    return Err(within(Error::Scene(text.into())));
                }
                let space = place.space(regions).map_err(within)?;
                ("fluence", Quantity::Binned(Binned::Fluence { space, scoring }))
            }
            QuantityFile::MeanAbsorption(place) => {
                let scoring = place.scoring.unwrap_or(Scoring::Collision);
                let space = place.space(regions).map_err(within)?;
                ("absorption", Quantity::Binned(Binned::Absorption { space, scoring }))
            }
        };
        let label = self.label.clone().unwrap_or_else(|| kind.to_string());
        if let (Some(min), Some(max)) = (self.min_order, self.max_order)
            && max < min
        {
            return Err(Error::Scene(format!(
                "sensor {}: max_order is {max}; allowed: min_order, {min}, or more",
                self.name
            )));
        }
        let orders = Orders { min: self.min_order.unwrap_or(0), max: self.max_order };
        Ok(Sensor { name: self.name.clone(), label, quantity, orders })
    }
}

impl SceneFile {
    /// A scene file from its text. Reading and writing stand here, since serde compiles both anew for every crate that asks.
    ///
    /// # Errors
    /// what is no TOML, or a key or value that is not allowed, with its place
    pub fn from_toml(text: &str) -> std::result::Result<Self, toml::de::Error> {
        toml::from_str(text)
    }

    /// The file as text, which reads back as the same.
    ///
    /// # Errors
    /// those of serde; none is known
    pub fn to_toml(&self) -> std::result::Result<String, toml::ser::Error> {
        toml::to_string(self)
    }

    /// The validated scene; names of other files are relative to `folder`.
    pub fn scene(&self, folder: &Path) -> Result<Scene> {
        let regions = self
            .regions
            .iter()
            .enumerate()
            .map(|(i, r)| r.region(folder).map_err(|e| e.within(&format!("regions[{i}]"))));
        let mut interiors = vec![Interior::surroundings()];
        for interior in &self.interiors {
            interiors.push(
                interior.interior(folder).map_err(|e| e.within(&format!("interior {}", interior.name)))?,
            );
        }
        let object = |o: &ObjectFile| {
            Ok(Object { shape: o.shape.shape(folder)?, surface: o.surface.surface(folder, &interiors)? })
        };
        let objects = self
            .objects
            .iter()
            .enumerate()
            .map(|(i, o)| object(o).map_err(|e: Error| e.within(&format!("objects[{i}]"))));
        let regions: Vec<Region> = regions.collect::<Result<_>>()?;
        Scene::new(SceneParts {
            sensors: self.sensors.iter().map(|s| s.sensor(folder, &regions)).collect::<Result<_>>()?,
            regions,
            interiors: interiors.clone(),
            objects: objects.collect::<Result<_>>()?,
            lights: self
                .lights
                .iter()
                .enumerate()
                .map(|(i, l)| l.light(folder).map_err(|e| e.within(&format!("lights[{i}]"))))
                .collect::<Result<_>>()?,
            cell: self.cell.map(|CellFile([x, y])| DVec2::new(x.get(), y.get())),
            camera: self.camera.as_ref().map(CameraFile::camera).transpose()?,
        })
    }
}
