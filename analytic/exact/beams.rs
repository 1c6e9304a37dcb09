//! `exact beams`: photons and rays as points or as beams.

use crate::answer::Answer;
use crate::plot::{Curve, figure, panel, ratios};
use crate::question::{Question, Solved};
use crate::read::{kernel, kernel_name};
use crate::unit::Unit;
use anyhow::Result;
use turbid_analytic::beams::{Pairing, Ray, crossing_moment, crossing_tail};
use turbid_analytic::{Kernel, Value};
use turbid_figure::{Axis, Figure};

/// Beam estimates: how photons as points or beams blur and spread, asked at a point or along a ray.
///
///   point asks points           blur in 3 dimensions, variance ~ 1/r^3
///   ray asks points             blur across the ray,  variance ~ 1/r^2       (the beam radiance estimate)
///   point asks beams            blur across the beams, variance ~ 1/r^2      (parallel beams)
///   ray asks beams              blur along the common normal, variance ~ E[1/sin theta]/r
///
/// bias = coefficient r^2 times the Laplacian in the directions of blur; relative variance in a uniform field
///
///   R_d E[1/sin theta]/(density r^d S),   S = (int T ds)^2/int T^2 ds along the ray, T = e^(-extinction s)
///
/// With --curvature, r^(d+4) = d B/(4 A^2) is best, where bias = A r^2 and variance = B/r^d.
/// Isotropic beams: E[1/sin theta] = pi/2, and X = 1/sin theta of those that cross has a tail P(X > x) ~ (4/(3 pi)) x^-3.
/// Lengths in one unit of your choice; density of points per volume, of beams as their length per volume.
/// Source: Jarosz, Zwicker and Jensen 2008; Jarosz, Nowrouzezahrai, Sadeghi and Jensen 2011.
#[derive(Clone, clap::Args)]
#[command(verbatim_doc_comment)]
pub struct Args {
    /// Kernel, by name as in `exact kernel`.
    #[arg(long, default_value = "uniform", value_parser = kernel)]
    kernel: Kernel,
    /// Radius of the kernel, 1e-60 to 1e60.
    #[arg(long, default_value_t = 1.0, allow_negative_numbers = true)]
    radius: f64,
    /// Points per volume, or length of beams per volume, 1e-60 to 1e60.
    #[arg(long, default_value_t = 1.0, allow_negative_numbers = true)]
    density: f64,
    /// Length of the ray, 1e-60 to 1e60.
    #[arg(long, default_value_t = 1.0, allow_negative_numbers = true)]
    length: f64,
    /// Extinction coefficient along the ray, in 1/length, 0 or more.
    #[arg(long, default_value_t = 0.0, allow_negative_numbers = true)]
    extinction: f64,
    /// Sine of the angle between ray and beams, above 0 to 1: parallel beams in place of isotropic ones.
    #[arg(long, allow_negative_numbers = true)]
    sine: Option<f64>,
    /// Gradients |b| of fields e^(b.x), times the radius: gives each estimate's mean over the truth.
    #[arg(long, num_args = 1.., value_delimiter = ',', value_name = "X", allow_negative_numbers = true)]
    gradient: Vec<f64>,
    /// Laplacians of the field over the field, in 1/length^2, not 0: gives the radius of least mean squared error, and that
    /// error, relative
    #[arg(verbatim_doc_comment, long, num_args = 1.., value_delimiter = ',', value_name = "C", allow_negative_numbers = true)]
    curvature: Vec<f64>,
    /// Values x of 1/sin theta, 1 and more: gives the tail P(X > x) and the second moment of isotropic beams up to x.
    #[arg(long, num_args = 1.., value_delimiter = ',', value_name = "X", allow_negative_numbers = true)]
    tail: Vec<f64>,
}

impl Args {
    fn ray(&self) -> Ray {
        Ray { length: self.length, extinction: self.extinction }
    }

    /// The four ways, by name.
    fn pairings(&self) -> [(Pairing, &'static str); 4] {
        let beams = match self.sine {
            Some(sine) => (Pairing::RayBeams { sine }, "ray, beams"),
            None => (Pairing::RayIsotropicBeams, "ray, isotropic beams"),
        };
        [
            (Pairing::PointPoints, "point, points"),
            (Pairing::RayPoints, "ray, points"),
            (Pairing::PointBeams, "point, beams"),
            beams,
        ]
    }
}

impl Question for Args {
    fn answer(&self, answer: &mut Answer, _: &Solved) -> Result<()> {
        let ray = self.ray();
        answer
            .of("beams")
            .with("kernel", kernel_name(self.kernel))
            .with("radius", self.radius)
            .with("density", self.density)
            .with("length", self.length)
            .with("extinction", self.extinction);
        if let Some(sine) = self.sine {
            answer.with("sine", sine);
        }
        for (pairing, name) in self.pairings() {
            let at = [("pairing", name.into())];
            answer.add("bias_per_r2_laplacian", Unit::One, &at, pairing.bias_coefficient(self.kernel)?);
            answer.add("inverse_sine", Unit::One, &at, pairing.inverse_sine()?);
            let variance = pairing.relative_variance(self.kernel, self.radius, self.density, ray)?;
            answer.add("relative_variance", Unit::One, &at, variance);
            for &x in &self.gradient {
                let at = [("pairing", name.into()), ("gradient", x.into())];
                answer.add("exponential_mean", Unit::Field, &at, pairing.exponential_mean(self.kernel, x)?);
            }
            for &c in &self.curvature {
                let at = [("pairing", name.into()), ("curvature", c.into())];
                let (radius, left) = pairing.optimum(self.kernel, c, self.density, ray)?;
                answer.add("optimum_radius", Unit::Length(1), &at, radius);
                answer.add("optimum_mean_squared_error", Unit::One, &at, left);
            }
        }
        for &x in &self.tail {
            let at = [("x", x.into())];
            answer.add("crossing_tail", Unit::One, &at, crossing_tail(x)?);
            answer.add("crossing_second_moment", Unit::One, &at, crossing_moment(2, x)?);
        }
        Ok(())
    }

    /// The three variances against the radius.
    fn figure(&self, _: &Solved) -> Result<Figure> {
        let (radii, ray) = (ratios(0.1 * self.radius, 10.0 * self.radius, 41), self.ray());
        let deviation = |v: Value| 100.0 * v.value.sqrt();
        let curve = |(pairing, name): (Pairing, &str)| {
            Curve::sample(name, &radii, |r| {
                Ok(deviation(pairing.relative_variance(self.kernel, r, self.density, ray)?))
            })
        };
        let curves = self.pairings().into_iter().map(curve).collect::<Result<Vec<_>>>()?;
        let title = format!("Points and beams, density {}, ray of length {}", self.density, self.length);
        Ok(figure(title, panel(Axis::log("Radius r", "length"), "Standard deviation", "%", curves)))
    }
}
