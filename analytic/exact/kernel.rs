//! `exact kernel`: what is known of one kernel.

use crate::table::Table;
use turbid_analytic::ball_mean::exponential_mean;
use turbid_analytic::blur::{edge_spread, equivalent_width, line_deviation, line_spread, rise_width};
use turbid_analytic::slab_kernel::face_moment;
use turbid_analytic::{Dimension, Kernel};

/// What to ask of a kernel.
#[derive(clap::Args)]
pub struct Args {
    /// uniform, epanechnikov, biweight, cone_k1 (any number for the 1), gaussian (standard deviation r, untruncated)
    /// or truncated_gaussian (standard deviation r/3, cut at r).
    #[arg(long, value_parser = kernel)]
    kernel: Kernel,
    /// Dimension of space: 1, 2 or 3.
    #[arg(long, default_value = "3", value_parser = dimension)]
    dimension: Dimension,
    /// Gradient times radius of exponential fields: gives the kernel's mean over the value at the centre.
    #[arg(long, num_args = 1.., value_name = "X", allow_negative_numbers = true)]
    gradient: Vec<f64>,
    /// Depths over the radius behind a flat face: gives the moments M_0, M_1, M_2 of the cut kernel (dimension 3) and,
    /// for the uniform kernel, the images of an edge and of a line.
    #[arg(long, num_args = 1.., value_name = "X", allow_negative_numbers = true)]
    depth: Vec<f64>,
}

/// Reads a kernel's name.
pub fn kernel(text: &str) -> Result<Kernel, String> {
    match text {
        "uniform" => Ok(Kernel::Uniform),
        "epan" | "epanechnikov" => Ok(Kernel::Epanechnikov),
        "biweight" => Ok(Kernel::Biweight),
        "gauss" | "gaussian" => Ok(Kernel::Gaussian),
        "truncated_gauss" | "truncated_gaussian" => Ok(Kernel::TruncatedGaussian),
        _ => match text.strip_prefix("cone_k").map(str::parse) {
            Some(Ok(kappa)) => Ok(Kernel::Cone { kappa }),
            _ => Err(format!(
                "kernel is '{text}'; allowed: uniform, epanechnikov, biweight, cone_k1, gaussian, truncated_gaussian"
            )),
        },
    }
}

/// Reads a dimension.
pub fn dimension(text: &str) -> Result<Dimension, String> {
    match text {
        "1" => Ok(Dimension::One),
        "2" => Ok(Dimension::Two),
        "3" => Ok(Dimension::Three),
        _ => Err(format!("dimension is '{text}'; allowed: 1, 2, 3")),
    }
}

/// Answers.
pub fn answer(args: &Args) -> anyhow::Result<Table> {
    let (kernel, d) = (args.kernel, args.dimension);
    let mut table = Table::default();
    table.add("normalization K(0)", kernel.normalization(d)?);
    table.add("m2", kernel.moment(d, 2)?);
    table.add("m4", kernel.moment(d, 4)?);
    table.add("roughness", kernel.roughness(d)?);
    table.add("bias per r^2 laplacian", kernel.bias_coefficient(d)?);
    table.add("bias per r^4 bilaplacian", kernel.second_bias_coefficient(d)?);
    table.add("variance coefficient", kernel.variance_coefficient(d)?);
    for &x in &args.gradient {
        table.add(format!("exponential mean x={x}"), exponential_mean(kernel, d, x)?);
    }
    let uniform = kernel == Kernel::Uniform;
    if uniform {
        table.add("equivalent width", equivalent_width(d));
        table.add("line deviation", line_deviation(d));
        table.add("rise 10 to 90 per cent", rise_width(d));
    }
    for &x in &args.depth {
        if d == Dimension::Three {
            for j in 0..3 {
                table.add(format!("face moment M_{j} x={x}"), face_moment(kernel, j, x)?);
            }
        }
        if uniform {
            table.add(format!("edge x={x}"), edge_spread(d, x)?);
            table.add(format!("line x={x}"), line_spread(d, x)?);
        }
    }
    Ok(table)
}
