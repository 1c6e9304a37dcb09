//! Photons as points of light, seen from the camera: a picture of the maps themselves.

use super::Grid;
use turbid::Spectrum;
use turbid::math::Ray;
use turbid::photons::PhotonMap;
use turbid::scene::{Camera, Scene};

/// What the photons of a map add to each pixel, row by row from the top: their colours, without regard to power but for the
/// ratio of the channels, so that every photon is one dot. Photons behind a body are hidden.
pub fn dots<'a>(scene: &Scene, camera: &Camera, maps: impl Iterator<Item = &'a PhotonMap>) -> Vec<Spectrum> {
    let grid = Grid { width: camera.width() as usize, height: camera.height() as usize };
    let mut picture = vec![Spectrum::ZERO; grid.pixels()];
    for photon in maps.flat_map(|map| map.tree().photons()) {
        let Some((x, y)) = camera.pixel(photon.position) else { continue };
        let towards = photon.position - camera.position();
        let distance = towards.length();
        let hit = scene.hit(&Ray::new(camera.position(), towards / distance), None);
        // Positions are kept in single precision: a photon may lie behind its own surface by that much.
        let is_hidden = hit.is_some_and(|found| found.hit.t < distance * (1.0 - 1e-3));
        let largest = photon.power.max_element();
        if !is_hidden && largest > 0.0 {
            picture[y as usize * grid.width + x as usize] += Spectrum((photon.power / largest).as_dvec3());
        }
    }
    picture
}
