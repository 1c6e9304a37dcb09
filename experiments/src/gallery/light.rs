//! References by light tracing: the photons' own walk, connected to the camera, finds what lights throw through glass and
//! water, where paths from the eye would have to meet a small light by chance.
//!
//! It knows only what the eye sees straight: an event X between which and the camera nothing specular stands. Paths give
//! what is seen by specular surfaces, and all layers that are not asked for here: each class of light comes from one of the
//! two, none from both, none from neither.

use anyhow::ensure;
use std::ops::Range;
use turbid::Spectrum;
use turbid::integrators::{Layer, Layers, Splat, light_tracing, path};
use turbid::math::Ray;
use turbid::photons::Emitter;
use turbid::rng::{Purpose, Stream};
use turbid::scene::{Camera, Orders, Scene};
use turbid::sensor::Streams;
use turbid::transport::{NoProgress, run_blocks};

/// Histories whose light is kept at once, before it is added to the picture: what they send to the camera fills some
/// hundred bytes each.
const AT_ONCE: u64 = 1 << 18;

/// Which layers of a reference are found by light tracing.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ByLight {
    /// These; none of them is emission.
    pub layers: &'static [Layer],
    /// Photons that are sent out for each sample a pixel of the paths, over the number of pixels times a thousand.
    pub permille: u64,
}

impl ByLight {
    /// Nothing: all by paths.
    pub const NOTHING: ByLight = ByLight { layers: &[], permille: 0 };

    /// Whether a layer is found by light.
    fn has(&self, layer: Layer) -> bool {
        self.layers.contains(&layer)
    }

    /// Who made the reference, in words.
    pub fn words(&self) -> &'static str {
        match self.layers {
            [] => "by paths",
            [Layer::Caustic] => "by paths, caustics that are seen straight by light tracing",
            [Layer::Caustic, Layer::Indirect] => {
                "by paths; caustic and indirect light that is seen straight by light tracing"
            }
            _ => "by light tracing",
        }
    }

    /// Whether all that is scattered is found by light.
    fn has_all(&self) -> bool {
        Layer::ALL.into_iter().all(|layer| layer == Layer::Emission || self.has(layer))
    }

    /// One sample of what paths have to find: all layers where a specular surface is seen, else those that light tracing
    /// leaves out.
    pub fn rest(&self, scene: &Scene, ray: Ray, within: usize, stream: &mut Stream) -> Layers {
        if self.layers.is_empty() || is_specular_ahead(scene, &ray) {
            return path::layers(scene, ray, None, within, stream).0;
        }
        // What is not scattered has order 0.
        let orders = if self.has_all() { Orders { min: 0, max: Some(0) } } else { Orders::ALL };
        let mut layers = Layers::ZERO;
        path::classes(scene, ray, None, within, orders, stream, |_, layer, value| {
            if !self.has(layer) {
                layers[layer] += value;
            }
        });
        layers
    }

    /// The layers that light tracing finds, by pixel.
    ///
    /// # Errors
    /// where a specular surface is seen through a medium whose light is asked for: paths and light would both count it
    pub fn trace(
        &self,
        scene: &Scene,
        camera: &Camera,
        samples: u64,
        streams: Streams,
    ) -> anyhow::Result<Vec<Layers>> {
        let mut film = vec![Layers::ZERO; camera.width() as usize * camera.height() as usize];
        let histories = samples * self.permille * film.len() as u64 / 1000;
        if self.layers.is_empty() || histories == 0 {
            return Ok(film);
        }
        self.check(scene, camera)?;
        // What arrives by specular surfaces alone was sent towards them; the rest may have been sent anywhere.
        match Emitter::towards_specular(scene).filter(|_| self.has(Layer::Caustic)) {
            Some(by_glass) => {
                send((scene, camera), &by_glass, 0..histories, streams, |l| l == Layer::Caustic, &mut film)?;
                if self.layers != [Layer::Caustic] {
                    let others = |layer| layer != Layer::Caustic && self.has(layer);
                    let next = histories..2 * histories;
                    send((scene, camera), &Emitter::by_power(scene), next, streams, others, &mut film)?;
                }
            }
            None => {
                let all = |layer| self.has(layer);
                send((scene, camera), &Emitter::by_power(scene), 0..histories, streams, all, &mut film)?;
            }
        }
        let share = Spectrum::grey(1.0 / histories as f64);
        film.iter_mut().for_each(|layers| *layers *= share);
        Ok(film)
    }

    /// Light of a medium before a specular surface belongs to light tracing, behind it to paths: a sample would have to be
    /// parted. No picture needs that.
    fn check(&self, scene: &Scene, camera: &Camera) -> anyhow::Result<()> {
        if !(self.has(Layer::Single) || self.has(Layer::Multiple)) {
            return Ok(());
        }
        let pixels = (0..camera.height()).flat_map(|y| (0..camera.width()).map(move |x| (x, y)));
        let seen = pixels.filter(|&(x, y)| {
            let ray = camera.ray(glam::DVec2::new(f64::from(x) + 0.5, f64::from(y) + 0.5));
            is_specular_ahead(scene, &ray)
        });
        ensure!(
            seen.count() == 0,
            "a specular surface is seen through a medium: its reference cannot be by light"
        );
        Ok(())
    }
}

/// Sends out the histories of these numbers, and adds what they bring to the layers that are wanted.
fn send(
    (scene, camera): (&Scene, &Camera),
    emitter: &Emitter,
    histories: Range<u64>,
    streams: Streams,
    is_wanted: impl Fn(Layer) -> bool + Sync,
    film: &mut [Layers],
) -> anyhow::Result<()> {
    for first in histories.clone().step_by(AT_ONCE as usize) {
        let block = |range: Range<u64>| {
            let mut splats: Vec<Splat> = Vec::new();
            for i in range {
                let mut stream =
                    Stream::new(streams.seed, Purpose::LightTracing, streams.replicate, first + i);
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
    /// is seen and by paths where the ball is, of what paths alone find, and with all that scatters by light.
    #[test]
    fn no_light_is_lost_or_counted_twice() {
        let file = SceneFile::from_toml(BALL).unwrap();
        let scene = file.scene(std::path::Path::new(".")).unwrap();
        let camera = scene.camera().unwrap();
        let within = scene.interior_at(camera.position());
        let pixels = u64::from(camera.width() * camera.height());
        let all = ByLight { layers: &[Layer::Direct, Layer::Caustic, Layer::Indirect], permille: 1000 };
        let one = |by_light: ByLight, replicate: u64| {
            const SAMPLES: u64 = 120;
            let streams = Streams { seed: 5, replicate };
            let mut sum = Layers::ZERO;
            for i in 0..SAMPLES * pixels {
                let mut stream = Stream::new(streams.seed, Purpose::Synthetic, replicate, i);
                let (x, y) = (i % pixels % 6, i % pixels / 6);
                let [u, v] = [x as f64 + stream.unit(), y as f64 + stream.unit()];
                sum += by_light.rest(&scene, camera.ray(glam::DVec2::new(u, v)), within, &mut stream);
            }
            sum *= 1.0 / SAMPLES as f64;
            by_light.trace(&scene, camera, SAMPLES, streams).unwrap().into_iter().for_each(|l| sum += l);
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
        let caustic = ByLight { layers: &[Layer::Caustic], permille: 1000 };
        let paths = moments(ByLight::NOTHING, 0);
        for (by_light, first) in [(caustic, 1000), (all, 2000)] {
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
