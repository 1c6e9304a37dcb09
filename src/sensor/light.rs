//! Pictures by light tracing: what photons send to the camera, spread over its pixels.

use super::film::{Film, Sample};
use super::render::Streams;
use crate::Spectrum;
use crate::error::{Error, Result};
use crate::integrators::{Layers, Splat, light_tracing};
use crate::photons::Emitter;
use crate::rng::{Purpose, Stream};
use crate::scene::{Camera, Scene};
use crate::transport::{Progress, run_blocks};

/// A picture of light that scatters on matt surfaces and in media where the camera sees it straight or through filters,
/// from `films` independent films of `histories` photons each: means are those over films, variances those between them.
///
/// What the camera sees of lights themselves and by specular surfaces is not in it.
///
/// # Errors
/// `Error::Unreachable` for media that emit and have no end, and for unbounded slabs, whose photons are folded into a cell;
/// `Error::NonFinite`; `Error::Cancelled`.
pub fn by_light(
    scene: &Scene,
    camera: &Camera,
    histories: u64,
    films: u64,
    streams: Streams,
    progress: &dyn Progress,
) -> Result<Film> {
    let refuse =
        |what: &str| Err(Error::Unreachable(format!("light tracing cannot sample {what}: use paths")));
    if scene.stage().is_some() {
        return refuse("an unbounded slab");
    }
    scene.check_emission()?;
    let emitter = Emitter::by_power(scene);
    let (width, height) = (camera.width() as usize, camera.height() as usize);
    let mut film = Film::new(camera.width(), camera.height());
    for number in 0..films {
        let block = |range: std::ops::Range<u64>| {
            let mut splats: Vec<Splat> = Vec::new();
            for i in range {
                let history = number * histories + i;
                let mut stream = Stream::new(streams.seed, Purpose::LightTracing, streams.replicate, history);
                light_tracing(scene, camera, &emitter, &mut stream, |splat| splats.push(splat));
            }
            splats
        };
        let merge = |mut a: Vec<Splat>, b: Vec<Splat>| {
            a.extend(b);
            a
        };
        let splats = run_blocks(histories, progress, block, merge)?.unwrap_or_default();
        let non_finite = splats.iter().filter(|splat| !splat.value.is_finite()).count();
        if non_finite > 0 {
            return Err(Error::NonFinite { count: non_finite as u64, place: "light tracing" });
        }
        let mut sums = vec![Layers::ZERO; width * height];
        for Splat { at, layer, value } in splats {
            for (x, wide) in camera.filter().pixels(at.x) {
                for (y, high) in camera.filter().pixels(at.y) {
                    let is_inside = (0..width as i64).contains(&x) && (0..height as i64).contains(&y);
                    if is_inside && wide * high > 0.0 {
                        sums[y as usize * width + x as usize][layer] += value * (wide * high);
                    }
                }
            }
        }
        let share = Spectrum::grey(1.0 / histories as f64);
        for (index, sum) in sums.into_iter().enumerate() {
            let (x, y) = ((index % width) as u32, (index / width) as u32);
            film.pixel_mut(x, y).push(&Sample::from(sum * share));
        }
    }
    Ok(film)
}
