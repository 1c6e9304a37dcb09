//! Words that choose among a few, as the programs have them.

use crate::error::refuse;
use pyo3::PyResult;
use turbid::estimators::boundary::Treatment;
use turbid::estimators::{BeamBlur, Kernel, RayEnds};
use turbid::integrators::StepRule;
use turbid::photons::beams::BeamLength;

/// The choice of this name.
///
/// # Errors
/// Names the argument and all that it may be
pub fn chosen<T: Copy>(argument: &str, word: &str, choices: &[(&str, T)]) -> PyResult<T> {
    choices.iter().find(|(name, _)| *name == word).map(|(_, choice)| *choice).ok_or_else(|| {
        let names: Vec<&str> = choices.iter().map(|(name, _)| *name).collect();
        refuse(format!("{argument} is '{word}'; allowed: {}", names.join(", ")))
    })
}

/// A kernel by its name.
///
/// # Errors
/// As [`chosen`]
pub fn kernel(argument: &str, word: &str) -> PyResult<Kernel> {
    chosen(argument, word, &Kernel::ALL.map(|kernel| (kernel.name(), kernel)))
}

/// That estimates about whole rays know a treatment.
///
/// # Errors
/// A treatment of balls
pub fn check_about_rays(treatment: Treatment) -> anyhow::Result<()> {
    if treatment.is_of_rays() {
        return Ok(());
    }
    Err(anyhow::anyhow!(
        "boundary is '{}', of balls; allowed of rays that are read as a whole: none, clipped",
        treatment.name().replace(' ', "-")
    ))
}

/// In how many dimensions beams are blurred.
///
/// # Errors
/// As [`chosen`]
pub fn beam_blur(word: &str) -> PyResult<BeamBlur> {
    chosen("beam_blur", word, &BeamBlur::ALL.map(|blur| (blur.name(), blur)))
}

/// How far beams go.
///
/// # Errors
/// As [`chosen`]
pub fn beam_length(word: &str) -> PyResult<BeamLength> {
    chosen("beam_length", word, &BeamLength::ALL.map(|length| (length.name(), length)))
}

/// Where rays that are read at once end.
///
/// # Errors
/// As [`chosen`]
pub fn ray_ends(word: &str) -> PyResult<RayEnds> {
    chosen("ray_ends", word, &RayEnds::ALL.map(|ends| (ends.name(), ends)))
}

/// What estimates do where a medium ends.
///
/// # Errors
/// As [`chosen`]
pub fn treatment(word: &str) -> PyResult<Treatment> {
    let all = [
        ("none", Treatment::None),
        ("clipped", Treatment::Clipped),
        ("reflection", Treatment::Reflection),
        ("local-linear", Treatment::LocalLinear),
    ];
    chosen("boundary", word, &all)
}

/// How much of a step's light reaches its near end.
///
/// # Errors
/// As [`chosen`]
pub fn step_rule(word: &str) -> PyResult<StepRule> {
    let all =
        [("near-end", StepRule::NearEnd), ("middle", StepRule::Middle), ("integrated", StepRule::Integrated)];
    chosen("step_rule", word, &all)
}
