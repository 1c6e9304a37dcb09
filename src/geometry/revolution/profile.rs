//! Smooth profiles from few points.

use glam::DVec2;

/// A line through all the points, `pieces` straight pieces between one and the next, along cubics whose tangent at a
/// point is half the step from the point before to the point after; a point that is given twice is a corner.
///
/// Radii that the cubic would bring below 0 are 0.
///
/// # Source     Catmull and Rom 1974, "A class of local interpolating splines"
pub fn smooth(points: &[DVec2], pieces: u32) -> Vec<DVec2> {
    let mut line = Vec::with_capacity(points.len() * pieces as usize + 1);
    // Corners end one curve and begin the next. A line that ends where it began, not at a corner, has no ends.
    for run in points.chunk_by(|a, b| a != b) {
        let is_loop = run.len() == points.len() && run.len() > 2 && run[0] == run[run.len() - 1];
        line.extend_from_slice(&run[..1]);
        for i in 0..run.len() - 1 {
            let (a, b) = (run[i], run[i + 1]);
            let before = if i > 0 {
                run[i - 1]
            } else if is_loop {
                run[run.len() - 2]
            } else {
                2.0 * a - b
            };
            let after = if i + 2 < run.len() {
                run[i + 2]
            } else if is_loop {
                run[1]
            } else {
                2.0 * b - a
            };
            for piece in 1..pieces {
                let s = f64::from(piece) / f64::from(pieces);
                let (ta, tb) = (0.5 * (b - before), 0.5 * (after - a));
                let p = a * ((1.0 + 2.0 * s) * (1.0 - s) * (1.0 - s))
                    + ta * (s * (1.0 - s) * (1.0 - s))
                    + b * (s * s * (3.0 - 2.0 * s))
                    - tb * (s * s * (1.0 - s));
                line.push(DVec2::new(p.x.max(0.0), p.y));
            }
            line.push(b);
        }
    }
    line.dedup();
    line
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Points stay, a straight line with even steps stays straight, a corner stays sharp, the middle of a span is
    /// (-1 9 9 -1)/16 of the four points around it.
    #[test]
    fn passes_through_its_points() {
        let p = |x: f64, y: f64| DVec2::new(x, y);
        let line = smooth(&[p(1.0, 0.0), p(1.0, 1.0), p(1.0, 2.0)], 4);
        assert_eq!(line.len(), 9);
        assert!(line.iter().enumerate().all(|(i, q)| q.distance(p(1.0, i as f64 / 4.0)) < 1e-15));
        let four = [p(1.0, 0.0), p(2.0, 1.0), p(1.0, 2.0), p(3.0, 3.0)];
        let bent = smooth(&four, 2);
        let middle = (four[1] + four[2]) * (9.0 / 16.0) - (four[0] + four[3]) / 16.0;
        assert!(bent[3].distance(middle) < 1e-15 && bent[2] == four[1] && bent[4] == four[2]);
        let corner = smooth(&[p(1.0, 0.0), p(1.0, 1.0), p(1.0, 1.0), p(2.0, 1.0)], 3);
        assert!(corner.iter().all(|q| q.x == 1.0 || q.y == 1.0), "{corner:?}");
        assert_eq!(smooth(&four, 1), four);
    }
}
