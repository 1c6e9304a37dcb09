//! The advice of pilot maps, realised: the error that independent maps of the advised size and radius then have,
//! against exact fluences.

use crate::checks::weights;
use crate::support::scenes::{self, Incidence};
use crate::support::{run, verdict};
use std::path::Path;
use turbid::Spectrum;
use turbid::estimators::boundary::Boundary;
use turbid::estimators::{Estimator, Gather, Kernel};
use turbid::math::exp;
use turbid::photons::{Histories, shoot};
use turbid::scene::{Orders, Quantity, Scene, SceneParts};
use turbid::sensor::{Advice, Pilot, PilotSettings};
use turbid::stats::{ALPHA, Moments, wilson_interval};
use turbid::transport::NoProgress;
use turbid_analytic::{AnisotropicSlab, IsotropicSlab};

/// A scene with fluence probes and the exact values there.
struct Case {
    scene: Scene,
    exact: Vec<Spectrum>,
}

impl Case {
    fn new(scene: &Scene, probes: Vec<(Quantity, f64)>) -> Self {
        let sensors = probes.iter().map(|(quantity, _)| run::sensor(quantity.clone(), Orders::ALL)).collect();
        let scene = Scene::new(SceneParts {
            regions: scene.regions().to_vec(),
            objects: scene.objects().to_vec(),
            lights: scene.lights().to_vec(),
            cell: scene.periodic_cell().map(|periodic_cell| periodic_cell.side),
            sensors,
            ..SceneParts::default()
        });
        Case {
            scene: scene.unwrap(),
            exact: probes.into_iter().map(|(_, exact)| Spectrum::grey(exact)).collect(),
        }
    }

    /// A thick slab, probed from a mean free path behind the lit face on.
    fn slab(g: f64) -> Self {
        let beam = turbid_analytic::Incidence::Beam { mu0: 1.0 };
        let depths = [1.0, 1.5, 2.5, 4.0];
        let exact = |t: f64| match g {
            0.0 => IsotropicSlab::new(6.0, 0.9, beam).unwrap().fluence(t).unwrap().value,
            g => AnisotropicSlab::new(6.0, 0.9, g, beam).unwrap().fluence(t).unwrap().value,
        };
        // Four probes a depth, two mean free paths apart: four times what a map tells of the error.
        let corners = [(1.0, 1.0), (1.0, 3.0), (3.0, 1.0), (3.0, 3.0)];
        let at = |t: f64| corners.map(|(x, y)| (Quantity::Fluence(glam::DVec3::new(x, y, t)), exact(t)));
        let probes = depths.into_iter().flat_map(at).collect();
        Case::new(&scenes::slab(6.0, 0.9, g, Incidence::Beam(1.0)), probes)
    }

    /// A ball without absorption in isotropic light: fluence 4 everywhere, so that all error is noise.
    fn furnace() -> Self {
        let shape = scenes::sphere(glam::DVec3::ZERO, 2.0);
        let scene = scenes::ball(2.0, 1.0, 0.0, scenes::isotropic(shape, turbid::light::Faces::Both));
        let at = |x: f64| (Quantity::Fluence(glam::DVec3::new(x, 0.0, 0.0)), 4.0);
        Case::new(&scene, vec![at(0.0), at(1.3), at(-1.3)])
    }

    fn advise(&self, pilot: u64, target: f64, seed: u64) -> Advice {
        let settings = PilotSettings { photons: pilot / 256, maps: 256, seed };
        Pilot::run(&self.scene, &settings, &NoProgress).unwrap().advise(target).unwrap()
    }

    /// Mean over the probes and their channels with light of the squared relative error, a number a map, of `maps` maps of some photons.
    fn realise(&self, radius: f64, photons: u64, maps: u64, seed: u64) -> Vec<f64> {
        let mut errors = Vec::new();
        for replicate in 0..maps {
            let histories = Histories { count: photons, seed, replicate, max_order: None };
            let pass = shoot(&self.scene, histories, &[], |_| true, &NoProgress).unwrap();
            let map = pass.into_map(radius).unwrap();
            let estimator = Estimator::new(Kernel::Uniform, Gather::radius(radius).unwrap());
            let squares = self.scene.sensors().iter().zip(&self.exact).map(|(sensor, exact)| {
                let Quantity::Fluence(p) = sensor.quantity else { return f64::NAN };
                let estimate = estimator.fluence(&map, p, Spectrum::ONE, &Boundary::UNKNOWN).value;
                let lit = (0..3).filter(|&c| exact[c] > 0.0).map(|c| (estimate[c] / exact[c] - 1.0).powi(2));
                lit.collect::<Moments>().mean()
            });
            errors.push(squares.sum::<f64>() / self.exact.len() as f64);
        }
        errors
    }

    /// Advises, realises, and compares squared errors; the interval of the advice is two-sided 95 per cent.
    fn check(&self, what: &str, pilot: u64, target: f64, maps: u64, seed: u64) -> (Advice, Moments) {
        let advice = self.advise(pilot, target, seed);
        let errors = self.realise(advice.radius, advice.photons, maps, seed + 1);
        let square = |x: f64| x * x;
        let uncertain = (square(advice.interval.high) - square(advice.interval.low))
            / (2.0 * 1.959_964)
            / square(advice.error);
        let relative: Moments =
            errors.iter().map(|e| e / square(advice.error)).collect::<Vec<f64>>().iter().collect();
        verdict::agrees(what, &relative, (1.0, uncertain), 0.5, seed);
        (advice, relative)
    }
}

#[test]
fn isotropic_slab() {
    let case = Case::slab(0.0);
    let (advice, relative) =
        case.check("squared error over the advised one, g = 0", 2_000_000, 0.05, 100, 11);
    // The negative control has half of the variance.
    let (bias, noise, all) = (advice.bias.powi(2), advice.noise.powi(2), advice.error.powi(2));
    verdict::rejects("half of the variance", &relative, (bias + 0.5 * noise) / all, 11);
}

#[test]
fn forward_scattering_slab() {
    Case::slab(0.75).check("squared error over the advised one, g = 0.75", 2_000_000, 0.05, 80, 13);
}

#[test]
fn furnace() {
    Case::furnace().check("squared error over the advised one, furnace", 2_000_000, 0.1, 256, 17);
}

/// Red photons and a few green ones: the error is the mean over both channels, and not that of their mean, which would need a sixth of
/// the photons; there is nothing blue.
#[test]
fn channels_of_their_own_noise() {
    let ball = "sphere = { center = [0, 0, 0], radius = 2 }";
    let lit = |radiance: &str| {
        format!(
            "[[lights]]\nisotropic = {{ shape = {{ {ball} }}, faces = \"both\", radiance = {radiance} }}\n"
        )
    };
    let text = format!(
        "[[regions]]\nshape = {{ {ball} }}\nsigma_t = 1\nalbedo = 1\ng = 0\n{}{}",
        lit("[1, 0, 0]"),
        lit("[0, 0.1, 0]")
    );
    let around = glam::DVec3::AXES.into_iter().flat_map(|axis| [1.3 * axis, -1.3 * axis]);
    let probes = around.chain([glam::DVec3::ZERO]).map(|p| (Quantity::Fluence(p), 0.0)).collect();
    let mut case = Case::new(&scenes::written(&text), probes);
    case.exact.fill(Spectrum::rgb(1.0, 0.1, 0.0) * (4.0 * std::f64::consts::PI));
    let (advice, relative) =
        case.check("squared error over the advised one, two colors", 2_000_000, 0.1, 150, 37);
    // Of eleven photons ten are red and one is green.
    let (of_mean, of_channels) = (1.0 / 11.0, 0.5 * (1.0 / 10.0 + 1.0));
    let (bias, noise, all) = (advice.bias.powi(2), advice.noise.powi(2), advice.error.powi(2));
    verdict::rejects("of the channels' mean", &relative, (bias + noise * of_mean / of_channels) / all, 37);
}

/// The best radius for uncollided photons follows from theory: the variance is 4/3 of the squared bias there.
#[test]
fn the_best_radius_of_uncollided_photons() {
    let scene = scenes::slab(6.0, 0.0, 0.0, Incidence::Beam(1.0));
    // Four probes a depth, farther apart than two radii: four times what a map tells of the error.
    let corners = [(1.0, 1.0), (1.0, 3.0), (3.0, 1.0), (3.0, 3.0)];
    let at = |t: f64| corners.map(|(x, y)| (Quantity::Fluence(glam::DVec3::new(x, y, t)), exp(-t)));
    let case = Case::new(&scene, [1.0, 2.0].into_iter().flat_map(at).collect());
    let (advice, relative) =
        case.check("squared error over the advised one, uncollided", 2_000_000, 0.05, 90, 19);
    // The negative control leaves the bias out.
    verdict::rejects("bias left out", &relative, (advice.noise / advice.error).powi(2), 19);
    // Bias r^2/10 with error^2 = 7/3 bias^2: r = sqrt(10 x 0.05 sqrt(3/7)) = 0.572. The optimum is flat: the radius is
    // known to a tenth where its photons are known to a hundredth.
    assert!((advice.radius / 0.572 - 1.0).abs() < 0.15, "{advice:?}");
    assert!((advice.noise.powi(2) / advice.bias.powi(2) / (4.0 / 3.0) - 1.0).abs() < 0.8, "{advice:?}");
    // Photons a ball needs: 1/noise^2, at the probe where there are fewest more than e times fewer than at the other.
    let expected =
        16.0 * advice.radius.powi(-3) / (4.0 / 3.0 * std::f64::consts::PI) * 0.5 * (exp(1.0) + exp(2.0))
            / advice.noise.powi(2);
    // A variance of eight probes from 256 maps of a quarter of the photons is known to sqrt(2/2048) = 3 %; ten of these.
    assert!((advice.photons as f64 / expected - 1.0).abs() < 0.3, "{expected} {advice:?}");
}

/// Radius, photons and interval of small pilots in an absorbing slab, where the error that they then have is known in
/// closed form: how often the interval contains it. Being conservative is allowed: the rate may be above 0.95. At
/// this level a hundred pilots tell a rate of 0.6 from 0.95.
#[test]
fn the_interval_covers_the_exact_error() {
    let depths = [1.0, 1.5, 2.0];
    let probes = depths.map(|t| (scenes::at_depth(t), exp(-t))).to_vec();
    let case = Case::new(&scenes::slab(6.0, 0.0, 0.0, Incidence::Beam(1.0)), probes);
    // The ball reads the mean of e^-z over it; its count is binomial. Bias and variance, means over the depths.
    let exact = |advice: &Advice| {
        let (r, n) = (advice.radius, advice.photons as f64);
        let bias = 3.0 * (r * libm::cosh(r) - libm::sinh(r)) / (r * r * r) - 1.0;
        let part = 4.0 / 3.0 * std::f64::consts::PI * r * r * r / (scenes::CELL * scenes::CELL);
        let variance = |t: &f64| {
            let chance = part * exp(-t) * (1.0 + bias);
            n * chance * (1.0 - chance) / (n * part * exp(-t)).powi(2)
        };
        (bias * bias, depths.iter().map(variance).sum::<f64>() / depths.len() as f64)
    };
    let pilots: Vec<Pilot> = (0..100)
        .map(|seed| {
            let settings = PilotSettings { photons: 1000, maps: 64, seed: 1000 + seed };
            Pilot::run(&case.scene, &settings, &NoProgress).unwrap()
        })
        .collect();
    for target in [0.05, 0.01] {
        let (mut covered, mut of_bias, mut of_twice) = (0, 0, 0);
        for pilot in &pilots {
            let advice = pilot.advise(target).unwrap();
            let (bias2, variance) = exact(&advice);
            let contains = |square: f64| u64::from(advice.interval.contains(square.sqrt()));
            covered += contains(bias2 + variance);
            of_bias += contains(bias2);
            of_twice += contains(bias2 + 4.0 * variance);
        }
        assert!(wilson_interval(covered, 100, 1.0 - ALPHA).high >= 0.95, "{target}: {covered} of 100");
        // The negative controls leave the noise out, and double it: pilots as small as these do not tell the error from noise alone.
        for (what, count) in [("no noise", of_bias), ("twice the noise", of_twice)] {
            assert!(wilson_interval(count, 100, 1.0 - ALPHA).high < 0.95, "{target}, {what}: {count} of 100");
        }
    }
}

fn shaft(parameters: &str) -> Scene {
    let builtin = turbid::scene::BUILTIN.iter().find(|b| b.name == "shaft").unwrap();
    let mut table: toml::Table = toml::from_str(builtin.defaults).unwrap();
    table.extend(toml::from_str::<toml::Table>(parameters).unwrap());
    (builtin.resolve)(&toml::to_string(&table).unwrap()).unwrap().unwrap().scene(Path::new("")).unwrap()
}

/// Balls end at the edge of a beam, across which the field jumps; a probe on the edge has none.
#[test]
fn the_edge_of_a_beam_limits_the_radius() {
    let scene = shaft("albedo = 0.0\nwidth = 2.0\nprobes = [0.25, 1.0]");
    let case = Case { scene, exact: vec![Spectrum::grey(exp(-2.0)); 2] };
    let (advice, _) = case.check("squared error over the advised one, shaft", 1_000_000, 0.2, 512, 23);
    assert!(advice.radius <= 0.25, "{advice:?}");
    assert!(advice.limited_by.is_some(), "{advice:?}");
    // A ball of 0.5 loses the part (1 - h)^2 (2 + h)/4 = 0.156 beyond the edge, h = 1/2, and gains r^2/10 = 0.025 by the
    // bend: the control's error at that probe whatever the photons.
    let wider: Moments = case.realise(0.5, 20 * advice.photons, 16, 29).iter().collect();
    assert!(wider.mean() > 0.5 * 0.13 * 0.13, "{wider:?}");
    let settings = PilotSettings { photons: 5000, maps: 64, seed: 1 };
    let pilot = Pilot::run(&shaft("probes = [0.0, 0.5]"), &settings, &NoProgress).unwrap();
    assert_eq!(pilot.on_boundary, ["x 0"]);
}

/// Advice scales with the scene: the same problem in lengths four times as long.
#[test]
fn the_same_advice_at_another_scale() {
    let text = |scale: f64| {
        let builtin = turbid::scene::BUILTIN.iter().find(|b| b.name == "slab").unwrap();
        let text = format!("tau = 6.0\nalbedo = 0.9\nscale = {scale:?}\nprobes = [0.25, 0.5]");
        let mut table: toml::Table = toml::from_str(builtin.defaults).unwrap();
        table.extend(toml::from_str::<toml::Table>(&text).unwrap());
        let scene = (builtin.resolve)(&toml::to_string(&table).unwrap())
            .unwrap()
            .unwrap()
            .scene(Path::new(""))
            .unwrap();
        let settings = PilotSettings { photons: 2000, maps: 64, seed: 3 };
        Pilot::run(&scene, &settings, &NoProgress).unwrap().advise(0.1).unwrap()
    };
    let (one, four) = (text(1.0), text(4.0));
    assert_eq!(one.photons, four.photons);
    assert!((four.radius / one.radius - 4.0).abs() < 1e-9);
}

#[test]
fn what_cannot_be_advised() {
    let case = Case::slab(0.0);
    let run = |scene: &Scene, maps| {
        Pilot::run(scene, &PilotSettings { photons: 100, maps, seed: 1 }, &NoProgress)
            .map(|_| ())
            .unwrap_err()
    };
    assert_eq!(run(&case.scene, 4).to_string(), "the number of pilot maps is 4; allowed: at least 32");
    let bare = scenes::slab(6.0, 0.9, 0.0, Incidence::Beam(1.0));
    assert!(run(&bare, 64).to_string().contains("no fluence probe"));
    let face = Case::new(&bare, vec![(scenes::at_depth(0.0), 1.0)]);
    assert!(run(&face.scene, 64).to_string().contains("no fluence probe"));
    let deep = Case::new(&bare, vec![(scenes::at_depth(5.99), 1.0)]);
    assert!(run(&deep.scene, 64).to_string().contains("larger pilot"));
    let pilot =
        Pilot::run(&case.scene, &PilotSettings { photons: 1000, maps: 64, seed: 1 }, &NoProgress).unwrap();
    for target in [0.0, -0.1, 1.5, f64::NAN] {
        assert!(pilot.advise(target).unwrap_err().to_string().starts_with("the target is"));
    }
}

#[test]
fn advised_noise_is_that_of_maps() {
    weights::advised_noise_is_that_of_maps();
}
