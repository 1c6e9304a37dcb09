//! Volumes of balls cut by a sphere or by a slab: what is left of the uniform kernel's ball inside the medium.
//!
//! A plane at distance x from the centre cuts off the cap (pi/3) (r-x)^2 (2r+x); a ball is cut by two parallel planes or by
//! another ball, whose lens is two caps.
//!
//! Limits: no face within r, the whole ball; the centre on a flat face, half of it.
//!
//! Source: Kern and Bland 1938, for cap and lens.

use crate::error::{Result, within};
use crate::value::Value;
use std::f64::consts::PI;

const LARGEST: f64 = 1e90;

/// Volume common to two balls of radii a and r at distance d of their centres \[length^3\].
///
/// pi (a+r-d)^2 (d^2 + 2d(a+r) - 3(a-r)^2)/(12 d) while they cut each other, the smaller ball inside the larger one,
/// 0 apart.
/// # Errors
/// `Error::OutOfRange` naming `a`, `r` or `distance`
pub fn lens_volume(a: f64, r: f64, distance: f64) -> Result<Value> {
    within("a", a, 0.0, LARGEST, "0 to 1e90")?;
    within("r", r, 0.0, LARGEST, "0 to 1e90")?;
    within("distance", distance, 0.0, LARGEST, "0 to 1e90")?;
    let small = a.min(r);
    let ball = 4.0 / 3.0 * PI * small * small * small;
    let value = if distance >= a + r {
        0.0
    } else if distance <= (a - r).abs() {
        ball
    } else {
        let (overlap, sum, difference) = (a + r - distance, a + r, a - r);
        PI * overlap * overlap * (distance * distance + 2.0 * distance * sum - 3.0 * difference * difference)
            / (12.0 * distance)
    };
    // Near touching from inside, the quotient cancels over the distance; the truth is never above the small ball.
    let spread = if distance > 0.0 { 1.0 + (a.max(r) / distance).min(1e16) } else { 1.0 };
    let edge = 16.0 * f64::EPSILON * PI * small * small * a.max(r) * spread;
    Ok(Value::new(value, edge, "closed form"))
}

/// Volume of a ball of radius r inside the slab 0 <= t <= thickness, its centre at depth h \[length^3\].
///
/// (4/3) pi r^3 less the caps beyond the two faces; the centre may lie outside.
/// # Errors
/// `Error::OutOfRange` naming `r`, `h` or `thickness`
pub fn ball_slab_volume(r: f64, h: f64, thickness: f64) -> Result<Value> {
    within("r", r, 0.0, LARGEST, "0 to 1e90")?;
    within("h", h, -LARGEST, LARGEST, "-1e90 to 1e90")?;
    within("thickness", thickness, 0.0, LARGEST, "0 to 1e90")?;
    let (low, high) = ((-h).max(-r), (thickness - h).min(r));
    let length = high - low;
    if length <= 0.0 {
        return Ok(Value::new(0.0, 8.0 * f64::EPSILON * PI * r * r * (r + thickness), "closed form"));
    }
    // int_low^high pi (r^2 - z^2) dz.
    let value = PI * length * (r * r - (high * high + high * low + low * low) / 3.0);
    // The faces' distances carry a rounding of h and of the thickness.
    let shift = f64::EPSILON * (h.abs() + thickness).min(h.abs() + r + length);
    Ok(Value::new(value.max(0.0), PI * r * r * (8.0 * f64::EPSILON * length + 2.0 * shift), "closed form"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::quadrature::GaussLegendre;
    use proptest::prelude::*;

    #[test]
    fn known_values() {
        assert!(lens_volume(2.0, 0.5, 1.8).unwrap().covers(0.391_259_185_065_829));
        assert!(ball_slab_volume(0.25, 0.05, 0.3).unwrap().covers(0.042_411_500_823_462_2));
        let ball = 4.0 / 3.0 * PI;
        assert!(lens_volume(3.0, 1.0, 2.0).unwrap().covers(ball));
        assert_eq!(lens_volume(3.0, 1.0, 4.0).unwrap().value, 0.0);
        assert!(ball_slab_volume(1.0, 5.0, 9.0).unwrap().covers(ball));
        assert!(ball_slab_volume(1.0, 0.0, 9.0).unwrap().covers(0.5 * ball));
        assert!(lens_volume(1.0, f64::NAN, 0.0).is_err());
    }

    proptest! {
        #![proptest_config(crate::fixed_cases(256))]

        #[test]
        fn volumes_are_integrals_of_discs(a in 0.1..2.0_f64, r in 0.1..2.0_f64, place in 0.0..1.0_f64, t in 0.01..3.0_f64) {
            let rule = GaussLegendre::rule(8);
            // Between the intersection plane and the far ends each cap is a polynomial: exact.
            let (near, far) = ((a - r).abs(), a + r);
            let d = near + (far - near) * (0.01 + 0.98 * place);
            let plane = (d * d + a * a - r * r) / (2.0 * d);
            let want = rule.integrate(d - r, plane, |z| PI * (r * r - (z - d) * (z - d)))
                + rule.integrate(plane, a, |z| PI * (a * a - z * z));
            let got = lens_volume(a, r, d).unwrap();
            prop_assert!((got.value - want).abs() <= got.error + 1e-13 * (1.0 + 1.0 / d), "{got:?} {want}");
            let h = t * (2.0 * place - 0.5);
            let cap = |x: f64| {
                if x >= r { 0.0 } else if x <= -r { 4.0 / 3.0 * PI * r * r * r } else { PI * (r - x) * (r - x) * (2.0 * r + x) / 3.0 }
            };
            let want = 4.0 / 3.0 * PI * r * r * r - cap(h) - cap(t - h);
            let got = ball_slab_volume(r, h, t).unwrap();
            prop_assert!((got.value - want.max(0.0)).abs() <= got.error + 1e-13, "{got:?} {want}");
        }
    }
}
