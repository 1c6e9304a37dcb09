//! Planes: what a flight through a medium and a scattering on it sweep out together, the tree over them, and maps of them.

mod crossing;
mod flight;
mod map;
mod plane;
mod tree;

pub use crossing::PlaneCrossing;
pub use flight::check_planes;
pub(in crate::photons) use flight::second_leg;
pub use map::PlaneMap;
pub use plane::Plane;
pub use tree::PlaneTree;

/// Most memory that a plane takes on its way into a map \[bytes\]: 128 as a record, twice while records are brought together, and, of
/// eight pieces at most, 12 each, 24 of a box, as much packed, 16 of what sorts them and 12 in order.
pub const PEAK_BYTES: f64 = 960.0;
