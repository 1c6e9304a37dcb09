//! Draws one specimen of every kind of figure, in both widths and as a table, into the folder named on the command line.

use std::error::Error;
use std::path::PathBuf;
use turbid_figure::{
    Align, Along, At, Axis, Band, Dash, Figure, Heatmap, Histogram, Legend, Line, Note, Panel, Points, Rule,
    Scale, Shading, Width,
};

/// Numbers that look measured: a fixed sequence, the same on every run.
struct Noise(u64);

impl Noise {
    fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// The sum of twelve uniforms less six: normal enough for a picture.
    fn normal(&mut self) -> f64 {
        (0..12).map(|_| self.uniform()).sum::<f64>() - 6.0
    }
}

fn grid(low: f64, high: f64, n: usize) -> Vec<f64> {
    (0..n).map(|i| low + (high - low) * i as f64 / (n - 1) as f64).collect()
}

fn powers(low: f64, high: f64, n: usize) -> Vec<f64> {
    grid(low, high, n).into_iter().map(libm::exp10).collect()
}

fn agreement() -> Figure {
    let mut noise = Noise(1);
    let classes = [
        "volume, fixed radius",
        "volume, k nearest",
        "at a wall, none",
        "at a wall, clipped",
        "at a wall, reflected",
        "beam",
    ];
    let mut scatter = Panel::new(Axis::linear("Predicted error", "%"), Axis::linear("Measured error", "%"))
        .with_title("(a) 204 cells");
    let mut scores = Vec::new();
    scatter = scatter.with(Rule::new(Along::Diagonal).with_label("measured = predicted"));
    for (class, label) in classes.iter().enumerate() {
        let (mut x, mut y, mut bars) = (vec![], vec![], vec![]);
        for i in 0..34 {
            let predicted = match class {
                2 => -12.0 - 36.0 * noise.uniform(),
                0 | 3 => 8.0 * noise.uniform(),
                _ => -6.0 + 9.0 * noise.uniform(),
            };
            let error = 0.25 + 1.1 * noise.uniform();
            let z = if class == 4 && i > 30 { 6.5 + noise.normal() } else { noise.normal() };
            let measured = predicted + z * error;
            scores.push(z);
            x.push(predicted);
            y.push(measured);
            bars.push((measured - 1.96 * error, measured + 1.96 * error));
        }
        scatter = scatter.with(Points::new(*label, class, x, y).with_y_interval(bars));
    }
    let edges = grid(-5.0, 5.0, 21);
    let z = grid(-5.0, 5.0, 201);
    let density = z.iter().map(|z| 0.398_942_280_401_432_7 * libm::exp(-0.5 * z * z)).collect();
    let histogram = Panel::new(
        Axis::linear("z = (measured − predicted) / standard error", ""),
        Axis::linear("Density", ""),
    )
    .with_title("(b) z scores")
    .with(Histogram::density("cells", 6, &scores, edges))
    .with(Line::theory("unit normal", z, density));
    Figure { heights: vec![1.0, 0.5], ..Figure::new(vec![scatter, histogram]) }
}

/// A cloud of 2,000 cases on a signed logarithmic scale.
fn cloud() -> Figure {
    let mut noise = Noise(7);
    let axis = |label: &str| Axis::new(label, "%", Scale::SymLog { threshold: 0.1 });
    let mut panel = Panel::new(axis("Predicted error"), axis("Measured error"));
    panel = panel.with(Rule::new(Along::Diagonal).with_label("measured = predicted"));
    for (class, label) in ["k rule", "clusters", "blur", "edge", "step", "storage"].iter().enumerate() {
        let (mut x, mut y, mut bars) = (vec![], vec![], vec![]);
        for _ in 0..[300, 200, 700, 500, 200, 100][class] {
            let size = libm::exp10([0.0, -0.7, 0.3, 1.4, 0.0, -1.0][class] + 0.5 * noise.normal());
            let predicted = if [true, true, false, false, true, false][class] { size } else { -size };
            let error = 0.02 + 0.04 * size * noise.uniform();
            let measured = predicted + error * noise.normal();
            x.push(predicted);
            y.push(measured);
            bars.push((measured - 1.96 * error, measured + 1.96 * error));
        }
        panel = panel.with(Points::new(*label, class, x, y).with_y_interval(bars));
    }
    Figure { width: Width::Double, heights: vec![0.6], ..Figure::new(vec![panel.with_legend(Legend::Right)]) }
}

fn convergence() -> Figure {
    let mut noise = Noise(2);
    let photons = powers(3.0, 7.0, 9);
    let fine = powers(2.9, 7.1, 60);
    let mut panel = Panel::new(Axis::log("Photons emitted", ""), Axis::log("Root mean square error", "%"));
    for (class, k) in [20.0, 100.0, 500.0].into_iter().enumerate() {
        // Standard deviation 1 / sqrt(k), bias growing as (k / N)^(2/3).
        let error = |n: f64| 100.0 * libm::sqrt(1.0 / k + 4.0 * libm::pow(k / n, 4.0 / 3.0));
        let label = format!("k = {k}");
        let y: Vec<f64> = photons.iter().map(|&n| error(n) * (1.0 + 0.03 * noise.normal())).collect();
        let bars = y.iter().map(|y| (y * 0.92, y * 1.08)).collect();
        panel = panel
            .with(Band::new(
                &label,
                class,
                fine.clone(),
                fine.iter().map(|&n| (0.9 * error(n), 1.1 * error(n))).collect(),
            ))
            .with(Line::new(&label, class, fine.clone(), fine.iter().map(|&n| error(n)).collect()))
            .with(Points::new(&label, class, photons.clone(), y).with_y_interval(bars));
    }
    Figure { title: "Error of the mean fluence against photons".to_owned(), ..Figure::new(vec![panel]) }
}

fn depth() -> Figure {
    let mut noise = Noise(3);
    let depths = grid(0.0, 2.0, 17);
    let fine = grid(0.0, 2.0, 801);
    let x = Axis::linear("Depth", "mean free paths");
    let mut panel = Panel::new(x, Axis::linear("Error of fluence", "%").with_range(-20.0, 8.0));
    panel = panel.with(Rule::new(Along::Horizontal(0.0)));
    for (class, r) in [0.05, 0.1, 0.2, 0.4].into_iter().enumerate() {
        let wall = |t: f64| {
            if t < r {
                let h = t / r;
                -50.0 * (1.0 - 1.5 * h + 0.5 * h * h * h)
            } else {
                0.0
            }
        };
        let error = |t: f64| 9.0 * r * r * (1.0 + t) + wall(t) + wall(2.0 - t);
        let y: Vec<f64> = depths.iter().map(|&t| error(t) + 0.4 * noise.normal()).collect();
        let bars = y.iter().map(|y| (y - 0.8, y + 0.8)).collect();
        let label = format!("r = {r}");
        panel = panel
            .with(
                Line::new(&label, class, fine.clone(), fine.iter().map(|&t| error(t)).collect())
                    .with_dash(Dash::Solid),
            )
            .with(Points::new(&label, class, depths.clone(), y).with_y_interval(bars));
    }
    Figure { width: Width::Double, heights: vec![0.45], ..Figure::new(vec![panel]) }
}

fn four() -> Figure {
    let mut noise = Noise(4);
    let panels = [(0.5, 0.0), (0.5, 0.75), (0.9, 0.0), (0.9, 0.75)]
        .into_iter()
        .enumerate()
        .map(|(i, (albedo, g))| {
            let letter = ["a", "b", "c", "d"][i];
            let mut panel = Panel::new(
                Axis::log("Gather radius", "mean free paths"),
                Axis::new("Signed error", "%", Scale::SymLog { threshold: 0.1 }),
            )
            .with_title(format!("({letter}) albedo {albedo}, g = {g}"))
            .with(Rule::new(Along::Horizontal(0.0)));
            let radii = powers(-1.7, 0.2, 8);
            for (class, name) in ["none", "clipped", "reflection", "local linear"].into_iter().enumerate() {
                let scale = [-40.0, 6.0, 9.0, -0.8][class] * albedo * (1.0 - 0.5 * g);
                let power = [0.15, 1.0, 1.2, 2.0][class];
                let error = |r: f64| scale * libm::pow(r, power);
                let y: Vec<f64> = radii
                    .iter()
                    .map(|&r| error(r) * (1.0 + 0.1 * noise.normal()) + 0.02 * noise.normal())
                    .collect();
                let bars = y.iter().map(|y| (y - 0.05 - 0.2 * y.abs(), y + 0.05 + 0.2 * y.abs())).collect();
                panel = panel
                    .with(Line::new(name, class, radii.clone(), radii.iter().map(|&r| error(r)).collect()))
                    .with(Points::new(name, class, radii.clone(), y).with_y_interval(bars));
            }
            panel
        })
        .collect();
    Figure {
        title: "Boundary treatments".to_owned(),
        width: Width::Double,
        columns: 2,
        heights: vec![0.6, 0.6],
        shared_legend: true,
        ..Figure::new(panels)
    }
}

fn maps() -> Figure {
    let (nx, ny) = (96, 64);
    let mut noise = Noise(5);
    let mut signed = Vec::new();
    let mut positive = Vec::new();
    for j in 0..ny {
        for i in 0..nx {
            let (x, y) = (f64::from(i) / f64::from(nx) * 2.0 - 1.0, f64::from(j) / f64::from(ny) * 2.0 - 1.0);
            let shaft = libm::exp(-8.0 * (y - 0.3 * x) * (y - 0.3 * x));
            signed.push(9.0 * (shaft - 0.4) + 1.5 * noise.normal());
            positive.push(0.01 + shaft * libm::exp(-1.5 * (x + 1.0)));
        }
    }
    let panel = |title: &str, map: Heatmap| {
        Panel::new(Axis::linear("Column", "pixel"), Axis::linear("Row", "pixel")).with_title(title).with(map)
    };
    let edges = |n: i32| (0..=n).map(f64::from).collect::<Vec<_>>();
    let error = Heatmap {
        x_edges: edges(nx),
        y_edges: edges(ny),
        values: signed,
        shading: Shading::Diverging,
        quantity: Axis::linear("Error of radiance", "%").with_range(-6.0, 6.0),
    };
    let radiance = Heatmap {
        x_edges: edges(nx),
        y_edges: edges(ny),
        values: positive,
        shading: Shading::Sequential,
        quantity: Axis::log("Radiance", "W/(m² sr)"),
    };
    Figure {
        width: Width::Double,
        columns: 2,
        heights: vec![0.667],
        ..Figure::new(vec![panel("(a) error", error), panel("(b) radiance", radiance)])
    }
}

fn odds() -> Figure {
    let far = Panel::new(
        Axis::linear("x", "").with_range(0.0, 10.0),
        Axis::linear("y", "µW").with_range(0.0, 1e-5),
    )
    .with_title("(a) points beyond the border")
    .with(
        Points::new(
            "all eight directions",
            1,
            vec![-1.0, 5.0, 11.0, 11.0, 11.0, 5.0, -1.0, -1.0, 5.0],
            vec![2e-5, 2e-5, 2e-5, 5e-6, -1e-6, -1e-6, -1e-6, 5e-6, 5e-6],
        )
        .with_y_interval(vec![
            (1.9e-5, 2.1e-5),
            (0.8e-5, 3e-5),
            (2e-5, 2e-5),
            (5e-6, 5e-6),
            (-1e-6, -1e-6),
            (-1e-6, -1e-6),
            (-1e-6, -1e-6),
            (5e-6, 5e-6),
            (4e-6, 6e-6),
        ])
        .with_x_interval(vec![
            (-1.0, -1.0),
            (5.0, 5.0),
            (11.0, 11.0),
            (9.0, 12.0),
            (11.0, 11.0),
            (5.0, 5.0),
            (-1.0, -1.0),
            (-2.0, 0.5),
            (4.0, 6.0),
        ]),
    );
    let mut names = Axis::linear("Kernel", "").with_range(-0.5, 3.5);
    names.names = ["box", "cone", "Epanechnikov", "biweight"]
        .iter()
        .enumerate()
        .map(|(i, n)| (i as f64, (*n).to_owned()))
        .collect();
    let mut markers =
        Panel::new(names, Axis::log("Variance ratio", "")).with_title("(b) named ticks, seven classes");
    for class in 0..7 {
        let y = (0..4).map(|i| 1.0 + 0.3 * f64::from(i) + 0.2 * class as f64).collect();
        markers = markers.with(Points::new(format!("class {class}"), class, grid(0.0, 3.0, 4), y));
    }
    let x = grid(0.0, 1.0, 50);
    let mut dashes = Panel::new(
        Axis::linear("Time", "s"),
        Axis::new("Counts", "", Scale::LogClipped).with_range(0.5, 200.0),
    )
    .with_title("(c) dashes, steps to zero");
    for (class, dash) in [Dash::Solid, Dash::Dashed, Dash::Dotted, Dash::DashDot].into_iter().enumerate() {
        let y = x.iter().map(|x| 50.0 * libm::exp(-3.0 * x * (class + 1) as f64)).collect();
        dashes = dashes.with(Line::new(format!("{dash:?}"), class, x.clone(), y).with_dash(dash));
    }
    dashes = dashes.with(
        Points::new("counts", 4, vec![0.1, 0.5, 0.7], vec![8.0, 1.0, 0.0]).with_y_interval(vec![
            (3.0, 14.0),
            (0.0, 5.0),
            (0.0, 3.0),
        ]),
    );
    dashes = dashes.with(Note { text: "no counts".to_owned(), at: At::Data(0.7, 0.8), align: Align::Start });
    let narrow = Panel::new(Axis::log("Narrow logarithmic axis", "m"), Axis::linear("Large numbers", "1/s"))
        .with_title("(d) ranges")
        .with_legend(Legend::Right)
        .with(Line::new("a line", 0, vec![2.2, 3.7], vec![1.2e9, 1.9e9]))
        .with(Band::new(
            "a band",
            1,
            vec![2.2, 3.0, 3.7],
            vec![(1.1e9, 1.3e9), (1.6e9, 1.5e9 + 2e8), (1.2e9, 1.9e9)],
        ));
    Figure { width: Width::Double, columns: 2, ..Figure::new(vec![far, markers, dashes, narrow]) }
}

fn main() -> Result<(), Box<dyn Error>> {
    let folder = PathBuf::from(std::env::args().nth(1).ok_or("name the folder to write to")?);
    std::fs::create_dir_all(&folder)?;
    for (name, figure) in [
        ("agreement", agreement()),
        ("cloud", cloud()),
        ("convergence", convergence()),
        ("depth", depth()),
        ("four", four()),
        ("maps", maps()),
        ("odds", odds()),
    ] {
        let other = figure.in_width(figure.width.other());
        for (name, figure) in [(name.to_owned(), &figure), (format!("{name}-{}", other.width.name()), &other)]
        {
            std::fs::write(folder.join(format!("{name}.png")), figure.png()?)?;
            std::fs::write(folder.join(format!("{name}.svg")), figure.svg()?)?;
        }
        std::fs::write(folder.join(format!("{name}.csv")), figure.csv("A specimen.")?)?;
    }
    Ok(())
}
