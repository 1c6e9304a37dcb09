//! A small sphere that emits, at the centre of a ball of fog: what stands for a point light where paths are to have a
//! finite variance.
//!
//! It is black: light that comes back to it is absorbed, and no fog is inside it. The exact ball has fog there and a
//! point. Two steps lead from one to the other, e the radius of the emitter and psi(r, mu) the chance to escape for a
//! photon that starts at r with the cosine mu to the radius:
//!
//! 1. An emitter that light passes through, fog inside it, has the escape L = int_0^1 psi(e, mu) 2 mu dmu.
//! 2. Of that, the black one lacks what came back to it, the part B of the power, and would have escaped then: B times a
//!    mean of psi(e, mu) over mu < 0. So escape + B psi = L with some psi between the least and the largest of those,
//!    which differ by O(e); B is O(e) itself.
//!
//! psi = e^-s + int_0^s w phi(r(s'))/4 e^-s' ds' along the way s to the surface, phi the fluence under isotropic
//! incidence: phi/4 is the chance to escape after a scattering, by reciprocity.

use super::sphere::{at, body, referee};
use crate::checks::slab::exact;
use crate::support::quadrature::integrate;
use crate::support::run::{Watcher, numbers, paths, tallies, watched};
use crate::support::scenes::{ball, bounded, emitting_sphere, outflow};
use crate::support::verdict;
use glam::DVec3;
use std::f64::consts::PI;
use turbid::math::{FOUR_PI, exp};
use turbid::scene::{Orders, Quantity, Scene};
use turbid::sensor::sample;
use turbid::transport::{Step, Walker};
use turbid_analytic::{Sphere, SphereSource};

const PHOTONS: u64 = 1 << 18;
const PATHS: u64 = 1 << 17;
const ALBEDO: f64 = 0.9;

/// Radiance of an emitter of power 1.
fn radiance(emitter: f64) -> f64 {
    1.0 / (PI * FOUR_PI * emitter * emitter)
}

/// The chance to escape from a ball, from r along a direction.
fn escapes(incident: &Sphere, r: f64, mu: f64) -> f64 {
    let a = incident.radius();
    let way = -r * mu + (a * a - r * r * (1.0 - mu * mu)).sqrt();
    let radius = |s: f64| (r * r + 2.0 * r * s * mu + s * s).max(0.0).sqrt().min(a);
    let phi = |s: f64| incident.fluence(radius(s)).unwrap().value;
    // s = way (1 - u^3) is smooth at the surface, where phi is but for t ln t.
    let scattered = integrate(0.0, 1.0, 1, |u| {
        let s = way * (1.0 - u * u * u);
        0.25 * incident.albedo() * phi(s) * exp(-s) * way * 3.0 * u * u
    });
    exp(-way) + scattered
}

/// L, and psi of light that comes back with half its range.
fn transparent(incident: &Sphere, emitter: f64) -> (f64, (f64, f64)) {
    let escape = integrate(0.0, 1.0, 1, |mu| escapes(incident, emitter, mu) * 2.0 * mu);
    let inward: Vec<f64> = (0..=20).map(|i| escapes(incident, emitter, -f64::from(i) / 20.0)).collect();
    let (least, most) =
        inward.iter().fold((f64::INFINITY, 0.0f64), |(low, high), &p| (low.min(p), high.max(p)));
    (escape, (0.5 * (least + most), 0.5 * (most - least)))
}

/// Escape and return of one photon.
#[derive(Default)]
struct End {
    escaped: f64,
    returned: f64,
}

impl Watcher<2> for End {
    fn see(&mut self, _walker: &Walker, step: Step) {
        match step {
            Step::Escaped(weight) => self.escaped += weight[0],
            Step::Surface(arrival, _) => self.returned += arrival.walker.weight[0],
            _ => {}
        }
    }

    fn numbers(&self) -> [f64; 2] {
        [self.escaped, self.returned]
    }
}

/// The sum escape + B psi of one photon.
struct Corrected(End, f64);

impl Watcher<1> for Corrected {
    fn see(&mut self, walker: &Walker, step: Step) {
        self.0.see(walker, step);
    }

    fn numbers(&self) -> [f64; 1] {
        [self.0.escaped + self.1 * self.0.returned]
    }
}

fn returned(scene: &Scene) -> f64 {
    watched::<2, _>(scene, PHOTONS, 2, End::default)[1].mean()
}

#[test]
fn escape_with_what_came_back() {
    let radius = 1.0;
    let incident = referee(radius, ALBEDO, SphereSource::Incident);
    for (emitter, promise) in [(0.05, 0.01), (0.3, 0.016)] {
        let scene = ball(radius, ALBEDO, 0.0, emitting_sphere(DVec3::ZERO, emitter));
        let (escape, (psi, range)) = transparent(&incident, emitter);
        let back = returned(&scene);
        let reference = (escape, 2.0 * range * back + 1e-9);
        let [by_photons] = watched(&scene, PHOTONS, 1, || Corrected(End::default(), psi));
        verdict::agrees(&format!("photons: emitter {emitter}"), &by_photons, reference, promise, 1);
        // What neither escapes nor is absorbed in the fog came back.
        let (out, absorbed) = (outflow(body(radius)), Quantity::Absorbed(0));
        let by_paths = numbers(PATHS, 1, |s| {
            let of = |quantity, s: &mut _| sample(&scene, &quantity, Orders::ALL, s)[0];
            let (out, absorbed) = (of(out.clone(), s), of(absorbed.clone(), s));
            out + psi * (1.0 - out - absorbed)
        });
        verdict::agrees(&format!("paths: emitter {emitter}"), &by_paths, reference, 0.05, 1);
        if emitter > 0.1 {
            let [plain, _] = watched::<2, _>(&scene, PHOTONS, 3, End::default);
            let point = referee(radius, ALBEDO, SphereSource::Centre).escape();
            verdict::rejects("a large emitter taken for a point", &plain, point.value, 3);
        }
    }
}

/// Fluence beside a small emitter by paths. Direct light is radiance times what its disc lets through, exactly. Of all
/// light, the emitter that is passed through has 4 times the mean irradiance that a point at r brings to its surface:
/// phi of the point light times 1 + (2/3)(1-w) e, for the net flux into it is what is absorbed inside, up to O(e^2/r^2);
/// the black one lacks B of it.
#[test]
fn fluence_beside_it() {
    let (radius, emitter) = (1.0, 0.05);
    let scene = ball(radius, ALBEDO, 0.0, emitting_sphere(DVec3::ZERO, emitter));
    let point = referee(radius, ALBEDO, SphereSource::Centre);
    let back = returned(&scene);
    for r in [0.06, 0.25, 0.5, 0.9] {
        let expected = direct(emitter, r);
        let moments = paths(&scene, at(r), Orders::only(0), 1 << 14, 4)[0];
        verdict::agrees(
            &format!("direct, at {r}"),
            &moments,
            (expected, 1e-10 * expected),
            0.02 * expected,
            4,
        );
        if r >= 0.5 {
            let (value, _) = exact(point.fluence(r).unwrap());
            let expected = value * (1.0 + 2.0 / 3.0 * (1.0 - ALBEDO) * emitter - back);
            let error = (emitter / r) * (emitter / r) * value;
            let moments = paths(&scene, at(r), Orders::ALL, PATHS, 5)[0];
            verdict::agrees(&format!("at {r}"), &moments, (expected, error), 0.12 * expected, 5);
        }
    }
}

/// Fluence of uncollided light at r: 2 pi times the radiance times the integral of e^-d over the cosines of the disc.
fn direct(emitter: f64, r: f64) -> f64 {
    let sin2 = (emitter / r) * (emitter / r);
    let widest = sin2 / (1.0 + (1.0 - sin2).sqrt());
    // 1 - mu = widest (1 - u^2): the way is smooth in u at the rim.
    let seen = integrate(0.0, 1.0, 1, |u| {
        let one_minus_mu = widest * (1.0 - u * u);
        let (mu, sine2) = (1.0 - one_minus_mu, one_minus_mu * (2.0 - one_minus_mu));
        let way = r * mu - (emitter * emitter - r * r * sine2).max(0.0).sqrt();
        exp(-way) * 2.0 * widest * u
    });
    2.0 * PI * radiance(emitter) * seen
}

/// In vacuum fluence is radiance times solid angle; in fog that scatters forward, from off the centre, paths and photons
/// agree.
#[test]
fn in_vacuum_and_off_the_centre() {
    let emitter = 0.1;
    let scene = bounded(Vec::new(), Vec::new(), vec![emitting_sphere(DVec3::ZERO, emitter)]);
    for d in [0.11, 0.5, 3.0] {
        let sin2 = (emitter / d) * (emitter / d);
        let expected = radiance(emitter) * 2.0 * PI * (sin2 / (1.0 + (1.0 - sin2).sqrt()));
        let moments = paths(&scene, at(d), Orders::ALL, 1 << 16, 6)[0];
        verdict::agrees(&format!("distance {d}"), &moments, (expected, 1e-14 * expected), 0.1 * expected, 6);
    }
    let fog = ball(2.0, 0.9, 0.5, emitting_sphere(DVec3::new(0.3, 0.0, 0.0), 0.2));
    let quantities = [outflow(body(2.0)), Quantity::Absorbed(0)];
    let photons = tallies(&fog, &quantities.clone().map(|q| (q, Orders::ALL)), PHOTONS, 7);
    for (photons, quantity) in photons.iter().zip(quantities) {
        let by_paths = paths(&fog, quantity.clone(), Orders::ALL, 1 << 16, 7)[0];
        verdict::agree(&format!("{quantity:?}"), &photons[0], &by_paths, 0.1, 7);
    }
}
