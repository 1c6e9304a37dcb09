//! What a camera can see at all, and photons drawn as dots.

use crate::Spectrum;
use crate::error::{Error, Result};
use crate::math::{Ray, warp};
use crate::photons::Photon;
use crate::rng::{Purpose, Stream};
use crate::scene::{Camera, Scene, Target};
use glam::{DVec2, DVec3};
use rayon::prelude::*;

/// Rays that look for a way out, and photons that look for a way in.
const TRIALS: u64 = 64;

/// Photons that are placed at once, before they are added up in order.
const DRAWN: usize = 1 << 16;

/// Refuses a camera inside a closed opaque object that no light is in: its picture would be black.
///
/// All of 64 directions meet the inner side of one opaque object, and none of 64 photons of any light starts inside it.
/// Light that several objects shut out together is not recognised.
///
/// # Errors
/// `Error::Scene`, naming the object.
pub fn check_camera(scene: &Scene, camera: &Camera) -> Result<()> {
    let mut around = None;
    for i in 0..TRIALS {
        let mut stream = Stream::new(0, Purpose::Synthetic, 0, i);
        let ray = Ray::new(camera.position(), warp::square_to_sphere(stream.pair()).normalize());
        let Some(found) = scene.hit(&ray, None) else { return Ok(()) };
        let Target::Object(index) = found.target else { return Ok(()) };
        let is_inner_side = found.hit.normal.dot(ray.dir) > 0.0;
        let is_same = around.is_none_or(|other| other == index);
        if !(scene.objects()[index].surface.is_opaque() && is_inner_side && is_same) {
            return Ok(());
        }
        around = Some(index);
    }
    let Some(index) = around else { return Ok(()) };
    let shape = &scene.objects()[index].shape;
    // A closed shape: what starts outside enters it first, seen on its way to the camera.
    let starts_inside = |origin: DVec3| {
        let Some(dir) = (camera.position() - origin).try_normalize() else { return true };
        shape.hit(&Ray::new(origin, dir), None).is_none_or(|hit| hit.normal.dot(dir) > 0.0)
    };
    for light in scene.lights() {
        for i in 0..TRIALS {
            let mut stream = Stream::new(0, Purpose::Synthetic, 1, i);
            if starts_inside(light.emit(scene.periodic_cell(), &mut stream).ray.origin) {
                return Ok(());
            }
        }
    }
    Err(Error::Scene(format!(
        "enclosed camera: it is inside objects[{index}], which is closed and opaque, and no light is in there with it"
    )))
}

/// Whether nothing opaque stands between the camera and a point, or a little before it: photons keep their places in
/// single precision.
fn is_visible(scene: &Scene, camera: &Camera, p: DVec3) -> bool {
    let towards = p - camera.position();
    let distance = towards.length();
    let (mut ray, mut start) = (Ray::new(camera.position(), towards / distance), None);
    let mut left = distance * (1.0 - 1e-4);
    // Glass and coloured windows hide nothing; a photon behind very many of them is given up.
    for _ in 0..64 {
        let Some(found) = scene.hit(&ray, start).filter(|found| found.hit.t < left) else { return true };
        match found.target {
            Target::Object(index) if !scene.objects()[index].surface.is_opaque() => {
                left -= found.hit.t;
                ray = Ray::new(ray.at(found.hit.t), ray.dir);
                start = Some(crate::scene::Start { target: found.target, primitive: found.hit.primitive });
            }
            _ => return false,
        }
    }
    false
}

/// The colour of a photon's dot: its power, over that of its strongest channel.
pub fn colour(photon: &Photon) -> Spectrum {
    let power = photon.power.as_dvec3();
    let strongest = power.max_element();
    if strongest > 0.0 { Spectrum(power / strongest) } else { Spectrum::ZERO }
}

/// Photons as dots seen from the camera, row by row from the top: every dot adds its colour, one in all, to the four
/// pixels about the place it is seen at. Returns how many are in the picture, too.
///
/// Photons behind opaque surfaces are hidden; what is seen by way of mirrors and refraction is not drawn. The number beside
/// each photon, what its map's pass sent out, does not count here.
pub fn draw_photons(scene: &Scene, camera: &Camera, photons: &[(Photon, u64)]) -> (Vec<Spectrum>, u64) {
    let (width, height) = (camera.width() as usize, camera.height() as usize);
    let place = |photon: &Photon| {
        camera.pixel(photon.position)?;
        let at = camera.project(photon.position)?;
        is_visible(scene, camera, photon.position).then_some(at)
    };
    let (mut picture, mut count) = (vec![Spectrum::ZERO; width * height], 0);
    let parts = photons.chunks(DRAWN).map(|part| (part, part.par_iter().map(|(photon, _)| place(photon))));
    let placed = parts.flat_map(|(part, places)| part.iter().zip(places.collect::<Vec<_>>()));
    for ((photon, _), at) in placed {
        let Some(at) = at else { continue };
        count += 1;
        let corner = at - DVec2::splat(0.5);
        let (first, part) = (corner.floor(), corner - corner.floor());
        for (dx, dy) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
            let share = |d: i64, part: f64| if d == 1 { part } else { 1.0 - part };
            let (x, y) = (first.x as i64 + dx, first.y as i64 + dy);
            if (0..width as i64).contains(&x) && (0..height as i64).contains(&y) {
                picture[y as usize * width + x as usize] +=
                    colour(photon) * (share(dx, part.x) * share(dy, part.y));
            }
        }
    }
    (picture, count)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Rectangle, Shape, Sphere};
    use crate::light::{Light, Point};
    use crate::scene::{Filter, Object, SceneParts, View};
    use crate::surface::{Lambertian, Surface};
    use crate::transport::Flags;
    use glam::Vec3;

    fn camera() -> Camera {
        let (position, look_at, up) = (DVec3::ZERO, DVec3::Z, DVec3::Y);
        Camera::new(View { position, look_at, up, fov: 90.0, width: 8, height: 8, filter: Filter::Box })
            .unwrap()
    }

    fn scene(shape: Shape, light: DVec3) -> Scene {
        let surface = Surface::Lambertian(Lambertian::new(Spectrum::grey(0.5)).unwrap());
        let light = Light::Point(Point::new(light, Spectrum::ONE).unwrap());
        let objects = vec![Object { shape, surface }];
        Scene::new(SceneParts { objects, lights: vec![light], ..SceneParts::default() }).unwrap()
    }

    #[test]
    fn a_camera_in_a_body_without_light_is_refused() {
        let ball = || Shape::Sphere(Sphere::new(DVec3::ZERO, 1.0).unwrap());
        let text = check_camera(&scene(ball(), DVec3::X * 3.0), &camera()).unwrap_err().to_string();
        assert!(text.contains("enclosed camera") && text.contains("objects[0]"), "{text}");
        // With the lamp inside it is a room; beside the camera it is a ball.
        assert_eq!(check_camera(&scene(ball(), DVec3::X * 0.5), &camera()), Ok(()));
        let beside = Shape::Sphere(Sphere::new(DVec3::Z * 3.0, 1.0).unwrap());
        assert_eq!(check_camera(&scene(beside, DVec3::X * 3.0), &camera()), Ok(()));
    }

    #[test]
    fn dots_are_where_their_photons_are_unless_hidden() {
        let screen = Rectangle::new(DVec3::new(0.0, -9.0, 2.0), DVec3::X * 9.0, DVec3::Y * 18.0).unwrap();
        let scene = scene(Shape::Rectangle(screen), DVec3::X * -5.0);
        let at = |position: DVec3| Photon {
            position,
            dir: Vec3::Z,
            normal: Vec3::ZERO,
            power: Vec3::new(2.0, 1.0, 0.0),
            order: 0,
            flags: Flags::NONE,
        };
        // Raster x grows to the camera's right, which is -X here.
        let left = camera().ray(DVec2::new(6.5, 2.5)).at(6.0);
        let hidden = camera().ray(DVec2::new(1.5, 2.5)).at(6.0);
        let before = camera().ray(DVec2::new(1.5, 5.5)).at(1.0);
        let behind_us = -DVec3::Z;
        let (picture, count) =
            draw_photons(&scene, &camera(), &[left, hidden, before, behind_us].map(|p| (at(p), 1)));
        assert_eq!(count, 2);
        let sum = picture.iter().fold(Spectrum::ZERO, |sum, p| sum + *p);
        assert!((sum.0 - DVec3::new(2.0, 1.0, 0.0)).abs().max_element() < 1e-12);
        for (x, y) in [(6, 2), (1, 5)] {
            assert!((picture[y * 8 + x].0 - DVec3::new(1.0, 0.5, 0.0)).abs().max_element() < 1e-9);
        }
    }
}
