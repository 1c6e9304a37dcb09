//! Estimates near boundaries on maps of independent photons: each treatment and each rejection against sums over all
//! photons, written down as they are defined, and against the exact expectation; the moments against rules of
//! another kind. Each law has a negative control.

use crate::support::quadrature::integrate;
use crate::support::verdict;
use glam::DVec3;
use std::f64::consts::PI;
use turbid::estimators::boundary::{Boundary, Rejection, Treatment, body_moments};
use turbid::estimators::{Estimate, Estimator, Gather, Kernel};
use turbid::geometry::{Cuboid, Rectangle, Shape, Slab, Sphere};
use turbid::photons::synthetic::{Number, Profile, Synthetic};
use turbid::photons::{Flags, Photon, PhotonMap};
use turbid::rng::{Purpose, Stream};
use turbid::stats::Moments;
use turbid_analytic::boundary as referee;

const SEED: u64 = 51;

fn slab(top: f64, thickness: f64) -> Shape {
    Shape::Slab(Slab::new(top, thickness).unwrap())
}

fn sphere(radius: f64) -> Shape {
    Shape::Sphere(Sphere::new(DVec3::ZERO, radius).unwrap())
}

fn cuboid(size: DVec3) -> Shape {
    Shape::Cuboid(Cuboid::new(DVec3::ZERO, size).unwrap())
}

/// A wall across z = `height`, its front up.
fn sheet(height: f64) -> Shape {
    let corner = DVec3::new(-9.0, -9.0, height);
    Shape::Rectangle(Rectangle::new(corner, DVec3::X * 18.0, DVec3::Y * 18.0).unwrap())
}

fn synthetic(profile: Profile, lower: DVec3, upper: DVec3) -> Synthetic {
    Synthetic::new(profile, lower, upper).unwrap()
}

/// The photons of a synthetic box that lie in a shape, as one pass would have stored them.
fn cut(box_map: &PhotonMap, shape: &Shape) -> PhotonMap {
    let photons: Vec<Photon> = box_map.tree().photons().filter(|p| shape.contains(p.position)).collect();
    PhotonMap::new(photons, box_map.emitted()).unwrap()
}

/// K_r at a vector, as it is defined.
fn kernel_at(kernel: Kernel, away: DVec3, radius: f64) -> f64 {
    let u2 = away.length_squared() / (radius * radius);
    if u2 <= 1.0 { kernel.peak() * kernel.profile(u2) / (radius * radius * radius) } else { 0.0 }
}

/// The distance to the boundary and the inward normal there.
fn nearest_boundary(shape: &Shape, p: DVec3) -> (f64, DVec3) {
    let faces: Vec<(f64, DVec3)> = match shape {
        Shape::Sphere(s) => vec![(s.radius() - p.length(), -p.normalize())],
        Shape::Slab(s) => {
            vec![(p.z - s.top(), DVec3::Z), (s.top() + s.thickness() - p.z, DVec3::NEG_Z)]
        }
        Shape::Cuboid(c) => (0..3)
            .flat_map(|i| [(p[i] - c.min()[i], DVec3::AXES[i]), (c.max()[i] - p[i], -DVec3::AXES[i])])
            .collect(),
        Shape::Rectangle(_) | Shape::Mesh(_) | Shape::Revolution(_) => Vec::new(),
    };
    faces.into_iter().reduce(|a, b| if b.0 < a.0 { b } else { a }).unwrap()
}

/// The moments of a kernel in a body by a product rule in spherical coordinates about the point: `n` midpoints along
/// each; inside or not, so that it errs like the shells that a boundary cuts.
fn moments_by_midpoints(kernel: Kernel, body: &Shape, p: DVec3, radius: f64, n: u32) -> [f64; 3] {
    let (_, normal) = nearest_boundary(body, p);
    let middle = |i: u32| (f64::from(i) + 0.5) / f64::from(n);
    let mut sums = [0.0; 3];
    for i in 0..n {
        let u = middle(i);
        let shell = 4.0 * PI * u * u * kernel.peak() * kernel.profile(u * u) / f64::from(n).powi(3);
        for j in 0..n {
            for k in 0..n {
                let dir = crate::support::unit_vector(2.0 * middle(j) - 1.0, 2.0 * PI * middle(k));
                if body.contains(p + dir * (u * radius)) {
                    let z = u * dir.dot(normal);
                    sums[0] += shell;
                    sums[1] += shell * z;
                    sums[2] += shell * z * z;
                }
            }
        }
    }
    sums
}

fn places() -> Vec<(Shape, DVec3, f64)> {
    let thin = cuboid(DVec3::new(1.0, 0.8, 1.2));
    vec![
        (slab(0.0, 1.0), DVec3::new(0.3, 0.2, 0.1), 0.4),
        (slab(0.0, 1.0), DVec3::new(0.0, 0.0, 1.0), 0.4),
        (slab(-1.0, 0.5), DVec3::new(0.0, 0.0, -0.7), 0.45),
        (sphere(1.0), DVec3::new(0.3, 0.8, -0.2), 0.5),
        (sphere(1.0), DVec3::new(0.0, 0.6, -0.8), 0.3),
        (sphere(0.4), DVec3::new(0.1, 0.0, 0.0), 0.45),
        (thin.clone(), DVec3::new(0.1, 0.4, 0.6), 0.35),
        (thin.clone(), DVec3::new(0.1, 0.65, 0.6), 0.35),
        (thin.clone(), DVec3::new(0.9, 0.15, 1.1), 0.35),
        (thin.clone(), DVec3::new(1.0, 0.8, 1.2), 0.35),
        (thin, DVec3::new(0.0, 0.0, 0.5), 0.35),
    ]
}

#[test]
fn moments_by_another_rule() {
    for (body, p, r) in places() {
        for kernel in Kernel::ALL {
            let (found, again) =
                (body_moments(kernel, &body, p, r), moments_by_midpoints(kernel, &body, p, r, 96));
            for j in 0..3 {
                // 96^3 midpoints, those beside the boundary counted whole or not: its 6 x 96^2 cells err at random by
                // about half of 1/96^3 each, 1.3e-4 in all, or 4e-4 where a plane runs along the cells.
                let off = found[j] - again[j];
                assert!(off.abs() < 2e-3, "{body:?} at {p}, {kernel:?} M_{j}: {} {}", found[j], again[j]);
            }
        }
    }
}

/// Flat faces: M_0 = 1/2 + 3x/4 - x^3/4 and M_1 = 3/16 (1-x^2)^2 of the uniform kernel; c (1-x^2)^(n+2)/(2(n+2)) of the
/// others. Two faces: integrals of the kernels' marginals. Sphere: the lens. Corners: an eighth.
#[test]
fn moments_in_closed_form() {
    let close = |found: f64, exact: f64, what: &str| {
        assert!((found - exact).abs() < 1e-13, "{what}: {found}, not {exact}");
    };
    let half = slab(0.0, 100.0);
    for h in [0.0, 0.2, 0.55, 0.9] {
        let at = |kernel| body_moments(kernel, &half, DVec3::new(3.0, -2.0, 0.7 * h), 0.7);
        let v = 1.0 - h * h;
        close(at(Kernel::Uniform)[0], 0.5 + 0.75 * h - 0.25 * h * h * h, "uniform M_0");
        close(at(Kernel::Uniform)[1], 3.0 / 16.0 * v * v, "uniform M_1");
        close(at(Kernel::Epanechnikov)[1], 15.0 / 16.0 * v * v * v / 6.0, "epanechnikov M_1");
        close(at(Kernel::Biweight)[1], 35.0 / 32.0 * v * v * v * v / 8.0, "biweight M_1");
    }
    let marginal = |kernel: Kernel, z: f64| match kernel {
        Kernel::Uniform => 0.75 * (1.0 - z * z),
        Kernel::Epanechnikov => 15.0 / 16.0 * (1.0 - z * z).powi(2),
        Kernel::Biweight => 35.0 / 32.0 * (1.0 - z * z).powi(3),
        Kernel::Cone => 1.0 - 3.0 * z * z + 2.0 * z.abs().powi(3),
        Kernel::Gaussian => {
            let e = turbid::math::exp;
            kernel.peak() * PI / 4.5 * (e(-4.5 * z * z) - e(-4.5))
        }
    };
    let thin = slab(0.0, 1.0);
    for kernel in Kernel::ALL {
        for (z, r) in [(0.3_f64, 0.9), (0.9, 0.4), (0.5, 3.0)] {
            let (below, above): (f64, f64) = ((z / r).min(1.0), ((1.0 - z) / r).min(1.0));
            let (near, far) = (below.min(above), below.max(above));
            let found = body_moments(kernel, &thin, DVec3::new(0.0, 0.0, z), r);
            for (j, found) in found.into_iter().enumerate() {
                let one = |u: f64| u.powi(j as i32) * marginal(kernel, u);
                let exact = integrate(-near, 0.0, 4, one) + integrate(0.0, far, 4, one);
                close(found, exact, &format!("{kernel:?} M_{j} between two faces"));
            }
        }
        // A corner, an edge and a face of a box, by symmetry.
        let body = cuboid(DVec3::splat(2.0));
        for (p, share) in
            [(DVec3::ZERO, 0.125), (DVec3::new(0.0, 2.0, 1.0), 0.25), (DVec3::new(1.0, 2.0, 1.0), 0.5)]
        {
            let [m0, _, m2] = body_moments(kernel, &body, p, 0.9);
            close(m0, share, "share of a corner");
            close(m2, share * kernel.m2() / 3.0, "M_2 at a corner");
        }
    }
    let (a, r): (f64, f64) = (1.0, 0.6);
    for d in [0.45, 0.8, 1.0] {
        let lens = PI * (a + r - d) * (a + r - d) * (d * d + 2.0 * d * (a + r) - 3.0 * (a - r) * (a - r))
            / (12.0 * d);
        let found = body_moments(Kernel::Uniform, &sphere(a), DVec3::new(0.0, d, 0.0), r)[0];
        close(found, lens / (4.0 / 3.0 * PI * r * r * r), "lens");
    }
    // A sphere inside the ball: its whole volume.
    let found = body_moments(Kernel::Uniform, &sphere(0.3), DVec3::new(0.0, 0.1, 0.0), 0.5)[0];
    close(found, 0.216, "a sphere in the ball");
}

/// Edges and corners: the rule's own error, found by cutting the cuboid into two and four. The parts of a ball in the
/// pieces add up to the part in the whole, M_0, whatever faces cut them.
#[test]
fn moments_of_pieces_add_up() {
    let size = DVec3::new(1.0, 0.8, 1.2);
    let mut stream = Stream::new(SEED, Purpose::Synthetic, 1, 0);
    for _ in 0..200 {
        // On the common edge of four pieces, at any height.
        let p = DVec3::new(stream.unit(), stream.unit(), stream.unit()) * size;
        let pieces = [0, 1, 2, 3].map(|i| {
            let (low, high) = (i & 1 == 0, i & 2 == 0);
            let x = if low { (0.0, p.x) } else { (p.x, size.x) };
            let y = if high { (0.0, p.y) } else { (p.y, size.y) };
            Shape::Cuboid(Cuboid::new(DVec3::new(x.0, y.0, 0.0), DVec3::new(x.1, y.1, size.z)).unwrap())
        });
        for kernel in Kernel::ALL {
            let whole = body_moments(kernel, &cuboid(size), p, 0.5)[0];
            let sum: f64 = pieces.iter().map(|piece| body_moments(kernel, piece, p, 0.5)[0]).sum();
            assert!((whole - sum).abs() < 1e-8, "{kernel:?} at {p}: {whole} {sum}");
        }
    }
}

/// Media thinner than the moments have digits: an empty map estimates 0 in them, one photon something finite.
#[test]
fn media_without_an_inside_have_finite_estimates() {
    let photon = Photon {
        position: DVec3::ZERO,
        dir: glam::Vec3::X,
        normal: glam::Vec3::ZERO,
        power: glam::Vec3::ONE,
        order: 1,
        flags: Flags::NONE,
    };
    let maps = [Vec::new(), vec![photon]].map(|photons| PhotonMap::new(photons, 10).unwrap());
    for thickness in [1e-12, 1e-16, 1e-20, 1e-100, 1e-150, 1e-300, 5e-324] {
        let bodies = [slab(0.0, thickness), sphere(thickness), cuboid(DVec3::new(1.0, thickness, 1.0))];
        for (body, treatment, kernel) in bodies
            .iter()
            .flat_map(|body| Treatment::ALL.map(|treatment| (body, treatment)))
            .flat_map(|(body, treatment)| Kernel::ALL.map(|kernel| (body, treatment, kernel)))
        {
            let estimator = Estimator::new(kernel, Gather::radius(0.4).unwrap()).treated(treatment);
            for boundary in [Boundary::of(body).unwrap(), Boundary::of(body).unwrap().among(&[])] {
                let found =
                    [0, 1].map(|i| estimator.collision_density(&maps[i], DVec3::ZERO, &boundary).value[0]);
                let what = format!("{body:?}, {treatment:?}, {kernel:?}: {found:?}");
                assert!(found[0] == 0.0 && found[1].is_finite(), "{what}");
            }
        }
    }
}

/// The estimate by its definition: every photon, every image, moments by [`body_moments`].
fn by_definition(
    photons: &[Photon],
    accepted: impl Fn(&Photon) -> bool,
    (treatment, kernel, gather): (Treatment, Kernel, Gather),
    body: &Shape,
    p: DVec3,
) -> (f64, f64, usize) {
    let mut near: Vec<(f64, &Photon)> =
        photons.iter().filter(|q| accepted(q)).map(|q| (q.position.distance(p), q)).collect();
    near.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (radius, counted) = match gather {
        Gather::Radius(r) => (r.get(), near.partition_point(|q| q.0 <= r.get())),
        Gather::Nearest { k, max_radius } => match near.get(k.get() - 1) {
            Some(kth) if kth.0 <= max_radius.get() => (kth.0, k.get() - 1),
            _ => (max_radius.get(), near.partition_point(|q| q.0 <= max_radius.get())),
        },
        Gather::NearestBiased { .. } => unreachable!(),
    };
    let (room, normal) = nearest_boundary(body, p);
    let moments = body_moments(kernel, body, p, radius);
    let (mut s0, mut s1, mut mirrored) = (0.0, 0.0, 0.0);
    for (_, q) in &near[..counted] {
        let away = q.position - p;
        let value = kernel_at(kernel, away, radius * (1.0 + 1e-9));
        s0 += value;
        s1 += value * away.dot(normal) / radius;
        // The photon's images: in every face, and in every pair and triple of faces of different axes.
        let mut planes: Vec<Vec<Option<f64>>> = vec![vec![None]; 3];
        match body {
            Shape::Slab(s) => planes[2].extend([Some(s.top()), Some(s.top() + s.thickness())]),
            Shape::Cuboid(c) => {
                (0..3).for_each(|i| planes[i].extend([Some(c.min()[i]), Some(c.max()[i])]));
            }
            _ => {
                let touch = p - normal * room;
                let image = q.position - normal * (2.0 * (q.position - touch).dot(normal));
                mirrored += kernel_at(kernel, image - p, radius);
            }
        }
        for x in &planes[0] {
            for y in &planes[1] {
                for z in &planes[2] {
                    let mut image = q.position;
                    for (i, plane) in [x, y, z].into_iter().enumerate() {
                        image[i] = plane.map_or(image[i], |plane| 2.0 * plane - image[i]);
                    }
                    if image != q.position {
                        mirrored += kernel_at(kernel, image - p, radius);
                    }
                }
            }
        }
    }
    let [m0, m1, m2] = moments;
    let value = match treatment {
        Treatment::None => s0,
        Treatment::Clipped => s0 / m0,
        Treatment::Reflection => s0 + mirrored,
        Treatment::LocalLinear => (m2 * s0 - m1 * s1) / (m0 * m2 - m1 * m1),
    };
    (value, radius, counted)
}

/// A kernel, a treatment and a body as the referee knows them; bodies have their lower corner, or centre, at the origin.
pub(super) fn known(kernel: Kernel) -> turbid_analytic::Kernel {
    match kernel {
        Kernel::Uniform => turbid_analytic::Kernel::Uniform,
        Kernel::Epanechnikov => turbid_analytic::Kernel::Epanechnikov,
        Kernel::Cone => turbid_analytic::Kernel::Cone { kappa: 1.0 },
        Kernel::Biweight => turbid_analytic::Kernel::Biweight,
        Kernel::Gaussian => turbid_analytic::Kernel::TruncatedGaussian,
    }
}

fn known_treatment(treatment: Treatment) -> referee::Treatment {
    match treatment {
        Treatment::None => referee::Treatment::None,
        Treatment::Clipped => referee::Treatment::Clipped,
        Treatment::Reflection => referee::Treatment::Reflection,
        Treatment::LocalLinear => referee::Treatment::LocalLinear,
    }
}

fn known_body(body: &Shape) -> referee::Body {
    match body {
        Shape::Sphere(s) => referee::Body::Sphere { radius: s.radius() },
        Shape::Slab(s) => referee::Body::Slab { thickness: s.thickness() },
        Shape::Cuboid(c) => referee::Body::Cuboid { edges: c.max().to_array() },
        Shape::Rectangle(_) | Shape::Mesh(_) | Shape::Revolution(_) => referee::Body::HalfSpace,
    }
}

/// All moments, edges and corners included, to the stated accuracy. Where several faces are equally near any normal
/// will do, and M_1 and M_2 may differ: those places are left out.
#[test]
fn moments_by_the_referee() {
    for (body, p, r) in places() {
        let is_tied = matches!(body, Shape::Cuboid(_))
            && p.to_array().iter().filter(|x| **x == 0.0 || **x == 0.8).count() > 1;
        if is_tied || matches!(body, Shape::Slab(s) if s.top() != 0.0) {
            continue;
        }
        for kernel in Kernel::ALL {
            let found = body_moments(kernel, &body, p, r);
            for (j, found) in (0..3).zip(found) {
                let exact =
                    referee::body_moment(known(kernel), known_body(&body), p.to_array(), r, j).unwrap();
                let bound = if matches!(body, Shape::Cuboid(_)) { 1e-8 } else { 1e-13 };
                let off = (found - exact.value).abs();
                assert!(
                    off <= bound + exact.error,
                    "{body:?} at {p}, {kernel:?} M_{j}: differs by {off:.1e}"
                );
            }
        }
    }
}

/// A linear field in each body, fixed radius: the mean over maps against the exact expectation. The negative controls:
/// reflection without its images, clipping with the moments of a whole ball, a linear fit without its slope.
#[test]
fn treatments_by_the_referee() {
    let (size, photons, maps) = (DVec3::new(1.0, 0.8, 1.2), 6000, 256);
    let field = synthetic(Profile::Linear { slope: 0.8 }, DVec3::splat(-1.0), DVec3::splat(1.2));
    let all: Vec<PhotonMap> =
        (0..maps).map(|m| field.map(Number::Expected(photons), SEED, 500 + m).unwrap()).collect();
    for (body, p, r) in [
        (slab(0.0, 0.9), DVec3::new(0.1, 0.1, 0.08), 0.35),
        (sphere(0.9), DVec3::new(0.8, 0.2, 0.1), 0.35),
        (cuboid(size), DVec3::new(0.06, 0.7, 1.1), 0.35),
    ] {
        let cut_maps: Vec<PhotonMap> = all.iter().map(|map| cut(map, &body)).collect();
        for treatment in Treatment::ALL {
            let kernel = Kernel::Epanechnikov;
            let boundary = Boundary::of(&body).unwrap();
            let estimator = Estimator::new(kernel, Gather::radius(r).unwrap()).treated(treatment);
            let one = |map: &PhotonMap| estimator.collision_density(map, p, &boundary).value[0];
            let values: Moments = cut_maps.iter().map(one).collect();
            let density = |q: [f64; 3]| field.density(DVec3::from_array(q));
            let mean = |treatment: Treatment| {
                let (kernel, treatment) = (known(kernel), known_treatment(treatment));
                referee::treated_mean(treatment, kernel, known_body(&body), p.to_array(), r, density).unwrap()
            };
            let exact = mean(treatment);
            // Relative variance of a whole ball is (10/7)/100 here, of a linear fit some ten times that at a corner:
            // errors of 2.5 % of the density 0.1, seen from 7.7 of them on.
            let what = format!("{} in {body:?}", treatment.name());
            verdict::agrees(&what, &values, (exact.value, exact.error), 0.025, SEED);
            if treatment != Treatment::None {
                verdict::rejects(
                    &format!("{what}, done without"),
                    &values,
                    mean(Treatment::None).value,
                    SEED,
                );
            }
        }
    }
}

/// A uniform density of collisions in a medium that is cut in two, and in one with another medium inside: photons
/// beyond the boundary are not of the medium, and the part of the ball that they lie in does not count. That part
/// is found by directions: the mean of its inverse is right within a hundredth.
#[test]
fn media_that_touch_are_told_apart() {
    let (low, high) = (DVec3::splat(-1.0), DVec3::splat(1.0));
    let field = synthetic(Profile::Constant, low, high);
    let half = Shape::Cuboid(Cuboid::new(low, DVec3::new(0.0, 1.0, 1.0)).unwrap());
    let whole = Shape::Cuboid(Cuboid::new(low, high).unwrap());
    let inner = [sphere(0.4)];
    let estimator = Estimator::new(Kernel::Uniform, Gather::radius(0.3).unwrap()).treated(Treatment::Clipped);
    for (what, boundary, point, off) in [
        ("half", Boundary::of(&half).unwrap().among(&[]), -0.05 * DVec3::X, 0.0),
        ("outer", Boundary::of(&whole).unwrap().among(&inner), -0.45 * DVec3::X, 0.01),
    ] {
        let values: Moments = (0..64)
            .map(|m| {
                let map = field.map(Number::Expected(12_000), SEED, 900 + m).unwrap();
                estimator.collision_density(&map, point, &boundary).value[0]
            })
            .collect();
        let exact = field.density(point);
        // 100 photons in the half's part of the ball, 10 per cent each and 1.3 over 64 maps, seen from 7.7 of them on: a
        // tenth. A bound counts as a fifth of itself.
        verdict::agrees(what, &values, (exact, 0.2 * off * exact), 0.12 * exact, SEED);
    }
}

#[test]
fn treatments_by_their_definition() {
    let around = synthetic(Profile::Linear { slope: 0.7 }, DVec3::splat(-1.3), DVec3::splat(1.3));
    let map = around.map(Number::Exact(60_000), SEED, 2).unwrap();
    for (body, p, r) in places() {
        let map = cut(&map, &body);
        let photons: Vec<Photon> = map.tree().photons().collect();
        for kernel in Kernel::ALL {
            for gather in [Gather::radius(r).unwrap(), Gather::nearest(90, 0.5).unwrap()] {
                for treatment in Treatment::ALL {
                    let boundary = Boundary::of(&body).unwrap();
                    let estimator = Estimator::new(kernel, gather).treated(treatment);
                    let found = estimator.collision_density(&map, p, &boundary);
                    let (sum, radius, _) =
                        by_definition(&photons, |_| true, (treatment, kernel, gather), &body, p);
                    let exact = sum / map.emitted() as f64;
                    // Squared distances are rounded to 2^-22 of their size and coordinates to 2^-24 of the box: 1e-6
                    // of the radius, which every kernel takes with a factor below 6; local linear multiplies by 10.
                    let off = found.value[0] / exact - 1.0;
                    assert!(
                        off.abs() < 6e-5,
                        "{treatment:?} {kernel:?} {gather:?} at {p} in {body:?}: {off:.1e}"
                    );
                    assert!((found.radius / radius - 1.0).abs() < 4e-6 && found.rejected == 0);
                }
            }
        }
    }
}

#[test]
fn whole_balls_are_the_plain_estimate_bit_by_bit() {
    let all = synthetic(Profile::Exponential { rate: 2.0 }, DVec3::ZERO, DVec3::splat(2.0));
    let map = all.map(Number::Exact(20_000), SEED, 3).unwrap();
    let middle = DVec3::new(0.9, 1.0, 1.05);
    let far = [sheet(-0.5), sheet(2.5)];
    let medium = cuboid(DVec3::splat(2.0));
    let boundary = Boundary::of(&medium).unwrap().with_walls(&far);
    for kernel in Kernel::ALL {
        for gather in [Gather::radius(0.4).unwrap(), Gather::nearest(50, 0.9).unwrap()] {
            let plain = Estimator::new(kernel, gather);
            let untreated = plain.collision_density(&map, middle, &Boundary::UNKNOWN);
            for treatment in Treatment::ALL {
                for rejection in Rejection::ALL {
                    let estimator = plain.treated(treatment).rejecting(rejection);
                    assert_eq!(estimator.collision_density(&map, middle, &boundary), untreated);
                }
            }
        }
    }
    // A wall in the ball with all photons on this side of it: the same photons, one by one.
    let walls = [sheet(0.0)];
    let medium = slab(-9.0, 18.0);
    let boundary = Boundary::of(&medium).unwrap().with_walls(&walls);
    let point = DVec3::new(0.9, 1.0, 0.1);
    for gather in [Gather::radius(1.04).unwrap(), Gather::nearest(700, 1.04).unwrap()] {
        let estimator = Estimator::new(Kernel::Cone, gather);
        let plain = estimator.collision_density(&map, point, &Boundary::UNKNOWN);
        for rejection in [Rejection::BehindPlane, Rejection::FacingBehind, Rejection::Visible] {
            let estimator = estimator.treated(Treatment::Clipped).rejecting(rejection);
            let Estimate { value, found, .. } = estimator.collision_density(&map, point, &boundary);
            assert!((value[0] / plain.value[0] - 1.0).abs() < 1e-5 && found == plain.found);
        }
    }
}

/// Each rejection against its words, with a rectangle, a sphere and a box as walls; radii are set by accepted photons.
#[test]
fn rejections_by_their_definition() {
    let all = synthetic(Profile::Linear { slope: -0.5 }, DVec3::splat(-1.0), DVec3::splat(1.0));
    let map = all.map(Number::Exact(30_000), SEED, 4).unwrap();
    let photons: Vec<Photon> = map.tree().photons().collect();
    let ball = Shape::Sphere(Sphere::new(DVec3::new(0.1, 0.0, -0.5), 0.4).unwrap());
    let block = Shape::Cuboid(Cuboid::new(DVec3::splat(-0.3), DVec3::new(0.3, 0.4, 0.0)).unwrap());
    // The wall, the point, the foot and the normal there; and whether a segment from the point meets the wall.
    type Blocks = fn(DVec3, DVec3) -> bool;
    let crosses: Blocks = |a, b| (a.z - 0.1) * (b.z - 0.1) < 0.0;
    let meets_ball: Blocks = |a, b| {
        let (d, f) = (b - a, a - DVec3::new(0.1, 0.0, -0.5));
        let t = (-f.dot(d) / d.length_squared()).clamp(0.0, 1.0);
        (f + d * t).length() < 0.4
    };
    let meets_block: Blocks = |a, b| {
        (0..=4000).any(|i| {
            let q = a + (b - a) * (f64::from(i) / 4000.0);
            q.cmpgt(DVec3::splat(-0.3)).all() && q.cmplt(DVec3::new(0.3, 0.4, 0.0)).all()
        })
    };
    let cases: [(Shape, DVec3, DVec3, DVec3, Blocks); 4] = [
        (sheet(0.1), DVec3::new(0.0, 0.1, 0.2), DVec3::new(0.0, 0.1, 0.1), DVec3::Z, crosses),
        (sheet(0.1), DVec3::new(0.0, 0.1, 0.0), DVec3::new(0.0, 0.1, 0.1), DVec3::NEG_Z, crosses),
        (ball, DVec3::new(0.1, 0.0, 0.0), DVec3::new(0.1, 0.0, -0.1), DVec3::Z, meets_ball),
        (block, DVec3::new(0.1, 0.1, 0.15), DVec3::new(0.1, 0.1, 0.0), DVec3::Z, meets_block),
    ];
    for (wall, p, foot, n, blocks) in cases {
        let walls = [wall];
        for rejection in Rejection::ALL {
            let accepts = |q: &Photon| {
                let (front, faces) = ((q.position - foot).dot(n) >= 0.0, q.dir.as_dvec3().dot(n) < 0.0);
                match rejection {
                    Rejection::Off => true,
                    Rejection::Facing => faces,
                    Rejection::FacingBehind => front || faces,
                    Rejection::BehindPlane => front,
                    Rejection::Visible => !blocks(p, q.position),
                }
            };
            for gather in [
                Gather::radius(0.3).unwrap(),
                Gather::nearest(40, 0.9).unwrap(),
                Gather::nearest(3000, 0.35).unwrap(),
            ] {
                let body = slab(-9.0, 18.0);
                let boundary = Boundary::of(&body).unwrap().with_walls(&walls);
                let estimator = Estimator::new(Kernel::Epanechnikov, gather).rejecting(rejection);
                let found = estimator.collision_density(&map, p, &boundary);
                let near: Vec<Photon> =
                    photons.iter().filter(|q| q.position.distance(p) < 0.9).copied().collect();
                let how = (Treatment::None, Kernel::Epanechnikov, gather);
                let (sum, radius, _) = by_definition(&near, accepts, how, &body, p);
                let off = found.value[0] / (sum / map.emitted() as f64) - 1.0;
                assert!(off.abs() < 2e-5, "{rejection:?} {gather:?} at {p}: {off:.1e}");
                assert!((found.radius / radius - 1.0).abs() < 4e-6);
                let reach = radius * (1.0 - 4e-6);
                let rejected = near.iter().filter(|q| q.position.distance(p) < reach && !accepts(q)).count();
                assert!(
                    found.rejected.abs_diff(rejected) <= 1,
                    "{rejection:?}: {} {rejected}",
                    found.rejected
                );
            }
        }
    }
}

/// Photons that coincide with the point or tie with the k-th, with a wall that rejects some of them.
#[test]
fn ties_and_coincidence() {
    let at = |x: f64, z: f64| Photon {
        position: DVec3::new(x, 0.0, z),
        dir: glam::Vec3::Z,
        normal: glam::Vec3::ZERO,
        power: glam::Vec3::ONE,
        order: 0,
        flags: turbid::photons::Flags::NONE,
    };
    let walls = [sheet(0.0)];
    let medium = slab(0.0, 9.0);
    let boundary = Boundary::of(&medium).unwrap().with_walls(&walls);
    let p = DVec3::new(0.0, 0.0, 0.5);
    let within = |photons: &[Photon], k: usize, cap: f64| {
        let map = PhotonMap::new(photons.to_vec(), 1).unwrap();
        let estimator = Estimator::new(Kernel::Uniform, Gather::nearest(k, cap).unwrap());
        estimator.rejecting(Rejection::BehindPlane).collision_density(&map, p, &boundary)
    };
    let estimate = |photons: &[Photon], k: usize| within(photons, k, 4.0);
    let ball = |r: f64| 4.0 / 3.0 * PI * r * r * r;
    // Two of four at distance 1 tie with the third; three behind the wall are nearer than they.
    let behind = [at(0.0, -0.25), at(0.1, -0.1), at(0.2, -0.2)];
    let tied = [&[at(0.0, 0.75), at(1.0, 0.5), at(-1.0, 0.5)][..], &behind].concat();
    let found = estimate(&tied, 3);
    assert!((found.value[0] * ball(1.0) - 2.0).abs() < 1e-6);
    assert_eq!((found.radius, found.found, found.rejected), (1.0, 3, 3));
    let coincident = [&[at(0.0, 0.5), at(0.0, 0.5), at(2.0, 0.5)][..], &behind].concat();
    let found = estimate(&coincident, 2);
    assert!((found.value[0] * ball(2.0) - 2.0).abs() < 1e-6 && found.coincident == 2);
    let found = estimate(&coincident, 4);
    assert!(found.underfull && found.radius == 4.0 && found.found == 3);
    // Nothing near, and nowhere.
    let far = within(&behind, 2, 0.7);
    assert!(far.value[0] == 0.0 && far.underfull);
}

/// One value a map at one point: maps of independent photons in a box.
fn over_maps(field: Synthetic, photons: u64, maps: u64, value: impl Fn(&PhotonMap) -> f64) -> Moments {
    let one = |replicate| value(&field.map(Number::Expected(photons), SEED, 100 + replicate).unwrap());
    (0..maps).map(one).collect()
}

/// A uniform field between flat faces: every k-nearest treatment but none is unbiased, since real photons alone set
/// the radius. The negative controls: nothing done, the ball's whole volume for clipping, the k-th photon chosen among photons
/// and images together.
#[test]
fn nearest_treatments_of_a_uniform_field() {
    let (size, photons, maps) = (DVec3::ONE, 4000, 512);
    let body = cuboid(size);
    let field = synthetic(Profile::Constant, DVec3::ZERO, size);
    let gather = Gather::nearest(20, 0.4).unwrap();
    // A corner, an edge, a face and near one.
    let probes =
        [DVec3::ZERO, DVec3::new(0.0, 1.0, 0.5), DVec3::new(0.5, 0.5, 1.0), DVec3::new(0.5, 0.04, 0.4)];
    let estimator = Estimator::new(Kernel::Uniform, gather);
    let mean = |map: &PhotonMap, treatment| {
        let boundary = Boundary::of(&body).unwrap();
        let one = |&p: &DVec3| estimator.treated(treatment).collision_density(map, p, &boundary).value[0];
        probes.iter().map(one).sum::<f64>() / probes.len() as f64
    };
    for treatment in [Treatment::Clipped, Treatment::Reflection, Treatment::LocalLinear] {
        let values = over_maps(field, photons, maps, |map| mean(map, treatment));
        // Local linear has the largest spread: 0.5 a probe, four of them, 512 maps, 7.6 standard errors.
        verdict::agrees(treatment.name(), &values, (1.0, 0.0), 0.12, SEED);
    }
    let untreated = over_maps(field, photons, maps, |map| mean(map, Treatment::None));
    verdict::rejects("no treatment", &untreated, 1.0, SEED);
    // The face's share for the corner's and the edge's: clipped by the wrong volume.
    let layer = slab(0.0, 1.0);
    let boundary = Boundary::of(&layer).unwrap();
    let face_alone = over_maps(field, photons, maps, |map| {
        estimator.treated(Treatment::Clipped).collision_density(map, DVec3::ZERO, &boundary).value[0]
    });
    verdict::rejects("clipped by the wrong volume", &face_alone, 1.0, SEED);
    // Among reals and images together the radius is that of a whole ball of k: (k-1) counted, k/(k - 1) of what the rule
    // for images needs at a face, where every image comes with its photon.
    let images_too = over_maps(field, photons, maps, |map| {
        let ten = Estimator::new(Kernel::Uniform, Gather::nearest(10, 0.24).unwrap());
        let ten = ten.treated(Treatment::Reflection);
        let places =
            (0..9).map(|i| DVec3::new(0.25 * f64::from(i % 3 + 1), 0.25 * f64::from(i / 3 + 1), 0.0));
        let right = places.map(|p| ten.collision_density(map, p, &boundary).value[0]);
        right.sum::<f64>() / 9.0 * 19.0 / 18.0
    });
    verdict::rejects("images set the radius", &images_too, 1.0, SEED);
}

/// A sheet between two uniform fields, k-nearest: behind-plane with clipping finds the field on this side. The negative controls:
/// rejecting after the radius was set, which leaves the mean (the k-1 nearer photons are a fair sample of their ball) but
/// fewer photons and so more variance; and not clipping.
#[test]
fn rejected_photons_set_no_radius() {
    let (low, high) = (DVec3::splat(-0.5), DVec3::splat(0.5));
    // Density 0.4 below x = 0 and 1.6 above, as a mixture: the step and a part of everything.
    let map = |replicate: u64| {
        let step =
            synthetic(Profile::Step { edge: 0.0 }, low, high).map(Number::Expected(2400), SEED, replicate);
        let rest =
            synthetic(Profile::Constant, low, high).map(Number::Expected(1600), SEED, 1 << 20 | replicate);
        let photons: Vec<Photon> =
            step.unwrap().tree().photons().chain(rest.unwrap().tree().photons()).collect();
        PhotonMap::new(photons, 4000).unwrap()
    };
    let corner = DVec3::new(0.0, -2.0, -2.0);
    let walls = [Shape::Rectangle(Rectangle::new(corner, DVec3::Y * 4.0, DVec3::Z * 4.0).unwrap())];
    let dark = Shape::Cuboid(Cuboid::new(DVec3::splat(-0.5), DVec3::new(0.0, 0.5, 0.5)).unwrap());
    let p = DVec3::new(-0.03, 0.0, 0.0);
    let gather = Gather::nearest(20, 0.45).unwrap();
    let maps: Vec<PhotonMap> = (0..512).map(map).collect();
    let boundary = Boundary::of(&dark).unwrap().with_walls(&walls);
    for rejection in [Rejection::BehindPlane, Rejection::Visible] {
        let estimator = Estimator::new(Kernel::Cone, gather).treated(Treatment::Clipped).rejecting(rejection);
        let one = |map: &PhotonMap| estimator.collision_density(map, p, &boundary).value[0];
        let values: Moments = maps.iter().map(one).collect();
        verdict::agrees(rejection.name(), &values, (0.4, 0.0), 0.06, SEED);
    }
    // The standard deviations of ratios of variances of 512 maps are below 0.1; the radius holds two fifths of the volume's
    // photons when false ones set it.
    let plain = Estimator::new(Kernel::Uniform, gather);
    let estimator = plain.treated(Treatment::Clipped).rejecting(Rejection::BehindPlane);
    let (mut right, mut late, mut unclipped) = (Moments::new(), Moments::new(), Moments::new());
    for map in &maps {
        let found = estimator.collision_density(map, p, &boundary);
        assert!(found.found == 20 || found.underfull);
        right.push(found.value[0]);
        let inside = body_moments(Kernel::Uniform, &dark, p, found.radius)[0];
        unclipped.push(found.value[0] * inside);
        let all = plain.collision_density(map, p, &Boundary::UNKNOWN);
        let inside = body_moments(Kernel::Uniform, &dark, p, all.radius)[0];
        let kept = map
            .tree()
            .photons()
            .filter(|q| q.position.x <= 0.0 && q.position.distance(p) < all.radius * (1.0 - 1e-6));
        late.push(kept.count() as f64 / (4.0 / 3.0 * PI * all.radius.powi(3) * inside * 4000.0));
    }
    verdict::agrees("behind plane, uniform", &right, (0.4, 0.0), 0.06, SEED);
    verdict::rejects("behind plane, not clipped", &unclipped, 0.4, SEED);
    assert!(late.variance() / right.variance() > 1.5, "{} {}", late.variance(), right.variance());
}
