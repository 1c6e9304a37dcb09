//! The figures.
use super::data::Data;
use crate::harness::{FigureFiles, Settings};
/// All figures.
pub fn all(_settings: &Settings, _data: &Data) -> anyhow::Result<Vec<FigureFiles>> {
    Ok(Vec::new())
}
