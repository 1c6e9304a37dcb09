//! Photons from the other side of a thin wall, and rules that reject them.

use super::body::{Body, length};
use super::nearest::{Counts, check_gather, mixture};
use super::profile::Profile;
use super::rule::settle;
use super::shell::{CheckedField, Field, U0};
use super::treated::{METHOD, check_kernel};
use crate::error::{Result, within};
use crate::kernel::{Dimension, Kernel};
use crate::value::Value;
use std::f64::consts::PI;

/// Which photons an estimate keeps. n is the unit normal of the nearest surface closer than the search radius, on the
/// side of the probe, s0 a point on it, w_p a photon's direction of travel; without such a surface all are kept.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Rejection {
    /// All.
    Off,
    /// w_p.n < 0: those that travel from the probe's side to the other. Half of the good ones are rejected.
    Facing,
    /// (x_p - s0).n >= 0 or w_p.n < 0: the same of photons behind the plane only.
    FacingBehind,
    /// (x_p - s0).n >= 0.
    BehindPlane,
    /// The segment from the probe to x_p meets no surface.
    Visible,
}

impl Rejection {
    /// All of them.
    pub const ALL: [Rejection; 5] = [
        Rejection::Off,
        Rejection::Facing,
        Rejection::FacingBehind,
        Rejection::BehindPlane,
        Rejection::Visible,
    ];

    /// Parts of the photons kept, on the probe's side and on the other, in isotropic fields beside a flat sheet.
    fn kept(self) -> (f64, f64) {
        match self {
            Rejection::Off => (1.0, 1.0),
            Rejection::Facing => (0.5, 0.5),
            Rejection::FacingBehind => (1.0, 0.5),
            Rejection::BehindPlane | Rejection::Visible => (1.0, 0.0),
        }
    }
}

/// Two uniform fields of kept photons, and the part of the ball on the probe's side.
struct Sheet<'a> {
    near: Profile<'a>,
    kernel: Kernel,
    clipped: bool,
    inside: f64,
    outside: f64,
}

impl Sheet<'_> {
    fn mixed(&self, near: f64, whole: f64) -> f64 {
        self.inside * near + self.outside * (whole - near)
    }
}

impl Counts for Sheet<'_> {
    fn held(&self, r: f64) -> f64 {
        self.mixed(self.near.ball(r, |_| 1.0)[U0], 4.0 / 3.0 * PI * r * r * r)
    }

    fn shell(&self, r: f64) -> f64 {
        self.mixed(self.near.shell(r)[U0], 4.0 * PI * r * r)
    }

    fn mean(&self, r: f64) -> Result<(f64, f64)> {
        let near = self.near.ball(r, |u| self.kernel.density(Dimension::Three, u) / (r * r * r))[U0];
        Ok((self.mixed(near, 1.0) / if self.clipped { near } else { 1.0 }, 1.0))
    }
}

/// What is asked of a sheet: where it is and what lies on its sides.
struct Question {
    rejection: Rejection,
    clipped: bool,
    kernel: Kernel,
    radius: f64,
    h: f64,
    inside: f64,
    outside: f64,
}

fn answer(question: &Question, gather: Option<(u32, f64)>) -> Result<Value> {
    let Question { rejection, clipped, kernel, radius, h, inside, outside } = *question;
    check_kernel(kernel)?;
    within("h", h, 0.0, 1e12, "0 to 1e12")?;
    within("inside", inside, 0.0, 1e50, "0 to 1e50")?;
    within("outside", outside, 0.0, 1e50, "0 to 1e50")?;
    let (keep_inside, keep_outside) = if h < radius { rejection.kept() } else { (1.0, 1.0) };
    let place = Body::HalfSpace.place([0.0, 0.0, h], radius)?;
    let asked = CheckedField::new(Field::Uniform, true);
    settle(METHOD, |rule| {
        let sheet = Sheet {
            near: Profile::new(rule, &place.own, radius, &asked),
            kernel,
            clipped,
            inside: keep_inside * inside,
            outside: keep_outside * outside,
        };
        match gather {
            None => sheet.mean(radius),
            Some((k, density)) => mixture(rule, k, radius, density, sheet.near.ends().collect(), &sheet),
        }
    })
}

/// Expectation of the fixed-radius estimate beside a thin flat sheet between two uniform isotropic fields.
///
/// (f_in M_0 p_in + f_out (1 - M_0) p_out), over M_0 if clipped, with p the parts kept: 1, 1 `Off`; 1/2, 1/2 `Facing`;
/// 1, 1/2 `FacingBehind`; 1, 0 `BehindPlane` and `Visible`. No rejection makes up for the ball's lost part: clipping does.
/// # Arguments
/// `clipped` whether the sum is divided by M_0, the kernel's mass on the probe's side; `radius` \[length\], 1e-12 to
/// 1e12; `h` distance of the probe from the sheet \[length\], 0 to 1e12; `inside`, `outside` the fields on the probe's
/// side and on the other, 0 to 1e50
/// # Returns
/// \[unit of the fields\]; what is true is `inside`
/// # Errors
/// `Error::OutOfRange` naming the parameter; `Error::Infinite` for the kernel without end
/// # Limits
/// a sheet at the radius or farther: `inside`, whatever the rejection
pub fn false_photon_mean(
    rejection: Rejection,
    clipped: bool,
    kernel: Kernel,
    radius: f64,
    h: f64,
    inside: f64,
    outside: f64,
) -> Result<Value> {
    length("radius", radius)?;
    answer(&Question { rejection, clipped, kernel, radius, h, inside, outside }, None)
}

/// Expectation of the k-nearest estimate beside a thin flat sheet; rejected photons do not set the radius.
///
/// Surfaces closer than the cap are looked at, so that a photon is kept or not whatever the k-th distance.
/// # Arguments
/// `k` 2 to 1e6 and `cap` \[length\], 1e-12 to 1e12; `density` photons per volume where the field is 1; the others as
/// in [`false_photon_mean`]
/// # Returns
/// \[unit of the fields\]
/// # Errors
/// as [`false_photon_mean`]
/// # Limits
/// `BehindPlane` and `Visible`, clipped: `inside`, for every k and cap
#[expect(clippy::too_many_arguments, reason = "the question has as many parts")]
pub fn nearest_false_photon_mean(
    rejection: Rejection,
    clipped: bool,
    kernel: Kernel,
    k: u32,
    cap: f64,
    h: f64,
    density: f64,
    inside: f64,
    outside: f64,
) -> Result<Value> {
    check_gather(k, cap, density)?;
    answer(&Question { rejection, clipped, kernel, radius: cap, h, inside, outside }, Some((k, density)))
}
