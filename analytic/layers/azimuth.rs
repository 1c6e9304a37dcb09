//! Radiance of a stratified slab in any direction, under a beam: modes of light scattered at least twice, and single
//! scattering as it is, as in [`crate::AddingDoubling`].

use super::adding::Added;
use super::problem::Problem;
use super::stratified::{ADDING, COSINES, StratifiedSlab};
use crate::adding_doubling::{CUT_TWICE, LAST, MOST, deflection, single_mode};
use crate::error::{Result, within};
use crate::incidence::{Incidence, check_depth};
use crate::slab_single::beam_path;
use crate::value::Value;
use libm::{cos, exp};

impl StratifiedSlab {
    /// Radiance of scattered light at depth t in the direction of signed cosine mu, by azimuth, by adding.
    ///
    /// I = sum_m (2 - delta_m0) I_m cos(m dphi), where sources and a Lambertian ground have m = 0 alone.
    /// # Arguments
    /// `t` depth in mean free paths, 0 to that of the ground; `mu` -1 to 1, positive towards the lit face, at least 1e-5 from 0;
    /// `azimuths` 1 to 64 of the direction of travel minus that of the beam \[rad\], -1e6 to 1e6, without effect where there is
    /// no beam
    /// # Returns
    /// \[1/sr\]; every query solves all modes anew, for all azimuths at once, which takes seconds where there are many
    /// # Errors
    /// `Error::OutOfRange` naming `t`, `mu`, `dphi` or `azimuths`; under a beam `index` where layers have several, and `mirror`
    /// # Limits
    /// one layer over a black ground is [`crate::AddingDoubling`]; the mean over azimuth is [`Self::radiance`]
    pub fn radiance_towards(&self, t: f64, mu: f64, azimuths: &[f64]) -> Result<Vec<Value>> {
        within("azimuths", azimuths.len() as f64, 1.0, COSINES, "1 to 64 of them")?;
        for &dphi in azimuths {
            within("dphi", dphi, -1e6, 1e6, "-1e6 to 1e6")?;
        }
        let problem = &self.problem;
        let Some(Incidence::Beam { mu0 }) = problem.incidence else {
            return Ok(vec![self.radiance(t, &[mu])?[0]; azimuths.len()]);
        };
        check_depth(t, problem.tau())?;
        within("mu", mu, -1.0, 1.0, "-1 to 1")?;
        within("mu", mu.abs(), 1e-5, 1.0, "1e-5 or more in magnitude with layers")?;
        let one = "1 in all layers with azimuths and a beam";
        within(
            "index",
            problem.indices().into_iter().fold(1.0, |a, n| if n == 1.0 { a } else { n }),
            1.0,
            1.0,
            one,
        )?;
        within(
            "mirror",
            f64::from(u8::from(problem.ground.mirror)),
            0.0,
            0.0,
            "none below azimuths and a beam",
        )?;
        let paths = paths(problem, mu0, t, mu);
        let single: Vec<f64> = azimuths
            .iter()
            .map(|&dphi| {
                let [minus, plus] = deflection(mu0, mu, dphi);
                let terms = problem.layers.iter().zip(&paths);
                terms.map(|(layer, path)| path * layer.phase.value_of(minus, plus)).sum()
            })
            .collect();
        let degrees = CUT_TWICE.map(|cut| {
            let of = problem.layers.iter().map(|layer| layer.phase.degree(cut, MOST));
            of.collect::<Vec<usize>>()
        });
        let most = degrees.each_ref().map(|all| all.iter().copied().fold(0, usize::max));
        let (i, x) = problem.place(t);
        let several = |set: usize, m: usize| -> Result<[f64; 2]> {
            let rule = Added::rule(set, most[set]);
            let added = Added::on(problem.clone(), rule, 1.0, &[mu.abs()], &degrees[set], m)?;
            let radiance = added.radiance(i, x, 0)?[usize::from(mu > 0.0)];
            let terms = problem.layers.iter().zip(&paths).zip(&degrees[set]);
            let once: f64 = terms
                .map(|((layer, path), &degree)| path * single_mode(&layer.phase, degree, m, mu0, mu))
                .sum();
            Ok([radiance - once, added.rounding()[0] * (radiance.abs() + once.abs())])
        };
        let mut sums = single.clone();
        let least = single.iter().copied().fold(f64::INFINITY, f64::min);
        let (mut difference, mut magnitude, mut tail) = (0.0, least, 0.0);
        let (mut rounding, mut small) = (0.0, 0);
        for m in 0..=most[0] {
            let weight = if m == 0 { 1.0 } else { 2.0 };
            let [[fine, rounded], [coarse, _]] = [several(0, m)?, several(1, m)?];
            for (sum, dphi) in sums.iter_mut().zip(azimuths) {
                *sum += weight * fine * cos(m as f64 * dphi);
            }
            difference += weight * (fine - coarse).abs();
            magnitude += weight * fine.abs();
            rounding += weight * rounded;
            small = if (weight * fine).abs() <= LAST * magnitude { small + 1 } else { 0 };
            if small == 2 {
                // What follows falls like the square of the moments, at least.
                tail = 16.0 * LAST * magnitude;
                break;
            }
        }
        let of = |(sum, single): (f64, f64)| {
            let size = magnitude - least + single;
            let direct = 16.0 * f64::EPSILON * (1.0 + problem.tau() / mu0).min(800.0) * size;
            Value::new(sum, 2.0 * difference + rounding + direct + tail + f64::MIN_POSITIVE, ADDING)
        };
        Ok(sums.into_iter().zip(single).map(of).collect())
    }
}

/// Of every layer, albedo times int e^(-t'/mu0)/mu0 e^(-|t-t'|/m) dt'/m along the ray that arrives at depth t.
fn paths(problem: &Problem, mu0: f64, t: f64, mu: f64) -> Vec<f64> {
    let depths = problem.depths.windows(2);
    let of = |(pair, albedo): (&[f64], f64)| {
        let (from, to) = if mu > 0.0 { (pair[0].max(t), pair[1]) } else { (pair[0], pair[1].min(t)) };
        if to <= from {
            return 0.0;
        }
        let thickness = to - from;
        let (place, rest) = if mu > 0.0 { (0.0, from - t) } else { (thickness, t - to) };
        albedo * exp(-from / mu0 - rest / mu.abs()) * beam_path(thickness, mu0, place, mu)
    };
    depths.zip(problem.layers.iter().map(|layer| layer.albedo)).map(of).collect()
}
