//! Russian roulette: what survives and what is lost, exactly where it can be exact, else in expectation.

use crate::checks::weights;
use crate::support::run::histories;
use crate::support::verdict;
use turbid::Spectrum;
use turbid::rng::{Purpose, Stream};
use turbid::transport::Roulette;

const N: u64 = 1 << 18;

fn stream(i: u64) -> Stream {
    Stream::new(1, Purpose::Synthetic, 0, i)
}

#[test]
fn a_grey_survivor_keeps_its_power_bit_for_bit() {
    let weight = Spectrum::rgb(0.1, 2.0, 0.7);
    for albedo in [0.0, 0.3, 0.999, 1.0] {
        let albedo_spectrum = Spectrum::grey(albedo);
        let survivors: Vec<Spectrum> = (0..10_000)
            .filter_map(|i| Roulette::Analog.survive(weight, albedo_spectrum, &mut stream(i)))
            .collect();
        assert!(survivors.iter().all(|w| *w == weight));
        assert!(albedo != 0.0 || survivors.is_empty());
        assert!(albedo != 1.0 || survivors.len() == 10_000);
        assert_eq!(Roulette::lost(weight, albedo_spectrum), weight);
    }
}

/// In colour a survivor keeps the summed power to rounding: products, two sums and two quotients.
#[test]
fn a_coloured_survivor_keeps_the_summed_power() {
    for i in 0..10_000 {
        let mut stream = stream(i);
        let draw = |stream: &mut Stream| Spectrum::rgb(stream.unit(), stream.unit(), stream.unit());
        let (weight, albedo) = (draw(&mut stream), draw(&mut stream));
        let lost = Roulette::lost(weight, albedo);
        assert!((lost.sum() / weight.sum() - 1.0).abs() < 16.0 * f64::EPSILON, "{lost:?} of {weight:?}");
        if let Some(kept) = Roulette::Analog.survive(weight, albedo, &mut stream) {
            assert!((kept.sum() / weight.sum() - 1.0).abs() < 8.0 * f64::EPSILON, "{kept:?} of {weight:?}");
        }
    }
}

/// Each channel in expectation: the survivors carry albedo x weight, the others the rest. The negative control books the
/// whole arriving power of those that end as absorbed.
#[test]
fn every_channel_holds_in_expectation() {
    let (weight, albedo) = (Spectrum::rgb(0.5, 1.0, 2.0), Spectrum::rgb(0.9, 0.5, 0.1));
    for roulette in [Roulette::Analog, Roulette::below(0.8), Roulette::below(10.0)] {
        let kept = histories(N, 5, |s| roulette.survive(weight, albedo, s).unwrap_or(Spectrum::ZERO));
        for c in 0..3 {
            let expected = weight[c] * albedo[c];
            verdict::agrees(
                &format!("{roulette:?}, kept, channel {c}"),
                &kept[c],
                (expected, 0.0),
                0.1 * expected,
                5,
            );
        }
    }
    let absorbed = |booked: Spectrum| {
        histories(N, 6, move |s| match Roulette::Analog.survive(weight, albedo, s) {
            None => booked,
            Some(_) => Spectrum::ZERO,
        })
    };
    let lost = absorbed(Roulette::lost(weight, albedo));
    let wrong = absorbed(weight);
    for c in 0..3 {
        let expected = weight[c] * (1.0 - albedo[c]);
        verdict::agrees(&format!("lost, channel {c}"), &lost[c], (expected, 0.0), 0.05 * expected, 6);
        verdict::rejects(&format!("lost, channel {c}, negative control"), &wrong[c], expected, 6);
    }
}

#[test]
fn photons_survive_as_the_albedo_says() {
    weights::photons_survive_as_the_albedo_says();
}
