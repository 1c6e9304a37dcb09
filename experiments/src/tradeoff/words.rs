//! Words.
use super::conclude::left_over;
use super::data::Data;
use super::predict::Known;
use crate::harness::Entry;
/// Summary.
pub fn summary(_data: &Data, _known: &Known) -> anyhow::Result<Vec<String>> {
    Ok(vec!["x".into()])
}
/// Notes.
pub fn notes(b: &[Entry], _data: &Data) -> Vec<String> {
    vec![format!("{:?}", left_over(b))]
}
