//! What a scene is made of.

use super::camera::Camera;
use super::sensor::Sensor;
use crate::geometry::Shape;
use crate::light::Light;
use crate::medium::Medium;
use crate::surface::Surface;
use glam::DVec2;

/// A medium and the shape it fills; its boundary is index-matched and no event.
#[derive(Debug, Clone, PartialEq)]
pub struct Region {
    /// Where it is.
    pub shape: Shape,
    /// What it is.
    pub medium: Medium,
}

/// A surface on a shape.
#[derive(Debug, Clone, PartialEq)]
pub struct Object {
    /// Where it is.
    pub shape: Shape,
    /// How it reflects.
    pub surface: Surface,
}

/// What a scene is made of, before it is checked.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct SceneParts {
    /// Media; where shapes overlap, the later one counts.
    pub regions: Vec<Region>,
    /// What fills the space between dielectric surfaces; the first one is the surroundings. Empty stands for these alone.
    pub interiors: Vec<Interior>,
    /// Surfaces.
    pub objects: Vec<Object>,
    /// Lights.
    pub lights: Vec<Light>,
    /// Sides along x and y of the cell that stands for an unbounded slab, the periods of all that is in it \[L\].
    pub cell: Option<DVec2>,
    /// What is measured.
    pub sensors: Vec<Sensor>,
    /// Who looks, if anybody does.
    pub camera: Option<Camera>,
}

/// The number of the surroundings.
pub const SURROUNDINGS: usize = 0;

/// What fills the space between dielectric surfaces.
#[derive(Debug, Clone, PartialEq)]
pub struct Interior {
    /// What dielectric surfaces call it.
    pub name: String,
    /// Index of refraction \[1\], at least 1.
    pub index: f64,
    /// What it is filled with; nothing that collides if none. Of the surroundings, regions say it.
    pub medium: Option<Medium>,
}

impl Interior {
    /// The space outside every dielectric.
    pub fn surroundings() -> Self {
        Interior { name: "surroundings".into(), index: 1.0, medium: None }
    }
}
