//! The photons that a history leaves around each of its own, to all orders, in unbounded isotropic fog.

use super::Table;
use turbid_analytic::quadrature::GaussLegendre;

/// Nodes of each panel.
const NODES: usize = 12;
/// Panels of the integral over s, in thirds towards 0, where the integrand rises like a logarithm.
const THIRDS: i32 = 6;
/// Halvings of the radius that are tabulated, as for kernel means.
const HALVINGS: i32 = 11;

/// 4 pi s^2 times the fluence at the distance s \[mfp\] of an isotropic point source of power 1.
struct PointSource {
    /// Decay of the mode that travels farthest \[1/mfp\].
    decay: f64,
    /// Its amplitude.
    amplitude: f64,
    /// Lengths u of the other modes, and their weights.
    modes: Vec<(f64, f64)>,
}

impl PointSource {
    /// With x = 1/u: phi = (1/4 pi s) {2 k^2 (1-k^2) e^(-ks) / (w (k^2+w-1)) + int_0^1 e^(-s/u) / D du/u^2},
    /// D = (1 - w u atanh u)^2 + (pi w u/2)^2, with w atanh(k) = k (Case and Zweifel 1967, chapter 5).
    fn new(albedo: f64) -> anyhow::Result<Self> {
        let w = albedo;
        let (mut low, mut high) = (1e-9, 1.0 - 1e-15);
        for _ in 0..100 {
            let middle = 0.5 * (low + high);
            if w * libm::atanh(middle) > middle { high = middle } else { low = middle }
        }
        let k = low;
        let amplitude = 2.0 * k * k * (1.0 - k * k) / (w * (k * k + w - 1.0));
        // Half decades towards 0, where short distances live, and decades towards 1, where D has a logarithm.
        let mut edges = vec![0.0];
        edges.extend((0..=13).map(|i| libm::exp10(-7.0 + 0.5 * f64::from(i))));
        edges.extend((1..=14).map(|i| 1.0 - libm::exp10(-f64::from(i))));
        edges.push(1.0);
        let rule = GaussLegendre::new(NODES)?;
        let mut modes = Vec::new();
        for pair in edges.windows(2) {
            for (node, weight) in rule.nodes.iter().zip(&rule.weights) {
                let u = pair[0] + (pair[1] - pair[0]) * node;
                let real = 1.0 - w * u * libm::atanh(u);
                let imaginary = 0.5 * std::f64::consts::PI * w * u;
                let density = 1.0 / (u * u * (real * real + imaginary * imaginary));
                if u < 1.0 {
                    modes.push((u, weight * (pair[1] - pair[0]) * density));
                }
            }
        }
        Ok(PointSource { decay: k, amplitude, modes })
    }

    fn at(&self, s: f64) -> f64 {
        let modes: f64 = self.modes.iter().map(|(u, weight)| weight * libm::exp(-s / u)).sum();
        s * (self.amplitude * libm::exp(-self.decay * s) + modes)
    }

    /// int_0^end of [`PointSource::at`] times a weight.
    fn integral(&self, end: f64, rule: &GaussLegendre, weight: impl Fn(f64) -> f64) -> f64 {
        let edge = |i: i32| if i == THIRDS { 0.0 } else { end * libm::pow(3.0, -f64::from(i)) };
        (0..THIRDS).map(|i| rule.integrate(edge(i + 1), edge(i), |s| self.at(s) * weight(s))).sum()
    }
}

/// Other photons of the same history around each photon of a ball, on average, against the ball's radius up to
/// `reach` \[mfp\], in unbounded isotropic fog.
///
/// A photon scatters with probability w and then lights its surroundings like a point source: its followers in the
/// ball are w int 4 pi s^2 phi(s) c(s) ds, with c(s) = 1 - 3s/(4r) + s^3/(16 r^3) the chance that a place at distance
/// s of one in the ball is in the ball too; its forerunners are as many. Near a face some leak out.
///
/// # Arguments
/// `albedo` \[1\], above 0 and below 1
pub fn isotropic_clustering(albedo: f64, reach: f64) -> anyhow::Result<Table> {
    let (source, rule) = (PointSource::new(albedo)?, GaussLegendre::new(NODES)?);
    let ends = (0..=HALVINGS).map(|i| reach * libm::exp2(-f64::from(i))).collect();
    Table::new(ends, |r| {
        let both = |s: f64| 1.0 - 0.75 * s / r + s * s * s / (16.0 * r * r * r);
        Ok(2.0 * albedo * source.integral(2.0 * r, &rule, both))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Power balance: int phi dV = 1/(1-w).
    #[test]
    fn a_point_source_loses_its_power_by_absorption() {
        let rule = GaussLegendre::new(NODES).unwrap();
        for albedo in [0.5, 0.9, 0.99] {
            let source = PointSource::new(albedo).unwrap();
            let step = 0.2 / source.decay;
            let inner = source.integral(step, &rule, |_| 1.0);
            let outer: f64 = (1..250)
                .map(|i| rule.integrate(f64::from(i) * step, f64::from(i + 1) * step, |s| source.at(s)))
                .sum();
            let balance = (inner + outer) * (1.0 - albedo);
            // Panels in thirds and decades leave a few 1e-6.
            assert!((balance - 1.0).abs() < 1e-5, "albedo {albedo}: {balance}");
        }
    }

    /// The first two orders of the radius in closed form. The next collision is inside with 3/4 r - 2/5 r^2 on average;
    /// the next but one has, near its forerunner, the density pi/(16 s), wherever the one between them was, in the ball
    /// or outside: int 4 pi s^2 pi/(16 s) c(s) ds = pi^2/10 r^2. What is left is of the order r^3 ln r.
    #[test]
    fn small_balls_hold_the_first_orders() {
        let returning = std::f64::consts::PI * std::f64::consts::PI / 10.0;
        for w in [0.5, 0.9, 0.99] {
            let table = isotropic_clustering(w, 1.0).unwrap();
            for r in [0.003, 0.01, 0.03] {
                let first = 2.0 * w * (0.75 * r - 0.4 * r * r) + 2.0 * w * w * returning * r * r;
                let difference = table.at(r) - first;
                let next = r * r * r * libm::log(1.0 / r);
                assert!(difference.abs() < next, "albedo {w}, r {r}: {difference}");
            }
        }
    }
}
