//! Pictures by light tracing: what photons send to the camera, spread over its pixels.

use super::film::{Film, Sample};
use super::render::{MAX_SAMPLES, Streams};
use crate::Spectrum;
use crate::error::{Error, Result};
use crate::integrators::{Layers, Rays, Splat, light_tracing};
use crate::photons::{Emitter, check_end};
use crate::rng::{Purpose, Stream, Work};
use crate::scene::{Camera, Scene};
use crate::transport::{Progress, run_blocks_of};

/// Histories whose light waits in a list before it is spread over the pixels: enough that threads rarely wait, and at first so
/// few that long ones fit.
const CHUNKS: std::ops::RangeInclusive<u64> = 1 << 6..=1 << 18;
/// Histories of a block: threads share small chunks too.
const BLOCK: u64 = 8;
/// Splats that wait, about \[64 bytes each\]: later chunks are of as many histories as have brought so many.
const WAITING: u64 = 1 << 17;
/// Memory of light tracing beside its film \[bytes\], as an estimate from above: a chunk may bring four times as much as is
/// wanted, in lists that double.
pub const LIGHT_BYTES: f64 = 8.0 * 64.0 * WAITING as f64;
/// Memory of light tracing a pixel beside its film \[bytes\]: the sample that is being made.
pub const LIGHT_PIXEL_BYTES: f64 = 144.0;

/// What light tracing took.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct LightCount {
    /// Flights of photons, and connections to the camera.
    pub rays: Rays,
    /// Work that the scene may not require.
    pub work: Work,
}

/// A picture of light that scatters on diffuse surfaces and in media where the camera sees it straight or through filters,
/// from `films` independent films of `histories` photons each: means are those over films, variances those between them.
///
/// What the camera sees of lights themselves and by specular surfaces is not in it.
///
/// # Errors
/// `Error::Unreachable` for media that emit and have no end, and for unbounded slabs, whose photons are wrapped into a periodic cell;
/// `Error::NonFinite`; `Error::Cancelled`.
pub fn by_light(
    scene: &Scene,
    camera: &Camera,
    histories: u64,
    films: u64,
    streams: Streams,
    progress: &dyn Progress,
) -> Result<Film> {
    let mut film = Film::new(camera.width(), camera.height());
    trace(&mut film, scene, camera, (histories, films), streams, progress)?;
    Ok(film)
}

/// Adds so many samples to each pixel of a film by light tracing. A sample of a picture is a film of its own, of as many
/// histories as there are pixels, so that variances are those between such films.
///
/// A film of n samples has the same bits however many calls brought them, and on any number of threads.
///
/// # Errors
/// those of [`by_light`], and `Error::OutOfRange` above [`MAX_SAMPLES`]
pub fn extend_by_light(
    film: &mut Film,
    scene: &Scene,
    camera: &Camera,
    samples: u64,
    streams: Streams,
    progress: &dyn Progress,
) -> Result<LightCount> {
    let all = film.samples() + samples;
    if all > MAX_SAMPLES {
        return Err(Error::out_of_range("samples per pixel", all as f64, "at most 4294967295 in all"));
    }
    let pixels = u64::from(film.width()) * u64::from(film.height());
    trace(film, scene, camera, (pixels, samples), streams, progress)
}

/// What some histories brought: each splat with the number of its film.
#[derive(Default)]
struct Part {
    splats: Vec<(u64, Splat)>,
    count: LightCount,
}

impl Part {
    fn merged(mut self, other: Part) -> Part {
        self.splats.extend(other.splats);
        self.count += other.count;
        self
    }
}

impl std::ops::AddAssign for LightCount {
    fn add_assign(&mut self, other: LightCount) {
        self.rays.segments += other.rays.segments;
        self.rays.shadow += other.rays.shadow;
        self.work += other.work;
    }
}

fn trace(
    film: &mut Film,
    scene: &Scene,
    camera: &Camera,
    size: (u64, u64),
    streams: Streams,
    progress: &dyn Progress,
) -> Result<LightCount> {
    check(scene)?;
    check_end(scene)?;
    let emitter = Emitter::by_power(scene);
    expose(film, camera, size, progress, |history, splat| {
        let mut stream = Stream::new(streams.seed, Purpose::LightTracing, streams.replicate, history);
        let rays = light_tracing(scene, camera, &emitter, &mut stream, splat);
        LightCount { rays, work: stream.work }
    })
}

/// Counts so many films of `histories` photons as samples of a film, behind those that it has: `history` follows that of a number, and
/// hands over what it sends to the camera.
///
/// # Errors
/// `Error::NonFinite`; `Error::Cancelled`
pub(super) fn expose(
    film: &mut Film,
    camera: &Camera,
    (histories, films): (u64, u64),
    progress: &dyn Progress,
    follow: impl Fn(u64, &mut dyn FnMut(Splat)) -> LightCount + Sync,
) -> Result<LightCount> {
    let first = film.samples() * histories;
    let last = first + films * histories;
    let mut count = LightCount::default();
    let mut open = Open::new(film, camera, histories);
    let (mut start, mut chunk) = (first, *CHUNKS.start());
    while start < last {
        let end = last.min(start + chunk);
        let block = |range: std::ops::Range<u64>| {
            let mut part = Part::default();
            for history in range.start + start..range.end + start {
                let number = history / histories;
                part.count += follow(history, &mut |splat| part.splats.push((number, splat)));
            }
            part
        };
        let part = run_blocks_of(BLOCK, end - start, progress, block, Part::merged)?.unwrap_or_default();
        let non_finite = part.splats.iter().filter(|(_, splat)| !splat.value.is_finite()).count();
        if non_finite > 0 {
            return Err(Error::NonFinite { count: non_finite as u64, place: "light tracing" });
        }
        count += part.count;
        let most = WAITING * (end - start) / (part.splats.len() as u64).max(1);
        chunk = most.min(4 * chunk).clamp(*CHUNKS.start(), *CHUNKS.end());
        // In the order of histories, whatever the chunks.
        part.splats.into_iter().for_each(|(number, splat)| open.add(number, splat));
        start = end;
    }
    open.finish(last / histories);
    Ok(count)
}

/// Whether light tracing can follow all of the scene's light.
fn check(scene: &Scene) -> Result<()> {
    let refuse =
        |what: &str| Err(Error::Unreachable(format!("light tracing cannot sample {what}: use paths")));
    if scene.periodic_cell().is_some() {
        return refuse("an unbounded slab");
    }
    scene.check_emission()
}

/// The film that is being exposed: sums of one sample, which is counted when the next one begins.
struct Open<'a> {
    film: &'a mut Film,
    camera: &'a Camera,
    share: Spectrum,
    sums: Vec<Layers>,
}

impl<'a> Open<'a> {
    fn new(film: &'a mut Film, camera: &'a Camera, histories: u64) -> Self {
        let sums = vec![Layers::ZERO; film.pixels().len()];
        Open { film, camera, share: Spectrum::grey(1.0 / histories as f64), sums }
    }

    /// Spreads light of the sample of this number over the pixels.
    fn add(&mut self, number: u64, Splat { at, layer, value }: Splat) {
        self.finish(number);
        for (pixel, density) in self.camera.pixels(at) {
            self.sums[pixel][layer] += value * density;
        }
    }

    /// Counts samples until there are so many.
    fn finish(&mut self, samples: u64) {
        while self.film.samples() < samples {
            let width = self.film.width() as usize;
            for (index, sum) in self.sums.iter_mut().enumerate() {
                let (x, y) = ((index % width) as u32, (index / width) as u32);
                self.film.pixel_mut(x, y).push(&Sample::from(*sum * self.share));
                *sum = Layers::ZERO;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::light::{Light, Point};
    use crate::scene::{Filter, Object, SceneParts, View};
    use crate::surface::{Lambertian, Surface};
    use crate::transport::NoProgress;
    use glam::DVec3;

    /// A film of n samples is the same in one call and in three, on one thread and on two.
    #[test]
    fn the_same_bits_on_any_number_of_threads_and_in_any_number_of_passes() {
        let floor =
            crate::geometry::Rectangle::new(DVec3::splat(-1.0), DVec3::X * 2.0, DVec3::Y * 2.0).unwrap();
        let diffuse = Surface::Lambertian(Lambertian::new(Spectrum::grey(0.5)).unwrap());
        let light = Light::Point(Point::new(DVec3::ZERO, Spectrum::ONE).unwrap());
        let objects = vec![Object { shape: crate::geometry::Shape::Rectangle(floor), surface: diffuse }];
        let scene = Scene::new(SceneParts { objects, lights: vec![light], ..SceneParts::default() }).unwrap();
        let (position, look_at, up) = (DVec3::new(0.0, 0.0, 2.0), DVec3::ZERO, DVec3::Y);
        let view = View { position, look_at, up, fov: 40.0, width: 9, height: 7, filter: Filter::Tent };
        let camera = Camera::new(view).unwrap();
        let streams = Streams { seed: 3, replicate: 1 };
        let in_calls = |threads: usize, calls: &[u64]| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let mut film = Film::new(9, 7);
            pool.install(|| {
                for samples in calls {
                    extend_by_light(&mut film, &scene, &camera, *samples, streams, &NoProgress).unwrap();
                }
            });
            film
        };
        let whole = in_calls(2, &[200]);
        assert_eq!(whole.samples(), 200);
        assert!(whole == in_calls(1, &[1, 150, 49]));
        assert!(whole == by_light(&scene, &camera, 63, 200, streams, &NoProgress).unwrap());
        assert!(whole.pixel(4, 3).layers().direct[0] > 0.0 && whole.pixel(4, 3).variance().unwrap()[0] > 0.0);
    }
}
