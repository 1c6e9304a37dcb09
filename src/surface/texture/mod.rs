//! What varies over a surface: reflectance, or the transmittance of a filter.

mod image;
mod wood;

pub use self::image::Image;
pub use wood::Wood;

use super::fraction::checked;
use crate::Spectrum;
use crate::error::{Error, Result};
use glam::{DVec2, DVec3};
use std::sync::Arc;

/// A number between 0 and 1 by channel, at each place of a surface.
#[derive(Debug, Clone, PartialEq)]
pub enum Texture {
    /// The same everywhere.
    Constant(Spectrum),
    /// A picture over the surface parameters, repeated beyond [0, 1].
    Image(Arc<Image>),
    /// Two values by turns over the surface parameters.
    Checker(Checker),
    /// Rings of light and dark wood about an axis in space.
    Wood(Arc<Wood>),
}

/// Rectangles by turns of one value and the other.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Checker {
    values: [Spectrum; 2],
    tiles: [f64; 2],
}

impl Checker {
    /// `tiles` rectangles along each surface parameter; the first value where both parameters begin.
    ///
    /// # Errors     `Error::OutOfRange` for values outside [0, 1] or numbers of tiles that are not above 0
    pub fn new(values: [Spectrum; 2], tiles: [f64; 2]) -> Result<Self> {
        match tiles.iter().find(|n| !(**n > 0.0 && n.is_finite())) {
            Some(bad) => Err(Error::out_of_range("tiles", *bad, "finite and above 0")),
            None => {
                Ok(Checker { values: [checked("values", values[0])?, checked("values", values[1])?], tiles })
            }
        }
    }

    fn at(&self, uv: DVec2) -> Spectrum {
        let tile = (uv * DVec2::from_array(self.tiles)).floor();
        // Sums of whole numbers: the remainder is exact.
        self.values[usize::from((tile.x + tile.y).rem_euclid(2.0) != 0.0)]
    }
}

impl Texture {
    /// The same everywhere, each channel in [0, 1]; errors call it by its name.
    pub fn constant(name: &'static str, value: Spectrum) -> Result<Self> {
        Ok(Texture::Constant(checked(name, value)?))
    }

    /// The value at a position \[L\] with these surface parameters.
    #[inline]
    pub fn at(&self, position: DVec3, uv: DVec2) -> Spectrum {
        match self {
            Texture::Constant(value) => *value,
            Texture::Image(image) => image.at(uv),
            Texture::Checker(checker) => checker.at(uv),
            Texture::Wood(wood) => wood.at(position),
        }
    }

    /// Largest value of each channel, over all places.
    pub fn brightest(&self) -> Spectrum {
        self.bounds().1
    }

    /// Smallest value of each channel, over all places.
    pub fn darkest(&self) -> Spectrum {
        self.bounds().0
    }

    fn bounds(&self) -> (Spectrum, Spectrum) {
        match self {
            Texture::Constant(value) => (*value, *value),
            Texture::Image(image) => image.bounds(),
            Texture::Checker(checker) => bounds(checker.values),
            Texture::Wood(wood) => bounds(wood.values()),
        }
    }

    /// Whether all channels are equal everywhere.
    pub fn is_grey(&self) -> bool {
        match self {
            Texture::Constant(value) => value.is_grey(),
            Texture::Image(image) => image.is_grey(),
            Texture::Checker(checker) => checker.values.iter().all(|v| v.is_grey()),
            Texture::Wood(wood) => wood.values().iter().all(|v| v.is_grey()),
        }
    }
}

/// Smaller and larger of two values, by channel.
fn bounds([a, b]: [Spectrum; 2]) -> (Spectrum, Spectrum) {
    (Spectrum(a.0.min(b.0)), Spectrum(a.0.max(b.0)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn checkers_take_turns() {
        let (black, white) = (Spectrum::grey(0.1), Spectrum::rgb(0.9, 0.8, 0.7));
        let texture = Texture::Checker(Checker::new([black, white], [4.0, 2.0]).unwrap());
        let at = |u: f64, v: f64| texture.at(DVec3::ZERO, DVec2::new(u, v));
        for (u, v, expected) in [
            (0.0, 0.0, black),
            (0.24, 0.49, black),
            (0.26, 0.0, white),
            (0.0, 0.51, white),
            (0.3, 0.6, black),
            (-0.1, 0.0, white),
            (-0.1, -0.1, black),
        ] {
            assert_eq!(at(u, v), expected, "{u} {v}");
        }
        assert_eq!((texture.darkest(), texture.brightest()), (black, white));
        assert!(!texture.is_grey());
        assert!(Checker::new([black, Spectrum::grey(1.5)], [1.0, 1.0]).is_err());
        assert!(Checker::new([black, white], [0.0, 1.0]).is_err());
        assert!(Texture::constant("reflectance", Spectrum::grey(-0.1)).is_err());
    }
}
