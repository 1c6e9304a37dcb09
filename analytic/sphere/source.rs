//! The three sources.

/// Where the light of a sphere comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SphereSource {
    /// Isotropic emission of unit power, spread evenly over the volume.
    Uniform,
    /// An isotropic point source of unit power at the centre.
    Centre,
    /// Radiance 1/pi from outside on the whole surface: irradiance 1, power 4 pi a^2.
    Incident,
}
