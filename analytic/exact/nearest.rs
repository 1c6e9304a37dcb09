//! `exact nearest`: the estimate from the k nearest points.

use crate::answer::Answer;
use crate::plot::{Curve, even, figure, panel};
use crate::question::{Question, Solved};
use crate::read::{dimension, kernel, kernel_name};
use crate::unit::Unit;
use anyhow::{Result, ensure};
use turbid_analytic::nearest::{
    biased_factor, nearest_curved, nearest_expectation_exponential, nearest_square_distance,
    nearest_variance_uniform, optimum_neighbors,
};
use turbid_analytic::{Dimension, Kernel, Value};
use turbid_figure::{Axis, Figure};

/// The k nearest of independent points: what the estimate expects, how it scatters, how far it gathers.
///
/// The rule: r_k is the distance of the k-th nearest point, the kernel of radius r_k is summed over the k - 1 nearer
/// ones. For the uniform kernel that is (k-1)/(N V(r_k)), unbiased where the density is uniform; k over the same ball
/// is high by k/(k-1). In the field e^(b.x) the mean is
///
///   E = int_0^inf p_(k-2)(s) M(r(s)) ds,   p_n(s) = e^(-s) s^n/n!,   s = points expected within r,
///
/// M(r) the kernel's mean of the field at radius r. In a field of curvature c = lap f/f, to second order in the radius,
///
///   bias = A c E[r_k^2],   variance = R V/(k-2) + O(c),   A = m2/(2d), R the roughness, V the unit ball
///
/// and the best k makes bias^2 + variance least. Lengths are in units of your choice, densities per unit volume.
/// Source: Loftsgaarden and Quesenberry 1965; Mack and Rosenblatt 1979.
#[derive(Clone, clap::Args)]
#[command(verbatim_doc_comment)]
pub struct Args {
    /// Points gathered, 2 to 1e6 (3 and more for a variance).
    #[arg(long, allow_negative_numbers = true)]
    k: u32,
    /// Dimension of space: 1, 2 or 3.
    #[arg(long, default_value = "3", value_parser = dimension)]
    dimension: Dimension,
    /// Points expected per unit length, area or volume at the probe, 1e-100 to 1e100.
    #[arg(long, default_value_t = 1.0, allow_negative_numbers = true)]
    density: f64,
    /// Number of points in all; without it a Poisson number.
    #[arg(long, allow_negative_numbers = true)]
    points: Option<u64>,
    /// Kernel, by name as in `exact kernel`.
    #[arg(long, default_value = "uniform", value_parser = kernel)]
    kernel: Kernel,
    /// Gradients |b| of exponential fields, in 1/length: gives the expectation over the field at the probe.
    #[arg(long, num_args = 1.., value_delimiter = ',', value_name = "B", allow_negative_numbers = true)]
    gradient: Vec<f64>,
    /// Laplacians of the field over the field, in 1/length^2: gives bias, variance and mean squared error to second order in
    /// the radius, relative, and for a curvature that is not 0 the k of least mean squared error
    #[arg(verbatim_doc_comment, long, num_args = 1.., value_delimiter = ',', value_name = "C", allow_negative_numbers = true)]
    curvature: Vec<f64>,
    /// Largest radius of a gather; without it, six times the radius within which k points are expected.
    #[arg(long, allow_negative_numbers = true)]
    cap: Option<f64>,
}

impl Args {
    /// The radius within which k points are expected, and the largest radius of a gather.
    fn reach(&self) -> (f64, f64) {
        let d = self.dimension;
        let typical =
            libm::pow(f64::from(self.k) / (self.density * d.ball_volume()), 1.0 / f64::from(d.number()));
        (typical, self.cap.unwrap_or(6.0 * typical))
    }
}

impl Question for Args {
    fn answer(&self, answer: &mut Answer, _: &Solved) -> Result<()> {
        let (k, d, density) = (self.k, self.dimension, self.density);
        answer
            .of("nearest")
            .with("k", k)
            .with("dimension", d.number())
            .with("density", density)
            .with("kernel", kernel_name(self.kernel));
        if let Some(points) = self.points {
            answer.with("points", points);
        }
        answer.add("k_over_volume_factor", Unit::One, &[], biased_factor(k)?);
        if k > 2 {
            answer.add(
                "relative_variance_uniform",
                Unit::One,
                &[],
                nearest_variance_uniform(k, self.points)?,
            );
        }
        let distance = |k| nearest_square_distance(d, k, density, self.points);
        answer.add("mean_square_distance_k", Unit::Length(2), &[], distance(k)?);
        answer.add("mean_square_distance_k_minus_1", Unit::Length(2), &[], distance(k - 1)?);
        let (_, cap) = self.reach();
        for &b in &self.gradient {
            let mean = nearest_expectation_exponential(self.kernel, d, k, density, b, cap)?;
            let at = [("gradient", b.into()), ("cap", cap.into())];
            answer.add("expectation_exponential", Unit::Field, &at, mean);
        }
        for &c in &self.curvature {
            let at = [("curvature", c.into())];
            let curved = nearest_curved(self.kernel, d, k, density, c)?;
            answer.add("relative_bias", Unit::One, &at, curved.bias);
            answer.add("relative_variance", Unit::One, &at, curved.variance);
            answer.add("relative_mean_squared_error", Unit::One, &at, curved.mean_squared_error);
            if c != 0.0 {
                let (best, left) = optimum_neighbors(self.kernel, d, density, c)?;
                let best = Value { value: f64::from(best), error: 0.0, method: "least of all whole numbers" };
                answer.add("optimum_k", Unit::One, &at, best);
                answer.add("optimum_mean_squared_error", Unit::One, &at, left);
            }
        }
        Ok(())
    }

    /// The expectation in an exponential field against its gradient.
    fn figure(&self, _: &Solved) -> Result<Figure> {
        let (typical, cap) = self.reach();
        ensure!(
            typical.is_finite() && typical > 0.0,
            "density is {}; allowed: 1e-100 to 1e100",
            self.density
        );
        let largest = self.gradient.iter().fold(1.0 / typical, |a: f64, b| a.max(b.abs()));
        let curve = Curve::sample("", &even(0.0, largest, 41), |b| {
            let mean =
                nearest_expectation_exponential(self.kernel, self.dimension, self.k, self.density, b, cap)?;
            // Without a gradient there is no bias, and what is left of it lies within the bound.
            let bias = mean.value - 1.0;
            Ok(if bias <= mean.error { 0.0 } else { 100.0 * bias })
        })?;
        let title =
            format!("The {} nearest in the field exp(b·x), {} dimensions", self.k, self.dimension.number());
        let x = Axis::linear("Gradient |b|", "1/length");
        Ok(figure(title, panel(x, "Bias", "% of the field at the probe", vec![curve])))
    }
}
