//! How words of the command line and cells of a table become numbers.

use turbid_analytic::{Dimension, Incidence, Kernel};

/// Reads `diffuse` or a cosine; its range is checked by the solver.
pub fn incidence(text: &str) -> Result<Incidence, String> {
    if text == "diffuse" {
        return Ok(Incidence::Diffuse);
    }
    match text.parse() {
        Ok(mu0) => Ok(Incidence::Beam { mu0 }),
        Err(_) => Err(format!("mu0 is '{text}'; allowed: a number above 0 to 1, or diffuse")),
    }
}

/// Reads the coordinates of a place, as many as there are.
pub fn place(text: &str) -> Result<Vec<f64>, String> {
    let number = |part: &str| part.trim().parse();
    text.split(',')
        .map(number)
        .collect::<Result<_, _>>()
        .map_err(|_| format!("at is '{text}'; allowed: numbers separated by commas, as 0.5,0.5,1"))
}

/// Reads a kernel's name.
pub fn kernel(text: &str) -> Result<Kernel, String> {
    match text {
        "uniform" => Ok(Kernel::Uniform),
        "epan" | "epanechnikov" => Ok(Kernel::Epanechnikov),
        "biweight" => Ok(Kernel::Biweight),
        "gauss" | "gaussian" => Ok(Kernel::Gaussian),
        "truncated_gauss" | "truncated_gaussian" => Ok(Kernel::TruncatedGaussian),
        _ => match text.strip_prefix("cone_k").map(str::parse) {
            Some(Ok(kappa)) => Ok(Kernel::Cone { kappa }),
            _ => Err(format!(
                "kernel is '{text}'; allowed: uniform, epanechnikov, biweight, cone_k1, gaussian, truncated_gaussian"
            )),
        },
    }
}

/// A kernel's name, as it is read.
pub fn kernel_name(kernel: Kernel) -> String {
    match kernel {
        Kernel::Uniform => "uniform".into(),
        Kernel::Epanechnikov => "epanechnikov".into(),
        Kernel::Biweight => "biweight".into(),
        Kernel::Gaussian => "gaussian".into(),
        Kernel::TruncatedGaussian => "truncated_gaussian".into(),
        Kernel::Cone { kappa } => format!("cone_k{kappa}"),
    }
}

/// Reads a dimension.
pub fn dimension(text: &str) -> Result<Dimension, String> {
    match text {
        "1" => Ok(Dimension::One),
        "2" => Ok(Dimension::Two),
        "3" => Ok(Dimension::Three),
        _ => Err(format!("dimension is '{text}'; allowed: 1, 2, 3")),
    }
}

/// How the light falls, as a parameter.
pub fn incidence_field(incidence: Incidence) -> crate::answer::Field {
    match incidence {
        Incidence::Diffuse => "diffuse".into(),
        Incidence::Beam { mu0 } => mu0.into(),
    }
}

/// How the light falls, in a title.
pub fn incidence_title(incidence: Incidence) -> String {
    match incidence {
        Incidence::Diffuse => "diffuse light".into(),
        Incidence::Beam { mu0 } => format!("beam μ₀ = {mu0}"),
    }
}
