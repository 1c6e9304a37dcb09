//! The lines above the table.

use crate::axis::Axis;
use crate::error::Error;
use crate::figure::{Figure, Legend, Panel, Width};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

/// The layout of the figure.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct FigureLine {
    #[serde(default)]
    pub title: String,
    pub width: Width,
    pub columns: usize,
    #[serde(default)]
    pub heights: Vec<f64>,
    #[serde(default)]
    pub shared_legend: bool,
}

impl FigureLine {
    pub(super) fn of(figure: &Figure) -> Self {
        Self {
            title: figure.title.clone(),
            width: figure.width,
            columns: figure.columns,
            heights: figure.heights.clone(),
            shared_legend: figure.shared_legend,
        }
    }

    pub(super) fn figure(self, panels: Vec<Panel>) -> Figure {
        let Self { title, width, columns, heights, shared_legend } = self;
        Figure { title, width, panels, columns, heights, shared_legend }
    }
}

/// Heading, axes and legend of a panel.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct PanelLine {
    #[serde(default)]
    pub title: String,
    pub x: Axis,
    pub y: Axis,
    pub legend: Legend,
}

impl PanelLine {
    pub(super) fn of(panel: &Panel) -> Self {
        let Panel { title, x, y, layers: _, legend } = panel.clone();
        Self { title, x, y, legend }
    }

    pub(super) fn panel(self) -> Panel {
        Panel { title: self.title, x: self.x, y: self.y, layers: Vec::new(), legend: self.legend }
    }
}

/// A value in its place in the file.
#[derive(Debug, Clone, Copy)]
pub(super) struct Json<'a> {
    pub line: usize,
    /// Characters of the line before it.
    pub before: usize,
    pub text: &'a str,
}

impl Json<'_> {
    /// The value as a `T`.
    pub(super) fn parse<T: DeserializeOwned>(&self) -> Result<T, Error> {
        serde_json::from_str(self.text).map_err(|e| {
            let text = e.to_string();
            let problem = text.rsplit_once(" at line ").map_or(text.as_str(), |(problem, _)| problem);
            let within = self.text.char_indices().take_while(|(i, _)| i + 1 < e.column()).count();
            Error::Csv {
                line: self.line,
                column: Some(self.before + within + 1),
                problem: problem.to_owned(),
            }
        })
    }
}

/// A value as one line of JSON.
pub(super) fn json(value: &impl Serialize) -> Result<String, Error> {
    serde_json::to_string(value).map_err(|e| Error::Backend(e.to_string()))
}

/// The lines above the table, by what they are about, and the number of these lines.
#[derive(Default)]
pub(super) struct Header<'a> {
    pub description: Option<Json<'a>>,
    pub figure: Option<Json<'a>>,
    pub panels: Vec<Json<'a>>,
    /// Looks of the layers of each panel.
    pub layers: Vec<Vec<Json<'a>>>,
    pub lines: usize,
}

impl<'a> Header<'a> {
    /// Sorts the lines that begin with `#`, up to the first that does not.
    pub(super) fn read(text: &'a str) -> Result<Self, Error> {
        let mut header = Self::default();
        for (i, line) in text.lines().enumerate().take_while(|(_, line)| line.starts_with('#')) {
            header.lines = i + 1;
            let problem = |problem: String| Error::Csv { line: i + 1, column: None, problem };
            let Some((key, value)) = line[1..].split_once(':') else {
                return Err(problem(format!("{line:?} is no header line; allowed: # key: value")));
            };
            let value =
                Json { line: i + 1, before: line[..line.len() - value.len()].chars().count(), text: value };
            let key = key.trim();
            let is_new = match key.split_once(' ').unwrap_or((key, "")) {
                ("turbid", "figure") => {
                    let version: u32 = value.parse()?;
                    if version != super::VERSION {
                        let known = super::VERSION;
                        return Err(problem(format!("the format is {version}; allowed: {known}")));
                    }
                    i == 0
                }
                ("description", "") => header.description.replace(value).is_none(),
                ("figure", "") => header.figure.replace(value).is_none(),
                ("panel", number) => {
                    let next = header.panels.len() + 1;
                    header.panels.push(value);
                    header.layers.push(Vec::new());
                    number == next.to_string()
                }
                ("layer", number) => {
                    let panel = header.panels.len();
                    let Some(layers) = header.layers.last_mut() else {
                        return Err(problem("a layer stands before its panel".to_owned()));
                    };
                    layers.push(value);
                    number == format!("{panel}.{}", layers.len())
                }
                _ => {
                    return Err(problem(format!(
                        "{key:?} is unknown; allowed: turbid figure, description, figure, panel N, layer N.M"
                    )));
                }
            };
            if !is_new {
                return Err(problem(format!(
                    "{key:?} is out of order; allowed: turbid figure first, description and figure once, \
                     panel 1, its layers 1.1, 1.2 and so on, then panel 2"
                )));
            }
        }
        if !text.starts_with("# turbid figure") {
            return Err(Error::Csv {
                line: 1,
                column: None,
                problem: format!(
                    "the file is no figure; its first line would be # turbid figure: {}",
                    super::VERSION
                ),
            });
        }
        Ok(header)
    }

    /// A line that has to be there.
    pub(super) fn required(&self, value: Option<Json<'a>>, key: &str) -> Result<Json<'a>, Error> {
        value.ok_or_else(|| Error::Csv {
            line: self.lines,
            column: None,
            problem: format!("the header ends without a line # {key}: ..."),
        })
    }
}
