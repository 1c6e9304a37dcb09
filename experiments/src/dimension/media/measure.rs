//! Measuring one map of each kind: points, flights, planes, and as many photons in the maps of a debiased sum.

use super::cases::{CELLS, LOOKED_AT, Medium, Method, answer, filling, name, reading, sizes};
use crate::harness::{CellId, CellOutput, Group, Settings};
use crate::setups::levels::Schedule;
use turbid::Spectrum;
use turbid::estimators::boundary::{Boundary, Treatment};
use turbid::estimators::{
    BeamEstimator, Estimator, Gather, Kernel, PlaneEstimator, RayEstimate, RayEstimator,
};
use turbid::integrators::{March, StepRule, along};
use turbid::math::{Positive, Ray};
use turbid::photons::beams::BeamMap;
use turbid::photons::planes::PlaneMap;
use turbid::photons::{Emitter, Histories, Photon, PhotonMap, Run, Storage};
use turbid::rng::{Purpose, Stream};
use turbid::scene::Scene;
use turbid::transport::{NoProgress, Passage, Walker};

/// All cells.
pub fn groups(settings: &Settings) -> Vec<Group> {
    let mut groups = Vec::new();
    for medium in Medium::ALL {
        for photons in sizes(settings) {
            let measure = move |settings: &Settings, cell: &CellId| measure(settings, cell, medium, photons);
            // Some passes of each size, and rays that cost as much.
            let group = Group::new(medium.group(photons), CELLS, 10.0 * photons as f64, measure);
            groups.push(group.holding(8 * photons));
        }
    }
    groups
}

/// What a pass stores: what light that is scattered twice and more is read from.
struct Twice(Method);

impl Storage for Twice {
    fn in_medium(&self, _: u64, photon: &Photon) -> bool {
        self.0 == Method::Points && photon.order > 0
    }

    fn has_beams(&self) -> bool {
        self.0 == Method::Beams
    }

    fn on_flight(&self, _: u64, walker: &Walker) -> bool {
        walker.order > 0
    }

    fn has_planes(&self) -> bool {
        self.0 == Method::Planes
    }

    fn on_plane(&self, _: u64, _: &Walker) -> bool {
        true
    }
}

/// Passes of a cell, each with photons of its own, and the rays that ask.
struct Passes<'a> {
    medium: Medium,
    scene: &'a Scene,
    emitter: &'a Emitter,
    boundary: Boundary<'a>,
    rays: Vec<Ray>,
    reach: f64,
    seed: u64,
    stream: u64,
    made: u64,
    emitted: u64,
}

impl Passes<'_> {
    /// A pass of so many photons, none of which was in another one.
    fn fresh(&mut self, photons: u64, stored: Method) -> turbid::Result<turbid::photons::Pass> {
        // Cells are below 256, and passes below 2^16: no two of a group share a number.
        let replicate = self.stream ^ self.made << 8;
        self.made += 1;
        self.emitted += photons;
        let histories = Histories { count: photons, seed: self.seed, replicate, max_order: None };
        Run::new(self.scene, self.emitter, histories).pass(&Twice(stored), &NoProgress)
    }

    fn points(&mut self, photons: u64) -> anyhow::Result<PhotonMap> {
        Ok(self.fresh(photons, Method::Points)?.into_map(self.reach)?)
    }

    fn beams(&mut self, photons: u64) -> anyhow::Result<BeamMap> {
        Ok(self.fresh(photons, Method::Beams)?.into_beams()?)
    }

    fn planes(&mut self, photons: u64) -> anyhow::Result<PlaneMap> {
        Ok(self.fresh(photons, Method::Planes)?.into_planes()?)
    }

    /// What every ray finds, and how many records were looked at for it.
    fn each(&self, read: impl Fn(&Ray) -> (Spectrum, usize)) -> Vec<Found> {
        let found = |ray| {
            let (value, looked_at) = read(ray);
            Found { value: value[0], looked_at }
        };
        self.rays.iter().map(found).collect()
    }

    /// Balls a radius apart.
    fn in_balls(&self, map: &PhotonMap, radius: f64) -> anyhow::Result<Vec<Found>> {
        let medium = self.scene.medium(0);
        let treatment = if self.medium.is_clipped() { Treatment::Clipped } else { Treatment::None };
        let balls = Estimator::new(Kernel::Uniform, Gather::radius(radius)?).treated(treatment);
        let march = March::equal(Positive::new("the step", radius)?, StepRule::Integrated);
        let (phase, one) = (medium.phase(), Spectrum::ONE);
        Ok(self.each(|ray| {
            let mut looked_at = 0;
            let source = |place| {
                let found = balls.in_scattered(map, place, -ray.dir, phase, one, &self.boundary);
                looked_at += found.found;
                medium.albedo(place) * found.value
            };
            // Nothing is drawn.
            let mut stream = Stream::new(self.seed, Purpose::Synthetic, 0, 0);
            let span = self.medium.span();
            let value = along(medium, (ray, span), &march, span.end, &mut stream, source);
            (value, looked_at)
        }))
    }

    fn along_points(&self, map: &PhotonMap, radius: f64) -> anyhow::Result<Vec<Found>> {
        let radius = Positive::new("the radius", radius)?;
        let discs = RayEstimator { kernel: Kernel::Uniform, radius, is_clipped: self.medium.is_clipped() };
        let (medium, span) = (self.scene.medium(0), self.medium.span());
        Ok(self.each(|ray| {
            // Nothing is drawn.
            let mut stream = Stream::new(self.seed, Purpose::Synthetic, 0, 0);
            let passage = Passage::new(medium, ray, span, &mut stream);
            of(discs.radiance(map, (ray, span), medium, &self.boundary, &passage))
        }))
    }

    fn along_beams(&self, map: &BeamMap, radius: f64) -> anyhow::Result<Vec<Found>> {
        let radius = Positive::new("the radius", radius)?;
        let strips = BeamEstimator { kernel: Kernel::Uniform, radius, is_clipped: self.medium.is_clipped() };
        let (medium, span) = ((0, self.scene.medium(0)), self.medium.span());
        Ok(self.each(|ray| of(strips.radiance(map, (ray, span), medium, &self.boundary, &passed))))
    }

    fn along_planes(&self, map: &PlaneMap) -> Vec<Found> {
        let span = self.medium.span();
        self.each(|ray| of(PlaneEstimator.radiance(map, (ray, span), (self.scene, 0), &passed)))
    }
}

/// What a ray found.
#[derive(Clone, Copy, Default)]
struct Found {
    value: f64,
    looked_at: usize,
}

fn of(estimate: RayEstimate) -> (Spectrum, usize) {
    (estimate.value, estimate.found + estimate.rejected)
}

/// What passes along a length of a medium of extinction 1.
fn passed(length: f64) -> Spectrum {
    Spectrum::grey(libm::exp(-length))
}

/// Measures one cell: what each ray finds by each method at each radius.
fn measure(settings: &Settings, cell: &CellId, medium: Medium, photons: u64) -> anyhow::Result<CellOutput> {
    let scene = medium.setup().scene()?;
    let emitter = Emitter::by_power(&scene);
    let radii = medium.radii();
    let mut passes = Passes {
        medium,
        scene: &scene,
        emitter: &emitter,
        boundary: Boundary::of(&scene.regions()[0].shape)?,
        rays: medium.rays(),
        reach: radii[0],
        seed: settings.seed,
        stream: cell.stream("dimension"),
        made: 0,
        emitted: 0,
    };
    let mut output = CellOutput::new();
    let push = |output: &mut CellOutput, method: Method, radius: Option<f64>, found: Vec<Found>| {
        let case = name(medium, method, photons, radius);
        let looked_at = found.iter().map(|found| found.looked_at as f64).sum::<f64>() / found.len() as f64;
        for (ray, found) in found.into_iter().enumerate() {
            output.push(&case, answer(ray), found.value);
        }
        output.push(&case, LOOKED_AT, looked_at);
    };
    let points = output.time(&filling(Method::Points), |_| passes.points(photons))?;
    let beams = output.time(&filling(Method::Beams), |_| passes.beams(photons))?;
    for radius in radii {
        for method in Method::ALL.into_iter().filter(|method| method.has_radius()) {
            let values = output.time(&reading(method, Some(radius)), |_| match method {
                Method::Balls => passes.in_balls(&points, radius),
                Method::Points => passes.along_points(&points, radius),
                _ => passes.along_beams(&beams, radius),
            })?;
            push(&mut output, method, Some(radius), values);
        }
    }
    let planes = output.time(&filling(Method::Planes), |_| passes.planes(photons))?;
    let values = output.time(&reading(Method::Planes, None), |_| passes.along_planes(&planes));
    push(&mut output, Method::Planes, None, values);
    let values = debiased(&mut passes, photons, &mut output)?;
    push(&mut output, Method::Debiased, None, values);
    output.count("photons emitted", passes.emitted);
    Ok(output)
}

/// A telescoping sum over flights, of so many photons on average, whose first radius is the largest: each replicate is that estimate, and
/// the difference of a level that is drawn, over its chance.
fn debiased(passes: &mut Passes<'_>, photons: u64, output: &mut CellOutput) -> anyhow::Result<Vec<Found>> {
    let schedule = Schedule::of(1.0);
    let replicates = schedule.replicates(photons);
    let mut levels = Stream::new(passes.seed, Purpose::Synthetic, passes.stream, 0);
    let mut sum = vec![Found::default(); passes.rays.len()];
    let mut add = |found: Vec<Found>, factor: f64| {
        for (sum, found) in sum.iter_mut().zip(found) {
            sum.value += factor * found.value / replicates as f64;
            sum.looked_at += found.looked_at;
        }
    };
    for _ in 0..replicates {
        let level = schedule.level(levels.unit());
        let radius = |level: u32| passes.reach * libm::exp2(-f64::from(level));
        let (large, small) = (radius(level), radius(level + 1));
        let [first, own] = [schedule.first, schedule.photons(level)]
            .map(|photons| output.time(&filling(Method::Debiased), |_| passes.beams(photons)));
        let (first, own) = (first?, own?);
        let phase = reading(Method::Debiased, None);
        add(output.time(&phase, |_| passes.along_beams(&first, passes.reach))?, 1.0);
        let factor = 1.0 / schedule.chance(level);
        add(output.time(&phase, |_| passes.along_beams(&own, small))?, factor);
        add(output.time(&phase, |_| passes.along_beams(&own, large))?, -factor);
    }
    Ok(sum)
}
