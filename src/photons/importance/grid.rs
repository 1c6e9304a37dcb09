//! The boxes and directions in which importance is learned.

use crate::math::{FOUR_PI, atan2, warp};
use glam::DVec3;
use std::f64::consts::PI;

/// A box about all events, cut into cubes.
#[derive(Debug, Clone)]
pub(super) struct Grid {
    low: DVec3,
    side: f64,
    count: [usize; 3],
}

impl Grid {
    /// `boxes` cubes along the longest edge of the box from `low` to `high`.
    pub fn new(low: DVec3, high: DVec3, boxes: usize) -> Self {
        let size = high - low;
        let side = size.max_element().max(f64::MIN_POSITIVE) / boxes.max(1) as f64;
        let count = (size / side).to_array().map(|n| (n.ceil() as usize).clamp(1, boxes.max(1)));
        Grid { low, side, count }
    }

    pub fn len(&self) -> usize {
        self.count.iter().product()
    }

    /// The cube of a point; one outside counts to the nearest.
    pub fn index(&self, p: DVec3) -> usize {
        let at = (p - self.low) / self.side;
        // Casts take what is below 0 to 0.
        let [x, y, z] = [0, 1, 2].map(|i| (at[i] as usize).min(self.count[i] - 1));
        (x * self.count[1] + y) * self.count[2] + z
    }
}

/// Rows of equal height and columns of directions.
const ROWS: usize = 8;
/// Cells of equal solid angle that the sphere of directions is cut into.
pub(super) const DIRECTIONS: usize = ROWS * ROWS;

/// The cell of a direction.
pub(super) fn direction_cell(dir: DVec3) -> usize {
    let row = (0.5 * (1.0 - dir.z) * ROWS as f64) as usize;
    let turn = atan2(dir.y, dir.x) / (2.0 * PI);
    let column = ((turn - turn.floor()) * ROWS as f64) as usize;
    row.min(ROWS - 1) * ROWS + column.min(ROWS - 1)
}

/// A uniform direction in a cell; its density there is that of [`density_in_cell`].
pub(super) fn direction_in(cell: usize, [u, v]: [f64; 2]) -> DVec3 {
    let at = |index: usize, u: f64| (index as f64 + u) / ROWS as f64;
    warp::square_to_sphere([at(cell / ROWS, u), at(cell % ROWS, v)]).normalize()
}

/// Density of a uniform direction in one cell [1/sr].
pub(super) fn density_in_cell() -> f64 {
    DIRECTIONS as f64 / FOUR_PI
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::{Purpose, Stream};

    #[test]
    fn directions_are_in_their_cells() {
        let mut stream = Stream::new(1, Purpose::Synthetic, 0, 0);
        for cell in 0..DIRECTIONS {
            for _ in 0..100 {
                assert_eq!(direction_cell(direction_in(cell, stream.pair())), cell);
            }
        }
    }

    #[test]
    fn points_are_in_their_cubes() {
        let grid = Grid::new(DVec3::new(-1.0, 0.0, 2.0), DVec3::new(3.0, 2.0, 3.0), 4);
        assert_eq!(grid.len(), 4 * 2);
        let centers: Vec<usize> = (0..8)
            .map(|i| {
                let at = DVec3::new((i / 2) as f64 + 0.5, (i % 2) as f64 + 0.5, 0.5);
                grid.index(DVec3::new(-1.0, 0.0, 2.0) + at)
            })
            .collect();
        assert_eq!(centers, (0..8).collect::<Vec<usize>>());
        assert_eq!(grid.index(DVec3::splat(-1e9)), 0);
        assert_eq!(grid.index(DVec3::splat(1e9)), 7);
    }
}
