//! Means over bins by methods that know nothing of each other, where nothing is known exactly; and laws that histories keep one
//! by one.

use crate::support::run::{bin_paths, scores, scoring_pass, sensor};
use crate::support::scenes::written;
use crate::support::verdict;
use turbid::estimators::{Estimator, Gather, Kernel};
use turbid::geometry::{Face, Shape};
use turbid::photons::{Emitter, Histories, Photon, Run};
use turbid::scene::{Binned, Orders, Quantity, Scene};
use turbid::sensor::{PathSettings, PhotonSettings, TallySettings, by_paths, by_photons, by_tallies};
use turbid::stats::Moments;
use turbid::transport::NoProgress;

const PHOTONS: u64 = 1 << 17;
const PATHS: u64 = 1 << 15;

fn measured(name: &str, measure: &str) -> String {
    format!("[[sensors]]\nname = \"{name}\"\nmeasure = {{ {measure} }}\n")
}

/// A diffuse floor, a mirror, a ball of glass, coloured fog and a void, under a lamp that paths find behind the glass too.
const ROOM: &str = r#"
[[regions]]
shape = { cuboid = { min = [-1, -1, 0], max = [0.2, 1, 1] } }
sigma_t = [1.0, 2.0, 0.5]
albedo = [0.9, 0.5, 0.2]
g = 0.5

[[objects]]
shape = { rectangle = { corner = [-2, -2, -0.1], u = [4, 0, 0], v = [0, 4, 0] } }
surface = { lambertian = { reflectance = [0.5, 0.7, 0.3] } }

[[lights]]
area = { shape = { sphere = { center = [0, 0, 2], radius = 0.4 } }, radiance = [3, 2, 1] }
"#;

const SPECULAR: &str = r#"
[[objects]]
shape = { rectangle = { corner = [1.3, -1, 0], u = [0, 2, 0], v = [0, 0, 1] } }
surface = { mirror = { reflectance = 0.9 } }

[[objects]]
shape = { sphere = { center = [0.7, 0, 0.5], radius = 0.4 } }
surface = { dielectric = { inside = "glass" } }
"#;

/// Every channel of every bin that both methods know.
fn agree(scene: &Scene, scored: &[Vec<[Moments; 3]>], seed: u64, promise: f64) {
    for (number, sensor) in scene.sensors().iter().enumerate() {
        for (bin, moments) in scored[number].iter().enumerate() {
            let by_paths = bin_paths(scene, sensor, bin, PATHS, seed);
            for channel in 0..3 {
                let what = format!("{} {bin}, channel {channel}", sensor.name);
                let size = promise * by_paths[channel].mean().abs();
                verdict::agree(&what, &moments[channel], &by_paths[channel], size, seed);
            }
        }
    }
}

/// Flights, collisions and paths, in the fog, and flights and paths in the void between glass and mirror, where nothing collides.
#[test]
fn every_way_to_a_volume_beside_glass_and_a_mirror() {
    let fog = "min = [-1, -0.5, 0], max = [0.2, 0.5, 1], cells = [1, 1, 2]";
    let void = "min = [1.1, -0.5, 0], max = [1.3, 0.5, 1], cells = [1, 1, 2]";
    let sensors = measured("flights in fog", &format!("mean-fluence = {{ {fog} }}"))
        + &measured("collisions in fog", &format!("mean-fluence = {{ {fog}, scoring = \"collision\" }}"))
        + &measured("flights in the void", &format!("mean-fluence = {{ {void} }}"))
        + &measured(
            "absorbed on flights",
            &format!("mean-absorption = {{ {fog}, scoring = \"track-length\" }}"),
        )
        + &measured("absorbed at collisions", &format!("mean-absorption = {{ {fog} }}"))
        + &measured("absorbed at ends", &format!("mean-absorption = {{ {fog}, scoring = \"analog\" }}"))
        + &measured(
            "up",
            "flux = { corner = [-1, -1, 1.2], u = [2, 0, 0], v = [0, 2, 0], bins = [2, 1], crossing = \"against\" }",
        )
        + &measured(
            "down",
            "flux = { corner = [-1, -1, -0.05], u = [0, 2, 0], v = [2, 0, 0], bins = [1, 2] }",
        );
    let glass = "interiors = [{ name = \"glass\", index = 1.5 }]\n";
    let scene = written(&format!("{glass}{ROOM}{SPECULAR}{sensors}"));
    let scored = scores(&scene, PHOTONS, 1);
    agree(&scene, &scored, 2, 0.4);
    // A fluence is not what is absorbed.
    verdict::differ("fluence for absorption", &scored[0][0][0], &scored[3][0][0], 1);
}

/// What collisions and diffuse reflections send towards a plane, where nothing bends light.
#[test]
fn radiance_of_fog_and_floor() {
    let looking = "mean-radiance = { corner = [-1, -1, 1.2], u = [2, 0, 0], v = [0, 2, 0], bins = [2, 2], dir = [0.2, 0.1, -1] }";
    let sensors = measured("down", looking) + "min_order = 1\n";
    let scene = written(&format!("{ROOM}{sensors}"));
    agree(&scene, &scores(&scene, PHOTONS, 3), 4, 0.3);
}

/// Where photons end is where their power stays: voxels that hold all media, what leaves through six faces and what is followed no
/// further add up to what was sent out, in the same histories, to the rounding of their sums.
#[test]
fn nothing_is_lost_between_voxels() {
    let fog = "[[regions]]\nshape = { sphere = { center = [0, 0, 0], radius = 0.9 } }\nsigma_t = [2, 1, 3]\nalbedo = [0.5, 0.9, 0.7]\ng = 0.3\n\
        density = { height-fog = { base = 0, scale_height = 0.5, up = [0, 1, 0] } }\n\
        [[regions]]\nshape = { cuboid = { min = [-0.2, -0.2, -0.2], max = [0.3, 0.2, 0.9] } }\nsigma_t = 5\nalbedo = 0.1\ng = 0\n\
        [[lights]]\npoint = { position = [0.1, 0.2, 0.3], power = [1, 2, 3] }\n\
        [[lights]]\nvolume-source = { shape = { sphere = { center = [-0.2, 0, 0], radius = 0.5 } }, density = 0.7 }\n";
    let voxels = "min = [-1, -1, -1], max = [1, 1, 1], cells = [3, 4, 5], scoring = \"analog\"";
    let mut sensors = measured("kept", &format!("mean-absorption = {{ {voxels} }}"));
    // Outwards: u x v.
    for (corner, u, v) in [
        ("[-1, -1, -1]", "[0, 2, 0]", "[2, 0, 0]"),
        ("[-1, -1, 1]", "[2, 0, 0]", "[0, 2, 0]"),
        ("[-1, -1, -1]", "[0, 0, 2]", "[0, 2, 0]"),
        ("[1, -1, -1]", "[0, 2, 0]", "[0, 0, 2]"),
        ("[-1, -1, -1]", "[2, 0, 0]", "[0, 0, 2]"),
        ("[-1, 1, -1]", "[0, 0, 2]", "[2, 0, 0]"),
    ] {
        sensors +=
            &measured("left", &format!("flux = {{ corner = {corner}, u = {u}, v = {v}, bins = [2, 3] }}"));
    }
    let scene = written(&format!("{fog}{sensors}"));
    let n = 1 << 14;
    let pass = scoring_pass(&scene, n, 5);
    let ledger = pass.report.ledger;
    let mut moments = pass.scores.moments(&scene, n);
    let [mut kept, mut left] = [0.0; 2];
    for sensor in scene.sensors() {
        let binned = sensor.binned().unwrap();
        let power: f64 = moments.by_ref().take(binned.bins()).flatten().map(|m| m.mean()).sum::<f64>()
            * binned.size(None)
            * n as f64;
        if matches!(binned, Binned::Absorption { .. }) { kept += power } else { left += power }
    }
    // Means of 2^14 histories, each rounded once.
    let close = |a: f64, b: f64| (a - b).abs() <= 2.0 * n as f64 * f64::EPSILON * ledger.emitted;
    assert!(close(kept, ledger.absorbed), "{kept} {}", ledger.absorbed);
    assert!(close(left, ledger.escaped), "{left} {}", ledger.escaped);
    assert!(close(kept + left, ledger.emitted) && kept > 0.1 * ledger.emitted && left > 0.1 * ledger.emitted);
}

/// The bins of a face add up to the outflow through it, and fine voxels to coarse ones, in the same histories.
#[test]
fn bins_add_up() {
    let face = "corner = [0, 0, 1], u = [2, 0, 0], v = [0, 2, 0]";
    let place = "min = [0, 0, 0.2], max = [2, 2, 0.9]";
    let sensors = measured("fine", &format!("flux = {{ {face}, bins = [5, 3] }}"))
        + &measured("flights", &format!("mean-fluence = {{ {place}, cells = [3, 4, 5] }}"))
        + &measured("of all", &format!("mean-fluence = {{ {place}, cells = [1, 1, 1] }}"));
    let scene = written(&format!(
        "cell = 2\n[[regions]]\nshape = {{ slab = {{ top = 0, thickness = 1 }} }}\nsigma_t = 1\nalbedo = 0.9\ng = 0\n\
         [[lights]]\nbeam = {{ dir = [0.6, 0.1, 0.8], irradiance = 2, section = \"unbounded\" }}\n{sensors}"
    ));
    let n = 1 << 14;
    let Shape::Slab(slab) = scene.regions()[0].shape.clone() else { unreachable!() };
    let outflow = [sensor(Quantity::Outflow { shape: Shape::Slab(slab), face: Face::Bottom }, Orders::ALL)];
    let emitter = Emitter::by_power(&scene);
    let histories = Histories { count: n, seed: 6, replicate: 0, max_order: None };
    let run = Run { sensors: &outflow, scored: scene.sensors(), ..Run::new(&scene, &emitter, histories) };
    let pass = run.pass(&|_: &Photon| false, &NoProgress).unwrap();
    let moments: Vec<[Moments; 3]> = pass.scores.moments(&scene, n).collect();
    let mean = |range: std::ops::Range<usize>| {
        moments[range.clone()].iter().map(|m| m[0].mean()).sum::<f64>() / range.len() as f64
    };
    let through = mean(0..15) * 4.0 / scene.power()[0];
    assert!((through - pass.tallies[0][0].mean()).abs() < 1e-11, "{through} {}", pass.tallies[0][0].mean());
    assert!((mean(15..75) / mean(75..76) - 1.0).abs() < 1e-11, "{} {}", mean(15..75), mean(75..76));
    // Every photon of the beam but those that collide passes one bin at most, and those that do pass any.
    assert!(moments[..15].iter().all(|m| m[0].mean() > 0.0));
}

/// Beside a map fluxes and absorption are scored by the histories that fill it: those that light tracing follows.
#[test]
fn scores_beside_a_map_are_those_of_light_tracing() {
    let sensors =
        measured("flux", "flux = { corner = [-1, -1, 1.2], u = [2, 0, 0], v = [0, 2, 0], bins = [2, 2] }")
            + &measured("absorbed", "mean-absorption = { region = 0 }")
            + "max_order = 3\n";
    let scene = written(&format!("{ROOM}{sensors}"));
    let light = TallySettings { photons: 9000, seed: 8, orders: Orders::ALL };
    let scored = by_tallies(&scene, &light, &NoProgress).unwrap();
    let estimator = Estimator::new(Kernel::Uniform, Gather::radius(0.1).unwrap());
    let settings = PhotonSettings { photons: 9000, maps: 1, seed: 8, orders: Orders::ALL, estimator };
    let beside = by_photons(&scene, &settings, &NoProgress).unwrap();
    assert_eq!((scored.measurements.len(), &scored.measurements), (15, &beside.measurements));
    assert_eq!(scored.ledger, beside.ledger);
    // Several maps are other histories, as many in all.
    let settings = PhotonSettings { photons: 3000, maps: 3, ..settings };
    let maps = by_photons(&scene, &settings, &NoProgress).unwrap().measurements;
    assert!(maps.iter().zip(&scored.measurements).all(|(a, b)| a.n == b.n && a.mean != b.mean));
}

/// The same bits on any number of threads, and a walk that does not know what is scored.
#[test]
fn scores_do_not_depend_on_threads() {
    let fog = "min = [-1, -0.5, 0], max = [0.2, 0.5, 1], cells = [2, 3, 2]";
    let looking = "mean-radiance = { corner = [-1, -1, 1.2], u = [2, 0, 0], v = [0, 2, 0], bins = [2, 2], dir = [0.2, 0.1, -1] }";
    let sensors = measured("flights", &format!("mean-fluence = {{ {fog} }}"))
        + &measured("absorbed", &format!("mean-absorption = {{ {fog}, scoring = \"track-length\" }}"))
        + &measured("down", looking)
        + "min_order = 1\n";
    let scene = written(&format!("{ROOM}{sensors}"));
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let settings = TallySettings { photons: 20_000, seed: 7, orders: Orders::ALL };
        let paths = PathSettings { samples: 100, seed: 7, replicate: 0, orders: Orders::ALL };
        pool.install(|| {
            (
                by_tallies(&scene, &settings, &NoProgress).unwrap(),
                by_paths(&scene, &paths, &NoProgress).unwrap(),
            )
        })
    };
    let one = on(1);
    assert_eq!(one, on(3));
    let histories = Histories { count: 20_000, seed: 7, replicate: 0, max_order: None };
    let emitter = Emitter::by_power(&scene);
    let alone = Run::new(&scene, &emitter, histories).pass(&|_: &Photon| false, &NoProgress).unwrap();
    let scored = scoring_pass(&scene, 20_000, 7).report;
    assert_eq!((alone.report.ledger, alone.report.collisions), (scored.ledger, scored.collisions));
}
