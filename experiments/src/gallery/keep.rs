//! Pictures kept between runs: resumable, one file a render.
//!
//! A file is a line of JSON, planes of single-precision numbers, and the digest of everything before it: a file that was
//! cut short, or changed, is not taken.

use crate::harness::Digest;
use anyhow::{Context, ensure};
use serde::{Deserialize, Serialize};
use std::path::Path;
use turbid::Spectrum;
use turbid::integrators::mapper::Gathers;
use turbid::integrators::{Layer, Layers};
use turbid::output::write_atomically;

/// The version of the files.
pub const FORMAT: u32 = 2;

fn first_format() -> u32 {
    1
}

/// Larger files are no pictures.
const MOST_BYTES: u64 = 1 << 32;

/// The estimates of a picture from one map.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MapEstimates {
    /// Photons asked for.
    pub asked: u64,
    /// How many estimates were made.
    pub count: u64,
    /// Mean number of photons found within the largest radius; 0 of no estimates.
    pub found: f64,
    /// Share of the estimates that are under-full: they found fewer than were asked for.
    pub underfull: f64,
}

impl MapEstimates {
    /// From the counts of a render.
    pub fn new(asked: Option<usize>, gathers: &Gathers) -> Self {
        let of_all = |n: u64| n as f64 / gathers.count.max(1) as f64;
        let (found, underfull) = (of_all(gathers.found), of_all(gathers.underfull));
        MapEstimates { asked: asked.unwrap_or(0) as u64, count: gathers.count, found, underfull }
    }
}

/// What is known of a render beside its pixels.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RenderRecord {
    /// [`FORMAT`] when it was made; 1 where it is not stated.
    #[serde(default = "first_format")]
    pub format: u32,
    /// What it is, in words: two renders of equal words and equal program are equal.
    pub words: String,
    /// Digest of the program that made it.
    pub program: String,
    /// CPU seconds, filling the maps among them.
    pub seconds: f64,
    /// Of them, filling the maps.
    pub map_seconds: f64,
    /// Samples a pixel.
    pub samples: u64,
    /// Photons emitted by the two passes.
    pub emitted: [u64; 2],
    /// Photons stored: global, caustic, volume.
    pub stored: [u64; 3],
    /// Mean radius of gathers: global, caustic, volume \[L\].
    pub radii: [f64; 3],
    /// Estimates from the global, caustic and volume map; none of paths, and of renders of format 1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub estimates: Option<[MapEstimates; 3]>,
}

/// A picture by layers.
#[derive(Debug, Clone, PartialEq)]
pub struct CachedRender {
    /// What is known of it.
    pub facts: RenderRecord,
    /// Radiance, row by row from the top.
    pub total: Vec<Spectrum>,
    /// Radiance of what is seen straight, or through specular surfaces alone.
    pub emission: Vec<Spectrum>,
    /// Radiance by class; empty if it is not kept.
    pub layers: Vec<Layers>,
}

impl CachedRender {
    /// Radiance by class and pixel, with its facts.
    pub fn new(facts: RenderRecord, layers: Vec<Layers>) -> Self {
        let total = layers.iter().map(|l| l.total()).collect();
        let emission = layers.iter().map(|l| l.emission).collect();
        CachedRender { facts, total, emission, layers }
    }

    /// The same without its classes: what is only compared needs none.
    pub fn without_layers(mut self) -> Self {
        self.layers = Vec::new();
        self
    }

    /// Radiance without light that is seen straight, or through specular surfaces alone: every method counts that alike,
    /// and the noise of its edges would hide all else.
    pub fn scattered(&self) -> Vec<Spectrum> {
        self.total.iter().zip(&self.emission).map(|(total, emission)| *total - *emission).collect()
    }

    /// The bytes of its file.
    fn bytes(&self) -> anyhow::Result<Vec<u8>> {
        let mut bytes = serde_json::to_vec(&self.facts)?;
        bytes.push(b'\n');
        let mut plane = |values: &mut dyn Iterator<Item = Spectrum>| {
            for s in values {
                for c in 0..3 {
                    bytes.extend((s[c] as f32).to_le_bytes());
                }
            }
        };
        plane(&mut self.total.iter().copied());
        plane(&mut self.emission.iter().copied());
        if !self.layers.is_empty() {
            for layer in Layer::ALL {
                plane(&mut self.layers.iter().map(|l| l[layer]));
            }
        }
        let digest = Digest::of(&bytes).to_string();
        bytes.extend(digest.as_bytes());
        Ok(bytes)
    }

    /// Writes its file.
    pub fn write(&self, path: &Path) -> anyhow::Result<()> {
        let bytes = self.bytes()?;
        write_atomically(path, |out| out.write_all(&bytes))?;
        Ok(())
    }

    /// Reads a file of a picture of so many pixels.
    pub fn read(path: &Path, pixels: usize) -> anyhow::Result<Self> {
        let bytes = turbid::input::read(path, MOST_BYTES)
            .with_context(|| format!("cannot read {}", path.display()))?;
        CachedRender::parse(&bytes, pixels)
            .with_context(|| format!("{} is not a complete picture", path.display()))
    }

    fn parse(bytes: &[u8], pixels: usize) -> anyhow::Result<Self> {
        let mark = Digest::of(&[]).to_string().len();
        let body = bytes.len().checked_sub(mark).context("the end mark is missing")?;
        let (body, end) = bytes.split_at(body);
        ensure!(end == Digest::of(body).to_string().as_bytes(), "the digest does not fit");
        let first = body.iter().position(|&b| b == b'\n').context("the first line is missing")?;
        let facts: RenderRecord = serde_json::from_slice(&body[..first])?;
        ensure!(facts.format == FORMAT, "its format is {}, not {FORMAT}", facts.format);
        let numbers = &body[first + 1..];
        let planes = numbers.len() / (12 * pixels).max(1);
        ensure!(
            numbers.len() == 12 * pixels * planes && [2, 2 + Layer::ALL.len()].contains(&planes),
            "its size does not fit {pixels} pixels"
        );
        let value = |plane: usize, pixel: usize| {
            let at = 12 * (plane * pixels + pixel);
            let one = |c: usize| {
                let bytes = [0, 1, 2, 3].map(|k| numbers[at + 4 * c + k]);
                f64::from(f32::from_le_bytes(bytes))
            };
            Spectrum::rgb(one(0), one(1), one(2))
        };
        let layered = |pixel: usize| {
            let mut layers = Layers::ZERO;
            for (n, layer) in Layer::ALL.into_iter().enumerate() {
                layers[layer] = value(2 + n, pixel);
            }
            layers
        };
        let layers = if planes > 2 { (0..pixels).map(layered).collect() } else { Vec::new() };
        let plane = |number: usize| (0..pixels).map(|i| value(number, i)).collect();
        Ok(CachedRender { facts, total: plane(0), emission: plane(1), layers })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn kept(has_layers: bool) -> CachedRender {
        let facts = RenderRecord {
            format: FORMAT,
            words: "box, paths".into(),
            program: "00".into(),
            seconds: 1.5,
            map_seconds: 0.25,
            samples: 4,
            emitted: [10, 20],
            stored: [1, 2, 3],
            radii: [0.5, 0.25, 0.125],
            estimates: has_layers.then(|| [MapEstimates::new(Some(7), &Gathers::default()); 3]),
        };
        let total = vec![Spectrum::rgb(1.0, 0.5, -0.25), Spectrum::grey(3.0)];
        let mut layers = vec![Layers::ZERO; 2];
        layers[1].multiple = Spectrum::rgb(0.0, 8.0, 0.125);
        let emission = vec![Spectrum::ZERO, Spectrum::grey(1.0)];
        let layers = if has_layers { layers } else { Vec::new() };
        CachedRender { facts, total, emission, layers }
    }

    #[test]
    fn a_picture_comes_back() {
        let folder = tempfile::tempdir().unwrap();
        for has_layers in [false, true] {
            let path = folder.path().join("a.picture");
            kept(has_layers).write(&path).unwrap();
            assert_eq!(CachedRender::read(&path, 2).unwrap(), kept(has_layers));
            assert!(CachedRender::read(&path, 3).is_err());
        }
    }

    /// Eight estimates of 50 photons, of which three found 10 and the others 50.
    #[test]
    fn what_is_found_is_counted_by_estimate() {
        let gathers = Gathers { count: 8, underfull: 3, found: 280, ..Gathers::default() };
        let expected = MapEstimates { asked: 50, count: 8, found: 35.0, underfull: 0.375 };
        assert_eq!(MapEstimates::new(Some(50), &gathers), expected);
        assert_eq!(MapEstimates::new(None, &Gathers::default()).found, 0.0);
    }

    #[test]
    fn light_seen_directly_is_left_out() {
        let kept = kept(false);
        assert_eq!(kept.scattered(), [kept.total[0], Spectrum::grey(2.0)]);
    }

    #[test]
    fn every_cut_and_every_changed_byte_is_seen() {
        let bytes = kept(true).bytes().unwrap();
        assert!((0..bytes.len()).all(|n| CachedRender::parse(&bytes[..n], 2).is_err()));
        for i in 0..bytes.len() {
            let mut bytes = bytes.clone();
            bytes[i] ^= 1;
            assert!(CachedRender::parse(&bytes, 2).is_err(), "byte {i}");
        }
    }
}
