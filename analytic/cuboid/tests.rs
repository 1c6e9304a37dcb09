use super::*;
use crate::quadrature::GaussLegendre;
use bickley::ki;
use nalgebra::{DMatrix, DVector, Dyn, LU};

fn shape(sides: [f64; 3], endless: bool) -> Body {
    Body { sides, endless }
}

/// The other method: collocation at Gauss points, the singularity taken away by the fluence of a uniform field,
/// int K (phi(r') - phi(r)) dr' + phi(r) K1(r), with K1 = 1 - (direct light of all faces)/4.
struct Nystroem {
    body: Body,
    albedo: f64,
    nodes: Vec<([f64; 3], f64)>,
    matrix: LU<f64, Dyn, Dyn>,
}

impl Nystroem {
    fn new(body: Body, albedo: f64, order: usize) -> Self {
        let rule = GaussLegendre::rule(order);
        let along = |axis: usize| -> Vec<(f64, f64)> {
            if axis >= body.axes() {
                return vec![(0.0, 1.0)];
            }
            let side = body.sides[axis];
            rule.nodes.iter().zip(&rule.weights).map(|(x, w)| (side * x, side * w)).collect()
        };
        let mut nodes = Vec::new();
        for (x, wx) in along(0) {
            for (y, wy) in along(1) {
                nodes.extend(along(2).into_iter().map(|(z, wz)| ([x, y, z], wx * wy * wz)));
            }
        }
        let mut matrix = DMatrix::identity(nodes.len(), nodes.len());
        for (i, &(place, _)) in nodes.iter().enumerate() {
            let mut rest = Self::all(&body, place);
            for (j, &(other, weight)) in nodes.iter().enumerate().filter(|&(j, _)| j != i) {
                let flight = weight * Self::kernel(&body, place, other);
                rest -= flight;
                matrix[(i, j)] -= albedo * flight;
            }
            matrix[(i, i)] -= albedo * rest;
        }
        Nystroem { body, albedo, nodes, matrix: matrix.lu() }
    }

    fn kernel(body: &Body, a: [f64; 3], b: [f64; 3]) -> f64 {
        let square: f64 = a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum();
        let d = square.sqrt();
        if body.endless { ki(1, d) / (2.0 * PI * d) } else { exp(-d) / (4.0 * PI * square) }
    }

    fn all(body: &Body, place: [f64; 3]) -> f64 {
        1.0 - 0.25 * direct::faces(body, place).unwrap().value
    }

    /// Mean fluence and that at places, from the direct light.
    fn at(&self, places: &[[f64; 3]], direct: impl Fn([f64; 3]) -> f64) -> (f64, Vec<f64>) {
        let right =
            DVector::from_iterator(self.nodes.len(), self.nodes.iter().map(|&(place, _)| direct(place)));
        let fluence = self.matrix.solve(&right).unwrap();
        let one = |&place: &[f64; 3]| {
            let (mut rest, mut sum) = (Self::all(&self.body, place), direct(place));
            for (&(other, weight), fluence) in self.nodes.iter().zip(fluence.iter()) {
                let flight = weight * Self::kernel(&self.body, place, other);
                rest -= flight;
                sum += self.albedo * flight * fluence;
            }
            sum / (1.0 - self.albedo * rest)
        };
        let integral: f64 = self.nodes.iter().zip(fluence.iter()).map(|((_, w), phi)| w * phi).sum();
        (integral / self.body.volume(), places.iter().map(one).collect())
    }
}

/// By lower degrees than those of the library, whose bound is as much wider.
fn solved(body: Body, albedo: f64, source: CuboidSource) -> Cuboid {
    Cuboid::of(body, albedo, source, if body.endless { [10, 14, 20] } else { [6, 8, 12] }).unwrap()
}

/// In the mean and in the middle collocation errs as the inverse of its order at worst, so that its last step, a quarter of the
/// order, is a third of what is left.
#[test]
fn two_methods_agree() {
    let bodies = [(shape([1.0, 1.5, 1.0], true), [15, 20]), (shape([1.0, 1.0, 2.0], false), [6, 8])];
    for (body, orders) in bodies {
        let other = orders.map(|order| Nystroem::new(body, 0.9, order));
        let middle = body.sides.map(|side| 0.5 * side);
        let middle = if body.endless { [0.45 * body.sides[0], middle[1], 0.0] } else { middle };
        for source in [CuboidSource::Face, CuboidSource::Beam] {
            let [ours, wrong] = [0.9, 0.91].map(|albedo| solved(body, albedo, source));
            let direct = |place| ours.fluence_direct(place).unwrap().value;
            let [coarse, fine] = [0, 1].map(|i| {
                let all = other[i].at(&[middle], direct);
                [all.0, all.1[0]]
            });
            let of = |cuboid: &Cuboid| [cuboid.mean_fluence(), cuboid.fluence(middle).unwrap()];
            for (i, (value, wrong)) in of(&ours).into_iter().zip(of(&wrong)).enumerate() {
                let allowed = 3.0 * (fine[i] - coarse[i]).abs() + value.error;
                assert!(
                    (value.value - fine[i]).abs() <= allowed,
                    "{body:?} {source:?}: {value:?} {}",
                    fine[i]
                );
                assert!(
                    (wrong.value - fine[i]).abs() > allowed,
                    "an albedo of 0.91 for 0.9 passes: {wrong:?}"
                );
            }
        }
    }
}

/// Light on all faces of a body that only scatters: 4, whatever its shape. With absorption, 4 less what an even source of that
/// strength would make.
#[test]
fn furnace() {
    for body in [shape([1.0, 2.0, 1.0], true), shape([4.0, 3.0, 5.0], false)] {
        let white = solved(body, 1.0, CuboidSource::Faces);
        let (grey, emitting) =
            (solved(body, 0.6, CuboidSource::Faces), solved(body, 0.6, CuboidSource::Uniform));
        assert!(white.escape().covers(1.0) && white.mean_fluence().covers(4.0), "{:?}", white.mean_fluence());
        for share in [[0.5; 3], [0.02, 0.5, 0.3], [0.01, 0.02, 0.03]] {
            let place = [0, 1, 2].map(|i| share[i] * body.sides[i]);
            let value = white.fluence(place).unwrap();
            assert!(value.covers(4.0) && value.error < 0.02, "{body:?} {place:?}: {value:?}");
            let (value, even) = (grey.fluence(place).unwrap(), emitting.fluence(place).unwrap());
            let expected = 4.0 * (1.0 - 0.4 * body.volume() * even.value);
            let allowed = value.error + 1.6 * body.volume() * even.error;
            assert!((value.value - expected).abs() <= allowed, "{body:?} {place:?}: {value:?} {expected}");
        }
    }
}

/// Light of unit radiance from all faces and an even source add up to 1 in a body that only absorbs: azimuths against pyramids.
#[test]
fn direct_light_of_faces_and_of_the_volume() {
    for body in [shape([1.0, 2.0, 1.0], true), shape([0.01, 0.05, 0.2], false), shape([3.0, 9.0, 6.0], false)]
    {
        for share in [[0.5; 3], [0.0, 0.5, 0.3], [1.0, 1e-3, 0.03], [0.0, 0.0, 1.0]] {
            let place = [0, 1, 2].map(|i| share[i] * body.sides[i]);
            let place = if body.endless { [place[0], place[1], 0.0] } else { place };
            let even = FirstFlights::from(&body, 2, place).uniform() * body.volume();
            for degree in [20, 40] {
                let again = FirstFlights::from(&body, degree, place).uniform() * body.volume();
                assert!((again - even).abs() <= ROUNDING * even, "{body:?} {place:?}: {again:e} {even:e}");
            }
            // On an edge the direct light depends on how it is come near.
            if share.iter().filter(|s| s.fract() == 0.0).count() < 2 {
                let faces = direct::faces(&body, place).unwrap();
                let sum = even + 0.25 * faces.value;
                assert!((sum - 1.0).abs() < faces.error + 2.0 * ROUNDING * even, "{body:?} {place:?}: {sum}");
            }
        }
    }
}

/// The bound of low degrees, against higher ones.
#[test]
fn the_bound_holds() {
    for (body, low) in
        [(shape([1.0, 1.0, 1.0], true), [6, 8, 12]), (shape([2.0, 1.0, 3.0], false), [4, 6, 8])]
    {
        for source in [CuboidSource::Face, CuboidSource::Uniform, CuboidSource::Beam] {
            let (rough, fine) = (Cuboid::of(body, 1.0, source, low).unwrap(), solved(body, 1.0, source));
            for i in 0..3_u32 {
                let share =
                    [0.754_877_666, 0.569_840_291, 0.430_159_709].map(|g| (0.5 + g * f64::from(i)).fract());
                let place = [0, 1, 2].map(|i| share[i] * body.sides[i]);
                let (a, b) = (rough.fluence(place).unwrap(), fine.fluence(place).unwrap());
                assert!((a.value - b.value).abs() <= a.error + b.error, "{source:?} {place:?}: {a:?} {b:?}");
                assert!(
                    a.error < 2e-2 * a.value && b.error < 4e-3 * b.value,
                    "{source:?} {place:?}: {a:?} {b:?}"
                );
            }
        }
    }
}

/// A cuboid between the faces of a slab lacks only what comes through its other faces, and radiance there is at most that of the
/// light: no more than these faces would give if they were lit.
#[test]
fn wide_ones_are_the_slab() {
    let slab = crate::IsotropicSlab::new(1.0, 0.3, crate::Incidence::Diffuse).unwrap();
    for body in [shape([1.0, 16.0, 1.0], true), shape([1.0, 9.0, 9.0], false)] {
        let face = solved(body, 0.3, CuboidSource::Face);
        let all = solved(body, 0.3, CuboidSource::Faces);
        let middle = |x: f64| [x, 0.5 * body.sides[1], if body.endless { 0.0 } else { 0.5 * body.sides[2] }];
        for x in [0.0, 0.3] {
            let (one, two, every) = (
                face.fluence(middle(x)).unwrap(),
                face.fluence(middle(1.0 - x)).unwrap(),
                all.fluence(middle(x)).unwrap(),
            );
            let exact = slab.fluence(x).unwrap();
            let error = one.error + two.error + every.error + exact.error;
            let sides = every.value - one.value - two.value;
            let lacks = exact.value - one.value;
            assert!(lacks >= -error && lacks <= sides + error, "{body:?} {x}: {lacks:e} {sides:e} {error:e}");
            assert!(error < 2e-2 && sides < 5e-2, "{body:?} {x}: {sides:e} {error:e}");
        }
    }
}

/// Thin: what scatters once, w K phi_0, with phi_0 = 1 under a beam, to the first order in the sides.
#[test]
fn thin_ones_scatter_once() {
    for body in [shape([1e-3, 2e-3, 1.0], true), shape([1e-3, 2e-3, 3e-3], false)] {
        let cuboid = solved(body, 0.5, CuboidSource::Beam);
        let place = [0.5e-3, 1e-3, if body.endless { 0.0 } else { 2e-3 }];
        let scattered = cuboid.fluence(place).unwrap().value - cuboid.fluence_direct(place).unwrap().value;
        let once = 0.5 * (1.0 - 0.25 * direct::faces(&body, place).unwrap().value);
        assert!((scattered / once - 1.0).abs() < 3e-3, "{scattered:e} {once:e}");
    }
}

#[test]
fn what_is_not_known_is_refused() {
    let refused = |sides, albedo, part: &str| {
        let error = Cuboid::new(sides, albedo, CuboidSource::Face).unwrap_err().to_string();
        assert!(error.contains(part), "{error}");
    };
    refused([1.0, 0.0, 1.0], 0.5, "side is 0");
    refused([1.0, f64::NAN, 1.0], 0.5, "side is NaN");
    refused([21.0, 2.0, 2.0], 0.5, "side is 21");
    refused([10.0, 0.1, 2.0], 0.5, "longest over shortest side is 100");
    refused([1.0, 1.0, 1.0], 1.5, "albedo is 1.5");
    let cuboid = solved(shape([1.0, 1.0, 2.0], false), 0.0, CuboidSource::Beam);
    assert!(cuboid.fluence([0.5, 1.5, 0.5]).unwrap_err().to_string().contains("y is 1.5"));
    assert!(cuboid.fluence([0.5, 0.5, 1.5]).unwrap().covers(exp(-0.5)));
}
