//! What the cells of all media say.

use super::cases::{Medium, Method, name, sizes};
use super::crossing::Pair;
use super::exact::exact;
use super::figures;
use super::predict::{self, EXPONENT};
use super::results::{Aim, Curve, Rung, Size};
use super::sentences;
use crate::harness::{
    Cells, Estimate, Parameters, Row, Section, Settings, Table, Unit, number, percent, signed, with_error,
};
use turbid::estimators::Kernel;

/// Concludes.
pub fn conclude(settings: &Settings, cells: &Cells) -> anyhow::Result<Section> {
    let sizes = sizes(settings);
    // What is best for an error is the same on every machine, what is best for time is not.
    let (mut curves, mut timed, mut exacts) = (Vec::new(), Vec::new(), Vec::new());
    for medium in Medium::ALL {
        let (value, error) = exact(medium)?;
        exacts.push((medium, value, error));
        for method in Method::ALL {
            curves.push(Curve::new(cells, (medium, value), method, (&sizes, Aim::Error))?);
            timed.push(Curve::new(cells, (medium, value), method, (&sizes, Aim::Time))?);
        }
    }
    let pairs: Vec<Pair<'_>> = sentences::pairs(&timed);
    Ok(Section {
        summary: vec![sentences::summary(&pairs)],
        figures: vec![figures::media(&timed)?],
        tables: vec![sentences::table(&pairs), table(&curves, &sizes), times(&timed, &sizes)],
        notes: notes(),
        rows: rows(&curves, &exacts, &sizes)?,
        ..Section::default()
    })
}

fn rows(curves: &[Curve], exacts: &[(Medium, f64, f64)], sizes: &[u64]) -> anyhow::Result<Vec<Row>> {
    let mut rows: Vec<Row> = exacts
        .iter()
        .map(|(medium, value, error)| {
            Row::exact(medium.name(), "radiance scattered twice and more", Unit::RADIANCE, *value, *error)
        })
        .collect();
    for curve in curves {
        for (i, rung) in curve.rungs.iter().enumerate() {
            let case = name(curve.medium, curve.method, rung.photons, None);
            let asked = Parameters {
                photons: Some(rung.photons),
                radius: rung.radii.map(|radii| radii[0]),
                kernel: rung.radii.map(|_| Kernel::Uniform),
                ..Parameters::default()
            };
            let quantities = [
                ("mean error", Estimate::mean(&rung.mean())),
                ("median error", curve.estimate(i, Size::Typical)),
                ("error that a tenth is beyond", curve.estimate(i, Size::Rare)),
                ("root mean square error", rung.root()),
            ];
            for (quantity, estimate) in quantities {
                // From a handful of photons all maps may say the same: nothing.
                if estimate.std_error() > 0.0 {
                    rows.push(Row::estimated(&case, quantity, Unit::FRACTION, &estimate)?.with(asked));
                }
            }
        }
        let exponent = curve.in_photons();
        if exponent.std_error() > 0.0 {
            let case = predict::name(curve.medium, curve.method);
            let predicted = curve.method.exponent(sizes[0], sizes[sizes.len() - 1]);
            rows.push(Row::estimated(&case, EXPONENT, Unit::ONE, &exponent)?.predicted(predicted));
        }
    }
    Ok(rows)
}

/// The radius of a rung; two where its halves disagree.
fn radius(rung: &Rung) -> String {
    match rung.radii {
        None => String::new(),
        Some([a, b]) if a == b => format!("{a:.3}"),
        Some([a, b]) => format!("{a:.3}, {b:.3}"),
    }
}

fn table(curves: &[Curve], sizes: &[u64]) -> Table {
    let mut rows = Vec::new();
    for curve in curves {
        let last = curve.rungs.len() - 1;
        let exponent = curve.in_photons();
        rows.push(vec![
            curve.medium.name().to_string(),
            curve.method.title().to_string(),
            radius(&curve.rungs[last]),
            curve.estimate(last, Size::Typical).in_percent(),
            curve.estimate(last, Size::Rare).in_percent(),
            number(percent(curve.rungs[last].root().value())),
            with_error(exponent.value(), exponent.std_error()),
            signed(curve.method.exponent(sizes[0], sizes[last]), 2),
        ]);
    }
    let columns = [
        "medium",
        "method",
        "radius",
        "median error [%]",
        "a tenth beyond [%]",
        "root mean square [%]",
        "exponent in photons",
        "in the limit",
    ];
    Table {
        caption: format!(
            "At equal photons: errors of rays with {} of them, at the radius of the least error (in mean free paths), and the exponent of the \
             median error. The root mean square of planes and of debiased sums does not settle: it is that of the maps at hand.",
            sizes[sizes.len() - 1]
        ),
        columns: columns.map(String::from).to_vec(),
        rows,
    }
}

fn times(curves: &[Curve], sizes: &[u64]) -> Table {
    let mut rows = Vec::new();
    for curve in curves {
        let last = curve.rungs.len() - 1;
        let rung = &curve.rungs[last];
        let (exponent, error) = (curve.in_time(), curve.quantiles[last][0]);
        rows.push(vec![
            curve.medium.name().to_string(),
            curve.method.title().to_string(),
            radius(rung),
            curve.estimate(last, Size::Typical).in_percent(),
            number(rung.seconds),
            number(1e6 * rung.ray),
            number(rung.looked_at),
            number(1e9 * rung.ray / rung.looked_at),
            number(error * error * rung.looked_at),
            with_error(exponent.value(), exponent.std_error()),
        ]);
    }
    let columns = [
        "medium",
        "method",
        "radius",
        "median error [%]",
        "CPU seconds",
        "microseconds a ray",
        "records a ray",
        "nanoseconds a record",
        "squared error times records",
        "exponent in time",
    ];
    Table {
        caption: format!(
            "Against time: the same at the radius of the least product of squared error and time, the CPU seconds of this machine for a map of {} \
             photons and 10,000 rays, what of it a ray takes and looks at (photons, flights or planes), the squared median error times the records, which says who would be ahead if \
             all records took alike, and the exponent of the median error.",
            sizes[sizes.len() - 1]
        ),
        columns: columns.map(String::from).to_vec(),
        rows,
    }
}

fn notes() -> Vec<String> {
    vec![
        "Four media, light scattered twice and more, albedo 0.9: a ball of radius 0.1 under light from all sides, asked along chords at half \
         its radius; a slab of 8 under a normal beam, asked at depth 1 along its faces; a slab of 4 of g = 0.9 under a normal beam, seen from \
         behind at a cosine of 0.5; a ball of radius 2 under light from all sides, asked along chords at nine tenths of its radius. Exact \
         values by the referee's integral equations and discrete ordinates. But in the slab of 8, kernels are cut by faces, and what \
         is left of them makes up for it."
            .to_string(),
        "Balls stand a radius apart along a ray. Debiased sums are those of the experiment on them: beams, the first radius the largest of the \
         medium, three levels, each of half the radius. Radii are tried from the largest in steps of the root of two, five of them; where the \
         largest is best, a larger one might be better still: in slabs light is even along the faces, and a kernel that takes in all of a \
         slab would live on that. Against time a radius is best where squared error times time is least: fewer photons are looked at within \
         a small one."
            .to_string(),
        "Times are those of this program, of which a record is the unit: a photon takes several times as long along a ray as in a ball, most \
         where faces cut the kernels, since a ball is cut once and along a ray every photon's disc by itself. The time of a picture of 10,000 rays \
         is mostly theirs: with fewer rays planes and beams fall back, whose maps take longer."
            .to_string(),
        "That a radius which shrinks by the right power leads to the exact value is the matter of the experiment `progressive`, and what debiasing \
         costs at equal photons that of `debiasing`."
            .to_string(),
    ]
}
