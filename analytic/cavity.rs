//! The Lambertian cavity: a sphere whose wall reflects diffusely, empty or filled with an index-matched medium.
//!
//! Every point of the wall of an empty sphere sees every other alike: what one spot sends out falls as the same
//! irradiance on the whole wall. So the light of any source is its own, E_0(x), and an even glow of the rest,
//! E(x) = E_0(x) + rho <E_0>/(1 - rho), rho the wall's albedo. Filled with an isotropically scattering medium that
//! absorbs the fraction A of what the wall sends in ([`crate::sphere`], incident light), an even wall keeps rho (1-A) a
//! round: E = E_1/(1 - rho (1-A)) with E_1 the irradiance before the wall's first reflection. An uneven E_1 leaves an
//! uneven E, whose mean alone follows that law.
//!
//! Irradiance is counted before reflection. Units: lengths in mean free paths (empty: any), powers over their squares.
//!
//! Limits: rho = 0, the source alone; rho = 1 is finite only if the medium absorbs.
//!
//! Source: Sumpner 1892; Walsh 1958, chapter 8 (the integrating sphere).

use crate::error::{Error, Result, within};
use crate::incidence::check_albedo;
use crate::sphere::{Sphere, SphereSource};
use crate::value::Value;
use std::f64::consts::PI;

const METHOD: &str = "closed form on the sphere's absorptance";

/// A spherical cavity with a diffuse wall.
pub struct Cavity {
    radius: f64,
    wall_albedo: f64,
    /// The medium under isotropic incidence and around a central source; nothing in an empty cavity.
    medium: Option<(Sphere, Sphere)>,
    /// 1/(1 - rho (1-A)).
    rounds: Value,
}

impl Cavity {
    /// A cavity without a medium.
    ///
    /// # Arguments
    /// `radius` in any unit of length, 1e-100 to 1e100; `wall_albedo` 0 to 1, 1 excluded
    /// # Errors
    /// `Error::OutOfRange` naming `radius` or `wall_albedo`; `Error::Infinite` for a wall that absorbs nothing
    pub fn empty(radius: f64, wall_albedo: f64) -> Result<Self> {
        within("radius", radius, 1e-100, 1e100, "1e-100 to 1e100")?;
        Self::build(radius, wall_albedo, None)
    }

    /// A cavity filled with an index-matched medium of isotropic scattering.
    ///
    /// # Arguments
    /// `radius` in mean free paths, 1e-12 to 1e6; `wall_albedo` 0 to 1; `albedo` of the medium, 0 to 1
    /// # Errors
    /// `Error::OutOfRange` naming `radius`, `wall_albedo` or `albedo`; `Error::Infinite` if neither wall nor medium
    /// absorbs
    pub fn filled(radius: f64, wall_albedo: f64, albedo: f64) -> Result<Self> {
        check_wall(wall_albedo)?;
        check_albedo(albedo)?;
        let lit = Sphere::new(radius, albedo, SphereSource::Incident)?;
        let centre = lit.with(albedo, SphereSource::Centre)?;
        Self::build(radius, wall_albedo, Some((lit, centre)))
    }

    fn build(radius: f64, wall_albedo: f64, medium: Option<(Sphere, Sphere)>) -> Result<Self> {
        let rho = check_wall(wall_albedo)?;
        let absorbed = medium.as_ref().map_or(Value::new(0.0, 0.0, METHOD), |m| m.0.absorptance());
        // (1 - rho) + rho A: nothing cancels.
        let lost = (1.0 - rho) + rho * absorbed.value;
        let error = rho * absorbed.error + 2.0 * f64::EPSILON * lost;
        if error >= 0.5 * lost {
            return Err(Error::Infinite(
                "light in a cavity that absorbs nothing grows without limit; allowed: wall_albedo or albedo below 1",
            ));
        }
        let rounds = 1.0 / lost;
        // The difference of two reciprocals, to first order doubled.
        let rounds = Value::new(rounds, 2.0 * error * rounds * rounds + f64::EPSILON * rounds, METHOD);
        Ok(Cavity { radius, wall_albedo, medium, rounds })
    }

    /// Radius in mean free paths (empty: any unit).
    pub fn radius(&self) -> f64 {
        self.radius
    }

    /// Albedo of the wall \[1\].
    pub fn wall_albedo(&self) -> f64 {
        self.wall_albedo
    }

    /// How often light falls on the wall, over how often it falls there for the first time \[1\]: 1/(1 - rho (1-A)).
    pub fn rounds(&self) -> Value {
        self.rounds
    }

    /// Irradiance of the wall if the wall itself emits evenly, per unit of emitted exitance \[1\].
    ///
    /// E = (1-A)/(1 - rho (1-A)).
    pub fn irradiance_wall(&self) -> Value {
        match &self.medium {
            Some((lit, _)) => times(lit.escape(), self.rounds),
            None => self.rounds,
        }
    }

    /// Irradiance of the wall from an isotropic source of unit power at the centre \[1/length^2\].
    ///
    /// E = L/(4 pi a^2)/(1 - rho (1-A)), L the part of the power that reaches the wall for the first time.
    pub fn irradiance_centre(&self) -> Value {
        let per_area = 1.0 / (4.0 * PI * self.radius * self.radius);
        match &self.medium {
            Some((_, centre)) => times(centre.escape(), self.rounds).scaled(per_area),
            None => self.rounds.scaled(per_area),
        }
    }

    /// Mean irradiance of the wall from any source.
    ///
    /// # Arguments
    /// `mean_first` mean over the wall of the irradiance before the wall's first reflection, the medium's scattering
    /// included, 0 to 1e100
    /// # Returns
    /// in the unit of `mean_first`
    /// # Errors
    /// `Error::OutOfRange` naming `mean_first`
    pub fn irradiance_mean(&self, mean_first: f64) -> Result<Value> {
        within("mean_first", mean_first, 0.0, 1e100, "0 to 1e100")?;
        Ok(self.rounds.scaled(mean_first))
    }

    /// Irradiance at a spot of an empty cavity's wall, from any source.
    ///
    /// E = E_0 + rho <E_0>/(1 - rho).
    /// # Arguments
    /// `first` the source's own irradiance at the spot, 0 to 1e100; `mean_first` its mean over the wall, 0 to 1e100
    /// # Errors
    /// `Error::OutOfRange` naming `first` or `mean_first`, and naming `first` in a filled cavity unless they are equal
    pub fn irradiance(&self, first: f64, mean_first: f64) -> Result<Value> {
        let mean = self.irradiance_mean(mean_first)?;
        within("first", first, 0.0, 1e100, "0 to 1e100")?;
        if self.medium.is_some() {
            if first == mean_first {
                return Ok(mean);
            }
            let allowed = "the mean, mean_first, in a filled cavity: an uneven wall has no closed form";
            return Err(Error::OutOfRange { name: "first", value: first, allowed });
        }
        let glow = mean.scaled(self.wall_albedo);
        let value = first + glow.value;
        Ok(Value::new(value, glow.error + f64::EPSILON * value, METHOD))
    }

    /// Fluence at distance r from the centre if the wall emits evenly, per unit of emitted exitance \[1\].
    ///
    /// All that the wall sends out, 1/(1 - rho (1-A)), falls on the medium as isotropic light: empty, 4 times that.
    /// # Errors
    /// `Error::OutOfRange` naming `r`
    pub fn fluence_wall(&self, r: f64) -> Result<Value> {
        match &self.medium {
            Some((lit, _)) => Ok(times(lit.fluence(r)?, self.rounds)),
            None => {
                within("r", r, 0.0, self.radius, "0 to the radius")?;
                Ok(self.rounds.scaled(4.0))
            }
        }
    }
}

fn check_wall(wall_albedo: f64) -> Result<f64> {
    within("wall_albedo", wall_albedo, 0.0, 1.0, "0 to 1")
}

fn times(a: Value, b: Value) -> Value {
    let value = a.value * b.value;
    let error = a.error * b.value.abs() + (a.value.abs() + a.error) * b.error;
    Value::new(value, error + f64::EPSILON * value.abs(), METHOD)
}
