//! How far light goes, learned from photons: how bright it is in the cells of a grid, and how many flights to lead there.
//!
//! The second moment of what a flight brings is the sum over its ends of P (b^2 + v bm^2) / (share b/bm + 1 - share), P the
//! probability of its own, b the brightness, bm their mean, v the noise of what is found there: as of directions, from photons in three
//! parts, so that chance is no gain. Each flight's is taken over its mean squared, and flights start where photons collided.

use super::arrival::PARTS;
use super::choice::{NOISE, SHARES};
use crate::math::warp;
use crate::photons::Photon;
use crate::rng::{Purpose, Stream};
use crate::scene::Scene;
use crate::transport::{Brightness, BrightnessGrid, CELLS};
use crate::{Spectrum, math::Ray};
use glam::{DVec2, DVec3};

/// Flights whose second moments are taken.
const FLIGHTS: usize = 2000;
/// Photons in media, for each cell of a grid, below which nothing is learned.
const LEAST: usize = 16;
/// Part of the second moment that is to be left at most: flights that are led take half as long again as others, or twice where little stands
/// in a ray's way.
const LEFT: f64 = 0.6;

/// What a photon tells of the brightness about it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Lit {
    position: DVec3,
    /// The axis that the surface's normal is next to; none in a medium.
    across: Option<u8>,
    /// In a medium its power over the extinction, on a surface four times its power: what is scattered or reflected evenly is by this
    /// as bright in both, per volume there and per area here.
    value: f64,
    part: u8,
}

impl Lit {
    pub fn in_medium(scene: &Scene, photon: &Photon, part: u8) -> Option<Self> {
        let sigma_t = scene.medium_at(photon.position)?.sigma_t(photon.position);
        let over = |channel: usize| {
            if sigma_t[channel] > 0.0 { f64::from(photon.power[channel]) / sigma_t[channel] } else { 0.0 }
        };
        let value = (0..3).map(over).sum();
        Some(Lit { position: photon.position, across: None, value, part })
    }

    pub fn on_surface(photon: &Photon, part: u8) -> Self {
        let value = 4.0 * f64::from(photon.power.element_sum());
        let across = Some(photon.normal.as_dvec3().abs().max_position() as u8);
        Lit { position: photon.position, across, value, part }
    }
}

/// A grid by all photons, and by each part of them.
fn grids(lit: &[Lit]) -> Vec<BrightnessGrid> {
    let corners = lit.iter().fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), one| {
        (low.min(one.position), high.max(one.position))
    });
    let (low, high) = if lit.is_empty() { (DVec3::ZERO, DVec3::ONE) } else { corners };
    let mut grids = vec![BrightnessGrid::new(low, high); 1 + PARTS as usize];
    let scale = grids[0].scale();
    for one in lit {
        // A surface crosses its cell along the axis that its normal is next to.
        let per = scale.element_product() / one.across.map_or(1.0, |axis| scale[usize::from(axis)]);
        grids[0].add(one.position, one.value * per);
        grids[1 + usize::from(one.part)].add(one.position, PARTS as f64 * one.value * per);
    }
    grids
}

/// What distances are led by; none where that gains too little.
///
/// # Arguments
/// `share` of the flights, in place of the best one
pub(super) fn learned(
    scene: &Scene,
    (media, surfaces): (&[Lit], &[Lit]),
    period: Option<DVec2>,
    share: Option<f64>,
    (seed, replicate): (u64, u64),
) -> Option<Brightness> {
    if media.is_empty() || !scene.media().iter().any(|medium| medium.is_homogeneous()) {
        return None;
    }
    let [in_media, on_surfaces] = [media, surfaces].map(grids);
    let both = in_media.into_iter().zip(on_surfaces);
    let mut by: Vec<Brightness> =
        both.map(|(media, surfaces)| Brightness { share: 0.0, media, surfaces, period }).collect();
    let share = share.or_else(|| best(scene, media, &by, (seed, replicate)))?;
    let all = by.swap_remove(0);
    Some(Brightness { share, ..all })
}

/// The share by which the second moment of flights is least, if that gains enough.
///
/// # Arguments
/// `by` all photons, and each part of them
fn best(scene: &Scene, media: &[Lit], by: &[Brightness], (seed, replicate): (u64, u64)) -> Option<f64> {
    if media.len() < LEAST * CELLS {
        return None;
    }
    let mut moments = [0.0; 1 + SHARES.len()];
    for number in 0..FLIGHTS {
        // Histories are numbered from 0.
        let mut stream = Stream::new(seed, Purpose::Guide, replicate, u64::MAX - number as u64);
        let position = media[number * media.len() / FLIGHTS].position;
        let ray = Ray::new(position, warp::square_to_sphere(stream.pair()).normalize());
        let hit = scene.hit(&ray, None);
        let end = hit.map_or(f64::INFINITY, |found| found.hit.t);
        let segments = scene.segments(&ray, end, scene.interior_at(position));
        let ends = |by: &Brightness| by.ends(scene, &ray, (hit.as_ref(), &segments), Spectrum::ONE);
        let [Some(all), Some(a), Some(b), Some(c)] = [0, 1, 2, 3].map(|part| ends(&by[part])) else {
            continue;
        };
        let square = all.mean() * all.mean();
        for (guide, one, other) in [(&a, &b, &c), (&b, &c, &a), (&c, &a, &b)] {
            for (moment, share) in moments.iter_mut().zip([0.0].iter().chain(&SHARES)) {
                let second = |way: usize| {
                    let ((own, guided), product) =
                        (guide.ways()[way], one.ways()[way].1 * other.ways()[way].1);
                    own * (product / square + NOISE) / guide.more_often(guided, *share)
                };
                *moment += (0..guide.ways().len()).map(second).sum::<f64>();
            }
        }
    }
    let (number, least) =
        moments.iter().enumerate().skip(1).min_by(|(_, a), (_, b)| a.total_cmp(b)).map(|(n, m)| (n, *m))?;
    (least < LEFT * moments[0]).then(|| SHARES[number - 1])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Cuboid, Shape};
    use crate::light::{Light, Point};
    use crate::math::Asymmetry;
    use crate::medium::Homogeneous;
    use crate::phase::Phase;
    use crate::scene::{Object, Region, SceneParts};
    use crate::surface::{Lambertian, Surface};

    /// Fog of albedo 0.8 in a box of side 2 with walls as bright.
    fn fog() -> Scene {
        let within = Cuboid::new(DVec3::splat(-1.0), DVec3::splat(1.0)).unwrap();
        let phase = Phase::with_asymmetry(Asymmetry::try_from(0.0).unwrap());
        let medium = Homogeneous::new(Spectrum::ONE, Spectrum::grey(0.8), phase).unwrap();
        let wall = Surface::Lambertian(Lambertian::new(Spectrum::grey(0.8)).unwrap());
        Scene::new(SceneParts {
            regions: vec![Region { shape: Shape::Cuboid(within), medium: medium.into() }],
            objects: vec![Object { shape: Shape::Cuboid(within), surface: wall }],
            lights: vec![Light::Point(Point::new(DVec3::ZERO, Spectrum::ONE).unwrap())],
            ..SceneParts::default()
        })
        .unwrap()
    }

    /// Photons in the fog, by places in a unit cube that are as they are drawn, and as many on the walls, all as bright.
    fn lit(count: usize, stream: &mut Stream, drawn: impl Fn(f64) -> f64) -> (Vec<Lit>, Vec<Lit>) {
        let mut place = || DVec3::from([stream.unit(), stream.unit(), drawn(stream.unit())]) * 2.0 - 1.0;
        // Spread over a volume of 8, and over an area of 24.
        let in_fog =
            |part: usize| Lit { position: place(), across: None, value: 8.0, part: (part % 3) as u8 };
        let media: Vec<Lit> = (0..count).map(in_fog).collect();
        let on_wall = |part: usize| {
            let (axis, side) = (part / 3 % 3, if (part / 9).is_multiple_of(2) { 1.0 } else { -1.0 });
            let mut position = place();
            position[axis] = side;
            Lit { position, across: Some(axis as u8), value: 24.0, part: (part % 3) as u8 }
        };
        (media, (0..count).map(on_wall).collect())
    }

    /// Where all is as bright the photons' noise is not learned, however few they are: in 100 fogs not once.
    #[test]
    fn noise_is_not_learned() {
        let scene = fog();
        for seed in 0..100 {
            let mut stream = Stream::new(seed, Purpose::Synthetic, 0, 0);
            let (media, surfaces) = lit(1 << (5 + seed % 11), &mut stream, |z| z);
            let learned = learned(&scene, (&media, &surfaces), None, None, (seed, 0));
            assert_eq!(learned.map(|brightness| brightness.share), None, "{seed}");
        }
    }

    /// A bright layer between dark walls is learned, and how many times as bright it is.
    #[test]
    fn a_bright_layer_is_learned() {
        let scene = fog();
        for seed in 0..20 {
            let mut stream = Stream::new(seed, Purpose::Synthetic, 0, 0);
            // Nine tenths of them in the uppermost eighth.
            let up = |z: f64| if z < 0.1 { 8.75 * z } else { 0.875 + (z - 0.1) / 7.2 };
            let (media, _) = lit(18_000, &mut stream, up);
            let learned = learned(&scene, (&media, &[]), None, None, (seed, 0)).unwrap();
            let cell = |i: usize| DVec3::new((i % 8) as f64, (i / 8 % 8) as f64, (i / 64) as f64);
            let bright = |i: usize| learned.media.at(0.25 * cell(i) - 0.875);
            let (low, high): (f64, f64) = ((0..448).map(bright).sum(), (448..512).map(bright).sum());
            assert!((high / low - 9.0).abs() < 1.0, "{}", high / low);
        }
    }
}
