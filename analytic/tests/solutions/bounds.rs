//! How large the bounds of the answers are beside what two methods differ by, family by family.
//!
//! That a difference lies within both bounds says nothing of a bound that is a thousand times too wide, nor of one that a
//! change made ten times too small and that chance keeps. So two numbers of each family are on record: the largest
//! difference over both bounds together, and the mean of log10 of the bound over the value. Elementary functions come from
//! `libm`, so that both are the same on every machine; a change of method moves them, and has to say so here.

use crate::support::kernels::BALL;
use crate::support::table::{number, rows};
use crate::support::{NORMAL, beam};
use std::f64::consts::PI;
use turbid_analytic::beams::{Pairing, blurred_field};
use turbid_analytic::boundary::{Body, body_moment};
use turbid_analytic::nearest::{nearest_expectation_exponential, nearest_moments, nearest_variance_uniform};
use turbid_analytic::quadrature::GaussLegendre;
use turbid_analytic::slab_kernel::face_moment;
use turbid_analytic::volumes::lens_volume;
use turbid_analytic::{
    AddingDoubling, AnisotropicMedium, Asymptotics, Critical, CriticalShape, Dimension, FresnelSlab,
    HalfSpace, Incidence, InfiniteMedium, IsotropicSlab, Kernel, Phase, ScatteringOrders, Sphere,
    SphereSource, Value, XAndY,
};

/// What is seen of a family.
#[derive(Default)]
struct Seen {
    /// Largest difference over both bounds.
    worst: f64,
    /// Sum of log10 of bounds over values, and how many there are.
    logs: f64,
    count: u32,
}

impl Seen {
    /// An answer against a number whose own bound is known.
    fn against(&mut self, a: Value, value: f64, error: f64) {
        self.worst = self.worst.max((a.value - value).abs() / (a.error + error));
        // A bound of a number that is exact says nothing.
        if a.error > 0.0 && a.value != 0.0 {
            self.logs += libm::log10(a.error / a.value.abs());
            self.count += 1;
        }
    }

    /// An answer of the family against that of the second method.
    fn push(&mut self, a: Value, b: Value) {
        self.against(a, b.value, b.error);
    }
}

const LIGHTS: [Incidence; 3] = [NORMAL, Incidence::Beam { mu0: 0.1 }, Incidence::Diffuse];

fn phase(g: f64) -> Phase {
    Phase::henyey_greenstein(g).unwrap()
}

/// Peierls' equation against adding and doubling.
fn isotropic_slab(seen: &mut Seen) {
    for (i, tau) in [1e-3, 0.1, 1.0].into_iter().enumerate() {
        for (j, albedo) in [0.5, 0.9, 1.0].into_iter().enumerate() {
            let light = LIGHTS[(i + j) % 3];
            let a = IsotropicSlab::new(tau, albedo, light).unwrap();
            let b = AddingDoubling::with_phase(tau, albedo, &Phase::isotropic(), light).unwrap();
            seen.push(a.reflectance(), b.reflectance());
            seen.push(a.transmittance_diffuse(), b.transmittance_diffuse());
            for share in [0.0, 0.3, 1.0] {
                seen.push(a.fluence(share * tau).unwrap(), b.fluence(share * tau).unwrap());
            }
        }
    }
}

/// Discrete ordinates against adding and doubling.
fn anisotropic_slab(seen: &mut Seen) {
    for (i, (albedo, g)) in [(0.9, 0.5), (1.0, 0.75), (0.5, -0.5), (0.999, 0.3)].into_iter().enumerate() {
        let medium = AnisotropicMedium::new(albedo, &phase(g)).unwrap();
        for tau in [1e-3, 1.0] {
            let light = LIGHTS[i % 3];
            let a = medium.slab(tau, light).unwrap();
            let b = AddingDoubling::with_phase(tau, albedo, medium.phase(), light).unwrap();
            seen.push(a.reflectance(), b.reflectance());
            seen.push(a.transmittance_diffuse(), b.transmittance_diffuse());
            for share in [0.0, 0.4, 1.0] {
                seen.push(a.fluence(share * tau).unwrap(), b.fluence(share * tau).unwrap());
            }
        }
    }
}

/// Light sent back: the beam and the eye change places.
fn radiance(seen: &mut Seen) {
    for (tau, albedo, g) in [(1.5, 0.9, 0.6), (0.1, 1.0, -0.5)] {
        let medium = AnisotropicMedium::new(albedo, &phase(g)).unwrap();
        for (a, b, dphi) in [(0.9, 0.2, 0.7), (0.35, 0.6, 3.0)] {
            let (one, other) = (medium.slab(tau, beam(a)).unwrap(), medium.slab(tau, beam(b)).unwrap());
            for (t, sign) in [(0.0, 1.0), (tau, -1.0)] {
                seen.push(
                    one.radiance(t, sign * b, dphi).unwrap(),
                    other.radiance(t, sign * a, dphi).unwrap(),
                );
            }
        }
    }
}

/// Successive orders on rays against orders of the integral equation.
fn orders(seen: &mut Seen) {
    for (tau, mu0) in [(1e-3, 0.2), (1.0, 0.7), (10.0, 1.0)] {
        let ours = ScatteringOrders::new(tau, 0.9, &Phase::isotropic(), beam(mu0)).unwrap();
        let theirs = IsotropicSlab::new(tau, 0.9, beam(mu0)).unwrap();
        for n in [1, 2, 5] {
            seen.push(ours.reflectance(n).unwrap(), theirs.reflectance_of_order(n).unwrap());
            seen.push(ours.transmittance(n).unwrap(), theirs.transmittance_of_order(n).unwrap());
            for share in [0.1, 0.5, 0.9] {
                let t = share * tau;
                seen.push(ours.fluence(n, t).unwrap(), theirs.fluence_of_order(n, t).unwrap());
            }
        }
    }
}

/// Discrete ordinates against doubled kernels.
fn fresnel_slab(seen: &mut Seen) {
    for (tau, albedo, g, index, light) in [
        (1.0, 0.9, 0.75, 1.33, Incidence::Beam { mu0: 0.1 }),
        (1.0, 1e-3, 0.0, 1.5, Incidence::Diffuse),
        (0.1, 0.99, 0.0, 2.4, NORMAL),
    ] {
        let a = FresnelSlab::with_phase(tau, albedo, &phase(g), index, light).unwrap();
        let b = FresnelSlab::by_doubling(tau, albedo, &phase(g), index, light).unwrap();
        seen.push(a.reflectance_diffuse(), b.reflectance_diffuse());
        seen.push(a.transmittance_diffuse(), b.transmittance_diffuse());
        seen.push(a.absorptance(), b.absorptance());
        for share in [0.0, 0.5, 1.0] {
            seen.push(a.fluence(tau * share).unwrap(), b.fluence(tau * share).unwrap());
        }
    }
}

/// A table is known to half a unit of its last digit, 16 digits at most.
fn against_row(seen: &mut Seen, got: Value, row: &crate::support::table::Row) {
    let value = number(row, "value");
    let unit = libm::pow(10.0, -number(row, "digits").min(16.0)) * value.abs();
    seen.against(got, value, 0.5 * unit);
}

/// The integral for H against the table.
fn half_space(seen: &mut Seen) {
    for row in rows("halfspace_H.csv", 30) {
        let quantity = row["quantity"].as_str();
        if quantity == "H" || quantity == "R_plane" {
            let space = HalfSpace::new(number(&row, "w")).unwrap();
            let got = match quantity {
                "H" => space.h(number(&row, "mu")).unwrap(),
                _ => space.reflectance(beam(number(&row, "mu0"))).unwrap(),
            };
            against_row(seen, got, &row);
        }
    }
}

/// X and Y, grown in depth, against Peierls' equation.
fn x_and_y(seen: &mut Seen) {
    for (tau, albedo) in [(0.1, 0.9), (1.0, 0.5), (2.0, 1.0)] {
        let layers = XAndY::new(tau, albedo).unwrap();
        for mu0 in [0.2, 1.0] {
            let slab = IsotropicSlab::new(tau, albedo, beam(mu0)).unwrap();
            let [back, through] = layers.fluxes(mu0).unwrap();
            seen.push(back, slab.reflectance());
            seen.push(through, slab.transmittance());
        }
    }
}

/// Asymptotic constants in closed form against ordinates.
fn thick(seen: &mut Seen) {
    for albedo in [0.5, 0.9, 0.999_999, 1.0] {
        let a = Asymptotics::isotropic(albedo).unwrap();
        let b = Asymptotics::new(albedo, &phase(0.0)).unwrap();
        seen.push(a.m(), b.m());
        seen.push(a.n(), b.n());
        seen.push(a.l(), b.l());
        seen.push(a.extrapolation_length(), b.extrapolation_length());
    }
}

/// Shells against the table.
fn sphere(seen: &mut Seen) {
    for row in rows("sphere.csv", 91) {
        let quantity = row["quantity"].as_str();
        let source = match quantity {
            q if q.contains("uniform") => SphereSource::Uniform,
            q if q.contains("iso_incidence") => SphereSource::Incident,
            _ => SphereSource::Centre,
        };
        let is_flux = quantity.starts_with("escape") || quantity.starts_with("absorbed");
        if is_flux && number(&row, "a") < 5.0 {
            let sphere = Sphere::new(number(&row, "a"), number(&row, "w"), source).unwrap();
            let got = if quantity.starts_with("escape") { sphere.escape() } else { sphere.absorptance() };
            against_row(seen, got, &row);
        }
    }
}

/// Discrete ordinates against the table.
fn critical(seen: &mut Seen) {
    for row in rows("critical.csv", 15) {
        let shape = match row["geometry"].as_str() {
            "critical_slab" => CriticalShape::Slab,
            _ => CriticalShape::Sphere,
        };
        let critical = Critical::new(shape, number(&row, "w")).unwrap();
        let got = match row["quantity"].as_str() {
            "flux_ratio" => critical.flux_ratio(number(&row, "r")).unwrap(),
            _ => critical.size(),
        };
        against_row(seen, got, &row);
    }
}

/// Modes and continuum against the table.
fn infinite(seen: &mut Seen) {
    for row in rows("infinite.csv", 31) {
        let medium = || InfiniteMedium::henyey_greenstein(number(&row, "w"), number(&row, "g")).unwrap();
        match row["quantity"].as_str() {
            "diffusion_exponent_k" => against_row(seen, medium().decays()[0], &row),
            "fluence_point" => against_row(seen, medium().fluence(number(&row, "r")).unwrap(), &row),
            _ => {}
        }
    }
}

/// Cut kernels by quadrature against their closed forms at a flat face.
fn kernels(seen: &mut Seen) {
    for kernel in [Kernel::Uniform, Kernel::Epanechnikov, Kernel::Biweight, Kernel::Cone { kappa: 1.0 }] {
        for h in [0.0, 0.1, 0.3] {
            for j in 0..3 {
                let got = body_moment(kernel, Body::HalfSpace, [3.0, -7.0, h], 0.4, j).unwrap();
                seen.push(got, face_moment(kernel, j, h / 0.4).unwrap());
            }
        }
    }
}

/// The law of H against discrete ordinates, at the face and below it.
fn half_space_fields(seen: &mut Seen) {
    for albedo in [0.3, 0.9, 1.0] {
        let space = HalfSpace::new(albedo).unwrap();
        let medium = AnisotropicMedium::new(albedo, &Phase::isotropic()).unwrap();
        for light in LIGHTS {
            let ordinates = medium.half_space(light).unwrap();
            for mu in [0.05, 0.5, 1.0] {
                seen.push(space.radiance(light, mu).unwrap(), ordinates.radiance(0.0, mu, 0.0).unwrap());
            }
            for t in [0.0, 0.1, 2.0] {
                seen.push(space.fluence(light, t).unwrap(), ordinates.fluence(t).unwrap());
            }
        }
    }
}

/// Shells against the table: fluence, or the radiance that leaves.
fn sphere_fields(seen: &mut Seen, wanted: &str) {
    for row in rows("sphere.csv", 91) {
        let quantity = row["quantity"].as_str();
        let source = match quantity {
            q if q.contains("uniform") => SphereSource::Uniform,
            q if q.contains("iso_incidence") => SphereSource::Incident,
            _ => SphereSource::Centre,
        };
        if quantity.starts_with(wanted) && number(&row, "a") < 5.0 {
            let sphere = Sphere::new(number(&row, "a"), number(&row, "w"), source).unwrap();
            let got = match wanted {
                "fluence" => sphere.fluence(number(&row, "r")),
                _ => sphere.exit_radiance(number(&row, "mu")),
            };
            against_row(seen, got.unwrap(), &row);
        }
    }
}

fn sphere_fluence(seen: &mut Seen) {
    sphere_fields(seen, "fluence");
}

fn sphere_radiance(seen: &mut Seen) {
    sphere_fields(seen, "exit_radiance");
}

/// Cut kernels by quadrature against lenses, and against what a face, an edge and a corner leave.
fn moments_in_bodies(seen: &mut Seen) {
    for (a, distance, r) in [(0.3, 0.05, 0.5), (1.0, 0.29, 0.8), (2.0, 1.9, 0.2), (1.0, 1.0, 0.5)] {
        let at = [distance * 0.6, 0.0, -distance * 0.8];
        let got = body_moment(Kernel::Uniform, Body::Sphere { radius: a }, at, r, 0).unwrap();
        let lens = lens_volume(a, r, distance).unwrap();
        let ball = BALL * r * r * r;
        seen.against(got, lens.value / ball, lens.error / ball);
    }
    let body = Body::Cuboid { edges: [3.0, 2.0, 4.0] };
    for kernel in [Kernel::Uniform, Kernel::Epanechnikov, Kernel::Cone { kappa: 1.0 }] {
        let moment = |at, j| body_moment(kernel, body, at, 0.4, j).unwrap();
        for h in [0.1, 0.3] {
            for j in 0..3 {
                seen.push(moment([1.5, 1.0, h], j), face_moment(kernel, j, h / 0.4).unwrap());
            }
        }
        seen.against(moment([0.0, 2.0, 2.0], 0), 0.25, 0.0);
        seen.against(moment([3.0, 0.0, 4.0], 0), 0.125, 0.0);
        let face = face_moment(kernel, 1, 0.0).unwrap();
        seen.against(moment([3.0, 0.0, 4.0], 1), 0.25 * face.value, 0.25 * face.error);
    }
}

/// Beams and rays in an exponential field: series against products of Gauss rules.
fn beams(seen: &mut Seen) {
    let pairings = [
        (Pairing::PointPoints, Dimension::Three),
        (Pairing::RayPoints, Dimension::Two),
        (Pairing::RayBeams { sine: 0.5 }, Dimension::One),
    ];
    for (pairing, d) in pairings {
        let share = 1.0 / f64::from(d.number()).sqrt();
        for kernel in [Kernel::Uniform, Kernel::Epanechnikov, Kernel::Cone { kappa: 1.0 }] {
            for x in [0.1, -2.0, 5.0] {
                let field = |p: [f64; 3]| libm::exp(x * share * (p[0] + p[1] + p[2]));
                seen.push(
                    pairing.exponential_mean(kernel, x).unwrap(),
                    blurred_field(kernel, d, 1.0, field).unwrap(),
                );
            }
        }
    }
}

/// The k nearest in the field e^(b z), over the points expected within a radius, against the same over the radius, in closed
/// form but for one integral; the variance in a uniform field against 1/(k-2).
fn nearest(seen: &mut Seen) {
    let rule = GaussLegendre::new(40).unwrap();
    for (k, b, cap) in [(2_u32, 0.3, 1.0), (10, 2.0, 1.2), (50, -1.0, 0.9)] {
        let density = 20.0;
        // (x cosh x - sinh x)/x^3 by its series, 2 n/(2n+1)! x^(2n-2).
        let within = |r: f64| {
            let x = b * r;
            let (mut term, mut sum, mut n) = (1.0 / 3.0, 0.0, 1.0);
            while term > 1e-18 * sum {
                sum += term;
                term *= x * x / (2.0 * n * (2.0 * n + 3.0));
                n += 1.0;
            }
            sum
        };
        let lambda = |r: f64| 4.0 * PI * density * r * r * r * within(r);
        let slope = |r: f64| 4.0 * PI * density * r * libm::sinh(b * r) / b;
        let poisson = |n: u32, s: f64| (1..=n).fold(libm::exp(-s), |p, i| p * s / f64::from(i));
        let mean = |r: f64| 3.0 * within(r);
        let gathers = |r: f64| poisson(k - 2, lambda(r)) * slope(r) * mean(r);
        let sum: f64 = (0..20)
            .map(|i| rule.integrate(cap * f64::from(i) / 20.0, cap * f64::from(i + 1) / 20.0, gathers))
            .sum();
        let underfull: f64 = (0..k - 1).map(|n| poisson(n, lambda(cap))).sum();
        let got = nearest_expectation_exponential(Kernel::Uniform, Dimension::Three, k, density, b, cap);
        seen.against(got.unwrap(), sum + underfull * mean(cap), 64.0 * f64::EPSILON);
    }
    for k in [3, 10, 100] {
        let lambda = |r: f64| 30.0 * BALL * r * r * r;
        let got = nearest_moments(k, 1e3, lambda, |_| 1.0, |r| 1.0 / lambda(r)).unwrap().variance;
        seen.push(got, nearest_variance_uniform(k, None).unwrap());
    }
}

/// Name; largest difference over both bounds; mean log10 of the relative bound: as recorded.
type Family = (&'static str, fn(&mut Seen), f64, f64);

const FAMILIES: [Family; 18] = [
    ("isotropic slab", isotropic_slab, 2.02e-2, -13.84),
    ("anisotropic slab", anisotropic_slab, 1.52e-2, -11.53),
    ("radiance", radiance, 3.98e-5, -10.66),
    ("orders", orders, 1.93e-2, -11.87),
    ("refracting slab", fresnel_slab, 4.13e-2, -13.14),
    ("half-space", half_space, 1.14e-1, -14.61),
    ("X and Y", x_and_y, 3.70e-3, -13.07),
    ("thick slabs", thick, 1.47e-2, -13.88),
    ("sphere", sphere, 2.87e-3, -13.65),
    ("critical bodies", critical, 1.45e-3, -13.23),
    ("unbounded medium", infinite, 3.93e-2, -14.03),
    ("kernels at a face", kernels, 1.05e-2, -12.76),
    ("fields of a half-space", half_space_fields, 5.79e-2, -14.30),
    ("fluence of a sphere", sphere_fluence, 6.31e-3, -13.67),
    ("radiance of a sphere", sphere_radiance, 1.88e-4, -13.82),
    ("kernels in sphere and cuboid", moments_in_bodies, 7.80e-3, -12.78),
    ("beams", beams, 1.72e-1, -13.81),
    ("nearest points", nearest, 2.08e-2, -12.23),
];

/// Differences lie within the bounds, and neither moves against the other: differences by no more than a factor of 2,
/// bounds by a quarter.
#[test]
fn bounds_are_as_wide_as_recorded() {
    let mut found = Vec::new();
    let mut is_right = true;
    for (name, family, worst, log) in FAMILIES {
        let mut seen = Seen::default();
        family(&mut seen);
        let mean = seen.logs / f64::from(seen.count);
        let is_as_recorded = (mean - log).abs() <= 0.1 && (0.5..=2.0).contains(&(seen.worst / worst));
        is_right &= seen.worst <= 1.0 && is_as_recorded;
        found.push(format!(
            "{name}: largest difference {:.2e} of the bounds (recorded {worst:.2e}), bounds 10^{mean:.2} of the value \
             (recorded 10^{log:.2}), {} answers",
            seen.worst, seen.count
        ));
    }
    let found = found.join("\n");
    #[allow(clippy::print_stdout, reason = "a test's protocol")]
    {
        println!("{found}");
    }
    assert!(is_right, "bounds or differences have changed:\n{found}");
}
