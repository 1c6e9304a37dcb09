//! Galerkin's method in products of Legendre polynomials.

use super::body::{Body, CuboidSource};
use super::pyramids::{Flight, Orders, integrals};
use crate::quadrature::GaussLegendre;
use libm::exp;
use nalgebra::{Cholesky, DMatrix, DVector};

/// Legendre polynomials of one degree after another, orthonormal on \[0, 1\].
pub(super) fn legendre(xi: f64, out: &mut [f64]) {
    let x = 2.0 * xi - 1.0;
    let (mut before, mut p) = (0.0, 1.0);
    for (degree, out) in out.iter_mut().enumerate() {
        let n = degree as f64;
        *out = (2.0 * n + 1.0).sqrt() * p;
        (before, p) = (p, ((2.0 * n + 1.0) * x * p - n * before) / (n + 1.0));
    }
}

/// A function on the body as a polynomial of degree below `degree` in each coordinate, even in y and z about the middle.
#[derive(Debug, Clone)]
pub(super) struct Expansion {
    body: Body,
    degree: usize,
    /// Coefficients by degree in x, half degree in y, half degree in z.
    coefficients: Vec<f64>,
}

/// Degrees of an axis: all along the first, even ones of the others.
fn degrees(body: &Body, degree: usize) -> [usize; 3] {
    let even = degree.div_ceil(2);
    [degree, even, if body.endless { 1 } else { even }]
}

fn orders(body: &Body, degree: usize) -> Orders {
    // Exact for the polynomials, of degree 2 n in each coordinate, with some nodes more for the exponential.
    let longest = body.sides[..body.axes()].iter().copied().fold(0.0, f64::max);
    let along = 3 * degree + 16 + longest as usize;
    Orders { along: if body.endless { 2 * along } else { along }, across: degree + 12 + longest as usize / 3 }
}

/// Pairs of degrees of one parity, the first not above the second, of every axis: all that the matrix is made of.
struct Pairs {
    list: Vec<(usize, usize)>,
    place: Vec<usize>,
    count: usize,
}

impl Pairs {
    fn new(count: usize, even: bool) -> Self {
        let (mut list, mut place) = (Vec::new(), vec![0; count * count]);
        for i in 0..count {
            for j in (i..count).filter(|j| even || (i + j).is_multiple_of(2)) {
                (place[i * count + j], place[j * count + i]) = (list.len(), list.len());
                list.push(if even { (2 * i, 2 * j) } else { (i, j) });
            }
        }
        Pairs { list, place, count }
    }

    fn at(&self, i: usize, j: usize) -> usize {
        self.place[i * self.count + j]
    }
}

/// The operator of first flights between polynomials.
pub(super) struct Operator {
    body: Body,
    degree: usize,
    pairs: [Pairs; 3],
    elements: Vec<f64>,
}

impl Operator {
    pub(super) fn new(body: Body, degree: usize) -> Self {
        let count = degrees(&body, degree);
        let pairs = [Pairs::new(count[0], false), Pairs::new(count[1], true), Pairs::new(count[2], true)];
        let rule = GaussLegendre::rule(degree);
        // int_0^(1-U) p_i(x) p_j(x+U) dx, the same for U and -U: the parities agree.
        let correlations = |axis: usize, u: f64, out: &mut [f64]| {
            let shift = u / body.sides[axis];
            let length = (1.0 - shift).max(0.0);
            let (mut here, mut there) = (vec![0.0; degree], vec![0.0; degree]);
            out.fill(0.0);
            for (x, w) in rule.nodes.iter().zip(&rule.weights) {
                legendre(length * x, &mut here);
                legendre(length * x + shift, &mut there);
                let weight = length * w;
                for (&(i, j), out) in pairs[axis].list.iter().zip(out.iter_mut()) {
                    *out += weight * here[i] * there[j];
                }
            }
        };
        let sizes = [pairs[0].list.len(), pairs[1].list.len(), pairs[2].list.len()];
        let mut elements = integrals(
            Flight::Collision,
            body.sides,
            body.endless,
            orders(&body, degree),
            sizes,
            &correlations,
        );
        // Both signs along every axis.
        let signs = if body.endless { 4.0 } else { 8.0 };
        elements.iter_mut().for_each(|element| *element *= signs);
        Operator { body, degree, pairs, elements }
    }

    fn element(&self, a: [usize; 3], b: [usize; 3]) -> f64 {
        let [x, y, z] = [0, 1, 2].map(|axis| self.pairs[axis].at(a[axis], b[axis]));
        self.elements[(x * self.pairs[1].list.len() + y) * self.pairs[2].list.len() + z]
    }

    fn places(&self) -> Vec<[usize; 3]> {
        let [x, y, z] = degrees(&self.body, self.degree);
        (0..x * y * z).map(|at| [at / (y * z), at / z % y, at % z]).collect()
    }

    /// Solves phi = phi_0 + w K phi among the polynomials, those even and odd along the first axis apart. Above their degrees
    /// stands the direct light, to twice that.
    pub(super) fn solve(&self, albedo: f64, source: CuboidSource) -> Expansion {
        let mut phi = direct(&self.body, 2 * self.degree, source);
        let places = self.places();
        let at: Vec<usize> = places.iter().map(|&place| phi.at(place)).collect();
        for parity in 0..2 {
            let block: Vec<usize> = (0..places.len()).filter(|&n| places[n][0] % 2 == parity).collect();
            if block.iter().all(|&n| phi.coefficients[at[n]] == 0.0) {
                continue;
            }
            let matrix = DMatrix::from_fn(block.len(), block.len(), |row, column| {
                let unit = if row == column { 1.0 } else { 0.0 };
                unit - albedo * self.element(places[block[row]], places[block[column]])
            });
            let right = DVector::from_iterator(block.len(), block.iter().map(|&n| phi.coefficients[at[n]]));
            // K is symmetric with eigenvalues below 1; if rounding says otherwise, the answer is refused as not finite.
            let solution = Cholesky::new(matrix).map_or(&right * f64::NAN, |factor| factor.solve(&right));
            for (&n, value) in block.iter().zip(solution.iter()) {
                phi.coefficients[at[n]] = *value;
            }
        }
        phi
    }
}

/// Moments of the direct light of a source.
pub(super) fn direct(body: &Body, degree: usize, source: CuboidSource) -> Expansion {
    let count = degrees(body, degree);
    let mut coefficients = match source {
        CuboidSource::Face => direct_of_face(body, degree, 0),
        CuboidSource::Faces => {
            let mut sum = vec![0.0; count[0] * count[1] * count[2]];
            for normal in 0..body.axes() {
                // The opposite face doubles what is even and takes the odd away, below.
                let one = direct_of_face(body, degree, normal);
                sum.iter_mut().zip(one).for_each(|(sum, one)| *sum += 2.0 * one);
            }
            sum
        }
        CuboidSource::Uniform => {
            let table = |axis: usize, u: f64, out: &mut [f64]| both_signs(body, axis, u, degree, out);
            let (flight, orders) = (Flight::Collision, orders(body, degree));
            let mut all = integrals(flight, body.sides, body.endless, orders, count, &table);
            all.iter_mut().for_each(|moment| *moment /= body.volume());
            all
        }
        CuboidSource::Beam => {
            let (mut moments, side) = (vec![0.0; count[0] * count[1] * count[2]], body.sides[0]);
            let rule = GaussLegendre::rule(degree + 16 + side as usize);
            let mut all = vec![0.0; degree];
            for (x, w) in rule.nodes.iter().zip(&rule.weights) {
                legendre(*x, &mut all);
                let weight = w * (side * body.face(0)).sqrt() * exp(-side * x);
                for (i, p) in all.iter().enumerate() {
                    moments[i * count[1] * count[2]] += weight * p;
                }
            }
            moments
        }
    };
    if matches!(source, CuboidSource::Faces | CuboidSource::Uniform) {
        let odd = |at: usize| !(at / (count[1] * count[2])).is_multiple_of(2);
        coefficients.iter_mut().enumerate().filter(|(at, _)| odd(*at)).for_each(|(_, moment)| *moment = 0.0);
    }
    Expansion { body: *body, degree, coefficients }
}

/// Moments of the direct light of the face at 0 with this normal.
fn direct_of_face(body: &Body, degree: usize, normal: usize) -> Vec<f64> {
    let table = |axis: usize, u: f64, out: &mut [f64]| {
        if axis != normal {
            return both_signs(body, axis, u, degree, out);
        }
        let mut all = vec![0.0; degree];
        legendre(u / body.sides[axis], &mut all);
        let scale = 1.0 / body.sides[axis].sqrt();
        out.iter_mut().enumerate().for_each(|(i, out)| *out = scale * all[step(axis) * i]);
    };
    let count = degrees(body, degree);
    integrals(Flight::Face(normal), body.sides, body.endless, orders(body, degree), count, &table)
}

/// From degree to degree: all along the first axis, the even ones along the others.
fn step(axis: usize) -> usize {
    if axis == 0 { 1 } else { 2 }
}

/// The integral over x of p_j(x) where x - u lies on the axis, and where x + u does: nothing for odd degrees, which cancel.
fn both_signs(body: &Body, axis: usize, u: f64, degree: usize, out: &mut [f64]) {
    let mut all = vec![0.0; degree + 2];
    legendre(u / body.sides[axis], &mut all);
    let plain = |j: usize| all[j] / (2.0 * j as f64 + 1.0).sqrt();
    for (i, out) in out.iter_mut().enumerate() {
        let j = step(axis) * i;
        // (2j+1) P_j = (P_(j+1) - P_(j-1))', in 2x - 1.
        let below = if j == 0 { 1.0 } else { plain(j - 1) };
        *out = if j % 2 == 1 {
            0.0
        } else {
            (body.sides[axis] / (2.0 * j as f64 + 1.0)).sqrt() * (below - plain(j + 1))
        };
    }
}

impl Expansion {
    pub(super) fn degree(&self) -> usize {
        self.degree
    }

    /// The integral of the fluence over the body.
    pub(super) fn integral(&self) -> f64 {
        self.coefficients[0] * self.body.volume().sqrt()
    }

    fn at(&self, place: [usize; 3]) -> usize {
        let [_, y, z] = degrees(&self.body, self.degree);
        (place[0] * y + place[1]) * z + place[2]
    }

    /// K phi at a place: the light of the collisions, before the albedo.
    pub(super) fn collided(&self, first_flights: &FirstFlights) -> f64 {
        let [x, y, z] = degrees(&self.body, self.degree);
        let places = (0..x * y * z).map(|at| [at / (y * z), at / z % y, at % z]);
        self.coefficients.iter().zip(places).map(|(c, place)| c * first_flights.at(place)).sum()
    }
}

/// First flights from a place into every polynomial.
pub(super) struct FirstFlights(Expansion);

impl FirstFlights {
    pub(super) fn from(body: &Body, degree: usize, place: [f64; 3]) -> Self {
        let count = degrees(body, degree);
        let mut moments = vec![0.0; count[0] * count[1] * count[2]];
        for octant in 0..1_usize << body.axes() {
            let back = |axis: usize| octant >> axis & 1 == 1;
            let reach: [f64; 3] = std::array::from_fn(|axis| match back(axis) {
                _ if axis >= body.axes() => 1.0,
                true => place[axis],
                false => (body.sides[axis] - place[axis]).max(0.0),
            });
            let table = |axis: usize, u: f64, out: &mut [f64]| {
                let at = if back(axis) { place[axis] - u } else { place[axis] + u };
                let mut all = vec![0.0; degree];
                legendre(at / body.sides[axis], &mut all);
                let scale = 1.0 / body.sides[axis].sqrt();
                out.iter_mut().enumerate().for_each(|(i, out)| *out = scale * all[step(axis) * i]);
            };
            // One factor of that degree here, two in the matrix.
            let orders = orders(body, degree.div_ceil(2));
            let part = integrals(Flight::Collision, reach, body.endless, orders, count, &table);
            moments.iter_mut().zip(part).for_each(|(sum, part)| *sum += part);
        }
        FirstFlights(Expansion { body: *body, degree, coefficients: moments })
    }

    fn at(&self, place: [usize; 3]) -> f64 {
        self.0.coefficients[self.0.at(place)]
    }

    /// The fluence of an even source of unit power, uncollided.
    pub(super) fn uniform(&self) -> f64 {
        self.at([0; 3]) / self.0.body.volume().sqrt()
    }
}
