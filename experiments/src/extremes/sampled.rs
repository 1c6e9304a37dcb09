//! Sampled rows: a mean over independent batches of histories, against an exact value.

use super::cases::Class;
use super::half_space::{half_space_reflectance, thick_white_transmittance};
use super::scenes::{Flux, Fog, at_depth, beam_along, furnace_ball, furnace_slab, sensor, slab};
use crate::harness::{CellId, Settings, Unit};
use glam::DVec3;
use std::sync::{Arc, OnceLock};
use turbid::Spectrum;
use turbid::error::Error;
use turbid::estimators::boundary::Boundary;
use turbid::estimators::{Estimator, Gather, Kernel};
use turbid::math::{FOUR_PI, Ray};
use turbid::photons::{Histories, Pass, Photon, shoot};
use turbid::rng::{Purpose, Stream};
use turbid::scene::{Orders, Quantity, Scene};
use turbid::transport::NoProgress;
use turbid_analytic::beer_lambert::direct_transmittance;
use turbid_analytic::slab_single::single_fluence;
use turbid_analytic::{AnisotropicSlab, Incidence, IsotropicSlab, Value};

/// A computed number and the bound on its error.
type Bounded = (f64, f64);

/// A normal beam.
const NORMAL: Incidence = Incidence::Beam { mu0: 1.0 };

/// One batch of histories of one row.
pub struct Batch {
    /// Histories to run.
    pub histories: u64,
    /// Seed of the study.
    pub seed: u64,
    /// Word of the random streams.
    pub replicate: u64,
}

/// What a batch brought.
#[derive(Debug, Clone, Copy, Default)]
pub struct Brought {
    /// The number that the row is about.
    pub value: f64,
    /// Contributions that were not finite.
    pub non_finite: u64,
}

/// Runs a batch.
type Run = Box<dyn Fn(&Batch) -> anyhow::Result<Brought> + Send + Sync>;

/// One row. Its name goes into its random streams: a row renamed is a row drawn anew.
pub struct Sampled {
    /// What it is about.
    pub class: Class,
    /// Its case, unique.
    pub name: String,
    /// Histories a batch, by preset.
    histories: (u64, u64),
    /// The exact value with its bound.
    pub exact: Box<dyn Fn() -> anyhow::Result<Bounded> + Send + Sync>,
    /// Where the exact value comes from.
    pub source: &'static str,
    /// Runs a batch.
    run: Run,
}

impl Sampled {
    /// Histories a batch.
    pub fn histories(&self, settings: &Settings) -> u64 {
        settings.photons(self.histories.0, self.histories.1)
    }

    /// The unit of its value.
    pub fn unit(&self) -> Unit {
        let is_fluence = ["fluence", "radiance"].iter().any(|word| self.name.contains(word));
        if is_fluence { Unit::FLUENCE } else { Unit::ONE }
    }

    /// Measures one batch; every row has streams of its own.
    pub fn measure(&self, settings: &Settings, batch: u64) -> anyhow::Result<Brought> {
        let replicate = CellId::of(&self.name, batch).stream("extremes");
        (self.run)(&Batch { histories: self.histories(settings), seed: settings.seed, replicate })
    }
}

/// All rows.
pub fn all() -> Vec<Sampled> {
    let mut rows = Rows(Vec::new());
    thickness(&mut rows);
    albedo(&mut rows);
    asymmetry(&mut rows);
    position(&mut rows);
    number(&mut rows);
    faces(&mut rows);
    ordinary(&mut rows);
    rows.0
}

/// Asymmetries below this change a flux by less than its own bound: by a part of g, and g here is 1e-12.
const ISOTROPIC: f64 = 1e-11;
/// Few collisions a history; full runs take sixteen times as many.
const LIGHT: (u64, u64) = (4096, 65_536);
/// As many as show a tenth of a per cent in a flux: 8 million, over all batches.
const SHARP: (u64, u64) = (1 << 17, 1 << 18);

struct Rows(Vec<Sampled>);

impl Rows {
    fn add(
        &mut self,
        class: Class,
        name: impl Into<String>,
        histories: (u64, u64),
        source: &'static str,
        exact: impl Fn() -> anyhow::Result<Bounded> + Send + Sync + 'static,
        run: impl Fn(&Batch) -> anyhow::Result<Brought> + Send + Sync + 'static,
    ) {
        let (exact, run) = (Box::new(exact), Box::new(run));
        self.0.push(Sampled { class, name: name.into(), histories, exact, source, run });
    }

    /// Fluxes of a slab by photons; the exact slab is solved once for all of them.
    fn fluxes(&mut self, class: Class, fog: Fog, incidence: Incidence, fluxes: &[Flux]) {
        self.fluxes_by(LIGHT, class, fog, incidence, fluxes);
    }

    fn fluxes_by(
        &mut self,
        histories: (u64, u64),
        class: Class,
        fog: Fog,
        incidence: Incidence,
        fluxes: &[Flux],
    ) {
        let source = if fog.g.abs() < ISOTROPIC { "isotropic slab" } else { "anisotropic slab" };
        let solved: Arc<OnceLock<[Bounded; 3]>> = Arc::default();
        for &flux in fluxes {
            let name = format!("{} {flux:?}", words(fog, incidence)).to_lowercase();
            let solved = solved.clone();
            let exact = move || match solved.get() {
                Some(all) => Ok(all[flux as usize]),
                None => {
                    let all = exact_fluxes(fog, incidence)?;
                    Ok(solved.get_or_init(|| all)[flux as usize])
                }
            };
            self.add(class, name, histories, source, exact, move |batch| {
                by_photons(fog, incidence, flux, batch)
            });
        }
    }
}

fn words(fog: Fog, incidence: Incidence) -> String {
    let Fog { tau, albedo, g } = fog;
    let short = |x: f64| if x.abs() > 1e3 { format!("{x:e}") } else { near_one(x) };
    let light = match incidence {
        Incidence::Beam { mu0: 1.0 } => String::new(),
        Incidence::Beam { mu0 } => format!(" mu0={}", short(mu0)),
        Incidence::Diffuse => " diffuse".to_string(),
    };
    format!("tau={} w={} g={}{light}", short(tau), near_one(albedo), short(g))
}

/// A number as one writes it: 1-1e-9, not 0.999999999.
pub fn near_one(x: f64) -> String {
    let rest = 1.0 - x.abs();
    let sign = if x < 0.0 { "-" } else { "" };
    if rest > 0.0 && rest < 0.5e-4 {
        format!("{sign}(1-{:e})", libm::exp10(libm::log10(rest).round()))
    } else if x != 0.0 && x.abs() < 1e-3 {
        format!("{x:e}")
    } else {
        format!("{x}")
    }
}

fn known(value: Value) -> Bounded {
    (value.value, value.error)
}

/// Reflected, transmitted, absorbed, in the order of [`Flux`].
fn exact_fluxes(fog: Fog, incidence: Incidence) -> anyhow::Result<[Bounded; 3]> {
    let Fog { tau, albedo, g } = fog;
    Ok(if g.abs() < ISOTROPIC {
        let slab = IsotropicSlab::new(tau, albedo, incidence)?;
        [slab.reflectance(), slab.transmittance(), slab.absorptance()].map(known)
    } else {
        let slab = AnisotropicSlab::new(tau, albedo, g, incidence)?;
        [slab.reflectance(), slab.transmittance(), slab.absorptance()].map(known)
    })
}

/// Runs photons; a pass that met something not finite says how often.
fn pass(
    scene: &Scene,
    batch: &Batch,
    flux: Option<(Flux, Orders)>,
    keep: impl Fn(&Photon) -> bool + Sync,
) -> anyhow::Result<(Pass, u64)> {
    let sensors: Vec<_> = flux.iter().map(|(flux, orders)| sensor(scene, *flux, *orders)).collect();
    let max_order = flux.and_then(|(_, orders)| orders.max);
    let histories =
        Histories { count: batch.histories, seed: batch.seed, replicate: batch.replicate, max_order };
    match shoot(scene, histories, &sensors, keep, &NoProgress) {
        Ok(pass) => Ok((pass, 0)),
        Err(Error::NonFinite { count, .. }) => Ok((Pass::default(), count)),
        Err(error) => Err(error.into()),
    }
}

fn tally(scene: &Scene, batch: &Batch, flux: Flux, orders: Orders) -> anyhow::Result<Brought> {
    let (pass, non_finite) = pass(scene, batch, Some((flux, orders)), |_| false)?;
    Ok(Brought { value: pass.tallies.first().map_or(0.0, |t| t[0].mean()), non_finite })
}

fn by_photons(fog: Fog, incidence: Incidence, flux: Flux, batch: &Batch) -> anyhow::Result<Brought> {
    tally(&slab(fog, incidence, 1.0)?, batch, flux, Orders::ALL)
}

fn by_paths(scene: &Scene, point: DVec3, orders: Orders, batch: &Batch) -> Brought {
    paths(scene, &Quantity::Fluence(point), orders, batch)
}

fn paths(scene: &Scene, quantity: &Quantity, orders: Orders, batch: &Batch) -> Brought {
    let (mut sum, mut non_finite) = (0.0, 0);
    for history in 0..batch.histories {
        let mut stream = Stream::new(batch.seed, Purpose::Paths, batch.replicate, history);
        let value = turbid::sensor::sample(scene, quantity, orders, &mut stream);
        non_finite += u64::from(!value.is_finite());
        sum += value[0];
    }
    Brought { value: sum / batch.histories as f64, non_finite }
}

/// Fluence at a point from a map of all photons, within a radius.
fn by_map(scene: &Scene, point: DVec3, radius: f64, batch: &Batch) -> anyhow::Result<Brought> {
    let (pass, non_finite) = pass(scene, batch, None, |_| true)?;
    let map = pass.into_map(0.0)?;
    let estimator = Estimator::new(Kernel::Uniform, Gather::radius(radius)?);
    let estimate = estimator.fluence(&map, point, Spectrum::ONE, &Boundary::UNKNOWN);
    let non_finite = non_finite + u64::from(!estimate.value.is_finite());
    Ok(Brought { value: estimate.value[0], non_finite })
}

fn collisions(scene: &Scene, batch: &Batch) -> anyhow::Result<Brought> {
    let (pass, non_finite) = pass(scene, batch, None, |_| false)?;
    Ok(Brought { value: pass.report.collisions as f64 / batch.histories as f64, non_finite })
}

fn thickness(rows: &mut Rows) {
    let class = Class::Thickness;
    let fog = |tau: f64, albedo: f64| Fog { tau, albedo, g: 0.0 };
    for tau in [1e-12, 1e-9, 1e-6, 1e-3] {
        rows.fluxes(class, fog(tau, 0.9), NORMAL, &[Flux::Reflected]);
    }
    // Through the thin slab goes all but what it takes: 1 - T would be lost to rounding, what it absorbs is not.
    rows.fluxes(class, fog(1e-12, 0.5), Incidence::Beam { mu0: 0.5 }, &[Flux::Absorbed]);
    rows.fluxes(class, fog(1.0, 0.9), NORMAL, &[Flux::Reflected, Flux::Transmitted]);
    let white = "thick slab without absorption";
    for (tau, histories) in [(100.0, (1024, 8192)), (300.0, (512, 8192))] {
        let name = format!("tau={tau} w=1 g=0 transmitted");
        let exact = move || thick_white_transmittance(1.0, tau);
        rows.add(class, name, histories, white, exact, move |batch| {
            by_photons(fog(tau, 1.0), NORMAL, Flux::Transmitted, batch)
        });
    }
    for tau in [1e4, 1e6] {
        let name = format!("tau={tau:e} w=0.9 g=0 reflected");
        let exact = || half_space_reflectance(1.0, 0.9);
        rows.add(class, name, LIGHT, "half-space", exact, move |batch| {
            by_photons(fog(tau, 0.9), NORMAL, Flux::Reflected, batch)
        });
    }
    // Without absorption the walk would take 1e12 steps; its first 32 orders are those of a slab that 32 steps
    // cannot cross and come back from: the chance is below e^-60.
    let orders = Orders { min: 0, max: Some(32) };
    let exact = || {
        let slab = IsotropicSlab::new(60.0, 1.0, NORMAL)?;
        let mut sum = (0.0, 0.0);
        for order in 1..=32 {
            let term = slab.reflectance_of_order(order)?;
            sum = (sum.0 + term.value, sum.1 + term.error);
        }
        Ok(sum)
    };
    rows.add(
        class,
        "tau=1e6 w=1 g=0 reflected, orders to 32",
        LIGHT,
        "orders of a slab",
        exact,
        move |batch| tally(&slab(fog(1e6, 1.0), NORMAL, 1.0)?, batch, Flux::Reflected, orders),
    );
}

fn albedo(rows: &mut Rows) {
    let class = Class::Albedo;
    let fog = |albedo: f64| Fog { tau: 2.0, albedo, g: 0.0 };
    rows.fluxes(class, fog(0.0), NORMAL, &[Flux::Transmitted]);
    for w in [0.5, 1.0 - 1e-12] {
        rows.fluxes(class, fog(w), NORMAL, &[Flux::Reflected]);
    }
    rows.fluxes(class, fog(1.0), NORMAL, &[Flux::Reflected, Flux::Transmitted]);
    rows.fluxes(class, fog(0.999), NORMAL, &[Flux::Absorbed]);
    // Photons of albedo 1e-12 are never scattered; paths carry the albedo.
    let exact = || Ok(known(single_fluence(2.0, 1e-12, 1.0, 1.0)?));
    let name = "tau=2 w=1e-12 g=0 scattered fluence at depth 1, paths";
    rows.add(class, name, LIGHT, "single scattering", exact, move |batch| {
        Ok(by_paths(&slab(fog(1e-12), NORMAL, 1.0)?, at_depth(1.0, 1.0), Orders::only(1), batch))
    });
    let exact = || Ok(known(IsotropicSlab::new(2.0, 1.0, NORMAL)?.fluence(1.0)?));
    rows.add(
        class,
        "tau=2 w=1 g=0 fluence at depth 1, paths",
        LIGHT,
        "isotropic slab",
        exact,
        move |batch| Ok(by_paths(&slab(fog(1.0), NORMAL, 1.0)?, at_depth(1.0, 1.0), Orders::ALL, batch)),
    );
    let exact = || half_space_reflectance(1.0, 0.999);
    let deep = Fog { tau: 1e6, albedo: 0.999, g: 0.0 };
    rows.add(class, "tau=1e6 w=0.999 g=0 reflected", (1024, 16_384), "half-space", exact, move |batch| {
        by_photons(deep, NORMAL, Flux::Reflected, batch)
    });
}

fn asymmetry(rows: &mut Rows) {
    let class = Class::Asymmetry;
    let fog = |g: f64| Fog { tau: 2.0, albedo: 0.9, g };
    for g in [1e-12, -1e-12] {
        rows.fluxes(class, fog(g), NORMAL, &[Flux::Reflected]);
    }
    for g in [0.95, -0.95] {
        rows.fluxes(class, fog(g), NORMAL, &[Flux::Reflected, Flux::Transmitted]);
    }
    // Every collision turns the beam round: with s = tau/mu0, R = s/(1+s), but for about (1-|g|) s.
    let backward = Fog { tau: 2.0, albedo: 1.0, g: -1.0 + 1e-9 };
    let oblique = Incidence::Beam { mu0: 0.5 };
    rows.add(
        class,
        "tau=2 w=1 g=-(1-1e-9) mu0=0.5 reflected",
        LIGHT,
        "beam that turns",
        || Ok((0.8, 1e-7)),
        move |batch| by_photons(backward, oblique, Flux::Reflected, batch),
    );
    for g in [0.0, 0.9999, -0.9999, 1.0 - 1e-9, -1.0 + 1e-9] {
        let name = format!("ball w=1 g={} collisions a photon", near_one(g));
        let length = || Ok((4.0 / 3.0, 4.0 * f64::EPSILON));
        rows.add(class, name, LIGHT, "mean chord, 4 V/S", length, move |batch| {
            collisions(&furnace_ball(DVec3::ZERO, g)?, batch)
        });
        let name = format!("ball w=1 g={} fluence, map", near_one(g));
        rows.add(class, name, LIGHT, "furnace", furnace, move |batch| {
            by_map(&furnace_ball(DVec3::ZERO, g)?, DVec3::ZERO, 0.4, batch)
        });
    }
    // In a slab a path along the faces, which the peak keeps there, would meet millions of collisions.
    for g in [0.0, 0.9999, -1.0 + 1e-9, 1.0 - 1e-9] {
        let name = format!("ball w=1 g={} fluence, paths", near_one(g));
        let inside = DVec3::new(0.3, -0.2, 0.5);
        rows.add(class, name, LIGHT, "furnace", furnace, move |batch| {
            Ok(by_paths(&furnace_ball(DVec3::ZERO, g)?, inside, Orders::ALL, batch))
        });
    }
}

fn furnace() -> anyhow::Result<Bounded> {
    Ok((4.0, 8.0 * f64::EPSILON))
}

fn position(rows: &mut Rows) {
    let class = Class::Position;
    for distance in [0.0, 1e3, 1e6, 9.9e8] {
        let center = DVec3::new(1.0, -0.6, 0.3) * distance;
        let name = format!("ball at {distance:e} collisions a photon");
        let length = || Ok((4.0 / 3.0, 4.0 * f64::EPSILON));
        rows.add(class, name, LIGHT, "mean chord, 4 V/S", length, move |batch| {
            collisions(&furnace_ball(center, 0.0)?, batch)
        });
        let name = format!("ball at {distance:e} fluence, map");
        rows.add(class, name, LIGHT, "furnace", furnace, move |batch| {
            by_map(&furnace_ball(center, 0.0)?, center, 0.4, batch)
        });
        let name = format!("ball at {distance:e} fluence, paths");
        rows.add(class, name, LIGHT, "furnace", furnace, move |batch| {
            Ok(by_paths(&furnace_ball(center, 0.0)?, center, Orders::ALL, batch))
        });
    }
}

fn number(rows: &mut Rows) {
    let class = Class::Number;
    // Passes of one history, of two, and of one more or less than a block; as many as make a batch.
    for size in [1, 2, 4095, 4097] {
        let exact = || Ok(known(direct_transmittance(NORMAL, 1.0)?));
        let name = format!("passes of {size}, tau=1 w=0 transmitted");
        rows.add(class, name, LIGHT, "Beer and Lambert", exact, move |batch| {
            let scene = slab(Fog { tau: 1.0, albedo: 0.0, g: 0.0 }, NORMAL, 1.0)?;
            let passes = batch.histories.div_ceil(size);
            let mut mean = Brought::default();
            for index in 0..passes {
                // Streams of one pass are histories of one replicate; passes must not share any.
                let replicate = batch.replicate.wrapping_add(index << 44);
                let one = Batch { histories: size, seed: batch.seed, replicate };
                let brought = tally(&scene, &one, Flux::Transmitted, Orders::ALL)?;
                mean.value += brought.value / passes as f64;
                mean.non_finite += brought.non_finite;
            }
            Ok(mean)
        });
    }
}

fn faces(rows: &mut Rows) {
    let class = Class::Faces;
    for mu0 in [1e-3, 1e-6] {
        let fog = Fog { tau: 2.0, albedo: 0.9, g: 0.0 };
        rows.fluxes(class, fog, Incidence::Beam { mu0 }, &[Flux::Reflected, Flux::Transmitted]);
    }
    for (name, depth) in [("lit", 0.0), ("far", 2.0)] {
        let exact = move || Ok(known(IsotropicSlab::new(2.0, 0.9, NORMAL)?.fluence(depth)?));
        let name = format!("tau=2 w=0.9 g=0 fluence on the {name} face, paths");
        rows.add(class, name, LIGHT, "isotropic slab", exact, move |batch| {
            let scene = slab(Fog { tau: 2.0, albedo: 0.9, g: 0.0 }, NORMAL, 1.0)?;
            Ok(by_paths(&scene, at_depth(depth, 1.0), Orders::ALL, batch))
        });
    }
    for (name, depth) in [("lit", 0.0), ("far", 2.0)] {
        let name = format!("furnace slab tau=2 g=0.5 radiance along the {name} face, times 4 pi, paths");
        rows.add(class, name, LIGHT, "furnace", furnace, move |batch| {
            let ray = Ray::new(at_depth(depth, 1.0), DVec3::X);
            let brought = paths(&furnace_slab(2.0, 0.5)?, &Quantity::Radiance(ray), Orders::ALL, batch);
            Ok(Brought { value: FOUR_PI * brought.value, ..brought })
        });
    }
    let first = Orders::only(0);
    let along =
        |name: &str, z: f64, expected: f64, source: &'static str, mean: fn(&Pass) -> f64, rows: &mut Rows| {
            let exact = move || Ok((expected, f64::EPSILON));
            rows.add(class, name, LIGHT, source, exact, move |batch| {
                let (pass, non_finite) =
                    pass(&beam_along(z)?, batch, Some((Flux::Absorbed, first)), |_| true)?;
                Ok(Brought { value: mean(&pass), non_finite })
            });
        };
    let per_photon = |pass: &Pass| pass.photons().count() as f64 / pass.emitted() as f64;
    let path = |pass: &Pass| {
        pass.photons().map(|p| p.position.x).sum::<f64>() / pass.photons().count().max(1) as f64
    };
    along("beam along the faces, mean free path", 1.0, 1.0, "mean of an exponential", path, rows);
    for (name, z) in [("lit", 0.0), ("far", 2.0)] {
        let name = format!("beam along, half in the {name} face: collisions a photon");
        along(&name, z, 0.5, "half of the beam is inside", per_photon, rows);
    }
}

/// Nothing is extreme here but the number of histories: what flights, albedo, phase function, powers and kernels miss
/// shows from some tenths of a per cent on. Extremes and the error budget see whole per cents only.
fn ordinary(rows: &mut Rows) {
    let class = Class::Ordinary;
    let sharp = [
        // What passes without a collision: flights.
        (Fog { tau: 1.6, albedo: 0.0, g: 0.0 }, vec![Flux::Transmitted]),
        // Nearly all that was sent: powers.
        (Fog { tau: 1e-3, albedo: 0.5, g: 0.0 }, vec![Flux::Transmitted]),
        (Fog { tau: 2.0, albedo: 0.9, g: 0.75 }, vec![Flux::Reflected, Flux::Absorbed]),
        (Fog { tau: 2.0, albedo: 0.9, g: 0.25 }, vec![Flux::Reflected, Flux::Absorbed]),
    ];
    for (fog, fluxes) in sharp {
        rows.fluxes_by(SHARP, class, fog, NORMAL, &fluxes);
    }
    // A ball that takes most of the medium: nothing but the kernel is left to be wrong.
    rows.add(class, "ball w=1 g=0 fluence, map, radius 0.9", SHARP, "furnace", furnace, move |batch| {
        by_map(&furnace_ball(DVec3::ZERO, 0.0)?, DVec3::ZERO, 0.9, batch)
    });
}
