//! The subpath of light: a photon's walk, with what the weights need at each of its scatterings.

use super::sources::Sources;
use super::vertex::{Vertex, is_specular};
use crate::integrators::Rays;
use crate::rng::Stream;
use crate::scene::Scene;
use crate::transport::{Roulette, Step, Visitor, Walker, walk};
use glam::DVec3;

/// The scatterings of one photon up to an order, nearest to the light first.
pub(super) fn subpath<'a>(
    scene: &'a Scene,
    sources: &Sources,
    limit: Option<u32>,
    rays: &mut Rays,
    stream: &mut Stream,
) -> Vec<Vertex<'a>> {
    let Some((index, start)) = sources.start(stream) else { return Vec::new() };
    let mut photon = Photon {
        scene,
        sources,
        light: (index, start),
        vertices: Vec::new(),
        leaving: None,
        is_specular: false,
        segments: 0,
    };
    walk(scene, start, Roulette::Analog, limit, stream, &mut photon);
    rays.segments += photon.segments;
    photon.vertices
}

struct Photon<'a, 's> {
    scene: &'a Scene,
    sources: &'s Sources<'s>,
    /// The number of the light, and how the photon left it.
    light: (usize, Walker),
    vertices: Vec<Vertex<'a>>,
    /// Direction in which it left its last vertex, and whether it met a specular surface since.
    leaving: Option<DVec3>,
    is_specular: bool,
    segments: u64,
}

impl<'a> Photon<'a, '_> {
    fn scatter(&mut self, mut vertex: Vertex<'a>) {
        vertex.ways = match (self.vertices.last(), self.leaving) {
            (Some(last), Some(leaving)) => last.ways_to(self.scene, &vertex, leaving, !self.is_specular),
            _ => self.sources.ways(self.light.0, &self.light.1, &vertex, !self.is_specular),
        };
        self.vertices.push(vertex);
        (self.leaving, self.is_specular) = (None, false);
    }
}

impl Visitor for Photon<'_, '_> {
    const LOOKS_AHEAD: bool = false;

    fn visit(&mut self, walker: &Walker, step: Step, _stream: &mut Stream) {
        match step {
            Step::Ahead(_) => {
                self.segments += 1;
                self.leaving.get_or_insert(walker.ray.dir);
            }
            Step::Collision(arrival, number) => {
                self.scatter(Vertex::in_medium(self.scene, &arrival, number));
            }
            Step::Surface(arrival, found) => match Vertex::on_surface(self.scene, &arrival, found) {
                Some(vertex) => self.scatter(vertex),
                None => self.is_specular |= is_specular(self.scene, found),
            },
            Step::Uncollided(..) | Step::Absorbed(..) | Step::Escaped(_) | Step::Truncated(_) => {}
        }
    }
}
