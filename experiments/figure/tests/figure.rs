//! Whole figures: what they show, what they refuse, that they repeat.
#![allow(clippy::unwrap_used, reason = "tests")]

use turbid_figure::{
    Align, Along, At, Axis, Band, Error, Figure, Heatmap, Histogram, Legend, Line, Note, Panel, Points, Rule,
    Scale, Shading, Width,
};

fn axes() -> Panel {
    Panel::new(Axis::linear("depth", "m"), Axis::linear("fluence", "W/m²"))
}

fn points(y: Vec<f64>) -> Points {
    Points::new("measured", 0, (0..y.len()).map(|i| i as f64).collect(), y)
}

fn refusal(panel: Panel) -> Error {
    Figure::new(vec![panel]).svg().unwrap_err()
}

/// The number in `name="..."`.
fn attribute(line: &str, name: &str) -> f64 {
    let (_, rest) = line.split_once(&format!(" {name}=\"")).unwrap();
    rest.split_once('"').unwrap().0.parse().unwrap()
}

/// Centres of the discs.
fn discs(svg: &str) -> Vec<(f64, f64)> {
    let discs = svg.lines().filter(|l| l.starts_with("<circle"));
    discs.map(|l| (attribute(l, "cx"), attribute(l, "cy"))).collect()
}

/// Opaque areas beside the paper: arrow heads, each on a white one, where there are no bars and no maps.
fn triangles(svg: &str) -> usize {
    svg.lines().filter(|l| l.starts_with("<path fill=\"#") && !l.contains("opacity")).count()
}

/// The places in path data of one area whose steps are horizontal and vertical.
fn rectangle(line: &str) -> Vec<(f64, f64)> {
    let data = line.split_once(" d=\"M").unwrap().1.trim_end_matches("z\"/>");
    let steps = data.replace('h', " h").replace('v', " v");
    let mut words = steps.split(' ');
    let start = words.next().unwrap().split_once(',').unwrap();
    let mut out = vec![(start.0.parse().unwrap(), start.1.parse().unwrap())];
    for word in words {
        let (x, y): (f64, f64) = *out.last().unwrap();
        let by: f64 = word[1..].parse().unwrap();
        out.push(if word.starts_with('h') { (x + by, y) } else { (x, y + by) });
    }
    out
}

#[test]
fn the_document_says_every_label_unit_and_title() {
    let mut figure = Figure::new(vec![
        axes()
            .with_title("(a) a < b & c")
            .with(points(vec![1.0, 2.0, 3.0]))
            .with(Line::theory("exact", vec![0.0, 2.0], vec![1.0, 3.0]))
            .with(Rule::new(Along::Horizontal(2.0)).with_label("plateau")),
    ]);
    figure.title = "A figure".to_owned();
    let svg = figure.svg().unwrap();
    for text in
        ["A figure", "(a) a &lt; b &amp; c", "depth [m]", "fluence [W/m²]", "measured", "exact", "plateau"]
    {
        assert!(svg.contains(&format!(">{text}</text>")), "{text}");
    }
    assert!(svg.contains("font-family=\"DejaVu Sans, Verdana, sans-serif\""));
    assert!(svg.starts_with("<svg width=\"85.00mm\""));
}

#[test]
fn equal_ratios_are_equal_lengths_on_a_logarithmic_axis() {
    let panel = Panel::new(Axis::log("N", ""), Axis::linear("y", ""))
        .with_legend(Legend::Hidden)
        .with(Points::new("", 0, vec![1e2, 1e3, 1e5], vec![0.0, 1.0, 3.0]));
    let at = discs(&Figure::new(vec![panel]).svg().unwrap());
    assert_eq!(at.len(), 3);
    // Places are whole units of the canvas, so that each length is known within one, twice it within three.
    assert!(((at[2].0 - at[1].0) - 2.0 * (at[1].0 - at[0].0)).abs() <= 3.0, "{at:?}");
    assert!(((at[1].1 - at[2].1) - 2.0 * (at[0].1 - at[1].1)).abs() <= 3.0, "{at:?}");
}

#[test]
fn numbers_that_are_not_finite_are_refused_by_name() {
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let error = refusal(axes().with(points(vec![1.0, bad])));
        assert!(matches!(&error, Error::NotFinite { column: "y", index: 1, .. }), "{error}");
        assert!(error.to_string().starts_with("panel 1, points \"measured\": y[1] is"), "{error}");
        let bars = points(vec![1.0, 2.0]).with_y_interval(vec![(0.0, 1.0), (bad, bad)]);
        assert!(matches!(
            refusal(axes().with(bars)),
            Error::NotFinite { column: "y_interval", index: 1, .. }
        ));
        assert!(matches!(
            refusal(axes().with(Line::theory("", vec![bad], vec![0.0]))),
            Error::NotFinite { column: "x", .. }
        ));
        let band = Band::new("", 0, vec![0.0], vec![(0.0, bad)]);
        assert!(matches!(refusal(axes().with(band)), Error::NotFinite { column: "interval", .. }));
        let bars = Histogram::new("", 0, vec![0.0, 1.0], vec![bad]);
        assert!(matches!(refusal(axes().with(bars)), Error::NotFinite { column: "heights", .. }));
        assert!(matches!(refusal(axes().with(Rule::new(Along::Vertical(bad)))), Error::NotFinite { .. }));
        assert!(matches!(
            refusal(axes().with(map(vec![0.0, bad]))),
            Error::NotFinite { column: "values", index: 1, .. }
        ));
    }
}

fn map(values: Vec<f64>) -> Heatmap {
    let x_edges = (0..=values.len()).map(|i| i as f64).collect();
    Heatmap {
        x_edges,
        y_edges: vec![0.0, 1.0],
        values,
        shading: Shading::Diverging,
        quantity: Axis::linear("error", "%"),
    }
}

#[test]
fn logarithms_need_positive_numbers_or_leave_to_clip() {
    let panel = |scale| {
        Panel::new(Axis::linear("x", ""), Axis::new("y", "", scale)).with(points(vec![1.0, 0.0, 10.0]))
    };
    assert!(matches!(refusal(panel(Scale::Log)), Error::NotPositive { column: "y", index: 1, .. }));
    let svg = Figure::new(vec![panel(Scale::LogClipped)]).svg().unwrap();
    // Two discs and one in the legend; the zero is an arrow: a white and a coloured triangle.
    assert_eq!(discs(&svg).len(), 3);
    assert_eq!(triangles(&svg), 2);
}

#[test]
fn points_beyond_a_range_become_arrows() {
    let mut panel = axes().with(points(vec![1.0, 2.0, 30.0])).with_legend(Legend::Hidden);
    panel.y = panel.y.with_range(0.0, 5.0);
    let svg = Figure::new(vec![panel]).svg().unwrap();
    assert_eq!(discs(&svg).len(), 2);
    assert_eq!(triangles(&svg), 2);
}

#[test]
fn lists_intervals_edges_and_ranges_are_checked() {
    let bad = Points::new("", 0, vec![0.0, 1.0], vec![0.0]);
    assert!(matches!(refusal(axes().with(bad)), Error::Length { column: "y", found: 1, expected: 2, .. }));
    let bad = points(vec![0.0]).with_x_interval(vec![(1.0, -1.0)]);
    assert!(matches!(refusal(axes().with(bad)), Error::Interval { column: "x_interval", .. }));
    let bad = Histogram::new("", 0, vec![0.0, 1.0, 1.0], vec![1.0, 1.0]);
    assert!(matches!(refusal(axes().with(bad)), Error::Edges { index: 2, .. }));
    let bad = Heatmap { values: vec![0.0; 3], ..map(vec![0.0; 2]) };
    assert!(matches!(refusal(axes().with(bad)), Error::Length { column: "values", expected: 2, .. }));
    for (low, high) in [(1.0, 1.0), (2.0, 1.0), (f64::NAN, 1.0), (0.0, f64::INFINITY)] {
        let mut panel = axes().with(points(vec![1.0]));
        panel.x = panel.x.with_range(low, high);
        assert!(matches!(refusal(panel), Error::Range { axis: "x", .. }));
    }
    let mut panel =
        Panel::new(Axis::log("x", ""), Axis::linear("y", "")).with(Line::theory("", vec![1.0], vec![1.0]));
    panel.x = panel.x.with_range(0.0, 1.0);
    assert!(matches!(refusal(panel), Error::Range { axis: "x", .. }));
    assert!(matches!(refusal(axes()), Error::Empty { .. }));
    assert!(matches!(refusal(axes().with(points(vec![]))), Error::Empty { .. }));
    assert!(matches!(
        refusal(axes().with(points(vec![1.0])).with_title("霧")),
        Error::Glyph { character: '霧', .. }
    ));
    let crowd = Figure { columns: 9, ..Figure::new(vec![axes().with(points(vec![1.0])); 9]) };
    assert!(matches!(crowd.svg(), Err(Error::Narrow { columns: 9, .. })));
}

#[test]
fn the_legend_stands_where_no_data_are_or_outside() {
    let n = 40;
    let x: Vec<f64> = (0..n).map(f64::from).collect();
    let shapes: [Box<dyn Fn(f64) -> f64>; 3] =
        [Box::new(|x| x), Box::new(|x| -x), Box::new(|x| (x - 20.0) * (x - 20.0))];
    let boxes = |svg: &str| -> Vec<Vec<(f64, f64)>> {
        svg.lines()
            .filter(|l| l.starts_with("<path") && l.contains("fill-opacity=\"0.9\""))
            .map(rectangle)
            .collect()
    };
    for shape in shapes {
        let y: Vec<f64> = x.iter().map(|&x| shape(x)).collect();
        let svg = Figure::new(vec![axes().with(Points::new("a label", 0, x.clone(), y))]).svg().unwrap();
        let boxes = boxes(&svg);
        assert_eq!(boxes.len(), 1);
        let (low, high) = (boxes[0][0], boxes[0][2]);
        let covered = discs(&svg)
            .into_iter()
            .filter(|p| p.0 > low.0 && p.0 < high.0 && p.1 > low.1 && p.1 < high.1)
            .count();
        assert_eq!(covered, 1, "only its own swatch");
    }
    // A grid of points leaves no corner: the legend goes below, without a box.
    let (mut gx, mut gy) = (Vec::new(), Vec::new());
    for i in 0..20 {
        for j in 0..20 {
            gx.push(f64::from(i));
            gy.push(f64::from(j));
        }
    }
    let svg = Figure::new(vec![axes().with(Points::new("a label", 0, gx, gy))]).svg().unwrap();
    assert!(boxes(&svg).is_empty());
    assert!(svg.contains(">a label</text>"));
}

#[test]
fn a_shared_legend_says_each_label_once() {
    let panel =
        || axes().with(points(vec![1.0, 2.0])).with(Line::new("theory", 1, vec![0.0, 1.0], vec![1.0, 2.0]));
    let mut figure = Figure { columns: 2, width: Width::Double, ..Figure::new(vec![panel(); 4]) };
    assert_eq!(figure.svg().unwrap().matches(">theory</text>").count(), 4);
    figure.shared_legend = true;
    assert_eq!(figure.svg().unwrap().matches(">theory</text>").count(), 1);
}

#[test]
fn a_histogram_says_what_lies_beyond_it() {
    let svg =
        Figure::new(vec![axes().with(Histogram::density("z", 0, &[-9.0, 0.5, 7.0, 8.0], vec![0.0, 1.0]))])
            .svg()
            .unwrap();
    assert!(svg.contains(">← 1 below</text>") && svg.contains(">2 above →</text>"));
}

#[test]
fn signed_colours_are_symmetric_about_white() {
    let svg = Figure::new(vec![axes().with(map(vec![-2.0, 0.0, 1.0]))]).svg().unwrap();
    // -2 is the end of the scale, 0 its middle, 1 half way to the other end: the mean of the third and fourth reds of the table, (244, 165, 130) and (214, 96, 77).
    for color in ["#053061", "#F7F7F7", "#E58368"] {
        assert!(svg.contains(color), "{color}");
    }
}

#[test]
fn pictures_have_300_pixels_to_the_inch_and_ink() {
    for (width, pixels) in [(Width::Single, 1004), (Width::Double, 2067), (Width::Millimetres(50.8), 600)] {
        let figure = Figure { width, ..Figure::new(vec![axes().with(points(vec![1.0, 2.0]))]) };
        let image = image::load_from_memory(&figure.png().unwrap()).unwrap().to_rgb8();
        assert_eq!(image.width(), pixels);
        assert_eq!(image.get_pixel(0, 0).0, [255, 255, 255]);
        assert!(image.pixels().any(|p| p.0 == [43, 79, 196]), "the blue of class 0");
        assert!(image.pixels().any(|p| p.0 == [0, 0, 0]), "black text");
    }
}

#[test]
fn the_same_figure_gives_the_same_bytes() {
    let figure =
        Figure::new(vec![axes().with(points(vec![1.0, 4.0, 2.0])), axes().with(map(vec![0.3, -0.7, 2.0]))]);
    assert_eq!(figure.svg().unwrap(), figure.svg().unwrap());
    assert_eq!(figure.png().unwrap(), figure.clone().png().unwrap());
}

#[test]
fn extremes_are_drawn() {
    for scale in [1e-300, 1e-12, 1.0, 1e15, 1e300] {
        let y = vec![scale, 2.0 * scale, -scale];
        Figure::new(vec![axes().with(points(y))]).svg().unwrap();
    }
    for y in [vec![0.0], vec![1e17, 1e17 + 16.0], vec![-5.0, -5.0]] {
        Figure::new(vec![axes().with(points(y.clone())).with(Rule::new(Along::Diagonal))]).png().unwrap();
    }
    let sym = Panel::new(Axis::linear("x", ""), Axis::new("y", "", Scale::SymLog { threshold: 1e-9 }))
        .with(points(vec![-1e9, 0.0, 1e12]));
    Figure::new(vec![sym]).svg().unwrap();
}

/// Every size of number that there is, down to the smallest and up to the largest, has an axis.
#[test]
fn numbers_of_any_size_are_drawn() {
    let sizes = (-323..=308).map(|e| format!("1e{e}").parse().unwrap()).chain([f64::MAX, 5e-324]);
    for size in sizes {
        for y in [vec![0.0, size], vec![-size, size], vec![size, size]] {
            let scales = [Scale::Linear, Scale::LogClipped, Scale::SymLog { threshold: 1.0 }];
            for scale in scales {
                let panel = Panel::new(Axis::linear("x", ""), Axis::new("y", "", scale));
                let svg = Figure::new(vec![panel.with(points(y.clone()))]).svg().unwrap();
                assert!(!svg.contains("NaN") && !svg.contains("inf"), "{scale:?} {y:?}");
            }
            Figure::new(vec![axes().with(map(y.clone()))]).svg().unwrap();
        }
    }
    for narrow in [5e-324, 1e-308, 1e-300] {
        let mut panel = axes().with(points(vec![0.0]));
        panel.y = panel.y.with_range(0.0, narrow);
        assert!(matches!(refusal(panel), Error::Range { .. }), "{narrow}");
    }
}

/// Sizes of all texts in points of print, from the document's own millimetres.
fn font_sizes(svg: &str) -> Vec<f64> {
    let (_, size) = svg.split_once("<svg width=\"").unwrap();
    let millimetres: f64 = size.split_once("mm").unwrap().0.parse().unwrap();
    let (_, size) = svg.split_once("viewBox=\"0 0 ").unwrap();
    let units: f64 = size.split_once(' ').unwrap().0.parse().unwrap();
    let texts = svg.lines().filter(|l| l.starts_with("<text"));
    texts.map(|l| attribute(l, "font-size") / units * millimetres / 25.4 * 72.0).collect()
}

#[test]
fn text_is_legible_in_print_in_both_widths() {
    let layers = |panel: Panel| panel.with(points(vec![1.0, 4.0, 2.0])).with(Rule::new(Along::Diagonal));
    let panel = layers(axes().with_title("(a)")).with_legend(Legend::Right);
    for (width, columns) in [(Width::Single, 1), (Width::Double, 3), (Width::Millimetres(120.0), 2)] {
        let mut figure = Figure { width, columns, ..Figure::new(vec![panel.clone(); 3]) };
        figure.panels[1] = axes().with(map(vec![0.3, -0.7, 2.0]));
        figure.title = "A figure".to_owned();
        for figure in [figure.in_width(width.other()), figure] {
            let sizes = font_sizes(&figure.svg().unwrap());
            let least = sizes.iter().copied().fold(f64::INFINITY, f64::min);
            // 6.5 pt, known to the half hundredth of a millimetre that the width is written to: 6e-5 of 85 mm.
            assert!(sizes.len() > 20 && least > 6.5 * (1.0 - 1e-4), "{least} pt");
        }
    }
}

#[test]
fn every_label_is_still_there_in_the_other_width() {
    let panels = vec![axes().with_title("(a)").with(points(vec![1.0, 2.0])).with_legend(Legend::Right); 3];
    let figure = Figure { width: Width::Double, columns: 3, ..Figure::new(panels) };
    let single = figure.in_width(Width::Single).svg().unwrap();
    assert!(single.starts_with("<svg width=\"85.00mm\""));
    for text in ["measured", "(a)", "depth [m]", "fluence [W/m²]"] {
        assert_eq!(single.matches(&format!(">{text}</text>")).count(), 3, "{text}");
    }
}

/// Width and height of the page [mm].
fn page(svg: &str) -> (f64, f64) {
    let head = svg.lines().next().unwrap();
    let size = |name: &str| {
        let (_, rest) = head.split_once(&format!("{name}=\"")).unwrap();
        rest.split_once("mm").unwrap().0.parse::<f64>().unwrap()
    };
    (size("width"), size("height"))
}

/// Whatever is asked for, a page is that of print: 240 mm.
#[test]
fn no_page_is_higher_than_one_of_print() {
    let kinds: [fn(Panel) -> Panel; 6] = [
        |p| p.with(points(vec![1.0, 2.0])).with_legend(Legend::Below),
        |p| p.with(points(vec![1.0, 2.0]).with_y_interval(vec![(0.5, 1.5), (1.0, 3.0)])),
        |p| {
            p.with(Rule::new(Along::Diagonal).with_label("measured = predicted")).with(points(vec![1.0, 2.0]))
        },
        |p| p.with(map(vec![0.3, -0.7, 2.0])),
        |p| p.with(Histogram::new("bars", 0, vec![0.0, 1.0, 2.0], vec![1.0, 3.0])),
        |p| p.with(Band::new("band", 1, vec![0.0, 1.0], vec![(0.5, 1.5), (1.0, 3.0)])),
    ];
    for kind in kinds {
        for (count, width, columns) in [
            (1_usize, Width::Single, 1_usize),
            (5, Width::Single, 1),
            (9, Width::Single, 1),
            (1, Width::Double, 1),
            (6, Width::Double, 1),
            (9, Width::Double, 2),
            (12, Width::Double, 3),
        ] {
            for heights in [vec![], vec![1.5; count.div_ceil(columns)], vec![1e308; count.div_ceil(columns)]]
            {
                for shared_legend in [false, true] {
                    let panel = kind(axes().with_title("a title"));
                    let panels = vec![panel; count];
                    let figure = Figure {
                        width,
                        columns,
                        heights: heights.clone(),
                        shared_legend,
                        ..Figure::new(panels)
                    };
                    for figure in [figure.in_width(width.other()), figure] {
                        let svg = figure.svg().unwrap();
                        let (wide, high) = page(&svg);
                        assert!(
                            (wide - figure.width.millimetres()).abs() < 0.01 && high <= 240.0,
                            "{count}: {high} mm"
                        );
                        assert_eq!(svg.matches(">a title</text>").count(), count);
                    }
                }
            }
        }
    }
}

#[test]
fn a_page_that_fits_keeps_its_heights_and_tall_rows_give_way_first() {
    let panel = || axes().with(points(vec![1.0, 2.0]));
    let plots = |heights: Vec<f64>| {
        let svg =
            Figure { heights: heights.clone(), ..Figure::new(vec![panel(); heights.len()]) }.svg().unwrap();
        page(&svg).1
    };
    // One row more adds its plot: 0.5 of the same width.
    let (one, two) = (plots(vec![0.5]), plots(vec![0.5, 0.5]));
    assert!(two < 240.0 && two > 1.9 * one);
    assert!((plots(vec![0.5, 9.0]) - 240.0).abs() < 0.01);
}

#[test]
fn what_has_no_room_is_refused() {
    let panel = || axes().with(points(vec![1.0, 2.0]));
    let error = Figure::new(vec![panel(); 60]).png().unwrap_err();
    assert!(matches!(error, Error::Tall { .. } | Error::Narrow { .. }), "{error}");
    let error = Figure { width: Width::Millimetres(1e6), ..Figure::new(vec![panel()]) }.png().unwrap_err();
    assert!(error.to_string().ends_with("allowed: up to 500 mm"), "{error}");
}

/// LaTeX of every kind of layer and scale: braces balance, nothing is left that pdflatex cannot read, every layer has its
/// rows and every label its entry.
#[test]
fn every_kind_of_figure_is_latex() {
    let sym = Scale::SymLog { threshold: 0.5 };
    let awkward = "5 % of a_b & {τ} ≤ 10⁻² m² − x, \\end #1";
    for (x, y) in
        [(Scale::Linear, Scale::Linear), (Scale::Log, Scale::LogClipped), (sym, sym), (Scale::Log, sym)]
    {
        let at = vec![0.5, 1.0, 2.0];
        let interval = vec![(0.4, 2.5), (0.4, 2.5), (0.4, 2.5)];
        let points = Points::new(awkward, 0, at.clone(), at.clone())
            .with_x_interval(interval.clone())
            .with_y_interval(interval.clone());
        let mut panel = Panel::new(Axis::new(awkward, "m²", x), Axis::new("y_1", "%", y))
            .with_title(awkward)
            .with(points)
            .with(Line::theory("line_", at.clone(), at.clone()))
            .with(Band::new("band", 1, at.clone(), interval))
            .with(Rule::new(Along::Diagonal).with_label("same"))
            .with(Rule::new(Along::Horizontal(1.0)))
            .with(Histogram::new("even", 2, vec![0.5, 1.0, 1.5], vec![1.0, 2.0]))
            .with(Histogram::new("odd", 3, vec![0.5, 1.0, 2.5], vec![1.0, 2.0]))
            .with(Note { text: awkward.to_owned(), at: At::Fraction(0.1, 0.1), align: Align::Start });
        if y == Scale::Linear {
            let mut map = map(vec![1.0, 2.0, 3.0]);
            (map.x_edges, map.y_edges) = (vec![0.5, 1.0, 1.5, 2.0], vec![0.5, 1.0]);
            panel = panel.with(map);
        }
        for shared_legend in [false, true] {
            let title = awkward.to_owned();
            let figure = Figure { title, shared_legend, ..Figure::new(vec![panel.clone(); 2]) };
            let (tex, csv) = (figure.tex("f.csv").unwrap(), figure.csv("").unwrap());
            assert!(tex.is_ascii(), "{tex}");
            let mut depth = 0_i32;
            let mut escaped = false;
            for c in tex.chars() {
                match c {
                    '{' if !escaped => depth += 1,
                    '}' if !escaped => depth -= 1,
                    _ => {}
                }
                escaped = c == '\\' && !escaped;
                assert!(depth >= 0);
            }
            assert_eq!(depth, 0);
            assert!(tex.contains(
                r"5 \% of a\_b \& \{\ensuremath{\tau}\} \ensuremath{\le} 10\ensuremath{^-}\ensuremath{^2}"
            ));
            let names: Vec<&str> = csv.lines().find(|l| !l.starts_with('#')).unwrap().split(',').collect();
            for used in tex.split("\\thisrow{").skip(1).map(|rest| rest.split_once('}').unwrap().0) {
                assert!(names.contains(&used), "{used}");
            }
            // Points, line, two edges of a band, two histograms, in either panel.
            assert_eq!(tex.matches("\n\\turbidplot{").count(), 2 * 6);
            assert_eq!(tex.matches("\\addlegendentry").count(), if shared_legend { 6 } else { 12 });
            assert_eq!(tex.contains("% Nor the heat map of panel 1, 2:"), y == Scale::Linear);
        }
    }
}
