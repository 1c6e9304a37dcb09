//! The boxes and directions in which importance is learned.

use crate::math::{FOUR_PI, Frame, atan2, cosine_pair, warp};
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

    /// The lower corner of the first cube.
    pub fn corner(&self) -> DVec3 {
        self.low
    }

    /// The middle of a cube.
    pub fn middle(&self, index: usize) -> DVec3 {
        let [_, y, z] = self.count;
        let at = [index / (y * z), index / z % y, index % z].map(|i| i as f64 + 0.5);
        self.low + DVec3::from(at) * self.side
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
const CELLS: usize = ROWS * ROWS;
/// All that a value is learned for: those cells, and the directions towards what is read, wherever they lie.
pub(super) const DIRECTIONS: usize = CELLS + 1;

/// The cell of a direction.
fn direction_cell(dir: DVec3) -> usize {
    let row = (0.5 * (1.0 - dir.z) * ROWS as f64) as usize;
    let turn = atan2(dir.y, dir.x) / (2.0 * PI);
    let column = ((turn - turn.floor()) * ROWS as f64) as usize;
    row.min(ROWS - 1) * ROWS + column.min(ROWS - 1)
}

/// A uniform direction in a cell.
fn direction_in(cell: usize, [u, v]: [f64; 2]) -> DVec3 {
    let at = |index: usize, u: f64| (index as f64 + u) / ROWS as f64;
    warp::square_to_sphere([at(cell / ROWS, u), at(cell % ROWS, v)]).normalize()
}

/// Density of a uniform direction in one cell [1/sr].
fn density_in_cell() -> f64 {
    CELLS as f64 / FOUR_PI
}

/// A ball about most of what is read: far from it, it fills little of a cell of directions.
#[derive(Debug, Clone, Copy)]
pub(super) struct Aim {
    pub center: DVec3,
    pub radius: f64,
}

/// The directions from one point: cells of the sphere, and the cone of the ball.
pub(super) struct Directions {
    /// Towards the ball, and 1 - cos of its half-angle; none from inside.
    cone: Option<(Frame, f64)>,
}

impl Aim {
    pub fn directions(&self, p: DVec3) -> Directions {
        let way = self.center - p;
        let sin2 = self.radius * self.radius / way.length_squared();
        let cone = (sin2 < 1.0).then(|| (Frame::new(way.normalize()), sin2 / (1.0 + (1.0 - sin2).sqrt())));
        Directions { cone }
    }
}

impl Directions {
    fn is_aimed(&self, dir: DVec3) -> bool {
        self.cone.is_some_and(|(frame, limit)| cosine_pair(frame.z, dir).0 < limit)
    }

    /// What a direction counts to.
    pub fn index(&self, dir: DVec3) -> usize {
        if self.is_aimed(dir) { CELLS } else { direction_cell(dir) }
    }

    /// The middle of each, and its solid angle over that of a cell; none for the cone from inside the ball.
    pub fn middle(&self, index: usize) -> Option<(DVec3, f64)> {
        if index < CELLS {
            return Some((direction_in(index, [0.5; 2]), 1.0));
        }
        self.cone.map(|(frame, limit)| (frame.z, density_in_cell() / warp::pdf_cone(limit)))
    }

    /// A uniform direction in one of them; cells keep their part of the cone.
    pub fn sample(&self, index: usize, u: [f64; 2]) -> DVec3 {
        match &self.cone {
            Some((frame, limit)) if index == CELLS => {
                frame.to_world(warp::square_to_cone(u, *limit)).normalize()
            }
            _ => direction_in(index.min(CELLS - 1), u),
        }
    }

    /// Density of a direction where each is sampled with these probabilities [1/sr].
    pub fn density(&self, dir: DVec3, probability: impl Fn(usize) -> f64) -> f64 {
        let aimed = match &self.cone {
            Some((_, limit)) if self.is_aimed(dir) => probability(CELLS) * warp::pdf_cone(*limit),
            _ => 0.0,
        };
        aimed + probability(direction_cell(dir)) * density_in_cell()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::{Purpose, Stream};

    #[test]
    fn directions_are_in_their_cells() {
        let mut stream = Stream::new(1, Purpose::Synthetic, 0, 0);
        for cell in 0..CELLS {
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
        assert!((0..8).all(|i| grid.index(grid.middle(i)) == i));
        assert_eq!(grid.index(DVec3::splat(-1e9)), 0);
        assert_eq!(grid.index(DVec3::splat(1e9)), 7);
    }
}
