//! How much of what a cell's photons tell is mixed in, and how finely: that by which the second moment of what a path brings is least.
//!
//! A path that is scattered by a density p and goes on by q brings p/q times an estimate of the radiance L of the direction,
//! whose own relative variance is about that of the mean: its second moment is the integral of p^2 (L^2 + v Lm^2)/q, Lm the mean
//! of L by p. Here q is share g + (1 - share) p, g the histogram. Photons are in three parts: where g is of one of them and L^2
//! the product of the other two, the sum over cells of directions is unbiased for a histogram of that many photons, and chance
//! that g has learned is no gain.

use super::arrival::Arrival;
use crate::math::{Frame, cosine_pair, warp};
use crate::phase::{Phase, PhaseFunction};
use crate::transport::Lobe;
use glam::DVec3;

/// Cells along an edge of the squares that are tried, the last the finest.
const SIDES: [usize; 3] = [8, 16, 32];
const FINE: usize = 32;
/// Shares that are tried: no weight of one scattering is above 2. A larger one is never best at this noise, however narrow the light.
pub(super) const SHARES: [f64; 2] = [0.25, 0.5];
/// Variance of what a path finds along a direction, over the square of the mean: about that of a box of fog and of rooms. Efficiency
/// is the same from 0.25 to 3 within the noise of its measurement.
pub(super) const NOISE: f64 = 2.0;
/// Part of the second moment that is to be left at most: what takes longer has to gain something.
const LEFT: f64 = 0.8;

/// The directions of a surface or a phase function.
pub(super) enum Own<'a> {
    /// By the cosine to a normal.
    Surface(DVec3),
    /// By a phase function.
    Medium(&'a Phase),
}

/// Masses of the finest cells.
type Masses = Vec<f64>;

impl Own<'_> {
    /// Masses of its directions; of a phase function, for some directions of arrival.
    fn masses(&self, solid_angles: &[f64]) -> Vec<Masses> {
        let by = |density: &dyn Fn(DVec3) -> f64| -> Masses {
            let cell = |(cell, solid_angle): (usize, &f64)| solid_angle * density(Lobe::middle(FINE, cell));
            let masses: Masses = solid_angles.iter().enumerate().map(cell).collect();
            let sum: f64 = masses.iter().sum();
            masses.into_iter().map(|mass| mass / sum).collect()
        };
        match self {
            Own::Surface(normal) => vec![by(&|dir| dir.dot(*normal).max(0.0))],
            Own::Medium(Phase::Isotropic(_)) => vec![by(&|_| 1.0)],
            // Slanted, so that no peak lies on the corners of cells.
            Own::Medium(phase) => {
                let Frame { x, y, z } = Frame::new(DVec3::new(0.36, 0.48, 0.8));
                [x, y, z]
                    .into_iter()
                    .flat_map(|axis| [axis, -axis])
                    .map(|before| {
                        by(&|dir| {
                            let (one_minus_mu, one_plus_mu) = cosine_pair(before, dir);
                            phase.eval(one_minus_mu, one_plus_mu)
                        })
                    })
                    .collect()
            }
        }
    }
}

/// What arrives by each part of the photons, and by all of them.
fn arriving(arrivals: &[Arrival]) -> ([Masses; 3], Masses) {
    let mut parts = [(); 3].map(|()| vec![0.0; FINE * FINE]);
    for arrival in arrivals {
        parts[arrival.part][Lobe::cell(FINE, arrival.from.as_dvec3())] += f64::from(arrival.power);
    }
    let all = (0..FINE * FINE).map(|cell| parts.iter().map(|part| part[cell]).sum()).collect();
    (parts, all)
}

/// What arrives, in the coarsest cells, at a share that nobody chose.
pub(super) fn plain(arrivals: &[Arrival], share: f64) -> Option<Lobe> {
    Lobe::new(&summed(&arriving(arrivals).1, SIDES[0]), share)
}

/// What is mixed into the directions of a cell; none where that gains too little.
pub(super) fn lobe(arrivals: &[Arrival], own: &Own) -> Option<Lobe> {
    let (parts, all) = arriving(arrivals);
    if parts.iter().any(|part| part.iter().all(|mass| *mass == 0.0)) {
        return None;
    }
    let solid_angle =
        |cell| 4.0 / ((FINE * FINE) as f64 * warp::octahedral_density(Lobe::middle(FINE, cell)));
    let solid_angles: Vec<f64> = (0..FINE * FINE).map(solid_angle).collect();
    let masses = own.masses(&solid_angles);
    // Photons fall on a surface by the cosine already.
    let fluxes = if let Own::Surface(_) = own { masses[0].clone() } else { solid_angles };
    let terms: Vec<Term> = masses.into_iter().map(|own| Term::new(own, &fluxes, &parts, &all)).collect();
    let moment = |guides: &[Masses; 3], share: f64| -> f64 {
        terms.iter().map(|term| term.second_moment(guides, share)).sum()
    };
    let guides = |side: usize| parts.each_ref().map(|part| coarse(part, side));
    let mut best = (LEFT * moment(&guides(FINE), 0.0), None);
    for side in SIDES {
        let guides = guides(side);
        for share in SHARES {
            let left = moment(&guides, share);
            if left < best.0 {
                best = (left, Some((side, share)));
            }
        }
    }
    let (side, share) = best.1?;
    Lobe::new(&summed(&all, side), share)
}

/// What enters the second moment for one direction of arrival.
struct Term {
    own: Masses,
    /// Products of what two parts bring by each cell, and the noise.
    squares: [Masses; 3],
}

impl Term {
    fn new(own: Masses, fluxes: &[f64], parts: &[Masses; 3], all: &[f64]) -> Self {
        let brought = |masses: &[f64], cell: usize| {
            if own[cell] > 0.0 { own[cell] * masses[cell] / fluxes[cell] } else { 0.0 }
        };
        let mean: f64 = (0..own.len()).map(|cell| brought(all, cell)).sum();
        let squares = [(1, 2), (2, 0), (0, 1)].map(|(one, other)| {
            let square = |cell: usize| {
                let noise = own[cell] * mean;
                9.0 * brought(&parts[one], cell) * brought(&parts[other], cell) + NOISE * noise * noise
            };
            (0..own.len()).map(square).collect()
        });
        Term { own, squares }
    }

    /// The second moment by a share of each part's guide, the mean over parts but for a factor.
    fn second_moment(&self, guides: &[Masses; 3], share: f64) -> f64 {
        let of = |(guide, squares): (&Masses, &Masses)| -> f64 {
            let cells = self.own.iter().zip(guide).zip(squares).filter(|((own, _), _)| **own > 0.0);
            cells.map(|((own, guide), square)| square / (share * guide + (1.0 - share) * own)).sum()
        };
        guides.iter().zip(&self.squares).map(of).sum()
    }
}

/// Masses of the cells of a coarser square.
fn summed(fine: &[f64], side: usize) -> Masses {
    let mut sums = vec![0.0; side * side];
    for (cell, mass) in fine.iter().enumerate() {
        sums[within(cell, side)] += mass;
    }
    sums
}

/// The cell of a coarser square that one of the finest lies in.
fn within(cell: usize, side: usize) -> usize {
    let along = FINE / side;
    (cell / FINE / along) * side + cell % FINE / along
}

/// Parts of all of the mass in the finest cells, if those of a coarser square are even within.
fn coarse(fine: &[f64], side: usize) -> Masses {
    let sums = summed(fine, side);
    let total: f64 = sums.iter().sum();
    let along = (FINE / side) as f64;
    (0..fine.len()).map(|cell| sums[within(cell, side)] / (total * along * along)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Asymmetry;
    use crate::rng::{Purpose, Stream};
    use glam::Vec3;

    /// Photons whose origins are drawn by `from`, part by part, of power 1 each.
    fn arrivals(count: usize, seed: u64, from: impl Fn(&mut Stream) -> DVec3) -> Vec<Arrival> {
        let mut stream = Stream::new(seed, Purpose::Synthetic, 0, 0);
        let arrival = |number: usize| Arrival {
            position: DVec3::ZERO,
            from: from(&mut stream).as_vec3(),
            normal: Vec3::ZERO,
            power: 1.0,
            part: number % 3,
        };
        (0..count).map(arrival).collect()
    }

    fn uniform(stream: &mut Stream) -> DVec3 {
        warp::square_to_sphere(stream.pair())
    }

    /// Where light is the same from everywhere the photons' noise is not learned, however few they are and whatever scatters them: in 300
    /// cells not once. Of a surface light arrives by the cosine.
    #[test]
    fn noise_is_not_learned() {
        let normal = DVec3::new(0.3, -0.5, 0.8).normalize();
        let falling = |stream: &mut Stream| {
            Frame::new(normal).to_world(warp::square_to_cosine_hemisphere(stream.pair()))
        };
        let [even, forward] = [0.0, 0.7].map(|g| Phase::with_asymmetry(Asymmetry::try_from(g).unwrap()));
        for seed in 0..100 {
            let count = 8 << (seed % 8);
            assert!(lobe(&arrivals(count, seed, uniform), &Own::Medium(&even)).is_none(), "{seed}");
            assert!(lobe(&arrivals(count, seed, uniform), &Own::Medium(&forward)).is_none(), "{seed}");
            assert!(lobe(&arrivals(count, seed, falling), &Own::Surface(normal)).is_none(), "{seed}");
        }
    }

    /// Light from one small cone is learned as finely and as much as there is, from 60 photons on; half of it amid light from
    /// everywhere too.
    #[test]
    fn a_bright_place_is_learned() {
        let axis = DVec3::new(0.2, 0.7, 0.6).normalize();
        let narrow =
            |stream: &mut Stream| Frame::new(axis).to_world(warp::square_to_cone(stream.pair(), 1e-3));
        let half = |stream: &mut Stream| if stream.unit() < 0.5 { uniform(stream) } else { narrow(stream) };
        let even = Phase::with_asymmetry(Asymmetry::try_from(0.0).unwrap());
        for seed in 0..20 {
            for own in [Own::Medium(&even), Own::Surface(DVec3::Y)] {
                let alone = lobe(&arrivals(60, seed, narrow), &own).unwrap();
                assert_eq!(alone.share(), 0.5);
                // Half of it in one to four of 32 x 32 cells.
                assert!(alone.mixed(axis, warp::pdf_sphere()) > 50.0 * warp::pdf_sphere());
                assert!(lobe(&arrivals(600, seed, half), &own).unwrap().share() >= 0.25);
            }
        }
    }

    /// The second moment by hand: one cell of all light, half of the directions from there.
    #[test]
    fn the_second_moment_by_hand() {
        let cells = FINE * FINE;
        let mut part = vec![0.0; cells];
        part[17] = 1.0;
        let parts = [(); 3].map(|()| part.clone());
        let all: Masses = part.iter().map(|mass| 3.0 * mass).collect();
        let own = vec![1.0 / cells as f64; cells];
        let term = Term::new(own.clone(), &own, &parts, &all);
        // Each cell brings its mass: (3 x 1)^2 in one cell, and noise of 2 (3 / cells)^2 in each.
        let (n, noise) = (cells as f64, 2.0 * (3.0 / cells as f64) * (3.0 / cells as f64));
        let expected = |share: f64| {
            let bright = share + (1.0 - share) / n;
            3.0 * ((9.0 + noise) / bright + (n - 1.0) * noise / ((1.0 - share) / n))
        };
        for share in [0.0, 0.5] {
            let guides = parts.each_ref().map(|part| coarse(part, FINE));
            let found = term.second_moment(&guides, share);
            assert!((found / expected(share) - 1.0).abs() < 1e-12, "{share}: {found}");
        }
        let along = FINE / 8;
        assert_eq!(coarse(&part, 8)[18], 1.0 / (along * along) as f64);
    }
}
