//! The interface rule: which medium and which index of refraction a point has.
//!
//! Space outside every dielectric is the *surroundings*, of index 1, where the regions lie: convex, index-matched, the
//! later one counts. A dielectric surface names the interior on its inner side, against its outward normal, and the
//! one on its outer side. An interior has one index everywhere, and at most one medium, which fills it wherever it
//! reaches; regions do not count inside it. Whoever travels carries the number of the interior that it is in.

use super::{Region, Scene};
use crate::medium::Medium;
use glam::DVec3;

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

/// Media by number, regions first, then interiors that are filled; and for each interior the number of its medium.
pub(super) fn numbered(regions: &[Region], interiors: &[Interior]) -> (Vec<Medium>, Vec<Option<usize>>) {
    let mut media: Vec<Medium> = regions.iter().map(|r| r.medium.clone()).collect();
    let mut filling = Vec::with_capacity(interiors.len());
    for interior in interiors {
        filling.push(interior.medium.as_ref().map(|_| media.len()));
        media.extend(interior.medium.clone());
    }
    (media, filling)
}

impl Scene {
    /// Every interior by its number; 0 is the surroundings.
    pub fn interiors(&self) -> &[Interior] {
        &self.parts.interiors
    }

    /// Every medium by its number: those of the regions, then those that fill interiors.
    pub fn media(&self) -> &[Medium] {
        &self.media
    }

    /// The medium of a number.
    ///
    /// # Panics
    /// If no medium has this number.
    pub fn medium(&self, number: usize) -> &Medium {
        &self.media[number]
    }

    /// Number of the medium that fills an interior, if one does; none for the surroundings, of which regions say it.
    pub fn filling(&self, within: usize) -> Option<usize> {
        self.filling[within]
    }

    /// Number of the interior that a point is in.
    pub fn interior_at(&self, _p: DVec3) -> usize {
        SURROUNDINGS
    }

    /// Number of the medium that counts at a point; none in vacuum.
    pub fn medium_number_at(&self, p: DVec3) -> Option<usize> {
        match self.interior_at(p) {
            SURROUNDINGS => self.regions().iter().rposition(|r| r.shape.contains(p)),
            within => self.filling(within),
        }
    }

    /// The medium at a point; none in vacuum.
    pub fn medium_at(&self, p: DVec3) -> Option<&Medium> {
        self.medium_number_at(p).map(|number| self.medium(number))
    }
}
