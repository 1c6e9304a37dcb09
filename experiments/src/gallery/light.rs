//! Pictures without photon maps, by paths and by light tracing: the photons' own walk, connected to the camera, finds what lights throw through glass and
//! water, where paths from the eye would have to meet a small light by chance.
//!
//! It knows only what the eye sees straight: an event X between which and the camera nothing specular stands. Paths give
//! what is seen by specular surfaces, and all layers that are not asked for here: each class of light comes from one of the
//! two, none from both, none from neither.

use anyhow::ensure;
use std::ops::Range;
use turbid::Spectrum;
use turbid::integrators::{Guides, Layer, Layers, Splat, light_tracing, path};
use turbid::math::Ray;
use turbid::photons::{Emitter, Guide, GuideSettings};
use turbid::rng::{Purpose, Stream};
use turbid::scene::{Camera, Orders, Scene};
use turbid::sensor::{Film, Streams, extend};
use turbid::transport::{NoProgress, Progress, run_blocks};

/// Histories whose light is kept at once, before it is added to the picture: what they send to the camera fills some
/// hundred bytes each.
const AT_ONCE: u64 = 1 << 18;

/// Which layers of a picture without photon maps are found by light tracing.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ByLight {
    /// These; none of them is emission.
    pub layers: &'static [Layer],
    /// Photons that are sent out for each sample a pixel of the paths, over the number of pixels times a thousand.
    pub permille: u64,
    /// Photons by which paths are led, none if 0.
    pub guide: u64,
}

impl ByLight {
    /// Nothing: all by paths.
    pub const NOTHING: ByLight = ByLight { layers: &[], permille: 0, guide: 0 };

    /// Nothing, and paths are led to where photons came from.
    pub const GUIDED: ByLight = ByLight { guide: 200_000, ..Self::NOTHING };

    /// What arrives by specular surfaces alone.
    pub const CAUSTICS: ByLight = ByLight { layers: &[Layer::Caustic], permille: 1000, guide: 0 };

    /// All that scatters.
    pub const ALL: ByLight = ByLight {
        layers: &[Layer::Direct, Layer::Caustic, Layer::Indirect, Layer::Single, Layer::Multiple],
        permille: 1000,
        guide: 0,
    };

    /// Whether a layer is found by light.
    fn has(&self, layer: Layer) -> bool {
        self.layers.contains(&layer)
    }

    /// The method's name.
    pub fn name(&self) -> &'static str {
        match self.layers {
            [] if self.guide > 0 => "guided paths",
            [] => "paths",
            [Layer::Caustic] => "paths with caustics by light tracing",
            [Layer::Caustic, Layer::Indirect] => "paths with caustics and indirect light by light tracing",
            _ => "light tracing",
        }
    }

    /// Whether all that is scattered is found by light.
    fn has_all(&self) -> bool {
        Layer::ALL.into_iter().all(|layer| layer == Layer::Emission || self.has(layer))
    }

    /// One sample of what paths have to find: all layers where a specular surface is seen, else those that light tracing
    /// leaves out.
    fn rest(
        &self,
        scene: &Scene,
        (ray, within): (Ray, usize),
        guides: Guides<'_>,
        stream: &mut Stream,
    ) -> Layers {
        let mut layers = Layers::ZERO;
        if self.layers.is_empty() || is_specular_ahead(scene, &ray) {
            let collect = |_, layer, value| layers[layer] += value;
            path::guided_classes(scene, (ray, within), Orders::ALL, guides, stream, collect);
            return layers;
        }
        // What is not scattered has order 0.
        let orders = if self.has_all() { Orders { min: 0, max: Some(0) } } else { Orders::ALL };
        path::classes(scene, ray, None, within, orders, stream, |_, layer, value| {
            if !self.has(layer) {
                layers[layer] += value;
            }
        });
        layers
    }

    /// Photons that are sent out with so many samples a pixel.
    fn histories(&self, samples: u64, pixels: usize) -> u64 {
        samples * self.permille * pixels as u64 / 1000
    }

    /// Adds the layers that light tracing finds with the samples of these numbers, by pixel, times the number of photons.
    fn trace(
        &self,
        scene: &Scene,
        camera: &Camera,
        samples: Range<u64>,
        streams: Streams,
        film: &mut [Layers],
    ) -> anyhow::Result<()> {
        let [first, last] = [samples.start, samples.end].map(|n| self.histories(n, film.len()));
        if self.layers.is_empty() || first == last {
            return Ok(());
        }
        // What arrives by specular surfaces alone was sent towards them; the rest may have been sent anywhere.
        let by_glass = Emitter::towards_specular(scene).filter(|_| self.has(Layer::Caustic));
        let is_by_glass = |layer| by_glass.is_some() && layer == Layer::Caustic;
        if let Some(by_glass) = &by_glass {
            send((scene, camera), (by_glass, 0), first..last, streams, is_by_glass, film)?;
        }
        if by_glass.is_none() || self.layers != [Layer::Caustic] {
            let others = |layer| self.has(layer) && !is_by_glass(layer);
            send((scene, camera), (&Emitter::by_power(scene), 1), first..last, streams, others, film)?;
        }
        Ok(())
    }

    /// Light of a medium before a specular surface belongs to light tracing, behind it to paths: a sample would have to be
    /// parted.
    ///
    /// # Errors
    /// where a specular surface is seen through a medium whose light is asked for
    pub fn check(&self, scene: &Scene, camera: &Camera) -> anyhow::Result<()> {
        let scatters = scene.media().iter().any(|medium| medium.matter().albedo().max() > 0.0);
        if !scatters || !(self.has(Layer::Single) || self.has(Layer::Multiple)) {
            return Ok(());
        }
        let pixels = (0..camera.height()).flat_map(|y| (0..camera.width()).map(move |x| (x, y)));
        let seen = pixels.filter(|&(x, y)| {
            let ray = camera.ray(glam::DVec2::new(f64::from(x) + 0.5, f64::from(y) + 0.5));
            is_specular_ahead(scene, &ray)
        });
        ensure!(
            seen.count() == 0,
            "a specular surface is seen through a medium: its light cannot be traced from the lamps"
        );
        Ok(())
    }
}

/// A picture without photon maps that grows sample by sample.
pub struct Unbiased<'a> {
    /// Which method.
    pub by_light: ByLight,
    /// Of which scene.
    pub scene: &'a Scene,
    /// From where.
    pub camera: &'a Camera,
    /// Random numbers.
    pub streams: Streams,
    /// Where photons came from, if paths are led there.
    guide: Option<Guide>,
    /// What paths have found.
    film: Film,
    /// What light tracing has found, times the number of photons.
    found: Vec<Layers>,
}

impl<'a> Unbiased<'a> {
    /// A picture without any sample.
    ///
    /// # Errors
    /// those of [`ByLight::check`] and of [`Guide::learn`]
    pub fn new(
        by_light: ByLight,
        scene: &'a Scene,
        camera: &'a Camera,
        streams: Streams,
    ) -> anyhow::Result<Self> {
        by_light.check(scene, camera)?;
        let film = Film::new(camera.width(), camera.height());
        let found = vec![Layers::ZERO; film.pixels().len()];
        let Streams { seed, replicate } = streams;
        let settings = GuideSettings { histories: by_light.guide, seed, replicate, share: None };
        let learn = || Guide::learn(scene, &settings, &NoProgress);
        let guide = (by_light.guide > 0).then(learn).transpose()?;
        Ok(Unbiased { by_light, scene, camera, streams, guide, film, found })
    }

    /// Samples a pixel so far.
    pub fn samples(&self) -> u64 {
        self.film.samples()
    }

    /// Adds so many samples to each pixel.
    ///
    /// # Errors
    /// those of rendering
    pub fn extend(&mut self, samples: u64, progress: &dyn Progress) -> anyhow::Result<()> {
        let Unbiased { by_light, scene, camera, streams, .. } = *self;
        let (first, interior) = (self.samples(), scene.interior_at(camera.position()));
        let guides = Guides { windows: None, learned: self.guide.as_ref() };
        extend(&mut self.film, camera, samples, streams, progress, |ray, stream, n: &mut u64| {
            *n += 1;
            by_light.rest(scene, (ray, interior), guides, stream)
        })?;
        by_light.trace(scene, camera, first..first + samples, streams, &mut self.found)
    }

    /// Radiance of each pixel by layer.
    pub fn layers(&self) -> Vec<Layers> {
        let histories = self.by_light.histories(self.samples(), self.found.len());
        let share = Spectrum::grey(1.0 / histories.max(1) as f64);
        let sum = |(pixel, found): (&turbid::sensor::Pixel, &Layers)| {
            let (mut layers, mut found) = (pixel.layers(), *found);
            found *= share;
            layers += found;
            layers
        };
        self.film.pixels().iter().zip(&self.found).map(sum).collect()
    }
}

/// Sends out the histories of these numbers, and adds what they bring to the layers that are wanted; two emitters, 0 and 1, of one
/// picture share no random numbers.
fn send(
    (scene, camera): (&Scene, &Camera),
    (emitter, number): (&Emitter, u64),
    histories: Range<u64>,
    streams: Streams,
    is_wanted: impl Fn(Layer) -> bool + Sync,
    film: &mut [Layers],
) -> anyhow::Result<()> {
    for first in histories.clone().step_by(AT_ONCE as usize) {
        let block = |range: Range<u64>| {
            let mut splats: Vec<Splat> = Vec::new();
            for i in range {
                let history = 2 * (first + i) + number;
                let mut stream = Stream::new(streams.seed, Purpose::LightTracing, streams.replicate, history);
                light_tracing(scene, camera, emitter, &mut stream, |splat| {
                    if is_wanted(splat.layer) {
                        splats.push(splat);
                    }
                });
            }
            splats
        };
        let merge = |mut a: Vec<Splat>, b: Vec<Splat>| {
            a.extend(b);
            a
        };
        let count = AT_ONCE.min(histories.end - first);
        let splats = run_blocks(count, &NoProgress, block, merge)?.unwrap_or_default();
        for Splat { at, layer, value } in splats {
            ensure!(value.is_finite(), "light tracing found a value that is not finite");
            for (pixel, density) in camera.pixels(at) {
                film[pixel][layer] += value * density;
            }
        }
    }
    Ok(())
}

/// Whether the first body on a ray, filters apart, is specular.
pub(crate) fn is_specular_ahead(scene: &Scene, ray: &Ray) -> bool {
    let (mut ray, mut from) = (*ray, None);
    while let Some(found) = scene.hit(&ray, from) {
        let turbid::scene::Target::Object(index) = found.target else { return false };
        let surface = &scene.objects()[index].surface;
        if surface.is_event() {
            return surface.is_specular();
        }
        ray = Ray::new(ray.at(found.hit.t), ray.dir);
        from = Some(found.start());
    }
    false
}

#[cfg(test)]
mod tests {
    use super::*;
    use turbid::scene::SceneFile;
    use turbid::stats::{Moments, student_p};

    /// A glass ball over a floor before a wall, beside a lamp large enough for paths to find it through the glass.
    const BALL: &str = r#"
        interiors = [{ name = "glass", index = 1.5 }]
        [camera]
        position = [0.0, 2.0, 4.0]
        look_at = [0.0, 0.5, 0.0]
        fov = 60.0
        width = 6
        height = 4
        [[objects]]
        shape = { sphere = { center = [0.0, 0.8, 0.0], radius = 0.7 } }
        surface = { dielectric = { inside = "glass" } }
        [[objects]]
        shape = { rectangle = { corner = [-3.0, 0.0, 3.0], u = [6.0, 0.0, 0.0], v = [0.0, 0.0, -6.0] } }
        surface = { lambertian = { reflectance = 0.6 } }
        [[objects]]
        shape = { rectangle = { corner = [-3.0, 0.0, -1.8], u = [6.0, 0.0, 0.0], v = [0.0, 4.0, 0.0] } }
        surface = { lambertian = { reflectance = 0.6 } }
        [[lights]]
        area = { shape = { sphere = { center = [-1.5, 2.6, -0.5], radius = 0.6 } }, radiance = 5 }
    "#;

    /// Layer by layer, paths alone and both together are the same picture: of the caustic, which is by light where the floor
    /// is seen and by paths where the ball is, of what paths alone find, with all that scatters by light, and by guided paths.
    #[test]
    fn no_light_is_lost_or_counted_twice() {
        let file = SceneFile::from_toml(BALL).unwrap();
        let scene = file.scene(std::path::Path::new(".")).unwrap();
        let camera = scene.camera().unwrap();
        let one = |by_light: ByLight, replicate: u64| {
            let streams = Streams { seed: 5, replicate };
            let mut picture = Unbiased::new(by_light, &scene, camera, streams).unwrap();
            // In two parts: no history is sent out twice.
            for samples in [50, 70] {
                picture.extend(samples, &NoProgress).unwrap();
            }
            let mut sum = Layers::ZERO;
            picture.layers().into_iter().for_each(|layers| sum += layers);
            sum
        };
        let moments = |by_light: ByLight, first: u64| {
            let mut all = vec![Moments::new(); Layer::ALL.len()];
            for replicate in first..first + 64 {
                let layers = one(by_light, replicate);
                all.iter_mut().zip(Layer::ALL).for_each(|(m, layer)| m.push(layers[layer].mean()));
            }
            all
        };
        let paths = moments(ByLight::NOTHING, 0);
        for (by_light, first) in [(ByLight::CAUSTICS, 1000), (ByLight::ALL, 2000), (ByLight::GUIDED, 3000)] {
            let both = moments(by_light, first);
            for ((layer, a), b) in Layer::ALL.into_iter().zip(&paths).zip(&both).take(4) {
                let std_error = (a.std_error() * a.std_error() + b.std_error() * b.std_error()).sqrt();
                let p = student_p((a.mean() - b.mean()).abs() / std_error, 63);
                assert!(p > 1e-6, "{layer:?}: {} against {}, error {std_error}", b.mean(), a.mean());
                // Half of a layer, lost or counted twice, is detected with a power of 99 per cent: (5.42 + 2.4) x 6 %. What is seen
                // of the lamp comes by paths on both sides, from few pixels: there the whole is, (5.42 + 2.4) x 12 %.
                let promised = if layer == Layer::Emission { 0.12 } else { 0.06 };
                assert!(std_error < promised * a.mean(), "{layer:?}: error {std_error} of {}", a.mean());
            }
        }
    }
}
