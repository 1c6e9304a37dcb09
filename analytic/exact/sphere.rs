//! `exact sphere`: the finite sphere of isotropic scattering.

use crate::answer::{Answer, Reply};
use crate::plot::{Curve, degrees, even, figure, panel, ratios};
use crate::typed::Typed;
use anyhow::Result;
use clap::ValueEnum;
use libm::cos;
use turbid_analytic::sphere::{Sphere, SphereSource, absorbing_transmittance, escape_from, escape_uniform};
use turbid_figure::{Axis, Figure};

/// A sphere with isotropic scattering: fluence, escape, absorption, radiance that leaves.
///
/// In a ball of radius a whose surface does not reflect, with w the albedo and phi_0 the light that has not collided,
///
///   phi(r) = phi_0(r) + (w/2) int_0^a (r'/r) [E_1(|r-r'|) - E_1(r+r')] phi(r') dr'
///
/// `escape_direct` leaves without a collision, in closed form: all the escape of a sphere that only absorbs, for a uniform
/// source 3/(8 a^3) [2 a^2 - 1 + (1 + 2a) e^(-2a)].
///
/// Lengths are mean free paths. Sources: `uniform` emission over the volume and a point at the `centre`, of unit power
/// (fluence in 1/mean free path^2, radiance per steradian of that); `incident` light of radiance 1/pi and irradiance 1
/// on the whole surface (fluence a pure number, radiance in 1/sr). Fluences include the direct light; so does radiance,
/// but for the central source, whose direct light e^(-a)/(4 pi a^2) leaves at mu = 1 alone.
/// Source: Davison 1957, chapter VI; Case and Zweifel 1967, chapters 2 and 6.
#[derive(Clone, clap::Args)]
#[command(verbatim_doc_comment)]
pub struct Args {
    /// Radius in mean free paths.
    #[arg(long, allow_negative_numbers = true)]
    radius: f64,
    /// Single-scattering albedo, 0 to 1.
    #[arg(long, allow_negative_numbers = true)]
    pub albedo: f64,
    /// Where the light comes from.
    #[arg(long, value_enum, default_value = "uniform")]
    source: Source,
    /// Distances from the centre in mean free paths, 0 to the radius, at which to give the fluence and its direct part,
    /// and the probability that light emitted there leaves without a collision
    #[arg(verbatim_doc_comment, long, num_args = 1.., value_delimiter = ',', value_name = "R", allow_negative_numbers = true)]
    r: Vec<f64>,
    /// Cosines to the outward normal, 0 to 1, at which to give the radiance that leaves.
    #[arg(long, num_args = 1.., value_delimiter = ',', value_name = "MU", allow_negative_numbers = true)]
    mu: Vec<f64>,
    /// Orders of scattering whose fluence to give at every r: 0 (direct light) to 1000, from a central source to 8; radius
    /// up to 64
    #[arg(verbatim_doc_comment, long, num_args = 1.., value_delimiter = ',', value_name = "N", allow_negative_numbers = true)]
    order: Vec<u32>,
    /// What --plot draws: fluence against distance from the centre, or radiance that leaves against the angle to the
    /// normal
    #[arg(verbatim_doc_comment, long, value_enum, default_value = "fluence")]
    draw: Draw,
}

impl Args {
    /// What rounding touches.
    pub fn typed(&self) -> Typed {
        Typed {
            albedo: Some(self.albedo),
            g: Some(0.0),
            size: Some(self.radius),
            places: self.r.clone(),
            ..Typed::default()
        }
    }
}

/// The sources, by their names on the command line.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Source {
    /// Isotropic emission of unit power, spread evenly.
    Uniform,
    /// An isotropic point of unit power at the centre.
    Centre,
    /// Radiance 1/pi from outside on the whole surface.
    Incident,
}

impl Source {
    fn known(self) -> (SphereSource, &'static str, &'static str) {
        match self {
            Source::Uniform => (SphereSource::Uniform, "uniform", "uniform source"),
            Source::Centre => (SphereSource::Centre, "centre", "point source at the centre"),
            Source::Incident => (SphereSource::Incident, "incident", "isotropic incidence"),
        }
    }
}

/// What a figure of a sphere shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Draw {
    /// Fluence against distance from the centre.
    Fluence,
    /// Radiance that leaves.
    Radiance,
}

/// Answers.
pub fn answer(args: &Args, draw: bool) -> Result<Reply> {
    let (source, name, _) = args.source.known();
    let sphere = Sphere::new(args.radius, args.albedo, source)?;
    let mut answer =
        Answer::new("sphere").with("radius", args.radius).with("albedo", args.albedo).with("source", name);
    answer.add("escape", sphere.escape());
    answer.add("absorptance", sphere.absorptance());
    // Without a collision: what leaves a sphere that only absorbs.
    answer.add(
        "escape_direct",
        match args.source {
            Source::Uniform => escape_uniform(args.radius)?,
            Source::Centre => escape_from(args.radius, 0.0)?,
            Source::Incident => absorbing_transmittance(args.radius)?,
        },
    );
    for &r in &args.r {
        let at = || vec![("r", r.into())];
        answer.add_at("fluence", at(), sphere.fluence(r)?);
        answer.add_at("fluence_direct", at(), sphere.fluence_direct(r)?);
        answer.add_at("escape_direct_from", at(), escape_from(args.radius, r)?);
        for &n in &args.order {
            let at = vec![("r", r.into()), ("order", n.into())];
            answer.add_at("fluence_of_order", at, sphere.fluence_of_order(n, r)?);
        }
    }
    for &mu in &args.mu {
        answer.add_at("exit_radiance", vec![("mu", mu.into())], sphere.exit_radiance(mu)?);
    }
    let figure = if draw { Some(drawn(args, &sphere)?) } else { None };
    Ok(Reply { answer, figure })
}

fn drawn(args: &Args, sphere: &Sphere) -> Result<Figure> {
    let (a, (_, _, source)) = (args.radius, args.source.known());
    let title = format!("Sphere of radius {a}, albedo {}, {source}", args.albedo);
    let centre = args.source == Source::Centre;
    let per = if args.source == Source::Incident { "irradiance" } else { "power" };
    let unit = |of: &str| match (args.source, of) {
        (Source::Incident, unit) => unit.to_string(),
        (_, "") => "1/mean free path²".to_string(),
        (_, unit) => format!("{unit}/mean free path²"),
    };
    let panel = match args.draw {
        Draw::Fluence => {
            // The field bends at the surface; a point source is seen over two decades of distance.
            let places = if centre {
                ratios(0.01 * a, a, 121)
            } else {
                even(0.0, 1.0, 121).into_iter().map(|x| a * (1.0 - (1.0 - x) * (1.0 - x))).collect()
            };
            let all = Curve::sample("all light", &places, |r| Ok(sphere.fluence(r)?.value))?;
            let direct = Curve::sample("direct light", &places, |r| Ok(sphere.fluence_direct(r)?.value))?;
            let label = "Distance from the centre r";
            let axis = if centre { Axis::log } else { Axis::linear }(label, "mean free paths");
            panel(axis, &format!("Fluence over {per}"), &unit(""), vec![all, direct])
        }
        Draw::Radiance => {
            // Towards the normal the scattered light of a central source grows without limit.
            let angles = even(if centre { 1.0 } else { 0.0 }, 90.0, 91);
            let curve =
                Curve::sample("", &angles, |angle| Ok(sphere.exit_radiance(cos(angle.to_radians()))?.value))?;
            let axis = degrees("Angle to the normal", 90);
            panel(axis, &format!("Radiance that leaves over {per}"), &unit("1/sr"), vec![curve])
        }
    };
    Ok(figure(title, panel))
}
