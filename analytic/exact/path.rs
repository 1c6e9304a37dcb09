//! `exact path`: mean path lengths and chords.

use crate::answer::{Answer, Reply};
use crate::plot::{Curve, crowded, figure, panel};
use crate::typed::Typed;
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
    pub albedo: Option<f64>,
}

impl Args {
    /// What rounding touches.
    pub fn typed(&self) -> Typed {
        Typed { albedo: self.albedo, g: Some(0.0), places: self.size.clone(), ..Typed::default() }
    }
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

/// Answers; the figure shows the mean path over 4 V/S against the albedo, for sphere and slab.
pub fn answer(args: &Args, draw: bool) -> Result<Reply> {
    let shape = args.shape.to_possible_value().map_or_else(String::new, |v| v.get_name().to_string());
    let mut answer = Answer::new("path").with("shape", shape.as_str());
    for (name, &length) in ["size", "size_2", "size_3"].into_iter().zip(&args.size) {
        answer = answer.with(name, length);
    }
    match (args.shape, args.size.as_slice()) {
        (Shape::Sphere, &[radius]) => {
            answer.add("mean_path", mean_path_sphere(radius)?);
            answer.add_at("chord_moment", vec![("n", 1_u32.into())], chord_moment_sphere(radius, 1)?);
            answer.add_at("chord_moment", vec![("n", 2_u32.into())], chord_moment_sphere(radius, 2)?);
        }
        (Shape::Slab, &[thickness]) => {
            answer.add("mean_path", mean_path_slab(thickness)?);
            // The second is infinite: grazing chords are long.
            answer.add_at("chord_moment", vec![("n", 1_u32.into())], chord_moment_slab(thickness, 1)?);
        }
        (Shape::Cuboid, &[x, y, z]) => answer.add("mean_path", mean_path_cuboid(x, y, z)?),
        (Shape::Convex, &[volume, surface]) => answer.add("mean_path", mean_path(volume, surface)?),
        (_, sizes) => bail!(
            "--size has {} numbers; allowed: 1 for sphere and slab, 3 for cuboid, 2 for convex",
            sizes.len()
        ),
    }
    for &length in &args.chord {
        let density = match args.shape {
            Shape::Sphere => chord_density_sphere(args.size[0], length)?,
            Shape::Slab => chord_density_slab(args.size[0], length)?,
            _ => bail!("--chord is {length}; allowed with --shape sphere and slab, not {shape}"),
        };
        answer.add_at("chord_density", vec![("chord", length.into())], density);
    }
    if let Some(albedo) = args.albedo {
        let mean = absorbing(args, albedo)?.with_context(|| {
            format!("--albedo is {albedo}; allowed with --shape sphere and slab, not {shape}")
        })?;
        answer.add_at("mean_path_absorbing", vec![("albedo", albedo.into())], mean);
    }
    let figure = if draw { Some(drawn(args, &shape)?) } else { None };
    Ok(Reply { answer, figure })
}

fn absorbing(args: &Args, albedo: f64) -> Result<Option<turbid_analytic::Value>> {
    Ok(match args.shape {
        Shape::Sphere => Some(mean_path_sphere_absorbing(args.size[0], albedo)?),
        Shape::Slab => Some(mean_path_slab_absorbing(args.size[0], albedo)?),
        Shape::Cuboid | Shape::Convex => None,
    })
}

fn drawn(args: &Args, shape: &str) -> Result<Figure> {
    if matches!(args.shape, Shape::Cuboid | Shape::Convex) {
        bail!("--plot draws the path against the albedo; allowed with --shape sphere and slab, not {shape}");
    }
    let curve = Curve::sample("", &crowded(1.0, 41), |w| {
        Ok(absorbing(args, w)?.context("a sphere or a slab")?.value)
    })?;
    let title = format!("Mean path to escape or absorption, {shape} of {} mean free paths", args.size[0]);
    let axis = Axis::linear("Albedo", "");
    Ok(figure(title, panel(axis, "Mean path", "mean free paths", vec![curve])))
}
