//! The formats that leave: a table to keep and to edit, and drawings.

use crate::error::Error;
use crate::figure::Figure;
use crate::text::Fonts;
use crate::{check, page, png, svg, table, tex};

impl Figure {
    /// The figure as a CSV file to keep and to edit, under a description in words such as its caption.
    ///
    /// Lines `# key: JSON` have the layout, the axes and the looks; tidy rows have the data: `panel`, `layer`, `kind`,
    /// then `x`, `y`, `x_low`, `x_high`, `y_low`, `y_high` and `value` as far as the figure fills them, then `label`.
    /// [`Figure::from_csv`] gives the same figure back, every bit of it.
    ///
    /// # Errors
    /// Any [`Error`] that drawing would meet, save that there may be no room.
    pub fn csv(&self, description: &str) -> Result<String, Error> {
        check::figure(self, &Fonts::load()?)?;
        table::write(self, description)
    }

    /// The figure of such a file, and its description.
    ///
    /// Lines of the table that begin with `#` are left out; columns may stand in any order.
    ///
    /// # Errors
    /// [`Error::Csv`] with the line that is wrong and what is allowed there.
    pub fn from_csv(text: &str) -> Result<(Self, String), Error> {
        table::read(text)
    }

    /// The figure as an SVG document, sized in millimetres.
    ///
    /// # Errors
    /// Any [`Error`]: numbers that cannot be drawn, lists that do not match, no room.
    pub fn svg(&self) -> Result<String, Error> {
        svg::encode(&page::compose(self)?)
    }

    /// The figure as LaTeX with pgfplots: for `\input`, beside its CSV file, whose name is `table`.
    ///
    /// All numbers of points, lines, bands and histograms are read from that file by panel and layer; `label` has to be
    /// its last column, as [`Figure::csv`] writes it. Heat maps are not drawn, and a comment says so.
    ///
    /// # Errors
    /// Any [`Error`]: numbers that cannot be drawn, lists that do not match, no room.
    pub fn tex(&self, table: &str) -> Result<String, Error> {
        tex::write(self, table)
    }

    /// The figure as a PNG file, 300 pixels to the inch of the width in print.
    ///
    /// # Errors
    /// Any [`Error`]: numbers that cannot be drawn, lists that do not match, no room.
    pub fn png(&self) -> Result<Vec<u8>, Error> {
        png::encode(&page::compose(self)?)
    }
}
