//! How beams are blurred, and how long they are.

/// In how many dimensions beams are blurred. The variance falls with the radius as it does whatever the blur; the bias is of the square
/// of the radius with another factor.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum BeamBlur {
    /// As few as there are: along the line across a ray and a beam; at a place, where there is no such line, across the beam.
    #[default]
    OneD,
    /// Across the ray; at a place across the beam.
    TwoD,
    /// In the ball about a place. Rays are not read so.
    ThreeD,
}

impl BeamBlur {
    /// All.
    pub const ALL: [BeamBlur; 3] = [BeamBlur::OneD, BeamBlur::TwoD, BeamBlur::ThreeD];

    /// Its name in files and tables.
    pub fn name(self) -> &'static str {
        match self {
            BeamBlur::OneD => "1d",
            BeamBlur::TwoD => "2d",
            BeamBlur::ThreeD => "3d",
        }
    }
}
