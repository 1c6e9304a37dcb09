//! Lights: one file each; emission of photons, next-event estimation, and what a ray meets by itself.

mod area;
mod beam;
mod bundle;
mod emission;
mod isotropic;
mod medium_emission;
mod numbers;
mod point;
mod portal;
mod spot;
mod sun;
mod volume_source;

pub use area::Area;
pub use beam::{Beam, Section};
pub use bundle::{Bundle, EmissionCell};
pub use emission::{Emission, LightSample, PeriodicCell};
pub use isotropic::{Faces, Isotropic};
pub use medium_emission::MediumEmission;
pub use numbers::{Needs, PrimarySample};
pub use point::Point;
pub use spot::Spot;
pub use sun::Sun;
pub use volume_source::VolumeSource;

use crate::Spectrum;
use crate::error::{Error, Result};
use crate::geometry::{Hit, Shape, Sphere};
use crate::math::{Frame, Ray};
use crate::rng::Stream;
use bundle::by_number;
use glam::DVec3;

/// The lights at hand.
#[derive(Debug, Clone, PartialEq)]
pub enum Light {
    /// Collimated light, unbounded or of a given section.
    Beam(Beam),
    /// A black shape whose surface emits the same radiance everywhere, outwards.
    Area(Area),
    /// A point that emits the same intensity in all directions.
    Point(Point),
    /// A point that emits into a cone.
    Spot(Spot),
    /// A distant disc of uniform radiance.
    Sun(Sun),
    /// The same radiance from all directions into a closed shape, or through the faces of a slab.
    Isotropic(Isotropic),
    /// Power emitted uniformly inside a shape, alike in all directions.
    VolumeSource(VolumeSource),
    /// What an emitting medium sends out: a scene makes it of its media, nobody else.
    MediumEmission(MediumEmission),
}

impl Light {
    /// Whether its radiance is a delta function, so that no ray meets it by itself.
    pub fn is_delta(&self) -> bool {
        match self {
            Light::Beam(_) | Light::Point(_) | Light::Spot(_) => true,
            Light::Sun(l) => l.is_delta(),
            Light::Area(_) | Light::Isotropic(_) | Light::VolumeSource(_) | Light::MediumEmission(_) => false,
        }
    }

    /// Whether it fills a volume or comes from all sides, so that rays collect it on their way: no surface, point or direction.
    pub fn fills_space(&self) -> bool {
        match self {
            Light::Isotropic(_) | Light::VolumeSource(_) | Light::MediumEmission(_) => true,
            Light::Beam(_) | Light::Area(_) | Light::Point(_) | Light::Spot(_) | Light::Sun(_) => false,
        }
    }

    /// The body that rays can meet, black but for its light; none for lights without.
    pub fn body(&self) -> Option<&Shape> {
        if let Light::Area(l) = self { Some(l.shape()) } else { None }
    }

    /// The one point that all its light comes from, if there is one \[L\].
    pub fn apex(&self) -> Option<DVec3> {
        match self {
            Light::Point(l) => Some(l.position()),
            Light::Spot(l) => Some(l.position()),
            _ => None,
        }
    }

    /// Whether it lights a part of space with sides: a bounded beam.
    pub fn is_shaft(&self) -> bool {
        matches!(self, Light::Beam(l) if l.section() != Section::Unbounded)
    }

    /// Makes the photons of a sun cover what is in the scene, unless it was told what to cover.
    ///
    /// # Errors
    /// `Error::Scene` for a sun where nothing bounds the scene.
    pub(crate) fn cover(&mut self, bounds: Option<Sphere>) -> Result<()> {
        if let Light::Sun(sun) = self
            && sun.disc().is_none()
        {
            let Some(bounds) = bounds else {
                return Err(Error::Scene(
                    "a sun needs something to shine on: bodies or media, and no unbounded slab among them"
                        .into(),
                ));
            };
            *sun = sun.covering(bounds);
        }
        Ok(())
    }

    /// Whether next-event estimation can aim at it, from some points at least.
    pub fn has_direction(&self) -> bool {
        match self {
            Light::Isotropic(_) | Light::MediumEmission(_) => false,
            Light::VolumeSource(l) => l.shape().bounds().is_some(),
            Light::Beam(_) | Light::Area(_) | Light::Point(_) | Light::Spot(_) | Light::Sun(_) => true,
        }
    }

    /// The same from the point `p`: a volume source is met by chance from inside.
    pub fn has_direction_from(&self, p: DVec3) -> bool {
        match self {
            Light::VolumeSource(l) => l.has_direction_from(p),
            _ => self.has_direction(),
        }
    }

    /// Whether all channels are equal.
    pub fn is_grey(&self) -> bool {
        match self {
            Light::Beam(l) => l.irradiance().is_grey(),
            Light::Area(l) => l.radiance().is_grey(),
            Light::Point(l) => l.power().is_grey(),
            Light::Spot(l) => l.power().is_grey(),
            Light::Sun(l) => l.irradiance().is_grey(),
            Light::Isotropic(l) => l.radiance().is_grey(),
            Light::VolumeSource(l) => l.emission().is_grey(),
            Light::MediumEmission(l) => l.is_grey(),
        }
    }

    /// Whether photons start from the cell of an unbounded slab.
    pub fn needs_cell(&self) -> bool {
        match self {
            Light::Beam(l) => l.section() == Section::Unbounded,
            Light::Isotropic(l) => matches!(l.shape(), Shape::Slab(_)),
            Light::VolumeSource(l) => matches!(l.shape(), Shape::Slab(_)),
            Light::Area(_) | Light::Point(_) | Light::Spot(_) | Light::Sun(_) | Light::MediumEmission(_) => {
                false
            }
        }
    }

    /// Emitted power \[W\]; of an unbounded light the part that enters the cell, of the sun the part that can meet the
    /// scene; of a medium a quadrature.
    pub fn power(&self, periodic_cell: Option<&PeriodicCell>) -> Spectrum {
        match self {
            Light::Beam(l) => l.power(periodic_cell),
            Light::Area(l) => l.power(),
            Light::Point(l) => l.power(),
            Light::Spot(l) => l.power(),
            Light::Sun(l) => l.power(),
            Light::Isotropic(l) => l.power(periodic_cell),
            Light::VolumeSource(l) => l.power(periodic_cell),
            Light::MediumEmission(l) => l.power(),
        }
    }

    /// What photons carry together if none is refused ([`Emission::chance`]) \[W\]: the power, but for media at least that.
    pub fn power_bound(&self, periodic_cell: Option<&PeriodicCell>) -> Spectrum {
        if let Light::MediumEmission(l) = self { l.power_bound() } else { self.power(periodic_cell) }
    }

    /// How many numbers decide where a photon starts and where it goes.
    pub fn needs(&self) -> Needs {
        match self {
            Light::Beam(_) => Needs { position: 2, direction: 0 },
            Light::Point(_) | Light::Spot(_) => Needs { position: 0, direction: 2 },
            Light::Area(l) => l.needs(),
            Light::Sun(l) => l.needs(),
            Light::Isotropic(_) | Light::VolumeSource(_) | Light::MediumEmission(_) => {
                Needs { position: 3, direction: 2 }
            }
        }
    }

    /// The numbers of one photon.
    pub fn numbers(&self, stream: &mut Stream) -> PrimarySample {
        if let Light::Isotropic(l) = self {
            return l.numbers(stream);
        }
        let needs = self.needs();
        let mut numbers = PrimarySample::default();
        numbers.position[..needs.position].fill_with(|| stream.unit());
        numbers.direction[..needs.direction].fill_with(|| stream.unit());
        numbers
    }

    /// The photon of these numbers; it carries the light's whole power.
    pub fn emit_at(&self, periodic_cell: Option<&PeriodicCell>, numbers: &PrimarySample) -> Emission {
        let ray = match self {
            Light::Beam(l) => l.ray(periodic_cell, numbers),
            Light::Area(l) => l.ray(numbers),
            Light::Point(l) => l.ray(numbers),
            Light::Spot(l) => l.ray(numbers),
            Light::Sun(l) => l.ray(numbers),
            Light::Isotropic(l) => l.ray(periodic_cell, numbers),
            Light::VolumeSource(l) => l.ray(periodic_cell, numbers),
            Light::MediumEmission(l) => return l.emit_at(periodic_cell, numbers),
        };
        let primitive = if let Light::Area(l) = self { l.primitive(numbers) } else { 0 };
        Emission { ray, primitive, power: self.power(periodic_cell), chance: 1.0 }
    }

    /// The photon of these numbers where directions are chosen by cells: [`Self::emit_at`], but from a sphere the
    /// direction comes first, uniform, and then the start, uniform on the disc that the sphere shows to it. Both ways
    /// photons have the same distribution, and the light spreads its power evenly over the numbers.
    pub fn emit_aimed(&self, periodic_cell: Option<&PeriodicCell>, numbers: &PrimarySample) -> Emission {
        if let Light::Area(l) = self
            && let Some(ray) = l.aimed_ray(numbers)
        {
            return Emission { ray, primitive: 0, power: l.power(), chance: 1.0 };
        }
        self.emit_at(periodic_cell, numbers)
    }

    /// Cuts the unit cube of the light's numbers into cells, about `count` of them, small ones where the light's photons
    /// go different ways.
    pub fn cells(&self, count: usize) -> Vec<EmissionCell> {
        let needs = self.needs();
        let root = |n: usize, power: f64| (libm::pow(n as f64, power).round() as usize).max(1);
        let uniform = |n: usize| (0..=n).map(|i| i as f64 / n as f64).collect::<Vec<f64>>();
        let none = || uniform(1);
        // A local light is seen by its directions: positions get a sixteenth of the cells at most, directions the rest.
        let (mut along, mut aside) = match (needs.position, needs.direction) {
            (_, 0) => (root(count, 0.5), 1),
            (0, _) => (1, root(count, 0.5)),
            _ => (if count >= 1024 { 4 } else { 2 }, 0),
        };
        let mut first = None;
        match self {
            Light::Area(l) => {
                first = l.faces();
                if l.is_sphere() {
                    along = 1;
                }
            }
            Light::Sun(_) => (along, aside) = (root(count, 0.5), 1),
            Light::VolumeSource(_) | Light::MediumEmission(_) => along = 1,
            _ => {}
        }
        let axes = |i: usize| if i < needs.position { uniform(along) } else { none() };
        let positions = match first {
            Some(faces) => [faces, axes(1), axes(2)],
            None => [axes(0), axes(1), axes(2)],
        };
        if aside == 0 {
            let used: usize = positions.iter().map(|axis| axis.len() - 1).product();
            aside = root(count.div_ceil(used), 0.5);
        }
        let aside = if needs.direction > 0 { uniform(aside) } else { none() };
        let mut cells = Vec::new();
        // A face may be nothing beside the others, so that its ends coincide.
        let parts =
            |axis: &[f64]| axis.windows(2).filter(|w| w[0] < w[1]).map(|w| (w[0], w[1])).collect::<Vec<_>>();
        let [x, y, z] = positions.map(|axis| parts(&axis));
        let direction = parts(&aside);
        for a in &x {
            for b in &y {
                for c in &z {
                    for d in &direction {
                        for e in &direction {
                            cells.push(EmissionCell {
                                low: PrimarySample { position: [a.0, b.0, c.0], direction: [d.0, e.0] },
                                high: PrimarySample { position: [a.1, b.1, c.1], direction: [d.1, e.1] },
                            });
                        }
                    }
                }
            }
        }
        cells
    }

    /// The four quarters of a cell, cut by the numbers that say most of where its photons go: where they start of beams and
    /// suns, their direction of other lights.
    pub fn quarters(&self, cell: &EmissionCell) -> [EmissionCell; 4] {
        let is_parallel = matches!(self, Light::Beam(_) | Light::Sun(_));
        [(0, 0), (0, 1), (1, 0), (1, 1)].map(|halves| {
            let mut quarter = *cell;
            for (axis, half) in [halves.0, halves.1].into_iter().enumerate() {
                let (low, high) = match is_parallel {
                    true => (&mut quarter.low.position[axis], &mut quarter.high.position[axis]),
                    false => (&mut quarter.low.direction[axis], &mut quarter.high.direction[axis]),
                };
                let middle = 0.5 * (*low + *high);
                *(if half == 0 { high } else { low }) = middle;
            }
            quarter
        })
    }

    /// A bundle that holds the rays of a cell, by [`Self::emit_aimed`]; none where they may go anywhere.
    pub fn bundle(&self, cell: &EmissionCell) -> Option<Bundle> {
        match self {
            Light::Beam(l) => l.bundle(cell),
            Light::Area(l) => l.bundle(cell),
            Light::Point(l) => {
                let (axis, angle) = bundle::cone(cell, &Frame::new(DVec3::Z), by_number::sphere);
                Some(Bundle { center: l.position(), radius: 0.0, axis, angle })
            }
            Light::Spot(l) => Some(l.bundle(cell)),
            Light::Sun(l) => l.bundle(cell),
            Light::VolumeSource(_) | Light::MediumEmission(_) => {
                let ball = match self {
                    Light::MediumEmission(l) => l.ball(),
                    Light::VolumeSource(l) => l.shape().bounds(),
                    _ => None,
                };
                let (center, radius) = ball?;
                let (axis, angle) = bundle::cone(cell, &Frame::new(DVec3::Z), by_number::sphere);
                Some(Bundle { center, radius, axis, angle })
            }
            Light::Isotropic(_) => None,
        }
    }

    /// One photon that carries the light's whole power.
    pub fn emit(&self, periodic_cell: Option<&PeriodicCell>, stream: &mut Stream) -> Emission {
        self.emit_at(periodic_cell, &self.numbers(stream))
    }

    /// A direction from `p` towards the light; none if the light cannot be aimed at or sends nothing to `p`, and for what fills
    /// volumes ([`VolumeSource::sample`], [`MediumEmission::sample`]).
    pub fn sample(&self, p: DVec3, u: [f64; 2]) -> Option<LightSample> {
        match self {
            Light::Beam(l) => l.sample(p),
            Light::Area(l) => l.sample(p, u),
            Light::Point(l) => l.sample(p),
            Light::Spot(l) => l.sample(p),
            Light::Sun(l) => l.sample(p, u),
            Light::Isotropic(_) | Light::VolumeSource(_) | Light::MediumEmission(_) => None,
        }
    }

    /// Where a ray meets the light's own body; `from` is the part of it that the ray starts on, if it does.
    pub fn hit(&self, ray: &Ray, from: Option<u32>) -> Option<Hit> {
        if let Light::Area(l) = self { l.hit(ray, from) } else { None }
    }

    /// Whether another part of the light's own body stands before the point at distance `end` \[L\] of it.
    pub(crate) fn hides_itself(&self, ray: &Ray, end: f64) -> bool {
        if let Light::Area(l) = self { l.hides_itself(ray, end) } else { false }
    }

    /// Radiance sent back along a ray that meets the light's body [W/(L^2 sr)], and the density with which
    /// [`Self::sample`] aims from the ray's origin at that point [1/sr].
    pub fn emitted(&self, ray: &Ray, hit: &Hit) -> (Spectrum, f64) {
        if let Light::Area(l) = self { l.emitted(ray, hit) } else { (Spectrum::ZERO, 0.0) }
    }

    /// Radiance seen by a ray that leaves the scene [W/(L^2 sr)], and the density with which [`Self::sample`] aims from
    /// its origin along it [1/sr]; none where the light has no part in it.
    pub fn background(&self, ray: &Ray) -> Option<(Spectrum, f64)> {
        if let Light::Sun(l) = self { l.background(ray) } else { None }
    }
}
