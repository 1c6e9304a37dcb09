//! Beside a wall, and along a marched ray.

use crate::support::scenes::homogeneous;
use glam::DVec3;
use turbid::Spectrum;
use turbid::estimators::boundary::{Boundary, Rejection, Treatment};
use turbid::estimators::{Estimator, Gather, Kernel};
use turbid::geometry::{Cuboid, Rectangle, Shape};
use turbid::integrators::{March, StepRule, along};
use turbid::math::{Interval, Positive, Ray, exp_m1};
use turbid::photons::synthetic::{Number, Profile, Synthetic};
use turbid::rng::{Purpose, Stream};

/// The k nearest photons on one side of a wall are k accepted ones, whatever stands behind it.
pub fn the_k_nearest_are_accepted() {
    let (low, high) = (DVec3::splat(-0.5), DVec3::splat(0.5));
    let map = Synthetic::new(Profile::Constant, low, high).unwrap().map(Number::Exact(4000), 29, 0).unwrap();
    let wall = Rectangle::new(DVec3::new(0.0, -2.0, -2.0), DVec3::Y * 4.0, DVec3::Z * 4.0).unwrap();
    let side = Shape::Cuboid(Cuboid::new(low, DVec3::new(0.0, 0.5, 0.5)).unwrap());
    let walls = [Shape::Rectangle(wall)];
    let boundary = Boundary::of(&side).unwrap().with_walls(&walls);
    let estimator = Estimator::new(Kernel::Uniform, Gather::nearest(20, 0.45).unwrap())
        .treated(Treatment::Clipped)
        .rejecting(Rejection::BehindPlane);
    let ball = estimator.collision_density(&map, DVec3::new(-0.02, 0.0, 0.0), &boundary);
    assert!(!ball.underfull && ball.found == 20, "{} accepted photons in the ball of the 20th", ball.found);
}

/// A constant source in an absorbing medium, (1 - e^-tau)/sigma_t, whatever the step.
pub fn a_constant_source_is_marched_to_its_integral() {
    let span = Interval { start: 0.0, end: 2.0 };
    let exact = -exp_m1(-1.5 * 2.0) / 1.5;
    let medium = homogeneous(Spectrum::grey(1.5), Spectrum::ZERO, 0.0);
    for step in [0.5, 0.25, 0.01] {
        let equal = March::equal(Positive::new("step", step).unwrap(), StepRule::Integrated);
        let ray = Ray::new(DVec3::ZERO, DVec3::X);
        let mut stream = Stream::new(1, Purpose::Synthetic, 0, 0);
        let sum = along(&medium, (&ray, span), &equal, 1.0, &mut stream, |_| Spectrum::ONE)[0];
        // Two hundred terms of one sign, a few roundings each.
        assert!((sum / exact - 1.0).abs() < 1e-12, "step {step}: {sum}, not {exact}");
    }
}
