//! Mean and spread of every estimate, from theory: independent photons of the exact field, thickened by the clusters
//! of one history.

use super::cases::{Field, Setting, Treatment};
use crate::setups::{Setup, Size};
use crate::theory::{Gathers, clustering};
use std::f64::consts::PI;
use turbid::estimators::Kernel;
use turbid_analytic::nearest::{nearest_expectation, nearest_moments};

/// What theory says of one estimate, as fractions of the exact fluence.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Expected {
    /// Mean error: what is missing of a uniform field where the medium ends inside the ball.
    pub edge: f64,
    /// Mean error: all else that independent photons do.
    pub blur: f64,
    /// Mean error: photons of one history draw the k-th photon nearer.
    pub clusters: f64,
    /// Standard deviation of one estimate.
    pub noise: f64,
    /// Standard deviation if photons were independent.
    pub noise_independent: f64,
    /// Bound on the numerical error of the mean.
    pub error: f64,
}

impl Expected {
    /// The mean error.
    pub fn bias(&self) -> f64 {
        self.edge + self.blur + self.clusters
    }
}

/// Root mean squares over the layers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rms {
    /// Of the mean errors.
    pub bias: f64,
    /// Of the standard deviations.
    pub noise: f64,
}

impl Rms {
    /// Over layers.
    pub fn of(layers: &[Expected]) -> Self {
        let mean = |f: &dyn Fn(&Expected) -> f64| {
            (layers.iter().map(|e| f(e) * f(e)).sum::<f64>() / layers.len() as f64).sqrt()
        };
        Rms { bias: mean(&Expected::bias), noise: mean(&|e| e.noise) }
    }

    /// Of the errors.
    pub fn total(&self) -> f64 {
        libm::hypot(self.bias, self.noise)
    }
}

/// The theory of one field of fog.
pub struct Theory {
    field: &'static Field,
    gathers: Gathers,
}

/// Largest radius that is asked of the theory, beside the settings' own \[mfp\].
const REACH: f64 = 1.0;
/// Panels of the quadrature over the fluence, which bends like t ln t at the faces: 10^-6 of it is left.
const PANELS: u32 = 64;

impl Theory {
    /// The theory of a field whose settings are these.
    pub fn new<'a>(
        field: &'static Field,
        settings: impl Iterator<Item = &'a Setting>,
    ) -> anyhow::Result<Self> {
        let reach = settings.filter(|s| s.field == field).map(Setting::cap).fold(REACH, f64::max);
        let gathers = Gathers::new(field.setup, &field.depths(), reach)?;
        Ok(Theory { field, gathers })
    }

    /// Exact fluence and its bound.
    pub fn exact(&self, t: f64) -> anyhow::Result<(f64, f64)> {
        self.gathers.exact(t)
    }

    /// Collisions of a history, on average: the integral of the fluence over the fog, per unit of power.
    pub fn collisions(&self) -> anyhow::Result<f64> {
        self.field.setup.collisions(self.gathers.fluence(), PANELS)
    }

    /// One setting at one layer's depth.
    pub fn expected(&self, setting: &Setting, treatment: Treatment, t: f64) -> anyhow::Result<Expected> {
        match setting.size {
            Size::Radius(r) => self.within(r, setting.photons as f64, treatment, t),
            Size::Nearest(k) => self.nearest(setting, k, treatment, t),
        }
    }

    /// A fixed radius, with any number of photons. With X the photons of one history in the ball, the count of N
    /// histories has the variance N (E X^2 - (E X)^2) = lambda (1 + eta) - lambda^2/N.
    pub fn within(&self, r: f64, photons: f64, treatment: Treatment, t: f64) -> anyhow::Result<Expected> {
        let (here, here_error) = self.exact(t)?;
        let mean = self.gathers.profile(t, Kernel::Uniform)?.at(r);
        let whole = self.field.setup.body.inside(r, t)?;
        let held = photons / self.field.setup.power() * 4.0 / 3.0 * PI * r * r * r * mean;
        let (edge, value) = match treatment {
            Treatment::Plain => (whole - 1.0, mean / here),
            Treatment::Clipped => (0.0, mean / (here * whole)),
        };
        let spread = |eta: f64| value * ((1.0 + eta) / held - 1.0 / photons).sqrt();
        Ok(Expected {
            edge,
            blur: value - 1.0 - edge,
            clusters: 0.0,
            noise: spread(self.clustering(r, t)?),
            noise_independent: spread(0.0),
            error: here_error / here + 1e-8,
        })
    }

    /// The k nearest photons.
    ///
    /// Photons of one history come in clusters of 1 + eta: k of them set the radius like k/(1 + eta) independent
    /// ones, so that 1/(k - 2), the relative variance in a uniform field, becomes 1/(k/(1 + eta) - 2); and the
    /// histories are not Poisson but N, which takes k/N off.
    fn nearest(&self, setting: &Setting, k: usize, treatment: Treatment, t: f64) -> anyhow::Result<Expected> {
        let (here, here_error) = self.exact(t)?;
        let (density, cap) = (setting.density(), setting.cap());
        let profile = self.gathers.profile(t, Kernel::Uniform)?;
        let ball = |r: f64| density * 4.0 / 3.0 * PI * r * r * r;
        let number = |r: f64| ball(r) * profile.at(r);
        let whole = |r: f64| self.field.setup.body.inside(r, t).unwrap_or(f64::NAN);
        let part = |r: f64| if treatment == Treatment::Plain { 1.0 } else { whole(r) };
        let mean = |r: f64| profile.at(r) / part(r);
        let square = |r: f64| profile.at(r) / (ball(r) * part(r) * part(r));
        let neighbors = u32::try_from(k)?;
        let moments = nearest_moments(neighbors, cap, number, mean, square)?;
        let right = moments.mean.value / here;
        // What a uniform field would read, clipped or not, and what clusters do to the plain estimate.
        let uniform =
            nearest_expectation(neighbors, cap, |r| ball(r) * here * whole(r), |r| here * whole(r))?;
        let lost = uniform.value / here - 1.0;
        let edge = if treatment == Treatment::Plain { lost } else { 0.0 };
        let clusters =
            self.gathers.clusters(k, density * here, lost, right - 1.0 - edge) / (1.0 + lost - edge);
        // The k-th photon lies where a ball holds k.
        let (mut low, mut high) = (0.0, cap);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if number(middle) < k as f64 { low = middle } else { high = middle }
        }
        let k = k as f64;
        let spread = |eta: f64| {
            let thicker = (k - 2.0) / (k / (1.0 + eta) - 2.0);
            let relative = moments.variance.value / (here * here) * (thicker - k / setting.photons as f64);
            relative.sqrt()
        };
        Ok(Expected {
            edge,
            blur: right - 1.0 - edge,
            clusters,
            noise: spread(self.clustering(low, t)?),
            noise_independent: spread(0.0),
            error: (moments.mean.error + uniform.error + here_error) / here + 1e-8,
        })
    }

    /// Other photons of its history that a photon of the ball has there, on average. Where the surface cuts the ball,
    /// neighbours become fewer in proportion to its mean chord, an approximation.
    fn clustering(&self, r: f64, t: f64) -> anyhow::Result<f64> {
        let Setup { body, albedo, g, .. } = self.field.setup;
        Ok(clustering(albedo, g, r) * body.chord(r, t)?)
    }
}

#[cfg(test)]
mod tests {
    use super::super::cases::FIELDS;
    use super::*;

    fn field(name: &str) -> &'static Field {
        FIELDS.into_iter().find(|s| s.name == name).unwrap()
    }

    /// Power balance: what is absorbed and what leaves make 1, so that collisions are (1 - R - T)/(1 - albedo).
    #[test]
    fn collisions_by_power_balance() {
        use turbid_analytic::{Incidence, IsotropicSlab};
        for name in ["thin", "moderate", "thick"] {
            let field = field(name);
            let exact = IsotropicSlab::new(
                field.setup.body.deepest(),
                field.setup.albedo,
                Incidence::Beam { mu0: 1.0 },
            )
            .unwrap();
            let balance =
                (1.0 - exact.reflectance().value - exact.transmittance().value) / (1.0 - field.setup.albedo);
            let found = Theory::new(field, std::iter::empty()).unwrap().collisions().unwrap();
            assert!((found / balance - 1.0).abs() < 1e-5, "{name}: {found}, {balance}");
        }
    }

    /// Where the whole ball lies inside, clipping changes nothing; at the face it doubles what is left.
    #[test]
    fn clipping_restores_the_missing_part() {
        let theory = Theory::new(field("moderate"), std::iter::empty()).unwrap();
        let depth = field("moderate").depth(0);
        let at = |treatment| theory.within(0.4, 1e5, treatment, depth).unwrap();
        let (plain, clipped) = (at(Treatment::Plain), at(Treatment::Clipped));
        let whole = 1.0 + plain.edge;
        assert!(((1.0 + plain.bias()) / whole - 1.0 - clipped.bias()).abs() < 1e-12);
        assert!((plain.noise / whole / clipped.noise - 1.0).abs() < 1e-12);
        let middle = field("moderate").depth(8);
        let at = |treatment| theory.within(0.4, 1e5, treatment, middle).unwrap();
        assert_eq!(at(Treatment::Plain).blur, at(Treatment::Clipped).blur);
    }
}
