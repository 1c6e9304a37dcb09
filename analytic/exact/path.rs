//! `exact path`: mean path lengths and chords.

use crate::answer::Answer;
use crate::plot::{Curve, crowded, figure, panel};
use crate::question::{Question, Solved};
use crate::typed::Typed;
use crate::unit::Unit;
use anyhow::{Context, Result, bail};
use clap::ValueEnum;
use turbid_analytic::mean_path::{
    chord_density_slab, chord_density_sphere, chord_moment_slab, chord_moment_sphere, mean_path,
    mean_path_cuboid, mean_path_slab, mean_path_slab_absorbing, mean_path_sphere, mean_path_sphere_absorbing,
};
use turbid_figure::{Axis, Figure};

/// Mean path of isotropic light in a convex body: 4 V/S, whatever the medium scatters.
///
/// Light that falls isotropically and evenly on the whole surface S of a convex body of volume V travels
///
///   mean path = 4 V/S
///
/// in it before it leaves, for any phase function and any amount of scattering, if nothing is absorbed. With absorption the
/// path to escape or absorption is l = A/(1-w) mean free paths, A the absorbed fraction: given for sphere and slab with
/// isotropic scattering. Lengths in one unit of your choice; with --albedo they are mean free paths.
/// Source: Dirac 1943; Case and Zweifel 1967, section 2.8; Blanco and Fournier 2003; Mazzolo 2004.
#[derive(Clone, clap::Args)]
#[command(verbatim_doc_comment)]
pub struct Args {
    /// The body.
    #[arg(long, value_enum)]
    shape: Shape,
    /// Radius of the sphere, thickness of the slab, or the three edges of the cuboid; for any convex body its volume and its
    /// surface. 1e-100 to 1e100
    #[arg(verbatim_doc_comment, long, num_args = 1..=3, value_delimiter = ',', required = true, value_name = "L", allow_negative_numbers = true)]
    size: Vec<f64>,
    /// Lengths of chords of sphere or slab, 0 or more: gives the density of the chord length under that light.
    #[arg(long, num_args = 1.., value_delimiter = ',', value_name = "L", allow_negative_numbers = true)]
    chord: Vec<f64>,
    /// Single-scattering albedo, 0 to 1, of sphere or slab (then up to 1e6 or 400 mean free paths).
    #[arg(long, allow_negative_numbers = true)]
    albedo: Option<f64>,
}

/// The bodies, by their names on the command line.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Shape {
    /// A ball.
    Sphere,
    /// Between two parallel planes.
    Slab,
    /// Three edges.
    Cuboid,
    /// Any convex body, by volume and surface.
    Convex,
}

impl Args {
    fn shape(&self) -> String {
        self.shape.to_possible_value().map_or_else(String::new, |v| v.get_name().to_string())
    }

    fn absorbing(&self, albedo: f64) -> Result<Option<turbid_analytic::Value>> {
        Ok(match self.shape {
            Shape::Sphere => Some(mean_path_sphere_absorbing(self.size[0], albedo)?),
            Shape::Slab => Some(mean_path_slab_absorbing(self.size[0], albedo)?),
            Shape::Cuboid | Shape::Convex => None,
        })
    }
}

impl Question for Args {
    fn answer(&self, answer: &mut Answer, _: &Solved) -> Result<()> {
        let shape = self.shape();
        answer.of("path").with("shape", shape.as_str());
        for (name, &length) in ["size", "size_2", "size_3"].into_iter().zip(&self.size) {
            answer.with(name, length);
        }
        let mean_path = match (self.shape, self.size.as_slice()) {
            (Shape::Sphere, &[radius]) => mean_path_sphere(radius)?,
            (Shape::Slab, &[thickness]) => mean_path_slab(thickness)?,
            (Shape::Cuboid, &[x, y, z]) => mean_path_cuboid(x, y, z)?,
            (Shape::Convex, &[volume, surface]) => mean_path(volume, surface)?,
            (_, sizes) => bail!(
                "--size has {} numbers; allowed: 1 for sphere and slab, 3 for cuboid, 2 for convex",
                sizes.len()
            ),
        };
        answer.add("mean_path", Unit::Length(1), &[], mean_path);
        let mut moment =
            |n: u32, value| answer.add("chord_moment", Unit::LengthToN, &[("n", n.into())], value);
        match self.shape {
            Shape::Sphere => {
                moment(1, chord_moment_sphere(self.size[0], 1)?);
                moment(2, chord_moment_sphere(self.size[0], 2)?);
            }
            // The second is infinite: grazing chords are long.
            Shape::Slab => moment(1, chord_moment_slab(self.size[0], 1)?),
            Shape::Cuboid | Shape::Convex => {}
        }
        for &length in &self.chord {
            let density = match self.shape {
                Shape::Sphere => chord_density_sphere(self.size[0], length)?,
                Shape::Slab => chord_density_slab(self.size[0], length)?,
                Shape::Cuboid | Shape::Convex => {
                    bail!("--chord is {length}; allowed with --shape sphere and slab, not {shape}")
                }
            };
            answer.add("chord_density", Unit::Length(-1), &[("chord", length.into())], density);
        }
        if let Some(albedo) = self.albedo {
            let mean = self.absorbing(albedo)?.with_context(|| {
                format!("--albedo is {albedo}; allowed with --shape sphere and slab, not {shape}")
            })?;
            answer.add("mean_path_absorbing", Unit::Mfp(1), &[("albedo", albedo.into())], mean);
        }
        Ok(())
    }

    /// The mean path over 4 V/S against the albedo, for sphere and slab.
    fn figure(&self, _: &Solved) -> Result<Figure> {
        let shape = self.shape();
        if matches!(self.shape, Shape::Cuboid | Shape::Convex) {
            bail!(
                "--plot draws the path against the albedo; allowed with --shape sphere and slab, not {shape}"
            );
        }
        let curve = Curve::sample("", &crowded(1.0, 41), |w| {
            Ok(self.absorbing(w)?.context("a sphere or a slab")?.value)
        })?;
        let title = format!("Mean path to escape or absorption, {shape} of {} mean free paths", self.size[0]);
        let axis = Axis::linear("Albedo", "");
        Ok(figure(title, panel(axis, "Mean path", "mean free paths", vec![curve])))
    }

    fn typed(&self) -> Option<Typed> {
        Some(Typed { albedo: self.albedo, g: Some(0.0), places: self.size.clone(), ..Typed::default() })
    }

    fn moved(&self, to: f64) -> Option<Box<dyn Question>> {
        Some(Box::new(Args { albedo: Some(to), ..self.clone() }))
    }
}
