//! Pictures by bidirectional paths: each sample is a path a pixel, and what as many photons as there are pixels send to the camera.

use super::film::Film;
use super::light::{LightCount, expose};
use super::render::{Streams, extend_pixels};
use crate::error::Result;
use crate::integrators::bidirectional::{Pinhole, check, seen, splats};
use crate::integrators::mapper::Report;
use crate::rng::{Purpose, Stream};
use crate::scene::{Camera, Scene};
use crate::transport::Progress;

/// Adds so many samples to each pixel of a film, and returns the work.
///
/// A film of n samples has the same bits however many calls brought them, and on any number of threads.
///
/// # Errors
/// those of [`check`] and of [`super::extend`]
pub(super) fn extend_bidirectionally(
    film: &mut Film,
    scene: &Scene,
    camera: &Camera,
    samples: u64,
    streams: Streams,
    progress: &dyn Progress,
) -> Result<Report> {
    check(scene)?;
    let pixels = u64::from(film.width()) * u64::from(film.height());
    let pinhole = Pinhole::new(camera, pixels);
    let interior = scene.interior_at(camera.position());
    let has_subpaths = scene.lights().iter().any(|light| !light.fills_space());
    let mut work = Report::default();
    for _ in 0..samples {
        let first = film.samples() * pixels;
        let mut sent = Film::new(film.width(), film.height());
        if has_subpaths {
            let count = expose(&mut sent, camera, (pixels, 1), progress, |history, splat| {
                let number = first + history;
                let mut stream = Stream::new(streams.seed, Purpose::LightTracing, streams.replicate, number);
                let rays = splats(scene, &pinhole, &mut stream, splat);
                LightCount { rays, work: stream.work }
            })?;
            work += Report { rays: count.rays, work: count.work, ..Report::default() };
        }
        work += extend_pixels(
            film,
            (camera, |x, y| (x, y)),
            1,
            streams,
            progress,
            |(x, y), ray, stream: &mut Stream, work: &mut Report| {
                let (layers, rays) = seen(scene, &pinhole, ray, interior, stream);
                *work += Report { rays, work: stream.work, ..Report::default() };
                layers + sent.pixel(x, y).layers()
            },
        )?;
    }
    Ok(work)
}
