//! What photon maps cost beside paths in one scene: the answer to the study's question, as an experiment gives it.

use super::Estimate;

/// Name of the section that all answers together become, which opens the report.
pub const ANSWER: &str = "answer";

/// Queries of one map that answers are for; a picture's are its pixels' samples.
pub const QUERIES: u64 = 4096;

/// Root mean square errors that are asked about, relative to the exact value.
pub const TARGETS: [f64; 4] = [0.2, 0.1, 0.05, 0.03];

/// One scene: a row of the report's first table and, if drawn, a panel of its first figure.
#[derive(Debug, Clone, PartialEq)]
pub struct Answer {
    /// The scene, for readers.
    pub scene: String,
    /// For each of [`TARGETS`] what the cheapest map that reaches it saves, if one of those tried does.
    pub reached: [Option<Reached>; 4],
    /// The best of all maps tried with the faces of the medium untreated, if that is told apart.
    pub untreated: Option<Untreated>,
    /// Error and CPU time of photon maps and paths.
    pub curves: Option<Curves>,
}

/// The maps that reach an error at the least cost.
#[derive(Debug, Clone, PartialEq)]
pub struct Reached {
    /// CPU time that the path tracer takes to the error, over that of the fastest map, on this machine.
    pub time: Estimate,
    /// Queries of one map from which that map is the faster, where queries are asked one by one, and paths are clearly slower.
    pub pays_from: Option<Estimate>,
    /// Work of the path tracer over that of the map of the least work, counted in rays as in
    /// [`cost_model`](crate::cost_model): the same on every machine.
    pub work: Estimate,
    /// Root mean square of the fastest map's systematic error.
    pub bias: Estimate,
    /// The largest part of its error.
    pub limit: &'static str,
}

/// The smallest error with faces untreated.
#[derive(Debug, Clone, PartialEq)]
pub struct Untreated {
    /// Root mean square error.
    pub error: Estimate,
    /// The largest part of it.
    pub limit: &'static str,
}

/// A point of a curve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Point {
    /// CPU time \[s\].
    pub seconds: f64,
    /// Root mean square error, relative.
    pub error: f64,
    /// Its 95 per cent interval.
    pub interval: (f64, f64),
}

/// Error against CPU time.
#[derive(Debug, Clone, PartialEq)]
pub struct Curves {
    /// Maps with faces treated that no other map beats in both, the cheapest first.
    pub maps: Vec<Point>,
    /// The same with faces untreated; empty where that is not told apart.
    pub untreated: Vec<Point>,
    /// The path tracer: CPU time \[s\] and error, from one sample on.
    pub paths: Vec<(f64, f64)>,
}
