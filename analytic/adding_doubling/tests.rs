//! What only the inside can see: the bounds against a third set of nodes, and light inside against its law.

use super::*;
use proptest::prelude::*;

/// The slab on nodes finer than any in use.
fn finer(tau: f64, albedo: f64, phase: &Phase, incidence: Incidence) -> Solution {
    let degree = phase.degree(1e-15, 2 * MOST);
    let moments: Vec<f64> = (0..=degree).map(|l| phase.moment(l)).collect();
    let beam = match incidence {
        Incidence::Beam { mu0 } => vec![mu0],
        Incidence::Diffuse => Vec::new(),
    };
    let nodes = Nodes::open(40.max(degree / 2 + 8), 80).with(&beam);
    let stack = Stack::new(tau, albedo, &moments, 0, nodes).unwrap();
    let entering = entering(&stack.nodes, incidence);
    Solution { stack, entering }
}

proptest! {
    #![proptest_config(crate::fixed_cases(16))]

    /// The bound is earned: it covers what more nodes make of the same slab, everywhere.
    #[test]
    fn bounds_cover_a_third_set_of_nodes(
        tau in (-9.0..2.0_f64).prop_map(|x| libm::pow(10.0, x)),
        albedo in prop_oneof![0.0..=1.0_f64, Just(1.0), (-12.0..0.0_f64).prop_map(|x| libm::pow(10.0, x))],
        g in -0.8..0.8_f64,
        light in prop_oneof![
            Just(Incidence::Diffuse),
            Just(Incidence::Beam { mu0: 1.0 }),
            (-5.0..0.0_f64).prop_map(|x| Incidence::Beam { mu0: libm::pow(10.0, x) }),
        ],
    ) {
        let phase = Phase::henyey_greenstein(g).unwrap();
        let slab = AddingDoubling::with_phase(tau, albedo, &phase, light).unwrap();
        let finer = finer(tau, albedo, &phase, light);
        let check = |name: &str, got: Value, truth: f64| {
            prop_assert!(got.covers(truth), "{name}: {got:?}, finer {truth:e}");
            // Steep light leaves a fluence that changes within the mean free path of few nodes.
            let relative = if name == "phi" { 1e-7 } else { 1e-9 };
            prop_assert!(got.error <= relative * got.value + f64::MIN_POSITIVE, "{name}: {got:?}");
            Ok(())
        };
        check("R", slab.reflectance(), finer.reflectance())?;
        check("T", slab.transmittance_diffuse(), finer.transmittance_diffuse())?;
        check("A", slab.absorptance(), finer.absorptance())?;
        for share in [0.0, 1e-7, 1e-3, 0.03, 0.4, 0.9, 0.999, 1.0] {
            check("phi", slab.fluence(tau * share).unwrap(), finer.fluence(tau * share, light))?;
        }
    }
}

/// The net flux falls as light is absorbed: what enters a part of the slab and does not leave it is (1-w) times the
/// integral of the fluence, at depths that no doubling meets.
#[test]
fn flux_falls_by_what_is_absorbed() {
    let (tau, albedo) = (3.0, 0.7);
    let light = Incidence::Beam { mu0: 0.4 };
    let slab = AddingDoubling::new(tau, albedo, 0.6, light).unwrap();
    let down = |t: f64| {
        let solution = &slab.solutions[0];
        let dark = DVector::zeros(solution.entering.len());
        let (down, up) = solution.stack.field(t, solution.entering.clone(), dark);
        solution.power(&(down - up)) + libm::exp(-t / 0.4)
    };
    let (a, b) = (0.3, 1.7);
    let absorbed = (1.0 - albedo)
        * crate::quadrature::GaussLegendre::rule(16).integrate(a, b, |t| slab.fluence(t).unwrap().value);
    assert!((down(a) - down(b) - absorbed).abs() < 1e-12, "{:e}", down(a) - down(b) - absorbed);
}

/// Two layers that are not alike in thickness: the field of one slab, cut anywhere, is that of its parts.
#[test]
fn light_inside_meets_what_leaves() {
    let slab = AddingDoubling::new(2.0, 0.95, 0.5, Incidence::Diffuse).unwrap();
    let solution = &slab.solutions[0];
    let dark = DVector::zeros(solution.entering.len());
    let (down, up) = solution.stack.field(2.0, solution.entering.clone(), dark.clone());
    assert!(up.norm() < 1e-16 * down.norm());
    let direct = 2.0 * crate::exponential_integral::e_n(3, 2.0);
    let through = slab.transmittance_diffuse().value + direct;
    assert!((solution.power(&down) - through).abs() < 1e-11, "{:e}", solution.power(&down) - through);
    let (_, up) = solution.stack.field(0.0, solution.entering.clone(), dark);
    assert!((solution.power(&up) - slab.reflectance().value).abs() < 1e-13);
}

/// Prahl's own test values (iadpython, test_ur1_uru) of a slab of albedo 0.5, thickness 1 and g = 0.9 at normal incidence are
/// those of four directions: delta-M with the moments below g^4 on a Radau rule of four nodes has all digits of UR1 and
/// is within 1e-4 of UT1, of which the slab itself is 9e-4 and 1.6e-3 away. What is left is Prahl's first layer, of d = 0.084 by
/// differences, that makes e^-t wrong by t d^2/12 e^-t = 2e-4; of diffuse light, at slanting directions, by 6e-4, more
/// than the four directions do.
#[test]
fn four_directions_of_prahl() {
    let (tau, albedo, g) = (1.0, 0.5, 0.9_f64);
    let f = g.powi(4);
    let rest = 1.0 - f * albedo;
    let moments: Vec<f64> = (0..4).map(|l| (g.powi(l) - f) / (1.0 - f)).collect();
    // Radau on [0, 1] with a node at 1, Abramowitz and Stegun 25.4.31 turned round.
    let mu = vec![0.088_587_959_512_704, 0.409_466_864_440_734_6, 0.787_659_461_760_847_1, 1.0];
    let weight = vec![0.220_462_211_176_768_4, 0.388_193_468_843_172, 0.328_844_319_980_059_6, 0.0625];
    let nodes = Nodes { mu, weight, count: 4 }.with(&[1.0]);
    let stack = Stack::new(tau * rest, (1.0 - f) * albedo / rest, &moments, 0, nodes).unwrap();
    let light = Incidence::Beam { mu0: 1.0 };
    let entering = entering(&stack.nodes, light);
    let four = Solution { stack, entering };
    let transmitted = four.transmittance_diffuse() + libm::exp(-tau * rest);
    let slab = AddingDoubling::new(tau, albedo, g, light).unwrap();
    for (four, exact, printed, tolerance) in [
        (four.reflectance(), slab.reflectance(), 0.00585, 0.5e-5),
        (transmitted, slab.transmittance(), 0.59232, 2e-4),
    ] {
        assert!((four - printed).abs() <= tolerance, "{four} {printed}");
        assert!((exact.value - printed).abs() > 4.0 * tolerance, "{exact:?} {printed}");
    }
}
