//! Laws of the sphere: balance, reciprocity, the flux of its radiance, limits; the cavity and mean paths on top of it.

use libm::{exp, pow};
use std::f64::consts::PI;
use turbid_analytic::mean_path::{
    chord_density_slab, chord_density_sphere, chord_moment_slab, chord_moment_sphere, mean_path,
    mean_path_cuboid, mean_path_slab, mean_path_slab_absorbing, mean_path_sphere, mean_path_sphere_absorbing,
};
use turbid_analytic::quadrature::GaussLegendre;
use turbid_analytic::sphere::{absorbing_transmittance, escape_from, escape_uniform};
use turbid_analytic::{Cavity, Sphere, SphereSource, Value};

const SOURCES: [SphereSource; 3] = [SphereSource::Uniform, SphereSource::Centre, SphereSource::Incident];

fn near(a: f64, b: f64, tolerance: f64) -> bool {
    (a - b).abs() <= tolerance
}

/// Escape and absorptance are computed apart: together 1 within their bounds, at every extreme.
#[test]
fn energy_balances() {
    for a in [1e-12, 1e-3, 3.0, 50.0, 100.0, 1e6] {
        let first = Sphere::new(a, 0.0, SphereSource::Uniform).unwrap();
        for albedo in [0.0, 1e-6, 0.5, 0.999_999, 1.0] {
            for source in SOURCES {
                let sphere = first.with(albedo, source).unwrap();
                let (l, b) = (sphere.escape(), sphere.absorptance());
                let off = l.value + b.value - 1.0;
                assert!(off.abs() <= l.error + b.error + f64::EPSILON, "{a} {albedo} {source:?}: {off:e}");
                assert!(l.error + b.error < 1e-10, "{a} {albedo} {source:?}: {l:?} {b:?}");
            }
        }
    }
}

/// phi_incident = 4 [1 - (1-w) V phi_uniform], A_incident = (4a/3)(1-w) L_uniform, L_centre = phi_incident(0)/4: three
/// separate solutions of the same equation.
#[test]
fn reciprocity() {
    for a in [1e-8, 0.7, 40.0, 1e4] {
        for albedo in [1e-6, 0.6, 0.999_999] {
            let uniform = Sphere::new(a, albedo, SphereSource::Uniform).unwrap();
            let incident = uniform.with(albedo, SphereSource::Incident).unwrap();
            let centre = uniform.with(albedo, SphereSource::Centre).unwrap();
            let volume = 4.0 * PI / 3.0 * a * a * a;
            for part in [0.0, 0.3, 0.9, 1.0] {
                let (u, i) = (uniform.fluence(part * a).unwrap(), incident.fluence(part * a).unwrap());
                let scale = 4.0 * (1.0 - albedo) * volume;
                let tolerance = i.error + scale * u.error + 16.0 * f64::EPSILON;
                assert!(near(i.value, 4.0 - scale * u.value, tolerance), "{a} {albedo} {part}: {i:?} {u:?}");
            }
            let scale = 4.0 * a / 3.0 * (1.0 - albedo);
            let (l, b) = (uniform.escape(), incident.absorptance());
            assert!(near(b.value, scale * l.value, b.error + scale * l.error), "{a} {albedo}");
            let at_centre = incident.fluence(0.0).unwrap();
            let l = centre.escape();
            assert!(near(l.value, 0.25 * at_centre.value, l.error + 0.25 * at_centre.error), "{a} {albedo}");
        }
    }
}

/// Under incidence without absorption the fluence is 4 everywhere.
#[test]
fn the_furnace() {
    for a in [1e-8, 0.2, 5.0, 50.0, 100.0, 1e4] {
        let sphere = Sphere::new(a, 1.0, SphereSource::Incident).unwrap();
        for part in [0.0, 1e-9, 0.2, 0.999, 1.0] {
            let phi = sphere.fluence(part * a).unwrap();
            assert!(phi.covers(4.0) && phi.error < 4e-10, "{a} {part}: {phi:?}");
        }
        for mu in [0.0, 1e-9, 0.3, 1.0] {
            let radiance = sphere.exit_radiance(mu).unwrap();
            assert!(radiance.covers(1.0 / PI) && radiance.error < 1e-10, "{a} {mu}: {radiance:?}");
        }
    }
}

/// 2 pi int mu I dmu is the power through a unit of the surface.
#[test]
fn radiance_carries_the_escape() {
    let rule = GaussLegendre::new(40).unwrap();
    for (a, albedo) in [(1e-3, 0.8), (1.5, 0.8), (6.0, 0.99), (70.0, 0.999)] {
        for source in SOURCES {
            let sphere = Sphere::new(a, albedo, source).unwrap();
            let area = match source {
                SphereSource::Incident => 1.0,
                _ => 4.0 * PI * a * a,
            };
            let radiance = |mu: f64| sphere.exit_radiance(mu).unwrap().value;
            // mu = x^3 below 1/2 resolves the grazing layer, 1 - mu = y^4/2 above it the centre's
            // 1/sqrt(1-mu) and ln(1-mu).
            let graze = rule.integrate(0.0, 1.0, |x| {
                let mu = 0.5 * x * x * x;
                1.5 * x * x * mu * radiance(mu)
            });
            let steep = rule.integrate(0.0, 1.0, |y| {
                let mu = 1.0 - 0.5 * y * y * y * y;
                2.0 * y * y * y * mu * radiance(mu)
            });
            let mut power = 2.0 * PI * area * (graze + steep);
            if source == SphereSource::Centre {
                power += exp(-a);
            }
            let escape = sphere.escape();
            // Forty nodes; large spheres have a layer at mu = 1/a.
            assert!(near(power, escape.value, 1e-10 + 1e-9 * a / 70.0), "{a} {source:?}: {power} {escape:?}");
        }
    }
}

#[test]
fn limits() {
    // Thin: one flight. L = 1 - (1-w) 3a/4 (uniform), 1 - (1-w) a (centre), 1 - (1-w) 4a/3 (incident), to a^2.
    let a = 1e-8;
    let first = Sphere::new(a, 0.5, SphereSource::Uniform).unwrap();
    for (source, mean) in SOURCES.into_iter().zip([0.75 * a, a, 4.0 * a / 3.0]) {
        for albedo in [1e-6, 0.4, 0.999_999] {
            let absorbed = first.with(albedo, source).unwrap().absorptance();
            assert!(near(absorbed.value / ((1.0 - albedo) * mean), 1.0, 3.0 * a), "{source:?} {absorbed:?}");
        }
    }
    // Faint: closed forms.
    for a in [0.4, 7.0, 200.0] {
        let uniform = Sphere::new(a, 0.0, SphereSource::Uniform).unwrap();
        assert!(near(uniform.escape().value, escape_uniform(a).unwrap().value, 1e-14));
        let incident = uniform.with(0.0, SphereSource::Incident).unwrap();
        assert!(near(incident.escape().value, absorbing_transmittance(a).unwrap().value, 1e-14));
        let r = 0.6 * a;
        let phi = incident.fluence(r).unwrap().value;
        assert!(near(phi / (4.0 * escape_from(a, r).unwrap().value), 1.0, 1e-13 * a));
        let centre = uniform.with(0.0, SphereSource::Centre).unwrap();
        assert!(near(centre.fluence(r).unwrap().value * (4.0 * PI * r * r) / exp(-r), 1.0, 1e-13 * a));
        assert_eq!(centre.exit_radiance(0.3).unwrap().value, 0.0);
    }
    // Without absorption u = r phi is that of a slab, linear in its depth up to e^(-depth): of a central source
    // (3/4 pi) (1 - r/(a + q)), q Milne's extrapolation length.
    let q = 0.710_446_089_598_763_1;
    for a in [64.0, 100.0, 1e4, 1e6] {
        let sphere = Sphere::new(a, 1.0, SphereSource::Centre).unwrap();
        let r = 0.5 * a;
        let phi = sphere.fluence(r).unwrap();
        let known = 3.0 / (4.0 * PI) * (1.0 / r - 1.0 / (a + q));
        assert!(near(phi.value, known, phi.error + 1e-13 * known), "{a}: {phi:?} {known}");
        assert!(phi.error < 1e-9 * known, "{a}: {phi:?}");
        let known = sphere.fluence(a).unwrap();
        assert!(known.error < 1e-9 * known.value, "{a}: {known:?}");
        // On the face of the Milne problem u is 1/sqrt 3 of the slope of the linear part.
        let face = 3.0 / (4.0 * PI) / (a + q) / 3.0_f64.sqrt() / a;
        assert!(near(known.value, face, known.error + 1e-13 * face), "{a}: {known:?} {face}");
    }
}

/// Orders add up to the whole, and those of the central source follow from each other by the equation.
#[test]
fn orders_add_up() {
    for source in [SphereSource::Uniform, SphereSource::Incident] {
        let sphere = Sphere::new(1.2, 0.9, source).unwrap();
        for r in [0.0, 0.5, 1.19, 1.2] {
            // A flight stays within a radius of 1.2 with a probability under 0.7: 100 orders leave 0.63^100.
            let (mut sum, mut error) = (0.0, 0.0);
            for n in 0..100 {
                let order = sphere.fluence_of_order(n, r).unwrap();
                sum += order.value;
                error += order.error;
            }
            let whole = sphere.fluence(r).unwrap();
            assert!(near(sum, whole.value, error + whole.error), "{source:?} {r}: {sum} {whole:?}");
            assert!(error < 1e-12 * sum);
        }
    }
    // Of the central source orders 0 to 7. (w/2) K takes a bounded field to at most w (1 - e^(-a)) of its maximum, so
    // orders from 8 on add up to some (w (1 - e^(-a)))^6 of the maximum of order 2. In the largest sphere that is
    // 7e-16 of 3e-7 (order 2 at the radius 0.01, where its logarithm is still small), beside 5e-7 in all at its face.
    for (a, albedo) in [(1e-3, 0.5), (1.2, 0.01), (8.0, 0.003)] {
        let sphere = Sphere::new(a, albedo, SphereSource::Centre).unwrap();
        for part in [1e-6, 0.1, 0.5, 0.99, 1.0] {
            let r = part * a;
            let (mut sum, mut error) = (0.0, 0.0);
            for n in 0..=7 {
                let order = sphere.fluence_of_order(n, r).unwrap();
                sum += order.value;
                error += order.error;
            }
            let whole = sphere.fluence(r).unwrap();
            let tolerance = error + whole.error + 1e-12 * whole.value;
            assert!(near(sum, whole.value, tolerance), "{a} {part}: {sum} {whole:?}");
            assert!(error < 1e-10 * sum, "{a} {part}: {error:e} {sum}");
        }
    }
    let sphere = Sphere::new(1.2, 0.9, SphereSource::Centre).unwrap();
    // Order n is w^n times that without absorption.
    let pure = sphere.with(1.0, SphereSource::Centre).unwrap();
    for n in 1..=7 {
        let (p, q) = (sphere.fluence_of_order(n, 0.7).unwrap(), pure.fluence_of_order(n, 0.7).unwrap());
        let scale = pow(0.9, f64::from(n));
        assert!(near(p.value, scale * q.value, p.error + q.error) && p.error < 1e-10 * p.value, "{n}: {p:?}");
    }
    // Single scattering on the surface, int over the ball of e^(-r') e^(-d)/((4 pi)^2 r'^2 d^2), by shells: the mean of
    // e^(-d)/d^2 over a shell is int e^(-d)/(2 r r' d) dd.
    let rule = GaussLegendre::new(60).unwrap();
    let a = 1.2;
    let single = rule.integrate(0.0, 1.0, |x| {
        let source = a * (1.0 - x * x * x * x);
        let inner = rule.integrate(libm::log(a - source), libm::log(a + source), |l| exp(-exp(l)));
        4.0 * a * x * x * x * exp(-source) / (8.0 * PI * a * source) * inner
    });
    let got = pure.fluence_of_order(1, a).unwrap();
    assert!(near(got.value, single, 1e-11 * single), "{got:?} {single}");
    assert!(sphere.fluence_of_order(8, 0.7).is_err() && sphere.fluence_of_order(3, 2.0).is_err());
}

#[test]
fn what_is_solved_is_what_is_interpolated() {
    for source in SOURCES {
        let sphere = Sphere::new(2.5, 0.9, source).unwrap();
        for r in [1e-3, 0.4, 1.3, 2.2, 2.49] {
            let (p, q) = (sphere.fluence(r).unwrap(), sphere.fluence_interpolated(r).unwrap());
            assert!(near(p.value, q.value, p.error + q.error) && q.error < 1e-11 * q.value, "{p:?} {q:?}");
            let direct = sphere.fluence_direct(r).unwrap();
            assert!(direct.value < p.value);
        }
    }
}

#[test]
fn refusals_name_the_parameter() {
    let says = |result: turbid_analytic::Result<Value>, name: &str| {
        let text = result.unwrap_err().to_string();
        assert!(text.starts_with(name), "{text}");
    };
    let new = |a: f64, w: f64| Sphere::new(a, w, SphereSource::Uniform).map(|s| s.escape());
    says(new(0.0, 0.5), "radius is 0; allowed: 1e-12 to 1e6");
    says(new(f64::NAN, 0.5), "radius is NaN");
    says(new(1e7, 0.5), "radius");
    says(new(1.0, 1.5), "albedo is 1.5; allowed: 0 to 1");
    says(new(100.0, 1e-20), "albedo");
    let sphere = Sphere::new(1.0, 0.5, SphereSource::Centre).unwrap();
    says(sphere.fluence(1.0 + 1e-15), "r is");
    says(sphere.fluence(0.0), "the fluence at a point source is infinite");
    says(sphere.exit_radiance(1.0), "the radiance through a point source");
    says(sphere.exit_radiance(-0.1), "mu is -0.1; allowed: 0 to 1");
}

/// The cavity by its own series: what falls on the wall after n reflections, added up.
#[test]
fn cavities_add_up_their_reflections() {
    let rule = GaussLegendre::new(40).unwrap();
    for (rho, albedo) in [(0.0, 0.3), (0.5, 0.9), (0.9, 0.999), (1.0, 0.5)] {
        let a = 1.3;
        let cavity = Cavity::filled(a, rho, albedo).unwrap();
        let lit = Sphere::new(a, albedo, SphereSource::Incident).unwrap();
        let kept = lit.escape().value;
        let (mut falls, mut sum) = (kept, 0.0);
        for _ in 0..1000 {
            sum += falls;
            falls *= rho * kept;
        }
        let wall = cavity.irradiance_wall();
        assert!(near(wall.value, sum, wall.error + 1e-13 * sum), "{wall:?} {sum}");
        let central = Sphere::new(a, albedo, SphereSource::Centre).unwrap().escape().value;
        let centre = cavity.irradiance_centre();
        let known = central / (4.0 * PI * a * a) * sum / kept;
        assert!(near(centre.value, known, centre.error + 1e-13 * known));
        // Power: the wall keeps (1-rho) E, the medium A of all that the wall sends out, and both add up to the source.
        let sent = 1.0 + rho * wall.value;
        let lost = (1.0 - rho) * wall.value + (1.0 - kept) * sent;
        assert!(near(lost, 1.0, 1e-12), "{lost}");
        // At the wall: 2 from what the wall sends out, a half-space of radiance 1/pi, and what arrives from the medium,
        // mu = x^3 so that its mu ln mu at the horizon leaves 40 nodes less than a rounding.
        let arriving =
            rule.integrate(0.0, 1.0, |x| 3.0 * x * x * lit.exit_radiance(x * x * x).unwrap().value);
        let known = sent * (2.0 + 2.0 * PI * arriving);
        let at_wall = cavity.fluence_wall(a).unwrap();
        assert!(near(at_wall.value, known, at_wall.error + 1e-12 * known), "{at_wall:?} {known}");
    }
    // Empty: E = E_0 + rho <E_0>/(1-rho).
    let cavity = Cavity::empty(2.0, 0.8).unwrap();
    assert!(near(cavity.irradiance(3.0, 1.5).unwrap().value, 3.0 + 0.8 * 1.5 / 0.2, 1e-14 * 9.0));
    assert!(near(cavity.irradiance_wall().value, 5.0, 1e-14));
    assert!(near(cavity.irradiance_centre().value, 5.0 / (16.0 * PI), 1e-15));
    assert!(near(cavity.fluence_wall(0.3).unwrap().value, 20.0, 1e-13));
    // A medium that hardly is one changes nothing.
    let filled = Cavity::filled(1e-12, 0.8, 0.3).unwrap();
    assert!(near(filled.irradiance_wall().value, 5.0, 1e-10));
    // A wall that absorbs nothing needs a medium that does.
    assert!(Cavity::empty(1.0, 1.0).is_err() && Cavity::filled(1.0, 1.0, 1.0).is_err());
    let bright = Cavity::filled(1.0, 1.0, 0.999_999).unwrap().irradiance_wall();
    assert!(bright.error < 1e-12 * bright.value && bright.value > 1e5, "{bright:?}");
    assert!(Cavity::filled(1.0, 0.5, 0.5).unwrap().irradiance(1.0, 2.0).is_err());
    assert!(Cavity::empty(1.0, f64::NAN).err().unwrap().to_string().starts_with("wall_albedo"));
}

#[test]
fn mean_paths() {
    let a = 1.7;
    let sphere = mean_path(4.0 * PI / 3.0 * a * a * a, 4.0 * PI * a * a).unwrap().value;
    assert!(near(sphere, mean_path_sphere(a).unwrap().value, 1e-15));
    assert!(near(mean_path_sphere_absorbing(a, 1.0).unwrap().value, sphere, 1e-13));
    let (x, y, z) = (0.5, 2.0, 3.0);
    let cuboid = mean_path(x * y * z, 2.0 * (x * y + y * z + z * x)).unwrap().value;
    assert!(near(cuboid, mean_path_cuboid(x, y, z).unwrap().value, 1e-15));
    // A cuboid that is flat is a slab.
    assert!(near(
        mean_path_cuboid(0.3, 1e60, 1e60).unwrap().value,
        mean_path_slab(0.3).unwrap().value,
        1e-16
    ));
    // Without scattering: 1 - T, and it grows to 4 V/S with the albedo, from below.
    let dark = mean_path_sphere_absorbing(a, 0.0).unwrap().value;
    assert!(near(dark, 1.0 - absorbing_transmittance(a).unwrap().value, 1e-14));
    let mut last = dark;
    for albedo in [0.3, 0.9, 0.999, 1.0] {
        let next = mean_path_sphere_absorbing(a, albedo).unwrap().value;
        assert!(next > last && next <= sphere * (1.0 + 1e-13));
        last = next;
    }
    let slab = mean_path_slab_absorbing(2.0, 1.0 - 1e-9).unwrap();
    assert!(near(slab.value, 4.0, slab.error + 1e-7) && slab.error < 1e-11, "{slab:?}");
    assert_eq!(mean_path_slab_absorbing(2.0, 1.0).unwrap().value, 4.0);
    // Moments are integrals of the densities.
    let rule = GaussLegendre::new(30).unwrap();
    for n in 0..6 {
        let sum = rule
            .integrate(0.0, 2.0 * a, |l| pow(l, f64::from(n)) * chord_density_sphere(a, l).unwrap().value);
        assert!(near(sum / chord_moment_sphere(a, n).unwrap().value, 1.0, 1e-14));
    }
    assert!(near(chord_moment_sphere(a, 1).unwrap().value, sphere, 1e-15));
    // The slab's by 1/L.
    let mean = rule.integrate(0.0, 1.0 / a, |u| chord_density_slab(a, 1.0 / u).unwrap().value / (u * u * u));
    assert!(near(mean, chord_moment_slab(a, 1).unwrap().value, 1e-13) && near(mean, 2.0 * a, 1e-13));
    assert!(chord_moment_slab(a, 2).is_err() && chord_moment_sphere(1e100, 9).is_err());
    assert!(mean_path(-1.0, 1.0).is_err() && mean_path_sphere(f64::NAN).is_err());
}
