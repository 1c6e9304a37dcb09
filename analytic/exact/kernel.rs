//! `exact kernel`: what is known of one kernel.

use crate::answer::Answer;
use crate::plot::{Curve, even, figure, panel};
use crate::question::{Question, Solved};
use crate::read::{dimension, kernel, kernel_name};
use crate::unit::Unit;
use anyhow::Result;
use turbid_analytic::ball_mean::exponential_mean;
use turbid_analytic::blur::{
    edge_spread, equivalent_width, kernel_transfer, line_deviation, line_spread, missing_length, rise_width,
};
use turbid_analytic::slab_kernel::face_moment;
use turbid_analytic::{Dimension, Kernel};
use turbid_figure::{Axis, Figure};

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

impl Question for Args {
    fn answer(&self, answer: &mut Answer, _: &Solved) -> Result<()> {
        let (kernel, d) = (self.kernel, self.dimension);
        answer.of("kernel").with("kernel", kernel_name(kernel)).with("dimension", d.number());
        answer.ask("normalization", Unit::PerRadiusD, &[], || Ok(kernel.normalization(d)?))?;
        answer.ask("m2", Unit::Radius(2), &[], || Ok(kernel.moment(d, 2)?))?;
        answer.ask("m4", Unit::Radius(4), &[], || Ok(kernel.moment(d, 4)?))?;
        answer.ask("roughness", Unit::PerRadiusD, &[], || Ok(kernel.roughness(d)?))?;
        answer.ask("bias_per_r2_laplacian", Unit::One, &[], || Ok(kernel.bias_coefficient(d)?))?;
        answer.ask("bias_per_r4_bilaplacian", Unit::One, &[], || Ok(kernel.second_bias_coefficient(d)?))?;
        answer.ask("variance_coefficient", Unit::One, &[], || Ok(kernel.variance_coefficient(d)?))?;
        let uniform = kernel == Kernel::Uniform;
        if uniform {
            answer.add("equivalent_width", Unit::Radius(1), &[], equivalent_width(d));
            answer.add("line_deviation", Unit::Radius(1), &[], line_deviation(d));
            answer.add("rise_width_10_90", Unit::Radius(1), &[], rise_width(d));
            answer.add("missing_length", Unit::Radius(1), &[], missing_length(d));
        }
        for &x in &self.gradient {
            let at = [("gradient", x.into())];
            answer.ask("exponential_mean", Unit::Field, &at, || Ok(exponential_mean(kernel, d, x)?))?;
        }
        for &x in &self.depth {
            let at = [("depth", x.into())];
            if d == Dimension::Three {
                let units = [Unit::One, Unit::Radius(1), Unit::Radius(2)];
                let moments = ["face_moment_0", "face_moment_1", "face_moment_2"].into_iter().zip(units);
                for (j, (moment, unit)) in (0..).zip(moments) {
                    answer.ask(moment, unit, &at, || Ok(face_moment(kernel, j, x)?))?;
                }
            }
            if uniform {
                answer.ask("edge_spread", Unit::One, &at, || Ok(edge_spread(d, x)?))?;
                answer.ask("line_spread", Unit::Radius(-1), &at, || Ok(line_spread(d, x)?))?;
            }
        }
        for &q in &self.wave {
            anyhow::ensure!(d == Dimension::Three, "dimension is {}; allowed with --wave: 3", d.number());
            answer.ask("transfer", Unit::One, &[("wave", q.into())], || Ok(kernel_transfer(kernel, q)?))?;
        }
        Ok(())
    }

    /// The profile K(u).
    fn figure(&self, _: &Solved) -> Result<Figure> {
        let (kernel, d, name) = (self.kernel, self.dimension, kernel_name(self.kernel));
        let reach = if kernel == Kernel::Gaussian { 3.0 } else { 1.0 };
        let curve = Curve::sample("", &even(0.0, reach, 201), |u| Ok(kernel.profile(d, u)?.value))?;
        let panel = panel(Axis::linear("Distance over radius, u/r", ""), "Kernel K(u)", "", vec![curve]);
        Ok(figure(format!("Kernel: {}, {} dimensions", name.replace('_', " "), d.number()), panel))
    }
}
