//! The scene: a plain struct, validated once and trusted after; what a ray meets in it; what it requires.

mod bodies;
mod bounds;
mod builtin;
mod camera;
mod checked;
mod coincident;
mod emitting_media;
mod file;
mod full;
mod hit;
mod interiors;
mod parts;
mod place;
mod plan;
mod read;
mod regions;
mod segment;
mod segments;
mod sensor;
mod source;
mod target;
mod validate;

pub use builtin::{BUILTIN, Builtin};
pub use camera::{Camera, Filter, MAX_PIXELS, MAX_SIDE, View};
pub use checked::{Scene, decay};
pub use file::{
    CameraFile, Channels, DensityFile, DielectricFile, GridFile, InteriorFile, Interpolation, LightFile,
    NormalsFile, ObjectFile, PhaseFile, QuantityFile, RegionFile, RotateFile, SceneFile, SensorFile,
    ShapeFile, SurfaceFile, TextureFile,
};
pub use parts::{Interior, Object, Region, SURROUNDINGS, SceneParts};
pub use plan::Plan;
pub use read::toml_message;
pub use segment::Segment;
pub use segments::Segments;
pub use sensor::{Binned, Crossing, Orders, Quantity, Scoring, Sensor, Space};
pub use source::SceneSource;
pub use target::{SceneHit, Start, Target};

use crate::error::Result;
use checked::Answers;
use glam::DVec2;

/// Media that vary along x or y are the same in every period of a cell of these sides \[L\].
fn repeat_media(parts: &mut SceneParts, cell: DVec2) -> Result<()> {
    for (i, region) in parts.regions.iter_mut().enumerate() {
        region.medium = region.medium.repeated(cell).map_err(|e| e.within(&format!("regions[{i}]")))?;
    }
    for Interior { name, medium, .. } in &mut parts.interiors {
        if let Some(medium) = medium {
            *medium = medium.repeated(cell).map_err(|e| e.within(&format!("interior {name}")))?;
        }
    }
    Ok(())
}

impl Scene {
    /// A scene from its parts.
    ///
    /// # Errors
    /// `Error::Scene` or `Error::OutOfRange`, naming the part, where parts do not fit together.
    pub fn new(mut parts: SceneParts) -> Result<Self> {
        if parts.interiors.is_empty() {
            parts.interiors.push(Interior::surroundings());
        }
        let bounds = bounds::of(&parts);
        parts.lights.iter_mut().try_for_each(|light| light.cover(bounds))?;
        let periodic_cell = validate::check(&parts)?;
        if let Some(cell) = &periodic_cell {
            repeat_media(&mut parts, cell.side)?;
        }
        interiors::match_indices(&mut parts);
        let plan = Plan::of(&parts);
        let (media, filling) = interiors::numbered(&parts.regions, &parts.interiors);
        let bodies = bodies::Bodies::of(&parts);
        let region_tree = regions::RegionTree::new(&parts.regions)?;
        let lights = parts.lights.clone();
        let mut scene = Scene {
            parts,
            media,
            filling,
            lights,
            is_emission_bounded: true,
            light_within: Vec::new(),
            far: Vec::new(),
            marks: Vec::new(),
            bodies,
            region_tree,
            periodic_cell,
            bounds,
            plan,
            answers: Answers::default(),
        };
        scene.marks = place::marks(&scene);
        scene.far = place::far(&scene);
        let (emitting, is_emission_bounded) = emitting_media::of(&scene);
        scene.lights.extend(emitting);
        scene.is_emission_bounded = is_emission_bounded;
        scene.light_within = interiors::of_lights(&scene);
        validate::check_power(&scene)?;
        validate::check_apexes(&scene)?;
        Ok(scene)
    }
}
