//! Path classes: what light has met on its way.

/// What a path has met before the event it is stored at.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Flags(u8);

impl Flags {
    /// Met nothing: direct light.
    pub const NONE: Flags = Flags(0);
    /// Met a specular surface (S).
    pub const SPECULAR: Flags = Flags(1);
    /// Met a non-specular surface (D).
    pub const DIFFUSE: Flags = Flags(2);
    /// Was scattered in a medium (M).
    pub const MEDIUM: Flags = Flags(4);

    /// The flags as bits: 1 specular, 2 surface, 4 medium.
    pub fn bits(self) -> u8 {
        self.0
    }

    /// The flags of these bits; none of others.
    pub fn of_bits(bits: u8) -> Option<Flags> {
        (bits < 8).then_some(Flags(bits))
    }

    /// Both sets of flags.
    pub fn with(self, other: Flags) -> Flags {
        Flags(self.0 | other.0)
    }

    /// Whether every flag of `other` is set.
    pub fn has(self, other: Flags) -> bool {
        self.0 & other.0 == other.0
    }

    /// Whether the path came straight from the light.
    pub fn is_direct(self) -> bool {
        self.0 == 0
    }
}
