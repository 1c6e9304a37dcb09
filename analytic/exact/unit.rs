//! Units: what a value is a multiple of.

use serde::{Serialize, Serializer};
use std::fmt;

/// The unit of a value, chosen where the value is made.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Unit {
    /// A pure number.
    One,
    /// A power of a mean free path.
    Mfp(i8),
    /// A power of the unit of length that the user has chosen.
    Length(i8),
    /// `length^n`, n in the same row.
    LengthToN,
    /// A power of the kernel's radius.
    Radius(i8),
    /// As many dimensions in the denominator as space has.
    PerRadiusD,
    /// Power on the lit face.
    IncidentPower,
    /// Power on the lit face, per area.
    Irradiance,
    /// Irradiance per steradian.
    IrradiancePerSr,
    /// Power that leaves a face or a wall, per area.
    Exitance,
    /// Exitance per steradian.
    ExitancePerSr,
    /// Power of the source.
    EmittedPower,
    /// Power that is emitted at the place in the same row.
    EmittedThere,
    /// Power of the source, times a mean free path.
    PowerMfp,
    /// Power of the source, per squared mean free path.
    PowerPerMfp2,
    /// The same per steradian.
    PowerPerMfp2Sr,
    /// Power of the source per volume, times a length.
    SourcePerVolumeLength,
    /// What a black wall of the temperature of the medium sends out, sigma T^4.
    BlackExitance,
    /// The same per side of the cube.
    BlackExitancePerSide,
    /// Power of the source, per squared length.
    PowerPerLength2,
    /// The unit of `--first`.
    First,
    /// The fluence in the middle.
    Middle,
    /// The field at the probe.
    Field,
    /// The field in front of a wall.
    FieldInFront,
    /// The same of a ball that no face cuts.
    WholeBall,
    /// The same of the first pass.
    FirstPass,
}

/// A power of a length by name.
fn power(f: &mut fmt::Formatter<'_>, name: &str, n: i8) -> fmt::Result {
    match n {
        -1 => write!(f, "1/{name}"),
        1 => write!(f, "{name}"),
        n if n < 0 => write!(f, "1/{name}^{}", -n),
        n => write!(f, "{name}^{n}"),
    }
}

impl fmt::Display for Unit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Unit::Mfp(n) => return power(f, "mfp", *n),
            Unit::Length(n) => return power(f, "length", *n),
            Unit::Radius(n) => return power(f, "radius", *n),
            Unit::One => "1",
            Unit::LengthToN => "length^n",
            Unit::PerRadiusD => "1/radius^d",
            Unit::IncidentPower => "incident power",
            Unit::Irradiance => "irradiance",
            Unit::IrradiancePerSr => "irradiance/sr",
            Unit::Exitance => "exitance",
            Unit::ExitancePerSr => "exitance/sr",
            Unit::EmittedPower => "emitted power",
            Unit::EmittedThere => "emitted there",
            Unit::PowerMfp => "power mfp",
            Unit::PowerPerMfp2 => "power/mfp^2",
            Unit::PowerPerMfp2Sr => "power/(mfp^2 sr)",
            Unit::SourcePerVolumeLength => "length power/volume",
            Unit::BlackExitance => "sigma T^4",
            Unit::BlackExitancePerSide => "sigma T^4/side",
            Unit::PowerPerLength2 => "power/length^2",
            Unit::First => "unit of first",
            Unit::Middle => "middle",
            Unit::Field => "field",
            Unit::FieldInFront => "field in front",
            Unit::WholeBall => "whole ball",
            Unit::FirstPass => "first pass",
        })
    }
}

impl Serialize for Unit {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}
