//! What files of pictures say of each channel.

use ::exr::prelude::{ReadChannels, ReadLayers, read};
use std::io::Cursor;
use turbid::Spectrum;
use turbid::integrators::{Layer, Layers};
use turbid::output::{auto_exposure, encode_exr};
use turbid::sensor::{Film, Sample};

/// Two samples of a pixel whose layers and channels are all apart by another amount: the variance of a mean of two that
/// are 2 d apart is d^2.
pub fn each_channel_has_its_own_variance() {
    let step = |layer: usize, c: usize| (1 + 3 * layer + c) as f64;
    let sample = |sign: f64| {
        let mut layers = Layers::ZERO;
        for (i, layer) in Layer::ALL.into_iter().enumerate() {
            let value = |c: usize| 100.0 + sign * step(i, c);
            layers[layer] = Spectrum::rgb(value(0), value(1), value(2));
        }
        Sample { layers, photons: 0.0 }
    };
    let mut film = Film::new(1, 1);
    [1.0, -1.0].iter().for_each(|sign| film.pixel_mut(0, 0).push(&sample(*sign)));
    let bytes = encode_exr(&film, &serde_json::Value::Null).unwrap();
    let image = read()
        .no_deep_data()
        .largest_resolution_level()
        .all_channels()
        .all_layers()
        .all_attributes()
        .from_buffered(Cursor::new(&bytes))
        .unwrap();
    let channels = &image.layer_data[0].channel_data.list;
    let at = |name: String| {
        let channel = channels.iter().find(|c| c.name.to_string() == name).unwrap();
        f64::from(channel.sample_data.value_by_flat_index(0).to_f32())
    };
    for (c, letter) in ["R", "G", "B"].into_iter().enumerate() {
        for (i, layer) in Layer::ALL.into_iter().enumerate() {
            let expected = step(i, c) * step(i, c);
            assert_eq!(at(format!("variance.{}.{letter}", layer.name())), expected, "{layer:?} {letter}");
        }
        // Both samples differ alike in all layers: their distances add up.
        let sum: f64 = (0..Layer::ALL.len()).map(|i| step(i, c)).sum();
        assert_eq!(at(format!("variance.{letter}")), sum * sum, "{letter}");
    }
}

/// Luminance of pure colours (IEC 61966-2-1, the second row of its matrix): what one channel alone needs in exposure over
/// what grey of the same radiance needs, to the tenth of a stop that exposure is rounded to.
pub fn channels_weigh_as_the_eye_has_it() {
    // The radiances bring each to a place between two tenths that the roundings do not decide.
    for (c, weight) in [0.2126, 0.7152, 0.0722].into_iter().enumerate() {
        for radiance in [0.011, 0.37, 5.3, 820.0] {
            let color = [0, 1, 2].map(|i| if i == c { radiance } else { 0.0 });
            let found = auto_exposure([Spectrum::rgb(color[0], color[1], color[2])].into_iter());
            let expected = libm::log2(0.6 / (radiance * weight));
            assert!((found - expected).abs() <= 0.05 + 1e-9, "channel {c}: {found} stops for {expected}");
        }
    }
}
