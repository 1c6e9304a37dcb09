//! Polygons in triangles.

use glam::{DVec2, DVec3};

/// Turns below this part of the product of two sides are rounding.
const STRAIGHT: f64 = 1e-9;

/// A polygon that is not convex has no more corners: each of its triangles is tried against all of them.
const MOST: usize = 4096;

/// Cuts a polygon into triangles of its own sense of rotation.
///
/// # Arguments
/// `at` says where a corner is
/// # Errors
/// what is wrong with a polygon whose sides cross, or that is not convex and has too many corners
pub(super) fn cut<T: Copy>(
    corners: Vec<T>,
    at: impl Fn(T) -> DVec3,
    triangle: impl FnMut([T; 3]),
) -> Result<(), String> {
    if corners.len() == 3 {
        cut_convex(corners, triangle);
        return Ok(());
    }
    let flat = flat(&corners.iter().map(|corner| at(*corner)).collect::<Vec<_>>());
    if is_convex(&flat) {
        cut_convex(corners, triangle);
        return Ok(());
    }
    if corners.len() > MOST {
        return Err(format!(
            "{} corners, and is not convex; allowed: up to {MOST}, or convex polygons",
            corners.len()
        ));
    }
    match cut_ears(corners.into_iter().zip(flat).collect(), triangle) {
        true => Ok(()),
        false => Err("sides that cross each other; allowed: polygons without".to_string()),
    }
}

/// The polygon as it is seen along the axis that its normal is next to, turning to the left.
fn flat(corners: &[DVec3]) -> Vec<DVec2> {
    // From one corner, so that a polygon far off loses no digits.
    let ways: Vec<DVec3> = corners.iter().map(|corner| *corner - corners[0]).collect();
    let following = ways.iter().cycle().skip(1);
    let normal: DVec3 = ways.iter().zip(following).map(|(a, b)| a.cross(*b)).sum();
    let axis = normal.abs().max_position();
    let seen = |way: DVec3| {
        let [x, y] = [way[(axis + 1) % 3], way[(axis + 2) % 3]];
        if normal[axis] < 0.0 { DVec2::new(y, x) } else { DVec2::new(x, y) }
    };
    ways.into_iter().map(seen).collect()
}

/// Whether it turns to the left everywhere, and goes around once: its sides then go to the right once, and to the left once.
fn is_convex(flat: &[DVec2]) -> bool {
    let side = |i: usize| flat[(i + 1) % flat.len()] - flat[i % flat.len()];
    let is_left = |i: usize| {
        let (a, b) = (side(i), side(i + 1));
        a.perp_dot(b) >= -STRAIGHT * a.length() * b.length()
    };
    let is_rightward: Vec<bool> =
        (0..flat.len()).map(|i| side(i).x).filter(|x| *x != 0.0).map(|x| x > 0.0).collect();
    let following = is_rightward.iter().cycle().skip(1);
    let changes = is_rightward.iter().zip(following).filter(|(a, b)| a != b).count();
    changes <= 2 && (0..flat.len()).all(is_left)
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

/// Cuts off corners whose triangle holds no other corner, one after the other; whether all could be.
///
/// # Source
/// Meisters 1975: every polygon whose sides do not cross has two such corners.
fn cut_ears<T: Copy>(mut ring: Vec<(T, DVec2)>, mut triangle: impl FnMut([T; 3])) -> bool {
    let mut from = 0;
    while ring.len() > 3 {
        let count = ring.len();
        // Corners on the edge of a triangle count as in it, as long as others are to be had.
        let ear = [true, false].into_iter().find_map(|with_edge| {
            (0..count).map(|n| (from + n) % count).find(|middle| is_ear(&ring, *middle, with_edge))
        });
        let Some(middle) = ear else { return false };
        triangle([(middle + count - 1) % count, middle, (middle + 1) % count].map(|i| ring[i].0));
        ring.remove(middle);
        // The next but one, so that triangles do not lie over each other.
        from = middle + 1;
    }
    let [a, b, c] = [0, 1, 2].map(|i| ring[i].1);
    if (b - a).perp_dot(c - a) < -STRAIGHT * (b - a).length() * (c - a).length() {
        return false;
    }
    triangle([ring[0].0, ring[1].0, ring[2].0]);
    true
}

fn is_ear<T>(ring: &[(T, DVec2)], middle: usize, with_edge: bool) -> bool {
    let count = ring.len();
    let [a, b, c] = [count - 1, 0, 1].map(|k| ring[(middle + k) % count].1);
    if (b - a).perp_dot(c - b) <= 0.0 {
        return false;
    }
    let is_in = |p: DVec2| {
        let sides = [(b - a).perp_dot(p - a), (c - b).perp_dot(p - b), (a - c).perp_dot(p - c)];
        let is_corner = p == a || p == b || p == c;
        !is_corner && sides.iter().all(|side| *side > 0.0 || (with_edge && *side == 0.0))
    };
    !ring.iter().any(|(_, p)| is_in(*p))
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
            (0..corners.len()).collect(),
            |i| corners[i],
            |triangle: [usize; 3]| {
                all.push(area(&triangle.map(|i| corners[i])).dot(whole.normalize()));
            },
        )?;
        Ok((all, whole.length()))
    }

    fn is_filled_once(corners: &[DVec3]) {
        let (all, whole) = areas(corners).unwrap();
        assert_eq!(all.len(), corners.len() - 2);
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
        let bow = [(0.0, 0.0), (2.0, 2.0), (2.0, 0.0), (0.0, 3.0)].map(|(x, y)| DVec3::new(x, y, 0.0));
        assert!(areas(&bow).unwrap_err().contains("cross"));
        let mut many: Vec<DVec3> = (0..MOST).map(|i| DVec3::new(i as f64, (i % 2) as f64, 0.0)).collect();
        many.extend([DVec3::new(MOST as f64, -1.0, 0.0), DVec3::new(0.0, -1.0, 0.0)]);
        assert!(areas(&many).unwrap_err().contains("up to 4096"));
    }
}
