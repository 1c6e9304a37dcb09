//! Binary Markov mixtures: two materials in turn along an axis, with exponential chords.

use crate::error::{Error, Result};
use crate::math::{Positive, ln_1p};
use crate::rng::{Purpose, Stream};

/// The most layers, in the mean.
const MOST: f64 = 1e6;

/// One realisation: the edges of the layers \[L\], from `from` to `to`, and the material of each, 0 or 1.
///
/// Chords of material i are exponential with mean l_i. What is first has the probability of its material at any point,
/// l_i/(l_0 + l_1): an exponential has no memory, so that its rest is one too, and the mixture looks the same from everywhere.
///
/// # Arguments
/// `mean_chords` l_0 and l_1 \[L\]; `seed` is the realisation
/// # Errors
/// `Error::OutOfRange` for ends that are not finite or do not rise, and for more than 1e6 layers in the mean
pub fn markov(
    (from, to): (f64, f64),
    mean_chords: [Positive; 2],
    seed: u64,
) -> Result<(Vec<f64>, Vec<usize>)> {
    if !(from.is_finite() && to.is_finite() && from < to) {
        return Err(Error::out_of_range("to of a Markov mixture", to, "finite and above from"));
    }
    let chords = mean_chords.map(Positive::get);
    let layers = 2.0 * (to - from) / (chords[0] + chords[1]);
    // A quotient that is not a number is above all.
    if layers.total_cmp(&MOST).is_gt() {
        return Err(Error::out_of_range("layers of a Markov mixture in the mean", layers, "at most 1e6"));
    }
    let mut stream = Stream::new(seed, Purpose::Mixture, 0, 0);
    let mut material = usize::from(stream.unit() * (chords[0] + chords[1]) >= chords[0]);
    let (mut edges, mut materials) = (vec![from], vec![material]);
    let mut at = from;
    loop {
        at -= chords[material] * ln_1p(-stream.unit());
        if at >= to {
            edges.push(to);
            return Ok((edges, materials));
        }
        material = 1 - material;
        // A chord below the rounding of its place is none.
        if edges.last().is_some_and(|last| at > *last) {
            edges.push(at);
            materials.push(material);
        } else if let Some(last) = materials.last_mut() {
            *last = material;
        }
    }
}
