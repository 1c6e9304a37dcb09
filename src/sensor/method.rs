//! Who makes a picture: photon maps, paths, bidirectional paths or light tracing, behind one call.

use super::bidirectional::extend_bidirectionally;
use super::film::{Film, Sample};
use super::light::{LightCount, extend_by_light};
use super::render::{Streams, extend};
use crate::error::Result;
use crate::integrators::mapper::{Mapper, Report};
use crate::integrators::{Guides, Layers, path};
use crate::photons::Guide;
use crate::rng::Stream;
use crate::scene::{Camera, Orders, Scene};
use crate::transport::Progress;

/// What makes pictures of a scene.
#[derive(Debug)]
pub enum Method<'a> {
    /// The photon mapper, with maps that are filled.
    Photons(Mapper<'a>),
    /// The unbiased path tracer.
    Paths(&'a Scene),
    /// The unbiased path tracer, led to where photons came from.
    Guided(&'a Scene, &'a Guide),
    /// The unbiased path tracer whose paths are connected to subpaths from the lights.
    Bidirectional(&'a Scene),
    /// The unbiased light tracer: what the camera sees straight or through filters of light that scatters last on a diffuse
    /// surface or in a medium.
    Light(&'a Scene),
}

impl<'a> Method<'a> {
    /// The path tracer, led by what photons told, if there is that.
    pub fn of_paths(scene: &'a Scene, guide: Option<&'a Guide>) -> Self {
        guide.map_or(Method::Paths(scene), |guide| Method::Guided(scene, guide))
    }

    /// A picture with so many samples per pixel.
    ///
    /// # Errors
    /// those of [`Method::extend`]
    pub fn render(
        &self,
        camera: &Camera,
        samples: u64,
        streams: Streams,
        progress: &dyn Progress,
    ) -> Result<Film> {
        let mut film = Film::new(camera.width(), camera.height());
        self.extend(&mut film, camera, samples, streams, progress)?;
        Ok(film)
    }

    /// Adds so many samples to each pixel of a film, and returns the work: of light tracing, histories a pixel and rays.
    ///
    /// A film of n samples has the same bits however many calls brought them, and on any number of threads.
    ///
    /// # Errors
    /// those of [`extend`], of [`extend_by_light`], of [`Mapper::check_radii`] and of `integrators::bidirectional::check`
    pub fn extend(
        &self,
        film: &mut Film,
        camera: &Camera,
        samples: u64,
        streams: Streams,
        progress: &dyn Progress,
    ) -> Result<Report> {
        match self {
            Method::Photons(mapper) => {
                mapper.check_radii()?;
                let interior = mapper.scene().interior_at(camera.position());
                extend(film, camera, samples, streams, progress, |ray, stream: &mut Stream, work| {
                    let (layers, report) = mapper.radiance(ray, None, interior, stream);
                    *work += report;
                    *work += Report { work: stream.work, ..Report::default() };
                    let photons = report.global.found + report.caustic.found + report.volume.found;
                    Sample { layers, photons: photons as f64 }
                })
            }
            Method::Paths(scene) => by_paths(film, scene, None, camera, samples, streams, progress),
            Method::Guided(scene, guide) => {
                by_paths(film, scene, Some(guide), camera, samples, streams, progress)
            }
            Method::Bidirectional(scene) => {
                extend_bidirectionally(film, scene, camera, samples, streams, progress)
            }
            Method::Light(scene) => {
                let LightCount { rays, work } =
                    extend_by_light(film, scene, camera, samples, streams, progress)?;
                Ok(Report { rays, work, ..Report::default() })
            }
        }
    }
}

/// By paths, guided or not.
fn by_paths(
    film: &mut Film,
    scene: &Scene,
    guide: Option<&Guide>,
    camera: &Camera,
    samples: u64,
    streams: Streams,
    progress: &dyn Progress,
) -> Result<Report> {
    let interior = scene.interior_at(camera.position());
    let guides = Guides { windows: None, learned: guide };
    extend(film, camera, samples, streams, progress, |ray, stream: &mut Stream, work| {
        let mut layers = Layers::ZERO;
        let collect = |_, layer, value| layers[layer] += value;
        let rays = path::guided_classes(scene, (ray, interior), Orders::ALL, guides, stream, collect);
        *work += Report { rays, work: stream.work, ..Report::default() };
        layers
    })
}
