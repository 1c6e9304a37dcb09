//! What theory says of an estimator on a line: mean, mean squared error and look-ups, in closed form or by quadrature.

use super::estimators::{Estimator, LEVEL};
use super::line::{Line, Places};
use super::series::Orders;
use libm::{exp, expm1, log1p};
use turbid::medium::Bound;
use turbid_analytic::power_series;
use turbid_analytic::quadrature::GaussLegendre;

/// What is expected of one estimate, relative to the transmittance T.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Expected {
    /// Mean over T, less 1.
    pub bias: f64,
    /// Mean of the squared error, over T^2.
    pub squared: f64,
    /// Mean number of densities looked up.
    pub look_ups: f64,
}

impl Expected {
    fn unbiased(squared: f64, look_ups: f64) -> Self {
        Expected { bias: 0.0, squared, look_ups }
    }

    /// What a mean of independent estimates costs to a relative variance of 1, in look-ups.
    pub fn work(&self) -> f64 {
        self.squared * self.look_ups
    }
}

/// What theory says of an estimator.
pub fn expected(line: &Line, estimator: &Estimator) -> Expected {
    let ((low, high), depth) = (line.bounds(), line.depth());
    match estimator {
        Estimator::Analogue => Expected::unbiased(expm1(depth), line.reached(|_, _| high, |mu, _| mu)),
        Estimator::Ratio => expected(line, &Estimator::Residual(0.0)),
        Estimator::Residual(control) => {
            let rate = (high - control).max(control - low);
            let exponent = match rate > 0.0 {
                true => line.integral(|mu, _| (mu - control) * (mu - control) / rate),
                false => 0.0,
            };
            // What lets nothing pass ends the tracking.
            let ends = |mu: f64, _: &Bound| if is_all(mu - control, rate) { rate } else { 0.0 };
            Expected::unbiased(expm1(exponent), line.reached(|_, _| rate.max(0.0), ends))
        }
        Estimator::Local => {
            let exponent = line.integral(|mu, b| match b.high > b.low {
                true => (mu - b.low) * (mu - b.low) / (b.high - b.low),
                false => 0.0,
            });
            let width = |b: &Bound| b.high - b.low;
            let ends = |mu: f64, b: &Bound| if is_all(mu - b.low, width(b)) { width(b) } else { 0.0 };
            Expected::unbiased(expm1(exponent), line.reached(|_, b| width(b), ends))
        }
        Estimator::Series { orders, pivot } => series(line, depth, *orders, *pivot),
        Estimator::Comb { orders, places, teeth } => combs(line, depth, *orders, places, *teeth),
        Estimator::March(count) => {
            let march = Marches::new(line, depth);
            let n = f64::from(*count);
            let (mean, square) = (expm1(march.ln(1.0, n)), exp(march.ln(2.0, n)));
            Expected { bias: mean, squared: square - 1.0 - 2.0 * mean, look_ups: n }
        }
        Estimator::Marched(places, teeth) => {
            let nodes = Nodes::new(line, depth, places, *teeth);
            let mean = nodes.mean(|y| expm1(-y));
            let squared = nodes.mean(|y| expm1(-y) * expm1(-y));
            Expected { bias: mean, squared, look_ups: look_ups(places, *teeth) }
        }
        Estimator::Jackknife(count) => jackknife(&Marches::new(line, depth), f64::from(*count)),
        Estimator::Telescoped(first) => telescoped(&Marches::new(line, depth), f64::from(*first)),
    }
}

fn look_ups(places: &Places, teeth: u32) -> f64 {
    if places.is_empty() { 0.0 } else { f64::from(teeth) }
}

/// Whether a tentative collision of such a rate, over a control, lets nothing pass.
fn is_all(extinction: f64, rate: f64) -> bool {
    rate > 0.0 && extinction >= rate * (1.0 - 1e-12)
}

/// Places at random, each with its own factor: E P_k P_l is b^min a^|k-l|, a = pivot - tau, b = E (pivot - Y)^2, and the order
/// reaches both with the chance of the larger.
fn series(line: &Line, depth: f64, orders: Orders, pivot: f64) -> Expected {
    let b: f64 = line.nodes().iter().map(|(y, w)| w * (pivot - y) * (pivot - y)).sum();
    let a = pivot - depth;
    // Terms fall by factorials once past the root of b.
    let count = 60 + 4 * b.sqrt() as usize;
    let mut terms = Vec::new();
    // b^k / (k!^2 Q_k), and what follows it by powers of a.
    let mut own = 1.0;
    for k in 0..count {
        let reached = match orders {
            Orders::Geometric(q) => libm::pow(q, k as f64),
            Orders::Seldom => orders.reaches(k),
        };
        let (mut tail, mut power) = (0.0, 1.0);
        for l in 1..40 {
            power *= a / (k + l) as f64;
            tail += 2.0 * power;
        }
        terms.push(own / reached * (1.0 + tail));
        own *= b / ((k + 1) * (k + 1)) as f64;
    }
    let square: f64 = terms.iter().rev().sum();
    Expected::unbiased(exp(2.0 * (depth - pivot)) * square - 1.0, orders.mean())
}

/// Marches of places at random, relative to T.
struct Marches {
    /// Y - tau of places with their weights.
    nodes: Vec<(f64, f64)>,
}

impl Marches {
    fn new(line: &Line, depth: f64) -> Self {
        Marches { nodes: line.nodes().into_iter().map(|(y, w)| (y - depth, w)).collect() }
    }

    /// ln of E exp(-x (Y - tau)).
    fn one(&self, x: f64) -> f64 {
        log1p(self.nodes.iter().map(|(y, w)| w * expm1(-x * y)).sum())
    }

    /// ln of E F^power of a march of n places.
    fn ln(&self, power: f64, n: f64) -> f64 {
        n * self.one(power / n)
    }
}

/// n F_n - (n-1) mean of F_{n-1} over what is left out.
fn jackknife(march: &Marches, n: f64) -> Expected {
    let m = n - 1.0;
    let bias = n * expm1(march.ln(1.0, n)) - m * expm1(march.ln(1.0, m));
    let both = m * march.one(1.0 / n + 1.0 / m) + march.one(1.0 / n);
    // Two that leave out different places share the other n - 2.
    let apart = (n - 2.0) * march.one(2.0 / m) + 2.0 * march.one(1.0 / m);
    let left_out = exp(march.ln(2.0, m)) / n + m / n * exp(apart);
    let square = n * n * exp(march.ln(2.0, n)) - 2.0 * n * m * exp(both) + m * m * left_out;
    Expected { bias, squared: square - 1.0 - 2.0 * bias, look_ups: n }
}

/// Mean squared difference between a march of 2 `half` places and the mean of its halves, over T^2.
fn squared_difference(march: &Marches, half: f64) -> f64 {
    let n = 2.0 * half;
    let whole = march.ln(2.0, n);
    let with_half = half * march.one(3.0 / n) + half * march.one(1.0 / n) - whole;
    let of_half = half * march.one(4.0 / n) - whole;
    exp(whole) * (0.5 * expm1(of_half) - 2.0 * expm1(with_half))
}

/// A first march, and a difference divided by its chance; the differences sum to what the first march has too much.
fn telescoped(march: &Marches, first: f64) -> Expected {
    const LEVELS: i32 = 13;
    let start = expm1(march.ln(1.0, first));
    let square = exp(march.ln(2.0, first));
    let (mut half, mut chance, mut sum, mut last) = (first, 1.0 - LEVEL, 0.0, 0.0);
    for _ in 0..LEVELS {
        last = squared_difference(march, half) / chance;
        sum += last;
        (half, chance) = (2.0 * half, chance * LEVEL);
    }
    // Behind them each level is 2^(-1/2) of the one before.
    let fall = 0.25 / LEVEL;
    sum += last * fall / (1.0 - fall);
    let squared = square - 2.0 * start * (1.0 + start) + sum - 1.0;
    let look_ups = first * (1.0 + 2.0 * (1.0 - LEVEL) / (1.0 - 2.0 * LEVEL));
    Expected::unbiased(squared, look_ups)
}

/// Mean squared difference of halves of so many places on a line, over T^2.
pub fn difference(line: &Line, half: u64) -> f64 {
    squared_difference(&Marches::new(line, line.depth()), half as f64)
}

/// What a comb says beside the optical depth, by its offset, with weights.
struct Nodes(Vec<(f64, f64)>);

impl Nodes {
    fn new(line: &Line, depth: f64, places: &Places, teeth: u32) -> Self {
        let teeth = f64::from(teeth);
        // Offsets at which a tooth passes a break; eight pieces at least, and where there are too many, even ones.
        let mut edges: Vec<f64> = line.edges_in(places).iter().map(|v| (v * teeth).fract()).collect();
        edges.sort_by(f64::total_cmp);
        edges.dedup_by(|a, b| *a - *b < 1e-9);
        const MOST: usize = 64;
        if edges.len() > MOST {
            edges.clear();
        }
        let even = if edges.is_empty() { MOST } else { 8 };
        edges.extend((0..=even).map(|i| i as f64 / even as f64));
        edges.sort_by(f64::total_cmp);
        edges.dedup_by(|a, b| *a - *b < 1e-9);
        let mut nodes = Vec::new();
        let Ok(rule) = GaussLegendre::new(2) else { return Nodes(nodes) };
        for ends in edges.windows(2) {
            rule.integrate(ends[0], ends[1], |offset| {
                let tooth = |i: u32| places.depth_at(line, (f64::from(i) + offset) / teeth);
                let sum: f64 = (0..teeth as u32).map(tooth).sum();
                nodes.push((places.control + sum / teeth - depth, 0.5 * (ends[1] - ends[0])));
                0.0
            });
        }
        Nodes(nodes)
    }

    fn mean(&self, f: impl Fn(f64) -> f64) -> f64 {
        self.0.iter().map(|(y, w)| w * f(*y)).sum()
    }
}

/// The second moment of combs about one of several, by [`power_series`].
fn combs(line: &Line, depth: f64, orders: Orders, places: &Places, teeth: u32) -> Expected {
    let look_ups = look_ups(places, teeth) * (1.0 + orders.mean());
    if places.is_empty() {
        return Expected::unbiased(0.0, 0.0);
    }
    let nodes = Nodes::new(line, depth, places, teeth);
    let total = power_series::second_moment(&nodes.0, |k| orders.reaches(k));
    // Higher orders count as if they were exact; combs that all say the same leave a rounding.
    let counted = 1.0 - orders.reaches(power_series::ORDERS + 1);
    Expected::unbiased((total - counted).max(0.0), look_ups)
}
