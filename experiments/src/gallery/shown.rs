//! What the page tells of a picture; kept beside its PNG files, so that pictures can be made one at a time.

use super::compare::{Agreement, Comparison, Errors};
use super::keep::RenderRecord;
use serde::{Deserialize, Serialize};
use turbid::stats::Interval;

/// One PNG file with its caption.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Plate {
    /// Name of the file, beside the page.
    pub file: String,
    /// What it is.
    pub caption: String,
    /// Which of the picture's plates: `photons`, `paths`, `reference`, `error`, ...
    pub kind: String,
}

/// Numbers of a picture's comparison with its reference.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Compared {
    /// Independent replicates of the photon mapper's picture.
    pub replicates: usize,
    /// Root mean square error of the picture that is shown, over its mean, 95 per cent.
    pub rms: [f64; 2],
    /// The systematic part, 95 per cent.
    pub systematic: [f64; 2],
    /// Error of the picture's mean, 95 per cent.
    pub bias: [f64; 2],
    /// Root mean square error of the rival's picture in the same time, 95 per cent.
    pub equal_rms: [f64; 2],
    /// The rival: of the methods without photon maps that raced the one with the smallest error.
    #[serde(default = "paths")]
    pub rival: String,
    /// The others, with their errors, 95 per cent.
    #[serde(default)]
    pub beaten: Vec<(String, [f64; 2])>,
    /// The picture with its medium read along whole rays, in the same time: from what, and its error, 95 per cent.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub along: Vec<(String, [f64; 2])>,
    /// The verdict in words.
    pub verdict: String,
    /// Blocks and channels compared, and how many differ.
    pub blocks: (usize, usize),
    /// Share that was masked beforehand, of the pixels that scatter light.
    pub masked: f64,
    /// Share without a verdict for its heavy tails, of the same.
    pub heavy: f64,
    /// Median of the smallest detectable relative deviations.
    pub smallest: f64,
}

/// The one rival of results that name none.
fn paths() -> String {
    "paths".to_string()
}

impl Compared {
    /// The numbers of a comparison.
    ///
    /// # Arguments   `raced` methods without photon maps and their errors, the smallest first; at least one. `along` whole rays, likewise
    pub fn new(
        comparison: &Comparison,
        errors: &Errors,
        replicates: usize,
        rms: Interval,
        raced: &[(&str, Interval)],
        along: &[(&str, Interval)],
    ) -> Self {
        let pair = |i: Interval| [i.low, i.high];
        let named =
            |all: &[(&str, Interval)]| all.iter().map(|(name, rms)| (name.to_string(), pair(*rms))).collect();
        let agreement = comparison.agreement();
        let differ = if let Agreement::Differ(n) = agreement { n } else { 0 };
        let verdict = match agreement {
            Agreement::Agree => "agrees with its reference".to_string(),
            Agreement::Differ(_) => "differs from its reference".to_string(),
            Agreement::Undecided(why) => format!("undecided: {why}"),
        };
        Compared {
            replicates,
            rms: pair(rms),
            systematic: pair(errors.systematic),
            bias: pair(errors.bias),
            equal_rms: pair(raced[0].1),
            rival: raced[0].0.to_string(),
            beaten: named(&raced[1..]),
            along: named(along),
            verdict,
            blocks: (comparison.blocks.len(), differ),
            masked: comparison.masked,
            heavy: comparison.heavy,
            smallest: comparison.typical_smallest(),
        }
    }
}

/// All that the page tells of a picture.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PageEntry {
    /// Name of the picture.
    pub name: String,
    /// The command that renders it as EXR.
    pub command: String,
    /// Columns and rows of pixels.
    pub size: (usize, usize),
    /// CPU seconds of everything of it.
    pub seconds: f64,
    /// The photon mapper's picture.
    pub ours: RenderRecord,
    /// The rival's in the same time; none of a draft.
    pub equal: Option<RenderRecord>,
    /// Samples a pixel and CPU seconds of the reference; none of a draft.
    pub reference: Option<(u64, f64)>,
    /// The comparison; none of a draft.
    pub compared: Option<Compared>,
    /// PNG files.
    pub plates: Vec<Plate>,
}
