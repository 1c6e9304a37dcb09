//! Groups of cells: what is simulated, and how often.

use super::cell::{CellId, CellOutput};
use super::settings::Settings;
use std::sync::Arc;

/// Measures one cell: a pure function of the settings, and of group and replicate.
pub(super) type Measure = Arc<dyn Fn(&Settings, &CellId) -> anyhow::Result<CellOutput> + Send + Sync>;

/// Cells that differ in their random numbers only.
#[derive(Clone)]
pub struct Group {
    name: String,
    stream: String,
    cells: u64,
    cost: f64,
    held: u64,
    pub(super) measure: Measure,
}

impl Group {
    /// A group (lower case letters, digits, `.`, `_` and `-`) of so many cells, each of a cost in any unit that all
    /// cells of the study share, such as photons.
    pub fn new(
        name: impl Into<String>,
        cells: u64,
        cost: f64,
        measure: impl Fn(&Settings, &CellId) -> anyhow::Result<CellOutput> + Send + Sync + 'static,
    ) -> Self {
        let name = name.into();
        Group { stream: name.clone(), name, cells, cost, held: 0, measure: Arc::new(measure) }
    }

    /// The same, whose random streams keep a name of their own: a group that is renamed draws the same numbers.
    #[must_use]
    pub fn with_stream(self, name: &str) -> Self {
        Group { stream: name.to_string(), ..self }
    }

    /// The same, of maps of at least so many photons.
    #[must_use]
    pub fn holding(self, photons: u64) -> Self {
        Group { held: photons, ..self }
    }

    /// The cells.
    pub fn cells(&self) -> impl Iterator<Item = CellId> {
        (0..self.cells).map(|replicate| CellId {
            group: self.name.clone(),
            stream: self.stream.clone(),
            replicate,
            cost: self.cost,
            held: self.held,
        })
    }
}
