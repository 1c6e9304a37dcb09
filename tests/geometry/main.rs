//! Shapes of many parts, meshes and lathes, against shapes of one part, brute force and closed forms.
#![allow(clippy::unwrap_used, reason = "tests")]

#[path = "../common/mod.rs"]
mod common;
#[path = "../support/mod.rs"]
mod support;

mod distance;
mod files;
mod height_field;
mod lathe;
mod meshes;
mod solids;
