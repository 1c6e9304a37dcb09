//! `exact boundary`: photon estimates near the faces of a body.

use crate::answer::Answer;
use crate::plot::{Curve, crowded, even, figure, panel};
use crate::question::{Question, Solved};
use crate::read::{kernel, kernel_name};
use crate::unit::Unit;
use anyhow::{Result, bail, ensure};
use clap::ValueEnum;
use turbid_analytic::boundary::{
    Body, Rejection, Treatment, false_photon_mean, treated_mean_symmetric, treated_mean_uniform,
    treated_variance,
};
use turbid_analytic::{Kernel, Value};
use turbid_figure::{Axis, Figure};

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

impl Args {
    /// The body, of as many lengths as it has.
    fn shape(&self) -> Result<Body> {
        Ok(match (self.body, self.size.as_slice()) {
            (Shape::HalfSpace, _) => Body::HalfSpace,
            (Shape::Slab, &[thickness]) => Body::Slab { thickness },
            (Shape::Sphere, &[radius]) => Body::Sphere { radius },
            (Shape::Cuboid, &[edge]) => Body::Cuboid { edges: [edge; 3] },
            (Shape::Cuboid, &[x, y, z]) => Body::Cuboid { edges: [x, y, z] },
            (_, sizes) => {
                bail!("--size has {} numbers; allowed: 1 for slab and sphere, 1 or 3 for cuboid", sizes.len())
            }
        })
    }

    fn shape_name(&self) -> String {
        self.body.to_possible_value().map_or_else(String::new, |v| v.get_name().to_string())
    }

    /// A probe below the face.
    fn probe(&self, body: Body, depth: f64) -> [f64; 3] {
        match body {
            Body::Sphere { radius } => [0.0, 0.0, depth - radius],
            Body::Cuboid { .. } if self.corner => [depth; 3],
            Body::Cuboid { edges } => [0.5 * edges[0], 0.5 * edges[1], depth],
            Body::HalfSpace | Body::Slab { .. } => [0.0, 0.0, depth],
        }
    }

    fn uniform(&self, body: Body, treatment: Treatment, depth: f64) -> Result<Value> {
        Ok(treated_mean_uniform(treatment, self.kernel, body, self.probe(body, depth), self.radius)?)
    }

    /// Expectation in the field e^(-s (place - probe)): over the field at the probe.
    fn decaying(&self, body: Body, treatment: Treatment, depth: f64) -> Result<Value> {
        let fall = |place: f64| libm::exp(-self.decay * (place - depth));
        let field = |z: f64| match body {
            Body::Sphere { radius } => fall(radius - z),
            Body::HalfSpace | Body::Slab { .. } | Body::Cuboid { .. } => fall(z),
        };
        let probe = self.probe(body, depth);
        Ok(treated_mean_symmetric(treatment, self.kernel, body, probe, self.radius, field)?)
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

impl Question for Args {
    fn answer(&self, answer: &mut Answer, _: &Solved) -> Result<()> {
        let body = self.shape()?;
        ensure!(!self.corner || self.body == Shape::Cuboid, "--corner is given; allowed with --body cuboid");
        ensure!(
            self.decay == 0.0 || self.body != Shape::Cuboid,
            "--decay is {}; allowed with --body cuboid: 0, the uniform field",
            self.decay
        );
        answer.of("boundary").with("body", self.shape_name());
        if self.body != Shape::HalfSpace {
            for (name, &length) in ["size", "size_2", "size_3"].into_iter().zip(&self.size) {
                answer.with(name, length);
            }
        }
        if self.corner {
            answer.with("place", "corner");
        }
        answer.with("radius", self.radius).with("kernel", kernel_name(self.kernel));
        if self.decay != 0.0 {
            answer.with("decay", self.decay);
        }
        for &depth in &self.depth {
            for treatment in Treatment::ALL {
                let at = [("treatment", name(treatment).into()), ("depth", depth.into())];
                answer.add("mean_uniform", Unit::Field, &at, self.uniform(body, treatment, depth)?);
                if self.decay != 0.0 {
                    answer.add("mean_decaying", Unit::Field, &at, self.decaying(body, treatment, depth)?);
                }
                let probe = self.probe(body, depth);
                let variance = treated_variance(treatment, self.kernel, body, probe, self.radius)?;
                answer.add("variance_over_whole_ball", Unit::WholeBall, &at, variance);
            }
        }
        let Some(behind) = self.behind else { return Ok(()) };
        answer.with("behind", behind);
        for &depth in &self.depth {
            for rule in Rejection::ALL {
                for (clipped, divisor) in [(false, "1"), (true, "M_0")] {
                    let mean =
                        false_photon_mean(rule, clipped, self.kernel, self.radius, depth, 1.0, behind)?;
                    let at =
                        [("rule", rule_name(rule).into()), ("over", divisor.into()), ("depth", depth.into())];
                    answer.add("mean_at_wall", Unit::FieldInFront, &at, mean);
                }
            }
        }
        Ok(())
    }

    /// The expectation against the depth, one curve a treatment.
    fn figure(&self, _: &Solved) -> Result<Figure> {
        let body = self.shape()?;
        let depths = match self.body {
            Shape::HalfSpace => even(0.0, 1.25 * self.radius, 81),
            Shape::Slab => crowded(self.size[0], 81),
            Shape::Sphere => even(0.0, self.size[0], 81),
            Shape::Cuboid => even(0.0, 0.5 * self.size.iter().copied().fold(f64::INFINITY, f64::min), 41),
        };
        let curve = |treatment| {
            let label = if treatment == Treatment::None { "no treatment" } else { name(treatment) };
            Curve::sample(label, &depths, |depth| {
                let mean = if self.decay == 0.0 { Args::uniform } else { Args::decaying };
                Ok(mean(self, body, treatment, depth)?.value)
            })
        };
        let curves = Treatment::ALL.into_iter().map(curve).collect::<Result<Vec<_>>>()?;
        let field = if self.decay == 0.0 {
            String::new()
        } else {
            format!(", field exp(−{} h)", self.decay).replace("−1 h", "−h")
        };
        let (shape, name) = (self.shape_name(), kernel_name(self.kernel).replace('_', " "));
        let title = format!("At the face of a {shape}: {name} kernel, r = {}{field}", self.radius);
        let axis = Axis::linear("Depth of the probe h", "length");
        Ok(figure(title, panel(axis, "Expectation over the field at the probe", "", curves)))
    }
}
