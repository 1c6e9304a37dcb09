//! Polygons in triangles.

use glam::{DVec2, DVec3};

/// Turns below this part of the product of two sides are rounding.
const STRAIGHT: f64 = 1e-9;

/// What reaches no farther across than this part of its length is a line but for rounding, as of single precision.
const THIN: f64 = 1e-6;

/// A polygon that is not convex has no more corners: each of its triangles is tried against all of them.
const MOST: usize = 16384;

/// Cuts a polygon into triangles of its own sense of rotation; some may have no area.
///
/// # Arguments
/// `at` says where a corner is
/// # Errors
/// what is wrong with a polygon whose sides cross, or that is not convex and has too many corners
pub(super) fn cut<T: Copy>(
    corners: &[T],
    at: impl Fn(T) -> DVec3,
    mut triangle: impl FnMut([T; 3]),
) -> Result<(), String> {
    if let [a, b, c] = *corners {
        triangle([a, b, c]);
        return Ok(());
    }
    let flat = flat(&corners.iter().map(|corner| at(*corner)).collect::<Vec<_>>());
    if corners.len() > MOST && !is_convex(&flat) {
        return Err(format!(
            "{} corners, and is not convex, but for rounding at least; allowed: up to {MOST}, or convex polygons",
            corners.len()
        ));
    }
    match cut_ears(corners.to_vec(), flat, triangle) {
        true => Ok(()),
        false => Err("sides that cross each other; allowed: polygons without".to_string()),
    }
}

/// The polygon as it is seen along the axis that its normal is next to, turning to the left.
fn flat(corners: &[DVec3]) -> Vec<DVec2> {
    // From one corner, so that a polygon far off loses no digits.
    let ways: Vec<DVec3> = corners.iter().map(|corner| *corner - corners[0]).collect();
    let crosses = || ways.iter().zip(ways.iter().cycle().skip(1)).map(|(a, b)| a.cross(*b));
    // By the plane that it lies in, which areas that cancel tell as well.
    let axis = crosses().map(DVec3::abs).sum::<DVec3>().max_position();
    let normal: DVec3 = crosses().sum();
    let seen = |way: DVec3| {
        let [x, y] = [way[(axis + 1) % 3], way[(axis + 2) % 3]];
        if normal[axis] < 0.0 { DVec2::new(y, x) } else { DVec2::new(x, y) }
    };
    ways.into_iter().map(seen).collect()
}

/// Whether it turns to the left everywhere, and goes around once: its sides then go to the right once, and to the left once.
fn is_convex(flat: &[DVec2]) -> bool {
    let following = flat.iter().cycle().skip(1);
    // Corners in one place are one.
    let sides: Vec<DVec2> =
        flat.iter().zip(following).map(|(a, b)| *b - *a).filter(|side| *side != DVec2::ZERO).collect();
    let turns = || sides.iter().zip(sides.iter().cycle().skip(1));
    let is_left = |(a, b): (&DVec2, &DVec2)| a.perp_dot(*b) >= -STRAIGHT * a.length() * b.length();
    let is_rightward: Vec<bool> =
        sides.iter().filter(|side| side.x != 0.0).map(|side| side.x > 0.0).collect();
    let changes =
        is_rightward.iter().zip(is_rightward.iter().cycle().skip(1)).filter(|(a, b)| a != b).count();
    changes <= 2 && turns().all(is_left)
}

/// Every second corner is cut off, and again what is left: a fan about one corner would be hundreds of triangles that lie over each other
/// seen from everywhere but in front, and no tree would part them.
fn cut_convex<T: Copy>(corners: Vec<T>, mut triangle: impl FnMut([T; 3])) {
    let mut ring = corners;
    while ring.len() > 2 {
        ring.windows(3).step_by(2).for_each(|cut| triangle([cut[0], cut[1], cut[2]]));
        if let ([first, .., before, last], true) = (&ring[..], ring.len().is_multiple_of(2)) {
            triangle([*first, *before, *last]);
        }
        ring = ring.into_iter().step_by(2).collect();
    }
}

/// Cuts off corners whose triangle holds no other corner, one after the other, until what is left is convex; whether that could be.
///
/// # Source
/// Meisters 1975: every polygon whose sides do not cross has two such corners.
fn cut_ears<T: Copy>(mut ring: Vec<T>, mut flat: Vec<DVec2>, mut triangle: impl FnMut([T; 3])) -> bool {
    let mut from = 0;
    while !is_convex(&flat) {
        let count = ring.len();
        let find = |is_wanted: &dyn Fn(usize) -> bool| {
            (0..count).map(|n| (from + n) % count).find(|i| is_wanted(*i))
        };
        // Spurs first, which no triangle may cross. Corners on the edge of a triangle count as in it, as long as others are to be had, and
        // what spans nothing is gone: teeth may stand on that edge and reach through.
        let ear = find(&|middle| is_straight(&flat, middle, true))
            .or_else(|| find(&|middle| is_ear(&flat, middle, true)))
            .or_else(|| find(&|middle| is_straight(&flat, middle, false)))
            .or_else(|| find(&|middle| is_ear(&flat, middle, false)));
        let Some(middle) = ear else {
            if is_thin(&flat) {
                break;
            }
            return false;
        };
        triangle(around(count, middle).map(|i| ring[i]));
        ring.remove(middle);
        flat.remove(middle);
        // The next but one, so that triangles do not lie over each other.
        from = middle + 1;
    }
    cut_convex(ring, triangle);
    true
}

/// A corner's number between those of its neighbours.
fn around(count: usize, middle: usize) -> [usize; 3] {
    [(middle + count - 1) % count, middle, (middle + 1) % count]
}

fn is_ear(flat: &[DVec2], middle: usize, with_edge: bool) -> bool {
    let [a, b, c] = around(flat.len(), middle).map(|i| flat[i]);
    if (b - a).perp_dot(c - b) <= 0.0 {
        return false;
    }
    let is_in = |p: DVec2| {
        let sides = [(b - a).perp_dot(p - a), (c - b).perp_dot(p - b), (a - c).perp_dot(p - c)];
        let is_corner = p == a || p == b || p == c;
        !is_corner && sides.iter().all(|side| *side > 0.0 || (with_edge && *side == 0.0))
    };
    !flat.iter().any(|p| is_in(*p))
}

/// Whether a corner spans no area with its neighbours; of spurs, whether the way goes back there.
fn is_straight(flat: &[DVec2], middle: usize, is_spur: bool) -> bool {
    let [a, b, c] = around(flat.len(), middle).map(|i| flat[i]);
    let (before, after) = (b - a, c - b);
    let is_back = before.dot(after) < 0.0;
    before.perp_dot(after).abs() <= STRAIGHT * before.length() * after.length() && (is_back || !is_spur)
}

/// Whether all corners lie on a line, but for rounding.
fn is_thin(flat: &[DVec2]) -> bool {
    let far = |from: DVec2| {
        flat.iter().copied().max_by(|a, b| (*a - from).length().total_cmp(&(*b - from).length()))
    };
    let Some(along) = far(flat[0]).and_then(|a| far(a).map(|b| b - a)) else { return true };
    let across = |p: &DVec2| (*p - flat[0]).perp_dot(along).abs();
    flat.iter().map(across).fold(0.0, f64::max) <= THIN * along.length_squared()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::{cos, sin, warp};
    use crate::rng::{Purpose, Stream};
    use std::f64::consts::PI;

    /// Triangles of a polygon: their areas along its normal, and its own.
    fn areas(corners: &[DVec3]) -> Result<(Vec<f64>, f64), String> {
        let area = |ring: &[DVec3]| -> DVec3 {
            (1..ring.len() - 1).map(|i| 0.5 * (ring[i] - ring[0]).cross(ring[i + 1] - ring[0])).sum()
        };
        let whole = area(corners);
        let mut all = Vec::new();
        cut(
            &(0..corners.len()).collect::<Vec<_>>(),
            |i| corners[i],
            |triangle: [usize; 3]| {
                all.push(area(&triangle.map(|i| corners[i])).dot(whole.normalize()));
            },
        )?;
        Ok((all, whole.length()))
    }

    fn is_filled_once(corners: &[DVec3]) {
        let (all, whole) = areas(corners).unwrap();
        assert!(all.len() <= corners.len() - 2);
        assert!(all.iter().all(|area| *area >= -1e-12 * whole), "{all:?}");
        assert!((all.iter().sum::<f64>() / whole - 1.0).abs() < 1e-9, "{all:?} {whole}");
    }

    /// Stars and combs in any plane, from any corner on, in both senses: triangles fill them once.
    #[test]
    fn polygons_that_are_not_convex_are_filled_once() {
        let mut stream = Stream::new(11, Purpose::Synthetic, 0, 0);
        for trial in 0..300 {
            let count = 4 + trial % 40;
            let star = (0..count).map(|i| {
                let angle = 2.0 * PI * i as f64 / count as f64;
                DVec2::new(cos(angle), sin(angle)) * (0.05 + stream.unit())
            });
            let comb = (0..count).map(|i| DVec2::new(i as f64, if i % 2 == 0 { 1.0 } else { 0.2 }));
            let comb = comb.chain([DVec2::new(count as f64, -1.0), DVec2::new(0.0, -1.0)]);
            let mut ring: Vec<DVec2> = if trial % 3 == 0 { comb.collect() } else { star.collect() };
            let from = (stream.unit() * ring.len() as f64) as usize;
            ring.rotate_left(from);
            if trial % 2 == 0 {
                ring.reverse();
            }
            // Some corners doubled, or all.
            if trial % 5 < 2 {
                ring = ring
                    .iter()
                    .flat_map(|p| vec![*p; 1 + usize::from(trial % 5 == 0 || stream.unit() < 0.2)])
                    .collect();
            }
            let normal = [DVec3::X, DVec3::NEG_Y, warp::square_to_sphere(stream.pair())][trial % 3];
            let frame = crate::math::Frame::new(normal);
            let far = 1e3 * DVec3::from(stream.triple());
            let place = |p: &DVec2| far + frame.to_world(DVec3::new(p.x, p.y, 0.0));
            is_filled_once(&ring.iter().map(place).collect::<Vec<_>>());
        }
    }

    /// An arrow head from each of its corners, and a wall with a window, which is cut open to it.
    #[test]
    fn known_polygons() {
        let mut arrow = [(0.0, 0.0), (2.0, 0.0), (2.0, 2.0), (1.8, 0.2)].map(|(x, y)| DVec3::new(x, y, 0.0));
        for _ in 0..4 {
            let (all, whole) = areas(&arrow).unwrap();
            assert!((all.iter().sum::<f64>() - 0.4).abs() < 1e-12 && (whole - 0.4).abs() < 1e-12);
            arrow.rotate_left(1);
        }
        let window = [
            (0.0, 0.0),
            (4.0, 0.0),
            (4.0, 4.0),
            (0.0, 4.0),
            (0.0, 0.0),
            (1.0, 1.0),
            (1.0, 2.0),
            (2.0, 2.0),
            (2.0, 1.0),
            (1.0, 1.0),
        ];
        let window = window.map(|(x, y)| DVec3::new(x, 0.0, y));
        let (all, whole) = areas(&window).unwrap();
        assert!((whole - 15.0).abs() < 1e-12 && (all.iter().sum::<f64>() - 15.0).abs() < 1e-12, "{all:?}");
        assert!(all.iter().all(|area| *area >= 0.0), "{all:?}");
    }

    #[test]
    fn sides_that_cross_are_refused() {
        let star = |step: usize| -> Vec<DVec3> {
            let corner = |i: usize| 2.0 * PI * (i * step) as f64 / 5.0;
            (0..5).map(corner).map(|angle| DVec3::new(cos(angle), sin(angle), 1.0)).collect()
        };
        assert!(areas(&star(1)).is_ok());
        assert!(areas(&star(2)).unwrap_err().contains("cross"));
        // Not those that cross by rounding, nor spurs.
        let thin =
            [(0.0, 0.0), (1.0, 0.0), (0.999_99, 1e-7), (0.0, -1e-7)].map(|(x, y)| DVec3::new(x, y, 0.0));
        assert!(areas(&thin).is_ok());
        let spur =
            [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0), (1.0, 1.0)].map(|(x, y)| DVec3::new(x, 0.0, y));
        let (all, whole) = areas(&spur).unwrap();
        assert!((all.iter().sum::<f64>() - 0.5).abs() < 1e-12 && (whole - 0.5).abs() < 1e-12, "{all:?}");
        let bow = [(0.0, 0.0), (2.0, 2.0), (2.0, 0.0), (0.0, 3.0)].map(|(x, y)| DVec3::new(x, y, 0.0));
        assert!(areas(&bow).unwrap_err().contains("cross"));
        let mut many: Vec<DVec3> = (0..MOST).map(|i| DVec3::new(i as f64, (i % 2) as f64, 0.0)).collect();
        many.extend([DVec3::new(MOST as f64, -1.0, 0.0), DVec3::new(0.0, -1.0, 0.0)]);
        assert!(areas(&many).unwrap_err().contains("up to 16384"));
    }
}
