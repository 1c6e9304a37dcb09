//! Files that appear whole or not at all: tables that keep every bit, pictures, point clouds.

mod atomic;
mod bins;
mod error_picture;
mod exr;
mod npy;
mod panic;
mod ply;
mod signal;
mod stdout;
mod table;
mod tone;

pub use atomic::{WriteError, check_writable, is_same_file, write_and_hold, write_atomically};
pub use bins::{npy, voxel_grid};
pub use error_picture::{error_scale, write_error_picture};
pub use exr::{PROVENANCE, encode_exr, write_exr};
pub use npy::write_photons_npy;
pub use panic::without_panic;
pub use ply::write_ply;
pub use signal::end_on_signal;
pub use stdout::{ignore_closed_pipe, one_line, print};
pub use table::{Format, RunInfo, write_aligned, write_csv, write_json, write_rows};
pub use tone::{Curve, Tone, auto_exposure, to_srgb, write_png};
