//! The photons that a history leaves around each of its own, to all orders, in unbounded fog.

use super::Table;
use std::f64::consts::PI;
use turbid_analytic::InfiniteMedium;
use turbid_analytic::quadrature::GaussLegendre;

/// Nodes of a panel, and panels of the integral over x = s r: half a wave of the squared Bessel function each.
const NODES: usize = 8;
const PANELS: u32 = 60;
/// Ends of the pieces of the table \[mfp\].
const ENDS: [f64; 4] = [SMALLEST, 0.3, 1.5, LARGEST];
/// Radii between which it is tabulated \[mfp\].
pub const SMALLEST: f64 = 0.05;
pub const LARGEST: f64 = 8.0;

/// Largest wave number that is asked, a power of two above 60 pi/2 / [`SMALLEST`] = 1885, and halvings of it down to 2e-9,
/// where even without absorption, when the transform is 3/s^2, nothing is left of the integral.
const FASTEST: f64 = 2048.0;
const HALVINGS: i32 = 40;

/// The transform of the fluence about an isotropic source, tabulated: its singularities are imaginary, no nearer to a
/// piece from s to 2 s than s, so that sixteen points leave 1e-11 of it.
fn transform(medium: &InfiniteMedium) -> anyhow::Result<Table> {
    let ends = (0..=HALVINGS).map(|i| libm::ldexp(FASTEST, -i)).collect();
    Table::new(ends, |s| Ok(medium.transform(s)?.value))
}

/// Other photons of the same history around each photon of a ball, on average, against the ball's radius from
/// [`SMALLEST`] to [`LARGEST`], in unbounded fog with the Henyey-Greenstein phase function.
///
/// A photon of the ball scatters with probability w. Places in a ball have no preferred direction, so its followers are
/// on average those of an isotropic point source: w int phi(s) c(s) dV, with c(s) the chance that a place at distance s
/// of one in the ball is in the ball too; its forerunners are as many. In Fourier space, with V c the square of the
/// ball's transform V B, B = 3 j_1(x)/x at x = s r: eta = 2 w V/(2 pi^2) int s^2 transform(s) B^2 ds. Near a face some
/// leak out.
pub fn returns(albedo: f64, g: f64) -> anyhow::Result<Table> {
    let rule = GaussLegendre::new(NODES)?;
    let medium = InfiniteMedium::henyey_greenstein(albedo, g)?;
    let transform = transform(&medium)?;
    let eta = |r: f64| {
        let weight = |x: f64| {
            let bessel = if x < 1e-2 {
                1.0 - x * x / 10.0
            } else {
                3.0 * (libm::sin(x) - x * libm::cos(x)) / (x * x * x)
            };
            x * x * bessel * bessel * transform.at(x / r)
        };
        let step = 0.5 * PI;
        let sum: f64 =
            (0..PANELS).map(|i| rule.integrate(f64::from(i) * step, f64::from(i + 1) * step, weight)).sum();
        // Beyond, cos^2 is 1/2 on average and the transform pi/(2 s): int x^2 (9/2) x^-4 (pi r/(2x)) dx.
        let end = f64::from(PANELS) * step;
        let tail = 9.0 * PI * r / (8.0 * end * end);
        // V/(2 pi^2 r^3) = 2/(3 pi).
        2.0 * albedo * 2.0 / (3.0 * PI) * (sum + tail)
    };
    Table::new(ENDS.to_vec(), |r| Ok(eta(r)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_tabulated_transform() {
        for (albedo, g) in [(0.5, 0.0), (0.99, 0.75), (0.9, -0.5), (1.0, 0.0)] {
            let medium = InfiniteMedium::henyey_greenstein(albedo, g).unwrap();
            let table = transform(&medium).unwrap();
            for i in 0..300 {
                let s = 1e-6 * libm::pow(10.0, 0.031 * f64::from(i));
                let direct = medium.transform(s).unwrap().value;
                assert!(
                    (table.at(s) / direct - 1.0).abs() < 1e-10,
                    "{albedo} {g} {s}: {}",
                    table.at(s) / direct
                );
            }
        }
    }

    /// The first two orders of the radius in closed form. The next collision is inside with 3/4 r - 2/5 r^2 on average;
    /// in isotropic fog the next but one has, near its forerunner, the density pi/(16 s), wherever the one between them
    /// was, in the ball or outside: int 4 pi s^2 pi/(16 s) c(s) ds = pi^2/10 r^2. What is left is of the order r^3 ln r.
    #[test]
    fn small_balls_hold_the_first_orders() {
        for w in [0.5, 0.9, 0.99] {
            let table = returns(w, 0.0).unwrap();
            for r in [0.05, 0.06] {
                let first = 2.0 * w * (0.75 * r - 0.4 * r * r) + 0.2 * PI * PI * w * w * r * r;
                let difference = table.at(r) - first;
                let next = r * r * r * libm::log(1.0 / r);
                assert!(difference.abs() < next, "albedo {w}, r {r}: {difference}");
            }
        }
    }

    /// No sum over orders: without scattering to come, nobody follows; one order alone is <1 - e^-L>.
    #[test]
    fn thin_fog_has_the_next_collision_alone() {
        let w = 1e-6;
        let table = returns(w, 0.5).unwrap();
        for r in [0.1, 1.0, 4.0f64] {
            // <1 - e^-L> over a ball: 1 - 3/(8 r^3) (2 r^2 - 1 + (1 + 2r) e^-2r), its escape probability.
            let escape =
                3.0 / (8.0 * r * r * r) * (2.0 * r * r - 1.0 + (1.0 + 2.0 * r) * libm::exp(-2.0 * r));
            let exact = 2.0 * w * (1.0 - escape);
            // The tail's oscillation, (x end)^-3, and cancellation in the closed form at r = 0.1.
            assert!((table.at(r) / exact - 1.0).abs() < 1e-4, "r {r}: {} {exact}", table.at(r));
        }
    }
}
