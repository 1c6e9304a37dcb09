//! What the pictures say, and where two ways cost the same.

use super::data::{Cell, Currency, Fit, read};
use super::{SIDE, Size, sizes};
use crate::cost_model::{RANGE, cheapest, crossing};
use crate::harness::{Cells, Estimate, Settings, percent};
use turbid::rng::{Purpose, Stream};
use turbid::stats::Interval;

/// Everything measured, with resamples of the cells.
pub struct Pictures {
    /// By cell.
    pub cells: Vec<Cell>,
    /// Sizes of maps.
    pub sizes: Vec<Size>,
    /// Numbers of cells, drawn with replacement.
    resamples: Vec<Vec<usize>>,
}

impl Pictures {
    pub fn new(settings: &Settings, cells: &Cells) -> anyhow::Result<Self> {
        let cells = read(settings, cells)?;
        let draw = |i| {
            let mut stream = Stream::new(settings.seed, Purpose::Resampling, i, 0);
            (0..cells.len()).map(|_| stream.index(cells.len())).collect()
        };
        Ok(Pictures { resamples: (0..RESAMPLES).map(draw).collect(), sizes: sizes(settings), cells })
    }

    /// Of all cells.
    pub fn fit(&self, currency: Currency) -> Fit {
        Fit::of(&self.cells.iter().collect::<Vec<_>>(), currency)
    }

    /// Time of paths over that of the cheapest map at an error over the mean, with its interval.
    pub fn gain(&self, error: f64) -> String {
        let of = |fit: &Fit| gain(fit, PIXELS, error).unwrap_or(0.0);
        let interval = middle(self.resampled(Currency::Seconds).map(|fit| of(&fit)).collect());
        format!("{:.1} ({:.1} to {:.1})", of(&self.fit(Currency::Seconds)), interval.low, interval.high)
    }

    /// Cost of paths over that of the cheapest map at errors over the mean, with half their intervals over resampled cells as
    /// two standard errors: the cheapest of several sizes has no jackknife. None below what every map has left.
    pub fn gains<const N: usize>(&self, currency: Currency, errors: [f64; N]) -> [Option<Estimate>; N] {
        let fit = self.fit(currency);
        let resampled: Vec<Fit> = self.resampled(currency).collect();
        errors.map(|error| {
            let value = gain(&fit, PIXELS, error)?;
            let of = |fit: &Fit| gain(fit, PIXELS, error).unwrap_or(0.0);
            let interval = middle(resampled.iter().map(of).collect());
            let std_error = (interval.high - interval.low) / (2.0 * NORMAL_95);
            Some(Estimate::resampled(value, std_error, self.cells.len() as u64))
        })
    }

    /// Of the resampled cells.
    pub fn resampled(&self, currency: Currency) -> impl Iterator<Item = Fit> {
        let of = move |chosen: &Vec<usize>| {
            Fit::of(&chosen.iter().map(|&i| &self.cells[i]).collect::<Vec<_>>(), currency)
        };
        self.resamples.iter().map(of)
    }
}

/// Standard errors from the middle of a 95 % interval to its ends.
const NORMAL_95: f64 = 1.96;

/// The ends of the middle 95 % of some values.
pub fn middle(mut values: Vec<f64>) -> Interval {
    values.sort_unstable_by(f64::total_cmp);
    let (last, cut) = (values.len() - 1, values.len() / 40);
    Interval::new(values[cut], values[last - cut])
}

/// Root mean square error, over the mean, below which paths are cheaper, with its interval over cells.
pub struct Crossing {
    /// Of all cells.
    pub at: f64,
    /// Bootstrap interval of 95 %.
    pub interval: Interval,
}

impl Crossing {
    /// One a picture's side.
    pub fn all(pictures: &Pictures, currency: Currency) -> Vec<Crossing> {
        let of =
            |fit: &Fit| SIDES.map(|side| crossing(&fit.maps, &fit.paths, f64::from(side * side), fit.mean));
        let whole = of(&pictures.fit(currency));
        let resampled: Vec<_> = pictures.resampled(currency).map(|fit| of(&fit)).collect();
        let one =
            |i: usize| Crossing { at: whole[i], interval: middle(resampled.iter().map(|r| r[i]).collect()) };
        (0..SIDES.len()).map(one).collect()
    }

    /// No error below the range is looked at: where maps win at its lower end, they win down to that at least.
    pub fn words(&self) -> String {
        let one = |error: f64| match error <= RANGE.0 {
            true => format!("at most {:.1}", percent(error)),
            false => format!("{:.1}", percent(error)),
        };
        format!("{} % ({} to {})", one(self.at), one(self.interval.low), one(self.interval.high))
    }

    pub fn verdict(&self) -> String {
        let asked = percent(PREVIEW_ERROR);
        match self.interval {
            i if i.high < PREVIEW_ERROR => format!("the whole interval is below {asked} %"),
            i if i.low > PREVIEW_ERROR => format!("the whole interval is above {asked} %"),
            _ => format!("undecided against {asked} % on this machine, in this run"),
        }
    }
}

/// The error that the claim and the words ask about, chosen before the first run: what a preview may have.
pub const PREVIEW_ERROR: f64 = 0.3;

/// Resamples of the cells for intervals.
pub const RESAMPLES: u64 = 500;

/// Sides of pictures in the table: the one measured, and what larger ones would do with the same maps and pixels.
pub const SIDES: [u32; 5] = [16, 32, 64, 128, 512];

/// Cost of paths over that of the cheapest map at an error over the mean; none below what every map has left.
pub fn gain(fit: &Fit, pixels: f64, error: f64) -> Option<f64> {
    let square = error * error * fit.mean * fit.mean;
    cheapest(&fit.maps, pixels, square).map(|(_, cost)| fit.paths.cost(pixels, square) / cost)
}

pub const PIXELS: f64 = (SIDE * SIDE) as f64;
