//! From a figure to marks on a page: sizes, places, then drawing.

use crate::check;
use crate::draw::draw;
use crate::error::Error;
use crate::extent::{Spans, spans};
use crate::figure::{Figure, Legend as Place, Panel};
use crate::frame::Frame;
use crate::layer::Align;
use crate::legend::Legend;
use crate::mark::{Mark, Page, Point, Rect, Text};
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
/// Narrower plots are not worth printing [pt], nor are lower ones that had to give way.
const LEAST: f64 = 45.0;
const LOWEST: f64 = 40.0;
/// Where nothing else helps they are, down to here [pt].
const STRIP: f64 = 12.0;
/// Greatest height of a page, 240 mm \[pt\]: what a page of print leaves beside a caption.
const TALLEST: f64 = 240.0 / 25.4 * 72.0;
/// Height over width where the figure does not say.
pub(crate) const HEIGHT: f64 = 0.75;

/// Places of all plots.
struct Layout {
    rects: Vec<Rect>,
    frames: Vec<Frame>,
    /// Width for the legend of a panel: below it, and to its right.
    column: f64,
    /// Bottom of the plots and their labels.
    bottom: f64,
}

/// Where everything stands on the page, before anything is drawn.
pub(crate) struct Laid {
    pub(crate) spans: Vec<Spans>,
    /// Plots, labels around them, and legends, one for each panel.
    pub(crate) rects: Vec<Rect>,
    pub(crate) frames: Vec<Frame>,
    pub(crate) places: Vec<Place>,
    /// Width for the legend of a panel.
    column: f64,
    title: Vec<String>,
    /// Bottom of the plots, their labels and legends.
    bottom: f64,
    pub(crate) width: f64,
    pub(crate) height: f64,
}

impl Laid {
    /// The legend of a panel that stands there, outside its plot.
    pub(crate) fn outside<'a>(&self, panel: &'a Panel, place: Place, fonts: &Fonts) -> Option<Legend<'a>> {
        outside(panel, place, self.column, fonts)
    }

    /// The legend of all panels, if they have one, and its top left corner.
    pub(crate) fn shared<'a>(&self, figure: &'a Figure, fonts: &Fonts) -> Option<(Legend<'a>, Point)> {
        let legend = shared(figure, self.width, fonts)?;
        let corner = (0.5 * (self.width - legend.width()), self.bottom + LEGEND_GAP);
        Some((legend, corner))
    }
}

/// The page that shows the figure.
pub(crate) fn compose(figure: &Figure) -> Result<Page, Error> {
    let fonts = Fonts::load()?;
    check::figure(figure, &fonts)?;
    let laid = lay_out(figure, &fonts)?;
    let mut marks = Vec::new();
    for (i, line) in laid.title.iter().enumerate() {
        let at = (BORDER, BORDER + (i as f64 + 0.8) * LARGE * LEADING);
        marks.push(Mark::Text(Text { bold: true, ..plain(line, at, Align::Start, LARGE) }));
    }
    for (i, panel) in figure.panels.iter().enumerate() {
        let plot = Plot { rect: laid.rects[i], spans: laid.spans[i] };
        let frame = &laid.frames[i];
        frame.draw_under(&plot, panel, &mut marks);
        draw(&plot, &panel.layers, &fonts, &mut marks);
        frame.draw_over(&plot, panel, &mut marks);
        draw_legend(panel, laid.places[i], &plot.rect, frame, laid.column, &fonts, &mut marks);
    }
    if let Some((legend, corner)) = laid.shared(figure, &fonts) {
        legend.draw(corner, false, &mut marks);
    }
    let name = if figure.title.is_empty() { figure.panels[0].title.clone() } else { figure.title.clone() };
    Ok(Page { width: laid.width, height: laid.height, name, marks })
}

/// Sizes and places of a figure that was checked, on a page no taller than one of print.
///
/// Where it would be taller, the tallest plots give way first, to one height; where plots would be too low, more panels
/// stand beside each other, if there is room.
///
/// # Errors
/// [`Error::Narrow`] and [`Error::Tall`], if there is no room
pub(crate) fn lay_out(figure: &Figure, fonts: &Fonts) -> Result<Laid, Error> {
    let first = on_a_page(figure, LOWEST, fonts);
    if !matches!(first, Err(Error::Tall { .. })) {
        return first;
    }
    let wider =
        (figure.columns + 1..=figure.panels.len()).map(|n| on_a_page(&figure.in_columns(n), LOWEST, fonts));
    let wider = wider.filter_map(Result::ok).next();
    wider.map_or_else(|| on_a_page(figure, STRIP, fonts), Ok)
}

/// The figure in its columns, its plots no lower than `lowest` [pt] unless they are so by themselves.
fn on_a_page(figure: &Figure, lowest: f64, fonts: &Fonts) -> Result<Laid, Error> {
    let spans: Vec<Spans> =
        figure.panels.iter().enumerate().map(|(i, p)| spans(i + 1, p)).collect::<Result<_, _>>()?;
    let width = figure.width.millimetres() * 72.0 / 25.4;
    let title = fonts.wrap(&figure.title, LARGE, true, width - 2.0 * BORDER);
    let top = BORDER + if title.is_empty() { 0.0 } else { title.len() as f64 * LARGE * LEADING + 3.0 };
    let below = shared(figure, width, fonts).map_or(0.0, |legend| LEGEND_GAP + legend.height()) + BORDER;
    let mut highest = TALLEST;
    loop {
        let mut places: Vec<Place> = figure
            .panels
            .iter()
            .map(|p| if figure.shared_legend { Place::Hidden } else { p.legend })
            .collect();
        let mut layout = arrange(figure, &spans, &places, width, top, highest, fonts)?;
        for (i, panel) in figure.panels.iter().enumerate() {
            if places[i] == Place::Auto {
                let plot = Plot { rect: layout.rects[i], spans: spans[i] };
                let obstacles = obstacles::between(&plot, &panel.layers, fonts);
                let free = Legend::new(panel.layers.iter(), plot.rect.width, false, fonts)
                    .map(|l| l.free_corner(&plot.rect, &obstacles));
                places[i] = match free {
                    None => Place::Hidden,
                    Some(None) => Place::Below,
                    Some(Some(corner)) => Place::Inside(corner),
                };
            }
        }
        // Legends below move panels only, so that corners found free stay free.
        layout = arrange(figure, &spans, &places, width, top, highest, fonts)?;
        let height = layout.bottom + below;
        if height <= TALLEST {
            let Layout { rects, frames, column, bottom } = layout;
            return Ok(Laid { spans, rects, frames, places, column, title, bottom, width, height });
        }
        let rows: Vec<f64> = layout.rects.iter().step_by(figure.columns).map(|r| r.height).collect();
        let room = TALLEST - (height - rows.iter().sum::<f64>());
        // A millionth less: the sum of the rows is rounded.
        let level = (1.0 - 1e-6) * level(&rows, room);
        // Other ticks may take more room: the level falls, each time around.
        if level < lowest.min(0.999 * highest) {
            return Err(Error::Tall { millimetres: height * 25.4 / 72.0, allowed: TALLEST * 25.4 / 72.0 });
        }
        highest = level.min(0.999 * highest);
    }
}

/// The height to which rows are cut so that their sum is `room`.
fn level(rows: &[f64], room: f64) -> f64 {
    let mut sorted = rows.to_vec();
    sorted.sort_by(f64::total_cmp);
    let mut left = room;
    for (i, row) in sorted.iter().enumerate() {
        let share = left / (sorted.len() - i) as f64;
        if *row >= share {
            return share;
        }
        left -= row;
    }
    f64::INFINITY
}

/// The legend of all panels, if the figure has one.
fn shared<'a>(figure: &'a Figure, width: f64, fonts: &Fonts) -> Option<Legend<'a>> {
    let layers = figure.panels.iter().flat_map(|p| &p.layers);
    figure.shared_legend.then(|| Legend::new(layers, width - 2.0 * BORDER, true, fonts)).flatten()
}

/// The legend of a panel outside its plot, and the room it takes there.
fn outside<'a>(panel: &'a Panel, place: Place, column: f64, fonts: &Fonts) -> Option<Legend<'a>> {
    match place {
        Place::Below => Legend::new(panel.layers.iter(), column, true, fonts),
        Place::Right => Legend::new(panel.layers.iter(), 0.45 * column, false, fonts),
        Place::Auto | Place::Inside(_) | Place::Hidden => None,
    }
}

/// Sizes of plots, none higher than `highest`, and places of panels; ticks and sizes depend on each other, so that it goes round a few times.
fn arrange(
    figure: &Figure,
    spans: &[Spans],
    places: &[Place],
    width: f64,
    top: f64,
    highest: f64,
    fonts: &Fonts,
) -> Result<Layout, Error> {
    let columns = figure.columns.min(figure.panels.len());
    let rows = figure.panels.len().div_ceil(columns);
    let height =
        |row: usize, width: f64| (figure.heights.get(row).copied().unwrap_or(HEIGHT) * width).min(highest);
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
            .map(|(i, p)| Frame::new(p, &spans[i], plot_width, height(i / columns, plot_width), fonts))
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
                height: height(row, plot_width),
            });
            x += left[c] + plot_width + right[c] + BETWEEN_COLUMNS;
        }
        y += above + height(row, plot_width) + below + BETWEEN_ROWS;
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
