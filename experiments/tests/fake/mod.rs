//! A tiny experiment: maps whose mean is known, an estimator that is right and a planted twin that is not.

use std::fmt::Write;
use turbid::math::{ln, sin_cos};
use turbid::rng::{Purpose, Stream};
use turbid_experiments::harness::{
    CellId, CellOutput, Cells, Claim, Experiment, FigureFiles, Prediction, Row, Section, Settings, Study,
    Table, Unit,
};

/// The gather sizes.
pub const RADII: [f64; 4] = [0.1, 0.2, 0.4, 0.8];

/// The right estimator reads 1 + r^2/10, as predicted; the twin reads 5 per cent more.
pub fn predicted(r: f64) -> f64 {
    0.1 * r * r
}

pub fn case(r: f64) -> String {
    format!("r = {r}")
}

/// The experiment.
pub const FAKE: Experiment = Experiment {
    name: "fake",
    title: "The blur of a known mean",
    question: "Does the estimate of a known mean carry the predicted bias, and is a planted fault of 5 per cent seen?",
    cells,
    predict,
    measure,
    conclude,
};

/// A study of it.
pub fn study() -> Study<'static> {
    Study { name: "fake", experiments: &[FAKE], closing: None, program: "program-1".to_string() }
}

fn cells(settings: &Settings) -> Vec<CellId> {
    CellId::replicates("slab", settings.pick(64, 256), settings.photons(10_000, 10_000) as f64).collect()
}

fn predict(_: &Settings) -> anyhow::Result<Vec<Prediction>> {
    let prediction = |&r: &f64| Prediction {
        case: case(r),
        quantity: "bias".to_string(),
        unit: Unit::ONE,
        value: predicted(r),
        error: 0.0,
        source: "the definition, r²/10".to_string(),
    };
    Ok(RADII.iter().map(prediction).collect())
}

/// One map: all its values share one random number, as estimates of one map share photons.
fn measure(settings: &Settings, cell: &CellId) -> anyhow::Result<CellOutput> {
    anyhow::ensure!(settings.out.join("predictions.csv").exists(), "measured before it was predicted");
    if settings.out.join("fail").exists() && cell.replicate == 40 {
        anyhow::bail!("asked to fail");
    }
    if settings.out.join("abort").exists() && cell.replicate == 40 {
        std::process::abort();
    }
    let photons = settings.photons(10_000, 10_000);
    let mut stream = Stream::new(settings.seed, Purpose::Synthetic, cell.replicate, 0);
    let mut normal =
        || (-2.0 * ln(stream.open_unit())).sqrt() * sin_cos(std::f64::consts::TAU * stream.unit()).1;
    let scale = 0.3 / (photons as f64).sqrt();
    let shared = normal();
    let mut output = CellOutput::new();
    for r in RADII {
        let noise = scale * (shared + 0.5 * normal());
        output.push(case(r), "bias", predicted(r) + noise);
        output.push(case(r), "twin", predicted(r) + 0.05 + noise);
    }
    if settings.out.join("broken").exists() {
        output.push("r = 0", "bias", f64::NAN);
    }
    output.count("photons", photons);
    Ok(output)
}

fn conclude(_: &Settings, predictions: &[Prediction], cells: &Cells) -> anyhow::Result<Section> {
    let mut rows = Vec::new();
    for p in predictions {
        let bias = cells.moments(&p.case, "bias")?;
        rows.push(
            Row::measured(&p.case, "bias", Unit::ONE, &bias)?
                .reference(p.value, 0.0)
                .predicted_from(predictions)
                .cost(cells.counter("photons"), "photons"),
        );
    }
    let cases: Vec<String> = RADII.map(case).to_vec();
    let values = RADII.map(predicted);
    let maps = cells.per_map(&cases, "bias")?;
    let fit = turbid::stats::amplitude_per_map(&values, &maps, &[1.0; 4])
        .ok_or_else(|| anyhow::anyhow!("no fit"))?;
    let amplitude = turbid_experiments::harness::Estimate::mean(&fit.moments);
    rows.push(Row::estimated("all radii", "measured over predicted", Unit::ONE, &amplitude)?.predicted(1.0));
    let twin = cells.estimate(&case(0.1), "twin")?.minus(predicted(0.1)).times(100.0);
    let small = cells.estimate(&case(0.8), "bias")?.minus(predicted(0.8)).times(100.0);
    Ok(Section {
        summary: vec![
            "The measured bias follows r²/10 within a tenth, and a fault of 5 per cent is seen.".to_string(),
            "Every map is estimated at four gather sizes, so the four share their noise; the factor between measured and \
             predicted bias is fitted to each map by itself, and its error is the spread over maps."
                .to_string(),
        ],
        claims: vec![
            Claim::within("amplitude", "Measured bias over predicted bias is 1 within 10 per cent.", Unit::ONE, amplitude, 0.9, 1.1),
            Claim::within("residual", "No bias is left at r = 0.8 beside the predicted one, within 0.05 per cent.", Unit::PERCENT, small, -0.05, 0.05),
            Claim::within("wrong", "The twin has no bias beyond the predicted one, within 1 per cent.", Unit::PERCENT, twin, -1.0, 1.0),
            Claim::detected("twin", "The planted fault of 5 per cent is seen.", Unit::PERCENT, twin, 0.0, 2.5),
        ],
        figures: vec![figure(cells)?],
        tables: vec![Table::of_rows("Bias at four gather sizes: the measured values scatter about the prediction by their errors.", &rows)],
        notes: vec!["All four sizes are read from the same maps: their errors move together.".to_string()],
        rows,
        ..Section::default()
    })
}

fn figure(cells: &Cells) -> anyhow::Result<FigureFiles> {
    let (x, y) = (|r: f64| 80.0 + 900.0 * r, |b: f64| 400.0 - 5000.0 * b);
    let mut svg = String::from(
        "<?xml version=\"1.0\"?>\n<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 960 460\" font-family=\"sans-serif\" font-size=\"16\">",
    );
    let mut line = String::new();
    for i in 0..=40 {
        let r = 0.02 * f64::from(i);
        write!(line, "{:.1},{:.1} ", x(r), y(predicted(r)))?;
    }
    write!(svg, "<polyline points=\"{line}\" fill=\"none\" stroke=\"#1a4f8b\" stroke-width=\"2\"/>")?;
    write!(
        svg,
        "<path d=\"M80 20V400H900\" fill=\"none\" stroke=\"#1c1f23\"/><text x=\"80\" y=\"440\">gather radius [mfp]</text><text x=\"95\" y=\"36\">bias</text>"
    )?;
    for r in RADII {
        let m = cells.moments(&case(r), "bias")?;
        let (cx, cy, e) = (x(r), y(m.mean()), 5000.0 * 1.96 * m.std_error());
        write!(
            svg,
            "<path d=\"M{cx} {:.1}V{:.1}\" stroke=\"#a3231f\" stroke-width=\"2\"/><circle cx=\"{cx}\" cy=\"{cy:.1}\" r=\"5\" fill=\"#a3231f\"/>",
            cy - e,
            cy + e
        )?;
    }
    svg.push_str("</svg>\n");
    let caption = "Measured bias (dots, 95 per cent intervals) on the predicted parabola (line): the dots lie on the line.".to_string();
    Ok(FigureFiles { name: "bias".to_string(), caption, svg, png: vec![0x89, b'P', b'N', b'G'] })
}
