//! `exact kernel`: what is known of one kernel.

use crate::answer::{Answer, Reply};
use crate::plot::{Curve, even, figure, panel};
use crate::read::{dimension, kernel, kernel_name};
use anyhow::Result;
use turbid_analytic::ball_mean::exponential_mean;
use turbid_analytic::blur::{
    edge_spread, equivalent_width, kernel_transfer, line_deviation, line_spread, missing_length, rise_width,
};
use turbid_analytic::slab_kernel::face_moment;
use turbid_analytic::{Dimension, Kernel};
use turbid_figure::Axis;

/// A smoothing kernel: moments, variance, exponential fields, faces, edges and sinusoids.
///
/// A kernel K of unit integral over R^d, at radius r K(u/r)/r^d, smooths N independent points of density f:
///
///   bias     = m2/(2d) r^2 lap f + m4/(8 d (d+2)) r^4 lap^2 f + ...,    m_j = int |u|^j K(u) du
///   variance = (1/N) (R f/r^d - f^2 + ...),                             R = int K^2
///
/// Lengths are in radii; all values are pure numbers. The uniform kernel also gives the images of an edge and a line.
/// Source: Silverman 1986, chapter 4; the cone is Jensen 1996.
#[derive(Clone, clap::Args)]
#[command(verbatim_doc_comment)]
pub struct Args {
    /// uniform, epanechnikov, biweight, cone_k1 (any number for the 1), gaussian (standard deviation r, untruncated)
    /// or truncated_gaussian (standard deviation r/3, cut at r)
    #[arg(verbatim_doc_comment, long, value_parser = kernel)]
    kernel: Kernel,
    /// Dimension of space: 1 (beams at a ray), 2 (photons on a surface) or 3 (photons in a medium).
    #[arg(long, default_value = "3", value_parser = dimension)]
    dimension: Dimension,
    /// Gradient times radius of exponential fields e^(b.x), -500 to 500 (Gaussian: 35): gives the kernel's mean over
    /// the value at the centre
    #[arg(verbatim_doc_comment, long, num_args = 1.., value_delimiter = ',', value_name = "X", allow_negative_numbers = true)]
    gradient: Vec<f64>,
    /// Depths over the radius behind a flat face (negative: outside): gives the moments M_0, M_1, M_2 of the cut kernel
    /// (dimension 3) and, for the uniform kernel, the images of an edge and of a line
    #[arg(verbatim_doc_comment, long, num_args = 1.., value_delimiter = ',', value_name = "X", allow_negative_numbers = true)]
    depth: Vec<f64>,
    /// Wave numbers times radius of sinusoids: gives the transfer of the kernel in three dimensions.
    #[arg(long, num_args = 1.., value_delimiter = ',', value_name = "Q", allow_negative_numbers = true)]
    wave: Vec<f64>,
}

/// Answers; the figure shows the profile K(u).
pub fn answer(args: &Args, draw: bool) -> Result<Reply> {
    let (kernel, d) = (args.kernel, args.dimension);
    let name = kernel_name(kernel);
    let mut answer = Answer::new("kernel").with("kernel", name.as_str()).with("dimension", d.number());
    answer.add("normalization", kernel.normalization(d)?);
    answer.add("m2", kernel.moment(d, 2)?);
    answer.add("m4", kernel.moment(d, 4)?);
    answer.add("roughness", kernel.roughness(d)?);
    answer.add("bias_per_r2_laplacian", kernel.bias_coefficient(d)?);
    answer.add("bias_per_r4_bilaplacian", kernel.second_bias_coefficient(d)?);
    answer.add("variance_coefficient", kernel.variance_coefficient(d)?);
    let uniform = kernel == Kernel::Uniform;
    if uniform {
        answer.add("equivalent_width", equivalent_width(d));
        answer.add("line_deviation", line_deviation(d));
        answer.add("rise_width_10_90", rise_width(d));
        answer.add("missing_length", missing_length(d));
    }
    for &x in &args.gradient {
        answer.add_at("exponential_mean", vec![("gradient", x.into())], exponential_mean(kernel, d, x)?);
    }
    for &x in &args.depth {
        let at = || vec![("depth", x.into())];
        if d == Dimension::Three {
            for (j, moment) in (0..).zip(["face_moment_0", "face_moment_1", "face_moment_2"]) {
                answer.add_at(moment, at(), face_moment(kernel, j, x)?);
            }
        }
        if uniform {
            answer.add_at("edge_spread", at(), edge_spread(d, x)?);
            answer.add_at("line_spread", at(), line_spread(d, x)?);
        }
    }
    for &q in &args.wave {
        anyhow::ensure!(d == Dimension::Three, "dimension is {}; allowed with --wave: 3", d.number());
        answer.add_at("transfer", vec![("wave", q.into())], kernel_transfer(kernel, q)?);
    }
    let figure = if draw { Some(profiles(kernel, d, &name)?) } else { None };
    Ok(Reply { answer, figure })
}

fn profiles(kernel: Kernel, d: Dimension, name: &str) -> Result<turbid_figure::Figure> {
    let reach = if kernel == Kernel::Gaussian { 3.0 } else { 1.0 };
    let curve = Curve::sample("", &even(0.0, reach, 201), |u| Ok(kernel.profile(d, u)?.value))?;
    let panel = panel(Axis::linear("Distance over radius, u/r", ""), "Kernel K(u)", "", vec![curve]);
    Ok(figure(format!("Kernel: {}, {} dimensions", name.replace('_', " "), d.number()), panel))
}
