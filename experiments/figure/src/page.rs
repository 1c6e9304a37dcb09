//! From a figure to marks on a page: sizes, places, then drawing.

use crate::check;
use crate::draw::draw;
use crate::error::Error;
use crate::extent::{Spans, spans};
use crate::figure::{Figure, Legend as Place, Panel};
use crate::frame::Frame;
use crate::layer::Align;
use crate::legend::Legend;
use crate::mark::{Mark, Page, Rect, Text};
use crate::obstacles;
use crate::plot::Plot;
use crate::text::{Fonts, LARGE, LEADING, SMALL, plain};

/// White border of the page [pt].
const BORDER: f64 = 3.0;
/// Distance of columns and of rows [pt].
const BETWEEN_COLUMNS: f64 = 12.0;
const BETWEEN_ROWS: f64 = 8.0;
/// Distance of a legend from what is above or left of it [pt].
const LEGEND_GAP: f64 = 5.0;
/// Narrower plots are not worth printing [pt].
const LEAST: f64 = 45.0;
/// Height over width where the figure does not say.
pub(crate) const HEIGHT: f64 = 0.75;

/// Places of all plots, and the size of the page.
struct Layout {
    rects: Vec<Rect>,
    frames: Vec<Frame>,
    /// Width for the legend of a panel: below it, and to its right.
    column: f64,
    /// Bottom of the plots and their labels.
    bottom: f64,
}

/// The page that shows the figure.
pub(crate) fn compose(figure: &Figure) -> Result<Page, Error> {
    let fonts = Fonts::load()?;
    check::figure(figure, &fonts)?;
    let spans: Vec<Spans> =
        figure.panels.iter().enumerate().map(|(i, p)| spans(i + 1, p)).collect::<Result<_, _>>()?;
    let width = figure.width.millimetres() * 72.0 / 25.4;
    let title = fonts.wrap(&figure.title, LARGE, true, width - 2.0 * BORDER);
    let top = BORDER + if title.is_empty() { 0.0 } else { title.len() as f64 * LARGE * LEADING + 3.0 };

    let mut places: Vec<Place> =
        figure.panels.iter().map(|p| if figure.shared_legend { Place::Hidden } else { p.legend }).collect();
    let mut layout = arrange(figure, &spans, &places, width, top, &fonts)?;
    // Before anything is drawn: dashes and bars take memory in proportion to the height.
    check_height(layout.bottom)?;
    for (i, panel) in figure.panels.iter().enumerate() {
        if places[i] == Place::Auto {
            let plot = Plot { rect: layout.rects[i], spans: spans[i] };
            let obstacles = obstacles::between(&plot, &panel.layers, &fonts);
            let free = Legend::new(panel.layers.iter(), plot.rect.width, false, &fonts)
                .map(|l| l.free_corner(&plot.rect, &obstacles));
            places[i] = match free {
                None => Place::Hidden,
                Some(None) => Place::Below,
                Some(Some(corner)) => Place::Inside(corner),
            };
        }
    }
    // Legends below change heights only, so that corners found free stay free.
    layout = arrange(figure, &spans, &places, width, top, &fonts)?;
    check_height(layout.bottom)?;

    let mut marks = Vec::new();
    for (i, line) in title.iter().enumerate() {
        let at = (BORDER, BORDER + (i as f64 + 0.8) * LARGE * LEADING);
        marks.push(Mark::Text(Text { bold: true, ..plain(line, at, Align::Start, LARGE) }));
    }
    for (i, panel) in figure.panels.iter().enumerate() {
        let plot = Plot { rect: layout.rects[i], spans: spans[i] };
        let frame = &layout.frames[i];
        frame.draw_under(&plot, panel, &mut marks);
        draw(&plot, &panel.layers, &fonts, &mut marks);
        frame.draw_over(&plot, panel, &mut marks);
        draw_legend(panel, places[i], &plot.rect, frame, layout.column, &fonts, &mut marks);
    }
    let mut bottom = layout.bottom;
    if figure.shared_legend {
        let layers = figure.panels.iter().flat_map(|p| &p.layers);
        if let Some(legend) = Legend::new(layers, width - 2.0 * BORDER, true, &fonts) {
            legend.draw((0.5 * (width - legend.width()), bottom + LEGEND_GAP), false, &mut marks);
            bottom += LEGEND_GAP + legend.height();
        }
    }
    check_height(bottom)?;
    let name = if figure.title.is_empty() { figure.panels[0].title.clone() } else { figure.title.clone() };
    Ok(Page { width, height: bottom + BORDER, name, marks })
}

/// Refuses a page that is too tall, from the end of what is on it [pt].
fn check_height(bottom: f64) -> Result<(), Error> {
    let millimetres = (bottom + BORDER) * 25.4 / 72.0;
    if millimetres.is_nan() || millimetres > TALLEST {
        return Err(Error::Tall { millimetres, allowed: TALLEST });
    }
    Ok(())
}

/// The legend of a panel outside its plot, and the room it takes there.
fn outside<'a>(panel: &'a Panel, place: Place, column: f64, fonts: &Fonts) -> Option<Legend<'a>> {
    match place {
        Place::Below => Legend::new(panel.layers.iter(), column, true, fonts),
        Place::Right => Legend::new(panel.layers.iter(), 0.45 * column, false, fonts),
        Place::Auto | Place::Inside(_) | Place::Hidden => None,
    }
}

/// Greatest height of a page \[mm\]: twice that of a journal. Drawn in its greatest width it takes 600 MB.
const TALLEST: f64 = 500.0;

/// Sizes of plots and places of panels; ticks and sizes depend on each other, so that it goes round a few times.
fn arrange(
    figure: &Figure,
    spans: &[Spans],
    places: &[Place],
    width: f64,
    top: f64,
    fonts: &Fonts,
) -> Result<Layout, Error> {
    let columns = figure.columns.min(figure.panels.len());
    let rows = figure.panels.len().div_ceil(columns);
    let height = |row: usize| figure.heights.get(row).copied().unwrap_or(HEIGHT);
    let inner = width - 2.0 * BORDER - (columns - 1) as f64 * BETWEEN_COLUMNS;
    let column = inner / columns as f64;
    let legends: Vec<_> =
        figure.panels.iter().zip(places).map(|(p, &place)| outside(p, place, column, fonts)).collect();
    let mut plot_width = 0.75 * column;
    let mut frames: Vec<Frame> = Vec::new();
    let (mut left, mut right) = (vec![0.0; columns], vec![0.0; columns]);
    for _ in 0..4 {
        frames = figure
            .panels
            .iter()
            .enumerate()
            .map(|(i, p)| Frame::new(p, &spans[i], plot_width, height(i / columns) * plot_width, fonts))
            .collect();
        left.fill(0.0_f64);
        right.fill(0.0_f64);
        for (i, frame) in frames.iter().enumerate() {
            let beside = match (&legends[i], places[i]) {
                (Some(legend), Place::Right) => LEGEND_GAP + legend.width(),
                _ => 0.0,
            };
            left[i % columns] = left[i % columns].max(frame.left);
            right[i % columns] = right[i % columns].max(frame.right + beside);
        }
        plot_width = (inner - left.iter().sum::<f64>() - right.iter().sum::<f64>()) / columns as f64;
        if plot_width < LEAST {
            return Err(Error::Narrow { columns, left: plot_width });
        }
    }
    let mut rects = Vec::new();
    let mut y = top;
    for row in 0..rows {
        let members = row * columns..((row + 1) * columns).min(frames.len());
        let above = frames[members.clone()].iter().map(|f| f.top).fold(0.0, f64::max);
        let below = members
            .clone()
            .map(|i| {
                let legend = match (&legends[i], places[i]) {
                    (Some(legend), Place::Below) => LEGEND_GAP + legend.height(),
                    _ => 0.0,
                };
                frames[i].bottom + legend
            })
            .fold(0.0, f64::max);
        let mut x = BORDER;
        for i in members {
            let c = i % columns;
            rects.push(Rect {
                left: x + left[c],
                top: y + above,
                width: plot_width,
                height: height(row) * plot_width,
            });
            x += left[c] + plot_width + right[c] + BETWEEN_COLUMNS;
        }
        y += above + height(row) * plot_width + below + BETWEEN_ROWS;
    }
    Ok(Layout { rects, frames, column, bottom: y - BETWEEN_ROWS })
}

fn draw_legend(
    panel: &Panel,
    place: Place,
    plot: &Rect,
    frame: &Frame,
    column: f64,
    fonts: &Fonts,
    marks: &mut Vec<Mark>,
) {
    match place {
        Place::Inside(corner) => {
            if let Some(legend) = Legend::new(panel.layers.iter(), plot.width, false, fonts) {
                legend.draw(legend.place(plot, corner), true, marks);
            }
        }
        Place::Below => {
            if let Some(legend) = outside(panel, place, column, fonts) {
                let left = (plot.left + 0.5 * (plot.width - legend.width())).max(plot.left - frame.left);
                legend.draw((left, plot.bottom() + frame.bottom + LEGEND_GAP), false, marks);
            }
        }
        Place::Right => {
            if let Some(legend) = outside(panel, place, column, fonts) {
                legend.draw((plot.right() + frame.right + LEGEND_GAP, plot.top - 0.2 * SMALL), false, marks);
            }
        }
        Place::Auto | Place::Hidden => {}
    }
}
