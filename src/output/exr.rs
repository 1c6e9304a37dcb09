//! Pictures in linear light: OpenEXR, one part, a channel for each number of the film.

use super::{WriteError, write_atomically};
use crate::Spectrum;
use crate::faults::{Fault, planted};
use crate::integrators::Layer;
use crate::sensor::{Film, Pixel};
use ::exr::prelude::{
    AnyChannel, AnyChannels, AttributeValue, Blocks, Compression, Encoding, FlatSamples, Image, LineOrder,
    Text, WritableImage,
};
use std::io;
use std::path::Path;

/// Name of the header attribute that holds where a picture comes from, as JSON.
pub const PROVENANCE: &str = "turbid";

const CHANNELS: [&str; 3] = ["R", "G", "B"];

/// Writes a film with its provenance. The same film and provenance make the same bytes.
///
/// Channels, all of 32 bits: `R G B`, the radiance; `emission.R`, `direct.R`, `caustic.R`, `indirect.R`, `single.R`,
/// `multiple.R` and so on, the layers; where there are at least two samples `variance.R` and so on, the variance of the
/// mean radiance (between maps, where the film is made of several), and `variance.direct.R` and so on, that of each layer's
/// mean; `photons.N`, the photons that a sample's estimates took, in the mean. Layers of one pixel share their paths, so
/// that their variances do not add up to that of the whole.
///
/// # Errors
/// [`WriteError`], naming the path; the old file is then untouched.
pub fn write_exr(
    path: impl AsRef<Path>,
    film: &Film,
    provenance: &serde_json::Value,
) -> Result<(), WriteError> {
    let path = path.as_ref();
    let bytes = encode_exr(film, provenance).map_err(|cause| WriteError {
        path: path.to_path_buf(),
        cause: io::Error::other(cause.to_string()),
    })?;
    write_atomically(path, |out| out.write_all(&bytes))
}

/// The bytes of [`write_exr`].
///
/// # Errors
/// What the format cannot hold.
pub fn encode_exr(film: &Film, provenance: &serde_json::Value) -> ::exr::error::Result<Vec<u8>> {
    let mut channels = Vec::new();
    let mut add = |name: String, value: &dyn Fn(&Pixel) -> f64| {
        let samples = film.pixels().iter().map(|pixel| value(pixel) as f32).collect();
        channels.push(AnyChannel::new(text(&name), FlatSamples::F32(samples)));
    };
    // One sample says nothing of its variance.
    let has_variance = film.samples() >= 2;
    for (c, channel) in CHANNELS.into_iter().enumerate() {
        let v = if planted(Fault::VarianceOfRed) { 0 } else { c };
        add(channel.to_string(), &|pixel| pixel.total()[c]);
        if has_variance {
            let variance = |pixel: &Pixel| pixel.variance().unwrap_or(Spectrum::ZERO)[v];
            add(format!("variance.{channel}"), &variance);
        }
        for layer in Layer::ALL {
            let name = layer.name();
            add(format!("{name}.{channel}"), &|pixel| pixel.layers()[layer][c]);
            if has_variance {
                let variance = |pixel: &Pixel| pixel.layer_variance(layer).unwrap_or(Spectrum::ZERO)[v];
                add(format!("variance.{name}.{channel}"), &variance);
            }
        }
    }
    add("photons.N".to_string(), &|pixel| pixel.photons());
    let mut image = Image::from_layer(::exr::prelude::Layer {
        channel_data: AnyChannels::sort(channels.into_iter().collect()),
        attributes: ::exr::prelude::LayerAttributes::default(),
        size: ::exr::prelude::Vec2(film.width() as usize, film.height() as usize),
        encoding: Encoding {
            compression: Compression::ZIP16,
            blocks: Blocks::ScanLines,
            line_order: LineOrder::Increasing,
        },
    });
    let version = format!("turbid {}", env!("CARGO_PKG_VERSION"));
    image.layer_data.attributes.software_name = Some(text(&version));
    // A second attribute of our own would come in an order that changes from run to run.
    let provenance = AttributeValue::Text(text(&ascii(&provenance.to_string())));
    image.layer_data.attributes.other.insert(text(PROVENANCE), provenance);
    let mut bytes = io::Cursor::new(Vec::new());
    image.write().to_buffered(&mut bytes)?;
    Ok(bytes.into_inner())
}

/// The format's text, of one byte a character: what is above them becomes a question mark.
fn text(given: &str) -> Text {
    let bytes = given.chars().map(|c| u8::try_from(u32::from(c)).unwrap_or(b'?')).collect();
    Text::from_bytes_unchecked(bytes)
}

/// JSON with every character outside ASCII escaped: it reads back as the same value.
fn ascii(json: &str) -> String {
    let mut escaped = String::with_capacity(json.len());
    for character in json.chars() {
        if character.is_ascii() {
            escaped.push(character);
        } else {
            for unit in character.encode_utf16(&mut [0; 2]) {
                escaped.push_str(&format!("\\u{unit:04x}"));
            }
        }
    }
    escaped
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::integrators::Layers;
    use crate::sensor::Sample;
    use ::exr::prelude::{ReadChannels, ReadLayers, read};
    use std::io::Cursor;

    fn film(samples: u32) -> Film {
        let mut film = Film::new(5, 3);
        for y in 0..3 {
            for x in 0..5 {
                for i in 0..samples {
                    let value = |layer: u32| {
                        let base = f64::from(100 * layer + 10 * y + x + i);
                        Spectrum::rgb(base, base + 0.25, -base)
                    };
                    let layers = Layers {
                        emission: value(0),
                        direct: value(1),
                        caustic: value(2),
                        indirect: value(3),
                        single: value(4),
                        multiple: value(5),
                    };
                    film.pixel_mut(x, y).push(&Sample { layers, photons: f64::from(x + y) });
                }
            }
        }
        film
    }

    /// Read back by the crate's own reader, by name: every channel in its place, the provenance word by word.
    #[test]
    fn channels_and_provenance_read_back() {
        let given = serde_json::json!({ "scene": "fog → \"π\" 𝄞 ü\n", "seed": 7, "samples": 2 });
        let bytes = encode_exr(&film(2), &given).unwrap();
        let image = read()
            .no_deep_data()
            .largest_resolution_level()
            .all_channels()
            .all_layers()
            .all_attributes()
            .from_buffered(Cursor::new(&bytes))
            .unwrap();
        assert_eq!(image.layer_data.len(), 1);
        let layer = &image.layer_data[0];
        assert_eq!((layer.size.0, layer.size.1, layer.encoding.compression), (5, 3, Compression::ZIP16));
        assert_eq!(layer.channel_data.list.len(), 14 * 3 + 1);
        let at = |name: &str, x: u32, y: u32| {
            let channel = layer.channel_data.list.iter().find(|c| c.name.to_string() == name);
            let channel = channel.unwrap_or_else(|| panic!("no channel {name}"));
            channel.sample_data.value_by_flat_index((y * 5 + x) as usize).to_f32()
        };
        for (y, x) in [(0, 0), (2, 1), (1, 4)] {
            let base = (10 * y + x) as f32 + 0.5;
            for (i, layer) in Layer::ALL.into_iter().enumerate() {
                let expected = 100.0 * i as f32 + base;
                assert_eq!(at(&format!("{}.R", layer.name()), x, y), expected);
                assert_eq!(at(&format!("{}.G", layer.name()), x, y), expected + 0.25);
                assert_eq!(at(&format!("{}.B", layer.name()), x, y), -expected);
            }
            assert_eq!(at("R", x, y), 1500.0 + 6.0 * base);
            assert_eq!(at("G", x, y), 1500.0 + 6.0 * (base + 0.25));
            // Totals 6 apart: squared deviations 9 + 9, over 2 and 1.
            assert_eq!(at("variance.B", x, y), 9.0);
            // Layers 1 apart: 1/4 + 1/4, over 2 and 1.
            for layer in Layer::ALL {
                assert_eq!(at(&format!("variance.{}.G", layer.name()), x, y), 0.25);
            }
            assert_eq!(at("photons.N", x, y), (x + y) as f32);
        }
        let Some(AttributeValue::Text(text)) = layer.attributes.other.get(&Text::from(PROVENANCE)) else {
            panic!("no provenance")
        };
        let read: serde_json::Value = serde_json::from_str(&text.to_string()).unwrap();
        assert_eq!(read, given);
        assert!(bytes == encode_exr(&film(2), &given).unwrap(), "the bytes change from run to run");
    }

    /// One sample says nothing of its variance.
    #[test]
    fn no_variance_from_one_sample() {
        let bytes = encode_exr(&film(1), &serde_json::Value::Null).unwrap();
        let meta = ::exr::meta::MetaData::read_from_buffered(Cursor::new(&bytes), false).unwrap();
        let names: Vec<String> = meta.headers[0].channels.list.iter().map(|c| c.name.to_string()).collect();
        assert_eq!(names.len(), 7 * 3 + 1);
        assert!(names.iter().all(|name| !name.starts_with("variance")));
    }

    #[cfg(unix)]
    #[test]
    fn a_full_disk_is_told_in_one_line() {
        let error = write_exr("/dev/full", &film(2), &serde_json::Value::Null).unwrap_err().to_string();
        assert!(error.starts_with("cannot write /dev/full: ") && error.lines().count() == 1, "{error}");
    }
}
