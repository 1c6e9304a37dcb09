//! `exact boundary`: photon estimates near the faces of a body.

use crate::answer::{Answer, Reply};
use crate::plot::{Curve, crowded, even, figure, panel};
use crate::read::{kernel, kernel_name};
use anyhow::{Result, bail, ensure};
use clap::ValueEnum;
use turbid_analytic::boundary::{
    Body, Rejection, Treatment, false_photon_mean, treated_mean_symmetric, treated_mean_uniform,
    treated_variance,
};
use turbid_analytic::{Kernel, Value};
use turbid_figure::Axis;

/// Photon estimates near a face: four treatments of the ball that the face cuts.
///
/// With K_r of unit integral over the whole ball, z the depth along the inward normal, M_j = int K_r z^j over the
/// medium and S_j = sum q_p K_r(x_p - x) z_p^j over the photons:
///
///   none          S_0                            clipped        S_0/M_0
///   reflection    S_0 + mirror images            local linear   (M_2 S_0 - M_1 S_1)/(M_0 M_2 - M_1^2)
///
/// Photons from behind a thin wall are false: rules reject those that fly from the probe's side to the other (`facing`), the
/// same of those behind the wall's plane only (`facing behind`), all behind the plane, or all that the probe cannot see
/// (`visible`); `over` M_0 makes up for the part of the ball that is lost.
/// Given are the expectation in a uniform field (1 is right), and in one that falls as e^(-s depth), and the variance
/// over that of the whole ball in a uniform field. Lengths are in one unit of your choice.
/// Source: Jones 1993 (local linear), Silverman 1986 (reflection), Jensen and Christensen 1998 (none).
#[derive(Clone, clap::Args)]
#[command(verbatim_doc_comment)]
pub struct Args {
    /// The body that the medium fills.
    #[arg(long, value_enum, default_value = "half-space")]
    body: Shape,
    /// Thickness of the slab, radius of the sphere, or edges of the cuboid (one for a cube), 1e-12 to 1e12.
    #[arg(long, num_args = 1..=3, value_delimiter = ',', value_name = "L", default_values_t = [1.0], allow_negative_numbers = true)]
    size: Vec<f64>,
    /// Radius of the kernel, 1e-12 to 1e12.
    #[arg(long, default_value_t = 1.0, allow_negative_numbers = true)]
    radius: f64,
    /// Depths of probes below the nearest face, inside the body; in a cuboid below the middle of a face.
    #[arg(long, num_args = 1.., value_delimiter = ',', value_name = "H", default_values_t = [0.0, 0.5, 1.0], allow_negative_numbers = true)]
    depth: Vec<f64>,
    /// Decay s of the field e^(-s depth), in 1/length; 0 for the uniform field alone.
    #[arg(long, default_value_t = 0.0, allow_negative_numbers = true)]
    decay: f64,
    /// Probes of a cuboid as deep below three faces at once, at a corner.
    #[arg(long)]
    corner: bool,
    /// Uniform field behind a thin flat wall as far from the probe as each depth, over the field in front: gives the
    /// expectation over that in front with every rule that rejects photons from behind, body and treatment aside
    #[arg(verbatim_doc_comment, long, allow_negative_numbers = true, value_name = "F")]
    behind: Option<f64>,
    /// Kernel, by name as in `exact kernel`.
    #[arg(long, default_value = "uniform", value_parser = kernel)]
    kernel: Kernel,
}

/// Bodies of one length.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Shape {
    /// z >= 0.
    HalfSpace,
    /// 0 <= z <= size.
    Slab,
    /// A ball of radius size.
    Sphere,
    /// A box.
    Cuboid,
}

/// A question: the body and everything about the kernel.
struct Asked<'a> {
    args: &'a Args,
    body: Body,
}

impl Asked<'_> {
    /// A probe below the face.
    fn probe(&self, depth: f64) -> [f64; 3] {
        match self.body {
            Body::Sphere { radius } => [0.0, 0.0, depth - radius],
            Body::Cuboid { .. } if self.args.corner => [depth; 3],
            Body::Cuboid { edges } => [0.5 * edges[0], 0.5 * edges[1], depth],
            _ => [0.0, 0.0, depth],
        }
    }

    fn uniform(&self, treatment: Treatment, depth: f64) -> Result<Value> {
        let args = self.args;
        Ok(treated_mean_uniform(treatment, args.kernel, self.body, self.probe(depth), args.radius)?)
    }

    /// Expectation in the field e^(-s (place - probe)): over the field at the probe.
    fn decaying(&self, treatment: Treatment, depth: f64) -> Result<Value> {
        let args = self.args;
        let fall = |place: f64| libm::exp(-args.decay * (place - depth));
        let field = |z: f64| match self.body {
            Body::Sphere { radius } => fall(radius - z),
            _ => fall(z),
        };
        Ok(treated_mean_symmetric(treatment, args.kernel, self.body, self.probe(depth), args.radius, field)?)
    }
}

fn name(treatment: Treatment) -> &'static str {
    match treatment {
        Treatment::None => "none",
        Treatment::Clipped => "clipped",
        Treatment::Reflection => "reflection",
        Treatment::LocalLinear => "local linear",
    }
}

fn rule_name(rule: Rejection) -> &'static str {
    match rule {
        Rejection::Off => "none",
        Rejection::Facing => "facing",
        Rejection::FacingBehind => "facing behind",
        Rejection::BehindPlane => "behind plane",
        Rejection::Visible => "visible",
    }
}

/// Answers; the figure shows the expectation against the depth, one curve a treatment.
pub fn answer(args: &Args, draw: bool) -> Result<Reply> {
    let body = match (args.body, args.size.as_slice()) {
        (Shape::HalfSpace, _) => Body::HalfSpace,
        (Shape::Slab, &[thickness]) => Body::Slab { thickness },
        (Shape::Sphere, &[radius]) => Body::Sphere { radius },
        (Shape::Cuboid, &[edge]) => Body::Cuboid { edges: [edge; 3] },
        (Shape::Cuboid, &[x, y, z]) => Body::Cuboid { edges: [x, y, z] },
        (_, sizes) => {
            bail!("--size has {} numbers; allowed: 1 for slab and sphere, 1 or 3 for cuboid", sizes.len())
        }
    };
    ensure!(!args.corner || args.body == Shape::Cuboid, "--corner is given; allowed with --body cuboid");
    ensure!(
        args.decay == 0.0 || args.body != Shape::Cuboid,
        "--decay is {}; allowed with --body cuboid: 0, the uniform field",
        args.decay
    );
    let asked = Asked { args, body };
    let shape = args.body.to_possible_value().map_or_else(String::new, |v| v.get_name().to_string());
    let mut answer = Answer::new("boundary").with("body", shape.as_str());
    if args.body != Shape::HalfSpace {
        for (name, &length) in ["size", "size_2", "size_3"].into_iter().zip(&args.size) {
            answer = answer.with(name, length);
        }
    }
    if args.corner {
        answer = answer.with("place", "corner");
    }
    answer = answer.with("radius", args.radius).with("kernel", kernel_name(args.kernel));
    if args.decay != 0.0 {
        answer = answer.with("decay", args.decay);
    }
    for &depth in &args.depth {
        for treatment in Treatment::ALL {
            let at = || vec![("treatment", name(treatment).into()), ("depth", depth.into())];
            answer.add_at("mean_uniform", at(), asked.uniform(treatment, depth)?);
            if args.decay != 0.0 {
                answer.add_at("mean_decaying", at(), asked.decaying(treatment, depth)?);
            }
            let variance = treated_variance(treatment, args.kernel, body, asked.probe(depth), args.radius)?;
            answer.add_at("variance_over_whole_ball", at(), variance);
        }
    }
    if let Some(behind) = args.behind {
        answer = answer.with("behind", behind);
        for &depth in &args.depth {
            for rule in Rejection::ALL {
                for (clipped, divisor) in [(false, "1"), (true, "M_0")] {
                    let mean =
                        false_photon_mean(rule, clipped, args.kernel, args.radius, depth, 1.0, behind)?;
                    let at = vec![
                        ("rule", rule_name(rule).into()),
                        ("over", divisor.into()),
                        ("depth", depth.into()),
                    ];
                    answer.add_at("mean_at_wall", at, mean);
                }
            }
        }
    }
    let figure = if draw { Some(drawn(&asked, &shape)?) } else { None };
    Ok(Reply { answer, figure })
}

fn drawn(asked: &Asked<'_>, shape: &str) -> Result<turbid_figure::Figure> {
    let args = asked.args;
    let depths = match args.body {
        Shape::HalfSpace => even(0.0, 1.25 * args.radius, 81),
        Shape::Slab => crowded(args.size[0], 81),
        Shape::Sphere => even(0.0, args.size[0], 81),
        Shape::Cuboid => even(0.0, 0.5 * args.size.iter().copied().fold(f64::INFINITY, f64::min), 41),
    };
    let curve = |treatment| {
        let label = if treatment == Treatment::None { "no treatment" } else { name(treatment) };
        Curve::sample(label, &depths, |depth| {
            let mean = if args.decay == 0.0 { Asked::uniform } else { Asked::decaying };
            Ok(mean(asked, treatment, depth)?.value)
        })
    };
    let curves = Treatment::ALL.into_iter().map(curve).collect::<Result<Vec<_>>>()?;
    let field = if args.decay == 0.0 {
        String::new()
    } else {
        format!(", field exp(−{} h)", args.decay).replace("−1 h", "−h")
    };
    let name = kernel_name(args.kernel).replace('_', " ");
    let title = format!("At the face of a {shape}: {name} kernel, r = {}{field}", args.radius);
    let axis = Axis::linear("Depth of the probe h", "length");
    Ok(figure(title, panel(axis, "Expectation over the field at the probe", "", curves)))
}
