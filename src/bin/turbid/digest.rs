//! A number that stands for bytes.

/// Where a digest begins and what it is multiplied by (Fowler, Noll and Vo, FNV-1a of 64 bits).
const FNV: (u64, u64) = (0xcbf2_9ce4_8422_2325, 0x0100_0000_01b3);

/// A digest of bytes so far.
#[derive(Clone, Copy)]
pub struct Digest(u64);

impl Digest {
    /// That of no bytes.
    pub const EMPTY: Digest = Digest(FNV.0);

    /// That after more bytes.
    #[must_use]
    pub fn with(self, bytes: &[u8]) -> Self {
        Digest(bytes.iter().fold(self.0, |digest, byte| (digest ^ u64::from(*byte)).wrapping_mul(FNV.1)))
    }

    /// The number.
    pub fn number(self) -> u64 {
        self.0
    }
}
