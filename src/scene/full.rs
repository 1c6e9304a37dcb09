//! A scene with nothing left out: what its plan saves can be measured, and what it leaves out tested against the rest.

use super::{Region, Scene, SceneParts};
use crate::Spectrum;
use crate::error::Result;
use crate::geometry::Shape;
use crate::medium::{Density, Grid, Heterogeneous, Homogeneous, Medium};
use crate::phase::{Isotropic, Phase};
use glam::DVec3;

/// Extinction of what fills the gaps between media, if there were any of it [1/L]: its density is 0.
const VACUUM: f64 = 1.0;

impl Scene {
    /// The same scene with everything forced on, needed or not; the expected radiance is the same everywhere.
    ///
    /// Homogeneous media become grids of one cell, so that flights and transmittances are tracked by majorants, channel
    /// by channel; a scene without media is filled with one of density 0, and marched through; shadow rays go from body
    /// to body as though there were filters; lights are cut into cells as though there were specular bodies; all three
    /// maps are filled and read, empty or not; emission is looked for along every ray.
    ///
    /// # Errors
    /// those of [`Scene::new`]
    pub fn with_full_plan(&self) -> Result<Scene> {
        let mut parts = self.parts.clone();
        for region in &mut parts.regions {
            region.medium = varying(&region.medium)?;
        }
        for interior in &mut parts.interiors {
            interior.medium = interior.medium.as_ref().map(varying).transpose()?;
        }
        fill_vacuum(&mut parts, self)?;
        let scene = Scene::new(parts)?;
        Ok(Scene { plan: scene.plan.full(), ..scene })
    }
}

/// A medium whose density could vary.
fn varying(medium: &Medium) -> Result<Medium> {
    match medium {
        Medium::Homogeneous(matter) => Ok(Heterogeneous::new(matter.clone(), uniform(1.0)?).into()),
        Medium::Heterogeneous(_) => Ok(medium.clone()),
    }
}

/// The same density everywhere, in one cell.
fn uniform(density: f32) -> Result<Density> {
    Density::grid(Grid::new((DVec3::ZERO, DVec3::ONE), [1; 3], 1, vec![density])?)
}

/// A medium of density 0 about everything, where a scene has no regions and is bounded.
fn fill_vacuum(parts: &mut SceneParts, scene: &Scene) -> Result<()> {
    let Some(ball) = scene.bounds().filter(|_| parts.regions.is_empty()) else {
        return Ok(());
    };
    let matter = Homogeneous::new(Spectrum::grey(VACUUM), Spectrum::ONE, Phase::Isotropic(Isotropic))?;
    let medium = Heterogeneous::new(matter, uniform(0.0)?).into();
    parts.regions.push(Region { shape: Shape::Sphere(*ball), medium });
    Ok(())
}
