//! How far light goes, learned from photons: how bright it is in the cells of a grid, and how many flights to lead there.
//!
//! The second moment of what a flight brings is the sum over its ends of P (b^2 + v bm^2) / (share b/bm + 1 - share), P the
//! probability of its own, b the brightness, bm their mean, v the noise of what is found there: as of directions, from photons in three
//! parts, so that chance is no gain. Each flight's is taken over its mean squared, and flights start where photons collided.

use super::PARTS;
use super::choice::{LEFT, NOISE, SHARES};
use crate::math::warp;
use crate::photons::Photon;
use crate::rng::{Purpose, Stream};
use crate::scene::Scene;
use crate::transport::{Brightness, BrightnessGrid};
use crate::{Spectrum, math::Ray};
use glam::{DVec2, DVec3};

/// Flights whose second moments are taken.
const FLIGHTS: usize = 2000;

/// What a photon tells of the brightness about it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Lit {
    position: DVec3,
    /// Unit normal of the surface; 0 in a medium.
    normal: DVec3,
    /// In a medium its power over the extinction, on a surface four times its power: what is scattered or reflected evenly is by this
    /// as bright in both, per volume there and per area here.
    value: f64,
    part: usize,
}

impl Lit {
    pub fn in_medium(scene: &Scene, photon: &Photon, part: usize) -> Option<Self> {
        let sigma_t = scene.medium_at(photon.position)?.sigma_t(photon.position);
        let over = |channel: usize| {
            if sigma_t[channel] > 0.0 { f64::from(photon.power[channel]) / sigma_t[channel] } else { 0.0 }
        };
        let value = (0..3).map(over).sum();
        Some(Lit { position: photon.position, normal: DVec3::ZERO, value, part })
    }

    pub fn on_surface(photon: &Photon, part: usize) -> Self {
        let value = 4.0 * f64::from(photon.power.element_sum());
        Lit { position: photon.position, normal: photon.normal.as_dvec3(), value, part }
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
        let across = one.normal.abs();
        let per = match across == DVec3::ZERO {
            true => scale.element_product(),
            false => scale.element_product() / scale[across.max_position()],
        };
        grids[0].add(one.position, one.value * per);
        grids[1 + one.part].add(one.position, PARTS as f64 * one.value * per);
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
    let share = share.or_else(|| best(scene, media, &by[1..], (seed, replicate)))?;
    let all = by.swap_remove(0);
    Some(Brightness { share, ..all })
}

/// The share by which the second moment of flights is least, if that gains enough.
fn best(scene: &Scene, media: &[Lit], parts: &[Brightness], (seed, replicate): (u64, u64)) -> Option<f64> {
    let mut moments = [0.0; 1 + SHARES.len()];
    for number in 0..FLIGHTS.min(media.len()) {
        // Histories are numbered from 0.
        let mut stream = Stream::new(seed, Purpose::Guide, replicate, u64::MAX - number as u64);
        let position = media[number * media.len() / FLIGHTS.min(media.len())].position;
        let ray = Ray::new(position, warp::square_to_sphere(stream.pair()).normalize());
        let hit = scene.hit(&ray, None);
        let end = hit.map_or(f64::INFINITY, |found| found.hit.t);
        let segments = scene.segments(&ray, end, scene.interior_at(position));
        let ends = |part: &Brightness| part.ends(scene, &ray, (hit.as_ref(), &segments), Spectrum::ONE);
        let [Some(a), Some(b), Some(c)] = [0, 1, 2].map(|part| ends(&parts[part])) else { continue };
        let mean = |of: &dyn Fn(usize) -> f64| -> f64 {
            a.ways().iter().enumerate().map(|(way, (own, _))| own * of(way)).sum()
        };
        for (guide, one, other) in [(&a, &b, &c), (&b, &c, &a), (&c, &a, &b)] {
            let [one, other] = [one.ways(), other.ways()];
            let noise = NOISE * mean(&|way| one[way].1) * mean(&|way| other[way].1);
            if noise == 0.0 {
                continue;
            }
            for (moment, share) in moments.iter_mut().zip([0.0].iter().chain(&SHARES)) {
                let second = mean(&|way| {
                    (one[way].1 * other[way].1 + noise) / guide.more_often(guide.ways()[way].1, *share)
                });
                *moment += second / noise;
            }
        }
    }
    let (number, least) =
        moments.iter().enumerate().skip(1).min_by(|(_, a), (_, b)| a.total_cmp(b)).map(|(n, m)| (n, *m))?;
    (least < LEFT * moments[0]).then(|| SHARES[number - 1])
}
