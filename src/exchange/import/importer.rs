//! A scene as far as it has been read.

use super::document::{Element, check_inside};
use super::part::Ids;
use crate::Spectrum;
use crate::error::Result;
use crate::exchange::Beside;
use crate::geometry::Shape;
use crate::math::NonNegative;
use crate::scene::{CameraFile, Channels, LightFile, ObjectFile, ShapeFile};
use std::path::{Path, PathBuf};

/// What lies on the two sides of a surface: media, by their elements.
pub(super) type Sides<'a> = [Option<&'a Element>; 2];

/// A boundary that light crosses, whose sides are to be named once all of them are known.
pub(super) struct Boundary<'a> {
    pub element: &'a Element,
    pub file: ShapeFile,
    pub shape: Shape,
    /// Inside and outside; none where light passes straight on.
    pub indices: Option<[f64; 2]>,
    pub media: Sides<'a>,
}

/// What fills the space inside of a boundary.
pub(super) struct Filled<'a> {
    pub name: String,
    pub index: f64,
    pub medium: Option<&'a Element>,
}

/// A boundary whose inner side has a name.
pub(super) struct Inner {
    pub shape: Shape,
    pub filled: usize,
}

/// What has been read so far.
pub(super) struct Importer<'a> {
    pub ids: &'a Ids<'a>,
    pub folder: &'a Path,
    pub stem: &'a str,
    pub is_confined: bool,
    pub files: Vec<Beside>,
    /// Files that were read.
    pub read: Vec<PathBuf>,
    pub notes: Vec<String>,
    pub camera: Option<CameraFile>,
    pub camera_place: Option<&'a Element>,
    pub camera_medium: Option<&'a Element>,
    pub lights: Vec<LightFile>,
    /// Light from all around.
    pub around: Option<(&'a Element, Channels<NonNegative>)>,
    pub objects: Vec<ObjectFile>,
    /// Bodies that no light crosses, with the medium that each says is outside.
    pub opaque: Vec<(&'a Element, Shape, Option<&'a Element>)>,
    pub boundaries: Vec<Boundary<'a>>,
    pub is_two_sided: bool,
    /// Diffuse surfaces that are black behind.
    pub one_sided: usize,
    /// Regions, the larger first.
    pub regions: Vec<(Shape, ShapeFile, Option<&'a Element>)>,
    pub inner: Vec<Inner>,
    pub filled: Vec<Filled<'a>>,
}

/// Refuses a value below 0.
pub(super) fn refuse_negative(element: &Element, name: &str, value: Spectrum) -> Result<()> {
    if value.min() < 0.0 {
        return element.refuse(format!("{name} is {}; allowed: at least 0", value.min()));
    }
    Ok(())
}

/// A value by channel.
pub(super) fn channels<T: Copy>(value: Spectrum, make: impl Fn(f64) -> Result<T>) -> Result<Channels<T>> {
    Ok(Channels([make(value[0])?, make(value[1])?, make(value[2])?]))
}

/// A light by channel.
pub(super) fn light_channels(
    element: &Element,
    name: &str,
    value: Spectrum,
) -> Result<crate::scene::Channels<NonNegative>> {
    channels(value, |x| NonNegative::new(name, x)).map_err(|e| element.error(e))
}

impl<'a> Importer<'a> {
    /// Takes a file that is to stand beside, and says its name.
    pub fn beside(&mut self, what: &str, extension: &str, bytes: Vec<u8>) -> String {
        let name = format!("{}-{what}-{}.{extension}", self.stem, self.files.len());
        self.files.push(Beside { name: name.clone(), bytes });
        name
    }

    /// Where a file is that an element names.
    pub fn path(&mut self, element: &Element, name: &str) -> Result<PathBuf> {
        check_inside(self.is_confined, element, name, self.folder)?;
        let path = self.folder.join(name);
        self.read.push(path.clone());
        Ok(path)
    }

    /// Takes light from all around.
    pub fn light_from_around(&mut self, element: &'a Element, radiance: Channels<NonNegative>) -> Result<()> {
        if self.around.is_some() {
            return element.refuse("a second constant emitter; allowed: one");
        }
        self.around = Some((element, radiance));
        Ok(())
    }
}
