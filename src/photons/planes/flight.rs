//! The plane of a flight: every flight has one, wherever it ended.

use super::Plane;
use crate::error::{Error, Result};
use crate::math::{Ray, ln_1p};
use crate::photons::beams::Beam;
use crate::rng::Stream;
use crate::scene::Scene;

/// Checks that planes can be stored of flights through a scene's media.
///
/// # Errors
/// `Error::Scene` where a medium varies, extinction differs by channel, or bodies are of glass
pub fn check_planes(scene: &Scene) -> Result<()> {
    let is_even = scene.media().iter().all(|medium| medium.is_homogeneous() && medium.has_grey_extinction());
    match is_even && !scene.plan().has_dielectrics {
        true => Ok(()),
        false => Err(Error::Scene(
            "planes can be stored neither in media that vary or whose extinction differs by channel, nor beside dielectric bodies, index-matched ones among them; \
             allowed: beams (a beam radius), points along rays (a ray radius), or points in balls"
                .into(),
        )),
    }
}

/// Draws the second leg: a direction, and how deep it goes. The flight need not have been scattered: a plane stands for what would be
/// all along it, and only planes of every flight together know what passes.
pub(in crate::photons) fn second_leg(scene: &Scene, leg: Beam, stream: &mut Stream) -> Plane {
    let medium = scene.medium(leg.medium as usize);
    let dir = medium.phase().scatter(leg.dir, stream.pair());
    let depth = -ln_1p(-stream.unit());
    let room = room(scene, &leg, dir);
    // Regions are convex: alone, one is all about its second legs.
    let reach = match scene.media().len() {
        1 => room.min(depth / medium.matter().sigma_t()[0]),
        _ => room,
    };
    Plane { leg, dir, depth, reach }
}

/// How far from a flight media reach in a direction, at most \[L\]: across all of them, or out of the last slab, which is linear in where
/// on the flight it starts.
fn room(scene: &Scene, leg: &Beam, dir: glam::DVec3) -> f64 {
    if let Some(bounds) = scene.bounds() {
        let way = (leg.at(0.5 * leg.length) - bounds.center()).length();
        return way + 0.5 * leg.length + bounds.radius();
    }
    let ends = [0.0, leg.length].map(|t| Ray::new(leg.at(t), dir));
    let exits = scene.regions().iter().flat_map(|region| ends.map(|ray| region.shape.interval(&ray)));
    exits.flatten().fold(0.0, |most, inside| most.max(inside.end))
}
