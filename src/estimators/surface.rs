//! Estimates on a surface.

use super::point::{Counting, LaneSum, Weighted};
use super::{Estimate, Gather, Kernel};
use crate::faults::{Fault, planted};
use crate::photons::PhotonMap;
use crate::photons::tree::{Nearest, Neighbors, ROW, Tangent};
use crate::spectrum::Spectrum;
use glam::DVec3;
use wide::f32x8;

/// Irradiance at a point of a surface [W/L^2], on the side of the tangent's normal: sum p K_r / N over the photons that
/// the tangent accepts, K_r of unit integral over the disc.
///
/// Rejected photons set no radius and count nowhere; `found` is the number of accepted ones. A diffuse surface of
/// reflectance rho reflects rho/pi of the value into every direction.
///
/// # Limits
/// The sum is that of a whole disc: where the accepted surface is less, at an edge, on a curved body or beside one that
/// covers it, it is to be divided by the integral of K_r over the accepted surface ([`disc_share`](super::disc_share),
/// [`cap_share`](super::cap_share)). Undivided it loses 2r/(3 pi) of the irradiance along each edge, in depth, for the
/// uniform kernel, and nearly all of it on a sphere much smaller than r.
///
/// # Source
/// Jensen 1996; the k-1 of the k-nearest rule is Loftsgaarden and Quesenberry 1965.
pub fn irradiance(
    map: &PhotonMap,
    point: DVec3,
    tangent: &Tangent,
    kernel: Kernel,
    gather: Gather,
) -> Estimate {
    weighted(map, point, tangent, kernel, gather, |_| f32x8::ONE)
}

/// The same sum over those photons alone whose place `is_seen` accepts: all of them set the radius. With k-1 places that
/// are independent inside the radius of the k-th, the part of them that is seen is unbiased for the seen part of the
/// surface.
pub fn irradiance_seen(
    map: &PhotonMap,
    point: DVec3,
    tangent: &Tangent,
    kernel: Kernel,
    gather: Gather,
    is_seen: impl Fn(DVec3) -> bool,
) -> Estimate {
    let tree = map.tree();
    weighted(map, point, tangent, kernel, gather, |neighbors| {
        let mut lanes = [0.0; ROW];
        for (lane, place) in neighbors.places() {
            lanes[lane] = if is_seen(tree.photon(place).position) { 1.0 } else { 0.0 };
        }
        f32x8::new(lanes)
    })
}

#[inline(always)]
fn weighted(
    map: &PhotonMap,
    point: DVec3,
    tangent: &Tangent,
    kernel: Kernel,
    gather: Gather,
    weight: impl Fn(&Neighbors<'_>) -> f32x8,
) -> Estimate {
    let tree = map.tree();
    let mut sum = Weighted { kernel, weight, sum: LaneSum::default() };
    let (k, cap, counted) = gather.rule();
    let shell = k.map(|k| tree.nearest_facing(point, tangent, k.get(), cap, counted, &mut sum));
    let (radius, found, underfull, coincident) = match shell {
        Some(Nearest::Found(shell)) => (shell.radius, shell.closer + shell.tied, false, shell.coincident),
        _ => {
            let mut counting = Counting { found: 0, visitor: &mut sum };
            tree.within_facing(point, tangent, cap, &mut counting);
            (cap, counting.found, k.is_some(), 0)
        }
    };
    let emitted = if planted(Fault::StoredOnSurfaces) { map.stored() as u64 } else { map.emitted() };
    // No photon is near a point that is not finite; that is no darkness.
    let nowhere = if point.is_finite() { 0.0 } else { f64::NAN };
    let scale = kernel.disc_peak() / (radius * radius * emitted as f64);
    Estimate {
        value: (sum.sum.total() + Spectrum::grey(nowhere)) * scale,
        radius,
        found,
        underfull,
        coincident,
        rejected: 0,
    }
}
