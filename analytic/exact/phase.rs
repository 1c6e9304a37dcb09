//! Phase functions on the command line.

use crate::input::read_text;
use crate::text::one_line;
use anyhow::{Context, Result, anyhow, bail};
use std::path::{Path, PathBuf};
use turbid_analytic::Phase;

/// How scattering turns light; isotropic when nothing is given.
#[derive(clap::Args, Clone, Default)]
pub struct PhaseArgs {
    /// Henyey-Greenstein scattering of this mean cosine: checked from -0.95 to 0.99, and answered beyond as far as its moments allow.
    #[arg(long, help_heading = "Phase function", allow_negative_numbers = true, conflicts_with_all = ["rayleigh", "moments", "table"])]
    g: Option<f64>,
    /// With --g and --share: the mean cosine of a second Henyey-Greenstein term.
    #[arg(
        long,
        help_heading = "Phase function",
        allow_negative_numbers = true,
        requires = "g",
        requires = "share"
    )]
    g2: Option<f64>,
    /// Share of the first of two terms, 0 to 1.
    #[arg(long, help_heading = "Phase function", allow_negative_numbers = true, requires = "g2")]
    share: Option<f64>,
    /// Rayleigh scattering without polarisation, 3 (1 + cos^2)/(16 pi).
    #[arg(long, help_heading = "Phase function", conflicts_with_all = ["moments", "table"])]
    rayleigh: bool,
    /// Legendre moments chi_0 = 1, chi_1, ... of p = 1/(4 pi) sum (2l+1) chi_l P_l, separated by commas, blanks or
    /// lines, in a file of up to 16 MiB; # begins a comment
    #[arg(verbatim_doc_comment, long, help_heading = "Phase function", value_name = "FILE")]
    moments: Option<PathBuf>,
    /// Values at cosines from -1 to 1 in rising order, in any unit, as lines `cosine,value` of a file of up to 16 MiB;
    /// linear in between; # begins a comment. What is used is the sum of its Legendre moments, which must not be negative
    #[arg(
        verbatim_doc_comment,
        long,
        help_heading = "Phase function",
        value_name = "FILE",
        conflicts_with = "moments"
    )]
    table: Option<PathBuf>,
    /// Highest moment of --table, 0 to 1999; a peak needs about pi over its width.
    #[arg(
        long,
        help_heading = "Phase function",
        default_value_t = 100,
        requires = "table",
        allow_negative_numbers = true
    )]
    degree: u32,
}

/// A phase function under the name that tables and titles give it.
#[derive(Clone)]
pub struct Named {
    /// The phase function.
    pub phase: Phase,
    /// Its name and parameters.
    pub name: String,
    /// Its g, if it is Henyey-Greenstein or isotropic.
    pub single_g: Option<f64>,
}

impl Named {
    /// Henyey-Greenstein, isotropic at 0.
    pub fn henyey_greenstein(g: f64) -> Result<Self> {
        let (phase, name) = if g == 0.0 {
            (Phase::isotropic(), "isotropic".to_string())
        } else {
            (Phase::henyey_greenstein(g)?, format!("Henyey-Greenstein g={g}"))
        };
        Ok(Named { phase, name, single_g: Some(g) })
    }

    /// Whether light is scattered alike in all directions.
    pub fn is_isotropic(&self) -> bool {
        self.single_g == Some(0.0)
    }

    /// The g of Henyey-Greenstein, where nothing else will do.
    pub fn only_g(&self, with: &str) -> Result<f64> {
        self.single_g
            .ok_or_else(|| anyhow!("phase function is {}; allowed with {with}: isotropic, --g", self.name))
    }
}

impl PhaseArgs {
    /// The g of Henyey-Greenstein or isotropic scattering.
    pub fn single_g(&self) -> Option<f64> {
        let single = !self.rayleigh && self.moments.is_none() && self.table.is_none() && self.g2.is_none();
        single.then_some(self.g.unwrap_or(0.0))
    }

    /// The phase function asked for.
    pub fn read(&self) -> Result<Named> {
        if self.rayleigh {
            return Ok(Named { phase: Phase::rayleigh(), name: "Rayleigh".into(), single_g: None });
        }
        if let Some(path) = &self.moments {
            return from_file(path);
        }
        if let Some(path) = &self.table {
            return from_table(path, self.degree);
        }
        match (self.g, self.g2, self.share) {
            (Some(g1), Some(g2), Some(share)) => Ok(Named {
                phase: Phase::two_term(g1, g2, share)?,
                name: format!("two-term g={g1} g2={g2} share={share}"),
                single_g: None,
            }),
            (g, _, _) => Named::henyey_greenstein(g.unwrap_or(0.0)),
        }
    }
}

fn from_table(path: &Path, degree: u32) -> Result<Named> {
    let shown = path.display();
    let text = read_text(path)?;
    let (mut cosines, mut values) = (Vec::new(), Vec::new());
    for (i, line) in text.lines().enumerate() {
        let line = line.split('#').next().unwrap_or_default();
        let words: Vec<&str> = line.split([',', ' ', '\t', ';']).filter(|word| !word.is_empty()).collect();
        let numbers = words.iter().map(|word| word.parse::<f64>()).collect::<Result<Vec<f64>, _>>();
        match numbers.as_deref() {
            Ok([]) => {}
            Ok(&[cosine, value]) => {
                cosines.push(cosine);
                values.push(value);
            }
            _ => bail!("{shown}:{}: '{}'; allowed: cosine,value", i + 1, line.trim()),
        }
    }
    if cosines.is_empty() {
        bail!("{shown}: no lines; allowed: 2 or more of cosine,value");
    }
    let phase = Phase::tabulated(&cosines, &values, degree as usize).with_context(|| format!("{shown}"))?;
    let file = file_name(path);
    Ok(Named { phase, name: format!("table {file} to degree {degree}"), single_g: None })
}

/// The name of a file in tables and titles.
fn file_name(path: &Path) -> String {
    one_line(&path.file_name().unwrap_or_default().to_string_lossy())
}

/// Legendre moments from a file.
pub fn from_file(path: &Path) -> Result<Named> {
    let shown = path.display();
    let text = read_text(path)?;
    let mut moments = Vec::new();
    for (i, line) in text.lines().enumerate() {
        let line = line.split('#').next().unwrap_or_default();
        for word in line.split([',', ' ', '\t', ';']).filter(|word| !word.is_empty()) {
            match word.parse::<f64>() {
                Ok(moment) if moment.abs() <= 1.0 => moments.push(moment),
                _ => bail!(
                    "{shown}:{}: chi_{} is '{word}'; allowed: a number from -1 to 1",
                    i + 1,
                    moments.len()
                ),
            }
        }
    }
    let count = moments.len();
    let phase = Phase::legendre(moments).with_context(|| format!("{shown}"))?;
    let file = file_name(path);
    Ok(Named { phase, name: format!("{count} Legendre moments of {file}"), single_g: None })
}
