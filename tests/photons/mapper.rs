//! The photon mapper against closed forms: a furnace of fog, steps of the march, treated radiance of single photons.

use crate::checks::ledger::{Room, filling, layers_of_maps, settings};
use crate::checks::media::{layered, varying};
use crate::checks::point_light;
use crate::support::scenes::{
    bounded, cuboid, emitting_sphere, homogeneous, isotropic, lambertian, point_light as point_lamp,
    rectangle, refracting_cavity, region, sphere,
};
use crate::support::verdict;
use glam::{DVec3, Vec3};
use std::f64::consts::PI;
use turbid::Spectrum;
use turbid::estimators::boundary::{Boundary, Rejection, Treatment};
use turbid::estimators::{Estimator, Gather, Kernel};
use turbid::geometry::{Rectangle, Shape};
use turbid::integrators::mapper::{Mapper, Settings};
use turbid::integrators::{Adaptive, March};
use turbid::integrators::{Layers, StepRule, path};
use turbid::light::Faces;
use turbid::math::{Asymmetry, FOUR_PI, Positive, Ray, cosine_pair, exp, exp_m1, warp};
use turbid::phase::{Phase, PhaseFunction};
use turbid::photons::maps::{Indirect, Maps, fill};
use turbid::photons::{Flags, Photon, PhotonMap, Photons};
use turbid::rng::{Purpose, Stream};
use turbid::scene::{Region, Scene};
use turbid::stats::Moments;
use turbid::surface::{Filter, Mirror, Surface};
use turbid::transport::NoProgress;

fn marching(step: f64, rule: StepRule, is_jittered: bool) -> Settings {
    let step = Positive::new("the step", step).unwrap();
    Settings { march: March { step, rule, is_jittered, adaptive: None }, ..settings(1) }
}

/// The same, with the volume map read along whole rays; places lie nearer to the faces than the radius.
fn along_rays(settings: Settings, radius: f64) -> Settings {
    let radius = Positive::new("the radius", radius).unwrap();
    Settings { volume: settings.volume.along_rays(radius), ..settings }
}

/// The same with a radius for each photon.
fn of_nearest(settings: Settings, k: usize) -> Settings {
    let k = std::num::NonZeroUsize::new(k).unwrap();
    Settings { volume: settings.volume.of_nearest(k), ..settings }
}

/// Fog of albedo 1 with the same radiance from all sides is as bright everywhere, at any anisotropy: what is lost on the
/// way is scattered in. Single scattering alone is not even: places lie farther from the faces than a ball reaches. A constant source of steps of x mean free paths is read as each rule reads it, also where the medium is one that could vary.
#[test]
fn a_furnace_of_fog() {
    let corners = (DVec3::ZERO, DVec3::splat(2.0));
    let cube = cuboid(corners.0, corners.1);
    let grey = Spectrum::ONE;
    for (medium, seed) in [
        (homogeneous(grey, grey, 0.0), 1),
        (homogeneous(grey, grey, 0.6), 2),
        (varying(grey, 1.0, layered(corners, 1, |_| 1.0)), 3),
    ] {
        let scene = bounded(
            vec![Region { shape: cube.clone(), medium: medium.clone() }],
            Vec::new(),
            vec![isotropic(cube.clone(), Faces::Both)],
        );
        let maps: Vec<_> = (0..64)
            .map(|replicate| {
                fill(&scene, &filling(4000, Indirect::Seen, seed, replicate), &NoProgress).unwrap()
            })
            .collect();
        let x: f64 = 0.4;
        for (settings, factor) in [
            (marching(0.7, StepRule::Integrated, true), 1.0),
            (marching(x, StepRule::Integrated, false), 1.0),
            (marching(x, StepRule::NearEnd, false), x / -exp_m1(-x)),
            (along_rays(marching(0.7, StepRule::Integrated, true), 0.3), 1.0),
            (of_nearest(along_rays(marching(0.7, StepRule::Integrated, true), 0.2), 8), 1.0),
            (marching(0.5 * x, StepRule::NearEnd, false), 0.5 * x / -exp_m1(-0.5 * x)),
            (marching(x, StepRule::Middle, false), 0.5 * x / libm::sinh(0.5 * x)),
        ] {
            let mut moments = Moments::new();
            for (replicate, maps) in maps.iter().enumerate() {
                let mapper = Mapper::new(&scene, maps, &settings);
                let mut sum = 0.0;
                for history in 0..50 {
                    let mut stream = Stream::new(seed, Purpose::Paths, replicate as u64, history);
                    let [y, z] = stream.pair().map(|u| 0.2 + 1.6 * u);
                    let ray = Ray::new(DVec3::new(0.4, y, z), DVec3::X);
                    sum += mapper.radiance(ray, None, 0, &mut stream).0.total()[1];
                }
                moments.push(sum / 50.0 * PI);
            }
            let behind = exp(-1.6);
            let expected = behind + (1.0 - behind) * factor;
            let what = format!("seed {seed}, {:?}", settings.march);
            verdict::agrees(&what, &moments, (expected, 1e-12), 0.1, seed);
        }
    }
}

/// More photons change no brightness.
#[test]
fn pictures_do_not_depend_on_the_number_of_photons() {
    let room = Room {
        floor: lambertian(Spectrum::grey(0.7)),
        sigma_t: Spectrum::grey(0.5),
        albedo: Spectrum::grey(0.8),
        g: 0.0,
        is_colored: true,
        has_glass: false,
        has_water: false,
    };
    let scene = room.scene();
    let of = |emitted: u64, seed: u64| layers_of_maps(&scene, &settings(1), emitted, Indirect::Seen, seed);
    let (few, many) = (of(1000, 11), of(6000, 12));
    for (i, name) in [(3, "indirect"), (5, "multiple"), (6, "total")] {
        verdict::agree(name, &few[i], &many[i], 0.35 * many[i].mean(), 11);
    }
}

/// In a map of one photon, radiance is density times the phase function, whatever is done at the boundary.
#[test]
fn treated_radiance_of_one_photon() {
    let dir = Vec3::new(0.6, 0.0, 0.8);
    let position = DVec3::new(0.3, 0.5, 0.1);
    let photon = Photon {
        position,
        dir,
        normal: Vec3::ZERO,
        power: Vec3::new(1.0, 2.0, 3.0),
        order: 1,
        flags: Flags::MEDIUM,
    };
    let map = PhotonMap::new(vec![photon], 3).unwrap();
    let cube = cuboid(DVec3::ZERO, DVec3::ONE);
    let (wo, point) = (DVec3::new(0.0, 0.6, 0.8), DVec3::new(0.35, 0.5, 0.05));
    let wall = [cuboid(DVec3::new(0.0, 0.0, 0.5), DVec3::ONE)];
    for g in [0.0, 0.7] {
        let phase = Phase::with_asymmetry(Asymmetry::new("g", g).unwrap());
        let (minus, plus) = cosine_pair(dir.as_dvec3(), wo);
        let p = phase.eval(minus, plus);
        assert!(g != 0.0 || (p * FOUR_PI - 1.0).abs() < 1e-15);
        for treatment in Treatment::ALL {
            for rejection in Rejection::ALL {
                for kernel in Kernel::ALL {
                    let gather = Gather::radius(0.2).unwrap();
                    let boundary = Boundary::of(&cube).unwrap().with_walls(&wall);
                    let estimator = Estimator::new(kernel, gather).treated(treatment).rejecting(rejection);
                    let density = estimator.collision_density(&map, point, &boundary);
                    let radiance = estimator.in_scattered(&map, point, wo, &phase, Spectrum::ONE, &boundary);
                    let expected = density.value[2] * p;
                    assert!(expected > 0.0);
                    // Single precision of the phase function's eight lanes.
                    assert!(
                        (radiance.value[2] / expected - 1.0).abs() < 1e-5,
                        "{treatment:?} {rejection:?} {kernel:?} {g}"
                    );
                }
            }
        }
    }
}

/// Fog that emits: what is seen of it straight, and what it scatters of its own light once.
#[test]
fn emitting_fog() {
    let cube = cuboid(DVec3::ZERO, DVec3::splat(2.0));
    let matter = homogeneous(Spectrum::ONE, Spectrum::rgb(0.5, 0.7, 0.9), 0.3);
    let emitting = matter.matter().clone().with_emission(Spectrum::rgb(1.0, 2.0, 3.0)).unwrap();
    let region = Region { shape: cube, medium: emitting.into() };
    let scene = bounded(vec![region], Vec::new(), vec![emitting_sphere(DVec3::new(1.0, 1.0, 0.5), 0.2)]);
    let maps = fill(&scene, &filling(100, Indirect::Seen, 1, 0), &NoProgress).unwrap();
    let settings = marching(0.7, StepRule::Integrated, true);
    let mapper = Mapper::new(&scene, &maps, &settings);
    let mut all = [[Moments::new(); 2]; 2];
    for history in 0..20_000 {
        let mut stream = Stream::new(5, Purpose::Paths, 0, history);
        let [y, z] = stream.pair();
        let ray = Ray::new(DVec3::new(0.1, 0.2 + y, 1.0 + 0.5 * z), DVec3::X);
        let by_map = mapper.radiance(ray, None, 0, &mut stream).0;
        let by_path = path::layers(&scene, ray, None, 0, &mut stream).0;
        for (moments, layers) in all.iter_mut().zip([by_map, by_path]) {
            moments[0].push(layers.emission.sum());
            moments[1].push(layers.single.sum());
        }
    }
    for (i, name) in ["emission", "single"].into_iter().enumerate() {
        let mean = all[1][i].mean();
        verdict::agree(name, &all[0][i], &all[1][i], 0.1 * mean, 5);
    }
}

/// Single scattering of a ray that passes close to a point light, against its integral: steps chosen by probes leave the mean
/// alone, and take fewer steps than equal ones of the same spread.
#[test]
fn chosen_steps_keep_the_mean() {
    let scene = point_light::fog(Spectrum::ONE, Spectrum::grey(0.5));
    let maps = Maps::none(Indirect::Seen);
    let expected = point_light::single_scattering(1.0, 0.5, point_light::BESIDE);
    let adaptive = Adaptive { tolerance: 0.5, shortest: Positive::new("the shortest step", 0.0125).unwrap() };
    // Mean, variance and steps of each way.
    let run = |step: f64, adaptive: Option<Adaptive>, seed: u64| {
        let mut settings = marching(step, StepRule::Integrated, true);
        settings.march.adaptive = adaptive;
        let mapper = Mapper::new(&scene, &maps, &settings);
        let (mut moments, mut steps) = (Moments::new(), 0);
        for history in 0..20_000 {
            let mut stream = Stream::new(seed, Purpose::Paths, 0, history);
            let ray = point_light::ray(point_light::BESIDE);
            let (layers, report) = mapper.radiance(ray, None, 0, &mut stream);
            moments.push(layers.single[1]);
            steps += report.steps;
        }
        (moments, steps)
    };
    let (chosen, chosen_steps) = run(0.2, Some(adaptive), 3);
    let (equal, equal_steps) = run(0.05, None, 4);
    verdict::agrees("chosen steps", &chosen, (expected, 1e-9), 0.03 * expected, 3);
    verdict::agrees("equal steps", &equal, (expected, 1e-9), 0.03 * expected, 4);
    assert!(chosen_steps < equal_steps, "{chosen_steps} {equal_steps}");
    assert!(chosen.variance() < equal.variance(), "{:e} {:e}", chosen.variance(), equal.variance());
}

/// Evenly lit squares, one, or two side by side in a plane: with clipped discs they are as bright at edges and in corners as
/// in the middle, exactly in the mean over maps; without, they are darker.
#[test]
fn flat_surfaces_are_even_up_to_their_edges() {
    const N: u64 = 1000;
    let square = |x: f64| Rectangle::new(DVec3::X * x, DVec3::X, DVec3::Y).unwrap();
    for (name, sides, clips_discs) in [("one", 1u32, true), ("two", 2, true), ("not clipped", 1, false)] {
        let objects = (0..sides)
            .map(|i| (Shape::Rectangle(square(f64::from(i))), lambertian(Spectrum::grey(0.5))))
            .collect();
        let light = emitting_sphere(DVec3::new(0.5, 0.5, 9.0), 0.1);
        let scene = bounded(Vec::new(), objects, vec![light]);
        let mut settings = settings(1);
        settings.clips_discs = clips_discs;
        settings.global = (Kernel::Uniform, Gather::nearest(20, 0.5).unwrap());
        let mut moments = Moments::new();
        for map in 0..200 {
            let mut stream = Stream::new(9, Purpose::Synthetic, map, 0);
            let photons = (0..N * u64::from(sides)).map(|_| {
                let [x, y] = stream.pair();
                Photon {
                    position: DVec3::new(x * f64::from(sides), y, 0.0),
                    dir: Vec3::NEG_Z,
                    normal: Vec3::Z,
                    power: Vec3::ONE,
                    order: 1,
                    flags: Flags::DIFFUSE,
                }
            });
            let global = PhotonMap::new(photons.collect::<Photons>(), N).unwrap();
            let maps = Maps { global: Some(global), ..Maps::none(Indirect::Seen) };
            let mapper = Mapper::new(&scene, &maps, &settings);
            let spots = [(0.001, 0.001), (0.5, 0.01), (0.97, 0.5), (0.999, 0.98), (0.05, 0.4), (0.5, 0.5)];
            let seen = spots.map(|(x, y)| {
                let ray = Ray::new(DVec3::new(x, y, 1.0), DVec3::NEG_Z);
                mapper.radiance(ray, None, 0, &mut stream).0.indirect[1]
            });
            moments.push(seen.iter().sum::<f64>() / seen.len() as f64);
        }
        // Irradiance 1 (N photons of power 1, of N sent out, on area 1), reflectance 0.5.
        let expected = 0.5 / PI;
        match clips_discs {
            true => verdict::agrees(name, &moments, (expected, 1e-6), 0.06 * expected, 9),
            false => verdict::rejects(name, &moments, expected, 9),
        }
    }
}

/// Light from all sides through two panes that let a half and a third of it pass is direct light of what is behind them,
/// in every sample: lights that nothing can aim at are looked for beyond filters.
#[test]
fn light_from_all_sides_is_direct_behind_panes() {
    let around = sphere(DVec3::ZERO, 3.0);
    let pane = |half: f64, passed: f64| {
        let filter = Filter::new(Spectrum::grey(passed)).unwrap();
        (cuboid(DVec3::splat(-half), DVec3::splat(half)), Surface::Filter(filter))
    };
    let floor = rectangle(DVec3::new(-0.5, -0.5, 0.0), DVec3::X, DVec3::Y);
    let floor = (Shape::Rectangle(floor), lambertian(Spectrum::grey(0.6)));
    let light = isotropic(around, Faces::Both);
    let scene = bounded(Vec::new(), vec![floor, pane(1.0, 0.5), pane(1.5, 1.0 / 3.0)], vec![light]);
    let maps = fill(&scene, &filling(100, Indirect::Seen, 1, 0), &NoProgress).unwrap();
    let settings = settings(1);
    let mapper = Mapper::new(&scene, &maps, &settings);
    for history in 0..50 {
        let mut stream = Stream::new(1, Purpose::Paths, 0, history);
        let [x, y] = stream.pair().map(|u| u - 0.5);
        let ray = Ray::new(DVec3::new(x, y, 0.7), -DVec3::Z);
        let direct = mapper.radiance(ray, None, 0, &mut stream).0.direct[0];
        // Radiance 1/pi, a sixth of it behind the panes, from the half space above the floor.
        let expected = 0.6 / PI / 6.0;
        assert!((direct - expected).abs() < 1e-12, "{direct} {expected}");
    }
}

/// The photon mapper's radiance along chosen rays, a value a map: the sum of a layer, or of all.
fn by_maps(
    scene: &Scene,
    settings: &Settings,
    (emitted, rays): (u64, u64),
    seed: u64,
    ray: impl Fn(&mut Stream) -> Ray,
    value: impl Fn(&Layers) -> f64,
) -> Moments {
    let mut moments = Moments::new();
    for replicate in 0..64 {
        let maps = fill(scene, &filling(emitted, Indirect::Gathered, seed, replicate), &NoProgress).unwrap();
        let mapper = Mapper::new(scene, &maps, settings);
        let mut sum = 0.0;
        for history in 0..rays {
            let mut stream = Stream::new(seed, Purpose::Paths, replicate, history);
            let ray = ray(&mut stream);
            let within = scene.interior_at(ray.origin);
            sum += value(&mapper.radiance(ray, None, within, &mut stream).0);
        }
        moments.push(sum / rays as f64);
    }
    moments
}

/// A diffuse ball with a point light in its middle, every ray of the gathering traced on: they end by the reflectance, and
/// the radiance is rho E/pi (1 + rho + rho^2 + ...).
#[test]
fn rays_traced_on_come_to_an_end() {
    for rho in [0.5, 0.9] {
        let wall = (sphere(DVec3::ZERO, 1.0), lambertian(Spectrum::grey(rho)));
        let scene = bounded(Vec::new(), vec![wall], vec![point_lamp(DVec3::ZERO, Spectrum::ONE)]);
        let near = Settings { near: 10.0, ..settings(2) };
        let ray =
            |stream: &mut Stream| Ray::new(DVec3::new(0.5, 0.1, 0.0), warp::square_to_sphere(stream.pair()));
        let found = by_maps(&scene, &near, (50, 80), 20, ray, |layers| layers.total()[0]);
        let expected = rho / PI / FOUR_PI / (1.0 - rho);
        verdict::agrees(&format!("rho {rho}"), &found, (expected, 1e-9), 0.1 * expected, 20);
    }
}

/// Between mirrors that lose nothing rays of the gathering end at the light or the one diffuse body there is.
#[test]
fn rays_between_mirrors_come_to_an_end() {
    let edge = |corner: DVec3, u: DVec3, v: DVec3| {
        let mirror = Surface::Mirror(Mirror::new(Spectrum::ONE).unwrap());
        (Shape::Rectangle(rectangle(corner, 2.0 * u, 2.0 * v)), mirror)
    };
    let [x, y, z] = DVec3::AXES;
    let mut objects = vec![
        edge(DVec3::ZERO, x, y),
        edge(2.0 * z, x, y),
        edge(DVec3::ZERO, x, z),
        edge(2.0 * y, x, z),
        edge(DVec3::ZERO, y, z),
        edge(2.0 * x, y, z),
    ];
    objects.push((sphere(DVec3::new(0.6, 0.7, 0.8), 0.3), lambertian(Spectrum::grey(0.5))));
    let scene = bounded(Vec::new(), objects, vec![emitting_sphere(DVec3::new(1.4, 1.3, 1.2), 0.3)]);
    let ray =
        |stream: &mut Stream| Ray::new(DVec3::new(1.0, 0.3, 0.5), warp::square_to_sphere(stream.pair()));
    for near in [0.0, 100.0] {
        let settings = Settings { near, ..settings(2) };
        let found = by_maps(&scene, &settings, (50, 5), 21, ray, |layers| layers.total()[0]);
        assert!(found.mean() > 0.0 && found.mean().is_finite());
    }
}

/// One fog as one region, and cut in two where the rays run: balls count what both halves hold.
#[test]
fn fog_cut_in_two_is_the_same_fog() {
    let (low, high) = (DVec3::ZERO, DVec3::splat(2.0));
    let (left, right) = (cuboid(low, high.with_x(1.0)), cuboid(low.with_x(1.0), high));
    let scene = |shapes: Vec<Shape>| {
        let regions = shapes.into_iter().map(|shape| region(shape, 1.0, 0.9, 0.3)).collect();
        bounded(regions, Vec::new(), vec![emitting_sphere(DVec3::new(1.0, 1.0, 1.7), 0.2)])
    };
    let ray = |stream: &mut Stream| {
        let [u, v] = stream.pair();
        Ray::new(DVec3::new(0.97 + 0.06 * u, 0.2 + 0.8 * v, -0.1), DVec3::Z)
    };
    let wide = Estimator::new(Kernel::Uniform, Gather::radius(0.25).unwrap()).treated(Treatment::Clipped);
    let settings = Settings { volume: wide, ..marching(0.5, StepRule::Integrated, true) };
    let multiple = |layers: &Layers| layers.multiple[0];
    let whole = by_maps(&scene(vec![cuboid(low, high)]), &settings, (4000, 150), 22, ray, multiple);
    let cut = by_maps(&scene(vec![left, right]), &settings, (4000, 150), 23, ray, multiple);
    verdict::agree("cut", &cut, &whole, 0.25 * whole.mean(), 22);
}

/// A ball of milk in glass of its own, as bright all around as the isotropic light about it: balls are clipped at the
/// glass. Where they are not, what is scattered more than once is low by 3 r/16 of the surface over the volume, and more
/// as seen from outside, where the near parts count most.
#[test]
fn balls_are_clipped_at_glass() {
    let ray = |stream: &mut Stream| {
        let [u, v] = stream.pair().map(|u| 1.6 * u - 0.8);
        Ray::new(DVec3::new(u, v, -1.3), DVec3::Z)
    };
    let scene = refracting_cavity(1.33, 2.0, 0.0);
    let treated = |treatment| {
        let settings = marching(0.3, StepRule::Integrated, true);
        Settings { volume: settings.volume.treated(treatment), ..settings }
    };
    let total = |layers: &Layers| layers.total()[0] * PI;
    let clipped = by_maps(&scene, &treated(Treatment::Clipped), (3000, 300), 25, ray, total);
    verdict::agrees("clipped", &clipped, (1.0, 1e-4), 0.05, 25);
    let plain = by_maps(&scene, &treated(Treatment::None), (3000, 300), 25, ray, total);
    verdict::rejects("not clipped", &plain, 1.0, 25);
}
