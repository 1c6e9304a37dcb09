//! Values in a scene file.

use crate::Spectrum;
use crate::error::Result;
use crate::geometry::Rectangle;
use crate::math::Positive;
use serde::de::{IntoDeserializer, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// A number for all channels, or one a channel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Channels<T>(pub [T; 3]);

impl<T: Into<f64> + Copy> Channels<T> {
    pub(super) fn spectrum(self) -> Spectrum {
        let [r, g, b] = self.0;
        Spectrum::rgb(r.into(), g.into(), b.into())
    }
}

impl<'de, T: Deserialize<'de> + Copy> Deserialize<'de> for Channels<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> std::result::Result<Self, D::Error> {
        struct Either<T>(std::marker::PhantomData<T>);
        impl<'de, T: Deserialize<'de> + Copy> Visitor<'de> for Either<T> {
            type Value = Channels<T>;
            fn expecting(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
                f.write_str("a number, or three numbers for red, green and blue")
            }
            fn visit_f64<E: serde::de::Error>(self, v: f64) -> std::result::Result<Self::Value, E> {
                T::deserialize(v.into_deserializer()).map(|x| Channels([x; 3]))
            }
            fn visit_i64<E: serde::de::Error>(self, v: i64) -> std::result::Result<Self::Value, E> {
                self.visit_f64(v as f64)
            }
            fn visit_seq<A: SeqAccess<'de>>(self, seq: A) -> std::result::Result<Self::Value, A::Error> {
                <[T; 3]>::deserialize(serde::de::value::SeqAccessDeserializer::new(seq)).map(Channels)
            }
        }
        deserializer.deserialize_any(Either(std::marker::PhantomData))
    }
}

impl<T: Serialize + PartialEq> Serialize for Channels<T> {
    fn serialize<S: Serializer>(&self, serializer: S) -> std::result::Result<S::Ok, S::Error> {
        let [r, g, b] = &self.0;
        if r == g && g == b { r.serialize(serializer) } else { self.0.serialize(serializer) }
    }
}

/// The sides of a cell along x and y: a number for both, or two.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CellFile(pub [Positive; 2]);

impl<'de> Deserialize<'de> for CellFile {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> std::result::Result<Self, D::Error> {
        struct Either;
        impl<'de> Visitor<'de> for Either {
            type Value = CellFile;
            fn expecting(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
                f.write_str("a number, or two numbers for the sides along x and y")
            }
            fn visit_f64<E: serde::de::Error>(self, v: f64) -> std::result::Result<Self::Value, E> {
                Positive::deserialize(v.into_deserializer()).map(|side| CellFile([side; 2]))
            }
            fn visit_i64<E: serde::de::Error>(self, v: i64) -> std::result::Result<Self::Value, E> {
                self.visit_f64(v as f64)
            }
            fn visit_seq<A: SeqAccess<'de>>(self, seq: A) -> std::result::Result<Self::Value, A::Error> {
                <[Positive; 2]>::deserialize(serde::de::value::SeqAccessDeserializer::new(seq)).map(CellFile)
            }
        }
        deserializer.deserialize_any(Either)
    }
}

impl Serialize for CellFile {
    fn serialize<S: Serializer>(&self, serializer: S) -> std::result::Result<S::Ok, S::Error> {
        let [x, y] = &self.0;
        if x == y { x.serialize(serializer) } else { self.0.serialize(serializer) }
    }
}

pub(super) fn rectangle(corner: [f64; 3], u: [f64; 3], v: [f64; 3]) -> Result<Rectangle> {
    Rectangle::new(corner.into(), u.into(), v.into())
}
