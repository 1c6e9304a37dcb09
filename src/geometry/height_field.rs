//! Height fields: a mesh over a grid of heights, such as a water surface.

use super::Mesh;
use super::mesh::TRIANGLE_BYTES;
use crate::error::{Error, Result};
use crate::math::sin;
use crate::rng::{Purpose, Stream};
use glam::{DVec2, DVec3};
use std::f64::consts::PI;

/// Which way is up.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Up {
    /// Heights along y, over the plane of z and x.
    Y,
    /// Heights along z, over the plane of x and y.
    #[default]
    Z,
}

impl Up {
    /// A point over the ground at a height, with the same handedness for every direction.
    fn place(self, ground: DVec2, height: f64) -> DVec3 {
        match self {
            Up::Y => DVec3::new(ground.y, height, ground.x),
            Up::Z => DVec3::new(ground.x, ground.y, height),
        }
    }
}

/// A rectangle of ground: where it begins, its extent \[L\] and the number of grid cells, each along both axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ground {
    /// Least coordinates \[L\].
    pub corner: DVec2,
    /// Extent along the first and the second axis \[L\].
    pub size: DVec2,
    /// Number of cells along each axis.
    pub cells: [usize; 2],
}

/// More cells than this are refused: a million, two million triangles, which take some 1 GB while they are made.
const MAX_CELLS: usize = 1 << 20;

/// The mesh over a grid of heights, whose up side is outside: each cell is two triangles.
///
/// With a `floor` \[L\] below all heights, walls and a flat bottom close it: a body of water.
///
/// # Arguments   `height` of the point in ground coordinates \[L\]
/// # Errors      `Error::Scene` or `Error::OutOfRange` for a ground without extent or cells, heights that are not finite,
/// a floor that is not below them,
/// or more than the memory that is free
pub fn height_field(
    ground: &Ground,
    up: Up,
    floor: Option<f64>,
    height: impl Fn(DVec2) -> f64,
) -> Result<Mesh> {
    let [columns, rows] = ground.cells;
    if columns == 0 || rows == 0 || columns > MAX_CELLS || rows > MAX_CELLS || columns * rows > MAX_CELLS {
        return Err(Error::Scene(format!(
            "a height field of {columns} x {rows} cells; allowed: 1 to 2^20 in all"
        )));
    }
    if !(ground.corner.is_finite() && ground.size.is_finite() && ground.size.min_element() > 0.0) {
        return Err(Error::Scene(
            "a height field needs a finite corner and a size above 0 on both axes".into(),
        ));
    }
    let what = || format!("a height field of {columns} x {rows} cells");
    crate::memory::check(what, 2.0 * TRIANGLE_BYTES * (columns * rows) as f64)?;
    let at = |i: usize, j: usize| {
        ground.corner + ground.size * DVec2::new(i as f64 / columns as f64, j as f64 / rows as f64)
    };
    let (mut positions, mut uvs, mut lowest) = (Vec::new(), Vec::new(), f64::INFINITY);
    for j in 0..=rows {
        for i in 0..=columns {
            let h = height(at(i, j));
            if !h.is_finite() {
                return Err(Error::out_of_range("height", h, "finite"));
            }
            lowest = lowest.min(h);
            positions.push(up.place(at(i, j), h));
            uvs.push(DVec2::new(i as f64 / columns as f64, j as f64 / rows as f64));
        }
    }
    let top = |i: usize, j: usize| (j * (columns + 1) + i) as u32;
    let mut triangles = Vec::with_capacity(2 * columns * rows);
    for j in 0..rows {
        for i in 0..columns {
            let [a, b, c, d] = [top(i, j), top(i + 1, j), top(i + 1, j + 1), top(i, j + 1)];
            // Diagonals alternate, so that the triangles lean in no direction.
            triangles.extend(if (i + j) % 2 == 0 { [[a, b, c], [a, c, d]] } else { [[a, b, d], [b, c, d]] });
        }
    }
    if let Some(floor) = floor {
        if floor.is_nan() || floor >= lowest || floor == f64::NEG_INFINITY {
            return Err(Error::out_of_range("floor", floor, "finite and below every height"));
        }
        // Once around the ground, counter-clockwise seen from above.
        let edge: Vec<(usize, usize)> = (0..columns)
            .map(|i| (i, 0))
            .chain((0..rows).map(|j| (columns, j)))
            .chain((1..=columns).rev().map(|i| (i, rows)))
            .chain((1..=rows).rev().map(|j| (0, j)))
            .collect();
        let first = positions.len() as u32;
        positions.extend(edge.iter().map(|&(i, j)| up.place(at(i, j), floor)));
        uvs.extend(edge.iter().map(|&(i, j)| uvs[top(i, j) as usize]).collect::<Vec<_>>());
        let middle = positions.len() as u32;
        positions.push(up.place(ground.corner + 0.5 * ground.size, floor));
        uvs.push(DVec2::splat(0.5));
        for (k, &(i, j)) in edge.iter().enumerate() {
            let next = (k + 1) % edge.len();
            let (low, low_next) = (first + k as u32, first + next as u32);
            let (high, high_next) = (top(i, j), top(edge[next].0, edge[next].1));
            triangles.extend([[low, low_next, high_next], [low, high_next, high], [middle, low_next, low]]);
        }
    }
    let uvs: Vec<[DVec2; 3]> = triangles.iter().map(|t: &[u32; 3]| t.map(|k| uvs[k as usize])).collect();
    Mesh::new(&positions, &triangles, Some(&uvs))
}

/// A rough surface: sines of random direction, phase and length, all equally steep.
#[derive(Debug, Clone, PartialEq)]
pub struct Waves {
    /// Wave vector [1/L], phase and amplitude \[L\] of each.
    waves: Vec<(DVec2, f64, f64)>,
}

impl Waves {
    /// `count` waves between half and twice `wavelength` \[L\], whose heights have the root-mean-square `rms` \[L\].
    ///
    /// # Errors     `Error::OutOfRange` for a wavelength that is not above 0, an rms below 0, or no waves
    pub fn new(seed: u64, count: u32, wavelength: f64, rms: f64) -> Result<Self> {
        if !(wavelength > 0.0 && wavelength.is_finite()) {
            return Err(Error::out_of_range("wavelength", wavelength, "finite and above 0"));
        }
        if !(rms >= 0.0 && rms.is_finite()) {
            return Err(Error::out_of_range("rms", rms, "finite and at least 0"));
        }
        if !(1..=1000).contains(&count) {
            return Err(Error::out_of_range("count", f64::from(count), "1 to 1000"));
        }
        let mut stream = Stream::new(seed, Purpose::Synthetic, 0, 0);
        let mut waves: Vec<(DVec2, f64, f64)> = (0..count)
            .map(|_| {
                let [u, v, w] = stream.triple();
                // Lengths even in their logarithm.
                let length = wavelength * libm::exp2(2.0 * u - 1.0);
                let (sin, cos) = crate::math::sin_cos(2.0 * PI * v);
                (DVec2::new(cos, sin) * (2.0 * PI / length), 2.0 * PI * w, length)
            })
            .collect();
        // A sine of amplitude a has the mean square a^2/2; waves of different direction or length add their squares.
        let square: f64 = waves.iter().map(|(_, _, a)| 0.5 * a * a).sum();
        for (_, _, amplitude) in &mut waves {
            *amplitude *= rms / square.sqrt();
        }
        Ok(Waves { waves })
    }

    /// Height over a point of the ground \[L\].
    pub fn height(&self, p: DVec2) -> f64 {
        self.waves.iter().map(|(k, phase, a)| a * sin(k.dot(p) + phase)).sum()
    }
}

/// Heights from a list of rows, bilinear between them: the list fills the ground from edge to edge.
///
/// # Errors     `Error::Scene` for fewer than two rows or columns, rows of different lengths, or numbers that are not finite
pub fn listed(ground: &Ground, rows: &[Vec<f64>]) -> Result<impl Fn(DVec2) -> f64> {
    let columns = rows.first().map_or(0, Vec::len);
    if rows.len() < 2 || columns < 2 {
        return Err(Error::Scene("heights need at least 2 rows of at least 2 numbers".into()));
    }
    if let Some(row) = rows.iter().position(|row| row.len() != columns) {
        return Err(Error::Scene(format!(
            "row {} of the heights has {} numbers, the first has {columns}; allowed: all alike",
            row + 1,
            rows[row].len()
        )));
    }
    if let Some(bad) = rows.iter().flatten().find(|h| !h.is_finite()) {
        return Err(Error::out_of_range("height", *bad, "finite"));
    }
    let ground = *ground;
    Ok(move |p: DVec2| {
        let part =
            (p - ground.corner) / ground.size * DVec2::new((columns - 1) as f64, (rows.len() - 1) as f64);
        let cell = |x: f64, count: usize| {
            let i = (x.max(0.0) as usize).min(count - 2);
            (i, x - i as f64)
        };
        let ((i, x), (j, y)) = (cell(part.x, columns), cell(part.y, rows.len()));
        let row = |j: usize| rows[j][i] * (1.0 - x) + rows[j][i + 1] * x;
        row(j) * (1.0 - y) + row(j + 1) * y
    })
}
