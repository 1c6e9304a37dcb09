//! Bodies of fog in which light depends on the distance from the surface alone, and balls in them.

use super::{Exact, Table, referee_kernel};
use glam::DVec3;
use std::f64::consts::PI;
use turbid::estimators::Kernel;
use turbid::geometry::{Shape, Slab, Sphere};
use turbid_analytic::boundary::{Body, Treatment, body_moment, treated_mean_symmetric, treated_mean_uniform};
use turbid_analytic::quadrature::GaussLegendre;
use turbid_analytic::slab_kernel::{edge_loss, slab_moment};
use turbid_analytic::volumes::{ball_slab_volume, lens_volume};

/// A body of fog; places in it are given by their depth below the surface (in the slab: below the face at depth 0).
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Fog {
    /// Between two faces, unbounded along them.
    Slab {
        /// Optical thickness.
        thickness: f64,
    },
    /// A ball.
    Sphere {
        /// Radius \[mfp\].
        radius: f64,
    },
}

/// Directions spread evenly over the sphere (Swinbank and Purser 2006); the nearest two are 3.09/sqrt(n) apart.
pub fn spiral(n: usize) -> impl Iterator<Item = DVec3> {
    let golden = PI * (3.0 - 5.0_f64.sqrt());
    (0..n).map(move |i| {
        let z = 1.0 - (2.0 * i as f64 + 1.0) / n as f64;
        let (sin, cos) = turbid::math::sin_cos(golden * i as f64);
        let across = (1.0 - z * z).sqrt();
        DVec3::new(across * cos, across * sin, z)
    })
}

/// Nodes of a panel in integrals over depth.
const NODES: usize = 8;

impl Fog {
    /// The body as the referee knows it.
    pub fn body(self) -> Body {
        match self {
            Fog::Slab { thickness } => Body::Slab { thickness },
            Fog::Sphere { radius } => Body::Sphere { radius },
        }
    }

    /// The deepest place.
    pub fn deepest(self) -> f64 {
        match self {
            Fog::Slab { thickness } => thickness,
            Fog::Sphere { radius } => radius,
        }
    }

    /// The distance to the nearest point of the surface.
    pub fn room(self, depth: f64) -> f64 {
        match self {
            Fog::Slab { thickness } => depth.min(thickness - depth),
            Fog::Sphere { .. } => depth,
        }
    }

    /// One of the places at a depth.
    pub fn place(self, depth: f64) -> [f64; 3] {
        match self {
            Fog::Slab { .. } => [0.0, 0.0, depth],
            Fog::Sphere { radius } => [0.0, 0.0, radius - depth],
        }
    }

    /// The body as the simulator knows it: a slab from z = 0 down, a ball about the origin.
    pub fn shape(self) -> turbid::Result<Shape> {
        Ok(match self {
            Fog::Slab { thickness } => Shape::Slab(Slab::new(0.0, thickness)?),
            Fog::Sphere { radius } => Shape::Sphere(Sphere::new(DVec3::ZERO, radius)?),
        })
    }

    /// A field of depth as one of the referee's coordinate: the depth in a slab, the distance from the centre in a ball.
    pub fn field(self, exact: &Exact) -> impl Fn(f64) -> f64 {
        move |x: f64| {
            let depth = if let Fog::Sphere { radius } = self { radius - x } else { x };
            exact(depth).map_or(f64::NAN, |(value, _)| value)
        }
    }

    /// Radii of a ball at a depth where more of the surface comes in.
    fn corners(self, depth: f64) -> [f64; 2] {
        match self {
            Fog::Slab { thickness } => [depth, thickness - depth],
            Fog::Sphere { radius } => [depth, 2.0 * radius - depth],
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
            Fog::Slab { thickness } => Table::of_kernel_means(kernel, depth, thickness, most, exact),
            Fog::Sphere { .. } => Table::of_means(most, &self.corners(depth), |r| {
                let (body, at) = (self.body(), self.place(depth));
                Ok(treated_mean_symmetric(Treatment::None, kernel, body, at, r, self.field(exact))?.value)
            }),
        }
    }

    /// int_O K_r: what a uniform field of 1 reads.
    pub(super) fn mass(self, kernel: Kernel, radius: f64, depth: f64) -> anyhow::Result<f64> {
        let kernel = referee_kernel(kernel);
        Ok(match self {
            Fog::Slab { thickness } => slab_moment(kernel, 0, radius, depth, thickness)?.value,
            Fog::Sphere { .. } if radius <= depth => 1.0,
            Fog::Sphere { .. } if kernel == turbid_analytic::Kernel::Uniform => self.inside(radius, depth)?,
            Fog::Sphere { .. } => body_moment(kernel, self.body(), self.place(depth), radius, 0)?.value,
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
        if let Fog::Slab { thickness } = self {
            let split = edge_loss(kernel, radius, depth, thickness, field)?;
            return Ok([(split.edge.value, split.edge.error), (split.blur.value, split.blur.error)]);
        }
        let (here, _) = exact(depth)?;
        let (plain, body, at) = (Treatment::None, self.body(), self.place(depth));
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
            Fog::Slab { thickness } => ball_slab_volume(radius, depth, thickness)?,
            Fog::Sphere { radius: whole } => lens_volume(whole, radius, whole - depth)?,
        };
        Ok(volume.value / ball)
    }

    /// Mean chord of the part of a ball that lies in the fog, over that of the whole ball: four times its volume over
    /// its surface (Cauchy).
    pub fn chord(self, radius: f64, depth: f64) -> f64 {
        match self {
            Fog::Slab { thickness } => {
                let (up, down) = ((depth / radius).min(1.0), ((thickness - depth) / radius).min(1.0));
                let volume = 0.75 * (up + down) - 0.25 * (up * up * up + down * down * down);
                let surface = 0.5 * (up + down) + 0.25 * (2.0 - up * up - down * down);
                volume / surface
            }
            Fog::Sphere { .. } if radius <= depth => 1.0,
            Fog::Sphere { radius: whole } => {
                let ball = 4.0 / 3.0 * PI * radius * radius * radius;
                let volume = self.inside(radius, depth).map_or(f64::NAN, |part| part * ball);
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
        }
    }

    /// The integral of a field over the fog, per area of a slab's face, by panels of equal depth. It bends like t ln t at
    /// the surface: 64 panels leave 10^-6 of it, 16 leave 10^-5.
    pub fn total(self, exact: &Exact, panels: u32) -> anyhow::Result<f64> {
        let rule = GaussLegendre::new(NODES)?;
        let step = self.deepest() / f64::from(panels);
        let weighted = |depth: f64| {
            let fluence = exact(depth).map_or(f64::NAN, |(value, _)| value);
            match self {
                Fog::Slab { .. } => fluence,
                Fog::Sphere { radius } => fluence * 4.0 * PI * (radius - depth) * (radius - depth),
            }
        };
        Ok((0..panels).map(|i| rule.integrate(f64::from(i) * step, f64::from(i + 1) * step, weighted)).sum())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spirals_keep_their_distance() {
        for n in [10, 50, 500] {
            let places: Vec<DVec3> = spiral(n).collect();
            let least = (0..n)
                .flat_map(|i| (0..i).map(move |j| (i, j)))
                .map(|(i, j)| places[i].distance(places[j]))
                .fold(f64::INFINITY, f64::min);
            // Far from the poles it is 3.09; the two places at a pole are nearer.
            assert!(least * (n as f64).sqrt() > 2.0, "{n}: {}", least * (n as f64).sqrt());
        }
    }

    #[test]
    fn chords_of_whole_and_half_balls() {
        let thick = Fog::Slab { thickness: 8.0 };
        assert_eq!(thick.chord(0.5, 4.0), 1.0);
        // Half a ball: (2/3 pi) over (3 pi), a ball (4/3 pi) over (4 pi): two thirds.
        assert!((thick.chord(0.5, 0.0) - 2.0 / 3.0).abs() < 1e-15);
        // A thin disc of thickness d has the chord 2 d.
        let thin = Fog::Slab { thickness: 0.5 };
        let wide = thin.chord(400.0, 0.25) * 400.0 * 4.0 / 3.0;
        assert!((wide - 1.0).abs() < 2e-3, "{wide}");
    }

    #[test]
    fn chords_in_a_sphere() {
        let sphere = Fog::Sphere { radius: 2.0 };
        assert_eq!(sphere.chord(0.5, 0.5), 1.0);
        // Small balls on the surface see a flat face, to first order in radius over radius.
        assert!((sphere.chord(1e-4, 0.0) - 2.0 / 3.0).abs() < 1e-4);
        // A ball that holds the fog: the fog's own chord, 4/3 of its radius.
        assert!((sphere.chord(5.0, 1.0) * 5.0 - 2.0).abs() < 1e-12);
        // Two equal balls through each other's centres: volume 5 pi/12 a^3, surface 2 pi a^2.
        assert!((sphere.chord(2.0, 0.0) - 4.0 * 5.0 / 12.0 / 2.0 * 0.75).abs() < 1e-14);
    }

    /// A quadratic field in closed form: in whole balls 1 - b (x^2 + 3/5 r^2), at a distance x from the centre; and the
    /// tables and the parts say the same as the referee.
    #[test]
    fn a_field_that_bends_in_a_sphere() {
        let (sphere, b) = (Fog::Sphere { radius: 2.0 }, 0.1);
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
                sphere.body(),
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
