//! Rays against meshes of 36, 82 thousand and 1.3 million triangles: millions of rays a second on one thread, nearest hit
//! and shadow, and the seconds that the tree takes to build.
//!
//! `cargo bench --bench mesh`

use cpu_time::ThreadTime;
use glam::DVec3;
use std::collections::HashMap;
use std::hint::black_box;
use std::io::Write;
use turbid::geometry::Mesh;
use turbid::math::{Ray, warp};
use turbid::rng::{Purpose, Stream};

const RAYS: u64 = 200_000;
const ROUNDS: usize = 5;

fn main() -> anyhow::Result<()> {
    let mut out = std::io::stdout().lock();
    writeln!(
        out,
        "triangles  build s  nearest M/s  shadow M/s  (fastest of {ROUNDS} rounds of {RAYS} rays)"
    )?;
    for (corners, triangles) in [boxes(), ball(6), ball(8)] {
        let start = ThreadTime::now();
        let mesh = Mesh::new(&corners, &triangles, None)?;
        let build = start.elapsed().as_secs_f64();
        let rays = rays();
        let rate = |f: &dyn Fn(&Ray)| {
            let seconds = (0..ROUNDS).map(|_| {
                let start = ThreadTime::now();
                rays.iter().for_each(f);
                start.elapsed().as_secs_f64()
            });
            rays.len() as f64 / seconds.fold(f64::INFINITY, f64::min) * 1e-6
        };
        let nearest = rate(&|ray| _ = black_box(mesh.hit(ray, None)));
        let shadow = rate(&|ray| _ = black_box(mesh.blocks(ray, None, 2.0)));
        writeln!(out, "{:>9}  {build:>7.2}  {nearest:>11.2}  {shadow:>10.2}", mesh.len())?;
    }
    Ok(())
}

/// Rays between random points of a sphere of radius 1.5, none like the one before.
fn rays() -> Vec<Ray> {
    let ray = |i: u64| {
        let mut stream = Stream::new(1, Purpose::Synthetic, 0, i);
        let [a, b] = [stream.pair(), stream.pair()].map(|u| warp::square_to_sphere(u) * 1.5);
        Ray::new(a, (b - a).normalize())
    };
    (0..RAYS).map(ray).collect()
}

type Surface = (Vec<DVec3>, Vec<[u32; 3]>);

/// Three boxes: 36 triangles.
fn boxes() -> Surface {
    let (mut corners, mut triangles) = (Vec::new(), Vec::new());
    for (middle, size) in [(-0.5, 0.4), (0.1, 0.3), (0.6, 0.35)] {
        let first = corners.len() as u32;
        let corner =
            |i: u32| DVec3::new(f64::from(i & 1), f64::from(i >> 1 & 1), f64::from(i >> 2)) * 2.0 - 1.0;
        corners.extend((0..8).map(|i| corner(i) * size + DVec3::new(middle, 0.3 * middle, -middle)));
        for [a, b, c, d] in
            [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]]
        {
            triangles.extend([[a, b, c], [a, c, d]].map(|t: [u32; 3]| t.map(|i| i + first)));
        }
    }
    (corners, triangles)
}

/// A ball with hills from an octahedron of which six sides are cut in three, 20 triangles, each then cut in four `levels`
/// times: 20 4^levels.
fn ball(levels: u32) -> Surface {
    let mut corners = vec![DVec3::X, DVec3::Y, DVec3::NEG_X, DVec3::NEG_Y, DVec3::Z, DVec3::NEG_Z];
    // Twenty triangles: the eight of an octahedron, six of them cut in three.
    let mut triangles: Vec<[u32; 3]> = Vec::new();
    for (i, [a, b, c]) in
        [[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4], [1, 0, 5], [2, 1, 5], [3, 2, 5], [0, 3, 5]]
            .into_iter()
            .enumerate()
    {
        if i < 6 {
            let middle = corners.len() as u32;
            corners.push((corners[a as usize] + corners[b as usize] + corners[c as usize]).normalize());
            triangles.extend([[a, b, middle], [b, c, middle], [c, a, middle]]);
        } else {
            triangles.push([a, b, c]);
        }
    }
    for _ in 0..levels {
        let mut middles = HashMap::new();
        let mut middle = |a: u32, b: u32| {
            *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
                corners.push((corners[a as usize] + corners[b as usize]).normalize());
                corners.len() as u32 - 1
            })
        };
        let cut = |&[a, b, c]: &[u32; 3]| {
            let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
            [[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]
        };
        triangles = triangles.iter().flat_map(cut).collect();
    }
    let hill = |p: &DVec3| *p * (1.0 + 0.05 * turbid::math::sin(20.0 * p.x) * turbid::math::sin(17.0 * p.y));
    (corners.iter().map(hill).collect(), triangles)
}
