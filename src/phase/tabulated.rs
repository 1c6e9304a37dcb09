//! A phase function given by a table, as Mie theory does.

use super::PhaseFunction;
use crate::error::{Error, Result};
use crate::math::quadrature::{gauss_legendre, legendre_series};
use crate::math::{atan2, sin_cos};
use std::f64::consts::PI;
use std::path::Path;

/// A point of the table.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Node {
    /// 1-mu.
    minus: f64,
    /// 1+mu.
    plus: f64,
    /// Density over mu \[1\]: 2 pi times that over directions.
    value: f64,
    /// Fraction scattered below this cosine.
    below: f64,
    /// Fraction scattered above it.
    above: f64,
}

/// Values at some angles, linear in the cosine between them, normalised.
///
/// # Limits
/// The pair (1-mu, 1+mu) of a point of the table keeps every digit, however narrow the peak.
#[derive(Debug, Clone, PartialEq)]
pub struct Tabulated {
    /// From backward to forward.
    nodes: Vec<Node>,
    /// mu_(i+1) - mu_i, without cancellation.
    widths: Vec<f64>,
}

fn refuse<T>(place: &str, text: impl std::fmt::Display) -> Result<T> {
    Err(Error::Scene(format!("{place}: {text}")))
}

/// Larger tables are refused: a million angles.
const MOST_BYTES: u64 = 1 << 25;

impl Tabulated {
    /// A table of angles in degrees, rising from 0 (forward) to 180, and values in any unit.
    ///
    /// # Errors
    /// `Error::Scene` for fewer than two angles, angles that do not rise or do not run from 0 to 180, values that are
    /// negative or not finite or all 0
    pub fn new(table: &[(f64, f64)]) -> Result<Self> {
        let lines: Vec<(usize, f64, f64)> =
            table.iter().enumerate().map(|(i, (angle, value))| (i + 1, *angle, *value)).collect();
        Tabulated::checked("phase table", "row", &lines)
    }

    /// Reads a table: a line with an angle in degrees, rising from 0 to 180, and a value, between spaces, tabs or a comma; or with
    /// a cosine, rising from -1 to 1, in its place. `#` starts a comment.
    ///
    /// # Errors
    /// `Error::Scene` that names the file and the line
    pub fn read(path: &Path) -> Result<Self> {
        let file = format!("phase table {}", path.display());
        let text = match crate::input::read_text(path, MOST_BYTES) {
            Ok(text) => text,
            Err(cause) => return refuse(&file, cause),
        };
        let mut lines = Vec::new();
        for (i, line) in text.lines().enumerate() {
            let numbers = line.split('#').next().unwrap_or_default();
            let words: Vec<&str> = numbers.split([' ', '\t', ',', ';']).filter(|w| !w.is_empty()).collect();
            match words[..] {
                [] => {}
                [angle, value] => match (angle.parse(), value.parse()) {
                    (Ok(angle), Ok(value)) => lines.push((i + 1, angle, value)),
                    _ => {
                        // Of a file that is none of ours a few signs, and none that a terminal would obey.
                        let line: String =
                            line.trim().chars().take(40).flat_map(char::escape_debug).collect();
                        return refuse(&file, format!("line {}: `{line}` is no pair of numbers", i + 1));
                    }
                },
                _ => {
                    let found = words.len();
                    return refuse(
                        &file,
                        format!("line {} has {found} words; allowed: an angle in degrees and a value", i + 1),
                    );
                }
            }
        }
        // No angle is negative: the first number tells.
        if lines.first().is_some_and(|(_, first, _)| *first == -1.0) {
            return Tabulated::of_cosines(&file, &lines);
        }
        Tabulated::checked(&file, "line", &lines)
    }

    /// The table of these cosines, as angles.
    fn of_cosines(file: &str, lines: &[(usize, f64, f64)]) -> Result<Self> {
        for pair in lines.windows(2) {
            let ((_, before, _), (line, cosine, _)) = (pair[0], pair[1]);
            if !(cosine > before && cosine <= 1.0) {
                return refuse(
                    file,
                    format!("line {line}: cosine {cosine} after {before}; allowed: rising, to 1"),
                );
            }
        }
        let angle = |cosine: f64| atan2(((1.0 - cosine) * (1.0 + cosine)).sqrt(), cosine).to_degrees();
        let ends = |cosine: f64| if cosine == -1.0 { 180.0 } else { angle(cosine) };
        let rows: Vec<(usize, f64, f64)> =
            lines.iter().rev().map(|(line, cosine, value)| (*line, ends(*cosine), *value)).collect();
        Tabulated::checked(file, "line", &rows)
    }

    fn checked(file: &str, row: &str, lines: &[(usize, f64, f64)]) -> Result<Self> {
        if lines.len() < 2 {
            return refuse(
                file,
                format!("{} angles; allowed: 2 or more, from 0 to 180 degrees", lines.len()),
            );
        }
        for &(line, angle, value) in lines {
            if !(0.0..=180.0).contains(&angle) {
                return refuse(file, format!("{row} {line}: angle is {angle}; allowed: 0 to 180 degrees"));
            }
            if !(0.0..=1e100).contains(&value) {
                return refuse(file, format!("{row} {line}: value is {value}; allowed: 0 to 1e100"));
            }
        }
        for pair in lines.windows(2) {
            let ((_, before, _), (line, angle, _)) = (pair[0], pair[1]);
            if angle <= before {
                return refuse(
                    file,
                    format!("{row} {line}: angle {angle} after {before}; allowed: rising angles"),
                );
            }
        }
        let (first, last) = (lines[0].1, lines[lines.len() - 1].1);
        if first != 0.0 || last != 180.0 {
            return refuse(
                file,
                format!("angles run from {first} to {last}; allowed: from 0 to 180 degrees"),
            );
        }
        match Tabulated::normalised(lines) {
            Some(table) => Ok(table),
            None => {
                refuse(file, "every value is 0, or angles too close to tell; allowed: some value above 0")
            }
        }
    }

    /// The table from backward to forward, with its cumulated fractions from both ends.
    fn normalised(lines: &[(usize, f64, f64)]) -> Option<Self> {
        let half = |angle: f64| sin_cos(0.5 * angle.to_radians());
        let rows: Vec<(f64, f64)> = lines.iter().rev().map(|(_, angle, value)| (*angle, *value)).collect();
        let mut nodes: Vec<Node> = rows
            .iter()
            .map(|&(angle, value)| {
                let (s, c) = if angle == 180.0 { (1.0, 0.0) } else { half(angle) };
                Node { minus: 2.0 * s * s, plus: 2.0 * c * c, value, below: 0.0, above: 0.0 }
            })
            .collect();
        // cos b - cos a = 2 sin((a+b)/2) sin((a-b)/2).
        let width = |a: f64, b: f64| 2.0 * half(a + b).0 * half(a - b).0;
        let widths: Vec<f64> = rows.windows(2).map(|w| width(w[0].0, w[1].0)).collect();
        let area = |nodes: &[Node], i: usize| 0.5 * (nodes[i].value + nodes[i + 1].value) * widths[i];
        let total: f64 = (0..widths.len()).map(|i| area(&nodes, i)).sum();
        if !(total > 0.0 && total.is_finite()) || widths.iter().any(|w| *w <= 0.0) {
            return None;
        }
        nodes.iter_mut().for_each(|node| node.value /= total);
        for i in 0..widths.len() {
            nodes[i + 1].below = nodes[i].below + area(&nodes, i);
        }
        for i in (0..widths.len()).rev() {
            nodes[i].above = nodes[i + 1].above + area(&nodes, i);
        }
        Some(Tabulated { nodes, widths })
    }

    /// The pairs (1-mu, 1+mu) of the table's points from backward to forward: the density has a kink at each.
    pub fn kinks(&self) -> impl Iterator<Item = (f64, f64)> {
        self.nodes.iter().map(|node| (node.minus, node.plus))
    }

    /// Moments 0 to `highest`.
    pub fn moments(&self, highest: u32) -> Vec<f64> {
        // A line times P_l has degree l + 1.
        let rule = gauss_legendre(highest / 2 + 2);
        let mut sums = vec![0.0; highest as usize + 1];
        for (pair, width) in self.nodes.windows(2).zip(&self.widths) {
            for (x, w) in &rule {
                let part = 0.5 * (1.0 + x);
                let value = pair[0].value + part * (pair[1].value - pair[0].value);
                let mu = (pair[0].plus + part * width) - 1.0;
                for (sum, p) in sums.iter_mut().zip(legendre_series(mu)) {
                    *sum += 0.5 * width * w * value * p;
                }
            }
        }
        sums
    }
}

/// How far into a stretch of length `width` an area `t` reaches, whose height goes from `near` to `far`.
fn reach(t: f64, near: f64, far: f64, width: f64) -> f64 {
    let square = near * near + 2.0 * t * ((far - near) / width);
    let sum = near + square.max(0.0).sqrt();
    if sum > 0.0 { (2.0 * t / sum).min(width) } else { 0.0 }
}

impl PhaseFunction for Tabulated {
    fn eval(&self, one_minus_mu: f64, one_plus_mu: f64) -> f64 {
        let nodes = &self.nodes;
        let last = self.widths.len() - 1;
        let density = if one_plus_mu <= one_minus_mu {
            let i = nodes.partition_point(|n| n.plus <= one_plus_mu).saturating_sub(1).min(last);
            let part = ((one_plus_mu - nodes[i].plus) / self.widths[i]).clamp(0.0, 1.0);
            nodes[i].value + part * (nodes[i + 1].value - nodes[i].value)
        } else {
            let i = nodes.partition_point(|n| n.minus > one_minus_mu).saturating_sub(1).min(last);
            let part = ((one_minus_mu - nodes[i + 1].minus) / self.widths[i]).clamp(0.0, 1.0);
            nodes[i + 1].value + part * (nodes[i].value - nodes[i + 1].value)
        };
        density / (2.0 * PI)
    }

    /// The cumulated density is a parabola between two points: below the median from the backward end, above it from
    /// the forward one.
    fn sample(&self, u: f64) -> (f64, f64) {
        let nodes = &self.nodes;
        let last = self.widths.len() - 1;
        if u < 0.5 {
            let i = nodes.partition_point(|n| n.below <= u).saturating_sub(1).min(last);
            let (near, far) = (&nodes[i], &nodes[i + 1]);
            let step = reach(u - near.below, near.value, far.value, self.widths[i]);
            (near.minus - step, near.plus + step)
        } else {
            let e = 1.0 - u;
            let i = nodes.partition_point(|n| n.above > e).saturating_sub(1).min(last);
            let (near, far) = (&nodes[i + 1], &nodes[i]);
            let step = reach(e - near.above, near.value, far.value, self.widths[i]);
            (near.minus + step, near.plus - step)
        }
    }

    fn moment(&self, l: u32) -> f64 {
        if l == 0 { 1.0 } else { self.moments(l).pop().unwrap_or_default() }
    }
}
