//! Whether light comes to an end: histories that look for rooms that keep it.
//!
//! Light in a closed room of white walls, of mirrors or of a medium that absorbs nothing is met again and again. Whether
//! what several bodies enclose has a way out cannot be read from a scene; histories find it out. They are run only where
//! so little is lost at an event that the number of events has no small bound.

use super::emit;
use crate::Spectrum;
use crate::error::{Error, Result};
use crate::geometry::Sphere;
use crate::light::PeriodicCell;
use crate::math::{Frame, Ray, warp};
use crate::medium::Medium;
use crate::rng::{Purpose, Stream};
use crate::scene::{Binned, Quantity, Scene, Target};
use crate::surface::Surface;
use crate::transport::{LONG, Roulette, Step, Visitor, Walker, walk};

/// Events of a history, in the mean, above which a scene is refused: 100,000 photons of so many events each take about three
/// minutes. From the middle of a layer that absorbs nothing they leave after 3/8 of its squared thickness, tau = 230.
pub const MOST_EVENTS: u64 = 20_000;

/// Histories from each place that light starts from or is looked for at. Where a fifteenth of them or more are kept for ever the mean is
/// too long; fewer cost a run their 300,000 events each, and end by roulette. Openings to a medium without end may be small.
const PILOTS: u64 = 4096;

/// Events of all pilots: a quarter of a second. Where histories are so long, fewer of them say how long.
const BUDGET: u64 = 2_000_000;

/// Look-ups in densities that take as long as an event: in a grid of voids one flight may take a hundred thousand.
const LOOK_UPS: u64 = 8;

/// Where at least this part is lost at every event, the mean is below its inverse.
const LOSS: f64 = 1e-3;

/// Thickness of all media together \[mean free paths\] below which light leaves a scene of little else soon: in a medium
/// without loss it is scattered as often as its square, about.
const THIN: f64 = 30.0;

/// Index of refraction above which light may be in a clear body for long: it leaves by a cone of 1/(2 n^2).
const HIGH_INDEX: f64 = 10.0;

/// Refuses a scene in which light does not come to an end, or hardly: where its histories have more than [`MOST_EVENTS`] events
/// in the mean. They start from every light, the camera, and every sensor; one of more than [`LONG`] counts as it is
/// followed, to the end by roulette.
///
/// Light caught in clear glass by total reflection is none of these: it is given up after some thousands of reflections.
/// What is asked is asked once a scene; the answer is a function of the scene alone.
///
/// Nor does it end in a medium without loss and without end, behind a surface that encloses nothing; there emission that
/// nothing absorbs has no end either.
///
/// # Errors
/// [`Error::Scene`], naming the light, and what keeps it
pub fn check_end(scene: &Scene) -> Result<()> {
    scene.once(|| if is_short(scene) { Ok(()) } else { probe(scene) })
}

/// Whether no history can be long, as far as the numbers of the scene's parts tell.
fn is_short(scene: &Scene) -> bool {
    let keeps_all = |kept: Spectrum| kept.max() > 1.0 - LOSS;
    let surfaces = scene.objects().iter().map(|o| &o.surface);
    let is_lossy = |surface: &Surface| match surface {
        Surface::Lambertian(_) | Surface::Mirror(_) => !keeps_all(surface.largest_reflectance()),
        // Light that goes straight on meets a filter once.
        Surface::Filter(_) | Surface::Black(_) => true,
        Surface::Dielectric(d) => {
            [d.inside(), d.outside()].iter().all(|i| scene.interiors()[*i].index < HIGH_INDEX)
        }
    };
    let first_filled = scene.regions().len();
    let fills = scene.media()[first_filled..].iter();
    let keeping = |keeps: bool, thickness: f64| if keeps { thickness } else { 0.0 };
    let thickness: f64 = scene
        .regions()
        .iter()
        .map(|r| {
            let mean_free_paths = r.shape.shortest_extent() * r.medium.highest_sigma_t().max();
            keeping(keeps_all(r.medium.matter().albedo()), mean_free_paths)
        })
        .sum();
    thickness < THIN
        && surfaces.into_iter().all(is_lossy)
        && fills.into_iter().all(|medium| !keeps_all(medium.matter().albedo()) && !emits_clear(medium))
}

/// Whether rays through a medium gather emission that nothing absorbs, in some channel: without end where the medium has
/// none. Light that escapes has passed a density that ends, but emission that does not follow the density does not end.
fn emits_clear(medium: &Medium) -> bool {
    let (sigma_t, everywhere) = (medium.matter().sigma_t(), medium.matter().emission());
    let (ends, emission) = match medium {
        Medium::Homogeneous(_) => (false, everywhere),
        Medium::Heterogeneous(medium) => (true, medium.emission_of(1.0)),
    };
    (0..3).any(|c| (emission[c] > 0.0 && sigma_t[c] == 0.0) || (ends && everywhere[c] > 0.0))
}

/// Where a history starts.
#[derive(Clone, Copy)]
enum Source {
    Light(usize),
    Camera,
    Sensor(usize),
}

impl Source {
    fn all(scene: &Scene) -> Vec<Source> {
        let lights = (0..scene.lights().len()).map(Source::Light);
        let camera = scene.camera().map(|_| Source::Camera);
        lights.chain(camera).chain((0..scene.sensors().len()).map(Source::Sensor)).collect()
    }

    /// A walker from here; none if nothing starts this time.
    fn start(self, scene: &Scene, stream: &mut Stream) -> Option<Walker> {
        let side = PeriodicCell::side(scene.periodic_cell());
        let ray = match self {
            Source::Light(index) => return emit::from_light(scene, index, stream),
            Source::Camera => {
                let camera = scene.camera()?;
                let (x, y) = (stream.index(camera.width() as usize), stream.index(camera.height() as usize));
                camera.sample(x as u32, y as u32, stream.pair())
            }
            Source::Sensor(index) => match &scene.sensors()[index].quantity {
                Quantity::Fluence(p) => Ray::new(*p, warp::square_to_sphere(stream.pair()).normalize()),
                Quantity::Radiance(ray) => *ray,
                Quantity::Outflow { shape, face } => {
                    let (position, normal, _) = shape.sample_boundary(*face, side, stream.triple());
                    let dir = Frame::new(-normal).to_world(warp::square_to_cosine_hemisphere(stream.pair()));
                    Ray::new(position, dir)
                }
                Quantity::Absorbed(number) => {
                    let shape = &scene.regions().get(*number)?.shape;
                    let (position, _) = shape.sample_inside(side, stream.triple());
                    Ray::new(position, warp::square_to_sphere(stream.pair()).normalize())
                }
                Quantity::Binned(binned) => {
                    let bin = stream.index(binned.bins());
                    let position = binned.point(bin, scene.periodic_cell(), stream.triple());
                    let anywhere = warp::square_to_sphere(stream.pair()).normalize();
                    Ray::new(
                        position,
                        if let Binned::Radiance { dir, .. } = binned { *dir } else { anywhere },
                    )
                }
            },
        };
        Some(Walker { interior: scene.interior_at(ray.origin), ..Walker::new(ray, Spectrum::ONE) })
    }

    fn name(self, scene: &Scene) -> String {
        match self {
            Source::Light(index) if index < scene.named_lights().len() => {
                format!("light from lights[{index}]")
            }
            Source::Light(_) => "light from a medium that emits".to_string(),
            Source::Camera => "light that the camera could see".to_string(),
            Source::Sensor(index) => {
                format!("light that sensor {} could measure", scene.sensors()[index].name)
            }
        }
    }
}

/// What a history meets.
struct Met<'a> {
    scene: &'a Scene,
    events: u64,
    objects: Vec<bool>,
    media: Vec<bool>,
    /// A medium without end from which light does not come back, or on whose way it gathers without end.
    endless: Option<(usize, &'static str)>,
}

/// Beyond so many radii of the scene light in a medium without loss comes back at most every second time, and not from the
/// next such distance.
const FAR: f64 = 2.0;

impl Visitor for Met<'_> {
    const LOOKS_AHEAD: bool = false;

    fn visit(&mut self, walker: &Walker, step: Step, _stream: &mut Stream) {
        match step {
            Step::Ahead(_) => self.events += 1,
            Step::Collision(arrival, number) => {
                self.media[number] = true;
                let fills = number >= self.scene.regions().len();
                let is_far = |ball: &Sphere| arrival.position.distance(ball.center()) > FAR * ball.radius();
                let keeps = self.scene.media()[number].matter().albedo().max() >= 1.0;
                if fills && keeps && self.scene.bounds().is_some_and(is_far) {
                    self.endless = Some((walker.interior, "absorbs nothing"));
                }
            }
            Step::Escaped(_) => {
                let filling = self.scene.filling(walker.interior);
                if filling.is_some_and(|number| emits_clear(&self.scene.media()[number])) {
                    self.endless = Some((walker.interior, "emits where nothing absorbs"));
                }
            }
            Step::Surface(_, found) => {
                if let Target::Object(index) = found.target {
                    self.objects[index] = true;
                }
            }
            _ => {}
        }
    }
}

impl Met<'_> {
    /// What it met, in words: the first ones of each kind.
    fn words(&self, scene: &Scene) -> String {
        const NAMED: usize = 6;
        let numbers = |met: &[bool]| -> Vec<usize> {
            met.iter().enumerate().filter_map(|(i, is_met)| is_met.then_some(i)).collect()
        };
        let (objects, media) = (numbers(&self.objects), numbers(&self.media));
        let regions = scene.regions().len();
        let medium = |i: &usize| {
            if *i < regions { format!("regions[{i}]") } else { "what fills an interior".to_string() }
        };
        let named = objects.iter().map(|i| format!("objects[{i}]")).chain(media.iter().map(medium));
        let mut words: Vec<String> = named.take(NAMED).collect();
        let more = objects.len() + media.len() - words.len();
        if more > 0 {
            words.push(format!("{more} more"));
        }
        if words.is_empty() { "nothing".to_string() } else { words.join(", ") }
    }
}

/// Runs the pilots, from all places by turns, until they have had their events. The first place whose histories are too long is
/// named: lights before those who look.
fn probe(scene: &Scene) -> Result<()> {
    let sources = Source::all(scene);
    let blank = || Met {
        scene,
        events: 0,
        objects: vec![false; scene.objects().len()],
        media: vec![false; scene.media().len()],
        endless: None,
    };
    let mut met: Vec<(u64, Met)> = sources.iter().map(|_| (0, blank())).collect();
    let turns = (0..PILOTS).flat_map(|pilot| (0..sources.len()).map(move |number| (pilot, number)));
    let mut all = 0;
    for (pilot, number) in turns {
        let mut stream = Stream::new(0, Purpose::Ends, number as u64, pilot);
        let (histories, met) = &mut met[number];
        *histories += 1;
        if let Some(start) = sources[number].start(scene, &mut stream) {
            let before = met.events;
            walk(scene, start, Roulette::Analog, None, &mut stream, met);
            all += met.events - before + stream.work.densities / LOOK_UPS;
        }
        if all > BUDGET || met.endless.is_some() {
            break;
        }
    }
    for (source, (histories, met)) in sources.iter().zip(&met) {
        if let Some((interior, what)) = met.endless {
            return Err(Error::Scene(format!(
                "{} does not end in interior {}, which no body encloses and whose medium {what}; allowed: a medium that absorbs, or bodies all around it",
                source.name(scene),
                scene.interiors()[interior].name
            )));
        }
        // One long history is no room that keeps light: in a thick medium without loss there are a few.
        let mean = met.events / (*histories).max(1);
        if mean > MOST_EVENTS {
            let found = match mean > u64::from(LONG) {
                true => format!("more than {LONG}"),
                false => mean.to_string(),
            };
            return Err(Error::Scene(format!(
                "{} hardly ever ends: {found} events a history in the mean between {}; allowed: {MOST_EVENTS} in the mean; let one of them absorb more, or leave an opening",
                source.name(scene),
                met.words(scene),
            )));
        }
    }
    Ok(())
}
