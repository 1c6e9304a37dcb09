//! What a treatment adds to the variance, in a uniform field.
//!
//! Photons of a Poisson process give the estimate the variance (f/N) int_O W^2; the plain estimate in a whole ball has
//! (f/N) R/r^3, R = int K^2.

use super::body::{Body, Shape, length};
use super::profile::Profile;
use super::rule::{Rule, pieces, settle};
use super::shell::{CheckedField, Ends, Field, U0, U1, U2};
use super::treated::{METHOD, Treatment, check_kernel, determinant};
use crate::error::{Result, within};
use crate::kernel::{Dimension, Kernel};
use crate::value::Value;
use std::f64::consts::PI;

/// Variance of the fixed-radius estimate with a treatment, over that of the plain estimate in a whole ball with the same
/// kernel; uniform field, independent photons.
///
/// r^3 int_O W^2 / R with W the treatment's weight. Behind flat faces, reflection: the sum over all images of the probe,
/// at distances d, of int K_r(y) K_r(y-d) dy over the same at d = 0.
/// # Arguments
/// `at` as in [`super::body_moment`]; `radius` \[length\], 1e-12 to 1e12
/// # Returns
/// \[1\]; on a flat face, uniform kernel: 1/2, 2, 2, 6.74 in the order of [`Treatment::ALL`]
/// # Errors
/// `Error::OutOfRange` naming the parameter, `radius` for reflection beyond the shortest edge; `Error::Infinite` for the
/// kernel without end
/// # Limits
/// radius up to the probe's depth: 1
pub fn treated_variance(
    treatment: Treatment,
    kernel: Kernel,
    body: Body,
    at: [f64; 3],
    radius: f64,
) -> Result<Value> {
    check_kernel(kernel)?;
    length("radius", radius)?;
    let place = body.place(at, radius)?;
    let roughness = kernel.roughness(Dimension::Three)?.value;
    let density = |u: f64| kernel.density(Dimension::Three, u);
    let asked = CheckedField::new(Field::Uniform, true);
    let cubed = radius * radius * radius;
    let square = |u: f64| density(u) * density(u) / (roughness * cubed);
    if treatment == Treatment::Reflection {
        return match body.shape() {
            Shape::Flat(ends) => {
                let allowed = "up to the thickness or shortest edge, for reflection";
                within("radius", radius, 0.0, body.completed_up_to(), allowed)?;
                let distances = image_distances(ends, at, radius);
                settle(METHOD, |rule| {
                    let sum: f64 = distances.iter().map(|d| overlap(rule, kernel, *d)).sum();
                    Ok((1.0 + sum / roughness, 1.0))
                })
            }
            Shape::Round(a) => settle(METHOD, |rule| {
                let probes = std::iter::once(&place.own).chain(&place.images);
                let squares: f64 = probes
                    .map(|shells| Profile::new(rule, shells, radius, &asked).ball(radius, square)[U0])
                    .sum();
                let cross = sphere_overlap(rule, kernel, a / radius, place.depth / radius);
                Ok((squares + 2.0 * cross / roughness, 1.0))
            }),
        };
    }
    settle(METHOD, |rule| {
        let profile = Profile::new(rule, &place.own, radius, &asked);
        let squares = profile.ball(radius, square);
        let moments = profile.ball(radius, |u| density(u) / cubed);
        match treatment {
            Treatment::LocalLinear => {
                let (determinant, spread) = determinant(&moments);
                let (a, b) = (moments[U2] / determinant, moments[U1] / determinant);
                Ok((a * a * squares[U0] - 2.0 * a * b * squares[U1] + b * b * squares[U2], spread))
            }
            Treatment::Clipped => Ok((squares[U0] / (moments[U0] * moments[U0]), 1.0)),
            Treatment::None | Treatment::Reflection => Ok((squares[U0], 1.0)),
        }
    })
}

/// Distances, in radii and below 2, of a probe from all its images but itself: mirrored and shifted by whole periods.
fn image_distances(ends: Ends, at: [f64; 3], radius: f64) -> Vec<f64> {
    let mut squares = vec![0.0];
    for ((low, high), x) in ends.into_iter().zip(at) {
        let mut offsets = vec![0.0];
        if high.is_finite() {
            let period = 2.0 * (high - low);
            // The radius is at most half a period, so that images beyond two periods are farther than two radii.
            for shift in [-2.0, -1.0, 0.0, 1.0, 2.0] {
                offsets.push(2.0 * (low - x) + shift * period);
                if shift != 0.0 {
                    offsets.push(shift * period);
                }
            }
        } else if low.is_finite() {
            offsets.push(2.0 * (low - x));
        }
        squares = squares.iter().flat_map(|s| offsets.iter().map(move |o| s + o * o)).collect();
        squares.retain(|s| *s < 4.0 * radius * radius);
    }
    // The first is the probe itself.
    squares[1..].iter().map(|s| s.sqrt() / radius).collect()
}

/// int K(|y|) K(|y - d|) dy at radius 1, shell by shell about the origin.
fn overlap(rule: &Rule, kernel: Kernel, d: f64) -> f64 {
    if d >= 2.0 {
        return 0.0;
    }
    let shell = |s: f64| s * s * kernel.density(Dimension::Three, s) * cap(rule, kernel, s, d, -1.0);
    let ends = pieces((d - 1.0).max(0.0), 1.0, vec![d, 1.0 - d]);
    2.0 * PI * rule.integrate_pieces(&ends, shell)
}

/// int K(sqrt(s^2 + d^2 + 2 s d c)) dc from `low` to 1: a shell of radius s seen from a point at distance d.
fn cap(rule: &Rule, kernel: Kernel, s: f64, d: f64, low: f64) -> f64 {
    let above = 1.0 - s * s - d * d;
    let high = if above >= 2.0 * s * d { 1.0 } else { above / (2.0 * s * d) };
    if high <= low {
        return 0.0;
    }
    let seen = |c: f64| ((s - d) * (s - d) + 2.0 * s * d * (1.0 + c)).max(0.0).sqrt();
    rule.integrate(low, high, |c| kernel.density(Dimension::Three, seen(c).min(1.0)))
}

/// int over a sphere of radius a of the kernels about a probe at depth h and about its image in the tangent plane.
fn sphere_overlap(rule: &Rule, kernel: Kernel, a: f64, h: f64) -> f64 {
    let distance = a - h;
    if h >= 1.0 {
        return 0.0;
    }
    // c counts from the inward normal; the image lies 2h behind, and the body begins at c = low.
    let low = |s: f64| {
        let above = s * s - h * (a + distance);
        let below = 2.0 * s * distance;
        if above <= -below {
            -1.0
        } else if above >= below {
            1.0
        } else {
            above / below
        }
    };
    let shell = |s: f64| s * s * kernel.density(Dimension::Three, s) * cap(rule, kernel, s, 2.0 * h, low(s));
    // Where the image's ball meets the surface on the shell.
    let meeting = if h > 0.0 && distance > 0.0 {
        let above = (1.0 - 4.0 * h * h) / (4.0 * h) + h * (a + distance) / (2.0 * distance);
        (above / (1.0 / (4.0 * h) + 1.0 / (2.0 * distance))).max(0.0).sqrt()
    } else {
        0.0
    };
    let ends = pieces(0.0, 1.0, vec![(1.0 - 2.0 * h).abs(), 2.0 * h, h, a + distance, meeting]);
    2.0 * PI * rule.integrate_pieces(&ends, shell)
}
