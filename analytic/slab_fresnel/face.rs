//! A smooth face between the medium, of index n, and the outside, of index 1: Fresnel's laws for unpolarised light.

use crate::adding_doubling::{Nodes, Panels};
use crate::error::Result;
use crate::quadrature::Adaptive;
use crate::value::Value;
use libm::{log, sqrt};

/// The face, by its refractive index inside over outside.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Face {
    index: f64,
    /// n^2 - 1 without cancellation.
    excess: f64,
}

/// Gauss nodes of a panel next to a point where the light has a singularity.
const PANEL: usize = 20;

impl Face {
    pub fn new(index: f64) -> Self {
        Face { index, excess: (index - 1.0) * (index + 1.0) }
    }

    /// n^2, by which the solid angle shrinks on the way in.
    pub fn spread(self) -> f64 {
        self.index * self.index
    }

    /// Cosine inside below which light is reflected whole; 0 if there is none.
    pub fn critical(self) -> f64 {
        if self.excess > 0.0 { sqrt(self.excess) / self.index } else { 0.0 }
    }

    /// Cosine outside of light that runs at cosine `mu` inside; none if it is reflected whole.
    pub fn outside(self, mu: f64) -> Option<f64> {
        let square = if self.excess > 0.0 {
            let critical = self.critical();
            self.index * self.index * (mu - critical) * (mu + critical)
        } else {
            self.index * self.index * mu * mu - self.excess
        };
        (square > 0.0).then(|| sqrt(square))
    }

    /// Cosine inside of light that comes at cosine `mu0` from outside; none if it is reflected whole.
    pub fn inside(self, mu0: f64) -> Option<f64> {
        if self.excess == 0.0 {
            return Some(mu0);
        }
        let square = self.excess + mu0 * mu0;
        (square > 0.0).then(|| (sqrt(square) / self.index).min(1.0))
    }

    /// Reflectance and transmittance for light of the given cosines inside and outside, from either side.
    ///
    /// r_s = (n mu - mu_o)/(n mu + mu_o), r_p = (mu - n mu_o)/(mu + n mu_o), with the differences multiplied out by the cosine on the
    /// side of the smaller index: by the other one they cancel where light grazes.
    pub fn reflected(self, inside: f64, outside: f64) -> (f64, f64) {
        let (n, square) = (self.index, self.index * self.index);
        let s = n * inside + outside;
        let p = inside + n * outside;
        let rs = self.excess / (s * s);
        let difference = if self.excess > 0.0 {
            (1.0 - (1.0 + square) * outside * outside) / square
        } else {
            square - (1.0 + square) * inside * inside
        };
        let rp = self.excess * difference / (p * p);
        let through = 2.0 * n * inside * outside * (1.0 / (s * s) + 1.0 / (p * p));
        (0.5 * (rs * rs + rp * rp), through)
    }

    /// Reflectance and transmittance from inside at cosine `mu`.
    pub fn reflected_inside(self, mu: f64) -> (f64, f64) {
        self.outside(mu).map_or((1.0, 0.0), |outside| self.reflected(mu, outside))
    }

    /// Reflectance for Lambertian light from outside, or from inside.
    pub fn diffuse(self, from_outside: bool) -> Result<Value> {
        let dense = if self.excess >= 0.0 { self.index } else { 1.0 / self.index };
        let thin_side = lambertian(dense)?;
        // The light that passes is the same in both directions, seen in a solid angle that is n^2 times as large.
        let square = dense * dense;
        let passing = (1.0 - thin_side.value) / square;
        let rounding = 4.0 * f64::EPSILON;
        let dense_side = Value::new(1.0 - passing, thin_side.error / square + rounding, thin_side.method);
        Ok(if from_outside == (self.excess >= 0.0) { thin_side } else { dense_side })
    }

    /// Directions inside, crowded where the light changes: towards the horizon, and beyond the critical cosine, where
    /// the reflectance falls with the root of the difference.
    pub fn nodes(self, rule: Rule) -> Nodes {
        let Rule { upper, lower, power, degree, tau } = rule;
        let (least, turns) = (upper, degree as f64);
        let upper = least.max(5 + degree / 2);
        let open = 3.0 / (upper as f64 + 2.0);
        let critical = self.critical();
        // The reflectance is analytic but for mu^2 = (n^2 - 1)/n^2, which for n < 1 lies across.
        let scale = if self.excess < 0.0 { sqrt(-self.excess) / self.index } else { critical };
        let mut panels = Panels::default();
        let mut edge = if scale > 0.0 { open.min(0.5 * scale) } else { open };
        if critical > 0.0 && critical <= open {
            edge = critical;
        }
        panels.power(0.0, edge, power, lower);
        if critical > 0.0 {
            if edge < critical {
                panels.plain(edge, critical, least.max(12 + (0.5 * critical * turns) as usize));
            }
            // In the root of mu - mu_c the turns of P_l are densest at mu = 1, root(1 - mu_c) as dense as on a whole
            // hemisphere in mu itself.
            let order = least.max(16 + (0.75 * sqrt(1.0 - critical) * turns) as usize);
            let whole = 4.0 * critical >= open.max(0.25);
            edge = if whole { 1.0 } else { 4.0 * critical };
            if tau < 0.5 * critical {
                // Light goes to and fro until a face has let it out, a share of the root of mu - mu_c each time, or
                // it has collided, a share tau/mu: between the two it changes with the logarithm.
                let near = if whole { critical + 0.1 * (1.0 - critical) } else { edge };
                panels.power(critical, near, 6, lower);
                if whole {
                    panels.plain(near, edge, order);
                }
            } else {
                panels.power(critical, edge, 2, if whole { order } else { PANEL });
            }
        }
        while edge < open {
            let next = if 3.0 * edge >= open { open } else { 3.0 * edge };
            panels.plain(edge, next, PANEL);
            edge = next;
        }
        if edge < 1.0 {
            panels.plain(edge, 1.0, upper);
        }
        panels.finish()
    }
}

/// How fine the directions are to be.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Rule {
    /// The fewest nodes of a panel away from the horizon.
    pub upper: usize,
    /// Nodes towards the horizon, in the root of this power.
    pub lower: usize,
    pub power: i32,
    /// The highest Legendre moment to be followed.
    pub degree: usize,
    /// Thickness of the slab.
    pub tau: f64,
}

/// Reflectance for Lambertian light on a medium of index n > 1 (Walsh 1926; Duntley 1942).
fn lambertian(n: f64) -> Result<Value> {
    const CLOSED: &str = "closed form";
    if n == 1.0 {
        return Ok(Value::new(0.0, 0.0, CLOSED));
    }
    let face = Face::new(n);
    if n < 1.5 {
        // The closed form is a small difference of terms that grow as 1/(n-1).
        let integrand =
            |mu: f64| Ok(face.inside(mu).map_or(0.0, |inside| 2.0 * mu * face.reflected(inside, mu).0));
        let scale = sqrt(face.excess);
        let mut breaks = vec![0.0];
        breaks.extend((-3..40).map(|k| scale * f64::powi(4.0, k)).take_while(|&x| x < 1.0));
        breaks.push(1.0);
        return Adaptive::new(1e-15).integrate(&breaks, "reflectance", "quadrature", integrand);
    }
    let (n2, n4) = (n * n, n * n * n * n);
    let (plus, minus) = (n2 + 1.0, n4 - 1.0);
    let terms = [
        0.5,
        (n - 1.0) * (3.0 * n + 1.0) / (6.0 * (n + 1.0) * (n + 1.0)),
        n2 * (n2 - 1.0) * (n2 - 1.0) / (plus * plus * plus) * log((n - 1.0) / (n + 1.0)),
        -2.0 * n2 * n * (n2 + 2.0 * n - 1.0) / (plus * minus),
        8.0 * n4 * (n4 + 1.0) / (plus * minus * minus) * log(n),
    ];
    let magnitude: f64 = terms.iter().map(|x| x.abs()).sum();
    // n - 1 and n^4 - 1 each magnify the rounding of n once.
    let roundings = 16.0 + 8.0 / (n - 1.0);
    Ok(Value::new(terms.iter().sum(), roundings * f64::EPSILON * magnitude, CLOSED))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hemispherical_reflectances() {
        // Duntley's formula in 30 digits.
        let glass = Face::new(1.5);
        assert!((glass.diffuse(true).unwrap().value - 0.0917779593).abs() < 1e-10);
        for n in [0.2, 0.7, 0.9999, 1.0, 1.0 + 1e-12, 1.0001, 1.05, 1.0999, 1.1, 1.33, 1.5, 2.4, 4.0] {
            let face = Face::new(n);
            let (outer, inner) = (face.diffuse(true).unwrap(), face.diffuse(false).unwrap());
            // From outside, in the cosine inside where that is the smoother; from inside, with all that returns whole.
            let nodes = face.nodes(Rule { upper: 60, lower: 60, power: 5, degree: 0, tau: 1e-3 });
            let got = nodes.sum(|mu| 2.0 * mu * face.reflected_inside(mu).0);
            assert!((got - inner.value).abs() < inner.error + 1e-13, "{n} inside {got} {inner:?}");
            let through = nodes.sum(|mu| 2.0 * n * n * mu * face.reflected_inside(mu).1);
            assert!((1.0 - through - outer.value).abs() < outer.error + 1e-13, "{n} {through} {outer:?}");
            assert!(outer.error < 1e-13 && inner.error < 1e-13, "{n} {outer:?} {inner:?}");
        }
    }

    #[test]
    fn fresnel_conserves_light() {
        for n in [0.25, 0.3, 0.99, 1.0, 1.0 + 1e-9, 1.33, 2.4, 4.0] {
            let face = Face::new(n);
            for i in 0..=200 {
                let cosine = libm::pow(10.0, -0.025 * f64::from(i));
                let entering = face.inside(cosine).map(|inside| face.reflected(inside, cosine));
                // Nine roundings.
                for (r, t) in entering.into_iter().chain([face.reflected_inside(cosine)]) {
                    assert!((r + t - 1.0).abs() < 2e-15, "{n} {cosine}: {r} and {t}");
                }
            }
        }
        // Normal incidence: ((n-1)/(n+1))^2.
        assert!((Face::new(1.5).reflected(1.0, 1.0).0 - 0.04).abs() < 1e-16);
    }
}
