//! The mean of a field over a kernel, as a function of the kernel's radius, fast enough to be asked a million times.

use super::fields::{CELL, Exact};
use turbid_analytic::kernel::Kernel;
use turbid_analytic::slab_kernel::slab_kernel_mean;

/// Chebyshev points a piece: sixteen leave 1e-9 of functions as smooth as these on pieces of a factor of two.
const POINTS: usize = 16;
/// Halvings of the radius, from half the cell down to a thousandth of a mean free path. Below it the mean is taken
/// as constant: no gather is that small.
const HALVINGS: usize = 11;

/// One piece: its ends and the values at its Chebyshev points.
struct Piece {
    low: f64,
    high: f64,
    values: [f64; POINTS],
}

/// int_O K_r f against r, from nothing to half the cell.
pub struct Profile {
    pieces: Vec<Piece>,
}

/// The place of a Chebyshev point of the second kind in [-1, 1], from 1 down.
fn point(i: usize) -> f64 {
    libm::cos(std::f64::consts::PI * i as f64 / (POINTS - 1) as f64)
}

impl Profile {
    /// Tabulates the mean at one depth of a slab. Pieces end where the ball touches a face.
    pub fn new(kernel: Kernel, depth: f64, thickness: f64, field: &Exact) -> anyhow::Result<Self> {
        let most = 0.5 * CELL;
        let mut ends: Vec<f64> = (0..=HALVINGS).map(|i| most * 0.5f64.powi(i as i32)).collect();
        let smallest = ends[HALVINGS];
        ends.extend([depth, thickness - depth].iter().filter(|&&r| smallest < r && r < most));
        ends.sort_by(f64::total_cmp);
        ends.dedup();
        let value = |depth: f64| field(depth).map_or(f64::NAN, |(value, _)| value);
        let mut pieces = Vec::with_capacity(ends.len());
        for pair in ends.windows(2) {
            let mut piece = Piece { low: pair[0], high: pair[1], values: [0.0; POINTS] };
            for (i, slot) in piece.values.iter_mut().enumerate() {
                let radius = 0.5 * (piece.low + piece.high) + 0.5 * (piece.high - piece.low) * point(i);
                *slot = slab_kernel_mean(kernel, radius, depth, thickness, value)?.value;
            }
            pieces.push(piece);
        }
        Ok(Profile { pieces })
    }

    /// The mean at a radius, by barycentric interpolation (Berrut and Trefethen 2004).
    pub fn at(&self, radius: f64) -> f64 {
        let index = self.pieces.partition_point(|p| p.high < radius).min(self.pieces.len() - 1);
        let piece = &self.pieces[index];
        let x = ((2.0 * radius - piece.low - piece.high) / (piece.high - piece.low)).clamp(-1.0, 1.0);
        let (mut above, mut below) = (0.0, 0.0);
        for (i, value) in piece.values.iter().enumerate() {
            let distance = x - point(i);
            if distance == 0.0 {
                return *value;
            }
            let half = if i == 0 || i == POINTS - 1 { 0.5 } else { 1.0 };
            let weight = if i % 2 == 0 { half } else { -half } / distance;
            above += weight * value;
            below += weight;
        }
        above / below
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn interpolates_what_it_tabulates() {
        let field: Exact = Box::new(|t| Ok((libm::exp(-t), 0.0)));
        for kernel in [Kernel::Uniform, Kernel::Biweight] {
            for depth in [0.0, 0.25, 1.0] {
                let profile = Profile::new(kernel, depth, 2.0, &field).unwrap();
                for i in 1..200 {
                    let r = 0.01 * f64::from(i);
                    let direct = slab_kernel_mean(kernel, r, depth, 2.0, |t| libm::exp(-t)).unwrap().value;
                    assert!(
                        (profile.at(r) / direct - 1.0).abs() < 1e-8,
                        "{kernel:?} depth {depth} radius {r}"
                    );
                }
            }
        }
    }
}
