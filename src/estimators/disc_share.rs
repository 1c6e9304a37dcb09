//! The part of a kernel's disc that lies on a rectangle, before straight lines, among segments, and in a circle.

use super::Kernel;
use crate::geometry::Rectangle;
use glam::{DVec2, DVec3};
use std::f64::consts::PI;

/// A Gauss rule of 8 nodes on \[0, 1\]: places and weights.
pub(super) const RULE: [(f64, f64); 8] = [
    (0.019_855_071_751_231_86, 0.050_614_268_145_188_13),
    (0.101_666_761_293_186_64, 0.111_190_517_226_687_24),
    (0.237_233_795_041_835_5, 0.156_853_322_938_943_63),
    (0.408_282_678_752_175_1, 0.181_341_891_689_181),
    (0.591_717_321_247_825, 0.181_341_891_689_181),
    (0.762_766_204_958_164_5, 0.156_853_322_938_943_63),
    (0.898_333_238_706_813_4, 0.111_190_517_226_687_24),
    (0.980_144_928_248_768_1, 0.050_614_268_145_188_13),
];

/// Sines of angles below this are of parallel lines; those no farther apart than this coincide.
const PARALLEL: f64 = 1e-12;

/// The integral over a rectangle of the kernel of radius r about a point of its plane: 1 if the disc is whole, a quarter in
/// a corner.
///
/// The sum over the rectangle's corners of the integrals over the right-angled pieces between the point and the corner. The
/// triangle with one side along an edge at distance a r of the point, from its foot to a height y, holds
/// int_0^y a g(a^2 + s^2) ds with w g(w) the kernel's integral over a wedge of one radian out to sqrt(w); what reaches
/// beyond the disc is cut there.
///
/// # Returns
/// \[1\], to rounding for the uniform, Epanechnikov and biweight kernels and to 1e-9 for the Gaussian, by the degree of the
/// integrand; to 1e-4 for the cone, whose tip a rule on a line beside it sees as a bend
pub fn disc_share(kernel: Kernel, rectangle: &Rectangle, point: DVec3, radius: f64) -> f64 {
    let inside = rectangle.inside(point);
    if inside >= radius {
        return 1.0;
    }
    if inside <= -radius {
        return 0.0;
    }
    let (low, high) = rectangle.bounds_about(point);
    let ([x0, y0], [x1, y1]) = ((low / radius).to_array(), (high / radius).to_array());
    let piece = |x: f64, y: f64| piece(kernel, x.abs(), y.abs()).copysign(x * y);
    piece(x1, y1) - piece(x0, y1) - piece(x1, y0) + piece(x0, y0)
}

/// The integral of the disc's kernel over what is before all of several lines that do not pass behind its centre, each given by a unit
/// vector from the centre towards it, and its distance over the radius. An edge's part of the polygon hides the wedge behind it.
///
/// # Returns
/// \[1\], as exact as [`disc_share`]
pub fn share_before(kernel: Kernel, lines: &[(DVec2, f64)]) -> f64 {
    let behind = |(index, (towards, away)): (usize, &(DVec2, f64))| {
        let half = ((1.0 - away).max(0.0) * (1.0 + away)).sqrt();
        let (mut low, mut high) = (-half, half);
        for (other, (towards_other, away_of_other)) in lines.iter().enumerate() {
            let (cos, sin) = (towards.dot(*towards_other), towards.perp_dot(*towards_other));
            let room = away_of_other - away * cos;
            if sin.abs() < PARALLEL {
                // Of two that coincide the first one counts.
                if room < -PARALLEL || (room < PARALLEL && cos > 0.0 && other < index) {
                    return 0.0;
                }
            } else if sin > 0.0 {
                high = high.min(room / sin);
            } else {
                low = low.max(room / sin);
            }
        }
        if low >= high {
            return 0.0;
        }
        let before = |y: f64| triangle(kernel, *away, y.abs()).copysign(y);
        let wedge = (libm::atan2(high, *away) - libm::atan2(low, *away)) / (2.0 * PI);
        wedge - (before(high) - before(low))
    };
    1.0 - lines.iter().enumerate().map(behind).sum::<f64>()
}

/// The integral of the disc's kernel over what is before lines, as [`share_before`], and seen from its centre among segments, in units of the
/// radius. From angle to angle at which one begins, ends or crosses another the same one is nearest, or none: what is before it is a triangle.
/// What a segment through the centre itself hides is for rounding to say.
///
/// # Returns
/// \[1\], as exact as [`disc_share`]
pub fn share_among(kernel: Kernel, lines: &[(DVec2, f64)], segments: &[[DVec2; 2]]) -> f64 {
    // A line through the centre is before it by more than rounding.
    let across = |&(towards, away): &(DVec2, f64)| {
        [-1.0, 1.0].map(|end| towards * away.max(PARALLEL) + towards.perp() * end)
    };
    let segments = lines.iter().map(across).chain(segments.iter().copied());
    let segments: Vec<[DVec2; 2]> = segments.filter_map(in_disc).collect();
    let mut turns: Vec<DVec2> = segments.as_flattened().to_vec();
    for (index, one) in segments.iter().enumerate() {
        turns.extend(segments[..index].iter().filter_map(|other| crossing(one, other)));
    }
    // One at the centre is in no direction.
    turns.retain(|place| *place != DVec2::ZERO);
    let mut turns: Vec<Turn> =
        turns.into_iter().map(|place| (libm::atan2(place.y, place.x), place)).collect();
    turns.sort_unstable_by(|(a, _), (b, _)| a.total_cmp(b));
    let Some((first, place)) = turns.first().copied() else { return 1.0 };
    turns.push((first + 2.0 * PI, place));
    // Of each sector what is nearest in it.
    let nearest = |sector: &[Turn]| {
        let (sin, cos) = crate::math::sin_cos(0.5 * (sector[0].0 + sector[1].0));
        let away = |(index, ends)| Some((index, along(ends, DVec2::new(cos, sin))?));
        let nearest = segments.iter().enumerate().filter_map(away).min_by(|(_, a), (_, b)| a.total_cmp(b));
        (nearest.map(|(index, _)| index), sector[0], sector[1])
    };
    let sectors: Vec<_> = turns.windows(2).map(nearest).collect();
    let seen = |run: &[(Option<usize>, Turn, Turn)]| {
        let ((index, start, _), (_, _, end)) = (run[0], run[run.len() - 1]);
        let Some(index) = index else { return (end.0 - start.0) / (2.0 * PI) };
        let [a, b] = segments[index];
        let way = (b - a).normalize();
        let away = a.perp_dot(way).abs();
        // Along the segment's line from its place nearest the centre, turning as angles do.
        let along_line = if a.perp_dot(way) >= 0.0 { way } else { -way };
        let before = |(_, dir): Turn| {
            let (across, along) = (dir.perp_dot(along_line), dir.dot(along_line));
            let height = if across > 0.0 { away * along / across } else { f64::INFINITY.copysign(along) };
            triangle(kernel, away, height.abs()).copysign(height)
        };
        before(end) - before(start)
    };
    sectors.chunk_by(|a, b| a.0 == b.0).map(seen).sum()
}

/// An angle, and a place in its direction.
type Turn = (f64, DVec2);

/// The part of a segment in the unit disc about 0.
fn in_disc([a, b]: [DVec2; 2]) -> Option<[DVec2; 2]> {
    let way = b - a;
    let length = way.length();
    let (middle, away) = (-a.dot(way) / length, a.perp_dot(way) / length);
    let half = ((1.0 - away.abs()).max(0.0) * (1.0 + away.abs())).sqrt();
    let (start, end) = (middle - half, middle + half);
    // An end in the disc stays as it is: counted from the other one, far off, it would move.
    let first = if start > 0.0 { a + way * (start / length) } else { a };
    let last = if end < length { a + way * (end / length) } else { b };
    (start.max(0.0) < end.min(length)).then_some([first, last])
}

/// Where two segments cross.
fn crossing([a, b]: &[DVec2; 2], [c, d]: &[DVec2; 2]) -> Option<DVec2> {
    let (way, other, between) = (*b - *a, *d - *c, *c - *a);
    let sine = way.perp_dot(other);
    let (part, of_other) = (between.perp_dot(other) / sine, between.perp_dot(way) / sine);
    let is_within = |part: f64| (0.0..=1.0).contains(&part);
    (is_within(part) && is_within(of_other)).then(|| *a + way * part)
}

/// How far from 0 a segment is in a direction, if it is met.
fn along([a, b]: &[DVec2; 2], dir: DVec2) -> Option<f64> {
    let way = *b - *a;
    let sine = dir.perp_dot(way);
    let (away, part) = (a.perp_dot(way) / sine, a.perp_dot(dir) / sine);
    (away > 0.0 && (0.0..=1.0).contains(&part)).then_some(away)
}

/// The integral of the disc's kernel over what of it lies in a circle that holds its centre: of radius `circle`, its centre `away`, both over
/// the disc's radius. By two rules over the angles at which the circle cuts the disc.
///
/// # Returns
/// \[1\], to 3e-3, and to 1e-4 where the circle is no nearer than a tenth: nearer, the rules may step over a narrow bend
pub fn share_in_circle(kernel: Kernel, circle: f64, away: f64) -> f64 {
    let beyond = (circle - away) * (circle + away);
    if circle - away >= 1.0 || beyond <= 0.0 {
        return if beyond > 0.0 { 1.0 } else { 0.0 };
    }
    // The angle from the way out of the circle's centre within which the circle is nearer than the disc's rim.
    let cut = libm::acos(((beyond - 1.0) / (2.0 * away)).clamp(-1.0, 1.0));
    let reach = |angle: f64| {
        let (sin, cos) = crate::math::sin_cos(angle);
        let along = away * cos;
        let root = (circle * circle - away * away * sin * sin).max(0.0).sqrt();
        // Of two forms the one that subtracts nothing.
        if along > 0.0 { beyond / (root + along) } else { root - along }
    };
    let inner = |angle: f64| kernel.within_disc(reach(angle).min(1.0));
    let both =
        |(place, weight): &(f64, f64)| weight * (inner(0.5 * cut * place) + inner(0.5 * cut * (1.0 + place)));
    (1.0 - cut / PI) + cut / PI * 0.5 * RULE.iter().map(both).sum::<f64>()
}

/// The integral over a spherical surface of the kernel of radius r about a point of it, as far as chords of `reach` r: the
/// part of a sphere within a chord d has the area pi d^2, that of a flat disc, whatever the sphere's radius.
pub fn cap_share(kernel: Kernel, reach: f64) -> f64 {
    let w = (reach * reach).min(1.0);
    if w == 1.0 { 1.0 } else { 2.0 * PI * w * kernel.wedge(w) }
}

/// Over the rectangle with opposite corners at the disc's centre and (a, b), in units of the radius.
fn piece(kernel: Kernel, a: f64, b: f64) -> f64 {
    triangle(kernel, a, b) + triangle(kernel, b, a)
}

/// Over the triangle (0, 0), (a, 0), (a, b), as far as it lies in the disc.
fn triangle(kernel: Kernel, a: f64, b: f64) -> f64 {
    let wedge = |angle: f64| angle / (2.0 * PI);
    if a >= 1.0 {
        return wedge(libm::atan2(b, a));
    }
    let height = b.min((1.0 - a * a).sqrt());
    let sum: f64 =
        RULE.iter().map(|(s, weight)| weight * kernel.wedge(a * a + height * height * s * s)).sum();
    let beyond = if height < b { libm::atan2(b, a) - libm::atan2(height, a) } else { 0.0 };
    a * height * sum + wedge(beyond)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::{Purpose, Stream};

    fn rectangle() -> Rectangle {
        Rectangle::new(DVec3::ZERO, DVec3::X * 2.0, DVec3::Y).unwrap()
    }

    /// Rings of the disc, each with the part of its angles that is inside found by counting.
    fn counted(kernel: Kernel, point: DVec3, radius: f64) -> f64 {
        let (rings, angles) = (400, 1600);
        let mut sum = 0.0;
        for ring in 0..rings {
            let u = (f64::from(ring) + 0.5) / f64::from(rings);
            let count = (0..angles).filter(|angle| {
                let (sine, cosine) =
                    crate::math::sin_cos(2.0 * PI * (f64::from(*angle) + 0.5) / f64::from(angles));
                rectangle().covers(point + radius * u * DVec3::new(cosine, sine, 0.0))
            });
            let share = count.count() as f64 / f64::from(angles);
            sum += share * 2.0 * PI * u * kernel.disc_peak() * kernel.profile(u * u) / f64::from(rings);
        }
        sum
    }

    /// Counting is wrong by up to a count at each of four ends, a few thousandths at most; rings by far less.
    #[test]
    fn against_counting() {
        for kernel in Kernel::ALL {
            for (x, y) in
                [(0.0, 0.0), (0.1, 0.2), (1.0, 0.5), (1.9, 0.97), (2.0, 0.4), (-0.1, 0.3), (2.2, 1.1)]
            {
                let point = DVec3::new(x, y, 0.0);
                for radius in [0.05, 0.3, 0.8, 1.5, 4.0] {
                    let (found, counted) =
                        (disc_share(kernel, &rectangle(), point, radius), counted(kernel, point, radius));
                    assert!((found - counted).abs() < 4e-3, "{kernel:?} {x} {y} {radius}: {found} {counted}");
                }
            }
        }
    }

    #[test]
    fn halves_quarters_and_areas() {
        for kernel in Kernel::ALL {
            let share = |x, y, radius| disc_share(kernel, &rectangle(), DVec3::new(x, y, 0.0), radius);
            let error = if kernel == Kernel::Cone { 1e-4 } else { 1e-9 };
            assert_eq!(share(1.0, 0.5, 0.5), 1.0);
            assert_eq!(share(-1.0, 0.5, 1.0), 0.0);
            assert!((share(0.0, 0.5, 0.5) - 0.5).abs() < error);
            assert!((share(2.0, 1.0, 0.5) - 0.25).abs() < error);
            // Halves of the plane, side by side, hold the disc together.
            let other = Rectangle::new(DVec3::NEG_X * 2.0, DVec3::X * 2.0, DVec3::Y).unwrap();
            let point = DVec3::new(0.13, 0.6, 0.0);
            let sum = share(0.13, 0.6, 0.35) + disc_share(kernel, &other, point, 0.35);
            assert!((sum - 1.0).abs() < error, "{kernel:?} {sum}");
        }
        // All of a small rectangle counts in a uniform disc.
        let found = disc_share(Kernel::Uniform, &rectangle(), DVec3::new(0.7, 0.3, 0.0), 5.0);
        assert!((found - 2.0 / (PI * 25.0)).abs() < 1e-15);
    }

    /// Random lines, two of them twice, opposite each other, and beyond the disc: against rays at 40,000 equal angles, whose error is far
    /// below a ten thousandth.
    #[test]
    fn lines_against_rays() {
        let mut stream = Stream::new(11, Purpose::Synthetic, 0, 0);
        for (trial, kernel) in (0..40).flat_map(|trial| Kernel::ALL.map(|kernel| (trial, kernel))) {
            let mut lines: Vec<(DVec2, f64)> = (0..trial % 6)
                .map(|_| {
                    let (sin, cos) = crate::math::sin_cos(2.0 * PI * stream.unit());
                    (DVec2::new(cos, sin), 1.2 * stream.unit())
                })
                .collect();
            if let Some(&(towards, away)) = lines.first() {
                lines.extend([(towards, away), (-towards, 0.0), (towards, 0.5 + away)]);
            }
            let rays = 40_000;
            let sum: f64 = (0..rays)
                .map(|ray| {
                    let (sin, cos) =
                        crate::math::sin_cos(2.0 * PI * (f64::from(ray) + 0.5) / f64::from(rays));
                    let dir = DVec2::new(cos, sin);
                    let ends = lines.iter().map(|(towards, away)| (dir.dot(*towards), away));
                    let end = ends.filter(|(cos, _)| *cos > 0.0).map(|(cos, away)| away / cos);
                    kernel.within_disc(end.fold(1.0, f64::min))
                })
                .sum();
            let (found, counted) = (share_before(kernel, &lines), sum / f64::from(rays));
            assert!((found - counted).abs() < 2e-4, "{kernel:?} {lines:?}: {found} {counted}");
        }
    }

    /// Random segments, some of them twice, with a common end, beyond the disc or crossing others, alone and in a thin gap: against rays at
    /// 40,000 equal angles. Whole lines among them say what [`share_before`] says.
    #[test]
    fn segments_against_rays() {
        let mut stream = Stream::new(13, Purpose::Synthetic, 0, 0);
        let mut seen = [0; 2];
        for (trial, kernel) in (0..60).flat_map(|trial| Kernel::ALL.map(|kernel| (trial, kernel))) {
            let size = [0.3, 1.5, 10.0][trial % 3];
            let mut segments: Vec<[DVec2; 2]> = (0..trial % 7)
                .map(|_| {
                    let place = DVec2::from(stream.pair()) * 2.4 - 1.2;
                    [place, place + size * (DVec2::from(stream.pair()) - 0.5)]
                })
                .collect();
            if let Some(&[a, b]) = segments.first() {
                segments.extend([[a, b], [b, 1.1 * a]]);
            }
            match trial % 5 {
                // Ends at the centre, one of them with another end at the angle 0.
                1 => segments
                    .extend([[DVec2::ZERO, DVec2::new(-0.5, -0.3)], [DVec2::X * 0.5, DVec2::new(0.5, -0.5)]]),
                // Far off at one end, hardly off the centre at the other.
                2 => segments.push([DVec2::new(5e6, 0.5), DVec2::new(1e-9, 3e-10)]),
                _ => (),
            }
            if trial % 4 == 3 {
                segments.extend([0.01, -0.02].map(|y| [DVec2::new(-0.8, y), DVec2::new(2.0, y)]));
            }
            let rays = 40_000;
            let reach = |ray: u32| {
                let (sin, cos) = crate::math::sin_cos(2.0 * PI * (f64::from(ray) + 0.5) / f64::from(rays));
                // From the nearer end, which counting from one far off would move.
                let outwards =
                    |[a, b]: &[DVec2; 2]| if a.length() <= b.length() { [*a, *b] } else { [*b, *a] };
                let met = segments.iter().filter_map(|ends| along(&outwards(ends), DVec2::new(cos, sin)));
                kernel.within_disc(met.fold(1.0, f64::min))
            };
            let expected = (0..rays).map(reach).sum::<f64>() / f64::from(rays);
            let found = share_among(kernel, &[], &segments);
            assert!((found - expected).abs() < 2e-4, "{kernel:?} {segments:?}: {found} {expected}");
            seen[usize::from(expected < 0.99)] += 1;

            let lines: Vec<_> = (0..1 + trial % 3)
                .map(|_| {
                    let (sin, cos) = crate::math::sin_cos(2.0 * PI * stream.unit());
                    (DVec2::new(cos, sin), stream.unit())
                })
                .collect();
            let among = share_among(kernel, &lines, &[]);
            let before = share_before(kernel, &lines);
            assert!(
                (among - before).abs() < 1e-13 + 4e-4 * f64::from(u8::from(kernel == Kernel::Cone)),
                "{among} {before}"
            );
        }
        assert!(seen.iter().all(|count| *count > 40), "{seen:?}");
    }

    /// Strips and circles far smaller than the disc are known to a part of themselves: that of the strip is sqrt(1 - a^2) a + asin a over pi
    /// to each side of the centre (uniform kernel), all of a circle counts.
    #[test]
    fn little_is_known_as_well_as_much() {
        for size in [1e-1f64, 1e-3, 1e-6, 1e-9] {
            for part in [0.0, 0.01, 0.3, 0.5, 0.9, 0.999] {
                let sides = [part * size, (1.0 - part) * size];
                let strip: f64 = sides.iter().map(|a| (a * (1.0 - a * a).sqrt() + libm::asin(*a)) / PI).sum();
                let lines = [(DVec2::Y, sides[0]), (DVec2::NEG_Y, sides[1])];
                for found in
                    [share_before(Kernel::Uniform, &lines), share_among(Kernel::Uniform, &lines, &[])]
                {
                    assert!(
                        (found / strip - 1.0).abs() < 1e-6 + 2e-12 / size,
                        "{size} {part}: {found} {strip}"
                    );
                }
                let found = share_in_circle(Kernel::Uniform, size, part * size);
                assert!((found / (size * size) - 1.0).abs() < 3e-3, "{size} {part}: {found}");
            }
        }
    }

    /// Circles about the centre, large and small, near and far: against rays at 40,000 equal angles.
    #[test]
    fn circles_against_rays() {
        let mut stream = Stream::new(12, Purpose::Synthetic, 0, 0);
        for (trial, kernel) in (0..200).flat_map(|trial| Kernel::ALL.map(|kernel| (trial, kernel))) {
            let circle = libm::exp10(4.0 * stream.unit() - 1.0);
            let away = match trial % 3 {
                0 => circle * stream.unit(),
                1 => (circle - stream.unit()).max(0.0),
                _ => circle - (circle * 1e-3).min(1e-2) * stream.unit(),
            };
            let rays = 40_000;
            let sum: f64 = (0..rays)
                .map(|ray| {
                    let (sin, cos) =
                        crate::math::sin_cos(2.0 * PI * (f64::from(ray) + 0.5) / f64::from(rays));
                    // From the centre of the disc, at (away, 0) from that of the circle.
                    let half = away * cos;
                    let root = (circle * circle - away * away * sin * sin).max(0.0).sqrt();
                    kernel.within_disc((root - half).clamp(0.0, 1.0))
                })
                .sum();
            let (found, counted) = (share_in_circle(kernel, circle, away), sum / f64::from(rays));
            // The rays' own error is below 1e-5.
            let error = if circle - away > 0.1 { 1.1e-4 } else { 3e-3 };
            assert!((found - counted).abs() < error, "{kernel:?} {circle} {away}: {found} {counted}");
        }
    }
}
