//! The balance heuristic over all techniques that make a path, by recursion along its two subpaths.
//!
//! A path has the scatterings v_1 ... v_m, from the light to the eye, by media and diffuse surfaces; between two of them is a
//! flight, which may have been turned by specular surfaces. Technique s >= 2 makes v_1 ... v_(s-1) by a subpath of light, the rest
//! from the eye, and connects v_(s-1) with v_s, where nothing specular may lie between; s = 1 is next-event estimation from v_1,
//! s = 0 meets the light by chance; in pictures s = m + 1 connects v_m with the camera. With f_i and b_i the densities with which the flight between v_i and v_(i+1) is chosen from
//! its one end and from its other,
//!
//! p_s = e f_1 ... f_(s-2) b_s ... b_(m-1), p_1 = q b_1 ... b_(m-1), p_0 = h b_1 ... b_(m-1),
//!
//! where, per solid angle at v_1 and area or volume of v_1, e is the density of light that arrives: of the photons that leave all
//! lights in proportion to their radiance L it is L over their power, times the cosine or extinction at v_1. The square
//! of the distance that a flight's two densities have in common is left out where specular surfaces turn the flight, since no
//! technique connects there; the densities then differ by the squared indices at its ends, as radiance does.
//!
//! A transmittance in them is any function of a flight's ends, and roulette is left out: weights that are functions of the path alone
//! and add up to one are unbiased, whatever they are.
//!
//! # Source     Veach 1997, "Robust Monte Carlo methods for light transport simulation", 10.2; Georgiev 2012, "Implementing
//! vertex connection and merging", for the recursion

/// Ratios of densities stay below it, so that none is infinite, or infinite times 0.
const LARGEST: f64 = 1e150;

/// What the weights of all techniques need of a vertex and of its subpath before it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Ways {
    /// Density with which its own subpath chose it.
    pub pdf: f64,
    /// What the technique that leaves it to the other subpath is worth beside its density: 1 if the vertex before it can be
    /// connected, else 0. Of the first vertex from a light, the density of next-event estimation.
    pub connected: f64,
    /// Sum of the techniques that leave the vertex before it to the other subpath too, over the density of the scattering that goes there.
    pub beyond: f64,
}

impl Ways {
    /// A vertex that no other technique has: the first one from the eye, where nothing is connected to the eye.
    pub const FIRST: Ways = Ways { pdf: 1.0, connected: 0.0, beyond: 0.0 };

    /// The techniques that leave this vertex to the other subpath, in parts of the one that does not.
    ///
    /// # Arguments
    /// `pdf` with which the other subpath chooses it; `turned` with which scattering there, of what comes from the other subpath,
    /// goes on to the vertex before it
    pub fn others(&self, pdf: f64, turned: f64) -> f64 {
        ((pdf / self.pdf).min(LARGEST) * (self.connected + turned * self.beyond)).min(LARGEST)
    }

    /// The vertex behind this one.
    ///
    /// # Arguments
    /// `pdf` with which it is chosen from here; `back` with which this one would be chosen from it, but for the scattering
    /// there; `turned` as in [`Ways::others`]; `is_direct` whether nothing specular lies between
    pub fn next(&self, pdf: f64, back: f64, turned: f64, is_direct: bool) -> Ways {
        Ways { pdf, connected: f64::from(u8::from(is_direct)), beyond: self.others(back, turned) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::{Purpose, Stream};

    /// The flights of a path, with what chooses them from either end: numbers between 0.1 and 10.
    struct Path {
        /// The scatterings' densities, towards the eye and towards the light: of v_1 to v_m, at 0 to m - 1.
        to_eye: Vec<f64>,
        to_light: Vec<f64>,
        /// What makes densities of them: at the ends of the flight between v_i and v_(i+1) nearer to the light and to the eye.
        near_light: Vec<f64>,
        near_eye: Vec<f64>,
        is_direct: Vec<bool>,
        /// e; q, 0 behind specular surfaces; 1 where light can be met by chance.
        light: (f64, f64, f64),
    }

    fn path(m: usize, stream: &mut Stream) -> Path {
        let mut numbers =
            |n: usize| -> Vec<f64> { (0..n).map(|_| libm::pow(10.0, 2.0 * stream.unit() - 1.0)).collect() };
        let [to_eye, to_light, near_light, near_eye] = [m, m, m - 1, m - 1].map(&mut numbers);
        let [e, q] = [numbers(1)[0], numbers(1)[0]];
        let is_direct = (0..m - 1).map(|_| stream.unit() < 0.7).collect();
        let (is_aimed_at, is_met) = (stream.unit() < 0.7, stream.unit() < 0.5);
        let light = (e, if is_aimed_at { q } else { 0.0 }, f64::from(u8::from(is_met)));
        Path { to_eye, to_light, near_light, near_eye, is_direct, light }
    }

    impl Path {
        /// p_s by its definition, 0 where the technique cannot make the path.
        fn pdf(&self, s: usize) -> f64 {
            let m = self.to_eye.len();
            let (e, q, met) = self.light;
            let from_light = |i: usize| self.to_eye[i - 1] * self.near_eye[i - 1];
            let from_eye = |i: usize| self.to_light[i] * self.near_light[i - 1];
            let eye = |from: usize| (from..m).map(from_eye).product::<f64>();
            match s {
                0 => met * self.to_light[0] * eye(1),
                1 => q * eye(1),
                _ if !self.is_direct[s - 2] => 0.0,
                _ => e * (1..=s - 2).map(from_light).product::<f64>() * eye(s),
            }
        }

        /// The vertices of the subpath of light, v_1 first, and of that of the eye, v_m first.
        fn ways(&self) -> (Vec<Ways>, Vec<Ways>) {
            let m = self.to_eye.len();
            let (e, q, met) = self.light;
            let mut light = vec![Ways { pdf: e, connected: q, beyond: met }];
            let mut eye = vec![Ways::FIRST];
            for i in 0..m - 1 {
                let (pdf, back) = (self.to_eye[i] * self.near_eye[i], self.near_light[i]);
                light.push(light[i].next(pdf, back, self.to_light[i], self.is_direct[i]));
                let j = m - 2 - i;
                let (pdf, back) = (self.to_light[j + 1] * self.near_light[j], self.near_eye[j]);
                eye.push(eye[i].next(pdf, back, self.to_eye[j + 1], self.is_direct[j]));
            }
            (light, eye)
        }

        /// The weight of a technique that can make the path, as the integrator reckons it.
        fn weight(&self, s: usize) -> f64 {
            let m = self.to_eye.len();
            let (e, q, met) = self.light;
            let (light, eye) = self.ways();
            if s < 2 {
                let (h, others) = (met * self.to_light[0], eye[m - 1].others(e, self.to_eye[0]));
                return if s == 0 { h } else { q } / (h + q + others);
            }
            // v_(s-1) of light and v_s of the eye; their flight is number s - 2.
            let (y, z) = (&light[s - 2], &eye[m - s]);
            let to_y = y.others(self.to_light[s - 1] * self.near_light[s - 2], self.to_light[s - 2]);
            let to_z = z.others(self.to_eye[s - 2] * self.near_eye[s - 2], self.to_eye[s - 1]);
            1.0 / (1.0 + to_y + to_z)
        }
    }

    /// On one path: each weight is that technique's density over the sum of all, so that they add up to one.
    #[test]
    fn weights_are_shares_of_the_densities() {
        let mut stream = Stream::new(1, Purpose::Synthetic, 0, 0);
        let mut made = 0;
        for m in 2..12 {
            for _ in 0..300 {
                let path = path(m, &mut stream);
                let all: f64 = (0..=m).map(|s| path.pdf(s)).sum();
                let mut sum = 0.0;
                for s in (0..=m).filter(|s| path.pdf(*s) > 0.0) {
                    let (weight, expected) = (path.weight(s), path.pdf(s) / all);
                    assert!((weight / expected - 1.0).abs() < 1e-12, "{m} {s}: {weight} {expected}");
                    sum += weight;
                    made += 1;
                }
                assert!(all == 0.0 || (sum - 1.0).abs() < 1e-12, "{m}: {sum}");
            }
        }
        assert!(made > 10_000, "{made}");
    }
}
