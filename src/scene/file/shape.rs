//! Shapes in the scene file.

use super::values::rectangle;
use crate::error::{Error, Result};
use crate::geometry::{
    Cuboid, Ground, Mesh, Revolution, Shape, Slab, Sphere, Up, Waves, height_field, listed, smooth,
};
use crate::math::{NonNegative, Positive, sin_cos};
use glam::{DMat3, DVec2, DVec3};
use serde::{Deserialize, Serialize};
use std::path::Path;
use std::sync::Arc;

/// A shape; lengths in scene units.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
#[allow(
    missing_docs,
    reason = "the names are those of the shapes' own constructors, which say their meaning"
)]
pub enum ShapeFile {
    Sphere {
        center: [f64; 3],
        radius: Positive,
    },
    Rectangle {
        corner: [f64; 3],
        u: [f64; 3],
        v: [f64; 3],
    },
    Slab {
        top: f64,
        thickness: Positive,
    },
    Cuboid {
        min: [f64; 3],
        max: [f64; 3],
    },
    /// Triangles from an OBJ or PLY file, scaled, turned about the origin, then moved.
    Mesh {
        file: String,
        #[serde(default = "one", skip_serializing_if = "is_one")]
        scale: Positive,
        #[serde(default, skip_serializing_if = "Option::is_none")]
        rotate: Option<RotateFile>,
        #[serde(default, skip_serializing_if = "is_zero", alias = "translate")]
        at: [f64; 3],
        #[serde(default, skip_serializing_if = "NormalsFile::is_flat")]
        normals: NormalsFile,
    },
    /// A profile of (radius, height), turned about the axis; `smooth` pieces between its points.
    #[serde(alias = "surface-of-revolution")]
    Lathe {
        #[serde(default, skip_serializing_if = "is_zero")]
        base: [f64; 3],
        #[serde(default = "upwards")]
        axis: [f64; 3],
        profile: Vec<[f64; 2]>,
        #[serde(default = "one_piece", skip_serializing_if = "is_one_piece")]
        smooth: u32,
    },
    /// Heights over a rectangle of ground, added to `level`; closed by walls and a bottom with a `floor`.
    HeightField {
        corner: [f64; 2],
        size: [f64; 2],
        cells: [usize; 2],
        #[serde(default)]
        up: Up,
        #[serde(default)]
        level: f64,
        heights: HeightsFile,
        #[serde(default, skip_serializing_if = "Option::is_none")]
        floor: Option<f64>,
    },
}

/// Which normals light scatters about on a mesh.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum NormalsFile {
    /// Those of the triangles.
    #[default]
    Flat,
    /// Those of the file, interpolated.
    Smooth,
}

impl NormalsFile {
    fn is_flat(&self) -> bool {
        *self == NormalsFile::Flat
    }
}

/// A turn about an axis through the origin, counterclockwise seen against it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RotateFile {
    /// The axis, of any length but 0.
    pub axis: [f64; 3],
    /// The angle \[degrees\].
    pub degrees: f64,
}

impl RotateFile {
    /// The columns of the matrix: R p = cos p + sin (a x p) + (1 - cos) a (a . p).
    fn matrix(&self) -> Result<DMat3> {
        let Some(a) = DVec3::from(self.axis).try_normalize() else {
            return Err(Error::Scene("rotate: axis needs a finite direction other than 0 0 0".into()));
        };
        if self.degrees.is_nan() || self.degrees.abs() > 1e6 {
            return Err(Error::out_of_range("rotate.degrees", self.degrees, "-1e6 to 1e6"));
        }
        let (sin, cos) = sin_cos(self.degrees.to_radians());
        // 1 - cos of the half angle, which keeps the digits of small angles.
        let half = sin_cos(0.5 * self.degrees.to_radians()).0;
        let column = |e: DVec3| cos * e + sin * a.cross(e) + 2.0 * half * half * a.dot(e) * a;
        Ok(DMat3::from_cols(column(DVec3::X), column(DVec3::Y), column(DVec3::Z)))
    }
}

/// Where the heights of a field come from.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
#[allow(missing_docs, reason = "the names are those of `geometry::Waves` and `geometry::listed`")]
pub enum HeightsFile {
    /// Rows along the first axis, from edge to edge.
    Rows(Vec<Vec<f64>>),
    /// Sines of random direction.
    Waves { seed: u64, count: u32, wavelength: Positive, rms: NonNegative },
}

fn one() -> Positive {
    Positive::ONE
}

fn is_one(scale: &Positive) -> bool {
    scale.get() == 1.0
}

fn is_zero(at: &[f64; 3]) -> bool {
    *at == [0.0; 3]
}

fn upwards() -> [f64; 3] {
    [0.0, 0.0, 1.0]
}

fn one_piece() -> u32 {
    1
}

fn is_one_piece(pieces: &u32) -> bool {
    *pieces == 1
}

/// Sines that heights are sums of: more take seconds.
const MOST_SINES: f64 = (1u64 << 26) as f64;

/// Pieces that a profile is cut into: more take gigabytes.
const MOST_PIECES: f64 = (1u64 << 20) as f64;

impl ShapeFile {
    pub(super) fn shape(&self, folder: &Path) -> Result<Shape> {
        Ok(match *self {
            ShapeFile::Sphere { center, radius } => Shape::Sphere(Sphere::new(center.into(), radius.get())?),
            ShapeFile::Rectangle { corner, u, v } => Shape::Rectangle(rectangle(corner, u, v)?),
            ShapeFile::Slab { top, thickness } => Shape::Slab(Slab::new(top, thickness.get())?),
            ShapeFile::Cuboid { min, max } => Shape::Cuboid(Cuboid::new(min.into(), max.into())?),
            ShapeFile::Mesh { ref file, scale, rotate, at, normals } => {
                let at = DVec3::from(at);
                let turn = rotate.map(|rotate| rotate.matrix()).transpose()?;
                let place = |p: DVec3| {
                    let p = p * scale.get();
                    turn.map_or(p, |turn| turn * p) + at
                };
                // Scaled alike along all axes, normals turn as the body does.
                let turned = |normal: DVec3| turn.map_or(normal, |turn| turn * normal);
                let is_smooth = normals == NormalsFile::Smooth;
                let path = folder.join(file);
                let mesh = Mesh::read(&path, place, is_smooth.then_some(&turned as _))?;
                if is_smooth && !mesh.is_smooth() {
                    return Err(Error::Scene(format!(
                        "normals: {} has none at its corners, which \"smooth\" needs; allowed: \"flat\"",
                        path.display()
                    )));
                }
                Shape::Mesh(Arc::new(mesh))
            }
            ShapeFile::Lathe { base, axis, ref profile, smooth: pieces } => {
                if !(1..=1000).contains(&pieces) {
                    return Err(Error::out_of_range("smooth", f64::from(pieces), "1 to 1000"));
                }
                let all = f64::from(pieces) * profile.len() as f64;
                if all > MOST_PIECES {
                    return Err(Error::out_of_range(
                        "smooth times the points of the profile",
                        all,
                        "at most 2^20",
                    ));
                }
                let points: Vec<DVec2> = profile.iter().map(|p| DVec2::from_array(*p)).collect();
                Shape::Revolution(Arc::new(Revolution::new(
                    base.into(),
                    axis.into(),
                    &smooth(&points, pieces),
                )?))
            }
            ShapeFile::HeightField { corner, size, cells, up, level, ref heights, floor } => {
                let ground = Ground { corner: corner.into(), size: size.into(), cells };
                Shape::Mesh(Arc::new(match heights {
                    HeightsFile::Rows(rows) => {
                        let height = listed(&ground, rows)?;
                        height_field(&ground, up, floor, |p| level + height(p))?
                    }
                    HeightsFile::Waves { seed, count, wavelength, rms } => {
                        let waves = Waves::new(*seed, *count, wavelength.get(), rms.get())?;
                        let sines =
                            cells.iter().fold(f64::from(*count), |sines, cells| sines * *cells as f64);
                        if sines > MOST_SINES {
                            return Err(Error::out_of_range(
                                "count times the cells",
                                sines,
                                "at most 2^26 = 67108864",
                            ));
                        }
                        height_field(&ground, up, floor, |p| level + waves.height(p))?
                    }
                }))
            }
        })
    }
}
