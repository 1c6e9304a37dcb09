//! The tables.

use super::cases::Place;
use super::claims::is_main;
use super::fields::FIELDS;
use super::results::{Found, VISIBLE, integrals, kept, rims, signed};
use super::sheet::{Sheet, Side};
use crate::harness::{Settings, Table, percent, percent_with_error, with_error};
use crate::setups::Size;
use turbid::estimators::Kernel;
use turbid::estimators::boundary::{Rejection, Treatment};
use turbid::stats::Moments;

/// All tables.
pub fn all(settings: &Settings, found: &Found) -> anyhow::Result<Vec<Table>> {
    Ok(vec![
        verdict(found)?,
        treatments(settings, found)?,
        rim(settings, found),
        integral(settings, found),
        sheet(found)?,
    ])
}

fn text(moments: &Moments) -> String {
    with_error(moments.mean(), moments.std_error())
}

/// Which remedy cures which fault.
fn verdict(found: &Found) -> anyhow::Result<Table> {
    let mut rows = Vec::new();
    for rejection in Rejection::ALL {
        for is_clipped in [false, true] {
            let error = |side| -> anyhow::Result<String> {
                let sheet = Sheet {
                    side,
                    distance: 0.25,
                    size: Size::Radius(0.1),
                    kernel: Kernel::Uniform,
                    rejection,
                    is_clipped,
                };
                Ok(percent_with_error(&found.sheet(&sheet)?.error))
            };
            let [good, bad] = kept(found, rejection, 0.25, Size::Radius(0.1))?;
            rows.push(vec![
                rejection.name().to_string(),
                if is_clipped { "yes" } else { "no" }.to_string(),
                percent_with_error(&good.iter().collect()),
                percent_with_error(&bad.iter().collect()),
                error(Side::Bright)?,
                error(Side::Dark)?,
            ]);
        }
    }
    let columns = [
        "rejection",
        "clipped",
        "good photons kept [%]",
        "false photons kept [%]",
        "error, bright side [%]",
        "error, dark side [%]",
    ];
    Ok(Table {
        caption: "The verdict. A thin opaque sheet parts a uniform field from one a quarter as bright; the probe is a quarter of \
                  the radius from it, uniform kernel. Directions ('facing', 'facing behind') remove at most half of the false \
                  photons, places ('behind plane', 'visible') all of them, and no rejection repairs the low density: \
                  that is what clipping does. Only both together are right on both sides."
            .to_string(),
        columns: columns.map(String::from).to_vec(),
        rows,
    })
}

/// Treatments at the surface of each body.
fn treatments(settings: &Settings, found: &Found) -> anyhow::Result<Table> {
    let mut rows = Vec::new();
    for field in FIELDS {
        for place in [Place::Face(0.0), Place::Edge(0.0), Place::Corner(0.0)] {
            let mut row = vec![format!("{}, {}", field.title, words(place))];
            for treatment in Treatment::ALL {
                let one = found.results.iter().find(|r| {
                    let c = &r.case;
                    (c.field, c.photons, c.treatment, c.place)
                        == (field, field.main_size(settings), treatment, place)
                        && (is_main(c) || c.size == Size::Radius(0.4) && c.kernel == Kernel::Uniform)
                });
                if let Some(r) = one {
                    row.push(format!(
                        "{} [{}]",
                        percent_with_error(&r.error),
                        signed(percent(r.predicted()), 2)
                    ));
                }
            }
            if row.len() == 5 {
                rows.push(row);
            }
        }
    }
    let mut row = vec!["variance factor at a flat face".to_string()];
    for treatment in Treatment::ALL {
        let one = found.spreads.iter().find(|s| {
            (s.spread.treatment, s.spread.depth, s.spread.kernel) == (treatment, 0.0, Kernel::Uniform)
        });
        row.push(one.map_or_else(String::new, |s| {
            format!("{} [{}]", text(&s.factors.iter().collect()), signed(s.exact.0, 2))
        }));
    }
    rows.push(row);
    let mut columns = vec!["place".to_string()];
    columns.extend(Treatment::ALL.map(|t| format!("{} [%]", t.name())));
    Ok(Table {
        caption: "Error on the surface, radius 0.4 mean free paths, uniform kernel: measured with its standard error and, in \
                  square brackets, predicted before. Last row: the variance over that of a whole ball, independent photons, a \
                  pure number. Local linear is the least biased where the field bends and the noisiest."
            .to_string(),
        columns,
        rows,
    })
}

fn words(place: Place) -> &'static str {
    match place {
        Place::Face(_) => "on a face",
        Place::Edge(_) => "on an edge",
        Place::Corner(_) => "on a corner",
    }
}

/// The dark rim.
fn rim(settings: &Settings, found: &Found) -> Table {
    let mut rows = Vec::new();
    for rim in rims(settings, found) {
        rows.push(vec![
            rim.photons.to_string(),
            rim.size.name(),
            with_error(rim.width.value, rim.width.std_error),
            signed(rim.predicted_width, 4),
            with_error(rim.lost.value, rim.lost.std_error),
            signed(rim.predicted_lost, 5),
        ]);
    }
    let columns = ["photons", "gather", "rim width [mfp]", "predicted", "fluence lost [mfp]", "predicted"]
        .map(String::from);
    Table {
        caption: format!(
            "The dark rim of the furnace slab without treatment: how deep the error is {} % or more, and the \
             integral of the loss over depth, the thickness of fluence that is lost at each face. At a fixed radius both are \
             proportional to the radius and ignore the number of photons; with the k nearest they fall with the cube root of \
             photons over k.",
            percent(VISIBLE)
        ),
        columns: columns.to_vec(),
        rows,
    }
}

/// The size of the error over depth.
fn integral(settings: &Settings, found: &Found) -> Table {
    let all = integrals(settings, found);
    // One line a gather: its treatments follow one another.
    let rows = all.chunks(Treatment::ALL.len()).map(|line| {
        let mut row = vec![line[0].field.title.to_string(), line[0].size.name()];
        row.extend(line.iter().map(|one| {
            let measured = with_error(one.measured.value, one.measured.std_error);
            format!("{measured} [{}; {}]", signed(one.predicted, 5), signed(one.noise, 5))
        }));
        row
    });
    let mut columns = vec!["field".to_string(), "gather".to_string()];
    columns.extend(Treatment::ALL.map(|t| format!("{} [mfp]", t.name())));
    Table {
        caption: "The size of the error below a face, integrated over depth from the surface to 1.25 radii (1.75 for the k \
                  nearest) in mean free paths, uniform kernel: measured and, in square brackets, predicted and what noise \
                  alone would leave on average. A size has no sign to cancel noise by: beside no bias the measured \
                  number is noise, and its standard error, by leaving out maps, rough."
            .to_string(),
        columns,
        rows: rows.collect(),
    }
}

/// The k nearest beside the sheet.
fn sheet(found: &Found) -> anyhow::Result<Table> {
    let mut rows = Vec::new();
    for rejection in Rejection::ALL {
        for is_clipped in [false, true] {
            let mut row =
                vec![rejection.name().to_string(), if is_clipped { "yes" } else { "no" }.to_string()];
            for side in [Side::Bright, Side::Dark] {
                for distance in [0.05, 0.5] {
                    let (size, kernel) = (Size::Nearest(30), Kernel::Uniform);
                    let s = found.sheet(&Sheet { side, distance, size, kernel, rejection, is_clipped })?;
                    row.push(format!(
                        "{} [{}]",
                        percent_with_error(&s.error),
                        signed(percent(s.predicted), 1)
                    ));
                }
            }
            rows.push(row);
        }
    }
    let columns = ["rejection", "clipped", "bright, 0.005", "bright, 0.05", "dark, 0.005", "dark, 0.05"];
    Ok(Table {
        caption: "The 30 nearest accepted photons beside the sheet, uniform kernel, at two distances from it in units of the \
                  box: error in per cent of the field on the probe's side, measured with its standard error and, in square \
                  brackets, predicted. Rejected photons set no radius."
            .to_string(),
        columns: columns.map(String::from).to_vec(),
        rows,
    })
}
