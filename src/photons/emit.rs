//! Emission: a photon from one of the lights, chosen in proportion to power.

use crate::Spectrum;
use crate::rng::Stream;
use crate::scene::{Scene, Start, Target};
use crate::transport::Walker;

/// A photon from one of the lights, chosen in proportion to power; it carries the power of all of them \[W\], in the
/// colour of its own.
///
/// # Arguments
/// `power` of all lights, [`Scene::power`], which the caller asks for once
pub fn emit(scene: &Scene, power: Spectrum, stream: &mut Stream) -> Walker {
    let (lights, stage) = (scene.lights(), scene.stage());
    let total = power.sum();
    let mut index = 0;
    if lights.len() > 1 {
        let mut target = stream.unit() * total;
        while index + 1 < lights.len() && target >= lights[index].power(stage).sum() {
            target -= lights[index].power(stage).sum();
            index += 1;
        }
    }
    let emission = lights[index].emit(stage, stream);
    let weight =
        if lights.len() > 1 { emission.power * (total / emission.power.sum()) } else { emission.power };
    let from = lights[index].body().map(|_| Start { target: Target::Light(index), primitive: 0 });
    let within = scene.interior_of_light(index, emission.ray.origin);
    Walker { from, within, ..Walker::new(emission.ray, weight) }
}
