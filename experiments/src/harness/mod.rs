//! The machinery of a study: settings, cells, predictions before measurements, claims and verdicts, results.
//!
//! An experiment is a constant of type [`Experiment`] in a module of its own. Its cells are pure functions of the
//! settings, each one map; they run in parallel, are kept in files, and are merged in sorted order, so that results
//! are the same bits on any number of threads and after any interruption.

mod answer;
mod cell;
mod cells;
mod claim;
mod digest;
mod estimate;
mod experiment;
mod format;
mod group;
mod headline;
mod lock;
mod manifest;
mod measure;
mod merge;
mod outcome;
mod outputs;
mod panics;
mod parameters;
mod part;
mod program;
mod progress;
mod provenance;
mod question;
mod replot;
mod results;
mod section;
mod settings;
mod study;
mod unit;

pub use answer::{ANSWER, Answer, Curves, Point, QUERIES, Reached, TARGETS, Untreated};
pub(crate) use cell::read as read_cell;
pub use cell::{CellId, CellOutput, CellRow};
pub use cells::Cells;
pub use claim::{
    Basis, Claim, FAMILY_WISE, FIT_LEVEL, GEOMETRIC, Judged, Kind, LEFT_OVER, MIN_MAPS, PREDICTED, Verdict,
    judge,
};
pub use digest::{Digest, program_digest};
pub use estimate::Estimate;
pub use experiment::Experiment;
pub use format::{number, percent, percent_with_error, signed, with_error, with_rough_error};
pub use group::Group;
pub use headline::Headline;
pub(crate) use outcome::cost_line;
pub use outcome::{Outcome, SectionReport};
pub(crate) use outputs::{check_folder, check_later, read_if_there};
pub(crate) use panics::{caught, guarded};
pub use parameters::Parameters;
pub use part::Share;
pub(crate) use program::{on_threads, one_line, program, seed, threads};
pub(crate) use progress::duration;
pub use progress::{Terminal, Watch, say};
pub use provenance::Provenance;
pub use question::Question;
pub use replot::replot;
pub(crate) use replot::try_redraw;
pub use results::Row;
pub(crate) use section::row_label;
pub use section::{FigureFiles, OtherWidth, Section, Table, bar, percent_bar, positive_bar};
pub use settings::{Preset, Replot, Settings};
pub use study::{Asked, Closing, Findings, Study, main, main_with, run, run_watched};
pub use unit::Unit;
