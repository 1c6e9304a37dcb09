//! Mean path lengths: 4 V/S, whatever the medium scatters.
//!
//! Light that falls isotropically and evenly on the whole surface of a convex body of volume V and surface S travels
//! 4 V/S in it on the average before it leaves, if nothing is absorbed, for any phase function and any amount of
//! scattering: without scattering this is Cauchy's mean chord, and the uniform fluence that such light keeps up makes it
//! so with scattering. With absorption, the path to escape **or** absorption is l = A/(1-w) mean free paths, A the
//! absorbed fraction; in the sphere that is (4a/3) L, L the escape from a uniform source.
//!
//! Chords of isotropic light: in the sphere the density of a length L up to 2a is L/(2 a^2) (for a beam over its disc
//! too); in the slab 2 tau^2/L^3 beyond tau.
//!
//! Source: Dirac 1943; Case and Zweifel 1967, section 2.8; Blanco and Fournier 2003; Mazzolo 2004.

use crate::error::{Error, Result, within};
use crate::incidence::{Incidence, check_albedo, check_tau};
use crate::slab_isotropic::IsotropicSlab;
use crate::sphere::{Sphere, SphereSource};
use crate::value::Value;

const METHOD: &str = "closed form";

/// Lengths whose products and quotients stay in range.
fn check_length(name: &'static str, length: f64) -> Result<f64> {
    within(name, length, 1e-100, 1e100, "1e-100 to 1e100")
}

/// Mean path in a convex body that does not absorb, isotropic light on its whole surface: 4 V/S.
///
/// # Arguments
/// `volume`, `surface` in units of one length, 1e-100 to 1e100
/// # Errors
/// `Error::OutOfRange` naming `volume` or `surface`
pub fn mean_path(volume: f64, surface: f64) -> Result<Value> {
    check_length("volume", volume)?;
    check_length("surface", surface)?;
    Ok(Value::rounded(4.0 * volume / surface, 2.0, METHOD))
}

/// Mean path in a sphere that does not absorb: 4 a/3.
///
/// # Errors
/// `Error::OutOfRange` naming `radius`
pub fn mean_path_sphere(radius: f64) -> Result<Value> {
    check_length("radius", radius)?;
    Ok(Value::rounded(4.0 * radius / 3.0, 2.0, METHOD))
}

/// Mean path in a slab that does not absorb, lit on one face or both: 2 tau.
///
/// # Errors
/// `Error::OutOfRange` naming `thickness`
pub fn mean_path_slab(thickness: f64) -> Result<Value> {
    check_length("thickness", thickness)?;
    Ok(Value::rounded(2.0 * thickness, 1.0, METHOD))
}

/// Mean path in a cuboid that does not absorb: 2/(1/x + 1/y + 1/z).
///
/// # Errors
/// `Error::OutOfRange` naming `x`, `y` or `z`
pub fn mean_path_cuboid(x: f64, y: f64, z: f64) -> Result<Value> {
    check_length("x", x)?;
    check_length("y", y)?;
    check_length("z", z)?;
    Ok(Value::rounded(2.0 / (1.0 / x + 1.0 / y + 1.0 / z), 4.0, METHOD))
}

/// Mean path to escape or absorption in a sphere of isotropic scattering under isotropic light, in mean free paths.
///
/// # Arguments
/// `radius` in mean free paths, 1e-12 to 1e6; `albedo` 0 to 1
/// # Errors
/// `Error::OutOfRange` naming `radius` or `albedo`
/// # Limits
/// albedo 1: 4a/3; albedo 0: 1 - T of the absorbing sphere
pub fn mean_path_sphere_absorbing(radius: f64, albedo: f64) -> Result<Value> {
    // A/(1-w) without the division: (4a/3) times the escape from a uniform source.
    let sphere = Sphere::new(radius, albedo, SphereSource::Uniform)?;
    Ok(sphere.escape().scaled(4.0 * radius / 3.0))
}

/// Mean path to escape or absorption in a slab of isotropic scattering under isotropic light, in mean free paths.
///
/// # Arguments
/// `tau` optical thickness, 1e-12 to 400; `albedo` 0 to 1
/// # Errors
/// `Error::OutOfRange` naming `tau` or `albedo`
/// # Limits
/// albedo 1: 2 tau; albedo 0: 1 - 2 E_3(tau)
pub fn mean_path_slab_absorbing(tau: f64, albedo: f64) -> Result<Value> {
    check_tau(tau)?;
    check_albedo(albedo)?;
    if albedo == 1.0 {
        return mean_path_slab(tau);
    }
    let slab = IsotropicSlab::new(tau, albedo, Incidence::Diffuse)?;
    Ok(slab.absorptance().scaled(1.0 / (1.0 - albedo)))
}

/// Mean of the n-th power of the chord of a sphere: 2 (2a)^n/(n+2).
///
/// # Arguments
/// `radius` 1e-100 to 1e100; `n` 0 to 100, as far as the value stays in range
/// # Errors
/// `Error::OutOfRange` naming `radius` or `n`
pub fn chord_moment_sphere(radius: f64, n: u32) -> Result<Value> {
    check_length("radius", radius)?;
    let power = power(2.0 * radius, n)?;
    Ok(Value::rounded(2.0 * power / (f64::from(n) + 2.0), f64::from(n) + 4.0, METHOD))
}

/// Mean of the n-th power of the chord of a slab: 2 tau^n/(2-n).
///
/// # Arguments
/// `thickness` 1e-100 to 1e100; `n` 0 or 1
/// # Errors
/// `Error::OutOfRange` naming `thickness` or `n`; `Error::Infinite` for n of 2 and more
pub fn chord_moment_slab(thickness: f64, n: u32) -> Result<Value> {
    check_length("thickness", thickness)?;
    match n {
        0 => Ok(Value::new(1.0, 0.0, METHOD)),
        1 => mean_path_slab(thickness),
        _ => Err(Error::Infinite("the chords of a slab have no second moment; allowed: n of 0 or 1")),
    }
}

/// Density of the chord lengths of a sphere, L/(2 a^2) up to 2a \[1/length\].
///
/// # Errors
/// `Error::OutOfRange` naming `radius` or `length`
pub fn chord_density_sphere(radius: f64, length: f64) -> Result<Value> {
    check_length("radius", radius)?;
    within("length", length, 0.0, f64::MAX, "0 or more")?;
    let value = if length > 2.0 * radius { 0.0 } else { 0.5 * (length / radius) / radius };
    Ok(Value::rounded(value, 2.0, METHOD))
}

/// Density of the chord lengths of a slab, 2 tau^2/L^3 beyond tau \[1/length\].
///
/// # Errors
/// `Error::OutOfRange` naming `thickness` or `length`
pub fn chord_density_slab(thickness: f64, length: f64) -> Result<Value> {
    check_length("thickness", thickness)?;
    within("length", length, 0.0, f64::MAX, "0 or more")?;
    let ratio = thickness / length;
    let value = if length < thickness { 0.0 } else { 2.0 * ratio * ratio / length };
    Ok(Value::rounded(value, 4.0, METHOD))
}

fn power(base: f64, n: u32) -> Result<f64> {
    const ALLOWED: &str = "0 to 100, as far as the moment is between 1e-300 and 1e300";
    let exponent = within("n", f64::from(n), 0.0, 100.0, ALLOWED)?;
    let value = (0..n).fold(1.0, |p: f64, _| p * base);
    if (1e-300..=1e300).contains(&value) {
        Ok(value)
    } else {
        Err(Error::OutOfRange { name: "n", value: exponent, allowed: ALLOWED })
    }
}
