//! An estimator: what a photon map is asked, and how.

use super::boundary::{Boundary, Gathered, PhotonFilter, Rejection, Surroundings, Treatment, accepted};
use super::point::{ball_sum, for_each_photon, in_scattered_sum};
use super::{
    BallSum, BeamBlur, BeamEstimator, Codimension, Directional, Estimate, Gather, Kernel, NeighborCount,
    OwnEnds, PlaneEstimator, RayEnds, RayEstimate, RayEstimator,
};
use crate::Spectrum;
use crate::error::{Error, Result};
use crate::geometry::Shape;
use crate::math::{Positive, Ray, cosine_pair};
use crate::medium::Medium;
use crate::photons::beams::{BeamLength, BeamMap};
use crate::photons::tree::Radii;
use crate::photons::{Photon, PhotonMap};
use crate::scene::Scene;
use glam::DVec3;
use std::num::NonZeroUsize;

/// A map that is read along whole rays.
#[derive(Debug, Clone, Copy)]
pub enum Stretched<'a> {
    /// Photons, with a radius for each, where there is one.
    Points(&'a PhotonMap, Option<&'a Radii>),
    /// Flights.
    Beams(&'a BeamMap),
}

/// How light at a point of a medium is estimated from the photons about it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Estimator {
    /// How photons are weighted by their distance.
    pub kernel: Kernel,
    /// Which photons are used.
    pub gather: Gather,
    /// What is done where the medium ends in the ball, or bodies stand in it.
    pub treatment: Treatment,
    /// Which photons that walls part from the point are rejected.
    pub rejection: Rejection,
    /// How near to a ray photons are that whole stretches of it are read from at once ([`RayEstimator`]); none where rays are read
    /// point by point.
    pub ray_radius: Option<Positive>,
    /// Which of the other photons nearest to a photon sets its radius about rays, at most `ray_radius`; none where all have that one.
    pub ray_k: Option<NonZeroUsize>,
    /// How near to a ray photons' flights pass that whole stretches of it are read from at once ([`BeamEstimator`]), in place of
    /// photons; none where there are no beams.
    pub beam_radius: Option<Positive>,
    /// In how many dimensions beams are blurred.
    pub beam_blur: BeamBlur,
    /// How far beams go.
    pub beam_length: BeamLength,
    /// Whether fluence is read from beams too, in place of from photons in balls.
    pub has_beam_fluence: bool,
    /// Where stretches of rays that are read at once end.
    pub ray_ends: RayEnds,
    /// Whether light that media scatter twice and more is read from planes of photons' flights ([`PlaneEstimator`]), and from beams only
    /// what is scattered once.
    pub has_planes: bool,
    /// Whether fixed radii are those of the first of several maps and shrink from map to map ([`Estimator::in_map`]).
    pub is_progressive: bool,
}

/// Bodies and photons are looked for a little beyond a ball, so that rounding leaves none in it out.
const BEYOND: f64 = 1.001;

/// How far ahead of the point is looked from, in parts of the largest radius.
const AHEAD: f64 = 1e-9;

impl Estimator {
    /// Of all photons that a gather finds, wherever they are.
    pub fn new(kernel: Kernel, gather: Gather) -> Self {
        Estimator {
            kernel,
            gather,
            treatment: Treatment::None,
            rejection: Rejection::Off,
            ray_radius: None,
            ray_k: None,
            beam_radius: None,
            beam_blur: BeamBlur::default(),
            beam_length: BeamLength::default(),
            has_beam_fluence: false,
            ray_ends: RayEnds::default(),
            has_planes: false,
            is_progressive: false,
        }
    }

    /// The same with a treatment of boundaries.
    pub fn treated(self, treatment: Treatment) -> Self {
        Estimator { treatment, ..self }
    }

    /// The same with photons behind walls rejected.
    pub fn rejecting(self, rejection: Rejection) -> Self {
        Estimator { rejection, ..self }
    }

    /// The same with whole stretches of rays read at once, from photons as near as this \[L\].
    pub fn along_rays(self, radius: Positive) -> Self {
        Estimator {
            ray_radius: Some(radius),
            ray_k: None,
            beam_radius: None,
            has_beam_fluence: false,
            has_planes: false,
            ..self
        }
    }

    /// The same with a radius about rays for each photon: the distance to its k-th nearest other one, no farther than as
    /// [`Estimator::along_rays`] says.
    pub fn of_nearest(self, k: NonZeroUsize) -> Self {
        Estimator { ray_k: Some(k), ..self }
    }

    /// The same with whole stretches of rays read at once, from flights of photons that pass as near as this \[L\].
    pub fn along_beams(self, radius: Positive) -> Self {
        Estimator { beam_radius: Some(radius), ray_radius: None, ..self }
    }

    /// The same with beams blurred in so many dimensions.
    pub fn blurred(self, beam_blur: BeamBlur) -> Self {
        Estimator { beam_blur, ..self }
    }

    /// The same with beams of such a length.
    pub fn of_length(self, beam_length: BeamLength) -> Self {
        Estimator { beam_length, ..self }
    }

    /// The same with stretches of rays that end so.
    pub fn ending(self, ray_ends: RayEnds) -> Self {
        Estimator { ray_ends, ..self }
    }

    /// The same with fluence at points read from the beams that pass it too, where there are some ([`Estimator::along_beams`]): in W/L^2,
    /// with treatments of boundaries other than none divided by the part of each beam's disc that is in the medium and seen.
    pub fn with_beam_fluence(self) -> Self {
        Estimator { has_beam_fluence: self.beam_radius.is_some(), ..self }
    }

    /// The same with light that media scatter twice and more read from planes of photons' flights. Light that is scattered once takes
    /// [`Estimator::along_beams`] beside it, or is not asked for.
    pub fn in_planes(self) -> Self {
        Estimator { has_planes: true, ray_radius: None, ..self }
    }

    /// The same with fixed radii that shrink from map to map, so that the mean over maps converges to the light itself.
    pub fn progressive(self) -> Self {
        Estimator { is_progressive: true, ..self }
    }

    /// What reads the map of this number, the first being 0: where it is progressive with the radii that are due there
    /// ([`Codimension::shrinkage`]), by the codimension of balls, of rays and of beams; the k nearest photons as in the first, about
    /// a ray too.
    pub fn in_map(self, map: u64) -> Self {
        if !self.is_progressive {
            return self;
        }
        Estimator {
            gather: self.gather.in_map(map, Codimension::Three),
            ray_radius: self.ray_radius.map(|radius| Codimension::Two.radius(radius, map)),
            beam_radius: self.beam_radius.map(|radius| Codimension::One.radius(radius, map)),
            ..self
        }
    }

    /// What reads whole stretches of rays from beams; none where photons are points.
    pub fn of_beams(&self) -> Option<BeamEstimator> {
        let Estimator { kernel, treatment, .. } = *self;
        let is_clipped = treatment != Treatment::None;
        self.beam_radius.map(|radius| BeamEstimator { kernel, radius, is_clipped })
    }

    /// Whether rays are read as a whole, and not point by point.
    pub fn reads_rays(&self) -> bool {
        self.ray_radius.is_some() || self.beam_radius.is_some() || self.has_planes
    }

    /// What reads light that is scattered twice and more from planes; none where there are none.
    pub fn of_planes(&self) -> Option<PlaneEstimator> {
        self.has_planes.then_some(PlaneEstimator)
    }

    /// What reads whole stretches of rays; none where they are read point by point.
    pub fn of_rays(&self) -> Option<RayEstimator> {
        let Estimator { kernel, treatment, .. } = *self;
        self.ray_radius.map(|radius| RayEstimator {
            kernel,
            radius,
            is_clipped: treatment != Treatment::None,
        })
    }

    /// Checks that rays end in a scene as they are asked to.
    ///
    /// # Errors
    /// `Error::Scene` for ends of their own where rays are read point by point or from planes, and in scenes other than one homogeneous
    /// region with nothing in it
    pub fn check_ends(&self, scene: &Scene) -> Result<()> {
        if self.ray_ends == RayEnds::Cut {
            return Ok(());
        }
        if self.has_planes || !self.reads_rays() {
            return Err(Error::Scene(
                "ends of their own are those of photons and beams about rays; allowed: a ray radius or a beam radius, no planes".into(),
            ));
        }
        let is_alone = scene.regions().len() == 1 && scene.media().len() == 1 && !scene.plan().has_surfaces;
        let has_lamps = scene.lights().iter().any(|light| light.body().is_some());
        let is_layer = scene.regions().iter().all(|region| matches!(region.shape, Shape::Slab(_)));
        let is_open = scene.periodic_cell().is_none() || is_layer;
        match is_alone && !has_lamps && is_open && scene.medium(0).is_homogeneous() {
            true => Ok(()),
            false => Err(Error::Scene(
                "rays end for each photon or beam in one homogeneous region with nothing in it, in a periodic cell a slab; allowed \
                 otherwise: ends that are cut"
                    .into(),
            )),
        }
    }

    /// What the one medium of a scene scatters to the near end of a ray [W/(L^2 sr)], each photon or beam ending for itself.
    ///
    /// # Returns
    /// not a number where [`Estimator::check_ends`] refuses
    pub fn radiance_of_own_ends(&self, scene: &Scene, stored: Stretched<'_>, ray: &Ray) -> RayEstimate {
        let of_none = |value| RayEstimate { value: Spectrum::grey(value), found: 0, rejected: 0 };
        let (Some(region), Medium::Homogeneous(even)) = (scene.regions().first(), scene.medium(0)) else {
            return of_none(f64::NAN);
        };
        let medium = scene.medium(0);
        let ends = |radius: Positive| OwnEnds::new(even, &region.shape, ray, radius.get());
        let estimate = match (stored, self.of_rays(), self.of_beams()) {
            (Stretched::Points(map, radii), Some(of_rays), _) => ends(of_rays.radius)
                .map(|ends| of_rays.radiance_of_own_ends((map, radii), (ray, &ends), medium)),
            (Stretched::Beams(map), _, Some(of_beams)) => ends(of_beams.radius)
                .map(|ends| of_beams.radiance_of_own_ends(map, (ray, &ends), (0, medium), self.beam_blur)),
            _ => Some(of_none(f64::NAN)),
        };
        // Nothing of the medium is ahead.
        estimate.unwrap_or(of_none(0.0))
    }

    /// The smallest of the radii that it names, of a point or a ray \[L\]; those about beams are no matter of single precision.
    pub fn least_named_radius(&self) -> f64 {
        self.gather.cap().min(self.ray_radius.map_or(f64::INFINITY, Positive::get))
    }

    /// The farthest that photons or beams are looked for, of a point or a ray \[L\].
    pub fn reach(&self) -> f64 {
        let radii = [self.ray_radius, self.beam_radius].map(|radius| radius.map_or(0.0, Positive::get));
        radii.into_iter().fold(self.gather.cap(), f64::max)
    }

    /// Every kernel with every gather and every treatment, at this radius \[L\], or this k as far as that.
    pub fn specimens(radius: Positive, k: NeighborCount) -> Vec<Estimator> {
        let max_radius = radius;
        let gathers = [
            Gather::Radius(radius),
            Gather::Nearest { k, max_radius },
            Gather::NearestBiased { k, max_radius },
        ];
        let mut all = Vec::new();
        for kernel in Kernel::ALL {
            for gather in gathers {
                for treatment in Treatment::ALL {
                    all.push(Estimator::new(kernel, gather).treated(treatment));
                }
            }
        }
        all
    }

    /// Whether it follows a rule of the literature about walls, which it is then to be told of by [`Boundary::with_walls`].
    pub fn needs_walls(&self) -> bool {
        match self.rejection {
            Rejection::Off => false,
            Rejection::Visible => self.treatment == Treatment::None,
            Rejection::Facing | Rejection::FacingBehind | Rejection::BehindPlane => true,
        }
    }

    /// Its name, such as "cone, k=50, clipped"; one radius for points and rays is said once.
    pub fn name(&self) -> String {
        let Estimator {
            kernel,
            gather,
            treatment,
            rejection,
            ray_radius,
            ray_k,
            beam_radius,
            beam_blur,
            beam_length,
            has_beam_fluence,
            ray_ends,
            has_planes,
            is_progressive,
        } = self;
        let of_rays = match (ray_radius, beam_radius) {
            (Some(radius), _) if ray_k.is_some() => {
                let k = ray_k.map_or(0, NonZeroUsize::get);
                Some((radius, format!("along rays k={k} r<={}", radius.get())))
            }
            (Some(radius), _) => Some((radius, format!("along rays r={}", radius.get()))),
            (_, Some(radius)) => {
                let blur = if *beam_blur == BeamBlur::OneD { "" } else { beam_blur.name() };
                let length = if *beam_length == BeamLength::Sampled { "" } else { beam_length.name() };
                let words = ["beams", blur, length].into_iter().filter(|word| !word.is_empty());
                let words = words.collect::<Vec<_>>().join(" ");
                Some((radius, format!("{words} r={}", radius.get())))
            }
            (None, None) => None,
        };
        // One radius for points and rays.
        let alone = of_rays.as_ref().filter(|(radius, _)| *gather == Gather::Radius(**radius));
        let mut name = match alone {
            Some((_, along)) => format!("{}, {along}", kernel.name()),
            None => format!("{}, {gather}", kernel.name()),
        };
        if *treatment != Treatment::None {
            name += &format!(", {}", treatment.name());
        }
        if *rejection != Rejection::Off {
            name += &format!(", {}", rejection.name());
        }
        if let (Some((_, along)), None) = (&of_rays, alone) {
            name += &format!(", {along}");
        }
        if *ray_ends != RayEnds::default() {
            name += ", own ends";
        }
        if *has_beam_fluence {
            name += ", fluence by beams";
        }
        if *has_planes {
            name += ", planes";
        }
        if *is_progressive {
            name += ", progressive";
        }
        name
    }

    /// Bias expected in a field from independent photons away from boundaries, to second order in the radius
    /// ([`Gather::expected_bias`]).
    ///
    /// # Arguments `field` and its `laplacian` (per L^2) at the point; `photons_per_volume` [1/L^3], stored
    /// # Returns   in the unit of the field
    pub fn expected_bias(&self, field: f64, laplacian: f64, photons_per_volume: f64) -> f64 {
        self.gather.expected_bias(self.kernel, field, laplacian, photons_per_volume)
    }

    /// Variance expected from independent photons in a uniform field away from boundaries, over the square of the field
    /// ([`Gather::expected_relative_variance`]).
    ///
    /// # Arguments `power_ratio` q, at least 1; `photons_per_volume` [1/L^3], stored
    pub fn expected_relative_variance(&self, photons_per_volume: f64, power_ratio: f64) -> f64 {
        self.gather.expected_relative_variance(self.kernel, photons_per_volume, power_ratio)
    }

    /// Density of collisions at a point, by power [W/L^3]: sum p K_r / N, and what the treatment makes of it.
    ///
    /// # Arguments
    /// `point` inside the medium or on its boundary. Reflection in a slab, or a cuboid, is exact for radii up to the
    /// distance of opposite faces
    /// # Limits
    /// with a whole ball and nothing rejected all treatments are the same, bit by bit
    /// # Source
    /// Jensen and Christensen 1998; the k-1 of the k-nearest rule is Loftsgaarden and Quesenberry 1965; Jones 1993, "Simple
    /// boundary correction for kernel density estimation"
    pub fn collision_density(&self, map: &PhotonMap, point: DVec3, boundary: &Boundary<'_>) -> Estimate {
        let point = map.place(point, self.gather.cap());
        let plain = || ball_sum(map, point, self.kernel, self.gather);
        self.asked(map, (point, point), boundary, plain, &|_| 1.0)
    }

    /// Fluence at a point [W/L^2], [`Estimator::collision_density`] over sigma_t.
    ///
    /// # Arguments
    /// `sigma_t` [1/L] at the point, above zero in every channel: a channel in which it is zero gives a
    /// non-finite value, never a silent zero.
    ///
    /// # Limits
    /// Where sigma_t varies this is the blurred collision density over the local sigma_t; see [`for_each_photon`]
    /// for sums that weight each photon by its own.
    pub fn fluence(
        &self,
        map: &PhotonMap,
        point: DVec3,
        sigma_t: Spectrum,
        boundary: &Boundary<'_>,
    ) -> Estimate {
        let mut estimate = self.collision_density(map, point, boundary);
        estimate.value = estimate.value.over(sigma_t);
        estimate
    }

    /// In-scattered radiance at a point [W/(L^2 sr)], sum p phase(dir -> wo) K_r / (N sigma_t), and what the treatment makes
    /// of it: images of photons are weighted by their own directions.
    ///
    /// # Arguments
    /// `wo` unit direction of travel after the scattering; `phase` [1/sr]; the rest as in [`Estimator::fluence`]
    ///
    /// # Limits
    /// Directions are held in single precision, which blurs a phase function over about 1e-7 rad: peaks of |g|
    /// above 0.9999 feel it. The source term of the transfer equation is sigma_s times the value.
    pub fn in_scattered(
        &self,
        map: &PhotonMap,
        point: DVec3,
        wo: DVec3,
        phase: &impl Directional,
        sigma_t: Spectrum,
        boundary: &Boundary<'_>,
    ) -> Estimate {
        let point = map.place(point, self.gather.cap());
        let plain = || in_scattered_sum(map, point, wo, phase, self.kernel, self.gather);
        let value = |photon: &Photon| {
            let (one_minus_mu, one_plus_mu) = cosine_pair(photon.dir.as_dvec3(), wo);
            phase.value(one_minus_mu, one_plus_mu)
        };
        // A step of a march may begin on a body, and goes on from there.
        let eye = point - wo * (AHEAD * self.gather.cap());
        let mut estimate = self.asked(map, (point, eye), boundary, plain, &value);
        estimate.value = estimate.value.over(sigma_t);
        estimate
    }

    /// The sum of power x value over the number emitted, at a point where the tree may be asked; `plain` is the untreated one.
    /// The second point is where bodies are looked at from.
    fn asked(
        &self,
        map: &PhotonMap,
        (point, eye): (DVec3, DVec3),
        boundary: &Boundary<'_>,
        plain: impl FnOnce() -> BallSum,
        value: &dyn Fn(&Photon) -> f64,
    ) -> Estimate {
        let Estimator { kernel, gather, treatment, rejection, .. } = *self;
        let filter = PhotonFilter::new(rejection, boundary.walls, point, gather.cap());
        let alone;
        let boundary = match treatment {
            Treatment::None if filter.is_none() => return Estimate::new(map, plain(), 0),
            Treatment::None => {
                alone = boundary.alone();
                &alone
            }
            Treatment::Clipped | Treatment::Reflection | Treatment::LocalLinear => boundary,
        };
        let medium = |radius: f64| boundary.medium.filter(|medium| medium.room(point) < radius);
        let mut hidden = None;
        if filter.is_none() {
            let plain = plain();
            let r = plain.ball.radius;
            let about = Surroundings::new(boundary, point, eye, BEYOND * r);
            let count = about.count_rejected(map.tree(), point, BEYOND * r);
            if count == 0 {
                // The sum over accepted photons is the plain one.
                let sum = match medium(r) {
                    _ if !about.is_clear(r) => plain.sum / about.share(kernel, r, map.run()),
                    None => plain.sum,
                    Some(medium) => {
                        let photons = All { map, point, gather };
                        treatment.treated((medium, point, r), kernel, plain.sum, &photons, value)
                    }
                };
                return Estimate::new(map, BallSum { sum, ..plain }, 0);
            }
            hidden = Some(count);
        }
        let about = Surroundings::new(boundary, point, eye, BEYOND * gather.cap());
        let keeps = |place: usize| {
            filter.as_ref().is_none_or(|filter| filter.keeps(&map.tree().photon(place)))
                && about.keeps(map.tree().position(place))
        };
        let photons = accepted(map.tree(), point, gather, &keeps, hidden);
        let (ball, r) = (photons.ball, photons.ball.radius);
        let mut plain = Spectrum::grey(if point.is_finite() { 0.0 } else { f64::NAN });
        photons.each(kernel, &mut |photon, weight| {
            plain += Spectrum(photon.power.as_dvec3()) * (weight / (r * r * r) * value(photon));
        });
        let sum = match medium(r) {
            _ if treatment == Treatment::None => plain,
            _ if !about.is_clear(r) => plain / about.share(kernel, r, map.run()),
            None => plain,
            Some(medium) => treatment.treated((medium, point, r), kernel, plain, &photons, value),
        };
        Estimate::new(map, BallSum { sum, ball }, photons.rejected)
    }
}

/// All photons of a gather.
struct All<'a> {
    map: &'a PhotonMap,
    point: DVec3,
    gather: Gather,
}

impl Gathered for All<'_> {
    fn each(&self, kernel: Kernel, visit: &mut dyn FnMut(&Photon, f64)) {
        for_each_photon(self.map, self.point, kernel, self.gather, |photon, weight| visit(&photon, weight));
    }
}
