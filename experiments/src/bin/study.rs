//! The study.
fn main() {}
