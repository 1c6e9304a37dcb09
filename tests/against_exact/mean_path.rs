//! The mean path inside: light that comes in isotropically through the whole surface of a convex body stays in it for
//! 4 V/S on average, whatever the phase function (Blanco and Fournier 2003), as long as nothing is absorbed; with
//! absorption A = (1 - w) l in mean free paths, l the mean path to escape or absorption.
//!
//! Paths are measured twice: as the length that photons fly inside, and as their collisions over the extinction.

use super::henyey_greenstein::{medium, referee};
use crate::checks::slab::exact;
use crate::support::run::{Watcher, watched};
use crate::support::scenes::{Incidence, ball, bounded, cuboid, isotropic, layer, region, slab, sphere};
use crate::support::verdict;
use glam::DVec3;
use turbid::geometry::Shape;
use turbid::light::Faces;
use turbid::math::exp;
use turbid::scene::Scene;
use turbid::transport::{Step, Walker};
use turbid_analytic::mean_path::{mean_path, mean_path_slab};
use turbid_analytic::{Sphere, SphereSource, Value};

const HISTORIES: u64 = 1 << 17;
const ASYMMETRIES: [f64; 5] = [-0.5, 0.0, 0.75, 0.95, 0.9999];
/// Extinction of the bodies but the slab, whose lengths are mean free paths [1/L].
const SIGMA_T: f64 = 2.0;

/// The path of one photon inside a body.
struct Path<'a> {
    body: &'a Shape,
    length: f64,
    collisions: f64,
    absorbed: f64,
}

impl<'a> Path<'a> {
    fn inside(body: &'a Shape) -> Self {
        Path { body, length: 0.0, collisions: 0.0, absorbed: 0.0 }
    }
}

impl Watcher<3> for Path<'_> {
    fn see(&mut self, walker: &Walker, step: Step) {
        match step {
            Step::Uncollided(t, weight) => {
                if let Some(inside) = self.body.interval(&walker.ray) {
                    self.length += weight[0] * (inside.end.min(t) - inside.start).max(0.0);
                }
            }
            Step::Collision(arrival, _) => self.collisions += arrival.walker.weight[0],
            Step::Absorbed(weight, _) => self.absorbed += weight[0],
            _ => {}
        }
    }

    /// Length, collisions, absorbed power.
    fn numbers(&self) -> [f64; 3] {
        [self.length, self.collisions, self.absorbed]
    }
}

fn unit_ball() -> Shape {
    sphere(DVec3::ZERO, 1.0)
}

fn flat_box() -> Shape {
    cuboid(DVec3::ZERO, DVec3::new(1.0, 2.0, 0.3))
}

fn lit(shape: Shape, albedo: f64, g: f64) -> Scene {
    bounded(vec![region(shape.clone(), SIGMA_T, albedo, g)], Vec::new(), vec![isotropic(shape, Faces::Both)])
}

#[test]
fn mean_path_is_four_volumes_over_surface() {
    let (body, ball) = (flat_box(), unit_ball());
    let of_body = |shape: Shape| mean_path(shape.volume(), shape.area()).unwrap();
    let of_slab = mean_path_slab(3.0).unwrap();
    for g in ASYMMETRIES {
        let cases = [
            ("ball", ball.clone(), lit(ball.clone(), 1.0, g), SIGMA_T, of_body(ball.clone())),
            ("box", body.clone(), lit(body.clone(), 1.0, g), SIGMA_T, of_body(body.clone())),
            ("slab, both faces", layer(3.0), slab(3.0, 1.0, g, Incidence::Both), 1.0, of_slab),
            ("slab, one face", layer(3.0), slab(3.0, 1.0, g, Incidence::Diffuse), 1.0, of_slab),
        ];
        for (name, shape, scene, sigma_t, value) in cases {
            let reference = exact(value);
            let [length, collisions, _] = watched(&scene, HISTORIES, 1, || Path::inside(&shape));
            let promise = 0.04 * reference.0;
            verdict::agrees(&format!("length, {name}, g {g}"), &length, reference, promise, 1);
            let reference = (sigma_t * reference.0, sigma_t * reference.1);
            let what = format!("collisions, {name}, g {g}");
            verdict::agrees(&what, &collisions, reference, sigma_t * promise, 1);
        }
    }
    // What the law asks for: isotropic light, and no absorption.
    let shape = layer(3.0);
    let beam = slab(3.0, 1.0, 0.75, Incidence::Beam(1.0));
    let [length, ..] = watched(&beam, HISTORIES, 2, || Path::inside(&shape));
    verdict::rejects("length under a beam", &length, 6.0, 2);
    let [length, ..] = watched(&lit(ball.clone(), 0.99, 0.0), HISTORIES, 2, || Path::inside(&ball));
    verdict::rejects("length with an albedo of 0.99", &length, 4.0 / 3.0, 2);
}

/// What is absorbed is 1 - w times the mean path in mean free paths: in every history's mean, for any shape and phase
/// function; and the path is the referee's.
#[test]
fn absorptance_is_the_mean_path() {
    let (body, ball) = (flat_box(), unit_ball());
    let albedo = 0.9;
    for g in [-0.5, 0.0, 0.75, 0.95] {
        let of_slab = |tau| referee(&medium(albedo, g), tau, Incidence::Diffuse).absorptance();
        let of_ball = Sphere::new(SIGMA_T, albedo, SphereSource::Incident).unwrap().absorptance();
        let cases: [(&str, Shape, Scene, f64, Option<Value>); 3] = [
            ("ball", ball.clone(), lit(ball.clone(), albedo, g), SIGMA_T, (g == 0.0).then_some(of_ball)),
            ("box", body.clone(), lit(body.clone(), albedo, g), SIGMA_T, None),
            ("slab", layer(3.0), slab(3.0, albedo, g, Incidence::Diffuse), 1.0, Some(of_slab(3.0))),
        ];
        for (name, shape, scene, sigma_t, absorptance) in cases {
            let what = format!("{name}, g {g}");
            let moments = watched::<4, _>(&scene, HISTORIES, 3, || Balance(Path::inside(&shape), sigma_t));
            let [length, collisions, by_length, by_collisions] = &moments;
            verdict::agrees(&format!("A - (1-w) l, {what}"), by_length, (0.0, 1e-15), 0.015, 3);
            verdict::agrees(&format!("A - (1-w) collisions, {what}"), by_collisions, (0.0, 1e-15), 0.015, 3);
            if let Some(value) = absorptance {
                let (path, error) = exact(value);
                let reference = (path / (1.0 - albedo), error / (1.0 - albedo));
                verdict::agrees(&format!("l, {what}"), length, reference, 0.03 * reference.0, 3);
                verdict::agrees(&format!("collisions, {what}"), collisions, reference, 0.03 * reference.0, 3);
            }
        }
    }
}

/// Paths in mean free paths, and what is absorbed beyond 1 - w = 0.1 of them.
struct Balance<'a>(Path<'a>, f64);

impl Watcher<4> for Balance<'_> {
    fn see(&mut self, walker: &Walker, step: Step) {
        self.0.see(walker, step);
    }

    fn numbers(&self) -> [f64; 4] {
        let [length, collisions, absorbed] = self.0.numbers();
        let length = length * self.1;
        [length, collisions, absorbed - 0.1 * length, absorbed - 0.1 * collisions]
    }
}

/// Absorption put on afterwards, e^(-sigma_a l) along the paths of a medium that only scatters, leaves what escapes from
/// the medium that absorbs.
#[test]
fn absorption_along_paths_that_only_scatter() {
    let albedo = 0.9;
    let (tau, radius) = (2.0, 1.5);
    let slabs = [-0.5, 0.75, 0.95].map(|g| {
        let value = referee(&medium(albedo, g), tau, Incidence::Diffuse).absorptance();
        (format!("slab, g {g}"), layer(albedo * tau), slab(albedo * tau, 1.0, g, Incidence::Diffuse), value)
    });
    let body = sphere(DVec3::ZERO, albedo * radius);
    let light = isotropic(body.clone(), Faces::Both);
    let value = Sphere::new(radius, albedo, SphereSource::Incident).unwrap().absorptance();
    let all =
        slabs.into_iter().chain([("ball".to_string(), body, ball(albedo * radius, 1.0, 0.0, light), value)]);
    for (name, shape, scene, value) in all {
        // Lengths are in mean free paths of scattering here: sigma_a = (1-w)/w.
        let [survival] =
            watched(&scene, HISTORIES, 4, || Survival(Path::inside(&shape), (1.0 - albedo) / albedo));
        let (absorbed, error) = exact(value);
        let what = format!("e^(-sigma_a l), {name}");
        verdict::agrees(&what, &survival, (1.0 - absorbed, error), 0.01, 4);
        let [path, ..] = watched(&scene, HISTORIES, 5, || Path::inside(&shape));
        let naive = exp(-path.mean() * (1.0 - albedo) / albedo);
        verdict::rejects(&format!("e^(-sigma_a <l>), {name}"), &survival, naive, 5);
    }
}

/// e^(-sigma_a l) of one photon.
struct Survival<'a>(Path<'a>, f64);

impl Watcher<1> for Survival<'_> {
    fn see(&mut self, walker: &Walker, step: Step) {
        self.0.see(walker, step);
    }

    fn numbers(&self) -> [f64; 1] {
        [exp(-self.1 * self.0.length)]
    }
}
