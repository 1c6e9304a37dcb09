//! A scene of Mitsuba as it grows.

use crate::error::{Error, Result};
use crate::exchange::Beside;
use crate::exchange::xml::Xml;
use crate::scene::Scene;

/// What has been written so far.
pub(super) struct Writer<'a> {
    pub scene: &'a Scene,
    /// What names of files begin with.
    pub stem: &'a str,
    pub xml: Xml,
    pub files: Vec<Beside>,
    pub notes: Vec<String>,
    /// Places nearer to each other than this are one to Mitsuba's rays \[L\].
    pub nearest: f64,
}

/// Refuses a scene.
pub(super) fn refuse<T>(text: impl Into<String>) -> Result<T> {
    Err(Error::Scene(text.into()))
}

impl Writer<'_> {
    /// Takes a file that is to stand beside, and says its name.
    pub fn beside(&mut self, what: &str, extension: &str, bytes: Vec<u8>) -> String {
        let name = format!("{}-{what}.{extension}", self.stem);
        self.files.push(Beside { name: name.clone(), bytes });
        name
    }

    /// The name of a medium.
    pub fn medium_name(&self, number: usize) -> String {
        let regions = self.scene.regions().len();
        if number < regions {
            return format!("region-{number}");
        }
        let filled = |interior: &usize| self.scene.filling(*interior) == Some(number);
        let interior = (0..self.scene.interiors().len()).find(filled).unwrap_or_default();
        format!("interior-{}", interior.saturating_sub(1))
    }
}
