//! The homogeneous cuboid and the endless rectangular duct of isotropic scattering.
//!
//! phi(r) = phi_0(r) + w int K(|r-r'|) phi(r') dr', with K(d) = e^(-d)/(4 pi d^2) in a cuboid and Ki_1(d)/(2 pi d) in a duct.
//! Galerkin's method in products of Legendre polynomials p_i(x) p_j(y) p_k(z): the distances along the axes enter a matrix
//! element through correlations of one variable each, so that it is a threefold integral over a box with the singularity in
//! one corner, smooth in pyramids about it. Above the degrees of the equation stands the direct light, whose moments are as
//! cheap; then light flies once more, phi = phi_0 + w K phi_N, which smoothes what polynomials leave open at edges.

mod bickley;
mod body;
mod direct;
mod galerkin;
mod pyramids;
#[cfg(test)]
mod tests;

use crate::error::{Result, within};
use crate::value::Value;
use body::Body;
pub use body::CuboidSource;
use galerkin::{Expansion, FirstFlights, Operator, direct};
use libm::exp;
use std::f64::consts::PI;

/// Relative error of the pyramids' rules: what rules of other degrees change is less (tested).
const ROUNDING: f64 = 1e-11;

const HOW: &str = "Galerkin in Legendre polynomials, three degrees";
const DIRECT: &str = "direct light";

/// A cuboid 0 <= x <= a, 0 <= y <= b, 0 <= z <= c of isotropic scattering, or a duct that is endless along z.
#[derive(Debug, Clone)]
pub struct Cuboid {
    body: Body,
    albedo: f64,
    source: CuboidSource,
    /// Of three degrees, the highest last.
    expansions: Vec<Expansion>,
}

/// Degrees along each axis: a cuboid of 20 has 1,000 unknowns of either parity.
const DEGREES: [usize; 3] = [10, 14, 20];

/// The same of a duct: 512 unknowns.
const DUCT_DEGREES: [usize; 3] = [16, 22, 32];

impl Cuboid {
    /// A cuboid of these sides, in mean free paths.
    ///
    /// # Errors
    /// `Error::OutOfRange` unless sides are 1e-3 to 20, none more than 20 times another, and the albedo is 0 to 1
    /// # Limits
    /// two long sides: [`crate::IsotropicSlab`] under diffuse light or a beam; albedo 1 and light on all faces: fluence 4
    /// # Source
    /// Crosbie and Schrenker 1984; the method: Atkinson 1997, chapters 3 and 5 (Galerkin and its iterate), Duffy 1982
    pub fn new(sides: [f64; 3], albedo: f64, source: CuboidSource) -> Result<Self> {
        Self::of(Body { sides, endless: false }, albedo, source, DEGREES)
    }

    /// A duct of these two sides, in mean free paths, endless along z: z of a place does not matter, and powers are per mean
    /// free path of its length.
    ///
    /// # Errors
    /// As [`Cuboid::new`]
    pub fn duct(sides: [f64; 2], albedo: f64, source: CuboidSource) -> Result<Self> {
        Self::of(Body { sides: [sides[0], sides[1], 1.0], endless: true }, albedo, source, DUCT_DEGREES)
    }

    fn of(body: Body, albedo: f64, source: CuboidSource, degrees: [usize; 3]) -> Result<Self> {
        let sides = &body.sides[..body.axes()];
        for &side in sides {
            within("side", side, 1e-3, 20.0, "1e-3 to 20 mean free paths")?;
        }
        let shortest = sides.iter().copied().fold(f64::INFINITY, f64::min);
        let longest = sides.iter().copied().fold(0.0, f64::max);
        within("longest over shortest side", longest / shortest, 1.0, 20.0, "1 to 20")?;
        within("albedo", albedo, 0.0, 1.0, "0 to 1")?;
        let solve = |degree| match albedo {
            0.0 => direct(&body, 2 * degree, source),
            _ => Operator::new(body, degree).solve(albedo, source),
        };
        Ok(Cuboid { body, albedo, source, expansions: degrees.map(solve).to_vec() })
    }

    /// The value of the highest degree. Errors fall at least with the square of the degree, so that the difference from the
    /// middle degree is as large as the error, and that from the lowest, half as high, is three times as large; half of it
    /// stands in where the first is small by chance.
    fn best(values: [f64; 3], relative: f64) -> Value {
        let [low, middle, high] = values;
        let error = (high - middle).abs().max(0.5 * (high - low).abs());
        Value::new(high, error + relative * high.abs() + f64::MIN_POSITIVE, HOW)
    }

    /// A number of each expansion.
    fn of_each(&self, number: impl Fn(&Expansion) -> f64) -> [f64; 3] {
        std::array::from_fn(|i| number(&self.expansions[i]))
    }

    fn check(&self, place: [f64; 3]) -> Result<[f64; 3]> {
        let names = ["x", "y", "z"];
        for axis in 0..self.body.axes() {
            within(names[axis], place[axis], 0.0, self.body.sides[axis], "0 to the side along that axis")?;
        }
        Ok(if self.body.endless { [place[0], place[1], 0.0] } else { place })
    }

    fn first_flights(&self, place: [f64; 3]) -> FirstFlights {
        FirstFlights::from(&self.body, self.expansions[2].degree(), place)
    }

    /// Fluence over irradiance, or over power per squared mean free path.
    pub fn fluence(&self, place: [f64; 3]) -> Result<Value> {
        let place = self.check(place)?;
        if self.albedo == 0.0 {
            return self.fluence_direct(place);
        }
        let first_flights = self.first_flights(place);
        let direct = self.direct_with(place, Some(&first_flights))?;
        let collided = Self::best(self.of_each(|phi| phi.collided(&first_flights)), ROUNDING);
        Ok(direct.plus(collided.scaled(self.albedo), HOW))
    }

    /// Fluence of the light that has not collided.
    pub fn fluence_direct(&self, place: [f64; 3]) -> Result<Value> {
        self.direct_with(self.check(place)?, None)
    }

    fn direct_with(&self, place: [f64; 3], first_flights: Option<&FirstFlights>) -> Result<Value> {
        let body = &self.body;
        match self.source {
            CuboidSource::Face => direct::face(body, 0, false, place),
            CuboidSource::Faces => direct::faces(body, place),
            CuboidSource::Beam => Ok(Value::rounded(exp(-place[0]), 2.0 + place[0], "closed form")),
            CuboidSource::Uniform => {
                let uniform = match first_flights {
                    Some(flights) => flights.uniform(),
                    None => FirstFlights::from(body, 2, place).uniform(),
                };
                Ok(Value::new(uniform, ROUNDING * uniform, DIRECT))
            }
        }
    }

    /// Source function, what scatters and is emitted per steradian and mean free path: w phi/(4 pi), and of the even source
    /// its power over 4 pi and the volume.
    pub fn source_function(&self, place: [f64; 3]) -> Result<Value> {
        Ok(self.source_function_of(self.fluence(place)?))
    }

    /// The same from the fluence there.
    pub fn source_function_of(&self, fluence: Value) -> Value {
        let scattered = fluence.scaled(self.albedo / (4.0 * PI));
        match self.source {
            CuboidSource::Uniform => {
                let emitted = 1.0 / (4.0 * PI * self.body.volume());
                scattered.plus(Value::rounded(emitted, 4.0, "closed form"), HOW)
            }
            _ => scattered,
        }
    }

    /// Fluence averaged over the body.
    pub fn mean_fluence(&self) -> Value {
        Self::best(self.of_each(Expansion::integral), ROUNDING).scaled(1.0 / self.body.volume())
    }

    /// Power that enters, or is emitted.
    fn power(&self) -> f64 {
        match self.source {
            CuboidSource::Face | CuboidSource::Beam => self.body.face(0),
            CuboidSource::Faces => self.body.surface(),
            CuboidSource::Uniform => 1.0,
        }
    }

    /// Fraction of that power which is absorbed.
    pub fn absorptance(&self) -> Value {
        let absorbed = self.mean_fluence().scaled((1.0 - self.albedo) * self.body.volume() / self.power());
        Value { error: absorbed.error + f64::MIN_POSITIVE, ..absorbed }
    }

    /// Fraction of that power which leaves through all faces, uncollided light included.
    pub fn escape(&self) -> Value {
        let absorbed = self.absorptance();
        Value::new(1.0 - absorbed.value, absorbed.error + f64::EPSILON, absorbed.method)
    }
}
