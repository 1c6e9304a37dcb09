//! What `render` and `map` share: the camera, the photons, exposure.

use super::made::Filled;
use super::memory::{Memory, passes_that_fit, rounded_down};
use super::progress::Bar;
use super::shared::{kernels, note, parse_count, tell_ahead, whole};
use anyhow::{Context, anyhow};
use clap::ValueEnum;
use std::num::NonZeroUsize;
use turbid::estimators::boundary::{Rejection, Treatment};
use turbid::estimators::{BeamBlur, Estimator, Gather, Kernel, RayEnds};
use turbid::integrators::mapper::{LEAST_K, Settings, scene_size};
use turbid::integrators::{Adaptive, StepRule};
use turbid::math::Positive;
use turbid::output::Curve;
use turbid::photons::beams::BeamLength;
use turbid::photons::importance::{Importance, ImportanceSettings};
use turbid::photons::maps::{Amount, Emitted, Forecast, Indirect, MapSettings, MediumSamples, forecast};
use turbid::scene::{Camera, Scene};
use turbid::transport::BLOCK;

/// The camera's picture, in another size if asked for.
#[derive(clap::Args)]
pub struct Frame {
    /// Pixels across, instead of the scene's; the height follows unless it is given.
    #[arg(long, value_parser = whole::<u32>(1..=16_384))]
    width: Option<u32>,
    /// Pixels down, instead of the scene's; the width follows unless it is given.
    #[arg(long, value_parser = whole::<u32>(1..=16_384))]
    height: Option<u32>,
}

impl Frame {
    /// The options that were given.
    pub fn words(&self) -> Option<String> {
        let words = [("width", self.width), ("height", self.height)];
        let given = words.iter().filter_map(|(name, n)| n.map(|n| format!("--{name} {n}")));
        Some(given.collect::<Vec<_>>().join(" ")).filter(|words| !words.is_empty())
    }

    /// The scene's camera, in the size asked for, and able to see light.
    pub fn camera(&self, scene: &Scene) -> anyhow::Result<Camera> {
        let camera = scene.camera().ok_or_else(|| {
            anyhow!(
                "the scene has no [camera]: add one with position, look_at, fov, width and height, or take a scene that has one, such as the built-in fogbox"
            )
        })?;
        let camera = camera.sized(self.width, self.height).context("--width, --height")?;
        turbid::sensor::check_camera(scene, &camera)?;
        Ok(camera)
    }
}

/// How a picture is shown.
#[derive(clap::Args)]
pub struct ToneArgs {
    /// Exposure of the PNG in stops: radiance times 2 to this power; pictures to be compared need the same
    /// [default: bright parts well exposed; the value taken is printed].
    #[arg(long)]
    pub exposure: Option<f64>,
    /// What the PNG does with light too bright for a screen.
    #[arg(long, value_enum, default_value = "soft")]
    tone: ToneName,
}

#[derive(Clone, Copy, ValueEnum)]
enum ToneName {
    /// Linear to 0.6 of white, then a smooth shoulder that reaches white at infinity.
    Soft,
    /// Linear to white, then cut.
    Clip,
}

impl ToneArgs {
    /// The curve asked for.
    pub fn curve(&self) -> Curve {
        match self.tone {
            ToneName::Soft => Curve::Soft,
            ToneName::Clip => Curve::Clip,
        }
    }

    /// The exposure asked for, if it is a number of stops.
    pub fn checked(&self) -> anyhow::Result<Option<f64>> {
        match self.exposure {
            Some(stops) if stops.is_nan() || stops.abs() > 1000.0 => {
                Err(anyhow!("--exposure is {stops}; allowed: -1000 to 1000 stops"))
            }
            other => Ok(other),
        }
    }
}

/// Photons on the command line: `200000` are stored, `emit:1e6` sent out.
fn parse_amount(text: &str) -> Result<Amount, String> {
    const ALLOWED: &str = "allowed: a number of photons to store, 1 to 1e9, such as 200000, or to emit, 1 to 1e12, such as emit:1e6";
    let (number, is_emitted) = text.strip_prefix("emit:").map_or((text, false), |number| (number, true));
    let most = if is_emitted { 1_000_000_000_000 } else { 1_000_000_000 };
    let count = parse_count(number).ok().filter(|n| *n <= most).ok_or(ALLOWED)?;
    Ok(if is_emitted { Amount::Emitted(count) } else { Amount::Stored(count) })
}

/// Photons of an estimate; whether they are enough is checked with the other settings.
fn parse_k(text: &str) -> Result<usize, String> {
    let k = parse_count(text).ok().filter(|k| *k <= 1_000_000_000).and_then(|k| usize::try_from(k).ok());
    k.ok_or_else(|| "allowed: whole numbers from 2 to 1e9".to_string())
}

/// Photons of the global, the caustic and the volume map where nothing is asked for.
const USUAL: [u64; 3] = [200_000, 50_000, 65_000];

/// How many photons the maps get.
#[derive(clap::Args)]
pub struct Photons {
    /// Photons of the global map, which is those on surfaces: a number to store, or `emit:1e6` to send out.
    #[arg(long, value_name = "PHOTONS", value_parser = parse_amount, default_value_t = Amount::Stored(USUAL[0]))]
    global: Amount,
    /// Photons of the caustic map, light focused by mirrors and glass; used where the scene has such.
    #[arg(long, value_name = "PHOTONS", value_parser = parse_amount, default_value_t = Amount::Stored(USUAL[1]))]
    caustic: Amount,
    /// Photons of the volume map, those in media; used where the scene has media.
    #[arg(long, value_name = "PHOTONS", value_parser = parse_amount, default_value_t = Amount::Stored(USUAL[2]))]
    volume: Amount,
    /// Let importance lead photons of the global and the volume map to where the camera reads them. For a camera that sees
    /// a small part of a large scene; the mean is the same, powers are no longer equal.
    #[arg(long = "importance", id = "importance")]
    pub is_by_importance: bool,
}

impl Photons {
    /// What the camera needs, learned, if it is asked for.
    pub fn importance(
        &self,
        scene: &Scene,
        camera: &Camera,
        maps: &MapSettings,
    ) -> turbid::Result<Option<Importance>> {
        let MapSettings { seed, replicate, .. } = *maps;
        let settings = ImportanceSettings { seed, replicate, ..Default::default() };
        let ImportanceSettings { particles, pilot, rounds, .. } = settings;
        let learn = || {
            let bar = Bar::stage("importance", BLOCK + particles + pilot * rounds);
            let learned = Importance::of(scene, camera, maps.indirect, &settings, &bar);
            bar.finish();
            learned
        };
        self.is_by_importance.then(learn).transpose()
    }

    /// How many histories the maps take, refused if they do not fit the memory; of the first repetition told, where they take
    /// long.
    ///
    /// # Arguments
    /// `fixed` bytes that the rest takes, and `beside` those that each photon takes beside its map
    pub fn forecast(
        &self,
        scene: &Scene,
        maps: &MapSettings,
        importance: Option<&Importance>,
        held: Held,
        memory: &Memory,
        (fixed, beside): (f64, f64),
    ) -> anyhow::Result<Emitted> {
        let forecast = forecast(scene, maps, importance)?;
        let Forecast { emitted, stored, seconds, .. } = forecast;
        let total: f64 = stored.iter().sum();
        let passes = held.passes as f64;
        let a_pass = Forecast { stored: stored.map(|photons| photons / passes), ..forecast };
        let bytes = fixed + a_pass.bytes(held.runs) + beside * total / passes;
        memory.check(&format!("{total:.2e} photons in maps"), bytes, fixed, |part| {
            let part = a_pass.part_in(part, held.runs);
            let asked =
                [("global", maps.global, 0), ("volume", maps.volume, 1), ("caustic", maps.caustic, 2)];
            let needed = asked.iter().filter(|(_, _, map)| stored[*map] > 0.0);
            let fewer = needed.map(|(name, amount, _)| match amount {
                Amount::Stored(n) => format!("--{name} {}", rounded_down(*n as f64 * part)),
                Amount::Emitted(n) => format!("--{name} emit:{}", rounded_down(*n as f64 * part)),
            });
            let fewer = fewer.collect::<Vec<_>>().join(" ");
            let passes = passes_that_fit(held.passes, part);
            if held.has_radius { format!("{fewer}, or --passes {passes}") } else { fewer }
        })?;
        if maps.replicate == 0 {
            let what =
                format!("{:.2e} photons to send out, {total:.2e} to store", emitted.histories() as f64);
            tell_ahead(&what, seconds, bytes)?;
        }
        Ok(emitted)
    }

    /// Says which maps have far fewer photons than were asked for, and why.
    pub fn tell_sparse(&self, filled: &[Option<Filled>; 3]) -> std::io::Result<()> {
        let asked = [("global", self.global), ("caustic", self.caustic), ("volume", self.volume)];
        for ((name, asked), filled) in asked.into_iter().zip(filled) {
            let (Amount::Stored(asked), Some(Filled { stored, emitted })) = (asked, *filled) else {
                continue;
            };
            let stored = stored as u64;
            // An empty map has a line of its own.
            if stored == 0 || 2 * stored >= asked {
                continue;
            }
            let part = stored as f64 / emitted as f64;
            let all = asked as f64 / part;
            note(&format!(
                "the {name} map holds {stored} of {asked} photons asked for: it stores {:.2} % of those sent out, of which \
                 there were {emitted}; --{name} emit:{all:.0e} sends out as many as it takes",
                100.0 * part,
            ))?;
        }
        Ok(())
    }

    /// Settings of the maps of one repetition.
    pub fn settings(
        &self,
        indirect: Indirect,
        media: MediumSamples,
        seed: u64,
        replicate: u64,
    ) -> MapSettings {
        let Photons { global, caustic, volume, .. } = *self;
        MapSettings { global, caustic, volume, media, indirect, seed, replicate }
    }
}

/// How much of the photons is in memory at one time.
#[derive(Clone, Copy)]
pub struct Held {
    /// One part of so many.
    pub passes: u64,
    /// Maps of each kind that are filled one after the other, over all passes and repetitions.
    pub runs: u64,
    /// Whether the radius is fixed, so that there may be several.
    pub has_radius: bool,
}

impl Held {
    /// All of them.
    pub const ALL: Held = Held { passes: 1, runs: 1, has_radius: false };
}

/// How the maps are read.
#[derive(clap::Args)]
pub struct Readout {
    /// Photons an estimate takes, the k nearest [default: 100; of more than 70,000 in a global map that the eye sees, 50,000 in
    /// the caustic and 20,000 in the volume map what balances noise and blur, in proportion to their number to the power 2/3,
    /// in the volume 4/7, up to 1000; by the first of several maps].
    #[arg(long, value_parser = parse_k, conflicts_with = "radius")]
    k: Option<usize>,
    /// The same for the caustic map [default: --k, if given].
    #[arg(long, value_parser = parse_k, conflicts_with = "radius")]
    caustic_k: Option<usize>,
    /// The same for the volume map [default: --k, if given]. Not where rays are read as a whole.
    #[arg(long, value_parser = parse_k, conflicts_with_all = ["radius", "ray_radius", "beam_radius"])]
    volume_k: Option<usize>,
    /// Radius within which an estimate takes all photons, instead of the k nearest [L].
    #[arg(long)]
    radius: Option<f64>,
    /// The farthest that the k nearest photons are sought [L; default: a tenth of the scene].
    #[arg(long, conflicts_with = "radius")]
    max_radius: Option<f64>,
    /// How estimates from the global and the volume map weight their photons.
    #[arg(long, value_parser = kernels(), default_value = "uniform")]
    kernel: Kernel,
    /// The same for the caustic map.
    #[arg(long, value_parser = kernels(), default_value = "cone")]
    caustic_kernel: Kernel,
    /// Read the volume map along whole rays, from all photons within this distance of the ray, weighted by --kernel, in place of at
    /// each step of the march: the beam radiance estimate. With --boundary none what lies beyond faces and behind bodies beside the ray
    /// is missing [L].
    #[arg(long, conflicts_with = "reject")]
    ray_radius: Option<f64>,
    /// Give each photon a radius of its own about rays, the distance to its k-th nearest other photon, at most --ray-radius: the beam
    /// radiance estimate as it was published, sharp where photons are many. Its blur depends on their density. Not with --progressive
    /// or --passes.
    #[arg(long, value_name = "K", requires = "ray_radius", conflicts_with_all = ["progressive", "reject", "beam_radius"], value_parser = whole::<u32>(1..=1_000_000_000))]
    ray_k: Option<u32>,
    /// Store photons' flights through media as beams in place of photons, and read them along whole rays, from all beams that pass
    /// within this distance of the ray, weighted by --kernel: less noise than points where it is below 0.4 mean free paths. --volume
    /// counts beams [L].
    #[arg(long, conflicts_with_all = ["reject", "ray_radius"])]
    beam_radius: Option<f64>,
    /// In how many dimensions beams are blurred, 1d or 2d [default: 1d].
    #[arg(long, value_enum, requires = "beam_radius", conflicts_with_all = ["reject", "ray_radius"])]
    beam_blur: Option<BlurName>,
    /// How far beams go [default: sampled].
    #[arg(long, value_enum, requires = "beam_radius", conflicts_with_all = ["reject", "ray_radius"])]
    beam_length: Option<LengthName>,
    /// Where rays that are read at once end: own loses nothing at faces, and blurs the picture alone. Only for one homogeneous region
    /// with nothing in it [default: cut].
    #[arg(long, value_enum, conflicts_with = "planes")]
    ray_ends: Option<EndsName>,
    /// Read light that is scattered twice and more in media from planes of photons' flights, without blur or bias: each flight and a
    /// scattering on it sweep one out. Beside bodies --beam-radius is needed too, for light that comes to the media from them. Homogeneous
    /// media whose extinction is the same in all channels, without dielectric boundaries. Its variance is infinite: most pixels are a little
    /// too dark and few far too bright, the more so the more peaked media scatter, and errors between maps are too small by what few maps
    /// have not met yet. --volume counts planes and beams.
    #[arg(long, conflicts_with_all = ["ray_radius", "volume_k", "reject"])]
    planes: bool,
    /// Rays of a final gathering at each surface that is seen; 0 reads the global map there itself: fast, and blotchy.
    #[arg(long, default_value_t = 64, value_parser = whole::<u32>(0..=1_000_000))]
    gather_rays: u32,
    /// Rays of a final gathering that are shorter than this are traced on: the map's blur shows in corners [L].
    #[arg(long, default_value_t = 0.0)]
    near: f64,
    /// Longest step of the march through media [L; default: a twentieth of the scene, and no longer than the shortest mean
    /// free path of media whose density varies, down to a thousandth].
    #[arg(long)]
    step: Option<f64>,
    /// How much of a step's light reaches its near end: the rule of 1998, or exact for a constant source.
    #[arg(long, value_enum, default_value = "integrated")]
    step_rule: RuleName,
    /// Relative change of direct light from one end of a step to the other above which it is halved, to a quarter at
    /// most, as in 1998; 0 for equal steps [default: 0.5; 0 with several passes, or where the density of a medium varies].
    #[arg(long)]
    adapt: Option<f64>,
    /// March on places that are not random: no noise, but bands.
    #[arg(long)]
    no_jitter: bool,
    /// Random steps share a gather of the volume map, at one of their places, within this many radii of the last one; 0 for a gather at
    /// each step [default: 2; 0 with --no-jitter and the other step rules].
    #[arg(long)]
    spacing: Option<f64>,
    /// What volume estimates do where a medium ends or a body stands in it: without it there are no photons, behind it
    /// others. But for none, photons that a body hides from the point do not count.
    #[arg(long, value_enum, default_value = "clipped")]
    boundary: BoundaryName,
    /// What surface estimates do at the edges of flat surfaces, beyond which there are no photons.
    #[arg(long, value_enum, default_value = "clipped")]
    edges: EdgesName,
    /// A rule of the literature about photons behind walls, instead of what --boundary does about them; for the laboratory.
    #[arg(long, value_enum, default_value = "off")]
    reject: RejectName,
}

#[derive(Clone, Copy, ValueEnum)]
enum RuleName {
    /// The light at the near end of the step, not attenuated in it: the formula of 1998.
    NearEnd,
    /// The light in its middle.
    Middle,
    /// The exponential integrated over the step.
    Integrated,
}

#[derive(Clone, Copy, ValueEnum)]
pub enum BoundaryName {
    /// Nothing: up to half is lost at a face.
    None,
    /// Divides by the part of the kernel that is inside.
    Clipped,
    /// Mirrors the photons in the faces.
    Reflection,
    /// Fits a line along the normal.
    LocalLinear,
}

impl BoundaryName {
    /// Whether estimates about rays know it.
    ///
    /// # Errors
    /// a treatment of balls
    pub fn check_about_rays(self) -> anyhow::Result<()> {
        let treatment = self.treatment();
        if treatment.is_of_rays() {
            return Ok(());
        }
        Err(anyhow!(
            "--boundary is {}, of balls; allowed of rays that are read as a whole: none, clipped",
            treatment.name().replace(' ', "-")
        ))
    }

    /// The treatment of this name.
    pub fn treatment(self) -> Treatment {
        match self {
            BoundaryName::None => Treatment::None,
            BoundaryName::Clipped => Treatment::Clipped,
            BoundaryName::Reflection => Treatment::Reflection,
            BoundaryName::LocalLinear => Treatment::LocalLinear,
        }
    }
}

#[derive(Clone, Copy, PartialEq, ValueEnum)]
pub enum BlurName {
    /// Along the line across a ray and a beam; at a place, where there is no such line, across the beam.
    #[value(name = "1d")]
    OneD,
    /// Across the ray, so that beams along it count too; at a place across the beam.
    #[value(name = "2d")]
    TwoD,
    /// In the ball about a place; not for rays.
    #[value(name = "3d")]
    ThreeD,
}

impl BlurName {
    /// The blur of this name.
    pub fn blur(self) -> BeamBlur {
        match self {
            BlurName::OneD => BeamBlur::OneD,
            BlurName::TwoD => BeamBlur::TwoD,
            BlurName::ThreeD => BeamBlur::ThreeD,
        }
    }
}

#[derive(Clone, Copy, PartialEq, ValueEnum)]
pub enum EndsName {
    /// Square across the ray at the faces of the medium, which --boundary makes up for.
    Cut,
    /// For each photon or beam where the parallel ray through it leaves the medium.
    Own,
}

#[derive(Clone, Copy, ValueEnum)]
pub enum LengthName {
    /// As far as the photon flew.
    Sampled,
    /// To the end of each medium, with what passes, while the photon goes on from where it collided: less noise a photon, and more
    /// beams about every ray.
    Whole,
}

impl LengthName {
    /// The length of this name.
    pub fn length(self) -> BeamLength {
        match self {
            LengthName::Sampled => BeamLength::Sampled,
            LengthName::Whole => BeamLength::Whole,
        }
    }
}

#[derive(Clone, Copy, PartialEq, ValueEnum)]
enum EdgesName {
    /// Nothing: up to half is lost at an edge.
    None,
    /// Divides by the part of the kernel that is on the surface.
    Clipped,
}

#[derive(Clone, Copy, ValueEnum)]
pub enum RejectName {
    /// None: photons that a body hides from the point do not count where --boundary is not none.
    Off,
    /// Those that do not travel towards the wall: half of the good ones go too.
    Facing,
    /// Those behind the wall's plane that do not travel towards it.
    FacingBehind,
    /// Those behind the wall's plane.
    BehindPlane,
    /// Those that a body hides from the point, also where --boundary is none.
    Visible,
}

impl RejectName {
    /// The rejection of this name.
    pub fn rejection(self) -> Rejection {
        match self {
            RejectName::Off => Rejection::Off,
            RejectName::Facing => Rejection::Facing,
            RejectName::FacingBehind => Rejection::FacingBehind,
            RejectName::BehindPlane => Rejection::BehindPlane,
            RejectName::Visible => Rejection::Visible,
        }
    }
}

/// The radius of --ray-radius, checked.
pub fn ray_radius(given: Option<f64>) -> anyhow::Result<Option<Positive>> {
    Ok(given.map(|radius| Positive::length("--ray-radius", radius)).transpose()?)
}

/// The number of --ray-k.
pub fn ray_k(given: Option<u32>) -> Option<NonZeroUsize> {
    given.and_then(|k| NonZeroUsize::new(k as usize))
}

/// The radius of --beam-radius, checked.
pub fn beam_radius(given: Option<f64>) -> anyhow::Result<Option<Positive>> {
    Ok(given.map(|radius| Positive::length("--beam-radius", radius)).transpose()?)
}

/// Where rays end by --ray-ends, of these radii about rays and beams.
pub fn ray_ends(
    given: Option<EndsName>,
    radii: (Option<Positive>, Option<Positive>),
) -> anyhow::Result<RayEnds> {
    match given {
        Some(EndsName::Own) if radii == (None, None) => Err(anyhow!(
            "--ray-ends is own, of rays that are read at once; allowed: with --ray-radius or --beam-radius"
        )),
        Some(EndsName::Own) => Ok(RayEnds::Own),
        Some(EndsName::Cut) | None => Ok(RayEnds::Cut),
    }
}

/// Change of direct light above which a step of the march is halved.
const TOLERANCE: f64 = 0.5;

impl Readout {
    /// Where the global map is read.
    pub fn indirect(&self) -> Indirect {
        if self.gather_rays == 0 { Indirect::Seen } else { Indirect::Gathered }
    }

    /// Whether an estimate takes all photons within a radius.
    pub fn has_radius(&self) -> bool {
        self.radius.is_some()
    }

    /// Whether each photon has a radius of its own about rays.
    pub fn has_ray_k(&self) -> bool {
        self.ray_k.is_some()
    }

    /// Whether rays are read in ways that only homogeneous media allow.
    pub fn needs_even_media(&self) -> bool {
        self.planes || self.ray_ends == Some(EndsName::Own)
    }

    /// Whether steps that depend on what is read are asked for.
    pub fn is_adaptive(&self) -> bool {
        self.adapt.is_some_and(|tolerance| tolerance > 0.0)
    }

    /// Photons of an estimate from the global, the caustic and the volume map, if asked for.
    fn nearest(&self) -> [Option<usize>; 3] {
        [self.k, self.caustic_k.or(self.k), self.volume_k.or(self.k)]
    }

    /// Settings that suit the photons that the global, the caustic and the volume map hold, from those of [`Readout::settings`].
    pub fn suited(&self, settings: &Settings, stored: [usize; 3]) -> anyhow::Result<Settings> {
        let is_asked_for = self.nearest().map(|k| self.radius.is_some() || k.is_some());
        Ok(settings.balanced(stored, is_asked_for, self.indirect())?)
    }

    /// Settings of the mapper for a scene whose maps are not known, read in so many passes: steps are to be the same in all.
    pub fn settings(&self, scene: &Scene, passes: u64) -> anyhow::Result<Settings> {
        let size = scene_size(scene);
        let gather = |k: Option<usize>| match self.radius {
            Some(radius) => Gather::radius(radius).context("--radius"),
            None => {
                let reach = self.max_radius.unwrap_or(0.1 * size);
                Gather::nearest(k.unwrap_or(LEAST_K), reach).context("--k, --max-radius")
            }
        };
        let [surface, caustic, volume] = self.nearest().map(gather);
        let (surface, caustic, volume) = (surface?, caustic?, volume?);
        if !(self.near >= 0.0 && self.near.is_finite()) {
            return Err(anyhow!("--near is {}; allowed: finite and at least 0", self.near));
        }
        // Where the density varies, probes of direct light cost more than shorter steps bring: each tracks a shadow ray through the
        // density, empty places included (tests/cli/pictures.rs has the count).
        let is_probed = passes == 1 && scene.plan().densities.is_empty();
        let tolerance = self.adapt.unwrap_or(if is_probed { TOLERANCE } else { 0.0 });
        if !(tolerance >= 0.0 && tolerance.is_finite()) {
            return Err(anyhow!("--adapt is {tolerance}; allowed: finite and at least 0"));
        }
        let mut settings = Settings::for_scene(scene, LEAST_K)?;
        settings.global = (self.kernel, surface);
        settings.caustic = (self.caustic_kernel, caustic);
        let volume = Estimator::new(self.kernel, volume);
        settings.volume = volume.treated(self.boundary.treatment()).rejecting(self.reject.rejection());
        settings.volume.ray_radius = ray_radius(self.ray_radius)?;
        settings.volume.ray_k = ray_k(self.ray_k);
        settings.volume.beam_radius = beam_radius(self.beam_radius)?;
        settings.volume.beam_blur = self.beam_blur.map_or(BeamBlur::default(), BlurName::blur);
        settings.volume.beam_length = self.beam_length.map(LengthName::length).unwrap_or_default();
        settings.volume.has_planes = self.planes;
        let radii = (settings.volume.ray_radius, settings.volume.beam_radius);
        settings.volume.ray_ends = ray_ends(self.ray_ends, radii)?;
        settings.volume.check_ends(scene).context("--ray-ends")?;
        if settings.volume.beam_blur == BeamBlur::ThreeD {
            return Err(anyhow!("--beam-blur is 3d, which is about places; allowed of pictures: 1d, 2d"));
        }
        if settings.volume.reads_rays() {
            self.boundary.check_about_rays()?;
        }
        settings.gather_rays = self.gather_rays.max(1);
        settings.near = self.near;
        settings.clips_discs = self.edges == EdgesName::Clipped;
        if let Some(step) = self.step {
            let shortest = size / MOST_STEPS;
            if step > 0.0 && step < shortest {
                return Err(anyhow!(
                    "--step is {step}; allowed: at least a millionth of the scene, {shortest}"
                ));
            }
            settings.march.step = Positive::new("--step", step)?;
        }
        settings.march.rule = match self.step_rule {
            RuleName::NearEnd => StepRule::NearEnd,
            RuleName::Middle => StepRule::Middle,
            RuleName::Integrated => StepRule::Integrated,
        };
        settings.march.is_jittered = !self.no_jitter;
        let shortest = Positive::new("the shortest step", 0.25 * settings.march.step.get())?;
        settings.march.adaptive = (tolerance > 0.0).then_some(Adaptive { tolerance, shortest });
        if let Some(spacing) = self.spacing {
            if !(spacing >= 0.0 && spacing.is_finite()) {
                return Err(anyhow!("--spacing is {spacing}; allowed: finite and at least 0"));
            }
            if spacing > 0.0 && (self.no_jitter || settings.march.rule != StepRule::Integrated) {
                return Err(anyhow!(
                    "--spacing is about random steps; allowed: without --no-jitter, by --step-rule integrated"
                ));
            }
            if spacing > 0.0 && settings.volume.reads_rays() {
                return Err(anyhow!(
                    "--spacing is about steps; allowed: without --ray-radius, --beam-radius and --planes"
                ));
            }
            settings.spacing = spacing;
        }
        Ok(settings)
    }
}

/// Steps across the scene, at most: a march of more would not come to an end in a user's time.
const MOST_STEPS: f64 = 1e6;
