//! built-in scenes
/// x
pub struct Builtin;
/// x
pub const BUILTIN: [Builtin; 0] = [];
