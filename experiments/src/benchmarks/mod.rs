//! Benchmarks of other communities: their published numbers beside ours, each difference over the combined error.
//!
//! `benchmarks` runs the sets of [`sets::ALL`], keeps the answer of each in a file, and writes one page. A set asks the
//! referee, the simulator or both; every comparison has a sum of squares, its p and a verdict.

mod comparison;
mod pack;
mod page;
mod plot;
mod published;
mod run;
mod scene;
mod set;
pub mod sets;
mod settings;
mod slab_map;

pub use comparison::{Answered, Comparison, Row, Verdict};
pub use published::Published;
pub use run::main;
pub use scene::Bench;
pub use set::{Plot, Set};
