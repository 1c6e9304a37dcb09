//! A surface that absorbs everything.

/// No light leaves it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Black;
