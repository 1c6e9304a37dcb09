//! The exact fluence of a sphere, quick to ask at any depth.

use super::Exact;
use turbid_analytic::{Sphere, SphereSource};

/// The exact fluence of all orders against the depth below the surface, isotropic scattering; a uniform source has the
/// power 1 in all.
pub fn sphere_fluence(radius: f64, albedo: f64, source: SphereSource) -> anyhow::Result<Exact> {
    let sphere = Sphere::new(radius, albedo, source)?;
    Ok(Box::new(move |depth| {
        // A depth may be beyond the centre by a rounding.
        let from_centre = (radius - depth).clamp(0.0, radius);
        sphere.fluence_interpolated(from_centre).map(|v| (v.value, v.error)).map_err(Into::into)
    }))
}
