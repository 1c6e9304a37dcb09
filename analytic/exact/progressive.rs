//! `exact progressive`: schedules of shrinking radii, one map a pass.

use crate::answer::{Answer, Reply};
use crate::plot::{Curve, figure, panel, ratios};
use crate::read::dimension;
use anyhow::Result;
use turbid_analytic::Dimension;
use turbid_analytic::progressive::progressive;
use turbid_figure::Axis;

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

/// Answers; the figure shows the three ratios against the number of passes.
pub fn answer(args: &Args, draw: bool) -> Result<Reply> {
    let d = args.dimension;
    let alpha = args.alpha.unwrap_or(4.0 / (f64::from(d.number()) + 4.0));
    let mut answer = Answer::new("progressive").with("dimension", d.number()).with("alpha", alpha);
    for &n in &args.passes {
        let at = || vec![("passes", n.into())];
        let mean = progressive(d, alpha, n)?;
        answer.add_at("radius_ratio", at(), mean.radius);
        answer.add_at("variance_ratio", at(), mean.variance);
        answer.add_at("bias_ratio", at(), mean.bias);
    }
    let figure = if draw { Some(schedule(args, alpha)?) } else { None };
    Ok(Reply { answer, figure })
}

fn schedule(args: &Args, alpha: f64) -> Result<turbid_figure::Figure> {
    let last = f64::from(args.passes.iter().copied().max().unwrap_or(1).max(10));
    let x: Vec<f64> = ratios(1.0, last, 61).into_iter().map(libm::round).collect();
    let at = |n: f64| progressive(args.dimension, alpha, n as u32);
    let curves = vec![
        Curve::sample("radius", &x, |n| Ok(at(n)?.radius.value))?,
        Curve::sample("variance of the mean", &x, |n| Ok(at(n)?.variance.value))?,
        Curve::sample("bias of the mean", &x, |n| Ok(at(n)?.bias.value))?,
    ];
    let title = format!("Progressive passes in {} dimensions, α = {alpha:.3}", args.dimension.number());
    Ok(figure(title, panel(Axis::log("Passes n", ""), "Over the first pass", "", curves)))
}
