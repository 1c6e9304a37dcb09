//! Wood: rings about an axis, not quite round.

use crate::Spectrum;
use crate::error::{Error, Result};
use crate::math::{Frame, atan2, sin};
use crate::surface::fraction::checked;
use glam::DVec3;
use std::f64::consts::PI;

/// Light and dark rings about an axis in space, so that planks cut from one trunk fit together.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Wood {
    values: [Spectrum; 2],
    center: DVec3,
    frame: Frame,
    width: f64,
}

/// How far the rings wander from circles, in widths of a ring: three turns about the axis, and along it one in 20 widths.
const WANDER: f64 = 0.6;

/// Lengths are at most this: their squares are finite.
const LARGEST: f64 = 1e30;

impl Wood {
    /// Rings of `width` \[L\] about the line through `center` along `axis`, of any length but 0: the first value in early
    /// wood, the second in late wood.
    ///
    /// # Errors     `Error::OutOfRange` for values outside [0, 1], a width that is not above 0, or lengths above 1e30;
    /// `Error::Scene` for an axis that is none
    pub fn new(values: [Spectrum; 2], center: DVec3, axis: DVec3, width: f64) -> Result<Self> {
        let Some(axis) = axis.try_normalize() else {
            return Err(Error::Scene("wood needs an axis other than 0 0 0".into()));
        };
        let far = center.abs().max_element();
        if !(far <= LARGEST && center.is_finite()) {
            return Err(Error::out_of_range("center", far, "coordinates up to 1e30 in size"));
        }
        if !(1.0 / LARGEST..=LARGEST).contains(&width) {
            return Err(Error::out_of_range("width", width, "1e-30 to 1e30"));
        }
        Ok(Wood {
            values: [checked("values", values[0])?, checked("values", values[1])?],
            center,
            frame: Frame::new(axis),
            width,
        })
    }

    pub(super) fn values(&self) -> [Spectrum; 2] {
        self.values
    }

    /// The ring's saw tooth, early wood slowly turning late: continuous but for the sharp outer edge of a ring.
    pub(super) fn at(&self, p: DVec3) -> Spectrum {
        let local = self.frame.to_local(p - self.center) / self.width;
        let turn = atan2(local.y, local.x);
        let along = local.z * (2.0 * PI / 20.0);
        let radius = local.truncate().length();
        // No wandering on the axis itself, where the azimuth has no value.
        let wander = WANDER * radius / (1.0 + radius)
            * (sin(3.0 * turn + along) + 0.5 * sin(2.0 * turn - 1.7 * along));
        let ring = radius + wander;
        let part = ring - ring.floor();
        let late = part * part * part;
        self.values[0] * (1.0 - late) + self.values[1] * late
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// On the axis early wood; between the values everywhere; the same trunk at every turn of a full circle.
    #[test]
    fn rings_lie_between_the_values() {
        let (early, late) = (Spectrum::rgb(0.6, 0.4, 0.2), Spectrum::rgb(0.3, 0.15, 0.05));
        let wood = Wood::new([early, late], DVec3::ONE, DVec3::Y * 2.0, 0.5).unwrap();
        assert_eq!(wood.at(DVec3::ONE), early);
        let mut darkest = 1.0f64;
        for i in 0..2000 {
            let x = f64::from(i) * 0.01;
            let value = wood.at(DVec3::new(x, 0.3 * x, -x));
            for c in 0..3 {
                assert!(value[c] <= early[c] + 1e-15 && value[c] >= late[c] - 1e-15);
            }
            darkest = darkest.min(value[0]);
        }
        assert!(darkest < 0.31);
        assert!(Wood::new([early, late], DVec3::ZERO, DVec3::ZERO, 1.0).is_err());
        assert!(Wood::new([early, late], DVec3::ZERO, DVec3::X, 0.0).is_err());
    }
}
