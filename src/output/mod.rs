//! Files that appear whole or not at all, and tables that keep every bit.

mod atomic;
mod stdout;
mod table;

pub use atomic::{WriteError, write_atomically};
pub use stdout::{ignore_closed_pipe, print};
pub use table::{Format, write_aligned, write_csv, write_json, write_rows};
