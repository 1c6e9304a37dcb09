//! Where light comes from, and where it is bright, learned from photons: path guiding.
//!
//! A path finds a small lamp by connections, and what the lamp throws on a wall by luck: where a mirror, a lens or a gap leaves one
//! bright patch, one direction in thousands brings all the light. Photons know. Those that paths do not connect to, all but direct
//! ones, and these too where a light fills space, are sorted into cells of a tree, some hundreds each, apart for media and for
//! surfaces by the axis that their normal is next to; every cell learns a histogram of the directions that its photons came from
//! ([`Lobe`]), and how much of it to mix with the surface's or phase function's own directions, so that the second moment of what
//! a path brings is least (`choice`): none at all, where it gains too little. A mixture of known density keeps every mean, whatever
//! was learned. Distances are led by how bright all photons say that it is in media and on surfaces ([`Brightness`]), by a share of
//! flights that is the same everywhere (`distances`).
//!
//! # Source
//! Jensen 1995, "Importance driven path tracing using the photon map"; Vorba et al. 2014; Mueller et al. 2017; in media Herholz et
//! al. 2019. That resolution and share are chosen by photons that the histogram does not hold is turbid's own.

mod arrival;
mod cells;
mod choice;
mod distances;

use super::{Emitter, Everything, Histories, Photon, Run};
use crate::error::{Error, Result};
use crate::light::Light;
use crate::math::wrap;
use crate::rng::Purpose;
use crate::scene::Scene;
use crate::transport::{Brightness, Lobe, NoProgress, Progress};
use arrival::{Arrival, PARTS};
use cells::Cells;
use distances::Lit;
use glam::{DVec2, DVec3};

/// Most histories to learn from: more would say nothing new.
pub const MOST_HISTORIES: u64 = 10_000_000;

/// Most photons to learn from: they take about a gigabyte, 130 bytes each.
const MOST_PHOTONS: f64 = 8e6;

/// Histories that say how many photons others will store.
const PILOT: u64 = 1000;

/// Which photons are learned from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GuideSettings {
    /// Histories, 1 to [`MOST_HISTORIES`].
    pub histories: u64,
    /// Seed of the whole computation.
    pub seed: u64,
    /// Which independent repetition.
    pub replicate: u64,
    /// The share of what was learned, in every cell and of all flights, in (0, 1), in place of the one that is best by what the photons
    /// say: for the laboratory.
    pub share: Option<f64>,
}

/// Where light comes from, about every place of a scene, and where it is bright.
#[derive(Debug)]
pub struct Guide {
    media: Cells,
    /// By the axis that normals are next to, and their sign.
    surfaces: [Cells; 6],
    brightness: Option<Brightness>,
    is_used: bool,
    period: Option<DVec2>,
}

impl Guide {
    /// Learns from photons; the same bits on any number of threads.
    ///
    /// # Errors
    /// `Error::OutOfRange` for a number of histories or a share that is not allowed; `Error::Scene` where they would store more than
    /// 8,000,000 photons; those of [`Run::pass`]
    pub fn learn(scene: &Scene, settings: &GuideSettings, progress: &dyn Progress) -> Result<Self> {
        let GuideSettings { histories, seed, replicate, share } = *settings;
        if let Some(share) = share.filter(|share| !(*share > 0.0 && *share < 1.0)) {
            return Err(Error::out_of_range("the share of learned directions", share, "above 0 and below 1"));
        }
        if !(1..=MOST_HISTORIES).contains(&histories) {
            return Err(Error::out_of_range(
                "histories that paths are guided by",
                histories as f64,
                "from 1 to 10,000,000",
            ));
        }
        // Where some light fills space paths find it by themselves, in part or wholly; direct light else by connections.
        let has_space_filling = scene.lights().iter().any(Light::fills_space);
        let is_asked = |photon: &Photon| has_space_filling || !photon.flags.is_direct();
        let emitter = Emitter::towards_scene(scene);
        let (mut media, mut surfaces) = (Vec::new(), [(); 6].map(|()| Vec::new()));
        let mut lit = (Vec::new(), Vec::new());
        if histories > PILOT {
            let pilot = Histories { count: PILOT, seed, replicate, max_order: None };
            let pilot = Run { purpose: Purpose::Pilot, is_pilot: true, ..Run::new(scene, &emitter, pilot) };
            let each = pilot.pass(&Everything, &NoProgress)?.met.iter().sum::<u64>() as f64 / PILOT as f64;
            if each * histories as f64 > MOST_PHOTONS {
                return Err(Error::Scene(format!(
                    "{histories} histories that paths are guided by would store about {:.1e} photons; allowed: at most {:.0} \
                     histories in this scene",
                    each * histories as f64,
                    MOST_PHOTONS / each
                )));
            }
        }
        let medium_at = |p: DVec3| scene.medium_at(p);
        for part in 0..PARTS {
            let count = histories * (part + 1) / PARTS - histories * part / PARTS;
            // Different for each part of each repetition, however large the numbers of these are.
            let replicate = replicate.wrapping_mul(PARTS).wrapping_add(part);
            let histories = Histories { count, seed, replicate, max_order: None };
            let run = Run { purpose: Purpose::Guide, ..Run::new(scene, &emitter, histories) };
            let pass = run.pass(&Everything, progress)?;
            let part = part as usize;
            for photon in pass.photons() {
                lit.0.extend(Lit::in_medium(scene, &photon, part as u8));
                media.extend(is_asked(&photon).then(|| Arrival::new(&photon, part)));
            }
            for photon in pass.surfaces.iter().flat_map(|part| part.iter()) {
                lit.1.push(Lit::on_surface(&photon, part as u8));
                let face = &mut surfaces[face(photon.normal.as_dvec3())];
                face.extend(is_asked(&photon).then(|| Arrival::new(&photon, part)));
            }
        }
        let period = scene.periodic_cell().map(|cell| cell.side);
        let media = Cells::new(media, share, &medium_at);
        let surfaces = surfaces.map(|arrivals| Cells::new(arrivals, share, &medium_at));
        let brightness = distances::learned(scene, (&lit.0, &lit.1), period, share, (seed, replicate));
        let mut guide = Guide { media, surfaces, brightness, is_used: false, period };
        guide.is_used = guide.brightness.is_some() || guide.counts().iter().any(|[_, used]| *used > 0);
        Ok(guide)
    }

    /// What was learned about a place in a medium, if it is to be used.
    #[inline]
    pub fn in_medium(&self, position: DVec3) -> Option<&Lobe> {
        self.media.at(self.place(position))
    }

    /// What was learned about a place on a surface with this geometric normal, on the side that light arrives on.
    #[inline]
    pub fn on_surface(&self, position: DVec3, normal: DVec3) -> Option<&Lobe> {
        // As precisely as photons know it, so that both find the same face of what is halfway.
        self.surfaces[face(normal.as_vec3().as_dvec3())].at(self.place(position))
    }

    /// How bright places are, if flights are led by it.
    #[inline]
    pub fn brightness(&self) -> Option<&Brightness> {
        self.brightness.as_ref()
    }

    /// Cells in media and on surfaces, and those of them whose histograms are used.
    pub fn counts(&self) -> [[usize; 2]; 2] {
        let add = |[cells, used]: [usize; 2], more: [usize; 2]| [cells + more[0], used + more[1]];
        [self.media.counts(), self.surfaces.iter().map(Cells::counts).fold([0, 0], add)]
    }

    /// Whether anything that was learned is used.
    pub fn is_used(&self) -> bool {
        self.is_used
    }

    fn place(&self, position: DVec3) -> DVec3 {
        self.period.map_or(position, |side| wrap(position, side))
    }
}

/// The number of the axis that a normal is next to, with its sign.
fn face(normal: DVec3) -> usize {
    let size = normal.abs();
    let axis = if size.x >= size.y && size.x >= size.z { 0 } else { 1 + usize::from(size.z > size.y) };
    2 * axis + usize::from(normal[axis] < 0.0)
}
