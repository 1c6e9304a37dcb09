//! How the maps are read.

use crate::error::Result;
use crate::estimators::boundary::Treatment;
use crate::estimators::{Codimension, Estimator, Gather, Kernel};
use crate::integrators::{Adaptive, March, StepRule};
use crate::math::Positive;
use crate::photons::maps::{Indirect, MediumSamples};
use crate::scene::Scene;

/// Photons of an estimate where nothing is asked for: the fewest, and the most.
pub const LEAST_K: usize = 100;
const MOST_K: f64 = 1000.0;

/// Photons of a map from which on more than [`LEAST_K`] an estimate are better, and of what dimension their neighbourhoods are:
/// the global map where the eye looks, the caustic and the volume map. Chosen by pictures against paths, at k from 10 to 800: in
/// the smooth fogbox errors are least with two to four times as many as this gives, in a room with a spot light, a checker and
/// blocks, where blur counts more, with one to two times as many.
const BALANCED: [(f64, f64); 3] = [(70_000.0, 2.0), (50_000.0, 2.0), (20_000.0, 3.0)];

/// Photons of an estimate that balance noise and blur in a map of so many.
///
/// With n photons in d dimensions, r^d ~ k/n: noise 1/k and the square of a blur ~ r^2 fall at one pace, so that their sum is
/// least, where k ~ n^(4/(4 + d)).
fn balanced(stored: f64, (from, d): (f64, f64)) -> usize {
    let k = LEAST_K as f64 * libm::pow(stored / from, 4.0 / (4.0 + d));
    k.round().clamp(LEAST_K as f64, MOST_K) as usize
}

/// Radii of a gather within which steps of a march share one, where nothing is asked for. In the box of fog a gather at every step
/// reads each photon several times: pictures of eight samples take 0.56 of the time and have 1.05 of the error, those of one sample
/// 0.58 and 1.27 (`render experiments/scenes/fogbox-iso.toml --global emit:1 --caustic emit:1 --volume 65000 --gather-rays 0 --volume-k 100
/// --step 0.1 --maps 6`, the layer `multiple`, with `--spacing 0` and 2).
const SPACING: f64 = 2.0;

/// Steps across a scene, at most, that are taken without being asked for.
const MOST_DEFAULT_STEPS: f64 = 1e3;

/// How large a scene is \[L\]: the edge of the cube in the ball about its bodies and media, but for slabs, which have no
/// end; 1 for a scene of slabs.
pub fn scene_size(scene: &Scene) -> f64 {
    scene.bounds_of_bounded().map_or(1.0, |ball| 2.0 * ball.radius() / 3.0f64.sqrt())
}

/// How maps are read and combined.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// Photons of the global map that an estimate uses.
    pub global: (Kernel, Gather),
    /// Photons of the caustic map that an estimate uses.
    pub caustic: (Kernel, Gather),
    /// How the volume map is read. Unless its treatment is none photons of other media do not count, nor do those that a body
    /// hides from the point; its rejection, a rule of the laboratory about photons behind walls, takes the place of the latter,
    /// and `Visible` is the latter itself where there is a treatment.
    pub volume: Estimator,
    /// How far photons of a surface may lie off its tangent plane: sine of the angle seen from the point. On a sphere of
    /// radius R they reach as far as 2 R slope.
    pub slope: f64,
    /// Whether estimates on surfaces are divided by the part of the kernel's disc that accepted surface fills, as balls are by
    /// [`Treatment::Clipped`]: less than 1 at edges, on curved bodies, and where another body covers the surface or stands on
    /// it. Then flat surfaces, rectangles and the faces of cuboids and slabs, accept within a tenth of the slope. If not,
    /// curved bodies smaller than a disc come out nearly black.
    pub clips_discs: bool,
    /// Rays of a final gathering, at least 1; not used if the global map is to be seen.
    pub gather_rays: u32,
    /// Rays of a final gathering that are shorter than this \[L\] are traced on: in corners the map's blur would be seen.
    /// 0 for never.
    pub near: f64,
    /// The march through media.
    pub march: March,
    /// Steps with random places share one gather of the volume map as long as they are within this many radii of the gather before from
    /// the first of them, at least 0; 0 for one gather a step.
    pub spacing: f64,
}

impl Settings {
    /// The settings of 1998, for a scene of the given size: the k nearest photons within a tenth of it, a cone on
    /// surfaces' caustics, 64 rays a final gathering, steps of a twentieth that halve where radiance changes by half.
    ///
    /// # Errors
    /// [`Error::OutOfRange`](crate::Error::OutOfRange) if k is below 2 or the size not finite and above zero.
    pub fn for_size(size: f64, k: usize) -> Result<Self> {
        let nearest = Gather::nearest(k, 0.1 * size)?;
        Ok(Settings {
            global: (Kernel::Uniform, nearest),
            caustic: (Kernel::Cone, nearest),
            volume: Estimator::new(Kernel::Uniform, nearest).treated(Treatment::Clipped),
            slope: 0.1,
            clips_discs: true,
            gather_rays: 64,
            near: 0.0,
            march: March {
                step: Positive::new("the step", 0.05 * size)?,
                rule: StepRule::Integrated,
                is_jittered: true,
                adaptive: Some(Adaptive {
                    tolerance: 0.5,
                    shortest: Positive::new("the shortest step", 0.0125 * size)?,
                }),
            },
            spacing: 0.0,
        })
    }

    /// What a picture of a scene takes where nothing is asked for: those of its [`scene_size`], steps of equal length, which share gathers.
    ///
    /// The longest step is a twentieth of the scene, as far as that is not longer than the shortest mean free path of media
    /// whose density varies. There a step's light is asked for at one place of the step, and what reaches its near end is a
    /// random product: over several mean free paths few places count much. In a homogeneous medium places are chosen by what
    /// reaches the near end, and a step may be long.
    ///
    /// # Errors
    /// those of [`Settings::for_size`]
    pub fn for_scene(scene: &Scene, k: usize) -> Result<Self> {
        let size = scene_size(scene);
        let varying = scene.media().iter().filter(|medium| !medium.is_homogeneous());
        let densest = varying.map(|medium| medium.highest_sigma_t().max()).fold(0.0, f64::max);
        let step = (0.05 * size).min((1.0 / densest).max(size / MOST_DEFAULT_STEPS));
        let mut settings = Settings::for_size(size, k)?;
        settings.march.step = Positive::new("the step", step)?;
        settings.march.adaptive = None;
        settings.spacing = SPACING;
        Ok(settings)
    }

    /// The same settings with k that balance noise and blur in maps of so many photons (global, caustic, volume), for maps whose gather
    /// nobody asked for; a final gathering is the mean over many places, and keeps its own.
    ///
    /// # Errors
    /// None is known: k is at least 2 and caps are kept
    pub fn balanced(&self, stored: [usize; 3], is_asked_for: [bool; 3], indirect: Indirect) -> Result<Self> {
        let mut settings = *self;
        let maps = [&mut settings.global.1, &mut settings.caustic.1, &mut settings.volume.gather];
        for (index, (gather, stored)) in maps.into_iter().zip(stored).enumerate() {
            let is_gathered = index == 0 && indirect == Indirect::Gathered;
            if !is_asked_for[index] && !is_gathered {
                *gather = Gather::nearest(balanced(stored as f64, BALANCED[index]), gather.cap())?;
            }
        }
        Ok(settings)
    }

    /// How the map of this number is read, the first being 0: where the volume's estimator is progressive, with all fixed radii
    /// shrunk as [`Codimension::shrinkage`] says.
    pub fn in_map(&self, map: u64) -> Self {
        let mut settings = *self;
        if self.volume.is_progressive {
            settings.global.1 = self.global.1.in_map(map, Codimension::Two);
            settings.caustic.1 = self.caustic.1.in_map(map, Codimension::Two);
            settings.volume = self.volume.in_map(map);
        }
        settings
    }

    /// What the volume map is to hold.
    pub fn media(&self) -> MediumSamples {
        let Estimator { beam_radius, beam_length, has_planes, .. } = self.volume;
        MediumSamples::new(beam_radius.map(|_| beam_length), has_planes)
    }

    /// Photons of an estimate from the global, the caustic and the volume map; none for a fixed radius.
    pub fn nearest(&self) -> [Option<usize>; 3] {
        [self.global.1, self.caustic.1, self.volume.gather].map(Gather::k)
    }

    /// Whether steps of a march share gathers: not where places are not random, nor where rays are read as a whole.
    pub fn shares_gathers(&self) -> bool {
        let march = &self.march;
        let is_random = march.is_jittered && march.rule == StepRule::Integrated;
        self.spacing > 0.0 && is_random && !self.volume.reads_rays()
    }

    /// Whether volume estimates follow a rule of the laboratory about walls.
    pub(super) fn needs_walls(&self) -> bool {
        self.volume.needs_walls()
    }
}
