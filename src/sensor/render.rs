//! Rendering: a camera's pixels filled with samples, tile by tile, each sample with a random stream of its own.

use super::film::{Film, Pixel, Sample};
use crate::error::{Error, Result};
use crate::math::Ray;
use crate::rng::{Purpose, Stream};
use crate::scene::Camera;
use crate::transport::Progress;
use rayon::prelude::*;
use std::ops::{AddAssign, Range};

/// Side of a tile in pixels: large enough that threads rarely wait for the last one, small enough that the rays of a
/// tile meet the same photons.
const TILE: u32 = 16;

/// Most samples per pixel: the sample's number takes the lower half of its history's number, the pixel's the upper one.
pub const MAX_SAMPLES: u64 = u32::MAX as u64;

/// Which random streams a picture uses.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Streams {
    /// Seed of the whole computation.
    pub seed: u64,
    /// Which independent repetition.
    pub replicate: u64,
}

/// Adds so many samples to each pixel of a film, and returns what `sample` counted.
///
/// A film of n samples has the same bits however many calls brought them, and on any number of threads. Counts are
/// added tile by tile, in order; within a call only. After an error the film is of no use.
///
/// # Errors
/// `Error::NonFinite` if a sample was not finite; `Error::OutOfRange` above [`MAX_SAMPLES`]; `Error::Cancelled`.
pub fn extend<S: Into<Sample>, W: Default + AddAssign + Send>(
    film: &mut Film,
    camera: &Camera,
    samples: u64,
    streams: Streams,
    progress: &dyn Progress,
    sample: impl Fn(Ray, &mut Stream, &mut W) -> S + Sync,
) -> Result<W> {
    extend_at(film, (camera, |x, y| (x, y)), samples, streams, progress, sample)
}

/// The same for a film whose pixels are some of the camera's.
///
/// # Arguments
/// `place` of each pixel of the film in the camera's picture
///
/// # Errors
/// those of [`extend`]
pub(super) fn extend_at<S: Into<Sample>, W: Default + AddAssign + Send>(
    film: &mut Film,
    (camera, place): (&Camera, impl Fn(u32, u32) -> (u32, u32) + Sync),
    samples: u64,
    streams: Streams,
    progress: &dyn Progress,
    sample: impl Fn(Ray, &mut Stream, &mut W) -> S + Sync,
) -> Result<W> {
    let sample = |_: (u32, u32), ray: Ray, stream: &mut Stream, count: &mut W| sample(ray, stream, count);
    extend_pixels(film, (camera, place), samples, streams, progress, sample)
}

/// The same where `sample` is told its pixel of the film.
///
/// # Errors
/// those of [`extend`]
pub(super) fn extend_pixels<S: Into<Sample>, W: Default + AddAssign + Send>(
    film: &mut Film,
    (camera, place): (&Camera, impl Fn(u32, u32) -> (u32, u32) + Sync),
    samples: u64,
    streams: Streams,
    progress: &dyn Progress,
    sample: impl Fn((u32, u32), Ray, &mut Stream, &mut W) -> S + Sync,
) -> Result<W> {
    let first = film.samples();
    if first + samples > MAX_SAMPLES {
        return Err(Error::out_of_range(
            "samples per pixel",
            (first + samples) as f64,
            "at most 4294967295 in all",
        ));
    }
    let (width, height) = (film.width(), film.height());
    let filled = |band: &[Pixel], top: u32, tile: &Tile| {
        if progress.is_cancelled() {
            return Err(Error::Cancelled);
        }
        let mut done = Done { pixels: Vec::with_capacity(tile.count()), count: W::default(), non_finite: 0 };
        for (x, y) in tile.places() {
            let mut pixel = band[((y - top) * width + x) as usize];
            let number = u64::from(y) * u64::from(width) + u64::from(x);
            for i in first..first + samples {
                let mut stream =
                    Stream::new(streams.seed, Purpose::Paths, streams.replicate, number << 32 | i);
                let (column, row) = place(x, y);
                let ray = camera.sample(column, row, stream.pair());
                let value: Sample = sample((x, y), ray, &mut stream, &mut done.count).into();
                done.non_finite += u64::from(!value.layers.is_finite());
                pixel.push(&value);
            }
            done.pixels.push(pixel);
        }
        progress.advance(samples * tile.count() as u64);
        Ok(done)
    };
    // Band by band, so that beside the film there are never more new pixels than those of a band a thread.
    let bands = film.pixels_mut().par_chunks_mut((TILE * width) as usize).enumerate();
    let counted = bands.map(|(band, pixels)| {
        let top = band as u32 * TILE;
        let tiles = tiles(width, top..height.min(top + TILE));
        let done =
            tiles.par_iter().map(|tile| filled(pixels, top, tile)).collect::<Result<Vec<Done<W>>>>()?;
        let mut counts = Vec::with_capacity(tiles.len());
        for (tile, part) in tiles.iter().zip(done) {
            for ((x, y), pixel) in tile.places().zip(part.pixels) {
                pixels[((y - top) * width + x) as usize] = pixel;
            }
            counts.push((part.count, part.non_finite));
        }
        Ok(counts)
    });
    let (mut count, mut non_finite) = (W::default(), 0);
    for (part, bad) in counted.collect::<Result<Vec<_>>>()?.into_iter().flatten() {
        count += part;
        non_finite += bad;
    }
    if non_finite > 0 {
        return Err(Error::NonFinite { count: non_finite, place: "samples of a picture" });
    }
    Ok(count)
}

/// What filling a tile brought.
struct Done<W> {
    pixels: Vec<Pixel>,
    count: W,
    non_finite: u64,
}

/// A rectangle of pixels, its ends not included.
struct Tile {
    x: (u32, u32),
    y: (u32, u32),
}

impl Tile {
    fn count(&self) -> usize {
        ((self.x.1 - self.x.0) * (self.y.1 - self.y.0)) as usize
    }

    fn places(&self) -> impl Iterator<Item = (u32, u32)> + '_ {
        (self.y.0..self.y.1).flat_map(|y| (self.x.0..self.x.1).map(move |x| (x, y)))
    }
}

/// The tiles of a band of rows, not higher than a tile.
fn tiles(width: u32, rows: Range<u32>) -> Vec<Tile> {
    let columns = (0..width.div_ceil(TILE)).map(|i| (i * TILE, ((i + 1) * TILE).min(width)));
    columns.map(|x| Tile { x, y: (rows.start, rows.end) }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Spectrum;
    use crate::integrators::Layers;
    use crate::scene::{Filter, View};
    use crate::transport::NoProgress;
    use glam::{DVec2, DVec3};

    fn camera(width: u32, height: u32) -> Camera {
        let (position, look_at, up) = (DVec3::ZERO, DVec3::Z, DVec3::Y);
        Camera::new(View { position, look_at, up, fov: 60.0, width, height, filter: Filter::Box }).unwrap()
    }

    const STREAMS: Streams = Streams { seed: 3, replicate: 1 };

    /// Nothing to count.
    #[derive(Default)]
    struct Nothing;

    impl AddAssign for Nothing {
        fn add_assign(&mut self, _other: Nothing) {}
    }

    fn render(
        camera: &Camera,
        samples: u64,
        streams: Streams,
        progress: &dyn Progress,
        sample: impl Fn(Ray, &mut Stream) -> Layers + Sync,
    ) -> Result<Film> {
        let mut film = Film::new(camera.width(), camera.height());
        extend(&mut film, camera, samples, streams, progress, |ray, stream, _: &mut Nothing| {
            sample(ray, stream)
        })?;
        Ok(film)
    }

    fn noisy(ray: Ray, stream: &mut Stream) -> Layers {
        Layers { direct: Spectrum::grey(ray.dir.x + stream.unit()), ..Layers::ZERO }
    }

    /// A sphere of radiance 1 all around fills every pixel with 1, exactly, and with no variance.
    #[test]
    fn a_furnace_is_uniform() {
        let inside = Layers { emission: Spectrum::ONE, ..Layers::ZERO };
        let film = render(&camera(33, 17), 5, STREAMS, &NoProgress, |_, _| inside).unwrap();
        assert!(film.pixels().iter().all(|p| p.n() == 5 && p.total() == Spectrum::ONE));
        assert!(film.pixels().iter().all(|p| p.variance() == Some(Spectrum::ZERO)));
    }

    #[test]
    fn rays_belong_to_their_pixels() {
        let camera = camera(37, 18);
        let film = render(&camera, 3, STREAMS, &NoProgress, |ray, _| {
            let (x, y) = camera.pixel(ray.at(1.0)).unwrap();
            let place = Spectrum::rgb(f64::from(x), f64::from(y), 0.0);
            Layers { emission: place, ..Layers::ZERO }
        })
        .unwrap();
        for y in 0..18 {
            for x in 0..37 {
                assert_eq!(film.pixel(x, y).total(), Spectrum::rgb(f64::from(x), f64::from(y), 0.0));
            }
        }
    }

    #[test]
    fn the_same_bits_on_any_number_of_threads_and_in_any_number_of_passes() {
        let camera = camera(40, 20);
        let on = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| render(&camera, 6, STREAMS, &NoProgress, noisy).unwrap())
        };
        let one = on(1);
        assert!(one == on(2));
        let mut film = Film::new(40, 20);
        for samples in [1, 3, 2] {
            extend(&mut film, &camera, samples, STREAMS, &NoProgress, |r, s, _: &mut Nothing| noisy(r, s))
                .unwrap();
        }
        assert!(film == one);
        let other = Streams { replicate: 2, ..STREAMS };
        assert!(render(&camera, 6, other, &NoProgress, noisy).unwrap() != one);
    }

    #[test]
    fn counts_are_added_up_and_the_non_finite_fail_the_run() {
        let camera = camera(20, 17);
        let mut film = Film::new(20, 17);
        let count = extend(&mut film, &camera, 2, STREAMS, &NoProgress, |r, s, n: &mut u64| {
            *n += 1;
            noisy(r, s)
        });
        assert_eq!(count, Ok(2 * 20 * 17));
        let middle = camera.ray(DVec2::new(10.0, 8.5)).dir;
        let broken = render(&camera, 1, STREAMS, &NoProgress, |ray, _| {
            let is_near = ray.dir.dot(middle) > 0.9999;
            let value = if is_near { f64::NAN } else { 0.0 };
            Layers { indirect: Spectrum::rgb(0.0, value, 0.0), ..Layers::ZERO }
        });
        let Err(Error::NonFinite { count, place }) = broken else { panic!("{broken:?}") };
        assert!(count > 0 && place == "samples of a picture");
        struct Stopped;
        impl Progress for Stopped {
            fn advance(&self, _: u64) {}
            fn is_cancelled(&self) -> bool {
                true
            }
        }
        assert_eq!(render(&camera, 1, STREAMS, &Stopped, noisy), Err(Error::Cancelled));
    }
}
