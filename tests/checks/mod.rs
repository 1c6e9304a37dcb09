//! Checks that several suites run: each asserts by itself in the suite that it belongs to, and on trial, with a fault
//! planted, in the suite of faults.
#![allow(dead_code, reason = "the faults use a part")]

pub mod along_rays;
pub mod beams;
pub mod cell;
pub mod color;
pub mod connected;
pub mod emitters;
pub mod flights;
pub mod fog;
pub mod gathers;
pub mod glass;
pub mod guided;
pub mod ledger;
pub mod light;
pub mod media;
pub mod numbers;
pub mod outputs;
pub mod phase;
pub mod planes;
pub mod point_light;
pub mod points;
pub mod progressive;
pub mod shading;
pub mod slab;
pub mod threads;
pub mod walls;
pub mod weights;
