//! A rectangle as it is seen from a point: its solid angle, and points of it that are uniform in solid angle.

use super::Rectangle;
use crate::math::sin_cos;
use glam::DVec3;

/// What a point in front of a rectangle sees of it.
///
/// In axes along the edges, with the point at the origin and the rectangle in the plane at depth h, the part between
/// the near edge x0 and x fills the solid angle Phi(x) - Phi(x0), with
/// Phi(x) = atan(x y1/(h r1)) - atan(x y0/(h r0)), r the distance of the corner: that is asin(a b1) - asin(a b0) with
/// a = x/sqrt(h^2 + x^2) and b = y/sqrt(h^2 + y^2), which can be solved for a. On the line x = const the solid angle is
/// uniform in y/sqrt(h^2 + x^2 + y^2).
///
/// # Limits
/// Phi has an absolute error of some 1e-16, so that very small solid angles have few digits: rectangles that are far away
/// are better sampled by area.
///
/// # Source
/// Urena, Fajardo and King 2013, "An area-preserving parametrization for spherical rectangles"
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SphericalRectangle {
    /// Unit vectors along the edges, and towards the plane.
    axes: [DVec3; 3],
    /// Depth of the plane \[L\], above 0.
    depth: f64,
    x: [f64; 2],
    y: [f64; 2],
    /// Phi at x0 \[sr\].
    before: f64,
    solid_angle: f64,
}

impl SphericalRectangle {
    /// What `p` sees of the front of a rectangle; none from the plane or from behind.
    pub fn new(rectangle: &Rectangle, p: DVec3) -> Option<Self> {
        let depth = rectangle.height(p);
        let (lu, lv) = (rectangle.u().length(), rectangle.v().length());
        let axes = [rectangle.u() / lu, rectangle.v() / lv, -rectangle.normal()];
        let corner = rectangle.corner() - p;
        let (x0, y0) = (corner.dot(axes[0]), corner.dot(axes[1]));
        let (x, y) = ([x0, x0 + lu], [y0, y0 + lv]);
        // Both arc tangents lie within a quarter of a turn: their difference is the argument of a quotient.
        let corner = |x: f64, y: f64| (depth * (x * x + y * y + depth * depth).sqrt(), x * y);
        let phi = |x: f64| {
            let ((re_1, im_1), (re_0, im_0)) = (corner(x, y[1]), corner(x, y[0]));
            libm::atan2(im_1 * re_0 - re_1 * im_0, re_1 * re_0 + im_1 * im_0)
        };
        let before = phi(x[0]);
        let solid_angle = phi(x[1]) - before;
        // Written so that a NaN is refused too.
        (depth > 0.0 && solid_angle > 0.0).then_some(SphericalRectangle {
            axes,
            depth,
            x,
            y,
            before,
            solid_angle,
        })
    }

    /// Solid angle \[sr\].
    pub fn solid_angle(&self) -> f64 {
        self.solid_angle
    }

    /// The way from the point to a point of the rectangle \[L\], uniform in solid angle.
    pub fn sample(&self, [u, v]: [f64; 2]) -> DVec3 {
        let h2 = self.depth * self.depth;
        let [b0, b1] = self.y.map(|y| y / (h2 + y * y).sqrt());
        let phi = self.before + u * self.solid_angle;
        let (half, cosine_of_half) = sin_cos(0.5 * phi);
        let sine = 2.0 * half * cosine_of_half;
        // b0^2 + b1^2 - 2 b0 b1 cos phi
        let norm = ((b1 - b0) * (b1 - b0) + 4.0 * b0 * b1 * half * half).max(0.0).sqrt();
        // Straight ahead both are 0 where sight grazes.
        let a = if sine == 0.0 { 0.0 } else { (sine / norm).clamp(-1.0, 1.0) };
        // At grazing sight rounding may point past the edges: a = 1 is infinitely far.
        let x = (a * self.depth / (1.0 - a * a).sqrt()).clamp(self.x[0], self.x[1]);
        let d2 = h2 + x * x;
        let [c0, c1] = self.y.map(|y| y / (d2 + y * y).sqrt());
        let c = (c0 + v * (c1 - c0)).clamp(-1.0, 1.0);
        let y = (c * (d2 / (1.0 - c * c)).sqrt()).clamp(self.y[0], self.y[1]);
        self.axes[0] * x + self.axes[1] * y + self.axes[2] * self.depth
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rectangle() -> Rectangle {
        let u = DVec3::new(1.0, 2.0, 0.5).normalize() * 1.5;
        let v = u.cross(DVec3::new(0.2, -0.3, 1.0)).normalize() * 0.7;
        Rectangle::new(DVec3::new(0.3, -0.2, 1.0), u, v).unwrap()
    }

    /// Points before it: above the middle, near an edge, beside it, far off, grazing.
    fn points() -> Vec<DVec3> {
        let r = rectangle();
        [(0.5, 0.5, 0.3), (0.01, 0.4, 0.05), (1.7, -0.8, 0.4), (0.3, 2.0, 8.0), (1.2, 0.5, 0.01)]
            .into_iter()
            .map(|(a, b, height)| r.sample([a, b]) + r.normal() * height)
            .collect()
    }

    /// The integral of cos/d^2 over the area; the midpoint rule's error is below h^2/24 of the second derivatives, tested
    /// by halving.
    #[test]
    fn solid_angle_is_the_integral_over_the_area() {
        let r = rectangle();
        for p in points() {
            let midpoints = |n: u32| {
                let at = |i: u32| (f64::from(i) + 0.5) / f64::from(n);
                let element = |i: u32, j: u32| {
                    let way = r.sample([at(i), at(j)]) - p;
                    -way.dot(r.normal()) / way.length().powi(3) * r.area() / f64::from(n * n)
                };
                (0..n).flat_map(|i| (0..n).map(move |j| (i, j))).map(|(i, j)| element(i, j)).sum::<f64>()
            };
            let (coarse, fine) = (midpoints(400), midpoints(800));
            let found = SphericalRectangle::new(&r, p).unwrap().solid_angle();
            let error = (fine - coarse).abs() + 1e-9 * fine;
            assert!((found - fine).abs() <= error, "{found} {fine} +- {error}");
        }
    }

    /// The density of sampled points times the solid angle is cos/d^2: by central differences, exact to h^2.
    #[test]
    fn samples_are_uniform_in_solid_angle() {
        let r = rectangle();
        for p in points() {
            let seen = SphericalRectangle::new(&r, p).unwrap();
            for (u, v) in [(0.1, 0.2), (0.5, 0.5), (0.93, 0.4), (0.3, 0.97), (0.01, 0.99)] {
                let h = 1e-5;
                let slope = |a: [f64; 2], b: [f64; 2]| (seen.sample(a) - seen.sample(b)) / (2.0 * h);
                let along = slope([u + h, v], [u - h, v]);
                let across = slope([u, v + h], [u, v - h]);
                let way = seen.sample([u, v]);
                let cosine_by_d2 = -way.dot(r.normal()) / way.length().powi(3);
                let found = along.cross(across).length() * cosine_by_d2;
                // Third derivatives are of order 1/u^3 near an end of the unit square.
                assert!((found / seen.solid_angle() - 1.0).abs() < 1e-5, "{p} {u} {v}: {found}");
            }
        }
    }

    #[test]
    fn samples_lie_on_the_rectangle() {
        let r = rectangle();
        for height in [1e-12, 1e-6, 1e-3, 1.0, 40.0] {
            for (a, b) in [(0.5, 0.5), (0.0, 0.3), (-0.1, 1.4), (3.0, -3.0), (1.0, 1.0)] {
                let p = r.sample([a, b]) + r.normal() * height;
                let Some(seen) = SphericalRectangle::new(&r, p) else { continue };
                assert!(seen.solid_angle() < 2.0 * std::f64::consts::PI);
                for u in [0.0, 1e-9, 0.3, 0.999_999, 1.0 - f64::EPSILON] {
                    for v in [0.0, 0.5, 1.0 - f64::EPSILON] {
                        let point = p + seen.sample([u, v]);
                        assert!(point.is_finite() && r.inside(point) > -1e-12, "{height} {a} {b} {u} {v}");
                        assert!(r.height(point).abs() < 1e-12);
                    }
                }
            }
        }
    }

    #[test]
    fn nothing_is_seen_from_behind() {
        let r = rectangle();
        assert!(SphericalRectangle::new(&r, r.sample([0.5, 0.5]) - r.normal()).is_none());
        assert!(SphericalRectangle::new(&r, r.sample([2.0, 0.5])).is_none());
        assert!(SphericalRectangle::new(&r, DVec3::NAN).is_none());
    }
}
