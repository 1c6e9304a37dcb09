//! What one cell measured, and the file that keeps it.
//!
//! The file is a line of JSON (who made it, counters, seconds by phase), a table `case,quantity,value`, and a last line with
//! the digest of everything above: a file that was cut short, or changed, is not taken for a cell.

use super::digest::Digest;
use anyhow::{Context, bail, ensure};
use cpu_time::ThreadTime;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::Path;
use turbid::output::write_atomically;

/// One measured value: one quantity of one map.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CellRow {
    /// Which case: gather size, probe, estimator, in words that the predictions share.
    pub case: String,
    /// Which quantity.
    pub quantity: String,
    /// The value of this map.
    pub value: f64,
}

/// What one cell measured.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct CellOutput {
    /// One value a case and quantity.
    pub rows: Vec<CellRow>,
    /// Work done, by name: photons emitted, records visited.
    pub counters: BTreeMap<String, u64>,
    /// CPU seconds by phase of the work: measurements of the machine, kept apart from all results.
    pub seconds: BTreeMap<String, f64>,
    /// Non-finite contributions met on the way; any fails the study.
    pub non_finite: u64,
}

impl CellOutput {
    /// Nothing measured yet.
    pub fn new() -> Self {
        CellOutput::default()
    }

    /// Adds a value. One that is not finite counts as a non-finite contribution.
    pub fn push(&mut self, case: impl Into<String>, quantity: impl Into<String>, value: f64) {
        self.non_finite += u64::from(!value.is_finite());
        self.rows.push(CellRow { case: case.into(), quantity: quantity.into(), value });
    }

    /// Does a part of the work and adds the CPU seconds it took to a phase.
    pub fn time<T>(&mut self, phase: &str, work: impl FnOnce(&mut Self) -> T) -> T {
        let start = ThreadTime::now();
        let result = work(self);
        *self.seconds.entry(phase.to_string()).or_insert(0.0) += start.elapsed().as_secs_f64();
        result
    }

    /// Adds to a counter.
    pub fn count(&mut self, name: &str, more: u64) {
        *self.counters.entry(name.to_string()).or_insert(0) += more;
    }
}

/// First line of a cell's file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Header {
    pub format: u32,
    pub experiment: String,
    pub id: String,
    pub settings: String,
    pub program: String,
    pub cpu_seconds: f64,
    pub phases: BTreeMap<String, f64>,
    pub non_finite: u64,
    pub counters: BTreeMap<String, u64>,
}

/// Raised when files of an older form can no longer be read.
pub(super) const FORMAT: u32 = 4;

const END: &str = "#end ";

/// Writes the file of one cell.
pub(super) fn write(path: &Path, header: &Header, rows: &[CellRow]) -> anyhow::Result<()> {
    let mut bytes = b"#".to_vec();
    serde_json::to_writer(&mut bytes, header)?;
    bytes.push(b'\n');
    turbid::output::write_csv(&mut bytes, rows)?;
    let end = format!("{END}{}\n", Digest::of(&bytes));
    bytes.extend_from_slice(end.as_bytes());
    write_atomically(path, |out| out.write_all(&bytes))?;
    Ok(())
}

/// Larger files are no cells.
const MOST_BYTES: u64 = 1 << 28;

/// Reads the file of one cell; an error says why it is not one.
pub(crate) fn read(path: &Path) -> anyhow::Result<(Header, Vec<CellRow>)> {
    let text = turbid::input::read_text(path, MOST_BYTES)
        .with_context(|| format!("cannot read {}", path.display()))?;
    parse(&text).with_context(|| format!("{} is not a complete cell", path.display()))
}

fn parse(text: &str) -> anyhow::Result<(Header, Vec<CellRow>)> {
    let Some(end) = text.rfind(END) else { bail!("the end mark is missing") };
    let (body, mark) = text.split_at(end);
    ensure!(mark == format!("{END}{}\n", Digest::of(body.as_bytes())), "the digest does not fit");
    let (first, table) = body.split_once('\n').context("the first line is missing")?;
    let header: Header = serde_json::from_str(first.trim_start_matches('#'))?;
    ensure!(header.format == FORMAT, "its format is {}, not {FORMAT}", header.format);
    let rows = csv::Reader::from_reader(table.as_bytes()).deserialize().collect::<Result<_, _>>()?;
    Ok((header, rows))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn header() -> Header {
        Header {
            format: FORMAT,
            experiment: "bias".into(),
            id: "slab-000001".into(),
            settings: "quick".into(),
            program: "00".into(),
            cpu_seconds: 0.1,
            phases: BTreeMap::from([("shooting".to_string(), 0.05)]),
            non_finite: 0,
            counters: BTreeMap::from([("photons".to_string(), 10)]),
        }
    }

    fn rows() -> Vec<CellRow> {
        let values = [0.1, 1.0 / 3.0, 5e-324, f64::MAX, -0.0, 1e-12];
        let row = |(i, &value): (usize, &f64)| CellRow {
            case: format!("r = {i}, \"box\"\n#end "),
            quantity: "b,i".into(),
            value,
        };
        values.iter().enumerate().map(row).collect()
    }

    #[test]
    fn a_cell_comes_back_bit_by_bit() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.csv");
        write(&path, &header(), &rows()).unwrap();
        let (head, back) = read(&path).unwrap();
        assert_eq!((head, &back), (header(), &rows()));
        assert!(back.iter().zip(rows()).all(|(a, b)| a.value.to_bits() == b.value.to_bits()));
    }

    #[test]
    fn every_cut_and_every_changed_byte_is_seen() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.csv");
        write(&path, &header(), &rows()).unwrap();
        let text = std::fs::read_to_string(&path).unwrap();
        for length in 0..text.len() {
            assert!(parse(&text[..length]).is_err(), "cut at {length}");
        }
        for i in 0..text.len() {
            let mut bytes = text.clone().into_bytes();
            bytes[i] ^= 1;
            assert!(parse(std::str::from_utf8(&bytes).unwrap()).is_err(), "byte {i}");
        }
    }

    #[test]
    fn phases_are_timed() {
        let mut output = CellOutput::new();
        let sum = output.time("adding", |_| (0..1_000_000).fold(0.0, |sum, i| sum + f64::from(i).sqrt()));
        output.time("adding", |output| output.push("a", "q", sum));
        assert!(output.seconds.len() == 1 && output.seconds["adding"] > 0.0 && output.rows.len() == 1);
    }

    #[test]
    fn what_is_not_finite_is_counted() {
        let mut output = CellOutput::new();
        output.push("a", "q", 1.0);
        output.push("a", "r", f64::NAN);
        output.count("photons", 3);
        output.count("photons", 4);
        assert_eq!((output.non_finite, output.counters["photons"], output.rows.len()), (1, 7, 2));
    }
}

/// One cell: a map, or a batch of paths, that is a pure function of settings, group and replicate.
#[derive(Debug, Clone, PartialEq)]
pub struct CellId {
    /// What is simulated: maps of one group differ in their random numbers only.
    pub group: String,
    /// What names the group in random streams: the group, if it was never renamed.
    pub stream: String,
    /// Number of the independent repetition, from 0; it goes into the random streams.
    pub replicate: u64,
    /// Work, in any unit that all cells of the study share, such as photons: for order and remaining time.
    pub cost: f64,
    /// Photons that it holds at one time, at least; 0 where their number does not follow the settings.
    pub held: u64,
}

impl CellId {
    /// A cell that is known by its name alone.
    pub fn of(group: &str, replicate: u64) -> Self {
        let name = group.to_string();
        CellId { group: name.clone(), stream: name, replicate, cost: 0.0, held: 0 }
    }

    /// The unique file-safe name; names sort as replicates do.
    pub fn id(&self) -> String {
        format!("{}-{:06}", self.group, self.replicate)
    }

    /// The number that random streams take as their replicate: different for every experiment and group, so that
    /// cells of different groups share no histories. The experiment is named as when it was founded: names that are
    /// shown change, random numbers do not.
    pub fn stream(&self, experiment: &str) -> u64 {
        let name = Digest::of(format!("{experiment}/{}", self.stream).as_bytes());
        name.word() << 24 | self.replicate
    }

    /// Whether the group can be part of a file's name.
    pub(super) fn is_file_safe(&self) -> bool {
        let allowed = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || "._-".contains(c);
        !self.group.is_empty()
            && self.group.len() <= 100
            && !self.group.starts_with('.')
            && self.group.chars().all(allowed)
    }
}
