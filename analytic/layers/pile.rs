//! Light that is not scattered in a pile of plates: reflected and transmitted at every face, absorbed in every plate.
//!
//! With r and t what a face reflects and transmits, e what a plate lets pass, P what a face returns with all below it
//! and R = e^2 P what a plate does,
//!
//! P = r + t^2 R/(1 - r R),  1 - P = t (1 - R)/(1 - r R),  1 - r R = t + r (1 - R)
//!
//! and of power F on a face t F/(1 - r R) starts down into the plate below. 1 - P is followed beside P, so that light that
//! hardly enters keeps its digits. Faces are far from each other in wavelengths: powers add, fields do not.

use crate::slab_fresnel::face::Face;
use libm::{exp, expm1, sqrt};

/// Cosine in a medium of index `n` of light that has the cosine `mu` in one of index `from`; none if it cannot be there.
pub(super) fn cosine(n: f64, from: f64, mu: f64) -> Option<f64> {
    if n == from {
        return Some(mu);
    }
    let square = (n - from) * (n + from) + from * from * mu * mu;
    (square > 0.0).then(|| (sqrt(square) / n).min(1.0))
}

/// Clear or absorbing plates between two media.
#[derive(Clone)]
pub(super) struct Pile {
    /// Index above, of each plate, and below.
    pub indices: Vec<f64>,
    /// Thickness of each plate.
    pub taus: Vec<f64>,
    /// Reflectance of a mirror in the medium below.
    pub mirror: Option<f64>,
}

/// What becomes of unit power from above.
#[derive(Clone)]
pub(super) struct Passed {
    /// By the first face, before any light enters.
    pub specular: f64,
    /// By all faces.
    pub reflected: f64,
    /// Into the medium below, on each visit if there is a mirror.
    pub arrived: f64,
    /// Of each plate: power downwards at its upper face and upwards at its lower one.
    pub within: Vec<[f64; 2]>,
}

impl Pile {
    /// Whether light passes as if nothing were there.
    pub fn is_nothing(&self) -> bool {
        self.taus.is_empty() && self.indices[0] == self.indices[1] && self.mirror.is_none()
    }

    /// Turned upside down, for a pile without a mirror.
    pub fn reversed(&self) -> Pile {
        let turned = |list: &[f64]| list.iter().rev().copied().collect();
        Pile { indices: turned(&self.indices), taus: turned(&self.taus), mirror: None }
    }

    /// Light that has the cosine `of(n)` in a medium of index n. None that cannot be above is taken to be there.
    pub fn passed(&self, of: impl Fn(f64) -> Option<f64>) -> Passed {
        let count = self.taus.len();
        let cosines: Vec<Option<f64>> = self.indices.iter().map(|&n| of(n)).collect();
        let faces: Vec<(f64, f64)> = (0..=count).map(|i| self.face(i, &cosines)).collect();
        let through = |i: usize| cosines[i + 1].map_or(0.0, |mu| exp(-self.taus[i] / mu));
        let lost = |i: usize| cosines[i + 1].map_or(1.0, |mu| -expm1(-2.0 * self.taus[i] / mu));
        // From below: P and 1 - P of face i with all below it; R and 1 - R of the medium below it.
        let end = self.mirror.unwrap_or(0.0);
        let mut under = vec![[end, 1.0 - end]; count + 1];
        let mut with = vec![[0.0; 2]; count + 1];
        for i in (0..=count).rev() {
            if i < count {
                let ([p, kept], e) = (with[i + 1], through(i));
                under[i] = [e * e * p, lost(i) + e * e * kept];
            }
            let ((r, t), [back, gone]) = (faces[i], under[i]);
            let open = t + r * gone;
            with[i] =
                if t > 0.0 && open > 0.0 { [r + t * (t / open) * back, t * gone / open] } else { [r, t] };
        }
        let mut power = if cosines[0].is_some() { 1.0 } else { 0.0 };
        let (specular, reflected) = (power * faces[0].0, power * with[0][0]);
        let mut within = Vec::with_capacity(count);
        let enter = |i: usize, power: f64| {
            let ((r, t), [_, gone]) = (faces[i], under[i]);
            if t > 0.0 { power * t / (t + r * gone) } else { 0.0 }
        };
        for i in 0..count {
            let down = enter(i, power);
            power = down * through(i);
            within.push([down, power * with[i + 1][0]]);
        }
        Passed { specular, reflected, arrived: enter(count, power), within }
    }

    /// Reflectance and transmittance of a face.
    fn face(&self, i: usize, cosines: &[Option<f64>]) -> (f64, f64) {
        let (above, below) = (self.indices[i], self.indices[i + 1]);
        match (cosines[i], cosines[i + 1]) {
            _ if above == below => (0.0, 1.0),
            (Some(outside), Some(inside)) => Face::new(below / above).reflected(inside, outside),
            _ => (1.0, 0.0),
        }
    }
}
