//! What a stratified slab is made of, and the light in it that has not met the medium.

use super::pile::{Passed, Pile, cosine};
use crate::adding_doubling::degrees;
use crate::beer_lambert::{direct_fluence, direct_transmittance};
use crate::error::{Result, within};
use crate::incidence::{Incidence, check_albedo};
use crate::phase::Phase;
use crate::quadrature::Adaptive;
use crate::slab_fresnel::check_index;
use crate::value::Value;
use libm::{exp, expm1};

/// Thickness of a layer, and the most of all layers together.
const THICKEST: f64 = 100.0;
const THICKEST_STACK: f64 = 400.0;

/// Light that starts in a layer thinner than this is not known well enough: see the first layer of a doubling.
const THINNEST_SOURCE: f64 = 1e-6;

/// A homogeneous layer of a stratified slab.
#[derive(Debug, Clone, PartialEq)]
pub struct Layer {
    pub(super) tau: f64,
    pub(super) albedo: f64,
    pub(super) phase: Phase,
    pub(super) emission: f64,
    pub(super) index: f64,
}

impl Layer {
    /// A layer without a source, of index 1.
    ///
    /// # Arguments
    /// `tau` optical thickness \[1\], 1e-12 to 100, or 0 of a plate that neither scatters nor absorbs; `albedo` 0 to 1, that
    /// of such a plate 0; `phase` any whose Legendre moments beyond l = 450 are below 1e-9
    /// # Errors
    /// `Error::OutOfRange` naming `tau`, `albedo` or the first moment left out
    pub fn new(tau: f64, albedo: f64, phase: &Phase) -> Result<Self> {
        check_albedo(albedo)?;
        if tau != 0.0 || albedo != 0.0 {
            within("tau", tau, 1e-12, THICKEST, "1e-12 to 100 in one layer, 0 in a clear plate of albedo 0")?;
        }
        degrees(phase)?;
        Ok(Layer { tau, albedo, phase: phase.clone(), emission: 0.0, index: 1.0 })
    }

    /// A plate that neither scatters nor absorbs.
    ///
    /// # Errors
    /// as for [`Self::refracting`]
    pub fn plate(index: f64) -> Result<Self> {
        Layer::new(0.0, 0.0, &Phase::isotropic())?.refracting(index)
    }

    /// The same of another index of refraction.
    ///
    /// # Arguments
    /// `index` over that of the medium above the slab \[1\], 0.25 to 4
    /// # Errors
    /// `Error::OutOfRange` naming `index`
    pub fn refracting(mut self, index: f64) -> Result<Self> {
        self.index = check_index(index)?;
        Ok(self)
    }

    /// The same with a source: light that starts evenly and in all directions.
    ///
    /// # Arguments
    /// `emission` power that starts per area and mean free path of depth, over the irradiance on the lit face \[1\], 0 to
    /// 1e12: 4 pi (1-w) B where the layer has the Planck radiance B; Q/sigma_t of Q per volume. Where `emission` is
    /// above 0, `tau` is 1e-6 or more
    /// # Errors
    /// `Error::OutOfRange` naming `emission` or `tau`
    pub fn emitting(mut self, emission: f64) -> Result<Self> {
        self.emission = within("emission", emission, 0.0, 1e12, "0 to 1e12")?;
        if emission > 0.0 {
            within("tau", self.tau, THINNEST_SOURCE, THICKEST, "1e-6 to 100 in a layer that emits")?;
        }
        Ok(self)
    }

    /// Optical thickness \[1\].
    pub fn tau(&self) -> f64 {
        self.tau
    }

    /// Single-scattering albedo \[1\].
    pub fn albedo(&self) -> f64 {
        self.albedo
    }

    /// How the layer scatters.
    pub fn phase(&self) -> &Phase {
        &self.phase
    }

    /// Power that starts per area and mean free path, over the irradiance on the lit face \[1\].
    pub fn emission(&self) -> f64 {
        self.emission
    }

    /// Index of refraction over that of the medium above the slab \[1\].
    pub fn index(&self) -> f64 {
        self.index
    }

    /// Whether light is neither scattered nor starts in it.
    fn is_plate(&self) -> bool {
        self.albedo == 0.0 && self.emission == 0.0
    }
}

/// What lies below the last layer.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ground {
    pub(super) mirror: bool,
    pub(super) reflectance: f64,
    pub(super) exitance: f64,
    pub(super) index: f64,
}

impl Ground {
    /// Nothing comes back.
    pub fn black() -> Self {
        Ground { mirror: false, reflectance: 0.0, exitance: 0.0, index: 1.0 }
    }

    /// Reflects the same radiance in all directions.
    ///
    /// # Errors
    /// `Error::OutOfRange` naming `ground`, its reflectance, unless 0 to 1
    pub fn lambertian(reflectance: f64) -> Result<Self> {
        Ok(Ground { reflectance: within("ground", reflectance, 0.0, 1.0, "0 to 1")?, ..Ground::black() })
    }

    /// Reflects everything, as a plane of symmetry does: the slab and its image below it.
    pub fn mirror() -> Self {
        Ground { mirror: true, reflectance: 1.0, ..Ground::black() }
    }

    /// Reflects a share of the light as a mirror does, from all directions alike.
    ///
    /// # Errors
    /// `Error::OutOfRange` naming `mirror`, its reflectance, unless 0 to 1
    pub fn specular(reflectance: f64) -> Result<Self> {
        Ok(Ground { reflectance: within("mirror", reflectance, 0.0, 1.0, "0 to 1")?, ..Ground::mirror() })
    }

    /// The same with light of its own, in all directions alike.
    ///
    /// # Arguments
    /// `exitance` power per area, over the irradiance on the lit face \[1\], 0 to 1e12, that of a mirror 0: pi (1-R) B of a
    /// ground of reflectance R and Planck radiance B
    /// # Errors
    /// `Error::OutOfRange` naming `exitance`
    pub fn emitting(mut self, exitance: f64) -> Result<Self> {
        self.exitance = match self.mirror {
            true => within("exitance", exitance, 0.0, 0.0, "0 of a mirror")?,
            false => within("exitance", exitance, 0.0, 1e12, "0 to 1e12")?,
        };
        Ok(self)
    }

    /// The same in a medium of another index: 1, that above the slab, is a gap of air; that of the last layer is none.
    ///
    /// # Errors
    /// `Error::OutOfRange` naming `index`
    pub fn within(mut self, index: f64) -> Result<Self> {
        self.index = check_index(index)?;
        Ok(self)
    }
}

/// Layers from the top down, the ground and the light.
pub(super) struct Problem {
    pub layers: Vec<Layer>,
    pub ground: Ground,
    pub incidence: Option<Incidence>,
    /// Depths of the interfaces, both faces included.
    pub depths: Vec<f64>,
}

const FACES: &str = "unscattered light between faces";

impl Problem {
    pub fn new(layers: &[Layer], ground: Ground, incidence: Option<Incidence>) -> Result<Self> {
        within("layers", layers.len() as f64, 1.0, 1000.0, "1 to 1000 of them")?;
        let mut depths = vec![0.0];
        depths.extend(layers.iter().scan(0.0, |depth, layer| {
            *depth += layer.tau;
            Some(*depth)
        }));
        let tau = depths[layers.len()];
        within("tau", tau, 0.0, THICKEST_STACK, "at most 400 in all layers together")?;
        let problem = Problem { layers: layers.to_vec(), ground, incidence, depths };
        if let Some(Incidence::Beam { mu0 }) = incidence {
            within("mu0", mu0, 1e-5, 1.0, "1e-5 to 1 with layers, or diffuse")?;
            let grazing = |n: f64| cosine(n, 1.0, mu0).is_some_and(|mu| mu < 1e-5);
            if problem.indices().into_iter().any(grazing) {
                within("mu0", mu0, 1.0, 1.0, "refracted to cosines of 1e-5 or more, or reflected whole")?;
            }
        }
        Ok(problem)
    }

    pub fn tau(&self) -> f64 {
        self.depths[self.layers.len()]
    }

    /// The layer that holds depth `t`, and how deep `t` is in it.
    pub fn place(&self, t: f64) -> (usize, f64) {
        let last = self.layers.len() - 1;
        let i = self.depths[1..=last].partition_point(|&depth| depth <= t);
        (i, (t - self.depths[i]).clamp(0.0, self.layers[i].tau))
    }

    /// Index of refraction of a layer, or of what lies below the last one.
    pub fn index(&self, layer: usize) -> f64 {
        self.layers.get(layer).map_or(self.ground.index, |layer| layer.index)
    }

    /// All indices of refraction, that above the slab included, in rising order.
    pub fn indices(&self) -> Vec<f64> {
        let mut all: Vec<f64> = (0..=self.layers.len()).map(|layer| self.index(layer)).collect();
        all.push(1.0);
        all.sort_by(f64::total_cmp);
        all.dedup();
        all
    }

    /// Whether there are faces that reflect.
    pub fn refracts(&self) -> bool {
        self.indices().len() > 1
    }

    /// Layers that scatter or shine.
    pub fn scattering(&self) -> Vec<usize> {
        (0..self.layers.len()).filter(|&layer| !self.layers[layer].is_plate()).collect()
    }

    /// Layers from `first` to before `end`, between what lies above and below them.
    pub fn part(&self, first: usize, end: usize) -> Pile {
        let mut indices = vec![if first == 0 { 1.0 } else { self.index(first - 1) }];
        indices.extend((first..=end).map(|layer| self.index(layer)));
        let taus = self.layers[first..end].iter().map(|layer| layer.tau).collect();
        let over_mirror = self.ground.mirror && end == self.layers.len();
        Pile { indices, taus, mirror: over_mirror.then_some(self.ground.reflectance) }
    }

    /// All layers, as light that is not scattered meets them.
    pub fn pile(&self) -> Pile {
        self.part(0, self.layers.len())
    }

    /// Cosine of the beam in a layer, its power per area downwards on the upper face and upwards on the lower one.
    pub fn beam(&self, layer: usize) -> Option<(f64, [f64; 2])> {
        let Some(Incidence::Beam { mu0 }) = self.incidence else { return None };
        let mu = cosine(self.index(layer), 1.0, mu0)?;
        Some((mu, self.pile().passed(|n| cosine(n, 1.0, mu0)).within[layer]))
    }

    /// Light that is reflected by the lit face before any enters.
    pub fn specular(&self) -> Result<Value> {
        self.mean(0.0, |passed, _| passed.specular)
    }

    /// Unscattered light that leaves through the lit face.
    pub fn reflected(&self) -> Result<Value> {
        self.mean(2.0, |passed, _| passed.reflected)
    }

    /// Unscattered light that arrives at the ground.
    pub fn arrived(&self) -> Result<Value> {
        match self.incidence {
            Some(incidence) if !self.refracts() && !self.ground.mirror => {
                direct_transmittance(incidence, self.tau())
            }
            _ => self.mean(2.0, |passed, _| passed.arrived),
        }
    }

    /// Integral over a layer of the fluence of unscattered light.
    pub fn dwelt(&self, layer: usize) -> Result<Value> {
        let (n, tau) = (self.index(layer), self.layers[layer].tau);
        self.mean(2.0, |passed, of| {
            let lost = of(n).map_or(0.0, |mu| -expm1(-tau / mu));
            passed.within[layer].iter().sum::<f64>() * lost
        })
    }

    /// Fluence, power downwards and upwards of unscattered light at depth x of a layer.
    pub fn direct(&self, layer: usize, x: f64) -> Result<[Value; 3]> {
        if let (Some(incidence), false, false) = (self.incidence, self.refracts(), self.ground.mirror) {
            let t = self.depths[layer] + x;
            let down = direct_transmittance(incidence, t)?;
            let fluence = match incidence {
                Incidence::Beam { mu0 } => down.scaled(1.0 / mu0),
                Incidence::Diffuse => Value::rounded(direct_fluence(incidence, t), 32.0, FACES),
            };
            return Ok([fluence, down, Value::rounded(0.0, 0.0, FACES)]);
        }
        let (n, rest) = (self.index(layer), self.layers[layer].tau - x);
        let of = |which: usize| {
            self.mean(2.0, move |passed, of| {
                let Some(mu) = of(n) else { return 0.0 };
                let [down, up] = passed.within[layer];
                let (down, up) = (down * exp(-x / mu), up * exp(-rest / mu));
                [(down + up) / mu, down, up][which]
            })
        };
        Ok([of(0)?, of(1)?, of(2)?])
    }

    /// What is made of the incident light, by direction: of the beam, or on average over Lambertian light.
    ///
    /// # Arguments
    /// `passages` of the slab in the longest way that counts, of which exponentials take their roundings
    fn mean(&self, passages: f64, f: impl Fn(&Passed, &dyn Fn(f64) -> Option<f64>) -> f64) -> Result<Value> {
        let pile = self.pile();
        let value = |from: f64, mu: f64| {
            let of = |n: f64| cosine(n, from, mu);
            f(&pile.passed(of), &of)
        };
        // n^2 - 1 of the quotient of two indices is good to a few roundings of the quotient.
        let faces: f64 = pile
            .indices
            .windows(2)
            .filter(|pair| pair[0] != pair[1])
            .map(|pair| 8.0 + 8.0 * pair[0].max(pair[1]) / (pair[0] - pair[1]).abs())
            .sum();
        let mut all = match self.incidence {
            None => return Ok(Value::rounded(0.0, 0.0, FACES)),
            Some(Incidence::Beam { mu0 }) => {
                let way = |(layer, n): (&Layer, &f64)| cosine(*n, 1.0, mu0).map_or(0.0, |mu| layer.tau / mu);
                let depth: f64 = self.layers.iter().zip(&pile.indices[1..]).map(way).sum();
                Value::rounded(value(1.0, mu0), 32.0 + 4.0 * passages * depth.min(800.0), FACES)
            }
            Some(Incidence::Diffuse) => {
                let indices: Vec<f64> = self.indices().into_iter().filter(|&n| n <= 1.0).collect();
                let mut sum = Value::rounded(0.0, 0.0, FACES);
                for (i, &n) in indices.iter().enumerate() {
                    let critical = if i == 0 { 1.0 } else { cosine(n, indices[i - 1], 0.0).unwrap_or(0.0) };
                    let mut breaks: Vec<f64> = (0..26).map(|k| critical * f64::powi(0.25, k)).collect();
                    breaks.push(0.0);
                    breaks.reverse();
                    let integrand =
                        |mu: f64| Ok(if mu > 0.0 { 2.0 * n * n * mu * value(n, mu) } else { 0.0 });
                    let part =
                        Adaptive::new(1e-15).integrate(&breaks, "unscattered light", FACES, integrand)?;
                    sum = sum.plus(part, FACES);
                }
                sum
            }
        };
        all.error += faces * f64::EPSILON * all.value.abs();
        Ok(all)
    }
}
