//! Progressive photon maps: radii by map, the k nearest left alone, and a film that is gone on with.

use crate::checks::progressive;
use turbid::Spectrum;
use turbid::estimators::{Codimension, Estimator, Gather, Kernel};
use turbid::integrators::Layers;
use turbid::integrators::mapper::Settings;
use turbid::math::Positive;
use turbid::sensor::Film;

#[test]
fn each_map_is_read_within_the_radius_that_is_due() {
    progressive::each_map_is_read_within_the_radius_that_is_due();
}

/// Discs on surfaces have c = 2, balls 3, tubes 2, strips 1; what is not progressive, and the k nearest, stay.
#[test]
fn a_picture_s_radii_by_map() {
    let length = Positive::new("the radius", 0.4).unwrap();
    let fixed = Gather::radius(0.4).unwrap();
    let mut settings = Settings::for_size(1.0, 50).unwrap();
    (settings.global.1, settings.caustic.1) = (fixed, fixed);
    settings.volume = Estimator::new(Kernel::Uniform, fixed).along_beams(length);
    assert_eq!(settings.in_map(7), settings);
    settings.volume = settings.volume.progressive();
    let later = settings.in_map(7);
    let [two, three, one] =
        [Codimension::Two, Codimension::Three, Codimension::One].map(|c| 0.4 * c.shrinkage(7));
    assert_eq!((later.global.1.cap(), later.caustic.1.cap()), (two, two));
    assert_eq!(later.volume.gather.cap(), three);
    assert_eq!(later.volume.beam_radius.map(Positive::get), Some(one));
    assert!(one < two && two < three && three < 0.4);
    let along = Settings { volume: settings.volume.along_rays(length), ..settings }.in_map(7);
    assert_eq!(along.volume.ray_radius.map(Positive::get), Some(two));
    let nearest = Settings::for_size(1.0, 50).unwrap();
    let asked = Settings { volume: nearest.volume.progressive(), ..nearest };
    assert_eq!(asked.in_map(7), asked);
}

/// A film that goes through bytes is the same; what is no film is none.
#[test]
fn films_come_back_from_their_bytes() {
    let mut film = Film::new(3, 2);
    for (number, x) in [0.1, 2.0, -7.0].into_iter().enumerate() {
        let mut map = Film::new(3, 2);
        for y in 0..2 {
            for column in 0..3 {
                let direct = Spectrum::rgb(x, 1.0 / 3.0, f64::from(column));
                map.pixel_mut(column, y).push(&Layers { direct, ..Layers::ZERO }.into());
            }
        }
        film.push_film(&map);
        assert_eq!(film.samples(), number as u64 + 1);
    }
    let bytes = film.to_bytes();
    assert_eq!(Film::from_bytes(3, 2, &bytes).as_ref(), Some(&film));
    // Pixels are taken row by row, so that 2 x 3 has as many numbers; others have not.
    assert!(Film::from_bytes(3, 3, &bytes).is_none() && Film::from_bytes(3, 2, &bytes[1..]).is_none());
    let with = |at: usize, value: u64| {
        let mut bytes = bytes.clone();
        bytes[at..at + 8].copy_from_slice(&value.to_le_bytes());
        Film::from_bytes(3, 2, &bytes)
    };
    assert!(with(16, f64::NAN.to_bits()).is_none(), "a number that is none");
    assert!(with(0, 4).is_none(), "a pixel of more maps than the others");
    let size = bytes.len() / 6;
    let in_all = |at: usize, value: u64| {
        let mut bytes = bytes.clone();
        bytes
            .chunks_exact_mut(size)
            .for_each(|pixel| pixel[at..at + 8].copy_from_slice(&value.to_le_bytes()));
        Film::from_bytes(3, 2, &bytes)
    };
    assert!(
        in_all(0, 3).is_some() && in_all(0, 0).is_none() && in_all(0, u64::MAX).is_none(),
        "a count that none has"
    );
    let last = size - 8;
    assert!(
        in_all(last, 1f64.to_bits()).is_some() && in_all(last, (-1f64).to_bits()).is_none(),
        "a square below 0"
    );
}
