//! All cells of one experiment, merged in sorted order.

use super::cell::{self, Header};
use super::{CellId, Digest, Estimate, Settings};
use anyhow::{Context, bail, ensure};
use std::collections::{BTreeMap, HashMap, HashSet};
use std::path::Path;
use turbid::stats::Moments;

/// The measured values of one experiment, map by map.
///
/// Maps are in the order of their names, the same for every quantity: values of two quantities measured on the same
/// maps are paired.
#[derive(Debug, Clone, Default)]
pub struct Cells {
    ids: Vec<CellId>,
    values: BTreeMap<(String, String), Vec<(usize, f64)>>,
    counters: BTreeMap<String, u64>,
    /// What each cell took, in the order of the cells.
    pub(super) seconds: Vec<CellSeconds>,
    /// Programs that made the cells.
    pub(super) programs: Vec<String>,
}

/// CPU seconds of one cell.
#[derive(Debug, Clone)]
pub(super) struct CellSeconds {
    pub cell: String,
    pub total: f64,
    pub phases: BTreeMap<String, f64>,
}

/// Fewest different fractions of a cell that tell it from all others: a few counts of two maps may well be the same.
const FEWEST_TELLING: usize = 8;

/// A digest of what a cell measured, if that tells it from all others of its group.
fn telling(rows: &[cell::CellRow]) -> Option<String> {
    let fractions: HashSet<u64> =
        rows.iter().map(|row| row.value).filter(|x| x.fract() != 0.0).map(f64::to_bits).collect();
    let mut lines: Vec<String> = rows
        .iter()
        .map(|row| format!("{}\t{}\t{:x}\n", row.case, row.quantity, row.value.to_bits()))
        .collect();
    lines.sort();
    (fractions.len() >= FEWEST_TELLING).then(|| Digest::of(lines.concat().as_bytes()).to_string())
}

impl Cells {
    /// Reads the files of all cells of an experiment; refuses a set that is not complete, of another experiment or of other
    /// settings, and maps of one group that are the same.
    pub(super) fn read(
        folder: &Path,
        experiment: &str,
        expected: &[CellId],
        settings: &Settings,
    ) -> anyhow::Result<Self> {
        let (settings, is_scaled) = (settings.words(), settings.photon_scale != 1.0);
        let mut ids = expected.to_vec();
        ids.sort_by_key(CellId::id);
        let (mut cells, mut seen) = (Cells::default(), HashMap::new());
        for (index, id) in ids.iter().enumerate() {
            let (header, rows) =
                cell::read(&folder.join(format!("{}.csv", id.id()))).context("the set is incomplete")?;
            ensure!(
                header.experiment == experiment,
                "cell {} of {experiment} is that of {}",
                id.id(),
                header.experiment
            );
            ensure!(
                header.settings == settings && header.id == id.id(),
                "cell {} in {} is that of {} by other settings ({}, not {settings})",
                id.id(),
                folder.display(),
                header.id,
                header.settings
            );
            if let Some(digest) = telling(&rows)
                && let Some(first) = seen.insert((id.group.as_str(), digest), id)
            {
                bail!(
                    "cells {} and {} of {} measured the same numbers: they are one map, not two",
                    first.id(),
                    id.id(),
                    header.experiment
                );
            }
            cells.add(index, header, rows, is_scaled)?;
        }
        cells.ids = ids;
        Ok(cells)
    }

    /// Adds a cell; a scale of photons may make two of its cases one, of which the first counts.
    fn add(
        &mut self,
        index: usize,
        header: Header,
        rows: Vec<cell::CellRow>,
        is_scaled: bool,
    ) -> anyhow::Result<()> {
        if header.non_finite > 0 {
            bail!(
                "{} non-finite contributions in cell {} of {}; allowed: 0",
                header.non_finite,
                header.id,
                header.experiment
            );
        }
        for row in rows {
            let values = self.values.entry((row.case, row.quantity)).or_default();
            let twice = values.last().is_some_and(|last| last.0 == index);
            ensure!(
                !twice || is_scaled,
                "cell {} of {} gives one quantity twice",
                header.id,
                header.experiment
            );
            if !twice {
                values.push((index, row.value));
            }
        }
        for (name, count) in header.counters {
            *self.counters.entry(name).or_insert(0) += count;
        }
        let (cell, total, phases) = (header.id, header.cpu_seconds, header.phases);
        self.seconds.push(CellSeconds { cell, total, phases });
        self.programs.push(header.program);
        Ok(())
    }

    /// The values of one quantity, one a map, in the order of the maps.
    ///
    /// # Errors
    /// If no map has it.
    pub fn values(&self, case: &str, quantity: &str) -> anyhow::Result<Vec<f64>> {
        Ok(self.find(case, quantity)?.iter().map(|&(_, value)| value).collect())
    }

    /// Moments over the maps.
    ///
    /// # Errors
    /// If no map has the quantity.
    pub fn moments(&self, case: &str, quantity: &str) -> anyhow::Result<Moments> {
        Ok(self.values(case, quantity)?.iter().collect())
    }

    /// Mean over the maps with its error.
    ///
    /// # Errors
    /// If no map has the quantity.
    pub fn estimate(&self, case: &str, quantity: &str) -> anyhow::Result<Estimate> {
        Ok(Estimate::mean(&self.moments(case, quantity)?))
    }

    /// Paired values, one list a map with one value a case: what a fit per map needs.
    ///
    /// # Errors
    /// If a case is missing, or was measured on other maps than the first.
    pub fn per_map(&self, cases: &[String], quantity: &str) -> anyhow::Result<Vec<Vec<f64>>> {
        let Some(first) = cases.first() else { return Ok(Vec::new()) };
        let maps: Vec<usize> = self.find(first, quantity)?.iter().map(|&(index, _)| index).collect();
        let mut lists = vec![Vec::with_capacity(cases.len()); maps.len()];
        for case in cases {
            let values = self.find(case, quantity)?;
            let same = values.len() == maps.len() && values.iter().zip(&maps).all(|(v, &m)| v.0 == m);
            ensure!(same, "{quantity} of {case} and of {first} were measured on different maps");
            for (list, &(_, value)) in lists.iter_mut().zip(values) {
                list.push(value);
            }
        }
        Ok(lists)
    }

    fn find(&self, case: &str, quantity: &str) -> anyhow::Result<&Vec<(usize, f64)>> {
        let key = (case.to_string(), quantity.to_string());
        self.values.get(&key).with_context(|| format!("no cell measured {quantity} of {case}"))
    }

    /// All pairs of case and quantity, sorted.
    pub fn keys(&self) -> impl Iterator<Item = (&str, &str)> {
        self.values.keys().map(|(case, quantity)| (case.as_str(), quantity.as_str()))
    }

    /// A counter summed over all cells; 0 if none has it.
    pub fn counter(&self, name: &str) -> u64 {
        self.counters.get(name).copied().unwrap_or(0)
    }

    /// CPU seconds of one phase, one a cell of a group that timed it: what this machine needed, for text and figures
    /// that say so, never for results and claims.
    pub fn seconds(&self, group: &str, phase: &str) -> Vec<f64> {
        let own = self.ids.iter().zip(&self.seconds).filter(|(id, _)| id.group == group);
        own.filter_map(|(_, seconds)| seconds.phases.get(phase).copied()).collect()
    }

    /// All counters, summed over the cells.
    pub fn counters(&self) -> &BTreeMap<String, u64> {
        &self.counters
    }

    /// The cells, sorted by name.
    pub fn ids(&self) -> &[CellId] {
        &self.ids
    }
}
