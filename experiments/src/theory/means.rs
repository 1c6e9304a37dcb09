//! Means over balls in a body in which light depends on the depth alone.

use super::{Exact, Table, referee_kernel};
use crate::setups::{Body, CELL};
use anyhow::bail;
use std::f64::consts::PI;
use turbid::estimators::Kernel;
use turbid_analytic::boundary::{Treatment, body_moment, treated_mean_symmetric, treated_mean_uniform};
use turbid_analytic::quadrature::GaussLegendre;
use turbid_analytic::slab_kernel::{edge_loss, slab_moment};
use turbid_analytic::volumes::{ball_slab_volume, lens_volume};

/// Nodes of a panel in integrals over depth.
const NODES: usize = 8;

impl Body {
    /// A field of depth as one of the referee's coordinate: the depth in a slab, the distance from the centre in a ball.
    pub fn field(self, exact: &Exact) -> impl Fn(f64) -> f64 {
        move |x: f64| {
            let depth = if let Body::Sphere { radius } = self { radius - x } else { x };
            exact(depth).map_or(f64::NAN, |(value, _)| value)
        }
    }

    /// Radii of a ball at a depth where more of the surface comes in.
    fn corners(self, depth: f64) -> [f64; 2] {
        match self {
            Body::Slab { thickness } => [depth, thickness - depth],
            Body::Sphere { radius } => [depth, 2.0 * radius - depth],
            Body::Cuboid { edges: [.., c] } => [depth, c - depth],
        }
    }

    /// The table of int_O K_r f against r at one depth, up to r = `most`.
    pub(super) fn kernel_means(
        self,
        kernel: Kernel,
        depth: f64,
        most: f64,
        exact: &Exact,
    ) -> anyhow::Result<Table> {
        let kernel = referee_kernel(kernel);
        match self {
            Body::Slab { thickness } => Table::of_kernel_means(kernel, depth, thickness, most, exact),
            Body::Sphere { .. } | Body::Cuboid { .. } => Table::of_means(most, &self.corners(depth), |r| {
                let (body, at) = (self.referee(), self.place(depth));
                Ok(treated_mean_symmetric(Treatment::None, kernel, body, at, r, self.field(exact))?.value)
            }),
        }
    }

    /// int_O K_r: what a uniform field of 1 reads.
    pub(super) fn mass(self, kernel: Kernel, radius: f64, depth: f64) -> anyhow::Result<f64> {
        let kernel = referee_kernel(kernel);
        Ok(match self {
            Body::Slab { thickness } => slab_moment(kernel, 0, radius, depth, thickness)?.value,
            Body::Sphere { .. } if radius <= depth => 1.0,
            Body::Sphere { .. } if kernel == turbid_analytic::Kernel::Uniform => {
                self.inside(radius, depth)?
            }
            Body::Sphere { .. } | Body::Cuboid { .. } => {
                body_moment(kernel, self.referee(), self.place(depth), radius, 0)?.value
            }
        })
    }

    /// int_O K_r f in two parts with their bounds: what is missing of a uniform field, and all else.
    pub(super) fn parts(
        self,
        kernel: Kernel,
        radius: f64,
        depth: f64,
        exact: &Exact,
    ) -> anyhow::Result<[(f64, f64); 2]> {
        let (kernel, field) = (referee_kernel(kernel), self.field(exact));
        if let Body::Slab { thickness } = self {
            let split = edge_loss(kernel, radius, depth, thickness, field)?;
            return Ok([(split.edge.value, split.edge.error), (split.blur.value, split.blur.error)]);
        }
        let (here, _) = exact(depth)?;
        let (plain, body, at) = (Treatment::None, self.referee(), self.place(depth));
        let mean = treated_mean_symmetric(plain, kernel, body, at, radius, field)?;
        if radius <= depth {
            return Ok([(0.0, 0.0), (mean.value - here, mean.error)]);
        }
        let uniform = treated_mean_uniform(plain, kernel, body, at, radius)?;
        let bound = here * uniform.error;
        let edge = here * (uniform.value - 1.0);
        Ok([(edge, bound), (mean.value - here * uniform.value, mean.error + bound)])
    }

    /// The part of a ball that lies in the fog.
    pub fn inside(self, radius: f64, depth: f64) -> anyhow::Result<f64> {
        let ball = 4.0 / 3.0 * PI * radius * radius * radius;
        let volume = match self {
            Body::Slab { thickness } => ball_slab_volume(radius, depth, thickness)?,
            Body::Sphere { radius: whole } => lens_volume(whole, radius, whole - depth)?,
            Body::Cuboid { .. } => return self.mass(Kernel::Uniform, radius, depth),
        };
        Ok(volume.value / ball)
    }

    /// Mean chord of the part of a ball that lies in the fog, over that of the whole ball: four times its volume over
    /// its surface (Cauchy).
    ///
    /// # Errors
    /// In a cuboid, where it is not known.
    pub fn chord(self, radius: f64, depth: f64) -> anyhow::Result<f64> {
        Ok(match self {
            Body::Slab { thickness } => {
                let (up, down) = ((depth / radius).min(1.0), ((thickness - depth) / radius).min(1.0));
                let volume = 0.75 * (up + down) - 0.25 * (up * up * up + down * down * down);
                let surface = 0.5 * (up + down) + 0.25 * (2.0 - up * up - down * down);
                volume / surface
            }
            Body::Sphere { .. } if radius <= depth => 1.0,
            Body::Sphere { radius: whole } => {
                let ball = 4.0 / 3.0 * PI * radius * radius * radius;
                let volume = self.inside(radius, depth)? * ball;
                let away = whole - depth;
                // Caps of the ball inside the fog and of the fog's surface inside the ball: 2 pi radius times height.
                let (own, other) = if away + whole <= radius {
                    (0.0, 4.0 * PI * whole * whole)
                } else {
                    let height = (whole - radius + away) * (whole + radius - away) / (2.0 * away);
                    let beyond = (radius - whole + away) * (radius + whole - away) / (2.0 * away);
                    (2.0 * PI * radius * height, 2.0 * PI * whole * beyond)
                };
                4.0 * volume / (own + other) / (4.0 / 3.0 * radius)
            }
            Body::Cuboid { .. } => bail!("the mean chord of a ball in a cuboid is not known"),
        })
    }

    /// The integral of a field over the body, of a slab over the cell, by panels of equal depth. It bends like t ln t at
    /// the surface: 64 panels leave 10^-6 of it, 16 leave 10^-5.
    ///
    /// # Errors
    /// In a cuboid, whose light does not depend on the depth alone.
    pub fn total(self, exact: &Exact, panels: u32) -> anyhow::Result<f64> {
        let rule = GaussLegendre::new(NODES)?;
        let step = self.deepest() / f64::from(panels);
        let fluence = |depth: f64| exact(depth).map_or(f64::NAN, |(value, _)| value);
        let integral = |weighted: &dyn Fn(f64) -> f64| -> f64 {
            (0..panels).map(|i| rule.integrate(f64::from(i) * step, f64::from(i + 1) * step, weighted)).sum()
        };
        match self {
            Body::Slab { .. } => Ok(CELL * CELL * integral(&fluence)),
            Body::Sphere { radius } => {
                Ok(integral(&|depth| fluence(depth) * 4.0 * PI * (radius - depth) * (radius - depth)))
            }
            Body::Cuboid { .. } => bail!("in a cuboid light does not depend on the depth alone"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn chords_of_whole_and_half_balls() {
        let thick = Body::Slab { thickness: 8.0 };
        assert_eq!(thick.chord(0.5, 4.0).unwrap(), 1.0);
        // Half a ball: (2/3 pi) over (3 pi), a ball (4/3 pi) over (4 pi): two thirds.
        assert!((thick.chord(0.5, 0.0).unwrap() - 2.0 / 3.0).abs() < 1e-15);
        // A thin disc of thickness d has the chord 2 d.
        let thin = Body::Slab { thickness: 0.5 };
        let wide = thin.chord(400.0, 0.25).unwrap() * 400.0 * 4.0 / 3.0;
        assert!((wide - 1.0).abs() < 2e-3, "{wide}");
    }

    #[test]
    fn chords_in_a_sphere() {
        let sphere = Body::Sphere { radius: 2.0 };
        assert_eq!(sphere.chord(0.5, 0.5).unwrap(), 1.0);
        // Small balls on the surface see a flat face, to first order in radius over radius.
        assert!((sphere.chord(1e-4, 0.0).unwrap() - 2.0 / 3.0).abs() < 1e-4);
        // A ball that holds the fog: the fog's own chord, 4/3 of its radius.
        assert!((sphere.chord(5.0, 1.0).unwrap() * 5.0 - 2.0).abs() < 1e-12);
        // Two equal balls through each other's centres: volume 5 pi/12 a^3, surface 2 pi a^2.
        assert!((sphere.chord(2.0, 0.0).unwrap() - 4.0 * 5.0 / 12.0 / 2.0 * 0.75).abs() < 1e-14);
    }

    /// A quadratic field in closed form: in whole balls 1 - b (x^2 + 3/5 r^2), at a distance x from the centre; and the
    /// tables and the parts say the same as the referee.
    #[test]
    fn a_field_that_bends_in_a_sphere() {
        let (sphere, b) = (Body::Sphere { radius: 2.0 }, 0.1);
        let exact: Exact = Box::new(move |depth| Ok((1.0 - b * (2.0 - depth) * (2.0 - depth), 0.0)));
        let (depth, r) = (1.0, 0.7);
        let mean = 1.0 - b * (1.0 + 0.6 * r * r);
        let [edge, blur] = sphere.parts(Kernel::Uniform, r, depth, &exact).unwrap();
        assert_eq!(edge.0, 0.0);
        assert!((blur.0 - (mean - (1.0 - b))).abs() < 1e-12);
        let table = sphere.kernel_means(Kernel::Uniform, depth, 1.5, &exact).unwrap();
        assert!((table.at(r) - mean).abs() < 1e-9);
        // Cut balls: the parts add up to the table.
        for r in [1.1, 1.4] {
            let [edge, blur] = sphere.parts(Kernel::Uniform, r, depth, &exact).unwrap();
            assert!((table.at(r) - (1.0 - b) - edge.0 - blur.0).abs() < 1e-9, "radius {r}");
            let mass = sphere.mass(Kernel::Uniform, r, depth).unwrap();
            assert!((edge.0 / (1.0 - b) + 1.0 - mass).abs() < 1e-10, "radius {r}");
            let cut = treated_mean_uniform(
                Treatment::None,
                referee_kernel(Kernel::Cone),
                sphere.referee(),
                sphere.place(depth),
                r,
            );
            assert!((sphere.mass(Kernel::Cone, r, depth).unwrap() - cut.unwrap().value).abs() < 1e-9);
        }
        // Volume of the ball less b times its second moment 4/5 pi a^5.
        let whole = 4.0 / 3.0 * PI * 8.0 - b * 0.8 * PI * 32.0;
        assert!((sphere.total(&exact, 16).unwrap() / whole - 1.0).abs() < 1e-13);
    }
}
