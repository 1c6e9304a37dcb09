//! Shapes with what they are made of.

use super::document::Element;
use super::importer::{Boundary, Importer, Sides, channels, light_channels, refuse_negative};
use super::part::Part;
use crate::Spectrum;
use crate::error::Result;
use crate::geometry::Rectangle;
use crate::geometry::{Cuboid, Mesh, Revolution, Shape, Sphere};
use crate::math::{Albedo, Positive};
use crate::scene::{LightFile, NormalsFile, ObjectFile, ShapeFile, SurfaceFile, TextureFile};
use glam::{DVec2, DVec3};
use std::sync::Arc;

/// How a shape scatters.
enum Material {
    Surface(SurfaceFile),
    Dielectric([f64; 2]),
    Null,
}

/// Indices that Mitsuba knows by name (its documentation of `dielectric`).
const INDICES: [(&str, f64); 17] = [
    ("vacuum", 1.0),
    ("helium", 1.000036),
    ("hydrogen", 1.000132),
    ("air", 1.000277),
    ("carbon dioxide", 1.00045),
    ("water", 1.3330),
    ("acetone", 1.36),
    ("ethanol", 1.361),
    ("carbon tetrachloride", 1.461),
    ("glycerol", 1.4729),
    ("benzene", 1.501),
    ("silicone oil", 1.52045),
    ("bromine", 1.661),
    ("water ice", 1.31),
    ("fused quartz", 1.458),
    ("bk7", 1.5046),
    ("diamond", 2.419),
];

/// Bodies in each other, at most: scattering functions that stand in scattering functions.
const DEEPEST: usize = 4;

impl<'a> Importer<'a> {
    pub(super) fn shape(&mut self, element: &'a Element) -> Result<()> {
        let part = Part::new(element, self.ids)?;
        let is_flipped = part.flag("flip_normals")?.unwrap_or(false);
        let (file, shape) = self.form(&part, is_flipped)?;
        let mut media: Sides = [None, None];
        for (name, medium) in part.parts("medium")? {
            match name {
                Some("interior") => media[0] = Some(medium),
                Some("exterior") => media[1] = Some(medium),
                _ => return part.refuse("a medium without a name; allowed: interior, exterior"),
            }
        }
        let bsdf = part.part("bsdf")?;
        let emitter = part.part("emitter")?;
        part.finish()?;
        if let Some(emitter) = emitter {
            let light = Part::new(emitter, self.ids)?;
            if light.kind() != "area" {
                return light
                    .refuse(format!("an emitter of type `{}` in a shape; allowed: area", light.kind()));
            }
            let radiance = light.color("radiance")?.map_or(Spectrum::ONE, |color| color.of_light());
            light.finish()?;
            let material = bsdf.map(|bsdf| self.material(bsdf, 0)).transpose()?;
            let is_black = is_black(material.as_ref());
            if !is_black {
                self.notes.push(format!(
                    "{}: what the lamp's surface reflects is left out, lamps are black",
                    element.place()
                ));
            }
            self.opaque.push((element, shape, media[1]));
            let radiance = light_channels(emitter, "radiance", radiance)?;
            self.lights.push(LightFile::Area { shape: file, radiance });
            return Ok(());
        }
        let material = match bsdf {
            Some(bsdf) => self.material(bsdf, 0)?,
            // Mitsuba's own.
            None => Material::Surface(SurfaceFile::Lambertian {
                reflectance: lambertian(element, Spectrum::grey(0.5))?,
            }),
        };
        match material {
            Material::Surface(surface) => {
                self.opaque.push((element, shape, media[1]));
                self.objects.push(ObjectFile { shape: file, surface });
            }
            Material::Dielectric(indices) => {
                self.boundaries.push(Boundary { element, file, shape, indices: Some(indices), media });
            }
            Material::Null if media.iter().all(Option::is_none) => {
                self.notes.push(format!("{}: a surface that does nothing is left out", element.place()));
            }
            Material::Null => self.boundaries.push(Boundary { element, file, shape, indices: None, media }),
        }
        Ok(())
    }

    /// A scattering function.
    fn material(&mut self, element: &'a Element, depth: usize) -> Result<Material> {
        let part = Part::new(element, self.ids)?;
        if depth > DEEPEST {
            return part.refuse(format!(
                "more than {DEEPEST} scattering functions in each other, which are allowed"
            ));
        }
        let material = match part.kind() {
            "twosided" => {
                let inner = part.parts("bsdf")?;
                let [(_, inner)] = inner[..] else {
                    return part
                        .refuse(format!("twosided of {}; allowed: one scattering function", inner.len()));
                };
                self.is_two_sided = true;
                let material = self.material(inner, depth + 1)?;
                self.is_two_sided = false;
                material
            }
            "diffuse" => {
                let reflectance =
                    part.color("reflectance")?.map_or(Spectrum::grey(0.5), |color| color.of_matter());
                if !self.is_two_sided && !reflectance.is_black() {
                    self.one_sided += 1;
                }
                Material::Surface(SurfaceFile::Lambertian { reflectance: lambertian(element, reflectance)? })
            }
            "conductor" => {
                if part.string("material")? != Some("none") {
                    return part.refuse("a conductor of some material; allowed: material none, a mirror");
                }
                let reflectance =
                    part.color("specular_reflectance")?.map_or(Spectrum::ONE, |color| color.of_matter());
                let reflectance = channels(reflectance, |x| Albedo::new("specular_reflectance", x));
                Material::Surface(SurfaceFile::Mirror {
                    reflectance: reflectance.map_err(|e| element.error(e))?,
                })
            }
            "dielectric" => {
                for name in ["specular_reflectance", "specular_transmittance"] {
                    if part.color(name)?.is_some_and(|color| color.of_matter() != Spectrum::ONE) {
                        return part.refuse(format!("{name} of a dielectric; allowed: 1"));
                    }
                }
                Material::Dielectric([index(&part, "int_ior", "bk7")?, index(&part, "ext_ior", "air")?])
            }
            "null" => Material::Null,
            "mask" => {
                let inner = part.part("bsdf")?;
                let opacity = part.float("opacity")?.unwrap_or(0.5);
                let inner = inner.map(|inner| self.material(inner, depth + 1)).transpose()?;
                if !is_black(inner.as_ref()) {
                    return part.refuse(
                        "a mask over what reflects; allowed: over a diffuse surface of reflectance 0",
                    );
                }
                let passed = lambertian(element, Spectrum::grey(1.0 - opacity))?;
                Material::Surface(SurfaceFile::Filter { transmittance: passed })
            }
            other => {
                return part.refuse(format!(
                    "a scattering function of type `{other}` is not imported; allowed: diffuse, twosided, dielectric, null, conductor of material none, mask"
                ));
            }
        };
        part.finish()?;
        Ok(material)
    }

    /// A shape, as scene files say it and as it is.
    fn form(&mut self, part: &Part<'a>, is_flipped: bool) -> Result<(ShapeFile, Shape)> {
        let element = part.element;
        let at = |e: crate::Error| element.error(e);
        let transform = part.transform("to_world")?;
        match part.kind() {
            "rectangle" => {
                let corner = transform.point(DVec3::new(-1.0, -1.0, 0.0));
                let (mut u, mut v) = (transform.vector(2.0 * DVec3::X), transform.vector(2.0 * DVec3::Y));
                if is_flipped {
                    (u, v) = (v, u);
                }
                match Rectangle::new(corner, u, v) {
                    Ok(rectangle) => Ok((
                        ShapeFile::Rectangle { corner: corner.to_array(), u: u.to_array(), v: v.to_array() },
                        Shape::Rectangle(rectangle),
                    )),
                    // A parallelogram.
                    Err(_) => self.mesh(
                        element,
                        &[corner, corner + u, corner + u + v, corner + v],
                        &[[0, 1, 2], [0, 2, 3]],
                    ),
                }
            }
            "disk" => {
                let Some(scale) = transform.even_scale() else {
                    return part
                        .refuse("to_world of a disk is skewed; allowed: the same scale along all axes");
                };
                let axis = transform.vector(DVec3::Z) / scale * if is_flipped { -1.0 } else { 1.0 };
                let base = transform.point(DVec3::ZERO);
                // Outwards is to the right of the way: inwards on the upper side.
                let profile = vec![[scale, 0.0], [0.0, 0.0]];
                let points: Vec<DVec2> = profile.iter().map(|p| DVec2::from_array(*p)).collect();
                let shape = Revolution::new(base, axis, &points).map_err(at)?;
                Ok((
                    ShapeFile::Lathe { base: base.to_array(), axis: axis.to_array(), profile, smooth: 1 },
                    Shape::Revolution(Arc::new(shape)),
                ))
            }
            _ if is_flipped => {
                part.refuse("flip_normals of a shape other than rectangle and disk; allowed: false")
            }
            "sphere" => {
                let Some(scale) = transform.even_scale() else {
                    return part
                        .refuse("to_world of a sphere is skewed; allowed: the same scale along all axes");
                };
                let center = transform.point(part.vector("center")?.unwrap_or(DVec3::ZERO));
                let radius = scale * part.float("radius")?.unwrap_or(1.0);
                let sphere = Sphere::new(center, radius).map_err(at)?;
                let radius = Positive::new("radius", radius).map_err(at)?;
                Ok((ShapeFile::Sphere { center: center.to_array(), radius }, Shape::Sphere(sphere)))
            }
            "cube" => {
                if let Some((scale, middle)) = transform.along_axes() {
                    let (min, max) = (middle - scale, middle + scale);
                    let cuboid = Cuboid::new(min, max).map_err(at)?;
                    return Ok((
                        ShapeFile::Cuboid { min: min.to_array(), max: max.to_array() },
                        Shape::Cuboid(cuboid),
                    ));
                }
                let sign = |bit: usize| if bit > 0 { 1.0 } else { -1.0 };
                let corners: Vec<DVec3> = (0..8usize)
                    .map(|i| transform.point(DVec3::new(sign(i & 1), sign(i & 2), sign(i & 4))))
                    .collect();
                // Counterclockwise seen from outside.
                let faces =
                    [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
                let triangles: Vec<[u32; 3]> =
                    faces.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]).collect();
                self.mesh(element, &corners, &triangles)
            }
            "obj" | "ply" => {
                let Some(file) = part.string("filename")? else {
                    return part.refuse("a mesh without filename; allowed: one");
                };
                part.pass_over(&["flip_tex_coords"]);
                let is_flat = part.flag("face_normals")? == Some(true);
                let path = self.path(element, file)?;
                let is_ply = path.extension().is_some_and(|e| e.eq_ignore_ascii_case("ply"));
                if is_ply != (part.kind() == "ply") {
                    return part
                        .refuse(format!("a shape of type `{}` of a file of another kind", part.kind()));
                }
                let turn = |normal: DVec3| transform.normal(normal);
                let turn = (!is_flat).then_some(&turn as &dyn Fn(DVec3) -> DVec3);
                let mesh = Mesh::read(&path, |p| transform.point(p), turn).map_err(at)?;
                if !is_flat && !mesh.is_smooth() {
                    self.notes.push(format!(
                        "{}: its file has no normals, and facets are flat; Mitsuba makes normals of its own",
                        element.place()
                    ));
                }
                Ok(self.written(mesh))
            }
            other => part.refuse(format!(
                "a shape of type `{other}` is not imported; allowed: rectangle, cube, sphere, disk, obj, ply"
            )),
        }
    }

    fn mesh(
        &mut self,
        element: &Element,
        corners: &[DVec3],
        triangles: &[[u32; 3]],
    ) -> Result<(ShapeFile, Shape)> {
        let mesh = Mesh::new(corners, triangles, None).map_err(|e| element.error(e))?;
        Ok(self.written(mesh))
    }

    /// A mesh in a file of its own.
    fn written(&mut self, mesh: Mesh) -> (ShapeFile, Shape) {
        let file = self.beside("mesh", "ply", mesh.to_ply());
        let normals = if mesh.is_smooth() { NormalsFile::Smooth } else { NormalsFile::Flat };
        (
            ShapeFile::Mesh { file, scale: Positive::ONE, rotate: None, at: [0.0; 3], normals },
            Shape::Mesh(Arc::new(mesh)),
        )
    }
}

/// Whether a material reflects nothing.
fn is_black(material: Option<&Material>) -> bool {
    let Some(Material::Surface(SurfaceFile::Lambertian { reflectance: TextureFile::Constant(channels) })) =
        material
    else {
        return false;
    };
    channels.0.iter().all(|channel| channel.get() == 0.0)
}

fn lambertian(element: &Element, reflectance: Spectrum) -> Result<TextureFile> {
    refuse_negative(element, "reflectance", reflectance)?;
    let channels = channels(reflectance, |x| Albedo::new("reflectance", x)).map_err(|e| element.error(e))?;
    Ok(TextureFile::Constant(channels))
}

/// An index of refraction: a number, or the name of a material.
fn index(part: &Part, name: &str, otherwise: &str) -> Result<f64> {
    let word = match part.named(name) {
        Some(child) if child.tag == "string" => child.attribute("value").unwrap_or_default(),
        Some(_) => return Ok(part.float(name)?.unwrap_or_default()),
        None => otherwise,
    };
    match INDICES.iter().find(|(known, _)| *known == word) {
        Some((_, index)) => Ok(*index),
        None => {
            let known: Vec<&str> = INDICES.iter().map(|(known, _)| *known).collect();
            part.refuse(format!(
                "{name} is `{}`; allowed: a number, {}",
                super::document::shown(word),
                known.join(", ")
            ))
        }
    }
}
