//! Questions to the referee: each problem with its arguments, its range and its answer in rows, a file a problem.
//!
//! The program `exact` asks them from the command line ([`program`]); other programs ask by name ([`Asker`]), of what
//! [`problems`] lists.

mod answer;
mod asker;
mod beams;
mod boundary;
mod cases;
mod cavity;
mod command;
mod critical;
mod cuboid;
mod emitting_cube;
mod format;
mod fresnel;
mod half_space;
mod infinite;
mod input;
mod kernel;
mod layers;
mod method;
mod nearest;
mod nested;
mod output;
mod path;
mod phase;
mod plot;
mod problem;
pub mod program;
mod progressive;
mod question;
mod read;
mod slab;
mod sphere;
mod text;
mod thick;
mod two_stream;
mod typed;
mod unit;
mod usage;
mod xy;

pub use answer::{Answer, Field, Fields, Row};
pub use asker::Asker;
pub use problem::{Argument, Problem, Takes, problems};
pub use unit::Unit;
