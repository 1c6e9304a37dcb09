//! Textures in the scene file.

use super::values::Channels;
use crate::error::Result;
use crate::math::{Albedo, Positive};
use crate::surface::{Checker, Image, Texture, Wood};
use serde::de::value::{MapAccessDeserializer, SeqAccessDeserializer};
use serde::de::{IntoDeserializer, MapAccess, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use std::path::Path;
use std::sync::Arc;

/// A reflectance or transmittance: a number, three numbers, or a table that says how it varies.
#[derive(Debug, Clone, PartialEq)]
pub enum TextureFile {
    /// The same everywhere.
    Constant(Channels<Albedo>),
    /// Different from place to place.
    Varying(VaryingFile),
}

/// A texture that varies.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
#[allow(
    missing_docs,
    reason = "the names are those of the textures' own constructors, which say their meaning"
)]
pub enum VaryingFile {
    Image { file: String },
    Checker { values: [Channels<Albedo>; 2], tiles: [Positive; 2] },
    Wood { values: [Channels<Albedo>; 2], center: [f64; 3], axis: [f64; 3], width: Positive },
}

impl TextureFile {
    /// The texture; errors call a constant by this name.
    pub(super) fn texture(&self, name: &'static str, folder: &Path) -> Result<Texture> {
        let varying = match self {
            TextureFile::Constant(value) => return Texture::constant(name, value.spectrum()),
            TextureFile::Varying(varying) => varying,
        };
        Ok(match varying {
            VaryingFile::Image { file } => Texture::Image(Arc::new(Image::read(&folder.join(file))?)),
            VaryingFile::Checker { values, tiles } => {
                Texture::Checker(Checker::new(values.map(Channels::spectrum), tiles.map(Positive::get))?)
            }
            VaryingFile::Wood { values, center, axis, width } => {
                let values = values.map(Channels::spectrum);
                Texture::Wood(Arc::new(Wood::new(values, (*center).into(), (*axis).into(), width.get())?))
            }
        })
    }
}

impl<'de> Deserialize<'de> for TextureFile {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> std::result::Result<Self, D::Error> {
        struct Any;
        impl<'de> Visitor<'de> for Any {
            type Value = TextureFile;
            fn expecting(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
                f.write_str("a number, three numbers, or a table `image`, `checker` or `wood`")
            }
            fn visit_f64<E: serde::de::Error>(self, v: f64) -> std::result::Result<TextureFile, E> {
                Channels::deserialize(v.into_deserializer()).map(TextureFile::Constant)
            }
            fn visit_i64<E: serde::de::Error>(self, v: i64) -> std::result::Result<TextureFile, E> {
                self.visit_f64(v as f64)
            }
            fn visit_seq<A: SeqAccess<'de>>(self, seq: A) -> std::result::Result<TextureFile, A::Error> {
                Channels::deserialize(SeqAccessDeserializer::new(seq)).map(TextureFile::Constant)
            }
            fn visit_map<A: MapAccess<'de>>(self, map: A) -> std::result::Result<TextureFile, A::Error> {
                VaryingFile::deserialize(MapAccessDeserializer::new(map)).map(TextureFile::Varying)
            }
        }
        deserializer.deserialize_any(Any)
    }
}

impl Serialize for TextureFile {
    fn serialize<S: Serializer>(&self, serializer: S) -> std::result::Result<S::Ok, S::Error> {
        match self {
            TextureFile::Constant(value) => value.serialize(serializer),
            TextureFile::Varying(varying) => varying.serialize(serializer),
        }
    }
}
