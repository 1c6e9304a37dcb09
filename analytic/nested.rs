//! Light of a source in one cuboid, uncollided, through cuboids of other extinctions.
//!
//! phi(r) = (1/4 pi) int dOmega int q e^(-tau(s)) ds over the rays from r: in closed form along each of them, piece by piece, and by
//! Gauss rules over the directions, by slopes u, v on the faces of a cube about r. Edges of cuboids are seen there as straight
//! lines, at which the panels end.

use crate::error::{Error, Result, within};
use crate::quadrature::GaussLegendre;
use crate::value::Value;
use libm::{exp, expm1};
use std::f64::consts::PI;

const HOW: &str = "uncollided along rays, directions between edges by two rules";

/// Nodes of a panel in one round after another, until two agree.
const ORDERS: [usize; 5] = [4, 6, 9, 14, 21];

/// Rules that differ by more of the value than this have not begun to converge, and their difference bounds nothing.
const WORST: f64 = 1e-2;

/// Cuboids of a medium, and the one that emits.
#[derive(Debug, Clone)]
pub struct NestedCuboids {
    boxes: Vec<Block>,
    sources: Vec<[[f64; 2]; 3]>,
}

/// A cuboid by its extent along each axis, with its extinction.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Block {
    extent: [[f64; 2]; 3],
    extinction: f64,
}

impl NestedCuboids {
    /// Cuboids by extents along the axes and extinction, the later one counts, and the extent of a source of unit power per volume. At
    /// x, y or z = 0 there may be a mirror.
    ///
    /// # Errors
    /// `Error::OutOfRange` unless extents rise, extinctions are 0 to 1e6 per length, and nothing lies behind a mirror;
    /// `Error::Infinite` without a source of some volume
    /// # Limits
    /// no extinction: the solid angle's integral, (1/4 pi) int dV/d^2
    /// # Source
    /// Kobayashi, Sugimura and Nagaya 2000 (OECD/NEA), case i
    pub fn new(cuboids: &[([[f64; 2]; 3], f64)], source: [[f64; 2]; 3], mirrors: [bool; 3]) -> Result<Self> {
        let check = |extent: &[[f64; 2]; 3]| -> Result<()> {
            for (axis, [low, high]) in extent.iter().enumerate() {
                let least = if mirrors[axis] { 0.0 } else { -1e9 };
                let allowed = if mirrors[axis] { "0 (the mirror) to 1e9" } else { "-1e9 to 1e9" };
                within("lower end of an extent", *low, least, 1e9, allowed)?;
                within("upper end of an extent", *high, *low, 1e9, "the lower end to 1e9")?;
            }
            Ok(())
        };
        check(&source)?;
        if source.iter().any(|[low, high]| high <= low) {
            return Err(Error::Infinite("the source has no volume; allowed: extents that rise"));
        }
        let mut boxes = Vec::new();
        for (extent, extinction) in cuboids {
            check(extent)?;
            within("extinction", *extinction, 0.0, 1e6, "0 to 1e6 per length")?;
            boxes.extend(
                images(*extent, mirrors).into_iter().map(|extent| Block { extent, extinction: *extinction }),
            );
        }
        Ok(NestedCuboids { boxes, sources: images(source, mirrors) })
    }

    /// Fluence of the uncollided light at a place.
    pub fn fluence(&self, place: [f64; 3]) -> Result<Value> {
        for (name, at) in ["x", "y", "z"].into_iter().zip(place) {
            within(name, at, -1e9, 1e9, "-1e9 to 1e9")?;
        }
        let mut sum = Value::new(0.0, 0.0, HOW);
        for axis in 0..3 {
            for sign in [-1.0, 1.0] {
                sum = sum.plus(self.towards(axis, sign, place)?, HOW);
            }
        }
        Ok(sum.scaled(0.25 / PI))
    }

    /// Directions nearest to one half-axis: slopes u and v of the other two within -1 to 1, over those that meet the source.
    fn towards(&self, axis: usize, sign: f64, place: [f64; 3]) -> Result<Value> {
        let [q, r] = [[1, 2], [0, 2], [0, 1]][axis];
        let seen = |extent: &[[f64; 2]; 3]| {
            let mut seen = [0, 1, 2].map(|i| [extent[i][0] - place[i], extent[i][1] - place[i]]);
            if sign < 0.0 {
                seen[axis] = [-seen[axis][1], -seen[axis][0]];
            }
            seen
        };
        let (mut in_q, mut in_r) = ([1.0_f64, -1.0_f64], [1.0_f64, -1.0_f64]);
        for source in &self.sources {
            let [high, low] = [seen(source)[axis][1], seen(source)[axis][0].max(0.0)];
            if high <= 0.0 {
                continue;
            }
            for (window, side) in [(&mut in_q, q), (&mut in_r, r)] {
                for along in [low, high] {
                    for at in seen(source)[side] {
                        let slope = if at == 0.0 { 0.0 } else { (at / along).clamp(-1.0, 1.0) };
                        *window = [window[0].min(slope), window[1].max(slope)];
                    }
                }
            }
        }
        if in_q[0] >= in_q[1] || in_r[0] >= in_r[1] {
            return Ok(Value::new(0.0, 0.0, HOW));
        }
        // Edges: across q at a slope u, across r at a slope v, along the axis at a ratio v/u.
        let (mut us, mut vs, mut ratios) = (in_q.to_vec(), in_r.to_vec(), Vec::new());
        for extent in self.boxes.iter().map(|b| &b.extent).chain(&self.sources) {
            let edges = seen(extent);
            for (side, slopes) in [(q, &mut us), (r, &mut vs)] {
                for at in edges[side] {
                    slopes.extend(edges[axis].iter().filter(|&&along| along > 0.0).map(|along| at / along));
                }
            }
            for at_q in edges[q].into_iter().filter(|&at| at != 0.0) {
                ratios.extend(edges[r].iter().map(|at| at / at_q));
            }
        }
        let breaks = |slopes: &mut Vec<f64>, window: [f64; 2]| {
            slopes.retain(|slope| (window[0]..=window[1]).contains(slope));
            slopes.sort_by(f64::total_cmp);
            slopes.dedup_by(|a, b| *a - *b < 1e-13);
        };
        us.extend(
            ratios.iter().flat_map(|ratio| vs.iter().map(move |v| v / ratio)).filter(|u| u.is_finite()),
        );
        breaks(&mut us, in_q);
        let by = |rule: &GaussLegendre| -> f64 {
            let across = |u: f64| {
                let mut stops = vs.clone();
                stops.extend(ratios.iter().map(|ratio| ratio * u));
                breaks(&mut stops, in_r);
                let along = |v: f64| {
                    let mut direction = [sign; 3];
                    (direction[q], direction[r]) = (u, v);
                    let square = 1.0 + u * u + v * v;
                    let step = square.sqrt();
                    self.emitted(place, direction, step) / (square * step)
                };
                stops.windows(2).map(|pair| rule.integrate(pair[0], pair[1], along)).sum()
            };
            us.windows(2).map(|pair| rule.integrate(pair[0], pair[1], across)).sum()
        };
        // Smooth on every panel: what a rule of half the nodes leaves is far above what the last one does.
        let mut rough = by(&GaussLegendre::rule(ORDERS[0]));
        let mut error = f64::INFINITY;
        for order in &ORDERS[1..] {
            let fine = by(&GaussLegendre::rule(*order));
            (error, rough) = ((fine - rough).abs(), fine);
            if error <= 1e-7 * fine {
                break;
            }
        }
        if error > WORST * rough {
            let allowed = "at most 1e-2: the source is too thin for a place so close to it";
            return Err(Error::OutOfRange { name: "relative bound", value: error / rough, allowed });
        }
        Ok(Value::new(rough, 2.0 * error + 64.0 * f64::EPSILON * rough, HOW))
    }

    /// int q e^(-tau) ds along a ray, in steps of this length.
    fn emitted(&self, place: [f64; 3], direction: [f64; 3], step: f64) -> f64 {
        let spans = |extent: &[[f64; 2]; 3]| span(extent, place, direction);
        let boxes: Vec<Option<[f64; 2]>> = self.boxes.iter().map(|b| spans(&b.extent)).collect();
        let sources: Vec<[f64; 2]> = self.sources.iter().filter_map(spans).collect();
        let last = sources.iter().map(|span| span[1]).fold(0.0, f64::max);
        let mut stops: Vec<f64> = boxes.iter().flatten().chain(&sources).flatten().copied().collect();
        stops.push(0.0);
        stops.retain(|&s| s <= last);
        stops.sort_by(f64::total_cmp);
        let (mut tau, mut sum) = (0.0, 0.0);
        for pair in stops.windows(2).filter(|pair| pair[1] > pair[0]) {
            let (middle, length) = (0.5 * (pair[0] + pair[1]), step * (pair[1] - pair[0]));
            let within = |span: &[f64; 2]| span[0] < middle && middle < span[1];
            let here = boxes.iter().rposition(|b| b.is_some_and(|span| within(&span)));
            let depth = length * here.map_or(0.0, |i| self.boxes[i].extinction);
            if sources.iter().any(within) {
                let fading = if depth == 0.0 { 1.0 } else { -expm1(-depth) / depth };
                sum += exp(-tau) * length * fading;
            }
            tau += depth;
        }
        sum
    }
}

/// The cuboid and its mirror images; what touches a mirror is one with its image.
fn images(extent: [[f64; 2]; 3], mirrors: [bool; 3]) -> Vec<[[f64; 2]; 3]> {
    let mut all = vec![extent];
    for axis in (0..3).filter(|&axis| mirrors[axis]) {
        let [low, high] = extent[axis];
        if low == 0.0 {
            all.iter_mut().for_each(|image| image[axis] = [-high, high]);
        } else {
            let mut behind = all.clone();
            behind.iter_mut().for_each(|image| image[axis] = [-high, -low]);
            all.extend(behind);
        }
    }
    all
}

/// Where a ray is in a cuboid, forwards of its origin.
fn span(extent: &[[f64; 2]; 3], place: [f64; 3], direction: [f64; 3]) -> Option<[f64; 2]> {
    let (mut enter, mut leave) = (0.0_f64, f64::INFINITY);
    for axis in 0..3 {
        let [low, high] = [extent[axis][0] - place[axis], extent[axis][1] - place[axis]];
        if direction[axis] == 0.0 {
            if low > 0.0 || high < 0.0 {
                return None;
            }
            continue;
        }
        let (a, b) = (low / direction[axis], high / direction[axis]);
        (enter, leave) = (enter.max(a.min(b)), leave.min(a.max(b)));
    }
    (enter < leave).then_some([enter, leave])
}

#[cfg(test)]
mod tests {
    use super::*;

    const SOURCE: [[f64; 2]; 3] = [[0.0, 10.0]; 3];

    /// The three geometries of Kobayashi: shield, void, source.
    fn kobayashi(problem: usize) -> NestedCuboids {
        let (dense, void) = (0.1, 1e-4);
        let mut cuboids: Vec<([[f64; 2]; 3], f64)> = match problem {
            1 => vec![([[0.0, 100.0]; 3], dense), ([[0.0, 50.0]; 3], void)],
            2 => vec![
                ([[0.0, 60.0], [0.0, 100.0], [0.0, 60.0]], dense),
                ([[0.0, 10.0], [0.0, 100.0], [0.0, 10.0]], void),
            ],
            _ => vec![
                ([[0.0, 60.0], [0.0, 100.0], [0.0, 60.0]], dense),
                ([[0.0, 10.0], [0.0, 60.0], [0.0, 10.0]], void),
                ([[10.0, 40.0], [50.0, 60.0], [0.0, 10.0]], void),
                ([[30.0, 40.0], [50.0, 60.0], [10.0, 40.0]], void),
                ([[30.0, 40.0], [60.0, 100.0], [30.0, 40.0]], void),
            ],
        };
        cuboids.push((SOURCE, dense));
        NestedCuboids::new(&cuboids, SOURCE, [true; 3]).unwrap()
    }

    /// The other order: over the volume of the sources, each cut in `cuts` along every axis.
    fn over_the_volume(problem: &NestedCuboids, place: [f64; 3], cuts: usize) -> f64 {
        let rule = GaussLegendre::rule(4);
        let nodes = |[low, high]: [f64; 2]| -> Vec<(f64, f64)> {
            let length = (high - low) / cuts as f64;
            let of_cut = |cut: usize| {
                let start = low + length * cut as f64;
                rule.nodes.iter().zip(&rule.weights).map(move |(x, w)| (start + length * x, length * w))
            };
            (0..cuts).flat_map(of_cut).collect()
        };
        let mut sum = 0.0;
        for source in &problem.sources {
            for &(x, wx) in &nodes(source[0]) {
                for &(y, wy) in &nodes(source[1]) {
                    for &(z, wz) in &nodes(source[2]) {
                        let direction = [x - place[0], y - place[1], z - place[2]];
                        let square: f64 = direction.iter().map(|d| d * d).sum();
                        let depth = depth_to(problem, place, direction);
                        sum += wx * wy * wz * exp(-depth) / (4.0 * PI * square);
                    }
                }
            }
        }
        sum
    }

    /// Optical depth of the whole step, cuboid over cuboid.
    fn depth_to(problem: &NestedCuboids, place: [f64; 3], step: [f64; 3]) -> f64 {
        let mut stops = vec![0.0, 1.0];
        let spans: Vec<_> = problem.boxes.iter().map(|b| (b, span(&b.extent, place, step))).collect();
        stops.extend(spans.iter().filter_map(|(_, span)| *span).flatten().filter(|&s| s < 1.0));
        stops.sort_by(f64::total_cmp);
        let length = step.iter().map(|d| d * d).sum::<f64>().sqrt();
        let part = |pair: &[f64]| {
            let middle = 0.5 * (pair[0] + pair[1]);
            let inside = |s: [f64; 2]| s[0] < middle && middle < s[1];
            let here = spans.iter().rev().find(|(_, span)| span.is_some_and(inside));
            here.map_or(0.0, |(b, _)| b.extinction) * length * (pair[1] - pair[0])
        };
        stops.windows(2).map(part).sum()
    }

    #[test]
    fn two_orders_of_integration_agree() {
        let places =
            [(1, [15.0, 55.0, 5.0]), (2, [5.0, 45.0, 5.0]), (2, [25.0, 95.0, 35.0]), (3, [35.0, 75.0, 35.0])];
        for (number, place) in places {
            let problem = kobayashi(number);
            let value = problem.fluence(place).unwrap();
            let [rough, fine] = [4, 8].map(|cuts| over_the_volume(&problem, place, cuts));
            // Kinks: the error falls with the square of the panel, so that the step is three times what is left.
            let allowed = (fine - rough).abs() + value.error;
            assert!((value.value - fine).abs() <= allowed, "{number} {place:?}: {value:?} {fine:e}");
            assert!(
                allowed < 5e-3 * fine && value.error < 1e-5 * value.value,
                "{place:?}: {value:?} {allowed:e}"
            );
        }
    }

    /// One cuboid: the even source of the cuboid of isotropic scattering, without scattering.
    #[test]
    fn one_cuboid_is_the_cuboid() {
        let extent = [[0.0, 2.0], [1.0, 2.0], [-1.0, 2.0]];
        let nested = NestedCuboids::new(&[(extent, 1.0)], extent, [false; 3]).unwrap();
        let cuboid = crate::Cuboid::new([2.0, 1.0, 3.0], 0.0, crate::CuboidSource::Uniform).unwrap();
        for place in [[1.0, 1.5, 0.5], [0.1, 1.2, 1.9], [0.0, 1.5, 2.0]] {
            let value = nested.fluence(place).unwrap();
            let other = cuboid.fluence([place[0], place[1] - 1.0, place[2] + 1.0]).unwrap().scaled(6.0);
            assert!((value.value - other.value).abs() <= value.error + other.error, "{value:?} {other:?}");
            assert!(value.error < 1e-5 * value.value, "{value:?}");
        }
        // Extinction elsewhere shades only what is behind it.
        let screen = [[3.0, 3.5], [0.0, 5.0], [-5.0, 5.0]];
        let shaded = NestedCuboids::new(&[(extent, 1.0), (screen, 2.0)], extent, [false; 3]).unwrap();
        let (before, behind) = ([2.5, 1.5, 0.5], [4.0, 1.5, 0.5]);
        let ratio = |at| shaded.fluence(at).unwrap().value / nested.fluence(at).unwrap().value;
        assert!((ratio(before) - 1.0).abs() < 1e-5, "{}", ratio(before));
        // At least the normal depth of 1.
        assert!(ratio(behind) < exp(-1.0) && ratio(behind) > 0.5 * exp(-1.0), "{}", ratio(behind));
    }

    /// A mirror is the other half.
    #[test]
    fn mirrors_are_images() {
        let (inner, outer) = ([[1.0, 2.0], [0.0, 1.0], [0.0, 1.0]], [[0.0, 3.0]; 3]);
        let half = NestedCuboids::new(&[(outer, 0.5), (inner, 2.0)], inner, [true, false, false]).unwrap();
        let image = [[-2.0, -1.0], [0.0, 1.0], [0.0, 1.0]];
        let medium = [([[-3.0, 3.0], [0.0, 3.0], [0.0, 3.0]], 0.5), (inner, 2.0), (image, 2.0)];
        let parts = [inner, image].map(|source| NestedCuboids::new(&medium, source, [false; 3]).unwrap());
        let place = [0.3, 2.0, 0.7];
        let (one, two) = (half.fluence(place).unwrap(), parts.map(|part| part.fluence(place).unwrap()));
        let error = one.error + two[0].error + two[1].error;
        assert!((one.value - two[0].value - two[1].value).abs() <= error, "{one:?} {two:?}");
        for (extent, part) in
            [([[-1.0, 1.0], [0.0, 1.0], [0.0, 1.0]], "0 (the mirror)"), ([[1.0, 0.0]; 3], "upper end")]
        {
            let error = NestedCuboids::new(&[(extent, 1.0)], inner, [true; 3]).unwrap_err().to_string();
            assert!(error.contains(part), "{error}");
        }
        assert!(NestedCuboids::new(&[(outer, -1.0)], inner, [true; 3]).is_err());
        assert!(NestedCuboids::new(&[], [[0.0, 1.0], [0.0, 0.0], [0.0, 1.0]], [true; 3]).is_err());
    }
}
