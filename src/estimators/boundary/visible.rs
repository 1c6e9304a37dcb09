//! Photons that a point sees: those of its medium that no body hides, and the part of a ball where such photons can be.
//!
//! What a point sees is a star about it: on a ray it ends at the first body, or where the medium ends. The part of the
//! kernel on a ray is then known in closed form, and only the directions are sampled. Where one flat face parts the whole
//! ball, nothing is.

use super::moments::LEAST_OF_ALL;
use super::sheets::{FaceLine, Sheets, rectangles_of};
use super::surfaces::Boundary;
use crate::estimators::Kernel;
use crate::estimators::disc_share::share_in_circle;
use crate::estimators::kernel::UNIT_BALL;
use crate::geometry::{Face, Front, Rectangle, Shape};
use crate::math::{Frame, Interval, Ray, sin_cos, warp};
use crate::photons::PhotonTree;
use crate::photons::tree::Neighbors;
use crate::rng::{Purpose, Stream};
use glam::{DVec2, DVec3};
use libm::cbrt;
use std::f64::consts::TAU;
use std::sync::LazyLock;

/// Directions of a set: at a flat wall the part is then within a hundredth or so of the true one, and right in the mean.
const DIRECTIONS: u32 = 64;
/// Sets are added until the parts on their directions sum to this times the largest: an estimate divides by the part, and the mean of 1/part
/// is 1 plus the part's relative variance.
const ENOUGH: f64 = 24.0;
/// Directions across a ray: at a flat wall the part is then within about a hundredth of the true one.
pub(super) const ACROSS: u32 = 32;
/// No more sets than this; nor is a part less than one direction of all of them.
const SETS: u32 = 16;
/// A medium is flat if it fills less than this of a ball as far as its end, or the kernel's: directions would then hardly ever add up to enough.
const FLAT: f64 = 0.1;
/// Bodies lie in or behind a plane if they reach no farther out of it than this part of the point's distance: what rounding
/// of a scene's numbers leaves. They hide no larger part of the kernel then.
const ON_PLANE: f64 = 1e-6;
/// The farthest that a point lies from the middle of a circle, in parts of its radius.
const INSIDE: f64 = 1.0 - 1e-12;
/// Turns of this angle spread points evenly about an axis \[rad\]: pi (3 - sqrt 5).
const GOLDEN_ANGLE: f64 = 2.399_963_229_728_653;

/// A spiral of directions, each for an equal part of the sphere.
static SPIRAL: LazyLock<Vec<DVec3>> = LazyLock::new(|| {
    let one = |n: u32| {
        let z = 1.0 - (2.0 * f64::from(n) + 1.0) / f64::from(DIRECTIONS);
        let (sin, cos) = sin_cos(GOLDEN_ANGLE * f64::from(n));
        let across = (1.0 - z * z).sqrt();
        DVec3::new(across * cos, across * sin, z)
    };
    (0..DIRECTIONS).map(one).collect()
});

/// Cosines and sines of directions at equal angles.
static CIRCLE: LazyLock<[DVec2; ACROSS as usize]> = LazyLock::new(|| {
    std::array::from_fn(|n| {
        let (sin, cos) = sin_cos(TAU * n as f64 / f64::from(ACROSS));
        DVec2::new(cos, sin)
    })
});

/// The part of a disc's kernel in which photons are kept.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::estimators) struct DiscShare {
    /// Of 1.
    pub part: f64,
    /// Whether some directions tell it, not a closed form.
    pub is_sampled: bool,
}

impl DiscShare {
    /// All of it.
    pub const WHOLE: DiscShare = DiscShare::exact(1.0);
    /// Below this a closed form is rounding.
    pub(super) const LEAST: f64 = f64::EPSILON;

    /// By a closed form.
    pub const fn exact(part: f64) -> Self {
        DiscShare { part, is_sampled: false }
    }

    /// What a photon is divided by that is kept, `seen` over the radius from the middle: no less than the one direction brings in which it
    /// is, where directions tell the share.
    pub fn divisor(self, kernel: Kernel, seen: f64) -> f64 {
        let least = if self.is_sampled { kernel.within_disc(seen) / f64::from(ACROSS) } else { 0.0 };
        self.part.max(least).max(DiscShare::LEAST)
    }
}

/// Random numbers of a place and `salt`.
fn stream_of(place: DVec3, salt: u64) -> Stream {
    let [x, y, z] = place.to_array().map(f64::to_bits);
    Stream::new(x, Purpose::Resampling, y, z ^ salt.rotate_left(32))
}

/// A body near a point.
struct Body<'a> {
    shape: &'a Shape,
    /// How far away it is \[L\].
    distance: f64,
    /// A plane on whose near side it hides nothing.
    front: Option<Front>,
}

/// What lies about a point of a medium, within a distance.
pub(in crate::estimators) struct Surroundings<'a> {
    /// From where is looked.
    eye: DVec3,
    /// The shape of the medium, where other media may be beyond it.
    medium: Option<&'a Shape>,
    /// Distance to its surface; endless where that is not known \[L\].
    room: f64,
    is_only: bool,
    bodies: Vec<Body<'a>>,
    /// Regions that count instead of the medium, and how far away they are \[L\].
    later: Vec<(f64, &'a Shape)>,
    /// Distance to the nearest of either \[L\].
    clear: f64,
    /// The one plane that all bodies lie in or behind, where one of them fills it as far as is looked.
    screen: Option<Front>,
}

impl<'a> Surroundings<'a> {
    /// What is nearer to a point than `reach`; `eye` is the point, or next to it on the side from which a body is seen that
    /// the point lies on.
    pub fn new(boundary: &'a Boundary<'_>, point: DVec3, eye: DVec3, reach: f64) -> Self {
        let shapes = (boundary.bodies.iter(), boundary.later.iter());
        Self::among(boundary, shapes, (point, eye), reach)
    }

    /// The same where only these bodies and regions of the boundary can be that near.
    pub fn among(
        boundary: &'a Boundary<'_>,
        (bodies, later): (impl Iterator<Item = &'a Shape>, impl Iterator<Item = &'a Shape>),
        (point, eye): (DVec3, DVec3),
        reach: f64,
    ) -> Self {
        let near = |shape: &'a Shape| {
            let distance = shape.distance(point, reach);
            (distance < reach).then_some((distance, shape))
        };
        let body = |(distance, shape): (f64, &'a Shape)| Body { shape, distance, front: shape.front(eye) };
        let bodies: Vec<Body<'a>> = bodies.filter_map(near).map(body).collect();
        let mut later: Vec<(f64, &'a Shape)> = later.filter_map(near).collect();
        // One that holds the point holds the medium too.
        later.retain(|(_, shape)| !shape.contains(point));
        let distances = bodies.iter().map(|body| body.distance).chain(later.iter().map(|(d, _)| *d));
        let clear = distances.fold(f64::INFINITY, f64::min);
        let screens = bodies.iter().filter(|body| body.shape.parts_ball(eye, reach));
        let hides_all = |front: &Front| {
            bodies.iter().all(|body| body.shape.is_behind(eye, front, ON_PLANE * front.distance))
        };
        let screen = screens.filter_map(|body| body.front).find(hides_all);
        let medium = boundary.medium;
        let room = medium.map_or(f64::INFINITY, |medium| medium.room(eye));
        Surroundings { eye, medium, room, is_only: boundary.is_only, bodies, later, clear, screen }
    }

    /// Whether a ball about the point meets neither bodies nor regions that count instead.
    pub fn is_clear(&self, radius: f64) -> bool {
        self.clear >= radius
    }

    /// How many photons within a radius do not count.
    pub fn count_rejected(&self, tree: &PhotonTree, point: DVec3, radius: f64) -> usize {
        let mut count = 0;
        if !self.is_clear(radius) || (!self.is_only && self.room < radius) {
            // Nothing is hidden that is nearer than the nearest body, rounding allowed for.
            let safe = if self.is_only { self.clear } else { self.clear.min(self.room).max(0.0) };
            let safe = (0.99 * safe / radius).powi(2) as f32;
            tree.within(point, radius, &mut |neighbors: Neighbors<'_>| {
                let u2 = neighbors.u2().to_array();
                let rejected =
                    |(lane, place): &(usize, usize)| u2[*lane] >= safe && !self.keeps(tree.position(*place));
                count += neighbors.places().filter(rejected).count();
            });
        }
        count
    }

    /// Whether a photon counts: it lies in the medium, and no body hides it.
    pub fn keeps(&self, place: DVec3) -> bool {
        self.owns(place) && self.sees(place)
    }

    fn owns(&self, place: DVec3) -> bool {
        (self.is_only || self.medium.is_none_or(|medium| medium.contains(place)))
            && !self.later.iter().any(|(_, shape)| shape.contains(place))
    }

    /// Whether no body hides a place.
    pub fn sees(&self, place: DVec3) -> bool {
        let away = place - self.eye;
        let is_before = |front: &Front| front.height(away) >= 0.0;
        if let Some(screen) = &self.screen {
            return is_before(screen);
        }
        let distance = away.length();
        let hides = |body: &Body| {
            body.distance < distance
                && !body.front.as_ref().is_some_and(is_before)
                && body.shape.is_between(self.eye, place)
        };
        // The nearest body, that is, or the eye's own shift.
        distance < 0.999 * self.clear || !self.bodies.iter().any(hides)
    }

    /// The part of a kernel on a ray that is in the medium and seen, up to a `reach` \[L\]; `within` is the part within a distance over the
    /// radius.
    fn along(&self, within: &impl Fn(f64) -> f64, dir: DVec3, (radius, reach): (f64, f64)) -> f64 {
        let ray = Ray::new(self.eye, dir);
        let mut end = reach;
        for body in &self.bodies {
            if !body.front.is_some_and(|front| front.height(dir * end) >= 0.0) {
                end = body.shape.until(&ray, end);
            }
        }
        if let Some(medium) = self.medium.filter(|_| self.room < radius) {
            end = medium.interval(&ray).map_or(0.0, |inside| inside.end.min(end));
        }
        let whole = Interval { start: 0.0, end };
        let inside = |(_, shape): &(f64, &Shape)| shape.interval(&ray)?.intersection(whole);
        let mut others: Vec<Interval> = self.later.iter().filter_map(inside).collect();
        others.sort_by(|a, b| a.start.total_cmp(&b.start));
        let up_to = |t: f64| within(t / radius);
        let (mut sum, mut from) = (0.0, 0.0f64);
        for other in others {
            if other.start > from {
                sum += up_to(other.start) - up_to(from);
            }
            from = from.max(other.end);
        }
        if end > from { sum + up_to(end) - up_to(from) } else { sum }
    }

    /// The part of the kernel in which photons are kept, which a sum over photons is divided by: by rays in directions that are
    /// turned at random, right in the mean over turns. The turn is a function of the place and of `salt`: with that of a
    /// map's run means over maps are right at a single point too. Where few directions see far into a flat medium, they tell what is near, and
    /// random places what is not.
    pub fn share(&self, kernel: Kernel, radius: f64, salt: u64) -> f64 {
        if let Some(screen) = self.screen.filter(|_| self.room >= radius && self.later.is_empty()) {
            return 1.0 - kernel.beyond_plane(screen.distance / radius);
        }
        // What the kernel has within the farthest end of the medium: no direction has more, and the part in a medium that is small beside
        // the kernel is as small.
        let most = self.medium.and_then(Shape::bounds).map_or(1.0, |(center, size)| {
            kernel.within(((self.eye.distance(center) + size) / radius).min(1.0)).max(LEAST_OF_ALL)
        });
        let mut stream = stream_of(self.eye, salt);
        let within = |u: f64| kernel.within(u);
        let in_a_set = |stream: &mut Stream, reach: f64| {
            let axes = Frame::new(warp::square_to_sphere(stream.pair()));
            let (sin, cos) = sin_cos(TAU * stream.unit());
            let (across, beside) = (axes.x * cos + axes.y * sin, axes.y * cos - axes.x * sin);
            let turned = |dir: &DVec3| (across * dir.x + beside * dir.y + axes.z * dir.z).normalize();
            SPIRAL.iter().map(|dir| self.along(&within, turned(dir), (radius, reach))).sum::<f64>()
        };
        let (low, high) = self.box_about(radius);
        let volume = ((high - low) / radius).element_product();
        if volume > FLAT * UNIT_BALL * most {
            let (mut sum, mut sets) = (0.0, 0);
            while sum < ENOUGH * most && sets < SETS {
                sum += in_a_set(&mut stream, radius);
                sets += 1;
            }
            return (sum / f64::from(sets * DIRECTIONS)).max(most / f64::from(SETS * DIRECTIONS));
        }
        // Nearer than this a direction tells more than a place.
        let reach = radius * cbrt(volume / UNIT_BALL);
        let near: f64 = (0..SETS).map(|_| in_a_set(&mut stream, reach)).sum();
        let far: f64 = (0..SETS * DIRECTIONS)
            .map(|_| {
                let place = low + (high - low) * DVec3::from(stream.triple());
                let away = place - self.eye;
                let is_inside = || self.medium.is_none_or(|medium| medium.contains(place));
                let is_kept = away.length() > reach && is_inside() && self.keeps(place);
                if is_kept { kernel.at(away / radius) } else { 0.0 }
            })
            .sum();
        ((near + far * volume) / f64::from(SETS * DIRECTIONS)).max(LEAST_OF_ALL)
    }

    /// Corners of a box about the part of the medium within a radius of the eye \[L\].
    fn box_about(&self, radius: f64) -> (DVec3, DVec3) {
        let (low, high) = (self.eye - radius, self.eye + radius);
        match self.medium {
            Some(Shape::Slab(slab)) => {
                (low.with_z(low.z.max(slab.top())), high.with_z(high.z.min(slab.face(Face::Bottom))))
            }
            Some(medium) => medium.corners().map_or((low, high), |(min, max)| (low.max(min), high.min(max))),
            None => (low, high),
        }
    }

    /// The planes before which everything is kept that is within a radius, and the rectangles that hide something of it; none where
    /// more than these parts it.
    fn flat(&self, radius: f64) -> Option<(Vec<Front>, Vec<Rectangle>)> {
        if !self.later.is_empty() {
            return None;
        }
        let mut planes = match self.medium.filter(|_| self.room < radius) {
            Some(medium) => medium.faces_about(self.eye)?,
            None => Vec::new(),
        };
        let parts = |body: &&Body| body.shape.parts_ball(self.eye, radius);
        planes.extend(self.bodies.iter().filter(parts).filter_map(|body| body.front));
        let is_behind =
            |body: &Body, front: &Front| body.shape.is_behind(self.eye, front, ON_PLANE * front.distance);
        let is_in = |body: &Body| planes.iter().any(|front| is_behind(body, front));
        let others = self.bodies.iter().filter(|body| body.distance < radius && !is_in(body));
        let rectangles: Option<Vec<_>> = others.map(|body| rectangles_of(body.shape)).collect();
        let rectangles = rectangles?.concat();
        Some((planes, rectangles))
    }

    /// The part of the disc's kernel across an axis in which photons are kept, as [`Surroundings::share`] of the ball's: exact where planes and
    /// flat bodies alone or the medium's own sphere part it, and else by rays in directions at equal angles, turned at random by the place and `salt`.
    pub fn disc_share(&self, kernel: Kernel, axis: DVec3, radius: f64, salt: u64) -> DiscShare {
        if let (Some(Shape::Sphere(ball)), true) = (self.medium, self.is_clear(radius)) {
            let way = self.eye - ball.center();
            let height = way.dot(axis);
            let circle = ((ball.radius() - height) * (ball.radius() + height)).max(0.0).sqrt();
            // Rounding may put the centre just outside.
            let away = (way - axis * height).length().min(circle * INSIDE);
            return DiscShare::exact(share_in_circle(kernel, circle / radius, away / radius));
        }
        let axes = Frame::new(axis);
        if let Some((planes, rectangles)) = self.flat(radius) {
            let lines = planes.iter().filter_map(|face| FaceLine::new(face, &axes)).collect();
            let sheets = Sheets::new((&Ray::new(self.eye, axis), &axes), rectangles.into_iter(), lines);
            return DiscShare::exact(sheets.share(kernel, 0.0, radius));
        }
        let (sin, cos) = sin_cos(TAU * stream_of(self.eye, salt).unit() / f64::from(ACROSS));
        let (x, y) = (axes.x * cos + axes.y * sin, axes.y * cos - axes.x * sin);
        let one = |to: &DVec2| self.along(&|u| kernel.within_disc(u), x * to.x + y * to.y, (radius, radius));
        DiscShare { part: CIRCLE.iter().map(one).sum::<f64>() / f64::from(ACROSS), is_sampled: true }
    }

    /// The part of the line's kernel along a unit vector, both ways, in which beams are kept: exact. At least as far as `seen` \[L\] to
    /// one side, where there is a beam.
    pub fn line_share(&self, kernel: Kernel, across: DVec3, radius: f64, seen: f64) -> f64 {
        let half = |u: f64| 0.5 * kernel.within_line(u);
        let sum = self.along(&half, across, (radius, radius)) + self.along(&half, -across, (radius, radius));
        sum.max(half(seen / radius)).max(f64::MIN_POSITIVE)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimators::boundary::moments::body_part;
    use crate::geometry::{Cuboid, Rectangle, Slab, Sphere};
    use crate::stats::Moments;

    /// A block turned about z, of five rectangles or six, and one along the axes; each reaches up to about z = 0.
    fn blocks(stream: &mut Stream) -> [Vec<Shape>; 2] {
        let [a, b, c] = stream.triple().map(|u| 0.3 + u);
        let (sin, cos) = sin_cos(TAU * stream.unit());
        let (u, v, w) = (DVec3::new(cos, sin, 0.0) * a, DVec3::new(-sin, cos, 0.0) * b, DVec3::NEG_Z * c);
        let corner = -0.5 * (u + v);
        let sides = [(corner, u, v), (corner, u, w), (corner, v, w), (corner + u, v, w), (corner + v, u, w)];
        // What a file rounds.
        let rounded = |p: DVec3| (p * 1e7).round() / 1e7;
        let side = |(corner, u, v)| Shape::Rectangle(Rectangle::new(rounded(corner), u, v).unwrap());
        let (low, high) = (DVec3::new(-a, -b, -c), DVec3::new(a, b, 0.0));
        [sides.map(side).to_vec(), vec![Shape::Cuboid(Cuboid::new(low, high).unwrap())]]
    }

    /// About random points near blocks: as they are, with directions alone, and with directions that ask every body.
    fn ways<'a>(boundary: &'a Boundary<'a>, point: DVec3, radius: f64) -> [Surroundings<'a>; 3] {
        let mut ways = [0; 3].map(|_| Surroundings::new(boundary, point, point, radius));
        ways[1].screen = None;
        ways[2].screen = None;
        ways[2].bodies.iter_mut().for_each(|body| body.front = None);
        ways
    }

    /// A medium with a speck in it, however large the kernel: the part is that of the medium alone, which is known in closed form.
    #[test]
    fn small_media_have_small_parts() {
        let speck = [Shape::Sphere(Sphere::new(DVec3::new(0.1, 0.2, 0.3), 1e-6).unwrap())];
        let ball = Shape::Sphere(Sphere::new(DVec3::ZERO, 1.0).unwrap());
        let cube = Shape::Cuboid(Cuboid::new(DVec3::splat(-0.6), DVec3::new(0.6, 0.8, 1.0)).unwrap());
        let point = DVec3::new(0.3, -0.2, 0.1);
        for (medium, kernel) in
            [ball, cube].iter().flat_map(|medium| Kernel::ALL.map(|kernel| (medium, kernel)))
        {
            let boundary = Boundary::of(medium).unwrap();
            let boundary = boundary.about(&speck);
            for radius in [0.9, 3.0, 20.0, 1e3, 1e6, 1e12] {
                let surroundings = Surroundings::new(&boundary, point, point, radius);
                assert!(!surroundings.is_clear(radius));
                let mut ratios = Moments::new();
                for salt in 0..64 {
                    ratios.push(
                        surroundings.share(kernel, radius, salt) / body_part(kernel, medium, point, radius),
                    );
                }
                let off = ratios.mean() - 1.0;
                assert!(off.abs() < 4.0 * ratios.std_error() + 1e-6, "{medium:?} {kernel:?} {radius}: {off}");
                assert!(ratios.std_error() < 0.005, "{medium:?} {kernel:?} {radius}: {}", ratios.std_error());
            }
        }
    }

    /// Flat media into which few directions see far, with a speck in them or a wall across near the point: the part is that of the
    /// medium alone, or of what the wall leaves of it, known in closed form.
    #[test]
    fn flat_media_have_the_parts_that_few_directions_see() {
        let speck = Shape::Sphere(Sphere::new(DVec3::new(0.1, 0.2, 0.3), 1e-6).unwrap());
        let cuboid = |low, high| Shape::Cuboid(Cuboid::new(low, high).unwrap());
        let (low, high) = (DVec3::new(-1e3, -1e3, 0.0), DVec3::new(1e3, 1e3, 1.0));
        let medium = cuboid(low, high);
        let wall = |x: f64| {
            let corner = DVec3::new(x, low.y - 1.0, -1.0);
            Shape::Rectangle(Rectangle::new(corner, DVec3::Y * 2002.0, DVec3::Z * 3.0).unwrap())
        };
        let point = DVec3::new(0.0, 0.0, 0.4);
        let between = |from, to| cuboid(low.with_x(from), high.with_x(to));
        let slab = Shape::Slab(Slab::new(0.0, 1.0).unwrap());
        let cases = [
            (&medium, speck.clone(), medium.clone()),
            (&medium, wall(0.2), between(-1e3, 0.2)),
            (&slab, speck, slab.clone()),
        ];
        for ((medium, body, left), kernel) in
            cases.iter().flat_map(|case| Kernel::ALL.map(|kernel| (case, kernel)))
        {
            let bodies = std::slice::from_ref(body);
            let boundary = Boundary::of(medium).unwrap().about(bodies);
            for radius in [3.0, 30.0, 300.0, 3e3, 3e4] {
                let surroundings = Surroundings::new(&boundary, point, point, radius);
                let known = body_part(kernel, left, point, radius);
                let mut ratios = Moments::new();
                // What estimates divide by.
                for salt in 0..64 {
                    ratios.push(known / surroundings.share(kernel, radius, salt));
                }
                let off = ratios.mean() - 1.0;
                assert!(
                    off.abs() < 4.0 * ratios.std_error() + 0.003,
                    "{kernel:?} {radius}: {off} {bodies:?}"
                );
                assert!(ratios.std_error() < 0.01, "{kernel:?} {radius}: {}", ratios.std_error());
            }
        }
    }

    /// Where one face fills the ball, the closed form is the mean of the directions. In all places photons are seen as by
    /// rays to them.
    #[test]
    fn one_face_is_known_in_closed_form() {
        let mut stream = Stream::new(3, Purpose::Synthetic, 0, 0);
        for (block, kernel) in (0..2).flat_map(|block| Kernel::ALL.map(|kernel| (block, kernel))) {
            let mut ratios = Moments::new();
            let mut others = 0;
            while ratios.n() < 400 || others < 100 {
                let bodies = &blocks(&mut stream)[block];
                let boundary = Boundary::UNKNOWN.about(bodies);
                let point = (DVec3::from(stream.triple()) - DVec3::new(0.5, 0.5, 0.1)) * 0.4;
                let radius = 0.2 * stream.unit();
                let [known, directed, asked] = ways(&boundary, point, radius);
                if asked.is_clear(radius) {
                    continue;
                }
                let salt = stream.unit().to_bits();
                let share = directed.share(kernel, radius, salt);
                assert_eq!(share, asked.share(kernel, radius, salt), "fronts change nothing");
                match known.screen {
                    Some(_) => ratios.push(share / known.share(kernel, radius, 0)),
                    None => others += 1,
                }
                for _ in 0..20 {
                    let way = warp::square_to_sphere(stream.pair()) * (radius * stream.unit());
                    let (ray, end) = (Ray::new(point, way.normalize()), way.length());
                    let near_plane = |front: Front| front.height(way).abs() < 1e-6 * radius;
                    if asked.bodies.iter().filter_map(|body| body.shape.front(point)).any(near_plane) {
                        continue;
                    }
                    let is_hidden = bodies.iter().any(|body| body.blocks(&ray, None, end));
                    for about in [&known, &directed, &asked] {
                        assert_eq!(about.sees(point + way), !is_hidden, "{point} {way} {bodies:?}");
                    }
                }
            }
            let off = ratios.mean() - 1.0;
            assert!(ratios.std_error() < 0.0025, "{block} {kernel:?}: {}", ratios.std_error());
            assert!(off.abs() < 4.0 * ratios.std_error(), "{block} {kernel:?}: {off}");
        }
    }
}
