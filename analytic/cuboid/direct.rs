//! Direct light of a face that sends out radiance 1/pi.

use super::bickley::ki;
use super::body::Body;
use crate::error::Result;
use crate::exponential_integral::e_n;
use crate::quadrature::Adaptive;
use crate::value::Value;
use libm::{atan2, cos};
use std::f64::consts::PI;

const HOW: &str = "direct light, by azimuth about the normal of the face";

/// Fluence at `place` of the face with this normal on the side `far` or at 0.
///
/// Over the rectangle of the face, int e^(-d) dOmega = int [E_2(x) - (x/D) E_2(D)] dphi with x the distance of the face and
/// D(phi) that of its rim; of an endless duct, 2 int Ki_2(x/cos theta) dtheta over the angles of the side.
pub(super) fn face(body: &Body, normal: usize, far: bool, place: [f64; 3]) -> Result<Value> {
    let height = if far { (body.sides[normal] - place[normal]).max(0.0) } else { place[normal] };
    let adaptive = Adaptive::new(1e-14);
    let mut sum = Value::new(0.0, 0.0, HOW);
    let ends = |axis: usize| [place[axis], (body.sides[axis] - place[axis]).max(0.0)];
    if body.endless {
        for end in ends(1 - normal) {
            let part = adaptive.integrate(&[0.0, atan2(end, height)], "Ki_2", HOW, |angle| {
                Ok(2.0 / PI * if height == 0.0 { 1.0 } else { ki(2, height / cos(angle)) })
            })?;
            sum = sum.plus(part, HOW);
        }
        return Ok(sum);
    }
    let [q, r] = [[1, 2], [0, 2], [0, 1]][normal];
    let inner = e_n(2, height);
    for u in ends(q) {
        for v in ends(r) {
            for (near, other) in [(u, v), (v, u)] {
                if near == 0.0 || other == 0.0 {
                    continue;
                }
                let part = adaptive.integrate(&[0.0, atan2(other, near)], "E_2", HOW, |angle| {
                    let rim = near / cos(angle);
                    let slant = (height * height + rim * rim).sqrt();
                    Ok((inner - height / slant * e_n(2, slant)) / PI)
                })?;
                sum = sum.plus(part, HOW);
            }
        }
    }
    Ok(sum)
}

/// The same of all faces.
pub(super) fn faces(body: &Body, place: [f64; 3]) -> Result<Value> {
    let mut sum = Value::new(0.0, 0.0, HOW);
    for normal in 0..body.axes() {
        for far in [false, true] {
            sum = sum.plus(face(body, normal, far, place)?, HOW);
        }
    }
    Ok(sum)
}
