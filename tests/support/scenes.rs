//! Scenes from plain numbers.

use glam::DVec3;
use std::f64::consts::PI;
use std::sync::Arc;
use turbid::Spectrum;
use turbid::geometry::{Cuboid, Face, Mesh, Rectangle, Shape, Slab, Sphere};
use turbid::light::{Area, Beam, Faces, Isotropic, Light, Point, Section, VolumeSource};
use turbid::math::{Asymmetry, FOUR_PI};
use turbid::medium::{Homogeneous, Medium};
use turbid::phase::Phase;
use turbid::scene::{Interior, Object, Quantity, Region, Scene, SceneFile, SceneParts};
use turbid::surface::{Dielectric, Lambertian, Surface};

/// A scene from the text of a file.
pub fn written(text: &str) -> Scene {
    SceneFile::from_toml(text).unwrap().scene(std::path::Path::new("")).unwrap()
}

/// Side of the cells of unbounded slabs [L].
pub const CELL: f64 = 4.0;

/// How a slab is lit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Incidence {
    /// A beam of this cosine, with irradiance 1 on the top face.
    Beam(f64),
    /// Lambertian, irradiance 1 on the top face.
    Diffuse,
    /// Lambertian, irradiance 1 on both faces.
    Both,
}

pub fn homogeneous(sigma_t: Spectrum, albedo: Spectrum, g: f64) -> Medium {
    let phase = Phase::with_asymmetry(Asymmetry::try_from(g).unwrap());
    Homogeneous::new(sigma_t, albedo, phase).unwrap().into()
}

pub fn region(shape: Shape, sigma_t: f64, albedo: f64, g: f64) -> Region {
    Region { shape, medium: homogeneous(Spectrum::grey(sigma_t), Spectrum::grey(albedo), g) }
}

pub fn sphere(center: DVec3, radius: f64) -> Shape {
    Shape::Sphere(Sphere::new(center, radius).unwrap())
}

/// Corners and triangles of an octahedron with its corners on the axes at a distance of 1, normals outwards.
pub fn octahedron() -> ([DVec3; 6], [[u32; 3]; 8]) {
    let corners = [DVec3::Y, DVec3::NEG_Y, DVec3::Z, DVec3::NEG_Z, DVec3::X, DVec3::NEG_X];
    let faces = [[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]];
    (corners, faces)
}

/// A ball of 8 4^`times` triangles with its corners on the sphere, light scattered about the sphere's normals there or the triangles' own.
pub fn faceted_ball(center: DVec3, radius: f64, times: u32, is_smooth: bool) -> Shape {
    let (corners, faces) = octahedron();
    let mut triangles: Vec<[DVec3; 3]> = faces.map(|face| face.map(|i| corners[i as usize])).to_vec();
    for _ in 0..times {
        let parts = |[a, b, c]: [DVec3; 3]| {
            let [ab, bc, ca] = [a + b, b + c, c + a].map(DVec3::normalize);
            [[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]
        };
        triangles = triangles.into_iter().flat_map(parts).collect();
    }
    let positions: Vec<DVec3> = triangles.iter().flatten().map(|n| center + radius * *n).collect();
    let numbers: Vec<[u32; 3]> = (0..triangles.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    let mesh = match is_smooth {
        true => Mesh::smooth(&positions, &numbers, None, &triangles),
        false => Mesh::new(&positions, &numbers, None),
    };
    Shape::Mesh(Arc::new(mesh.unwrap()))
}

pub fn cuboid(min: DVec3, max: DVec3) -> Shape {
    Shape::Cuboid(Cuboid::new(min, max).unwrap())
}

pub fn layer(tau: f64) -> Shape {
    Shape::Slab(Slab::new(0.0, tau).unwrap())
}

pub fn rectangle(corner: DVec3, u: DVec3, v: DVec3) -> Rectangle {
    Rectangle::new(corner, u, v).unwrap()
}

pub fn incidence(shape: Shape, how: Incidence) -> Light {
    match how {
        Incidence::Beam(mu0) => {
            let dir = DVec3::new(((1.0 - mu0) * (1.0 + mu0)).sqrt(), 0.0, mu0);
            Light::Beam(Beam::new(dir, Spectrum::grey(1.0 / mu0), Section::Unbounded).unwrap())
        }
        Incidence::Diffuse => isotropic(shape, Faces::Top),
        Incidence::Both => isotropic(shape, Faces::Both),
    }
}

/// Radiance 1/pi from all sides: irradiance 1.
pub fn isotropic(shape: Shape, faces: Faces) -> Light {
    Light::Isotropic(Isotropic::new(shape, faces, Spectrum::grey(1.0 / PI)).unwrap())
}

/// Power 1, uniform in the shape.
pub fn volume_source(shape: Shape) -> Light {
    Light::VolumeSource(VolumeSource::new(shape.clone(), Spectrum::grey(1.0 / shape.volume())).unwrap())
}

pub fn point_light(position: DVec3, power: Spectrum) -> Light {
    Light::Point(Point::new(position, power).unwrap())
}

/// A small sphere of power 1.
pub fn emitting_sphere(center: DVec3, radius: f64) -> Light {
    let radiance = Spectrum::grey(1.0 / (PI * FOUR_PI * radius * radius));
    Light::Area(Area::new(sphere(center, radius), radiance).unwrap())
}

pub fn lambertian(reflectance: Spectrum) -> Surface {
    Surface::Lambertian(Lambertian::new(reflectance).unwrap())
}

pub fn area_light(rectangle: Rectangle, radiance: Spectrum) -> Light {
    Light::Area(Area::new(Shape::Rectangle(rectangle), radiance).unwrap())
}

/// A slab of optical thickness tau, extinction 1, lit with irradiance 1 (on each lit face).
pub fn slab(tau: f64, albedo: f64, g: f64, how: Incidence) -> Scene {
    let shape = layer(tau);
    Scene::new(SceneParts {
        regions: vec![region(shape.clone(), 1.0, albedo, g)],
        lights: vec![incidence(shape, how)],
        cell: Some(glam::DVec2::splat(CELL)),
        ..SceneParts::default()
    })
    .unwrap()
}

/// A ball of extinction 1 about the origin with a light.
pub fn ball(radius: f64, albedo: f64, g: f64, light: Light) -> Scene {
    let regions = vec![region(sphere(DVec3::ZERO, radius), 1.0, albedo, g)];
    Scene::new(SceneParts { regions, lights: vec![light], ..SceneParts::default() }).unwrap()
}

/// Lights, surfaces and media, bounded.
pub fn bounded(regions: Vec<Region>, objects: Vec<(Shape, Surface)>, lights: Vec<Light>) -> Scene {
    let objects = objects.into_iter().map(|(shape, surface)| Object { shape, surface }).collect();
    Scene::new(SceneParts { regions, objects, lights, ..SceneParts::default() }).unwrap()
}

/// Fluence at a depth in the middle of the cell.
pub fn at_depth(z: f64) -> Quantity {
    Quantity::Fluence(DVec3::new(0.5 * CELL, 0.5 * CELL, z))
}

pub fn reflectance(tau: f64) -> Quantity {
    Quantity::Outflow { shape: layer(tau), face: Face::Top }
}

pub fn transmittance(tau: f64) -> Quantity {
    Quantity::Outflow { shape: layer(tau), face: Face::Bottom }
}

pub fn outflow(shape: Shape) -> Quantity {
    Quantity::Outflow { shape, face: Face::Top }
}

/// The layer around a refracting slab, from which its light starts and through which it leaves.
pub fn around(tau: f64) -> Shape {
    Shape::Slab(Slab::new(-0.5 * tau, 2.0 * tau).unwrap())
}

/// An interior of some index of refraction, filled.
pub fn filled(name: &str, index: f64, medium: Medium) -> Interior {
    Interior { name: name.into(), index, medium: Some(medium) }
}

/// A boundary between the interiors of these numbers, 0 being the surroundings.
pub fn dielectric(inside: usize, outside: usize) -> Surface {
    Surface::Dielectric(Dielectric::new(inside, outside))
}

/// A slab of optical thickness tau, extinction 1, between smooth faces that refract, lit from outside with irradiance 1
/// (on each lit face); its medium has number 0.
pub fn fresnel_slab(tau: f64, albedo: f64, g: f64, index: f64, how: Incidence) -> Scene {
    let medium = homogeneous(Spectrum::ONE, Spectrum::grey(albedo), g);
    Scene::new(SceneParts {
        interiors: vec![Interior::surroundings(), filled("slab", index, medium)],
        objects: vec![Object { shape: layer(tau), surface: dielectric(1, 0) }],
        lights: vec![incidence(around(tau), how)],
        cell: Some(glam::DVec2::splat(CELL)),
        ..SceneParts::default()
    })
    .unwrap()
}

/// A ball of radius 1 and index n under radiance 1/pi from all sides; extinction `sigma_t`, nothing absorbed.
pub fn refracting_cavity(index: f64, sigma_t: f64, g: f64) -> Scene {
    let medium = homogeneous(Spectrum::grey(sigma_t), Spectrum::ONE, g);
    Scene::new(SceneParts {
        interiors: vec![Interior::surroundings(), filled("ball", index, medium)],
        objects: vec![Object { shape: sphere(DVec3::ZERO, 1.0), surface: dielectric(1, 0) }],
        lights: vec![isotropic(sphere(DVec3::ZERO, 1.5), Faces::Both)],
        ..SceneParts::default()
    })
    .unwrap()
}
