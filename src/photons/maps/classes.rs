//! Which photons a map holds, and the pass that fills it.

use super::settings::{Indirect, MapSettings, MediumSamples};
use crate::faults::{Fault, planted};
use crate::photons::beams::BeamLength;
use crate::photons::importance::Importance;
use crate::photons::{Emitter, Flags, Histories, Photon, Run, Storage};
use crate::scene::Scene;
use crate::transport::Walker;

/// Whether the global map holds a photon of this class.
pub fn is_global(flags: Flags, indirect: Indirect) -> bool {
    indirect == Indirect::Gathered
        || flags.has(Flags::DIFFUSE)
        || flags.has(Flags::MEDIUM)
        || (planted(Fault::CausticTwice) && is_caustic(flags))
}

/// Whether the caustic map holds a photon of this class.
pub fn is_caustic(flags: Flags) -> bool {
    flags == Flags::SPECULAR
}

/// Whether the volume map holds a photon of this class.
pub fn is_volume(flags: Flags) -> bool {
    !flags.is_direct() || planted(Fault::DirectInVolumeMap)
}

/// Which photons a pass stores.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Class {
    /// Those of the global and the volume map.
    Main(Indirect),
    /// Those of the caustic map.
    Caustic,
}

impl Class {
    /// The pass that fills maps of this class by so many histories.
    pub(super) fn run<'a>(
        self,
        scene: &'a Scene,
        emitters: &'a Emitters,
        importance: Option<&'a Importance>,
        settings: &MapSettings,
        count: u64,
    ) -> Run<'a> {
        // A caustic photon has not been scattered: its history ends with its first scattering.
        let max_order = (self == Class::Caustic).then_some(0);
        let histories = Histories { count, seed: settings.seed, replicate: settings.replicate, max_order };
        let importance = importance.filter(|_| self != Class::Caustic);
        Run { importance, ..Run::new(scene, emitters.of_class(self), histories) }
    }
}

/// The photons of the maps of a class.
pub(super) struct Classes {
    pub(super) class: Class,
    /// Histories that store surface photons.
    pub(super) global: u64,
    /// Histories that store volume photons.
    pub(super) volume: u64,
    /// What is stored of these.
    pub(super) media: MediumSamples,
}

impl Storage for Classes {
    fn in_medium(&self, history: u64, photon: &Photon) -> bool {
        self.media == MediumSamples::Points && self.is_volume(history, photon.flags)
    }

    fn on_surface(&self, history: u64, photon: &Photon) -> bool {
        let is_stored = match self.class {
            Class::Main(indirect) => is_global(photon.flags, indirect),
            Class::Caustic => is_caustic(photon.flags),
        };
        history < self.global && is_stored
    }

    fn has_beams(&self) -> bool {
        self.media.beams().is_some() && self.class != Class::Caustic && self.volume > 0
    }

    fn has_whole_beams(&self) -> bool {
        self.media.beams() == Some(BeamLength::Whole)
    }

    fn on_flight(&self, history: u64, walker: &Walker) -> bool {
        // A flight that begins at a collision is the second leg of a plane, up to the first body.
        let is_counted = !self.media.has_planes() || walker.origin_surface.is_some();
        is_counted && self.is_volume(history, walker.flags)
    }

    fn has_planes(&self) -> bool {
        self.media.has_planes() && self.class != Class::Caustic && self.volume > 0
    }

    fn on_plane(&self, history: u64, _walker: &Walker) -> bool {
        history < self.volume
    }
}

impl Classes {
    fn is_volume(&self, history: u64, flags: Flags) -> bool {
        self.class != Class::Caustic && history < self.volume && is_volume(flags)
    }
}

/// How photons of each pass leave the lights.
pub(super) struct Emitters {
    pub main: Emitter,
    /// Those that can meet a specular body; none if none can.
    pub caustic: Option<Emitter>,
}

impl Emitters {
    pub fn of(scene: &Scene, importance: Option<&Importance>) -> Self {
        let main = importance.map_or_else(|| Emitter::towards_scene(scene), |i| i.emitter().clone());
        Emitters { main, caustic: Emitter::towards_specular(scene) }
    }

    pub fn of_class(&self, class: Class) -> &Emitter {
        self.caustic.as_ref().filter(|_| class == Class::Caustic).unwrap_or(&self.main)
    }
}
