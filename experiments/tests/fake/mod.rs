//! A tiny experiment: maps whose mean is known, an estimator that is right and a negative control that is not.

use turbid::math::{ln, sin_cos};
use turbid::rng::{Purpose, Stream};
use turbid_experiments::harness::{
    CellId, CellOutput, Cells, Claim, Experiment, FigureFiles, Group, Headline, Row, Section, Settings,
    Study, Table, Unit, bar,
};
use turbid_experiments::prediction::Prediction;
use turbid_figure::{Axis, Figure, Line, Panel, Points};

/// The gather sizes.
pub const RADII: [f64; 4] = [0.1, 0.2, 0.4, 0.8];

/// The right estimator gives 1 + r^2/10, as predicted; the control 5 per cent more.
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
    groups,
    predict,
    conclude,
};

/// A study of it.
pub fn study() -> Study<'static> {
    Study { name: "fake", experiments: &[FAKE], closings: &[], program: "program-1".to_string() }
}

fn groups(settings: &Settings) -> Vec<Group> {
    group(settings, measure)
}

/// The group of its cells, measured otherwise.
pub fn group(
    settings: &Settings,
    measure: impl Fn(&Settings, &CellId) -> anyhow::Result<CellOutput> + Send + Sync + 'static,
) -> Vec<Group> {
    let cost = settings.photons(10_000, 10_000) as f64;
    vec![Group::new("slab", settings.pick(64, 256), cost, measure)]
}

fn predict(_: &Settings) -> anyhow::Result<Vec<Prediction>> {
    let prediction =
        |&r: &f64| Prediction::new(case(r), "bias", Unit::ONE, (predicted(r), 0.0), "the definition, r²/10");
    Ok(RADII.iter().map(prediction).collect())
}

/// One map: all its values share one random number, as estimates of one map share photons.
pub fn measure(settings: &Settings, cell: &CellId) -> anyhow::Result<CellOutput> {
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
        output.push(case(r), "control", predicted(r) + 0.05 + noise);
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
    let control = cells.estimate(&case(0.1), "control")?.minus(predicted(0.1));
    let small = cells.estimate(&case(0.8), "bias")?.minus(predicted(0.8));
    Ok(Section {
        summary: vec![
            "The measured bias follows r²/10 within a tenth, and a fault of 5 per cent is detected.".to_string(),
            "Every map is estimated at four gather sizes, so the four share their noise; the factor between measured and \
             predicted bias is fitted to each map by itself, and its error is the spread over maps."
                .to_string(),
        ],
        claims: vec![
            Claim::within("amplitude", "Measured bias over predicted bias is 1 within 10 per cent.", Unit::ONE, amplitude, 0.9, 1.1),
            Claim::within("residual", "No bias is left at r = 0.8 beside the predicted one, within 0.05 per cent.", Unit::FRACTION, small, -0.0005, 0.0005),
            Claim::within("wrong", "The control has no bias beyond the predicted one, within 1 per cent.", Unit::FRACTION, control, -0.01, 0.01),
            Claim::detected("control", "The planted fault of 5 per cent is detected.", Unit::FRACTION, control, 0.0, 0.025),
        ],
        headlines: vec![Headline::new("Factor", "measured bias over predicted bias", Unit::ONE, amplitude)],
        figures: vec![figure(cells)?],
        tables: vec![Table::of_rows("Bias at four gather sizes: the measured values scatter about the prediction by their errors.", &rows)],
        notes: vec!["All four sizes are read from the same maps: their errors move together.".to_string()],
        rows,
        ..Section::default()
    })
}

fn figure(cells: &Cells) -> anyhow::Result<FigureFiles> {
    let x: Vec<f64> = (0..=40).map(|i| 0.02 * f64::from(i)).collect();
    let theory = x.iter().map(|&r| predicted(r)).collect();
    let measured =
        RADII.map(|r| cells.moments(&case(r), "bias")).into_iter().collect::<Result<Vec<_>, _>>()?;
    let y = measured.iter().map(|m| m.mean()).collect();
    let points = Points::new("measured", 1, RADII.to_vec(), y);
    let panel = Panel::new(Axis::linear("gather radius", "mfp"), Axis::linear("bias", ""))
        .with(Line::theory("predicted", x, theory))
        .with(points.with_y_interval(measured.iter().map(bar).collect()));
    let caption = "Measured bias (dots, 95 per cent intervals) on the predicted parabola (line): the dots lie on the line.";
    // Flat, since the tests draw it some fifty times.
    FigureFiles::draw("bias", caption, &Figure { heights: vec![0.2], ..Figure::new(vec![panel]) })
}
