//! How maps are filled and read where nothing else is asked for: the choices of `turbid render`, number by number, so that the
//! same seed makes the same picture.

use crate::choices::{
    beam_blur, beam_length, check_about_rays, chosen, kernel, ray_ends, step_rule, treatment,
};
use crate::error::refuse;
use anyhow::{Context, Result, anyhow};
use pyo3::prelude::*;
use std::num::NonZeroUsize;
use turbid::estimators::boundary::Treatment;
use turbid::estimators::{BeamBlur, Estimator, Gather, Kernel, RayEnds};
use turbid::integrators::mapper::{LEAST_K, Settings, scene_size};
use turbid::integrators::{Adaptive, StepRule};
use turbid::math::Positive;
use turbid::photons::beams::BeamLength;
use turbid::photons::maps::{Amount, Indirect};
use turbid::scene::Scene;

/// Change of direct light above which a step of the march is halved.
const TOLERANCE: f64 = 0.5;

/// Steps across the scene, at most.
const MOST_STEPS: f64 = 1e6;

/// What Python asks for; its side has the defaults.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct Options {
    global_: String,
    caustic: String,
    volume: String,
    k: Option<usize>,
    caustic_k: Option<usize>,
    volume_k: Option<usize>,
    radius: Option<f64>,
    max_radius: Option<f64>,
    ray_radius: Option<f64>,
    ray_k: Option<usize>,
    beam_radius: Option<f64>,
    beam_blur: String,
    beam_length: String,
    ray_ends: String,
    planes: bool,
    kernel: String,
    caustic_kernel: String,
    gather_rays: u32,
    near: f64,
    step: Option<f64>,
    step_rule: String,
    adapt: Option<f64>,
    spacing: Option<f64>,
    jitter: bool,
    boundary: String,
    edges: String,
    /// Whether importance leads photons.
    pub importance: bool,
}

/// The same, understood.
pub struct Readout {
    options: Options,
    kernels: [Kernel; 2],
    treatment: Treatment,
    blur: BeamBlur,
    length: BeamLength,
    ends: RayEnds,
    rule: StepRule,
    clips_discs: bool,
    /// Photons of the global, the caustic and the volume map.
    pub amounts: [Amount; 3],
}

/// Photons of a map: `200000` are stored, `emit:1000000` sent out.
fn amount(name: &str, text: &str) -> PyResult<Amount> {
    let (number, is_emitted) = text.strip_prefix("emit:").map_or((text, false), |number| (number, true));
    let most = if is_emitted { 1_000_000_000_000 } else { 1_000_000_000 };
    let plain = number.parse::<u64>().ok().or_else(|| {
        let x = number.parse::<f64>().ok()?;
        (x.fract() == 0.0 && (0.0..=9e15).contains(&x)).then_some(x as u64)
    });
    let count = plain.filter(|n| (1..=most).contains(n)).ok_or_else(|| {
        refuse(format!(
            "{name} is {text}; allowed: a number of photons to store, 1 to 1e9, such as 200000, or to emit, 1 to 1e12, \
             such as 'emit:1e6'"
        ))
    })?;
    Ok(if is_emitted { Amount::Emitted(count) } else { Amount::Stored(count) })
}

impl Options {
    /// Understands the words.
    pub fn understood(self) -> PyResult<Readout> {
        let is_nearest = [self.k, self.caustic_k, self.volume_k].iter().any(Option::is_some);
        if self.radius.is_some() && (is_nearest || self.max_radius.is_some()) {
            return Err(refuse(
                "radius takes all photons within it; allowed with radius: no k, no max_radius",
            ));
        }
        Ok(Readout {
            kernels: [kernel("kernel", &self.kernel)?, kernel("caustic_kernel", &self.caustic_kernel)?],
            treatment: treatment(&self.boundary)?,
            blur: beam_blur(&self.beam_blur)?,
            length: beam_length(&self.beam_length)?,
            ends: ray_ends(&self.ray_ends)?,
            rule: step_rule(&self.step_rule)?,
            clips_discs: chosen("edges", &self.edges, &[("none", false), ("clipped", true)])?,
            amounts: [
                amount("global_", &self.global_)?,
                amount("caustic", &self.caustic)?,
                amount("volume", &self.volume)?,
            ],
            options: self,
        })
    }
}

impl Readout {
    /// Whether importance leads photons.
    pub fn is_by_importance(&self) -> bool {
        self.options.importance
    }

    /// Where the global map is read.
    pub fn indirect(&self) -> Indirect {
        if self.options.gather_rays == 0 { Indirect::Seen } else { Indirect::Gathered }
    }

    /// Photons of an estimate from the global, the caustic and the volume map, if asked for.
    fn nearest(&self) -> [Option<usize>; 3] {
        let Options { k, caustic_k, volume_k, .. } = self.options;
        [k, caustic_k.or(k), volume_k.or(k)]
    }

    /// Settings that suit the photons that the global, the caustic and the volume map hold, from those of
    /// [`Readout::settings`].
    pub fn suited(&self, settings: &Settings, stored: [usize; 3]) -> Result<Settings> {
        let is_asked_for = self.nearest().map(|k| self.options.radius.is_some() || k.is_some());
        Ok(settings.balanced(stored, is_asked_for, self.indirect())?)
    }

    /// Settings of the mapper for a scene whose maps are not known.
    pub fn settings(&self, scene: &Scene) -> Result<Settings> {
        let size = scene_size(scene);
        let Options { radius, max_radius, near, step, adapt, spacing, gather_rays, jitter, .. } =
            self.options;
        let gather = |k: Option<usize>| match radius {
            Some(radius) => Gather::radius(radius).context("radius"),
            None => {
                let reach = max_radius.unwrap_or(0.1 * size);
                Gather::nearest(k.unwrap_or(LEAST_K), reach).context("k, max_radius")
            }
        };
        let [surface, caustic, volume] = self.nearest().map(gather);
        let (surface, caustic, volume) = (surface?, caustic?, volume?);
        if !(near >= 0.0 && near.is_finite()) {
            return Err(anyhow!("near is {near}; allowed: finite and at least 0"));
        }
        let is_probed = scene.plan().densities.is_empty();
        let tolerance = adapt.unwrap_or(if is_probed { TOLERANCE } else { 0.0 });
        if !(tolerance >= 0.0 && tolerance.is_finite()) {
            return Err(anyhow!("adapt is {tolerance}; allowed: finite and at least 0"));
        }
        let mut settings = Settings::for_scene(scene, LEAST_K)?;
        settings.global = (self.kernels[0], surface);
        settings.caustic = (self.kernels[1], caustic);
        settings.volume = Estimator::new(self.kernels[0], volume).treated(self.treatment);
        let ray_radius = self.options.ray_radius;
        settings.volume.ray_radius =
            ray_radius.map(|radius| Positive::new("ray_radius", radius)).transpose()?;
        if self.options.ray_k.is_some() && ray_radius.is_none() {
            return Err(anyhow!("ray_k is the k nearest photons within ray_radius; allowed: with it"));
        }
        settings.volume.ray_k = self.options.ray_k.and_then(NonZeroUsize::new);
        let beam_radius = self.options.beam_radius;
        settings.volume.beam_radius =
            beam_radius.map(|radius| Positive::new("beam_radius", radius)).transpose()?;
        if ray_radius.is_some() && beam_radius.is_some() {
            return Err(anyhow!("ray_radius reads points and beam_radius beams; allowed: one of them"));
        }
        settings.volume.has_planes = self.options.planes;
        if ray_radius.is_some() && self.options.planes {
            return Err(anyhow!("ray_radius reads points and planes flights; allowed: one of them"));
        }
        settings.volume.ray_ends = self.ends;
        settings.volume.check_ends(scene).context("ray_ends")?;
        if settings.volume.reads_rays() {
            check_about_rays(self.treatment)?;
            if self.options.volume_k.is_some() {
                return Err(anyhow!(
                    "volume_k is of balls; allowed: without ray_radius, beam_radius and planes"
                ));
            }
        }
        settings.volume.beam_blur = self.blur;
        settings.volume.beam_length = self.length;
        let is_told = self.blur != BeamBlur::default() || self.length != BeamLength::default();
        if beam_radius.is_none() && is_told {
            return Err(anyhow!(
                "beam_blur and beam_length say how beams are read; allowed: with beam_radius"
            ));
        }
        if settings.volume.beam_blur == BeamBlur::ThreeD {
            return Err(anyhow!("beam_blur is 3d, which is about places; allowed of pictures: 1d, 2d"));
        }
        settings.gather_rays = gather_rays.max(1);
        settings.near = near;
        settings.clips_discs = self.clips_discs;
        if let Some(step) = step {
            let shortest = size / MOST_STEPS;
            if step > 0.0 && step < shortest {
                return Err(anyhow!(
                    "step is {step}; allowed: at least a millionth of the scene, {shortest}"
                ));
            }
            settings.march.step = Positive::new("step", step)?;
        }
        settings.march.rule = self.rule;
        settings.march.is_jittered = jitter;
        let shortest = Positive::new("the shortest step", 0.25 * settings.march.step.get())?;
        settings.march.adaptive = (tolerance > 0.0).then_some(Adaptive { tolerance, shortest });
        if let Some(spacing) = spacing {
            if !(spacing >= 0.0 && spacing.is_finite()) {
                return Err(anyhow!("spacing is {spacing}; allowed: finite and at least 0"));
            }
            settings.spacing = spacing;
            if spacing > 0.0 && !settings.shares_gathers() {
                return Err(anyhow!(
                    "spacing is about random steps; allowed: with jitter, step_rule \"integrated\", and none of ray_radius, beam_radius and planes"
                ));
            }
        }
        Ok(settings)
    }
}
