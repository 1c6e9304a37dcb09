//! How far flights go as beams.

/// How far a beam goes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum BeamLength {
    /// As far as the flight that was sampled.
    #[default]
    Sampled,
    /// To the end of the medium, with what passes (in closed form where it is homogeneous, tracked elsewhere), while the walk goes on from
    /// the sampled collision: less variance a photon, and more beams about every ray, in variance times beams never less.
    Whole,
}

impl BeamLength {
    /// Both.
    pub const ALL: [BeamLength; 2] = [BeamLength::Sampled, BeamLength::Whole];

    /// Its name in files and tables.
    pub fn name(self) -> &'static str {
        match self {
            BeamLength::Sampled => "sampled",
            BeamLength::Whole => "whole",
        }
    }
}
