//! A stretch of a ray through a medium, and the places on it that estimators ask.

use turbid::math::{Interval, Ray};
use turbid::medium::{Bound, Medium};
use turbid_analytic::quadrature::GaussLegendre;

/// Nodes of Gauss and Legendre between two places where the extinction bends: exact for the square of a cubic, and to some
/// 1e-12 for an exponential of a piece.
const NODES: usize = 8;
/// Even pieces that every line has.
const PIECES: u32 = 16;

/// A stretch of a ray through a medium.
#[derive(Debug, Clone)]
pub struct Line {
    medium: Medium,
    ray: Ray,
    part: Interval,
    sigma_t: f64,
    /// Bounds of the extinction [1/L], as the renderer knows them.
    stretches: Vec<Bound>,
    /// Where pieces end on which the extinction is smooth, the ends included \[L\].
    edges: Vec<f64>,
}

impl Line {
    /// The stretch `part` of a ray; `breaks` are where the density jumps or bends on it, in any order \[L\].
    pub fn new(medium: Medium, ray: Ray, part: Interval, breaks: Vec<f64>) -> Self {
        let sigma_t = medium.matter().sigma_t()[0];
        let scaled = |b: Bound| Bound { low: b.low * sigma_t, high: b.high * sigma_t, ..b };
        let stretches: Vec<Bound> = match medium.density() {
            Some(density) => density.along(&ray, part).map(scaled).collect(),
            None => vec![Bound { interval: part, low: sigma_t, high: sigma_t }],
        };
        let mut edges = breaks;
        edges.extend(stretches.iter().flat_map(|b| [b.interval.start, b.interval.end]));
        edges.retain(|t| part.start < *t && *t < part.end);
        // A smooth density that bends everywhere has pieces too.
        edges.extend((0..=PIECES).map(|i| part.start + part.length() * f64::from(i) / f64::from(PIECES)));
        edges.sort_by(f64::total_cmp);
        edges.dedup();
        Line { medium, ray, part, sigma_t, stretches, edges }
    }

    /// The medium, the ray and the part of it.
    pub fn way(&self) -> (&Medium, &Ray, Interval) {
        (&self.medium, &self.ray, self.part)
    }

    /// Extinction at a distance along the ray [1/L].
    pub fn extinction(&self, t: f64) -> f64 {
        match self.medium.density() {
            Some(density) => self.sigma_t * density.at(self.ray.at(t)),
            None => self.sigma_t,
        }
    }

    /// Its length \[L\].
    pub fn length(&self) -> f64 {
        self.part.length()
    }

    /// A distance along the ray, by its part of the stretch \[L\].
    pub fn at(&self, part: f64) -> f64 {
        self.part.start + part * self.part.length()
    }

    /// The bounds of the whole [1/L].
    pub fn bounds(&self) -> (f64, f64) {
        let wider = |(low, high): (f64, f64), b: &Bound| (low.min(b.low), high.max(b.high));
        let (low, high) = self.stretches.iter().fold((f64::INFINITY, 0.0), wider);
        (low.min(high), high)
    }

    /// The bounds at a distance along the ray that is not an end of theirs.
    fn bound_at(&self, t: f64) -> &Bound {
        let place = self.stretches.partition_point(|b| b.interval.end <= t);
        &self.stretches[place.min(self.stretches.len() - 1)]
    }

    /// The integral of a function of extinction and bounds over the stretch, by quadrature between its breaks.
    pub fn integral(&self, f: impl Fn(f64, &Bound) -> f64) -> f64 {
        let Ok(rule) = GaussLegendre::new(NODES) else { return f64::NAN };
        let of_piece = |ends: &[f64]| {
            let bound = self.bound_at(0.5 * (ends[0] + ends[1]));
            rule.integrate(ends[0], ends[1], |t| f(self.extinction(t), bound))
        };
        self.edges.windows(2).map(of_piece).sum()
    }

    /// Optical depth \[1\].
    pub fn depth(&self) -> f64 {
        self.integral(|mu, _| mu)
    }

    /// What a place at random says of the optical depth, the extinction there times the length, with weights of sum 1.
    pub fn nodes(&self) -> Vec<(f64, f64)> {
        let Ok(rule) = GaussLegendre::new(NODES) else { return Vec::new() };
        let of_piece = |ends: &[f64]| {
            let (start, piece) = (ends[0], ends[1] - ends[0]);
            let node = |(x, w): (&f64, &f64)| {
                (self.extinction(start + x * piece) * self.length(), w * piece / self.length())
            };
            rule.nodes.iter().zip(&rule.weights).map(node).collect::<Vec<_>>()
        };
        self.edges.windows(2).flat_map(of_piece).collect()
    }

    /// Mean number of tentative collisions of a rate [1/L] before one of another rate ends the tracking, or the line does; both by
    /// extinction and bounds.
    pub fn reached(&self, rate: impl Fn(f64, &Bound) -> f64, ends: impl Fn(f64, &Bound) -> f64) -> f64 {
        /// Steps on a piece, within which the ending rate is the same.
        const STEPS: u32 = 8;
        let (mut passed, mut sum) = (1.0, 0.0);
        for piece in self.edges.windows(2) {
            let step = (piece[1] - piece[0]) / f64::from(STEPS);
            for i in 0..STEPS {
                let middle = piece[0] + (f64::from(i) + 0.5) * step;
                let (mu, bound) = (self.extinction(middle), self.bound_at(middle));
                let depth = ends(mu, bound) * step;
                let held = if depth > 1e-12 { -libm::expm1(-depth) / depth } else { 1.0 };
                sum += passed * held * rate(mu, bound) * step;
                passed *= libm::exp(-depth);
            }
        }
        sum
    }

    /// Places evenly spread over the length.
    pub fn even(&self) -> Places {
        let all = Span { from: 0.0, start: self.part.start, rate: self.part.length(), low: 0.0, width: 1.0 };
        Places { control: 0.0, total: self.part.length(), spans: vec![all] }
    }

    /// Places spread as the difference of the bounds is; the lower bounds are the control.
    pub fn by_bounds(&self) -> Places {
        let width = |b: &Bound| b.high - b.low;
        let control = self.stretches.iter().map(|b| b.low * b.interval.length()).sum();
        let total: f64 = self.stretches.iter().map(|b| width(b) * b.interval.length()).sum();
        let (mut spans, mut sum) = (Vec::new(), 0.0);
        for b in self.stretches.iter().filter(|b| width(b) > 0.0) {
            let (from, rate) = (sum / total, total / width(b));
            spans.push(Span { from, start: b.interval.start, rate, low: b.low, width: width(b) });
            sum += width(b) * b.interval.length();
        }
        Places { control, total, spans }
    }

    /// Where the extinction bends, in the coordinate of places.
    pub fn edges_in(&self, places: &Places) -> Vec<f64> {
        self.edges.iter().map(|&t| places.coordinate(t)).collect()
    }
}

/// A stretch of the ray over which places are spread evenly.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Span {
    /// Coordinate of its start, 0 to 1.
    from: f64,
    /// Distance of its start \[L\].
    start: f64,
    /// Distance over coordinate \[L\].
    rate: f64,
    /// The control [1/L], and what a place's share of the optical depth is divided by [1/L].
    low: f64,
    width: f64,
}

/// Places on a line by a coordinate from 0 to 1. What they say of the optical depth: that of the control, and the mean over
/// the coordinate of what is said at each.
#[derive(Debug, Clone, PartialEq)]
pub struct Places {
    /// Optical depth of the control \[1\].
    pub control: f64,
    total: f64,
    spans: Vec<Span>,
}

impl Places {
    /// Whether anything is left to ask: where the bounds meet, the control is all.
    pub fn is_empty(&self) -> bool {
        self.spans.is_empty()
    }

    /// Tentative collisions that ratio tracking between the same bounds has in the mean, unless nothing is left to pass.
    pub fn total(&self) -> f64 {
        self.total
    }

    /// What the place of a coordinate says of the optical depth beside the control \[1\].
    pub fn depth_at(&self, line: &Line, v: f64) -> f64 {
        let place = self.spans.partition_point(|s| s.from <= v).max(1) - 1;
        let Some(span) = self.spans.get(place) else { return 0.0 };
        let t = span.start + (v - span.from) * span.rate;
        (line.extinction(t) - span.low) * self.total / span.width
    }

    /// The coordinate of a distance along the ray.
    fn coordinate(&self, t: f64) -> f64 {
        let place = self.spans.partition_point(|s| s.start <= t).max(1) - 1;
        self.spans.get(place).map_or(0.0, |s| (s.from + ((t - s.start) / s.rate).max(0.0)).min(1.0))
    }
}
