//! What the figures of all problems share: places to sample, scales, titles, files.

use anyhow::{Context, Result, bail};
use libm::{cos, exp, log};
use std::f64::consts::PI;
use std::path::Path;
use turbid_figure::{Axis, Figure, Legend, Line, Panel, Width};

/// Width in print, fit for a page of text \[mm\].
const WIDTH: f64 = 125.0;

/// Largest over smallest value beyond which an axis is logarithmic.
const DECADES: f64 = 30.0;

/// A line to be drawn: its name, abscissae and ordinates.
pub struct Curve {
    label: String,
    reference: bool,
    x: Vec<f64>,
    y: Vec<f64>,
}

impl Curve {
    /// Samples a function.
    pub fn sample(label: impl Into<String>, x: &[f64], f: impl Fn(f64) -> Result<f64>) -> Result<Self> {
        let y = x.iter().map(|&x| f(x)).collect::<Result<Vec<f64>>>()?;
        Ok(Curve { label: label.into(), reference: false, x: x.to_vec(), y })
    }

    /// The same line in solid black: what others are held against.
    pub fn into_reference(self) -> Self {
        Curve { reference: true, ..self }
    }
}

/// `count` numbers from `low` to `high` at equal distances.
pub fn even(low: f64, high: f64, count: usize) -> Vec<f64> {
    let step = 1.0 / (count - 1) as f64;
    (0..count).map(|i| if i + 1 == count { high } else { low + (high - low) * (i as f64 * step) }).collect()
}

/// `count` numbers from `low` to `high` in equal ratios.
pub fn ratios(low: f64, high: f64, count: usize) -> Vec<f64> {
    let mut points: Vec<f64> = even(log(low), log(high), count).into_iter().map(exp).collect();
    points[0] = low;
    points[count - 1] = high;
    points
}

/// Numbers from 0 to `length` that crowd at both ends, where fields bend.
pub fn crowded(length: f64, count: usize) -> Vec<f64> {
    even(0.0, PI, count).into_iter().map(|x| (0.5 * length * (1.0 - cos(x))).min(length)).collect()
}

/// An axis of angles from 0 to `last` degrees, with a tick every 30.
pub fn degrees(label: &str, last: u32) -> Axis {
    let names = (0..=last / 30).map(|i| (f64::from(30 * i), format!("{}°", 30 * i))).collect();
    Axis { names, ..Axis::linear(label, "").with_range(0.0, f64::from(last)) }
}

/// A panel of curves; the ordinate is logarithmic when it spans decades.
pub fn panel(x: Axis, label: &str, unit: &str, curves: Vec<Curve>) -> Panel {
    let all = || curves.iter().flat_map(|c| c.y.iter().copied());
    let (low, high) = (all().fold(f64::INFINITY, f64::min), all().fold(0.0, f64::max));
    let y = if low > 0.0 && high > DECADES * low {
        Axis::log(label, unit)
    } else if low >= 0.0 && high > 0.0 {
        // A field is seen against its zero.
        Axis::linear(label, unit).with_range(0.0, 1.06 * high)
    } else {
        Axis::linear(label, unit)
    };
    let single = curves.len() == 1;
    let panel = Panel::new(x, y);
    let panel = if single { panel.with_legend(Legend::Hidden) } else { panel };
    // Black is solid, so that the others begin with a dashed class.
    let mut class = usize::from(curves.iter().any(|curve| curve.reference));
    curves.into_iter().fold(panel, |panel, Curve { label, reference, x, y }| {
        panel.with(if reference {
            Line::theory(label, x, y)
        } else {
            class += 1;
            Line::new(label, class - 1, x, y)
        })
    })
}

/// One panel under a title.
pub fn figure(title: impl Into<String>, panel: Panel) -> Figure {
    Figure {
        title: title.into(),
        width: Width::Millimetres(WIDTH),
        heights: vec![0.6],
        ..Figure::new(vec![panel])
    }
}

/// Refuses endings other than .svg and .png before anything is computed.
pub fn check(path: &Path) -> Result<()> {
    match path.extension().and_then(|e| e.to_str()) {
        Some("svg" | "png") => Ok(()),
        _ => bail!("--plot is {}; allowed: a name that ends in .svg or .png", path.display()),
    }
}

/// The bytes of the file.
pub fn encode(figure: &Figure, path: &Path) -> Result<Vec<u8>> {
    let bytes = match path.extension().and_then(|e| e.to_str()) {
        Some("png") => figure.png(),
        _ => figure.svg().map(String::into_bytes),
    };
    bytes.with_context(|| format!("cannot draw {}", path.display()))
}
