//! Uncollided light of a beam aslant in a slab, whose error is known exactly: who asks it, what theory says, and how it is read.

mod case;
mod field;
mod query;
mod read;

pub use case::Case;
pub use field::{DEPTH, MU0, SPAN, places, scene};
pub use query::Query;
pub use read::{Uncollided, along_beams, along_points, at_place, beams_at_place};
