//! `exact critical`: critical slabs and spheres.

use crate::answer::Answer;
use crate::plot::{Curve, even, figure, panel};
use crate::question::{Question, Solved};
use crate::typed::Typed;
use crate::unit::Unit;
use anyhow::Result;
use clap::ValueEnum;
use std::rc::Rc;
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
    secondaries: f64,
    /// The body.
    #[arg(long, value_enum, default_value = "slab")]
    shape: Shape,
    /// Distances from the middle over the size, 0 to 1, at which to give the fluence over that in the middle.
    #[arg(long, num_args = 1.., value_delimiter = ',', value_name = "X", allow_negative_numbers = true)]
    x: Vec<f64>,
}

/// The bodies, by their names on the command line.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Shape {
    /// Between two parallel planes.
    Slab,
    /// A ball.
    Sphere,
}

impl Shape {
    fn name(self) -> &'static str {
        match self {
            Shape::Slab => "slab",
            Shape::Sphere => "sphere",
        }
    }
}

impl Args {
    fn body(&self, solved: &Solved) -> Result<Rc<Critical>> {
        let shape = match self.shape {
            Shape::Slab => CriticalShape::Slab,
            Shape::Sphere => CriticalShape::Sphere,
        };
        solved.once((shape, self.secondaries), || Ok(Critical::new(shape, self.secondaries)?))
    }
}

impl Question for Args {
    fn answer(&self, answer: &mut Answer, solved: &Solved) -> Result<()> {
        let body = self.body(solved)?;
        answer.of("critical").with("shape", self.shape.name()).with("secondaries", self.secondaries);
        answer.add("size", Unit::Mfp(1), &[], body.size());
        for &x in &self.x {
            answer.ask("flux_ratio", Unit::Middle, &[("x", x.into())], || Ok(body.flux_ratio(x)?))?;
        }
        Ok(())
    }

    /// The fluence against the distance from the middle.
    fn figure(&self, solved: &Solved) -> Result<Figure> {
        let body = self.body(solved)?;
        // The field bends at the surface.
        let places: Vec<f64> = even(0.0, 1.0, 101).into_iter().map(|x| 1.0 - (1.0 - x) * (1.0 - x)).collect();
        let curve = Curve::sample("", &places, |x| Ok(body.flux_ratio(x)?.value))?;
        let of = if self.shape == Shape::Slab { "half-thickness" } else { "radius" };
        let axis = Axis::linear(format!("Distance from the middle over the {of}"), "");
        let title = format!("Critical {}, {} secondaries a collision", self.shape.name(), self.secondaries);
        Ok(figure(title, panel(axis, "Fluence over that in the middle", "", vec![curve])))
    }

    fn typed(&self) -> Option<Typed> {
        Some(Typed { secondaries: Some(self.secondaries), ..Typed::default() })
    }

    fn moved(&self, to: f64) -> Option<Box<dyn Question>> {
        Some(Box::new(Args { secondaries: to, ..self.clone() }))
    }
}
