//! Directions learned from photons, mixed with those of a phase function or a surface.

use crate::faults::{Fault, planted};
use crate::math::warp;
use crate::rng::Stream;
use glam::{DVec2, DVec3};

/// Area of the octahedron's square.
const SQUARE: f64 = 4.0;

/// Where light comes from about a place: masses of the cells of the octahedron's square, and the share of a path's directions that
/// are drawn from them.
#[derive(Debug, Clone, PartialEq)]
pub struct Lobe {
    share: f64,
    /// Cells along an edge of the square.
    side: usize,
    /// Sums of the masses up to and with each cell; the last is 1.
    sums: Box<[f32]>,
}

impl Lobe {
    /// A lobe of cells that hold these masses, row by row; none where they hold nothing.
    ///
    /// # Arguments
    /// `masses` a square number of them, none below 0
    /// `share` in (0, 1)
    pub fn new(masses: &[f64], share: f64) -> Option<Self> {
        let total: f64 = masses.iter().sum();
        if !(total > 0.0 && total.is_finite()) {
            return None;
        }
        let mut sum = 0.0;
        let mut sums: Box<[f32]> = masses
            .iter()
            .map(|mass| {
                sum += mass;
                (sum / total) as f32
            })
            .collect();
        // Rounding leaves nothing over; cells of no mass behind the last one keep none.
        let last = masses.iter().rposition(|mass| *mass > 0.0)?;
        sums[last..].fill(1.0);
        Some(Lobe { share, side: masses.len().isqrt(), sums })
    }

    /// The share of directions that are drawn from it.
    pub fn share(&self) -> f64 {
        self.share
    }

    /// The cell of a direction in a square of so many along an edge.
    pub fn cell(side: usize, dir: DVec3) -> usize {
        let place = (warp::octahedral(dir) + 1.0) * (0.5 * side as f64);
        // Casts take what rounding brought below 0 to 0.
        let [x, y] = place.to_array().map(|at| (at as usize).min(side - 1));
        y * side + x
    }

    /// The direction in the middle of a cell.
    pub fn middle(side: usize, cell: usize) -> DVec3 {
        at(side, cell, [0.5; 2])
    }

    /// Density of its own directions [1/sr].
    fn pdf_solid_angle(&self, dir: DVec3) -> f64 {
        let cell = Self::cell(self.side, dir);
        let before = if cell == 0 { 0.0 } else { self.sums[cell - 1] };
        let mass = f64::from(self.sums[cell]) - f64::from(before);
        mass * (self.sums.len() as f64 / SQUARE) * warp::octahedral_density(dir)
    }

    /// Density with which a direction is drawn from the mixture of its own and those of a surface or phase function [1/sr].
    ///
    /// # Arguments
    /// `own` the density by the surface or phase function alone [1/sr]
    pub fn mixed(&self, dir: DVec3, own: f64) -> f64 {
        if planted(Fault::LobeForgotten) {
            return own;
        }
        self.share * self.pdf_solid_angle(dir) + (1.0 - self.share) * own
    }

    /// A direction from the mixture.
    ///
    /// # Arguments
    /// `own` draws a direction by the surface or phase function alone
    pub fn sample(&self, stream: &mut Stream, own: impl FnOnce(&mut Stream) -> DVec3) -> DVec3 {
        let u = stream.unit() / self.share;
        if u >= 1.0 {
            return own(stream);
        }
        let cell = self.sums.partition_point(|sum| f64::from(*sum) <= u).min(self.sums.len() - 1);
        at(self.side, cell, stream.pair())
    }
}

/// The direction at a place in a cell, by two numbers in [0, 1).
fn at(side: usize, cell: usize, numbers: [f64; 2]) -> DVec3 {
    let corner = DVec2::new((cell % side) as f64, (cell / side) as f64);
    warp::from_octahedral((corner + DVec2::from(numbers)) * (2.0 / side as f64) - 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::Purpose;

    /// Masses with empty cells at both ends and within.
    fn masses(side: usize) -> Vec<f64> {
        (0..side * side).map(|cell| if cell < 3 || cell % 5 == 2 { 0.0 } else { (cell % 7) as f64 }).collect()
    }

    /// Own directions that are uniform on the sphere.
    fn uniform(stream: &mut Stream) -> DVec3 {
        warp::square_to_sphere(stream.pair())
    }

    /// The mean of f over density, whose directions are drawn from the mixture, is the integral of f: 1, by hand z^2 and the squared
    /// sine about a slanted axis; and the density alone, over uniform directions, is 1 too.
    #[test]
    fn the_density_is_that_of_the_directions() {
        const N: u64 = 200_000;
        for (side, share) in [(1, 0.5), (2, 0.25), (8, 0.75), (16, 0.9)] {
            let masses = if side < 8 { vec![1.0; side * side] } else { masses(side) };
            let lobe = Lobe::new(&masses, share).unwrap();
            let axis = DVec3::new(1.0, -2.0, 0.5).normalize();
            let integrands: [(&dyn Fn(DVec3) -> f64, f64); 3] = [
                (&|_| 1.0, 1.0),
                (&|dir| dir.z * dir.z, 1.0 / 3.0),
                (&|dir| 1.0 - dir.dot(axis).powi(2), 2.0 / 3.0),
            ];
            let mut stream = Stream::new(3, Purpose::Synthetic, 0, side as u64);
            let (mut sums, mut squares, mut all) = ([0.0; 3], [0.0; 3], 0.0);
            for _ in 0..N {
                let dir = lobe.sample(&mut stream, uniform);
                for (i, (f, _)) in integrands.iter().enumerate() {
                    let value = f(dir) * warp::pdf_sphere() / lobe.mixed(dir, warp::pdf_sphere());
                    sums[i] += value;
                    squares[i] += value * value;
                }
                all += lobe.pdf_solid_angle(uniform(&mut stream)) / warp::pdf_sphere();
            }
            let n = N as f64;
            for (i, (_, expected)) in integrands.iter().enumerate() {
                let mean = sums[i] / n;
                let error = ((squares[i] / n - mean * mean) / n).sqrt();
                assert!((mean - expected).abs() < 4.5 * error + 1e-12, "{side} {i}: {mean} +- {error}");
                assert!(error < 0.01 * expected);
            }
            assert!((all / n - 1.0).abs() < 0.03, "{side}: {}", all / n);
        }
    }

    /// As many directions in each cell as its mass says, none where there is none, to the last digit of the numbers.
    #[test]
    fn cells_are_drawn_by_their_masses() {
        let masses = masses(8);
        let (lobe, total) = (Lobe::new(&masses, 0.5).unwrap(), masses.iter().sum::<f64>());
        let mut stream = Stream::new(4, Purpose::Synthetic, 0, 0);
        let (mut counts, mut drawn) = (vec![0.0; 64], 0.0);
        for _ in 0..400_000 {
            let mut is_own = false;
            let dir = lobe.sample(&mut stream, |stream| {
                is_own = true;
                uniform(stream)
            });
            if !is_own {
                counts[Lobe::cell(8, dir)] += 1.0;
                drawn += 1.0;
            }
        }
        assert!((drawn / 400_000.0 - 0.5f64).abs() < 0.004);
        for (cell, (count, mass)) in counts.iter().zip(&masses).enumerate() {
            let expected = drawn * mass / total;
            assert!((count - expected).abs() <= 4.5 * expected.sqrt(), "{cell}: {count} for {expected}");
        }
        for cell in 0..64 {
            assert_eq!(Lobe::cell(8, Lobe::middle(8, cell)), cell);
        }
        assert!(Lobe::new(&[0.0; 4], 0.5).is_none());
    }
}
