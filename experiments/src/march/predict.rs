//! What theory says of every case, before anything is measured.

use super::cases::{ALBEDO, Case, REACH, SETUP, TAU, photons};
use crate::harness::{Settings, Unit};
use crate::prediction::{PredictedError, Prediction, Term};
use crate::setups::Size;
use crate::theory::{Exact, Table, nearest_clustering};
use std::f64::consts::PI;
use turbid::integrators::StepRule;
use turbid::transport::in_parallel;
use turbid_analytic::kernel::Kernel;
use turbid_analytic::nearest::nearest_expectation;
use turbid_analytic::slab_kernel::{edge_loss, slab_moment};
use turbid_analytic::{Incidence, IsotropicSlab};

/// The terms of a case.
pub const TERMS: [Term; 4] = [Term::Step, Term::Edge, Term::Blur, Term::Clusters];

/// What interpolation of the kernel means adds to the error of a nearest expectation, tested in `theory::table`.
const INTERPOLATION: f64 = 1e-8;

/// What the estimate of the fluence at one depth is expected to be, over the exact fluence there less 1, in parts.
#[derive(Debug, Clone, Copy)]
struct AtDepth {
    exact: f64,
    edge: f64,
    blur: f64,
    clusters: f64,
    /// Bound on the error of exact fluence times the sum.
    error: f64,
}

/// The slab.
pub struct Theory {
    slab: IsotropicSlab,
    fluence: Exact,
    /// Photons per volume where the fluence is 1.
    density: f64,
}

impl Theory {
    /// The theory of maps of so many photons.
    pub fn new(photons: u64) -> anyhow::Result<Self> {
        Ok(Theory {
            slab: IsotropicSlab::new(TAU, ALBEDO, Incidence::Beam { mu0: 1.0 })?,
            fluence: SETUP.exact()?,
            density: SETUP.density(photons),
        })
    }

    /// The exact radiance and its bound.
    pub fn exact(&self, mu: f64) -> anyhow::Result<(f64, f64)> {
        let radiance = self.slab.radiance(0.0, mu)?;
        Ok((radiance.value, radiance.error))
    }

    fn at_depth(&self, t: f64, size: Size) -> anyhow::Result<AtDepth> {
        let (exact, exact_error) = (self.fluence)(t)?;
        let field = |depth: f64| (self.fluence)(depth).map_or(f64::NAN, |(value, _)| value);
        match size {
            Size::Radius(r) => {
                let split = edge_loss(Kernel::Uniform, r, t, TAU, field)?;
                let error = split.edge.error + split.blur.error + exact_error;
                let (edge, blur) = (split.edge.value / exact, split.blur.value / exact);
                Ok(AtDepth { exact, edge, blur, clusters: 0.0, error })
            }
            Size::Nearest(k) => {
                let neighbors = u32::try_from(k)?;
                let ball = |r: f64| self.density * 4.0 / 3.0 * PI * r * r * r;
                let table = Table::of_kernel_means(Kernel::Uniform, t, TAU, REACH, &self.fluence)?;
                let mean = nearest_expectation(neighbors, REACH, |r| ball(r) * table.at(r), |r| table.at(r))?;
                let inside =
                    |r| slab_moment(Kernel::Uniform, 0, r, t, TAU).map_or(f64::NAN, |v| exact * v.value);
                let uniform = nearest_expectation(neighbors, REACH, |r| ball(r) * inside(r), inside)?;
                let (edge, blur) = (uniform.value / exact - 1.0, (mean.value - uniform.value) / exact);
                // Where the medium ends inside the ball, neighbours are missing like the ball's own part.
                let part = 1.0 + edge;
                let clusters =
                    nearest_clustering(ALBEDO, 0.0, self.density * exact * part, k) * part * (part + blur);
                let error = mean.error + exact_error + INTERPOLATION * exact;
                Ok(AtDepth { exact, edge, blur, clusters, error })
            }
        }
    }

    /// The predicted error of one case. The weights of the rules are written here a second time: the simulator's own are what is
    /// tested.
    pub fn error(&self, case: &Case) -> anyhow::Result<PredictedError> {
        let (radiance, bound) = self.exact(case.mu)?;
        let (dx, count) = (case.step, (case.length() / case.step).round() as u32);
        let held = if case.rule == StepRule::Integrated { -libm::expm1(-dx) / dx } else { 1.0 };
        let at = if case.rule == StepRule::NearEnd { 0.0 } else { 0.5 };
        let attenuated_at = if case.rule == StepRule::Middle { 0.5 } else { 0.0 };
        let (mut step, mut edge, mut blur, mut clusters, mut error) = (0.0, 0.0, 0.0, 0.0, 0.0);
        for i in 0..count {
            let i = f64::from(i);
            let here = self.at_depth((i + at) * dx * case.mu, case.size)?;
            let weight = held * dx * libm::exp(-(i + attenuated_at) * dx) * ALBEDO / (4.0 * PI) / radiance;
            step += weight * here.exact;
            edge += weight * here.exact * here.edge;
            blur += weight * here.exact * here.blur;
            clusters += weight * here.exact * here.clusters;
            error += weight * here.error;
        }
        error += 2.0 * bound / radiance;
        let terms = TERMS.into_iter().zip([step - 1.0, edge, blur, clusters]).collect();
        Ok(PredictedError { exact: (radiance, bound), terms, error })
    }
}

/// The predictions, as they are written down before the measurement.
pub fn predict(settings: &Settings) -> anyhow::Result<Vec<Prediction>> {
    let theory = Theory::new(photons(settings))?;
    let cases = Case::all();
    let one = |case: &Case| {
        let sources = ["exact solution of the slab", "sum over steps of exact kernel means"];
        let source = |_| "weights of the rule times the part of each step";
        Ok(theory.error(case)?.predictions(&case.name(), ("radiance", Unit::RADIANCE), sources, source))
    };
    let all = in_parallel(cases.len(), |i| one(&cases[i])).into_iter().collect::<anyhow::Result<Vec<_>>>()?;
    Ok(all.into_iter().flatten().collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn case(mu: f64, step: f64, rule: StepRule) -> Case {
        Case { mu, step, rule, size: Size::Radius(0.2) }
    }

    /// The step's own error against the expansions of Euler and Maclaurin: the rule of 1998 sums half a step too much at
    /// the near end and half a step too little at the far one. The others err by dx^2 (A + B ln dx): at a face the
    /// fluence is phi(0) (1 - (w/2) t ln t) + ..., and a midpoint sum of t ln t errs by zeta(-1, 1/2) dx^2 ln dx =
    /// dx^2 ln dx / 24 (Navot 1961); at the far face the same, attenuated.
    #[test]
    fn step_errors_fall_as_they_must() {
        let theory = Theory::new(50_000).unwrap();
        let step = |dx, rule| theory.error(&case(1.0, dx, rule)).unwrap().of(Term::Step);
        let per_fluence = ALBEDO / (4.0 * PI) / theory.exact(1.0).unwrap().0;
        let near = (theory.fluence)(0.0).unwrap().0 * per_fluence;
        let far = (theory.fluence)(TAU).unwrap().0 * libm::exp(-TAU) * per_fluence;
        let dx = 0.0125;
        // Behind it, dx ln dx: 3 %, with a factor of order 1.
        assert!((step(dx, StepRule::NearEnd) / (0.5 * dx * (near - far)) - 1.0).abs() < 0.03);
        let b = -0.5 * ALBEDO / 24.0 * (near + far);
        for rule in [StepRule::Middle, StepRule::Integrated] {
            let over_square = |dx: f64| step(dx, rule) / (dx * dx);
            let found = (over_square(dx) - over_square(0.5 * dx)) / libm::log(2.0);
            // The next term is dx^3 without a logarithm: of order dx, a few per cent, of this one.
            assert!((found / b - 1.0).abs() < 0.05, "{rule:?}: {found}, not {b}");
        }
    }

    /// Four steps along a slant ray, summed by hand.
    #[test]
    fn parts_are_sums_over_depths() {
        let theory = Theory::new(50_000).unwrap();
        let error = theory.error(&case(0.5, 1.0, StepRule::Middle)).unwrap();
        let (radiance, _) = theory.exact(0.5).unwrap();
        let sum: f64 = [0.25, 0.75, 1.25, 1.75]
            .iter()
            .zip([0.5, 1.5, 2.5, 3.5])
            .map(|(&t, x)| libm::exp(-x) * (theory.fluence)(t).unwrap().0)
            .sum();
        assert!((error.of(Term::Step) + 1.0 - sum * ALBEDO / (4.0 * PI) / radiance).abs() < 1e-12);
        // No ball of these steps reaches a face.
        assert!(error.of(Term::Edge).abs() < 1e-12 && error.of(Term::Clusters) == 0.0);
    }
}
