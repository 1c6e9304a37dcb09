//! Smooth meshes: photons bring what radiance about the shading normal is.

use crate::support::scenes::{bounded, dielectric, lambertian, point_light, rectangle};
use crate::support::verdict;
use glam::DVec3;
use std::f64::consts::{PI, TAU};
use std::sync::Arc;
use turbid::Spectrum;
use turbid::geometry::{Mesh, Shape};
use turbid::integrators::path;
use turbid::light::{Beam, Light, Section};
use turbid::math::{Ray, sin_cos};
use turbid::photons::{Emitter, Histories, Photon, Photons, Run, Storage};
use turbid::rng::{Purpose, Stream};
use turbid::scene::{Interior, Object, Scene, SceneParts};
use turbid::stats::Moments;
use turbid::surface::{Mirror, Surface};
use turbid::transport::NoProgress;

/// All that meets a diffuse surface is kept.
struct OnSurfaces;

impl Storage for OnSurfaces {
    fn in_medium(&self, _history: u64, _photon: &Photon) -> bool {
        false
    }

    fn on_surface(&self, _history: u64, _photon: &Photon) -> bool {
        true
    }
}

/// A square in the plane of height 0 whose normals are all tilted alike, by degrees towards x.
fn tilted(degrees: f64) -> (Shape, DVec3) {
    let (sin, cos) = sin_cos(degrees.to_radians());
    let normal = DVec3::new(sin, 0.0, cos);
    let corners = [(-20.0, -20.0), (20.0, -20.0), (20.0, 20.0), (-20.0, 20.0)];
    let corners = corners.map(|(x, y)| DVec3::new(x, y, 0.0));
    let mesh = Mesh::smooth(&corners, &[[0, 1, 2], [0, 2, 3]], None, &[[normal; 3]; 2]).unwrap();
    (Shape::Mesh(Arc::new(mesh)), normal)
}

/// Power by area of the photons that meet surfaces within a disc across the z axis, a number a pass.
fn density(scene: &Scene, center: DVec3, radius: f64, count: u64) -> Moments {
    let emitter = Emitter::by_power(scene);
    let mut moments = Moments::new();
    for replicate in 0..64 {
        let histories = Histories { count, seed: 1, replicate, max_order: None };
        let pass = Run::new(scene, &emitter, histories).pass(&OnSurfaces, &NoProgress).unwrap();
        let near = |p: &Photon| p.position.distance(center) < radius;
        let power: f64 =
            pass.surfaces.iter().flat_map(Photons::iter).filter(near).map(|p| f64::from(p.power.x)).sum();
        moments.push(power / (pass.emitted() as f64 * PI * radius * radius));
    }
    moments
}

/// Under a point light of power 1 the irradiance about a normal n is (w . n)/(4 pi d^2): paths see it to rounding, from both sides
/// of the plane across n, and photons bring it to a disc.
pub fn photons_count_about_the_shading_normal() {
    let (floor, normal) = tilted(40.0);
    let lamp = DVec3::new(0.6, 0.3, 0.9);
    let rho = 0.5;
    let light = point_light(lamp, Spectrum::ONE);
    let scene = bounded(Vec::new(), vec![(floor, lambertian(Spectrum::grey(rho)))], vec![light]);
    let irradiance = |p: DVec3| {
        let way = lamp - p;
        way.normalize().dot(normal) / (4.0 * PI * way.length_squared())
    };
    for eye in [DVec3::new(1.0, 0.4, 2.0), DVec3::new(-2.0, 0.1, 0.3)] {
        let mut stream = Stream::new(1, Purpose::Paths, 0, 0);
        let seen = path::layers(&scene, Ray::new(eye, -eye.normalize()), None, 0, &mut stream).0.total()[0];
        let expected = rho * irradiance(DVec3::ZERO) / PI;
        assert!((seen / expected - 1.0).abs() < 1e-12, "{seen} {expected}");
    }
    // Midpoints on rings of equal area: wrong by less than 1e-5.
    let radius = 0.25;
    let (rings, spokes) = (64, 64);
    let mut mean = 0.0;
    for ring in 0..rings {
        let r = radius * ((f64::from(ring) + 0.5) / f64::from(rings)).sqrt();
        for spoke in 0..spokes {
            let (sin, cos) = sin_cos(TAU * (f64::from(spoke) + 0.5) / f64::from(spokes));
            mean += irradiance(DVec3::new(r * cos, r * sin, 0.0)) / f64::from(rings * spokes);
        }
    }
    let found = density(&scene, DVec3::ZERO, radius, 1 << 15);
    verdict::agrees("irradiance about a tilted normal", &found, (mean, 1e-5 * mean), 0.08 * mean, 1);
}

/// A parallel beam of irradiance 1 across itself keeps its radiance in a mirror, and it over the squared index, less what is
/// reflected, where it is refracted: about the shading normal, so that the irradiance across the beam behind is
/// T |wi . n_s| / |wo . n_s| of it, whatever its width has become on the triangles.
pub fn specular_meshes_keep_radiance() {
    let radius = 0.8;
    let dir = DVec3::new(0.3, 0.2, -1.0).normalize();
    let section = Section::Disc { center: -1.2 * dir, radius };
    let light = || Light::Beam(Beam::new(dir, Spectrum::ONE, section).unwrap());
    let receiver = |height: f64| {
        let corner = DVec3::new(-20.0, -20.0, height);
        let plane = rectangle(corner, DVec3::X * 40.0, DVec3::Y * 40.0);
        (Shape::Rectangle(plane), lambertian(Spectrum::ZERO))
    };
    let spot = |out: DVec3, height: f64| out * (height / out.z);
    let (mesh, normal) = tilted(20.0);
    let rho = 0.8;
    let mirror = Surface::Mirror(Mirror::new(Spectrum::grey(rho)).unwrap());
    let scene = bounded(Vec::new(), vec![(mesh.clone(), mirror), receiver(2.0)], vec![light()]);
    let out = dir - 2.0 * dir.dot(normal) * normal;
    let expected = rho * out.z;
    let found = density(&scene, spot(out, 2.0), 0.4, 1 << 12);
    verdict::agrees("behind a mirror", &found, (expected, 1e-7 * expected), 0.05 * expected, 1);
    let index: f64 = 1.5;
    let cos_in = -dir.dot(normal);
    let across = dir + cos_in * normal;
    let cos_out = (1.0 - across.length_squared() / (index * index)).sqrt();
    let out = across / index - cos_out * normal;
    let s = (cos_in - index * cos_out) / (cos_in + index * cos_out);
    let p = (index * cos_in - cos_out) / (index * cos_in + cos_out);
    let passed = 1.0 - 0.5 * (s * s + p * p);
    let expected = passed * cos_in / cos_out * -out.z;
    let (floor, surface) = receiver(-2.0);
    let scene = Scene::new(SceneParts {
        interiors: vec![Interior::surroundings(), Interior { name: "glass".into(), index, medium: None }],
        objects: vec![Object { shape: mesh, surface: dielectric(1, 0) }, Object { shape: floor, surface }],
        lights: vec![light()],
        ..SceneParts::default()
    })
    .unwrap();
    let found = density(&scene, spot(out, -2.0), 0.4, 1 << 12);
    verdict::agrees("behind glass", &found, (expected, 1e-7 * expected), 0.05 * expected, 1);
}

/// Photons on smooth meshes, diffuse and specular.
pub fn smooth_meshes_scatter_photons_as_radiance() {
    photons_count_about_the_shading_normal();
    specular_meshes_keep_radiance();
}
