//! A figure in another width of print.

use crate::figure::{Figure, Legend, Width};
use crate::page::HEIGHT;

/// Panels narrower than this stand below each other [mm]: labels keep their size in print, plots do not.
const PANEL: f64 = 80.0;
/// Height of a page [mm], what labels and titles take of it beside each row of plots, and the flattest plot, as a ratio.
const PAGE: f64 = 230.0;
const AROUND: f64 = 14.0;
const STRIP: f64 = 0.4;

impl Width {
    /// Between the two widths of a journal: one column up to here [mm].
    const BETWEEN: f64 = 130.0;

    /// The other width of a journal: double of what is drawn single, single of what is drawn double.
    #[must_use]
    pub fn other(self) -> Self {
        if self.millimetres() <= Self::BETWEEN { Self::Double } else { Self::Single }
    }

    /// Its name in a word.
    #[must_use]
    pub fn name(self) -> &'static str {
        if self.millimetres() <= Self::BETWEEN { "single" } else { "double" }
    }
}

impl Figure {
    /// The same figure laid out for another width: as many panels in a row as stay legible, text of the same size.
    ///
    /// Legends keep out of the way: what was to the right goes below in one column, what stood in a given corner
    /// looks for room again. Plots that become wider or narrower change their height by the root of that factor, so
    /// that neither their shape nor their height changes altogether.
    #[must_use]
    pub fn in_width(&self, width: Width) -> Self {
        let (from, to) = (self.width.millimetres(), width.millimetres());
        if from == to {
            return Self { width, ..self.clone() };
        }
        let old = self.columns.clamp(1, self.panels.len().max(1));
        let fit = ((to / PANEL).floor() as usize).max(1);
        let columns = if to < from { old.min(fit) } else { self.panels.len().clamp(1, fit.max(old)) };
        let factor = (from / old as f64) / (to / columns as f64);
        let height = |panel: usize| {
            let ratio = self.heights.get(panel / old).copied().unwrap_or(HEIGHT);
            // Squares stay squares at most: nothing grows taller than wide.
            (ratio * factor.sqrt()).min(ratio.max(1.0))
        };
        let rows = self.panels.len().div_ceil(columns);
        let tall = self.rows_of(columns, height);
        // What stands on one page of print stays on one page, unless plots would become strips.
        let room = PAGE - rows as f64 * AROUND;
        let flatter = (room / (tall.iter().sum::<f64>() * to / columns as f64)).min(1.0);
        let heights = tall.into_iter().map(|h| (h * flatter).max(h.min(STRIP))).collect();
        let mut panels = self.panels.clone();
        for panel in &mut panels {
            panel.legend = match panel.legend {
                Legend::Right if columns > 1 || to < from => Legend::Below,
                // A corner that was free in one shape need not be in another.
                Legend::Inside(_) => Legend::Auto,
                other => other,
            };
        }
        Self { width, columns, heights, panels, ..self.clone() }
    }

    /// The same figure with so many panels in a row, the ratios of their sides as before.
    pub(crate) fn in_columns(&self, columns: usize) -> Self {
        let old = self.columns.max(1);
        let height = |panel: usize| self.heights.get(panel / old).copied().unwrap_or(HEIGHT);
        Self { columns, heights: self.rows_of(columns, height), ..self.clone() }
    }

    /// The greatest of the panels' numbers in each row of so many.
    fn rows_of(&self, columns: usize, number: impl Fn(usize) -> f64) -> Vec<f64> {
        let panels: Vec<f64> = (0..self.panels.len()).map(number).collect();
        panels.chunks(columns).map(|row| row.iter().copied().fold(0.0, f64::max)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::axis::Axis;
    use crate::figure::Panel;
    use crate::layer::Line;

    fn figure(width: Width, panels: usize, columns: usize, heights: &[f64]) -> Figure {
        let line = Line::theory("exact", vec![0.0, 1.0], vec![0.0, 1.0]);
        let panel = Panel::new(Axis::linear("x", ""), Axis::linear("y", "")).with(line);
        Figure { width, columns, heights: heights.to_vec(), ..Figure::new(vec![panel; panels]) }
    }

    #[test]
    fn panels_move_below_each_other_and_keep_their_heights() {
        let single = figure(Width::Double, 3, 3, &[0.5]).in_width(Width::Single);
        assert_eq!((single.columns, single.heights.len()), (1, 3));
        // Each plot was a third of 175 mm wide and is 85 mm now: its ratio falls by the root of that.
        assert!((single.heights[2] - 0.5 * (175.0_f64 / 3.0 / 85.0).sqrt()).abs() < 1e-15);
        let double = figure(Width::Single, 3, 1, &[0.5, 0.9, 0.6]).in_width(Width::Double);
        assert_eq!((double.columns, double.heights.len()), (2, 2));
        assert!(double.heights[0] > double.heights[1]);
        let unchanged = figure(Width::Double, 3, 2, &[]);
        assert_eq!(unchanged.in_width(Width::Double), unchanged);
    }

    #[test]
    fn many_panels_stay_on_a_page() {
        let six = figure(Width::Double, 6, 2, &[0.8, 0.8, 0.8]).in_width(Width::Single);
        // Six rows of 14 mm beside the plots leave 146 mm: 24 mm a plot, but no flatter than 0.4 of 85 mm.
        assert_eq!(six.heights, [0.4; 6]);
        let four = figure(Width::Double, 4, 2, &[1.0, 1.0]).in_width(Width::Single);
        assert!((four.heights[0] - 174.0 / 4.0 / 85.0).abs() < 1e-12);
    }

    #[test]
    fn nothing_grows_taller_than_wide_that_was_not() {
        assert_eq!(figure(Width::Double, 1, 1, &[0.9]).in_width(Width::Single).heights, [1.0]);
        assert_eq!(figure(Width::Double, 1, 1, &[1.2]).in_width(Width::Single).heights, [1.2]);
    }

    #[test]
    fn each_width_is_the_other_of_the_other() {
        assert_eq!((Width::Single.other(), Width::Double.other()), (Width::Double, Width::Single));
        assert_eq!(
            (Width::Millimetres(60.0).other(), Width::Millimetres(180.0).name()),
            (Width::Double, "double")
        );
    }
}
