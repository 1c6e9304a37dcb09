//! Walks of light: bits that stay, invariants, extremes, and classes of paths by every method.

mod bidirectional;
mod bins;
mod deep;
mod ends;
mod extremes;
mod golden;
mod guided;
mod invariants;
mod lamps;
mod ledger;
mod light_tracing;
mod matched;
mod path_classes;
mod plan;
mod shading;
