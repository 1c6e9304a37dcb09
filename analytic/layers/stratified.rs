//! The stratified slab, solved on two sets of nodes by either method.

use super::adding::Added;
use super::ordinates::Matched;
use super::problem::{Ground, Layer, Problem};
use crate::adding_doubling::depths;
use crate::error::{Result, within};
use crate::exponential_integral::e_n;
use crate::incidence::{Incidence, check_depth};
use crate::value::Value;
use std::sync::{Arc, OnceLock};

pub(super) const ADDING: &str = "adding of layers, two node counts";
const ORDINATES: &str = "discrete ordinates in layers, two node counts";

/// The most cosines or azimuths of one question.
pub(super) const COSINES: f64 = 64.0;

/// A solved stratified slab.
pub struct StratifiedSlab {
    pub(super) problem: Arc<Problem>,
    method: &'static str,
    solutions: [Solution; 2],
    /// Scattered light that leaves through the lit face, and that arrives at the ground.
    leaving: [Value; 2],
    dwelt: Vec<Value>,
    /// Unscattered light that leaves through the lit face.
    reflected: Value,
    /// Of each layer: depths within it in rising order, and the relative differences of the two solutions there.
    ladders: Vec<OnceLock<Result<Ladder>>>,
}

type Ladder = Vec<(f64, [f64; 3])>;

/// One set of nodes.
enum Solution {
    Adding(Box<Added>),
    Ordinates(Box<Matched>),
}

impl Solution {
    fn leaving(&self) -> [f64; 2] {
        match self {
            Solution::Adding(solution) => solution.leaving(),
            Solution::Ordinates(solution) => solution.leaving(),
        }
    }

    fn dwelt(&self, i: usize) -> f64 {
        match self {
            Solution::Adding(solution) => solution.dwelt(i),
            Solution::Ordinates(solution) => solution.dwelt(i),
        }
    }

    fn light(&self, i: usize, x: f64) -> Result<[f64; 3]> {
        match self {
            Solution::Adding(solution) => solution.light(i, x),
            Solution::Ordinates(solution) => solution.light(i, x),
        }
    }

    /// What the nodes of a layer make wrong of the fluence of light from behind a plane, of unit irradiance, at distance
    /// `d`: it swings with ln d, so that distances around it count.
    fn unresolved(&self, layer: usize, d: f64) -> f64 {
        let steps = (0..9).map(|i| d * f64::from(1 << i) / 16.0).map(|d| {
            let sum = match self {
                Solution::Adding(solution) => solution.transmission(layer, d),
                Solution::Ordinates(solution) => solution.transmission(layer, d),
            };
            sum.map_or(0.0, |sum| 2.0 * (sum - e_n(2, d)).abs())
        });
        steps.fold(0.0, f64::max)
    }

    fn rounding(&self) -> [f64; 2] {
        match self {
            Solution::Adding(solution) => solution.rounding(),
            Solution::Ordinates(solution) => solution.rounding(),
        }
    }
}

impl StratifiedSlab {
    /// Solves the slab by adding of layers.
    ///
    /// # Arguments
    /// `layers` from the lit face down, 1 to 1000 of them, of a thickness of at most 400 together; `ground` below them;
    /// `incidence` of unit irradiance on the lit face, a beam with a cosine of 1e-5 to 1, or none
    /// # Returns
    /// a solution with errors below 1e-9 of themselves for most slabs; the bounds say how much. It takes a tenth of a
    /// second for each kind of layer, seconds at |g| = 0.95
    /// # Errors
    /// `Error::OutOfRange` naming `layers`, `tau` or `mu0`
    /// # Limits
    /// one layer over a black ground: [`crate::AddingDoubling`]
    pub fn new(layers: &[Layer], ground: Ground, incidence: Option<Incidence>) -> Result<Self> {
        let problem = Arc::new(Problem::new(layers, ground, incidence)?);
        let solve = |set| Ok(Solution::Adding(Box::new(Added::new(problem.clone(), set, 1.0, &[])?)));
        Self::of(problem.clone(), ADDING, [solve(0)?, solve(1)?])
    }

    /// Solves the slab by discrete ordinates, all interfaces at once: the second method.
    ///
    /// # Arguments
    /// as for [`Self::new`]; a dozen layers of isotropic scattering at most, fewer where there are more moments, of
    /// which the 250th must be the last of weight (|g| = 0.89)
    /// # Returns
    /// a solution whose bounds are those of roundings of the largest fluence: faint light is known better by adding.
    /// Radiances are known by adding alone
    /// # Errors
    /// as [`Self::new`], and `Error::OutOfRange` naming `moments`
    pub fn by_ordinates(layers: &[Layer], ground: Ground, incidence: Option<Incidence>) -> Result<Self> {
        let problem = Arc::new(Problem::new(layers, ground, incidence)?);
        let solve = |set| Ok(Solution::Ordinates(Box::new(Matched::new(problem.clone(), set)?)));
        Self::of(problem.clone(), ORDINATES, [solve(0)?, solve(1)?])
    }

    fn of(problem: Arc<Problem>, method: &'static str, solutions: [Solution; 2]) -> Result<Self> {
        let count = problem.layers.len();
        let sets = solutions.each_ref().map(|solution| {
            let mut fluxes = solution.leaving().to_vec();
            fluxes.extend((0..count).map(|i| solution.dwelt(i)));
            fluxes
        });
        // A layer's share is compared with the others by its fluence.
        let scale = |i: usize| if i < 2 { 1.0 } else { problem.layers[i - 2].tau.max(f64::MIN_POSITIVE) };
        let difference = |i: usize| (sets[0][i] - sets[1][i]).abs();
        let largest = (0..count + 2).fold(0.0, |a: f64, i| a.max(difference(i) / scale(i)));
        let relative = (0..count + 2)
            .filter(|&i| sets[0][i] != 0.0)
            .fold(0.0, |a: f64, i| a.max(difference(i) / sets[0][i].abs()));
        let [rounded, absolute] = solutions[0].rounding();
        let mut values: Vec<Value> = (0..count + 2)
            .map(|i| {
                let fine = sets[0][i];
                let shared = (largest * scale(i)).min(relative * fine.abs());
                let rounding = rounded * fine.abs() + absolute * scale(i) + f64::MIN_POSITIVE;
                Value::new(fine, difference(i) + shared + rounding, method)
            })
            .collect();
        let plates = (0..count).filter(|i| !problem.scattering().contains(i));
        for i in plates {
            values[i + 2] = values[i + 2].plus(problem.dwelt(i)?, method);
        }
        Ok(StratifiedSlab {
            reflected: problem.reflected()?,
            ladders: (0..count).map(|_| OnceLock::new()).collect(),
            leaving: [values[0], values[1]],
            dwelt: values[2..].to_vec(),
            problem,
            method,
            solutions,
        })
    }

    /// The layers, from the lit face down.
    pub fn layers(&self) -> &[Layer] {
        &self.problem.layers
    }

    /// What lies below them.
    pub fn ground(&self) -> Ground {
        self.problem.ground
    }

    /// How the light falls on the lit face, if any does.
    pub fn incidence(&self) -> Option<Incidence> {
        self.problem.incidence
    }

    /// Optical thickness of all layers \[1\].
    pub fn tau(&self) -> f64 {
        self.problem.tau()
    }

    /// Depths of the interfaces in mean free paths, the two faces included.
    pub fn depths(&self) -> &[f64] {
        &self.problem.depths
    }

    /// Power that leaves through the lit face \[1\], that of the sources included.
    pub fn reflectance(&self) -> Value {
        self.leaving[0].plus(self.reflected, self.method)
    }

    /// Power that the lit face returns before any light enters \[1\].
    pub fn specular(&self) -> Result<Value> {
        self.problem.specular()
    }

    /// Power that leaves through the lit face without a collision \[1\]: by all faces, a mirror included.
    pub fn reflectance_direct(&self) -> Value {
        self.reflected
    }

    /// Power that leaves through the lit face after a scattering, a reflection by a Lambertian ground or from a source \[1\].
    pub fn reflectance_diffuse(&self) -> Value {
        self.leaving[0]
    }

    /// Power that arrives at the ground \[1\], direct light and that of the sources included.
    ///
    /// Over a black ground it is what leaves the slab; else the ground returns some of it, and faces over it return light
    /// once more.
    pub fn transmittance(&self) -> Result<Value> {
        Ok(self.transmittance_direct()?.plus(self.leaving[1], self.method))
    }

    /// Power that arrives at the ground without a collision on its way from the lit face \[1\].
    pub fn transmittance_direct(&self) -> Result<Value> {
        self.problem.arrived()
    }

    /// Power that arrives at the ground after a scattering, a reflection by the ground or from a source \[1\].
    pub fn transmittance_diffuse(&self) -> Value {
        self.leaving[1]
    }

    /// Power that the ground keeps, less what it sends out by itself \[1\].
    pub fn absorptance_ground(&self) -> Result<Value> {
        let ground = self.problem.ground;
        let kept = self.transmittance()?.scaled(1.0 - ground.reflectance);
        Ok(kept.plus(Value::rounded(-ground.exitance, 1.0, self.method), self.method))
    }

    /// Power that layer i, from 0, absorbs \[1\]: (1-w) times the integral of the fluence.
    ///
    /// # Errors
    /// `Error::OutOfRange` naming `layer`
    pub fn absorptance(&self, layer: usize) -> Result<Value> {
        let i = self.check_layer(layer)?;
        Ok(self.dwelt[i].scaled(1.0 - self.problem.layers[i].albedo))
    }

    /// Fluence of layer i, from 0, on average over its depth \[1\].
    ///
    /// # Errors
    /// `Error::OutOfRange` naming `layer`
    pub fn mean_fluence(&self, layer: usize) -> Result<Value> {
        let i = self.check_layer(layer)?;
        let tau = self.problem.layers[i].tau;
        if tau == 0.0 {
            return Ok(self.light_in(i, 0.0)?[0]);
        }
        Ok(self.dwelt[i].scaled(1.0 / tau))
    }

    fn check_layer(&self, layer: usize) -> Result<usize> {
        let last = self.problem.layers.len() - 1;
        within("layer", layer as f64, 0.0, last as f64, "0 to one less than their number")?;
        Ok(layer)
    }

    /// Fluence at depth t, direct light included \[1\].
    ///
    /// # Arguments
    /// `t` depth in mean free paths, 0 to that of the ground
    /// # Errors
    /// `Error::OutOfRange` naming `t`
    pub fn fluence(&self, t: f64) -> Result<Value> {
        Ok(self.light(t)?[0])
    }

    /// Power downwards through a plane at depth t, direct light included \[1\].
    ///
    /// # Errors
    /// `Error::OutOfRange` naming `t`
    pub fn flux_down(&self, t: f64) -> Result<Value> {
        Ok(self.light(t)?[1])
    }

    /// Power upwards through a plane at depth t \[1\].
    ///
    /// # Errors
    /// `Error::OutOfRange` naming `t`
    pub fn flux_up(&self, t: f64) -> Result<Value> {
        Ok(self.light(t)?[2])
    }

    /// Net flux downwards at depth t \[1\]: [`Self::flux_down`] less [`Self::flux_up`].
    ///
    /// # Errors
    /// `Error::OutOfRange` naming `t`
    pub fn flux(&self, t: f64) -> Result<Value> {
        let [_, down, up] = self.light(t)?;
        Ok(down.plus(up.scaled(-1.0), self.method))
    }

    /// Fluence, power downwards and upwards.
    fn light(&self, t: f64) -> Result<[Value; 3]> {
        check_depth(t, self.tau())?;
        let (i, x) = self.problem.place(t);
        self.light_in(i, x)
    }

    fn light_in(&self, i: usize, x: f64) -> Result<[Value; 3]> {
        let direct = self.problem.direct(i, x)?;
        let [fine, coarse] = self.pair(i, x)?;
        let ladder = self.ladders[i].get_or_init(|| self.ladder(i)).as_ref().map_err(Clone::clone)?;
        // As in AddingDoubling: the difference swings with ln x, with a period of about a step of the ladder.
        let at = ladder.partition_point(|&(depth, _)| depth < x);
        let near = &ladder[at.saturating_sub(2)..(at + 2).min(ladder.len())];
        let [rounded, absolute] = self.solutions[0].rounding();
        let horizons = self.horizons(i, self.problem.depths[i] + x, fine[0] + direct[0].value);
        Ok(std::array::from_fn(|which| {
            let shared = near.iter().fold(0.0, |a: f64, (_, d)| a.max(d[which]));
            let difference = (fine[which] - coarse[which]).abs() + horizons[which];
            // Direct light has been taken out.
            let rounding = rounded * (fine[which].abs() + direct[which].value) + absolute;
            let error = difference + shared * fine[which].abs() + rounding;
            let scattered = Value::new(fine[which], error + f64::MIN_POSITIVE, self.method);
            direct[which].plus(scattered, self.method)
        }))
    }

    /// What the nodes leave open of fluence and fluxes by the light that comes from behind interfaces close by, almost
    /// level. Its radiance changes there by what is emitted and scattered, which is taken to be at most four times its mean
    /// over directions: tried against a third set of nodes, not proved. Fluxes are made of it on their way, as far as it is of
    /// one size.
    fn horizons(&self, layer: usize, t: f64, fluence: f64) -> [f64; 3] {
        let Problem { layers, ground, depths, .. } = self.problem.as_ref();
        let mut sum = [0.0; 3];
        for (k, depth) in depths.iter().enumerate() {
            let d = (t - depth).abs();
            // Farther off it is below rounding.
            if d > 0.0 && d < 0.1 {
                let beside = &layers[k.saturating_sub(1)..(k + 1).min(layers.len())];
                let source = |layer: &Layer| layer.emission + layer.albedo * fluence;
                let mut step = beside.iter().map(source).fold(0.0, f64::max);
                // A mirror is no step.
                if k == layers.len() && !ground.mirror {
                    step += ground.exitance + ground.reflectance * fluence;
                }
                let open = self.solutions[0].unresolved(layer, d) * step;
                sum[0] += open;
                sum[1] += open * t.min(16.0 * d);
                sum[2] += open * (self.tau() - t).min(16.0 * d);
            }
        }
        sum
    }

    fn pair(&self, i: usize, x: f64) -> Result<[[f64; 3]; 2]> {
        Ok([self.solutions[0].light(i, x)?, self.solutions[1].light(i, x)?])
    }

    fn ladder(&self, i: usize) -> Result<Ladder> {
        let tau = self.problem.layers[i].tau;
        let places = if tau > 0.0 { depths(tau) } else { vec![0.0] };
        let steps = places.into_iter().map(|x| {
            let [fine, coarse] = self.pair(i, x)?;
            let relative = |which: usize| {
                let difference: f64 = fine[which] - coarse[which];
                if fine[which] == 0.0 { 0.0 } else { (difference / fine[which]).abs() }
            };
            Ok((x, [relative(0), relative(1), relative(2)]))
        });
        steps.collect()
    }

    /// Mean over azimuth of the radiance at depth t in directions of signed cosine mu, by adding.
    ///
    /// Without light of the lit face that has not met the medium or a Lambertian ground: neither the beam, nor diffuse
    /// light on its way down, nor either of them in a mirror.
    /// # Arguments
    /// `t` depth in mean free paths, 0 to that of the ground; `cosines` 1 to 64 of them, -1 to 1, positive towards the lit
    /// face, at least 1e-5 from 0
    /// # Returns
    /// \[1/sr\]; the slab is solved anew, for all cosines at once
    /// # Errors
    /// `Error::OutOfRange` naming `t`, `mu` or `cosines`
    pub fn radiance(&self, t: f64, cosines: &[f64]) -> Result<Vec<Value>> {
        check_depth(t, self.tau())?;
        within("cosines", cosines.len() as f64, 1.0, COSINES, "1 to 64 of them")?;
        for &mu in cosines {
            within("mu", mu, -1.0, 1.0, "-1 to 1")?;
            within("mu", mu.abs(), 1e-5, 1.0, "1e-5 or more in magnitude with layers")?;
        }
        let heights: Vec<f64> = cosines.iter().map(|mu| mu.abs()).collect();
        let (i, x) = self.problem.place(t);
        let index = self.problem.index(i);
        let solve = |set| Added::new(self.problem.clone(), set, index, &heights);
        let sets = [solve(0)?, solve(1)?];
        let rounding = sets[0].rounding()[0];
        let of = |(user, &mu): (usize, &f64)| {
            let of =
                |added: &Added| added.radiance(i, x, user).map(|[down, up]| if mu > 0.0 { up } else { down });
            let (fine, coarse) = (of(&sets[0])?, of(&sets[1])?);
            let error = 2.0 * (fine - coarse).abs() + rounding * fine.abs() + f64::MIN_POSITIVE;
            Ok(Value::new(fine, error, ADDING))
        };
        cosines.iter().enumerate().map(of).collect()
    }
}
