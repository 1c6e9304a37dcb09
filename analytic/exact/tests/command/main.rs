//! The command: its answers, its refusals, its handbook.
#![allow(clippy::unwrap_used, reason = "tests")]

mod cases;
mod cli;
mod files;
mod handbook;
mod layers;
