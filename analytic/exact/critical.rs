//! `exact critical`: critical slabs and spheres.

use crate::answer::{Answer, Reply};
use crate::plot::{Curve, even, figure, panel};
use crate::typed::Typed;
use anyhow::Result;
use clap::ValueEnum;
use turbid_analytic::critical::{Critical, CriticalShape};
use turbid_figure::{Axis, Figure};

/// Critical slab or sphere: the size at which a multiplying medium keeps itself going, and the shape of its light.
///
/// Where each collision sends out c > 1 on the average, isotropically, one size has a positive solution without source:
///
///   phi = (c/2) K phi,   K the integral of E_1(|t-t'|) (slab), of the same on odd u = r phi (sphere)
///
/// `size` is the half-thickness or the radius in mean free paths; `flux_ratio` the fluence over that in the middle, at x, the
/// distance from the middle over the size.
/// Source: Davison 1957, chapter VIII; Case and Zweifel 1967, section 6.8; Kaper, Lindeman and Leaf 1974; Sood, Forster
/// and Parsons 2003.
#[derive(Clone, clap::Args)]
#[command(verbatim_doc_comment)]
pub struct Args {
    /// Mean number of secondaries a collision, c, 1 + 1e-12 to 1000.
    #[arg(long, allow_negative_numbers = true)]
    pub secondaries: f64,
    /// The body.
    #[arg(long, value_enum, default_value = "slab")]
    shape: Shape,
    /// Distances from the middle over the size, 0 to 1, at which to give the fluence over that in the middle.
    #[arg(long, num_args = 1.., value_delimiter = ',', value_name = "X", allow_negative_numbers = true)]
    x: Vec<f64>,
}

impl Args {
    /// What rounding touches.
    pub fn typed(&self) -> Typed {
        Typed { secondaries: Some(self.secondaries), ..Typed::default() }
    }
}

/// The bodies, by their names on the command line.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Shape {
    /// Between two parallel planes.
    Slab,
    /// A ball.
    Sphere,
}

/// Answers; the figure shows the fluence against the distance from the middle.
pub fn answer(args: &Args, draw: bool) -> Result<Reply> {
    let (shape, name) = match args.shape {
        Shape::Slab => (CriticalShape::Slab, "slab"),
        Shape::Sphere => (CriticalShape::Sphere, "sphere"),
    };
    let critical = Critical::new(shape, args.secondaries)?;
    let mut answer = Answer::new("critical").with("shape", name).with("secondaries", args.secondaries);
    answer.add("size", critical.size());
    for &x in &args.x {
        answer.add_at("flux_ratio", vec![("x", x.into())], critical.flux_ratio(x)?);
    }
    let figure = if draw { Some(drawn(args, name, &critical)?) } else { None };
    Ok(Reply { answer, figure })
}

fn drawn(args: &Args, name: &str, critical: &Critical) -> Result<Figure> {
    // The field bends at the surface.
    let places: Vec<f64> = even(0.0, 1.0, 101).into_iter().map(|x| 1.0 - (1.0 - x) * (1.0 - x)).collect();
    let curve = Curve::sample("", &places, |x| Ok(critical.flux_ratio(x)?.value))?;
    let of = if args.shape == Shape::Slab { "half-thickness" } else { "radius" };
    let axis = Axis::linear(format!("Distance from the middle over the {of}"), "");
    let title = format!("Critical {name}, {} secondaries a collision", args.secondaries);
    Ok(figure(title, panel(axis, "Fluence over that in the middle", "", vec![curve])))
}
