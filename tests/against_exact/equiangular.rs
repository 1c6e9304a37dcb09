//! A point light in fog: single scattering along a ray against its closed form, and intervals that can be trusted.
//!
//! Connections from free flights alone have an infinite variance: they are the wrong twin. A ray that passes
//! the light at a distance b sees it as 1/b; over all directions from a point that leaves a variance that diverges,
//! if only as a logarithm, so that intervals are promised for radiances and for lights with an extent.

use crate::checks::point_light::{
    BESIDE, by_both, by_free_flight, fog, intervals_cover, ray, single_scattering,
};
use crate::support::run::{numbers, paths};
use crate::support::verdict;
use turbid::Spectrum;
use turbid::scene::{Orders, Quantity};

#[test]
fn intervals_cover_with_equal_angles_and_not_without() {
    intervals_cover(by_both);
    let alone = verdict::trial(|| intervals_cover(by_free_flight));
    assert!(alone.is_rejected() && alone.broken.is_some(), "free flights alone pass: {alone:?}");
    assert!(alone.worst().unwrap().z < -10.0, "{alone:?}");
}

/// Grey and in colour, thin (forced flights) and thick: the shares of the two ways to find the light add up to one. A
/// share that differed between them by channel weights would show here.
#[test]
fn single_scattering_is_the_integral() {
    let albedo = Spectrum::rgb(0.9, 0.5, 1.0);
    let cases = [
        Spectrum::ONE,
        Spectrum::rgb(0.2, 1.0, 5.0),
        Spectrum::rgb(8.0, 0.3, 0.1),
        Spectrum::grey(1e-3),
        Spectrum::rgb(1e-3, 1e-2, 3e-2),
    ];
    for sigma_t in cases {
        let scene = fog(sigma_t, albedo);
        let moments = paths(&scene, Quantity::Radiance(ray(BESIDE)), Orders::only(1), 1 << 19, 2);
        for c in 0..3 {
            let expected = single_scattering(sigma_t[c], albedo[c], BESIDE);
            verdict::agrees(
                &format!("sigma_t {}, channel {c}", sigma_t.0),
                &moments[c],
                (expected, 1e-12 * expected),
                0.02 * expected,
                2,
            );
        }
    }
    let scene = fog(Spectrum::ONE, Spectrum::grey(0.9));
    let twice = numbers(1 << 19, 3, |s| by_both(&scene, BESIDE, s) + by_free_flight(&scene, BESIDE, s));
    assert!(twice.mean() > 1.5 * single_scattering(1.0, 0.9, BESIDE), "both in full must differ");
}
