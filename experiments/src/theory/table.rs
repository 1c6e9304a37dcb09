//! Tables of smooth functions of one number, fast enough to be asked a million times.

use super::Exact;
use std::sync::LazyLock;
use turbid_analytic::kernel::Kernel;
use turbid_analytic::slab_kernel::slab_kernel_mean;

/// Chebyshev points a piece: sixteen leave 1e-9 of a function whose nearest singularity is half a piece away.
const POINTS: usize = 16;
/// Halvings of the radius, from the largest down to one part in two thousand. Below it the mean is taken as constant:
/// no gather is that small.
const HALVINGS: usize = 11;
/// Thirds towards each face of a slab, where fluence behaves like c + t ln t: down to 1e-12 of the thickness.
const THIRDS: usize = 25;

/// One piece: its ends and the values at its Chebyshev points.
struct Piece {
    low: f64,
    high: f64,
    values: [f64; POINTS],
}

/// A function tabulated in pieces; constant beyond its ends.
pub struct Table {
    pieces: Vec<Piece>,
}

/// The Chebyshev points of the second kind in [-1, 1], from 1 down.
static POINT: LazyLock<[f64; POINTS]> = LazyLock::new(|| std::array::from_fn(point));

/// The place of a Chebyshev point of the second kind in [-1, 1], from 1 down.
fn point(i: usize) -> f64 {
    libm::cos(std::f64::consts::PI * i as f64 / (POINTS - 1) as f64)
}

impl Table {
    /// Tabulates a function between the given ends of pieces.
    pub fn new(mut ends: Vec<f64>, function: impl Fn(f64) -> anyhow::Result<f64>) -> anyhow::Result<Self> {
        ends.sort_by(f64::total_cmp);
        ends.dedup();
        let mut pieces = Vec::with_capacity(ends.len());
        for pair in ends.windows(2) {
            let mut piece = Piece { low: pair[0], high: pair[1], values: [0.0; POINTS] };
            for (i, slot) in piece.values.iter_mut().enumerate() {
                *slot = function(0.5 * (piece.low + piece.high) + 0.5 * (piece.high - piece.low) * POINT[i])?;
            }
            pieces.push(piece);
        }
        Ok(Table { pieces })
    }

    /// int_O K_r f against r at one depth of a slab, up to r = `most`. Pieces end where the ball touches a face.
    pub fn of_kernel_means(
        kernel: Kernel,
        depth: f64,
        thickness: f64,
        most: f64,
        field: &Exact,
    ) -> anyhow::Result<Self> {
        let value = |depth: f64| field(depth).map_or(f64::NAN, |(value, _)| value);
        Table::of_means(most, &[depth, thickness - depth], |radius| {
            Ok(slab_kernel_mean(kernel, radius, depth, thickness, value)?.value)
        })
    }

    /// Means over balls against their radius up to `most`; `corners` are the radii where they may bend.
    pub fn of_means(
        most: f64,
        corners: &[f64],
        mean: impl Fn(f64) -> anyhow::Result<f64>,
    ) -> anyhow::Result<Self> {
        let mut ends: Vec<f64> = (0..=HALVINGS).map(|i| most * 0.5f64.powi(i as i32)).collect();
        let smallest = ends[HALVINGS];
        ends.extend(corners.iter().filter(|&&r| smallest < r && r < most));
        Table::new(ends, mean)
    }

    /// A fluence against depth in a slab, with small pieces towards the faces.
    pub fn of_fluence(thickness: f64, fluence: impl Fn(f64) -> anyhow::Result<f64>) -> anyhow::Result<Self> {
        let mut ends = vec![0.0, thickness];
        let mut distance = 0.5 * thickness;
        for _ in 0..THIRDS {
            ends.extend([distance, thickness - distance]);
            distance /= 3.0;
        }
        Table::new(ends, fluence)
    }

    /// The function at a place, by barycentric interpolation (Berrut and Trefethen 2004).
    pub fn at(&self, x: f64) -> f64 {
        let index = self.pieces.partition_point(|p| p.high < x).min(self.pieces.len() - 1);
        let piece = &self.pieces[index];
        let x = ((2.0 * x - piece.low - piece.high) / (piece.high - piece.low)).clamp(-1.0, 1.0);
        let (mut above, mut below) = (0.0, 0.0);
        for (i, value) in piece.values.iter().enumerate() {
            let distance = x - POINT[i];
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
    use turbid_analytic::{Incidence, IsotropicSlab};

    #[test]
    fn kernel_means() {
        let slab = IsotropicSlab::new(2.0, 0.9, Incidence::Beam { mu0: 1.0 }).unwrap();
        let field: Exact = Box::new(move |t| Ok((slab.fluence_interpolated(t)?.value, 0.0)));
        for kernel in [Kernel::Uniform, Kernel::Biweight] {
            for depth in [0.0, 0.25, 1.0] {
                let profile = Table::of_kernel_means(kernel, depth, 2.0, 2.0, &field).unwrap();
                for i in 1..200 {
                    let r = 0.01 * f64::from(i);
                    let direct =
                        slab_kernel_mean(kernel, r, depth, 2.0, |t| field(t).unwrap().0).unwrap().value;
                    assert!(
                        (profile.at(r) / direct - 1.0).abs() < 1e-8,
                        "{kernel:?} depth {depth} radius {r}"
                    );
                }
            }
        }
    }

    #[test]
    fn fluence_with_logarithms_at_the_faces() {
        let fluence = |t: f64| {
            let log = |x: f64| if x > 0.0 { x * libm::log(x) } else { 0.0 };
            1.0 + log(t) - 0.5 * log(2.0 - t) + libm::exp(-t)
        };
        let table = Table::of_fluence(2.0, |t| Ok(fluence(t))).unwrap();
        for i in 0..=4000 {
            let t = 0.0005 * f64::from(i);
            assert!((table.at(t) - fluence(t)).abs() < 1e-9, "depth {t}: {}", table.at(t) - fluence(t));
        }
    }
}
