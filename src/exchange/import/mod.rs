//! A scene of Mitsuba 3 as a scene file: what it says that turbid can say, the rest refused with file and line.

mod bodies;
mod document;
mod importer;
mod lights;
mod media;
mod part;

use super::Beside;
use crate::error::Result;
use crate::geometry::Shape;
use crate::light::Faces;
use crate::math::{Albedo, Asymmetry, Index, NonNegative, Positive};
use crate::scene::{
    Channels, DielectricFile, InteriorFile, LightFile, ObjectFile, RegionFile, SceneFile, ShapeFile,
    SurfaceFile,
};
use document::{Element, shown};
use glam::DVec3;
use importer::{Boundary, Filled, Importer, Inner};
use media::MediumKeys;
use part::{Ids, Part};
use std::path::{Path, PathBuf};

/// A scene file made of a scene of Mitsuba.
#[derive(Debug, Clone, PartialEq)]
pub struct Imported {
    /// The scene.
    pub scene: SceneFile,
    /// Files that it names, in its own folder.
    pub files: Vec<Beside>,
    /// Files that were read for it.
    pub read: Vec<PathBuf>,
    /// What is not quite the same.
    pub notes: Vec<String>,
}

fn is_same(a: Option<&Element>, b: Option<&Element>) -> bool {
    match (a, b) {
        (Some(a), Some(b)) => std::ptr::eq(a, b),
        (None, None) => true,
        _ => false,
    }
}

/// What messages call a medium.
fn called(medium: Option<&Element>) -> String {
    medium.map_or("no medium".into(), |m| {
        format!("medium `{}`", shown(m.attribute("id").unwrap_or("without id")))
    })
}

fn collect_ids<'a>(element: &'a Element, ids: &mut Ids<'a>) -> Result<()> {
    if element.tag != "ref"
        && let Some(id) = element.attribute("id")
        && ids.insert(id, element).is_some()
    {
        return element.refuse(format!("two elements have the id `{}`; allowed: one", shown(id)));
    }
    element.children.iter().try_for_each(|child| collect_ids(child, ids))
}

/// Integrators that follow all light through media.
const WHOLE: [&str; 2] = ["volpath", "volpathmis"];

/// Index of air, as Mitsuba has it.
const AIR: f64 = 1.000277;

/// Reads a scene of Mitsuba 3. Names of files that the scene file is to have beside it begin with `stem`; `given` are values of
/// parameters, `$name`; a confined scene names files in its own folder alone.
///
/// # Errors
/// `Error::Scene` with file and line, for what is no such scene, and for what turbid cannot say
pub fn from_mitsuba(
    path: &Path,
    stem: &str,
    given: &[(String, String)],
    is_confined: bool,
) -> Result<Imported> {
    let (root, read) = document::read(path, given, is_confined)?;
    let mut ids = Ids::new();
    collect_ids(&root, &mut ids)?;
    let folder = path.parent().map(Path::to_path_buf).unwrap_or_default();
    let mut importer = Importer {
        ids: &ids,
        folder: &folder,
        stem,
        is_confined,
        files: Vec::new(),
        read,
        notes: Vec::new(),
        camera: None,
        camera_place: None,
        camera_medium: None,
        lights: Vec::new(),
        around: None,
        objects: Vec::new(),
        opaque: Vec::new(),
        boundaries: Vec::new(),
        is_two_sided: false,
        one_sided: 0,
        regions: Vec::new(),
        inner: Vec::new(),
        filled: Vec::new(),
    };
    for element in &root.children {
        importer.top(element)?;
    }
    importer.finish()
}

impl<'a> Importer<'a> {
    fn top(&mut self, element: &'a Element) -> Result<()> {
        match element.tag.as_str() {
            "sensor" => self.sensor(element),
            "emitter" => self.emitter(element),
            "shape" => self.shape(element),
            // Where something refers to them.
            "bsdf" | "medium" | "phase" | "volume" | "texture" | "film" | "sampler" | "rfilter" => Ok(()),
            "integrator" => {
                let part = Part::new(element, self.ids)?;
                if part.float("max_depth")?.is_some_and(|depth| depth >= 0.0) {
                    self.notes.push(format!("{}: max_depth is left out, paths have no end here", element.place()));
                }
                if part.flag("hide_emitters")? == Some(true) {
                    self.notes.push(format!("{}: hide_emitters is left out, the camera sees lamps here", element.place()));
                }
                let kind = element.attribute("type").unwrap_or_default();
                if !WHOLE.contains(&kind) {
                    self.notes.push(format!(
                        "{}: the integrator `{}` is left out; scenes are rendered with all light and media, as {} do",
                        element.place(),
                        shown(kind),
                        WHOLE.join(" and ")
                    ));
                }
                Ok(())
            }
            _ => element.refuse(format!(
                "{} is not imported; allowed: sensor, emitter, shape, bsdf, medium, integrator, default, include",
                element.name()
            )),
        }
    }

    /// The medium at a point, as boundaries say it.
    fn medium_at(&self, p: DVec3) -> Option<&'a Element> {
        match self.inner_at(p) {
            Some(inner) => self.filled[inner.filled].medium,
            None => self
                .regions
                .iter()
                .rev()
                .find(|(shape, ..)| shape.contains(p))
                .and_then(|(.., medium)| *medium),
        }
    }

    /// The innermost boundary with an inside of its own about a point: they are kept the larger first.
    fn inner_at(&self, p: DVec3) -> Option<&Inner> {
        self.inner.iter().rev().find(|inner| inner.shape.is_closed() && inner.shape.contains(p))
    }

    /// The number of the interior of this index and medium.
    fn filled(&mut self, index: f64, medium: Option<&'a Element>) -> usize {
        if let Some(known) = self.filled.iter().position(|f| f.index == index && is_same(f.medium, medium)) {
            return known;
        }
        let id = medium.and_then(|medium| medium.attribute("id"));
        let plain = id.map_or_else(|| format!("index-{index}"), str::to_string);
        let mut name = plain.clone();
        let mut count = 1;
        while name == "surroundings" || self.filled.iter().any(|f| f.name == name) {
            count += 1;
            name = format!("{plain}-{count}");
        }
        self.filled.push(Filled { name, index, medium });
        self.filled.len() - 1
    }

    /// Says of every boundary what lies on its sides, the larger ones first.
    fn name_sides(&mut self) -> Result<()> {
        let mut boundaries = std::mem::take(&mut self.boundaries);
        let outer = boundaries.iter().filter_map(|b| b.indices).map(|[_, outside]| outside);
        let has = |index: f64| move |other: f64| other == index;
        let is_in_air = outer.clone().any(has(AIR)) && !outer.clone().any(has(1.0));
        let ambient = if is_in_air { AIR } else { 1.0 };
        let size = |b: &Boundary| if b.shape.is_closed() { b.shape.volume().abs() } else { f64::INFINITY };
        boundaries.sort_by(|a, b| size(b).total_cmp(&size(a)));
        for Boundary { element, file, shape, indices, media } in boundaries {
            let (p, ..) = shape.sample_surface([0.37, 0.41, 0.53]);
            let place = self.medium_at(p);
            let about = self.inner_at(p).map(|inner| inner.filled);
            let around = about.map_or(1.0, |filled| self.filled[filled].index);
            // Where neither side is named, light keeps the medium that it is in.
            let media = if media.iter().all(Option::is_none) { [place, place] } else { media };
            let [inside, outside] =
                indices.map_or([around; 2], |indices| indices.map(|index| index / ambient));
            let is_apart = about.is_none() && outside != 1.0;
            if !is_apart && !is_same(media[1], place) {
                return element.refuse(format!(
                    "its exterior is {}, but it lies in {}; allowed: the same",
                    called(media[1]),
                    called(place)
                ));
            }
            if indices.is_none() && about.is_none() && shape.is_solid() {
                self.regions.push((shape, file, media[0]));
                continue;
            }
            let outer = match about {
                Some(filled) if (outside - around).abs() > 1e-9 => {
                    let name = &self.filled[filled].name;
                    return element.refuse(format!(
                        "ext_ior is {outside}, but it lies in `{}` of index {around}; allowed: the same",
                        shown(name)
                    ));
                }
                Some(filled) => Some(filled),
                None if outside == 1.0 => None,
                None => Some(self.filled(outside, media[1])),
            };
            let filled = self.filled(inside, media[0]);
            let name = |number: usize| self.filled[number].name.clone();
            let surface = DielectricFile {
                inside: name(filled),
                outside: outer.map_or_else(|| "surroundings".into(), name),
            };
            if surface.inside == surface.outside {
                self.notes.push(format!("{}: a boundary between alike is left out", element.place()));
                continue;
            }
            self.objects.push(ObjectFile { shape: file, surface: SurfaceFile::Dielectric(surface) });
            self.inner.push(Inner { shape, filled });
        }
        Ok(())
    }

    /// The shape of what is there of a medium that ends at a box.
    fn clipped(
        &self,
        shape: &Shape,
        file: ShapeFile,
        keys: &MediumKeys,
        element: &Element,
    ) -> Result<ShapeFile> {
        let Some((min, max)) = keys.extent else { return Ok(file) };
        let size = (max - min).max_element();
        let is_within = shape.corners().is_some_and(|(low, high)| {
            low.cmpge(min - 1e-6 * size).all() && high.cmple(max + 1e-6 * size).all()
        });
        let corner = |i: usize| DVec3::select(glam::BVec3::new(i & 1 > 0, i & 2 > 0, i & 4 > 0), max, min);
        if is_within {
            Ok(file)
        } else if (0..8).all(|i| shape.contains(corner(i))) {
            Ok(ShapeFile::Cuboid { min: min.to_array(), max: max.to_array() })
        } else {
            element
                .refuse("a grid that ends within the shape that it fills; allowed: either within the other")
        }
    }

    fn finish(mut self) -> Result<Imported> {
        self.name_sides()?;
        if let (Some(camera), Some(element)) = (&self.camera, self.camera_place) {
            let place = self.medium_at(camera.position.into());
            if !is_same(place, self.camera_medium) {
                return element.refuse(format!(
                    "the sensor lies in {}, but names {}; allowed: the same",
                    called(place),
                    called(self.camera_medium)
                ));
            }
        }
        for (element, shape, medium) in &self.opaque {
            let place = self.medium_at(shape.sample_surface([0.37, 0.41, 0.53]).0);
            if medium.is_some() && !is_same(*medium, place) {
                return element.refuse(format!(
                    "its exterior is {}, but it lies in {}; allowed: the same",
                    called(*medium),
                    called(place)
                ));
            }
        }
        if self.one_sided > 0 {
            let text = format!(
                "{} diffuse surfaces without twosided are black behind in Mitsuba, and reflect on both sides here",
                self.one_sided
            );
            self.notes.push(text);
        }
        let mut scene = SceneFile { camera: self.camera, ..SceneFile::default() };
        if let Some((_, radiance)) = self.around {
            self.lights.push(LightFile::Isotropic { shape: self.about_all()?, faces: Faces::Both, radiance });
        }
        for (index, (shape, file, medium)) in std::mem::take(&mut self.regions).into_iter().enumerate() {
            let region = match medium {
                Some(element) => {
                    let keys = self.medium_keys(element)?;
                    let shape = self.clipped(&shape, file, &keys, element)?;
                    region(shape, keys)
                }
                // A hole, if there is something that it can be in.
                None if index > 0 => hole(file)?,
                None => continue,
            };
            scene.regions.push(region);
        }
        for Filled { name, index, medium } in std::mem::take(&mut self.filled) {
            let keys = medium.map(|element| self.medium_keys(element)).transpose()?;
            if let (Some(MediumKeys { extent: Some((min, max)), .. }), Some(element)) = (&keys, medium) {
                let fills = |inner: &&Inner| {
                    inner.shape.corners().is_none_or(|(low, high)| {
                        low.cmplt(*min - 1e-6).any() || high.cmpgt(*max + 1e-6).any()
                    })
                };
                if self.inner.iter().any(|inner| fills(&inner)) {
                    return element
                        .refuse("a grid that ends within the shape that it fills; allowed: a larger one");
                }
            }
            scene.interiors.push(interior(name, index, keys)?);
        }
        scene.objects = self.objects;
        scene.lights = self.lights;
        Ok(Imported { scene, files: self.files, read: self.read, notes: self.notes })
    }

    /// A sphere about all there is.
    fn about_all(&self) -> Result<ShapeFile> {
        let shapes = self.opaque.iter().map(|(_, shape, _)| shape);
        let shapes = shapes.chain(self.regions.iter().map(|(shape, ..)| shape));
        let boxes = shapes.chain(self.inner.iter().map(|inner| &inner.shape)).filter_map(Shape::corners);
        let eye = self.camera.map(|camera| DVec3::from(camera.position)).map(|p| (p, p));
        let all = boxes.chain(eye).reduce(|(low, high), (min, max)| (low.min(min), high.max(max)));
        let (low, high) = all.unwrap_or((DVec3::ZERO, DVec3::ZERO));
        let radius = 0.55 * low.distance(high) + f64::from(u8::from(low == high));
        Ok(ShapeFile::Sphere {
            center: (0.5 * (low + high)).to_array(),
            radius: Positive::new("radius of all there is", radius)?,
        })
    }
}

fn region(shape: ShapeFile, keys: MediumKeys) -> RegionFile {
    RegionFile {
        shape,
        sigma_t: Some(keys.sigma_t),
        albedo: Some(keys.albedo),
        sigma_a: None,
        sigma_s: None,
        albedo_grid: keys.albedo_grid,
        g: keys.g,
        phase: keys.phase,
        emission: None,
        emission_by_density: None,
        density: keys.density,
    }
}

/// A region of nothing.
fn hole(shape: ShapeFile) -> Result<RegionFile> {
    let keys = MediumKeys {
        sigma_t: Channels([NonNegative::try_from(0.0)?; 3]),
        albedo: Channels([Albedo::try_from(0.0)?; 3]),
        g: Some(Asymmetry::try_from(0.0)?),
        phase: None,
        density: None,
        albedo_grid: None,
        extent: None,
    };
    Ok(region(shape, keys))
}

fn interior(name: String, index: f64, keys: Option<MediumKeys>) -> Result<InteriorFile> {
    let index = Index::new(&format!("index of `{}`", shown(&name)), index)?;
    let plain = InteriorFile {
        name,
        index,
        sigma_t: None,
        albedo: None,
        sigma_a: None,
        sigma_s: None,
        albedo_grid: None,
        g: None,
        phase: None,
        emission: None,
        emission_by_density: None,
        density: None,
    };
    let Some(keys) = keys else { return Ok(plain) };
    Ok(InteriorFile {
        sigma_t: Some(keys.sigma_t),
        albedo: Some(keys.albedo),
        albedo_grid: keys.albedo_grid,
        g: keys.g,
        phase: keys.phase,
        density: keys.density,
        ..plain
    })
}
