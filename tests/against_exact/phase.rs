//! Phase functions against the referee's: values and moments.

use std::sync::Arc;
use turbid::math::{Albedo, Asymmetry, cos};
use turbid::phase::{Phase, PhaseFunction, Rayleigh, Schlick, Tabulated, TwoTerm};
use turbid_analytic::Phase as Referee;

fn asymmetry(g: f64) -> Asymmetry {
    Asymmetry::try_from(g).unwrap()
}

/// Up to which moment.
const HIGHEST: u32 = 30;

/// Moments alike, and values where the referee has them in closed form.
fn compare(phase: &Phase, referee: &Referee, tolerance: f64) {
    for l in 0..=HIGHEST {
        let (own, other) = (phase.moment(l), referee.moment(l as usize));
        assert!((own - other).abs() < tolerance, "{phase:?}, moment {l}: {own} for {other}");
    }
}

#[test]
fn two_terms_have_the_moments_and_values_of_the_referee() {
    for (g1, g2, share) in [(0.8, -0.4, 0.7), (0.95, 0.0, 0.5), (-0.9, 0.3, 0.1), (0.5, 0.5, 1.0)] {
        let share_of = Albedo::try_from(share).unwrap();
        let phase = Phase::TwoTerm(TwoTerm::new(asymmetry(g1), asymmetry(g2), share_of));
        let referee = Referee::two_term(g1, g2, share).unwrap();
        compare(&phase, &referee, 1e-14);
        for i in 0..=20 {
            let mu = f64::from(i) / 10.0 - 1.0;
            let (own, other) = (phase.eval(1.0 - mu, 1.0 + mu), referee.value(mu));
            assert!((own / other - 1.0).abs() < 1e-14, "{mu}: {own} for {other}");
        }
    }
}

#[test]
fn rayleigh_is_the_referees() {
    let (phase, referee) = (Phase::Rayleigh(Rayleigh), Referee::rayleigh());
    compare(&phase, &referee, 1e-16);
    for mu in [-1.0, -0.3, 0.0, 0.7, 1.0] {
        assert!((phase.eval(1.0 - mu, 1.0 + mu) - referee.value(mu)).abs() < 1e-16);
    }
}

/// The same table to both: angles in degrees here, cosines there. Of the referee's moments 2 are kept, and it must find
/// them nowhere negative.
#[test]
fn a_table_has_the_moments_of_the_referee() {
    let table = [(0.0, 2.0), (30.0, 1.7), (75.0, 1.1), (90.0, 1.0), (120.0, 0.9), (180.0, 1.2)];
    let phase = Phase::Tabulated(Arc::new(Tabulated::new(&table).unwrap()));
    let cosine = |angle: f64| match angle {
        0.0 => 1.0,
        180.0 => -1.0,
        _ => cos(angle.to_radians()),
    };
    let (cosines, values): (Vec<f64>, Vec<f64>) =
        table.iter().rev().map(|(angle, value)| (cosine(*angle), *value)).unzip();
    let referee = Referee::tabulated(&cosines, &values, 60).unwrap();
    compare(&phase, &referee, 1e-13);
}

/// A Schlick function with a given mean cosine has it, and the values of its definition.
#[test]
fn schlick_matches_a_mean_cosine() {
    for g in [-0.95, -0.3, -1e-6, 0.0, 1e-3, 0.5, 0.85, 0.99] {
        let schlick = Schlick::with_mean_cosine(asymmetry(g)).unwrap();
        assert!((schlick.moment(1) - g).abs() < 1e-15, "{g}: {}", schlick.moment(1));
        let (k, mu) = (schlick.k(), 0.4);
        let value = (1.0 - k * k) / (4.0 * std::f64::consts::PI * (1.0 - k * mu) * (1.0 - k * mu));
        assert!((schlick.eval(1.0 - mu, 1.0 + mu) / value - 1.0).abs() < 1e-13);
    }
}
