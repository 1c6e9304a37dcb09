//! `exact progressive`: schedules of shrinking radii, one map a pass.

use crate::answer::Answer;
use crate::plot::{Curve, figure, panel, ratios};
use crate::question::{Question, Solved};
use crate::read::dimension;
use crate::unit::Unit;
use anyhow::Result;
use turbid_analytic::Dimension;
use turbid_analytic::progressive::progressive;
use turbid_figure::{Axis, Figure};

/// Progressive estimates: radius, variance and bias of the mean of n passes, over those of the first.
///
/// Radii shrink from pass to pass as r_(i+1)^d = r_i^d (i + alpha)/(i + 1); each pass is a map of its own, and the
/// estimate is the mean of the passes. Per pass the variance goes as r^(-d), the bias as r^2.
///
/// All values are pure numbers. The mean squared error falls fastest with alpha = 4/(d+4), as n^(-4/(d+4)).
/// Source: Hachisuka, Ogaki and Jensen 2008; Knaus and Zwicker 2011.
#[derive(Clone, clap::Args)]
#[command(verbatim_doc_comment)]
pub struct Args {
    /// Dimension of the blur: 1 (beams at a ray), 2 (photons on a surface) or 3 (photons in a medium).
    #[arg(long, default_value = "3", value_parser = dimension)]
    dimension: Dimension,
    /// How slowly radii shrink, above 0 to 1 (1: not at all); without it the optimum 4/(d+4).
    #[arg(long, allow_negative_numbers = true)]
    alpha: Option<f64>,
    /// Numbers of passes, 1 to 1e6.
    #[arg(long, num_args = 1.., value_delimiter = ',', value_name = "N", default_values_t = [10, 100, 1000], allow_negative_numbers = true)]
    passes: Vec<u32>,
}

impl Args {
    fn alpha(&self) -> f64 {
        self.alpha.unwrap_or(4.0 / (f64::from(self.dimension.number()) + 4.0))
    }
}

impl Question for Args {
    fn answer(&self, answer: &mut Answer, _: &Solved) -> Result<()> {
        let (d, alpha) = (self.dimension, self.alpha());
        answer.of("progressive").with("dimension", d.number()).with("alpha", alpha);
        for &n in &self.passes {
            let at = [("passes", n.into())];
            let mean = progressive(d, alpha, n)?;
            answer.add("radius_ratio", Unit::FirstPass, &at, mean.radius);
            answer.add("variance_ratio", Unit::FirstPass, &at, mean.variance);
            answer.add("bias_ratio", Unit::FirstPass, &at, mean.bias);
        }
        Ok(())
    }

    /// The three ratios against the number of passes.
    fn figure(&self, _: &Solved) -> Result<Figure> {
        let alpha = self.alpha();
        let last = f64::from(self.passes.iter().copied().max().unwrap_or(1).max(10));
        let x: Vec<f64> = ratios(1.0, last, 61).into_iter().map(libm::round).collect();
        let at = |n: f64| progressive(self.dimension, alpha, n as u32);
        let curves = vec![
            Curve::sample("radius", &x, |n| Ok(at(n)?.radius.value))?,
            Curve::sample("variance of the mean", &x, |n| Ok(at(n)?.variance.value))?,
            Curve::sample("bias of the mean", &x, |n| Ok(at(n)?.bias.value))?,
        ];
        let title = format!("Progressive passes in {} dimensions, α = {alpha:.3}", self.dimension.number());
        Ok(figure(title, panel(Axis::log("Passes n", ""), "Over the first pass", "", curves)))
    }
}
