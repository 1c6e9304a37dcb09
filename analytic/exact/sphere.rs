//! `exact sphere`: the finite sphere of isotropic scattering.

use crate::answer::Answer;
use crate::plot::{Curve, degrees, even, figure, panel, ratios};
use crate::question::{Question, Solved};
use crate::typed::Typed;
use crate::unit::Unit;
use anyhow::Result;
use clap::ValueEnum;
use libm::cos;
use std::rc::Rc;
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
    albedo: f64,
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

impl Args {
    fn sphere(&self, solved: &Solved) -> Result<Rc<Sphere>> {
        let (source, name, _) = self.source.known();
        solved.once((self.radius, self.albedo, name), || {
            // Spheres of one radius share an operator.
            Ok(match solved.latest(|_, other: &Sphere| other.radius().to_bits() == self.radius.to_bits()) {
                Some(other) => other.with(self.albedo, source)?,
                None => Sphere::new(self.radius, self.albedo, source)?,
            })
        })
    }
}

impl Question for Args {
    fn answer(&self, answer: &mut Answer, solved: &Solved) -> Result<()> {
        let sphere = || self.sphere(solved);
        let (power, fluence, radiance) = match self.source {
            Source::Uniform | Source::Centre => {
                (Unit::EmittedPower, Unit::PowerPerMfp2, Unit::PowerPerMfp2Sr)
            }
            Source::Incident => (Unit::IncidentPower, Unit::Irradiance, Unit::IrradiancePerSr),
        };
        let (_, name, _) = self.source.known();
        answer.of("sphere").with("radius", self.radius).with("albedo", self.albedo).with("source", name);
        answer.ask("escape", power, &[], || Ok(sphere()?.escape()))?;
        answer.ask("absorptance", power, &[], || Ok(sphere()?.absorptance()))?;
        // Without a collision: what leaves a sphere that only absorbs.
        answer.ask("escape_direct", power, &[], || {
            Ok(match self.source {
                Source::Uniform => escape_uniform(self.radius)?,
                Source::Centre => escape_from(self.radius, 0.0)?,
                Source::Incident => absorbing_transmittance(self.radius)?,
            })
        })?;
        for &r in &self.r {
            let at = [("r", r.into())];
            answer.ask("fluence", fluence, &at, || Ok(sphere()?.fluence(r)?))?;
            answer.ask("fluence_direct", fluence, &at, || Ok(sphere()?.fluence_direct(r)?))?;
            answer.ask("escape_direct_from", Unit::EmittedThere, &at, || Ok(escape_from(self.radius, r)?))?;
            for &n in &self.order {
                let at = [("r", r.into()), ("order", n.into())];
                answer.ask("fluence_of_order", fluence, &at, || Ok(sphere()?.fluence_of_order(n, r)?))?;
            }
        }
        for &mu in &self.mu {
            answer
                .ask("exit_radiance", radiance, &[("mu", mu.into())], || Ok(sphere()?.exit_radiance(mu)?))?;
        }
        Ok(())
    }

    fn figure(&self, solved: &Solved) -> Result<Figure> {
        let sphere = self.sphere(solved)?;
        let (a, (_, _, source)) = (self.radius, self.source.known());
        let title = format!("Sphere of radius {a}, albedo {}, {source}", self.albedo);
        let centre = self.source == Source::Centre;
        let per = if self.source == Source::Incident { "irradiance" } else { "power" };
        let unit = |of: &str| match (self.source, of) {
            (Source::Incident, unit) => unit.to_string(),
            (_, "") => "1/mean free path²".to_string(),
            (_, unit) => format!("{unit}/mean free path²"),
        };
        let panel = match self.draw {
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
                let curve = Curve::sample("", &angles, |angle| {
                    Ok(sphere.exit_radiance(cos(angle.to_radians()))?.value)
                })?;
                let axis = degrees("Angle to the normal", 90);
                panel(axis, &format!("Radiance that leaves over {per}"), &unit("1/sr"), vec![curve])
            }
        };
        Ok(figure(title, panel))
    }

    fn typed(&self) -> Option<Typed> {
        Some(Typed {
            albedo: Some(self.albedo),
            g: Some(0.0),
            size: Some(self.radius),
            places: self.r.clone(),
            ..Typed::default()
        })
    }

    fn moved(&self, to: f64) -> Option<Box<dyn Question>> {
        Some(Box::new(Args { albedo: to, ..self.clone() }))
    }
}
