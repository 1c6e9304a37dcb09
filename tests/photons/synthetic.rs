//! Synthetic maps: the points follow the density they state.

use crate::support::verdict;
use glam::DVec3;
use turbid::photons::Photon;
use turbid::photons::synthetic::{Number, Profile, Synthetic};
use turbid::stats::Moments;

const PROFILES: [Profile; 9] = [
    Profile::Constant,
    Profile::Linear { slope: 1.0 },
    Profile::Linear { slope: -1.0 },
    Profile::Linear { slope: 1e-12 },
    Profile::Exponential { rate: 2.0 },
    Profile::Exponential { rate: -1e-9 },
    Profile::Step { edge: 0.7 },
    Profile::Sinusoid { amplitude: 1.0, periods: 2 },
    Profile::Sinusoid { amplitude: -0.5, periods: 7 },
];

fn lower() -> DVec3 {
    DVec3::new(-1.0, 2.0, 0.5)
}

fn upper() -> DVec3 {
    DVec3::new(1.5, 3.0, 4.5)
}

fn synthetic(profile: Profile) -> Synthetic {
    Synthetic::new(profile, lower(), upper()).unwrap()
}

/// Simpson's rule along x over a part of the box, times its cross-section.
fn mass(synthetic: Synthetic, from: f64, to: f64) -> f64 {
    let n = 2000;
    let weight = |i: u32| f64::from(if i == 0 || i == n { 1 } else { 2 + 2 * (i % 2) });
    let h = (to - from) / f64::from(n);
    let density = |x: f64| synthetic.density(DVec3::new(x, 2.5, 1.0));
    (0..=n).map(|i| weight(i) * density(from + h * f64::from(i))).sum::<f64>() * h / 3.0 * 4.0
}

#[test]
fn densities_integrate_to_one() {
    for profile in PROFILES {
        // From the edge of the step: the rule is exact on smooth parts only.
        let from = if let Profile::Step { edge } = profile { edge } else { lower().x };
        let total = mass(synthetic(profile), from, upper().x);
        assert!((total - 1.0).abs() < 1e-9, "{profile:?}: {total}");
        let thinned = mass(synthetic(profile).thinned(0.25).unwrap(), from, upper().x);
        assert!((thinned - 0.25).abs() < 1e-9, "{profile:?}: {thinned}");
        assert_eq!(synthetic(profile).density(lower() - 0.1), 0.0);
    }
}

/// A name, a coordinate from 0 to 1, and the mass expected in each part of its range.
type Check<'a> = (&'a str, &'a dyn Fn(&Photon) -> f64, &'a [f64]);

/// Counts in twenty equal parts of the box along each axis, and of the direction cosines, against their
/// masses.
#[test]
fn points_follow_the_density() {
    const PARTS: usize = 20;
    const N: u64 = 400_000;
    for profile in PROFILES {
        let synthetic = synthetic(profile);
        let photons: Vec<Photon> = synthetic.map(Number::Exact(N), 17, 0).unwrap().tree().photons().collect();
        assert_eq!(photons.len() as u64, N);
        let uniform = vec![1.0 / PARTS as f64; PARTS];
        let step = (upper().x - lower().x) / PARTS as f64;
        let along_x: Vec<f64> = (0..PARTS)
            .map(|part| {
                let from = lower().x + step * part as f64;
                match profile {
                    Profile::Step { edge } => (from + step - edge.max(from)).max(0.0) / (upper().x - edge),
                    _ => mass(synthetic, from, from + step),
                }
            })
            .collect();
        let size = upper() - lower();
        let place = |p: &Photon| (p.position - lower()) / size;
        let checks: [Check; 6] = [
            ("x", &|p| place(p).x, &along_x),
            ("y", &|p| place(p).y, &uniform),
            ("z", &|p| place(p).z, &uniform),
            ("dir x", &|p| 0.5 + 0.5 * f64::from(p.dir.x), &uniform),
            ("dir y", &|p| 0.5 + 0.5 * f64::from(p.dir.y), &uniform),
            ("dir z", &|p| 0.5 + 0.5 * f64::from(p.dir.z), &uniform),
        ];
        for (what, coordinate, expected) in checks {
            let mut counts = [0.0; PARTS];
            for photon in &photons {
                counts[((coordinate(photon) * PARTS as f64) as usize).min(PARTS - 1)] += 1.0;
            }
            let fit = |expected: &[f64]| {
                verdict::counted(&counts, &expected.iter().map(|e| e * N as f64).collect::<Vec<_>>())
            };
            let name = format!("{profile:?} along {what}");
            verdict::fits(&name, fit(expected), 0.02, 17);
            // The negative control: a density 10 per cent steeper across the box.
            let steeper: Vec<f64> = (0..PARTS)
                .map(|i| expected[i] * (1.0 + 0.1 * (2.0 * (i as f64 + 0.5) / PARTS as f64 - 1.0)))
                .collect();
            let total: f64 = steeper.iter().sum();
            let control = fit(&steeper.iter().map(|e| e / total).collect::<Vec<_>>());
            verdict::misfits(&format!("{name}, steeper"), control, 17);
        }
    }
}

/// The number of photons: Poisson, with the mean asked for and a variance equal to it.
#[test]
fn expected_numbers_are_poisson() {
    let counts: Vec<f64> = (0..1000)
        .map(|replicate| {
            let map = synthetic(Profile::Constant).map(Number::Expected(400), 23, replicate).unwrap();
            assert_eq!(map.emitted(), 400);
            map.stored() as f64
        })
        .collect();
    let moments = |f: &dyn Fn(f64) -> f64| counts.iter().map(|c| f(*c)).collect::<Moments>();
    verdict::agrees("mean", &moments(&|c| c), (400.0, 0.0), 5.0, 23);
    // A fixed number would have none of the variance; numbers twice as wide, twice as much.
    let spread = moments(&|c| (c - 400.0) * (c - 400.0) / 400.0);
    verdict::agrees("variance over mean", &spread, (1.0, 0.0), 0.4, 23);
    verdict::rejects("variance over mean, a fixed number", &spread, 0.0, 23);
    verdict::rejects("variance over mean, half as wide again", &spread, 1.5, 23);
}

#[test]
fn maps_are_a_function_of_their_arguments() {
    let s = synthetic(Profile::Sinusoid { amplitude: 0.3, periods: 1 });
    let held = |replicate| -> Vec<Photon> {
        s.map(Number::Exact(300), 5, replicate).unwrap().tree().photons().collect()
    };
    assert!(held(0) == held(0));
    assert!(held(0) != held(1));
    // Thinning keeps some of the same photons.
    let thinned = s.thinned(0.5).unwrap().map(Number::Exact(300), 5, 0).unwrap();
    assert!(thinned.stored() < 300 && thinned.emitted() == 300);
}

#[test]
fn what_is_refused() {
    let new = |profile| Synthetic::new(profile, DVec3::ZERO, DVec3::ONE);
    assert!(new(Profile::Linear { slope: 1.5 }).is_err());
    assert!(new(Profile::Exponential { rate: f64::NAN }).is_err());
    assert!(new(Profile::Step { edge: 1.0 }).is_err());
    assert!(new(Profile::Sinusoid { amplitude: 2.0, periods: 1 }).is_err());
    assert!(Synthetic::new(Profile::Constant, DVec3::ONE, DVec3::ZERO).is_err());
    assert!(new(Profile::Constant).unwrap().thinned(0.0).is_err());
    assert!(new(Profile::Constant).unwrap().map(Number::Exact(0), 1, 1).is_err());
}
