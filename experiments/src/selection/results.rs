//! What the cells say.

use super::cases::{Selector, advised, is_put, name};
use super::fields::Field;
use super::predict::Expected;
use crate::harness::{Cells, Estimate};
use turbid::stats::Moments;

/// One question, number of photons and selector.
pub struct Choice {
    /// What is asked.
    pub field: Field,
    /// Photons of a map.
    pub photons: u64,
    /// Who chooses.
    pub selector: Selector,
    /// Mean error of each cell.
    pub errors: Vec<f64>,
    /// Mean squared error over that of the best radius in theory, of each cell.
    pub squares: Vec<f64>,
    /// Binary logarithm of the radius over the best; nothing of gathers of nearest photons.
    pub octaves: Moments,
    /// What was predicted at the best radius.
    pub best: Expected,
}

impl Choice {
    /// From the cells.
    pub fn new(cells: &Cells, (field, photons): (Field, u64), selector: Selector) -> anyhow::Result<Self> {
        let name = name(field, photons, selector);
        let best = Expected::best(field, photons)?;
        let squares = cells.values(&name, "squared error")?;
        Ok(Choice {
            field,
            photons,
            selector,
            errors: cells.values(&name, "error")?,
            squares: squares.into_iter().map(|square| square / best.squared).collect(),
            octaves: match selector {
                Selector::Nearest(_) => Moments::new(),
                _ => cells.moments(&name, "octaves from the best radius")?,
            },
            best,
        })
    }

    /// All of a case.
    pub fn all(cells: &Cells, case: (Field, u64)) -> anyhow::Result<Vec<Self>> {
        let put = Selector::ALL.into_iter().filter(|selector| is_put(*selector, case.0));
        put.map(|selector| Choice::new(cells, case, selector)).collect()
    }

    /// Mean squared error over that of the best radius.
    pub fn squared(&self) -> Estimate {
        Estimate::mean(&self.squares.iter().collect())
    }

    /// Root mean square error over that of the best radius.
    pub fn regret(&self) -> Estimate {
        self.squared().root()
    }
}

/// The largest regret of a selector on some fields.
pub fn worst(choices: &[Choice], selector: Selector, is_in: impl Fn(Field) -> bool) -> Option<&Choice> {
    let own = choices.iter().filter(|c| c.selector == selector && is_in(c.field));
    own.max_by(|a, b| a.regret().value().total_cmp(&b.regret().value()))
}

/// What the simulator's advice came to.
pub struct Advised {
    /// What is asked.
    pub field: Field,
    /// The error asked for.
    pub target: f64,
    /// Squared regret of the advised radius, with the advised number of photons.
    pub squared: Moments,
    /// Exact root mean square error of the advice over the target.
    pub error: Moments,
    /// The advised number.
    pub photons: Moments,
}

impl Advised {
    /// From the cells.
    pub fn new(cells: &Cells, field: Field, target: f64) -> anyhow::Result<Self> {
        let name = advised(field, target);
        Ok(Advised {
            field,
            target,
            squared: cells.moments(&name, "squared regret")?,
            error: cells.moments(&name, "error over target")?,
            photons: cells.moments(&name, "photons")?,
        })
    }

    /// Root mean square regret over pilots.
    pub fn regret(&self) -> Estimate {
        Estimate::mean(&self.squared).root()
    }
}
