//! Sources from radiance: S(mu) = (albedo/2) int h(mu, mu') J(mu') dmu', h = sum_l (2l+1) chi_l P_l(mu) P_l(mu').

use super::directions::Directions;

/// The scattering operator on the directions of both hemispheres, through Legendre moments.
pub(super) struct Scattering {
    /// P_l(mu) per moment with chi_l != 0, for the even and for the odd l.
    parity: [Vec<Term>; 2],
    weight: Vec<f64>,
}

struct Term {
    /// (albedo/2) (2l+1) chi_l.
    factor: f64,
    p: Vec<f64>,
}

/// Light going up and light going down: per direction, per depth.
#[derive(Clone)]
pub(super) struct Field {
    pub up: Vec<Vec<f64>>,
    pub down: Vec<Vec<f64>>,
}

impl Field {
    pub fn zero(directions: usize, depths: usize) -> Self {
        Field { up: vec![vec![0.0; depths]; directions], down: vec![vec![0.0; depths]; directions] }
    }
}

impl Scattering {
    pub fn new(directions: &Directions, albedo: f64, moments: &[f64]) -> Self {
        let mut parity = [Vec::new(), Vec::new()];
        let tables: Vec<Vec<f64>> = directions.mu.iter().map(|&mu| legendre(moments.len(), mu)).collect();
        for (l, &chi) in moments.iter().enumerate() {
            if chi != 0.0 {
                let factor = 0.5 * albedo * (2 * l + 1) as f64 * chi;
                parity[l % 2].push(Term { factor, p: tables.iter().map(|table| table[l]).collect() });
            }
        }
        Scattering { parity, weight: directions.weight.clone() }
    }

    /// Replaces the radiance by its sources, at all depths.
    pub fn scatter(&self, field: &mut Field) {
        let depths = field.up[0].len();
        // Sum and difference of the hemispheres take the place of the two.
        for (up, down) in field.up.iter_mut().zip(&mut field.down) {
            for (a, b) in up.iter_mut().zip(down) {
                (*a, *b) = (*a + *b, *a - *b);
            }
        }
        for (terms, rows) in self.parity.iter().zip([&mut field.up, &mut field.down]) {
            let mut moments = vec![vec![0.0; depths]; terms.len()];
            for (term, moment) in terms.iter().zip(&mut moments) {
                let factors: Vec<f64> =
                    term.p.iter().zip(&self.weight).map(|(p, w)| term.factor * p * w).collect();
                combine(&factors, rows, moment);
            }
            for (i, row) in rows.iter_mut().enumerate() {
                let factors: Vec<f64> = terms.iter().map(|term| term.p[i]).collect();
                row.fill(0.0);
                combine(&factors, &moments, row);
            }
        }
        for (up, down) in field.up.iter_mut().zip(&mut field.down) {
            for (a, b) in up.iter_mut().zip(down) {
                (*a, *b) = (*a + *b, *a - *b);
            }
        }
    }
}

/// out += sum of factor times row, eight rows at a time.
fn combine(factors: &[f64], rows: &[Vec<f64>], out: &mut [f64]) {
    let n = out.len();
    let mut i = 0;
    while i + 8 <= factors.len() {
        let f: [f64; 8] = std::array::from_fn(|k| factors[i + k]);
        let r: [&[f64]; 8] = std::array::from_fn(|k| &rows[i + k][..n]);
        for (j, o) in out.iter_mut().enumerate() {
            *o += (f[0] * r[0][j] + f[1] * r[1][j])
                + (f[2] * r[2][j] + f[3] * r[3][j])
                + (f[4] * r[4][j] + f[5] * r[5][j])
                + (f[6] * r[6][j] + f[7] * r[7][j]);
        }
        i += 8;
    }
    for (f, row) in factors[i..].iter().zip(&rows[i..]) {
        out.iter_mut().zip(row).for_each(|(o, r)| *o += f * r);
    }
}

/// P_0(x) to P_(count-1)(x).
pub(super) fn legendre(count: usize, x: f64) -> Vec<f64> {
    let mut p = vec![1.0, x];
    for l in 2..count {
        let n = l as f64;
        p.push(((2.0 * n - 1.0) * x * p[l - 1] - (n - 1.0) * p[l - 2]) / n);
    }
    p.truncate(count);
    p
}

/// sum_l (2l+1) chi_l P_l(x) P_l(y), y by its table, and the sum of the magnitudes.
pub(super) fn mean_phase(moments: &[f64], x: f64, table: &[f64]) -> (f64, f64) {
    let (mut value, mut magnitude) = (0.0, 0.0);
    let (mut before, mut p) = (0.0, 1.0);
    for (l, (chi, y)) in moments.iter().zip(table).enumerate() {
        let n = l as f64;
        let term = (2.0 * n + 1.0) * chi * p * y;
        value += term;
        magnitude += term.abs();
        let next = ((2.0 * n + 1.0) * x * p - n * before) / (n + 1.0);
        before = p;
        p = next;
    }
    (value, magnitude)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scattering_conserves_photons_and_turns_by_g() {
        let g = 0.6_f64;
        let moments: Vec<f64> = (0..40).map(|l| g.powi(l)).collect();
        let directions = Directions::new(moments.len(), 1.0, 1e-12);
        let operator = Scattering::new(&directions, 0.8, &moments);
        let mut field = Field::zero(directions.len(), 1);
        for (i, &mu) in directions.mu.iter().enumerate() {
            field.up[i][0] = mu * mu;
            field.down[i][0] = 2.0 + mu;
        }
        let moment = |field: &Field, power: i32| -> f64 {
            let sum = |i: usize, sign: f64, row: &Vec<f64>| {
                directions.weight[i] * row[0] * (sign * directions.mu[i]).powi(power)
            };
            (0..directions.len()).map(|i| sum(i, 1.0, &field.up[i]) + sum(i, -1.0, &field.down[i])).sum()
        };
        let before = (moment(&field, 0), moment(&field, 1));
        operator.scatter(&mut field);
        let after = (moment(&field, 0), moment(&field, 1));
        assert!((after.0 - 0.8 * before.0).abs() < 1e-13 && (after.1 - 0.48 * before.1).abs() < 1e-13);
    }

    #[test]
    fn the_azimuthal_mean_of_one_value() {
        // Rayleigh: 1 + P_2(x) P_2(y)/2.
        let (value, magnitude) = mean_phase(&[1.0, 0.0, 0.1], 0.3, &legendre(3, -0.8));
        let p2 = |x: f64| 1.5 * x * x - 0.5;
        assert!((value - 1.0 - 0.5 * p2(0.3) * p2(0.8)).abs() < 1e-15 && magnitude >= value.abs());
    }
}
