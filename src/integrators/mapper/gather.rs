//! The final gathering: indirect light of a diffuse surface by rays that read the maps one bounce away.
//!
//! A ray in a direction of density cos/pi brings pi times the radiance along it as irradiance. The ray flies as far as
//! a photon would. If it collides, it brings what the medium scatters there: single scattering by shadow rays and the
//! volume map; planes are read along all of its way in place of that map. If it passes, it brings what the diffuse surface
//! behind reflects, from the global map, which holds every class of light there, direct light too. What it meets of lights
//! themselves, straight or by specular surfaces, is direct light and caustics of the surface where it starts, and is left out.

use super::surface::Diffuse;
use super::{Mapper, ROULETTE, Report};
use crate::Spectrum;
use crate::math::{Frame, warp};
use crate::rng::Stream;
use crate::transport::{Arrival, Roulette, Step, Visitor, Walker, walk};
use std::f64::consts::PI;

impl Mapper<'_> {
    /// Indirect irradiance of a diffuse point [W/L^2] by `count` rays, one in each cell of a grid over the directions.
    pub(super) fn gathered(
        &self,
        diffuse: &Diffuse<'_>,
        count: u32,
        report: &mut Report,
        stream: &mut Stream,
    ) -> Spectrum {
        let frame = Frame::new(diffuse.normals.shading);
        let [rows, columns] = cells(count);
        let mut sum = Spectrum::ZERO;
        for cell in 0..rows * columns {
            let [u, v] = stream.pair();
            let u = (f64::from(cell / columns) + u) / f64::from(rows);
            let v = (f64::from(cell % columns) + v) / f64::from(columns);
            let dir = frame.to_world(warp::square_to_cosine_hemisphere([u, v])).normalize();
            let mut onwards = diffuse.normals.leaves(dir).then(|| (diffuse.leaving(dir), Spectrum::ONE));
            // In a bright corner there may be thousands, one behind the other.
            while let Some((start, weight)) = onwards {
                report.gathering += 1;
                let mut ray =
                    GatherRay { mapper: self, report, weight, found: Spectrum::ZERO, onwards: None };
                walk(self.scene, start, Roulette::below(ROULETTE), Some(1), stream, &mut ray);
                sum += ray.found;
                onwards = ray.onwards;
            }
        }
        sum * (PI / f64::from(count))
    }
}

/// The grid of so many cells that is nearest to a square.
fn cells(count: u32) -> [u32; 2] {
    let mut rows = f64::from(count).sqrt() as u32;
    while rows > 1 && !count.is_multiple_of(rows) {
        rows -= 1;
    }
    let rows = rows.max(1);
    [rows, count / rows]
}

/// A ray of a final gathering.
struct GatherRay<'a, 'm, 'r> {
    mapper: &'m Mapper<'a>,
    report: &'r mut Report,
    /// What it counts.
    weight: Spectrum,
    found: Spectrum,
    /// The ray that takes its place where what it met is near, and its weight.
    onwards: Option<(Walker, Spectrum)>,
}

impl GatherRay<'_, '_, '_> {
    /// What a diffuse surface reflects back along the ray.
    fn surface(&mut self, diffuse: &Diffuse<'_>, stream: &mut Stream) {
        let (maps, settings) = (self.mapper.maps, self.mapper.settings);
        if diffuse.reflectance.is_black() {
            return;
        }
        let Some(global) = &maps.global else { return };
        let mut reflected = self.weight * diffuse.walker.weight * diffuse.reflectance / PI;
        let arriving = if diffuse.found.hit.t < settings.near {
            // Where everything is near, rays would be traced on for ever: as many go on as the surface reflects.
            let kept = diffuse.reflectance.max().min(1.0);
            if stream.unit() >= kept {
                return;
            }
            reflected = reflected / kept;
            // Every class again, each by its own means.
            let mut sum = diffuse.direct(self.mapper, self.report, stream);
            if let Some(map) = &maps.caustic {
                sum +=
                    diffuse.irradiance(self.mapper, map, settings.caustic, &mut self.report.caustic, stream);
            }
            let dir = warp::square_to_cosine_hemisphere(stream.pair());
            let dir = Frame::new(diffuse.normals.shading).to_world(dir).normalize();
            self.onwards = diffuse.normals.leaves(dir).then(|| (diffuse.leaving(dir), reflected * PI));
            sum
        } else {
            diffuse.irradiance(self.mapper, global, settings.global, &mut self.report.global, stream)
        };
        self.found += reflected * arriving;
    }
}

impl Visitor for GatherRay<'_, '_, '_> {
    const LOOKS_AHEAD: bool = false;
    const CARRIES_RADIANCE: bool = true;

    fn visit(&mut self, walker: &Walker, step: Step, stream: &mut Stream) {
        match step {
            Step::Ahead(hit) if walker.order == 0 => {
                self.report.rays.segments += 1;
                if self.mapper.settings.volume.has_planes {
                    let end = hit.map_or(f64::INFINITY, |found| found.hit.t);
                    let multiple = self.mapper.all_along(walker, end, self.report, stream);
                    self.found += self.weight * walker.weight * multiple;
                }
            }
            Step::Collision(Arrival { walker, position }, number) => {
                let single = self.mapper.single(walker, position, number, self.report, stream);
                let (multiple, _) = self.mapper.multiple(walker, position, number, self.report);
                self.found += self.weight * walker.weight * (single + multiple);
            }
            Step::Surface(Arrival { walker, .. }, found) => {
                if let Some(diffuse) = Diffuse::met(self.mapper, walker, found) {
                    self.surface(&diffuse, stream);
                }
            }
            _ => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use super::cells;

    #[test]
    fn cells_are_nearly_square() {
        assert_eq!(
            [1, 2, 4, 7, 12, 64, 100].map(cells),
            [[1, 1], [1, 2], [2, 2], [1, 7], [3, 4], [8, 8], [10, 10]]
        );
    }
}
