//! Meshes from files.

use super::{Mesh, obj, ply};
use crate::error::{Error, Result};
use glam::DVec3;
use std::path::Path;

/// Larger files are refused: some 10 million triangles.
const MOST_BYTES: u64 = 1 << 30;

/// Memory of a mesh over the size of its file, while it is made.
const IN_MEMORY: f64 = 10.0;

impl Mesh {
    /// A mesh from a PLY file, or from a Wavefront OBJ file of whatever other name, each position where `place` puts it.
    /// Polygons are cut into triangles; materials are passed over, and normals where nothing is to `turn` them. A file without
    /// normals is a flat mesh.
    ///
    /// # Errors     `Error::Scene` with file and place for what cannot be read
    pub fn read(
        path: &Path,
        place: impl Fn(DVec3) -> DVec3,
        turn: Option<&dyn Fn(DVec3) -> DVec3>,
    ) -> Result<Self> {
        let name = path.display();
        let refuse = |what: String| Error::Scene(format!("{name}: {what}"));
        let bytes = crate::input::read(path, MOST_BYTES).map_err(|e| refuse(e.to_string()))?;
        let what = || format!("a mesh of {} bytes", bytes.len());
        crate::memory::check(what, IN_MEMORY * bytes.len() as f64).map_err(|e| refuse(e.to_string()))?;
        if path.extension().is_some_and(|e| e.eq_ignore_ascii_case("ply")) {
            return ply::parse(&bytes, place, turn).map_err(|e| refuse(e.to_string()));
        }
        obj::read(&name.to_string(), &String::from_utf8_lossy(&bytes), place, turn)
    }
}
