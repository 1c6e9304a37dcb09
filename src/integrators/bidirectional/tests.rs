//! Whole paths, made by both subpaths in scenes by chance: the weights of all techniques on each of them add up to one.

use super::light::subpath;
use super::sources::Sources;
use super::vertex::{Scatterer, Vertex, is_specular};
use super::weights::Ways;
use crate::Spectrum;
use crate::geometry::{Cuboid, Rectangle, Shape, Sphere};
use crate::integrators::Rays;
use crate::light::{Area, Beam, Light, Point, Section, Spot, Sun};
use crate::math::{Asymmetry, Ray, warp};
use crate::medium::{Cloud, CloudShape, Density, Heterogeneous, Homogeneous, Medium};
use crate::phase::Phase;
use crate::rng::{Purpose, Stream};
use crate::scene::{Interior, Object, Region, Scene, SceneParts};
use crate::surface::{Dielectric, Lambertian, Mirror, Surface};
use crate::transport::{Roulette, Step, Visitor, Walker, connection, walk};
use glam::DVec3;

/// A flight of a path: the directions of travel at its end nearer to the light and at the other, from the light to the eye, and whether nothing
/// specular lies between.
#[derive(Clone, Copy)]
struct Flight {
    leaving: DVec3,
    arriving: DVec3,
    is_direct: bool,
}

/// Vertices of a walk, and the flight to each.
struct Recorder<'a> {
    scene: &'a Scene,
    vertices: Vec<(Vertex<'a>, Flight)>,
    leaving: Option<DVec3>,
    is_specular: bool,
}

impl<'a> Recorder<'a> {
    fn push(&mut self, vertex: Vertex<'a>) {
        let leaving = self.leaving.unwrap_or(vertex.from);
        let flight = Flight { leaving, arriving: vertex.from, is_direct: !self.is_specular };
        self.vertices.push((vertex, flight));
        (self.leaving, self.is_specular) = (None, false);
    }
}

impl Visitor for Recorder<'_> {
    fn visit(&mut self, walker: &Walker, step: Step, _stream: &mut Stream) {
        match step {
            Step::Ahead(_) => {
                self.leaving.get_or_insert(walker.ray.dir);
            }
            Step::Collision(arrival, number) => self.push(Vertex::in_medium(self.scene, &arrival, number)),
            Step::Surface(arrival, found) => match Vertex::on_surface(self.scene, &arrival, found) {
                Some(vertex) => self.push(vertex),
                None => self.is_specular |= is_specular(self.scene, found),
            },
            _ => {}
        }
    }
}

fn recorded<'a>(scene: &'a Scene, start: Walker, stream: &mut Stream) -> Vec<(Vertex<'a>, Flight)> {
    let mut recorder = Recorder { scene, vertices: Vec::new(), leaving: None, is_specular: false };
    walk(scene, start, Roulette::Analog, Some(4), stream, &mut recorder);
    recorder.vertices
}

fn medium(sigma_t: Spectrum, g: f64) -> Homogeneous {
    let phase = Phase::with_asymmetry(Asymmetry::new("g", g).unwrap());
    Homogeneous::new(sigma_t, Spectrum::rgb(0.9, 0.8, 0.7), phase).unwrap()
}

/// Fog of chance in a box of diffuse walls, with a ball of foggy glass, a mirror, a cloud, and a light of each kind.
fn scene(stream: &mut Stream) -> Scene {
    let mut unit = || stream.unit();
    let (low, high) = (DVec3::splat(-1.0), DVec3::splat(1.0));
    let [x, y, z] = DVec3::AXES.map(|axis| axis * 2.0);
    let diffuse = || Surface::Lambertian(Lambertian::new(Spectrum::rgb(0.8, 0.6, 0.5)).unwrap());
    let wall = |corner, u, v, surface| Object {
        shape: Shape::Rectangle(Rectangle::new(corner, u, v).unwrap()),
        surface,
    };
    let mirror = Surface::Mirror(Mirror::new(Spectrum::grey(0.9)).unwrap());
    let ball = |p: DVec3, radius| Shape::Sphere(Sphere::new(p, radius).unwrap());
    let cloud = Cloud::new(CloudShape::plain(DVec3::new(0.5, 0.5, -0.4), DVec3::splat(0.4))).unwrap();
    let cloud = Heterogeneous::new(medium(Spectrum::grey(4.0 * unit()), 0.5), Density::Cloud(cloud.into()));
    let lamp = Rectangle::new(DVec3::new(-0.3, 0.95, -0.3), DVec3::X * 0.6, DVec3::Z * 0.6).unwrap();
    let down = DVec3::new(unit() - 0.5, -1.0, unit() - 0.5);
    let (at, one) = (DVec3::new(0.2, 0.6, 0.3), Spectrum::ONE);
    let section = Section::Disc { center: DVec3::new(0.0, 0.8, 0.0), radius: 0.3 };
    let lights = vec![
        Light::Area(Area::new(Shape::Rectangle(lamp), Spectrum::rgb(3.0, 2.0, 1.0)).unwrap()),
        Light::Area(Area::new(ball(DVec3::new(-0.6, 0.2, 0.5), 0.1), one).unwrap()),
        Light::Point(Point::new(at, one).unwrap()),
        Light::Spot(Spot::new(-at, down, (20.0, 50.0), one).unwrap()),
        Light::Beam(Beam::new(down, one, section).unwrap()),
        Light::Sun(Sun::new(down, one, 5.0).unwrap()),
        Light::Sun(Sun::new(down, one, 0.0).unwrap()),
    ];
    let region = |shape, medium: Medium| Region { shape, medium };
    let fog = medium(Spectrum::rgb(0.2, 0.5, 1.0) * (2.0 * unit()), unit() - 0.3);
    let glass = medium(Spectrum::grey(2.0 * unit()), 0.2);
    let glass = Interior { name: "glass".into(), index: 1.0 + unit(), medium: Some(glass.into()) };
    Scene::new(SceneParts {
        regions: vec![
            region(Shape::Cuboid(Cuboid::new(low, high).unwrap()), fog.into()),
            region(ball(DVec3::new(0.5, 0.5, -0.4), 0.45), cloud.into()),
        ],
        interiors: vec![Interior::surroundings(), glass],
        objects: vec![
            wall(low, x, z, diffuse()),
            wall(low, y, x, diffuse()),
            wall(low, z, y, diffuse()),
            wall(high, -z, -y, mirror),
            Object {
                shape: ball(DVec3::new(0.1, -0.4, 0.0), 0.4),
                surface: Surface::Dielectric(Dielectric::new(1, 0)),
            },
        ],
        lights,
        ..SceneParts::default()
    })
    .unwrap()
}

/// The same vertex of the other subpath, which arrives along `from`.
fn turned<'a>(vertex: &Vertex<'a>, from: DVec3) -> Vertex<'a> {
    Vertex { from, ways: Ways::FIRST, ..*vertex }
}

/// The weights of all techniques that can make a path.
///
/// # Arguments
/// `vertices` with the flight to each, from the light to the eye; `light` its number and how the path starts from it
fn weights(
    scene: &Scene,
    sources: &Sources,
    (index, start): (usize, &Walker),
    vertices: &[(Vertex, Flight)],
) -> Vec<f64> {
    let m = vertices.len();
    let flights: Vec<Flight> = vertices.iter().map(|(_, flight)| *flight).collect();
    // Leaving v_i towards v_(i+1), in the order of the path; and the eye's own vertices.
    let mut light: Vec<Vertex> = vertices.iter().map(|(v, flight)| turned(v, flight.arriving)).collect();
    light[0].ways = sources.ways(index, start, &light[0], flights[0].is_direct);
    for i in 1..m {
        light[i].ways = light[i - 1].ways_to(scene, &light[i], flights[i].leaving, flights[i].is_direct);
    }
    let towards_eye = |i: usize| if i + 1 < m { flights[i + 1].leaving } else { -vertices[i].0.from };
    let mut eye: Vec<Vertex> = (0..m).map(|i| turned(&vertices[i].0, -towards_eye(i))).collect();
    for i in (0..m - 1).rev() {
        let flight = flights[i + 1];
        eye[i].ways = eye[i + 1].ways_to(scene, &eye[i], -flight.arriving, flight.is_direct);
    }
    let mut weights = Vec::new();
    let dir = -flights[0].arriving;
    if flights[0].is_direct {
        let arriving = sources.arriving(index, eye[0].position, dir).unwrap();
        weights.extend(sources.shares(&eye[0], dir, &arriving, None));
    } else if !scene.lights()[index].is_delta() {
        let seen = Ray::new(start.ray.origin, -start.ray.dir);
        let radiance = match &scene.lights()[index] {
            Light::Area(area) => area.radiance(),
            sun => sun.background(&seen).unwrap().0,
        };
        let arriving = super::Arriving::met(radiance, 1.0, 1.0);
        let scale = sources.scale(eye[0].interior, start.interior);
        weights.push(sources.shares(&eye[0], dir, &arriving, Some(scale))[0]);
    }
    for i in 1..m {
        if flights[i].is_direct {
            let (y, z) = (&light[i - 1], &eye[i]);
            let between = y.position - z.position;
            weights.push(y.share(scene, z, between.normalize(), between.length()));
        }
    }
    weights
}

/// Paths that a connection makes: each technique's weight is asked of the vertices that its own subpaths would have.
#[test]
fn weights_of_a_path_add_up_to_one() {
    let mut stream = Stream::new(1, Purpose::Synthetic, 0, 0);
    let (mut made, mut specular, mut surfaces, mut most) = (0, 0, 0, 0);
    let mut kinds = [0; 7];
    for _ in 0..40 {
        let scene = scene(&mut stream);
        let sources = Sources::new(&scene);
        for _ in 0..500 {
            let Some((index, start)) = sources.start(&mut stream) else { continue };
            let light = recorded(&scene, start, &mut stream);
            let dir = warp::square_to_sphere(stream.pair()).normalize();
            let eye = Ray::new(DVec3::new(-0.7, 0.7, 0.7), dir);
            let eye = recorded(&scene, Walker::new(eye, Spectrum::ONE), &mut stream);
            for (a, (y, _)) in light.iter().enumerate() {
                for (b, (z, _)) in eye.iter().enumerate() {
                    let between = z.position - y.position;
                    let dir = between.normalize();
                    let place = (&Ray::new(z.position, -dir), z.body, z.interior);
                    let towards = y.body.map(|body| body.target);
                    let is_lit = !(y.sent(dir) * z.gathered(-dir)).is_black();
                    if !is_lit || connection(&scene, place, between.length(), towards, &mut stream).is_none()
                    {
                        continue;
                    }
                    let joined = Flight { leaving: dir, arriving: dir, is_direct: true };
                    let mut path: Vec<(Vertex, Flight)> = light[..=a].to_vec();
                    path.push((*z, joined));
                    // The eye's flights, the other way round.
                    for i in (0..b).rev() {
                        let Flight { leaving, arriving, is_direct } = eye[i + 1].1;
                        let back = Flight { leaving: -arriving, arriving: -leaving, is_direct };
                        path.push((eye[i].0, back));
                    }
                    let all = weights(&scene, &sources, (index, &start), &path);
                    let sum: f64 = all.iter().sum();
                    let is_about = (sum - 1.0).abs() < 1e-6;
                    assert!(is_about, "{sum}: {all:?}, light {index}, {} vertices", path.len());
                    made += 1;
                    kinds[index] += 1;
                    most = most.max(all.iter().filter(|w| **w > 0.01).count());
                    specular += usize::from(path.iter().any(|(_, flight)| !flight.is_direct));
                    surfaces += usize::from(
                        path.iter().any(|(v, _)| matches!(v.scatterer, Scatterer::Surface { .. })),
                    );
                }
            }
        }
    }
    assert!(
        made > 5000 && specular > 1000 && surfaces > 1000 && most >= 5,
        "{made} {specular} {surfaces} {most}"
    );
    assert!(kinds.iter().all(|made| *made > 100), "{kinds:?}");
}

/// The subpath of light has the vertices of the photon's walk, up to the order that is asked for.
#[test]
fn subpaths_end_with_their_order() {
    let mut stream = Stream::new(2, Purpose::Synthetic, 0, 0);
    let scene = scene(&mut stream);
    let (sources, mut rays, mut longest) = (Sources::new(&scene), Rays::default(), 0);
    for _ in 0..200 {
        let vertices = subpath(&scene, &sources, Some(3), &mut rays, &mut stream);
        assert!(vertices.iter().enumerate().all(|(i, vertex)| vertex.order as usize == i + 1));
        longest = longest.max(vertices.len());
    }
    assert!(longest == 3 && rays.segments > 200, "{longest}");
}
