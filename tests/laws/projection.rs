//! Emission towards specular bodies, and towards anything at all: cells of the lights' numbers, what their rays reach, and
//! that nothing is lost.

use super::lights::{lights, suns};
use crate::common::config as properties;
use crate::support::run::numbers;
use crate::support::scenes::{
    bounded, cuboid, homogeneous, lambertian, point_light, rectangle, region, sphere,
};
use crate::support::verdict;
use glam::DVec3;
use proptest::prelude::*;
use turbid::Spectrum;
use turbid::geometry::Shape;
use turbid::light::{EmissionCell, Light};
use turbid::photons::maps::{Amount, Indirect, MapReport, MapSettings, MediumSamples, fill};
use turbid::photons::{Emitter, Flags, Histories, Photon, Run};
use turbid::rng::{Purpose, Stream};
use turbid::scene::{Region, Scene};
use turbid::stats::Moments;
use turbid::surface::{Mirror, Surface};
use turbid::transport::NoProgress;

fn all_lights() -> Vec<(&'static str, Light)> {
    lights().into_iter().chain(suns()).collect()
}

fn mirror() -> Surface {
    Surface::Mirror(Mirror::new(Spectrum::rgb(1.0, 0.9, 0.8)).unwrap())
}

/// Two mirrors in fog, seen small from the lights.
fn scene(lights: Vec<Light>) -> Scene {
    let fog = region(cuboid(DVec3::splat(-5.0), DVec3::splat(6.0)), 0.3, 0.8, 0.0);
    let balls = [(DVec3::new(2.3, 0.3, 2.6), 0.5), (DVec3::new(0.4, 0.3, 4.0), 0.4)];
    bounded(vec![fog], balls.map(|(c, r)| (sphere(c, r), mirror())).to_vec(), lights)
}

#[test]
fn cells_fill_the_numbers() {
    for (name, light) in all_lights() {
        for count in [1, 100, 5000] {
            let volume: f64 = light.cells(count).iter().map(EmissionCell::volume).sum();
            assert!((volume - 1.0).abs() < 1e-12, "{name}: {volume}");
        }
    }
}

/// A lamp so long that its ends are nothing beside its sides: no cell is of those, and halves of cells have a bundle each.
#[test]
fn faces_that_are_nothing_have_no_cells() {
    let rod = cuboid(DVec3::new(-0.4, -0.5, -0.3), DVec3::new(0.7, 0.04, 1e16));
    let light = Light::Area(turbid::light::Area::new(rod, Spectrum::ONE).unwrap());
    let mut cells = light.cells(500);
    for _ in 0..60 {
        assert!(cells.iter().all(|cell| cell.low.position[0] < 1.0));
        let bundles = cells.iter().filter(|cell| light.bundle(cell).is_some()).count();
        assert!(bundles > 0);
        cells = vec![light.quarters(&cells[cells.len() - 1])[3]];
    }
}

proptest! {
    #![proptest_config(properties(2000))]

    /// Every ray of a cell is in the cell's bundle, and a bundle that a ray meets a ball with says that it reaches it.
    #[test]
    fn bundles_hold_their_rays(seed in 0..u64::MAX, count in 1..4000usize, radius in 0.01..2.0f64) {
        let mut stream = Stream::new(seed, Purpose::Synthetic, 0, 0);
        for (name, light) in all_lights() {
            let cells = light.cells(count);
            let cell = cells[stream.index(cells.len())];
            let Some(bundle) = light.bundle(&cell) else { continue };
            let needs = light.needs();
            let ray = light.emit_aimed(None, &cell.numbers((needs.position, needs.direction), &mut stream)).ray;
            let off = ray.origin.distance(bundle.center);
            prop_assert!(off <= bundle.radius * (1.0 + 1e-12) + 1e-12, "{name}: {off} {bundle:?}");
            let angle = turbid::math::atan2(ray.dir.cross(bundle.axis).length(), ray.dir.dot(bundle.axis));
            prop_assert!(angle <= bundle.angle + 1e-9, "{name}: {angle} {bundle:?}");
            let center = DVec3::from(stream.triple()) * 8.0 - 4.0;
            let along = (center - ray.origin).dot(ray.dir).max(0.0);
            if ray.at(along).distance(center) < radius * (1.0 - 1e-9) {
                prop_assert!(bundle.reaches(center, radius), "{name}: {ray:?} meets {center} {radius}, {bundle:?}");
            }
        }
    }
}

/// A bundle does not reach everything: seen from a point, the cells kept shrink to the cone of the ball.
#[test]
fn cells_shrink_to_what_is_seen() {
    let light = point_light(DVec3::ZERO, Spectrum::ONE);
    let (distance, radius) = (5.0, 0.5);
    // Share of the directions: half of 1 - cos, of the ball's angle.
    let share = 0.5 * (1.0 - (1.0f64 - 0.01).sqrt());
    for (count, most) in [(1 << 10, 8.0), (1 << 14, 2.5), (1 << 20, 1.15)] {
        let kept: f64 = light
            .cells(count)
            .iter()
            .filter(|cell| light.bundle(cell).unwrap().reaches(DVec3::new(3.0, 4.0, 0.0), radius))
            .map(EmissionCell::volume)
            .sum();
        assert!(kept >= share && kept < most * share, "{count} cells at {distance}: {}", kept / share);
    }
}

/// Aimed numbers give the same photons as the others: shares that meet balls around the light.
#[test]
fn aimed_photons_are_the_same_photons() {
    for (name, light) in lights() {
        let needs = light.needs();
        for (i, center) in [DVec3::new(1.5, 0.4, 1.5), DVec3::new(-1.0, -1.5, 0.5)].into_iter().enumerate() {
            let ball: Shape = sphere(center, 0.8);
            let meets = |ray: &turbid::math::Ray| f64::from(u8::from(ball.hit(ray, None).is_some()));
            let plain = numbers(1 << 15, 1, |s| meets(&light.emit(None, s).ray));
            let aimed = numbers(1 << 15, 2, |s| {
                let numbers = EmissionCell::WHOLE.numbers((needs.position, needs.direction), s);
                meets(&light.emit_aimed(None, &numbers).ray)
            });
            verdict::agree(&format!("{name}, ball {i}"), &plain, &aimed, 0.05, 2);
        }
    }
}

/// Power of the photons that come by mirrors alone to the fog on either side of x = 1, a value a batch.
fn caustic(scene: &Scene, emitter: &Emitter, seed: u64) -> [[Moments; 3]; 2] {
    const HISTORIES: u64 = 1024;
    let mut moments = [[Moments::new(); 3]; 2];
    for replicate in 0..64 {
        let histories = Histories { count: HISTORIES, seed, replicate, max_order: Some(0) };
        let keep = |photon: &Photon| photon.flags == Flags::SPECULAR;
        let pass = Run::new(scene, emitter, histories).pass(&keep, &NoProgress).unwrap();
        let mut sums = [[0.0f64; 3]; 2];
        for photon in pass.photons() {
            let here = &mut sums[usize::from(photon.position.x > 1.0)];
            here.iter_mut().zip(photon.power.to_array()).for_each(|(sum, power)| *sum += f64::from(power));
        }
        for (moments, sums) in moments.iter_mut().zip(sums) {
            moments.iter_mut().zip(sums).for_each(|(m, sum)| m.push(sum / HISTORIES as f64));
        }
    }
    moments
}

/// Caustic light with and without projection is the same; with it, a part of the photons does.
#[test]
fn projection_loses_nothing() {
    let mut cases: Vec<(&str, Vec<Light>)> = all_lights().into_iter().map(|(n, l)| (n, vec![l])).collect();
    cases.push(("all of them", all_lights().into_iter().map(|(_, l)| l).collect()));
    for (name, lights) in cases {
        let scene = scene(lights);
        let aimed = Emitter::towards_specular(&scene).unwrap();
        let plain = caustic(&scene, &Emitter::by_power(&scene), 1);
        let projected = caustic(&scene, &aimed, 2);
        let mean = |m: &[[Moments; 3]; 2]| m[0][1].mean() + m[1][1].mean();
        let error = |m: &[[Moments; 3]; 2]| libm::hypot(m[0][1].std_error(), m[1][1].std_error());
        verdict::println_line(&format!(
            "{name}: kept {:.4}, cells {}, relative error {:.3} plain, {:.3} projected",
            aimed.kept(),
            aimed.projection_cells(),
            error(&plain) / mean(&plain),
            error(&projected) / mean(&projected),
        ));
        for side in 0..2 {
            for c in 0..3 {
                if plain[side][c].mean() > 0.0 || projected[side][c].mean() > 0.0 {
                    let what = format!("{name}, side {side}, channel {c}");
                    let scale = mean(&plain).max(mean(&projected));
                    verdict::agree(&what, &plain[side][c], &projected[side][c], scale, 1);
                }
            }
        }
        // Isotropic light goes anywhere from each part of its numbers, and so wide a sun nearly so.
        let is_whole = name.starts_with("isotropic") || name.starts_with("wide sun");
        assert_eq!(aimed.kept() < 0.75, !is_whole, "{name}");
    }
}

/// A scene without specular bodies, or with none in reach, has no such emission, and costs no cell.
#[test]
fn nothing_to_aim_at() {
    let light = || point_light(DVec3::ZERO, Spectrum::ONE);
    let fog = || vec![region(sphere(DVec3::ZERO, 1.0), 1.0, 0.5, 0.0)];
    assert!(Emitter::towards_specular(&bounded(fog(), Vec::new(), vec![light()])).is_none());
    assert_eq!(Emitter::by_power(&bounded(fog(), Vec::new(), vec![light()])).projection_cells(), 0);
    let beam = turbid::light::Section::Disc { center: DVec3::ZERO, radius: 0.1 };
    let beam = Light::Beam(turbid::light::Beam::new(DVec3::X, Spectrum::ONE, beam).unwrap());
    let behind = bounded(fog(), vec![(sphere(DVec3::new(-2.0, 0.0, 0.0), 0.5), mirror())], vec![beam]);
    assert!(Emitter::towards_specular(&behind).is_none());
}

/// Fog, a diffuse ball and a mirror in empty space, where a photon of the last light goes: five units from where it starts.
fn afar(lights: Vec<Light>, seed: u64) -> Scene {
    let mut stream = Stream::new(seed, Purpose::Synthetic, 0, 0);
    let ray = lights[lights.len() - 1].emit(None, &mut stream).ray;
    let center = ray.at(5.0);
    let beside = |stream: &mut Stream| center + (DVec3::from(stream.triple()) - 0.5) * 0.8;
    let balls = [
        (sphere(beside(&mut stream), 0.3), lambertian(Spectrum::rgb(0.9, 0.5, 0.7))),
        (sphere(beside(&mut stream), 0.2), mirror()),
    ];
    bounded(vec![region(sphere(center, 1.0), 0.6, 0.9, 0.5)], balls.to_vec(), lights)
}

/// An emitting medium about the origin.
fn emitting(sigma_t: f64) -> Region {
    let medium = homogeneous(Spectrum::grey(sigma_t), Spectrum::grey(0.5), 0.0);
    let turbid::medium::Medium::Homogeneous(medium) = medium else { unreachable!() };
    let medium = medium.with_emission(Spectrum::rgb(0.5, 1.0, 2.0)).unwrap();
    Region { shape: sphere(DVec3::ZERO, 0.5), medium: medium.into() }
}

/// Power that collides in a scene's fog, of light that met nothing before, a diffuse surface, a mirror: a value a batch and
/// channel.
fn collided(scene: &Scene, emitter: &Emitter, histories: u64, seed: u64) -> [[Moments; 3]; 3] {
    let mut moments = [[Moments::new(); 3]; 3];
    for replicate in 0..64 {
        let count = Histories { count: histories, seed, replicate, max_order: None };
        let pass = Run::new(scene, emitter, count).pass(&|_: &Photon| true, &NoProgress).unwrap();
        let mut sums = [[0.0f64; 3]; 3];
        for photon in pass.photons() {
            let met = [Flags::DIFFUSE, Flags::SPECULAR].iter().position(|flag| photon.flags.has(*flag));
            let here = &mut sums[met.map_or(0, |i| i + 1)];
            here.iter_mut().zip(photon.power.to_array()).for_each(|(sum, power)| *sum += f64::from(power));
        }
        for (moments, sums) in moments.iter_mut().zip(sums) {
            moments.iter_mut().zip(sums).for_each(|(m, sum)| m.push(sum / histories as f64));
        }
    }
    moments
}

/// Aimed at what there is, photons bring as much light there as sent out everywhere, from every light alone and from all of
/// them; what is kept and what is left out are all power.
#[test]
fn open_scenes_lose_nothing() {
    let mut cases: Vec<(&str, Vec<Light>)> = all_lights().into_iter().map(|(n, l)| (n, vec![l])).collect();
    // One body would stand in the way of every other light here; the point is the last, whose photons meet the fog.
    let local = lights().into_iter().filter(|(name, l)| l.body().is_none() && !name.starts_with("isotropic"));
    let mut several: Vec<Light> = local.map(|(_, l)| l).collect();
    several.reverse();
    cases.push(("several", several));
    for (number, (name, lights)) in cases.into_iter().enumerate() {
        let scene = afar(lights, number as u64);
        let (plain, aimed) = (Emitter::by_power(&scene), Emitter::towards_scene(&scene));
        let whole = scene.power().sum();
        assert!(((aimed.kept() * whole + aimed.left_out()) / whole - 1.0).abs() < 1e-12, "{name}");
        // Isotropic light goes anywhere from each part of its numbers, and parallel light may all meet the fog.
        if aimed.kept() == 1.0 {
            let is_whole = ["isotropic,", "beam", "sun"].iter().any(|whole| name.contains(whole));
            assert!(is_whole, "{name}");
            continue;
        }
        // Few of those that are sent everywhere come to the fog.
        let (a, b) = (collided(&scene, &plain, 8192, 1), collided(&scene, &aimed, 1024, 2));
        let direct = a[0].map(|m| m.mean());
        for (class, (a, b)) in a.iter().zip(&b).enumerate() {
            // All channels are the same photons.
            if a[0].is_heavy_tailed() || a[0].mean() == 0.0 {
                continue;
            }
            let what = format!("{name}, kept {:.4}, class {class}", aimed.kept());
            for c in 0..3 {
                verdict::agree(&what, &a[c], &b[c], 0.4 * direct[c], 1);
            }
        }
    }
}

/// A medium that emits and in which nothing collides sends photons to what is far away.
#[test]
fn an_emitting_medium_is_aimed() {
    let far = || region(sphere(DVec3::new(5.0, 2.0, 1.0), 0.8), 1.0, 0.9, 0.0);
    let scene = bounded(vec![far(), emitting(0.0)], Vec::new(), Vec::new());
    let aimed = Emitter::towards_scene(&scene);
    let whole = scene.power().sum();
    assert!(aimed.kept() < 0.1 && ((aimed.kept() * whole + aimed.left_out()) / whole - 1.0).abs() < 1e-12);
    let (a, b) = (collided(&scene, &Emitter::by_power(&scene), 8192, 1), collided(&scene, &aimed, 1024, 2));
    for c in 0..3 {
        verdict::agree("emitting medium", &a[0][c], &b[0][c], 0.3 * a[0][c].mean(), 1);
    }
    // Where light collides in itself every direction may be of use.
    assert_eq!(
        Emitter::towards_scene(&bounded(vec![far(), emitting(0.1)], Vec::new(), Vec::new())).kept(),
        1.0
    );
}

/// Of a point, the part of its photons that meets a ball is known, and they carry the power of the cells that reach it: their
/// product is the ball's solid angle, however small it is.
#[test]
fn small_bodies_are_found() {
    for (distance, least) in [(3.0, 0.5), (30.0, 0.5), (300.0, 0.5), (3000.0, 0.4), (1e5, 0.05)] {
        let center = DVec3::new(0.48, -0.6, 0.64) * distance;
        let black = turbid::surface::Black;
        let scene = bounded(
            Vec::new(),
            vec![(sphere(center, 1.0), Surface::Black(black))],
            vec![point_light(DVec3::ZERO, Spectrum::ONE)],
        );
        let emitter = Emitter::towards_scene(&scene);
        let n = 1 << 17;
        let met = (0..n).filter(|history| {
            let mut stream = Stream::new(3, Purpose::Photons, 0, *history);
            let walker = emitter.emit(&scene, &mut stream).unwrap();
            scene.hit(&walker.ray, None).is_some()
        });
        let sine2: f64 = 1.0 / (distance * distance);
        let share = 0.5 * sine2 / (1.0 + (1.0 - sine2).sqrt());
        let expected = share / emitter.kept();
        let what = format!("at {distance}: kept {:.2e} for {share:.2e}", emitter.kept());
        assert!(expected > least, "{what}");
        verdict::rate(&what, met.count() as u64, n, expected, 0.1 * expected, 3);
    }
}

/// The report of maps of so many histories, filled from a light above a ball, in the open and in a room.
fn report(has_room: bool) -> MapReport {
    let mut objects = vec![(sphere(DVec3::ZERO, 0.3), lambertian(Spectrum::grey(0.5)))];
    if has_room {
        let (corner, side) = (DVec3::splat(-4.0), 8.0);
        for (u, v) in [(DVec3::X, DVec3::Y), (DVec3::Y, DVec3::Z), (DVec3::Z, DVec3::X)] {
            for shift in [0.0, side] {
                let wall = rectangle(corner + u.cross(v) * shift, u * side, v * side);
                objects.push((Shape::Rectangle(wall), lambertian(Spectrum::grey(0.2))));
            }
        }
    }
    let scene = bounded(Vec::new(), objects, vec![point_light(DVec3::new(1.0, -1.0, 3.0), Spectrum::ONE)]);
    let amount = Amount::Emitted(1 << 14);
    let (global, caustic, volume) = (amount, amount, amount);
    let settings = MapSettings {
        global,
        caustic,
        volume,
        media: MediumSamples::Points,
        indirect: Indirect::Gathered,
        seed: 1,
        replicate: 0,
    };
    fill(&scene, &settings, &NoProgress).unwrap().report
}

/// Power that is not sent out since it can meet nothing has escaped; in a room nothing is left out.
#[test]
fn what_is_left_out_has_escaped() {
    let (open, closed) = (report(false), report(true));
    for report in [open, closed] {
        let ledger = report.main.ledger;
        let settled = ledger.absorbed + ledger.escaped + ledger.truncated;
        assert!((settled / ledger.emitted - 1.0).abs() < 1e-10, "{ledger:?}");
        assert!((ledger.emitted / (3.0 * report.main.emitted as f64) - 1.0).abs() < 1e-10, "{ledger:?}");
    }
    // The ball fills 0.2 per cent of what the light sees.
    assert!(open.aimed < 0.01 && open.main.hits * 4 > open.main.emitted, "{open:?}");
    assert_eq!((closed.aimed, closed.main.ends.escaped), (1.0, 0));
}
