//! Densities in blocks and worlds that repeat them: rays of any length against sums over all the planes that they cross.

use crate::support::unit_vector;
use glam::{DVec2, DVec3};
use turbid::Spectrum;
use turbid::math::{Interval, Positive, Ray, exp};
use turbid::medium::{Blocks, Cloud, CloudShape, Density, Grid, Heterogeneous, Homogeneous, Medium, markov};
use turbid::phase::{Isotropic, Phase};
use turbid::rng::{Purpose, Stream};
use turbid::transport::segment_transmittance;

fn medium(sigma_t: f64, density: Density) -> Medium {
    let matter =
        Homogeneous::new(Spectrum::grey(sigma_t), Spectrum::ONE, Phase::Isotropic(Isotropic)).unwrap();
    Heterogeneous::new(matter, density).into()
}

/// Two columns of the I3RC step cloud, without end along y.
fn step_cloud(sigma_t: f64) -> Medium {
    let corners = (DVec3::ZERO, DVec3::new(0.5, 1.0, 0.25));
    medium(
        sigma_t,
        Density::blocks(Blocks::uniform(corners, [2, 1, 1], 1, vec![8.0, 72.0]).unwrap()).unwrap(),
    )
}

/// The integral of the step cloud's density from 0 to x: whole periods, and what is left.
fn step_integral(x: f64) -> f64 {
    let periods = (x / 0.5).floor();
    let left = x - 0.5 * periods;
    20.0 * periods + 8.0 * left.min(0.25) + 72.0 * (left - 0.25).max(0.0)
}

/// What passes the step cloud along rays that cross up to 5000 periods, either way: in closed form.
#[test]
fn rays_through_many_periods_pass_as_in_closed_form() {
    let mut stream = Stream::new(1, Purpose::Synthetic, 0, 0);
    let sigma_t = 1e-4;
    let (world, alone) = (step_cloud(sigma_t).repeated(DVec2::new(0.5, 7.0)).unwrap(), step_cloud(sigma_t));
    let mut wrong = 0;
    for mu in [1.0, 0.5, -0.3, 0.01, -1e-3, 1e-4] {
        for azimuth in [0.0, 1.0, 2.5, 4.0] {
            let dir = unit_vector(mu, azimuth);
            let origin = DVec3::new(30.0 * stream.unit() - 15.0, 3.0, if mu > 0.0 { 0.0 } else { 0.25 });
            let ray = Ray::new(origin, dir);
            let part = Interval { start: 0.0, end: 0.25 / mu.abs() };
            let run = dir.x * part.end;
            let exact = if run.abs() < 1e-9 {
                step_integral(origin.x + 1e-10) - step_integral(origin.x)
            } else {
                step_integral(origin.x + run) - step_integral(origin.x)
            };
            let slope = if run.abs() < 1e-9 { 1e-10 } else { run } / part.end;
            let tau = sigma_t * exact / slope;
            let tau =
                if run.abs() < 1e-9 { sigma_t * world.density().unwrap().at(origin) * part.end } else { tau };
            let passed = segment_transmittance(&world, &ray, part, &mut stream)[0];
            // Each of the crossings is rounded as the largest number in its sum, and so is the closed form: x to a part in 2^53
            // of itself, at a density of 72.
            let crossings = 4.0 * run.abs() / 0.5 + 4.0;
            let size = origin.x.abs() + run.abs() + part.end;
            let rounding = crossings * f64::EPSILON * sigma_t * 72.0 * size + 1e-14;
            assert!(
                (passed / exp(-tau) - 1.0).abs() <= rounding,
                "{mu} {azimuth}: {passed} {tau} {rounding}"
            );
            let summed = exp(-world.integrated_depth(&ray, part)[0]);
            assert!((passed / summed - 1.0).abs() <= rounding, "{mu} {azimuth}");
            let single = segment_transmittance(&alone, &ray, part, &mut stream)[0];
            wrong += u32::from((single / exp(-tau) - 1.0).abs() > 100.0 * rounding);
        }
    }
    // A cloud that ends where its last column goes on for ever is another one.
    assert!(wrong > 12, "{wrong}");
}

/// Where a ray crosses planes of a lattice with a period, and ends of columns.
fn crossings(ray: &Ray, end: f64, planes: [&[f64]; 3], sides: [f64; 2]) -> Vec<f64> {
    let mut all = vec![0.0, end];
    for axis in 0..3 {
        let periods = if axis < 2 { (3.0 * end / sides[axis]).ceil() as i32 } else { 0 };
        for plane in planes[axis] {
            for number in -periods..=periods {
                let shift = if axis < 2 { f64::from(number) * sides[axis] } else { 0.0 };
                let t = (plane + shift - ray.origin[axis]) / ray.dir[axis];
                if 0.0 < t && t < end {
                    all.push(t);
                }
            }
        }
    }
    all.sort_by(f64::total_cmp);
    all
}

/// The integral between crossings, where the density is constant: that of the middles.
fn summed(ray: &Ray, crossings: &[f64], density: impl Fn(DVec3) -> f64) -> f64 {
    crossings.windows(2).map(|two| (two[1] - two[0]) * density(ray.at(0.5 * (two[0] + two[1])))).sum()
}

fn folded(x: f64, side: f64) -> f64 {
    x - side * (x / side).floor()
}

/// Voxels and columns of uneven widths and heights, in worlds of two different periods: rays in all directions against sums over
/// planes, by a density that is looked up here. The same lattice moved by a period is the same; by half of one it is not.
#[test]
fn blocks_and_columns_are_summed_along_rays_of_any_direction() {
    let mut stream = Stream::new(2, Purpose::Synthetic, 0, 0);
    let (xs, ys, zs) = ([0.0, 0.3, 0.35, 1.0], [0.0, 0.9, 2.0], [0.0, 0.1, 0.4, 1.0, 1.5]);
    let values: Vec<f64> = (0..24).map(|i| f64::from(i * i % 7)).collect();
    let spans: Vec<(f64, f64)> =
        (0..6).map(|i| (0.1 * f64::from(i), 1.5 - 0.2 * f64::from(i * i % 5))).collect();
    let place =
        |planes: &[f64], x: f64| planes[1..planes.len() - 1].iter().filter(|plane| **plane <= x).count();
    let voxel = |p: DVec3| {
        let [x, y, z] = [place(&xs, folded(p.x, 1.0)), place(&ys, folded(p.y, 2.0)), place(&zs, p.z)];
        values[(z * 2 + y) * 3 + x]
    };
    let column = |p: DVec3| {
        let number = place(&ys, folded(p.y, 2.0)) * 3 + place(&xs, folded(p.x, 1.0));
        let (from, to) = spans[number];
        if from <= p.z && p.z <= to { values[number + 1] } else { 0.0 }
    };
    let voxels = Blocks::new([xs.to_vec(), ys.to_vec(), zs.to_vec()], 1, values.clone()).unwrap();
    let columns = Blocks::columns(xs.to_vec(), ys.to_vec(), values[1..7].to_vec(), spans.clone()).unwrap();
    let heights: Vec<f64> = spans.iter().flat_map(|(from, to)| [*from, *to]).collect();
    let cell = DVec2::new(3.0, 2.0);
    let [voxels, columns] =
        [voxels, columns].map(|blocks| medium(1.0, Density::blocks(blocks).unwrap()).repeated(cell).unwrap());
    let mut moved = [0, 0];
    for case in 0..400 {
        let origin =
            (DVec3::from_array(stream.triple()) - 0.5) * DVec3::new(20.0, 20.0, 2.0) + DVec3::Z * 0.7;
        let dir = match case % 8 {
            0 => DVec3::AXES[case / 8 % 3] * if case % 16 == 0 { 1.0 } else { -1.0 },
            1 => unit_vector(1e-3 * (stream.unit() - 0.5), 6.0 * stream.unit()),
            _ => unit_vector(2.0 * stream.unit() - 1.0, 6.0 * stream.unit()),
        };
        let (ray, end) = (Ray::new(origin, dir), 12.0);
        let part = Interval { start: 0.0, end };
        let sides = [1.0, 2.0];
        for (which, medium, expected) in [
            (0, &voxels, summed(&ray, &crossings(&ray, end, [&xs, &ys, &zs], sides), voxel)),
            (1, &columns, summed(&ray, &crossings(&ray, end, [&xs, &ys, &heights], sides), column)),
        ] {
            // Some hundred crossings, each rounded as a coordinate of 30 at a density of 6.
            let tolerance = 300.0 * 6.0 * 30.0 * f64::EPSILON / dir.abs().max_element();
            let depth = medium.integrated_depth(&ray, part)[0];
            assert!((depth - expected).abs() <= tolerance, "{which} {case}: {depth} {expected}");
            let by = |shift: DVec3| medium.integrated_depth(&Ray::new(origin + shift, dir), part)[0];
            assert!((by(DVec3::new(-5.0, 4.0, 0.0)) - expected).abs() <= 4.0 * tolerance, "{which} {case}");
            moved[which] += u32::from((by(DVec3::new(0.5, 1.0, 0.0)) - expected).abs() > 1e-3);
        }
    }
    assert!(moved.iter().all(|count| *count > 300), "{moved:?}");
}

/// A grid between whose samples values are linear goes on across the seam: moved by a sample it is the same function moved. What
/// is clamped at its faces is not.
#[test]
fn linear_grids_go_on_across_the_seam() {
    let wave = |i: usize| (1.0 + (i * i % 5) as f64) as f32;
    let corners = (DVec3::ZERO, DVec3::new(8.0, 1.0, 1.0));
    let grid = |shift: usize| {
        let values = (0..8).map(|i| wave((i + shift) % 8)).collect();
        medium(1.0, Density::grid(Grid::new(corners, [8, 1, 1], 1, values).unwrap()).unwrap())
    };
    let cell = DVec2::new(16.0, 3.0);
    let mut clamped = 0;
    for i in 0..200 {
        let p = DVec3::new(0.17 * f64::from(i) - 12.0, 0.4 * f64::from(i), 0.3);
        for shift in [1, 3] {
            let value = |medium: &Medium, p: DVec3| medium.sigma_t(p)[0];
            let step = DVec3::X * shift as f64;
            let (a, b) = (grid(0).repeated(cell).unwrap(), grid(shift).repeated(cell).unwrap());
            // Differences of samples up to 5 times places rounded as 12 is.
            assert!((value(&a, p + step) - value(&b, p)).abs() < 1e-12, "{p} {shift}");
            assert_eq!(value(&a, p), value(&a, p.with_y(0.0)));
            clamped += u32::from((value(&grid(0), p + step) - value(&grid(shift), p)).abs() > 0.1);
        }
    }
    assert!(clamped > 50, "{clamped}");
    // And along rays.
    let ray = Ray::new(DVec3::new(-20.0, 0.0, 0.9), DVec3::X);
    let whole = |start: f64| {
        let part = Interval { start, end: start + 8.0 };
        grid(0).repeated(cell).unwrap().integrated_depth(&ray, part)[0]
    };
    let sum: f64 = (0..8).map(|i| f64::from(wave(i))).sum();
    for start in [0.0, 0.3, 7.7, 31.1] {
        assert!((whole(start) - sum).abs() < 1e-11, "{start}: {} {sum}", whole(start));
    }
}

/// What does not fit into a cell is refused by name.
#[test]
fn what_is_no_part_of_the_cell_is_refused() {
    let said = |medium: &Medium, x: f64, y: f64| medium.repeated(DVec2::new(x, y)).unwrap_err().to_string();
    let step = step_cloud(1.0);
    assert!(said(&step, 0.75, 1.0).contains("0.5 wide along x; allowed: the side of the cell there, 0.75"));
    assert!(said(&step, 0.25, 1.0).contains("or a whole part of it"));
    assert!(step.repeated(DVec2::new(1.5, 0.1)).is_ok());
    let cloud = Cloud::new(CloudShape::plain(DVec3::ZERO, DVec3::ONE)).unwrap();
    let cloud = medium(1.0, Density::Cloud(std::sync::Arc::new(cloud)));
    assert!(said(&cloud, 4.0, 2.0).contains("wide along y, with its shreds; allowed: up to the side"));
    let fog = turbid::medium::HeightFog::new(DVec3::X, 0.0, Positive::try_from(1.0).unwrap()).unwrap();
    assert!(said(&medium(1.0, Density::HeightFog(fog)), 1.0, 1.0).contains("`up` along z"));
    let twice = step.repeated(DVec2::new(0.5, 1.0)).unwrap();
    assert_eq!(twice.repeated(DVec2::new(2.0, 1.0)).unwrap(), twice);
    assert!(said(&twice, 0.7, 1.0).contains("no part of the cell"));
}

/// A ray along the faces has no end: above all columns it is found to be empty, between them it is followed, and in them it
/// ends.
#[test]
fn rays_without_end_come_to_an_end() {
    let spans = vec![(0.5, 1.0), (0.8, 1.0)];
    let columns = Blocks::columns(vec![0.0, 1.0, 2.0], vec![0.0, 1.0], vec![1.0, 1.0], spans).unwrap();
    let world = medium(1.0, Density::blocks(columns).unwrap()).repeated(DVec2::new(2.0, 2.0)).unwrap();
    let passed = |z: f64, dir: DVec3| {
        let part = Interval { start: 0.0, end: f64::INFINITY };
        let mut stream = Stream::new(3, Purpose::Synthetic, 0, 0);
        segment_transmittance(&world, &Ray::new(DVec3::new(0.5, 0.5, z), dir), part, &mut stream)[0]
    };
    assert_eq!(passed(0.2, DVec3::X), 1.0);
    assert_eq!(passed(0.2, DVec3::new(-0.6, 0.8, 0.0)), 1.0);
    assert_eq!(passed(0.6, DVec3::X), 0.0);
    assert_eq!(passed(0.6, DVec3::Y), 0.0);
    let dense = world.density().unwrap();
    let (bounds, end) =
        (dense.along(&Ray::new(DVec3::Z * 0.2, DVec3::X), Interval { start: 0.0, end: 1e300 }), 1e300);
    assert_eq!(bounds.last().unwrap().interval.end, end);
}

/// Chords of a Markov mixture are exponential with its means, in every realisation's share: the mean over realisations of
/// what passes a mixture that absorbs only is the solution of Levermore's and Pomraning's two equations,
/// dT_i/ds = -(sigma_i + 1/l_i) T_i + T_j/l_i backwards from T_i = 1, weighted by l_i/(l_0 + l_1).
#[test]
fn what_passes_markov_mixtures_is_the_solution_of_their_two_equations() {
    const SEEDS: u64 = 1 << 15;
    for (sigma, chords, length) in [
        ([10.0 / 99.0, 100.0 / 11.0], [0.99, 0.11], 1.0),
        ([2.0 / 101.0, 200.0 / 101.0], [5.05, 5.05], 10.0),
        ([0.0, 3.0], [0.2, 0.7], 2.0),
    ] {
        let [p, q]: [f64; 2] = [chords[0] / (chords[0] + chords[1]), chords[1] / (chords[0] + chords[1])];
        let (a, b): (f64, f64) = (sigma[0] + 1.0 / chords[0], sigma[1] + 1.0 / chords[1]);
        let (c, d) = (1.0 / chords[0], 1.0 / chords[1]);
        // T' = -M T with M = [[a, -c], [-d, b]]; both eigenvalues are above 0.
        let root = ((a - b) * (a - b) + 4.0 * c * d).sqrt();
        let (fast, slow) = (0.5 * (a + b + root), 0.5 * (a + b - root));
        // exp(-Ms) = e^-slow s + (e^-fast s - e^-slow s)/(fast - slow) (M - slow).
        let (of_slow, of_fast) = (exp(-slow * length), exp(-fast * length));
        let ratio = (of_fast - of_slow) / (fast - slow);
        let passed = |row: [f64; 2]| of_slow + ratio * (row[0] + row[1] - slow);
        let exact = p * passed([a, -c]) + q * passed([-d, b]);
        let mixed = exp(-(p * sigma[0] + q * sigma[1]) * length);
        let mut moments = turbid::stats::Moments::new();
        let mut first = turbid::stats::Moments::new();
        for seed in 0..SEEDS {
            let means = chords.map(|l| Positive::try_from(l).unwrap());
            let (edges, materials) = markov((0.0, length), means, seed).unwrap();
            assert_eq!(edges.len(), materials.len() + 1);
            first.push(if materials[0] == 0 { 1.0 } else { 0.0 });
            let values = materials.iter().map(|material| sigma[*material]).collect();
            let density = Density::blocks(Blocks::layers(2, edges, values).unwrap()).unwrap();
            let down = Ray::new(DVec3::ZERO, DVec3::Z);
            moments.push(exp(-density.integral(&down, Interval { start: 0.0, end: length })));
        }
        let name = format!("chords {chords:?}");
        crate::support::verdict::agrees(&name, &moments, (exact, 1e-14), 0.02, 0);
        crate::support::verdict::rejects(&format!("{name}, mixed evenly"), &moments, mixed, 0);
        crate::support::verdict::agrees(&format!("{name}, what is first"), &first, (p, 1e-15), 0.03, 0);
    }
}
