//! Radiance of a homogeneous slab by photon maps, and what their balls make of the exact one.
//!
//! In a slab only depths matter: with k(z) = (3/4)(1 - z^2) the section of a ball of radius r, a map is expected to find the
//! in-scattered radiance int k(z) J(t + r z) dz, J nothing outside the slab. Along a ray of cosine mu to depth t from its far
//! face, at depth f, it collects
//!
//! int k(z) \[I(t + r z) - e^(-|t - f|/|mu|) I(f + r z)\] dz,
//!
//! I the exact radiance, continued behind the face where light leaves by e^(-distance/|mu|) and behind the far face by 0. So
//! the loss at faces and the blur within are both predicted, exactly.

use super::scene::Bench;
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::f64::consts::PI;
use turbid::scene::Scene;
use turbid::stats::Moments;
use turbid_analytic::StratifiedSlab;
use turbid_analytic::quadrature::GaussLegendre;

/// Radius of the balls in which photons are counted, in mean free paths.
pub const RADIUS: f64 = 0.25;

/// Nodes of each part of a ball: three times as many change no prediction by 1e-4 of it (tested).
const NODES: usize = 8;

/// A sensor that looks against light that travels at a cosine, positive downwards, and at an azimuth from that of the beam.
pub fn sensor(t: f64, mu: f64, azimuth: f64) -> String {
    let sine = libm::sqrt(1.0 - mu * mu);
    let (x, y) = (-sine * libm::cos(azimuth), -sine * libm::sin(azimuth));
    format!(
        "\n[[sensors]]\nname = \"depth {t}, cosine {mu}, azimuth {azimuth:.3}\"\nmeasure = {{ radiance = {{ origin = [0.5, 0.5, {t:?}], dir = [{x:?}, \
         {y:?}, {:?}] }} }}\n",
        -mu
    )
}

/// Azimuths with their weights, whose mean is that over so many in a circle: symmetric about the plane of the beam, all but the
/// first and the last count twice. One where the light is symmetric.
pub fn azimuths(count: usize) -> Vec<(f64, f64)> {
    let of = |i: usize| {
        let twice = i > 0 && 2 * i < count;
        (2.0 * PI * i as f64 / count as f64, f64::from(1 + u8::from(twice)) / count as f64)
    };
    (0..=count / 2).map(of).collect()
}

/// Means over the sensors of each group, with their weights, over independent maps that all sensors share: value and standard error.
///
/// # Errors
/// Those of the photon pass
pub fn means(
    bench: &Bench,
    scene: &Scene,
    photons: u64,
    groups: &[Vec<f64>],
) -> anyhow::Result<Vec<(f64, Option<f64>)>> {
    let maps = bench.each_map(scene, photons, RADIUS)?;
    let mut first = 0;
    let of = |weights: &Vec<f64>| {
        let range = first..first + weights.len();
        first = range.end;
        let of_map = |map: &Vec<f64>| {
            map[range.clone()]
                .iter()
                .zip(weights)
                .map(|(value, weight)| value * weight)
                .fold(0.0, |a, b| a + b)
        };
        let moments: Moments = maps.iter().map(of_map).collect();
        (moments.mean(), Some(moments.std_error()).filter(|_| !moments.is_heavy_tailed()))
    };
    Ok(groups.iter().map(of).collect())
}

/// The exact scattered radiance of a slab at some cosines, positive downwards, averaged over azimuth.
pub struct Views<'a> {
    slab: &'a StratifiedSlab,
    cosines: Vec<f64>,
    /// What is known already, by the bits of the depth.
    known: RefCell<BTreeMap<u64, Vec<f64>>>,
}

impl<'a> Views<'a> {
    /// None of it is known yet.
    pub fn new(slab: &'a StratifiedSlab, cosines: &[f64]) -> Self {
        Views { slab, cosines: cosines.to_vec(), known: RefCell::default() }
    }

    /// The exact radiance at a depth, one a cosine.
    ///
    /// # Errors
    /// Those of the referee
    pub fn exact(&self, t: f64) -> anyhow::Result<Vec<f64>> {
        if let Some(known) = self.known.borrow().get(&t.to_bits()) {
            return Ok(known.clone());
        }
        let up: Vec<f64> = self.cosines.iter().map(|mu| -mu).collect();
        let values: Vec<f64> = self.slab.radiance(t, &up)?.iter().map(|v| v.value).collect();
        self.known.borrow_mut().insert(t.to_bits(), values.clone());
        Ok(values)
    }

    /// What a map expects at a depth, one a cosine.
    ///
    /// # Errors
    /// Those of the referee
    pub fn blurred(&self, t: f64) -> anyhow::Result<Vec<f64>> {
        self.by_nodes(t, NODES)
    }

    fn by_nodes(&self, t: f64, nodes: usize) -> anyhow::Result<Vec<f64>> {
        let tau = self.slab.tau();
        let gauss = GaussLegendre::new(nodes)?;
        // Kinks where a depth crosses a face.
        let mut edges = vec![-1.0, 0.0, 1.0];
        edges.extend([-t, tau - t, -tau, tau].map(|d| d / RADIUS).into_iter().filter(|z| z.abs() < 1.0));
        edges.sort_by(f64::total_cmp);
        edges.dedup();
        let of = |i: usize| {
            let far = if self.cosines[i] < 0.0 { tau } else { 0.0 };
            let behind = libm::exp(-libm::fabs(t - far) / libm::fabs(self.cosines[i]));
            let value = |z: f64| -> anyhow::Result<f64> {
                let (near, far) = (self.continued(t + RADIUS * z, i)?, self.continued(far + RADIUS * z, i)?);
                Ok(0.75 * (1.0 - z * z) * (near - behind * far))
            };
            let piece = |edge: &[f64]| gauss.integrate(edge[0], edge[1], |z| value(z).unwrap_or(f64::NAN));
            edges.windows(2).map(piece).fold(0.0, |a, b| a + b)
        };
        Ok((0..self.cosines.len()).map(of).collect())
    }

    /// The radiance at any depth, as the slab's source alone would have it.
    fn continued(&self, t: f64, i: usize) -> anyhow::Result<f64> {
        let (tau, mu) = (self.slab.tau(), self.cosines[i]);
        let (near, beyond) = if mu < 0.0 { (0.0, -t) } else { (tau, t - tau) };
        Ok(if (0.0..=tau).contains(&t) {
            self.exact(t)?[i]
        } else if beyond > 0.0 {
            self.exact(near)?[i] * libm::exp(-beyond / libm::fabs(mu))
        } else {
            0.0
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use turbid_analytic::{Ground, Incidence, Layer, Phase};

    fn slab(tau: f64, albedo: f64, mu0: f64) -> StratifiedSlab {
        let layer = Layer::new(tau, albedo, &Phase::isotropic()).unwrap();
        StratifiedSlab::new(&[layer], Ground::black(), Some(Incidence::Beam { mu0 })).unwrap()
    }

    /// Light scattered once, of an albedo so small that nothing else is: the source is w e^(-t/mu0)/(4 pi mu0) per mean free path and
    /// irradiance on the face, and its average over balls along the ray is an integral in closed form over depths, here by
    /// brute force over both.
    #[test]
    fn single_scattering_by_brute_force() {
        let (tau, albedo, mu0) = (1.0, 1e-6, 0.5);
        let slab = slab(tau, albedo, mu0);
        let cosines = [-0.3, -0.9, 0.4, 1.0];
        let views = Views::new(&slab, &cosines);
        let steps = 1000;
        for t in [0.0, 0.4, 1.0] {
            for (i, blurred) in views.blurred(t).unwrap().into_iter().enumerate() {
                let (mu, mut sum) = (cosines[i], 0.0);
                let length = if mu < 0.0 { tau - t } else { t };
                for a in 0..steps {
                    let s = length * (f64::from(a) + 0.5) / f64::from(steps);
                    let (depth, size) = (if mu < 0.0 { t + s } else { t - s }, libm::fabs(mu));
                    for b in 0..400 {
                        let z = (f64::from(b) + 0.5) / 200.0 - 1.0;
                        let at = depth + RADIUS * z;
                        if (0.0..=tau).contains(&at) {
                            let source = albedo * libm::exp(-at / mu0) / (4.0 * PI * mu0);
                            sum += 0.75 * (1.0 - z * z) / 200.0 * source * libm::exp(-s / size) / size;
                        }
                    }
                }
                let brute = sum * length / f64::from(steps);
                let exact = views.exact(t).unwrap()[i];
                // Half a step where a face cuts a ball: 0.75/400 of what is found within a radius of it.
                assert!((blurred - brute).abs() <= 1e-3 * brute, "{t} {mu}: {blurred} {brute}");
                // The balls matter at faces: what is predicted is not the field itself.
                assert!(
                    t == 0.4 || length == 0.0 || (blurred / exact - 1.0).abs() > 0.005,
                    "{t} {mu}: {blurred} {exact}"
                );
            }
        }
    }

    #[test]
    fn more_nodes_change_nothing() {
        let slab = slab(1.0, 0.95, 0.5);
        let views = Views::new(&slab, &[-0.034, -0.2, -1.0]);
        let more = views.by_nodes(0.0, 3 * NODES).unwrap();
        for (few, more) in views.blurred(0.0).unwrap().into_iter().zip(more) {
            assert!((few - more).abs() <= 1e-4 * more.abs(), "{few} {more}");
        }
    }

    #[test]
    fn weights_of_azimuths() {
        for count in [1, 2, 12, 18] {
            let sum = |f: fn(f64) -> f64| azimuths(count).iter().map(|(a, w)| w * f(*a)).sum::<f64>();
            assert!((sum(|_| 1.0) - 1.0).abs() < 1e-15, "{count}");
            assert!(count == 1 || sum(libm::cos).abs() < 1e-15, "{count}");
        }
    }
}
