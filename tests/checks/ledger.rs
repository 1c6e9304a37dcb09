//! The ledger: each class of light, by the photon mapper and by the path tracer.

use crate::support::scenes::{
    cuboid, dielectric, emitting_sphere, homogeneous, lambertian, rectangle, sphere,
};
use crate::support::verdict;
use glam::DVec3;
use turbid::Spectrum;
use turbid::estimators::boundary::Treatment;
use turbid::estimators::{Estimator, Gather, Kernel};
use turbid::geometry::Shape;
use turbid::integrators::March;
use turbid::integrators::mapper::{Mapper, Report, Settings};
use turbid::integrators::{Layer, Layers, StepRule, path};
use turbid::math::{Positive, Ray};
use turbid::photons::maps::{Amount, Indirect, MapSettings, MediumSamples, fill};
use turbid::rng::{Purpose, Stream};
use turbid::scene::{Interior, Object, Region, Scene, SceneParts};
use turbid::stats::Moments;
use turbid::surface::{Mirror, Surface};
use turbid::transport::{NoProgress, run_blocks};

/// Side of the room [L].
const SIDE: f64 = 2.0;
const MAPS: u64 = 64;
/// Rays of one picture.
const RAYS: u64 = 400;
/// Radius of surface estimates [L].
const DISC: f64 = 0.04;
/// Radius of volume estimates [L].
const BALL: f64 = 0.1;

/// A diffuse room with a ball of light under its ceiling, a floor and a block on it, filled with fog.
pub struct Room {
    pub floor: Surface,
    pub sigma_t: Spectrum,
    pub albedo: Spectrum,
    pub g: f64,
    pub is_colored: bool,
    /// Whether a ball of glass hangs in it.
    pub has_glass: bool,
    /// Whether water stands in it, as high as a part of the block.
    pub has_water: bool,
}

impl Room {
    pub fn scene(&self) -> Scene {
        Scene::new(self.parts()).unwrap()
    }

    pub fn parts(&self) -> SceneParts {
        let (x, y, z) = (DVec3::X * SIDE, DVec3::Y * SIDE, DVec3::Z * SIDE);
        let light = emitting_sphere(DVec3::new(1.0, 1.0, 1.5), 0.4);
        let wall = |corner, u, v, rgb: [f64; 3]| {
            let [r, g, b] = if self.is_colored { rgb } else { [0.6; 3] };
            (Shape::Rectangle(rectangle(corner, u, v)), lambertian(Spectrum::rgb(r, g, b)))
        };
        let (white, red, green) = ([0.7, 0.65, 0.6], [0.6, 0.1, 0.1], [0.1, 0.5, 0.2]);
        let block = cuboid(DVec3::new(0.3, 0.4, 0.0), DVec3::new(0.9, 1.1, 0.7));
        let block = (block, lambertian(Spectrum::grey(0.5)));
        let mut objects = vec![
            (Shape::Rectangle(rectangle(DVec3::ZERO, x, y)), self.floor.clone()),
            wall(z, x, y, white),
            wall(DVec3::ZERO, x, z, white),
            wall(y, x, z, white),
            wall(DVec3::ZERO, y, z, red),
            wall(x, y, z, green),
            block,
        ];
        let fog = Region {
            shape: cuboid(DVec3::ZERO, DVec3::splat(SIDE)),
            medium: homogeneous(self.sigma_t, self.albedo, self.g),
        };
        let mut interiors = Vec::new();
        if self.has_glass {
            objects.push((sphere(DVec3::new(1.3, 0.8, 0.55), 0.4), dielectric(1, 0)));
            let glass = Interior { name: "glass".into(), index: 1.5, medium: None };
            interiors = vec![Interior::surroundings(), glass];
        }
        if self.has_water {
            // Its level reaches beyond the walls, which are all that bounds the water.
            let level = rectangle(DVec3::new(-9.0, -9.0, 0.4), DVec3::X * 20.0, DVec3::Y * 20.0);
            objects.push((Shape::Rectangle(level), dielectric(1, 0)));
            let water = Interior { name: "water".into(), index: 1.33, medium: None };
            interiors = vec![Interior::surroundings(), water];
        }
        SceneParts {
            regions: if self.sigma_t.is_black() { Vec::new() } else { vec![fog] },
            objects: objects.into_iter().map(|(shape, surface)| Object { shape, surface }).collect(),
            interiors,
            lights: vec![light],
            ..SceneParts::default()
        }
    }
}

pub fn mirror() -> Surface {
    Surface::Mirror(Mirror::new(Spectrum::grey(0.9)).unwrap())
}

/// A ray of the picture: from a corner of the room to points of its floor, two walls and its ceiling that lie farther
/// from the edges than a disc reaches, one in each cell of a grid. The block hides some of them.
pub fn look(history: u64, stream: &mut Stream) -> Ray {
    let eye = DVec3::new(1.85, 0.15, 1.2);
    let [a, b] = stream.pair();
    let [column, row] = [history / 4 % 10, history / 40 % 10].map(|cell| cell as f64);
    let [u, v] = [(column + a) / 10.0, (row + b) / 10.0].map(|u| 0.1 + (SIDE - 0.2) * u);
    let target = match history % 4 {
        0 => DVec3::new(u, v, 0.0),
        1 => DVec3::new(u, SIDE, v),
        2 => DVec3::new(0.0, u, v),
        _ => DVec3::new(u, v, SIDE),
    };
    Ray::new(eye, (target - eye).normalize())
}

/// How maps are read here: fixed small radii, steps that are unbiased.
pub fn settings(gather_rays: u32) -> Settings {
    let radius = |r| (Kernel::Uniform, Gather::radius(r).unwrap());
    Settings {
        global: radius(DISC),
        caustic: radius(DISC),
        volume: Estimator::new(radius(BALL).0, radius(BALL).1).treated(Treatment::Clipped),
        slope: 1e-3,
        clips_discs: true,
        gather_rays,
        near: 0.0,
        march: March {
            step: Positive::new("the step", 0.5).unwrap(),
            rule: StepRule::Integrated,
            is_jittered: true,
            adaptive: None,
        },
        spacing: 0.0,
    }
}

pub fn filling(emitted: u64, indirect: Indirect, seed: u64, replicate: u64) -> MapSettings {
    let amount = Amount::Emitted(emitted);
    MapSettings {
        global: amount,
        caustic: amount,
        volume: amount,
        media: MediumSamples::Points,
        indirect,
        seed,
        replicate,
    }
}

/// Moments a layer, channels summed; last the sum of the layers.
pub type Sheet = [Moments; 7];

fn push(sheet: &mut Sheet, layers: &Layers) {
    for (moments, layer) in sheet.iter_mut().zip(Layer::ALL) {
        moments.push(layers[layer].sum());
    }
    sheet[6].push(layers.total().sum());
}

pub fn by_paths(scene: &Scene, n: u64, seed: u64) -> Sheet {
    let block = |range: std::ops::Range<u64>| {
        let mut sheet = Sheet::default();
        for history in range {
            let mut stream = Stream::new(seed, Purpose::Paths, 0, history);
            let ray = look(history, &mut stream);
            push(&mut sheet, &path::layers(scene, ray, None, 0, &mut stream).0);
        }
        sheet
    };
    let merge = |mut a: Sheet, b: Sheet| {
        a.iter_mut().zip(&b).for_each(|(a, b)| a.merge(b));
        a
    };
    run_blocks(n, &NoProgress, block, merge).unwrap().unwrap()
}

pub fn layers_of_maps(
    scene: &Scene,
    settings: &Settings,
    emitted: u64,
    indirect: Indirect,
    seed: u64,
) -> Sheet {
    let mut sheet = Sheet::default();
    for replicate in 0..MAPS {
        let mut filled =
            MapSettings { media: settings.media(), ..filling(emitted, indirect, seed, replicate) };
        if filled.media.has_planes() {
            // A ray meets far more planes than photons.
            filled.volume = Amount::Emitted(emitted / 8);
        }
        let maps = fill(scene, &filled, &NoProgress).unwrap();
        let mapper = Mapper::new(scene, &maps, settings);
        let mut picture = Layers::ZERO;
        for history in 0..RAYS {
            let mut stream = Stream::new(seed, Purpose::Paths, replicate + 1, history);
            let ray = look(history, &mut stream);
            picture += mapper.radiance(ray, None, 0, &mut stream).0;
        }
        push(&mut sheet, &(picture * (1.0 / RAYS as f64)));
    }
    sheet
}

/// Every layer of the photon mapper is the path tracer's, and so is their sum.
///
/// What blur may change: indirect light varies over about half the room, so that a disc reads up to r^2/8 and a ball
/// r^2/10 times 4/L^2 of it differently, 0.1 and 0.4 per cent; balls that reach into the block, the light or the
/// glass lose 3r/16 times their area of the fog's volume, 0.5 per cent each; discs at edges, met by gathering rays, lose 2r/(3 pi) times the edges, 0.4 per length:
/// 2 per cent. Caustics of a flat mirror lie on the floor and walls with the blur moving less than a disc's radius of
/// their rim, and are compared within 3 per cent.
pub fn layers_are_those_of_paths(
    room: &Room,
    indirect: Indirect,
    settings: &Settings,
    emitted: u64,
    seed: u64,
) {
    layers_of_the_scene_are_those_of_paths(&room.scene(), indirect, settings, emitted, seed);
}

/// What paths find in a scene: the reference of all ways to read it.
pub fn reference(scene: &Scene, seed: u64) -> Sheet {
    by_paths(scene, 400 * 640, seed)
}

/// The same of a scene that is such a room in size and light.
pub fn layers_of_the_scene_are_those_of_paths(
    scene: &Scene,
    indirect: Indirect,
    settings: &Settings,
    emitted: u64,
    seed: u64,
) {
    layers_are_those_of_the_reference((scene, &reference(scene, seed)), indirect, settings, emitted, seed);
}

/// The same beside a reference that several ways to read share.
pub fn layers_are_those_of_the_reference(
    (scene, paths): (&Scene, &Sheet),
    indirect: Indirect,
    settings: &Settings,
    emitted: u64,
    seed: u64,
) {
    let maps = layers_of_maps(scene, settings, emitted, indirect, seed);
    let names = Layer::ALL.map(Layer::name).into_iter().chain(["total"]);
    for (i, name) in names.enumerate() {
        let (path, map) = (&paths[i], &maps[i]);
        if path.mean() == 0.0 {
            assert_eq!(map.mean(), 0.0, "{name}");
            continue;
        }
        let blur = match name {
            "caustic" => 0.03,
            "indirect" if indirect == Indirect::Gathered => 0.02,
            "multiple" => 0.02,
            "indirect" | "total" => 0.01,
            _ => 0.0,
        };
        // Paths find caustics by chance alone.
        let promise = if name == "caustic" { 0.8 } else { 0.2 };
        // A verdict lies 5.4 standard errors away: a bound counts as a fifth of itself.
        let error = libm::hypot(0.2 * blur * path.mean(), path.std_error());
        let is_by_planes = settings.volume.has_planes && name != "direct" && name != "single";
        let agrees = if is_by_planes { verdict::agrees_with_a_tail } else { verdict::agrees };
        agrees(name, map, (path.mean(), error), promise * path.mean(), seed);
    }
}

/// A room with a mirror for a floor.
fn mirrored(sigma_t: f64) -> Room {
    Room {
        floor: mirror(),
        sigma_t: Spectrum::grey(sigma_t),
        albedo: Spectrum::grey(0.8),
        g: 0.0,
        is_colored: false,
        has_glass: false,
        has_water: false,
    }
}

/// In fog, maps seen directly.
pub fn a_foggy_room_keeps_its_ledger() {
    layers_are_those_of_paths(&mirrored(0.5), Indirect::Seen, &settings(1), 4000, 1);
}

/// In fog, by a final gathering.
pub fn a_foggy_room_keeps_its_ledger_when_gathered() {
    layers_are_those_of_paths(&mirrored(0.5), Indirect::Gathered, &settings(4), 4000, 2);
}

/// In clear air, maps seen directly: light by the mirror is a sixteenth of the indirect light.
pub fn a_clear_room_keeps_its_ledger() {
    layers_are_those_of_paths(&mirrored(0.0), Indirect::Seen, &settings(1), 4000, 5);
}

/// Absent maps are never asked, and the march and shadow rays through fog are not there without it.
pub fn what_is_absent_is_not_asked() {
    let diffuse = || Room { floor: lambertian(Spectrum::grey(0.5)), ..mirrored(0.0) };
    let foggy = Room { floor: lambertian(Spectrum::grey(0.5)), ..mirrored(0.5) };
    for (room, has_caustic, has_volume) in [
        (diffuse(), false, false),
        (foggy, false, true),
        (mirrored(0.0), true, false),
        (mirrored(0.5), true, true),
    ] {
        let scene = room.scene();
        let maps = fill(&scene, &filling(1000, Indirect::Seen, 1, 0), &NoProgress).unwrap();
        let settings = settings(1);
        let mapper = Mapper::new(&scene, &maps, &settings);
        let mut report = Report::default();
        for history in 0..100 {
            let mut stream = Stream::new(1, Purpose::Paths, 0, history);
            let ray = look(history, &mut stream);
            report += mapper.radiance(ray, None, 0, &mut stream).1;
        }
        assert_eq!(report.caustic.count > 0, has_caustic);
        assert_eq!((report.volume.count > 0, report.steps > 0), (has_volume, has_volume));
        assert!(report.global.count > 0 && report.gathering == 0);
        assert!((report.global.mean_radius() - DISC).abs() < 1e-12);
    }
}
