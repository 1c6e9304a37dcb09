//! `exact cuboid`: the cuboid and the endless duct of isotropic scattering.

use crate::answer::Answer;
use crate::plot::{Curve, crowded, figure, panel};
use crate::question::{Question, Solved};
use crate::read::place;
use crate::typed::Typed;
use crate::unit::Unit;
use anyhow::{Result, ensure};
use clap::ValueEnum;
use std::rc::Rc;
use turbid_analytic::{Cuboid, CuboidSource};
use turbid_figure::{Axis, Figure};

/// A cuboid, or a rectangular duct without end, of isotropic scattering: fluence, source function, absorption.
///
/// In the body 0 <= x <= a, 0 <= y <= b, 0 <= z <= c (a duct has no c, and is the same at every z), with w the albedo and phi_0 the
/// light that has not collided,
///
///   phi(r) = phi_0(r) + w int K(|r-r'|) phi(r') dr',   K(d) = e^(-d)/(4 pi d^2),   of a duct Ki_1(d)/(2 pi d)
///
/// Lengths are mean free paths. Sources: isotropic light of irradiance 1 (radiance 1/pi) on the `face` x = 0 or on all `faces`, a
/// `beam` along x of irradiance 1 on the face x = 0 (fluence a pure number); `uniform` emission of unit power over the volume (fluence in
/// 1/mean free path^2; of a duct, of unit power over a mean free path of its length). `source_function` is w phi/(4 pi), with what is
/// emitted. Galerkin's method in Legendre polynomials; the bound is the difference of three degrees.
/// Source: Crosbie and Schrenker 1984; Altac and Spinrad 1990.
#[derive(Clone, clap::Args)]
#[command(verbatim_doc_comment)]
pub struct Args {
    /// Sides a, b, c of a cuboid or a, b of a duct, in mean free paths, 1e-3 to 20, none more than 20 times another.
    #[arg(long, required = true, num_args = 1.., value_delimiter = ',', value_name = "SIDE", allow_negative_numbers = true)]
    sides: Vec<f64>,
    /// Single-scattering albedo, 0 to 1.
    #[arg(long, allow_negative_numbers = true)]
    albedo: f64,
    /// Where the light comes from.
    #[arg(long, value_enum, default_value = "face")]
    source: Source,
    /// A place x,y,z (of a duct x,y), in mean free paths, at which to give fluence and source function. Once for each place.
    #[arg(long, value_parser = place, value_name = "X,Y,Z", allow_negative_numbers = true)]
    at: Vec<Vec<f64>>,
}

/// The sources, by their names on the command line.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Source {
    /// Isotropic light on the face x = 0.
    Face,
    /// Isotropic light on all faces.
    Faces,
    /// Isotropic emission of unit power, spread evenly.
    Uniform,
    /// A beam along x.
    Beam,
}

impl Source {
    fn known(self) -> (CuboidSource, &'static str, &'static str) {
        match self {
            Source::Face => (CuboidSource::Face, "face", "one face lit"),
            Source::Faces => (CuboidSource::Faces, "faces", "all faces lit"),
            Source::Uniform => (CuboidSource::Uniform, "uniform", "uniform source"),
            Source::Beam => (CuboidSource::Beam, "beam", "beam along x"),
        }
    }
}

impl Args {
    fn cuboid(&self, solved: &Solved) -> Result<Rc<Cuboid>> {
        let (source, name, _) = self.source.known();
        solved.once((&self.sides, self.albedo, name), || {
            Ok(match self.sides[..] {
                [a, b, c] => Cuboid::new([a, b, c], self.albedo, source)?,
                _ => Cuboid::duct([self.sides[0], self.sides[1]], self.albedo, source)?,
            })
        })
    }
}

impl Question for Args {
    fn answer(&self, answer: &mut Answer, solved: &Solved) -> Result<()> {
        ensure!(
            matches!(self.sides.len(), 2 | 3),
            "--sides has {}; allowed: 3 of a cuboid, 2 of a duct",
            self.sides.len()
        );
        for at in &self.at {
            ensure!(
                at.len() == self.sides.len(),
                "--at has {} coordinates; allowed: {}, as many as --sides",
                at.len(),
                self.sides.len()
            );
        }
        let cuboid = self.cuboid(solved)?;
        let (power, fluence, radiance) = match self.source {
            Source::Uniform => (Unit::EmittedPower, Unit::PowerPerMfp2, Unit::PowerPerMfp2Sr),
            _ => (Unit::IncidentPower, Unit::Irradiance, Unit::IrradiancePerSr),
        };
        let sides: Vec<String> = self.sides.iter().map(f64::to_string).collect();
        answer.of("cuboid").with("sides", sides.join(" x ")).with("albedo", self.albedo);
        answer.with("source", self.source.known().1);
        answer.add("absorptance", power, &[], cuboid.absorptance());
        answer.add("escape", power, &[], cuboid.escape());
        answer.add("mean_fluence", fluence, &[], cuboid.mean_fluence());
        for place in &self.at {
            let names = ["x", "y", "z"].into_iter().zip(place.iter().map(|&x| x.into()));
            let at: Vec<_> = names.collect();
            let place = [place[0], place[1], place.get(2).copied().unwrap_or(0.0)];
            let all = cuboid.fluence(place)?;
            answer.add("fluence", fluence, &at, all);
            answer.add("fluence_direct", fluence, &at, cuboid.fluence_direct(place)?);
            answer.add("source_function", radiance, &at, cuboid.source_function_of(all));
        }
        Ok(())
    }

    /// Fluence along the middle.
    fn figure(&self, solved: &Solved) -> Result<Figure> {
        let cuboid = self.cuboid(solved)?;
        let (_, _, source) = self.source.known();
        let middle = |x: f64| [x, 0.5 * self.sides[1], self.sides.get(2).map_or(0.0, |c| 0.5 * c)];
        let places = crowded(self.sides[0], 17);
        let all = Curve::sample("all light", &places, |x| Ok(cuboid.fluence(middle(x))?.value))?;
        let direct = Curve::sample("direct light", &places, |x| Ok(cuboid.fluence_direct(middle(x))?.value))?;
        let (per, unit) = match self.source {
            Source::Uniform => ("power", "1/mean free path²"),
            _ => ("irradiance", ""),
        };
        let sides: Vec<String> = self.sides.iter().map(f64::to_string).collect();
        let body = if self.sides.len() == 2 { "Duct" } else { "Cuboid" };
        let title = format!("{body} {}, albedo {}, {source}", sides.join(" × "), self.albedo);
        let axis = Axis::linear("x, in the middle of y and z", "mean free paths");
        Ok(figure(title, panel(axis, &format!("Fluence over {per}"), unit, vec![all, direct])))
    }

    fn typed(&self) -> Option<Typed> {
        Some(Typed {
            albedo: Some(self.albedo),
            g: Some(0.0),
            size: Some(self.sides.iter().sum()),
            places: self.at.iter().map(|place| place.iter().sum()).collect(),
            ..Typed::default()
        })
    }

    fn moved(&self, to: f64) -> Option<Box<dyn Question>> {
        Some(Box::new(Args { albedo: to, ..self.clone() }))
    }
}
