//! Moments of a kernel in the part of its ball that lies in a body.

use super::solid::{Along, SPHERE, cap, pair, triple};
use crate::estimators::Kernel;
use crate::geometry::{Face, Shape, Sphere};
use glam::DVec3;

/// M_j = int_O K_r(y - x) z^j dy for j = 0, 1, 2, with z = (y - x) . n / r and n the unit normal, inwards, at the
/// nearest point of the boundary.
///
/// Shell by shell: the part of a sphere about x that is inside a slab, a cuboid or a sphere, and its moments, are
/// known in closed form; the sum over shells is a Gauss rule between the radii at which a face, an edge or a corner
/// comes in.
///
/// # Arguments
/// `body` a slab, sphere or cuboid; `point` inside or on its boundary; `radius` \[L\], above 0
/// # Returns
/// \[1\], \[1, 0, m2/3\] exactly for a whole ball. Absolute error below 1e-13 in slabs and spheres, where the
/// rule is exact but for the Gaussian kernel, 1e-8 where an edge of a cuboid is in the ball (by cutting it into
/// pieces), 1e-3 of themselves in a cuboid within a thousandth of the radius
/// # Limits
/// a shape that is not solid has no inside: all moments are 0
pub fn body_moments(kernel: Kernel, body: &Shape, point: DVec3, radius: f64) -> [f64; 3] {
    if body.room(point) >= radius && body.is_solid() {
        return [1.0, 0.0, kernel.m2() / 3.0];
    }
    let scaled = |distance: f64| distance.max(0.0) / radius;
    match body {
        Shape::Rectangle(_) | Shape::Mesh(_) | Shape::Revolution(_) => [0.0; 3],
        Shape::Sphere(sphere) => in_sphere(kernel, sphere, point, radius),
        Shape::Slab(slab) => {
            let z = [point.z - slab.top(), slab.face(Face::Bottom) - point.z];
            let far = [f64::INFINITY; 2];
            Corner::new([far, far, z.map(scaled)]).moments(kernel)
        }
        Shape::Cuboid(cuboid) => {
            let (low, high) = (point - cuboid.min(), cuboid.max() - point);
            Corner::new([0, 1, 2].map(|i| [low[i], high[i]].map(scaled))).moments(kernel)
        }
    }
}

/// The least part that is told from none: the absolute error of [`body_moments`]. Bodies thinner than this part of the radius
/// hold no photons but by chance.
pub(super) const LEAST_PART: f64 = 1e-13;

/// The least part whose digits are known: less than that of the smallest body in the largest ball that scenes hold.
pub(super) const LEAST_OF_ALL: f64 = 1e-200;

/// A box whose faces are all nearer than this part of the radius is read as if the kernel were everywhere as in its middle: what its
/// shells make of it would be lost in their rounding.
const SMALL: f64 = 1e-3;

/// M_0 alone, sooner known where one flat face is in the ball; where it may be lost in rounding at least [`LEAST_PART`], since it divides.
pub(in crate::estimators) fn body_part(kernel: Kernel, body: &Shape, point: DVec3, radius: f64) -> f64 {
    let face = |distances: &[f64]| {
        let mut near = distances.iter().filter(|distance| **distance < radius);
        near.next().filter(|_| near.next().is_none()).copied()
    };
    let only = match body {
        Shape::Slab(slab) => face(&[point.z - slab.top(), slab.face(Face::Bottom) - point.z]),
        Shape::Cuboid(cuboid) => {
            let (low, high) = (point - cuboid.min(), cuboid.max() - point);
            face(&[low.x, low.y, low.z, high.x, high.y, high.z])
        }
        _ => None,
    };
    let part = match only {
        Some(distance) => 1.0 - kernel.beyond_plane(distance.max(0.0) / radius),
        None => body_moments(kernel, body, point, radius)[0],
    };
    let is_known = match body {
        Shape::Sphere(_) => true,
        Shape::Cuboid(cuboid) => {
            (point - cuboid.min()).max(cuboid.max() - point).max_element() < SMALL * radius
        }
        _ => false,
    };
    part.max(if is_known { LEAST_OF_ALL } else { LEAST_PART })
}

/// The unit normal, inwards, at the point of the boundary that is nearest to a point inside; any one of several.
pub(super) fn inward_normal(body: &Shape, point: DVec3) -> DVec3 {
    let nearer = |low: f64, high: f64, axis: DVec3| if low <= high { axis } else { -axis };
    match body {
        Shape::Sphere(sphere) => (sphere.center() - point).try_normalize().unwrap_or(DVec3::Z),
        Shape::Slab(slab) => nearer(point.z - slab.top(), slab.face(Face::Bottom) - point.z, DVec3::Z),
        Shape::Cuboid(cuboid) => {
            let (low, high) = (point - cuboid.min(), cuboid.max() - point);
            let axis = low.min(high).min_position();
            nearer(low[axis], high[axis], DVec3::AXES[axis])
        }
        Shape::Rectangle(rectangle) => rectangle.normal(),
        // Not solid: no treatment of a boundary asks them.
        Shape::Mesh(_) | Shape::Revolution(_) => DVec3::Z,
    }
}

fn in_sphere(kernel: Kernel, sphere: &Sphere, point: DVec3, radius: f64) -> [f64; 3] {
    let (a, from_center) = (sphere.radius() / radius, point.distance(sphere.center()) / radius);
    // Of a shell, the directions whose cosine to the outward radius is below this are inside.
    let limit = |s: f64| {
        let c = (a - from_center) * (a + from_center) - s * s;
        if from_center * s > 0.0 { (0.5 * c / (from_center * s)).clamp(-1.0, 1.0) } else { c.signum() }
    };
    sum_shells(kernel, &[(a - from_center).max(0.0), a + from_center], |s| {
        let c = limit(s);
        let third = std::f64::consts::TAU / 3.0;
        [3.0 * third * (1.0 + c), 1.5 * third * (1.0 - c) * (1.0 + c), third * (1.0 + c * c * c)]
    })
}

/// The faces about a point of a box, as far as they are in the ball: distances over the radius.
struct Corner {
    /// Below and above the point, along each axis; the first axis is that of the nearest face.
    distances: [[f64; 2]; 3],
}

impl Corner {
    /// Turns the box so that the nearest face is below the point on the first axis.
    fn new(mut distances: [[f64; 2]; 3]) -> Self {
        let least = |pair: [f64; 2]| pair[0].min(pair[1]);
        let nearest =
            (0..3).fold(0, |best, i| if least(distances[i]) < least(distances[best]) { i } else { best });
        distances.swap(0, nearest);
        if distances[0][0] > distances[0][1] {
            distances[0].reverse();
        }
        Corner { distances }
    }

    fn moments(&self, kernel: Kernel) -> [f64; 3] {
        let [[low, high], ..] = self.distances;
        if self.distances.as_flattened().iter().all(|&d| d < SMALL) {
            let part = kernel.peak() * self.distances.iter().map(|[low, high]| low + high).product::<f64>();
            return [part, part * 0.5 * (high - low), part * (high * high - high * low + low * low) / 3.0];
        }
        let mut breaks = Vec::with_capacity(8);
        self.parts(|x, others| {
            let all = x.map_or(0.0, |(d, _)| d * d) + others.iter().map(|d| d * d).sum::<f64>();
            breaks.push(all.sqrt());
        });
        sum_shells(kernel, &breaks, |s| {
            let mut inside = SPHERE;
            self.parts(|x, others| {
                // Parts that several faces cut off are counted with alternating sign.
                let faces = others.len() + usize::from(x.is_some());
                let sign = if faces == 2 { 1.0 } else { -1.0 };
                let (part, side) = match (x, others) {
                    (Some((a, side)), []) => (cap(a / s), side),
                    (Some((a, side)), &[b]) => (pair(a / s, b / s), side),
                    (Some((a, side)), &[b, c]) => (triple(a / s, b / s, c / s), side),
                    (None, &[b]) => (beside(cap(b / s)), 0.0),
                    (None, &[b, c]) => {
                        let (over_b, over_c) = (pair(b / s, c / s), pair(c / s, b / s));
                        ([over_b[0], 0.0, over_b[0] - over_b[2] - over_c[2]], 0.0)
                    }
                    _ => ([0.0; 3], 0.0),
                };
                for (sum, (part, side)) in inside.iter_mut().zip(part.into_iter().zip([1.0, side, 1.0])) {
                    *sum += sign * side * part;
                }
            });
            inside
        })
    }

    /// Every set of faces, no two of them opposite, that the ball may meet together: distance and side of the one on
    /// the first axis, distances of the others.
    fn parts(&self, mut visit: impl FnMut(Option<(f64, f64)>, &[f64])) {
        let [first, second, third] = self.distances;
        let near = |d: f64| d < 1.0;
        for x in [None, Some((first[0], -1.0)), Some((first[1], 1.0))] {
            if x.is_some_and(|(d, _)| !near(d)) {
                continue;
            }
            if x.is_some() {
                visit(x, &[]);
            }
            for b in second.into_iter().filter(|&d| near(d)) {
                visit(x, &[b]);
                for c in third.into_iter().filter(|&d| near(d)) {
                    visit(x, &[b, c]);
                }
            }
            for c in third.into_iter().filter(|&d| near(d)) {
                visit(x, &[c]);
            }
        }
    }
}

/// A cap's moments along an axis across its own.
fn beside(cap: Along) -> Along {
    [cap[0], 0.0, 0.5 * (cap[0] - cap[2])]
}

/// Nodes in (0, 1) and weights of Gauss's rule of 16 nodes on [-1, 1] (Abramowitz and Stegun, table 25.4).
const RULE: [(f64, f64); 8] = [
    (0.095_012_509_837_637_44, 0.189_450_610_455_068_5),
    (0.281_603_550_779_258_9, 0.182_603_415_044_923_6),
    (0.458_016_777_657_227_4, 0.169_156_519_395_002_5),
    (0.617_876_244_402_643_7, 0.149_595_988_816_576_7),
    (0.755_404_408_355_003, 0.124_628_971_255_533_9),
    (0.865_631_202_387_831_7, 0.095_158_511_682_492_8),
    (0.944_575_023_073_232_6, 0.062_253_523_938_647_9),
    (0.989_400_934_991_649_9, 0.027_152_459_411_754_1),
];

/// int_0^1 s^2 K(s) s^j shell_j(s) ds, the kernel of radius 1.
///
/// Panels end at the `breaks`. There a part begins or ends like a power 3/2, which the substitution s = a + (b-a) t^2 (3-2t)
/// makes smooth enough for the rule; it leaves polynomials of degree 9 exact, and 1e-15 of a Gaussian on half the radius.
fn sum_shells(kernel: Kernel, breaks: &[f64], shell: impl Fn(f64) -> Along) -> [f64; 3] {
    let mut ends = Vec::with_capacity(breaks.len() + 3);
    ends.extend([0.0, 1.0]);
    if kernel == Kernel::Gaussian {
        ends.push(0.5);
    }
    ends.extend(breaks.iter().copied().filter(|&s| 0.0 < s && s < 1.0));
    ends.sort_by(f64::total_cmp);
    let mut sums = [0.0; 3];
    for pair in ends.windows(2).filter(|pair| pair[0] < pair[1]) {
        let length = pair[1] - pair[0];
        for (node, weight) in RULE.iter().flat_map(|&(x, w)| [(x, w), (-x, w)]) {
            let t = 0.5 * (1.0 + node);
            let s = pair[0] + length * t * t * (3.0 - 2.0 * t);
            let stretched = 3.0 * length * t * (1.0 - t) * weight;
            let mut power = stretched * s * s * kernel.peak() * kernel.profile(s * s);
            for (sum, moment) in sums.iter_mut().zip(shell(s)) {
                *sum += power * moment;
                power *= s;
            }
        }
    }
    sums
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Cuboid, Slab};
    use crate::rng::{Purpose, Stream};

    /// One face or several in the ball.
    #[test]
    fn parts_are_the_first_moment() {
        let mut stream = Stream::new(2, Purpose::Synthetic, 0, 0);
        let shapes = [
            Shape::Cuboid(Cuboid::new(DVec3::ZERO, DVec3::new(1.0, 0.7, 1.3)).unwrap()),
            Shape::Slab(Slab::new(0.0, 0.8).unwrap()),
        ];
        for shape in &shapes {
            for kernel in Kernel::ALL {
                for _ in 0..200 {
                    let point = DVec3::from(stream.triple()) * 0.7;
                    let radius = stream.unit();
                    let (part, all) = (
                        body_part(kernel, shape, point, radius),
                        body_moments(kernel, shape, point, radius)[0],
                    );
                    assert!((part - all).abs() < 1e-13, "{kernel:?} {point} {radius}: {part}, not {all}");
                }
            }
        }
    }

    /// A body within a ball is told by its volume and, along the normal, by the distances of its faces, however large the ball is.
    #[test]
    fn bodies_far_within_the_ball() {
        let cuboid = Cuboid::new(DVec3::ZERO, DVec3::new(1.0, 0.7, 1.3)).unwrap();
        let sphere = Sphere::new(DVec3::ZERO, 0.8).unwrap();
        let point = DVec3::new(0.2, 0.3, 0.4);
        let [volume, from] = [4.0 / 3.0 * std::f64::consts::PI * 0.512, 0.8 - point.length()];
        // A box by its formula, a ball by a rule of 16 nodes on the part of a shell that is a few roundings.
        for (shape, volume, first, second, tolerance) in [
            (Shape::Cuboid(cuboid), 0.91, 0.3, (0.512 + 0.008) / 3.0, 1e-12),
            (Shape::Sphere(sphere), volume, 0.8 - from, (0.8 - from).powi(2) + 0.128, 1e-9),
        ] {
            for kernel in Kernel::ALL {
                for radius in [1e3, 2e4, 1e9, 1e30] {
                    let part = kernel.peak() * volume / (radius * radius * radius);
                    let expected = [part, part * first / radius, part * second / (radius * radius)];
                    let found = body_moments(kernel, &shape, point, radius);
                    // Weights fall by up to the distance over the radius, to 1.
                    let profile = if kernel == Kernel::Uniform { 1e-12 } else { 2.0 / radius };
                    for (found, expected) in found.into_iter().zip(expected) {
                        let off = (found / expected - 1.0).abs();
                        assert!(
                            off < tolerance + profile,
                            "{kernel:?} {radius} {shape:?}: {found}, not {expected}"
                        );
                    }
                    let off = (body_part(kernel, &shape, point, radius) / part - 1.0).abs();
                    assert!(off < tolerance + profile, "{kernel:?} {radius}");
                }
            }
        }
    }
}
