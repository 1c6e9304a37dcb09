//! The homogeneous slab order by order: light that was scattered exactly n times, any phase function.
//!
//! The azimuthal mean of the radiance, times 2 pi, of order n, J_n(t, mu), mu > 0 upwards, has the source
//!
//! S_n(t, mu) = (albedo/2) int sum_l (2l+1) chi_l P_l(mu) P_l(mu') J_(n-1)(t, mu') dmu',
//!
//! and J_n is its integral along the ray, int S_n(t', mu) e^(-|t-t'|/|mu|) dt'/|mu|. The fluence of order n is
//! int J_n dmu, the fluxes through the faces int |mu| J_n dmu. Order 0 is the direct light, in closed form. The light
//! that a beam has scattered once is closed in depth and one integral over mu.
//!
//! The orders are wanted for themselves (how much of a glow is single scattering?), for tests of photon maps that keep
//! the order of each photon, and as the exact answer in thin or dark slabs, where a few of them are all.
//!
//! Sources are polynomials on panels of depth that are graded towards both faces, where the fluence is like
//! c + t ln t; along rays they are integrated exactly, whatever the slope of the ray. Directions crowd towards the
//! horizon by decades. Everything is computed on two such grids, both of more depths, directions and moments in the
//! finer; the bound is their difference, shared with the neighbours so that no accident makes it vanish, plus
//! roundings. Its sums have no negative terms but for the phase function's series: orders of any smallness keep their
//! relative accuracy.
//!
//! Limits: n collisions need a path of at least tau to cross the slab, so that T_n is at most albedo^n times the
//! Poisson probability of up to n events in tau; thin slabs: order n falls like (tau ln(1/tau))^n; the sum over all orders is
//! the whole of [`crate::AnisotropicSlab`].
//!
//! Source: van de Hulst 1980, chapter 4; Irvine 1975 (successive orders); Chandrasekhar 1960, chapter III.

mod directions;
mod grid;
mod mesh;
mod once;
mod rays;
mod scattering;
#[cfg(test)]
mod tests;

use crate::beer_lambert::{direct_transmittance, uncollided_fluence};
use crate::error::{Error, Result, within};
use crate::exponential_integral::e_n;
use crate::incidence::{Incidence, check_albedo, check_depth};
use crate::phase::Phase;
use crate::poisson::at_most;
use crate::value::Value;
use grid::{Grid, Order};
use libm::{exp, expm1, log};
use once::Once;
use std::sync::{Mutex, OnceLock, PoisonError};

const METHOD: &str = "successive orders, two grids";

/// Highest order.
const HIGHEST: u32 = 100;

/// Depth beyond which the light of the first orders is nothing: a path of that length has more than [`HIGHEST`]
/// collisions but for a chance of 1e-40 or so, which the bounds count.
const DEEPEST: f64 = 300.0;

/// The largest part of a phase function that the first moment left out may be.
const LEFT_OUT: f64 = 1e-5;

/// The finer and the coarser grid: cuts of moments and directions, most moments, nodes a panel.
const GRIDS: [(f64, usize, usize); 2] = [(1e-12, 1200, 16), (1e-9, 800, 14)];

/// A slab whose light is sorted by the number of its scatterings.
pub struct ScatteringOrders {
    tau: f64,
    albedo: f64,
    incidence: Incidence,
    once: Option<Once>,
    /// Up to the highest that counts.
    moments: Vec<f64>,
    grids: OnceLock<[Grid; 2]>,
    /// Roundings of one order, in ulps.
    ulps: f64,
    /// Largest value of 4 pi times the phase function.
    peak: f64,
    kept: Mutex<Vec<[Order; 2]>>,
}

impl ScatteringOrders {
    /// Prepares the slab; an order is computed when it is first asked for, and kept.
    ///
    /// # Arguments
    /// `tau` optical thickness \[1\], 1e-12 to 1e300; `albedo` 0 to 1; `phase` of any shape whose moments beyond 1200 are
    /// below 1e-5 (Henyey-Greenstein from -0.99 to 0.99); `incidence` of unit irradiance, a beam with a cosine of 1e-5
    /// to 1
    /// # Errors
    /// `Error::OutOfRange` naming `tau`, `albedo`, `mu0` or `phase moment 1200`
    pub fn new(tau: f64, albedo: f64, phase: &Phase, incidence: Incidence) -> Result<Self> {
        within("tau", tau, 1e-12, 1e300, "1e-12 to 1e300")?;
        check_albedo(albedo)?;
        if let Incidence::Beam { mu0 } = incidence {
            within("mu0", mu0, 1e-5, 1.0, "1e-5 to 1 order by order, or diffuse")?;
        }
        let most = GRIDS[0].1;
        for l in most..2 * most {
            let chi = phase.moment(l);
            within("phase moment 1200", chi, -LEFT_OUT, LEFT_OUT, "-1e-5 to 1e-5, as |g| up to 0.99 gives")?;
        }
        let moments: Vec<f64> = (0..2 * most).map(|l| phase.moment(l)).collect();
        let once = match incidence {
            Incidence::Beam { mu0 } => Some(Once::new(tau, albedo, phase, mu0)),
            Incidence::Diffuse => None,
        };
        let weigh = |power: f64| -> f64 {
            let term =
                |(l, chi): (usize, &f64)| (2 * l + 1) as f64 * chi.abs() / libm::pow((l + 1) as f64, power);
            moments.iter().enumerate().map(term).sum()
        };
        // A source is a sum over moments; the mean magnitude of P_l falls like 1/sqrt(l).
        let ulps = 64.0 + 4.0 * weigh(0.5);
        let kept = Mutex::new(Vec::new());
        let (peak, grids) = (weigh(0.0), OnceLock::new());
        Ok(ScatteringOrders { tau, albedo, incidence, once, moments, grids, ulps, peak, kept })
    }

    /// Fraction of the incident power that leaves the lit face after exactly n scatterings \[1\].
    ///
    /// # Arguments
    /// `n` order, 0 to 100
    /// # Errors
    /// `Error::OutOfRange` naming `n`
    /// # Limits
    /// n = 0: nothing
    pub fn reflectance(&self, n: u32) -> Result<Value> {
        check_order(n)?;
        match (n, &self.once) {
            (0, _) => Ok(Value::new(0.0, 0.0, "direct light is not reflected")),
            (1, Some(once)) => once.reflectance(),
            _ => Ok(self.flux(n, |order| order.reflected)),
        }
    }

    /// Fraction of the incident power that leaves the far face after exactly n scatterings \[1\].
    ///
    /// # Arguments
    /// `n` order, 0 to 100
    /// # Errors
    /// `Error::OutOfRange` naming `n`
    /// # Limits
    /// n = 0: the direct light
    pub fn transmittance(&self, n: u32) -> Result<Value> {
        check_order(n)?;
        match (n, &self.once) {
            (0, _) => direct_transmittance(self.incidence, self.tau),
            (1, Some(once)) => once.transmittance(),
            _ if self.tau > DEEPEST => Ok(Value::new(
                0.0,
                at_most(n, DEEPEST) + f64::MIN_POSITIVE,
                "Poisson bound on the path's collisions",
            )),
            _ => Ok(self.flux(n, |order| order.transmitted)),
        }
    }

    /// Fraction of the incident power that is absorbed at its collision n + 1, after exactly n scatterings \[1\].
    ///
    /// (1 - albedo) times the integral of the fluence of order n. What is scattered there instead leaves or collides
    /// again: albedo C_n = R_(n+1) + T_(n+1) + C_(n+1), C_n the integral.
    /// # Arguments
    /// `n` order, 0 to 100
    /// # Errors
    /// `Error::OutOfRange` naming `n`
    pub fn absorptance(&self, n: u32) -> Result<Value> {
        check_order(n)?;
        let collided = if n == 0 {
            let value = match self.incidence {
                Incidence::Beam { mu0 } => -expm1(-self.tau / mu0),
                // 1 - 2 E_3 = 1 - e^(-tau) + tau E_2.
                Incidence::Diffuse => -expm1(-self.tau) + self.tau.min(1e3) * e_n(2, self.tau.min(1e3)),
            };
            Value::rounded(value, 32.0, "closed form")
        } else {
            self.flux(n, |order| order.collided)
        };
        Ok(collided.scaled(1.0 - self.albedo))
    }

    /// Fluence of light scattered exactly n times at depth t, per unit irradiance on the lit face \[1\].
    ///
    /// # Arguments
    /// `n` order, 0 to 100; `t` depth in mean free paths, 0 to tau
    /// # Errors
    /// `Error::OutOfRange` naming `n` or `t`
    /// # Limits
    /// n = 0: the direct light; deeper than 300: nothing, within a bound that falls like (e t/n)^n e^(-t)
    pub fn fluence(&self, n: u32, t: f64) -> Result<Value> {
        check_order(n)?;
        check_depth(t, self.tau)?;
        match (n, &self.once) {
            (0, _) => uncollided_fluence(self.incidence, t),
            (1, Some(once)) => once.fluence(t),
            _ if t > DEEPEST => Ok(Value::new(0.0, self.tail(n, t), "bound on light so deep")),
            _ => Ok(self.with(n, |orders| {
                let mesh = &self.grids()[0].mesh;
                let fine = mesh.interpolate(&orders[0].fluence, t);
                let coarse = self.grids()[1].mesh.interpolate(&orders[1].fluence, t);
                let (panel, _) = mesh.find(t);
                let last = mesh.panels() - 1;
                let near = &orders[0].defect[panel.saturating_sub(1)..=(panel + 1).min(last)];
                let shared = near.iter().fold(0.0, |a: f64, &b| a.max(b));
                self.value(n, fine, (fine - coarse).abs().max(shared * fine.abs()))
            })),
        }
    }

    /// A flux of order n >= 1: the difference of the two grids, but never less than the smallest relative one of its
    /// siblings.
    fn flux(&self, n: u32, pick: impl Fn(&Order) -> f64) -> Value {
        self.with(n, |orders| {
            let [fine, coarse] = [pick(&orders[0]), pick(&orders[1])];
            let relative = |f: fn(&Order) -> f64| {
                let [a, b] = [f(&orders[0]), f(&orders[1])];
                if a == 0.0 { 0.0 } else { ((a - b) / a).abs() }
            };
            let shared =
                relative(|o| o.reflected).max(relative(|o| o.transmitted)).max(relative(|o| o.collided));
            // A deep slab's transmittance has few digits, which is nothing to the others.
            let largest = (orders[0].collided - orders[1].collided).abs();
            self.value(n, fine, (fine - coarse).abs().max((shared * fine.abs()).min(largest)))
        })
    }

    fn value(&self, n: u32, fine: f64, difference: f64) -> Value {
        let rounding = f64::from(n) * self.ulps * f64::EPSILON * fine.abs();
        // What a thicker slab than the grid's sends back from below.
        let cut = if self.tau > DEEPEST { f64::from(n) * self.tail(n, DEEPEST) } else { 0.0 };
        Value::new(fine, difference + rounding + cut + f64::MIN_POSITIVE, METHOD)
    }

    /// Bound on the fluence of order n at depths beyond t.
    ///
    /// With a weight e^(a t), 0 <= a < 1, a ray integral grows by 1/(1-a) at most and scattering by the albedo, so that
    /// sup J_n e^(a t) <= (albedo/(1-a))^n sup J_0 e^(a t), where for a beam the first of the factors has the peak of the
    /// phase function; a = 1 - n/t.
    fn tail(&self, n: u32, t: f64) -> f64 {
        let n = f64::from(n).max(1.0);
        let first = match self.incidence {
            Incidence::Beam { mu0 } => self.peak / mu0,
            Incidence::Diffuse => 4.0,
        };
        first * exp(n * (1.0 + log(t / n)) - t) + f64::MIN_POSITIVE
    }

    fn grids(&self) -> &[Grid; 2] {
        self.grids.get_or_init(|| {
            GRIDS.map(|(cut, most, nodes)| {
                let end = self.moments.iter().rposition(|chi| chi.abs() > cut).map_or(1, |l| l + 1).min(most);
                let tau = self.tau.min(DEEPEST);
                Grid::new(tau, self.albedo, &self.moments[..end], self.incidence, cut, nodes)
            })
        })
    }

    /// Asks order n >= 1 on both grids; it is made from its predecessors, which are kept.
    fn with<T>(&self, n: u32, ask: impl FnOnce(&[Order; 2]) -> T) -> T {
        let mut kept = self.kept.lock().unwrap_or_else(PoisonError::into_inner);
        while kept.len() < n as usize {
            let last = kept.last();
            let [fine, coarse] = [0, 1].map(|i| self.grids()[i].next(last.map(|orders| &orders[i])));
            let mut fine = fine;
            fine.defect = self.grids()[0].defects(&fine, &self.grids()[1], &coarse);
            if let Some(last) = kept.last_mut() {
                // Radiances are needed for the next order only.
                last.iter_mut().for_each(Order::forget);
            }
            kept.push([fine, coarse]);
        }
        ask(&kept[n as usize - 1])
    }
}

fn check_order(n: u32) -> Result<()> {
    if n > HIGHEST {
        return Err(Error::OutOfRange { name: "order", value: f64::from(n), allowed: "0 to 100" });
    }
    Ok(())
}
