//! Densities in blocks in the scene file: columns, layers, binary Markov mixtures.

use crate::error::{Error, Result};
use crate::math::{Albedo, NonNegative, Positive};
use crate::medium::{Blocks, markov};
use serde::{Deserialize, Serialize};
use std::path::Path;

/// Larger tables of columns are refused.
const MOST_BYTES: u64 = 32 << 20;

fn refuse<T>(text: impl Into<String>) -> Result<T> {
    Err(Error::Scene(text.into()))
}

/// An axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Axis {
    /// Along x.
    X,
    /// Along y.
    Y,
    /// Along z.
    Z,
}

/// A height of all columns, or one a column \[L\].
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(untagged, expecting = "a height, or a list of them, one a column")]
pub enum Heights {
    /// The same of all.
    Same(f64),
    /// One a column.
    Each(Vec<f64>),
}

/// Columns along z: each of one extinction, between a base and a top of its own.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ColumnsFile {
    /// A table of columns.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub file: Option<String>,
    /// In place of a table: the extinction of each column, x fastest, in units of `sigma_t`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub extinction: Option<Vec<f64>>,
    /// In place of extinctions: optical depths from base to top, where `sigma_t` is 1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub optical_depth: Option<Vec<f64>>,
    /// How many columns along x and y; all of them along x if absent, and of a table what it says.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub count: Option<[usize; 2]>,
    /// Width of a column along x, and along y if they lie along both \[L\].
    pub width: Vec<Positive>,
    /// Where the first column begins along x and y \[L\]; 0 if absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub corner: Option<[f64; 2]>,
    /// z of height 0, from which heights count against z, towards the top face of a slab \[L\].
    pub ground: f64,
    /// Height where columns begin, if the table does not say \[L\].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub base: Option<Heights>,
    /// Height where they end \[L\].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub top: Option<Heights>,
    /// What extinctions are multiplied by; 1 if absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub scale: Option<Positive>,
}

/// Layers across an axis.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LayersFile {
    /// The axis.
    pub axis: Axis,
    /// Where layers begin, and the last one ends, rising \[L\].
    pub edges: Vec<f64>,
    /// Density of each.
    pub density: Vec<NonNegative>,
    /// Albedo of each, times that of the medium; 1 if absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub albedo: Option<Vec<Albedo>>,
}

/// One realisation of a binary Markov mixture.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MarkovFile {
    /// The axis that the two materials alternate along.
    pub axis: Axis,
    /// Where it begins \[L\].
    pub from: f64,
    /// Where it ends \[L\].
    pub to: f64,
    /// Mean chord of each material \[L\].
    pub mean_chord: [Positive; 2],
    /// Density of each.
    pub density: [NonNegative; 2],
    /// Albedo of each, times that of the medium; 1 if absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub albedo: Option<[Albedo; 2]>,
    /// The realisation.
    pub seed: u64,
}

impl LayersFile {
    /// Density, and albedo if there is one.
    pub(super) fn blocks(&self) -> Result<(Blocks, Option<Blocks>)> {
        let of = |values: Vec<f64>| Blocks::layers(self.axis as usize, self.edges.clone(), values);
        let albedo = self.albedo.as_ref().map(|albedo| of(albedo.iter().map(|a| a.get()).collect()));
        Ok((of(self.density.iter().map(|d| d.get()).collect())?, albedo.transpose()?))
    }
}

impl MarkovFile {
    /// Density, and albedo if there is one.
    pub(super) fn blocks(&self) -> Result<(Blocks, Option<Blocks>)> {
        let (edges, materials) = markov((self.from, self.to), self.mean_chord, self.seed)?;
        let of = |values: [f64; 2]| {
            let values = materials.iter().map(|material| values[*material]).collect();
            Blocks::layers(self.axis as usize, edges.clone(), values)
        };
        let albedo = self.albedo.map(|albedo| of(albedo.map(Albedo::get)));
        Ok((of(self.density.map(NonNegative::get))?, albedo.transpose()?))
    }
}

/// The numbers of columns, as a table or the scene file gives them.
struct Numbers {
    count: [usize; 2],
    values: Vec<f64>,
    /// Whether values are optical depths.
    is_depth: bool,
    base: Option<Heights>,
    top: Option<Heights>,
}

/// The names of a table's columns: the lattice's numbers, then what is where.
const NAMES: [&str; 6] = ["i", "j", "extinction", "optical_depth", "base", "top"];

/// Reads a table: a line of names, then a line a column of the medium, i fastest.
///
/// # Errors
/// those of its lines, by number and name
fn table(text: &str) -> Result<Numbers> {
    // Spreadsheets begin a file with a byte-order mark.
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let mut lines = text.lines().enumerate().map(|(i, line)| (i + 1, line.trim()));
    let Some((_, head)) = lines.next().filter(|(_, head)| !head.is_empty()) else {
        return refuse(format!("line 1: no names of columns; allowed: some of {}", NAMES.join(",")));
    };
    let mut names = Vec::new();
    for name in head.split(',').map(str::trim) {
        match NAMES.iter().position(|known| *known == name) {
            Some(known) if !names.contains(&known) => names.push(known),
            Some(_) => return refuse(format!("line 1, {name}: stands there twice; allowed: once")),
            None => {
                let name = name.escape_debug();
                return refuse(format!("line 1: unknown `{name}`; allowed: {}", NAMES.join(",")));
            }
        }
    }
    let place = |name: &str| names.iter().position(|known| NAMES[*known] == name);
    let (i, j) = (place("i"), place("j"));
    let Some(first) = i else { return refuse("line 1: no column i; allowed: i, from 0") };
    let (value, is_depth) = match (place("extinction"), place("optical_depth")) {
        (Some(value), None) => (value, false),
        (None, Some(value)) => (value, true),
        _ => return refuse("line 1: extinction or optical_depth; allowed: one of the two"),
    };
    let (base, top) = (place("base"), place("top"));
    let (mut values, mut bases, mut tops) = (Vec::new(), Vec::new(), Vec::new());
    // Columns along x, known when i is 0 again.
    let mut along_x = None;
    let mut row = vec![0.0; names.len()];
    for (line, text) in lines {
        if text.is_empty() {
            continue;
        }
        let mut fields = 0;
        for field in text.split(',') {
            if let (Some(number), Some(name)) = (row.get_mut(fields), names.get(fields)) {
                let name = NAMES[*name];
                *number = match field.trim().parse::<f64>() {
                    Ok(number) if number.is_finite() => number,
                    _ => {
                        let field = field.trim().escape_debug().to_string();
                        return refuse(format!("line {line}, {name}: `{field}` is not a finite number"));
                    }
                };
            }
            fields += 1;
        }
        if fields != row.len() {
            return refuse(format!("line {line}: {fields} values; allowed: {}, as line 1 names", row.len()));
        }
        let number = values.len();
        if along_x.is_none() && number > 0 && row[first] == 0.0 && j.is_some() {
            along_x = Some(number);
        }
        let wide = along_x.unwrap_or(usize::MAX);
        for (at, name, expected) in [(i, "i", number % wide), (j, "j", number / wide)] {
            if let Some(at) = at
                && row[at] != expected as f64
            {
                return refuse(format!(
                    "line {line}, {name}: is {}; allowed: {expected}, each column of the lattice once, i fastest",
                    row[at]
                ));
            }
        }
        if row[value] < 0.0 {
            let name = if is_depth { "optical_depth" } else { "extinction" };
            return refuse(format!("line {line}, {name}: is {}; allowed: at least 0", row[value]));
        }
        if let (Some(base), Some(top)) = (base, top)
            && row[base] > row[top]
        {
            return refuse(format!(
                "line {line}, base: is {}; allowed: at most its top, {}",
                row[base], row[top]
            ));
        }
        values.push(row[value]);
        bases.extend(base.map(|at| row[at]));
        tops.extend(top.map(|at| row[at]));
    }
    if values.is_empty() {
        return refuse("has no line behind its names; allowed: a line for each column");
    }
    let wide = along_x.unwrap_or(values.len());
    if !values.len().is_multiple_of(wide) {
        return refuse(format!(
            "ends after {} columns; allowed: a whole number of rows of {wide} along x",
            values.len()
        ));
    }
    Ok(Numbers {
        count: [wide, values.len() / wide],
        values,
        is_depth,
        base: base.map(|_| Heights::Each(bases)),
        top: top.map(|_| Heights::Each(tops)),
    })
}

impl ColumnsFile {
    pub(super) fn blocks(&self, folder: &Path) -> Result<Blocks> {
        match &self.file {
            Some(file) => {
                let path = folder.join(file);
                let within = |e: Error| e.within(&format!("columns {}", path.display()));
                let text = crate::input::read_text(&path, MOST_BYTES);
                let text = text.map_err(|cause| within(Error::Scene(cause.to_string())))?;
                if self.extinction.is_some() || self.optical_depth.is_some() || self.count.is_some() {
                    return refuse(
                        "columns with file and extinction, optical_depth or count; allowed: file alone",
                    );
                }
                let numbers = table(&text).map_err(within)?;
                self.placed(numbers).map_err(within)
            }
            None => {
                let (values, is_depth) = match (&self.extinction, &self.optical_depth) {
                    (Some(values), None) => (values.clone(), false),
                    (None, Some(values)) => (values.clone(), true),
                    _ => {
                        return refuse(
                            "columns need one of file, extinction and optical_depth; allowed: one of the three",
                        );
                    }
                };
                let count = self.count.unwrap_or([values.len(), 1]);
                let numbers = Numbers { count, values, is_depth, base: None, top: None };
                self.placed(numbers).map_err(|e| e.within("columns"))
            }
        }
    }

    /// The blocks: heights from the table or the scene file, z against them.
    fn placed(&self, numbers: Numbers) -> Result<Blocks> {
        let Numbers { count: [nx, ny], mut values, is_depth, .. } = numbers;
        let n = values.len();
        let heights = |name: &str, table: Option<Heights>, own: &Option<Heights>| match (table, own) {
            (Some(Heights::Each(each)), None) => Ok(each),
            (None, Some(Heights::Same(height))) => Ok(vec![*height; n]),
            (None, Some(Heights::Each(each))) if each.len() == n => Ok(each.clone()),
            (None, Some(Heights::Each(each))) => {
                refuse(format!("{name} has {} values; allowed: {n}, one a column", each.len()))
            }
            (Some(_), _) => {
                refuse(format!("{name} in the table and in the scene file; allowed: one of the two"))
            }
            (None, None) => refuse(format!("no {name}; allowed: in the table, or a key beside it")),
        };
        let (bases, tops) =
            (heights("base", numbers.base, &self.base)?, heights("top", numbers.top, &self.top)?);
        let scale = self.scale.map_or(1.0, Positive::get);
        for (column, value) in values.iter_mut().enumerate() {
            let (base, top) = (bases[column], tops[column]);
            if !(base <= top && (top - base).is_finite()) {
                return refuse(format!("base of column {column} is {base}; allowed: at most its top, {top}"));
            }
            if is_depth && *value != 0.0 {
                if top == base {
                    return refuse(format!(
                        "optical_depth of column {column} is {value} between base and top that are the same; allowed: 0 there"
                    ));
                }
                *value /= top - base;
            }
            *value *= scale;
        }
        let width: Vec<f64> = self.width.iter().map(|width| width.get()).collect();
        let (dx, dy) = match width[..] {
            [dx] if ny == 1 => (dx, dx),
            [dx, dy] => (dx, dy),
            _ => {
                let wanted = if ny == 1 { "1, along x, or 2" } else { "2, along x and y" };
                return refuse(format!("width has {} numbers; allowed: {wanted}", width.len()));
            }
        };
        let [x0, y0] = self.corner.unwrap_or_default();
        let planes = |from: f64, step: f64, count: usize| -> Vec<f64> {
            (0..=count).map(|i| from + step * i as f64).collect()
        };
        let spans =
            bases.iter().zip(&tops).map(|(base, top)| (self.ground - top, self.ground - base)).collect();
        if n != nx.saturating_mul(ny) || n == 0 {
            return refuse(format!(
                "{nx} x {ny} columns have {n} values; allowed: one a column, at least one"
            ));
        }
        Blocks::columns(planes(x0, dx, nx), planes(y0, dy, ny), values, spans)
    }
}
